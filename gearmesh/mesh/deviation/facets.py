"""Upper bounds of the distances of facets from the exact surface through their corners, and the largest distance measured.

Let h(q) be the signed distance of a point q of a facet from a smooth surface. Its gradient is the normal n at the foot
r = q - h n; its Hessian is the second form there. With dq = dr + h dn + n dh, along a vector w of the facet it is

    w . dn(w),   with   dn = a_i n_i   and   (r_i . r_j + h n_i . r_j) a_i = w . r_j,

exactly, for any parameters u_i of the surface [do Carmo, Differential Geometry of Curves and Surfaces, 3.5 ex. 11: parallel
surfaces]. Both follow from a jet. Let H(y) be the Hessian at places y of a triangle with corners x_i. Taylor's formula about a
place x = sum l_i x_i gives (the gradient drops out, because sum l_i (x_i - x) = 0)

    h(x) = sum l_i h(x_i) - sum l_i int_0^1 (1 - s) H(x + s (x_i - x)) [x_i - x] ds.

If low <= H <= up as quadratic forms all over the triangle, it follows that

    sum l_i h_i - 1/2 sum_ij l_i l_j up[x_i - x_j] <= h(x) <= sum l_i h_i - 1/2 sum_ij l_i l_j low[x_i - x_j]    (i < j).

Both sides are quadratic in l, with extremes in closed form. h and H are measured at the corners, at the middles of the edges
and at the centre. The formula is applied to the four quarters of the triangle with their measured h, and with low and up of
the whole triangle. It rests on one assumption: H leaves the range of the seven measured values by no more than
VARIATION_MARGIN of their largest difference from the mean. Forms are compared in the affine frame in which the triangle is
equilateral, so that long thin triangles along a ruling are judged correctly.

Where the surface is singular (an involute at its base circle), H has no bound, but the gradient has. With
|(n(y) - g) . (x_i - x_j)| <= R_ij for some vector g, h differs from sum l_i h_i by at most 2 sum_ij l_i l_j R_ij. The smaller
of both bounds is taken.

Triangles with a bound above CLOSE_BOUND_RATIO times the largest measured distance are cut into quarters, which are
measured in the same way. Subdivision proves the bound where the curvature changes much over a triangle. After
MAX_ROUNDS subdivisions the remaining bound is used as it stands.
"""

from __future__ import annotations

from dataclasses import fields

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.surface import Surface
from gearmesh.mesh.deviation.feet import MATRIX_PAIRS, ROUNDING_MM, Feet
from gearmesh.records import dataclass

Index = NDArray[np.int64]
#: least and greatest values
Range = tuple[Array, Array]

#: assumed excess of a second form (or normal) over the measured ones, as a share of their largest difference from the mean
VARIATION_MARGIN = 0.5
#: bound over the largest measured distance above which a facet is subdivided
CLOSE_BOUND_RATIO = 1.1
#: the same for bounds above the allowed distance
CLOSEST_BOUND_RATIO = 1.01
#: largest number of subdivisions
MAX_ROUNDS = 6
#: facets measured at once, so that their arrays stay in the cache
FACETS_PER_BLOCK = 4_000


@dataclass(frozen=True)
class LineHeights:
    """Heights of straight lines over a surface."""

    #: least heights (...,), mm
    low: Array
    #: greatest heights (...,), mm
    high: Array
    #: heights (...,), mm, of the middles
    middles: Array
    #: normals (..., 3) of the surface near the middles
    normals: Array


@dataclass(frozen=True)
class FacetBounds:
    """Bounds of the distances of facets from a surface."""

    #: upper bounds (M,), mm
    bounds: Array
    #: largest measured distance, mm
    sampled: float
    #: heights of the edges (M, 3); edge k is opposite to corner k
    sides: LineHeights
    #: (2,) of the surface, as in `Feet`
    lengths: Array

    @property
    def largest(self) -> float:
        """Largest bound, mm."""
        return float(self.bounds.max(initial=0.0))


def limit(sampled: float, allowed: float) -> float:
    """Return the bound, mm, above which facets are subdivided, by the largest measured and the allowed distance, mm."""
    return max(min(CLOSE_BOUND_RATIO * sampled, allowed), CLOSEST_BOUND_RATIO * sampled, ROUNDING_MM)


def facet_bounds(
    surface: Surface,
    parameters: Array,
    points: Array,
    triangles: Index,
    sampled: float = 0.0,
    allowed: float = np.inf,
) -> FacetBounds:
    """Return the bounds of facets between points on a surface.

    - parameters: parameters (N, 2) of the surface at the points.
    - points: (N, 3), mm.
    - triangles: (M, 3).
    - sampled: largest distance, mm, measured elsewhere; bounds below it are not refined.
    - allowed: allowed distance, mm; bounds above it are refined as far as possible.
    """
    every, measured, lengths = np.arange(len(triangles)), list[_Measured](), None
    for start in range(0, len(triangles), FACETS_PER_BLOCK):
        used, corners = np.unique(triangles[start : start + FACETS_PER_BLOCK], return_inverse=True)
        owner = every[start : start + FACETS_PER_BLOCK]
        facets = _Facets(points[used], parameters[used], corners.reshape(-1, 3), owner)
        measured.append(_Measured.of(surface, facets, lengths))
        lengths = measured[0].feet.lengths
        sampled = max(sampled, measured[-1].feet.largest)
    sides, bounds = _join([part.sides for part in measured]), np.zeros(len(triangles))
    for last in (*(False,) * MAX_ROUNDS, True):
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
    """Facets, or parts of facets."""

    #: (N, 3), mm
    points: Array
    #: parameters (N, 2) of the surface near the points
    parameters: Array
    #: corners (M, 3)
    corners: Index
    #: facet (M,) that each part belongs to
    owner: Index


@dataclass(frozen=True)
class _Measured:
    """Facets measured at their corners, the middles of their edges and their centres."""

    #: the facets
    facets: _Facets
    #: bounds (M,), mm
    bounds: Array
    #: heights of the edges (M, 3)
    sides: LineHeights
    #: corners, middles of edges and centres, mm
    points: Array
    #: feet of these points
    feet: Feet
    #: indices (M, 3) in `points` of the middles of the edges
    edges: Index

    @staticmethod
    def of(surface: Surface, facets: _Facets, lengths: Array | None) -> _Measured:
        """Return the measured facets; `lengths` (2,) as in `Feet.of`."""
        q, corners = facets.points, facets.corners
        low, high = np.moveaxis(np.sort(corners[:, [[1, 2], [2, 0], [0, 1]]], axis=-1), -1, 0)
        numbers, side = np.unique(low * len(q) + high, return_inverse=True)
        ends = np.stack(np.divmod(numbers, len(q)), axis=-1)
        middles, guesses = (
            np.concatenate((values[ends].mean(axis=1), values[corners].mean(axis=1)))
            for values in (q, facets.parameters)
        )
        points = np.concatenate((q, middles))
        # second start of the search for feet: a corner of the edge or facet, and its distance
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
        quarters = heights[:, _QUARTER_CORNERS]
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
        """Return the quarters of the `chosen` (M,) facets."""
        at = np.column_stack((self.facets.corners, self.edges))[chosen]
        used, corners = np.unique(at[:, _QUARTER_CORNERS], return_inverse=True)
        owner = np.repeat(self.facets.owner[chosen], len(_QUARTER_CORNERS))
        return _Facets(self.points[used], self.feet.parameters[used], corners.reshape(-1, 3), owner)


#: corners of the quarters of a triangle with corners 0, 1, 2 and middles 3, 4, 5 of the opposite edges; edge k of a quarter is
#: parallel to edge k of the triangle
_QUARTER_CORNERS = np.array([(0, 5, 4), (5, 1, 3), (4, 3, 2), (3, 4, 5)])


def second_forms(feet: Feet, at: Index, along: Array) -> tuple[Array, Array]:
    """Return second derivatives and slopes (M, S, E), mm, of the heights along edges (M, E, 3), at samples `at` (M, S)."""
    factors = np.empty((len(at), len(MATRIX_PAIRS), along.shape[1]))
    for k, (i, j) in enumerate(MATRIX_PAIRS):
        factors[:, k] = (1.0 if i == j else 2.0) * along[:, :, i] * along[:, :, j]
    with np.errstate(all="ignore"):
        return feet.changes[at] @ factors, feet.normals[at] @ np.swapaxes(along, 1, 2)


def over_triangle(forms: Array, slopes: Array) -> Range:
    """Return least and greatest second derivatives (M, 3), mm, along the edges, from samples (M, S, 3) all over triangles."""
    with np.errstate(all="ignore"):
        mean = forms.mean(axis=1)
        away = forms - mean[:, None]
        # in the frame in which the triangle is equilateral: half the trace, and the distance of the eigenvalues from it
        trace = away.mean(axis=2)
        spread = np.sqrt(2.0 / 3.0 * ((away - trace[..., None]) ** 2).sum(axis=2))
        more, less = ((1.0 + VARIATION_MARGIN) * part.max(axis=1)[:, None] for part in (trace + spread, spread - trace))
        tilt = _by_slopes(slopes)
        tame = np.maximum(np.abs(mean - less), np.abs(mean + more)).max(axis=1) <= tilt.max(axis=1)
    return np.where(tame[:, None], mean - less, -tilt), np.where(tame[:, None], mean + more, tilt)


def over_chord(forms: Array, slopes: Array) -> Range:
    """Return least and greatest second derivatives (M, E), mm, along edges, from samples (M, S, E) on the edges."""
    with np.errstate(all="ignore"):
        mean = forms.mean(axis=1)
        more, less = (
            (1.0 + VARIATION_MARGIN) * part.max(axis=1) for part in (forms - mean[:, None], mean[:, None] - forms)
        )
        tilt = _by_slopes(slopes)
        tame = np.maximum(np.abs(mean - less), np.abs(mean + more)) <= tilt
    return np.where(tame, mean - less, -tilt), np.where(tame, mean + more, tilt)


def _by_slopes(slopes: Array) -> Array:
    """Return second derivatives (M, E), mm, that give the same bound as the slopes (M, S, E) do."""
    tilt: Array = 8.0 * (1.0 + VARIATION_MARGIN) * np.abs(slopes - slopes.mean(axis=1, keepdims=True)).max(axis=1)
    return tilt


def _peak(values: Array, bend: Array) -> Array:
    """Return the greatest value (...,) over a triangle of sum l_i v_i + 1/2 sum_ij l_i l_j bend_k, with k neither i nor j.

    values, bend: (..., 3).
    """
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
    """Return the greatest value (...,) of (1 - x) first + x last + bend x (1 - x) / 2 for x from 0 to 1."""
    rise = last - first
    with np.errstate(all="ignore"):
        inside = 0.5 * (first + last) + 0.125 * bend + 0.5 * rise**2 / bend
    return np.where(bend > 2.0 * np.abs(rise), inside, np.maximum(first, last))


def chord_range(first: Array, last: Array, middle: Array, second: Range) -> Range:
    """Return least and greatest heights (...,) along chords, by the heights of ends and middle and the second derivatives."""
    low, high = second
    greatest = np.maximum(highest(first, middle, -0.25 * low), highest(middle, last, -0.25 * low))
    return -np.maximum(highest(-first, -middle, 0.25 * high), highest(-middle, -last, 0.25 * high)), greatest


def _join(sides: list[LineHeights]) -> LineHeights:
    """Return several sets of lines as one."""
    if len(sides) == 1:
        return sides[0]
    return LineHeights(
        *(np.concatenate([getattr(part, field.name) for part in sides]) for field in fields(LineHeights))
    )
