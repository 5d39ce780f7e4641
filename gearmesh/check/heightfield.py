"""Flanks as height fields: circles about an axis, or rays, intersected with a triangle mesh or an exact grid.

A `HeightChart` splits space into two flat coordinates (a, b) and a height, so that a flank is a function height(a, b):

    Arcs: a = rho, b = z, height = +-theta     circles about the z axis (how far may a body turn?)
    Slides: a = x, b = z, height = +-y         lines along the y axis (how far may a body slide?)
    Rays: a = x,   b = y, height = z           straight lines along z   (how far apart are two bodies?)

Arcs cross the *plane* of a triangle in closed form, so a mesh is treated exactly as a polyhedron. Interpolation of
theta between the vertices would be wrong by the size of the facets' deviation, because straight chords are curved in
(rho, z, theta). A structured grid of exact points is treated as the bicubic spline through the points.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Protocol, Self, TypeAlias

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import DesignError
from gearmesh.kernel.motion.joint import Joint
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, cross, distinct, dot, plane_cross, polar_angle, unit
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.records import dataclass

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

#: closes the cracks between neighbouring triangles; rounding is about 1e-12 for the thinnest facets
BARYCENTRIC_SLACK = 1e-9
#: margin of the half planes that hold a triangle, as a share of the size of the triangle
SIDE_MARGIN_SHARE = 1e-6
#: residual of the flat coordinates at which Newton's method on a grid ends
GRID_RESIDUAL_MM = 1e-11
#: Newton steps on a grid; nearly tangent lines, at a root or a rounded tip, gain a factor of 4 per step
MAX_GRID_STEPS = 24
#: step along the rim below which a place beyond the rim is given up, in cells
RESTING_STEP_CELLS = 1e-3
#: a grid has two sheets if its lines turn the other way by more than this share of the largest turning
SHEET_TOLERANCE = 1e-9
#: limit of the bins in either direction
MAX_BINS = 200
#: triangles are halved for the bins while their boxes exceed the whole divided by this in both directions
PIECES_PER_EXTENT = 24
#: limit of these halvings
MAX_HALVINGS = 14


#: arrays of one length, a quantity each: faster than rows of several quantities
Columns: TypeAlias = tuple[Array, ...]


class HeightChart(Protocol):
    """Two flat coordinates and a height, in the chart's own frame; mm, but rad for heights of `Arcs` and `Slides`."""

    def split(self, r: Array) -> tuple[Array, Array]:
        """Return flat coordinates (..., 2) and heights (...,) of points (..., 3)."""

    def join(self, flat: Array, height: Array) -> Array:
        """Return points (..., 3) from flat coordinates and heights."""

    def rate(self, r: Array, dr: Array) -> Array:
        """Return the change (..., 2) of the flat coordinates when points (..., 3) move by dr (..., 3)."""

    def uphill(self, r: Array) -> Array:
        """Return unit directions (..., 3) of increasing height."""

    def planes(self, normal: Array, offset: Array, near: Array) -> Columns:
        """Return what `plane_height` needs of the planes normal . r = offset on the branch of `near` (T, 3), (T,) each."""

    def plane_height(self, flat: Columns, planes: Columns) -> Array:
        """Return heights (N,) of planes over flat coordinates, (N,) each."""

    def lowest(self, corners: Array) -> Array:
        """Return lower bounds (T, 2) of the flat coordinates over triangles (T, 3, 3); upper bounds are corners."""

    def bulge(self, corners: Array) -> Array:
        """Return how far (T,) the first flat coordinate on triangles (T, 3, 3) may be below its interpolation between corners."""


@dataclass(frozen=True)
class Arcs:
    """Circles about z: flat (rho, z), height `sense` * theta, with theta within half a turn of `reference` (rad)."""

    sense: float
    reference: float

    def split(self, r: Array) -> tuple[Array, Array]:
        flat = np.stack((np.hypot(r[..., 0], r[..., 1]), r[..., 2]), axis=-1)
        return flat, self._height(polar_angle(r))

    def join(self, flat: Array, height: Array) -> Array:
        theta, rho = self.sense * height, flat[..., 0]
        return np.stack((rho * np.cos(theta), rho * np.sin(theta), flat[..., 1]), axis=-1)

    def rate(self, r: Array, dr: Array) -> Array:
        rho = np.hypot(r[..., 0], r[..., 1])
        return np.stack(((r[..., 0] * dr[..., 0] + r[..., 1] * dr[..., 1]) / rho, dr[..., 2]), axis=-1)

    def uphill(self, r: Array) -> Array:
        rho = np.hypot(r[..., 0], r[..., 1])
        return self.sense * np.stack((-r[..., 1] / rho, r[..., 0] / rho, np.zeros_like(rho)), axis=-1)

    def planes(self, normal: Array, offset: Array, near: Array) -> Columns:
        middle = polar_angle(normal)
        side = np.sign(_wrap(polar_angle(near) - middle))
        return middle, side, np.hypot(normal[..., 0], normal[..., 1]), normal[..., 2], offset

    def plane_height(self, flat: Columns, planes: Columns) -> Array:
        # solve |n_xy| rho cos(theta - direction of n_xy) = offset - n_z z, with the root on the side of `near`
        (rho, z), (middle, side, level, n_z, offset) = flat, planes
        half = np.arccos((offset - n_z * z) / (rho * level))
        return self._height(middle + side * half)

    def lowest(self, corners: Array) -> Array:
        # the smallest rho may lie between the ends of an edge
        start, end = corners[..., :2], np.roll(corners, -1, axis=1)[..., :2]
        edge = end - start
        (x, y), (dx, dy) = np.moveaxis(start, -1, 0), np.moveaxis(edge, -1, 0)
        square = np.maximum(dx * dx + dy * dy, np.finfo(float).tiny)
        along = np.clip(-(x * dx + y * dy) / square, 0.0, 1.0)
        x, y = x + along * dx, y + along * dy
        return np.stack((_least(np.sqrt(x * x + y * y)), _least(corners[..., 2])), axis=-1)

    def bulge(self, corners: Array) -> Array:
        # second derivatives of rho are at most 1 / rho, and a triangle is in a circle of radius L / sqrt(3)
        edge = (corners - np.roll(corners, -1, axis=1))[..., :2]
        with np.errstate(divide="ignore"):
            return _greatest((edge * edge).sum(axis=-1)) / (6.0 * self.lowest(corners)[:, 0])

    def slope(self, r: Array, normal: Array) -> Array:
        """Return derivatives of the height by (rho, z), (..., 2) in rad/mm, of surfaces with `normal` at r (..., 3)."""
        rho = np.hypot(r[..., 0], r[..., 1])
        outward = (r[..., 0] * normal[..., 0] + r[..., 1] * normal[..., 1]) / rho
        return -np.stack((outward, normal[..., 2]), axis=-1) / (rho * dot(normal, self.uphill(r)))[..., None]

    def arm(self, r: Array) -> Array:
        """Return the displacement in mm per rad of the height."""
        radius: Array = np.hypot(r[..., 0], r[..., 1])
        return radius

    def _height(self, theta: Array) -> Array:
        return self.sense * (self.reference + _wrap(theta - self.reference))


@dataclass(frozen=True)
class Slides:
    """Straight lines along y: flat (x, z), height `sense` * y / `radius`; the `Arcs` of a sliding member."""

    sense: float
    radius: float

    def split(self, r: Array) -> tuple[Array, Array]:
        return r[..., ::2], self.sense * r[..., 1] / self.radius

    def join(self, flat: Array, height: Array) -> Array:
        return np.stack((flat[..., 0], self.sense * self.radius * height, flat[..., 1]), axis=-1)

    def rate(self, r: Array, dr: Array) -> Array:
        return dr[..., ::2]

    def uphill(self, r: Array) -> Array:
        return np.broadcast_to(np.array([0.0, self.sense, 0.0]), r.shape)

    def planes(self, normal: Array, offset: Array, near: Array) -> Columns:
        return normal[..., 0], normal[..., 1], normal[..., 2], offset

    def plane_height(self, flat: Columns, planes: Columns) -> Array:
        (x, z), (n_x, n_y, n_z, offset) = flat, planes
        height: Array = self.sense * ((offset - n_x * x - n_z * z) / n_y) / self.radius
        return height

    def lowest(self, corners: Array) -> Array:
        corner: Array = corners[..., ::2].min(axis=1)
        return corner

    def bulge(self, corners: Array) -> Array:
        return np.zeros(len(corners))

    def slope(self, r: Array, normal: Array) -> Array:
        """Return derivatives of the height by (x, z), (..., 2) in rad/mm, of surfaces with `normal` at r (..., 3)."""
        return -normal[..., ::2] / (self.radius * self.sense * normal[..., 1])[..., None]

    def arm(self, r: Array) -> Array:
        """Return the displacement in mm per rad of the height."""
        return np.full(r.shape[:-1], self.radius)


#: charts over the paths in which a joint moves points
Ways: TypeAlias = Arcs | Slides


def along(joint: Joint, sense: float, reference: float) -> Ways:
    """Return the chart over the paths in which a joint moves points."""
    return Arcs(sense, reference) if joint.travel is None else Slides(sense, joint.travel)


@dataclass(frozen=True)
class Rays:
    """Lines along z: flat (x, y), height z."""

    def split(self, r: Array) -> tuple[Array, Array]:
        return r[..., :2], r[..., 2]

    def join(self, flat: Array, height: Array) -> Array:
        return np.concatenate((flat, height[..., None]), axis=-1)

    def rate(self, r: Array, dr: Array) -> Array:
        return dr[..., :2]

    def uphill(self, r: Array) -> Array:
        return np.broadcast_to(np.array([0.0, 0.0, 1.0]), r.shape)

    def planes(self, normal: Array, offset: Array, near: Array) -> Columns:
        return normal[..., 0], normal[..., 1], normal[..., 2], offset

    def plane_height(self, flat: Columns, planes: Columns) -> Array:
        (x, y), (n_x, n_y, n_z, offset) = flat, planes
        height: Array = (offset - n_x * x - n_y * y) / n_z
        return height

    def lowest(self, corners: Array) -> Array:
        corner: Array = corners[..., :2].min(axis=1)
        return corner

    def bulge(self, corners: Array) -> Array:
        return np.zeros(len(corners))


@dataclass(frozen=True)
class Hits:
    """Intersections of the lines of a chart with a flank; NaN where a line misses the flank.

    Points and normals are in the chart's frame. Normals point uphill, for any orientation of the triangles.
    """

    #: height (N,)
    height: Array
    #: point (N, 3), mm
    point: Array
    #: unit normal (N, 3)
    normal: Array
    #: number (N,) of the intersected part of a flank of several parts
    part: NDArray[np.int64]

    def __getitem__(self, which: NDArray[np.bool_]) -> Hits:
        return Hits(self.height[which], self.point[which], self.normal[which], self.part[which])

    def better(self, other: Hits, side: float) -> Hits:
        """Return the higher (`side` +1) or lower (-1) of two hits per place, or the only hit.

        This object's hit is returned if both are equal.
        """
        with np.errstate(invalid="ignore"):
            swap = np.isnan(self.height) | (side * other.height > side * self.height)
        swap &= np.isfinite(other.height)
        rows = swap[:, None]
        return Hits(
            np.where(swap, other.height, self.height),
            np.where(rows, other.point, self.point),
            np.where(rows, other.normal, self.normal),
            np.where(swap, other.part, self.part),
        )


@dataclass(frozen=True)
class RimPlaces:
    """Places on the rim of a flank."""

    #: flat coordinates (N, 2)
    flat: Array
    #: derivative (N, 2) of the flat coordinates by the share of the segment
    rate: Array
    #: hits at the places
    hits: Hits


class Field(Protocol):
    """A flank over a chart."""

    @property
    def box(self) -> Array:
        """Smallest and largest flat coordinates, (2, 2)."""

    @property
    def smooth(self) -> bool:
        """True if heights are smooth inside the rims of the flank; False for facets."""

    @property
    def rim_segments(self) -> int:
        """Number of segments of the rim; the rim is smooth within a segment."""

    def rim(self, segment: NDArray[np.int64], share: Array) -> RimPlaces:
        """Return exact places on the rim at shares (N,) of segments (N,); shares may leave 0 .. 1 slightly."""

    def at(self, flat: Array) -> Hits:
        """Return hits over flat coordinates (N, 2)."""


class HeightFlank(Protocol):
    """A tooth flank in its member's own frame."""

    @property
    def points(self) -> Array:
        """Points (K, 3) of the flank that indicate its position."""

    def over(self, chart: HeightChart, own_to_chart: Rigid, side: float) -> Field:
        """Return the flank as a height field; the highest (`side` +1) or the lowest (-1) of several hits counts."""

    def between(self, low: float, high: float) -> Self | None:
        """Return the part of the flank between two z (mm), slightly extended; None if there is none."""


def as_flank(source: TriangleMesh | Array | HeightFlank) -> HeightFlank:
    """Return a flank from a triangle mesh or a structured grid of exact points (I, J, 3); keep a flank as it is."""
    if isinstance(source, TriangleMesh):
        return MeshFlank(source.corners())
    if isinstance(source, np.ndarray):
        return GridFlank(source)
    return source


@dataclass(frozen=True)
class MeshFlank:
    """Triangles (T, 3, 3), mm, in the member's frame; the order of triangles and corners does not matter."""

    corners: Array

    def __post_init__(self) -> None:
        if self.corners.shape[0] == 0 or not np.isfinite(self.corners).all():
            raise DesignError("triangles", self.corners.shape[0], allowed="1 or more, with finite corners")

    @property
    def points(self) -> Array:
        return self.corners.reshape(-1, 3)

    @cached_property
    def rim(self) -> NDArray[np.int64]:
        """Triangle and first corner (R, 2) of each edge that belongs to one triangle only.

        Ends of edges are identified by their coordinates.
        """
        # sorted column by column: numpy compares rows ten times as slowly
        order = np.lexsort(self.points.T)
        vertex = np.empty(len(order), dtype=np.int64)
        vertex[order] = np.cumsum(np.append(False, (np.diff(self.points[order], axis=0) != 0.0).any(axis=1)))
        start, end = vertex, np.roll(vertex.reshape(-1, 3), -1, axis=1).ravel()
        edge = np.minimum(start, end) * len(order) + np.maximum(start, end)
        order = np.argsort(edge)
        differs = np.concatenate(([True], np.diff(edge[order]) != 0, [True]))
        alone = np.sort(order[differs[1:] & differs[:-1]])
        return np.stack((alone // 3, alone % 3), axis=-1)

    def between(self, low: float, high: float) -> Self | None:
        corners = _above(_above(self.corners, low, 1.0), high, -1.0)
        return replace(self, corners=corners) if len(corners) else None

    def over(self, chart: HeightChart, own_to_chart: Rigid, side: float) -> Field:
        return MeshField(chart, own_to_chart.point(self.corners), side, self)


@dataclass(frozen=True)
class MeshField:
    """Triangles in the chart's frame, sorted into bins over the flat coordinates."""

    #: chart of the field
    chart: HeightChart
    #: triangles (T, 3, 3) in the chart's frame
    corners: Array
    #: +1 if the highest of several hits counts, -1 if the lowest
    side: float
    #: the flank in its member's frame
    flank: MeshFlank
    #: False, as facets have edges
    smooth: bool = False

    @cached_property
    def _pieces(self) -> tuple[Array, NDArray[np.int64]]:
        """Pieces (K, 3, 3) of the triangles, and the number (K,) of the triangle of each piece.

        Long oblique triangles are halved until they fit their boxes.
        """
        pieces, whose, small = self.corners, np.arange(len(self.corners)), list[tuple[Array, NDArray[np.int64]]]()
        flat = self.chart.split(pieces)[0]
        large = np.ptp(flat.reshape(-1, 2), axis=0) / PIECES_PER_EXTENT
        for _ in range(MAX_HALVINGS):
            x, y = np.moveaxis(self.chart.split(pieces)[0], -1, 0)
            much = (_greatest(x) - _least(x) > large[0]) & (_greatest(y) - _least(y) > large[1])
            if not much.any():
                break
            # small pieces are complete; large pieces are halved
            small.append((pieces[~much], whose[~much]))
            halved = _halve(pieces[much])
            pieces, whose = np.concatenate(halved), np.concatenate([whose[much]] * len(halved))
        small.append((pieces, whose))
        return np.concatenate([own for own, _ in small]), np.concatenate([own for _, own in small])

    @cached_property
    def _bounds(self) -> tuple[Array, Array]:
        return self._boxes(self.corners)

    def _boxes(self, triangles: Array) -> tuple[Array, Array]:
        """Return smallest and largest flat coordinates (K, 2) over triangles (K, 3, 3)."""
        x, y = np.moveaxis(self.chart.split(triangles)[0], -1, 0)
        return self.chart.lowest(triangles), np.stack((_greatest(x), _greatest(y)), axis=-1)

    @cached_property
    def _sides(self) -> Array:
        """Half planes over the flat coordinates that hold a triangle: per side, factors (3, 3, T) of x, y and 1, >= 0 inside.

        Sides of a triangle may bend over the flat coordinates: half planes have a margin for this, and for rounding.
        """
        low, high = self._bounds
        flat = self.chart.split(self.corners)[0]
        start, edge = flat, np.roll(flat, -1, axis=1) - flat
        length = np.hypot(edge[..., 0], edge[..., 1])
        factors = np.stack((-edge[..., 1], edge[..., 0])) / np.where(length > 0.0, length, 1.0)
        third = np.roll(flat, -2, axis=1) - start
        factors *= np.where(factors[0] * third[..., 0] + factors[1] * third[..., 1] < 0.0, -1.0, 1.0)
        rounding = SIDE_MARGIN_SHARE * (high - low).sum(axis=-1) + 1e-9 * (high.max(axis=0) - low.min(axis=0)).sum()
        margin = np.abs(factors[0]) * self.chart.bulge(self.corners)[:, None] + rounding[:, None]
        # a triangle at the axis may bulge without limit
        margin = np.where(np.isfinite(margin), margin, np.inf)
        within = margin - factors[0] * start[..., 0] - factors[1] * start[..., 1]
        return np.ascontiguousarray(np.concatenate((factors, within[None])).transpose(2, 0, 1))

    @cached_property
    def _planes(self) -> Columns:
        """The planes of the triangles for the chart, (T,) each."""
        normal = self._area_vectors
        with np.errstate(all="ignore"):  # a triangle without area is never hit
            return self.chart.planes(normal, dot(normal, self.corners[:, 0]), self.corners.mean(axis=1))

    @cached_property
    def _area_vectors(self) -> Array:
        a, b, c = np.moveaxis(self.corners, 1, 0)
        return cross(b - a, c - a)

    @cached_property
    def _duals(self) -> Array:
        """Vectors (2, T, 3) whose products with r - corner 0 are the weights of corners 1 and 2."""
        a, b, c = np.moveaxis(self.corners, 1, 0)
        normal = self._area_vectors
        with np.errstate(all="ignore"):  # a triangle without area is never hit
            return np.stack((cross(c - a, normal), cross(normal, b - a))) / dot(normal, normal)[:, None]

    @cached_property
    def _bins(self) -> _Bins:
        pieces, whose = self._pieces
        return _Bins.of(*self._boxes(pieces), whose)

    @property
    def box(self) -> Array:
        low, high = self._bounds
        return np.stack((low.min(axis=0), high.max(axis=0)))

    @property
    def rim_segments(self) -> int:
        return len(self.flank.rim)

    def rim(self, segment: NDArray[np.int64], share: Array) -> RimPlaces:
        triangle, corner = self.flank.rim[segment].T
        start, end = self.corners[triangle, corner], self.corners[triangle, (corner + 1) % 3]
        point = start + share[:, None] * (end - start)
        flat, height = self.chart.split(point)
        normal = _uphill(self.chart, point, self._area_vectors[triangle])
        hits = Hits(height, point, normal, np.zeros(len(share), dtype=np.int64))
        return RimPlaces(flat, self.chart.rate(point, end - start), hits)

    def at(self, flat: Array) -> Hits:
        query, triangle = self._bins.pairs(flat)
        # side by side, which is faster than along a short last axis
        x, y = np.ascontiguousarray(flat.T)
        for by_x, by_y, within in self._sides:
            near = by_x[triangle] * x[query] + by_y[triangle] * y[query] + within[triangle] >= 0.0
            query, triangle = query[near], triangle[near]

        # queries whose line may meet a triangle, with what belongs to the triangle alone looked up
        here = flat[query]
        with np.errstate(all="ignore"):  # lines that run along a plane or miss it
            planes = tuple(column[triangle] for column in self._planes)
            height = self.chart.plane_height((here[:, 0], here[:, 1]), planes)
            point = self.chart.join(here, height)
            off_corner = point - self.corners[triangle, 0]
            weight_1, weight_2 = (dot(dual[triangle], off_corner) for dual in self._duals)
            hit = (
                (weight_1 >= -BARYCENTRIC_SLACK)
                & (weight_2 >= -BARYCENTRIC_SLACK)
                & (weight_1 + weight_2 <= 1.0 + BARYCENTRIC_SLACK)
            )
        query, triangle, height, point = query[hit], triangle[hit], height[hit], point[hit]
        best = first_highest(query, self.side * height)
        hits = _misses(len(flat))
        hits.height[query[best]] = height[best]
        hits.point[query[best]] = point[best]
        hits.normal[query[best]] = _uphill(self.chart, point[best], self._area_vectors[triangle[best]])
        return hits


def _above(triangles: Array, level: float, way: float) -> Array:
    """Return the parts of triangles (T, 3, 3) above the plane z = `level`, or below it (`way` -1), as triangles."""
    height = way * (triangles[..., 2] - level)
    inside = height >= 0.0
    count = inside.sum(axis=1)
    cut = (count == 1) | (count == 2)
    # corner a is alone on its side of the plane: the part is its tip, or the rest as two triangles
    alone = np.where(count == 1, inside.argmax(axis=1), inside.argmin(axis=1))[cut]
    order = (alone[:, None] + np.arange(3)) % 3
    a, b, c = np.moveaxis(np.take_along_axis(triangles[cut], order[..., None], axis=1), 1, 0)
    ab, ac = _at_level(a, b, level), _at_level(a, c, level)
    single_corner = (count == 1)[cut]
    tips = np.stack((a, ab, ac), axis=1)[single_corner]
    rests = [np.stack(corners, axis=1)[~single_corner] for corners in ((ab, b, c), (ab, c, ac))]
    return np.concatenate((triangles[count == 3], tips, *rests))


def _at_level(a: Array, b: Array, level: float) -> Array:
    """Return the points where edges from a to b (N, 3) cross z = `level`.

    Edges from b to a give the same points to the last digit.
    """
    swap = (a[:, 2] > b[:, 2])[:, None]
    low, high = np.where(swap, b, a), np.where(swap, a, b)
    point: Array = low + ((level - low[:, 2]) / (high[:, 2] - low[:, 2]))[:, None] * (high - low)
    point[:, 2] = level
    return point


def _least(values: Array) -> Array:
    """Return the smallest of three values each, (T, 3)."""
    return np.minimum(np.minimum(values[:, 0], values[:, 1]), values[:, 2])


def _greatest(values: Array) -> Array:
    """Return the largest of three values each, (T, 3)."""
    return np.maximum(np.maximum(values[:, 0], values[:, 1]), values[:, 2])


def _halve(triangles: Array) -> tuple[Array, Array]:
    """Return both halves of triangles (T, 3, 3), cut across their longest edges."""
    side = np.roll(triangles, -1, axis=1) - triangles
    length = np.sqrt(dot(side, side))
    order = (length.argmax(axis=1)[:, None] + np.arange(3)) % 3
    a, b, c = np.moveaxis(np.take_along_axis(triangles, order[..., None], axis=1), 1, 0)
    middle = 0.5 * (a + b)
    return np.stack((a, middle, c), axis=1), np.stack((middle, b, c), axis=1)


@dataclass(frozen=True)
class _Bins:
    """Triangles in a rectangular grid of bins, by the boxes of their pieces.

    Bin k holds members[start[k] : start[k + 1]].
    """

    #: corner (2,) of the grid, in flat coordinates
    origin: Array
    #: size (2,) of a bin
    size: Array
    #: number (2,) of bins in either direction
    shape: NDArray[np.int64]
    #: index in `members` at which each bin begins
    start: NDArray[np.int64]
    #: numbers of the triangles, bin after bin
    members: NDArray[np.int64]

    @staticmethod
    def of(low: Array, high: Array, whose: NDArray[np.int64]) -> _Bins:
        """Return bins of about the average size of the boxes `low` to `high` (K, 2).

        The boxes belong to pieces of the triangles `whose` (K,).
        """
        origin, extent = low.min(axis=0), high.max(axis=0) - low.min(axis=0)
        average = np.maximum((high - low).mean(axis=0), extent / MAX_BINS)
        shape = np.maximum(np.ceil(extent / np.maximum(average, np.finfo(float).tiny)), 1.0).astype(np.int64)
        size = np.maximum(extent / shape, np.finfo(float).tiny)
        margin = 1e-6 * size
        first = np.clip(np.floor((low - margin - origin) / size).astype(np.int64), 0, shape - 1)
        last = np.clip(np.floor((high + margin - origin) / size).astype(np.int64), 0, shape - 1)
        span = last - first + 1
        box, step = _expand(span.prod(axis=1))
        cell = first[box] + np.stack((step // span[box, 1], step % span[box, 1]), axis=-1)
        # an oblique triangle with many pieces in a bin is entered once
        count = int(whose.max(initial=0)) + 1
        key, member = np.divmod(distinct((cell[:, 0] * shape[1] + cell[:, 1]) * count + whose[box]), count)
        start = np.concatenate(([0], np.cumsum(np.bincount(key, minlength=int(shape.prod())))))
        return _Bins(origin, size, shape, start, member)

    def pairs(self, flat: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return indices of queries `flat` (N, 2), and of the triangles in their bins."""
        place = (flat - self.origin) / self.size
        within = (place >= -1e-6) & (place <= self.shape + 1e-6)
        inside = within[:, 0] & within[:, 1]
        cell = np.clip(np.where(inside[:, None], place, 0.0).astype(np.int64), 0, self.shape - 1)
        key = cell[:, 0] * self.shape[1] + cell[:, 1]
        query, step = _expand(np.where(inside, self.start[key + 1] - self.start[key], 0))
        return query, self.members[self.start[key[query]] + step]


@dataclass(frozen=True)
class GridFlank:
    """Bicubic spline over the indices of structured exact points."""

    #: points (I, J, 3), mm, in the member's frame; I and J are at least 4
    grid: Array
    #: polynomials (I - 1, J - 1, 4, 4, 3) of the cells, for a part of a larger grid that keeps the larger grid's spline
    cells: Array | None = None

    def __post_init__(self) -> None:
        if self.grid.ndim != 3 or self.grid.shape[-1] != 3 or min(self.grid.shape[:2]) < 4:
            raise DesignError(
                "grid", reason=f"has shape {self.grid.shape}", allowed="(I, J, 3) with I and J at least 4"
            )
        if not np.isfinite(self.grid).all():
            raise DesignError("grid", reason="has coordinates that are not finite")

    @property
    def points(self) -> Array:
        return self.grid.reshape(-1, 3)

    @property
    def last(self) -> Array:
        """Largest indices, (2,)."""
        return np.array(self.grid.shape[:2], dtype=float) - 1.0

    @cached_property
    def _coefficients(self) -> Array:
        """Polynomials (I - 1, J - 1, 4, 4, 3) of the cells, highest powers first."""
        from scipy.interpolate import CubicSpline

        if self.cells is not None:
            return self.cells
        along_i = CubicSpline(np.arange(self.grid.shape[0]), self.grid, axis=0).c
        along_j = CubicSpline(np.arange(self.grid.shape[1]), along_i, axis=2).c
        return np.ascontiguousarray(np.transpose(along_j, (3, 1, 2, 0, 4)))

    def jet(self, index: Array) -> tuple[Array, Array, Array]:
        """Return points and their partial derivatives (N, 3) at fractional indices (N, 2)."""
        cell = np.clip(index.astype(np.int64), 0, np.array(self._coefficients.shape[:2]) - 1)
        along_i, along_j = np.moveaxis(np.stack(_powers(index - cell), axis=-2), 1, 0)
        # contract over i for value and slope at once, then over j
        over_i = along_i @ self._coefficients[cell[:, 0], cell[:, 1]].reshape(-1, 4, 12)
        over_i = over_i.reshape(-1, 2, 4, 3)
        at_place = along_j @ over_i[:, 0]
        return at_place[:, 0], (along_j[:, None, 0] @ over_i[:, 1])[:, 0], at_place[:, 1]

    @cached_property
    def nodes(self) -> tuple[Array, Array, Array]:
        """Points of the grid and their partial derivatives, (I J, 3) each."""
        shape = self.grid.shape[:2]
        return self.jet(np.stack(np.unravel_index(np.arange(shape[0] * shape[1]), shape), axis=-1).astype(float))

    def between(self, low: float, high: float) -> Self | None:
        z = self.grid[..., 2]
        inside = np.flatnonzero((z.max(axis=0) >= low) & (z.min(axis=0) <= high))
        if not inside.size:
            return None
        # one cell more, and at least the four lines that a spline needs
        first, last = max(int(inside[0]) - 1, 0), min(int(inside[-1]) + 1, z.shape[1] - 1)
        first = max(min(first, last - 3), 0)
        end = max(last, first + 3)
        return replace(self, grid=self.grid[:, first : end + 1], cells=self._coefficients[:, first:end])

    def over(self, chart: HeightChart, own_to_chart: Rigid, side: float) -> Field:
        return GridField(chart, self, own_to_chart, side)


@dataclass(frozen=True)
class GridField:
    """A grid over a chart: Newton's method finds indices over flat coordinates from the nearest grid point.

    The grid has two sheets if lines of the chart are tangent to it. Each sheet is intersected separately, and the
    better hit counts.
    """

    #: chart of the field
    chart: HeightChart
    #: the flank in its member's frame
    flank: GridFlank
    #: transform from the member's frame to the chart's frame
    own_to_chart: Rigid
    #: +1 if the highest of several hits counts, -1 if the lowest
    side: float
    #: True, as a spline is smooth
    smooth: bool = True

    @cached_property
    def _sheets(self) -> list[tuple[cKDTree, NDArray[np.intp]]]:
        """Search trees of the grid points of every sheet over the flat coordinates, and the numbers of the points."""
        from scipy.spatial import cKDTree

        own, own_i, own_j = self.flank.nodes
        point = self.own_to_chart.point(own)
        flat = self.chart.split(point)[0]
        # the sign of the area element over the flat coordinates tells the sheets apart
        turning = plane_cross(
            self.chart.rate(point, self.own_to_chart.vector(own_i)),
            self.chart.rate(point, self.own_to_chart.vector(own_j)),
        )
        slack = SHEET_TOLERANCE * np.abs(turning).max()
        sheets = [np.flatnonzero(sign * turning >= -slack) for sign in (1.0, -1.0)]
        whole = [sheet for sheet in sheets if len(sheet) == len(flat)]
        return [(cKDTree(flat[sheet]), sheet) for sheet in whole[:1] or sheets]

    @cached_property
    def _longest(self) -> float:
        """Longest diagonal of a cell over the flat coordinates, mm."""
        flat = self.chart.split(self.own_to_chart.point(self.flank.grid))[0]
        diagonals = (flat[1:, 1:] - flat[:-1, :-1], flat[1:, :-1] - flat[:-1, 1:])
        return float(max(np.linalg.norm(d, axis=-1).max() for d in diagonals))

    @property
    def box(self) -> Array:
        trees = [tree for tree, _ in self._sheets]
        return np.stack((np.min([t.mins for t in trees], axis=0), np.max([t.maxes for t in trees], axis=0)))

    @property
    def rim_segments(self) -> int:
        return int(2.0 * self.flank.last.sum())

    def rim(self, segment: NDArray[np.int64], share: Array) -> RimPlaces:
        last_i, last_j = self.flank.last
        along = segment + share
        ends = np.cumsum([last_i, last_j, last_i, last_j])
        where = [segment < end for end in ends]
        zero = np.zeros_like(along)
        index = np.stack(
            (
                np.select(where, [along, zero + last_i, ends[2] - along, zero]),
                np.select(where, [zero, along - ends[0], zero + last_j, ends[3] - along]),
            ),
            axis=-1,
        )
        own, own_i, own_j = self.flank.jet(index)
        point = self.own_to_chart.point(own)
        r_i, r_j = self.own_to_chart.vector(own_i), self.own_to_chart.vector(own_j)
        onward = np.select([w[:, None] for w in where], [r_i, r_j, -r_i, -r_j])
        flat, height = self.chart.split(point)
        hits = Hits(height, point, _uphill(self.chart, point, cross(r_i, r_j)), np.zeros(len(share), dtype=np.int64))
        return RimPlaces(flat, self.chart.rate(point, onward), hits)

    def at(self, flat: Array) -> Hits:
        first, *rest = [self._from(tree, nodes, flat) for tree, nodes in self._sheets]
        for other in rest:
            first = first.better(other, self.side)
        return first

    def _from(self, tree: cKDTree, nodes: NDArray[np.intp], flat: Array) -> Hits:
        """Return hits found from the nearest of the grid points numbered `nodes`."""
        distance, nearest = tree.query(flat)
        index = np.stack(np.unravel_index(nodes[nearest], self.flank.grid.shape[:2]), axis=-1).astype(float)
        hits = _misses(len(flat))
        # a place in a cell is no farther from the nearest corner than the longest diagonal
        todo = np.flatnonzero(distance <= self._longest)
        for _ in range(MAX_GRID_STEPS):
            if todo.size == 0:
                break
            own, own_i, own_j = self.flank.jet(index[todo])
            point = self.own_to_chart.point(own)
            r_i, r_j = self.own_to_chart.vector(own_i), self.own_to_chart.vector(own_j)
            here, height = self.chart.split(point)
            residual = flat[todo] - here
            met = np.abs(residual).max(axis=-1) <= GRID_RESIDUAL_MM
            done = todo[met]
            hits.height[done], hits.point[done] = height[met], point[met]
            hits.normal[done] = _uphill(self.chart, point[met], cross(r_i[met], r_j[met]))
            wanted = index[todo] + np.clip(
                _solve(self.chart.rate(point, r_i), self.chart.rate(point, r_j), residual), -5.0, 5.0
            )
            # a place beyond the rim comes to rest on the rim with a residual: this is a miss
            moved = np.clip(wanted, 0.0, self.flank.last)
            resting = (moved != wanted).any(axis=-1) & (np.abs(moved - index[todo]) < RESTING_STEP_CELLS).all(axis=-1)
            going = ~met & ~resting & (moved != index[todo]).any(axis=-1) & np.isfinite(moved).all(axis=-1)
            index[todo[going]] = moved[going]
            todo = todo[going]
        return hits


@dataclass(frozen=True)
class PatchedFlank:
    """Several flanks in one frame as one flank: the links of a tooth, or the parts of a link between two corners."""

    patches: tuple[HeightFlank, ...]

    @property
    def points(self) -> Array:
        return np.concatenate([patch.points for patch in self.patches])

    def between(self, low: float, high: float) -> Self | None:
        parts = self.parts_between(low, high)
        return replace(self, patches=tuple(parts.values())) if parts else None

    def parts_between(self, low: float, high: float) -> dict[int, HeightFlank]:
        """Return the parts of the patches between two z (mm), slightly extended, by patch numbers."""
        return {k: part for k, patch in enumerate(self.patches) if (part := patch.between(low, high)) is not None}

    def over(self, chart: HeightChart, own_to_chart: Rigid, side: float) -> Field:
        return PatchedField(tuple(patch.over(chart, own_to_chart, side) for patch in self.patches), side)


@dataclass(frozen=True)
class PatchedField:
    """Several fields over one chart: the better of several hits counts, and the rim contains the rims of all fields."""

    fields: tuple[Field, ...]
    side: float

    @cached_property
    def _boxes(self) -> Array:
        """Boxes (K, 2, 2) of the fields, slightly extended."""
        boxes = np.stack([field.box for field in self.fields])
        margin = 1e-3 * (boxes[:, 1] - boxes[:, 0]) + GRID_RESIDUAL_MM
        return boxes + np.stack((-margin, margin), axis=1)

    @property
    def box(self) -> Array:
        boxes = np.stack([field.box for field in self.fields])
        return np.stack((boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)))

    @property
    def smooth(self) -> bool:
        return all(field.smooth for field in self.fields)

    @cached_property
    def _first(self) -> NDArray[np.int64]:
        """Number of the first segment (K + 1,) of every field."""
        return np.concatenate(([0], np.cumsum([field.rim_segments for field in self.fields])))

    @property
    def rim_segments(self) -> int:
        return int(self._first[-1])

    def rim(self, segment: NDArray[np.int64], share: Array) -> RimPlaces:
        owner = np.searchsorted(self._first, segment, side="right") - 1
        hits = _misses(len(segment))
        flat, rate = np.empty((len(segment), 2)), np.empty((len(segment), 2))
        for k, field in enumerate(self.fields):
            owned = np.flatnonzero(owner == k)
            places = field.rim(segment[owned] - self._first[k], share[owned])
            flat[owned], rate[owned] = places.flat, places.rate
            _put(hits, owned, places.hits, k)
        return RimPlaces(flat, rate, hits)

    def at(self, flat: Array) -> Hits:
        best = _misses(len(flat))
        for k, (field, (low, high)) in enumerate(zip(self.fields, self._boxes, strict=True)):
            near = np.flatnonzero(((flat >= low) & (flat <= high)).all(axis=-1))
            if near.size:
                field_hits = _misses(len(flat))
                _put(field_hits, near, field.at(flat[near]), k)
                best = best.better(field_hits, self.side)
        return best


def _put(hits: Hits, where: NDArray[np.intp], some: Hits, part: int) -> None:
    """Write hits of one part into the hits of all parts."""
    hits.height[where], hits.point[where], hits.normal[where] = some.height, some.point, some.normal
    hits.part[where] = part


def _powers(t: Array) -> tuple[Array, Array]:
    """Return t^3, t^2, t, 1 and their derivatives, (..., 4) each, at t (...,)."""
    one, zero = np.ones_like(t), np.zeros_like(t)
    return np.stack((t**3, t**2, t, one), axis=-1), np.stack((3.0 * t**2, 2.0 * t, one, zero), axis=-1)


def _solve(first: Array, second: Array, right: Array) -> Array:
    """Solve x0 first + x1 second = right, all (N, 2), for x (N, 2); not finite for parallel vectors."""
    with np.errstate(all="ignore"):
        determinant = plane_cross(first, second)
        x0, x1 = plane_cross(right, second) / determinant, plane_cross(first, right) / determinant
    return np.stack((x0, x1), axis=-1)


def _uphill(chart: HeightChart, point: Array, normal: Array) -> Array:
    """Return unit normals (N, 3) turned to the side of increasing height."""
    normal = unit(normal)
    return np.where(dot(normal, chart.uphill(point)) < 0.0, -1.0, 1.0)[:, None] * normal


def _misses(count: int) -> Hits:
    """Return hits without an intersection."""
    nan = np.full((count, 3), np.nan)
    return Hits(np.full(count, np.nan), nan, nan.copy(), np.zeros(count, dtype=np.int64))


def first_highest(owner: NDArray[np.int64], height: Array) -> NDArray[np.intp]:
    """Return the index of the first of the highest values of every owner; `owner` (N,) ascends."""
    first = np.flatnonzero(np.diff(owner, prepend=-1))
    if len(first) == len(owner):
        return first
    top = np.repeat(np.maximum.reduceat(height, first), np.diff(first, append=len(owner)))
    highest = np.flatnonzero(height == top)
    return highest[np.diff(owner[highest], prepend=-1) > 0]


def _expand(counts: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Return for counts (N,) every owner repeated by its count, and the running number within the owner."""
    owner = np.repeat(np.arange(len(counts)), counts)
    return owner, np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)


def _wrap(angle: Array) -> Array:
    """Return angles (...,) in [-pi, pi)."""
    turned = angle + np.pi
    # most angles are there already, and the remainder takes as long as ten sums
    if ((turned < 0.0) | (turned >= 2.0 * np.pi)).any():
        turned = np.mod(turned, 2.0 * np.pi)
    return turned - np.pi
