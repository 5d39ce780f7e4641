"""Points of a surface at given stations, the coordinate along the face width: the second parameter by Newton."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.errors import NoSolutionError, Solution, Status
from gearmesh.kernel.numeric.algebra import Array, broadcast_pair, dot
from gearmesh.kernel.surface.levels import Level
from gearmesh.kernel.surface.surface import Jet, Surface

#: rows of a grid whose solution starts the others'
START_ROWS = 7
#: Newton steps at most, and the distance from the station (of 1 mm and more, relative) that counts as none
ITERATIONS, TOLERANCE = 40, 1e-9
#: steps of the whole batch before what has not converged goes on alone, and steps that must halve a point's distance
TOGETHER, STALE = 8, 8


class TrimError(NoSolutionError):
    """A tooth that cannot be trimmed: `station` (t) and `what` ("pointed", "undercut", "flank", "tip", "edge") say where, why."""

    def __init__(self, what: str, station: float, message: str) -> None:
        super().__init__(reason=message)
        self.what, self.station = what, station


@dataclass(frozen=True)
class Followed(Solution):
    """Points at stations: the second parameter v (...,) as `values`, distance (mm) from the station as residual; their `jet`."""

    jet: Jet


def along(surface: Surface, p: Array, stations: Array, axial: Level, start: Array | float = 0.0) -> tuple[Array, Jet]:
    """Second parameter v, and the jet, of the points with first parameter p at the given station coordinates.

    Shapes broadcast to (...,). Raises TrimError where there is no such point near the start.
    """
    curve = follow(surface, p, stations, axial, start)
    if not curve.converged.all():
        raise TrimError("tip", 0.5, "the tooth surface cannot be followed along the face")
    return curve.values, curve.jet


def follow(surface: Surface, p: Array, stations: Array, axial: Level, start: Array | float = 0.0) -> Followed:
    """As `along`, with a status for each point.

    Newton: the station is linear in v for every rack-generated surface (one step). The whole batch goes on together, then
    what has not converged, so that a few points that have no v cost the others nothing. On a grid whose p is evenly spaced along
    the first axis a few rows are solved first and the others start from their interpolation.
    """
    p, stations = broadcast_pair(p, stations)
    if p.ndim == 2 and p.shape[0] > 2 * START_ROWS:
        start = _interpolate(surface, p, stations, axial, start)
    v = np.broadcast_to(np.asarray(start, dtype=float), p.shape)
    scale = 1.0 + float(np.abs(stations).max(initial=0.0))
    v, jet, miss, iterations = _newton_steps(surface, p, stations, axial, v, (scale, TOGETHER))
    left = ~(np.abs(miss) <= TOLERANCE * scale)
    if left.any() and iterations == TOGETHER:
        v[left], _, _, more = _newton_steps(
            surface, p[left], stations[left], axial, v[left], (scale, ITERATIONS - TOGETHER)
        )
        jet, iterations = surface.jet(p, v), iterations + more
        miss = axial.value(jet.r) - stations
    residual = np.abs(miss)
    status = np.where(np.isfinite(residual), int(Status.MAX_ITERATIONS), int(Status.NOT_FINITE))
    status = np.where(residual <= TOLERANCE * scale, int(Status.CONVERGED), status)
    return Followed(v, status, residual, iterations, jet)


def _newton_steps(
    surface: Surface, p: Array, stations: Array, axial: Level, start: Array, limits: tuple[float, int]
) -> tuple[Array, Jet, Array, int]:
    """v, jet and distance (...,) from the station after Newton steps from `start`, and their number; `limits`: scale, most.

    v is NaN where there is no step, or where the steps of STALE iterations together do not halve the distance.
    """
    scale, most = limits
    v = np.array(start, dtype=float)
    before, past = v, np.full(v.shape, np.inf)
    last, iterations = np.inf, 0
    while iterations < most:
        iterations += 1
        jet = surface.jet(p, v)
        miss = axial.value(jet.r) - stations
        if iterations % STALE == 0:
            size = np.abs(miss)
            v = np.where((size > TOLERANCE * scale) & (size > 0.5 * past), np.nan, v)
            past = size
        outside = ~np.isfinite(miss) & ~np.isnan(v)
        if outside.any():
            # the step went beyond what the tool generates: half of it, if there was one
            v = np.where(outside, np.where(v == before, np.nan, 0.5 * (v + before)), v)
            continue
        largest = float(np.fmax.reduce(np.abs(miss).ravel(), initial=0.0))
        # to rounding, which for a cutter much larger than the gear is that of the cutter
        if largest <= 4e-15 * scale or 0.5 * last < largest <= TOLERANCE * scale:
            return v, jet, miss, iterations
        last = largest
        with np.errstate(all="ignore"):
            step = miss / dot(axial.gradient(jet.r), jet.r_v)
        before, v = v, np.where(np.isfinite(step), v - step, np.nan)
        if np.array_equal(v, before, equal_nan=True) or largest <= 1e-12 * scale:
            break
    jet = surface.jet(p, v)
    return v, jet, axial.value(jet.r) - stations, iterations


def _interpolate(surface: Surface, p: Array, stations: Array, axial: Level, start: Array | float) -> Array | float:
    """Start values (S, T) from START_ROWS rows of a grid, by polynomials over p; `start` where p does not run along rows."""
    first, last = p[:1], p[-1:]
    with np.errstate(all="ignore"):
        place = ((p - first) / (last - first)).mean(axis=1)
    if not np.isfinite(place).all():
        return start
    rows = np.abs(place[:, None] - 0.5 * (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, START_ROWS)))).argmin(axis=0)
    if np.unique(rows).size < START_ROWS:
        return start
    at = np.broadcast_to(start, p.shape)[rows]
    curve = follow(surface, p[rows], stations[rows], axial, at)
    if not curve.converged.all():
        return start
    known = curve.values
    nodes = place[rows]
    apart = nodes[:, None] - nodes + np.eye(START_ROWS)
    # Lagrange: products of (x - x_k) / (x_j - x_k) over k other than j
    weights = np.repeat((place[:, None] - nodes)[:, None], START_ROWS, axis=1)
    weights[:, np.arange(START_ROWS), np.arange(START_ROWS)] = 1.0
    lagrange = weights.prod(axis=2) / apart.prod(axis=1)
    result: Array | float = lagrange @ known
    return result
