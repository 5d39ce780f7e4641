"""How far facets are from the exact surface that their corners lie on: upper bounds, and the largest distance measured.

The signed distance h(q) of a facet's point q from a smooth surface has the normal n at its foot r = q - h n as gradient, and
the second form there as Hessian: with dq = dr + h dn + n dh, along a vector w of the facet

    w . dn(w),   where dn = a_i n_i   and   (r_i . r_j + h n_i . r_j) a_i = w . r_j,

exactly, whatever the parameters u_i of the surface are [do Carmo, Differential Geometry of Curves and Surfaces, 3.5 ex. 11:
parallel surfaces]. A jet has both. With H(y) the Hessian at the places y of a triangle with corners x_i, Taylor's formula about
any place x = sum l_i x_i gives (the gradient drops out, since sum l_i (x_i - x) = 0)

    h(x) = sum l_i h(x_i) - sum l_i int_0^1 (1 - s) H(x + s (x_i - x)) [x_i - x] ds,

so that where low <= H <= up as quadratic forms all over the triangle

    sum l_i h_i - 1/2 sum_ij l_i l_j up[x_i - x_j] <= h(x) <= sum l_i h_i - 1/2 sum_ij l_i l_j low[x_i - x_j]    (i < j).

Both sides are quadratic in l and have their extremes in closed form. h and H are measured at the corners, at the middles of the
edges and at the centre; the formula is applied to the four quarters of the triangle, between the measured h, with low and up of
the whole. What it rests on, and all it rests on: that H leaves the range of the seven measured ones by no more than MARGIN of
their largest difference from the mean. Forms are compared in the affine frame in which the triangle is equilateral, so that
long thin triangles along a ruling are judged by what counts.

Where the surface is singular (an involute at its base circle) H has no bound. There the gradient has: with |(n(y) - g) . (x_i -
x_j)| <= R_ij for some vector g, h differs from sum l_i h_i by at most 2 sum_ij l_i l_j R_ij. The better of both bounds is
taken.

Triangles whose bound is above CLOSE times the largest distance measured are cut into their quarters, which are measured as they
were: so the bound is proved by subdivision where curvature changes much over a triangle. After ROUNDS of that what is still above
stays as it is: a bound all the same, only less close.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.surface import Surface
from gearmesh.mesh.deviation.feet import FLOOR, PAIRS, Feet

Index = NDArray[np.int64]
#: least and greatest of something
Range = tuple[Array, Array]

#: share of the largest difference between a measured second form (or normal) and the mean by which it may be larger elsewhere
MARGIN = 0.5
#: bounds above so many times the largest distance measured are looked into, where they are above what is allowed those above the
#: smaller one
CLOSE, CLOSEST = 1.1, 1.01
#: and at most so often
ROUNDS = 6
#: facets measured at once: as many as stay in the cache
BLOCK = 4_000


@dataclass(frozen=True)
class LineHeights:
    """Of straight lines: least (`low`) and greatest (`high`) heights over a surface, mm, those of their middles, all (...,), and
    the surface's `normals` there (..., 3)."""

    low: Array
    high: Array
    middles: Array
    normals: Array


@dataclass(frozen=True)
class FacetBounds:
    """Upper bounds (M,) of the distances of facets from a surface, mm, the largest distance `sampled`, mm.

    `sides` (M, 3): their edges, of which number k is opposite to corner k; `lengths` (2,) of the surface there, as those of `Feet`.
    """

    bounds: Array
    sampled: float
    sides: LineHeights
    lengths: Array

    @property
    def largest(self) -> float:
        """The largest bound, mm."""
        return float(self.bounds.max(initial=0.0))


def limit(sampled: float, allowed: float) -> float:
    """The bound (mm) that is good enough where so much was measured, and so much is allowed."""
    return max(min(CLOSE * sampled, allowed), CLOSEST * sampled, FLOOR)


def facet_bounds(
    surface: Surface,
    parameters: Array,
    points: Array,
    triangles: Index,
    sampled: float = 0.0,
    allowed: float = np.inf,
) -> FacetBounds:
    """Of facets (M, 3) between points (N, 3) that lie on a surface at its `parameters` (N, 2), mm.

    `sampled`: the largest distance measured elsewhere, which is returned if none is larger; bounds need not be close where they are
    below it. `allowed`: where more is measured than fits under it the bounds are as close as can be.
    """
    every, measured, lengths = np.arange(len(triangles)), list[_Measured](), None
    for start in range(0, len(triangles), BLOCK):
        used, corners = np.unique(triangles[start : start + BLOCK], return_inverse=True)
        owner = every[start : start + BLOCK]
        facets = _Facets(points[used], parameters[used], corners.reshape(-1, 3), owner)
        measured.append(_Measured.of(surface, facets, lengths))
        lengths = measured[0].feet.lengths
        sampled = max(sampled, measured[-1].feet.largest)
    sides, bounds = _join([part.sides for part in measured]), np.zeros(len(triangles))
    for last in (*(False,) * ROUNDS, True):
        open_ = [part.bounds > (np.inf if last else limit(sampled, allowed)) for part in measured]
        for part, again in zip(measured, open_, strict=True):
            np.maximum.at(bounds, part.facets.owner[~again], part.bounds[~again])
        finer = [part.quarters(again) for part, again in zip(measured, open_, strict=True) if again.any()]
        if not finer:
            break
        measured = [_Measured.of(surface, facets, lengths) for facets in finer]
        sampled = max(sampled, *(part.feet.largest for part in measured))
    return FacetBounds(bounds, sampled, sides, np.ones(2) if lengths is None else lengths)


@dataclass(frozen=True)
class _Facets:
    """Facets (M, 3) between points (N, 3), parameters (N, 2) of the surface near these, and whose parts they are, `owner` (M,)."""

    points: Array
    parameters: Array
    corners: Index
    owner: Index


@dataclass(frozen=True)
class _Measured:
    """Facets with what was measured at their corners, the middles of their edges and their centres."""

    facets: _Facets
    bounds: Array
    sides: LineHeights
    points: Array
    feet: Feet
    edges: Index

    @staticmethod
    def of(surface: Surface, facets: _Facets, lengths: Array | None) -> _Measured:
        q, corners = facets.points, facets.corners
        low, high = np.moveaxis(np.sort(corners[:, [[1, 2], [2, 0], [0, 1]]], axis=-1), -1, 0)
        numbers, side = np.unique(low * len(q) + high, return_inverse=True)
        ends = np.stack(np.divmod(numbers, len(q)), axis=-1)
        middles, guesses = (
            np.concatenate((given[ends].mean(axis=1), given[corners].mean(axis=1))) for given in (q, facets.parameters)
        )
        points = np.concatenate((q, middles))
        # a corner of each edge and facet, to which it is no farther than this
        corner = np.concatenate((np.arange(len(q)), ends[:, 0], corners[:, 0]))
        reach = np.linalg.norm(points - q[corner], axis=1)
        reach[: len(q)] = np.inf
        near = facets.parameters[corner], reach
        feet = Feet.of(surface, points, np.concatenate((facets.parameters, guesses)), near, lengths)
        edges = len(q) + side.reshape(-1, 3)
        at = np.column_stack((corners, edges, len(q) + len(ends) + np.arange(len(corners))))
        along = np.roll(q[corners], 1, axis=1) - np.roll(q[corners], -1, axis=1)
        forms, slopes = second_forms(feet, at, along)
        low, up = over_triangle(forms, slopes)
        heights = feet.heights[at]
        quarters = heights[:, _QUARTERS]
        bounds = np.maximum(
            _peak(quarters, -0.25 * low[:, None]).max(axis=1), _peak(-quarters, 0.25 * up[:, None]).max(axis=1)
        )
        bounds = np.maximum(np.where(np.isnan(bounds), np.inf, bounds), np.abs(heights).max(axis=1))
        on_edge, edge = np.array([(1, 2, 3), (2, 0, 4), (0, 1, 5)]).T, np.arange(3)
        along_edges = over_chord(forms[:, on_edge, edge], slopes[:, on_edge, edge])
        first, last = heights[:, on_edge[0]], heights[:, on_edge[1]]
        sides = LineHeights(
            *chord_range(first, last, heights[:, 3:6], along_edges), feet.known[edges], feet.normals[edges]
        )
        return _Measured(facets, bounds, sides, points, feet, edges)

    def quarters(self, chosen: NDArray[np.bool_]) -> _Facets:
        """The quarters of some facets (M,)."""
        at = np.column_stack((self.facets.corners, self.edges))[chosen]
        used, corners = np.unique(at[:, _QUARTERS], return_inverse=True)
        owner = np.repeat(self.facets.owner[chosen], len(_QUARTERS))
        return _Facets(self.points[used], self.feet.parameters[used], corners.reshape(-1, 3), owner)


#: corners of the quarters of a triangle with corners 0, 1, 2 and middles 3, 4, 5 of the edges opposite to these, so that the edge
#: opposite to each of them runs along the triangle's opposite to the corner of the same place
_QUARTERS = np.array([(0, 5, 4), (5, 1, 3), (4, 3, 2), (3, 4, 5)])


def second_forms(feet: Feet, at: Index, along: Array) -> tuple[Array, Array]:
    """Second derivatives of heights, mm, and slopes, mm, along edges (M, E, 3) at samples `at` (M, S): (M, S, E) each."""
    factors = np.empty((len(at), len(PAIRS), along.shape[1]))
    for k, (i, j) in enumerate(PAIRS):
        factors[:, k] = (1.0 if i == j else 2.0) * along[:, :, i] * along[:, :, j]
    with np.errstate(all="ignore"):
        return feet.changes[at] @ factors, feet.normals[at] @ np.swapaxes(along, 1, 2)


def over_triangle(forms: Array, slopes: Array) -> Range:
    """Least and greatest second derivatives (M, 3), mm, of heights along edges of triangles by samples (M, S, 3) all over these."""
    with np.errstate(all="ignore"):
        mean = forms.mean(axis=1)
        away = forms - mean[:, None]
        # half the trace, and the distance of the eigenvalues from it, where the triangle is equilateral
        trace = away.mean(axis=2)
        spread = np.sqrt(2.0 / 3.0 * ((away - trace[..., None]) ** 2).sum(axis=2))
        more, less = ((1.0 + MARGIN) * part.max(axis=1)[:, None] for part in (trace + spread, spread - trace))
        tilt = _by_slopes(slopes)
        tame = np.maximum(np.abs(mean - less), np.abs(mean + more)).max(axis=1) <= tilt.max(axis=1)
    return np.where(tame[:, None], mean - less, -tilt), np.where(tame[:, None], mean + more, tilt)


def over_chord(forms: Array, slopes: Array) -> Range:
    """Least and greatest second derivatives (M, E), mm, of heights along edges by samples (M, S, E) on them."""
    with np.errstate(all="ignore"):
        mean = forms.mean(axis=1)
        more, less = ((1.0 + MARGIN) * part.max(axis=1) for part in (forms - mean[:, None], mean[:, None] - forms))
        tilt = _by_slopes(slopes)
        tame = np.maximum(np.abs(mean - less), np.abs(mean + more)) <= tilt
    return np.where(tame, mean - less, -tilt), np.where(tame, mean + more, tilt)


def _by_slopes(slopes: Array) -> Array:
    """Second derivatives (M, E), mm, that lead to the bound by slopes (M, S, E)."""
    tilt: Array = 8.0 * (1.0 + MARGIN) * np.abs(slopes - slopes.mean(axis=1, keepdims=True)).max(axis=1)
    return tilt


def _peak(values: Array, bend: Array) -> Array:
    """Greatest value (...,) over triangles of sum l_i v_i + 1/2 sum_ij l_i l_j bend_k, of values and bends (..., 3); k is neither
    i nor j."""
    values, bend = np.broadcast_arrays(values, bend)
    (v0, v1, v2), (k0, k1, k2) = np.moveaxis(values, -1, 0), np.moveaxis(bend, -1, 0)
    greatest = np.maximum(np.maximum(highest(v1, v2, k0), highest(v2, v0, k1)), highest(v0, v1, k2))
    a, b, c = v1 - v0 + 0.5 * k2, v2 - v0 + 0.5 * k1, 0.5 * (k1 + k2 - k0)
    with np.errstate(all="ignore"):
        area = k1 * k2 - c**2
        x, y = (a * k1 - b * c) / area, (b * k2 - a * c) / area
        inside = (k1 > 0.0) & (area > 0.0) & (x > 0.0) & (y > 0.0) & (x + y < 1.0)
        return np.where(inside, np.maximum(greatest, v0 + 0.5 * (a * x + b * y)), greatest)


def highest(first: Array, last: Array, bend: Array) -> Array:
    """Greatest value (...,) of (1 - x) first + x last + bend x (1 - x) / 2, x from 0 to 1."""
    rise = last - first
    with np.errstate(all="ignore"):
        inside = 0.5 * (first + last) + 0.125 * bend + 0.5 * rise**2 / bend
    return np.where(bend > 2.0 * np.abs(rise), inside, np.maximum(first, last))


def chord_range(first: Array, last: Array, middle: Array, second: Range) -> Range:
    """Least and greatest heights (...,) along chords by those of both ends and middle, and the range of the second derivative."""
    low, high = second
    greatest = np.maximum(highest(first, middle, -0.25 * low), highest(middle, last, -0.25 * low))
    return -np.maximum(highest(-first, -middle, 0.25 * high), highest(-middle, -last, 0.25 * high)), greatest


def _join(sides: list[LineHeights]) -> LineHeights:
    if len(sides) == 1:
        return sides[0]
    return LineHeights(
        *(np.concatenate([getattr(part, field.name) for part in sides]) for field in fields(LineHeights))
    )
