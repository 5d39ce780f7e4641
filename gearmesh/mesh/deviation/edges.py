"""Distances of the chords of a mesh's sharp edges from the exact edges, by the heights of the chords over both surfaces.

In a section across an edge the exact body and the mesh are two equal wedges between planes with normals n1 and n2. The
vector w leads from the exact edge to the chord. With the heights h1 = n1 . w and h2 = n2 . w of the chord, the
Hausdorff distance of the two surfaces is

    max |n . w|   over the unit vectors n between n1 and n2.

It is |w| if w (or -w) points into the cone of the normals, because each edge is then the closest point of the other
body. Otherwise it is the larger height. If the surfaces join smoothly, the distance is the height, however far the
chord is from the seam along the surfaces. If they meet at an acute angle, it is larger than both heights.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.levels import Level, station_normal
from gearmesh.kernel.surface.surface import Surface
from gearmesh.mesh.deviation.facets import MAX_ROUNDS, LineHeights, Range, chord_range, limit, over_chord, second_forms
from gearmesh.mesh.deviation.feet import Feet
from gearmesh.mesh.deviation.revolution import drop
from gearmesh.records import dataclass

Index = NDArray[np.int64]


#: least square of the sine of the angle between a surface and a face; smaller ones count as this
MIN_SINE_SQUARE = 1e-6
#: largest distance of a point from the end of a chord that counts as 0
END_TOLERANCE_MM = 1e-6
#: function of chord numbers, x and y (K,) that returns the heights of the chords' parts from x to y (shares of the length)
Measure = Callable[[Index, Array, Array], LineHeights]


@dataclass(frozen=True)
class Chords:
    """Chords with their ends on a surface."""

    #: the surface, in its own frame
    surface: Surface
    #: ends (L, 2, 3), mm, in the frame of the surface
    ends: Array
    #: parameters (L, 2, 2) of the surface at the ends
    parameters: Array
    #: motion from the frame of the surface to that of the edge
    place: Rigid
    #: (2,) as in `Feet`
    lengths: Array

    def measure(self, which: Index, x: Array, y: Array) -> LineHeights:
        """Return the heights of parts of chords, see `Measure`."""
        at = np.stack((x, y, 0.5 * (x + y)), axis=1)[..., None]
        q, guess = (
            ((1.0 - at) * values[which, None, 0] + at * values[which, None, 1]).reshape(-1, values.shape[-1])
            for values in (self.ends, self.parameters)
        )
        # the nearer end of the chord is another start of the search for the foot
        end = (at[..., 0].ravel() > 0.5).astype(int)
        owner = np.repeat(which, 3)
        near = self.parameters[owner, end], np.linalg.norm(q - self.ends[owner, end], axis=1) + END_TOLERANCE_MM
        feet, samples = Feet.of(self.surface, q, guess, near, self.lengths), np.arange(len(q)).reshape(-1, 3)
        along = (y - x)[:, None] * (self.ends[which, 1] - self.ends[which, 0])
        forms, slopes = second_forms(feet, samples, along[:, None])
        second = over_chord(forms[..., 0], slopes[..., 0])
        first, last, middle = feet.heights[samples].T
        normals = self.place.vector(feet.normals[samples[:, 2]])
        return LineHeights(*chord_range(first, last, middle, second), feet.known[samples[:, 2]], normals)


@dataclass(frozen=True)
class FaceChords:
    """Chords between points of an end face, on which an axial station is constant."""

    #: axial station of points
    level: Level
    #: ends (L, 2, 3), mm
    ends: Array
    #: 1 if the station rises out of the body, else -1
    outwards: float

    def measure(self, which: Index, x: Array, y: Array) -> LineHeights:
        """Return the heights of parts of chords, see `Measure`; they are convex or concave along a chord."""
        a, b = self.ends[which, 0], self.ends[which, 1]
        first, last, middle = (a + share[:, None] * (b - a) for share in (x, y, 0.5 * (x + y)))
        station = self.level.value(a)
        start_height, end_height, half = (
            self.outwards * (self.level.value(q) - station) for q in (first, last, middle)
        )
        sag = -self.outwards * station_normal(self.level)[0] * drop(first, last)
        low = np.minimum(start_height, end_height) + np.minimum(sag, 0.0)
        high = np.maximum(start_height, end_height) + np.maximum(sag, 0.0)
        return LineHeights(low, high, half, self.outwards * self.level.gradient(middle))


def mirror(measure: Measure) -> Measure:
    """Return the measure over the mirror image of a surface in a plane z = const that contains all chords."""
    image = np.array([1.0, 1.0, -1.0])

    def measure_image(which: Index, x: Array, y: Array) -> LineHeights:
        heights = measure(which, x, y)
        return replace(heights, normals=heights.normals * image)

    return measure_image


def in_face(surface: Measure, face: Measure) -> Measure:
    """Return the measure of the distance from an edge within the face that contains all chords, from both measures there."""

    def measure_in_face(which: Index, x: Array, y: Array) -> LineHeights:
        over, station = surface(which, x, y), face(which, x, y)
        cosine = dot(over.normals, station.normals)
        scale = 1.0 / np.sqrt(np.maximum(1.0 - cosine**2, MIN_SINE_SQUARE))
        normals = (over.normals - cosine[:, None] * station.normals) * scale[:, None]
        return LineHeights(over.low * scale, over.high * scale, over.middles * scale, normals)

    return measure_in_face


def known(triangles: Index, line: Index, sides: LineHeights, place: Rigid) -> LineHeights:
    """Return the heights, known from the sides of triangles, of the chords of a line of nodes (L + 1,) on the edge of a mesh."""
    size = int(triangles.max()) + 1
    ends = np.sort(triangles[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2), axis=1)
    wanted = np.sort(np.stack((line[:-1], line[1:]), axis=1), axis=1)
    numbers, asked = (pairs[:, 0] * size + pairs[:, 1] for pairs in (ends, wanted))
    order = np.argsort(numbers, kind="stable")
    which = np.divmod(order[np.searchsorted(numbers[order], asked)], 3)
    return LineHeights(sides.low[which], sides.high[which], sides.middles[which], place.vector(sides.normals[which]))


@dataclass(frozen=True)
class EdgeSide:
    """Chords (L,) over one of the two surfaces of an edge."""

    #: heights of the whole chords
    whole: LineHeights
    #: measure of parts of the chords
    measure: Measure


def edge_bounds(side: EdgeSide, other: EdgeSide, sampled: float = 0.0, allowed: float = np.inf) -> tuple[Array, float]:
    """Return the bounds (L,), mm, of the distances of edges, and the largest of `sampled` and all measured distances, mm.

    Chords with a bound above the `limit` are halved, up to MAX_ROUNDS times; then the remaining bounds are used.
    """
    which = np.arange(len(side.whole.middles))
    bounds, x, y = np.zeros(len(which)), np.zeros(len(which)), np.ones(len(which))
    first, second = side.whole, other.whole
    for last in (*(False,) * MAX_ROUNDS, True):
        cosine = dot(first.normals, second.normals)
        largest = _largest((first.low, first.high), (second.low, second.high), cosine)
        sampled = max(sampled, float(between_wedges(first.middles, second.middles, cosine).max(initial=0.0)))
        open_ = largest > (np.inf if last else limit(sampled, allowed))
        np.maximum.at(bounds, which[~open_], largest[~open_])
        if not open_.any():
            break
        which, x, y = which[open_], x[open_], y[open_]
        middle = 0.5 * (x + y)
        which, x, y = np.tile(which, 2), np.concatenate((x, middle)), np.concatenate((middle, y))
        first, second = side.measure(which, x, y), other.measure(which, x, y)
    return bounds, sampled


def between_wedges(first: Array, second: Array, cosine: Array) -> Array:
    """Return the distance (...,), mm, of equal wedges apart by a vector with heights `first` and `second` (...,), mm.

    `cosine` (...,): cosine of the angle between the normals of the wedge's planes.
    """
    cos, sin = np.sqrt(np.maximum(0.5 * (1.0 + cosine), 0.0)), np.sqrt(np.maximum(0.5 * (1.0 - cosine), 0.0))
    with np.errstate(all="ignore"):
        along, across = np.abs(0.5 * (first + second) / cos), np.abs(0.5 * (first - second) / sin)
        within = np.hypot(along, np.fmin(across, along * sin / cos))
    return np.fmax(np.maximum(np.abs(first), np.abs(second)), np.where(np.isfinite(within), within, 0.0))


def _largest(first: Range, second: Range, cosine: Array) -> Array:
    """Return the largest `between_wedges` over ranges of the heights: it is convex, so its extremes are at the corners."""
    corners = [between_wedges(height, other_height, cosine) for height in first for other_height in second]
    largest: Array = np.maximum.reduce(corners)
    return largest
