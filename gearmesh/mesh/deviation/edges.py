"""How far sharp edges of a mesh, chords, are from the exact edges, by the heights of the chords over both surfaces that meet
there.

Across an edge both the exact body and the mesh are wedges between two planes with the normals n1, n2, apart by the vector w
from the exact edge to the chord. With heights h1 = n1 . w and h2 = n2 . w of the chord the distance between both surfaces (of
Hausdorff) is

    max |n . w|   over the unit vectors n between n1 and n2:

|w| where w points into the cone of the normals (or away from it), for then one edge is the closest point of the other; else the
larger height. Where the surfaces pass smoothly into each other it is their height, however far the chord is from the seam along
them; where they meet at an acute angle it is more than either.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.levels import Level, station_normal
from gearmesh.kernel.surface.surface import Surface
from gearmesh.mesh.deviation.facets import ROUNDS, LineHeights, Range, chord_range, limit, over_chord, second_forms
from gearmesh.mesh.deviation.feet import Feet
from gearmesh.mesh.deviation.revolution import drop

Index = NDArray[np.int64]


#: square of the sine of the angle between a surface and a face below which it is no less
STEEPEST = 1e-6
#: mm up to which a point counts as the end of a chord
NO_WAY = 1e-6
#: heights of the parts from x to y (K,), shares of their length, of chords by their numbers (K,)
Measure = Callable[[Index, Array, Array], LineHeights]


@dataclass(frozen=True)
class Chords:
    """Chords whose ends (L, 2, 3), mm, lie on a surface at `parameters` (L, 2, 2), which is turned to where they are by `place`;
    `lengths` (2,) of the surface as those of `Feet`."""

    surface: Surface
    ends: Array
    parameters: Array
    place: Rigid
    lengths: Array

    def measure(self, which: Index, x: Array, y: Array) -> LineHeights:
        """As `Measure`."""
        at = np.stack((x, y, 0.5 * (x + y)), axis=1)[..., None]
        q, guess = (
            ((1.0 - at) * given[which, None, 0] + at * given[which, None, 1]).reshape(-1, given.shape[-1])
            for given in (self.ends, self.parameters)
        )
        # the end that is nearer
        end = (at[..., 0].ravel() > 0.5).astype(int)
        owner = np.repeat(which, 3)
        near = self.parameters[owner, end], np.linalg.norm(q - self.ends[owner, end], axis=1) + NO_WAY
        feet, samples = Feet.of(self.surface, q, guess, near, self.lengths), np.arange(len(q)).reshape(-1, 3)
        along = (y - x)[:, None] * (self.ends[which, 1] - self.ends[which, 0])
        forms, slopes = second_forms(feet, samples, along[:, None])
        second = over_chord(forms[..., 0], slopes[..., 0])
        first, last, middle = feet.heights[samples].T
        normals = self.place.vector(feet.normals[samples[:, 2]])
        return LineHeights(*chord_range(first, last, middle, second), feet.known[samples[:, 2]], normals)


@dataclass(frozen=True)
class FaceChords:
    """Chords between points (L, 2, 3), mm, of an end face, where a level is constant; `outwards`: 1 if it rises out of the body, or
    -1."""

    level: Level
    ends: Array
    outwards: float

    def measure(self, which: Index, x: Array, y: Array) -> LineHeights:
        """As `Measure`; heights are convex or concave along a chord."""
        a, b = self.ends[which, 0], self.ends[which, 1]
        first, last, middle = (a + share[:, None] * (b - a) for share in (x, y, 0.5 * (x + y)))
        station = self.level.value(a)
        one, other, half = (self.outwards * (self.level.value(q) - station) for q in (first, last, middle))
        sag = -self.outwards * station_normal(self.level)[0] * drop(first, last)
        low, high = np.minimum(one, other) + np.minimum(sag, 0.0), np.maximum(one, other) + np.maximum(sag, 0.0)
        return LineHeights(low, high, half, self.outwards * self.level.gradient(middle))


def mirror(measure: Measure) -> Measure:
    """Over the image of a surface in a plane z = const that all chords are in."""
    image = np.array([1.0, 1.0, -1.0])

    def measure_image(which: Index, x: Array, y: Array) -> LineHeights:
        own = measure(which, x, y)
        return replace(own, normals=own.normals * image)

    return measure_image


def in_face(own: Measure, face: Measure) -> Measure:
    """Over the surface square to a face in which all chords are: how far they are from the edge itself, whatever begins there."""

    def measure_in_face(which: Index, x: Array, y: Array) -> LineHeights:
        over, station = own(which, x, y), face(which, x, y)
        cosine = dot(over.normals, station.normals)
        scale = 1.0 / np.sqrt(np.maximum(1.0 - cosine**2, STEEPEST))
        normals = (over.normals - cosine[:, None] * station.normals) * scale[:, None]
        return LineHeights(over.low * scale, over.high * scale, over.middles * scale, normals)

    return measure_in_face


def known(triangles: Index, line: Index, sides: LineHeights, place: Rigid) -> LineHeights:
    """Of the chords between nodes of a line (L + 1,) on the edge of a mesh, what was measured of its triangles' sides."""
    size = int(triangles.max()) + 1
    ends = np.sort(triangles[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2), axis=1)
    wanted = np.sort(np.stack((line[:-1], line[1:]), axis=1), axis=1)
    numbers, asked = (pairs[:, 0] * size + pairs[:, 1] for pairs in (ends, wanted))
    order = np.argsort(numbers, kind="stable")
    which = np.divmod(order[np.searchsorted(numbers[order], asked)], 3)
    return LineHeights(sides.low[which], sides.high[which], sides.middles[which], place.vector(sides.normals[which]))


@dataclass(frozen=True)
class EdgeSide:
    """Chords (L,) over one of the two surfaces of an edge: what is known of the whole ones, and how parts are measured."""

    whole: LineHeights
    measure: Measure


def edge_bounds(one: EdgeSide, other: EdgeSide, sampled: float = 0.0, allowed: float = np.inf) -> tuple[Array, float]:
    """Bounds (L,), mm, of the distance along edges, and the largest distance measured if that is more than `sampled`.

    Chords whose bound is above the `limit` are halved, ROUNDS times at most; then their bounds stay as they are.
    """
    which = np.arange(len(one.whole.middles))
    bounds, x, y = np.zeros(len(which)), np.zeros(len(which)), np.ones(len(which))
    first, second = one.whole, other.whole
    for last in (*(False,) * ROUNDS, True):
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
        first, second = one.measure(which, x, y), other.measure(which, x, y)
    return bounds, sampled


def between_wedges(first: Array, second: Array, cosine: Array) -> Array:
    """Distance (...,), mm, of wedges apart by a vector of heights `first`, `second` (...,); `cosine` of their normals' angle."""
    cos, sin = np.sqrt(np.maximum(0.5 * (1.0 + cosine), 0.0)), np.sqrt(np.maximum(0.5 * (1.0 - cosine), 0.0))
    with np.errstate(all="ignore"):
        along, across = np.abs(0.5 * (first + second) / cos), np.abs(0.5 * (first - second) / sin)
        within = np.hypot(along, np.fmin(across, along * sin / cos))
    return np.fmax(np.maximum(np.abs(first), np.abs(second)), np.where(np.isfinite(within), within, 0.0))


def _largest(first: Range, second: Range, cosine: Array) -> Array:
    """The greatest of `between_wedges` over ranges of the heights: it is convex in them, so that corners tell."""
    corners = [between_wedges(one, other, cosine) for one in first for other in second]
    largest: Array = np.maximum.reduce(corners)
    return largest
