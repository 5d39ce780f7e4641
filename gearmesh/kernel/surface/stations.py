"""Points of a surface at given stations along the face width: Newton's method for the second parameter."""

from __future__ import annotations

import numpy as np

from gearmesh.errors import NoSolutionError, Solution, Status
from gearmesh.kernel.numeric.algebra import Array, broadcast_pair, distinct, dot
from gearmesh.kernel.numeric.effort import ROOT_STEP, spend
from gearmesh.kernel.surface.levels import Level
from gearmesh.kernel.surface.surface import Jet, Surface
from gearmesh.records import dataclass

#: rows of a grid whose solution provides start values for the other rows
START_ROWS = 7
#: limit of the Newton steps
MAX_NEWTON_STEPS = 40
#: distance from the station that counts as 0, relative to 1 mm plus the largest station
RELATIVE_TOLERANCE = 1e-9
#: steps of the whole batch, after which only unconverged points continue
MAX_BATCH_STEPS = 8
#: steps that must halve the distance of a point; otherwise the point is given up
STEPS_PER_HALVING = 8
#: surfaces that cannot be trimmed, by `TrimError.what`; the flank for others
UNTRIMMED_SURFACES = {
    "pointed": ("land",),
    "root": ("fillet",),
    "edge": ("edge",),
    "undercut": ("flank", "fillet"),
    "crossing": ("flank", "fillet"),
}


class TrimError(NoSolutionError):
    """A tooth that cannot be trimmed."""

    def __init__(self, what: str, station: float, message: str, excess: float | None = None) -> None:
        super().__init__(reason=message, excess=excess)
        # what: "pointed", "undercut", "flank", "tip" or "edge"; station: t
        self.what, self.station = what, station
        # side of the tooth, "right" or "left"; empty for both
        self.side = ""

    @property
    def surfaces(self) -> tuple[str, ...]:
        """Names of the surfaces that could not be trimmed, with their side if it is known."""
        side = f"_{self.side}" if self.side else ""
        return tuple(f"{surface}{side}" for surface in UNTRIMMED_SURFACES.get(self.what, ("flank",)))


@dataclass(frozen=True)
class Followed(Solution):
    """Points at stations: second parameter v (...,) as `values`, distance (mm) from the station as residual."""

    jet: Jet


def along(surface: Surface, p: Array, stations: Array, axial: Level, start: Array | float = 0.0) -> tuple[Array, Jet]:
    """Return the second parameter v and the jet of points with first parameter p at given station coordinates.

    Shapes broadcast to (...,). Raises TrimError if there is no such point near the start.
    """
    curve = follow(surface, p, stations, axial, start)
    if not curve.converged.all():
        raise TrimError("tip", 0.5, "the tooth surface cannot be followed along the face")
    return curve.values, curve.jet


def follow(surface: Surface, p: Array, stations: Array, axial: Level, start: Array | float = 0.0) -> Followed:
    """Return the points of `along` with a status for each point.

    Newton's method takes one step on rack-generated surfaces, whose station is linear in v. The whole batch is solved
    together; then only unconverged points continue, so that a few points without a solution do not slow down the
    others. On a grid with p evenly spaced along the first axis a few rows are solved first, and the other rows start
    from their interpolation.
    """
    p, stations = broadcast_pair(p, stations)
    if p.ndim == 2 and p.shape[0] > 2 * START_ROWS:
        start = _interpolate(surface, p, stations, axial, start)
    v = np.broadcast_to(np.asarray(start, dtype=float), p.shape)
    scale = 1.0 + float(np.abs(stations).max(initial=0.0))
    # the whole batch first, then only its unconverged points
    v, jet, miss, iterations = _newton_steps(surface, p, stations, axial, v, (scale, MAX_BATCH_STEPS))
    unconverged = ~(np.abs(miss) <= RELATIVE_TOLERANCE * scale)
    if unconverged.any() and iterations == MAX_BATCH_STEPS:
        v[unconverged], _, _, more = _newton_steps(
            surface,
            p[unconverged],
            stations[unconverged],
            axial,
            v[unconverged],
            (scale, MAX_NEWTON_STEPS - MAX_BATCH_STEPS),
        )
        jet, iterations = surface.jet(p, v), iterations + more
        miss = axial.value(jet.r) - stations
    # in addition to the effort of the surface itself
    spend(p.size, iterations, ROOT_STEP)
    residual = np.abs(miss)
    status = np.where(np.isfinite(residual), int(Status.MAX_ITERATIONS), int(Status.NOT_FINITE))
    status = np.where(residual <= RELATIVE_TOLERANCE * scale, int(Status.CONVERGED), status)
    return Followed(v, status, residual, iterations, jet)


def _newton_steps(
    surface: Surface, p: Array, stations: Array, axial: Level, start: Array, limits: tuple[float, int]
) -> tuple[Array, Jet, Array, int]:
    """Return v, jet and distance (...,) from the station after Newton steps from `start`, and the number of steps.

    `limits`: scale of the stations, largest number of steps. v is NaN if there is no step, or if STEPS_PER_HALVING
    steps do not halve the distance.
    """
    scale, max_steps = limits
    v = np.array(start, dtype=float)
    previous_v, previous_size = v, np.full(v.shape, np.inf)
    previous_largest, iterations = np.inf, 0
    while iterations < max_steps:
        iterations += 1
        jet = surface.jet(p, v)
        miss = axial.value(jet.r) - stations
        if iterations % STEPS_PER_HALVING == 0:
            size = np.abs(miss)
            v = np.where((size > RELATIVE_TOLERANCE * scale) & (size > 0.5 * previous_size), np.nan, v)
            previous_size = size
        outside = ~np.isfinite(miss) & ~np.isnan(v)
        if outside.any():
            # the step left the range in which the tool generates: halve it, if there was one
            v = np.where(outside, np.where(v == previous_v, np.nan, 0.5 * (v + previous_v)), v)
            continue
        largest = float(np.fmax.reduce(np.abs(miss).ravel(), initial=0.0))
        # converged to rounding, or no longer improving: the rounding of a cutter much larger than the gear is coarser
        if largest <= 4e-15 * scale or 0.5 * previous_largest < largest <= RELATIVE_TOLERANCE * scale:
            return v, jet, miss, iterations
        previous_largest = largest
        with np.errstate(all="ignore"):
            step = miss / dot(axial.gradient(jet.r), jet.r_v)
        previous_v, v = v, np.where(np.isfinite(step), v - step, np.nan)
        if largest <= 1e-12 * scale or np.array_equal(v, previous_v, equal_nan=True):
            break
    jet = surface.jet(p, v)
    return v, jet, axial.value(jet.r) - stations, iterations


def _interpolate(surface: Surface, p: Array, stations: Array, axial: Level, start: Array | float) -> Array | float:
    """Return start values (S, T) interpolated by polynomials over p from START_ROWS solved rows of a grid.

    Returns `start` if p is not constant along rows or if the rows have no solution.
    """
    first, last = p[:1], p[-1:]
    with np.errstate(all="ignore"):
        place = ((p - first) / (last - first)).mean(axis=1)
    if not np.isfinite(place).all():
        return start
    # rows nearest to Chebyshev points, between which polynomials interpolate well
    rows = np.abs(place[:, None] - 0.5 * (1.0 - np.cos(np.pi * np.linspace(0.0, 1.0, START_ROWS)))).argmin(axis=0)
    if distinct(rows).size < START_ROWS:
        return start
    at = np.broadcast_to(start, p.shape)[rows]
    curve = follow(surface, p[rows], stations[rows], axial, at)
    if not curve.converged.all():
        return start
    known = curve.values
    nodes = place[rows]
    apart = nodes[:, None] - nodes + np.eye(START_ROWS)
    # Lagrange polynomials: products of (x - x_k) / (x_j - x_k) over k other than j
    weights = np.repeat((place[:, None] - nodes)[:, None], START_ROWS, axis=1)
    weights[:, np.arange(START_ROWS), np.arange(START_ROWS)] = 1.0
    lagrange = weights.prod(axis=2) / apart.prod(axis=1)
    result: Array | float = lagrange @ known
    return result
