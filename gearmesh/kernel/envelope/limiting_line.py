"""Limiting lines: where a tool that generates a surface makes it singular, the warning of undercut [LF04 17.9].

A point of the tool generates a singular point where the velocity of contact over the generated surface vanishes,

    v_r + v_12 = r_u du/dt + r_v dv/dt + w = 0   with   d/dt f(u, v, phi) = 0            [LF04 17.9.1, 17.9.2]

which is where the generated surface has no tangent plane left, (R_u x R_v) . N = 0: one equation F(u, v) = 0 [LF04 17.9.3]
on any surface with an exact jet, whatever motions generate it. It changes sign there, and also where a contact line
turns back on the tool (f_phi = 0), through infinity: such places are detected and omitted.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearmesh.errors import NoSolutionError
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.numeric.roots import bracketed_root, last_true
from gearmesh.kernel.surface.levels import Level
from gearmesh.kernel.surface.stations import follow
from gearmesh.kernel.surface.surface import GeneratedSurface, Jet, Surface, area_normal

#: points of a scan along a line for changes of sign
SAMPLES = 65
#: bisections towards the edge of where a line is defined
EDGE_STEPS = 20
#: share of its parameter to which a singular point is found
PRECISION = 1e-13
#: pieces in which a line is searched for its first singular point, and points of each
BLOCKS, BLOCK_SAMPLES = 8, 6

#: Values (...,) at parameters x of the lines numbered `row`, both (...,)
LineFunction = Callable[[Array, NDArray[np.intp]], Array]


@dataclass(frozen=True)
class LimitingLine:
    """Tool points that generate singular points: parameters p, v (K,) of the generated surface, mm or rad as the tool's.

    `on_tool`: points (K, 3) of the tool, in its frame; `on_surface`: the singular points (K, 3), in the blank's. Sorted
    by line of constant v, then from the beginning of the range of p to its end.
    """

    p: Array
    v: Array
    on_tool: Array
    on_surface: Array


def limiting_line(
    surface: GeneratedSurface, p_range: tuple[float, float], v_values: Array, samples: int = SAMPLES
) -> LimitingLine:
    """Limiting line of a generated surface (an `Envelope`, nested ones, a `FeedEnvelope`) over `p_range` at `v_values` (K,).

    Every change of sign between neighbours of `samples` points of each line v = const is followed to rounding. Empty arrays
    where there is none. Parameters for which the tool does not generate are passed over.
    """
    v_values = np.atleast_1d(np.asarray(v_values, dtype=float))
    low, high = (np.full_like(v_values, p) for p in p_range)
    row, p = zeros(lambda x, k: area_density(surface.jet(x, v_values[k])), low, high, samples)
    v = v_values[row]
    if not p.size:
        return LimitingLine(p, v, np.zeros((0, 3)), np.zeros((0, 3)))
    # the generation itself is regular where a pole of its partials is not, on the side that `zeros` hands out
    return LimitingLine(p, v, surface.tool.jet(*surface.on_tool(p, v)).r, surface.jet(p, v).r)


def singular_at(surface: Surface, p_range: tuple[ArrayLike, ArrayLike], stations: Array, axial: Level) -> Array:
    """Parameter p (T,) of the singular point nearest to p_range[0] (T,) at each station (T,), NaN where there is none.

    The search goes from p_range[0], where the surface is sound, to p_range[1] (T,); the answer lies on the sound side.
    """
    stations = np.atleast_1d(np.asarray(stations, dtype=float))
    start, end = (np.broadcast_to(np.asarray(p, dtype=float), stations.shape) for p in p_range)
    singular, active = np.full(stations.shape, np.nan), np.arange(stations.size)
    # in blocks: what lies beyond the answer need not be computed, and is often harder to
    for share in np.arange(BLOCKS) / BLOCKS:
        low = start + share * (end - start)
        high = low + (end - start) / BLOCKS

        def density(x: Array, row: NDArray[np.intp], at: Array = stations[active]) -> Array:
            points = follow(surface, x, at[row], axial)
            return np.where(points.converged, area_density(points.jet), np.nan)

        row, p = zeros(density, low[active], high[active], BLOCK_SAMPLES)
        first, index = np.unique(row, return_index=True)
        singular[active[first]] = p[index]
        active = np.delete(active, first)
        if not active.size:
            break
    return singular


def area_density(jet: Jet) -> Array:
    """(r_u x r_v) . n, (...,): the area element, signed; 0 at singular points."""
    return dot(area_normal(jet), jet.n)


def zeros(function: LineFunction, low: Array, high: Array, samples: int = SAMPLES) -> tuple[NDArray[np.intp], Array]:
    """Numbers (M,) of lines and parameters (M,) of all sign changes through 0 of `function` between low and high (K,).

    Poles are left out, places where the function is not defined (NaN, NoSolutionError) passed over. Of the last bracket,
    as narrow as rounding allows, the end towards `low` is returned, unless the value is exactly 0 inside it.
    """
    rows = np.arange(low.size)
    share = np.linspace(0.0, 1.0, samples)[:, None]
    x = low + share * (high - low)
    f = _values(function, x.ravel(), np.broadcast_to(rows, x.shape).ravel()).reshape(x.shape)
    # a sample that is 0 to the last digit would hide between two changes of sign
    exact = np.nonzero(f == 0.0)
    k, row = np.nonzero(f[:-1] * f[1:] < 0.0)
    first, second = np.stack((x[k, row], f[k, row])), np.stack((x[k + 1, row], f[k + 1, row]))
    edge_row, *at_edge = _edges(function, x, f)
    row = np.concatenate((row, edge_row))
    first, second = (np.concatenate(pair, axis=1) for pair in zip((first, second), at_edge, strict=True))
    if not row.size:
        return exact[1], x[exact]
    roots = bracketed_root(lambda at, k: _values(function, at, row[k]), first[0], second[0], relative=PRECISION)
    row = np.concatenate((row[roots.converged], exact[1]))
    at = np.concatenate((roots.before[roots.converged], x[exact]))
    order = np.lexsort(((at - low[row]) / (high - low)[row], row))
    return row[order], at[order]


def _edges(function: LineFunction, x: Array, f: Array) -> tuple[NDArray[np.intp], Array, Array]:
    """Changes of sign between samples f (S, K) at x and the edge of where the function is defined.

    Lines (M,) and (parameter, value) (2, M) of either end, in the order of the line.
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
    """Values (M,), NaN where the function has none; a batch that fails is halved until the failing members are alone."""
    try:
        with np.errstate(all="ignore"):
            return function(x, row)
    except NoSolutionError:
        if x.size == 1:
            return np.full(1, np.nan)
        half = x.size // 2
        return np.concatenate((_values(function, x[:half], row[:half]), _values(function, x[half:], row[half:])))
