"""Limiting lines: tool points that generate singular points of a surface, the first sign of undercut [LF04 17.9].

A tool point generates a singular point where the velocity of contact over the generated surface vanishes:

    v_r + v_12 = r_u du/dt + r_v dv/dt + w = 0   with   d/dt f(u, v, phi) = 0            [LF04 17.9.1, 17.9.2]

The generated surface has no tangent plane there: F(u, v) = (R_u x R_v) . N = 0 [LF04 17.9.3]. This one equation holds
on any surface with an exact jet, for any generating motion. F also changes sign through infinity where a contact line
turns back on the tool (f_phi = 0). Such poles are detected and left out.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearmesh.errors import NoSolutionError
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.numeric.roots import bracketed_root, last_true
from gearmesh.kernel.surface.levels import Level
from gearmesh.kernel.surface.stations import follow
from gearmesh.kernel.surface.surface import GeneratedSurface, Jet, Surface, area_normal
from gearmesh.records import dataclass

#: points at which a line is scanned for changes of sign
SAMPLES_PER_LINE = 65
#: bisections towards the edge of the domain of the function on a line
EDGE_STEPS = 20
#: precision of a singular point, relative to its parameter
RELATIVE_PRECISION = 1e-13
#: pieces in which a line is searched for its first singular point
BLOCKS_PER_LINE = 8
#: points at which such a piece is scanned
SAMPLES_PER_BLOCK = 6

#: values (...,) at parameters x of the lines numbered `row`, both (...,)
LineFunction = Callable[[Array, NDArray[np.intp]], Array]


@dataclass(frozen=True)
class LimitingLine:
    """Tool points that generate singular points, sorted by line v = const, then along the range of p."""

    #: first parameter (K,) of the generated surface, in the tool's unit
    p: Array
    #: second parameter (K,) of the generated surface, in the tool's unit
    v: Array
    #: points (K, 3) of the tool, mm, in the tool frame
    on_tool: Array
    #: singular points (K, 3) of the generated surface, mm, in the blank frame
    on_surface: Array


def limiting_line(
    surface: GeneratedSurface, p_range: tuple[float, float], v_values: Array, samples: int = SAMPLES_PER_LINE
) -> LimitingLine:
    """Return the limiting line of an `Envelope` or `FeedEnvelope`, nested or not, over `p_range` at `v_values` (K,).

    Every line v = const is scanned at `samples` points. Each change of sign between neighbouring points is followed to
    rounding. Parameters for which the tool does not generate are passed over. The arrays are empty if there is no
    singular point.
    """
    v_values = np.atleast_1d(np.asarray(v_values, dtype=float))
    low, high = (np.full_like(v_values, p) for p in p_range)
    row, p = zeros(lambda x, k: area_density(surface.jet(x, v_values[k])), low, high, samples)
    v = v_values[row]
    if not p.size:
        return LimitingLine(p, v, np.zeros((0, 3)), np.zeros((0, 3)))
    # `zeros` returns the regular side of each bracket, where the jet is finite
    return LimitingLine(p, v, surface.tool.jet(*surface.on_tool(p, v)).r, surface.jet(p, v).r)


def singular_at(surface: Surface, p_range: tuple[ArrayLike, ArrayLike], stations: Array, axial: Level) -> Array:
    """Return parameters p (T,) of the singular points nearest to p_range[0] (T,) at each station (T,); NaN without one.

    The search goes from p_range[0], where the surface is regular, to p_range[1] (T,). The returned point lies on the
    regular side.
    """
    stations = np.atleast_1d(np.asarray(stations, dtype=float))
    start, end = (np.broadcast_to(np.asarray(p, dtype=float), stations.shape) for p in p_range)
    singular, active = np.full(stations.shape, np.nan), np.arange(stations.size)
    # in blocks, because points beyond the first singular point are not needed and often harder to compute
    for share in np.arange(BLOCKS_PER_LINE) / BLOCKS_PER_LINE:
        low = start + share * (end - start)
        high = low + (end - start) / BLOCKS_PER_LINE

        def density(x: Array, row: NDArray[np.intp], at: Array = stations[active]) -> Array:
            points = follow(surface, x, at[row], axial)
            return np.where(points.converged, area_density(points.jet), np.nan)

        row, p = zeros(density, low[active], high[active], SAMPLES_PER_BLOCK)
        first, index = np.unique(row, return_index=True)
        singular[active[first]] = p[index]
        active = np.delete(active, first)
        if not active.size:
            break
    return singular


def area_density(jet: Jet) -> Array:
    """Return (r_u x r_v) . n, (...,): the signed area element, 0 at singular points."""
    return dot(area_normal(jet), jet.n)


def zeros(
    function: LineFunction, low: Array, high: Array, samples: int = SAMPLES_PER_LINE
) -> tuple[NDArray[np.intp], Array]:
    """Return line numbers (M,) and parameters (M,) of all sign changes of `function` through 0 in low ... high (K,).

    Poles are left out. Points at which the function is undefined (NaN, NoSolutionError) are passed over. A parameter is
    the end towards `low` of the last bracket, as narrow as rounding allows, or the point itself if the value there is
    exactly 0.
    """
    rows = np.arange(low.size)
    share = np.linspace(0.0, 1.0, samples)[:, None]
    x = low + share * (high - low)
    f = _values(function, x.ravel(), np.broadcast_to(rows, x.shape).ravel()).reshape(x.shape)
    # a sample that is exactly 0 produces no change of sign on either side
    exact = np.nonzero(f == 0.0)
    k, row = np.nonzero(f[:-1] * f[1:] < 0.0)
    first, second = np.stack((x[k, row], f[k, row])), np.stack((x[k + 1, row], f[k + 1, row]))
    # changes of sign between the last sample and the edge of the function's domain
    edge_row, *at_edge = _edges(function, x, f)
    row = np.concatenate((row, edge_row))
    first, second = (np.concatenate(pair, axis=1) for pair in zip((first, second), at_edge, strict=True))
    if not row.size:
        return exact[1], x[exact]
    roots = bracketed_root(
        lambda at, k: _values(function, at, row[k]), first[0], second[0], relative=RELATIVE_PRECISION
    )
    row = np.concatenate((row[roots.converged], exact[1]))
    at = np.concatenate((roots.before[roots.converged], x[exact]))
    order = np.lexsort(((at - low[row]) / (high - low)[row], row))
    return row[order], at[order]


def _edges(function: LineFunction, x: Array, f: Array) -> tuple[NDArray[np.intp], Array, Array]:
    """Return changes of sign between samples f (S, K) at x and the edge of the function's domain.

    The result is the line numbers (M,) and the (parameter, value) (2, M) at both ends of each change, in the order of
    the line.
    """
    defined = np.isfinite(f)
    k, row = np.nonzero(defined[:-1] != defined[1:])
    inner = np.where(defined[k, row], k, k + 1)
    inside, outside = x[inner, row], x[2 * k + 1 - inner, row]
    if k.size:
        edge_of = row
        inside, _ = last_true(
            lambda at, k: np.isfinite(_values(function, at, edge_of[k])), inside, outside, rounds=EDGE_STEPS
        )
    value = _values(function, inside, row) if k.size else np.zeros(0)
    change = np.flatnonzero(value * f[inner, row] < 0.0)
    k, row, inner = k[change], row[change], inner[change]
    sample, edge = np.stack((x[inner, row], f[inner, row])), np.stack((inside[change], value[change]))
    forward = inner == k
    return row, np.where(forward, sample, edge), np.where(forward, edge, sample)


def _values(function: LineFunction, x: Array, row: NDArray[np.intp]) -> Array:
    """Return values (M,), NaN where undefined. A batch that fails is halved until the failing members are alone."""
    try:
        with np.errstate(all="ignore"):
            return function(x, row)
    except NoSolutionError:
        if x.size == 1:
            return np.full(1, np.nan)
        half = x.size // 2
        return np.concatenate((_values(function, x[:half], row[:half]), _values(function, x[half:], row[half:])))
