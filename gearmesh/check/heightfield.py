"""Flanks as height fields: where a circle about an axis, or a straight ray, meets a triangle mesh or an exact grid.

A `HeightChart` splits space into two flat coordinates (a, b) and a height, so that a flank is a function height(a, b):

    Arcs: a = rho, b = z, height = +-theta     circles about the z axis (how far may a body turn?)
    Slides: a = x, b = z, height = +-y         lines along the y axis (how far may a body slide?)
    Rays: a = x,   b = y, height = z           straight lines along z   (how far apart are two bodies?)

Arcs cross the *plane* of a triangle in closed form, so that a mesh is met exactly as the polyhedron it is: straight
chords are curved in (rho, z, theta), and interpolating theta between the vertices would be wrong by as much as the
facets are. A structured grid of exact points is met as the bicubic spline through it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Protocol, Self, TypeAlias

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import DesignError
from gearmesh.kernel.motion.joint import Joint
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, cross, distinct, dot, plane_cross, polar_angle, unit
from gearmesh.mesh.triangles import TriangleMesh

if TYPE_CHECKING:
    from scipy.spatial import cKDTree

# Barycentric slack: closes the cracks between neighbouring triangles; rounding is about 1e-12 for the thinnest facets.
INSIDE = 1e-9
# A Newton step on the grid ends when the flat coordinates are met to this, mm.
GRID_RESIDUAL = 1e-11
# Where a grid is nearly tangent to the lines of the chart, at a root or a rounded tip, Newton gains a factor of 4 a step.
GRID_ITERATIONS = 24
# A place beyond the rim is given up when its foot on the rim moves by less than this, in cells.
AT_REST = 1e-3
# A grid has two sheets where its lines turn the other way by more than this share of the most.
FLAT = 1e-9
MOST_BINS = 200
# Triangles whose boxes are larger than this part of the whole, both ways, are halved for the bins, so many times at most.
PIECES, HALVINGS = 60, 14


class HeightChart(Protocol):
    """Two flat coordinates and a height; all in the chart's own frame, mm (heights of `Arcs` and `Slides` in rad)."""

    def split(self, r: Array) -> tuple[Array, Array]:
        """Flat coordinates (..., 2) and heights (...,) of points (..., 3)."""

    def join(self, flat: Array, height: Array) -> Array:
        """Points (..., 3)."""

    def rate(self, r: Array, dr: Array) -> Array:
        """Change of the flat coordinates, (..., 2), when points (..., 3) move by dr (..., 3)."""

    def uphill(self, r: Array) -> Array:
        """Unit directions (..., 3) in which the height grows."""

    def plane_height(self, flat: Array, normal: Array, offset: Array, near: Array) -> Array:
        """Heights (...,) of the planes normal . r = offset over `flat`, on the branch of the points `near` (..., 3)."""

    def lowest(self, corners: Array) -> Array:
        """Lower bounds (T, 2) of the flat coordinates over whole triangles (T, 3, 3); the upper ones are at corners."""


@dataclass(frozen=True)
class Arcs:
    """Circles about z: flat (rho, z), height `sense` * theta with theta within half a turn of `reference` (rad)."""

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

    def plane_height(self, flat: Array, normal: Array, offset: Array, near: Array) -> Array:
        # |n_xy| rho cos(theta - direction of n_xy) = offset - n_z z
        middle = polar_angle(normal)
        length = flat[..., 0] * np.hypot(normal[..., 0], normal[..., 1])
        half = np.arccos((offset - normal[..., 2] * flat[..., 1]) / length)
        side = np.sign(_wrap(polar_angle(near) - middle))
        return self._height(middle + side * half)

    def lowest(self, corners: Array) -> Array:
        # a chord passes closer to the axis than its ends
        start, end = corners[..., :2], np.roll(corners, -1, axis=1)[..., :2]
        edge = end - start
        (x, y), (dx, dy) = np.moveaxis(start, -1, 0), np.moveaxis(edge, -1, 0)
        square = np.maximum(dx * dx + dy * dy, np.finfo(float).tiny)
        along = np.clip(-(x * dx + y * dy) / square, 0.0, 1.0)
        x, y = x + along * dx, y + along * dy
        return np.stack((_least(np.sqrt(x * x + y * y)), _least(corners[..., 2])), axis=-1)

    def slope(self, r: Array, normal: Array) -> Array:
        """Partials of the height by (rho, z), (..., 2) in rad/mm, of surfaces with `normal` at r (..., 3)."""
        rho = np.hypot(r[..., 0], r[..., 1])
        outward = (r[..., 0] * normal[..., 0] + r[..., 1] * normal[..., 1]) / rho
        return -np.stack((outward, normal[..., 2]), axis=-1) / (rho * dot(normal, self.uphill(r)))[..., None]

    def arm(self, r: Array) -> Array:
        """mm per rad of the height."""
        radius: Array = np.hypot(r[..., 0], r[..., 1])
        return radius

    def _height(self, theta: Array) -> Array:
        return self.sense * (self.reference + _wrap(theta - self.reference))


@dataclass(frozen=True)
class Slides:
    """Straight lines along y: flat (x, z), height `sense` * y / `radius`; what `Arcs` are to what turns, to what slides."""

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

    def plane_height(self, flat: Array, normal: Array, offset: Array, near: Array) -> Array:
        y = (offset - normal[..., 0] * flat[..., 0] - normal[..., 2] * flat[..., 1]) / normal[..., 1]
        height: Array = self.sense * y / self.radius
        return height

    def lowest(self, corners: Array) -> Array:
        corner: Array = corners[..., ::2].min(axis=1)
        return corner

    def slope(self, r: Array, normal: Array) -> Array:
        """Partials of the height by (x, z), (..., 2) in rad/mm, of surfaces with `normal` at r (..., 3)."""
        return -normal[..., ::2] / (self.radius * self.sense * normal[..., 1])[..., None]

    def arm(self, r: Array) -> Array:
        """mm per rad of the height."""
        return np.full(r.shape[:-1], self.radius)


Ways: TypeAlias = Arcs | Slides


def along(joint: Joint, sense: float, reference: float) -> Ways:
    """The chart over the ways in which a joint moves points."""
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

    def plane_height(self, flat: Array, normal: Array, offset: Array, near: Array) -> Array:
        return (offset - normal[..., 0] * flat[..., 0] - normal[..., 1] * flat[..., 1]) / normal[..., 2]

    def lowest(self, corners: Array) -> Array:
        corner: Array = corners[..., :2].min(axis=1)
        return corner


@dataclass(frozen=True)
class Hits:
    """Where the lines of a chart meet a flank: heights (N,), points and unit normals (N, 3); NaN where they miss.

    Points and normals are in the chart's frame; normals look uphill, whatever the orientation of the triangles. `part`
    (N,) says which part of a flank of several was met.
    """

    height: Array
    point: Array
    normal: Array
    part: NDArray[np.int64]

    def __getitem__(self, which: NDArray[np.bool_]) -> Hits:
        return Hits(self.height[which], self.point[which], self.normal[which], self.part[which])

    def better(self, other: Hits, side: float) -> Hits:
        """Of two hits in a place the higher (`side` +1) or the lower (-1), or the only one; of equal ones the own."""
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
    """Places (N,) on the rim of a flank: flat coordinates (N, 2), how these change with the share (N, 2), and hits."""

    flat: Array
    rate: Array
    hits: Hits


class Field(Protocol):
    """A flank over a chart."""

    @property
    def box(self) -> Array:
        """Least and greatest flat coordinates, (2, 2)."""

    @property
    def smooth(self) -> bool:
        """Whether heights are smooth inside its rims; facets are not."""

    @property
    def rim_segments(self) -> int:
        """Number of segments of the rim; within one everything is smooth."""

    def rim(self, segment: NDArray[np.int64], share: Array) -> RimPlaces:
        """Places on the rim at shares (N,) in 0 .. 1 of segments (N,), met exactly; shares may run over a little."""

    def at(self, flat: Array) -> Hits:
        """Hits over flat coordinates (N, 2)."""


class HeightFlank(Protocol):
    """A tooth flank in its member's own frame."""

    @property
    def points(self) -> Array:
        """Points (K, 3) on it, that show where it is."""

    def over(self, chart: HeightChart, own_to_chart: Rigid, side: float) -> Field:
        """The flank as a height field; of several hits the highest (`side` +1) or the lowest (-1) counts."""

    def between(self, low: float, high: float) -> Self | None:
        """The part of it between two z (mm), and a little more; None where there is none."""


def as_flank(source: TriangleMesh | Array | HeightFlank) -> HeightFlank:
    """A flank from a triangle mesh, from a structured grid of exact points (I, J, 3), or as it is."""
    if isinstance(source, TriangleMesh):
        return MeshFlank(source.corners())
    if isinstance(source, np.ndarray):
        return GridFlank(source)
    return source


@dataclass(frozen=True)
class MeshFlank:
    """Triangles (T, 3, 3), own frame, mm; order of triangles and corners does not matter."""

    corners: Array

    def __post_init__(self) -> None:
        if self.corners.shape[0] == 0 or not np.isfinite(self.corners).all():
            raise DesignError("triangles", self.corners.shape[0], allowed="1 or more, with finite corners")

    @property
    def points(self) -> Array:
        return self.corners.reshape(-1, 3)

    @cached_property
    def rim(self) -> NDArray[np.int64]:
        """Triangle and first corner (R, 2) of the edges that belong to one triangle alone; ends are identified by coordinates."""
        vertex = np.unique(self.points, axis=0, return_inverse=True)[1].reshape(-1, 3)
        ends = np.sort(np.stack((vertex, np.roll(vertex, -1, axis=1)), axis=-1).reshape(-1, 2), axis=1)
        _, edge, count = np.unique(ends, axis=0, return_inverse=True, return_counts=True)
        alone = np.flatnonzero(count[edge.ravel()] == 1)
        return np.stack((alone // 3, alone % 3), axis=-1)

    def between(self, low: float, high: float) -> Self | None:
        corners = _above(_above(self.corners, low, 1.0), high, -1.0)
        return replace(self, corners=corners) if len(corners) else None

    def over(self, chart: HeightChart, own_to_chart: Rigid, side: float) -> Field:
        return MeshField(chart, own_to_chart.point(self.corners), side, self)


@dataclass(frozen=True)
class MeshField:
    """Triangles (T, 3, 3) in the chart's frame, sorted into bins over the flat coordinates."""

    chart: HeightChart
    corners: Array
    side: float
    flank: MeshFlank
    smooth: bool = False

    @cached_property
    def _pieces(self) -> tuple[Array, NDArray[np.int64]]:
        """Parts (K, 3, 3) of the triangles, halved until long and oblique ones fit their boxes, and whose parts they are (K,)."""
        pieces, whose, small = self.corners, np.arange(len(self.corners)), list[tuple[Array, NDArray[np.int64]]]()
        flat = self.chart.split(pieces)[0]
        large = np.ptp(flat.reshape(-1, 2), axis=0) / PIECES
        for _ in range(HALVINGS):
            x, y = np.moveaxis(self.chart.split(pieces)[0], -1, 0)
            much = (_greatest(x) - _least(x) > large[0]) & (_greatest(y) - _least(y) > large[1])
            if not much.any():
                break
            # what is small enough stays so
            small.append((pieces[~much], whose[~much]))
            halved = _halve(pieces[much])
            pieces, whose = np.concatenate(halved), np.concatenate([whose[much]] * len(halved))
        small.append((pieces, whose))
        return np.concatenate([own for own, _ in small]), np.concatenate([own for _, own in small])

    @cached_property
    def _bounds(self) -> tuple[Array, Array]:
        return self._boxes(self.corners)

    def _boxes(self, triangles: Array) -> tuple[Array, Array]:
        """Least and greatest flat coordinates (K, 2) over triangles (K, 3, 3)."""
        x, y = np.moveaxis(self.chart.split(triangles)[0], -1, 0)
        return self.chart.lowest(triangles), np.stack((_greatest(x), _greatest(y)), axis=-1)

    @cached_property
    def _reach(self) -> tuple[Array, Array]:
        """The bounds with a margin for rounding, (2, T)."""
        low, high = self._bounds
        margin = 1e-9 * (high.max(axis=0) - low.min(axis=0))
        return np.ascontiguousarray((low - margin).T), np.ascontiguousarray((high + margin).T)

    @cached_property
    def _middles(self) -> Array:
        middles: Array = self.corners.mean(axis=1)
        return middles

    @cached_property
    def _area_vectors(self) -> Array:
        a, b, c = np.moveaxis(self.corners, 1, 0)
        return cross(b - a, c - a)

    @cached_property
    def _duals(self) -> Array:
        """Vectors (T, 2, 3) whose products with r - corner 0 are the weights of corners 1 and 2."""
        a, b, c = np.moveaxis(self.corners, 1, 0)
        normal = self._area_vectors
        with np.errstate(all="ignore"):  # a triangle without area is never hit
            return np.stack((cross(c - a, normal), cross(normal, b - a)), axis=1) / dot(normal, normal)[:, None, None]

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
        # column by column: sums and comparisons over two or three numbers each take as long as those over thousands
        for place, low, high in zip(flat.T, *self._reach, strict=True):
            along = place[query]
            near = (along >= low[triangle]) & (along <= high[triangle])
            query, triangle = query[near], triangle[near]

        corner, normal = self.corners[triangle, 0], self._area_vectors[triangle]
        with np.errstate(all="ignore"):  # lines that run along a plane or miss it
            height = self.chart.plane_height(flat[query], normal, dot(normal, corner), self._middles[triangle])
            point = self.chart.join(flat[query], height)
            one, two = np.einsum("nkj,nj->kn", self._duals[triangle], point - corner)
            hit = (one >= -INSIDE) & (two >= -INSIDE) & (one + two <= 1.0 + INSIDE)
        query, triangle, height, point = query[hit], triangle[hit], height[hit], point[hit]

        first = np.lexsort((-self.side * height, query))
        first = first[np.diff(query[first], prepend=-1) > 0]
        hits = _misses(len(flat))
        hits.height[query[first]] = height[first]
        hits.point[query[first]] = point[first]
        hits.normal[query[first]] = _uphill(self.chart, point[first], self._area_vectors[triangle[first]])
        return hits


def _above(triangles: Array, level: float, way: float) -> Array:
    """What of triangles (T, 3, 3) lies above the plane z = `level`, or below it (`way` -1), as triangles in the same planes."""
    height = way * (triangles[..., 2] - level)
    inside = height >= 0.0
    count = inside.sum(axis=1)
    cut = (count == 1) | (count == 2)
    # the corner that is alone on its side first
    alone = np.where(count == 1, inside.argmax(axis=1), inside.argmin(axis=1))[cut]
    order = (alone[:, None] + np.arange(3)) % 3
    a, b, c = np.moveaxis(np.take_along_axis(triangles[cut], order[..., None], axis=1), 1, 0)
    ab, ac = _at_level(a, b, level), _at_level(a, c, level)
    one = (count == 1)[cut]
    tips = np.stack((a, ab, ac), axis=1)[one]
    rests = [np.stack(corners, axis=1)[~one] for corners in ((ab, b, c), (ab, c, ac))]
    return np.concatenate((triangles[count == 3], tips, *rests))


def _at_level(a: Array, b: Array, level: float) -> Array:
    """Where edges from a to b (N, 3) cross z = `level`: the same points, to the last digit, from b to a."""
    swap = (a[:, 2] > b[:, 2])[:, None]
    low, high = np.where(swap, b, a), np.where(swap, a, b)
    point: Array = low + ((level - low[:, 2]) / (high[:, 2] - low[:, 2]))[:, None] * (high - low)
    point[:, 2] = level
    return point


def _least(values: Array) -> Array:
    """The least of three values each, (T, 3)."""
    return np.minimum(np.minimum(values[:, 0], values[:, 1]), values[:, 2])


def _greatest(values: Array) -> Array:
    """The greatest of three values each, (T, 3)."""
    return np.maximum(np.maximum(values[:, 0], values[:, 1]), values[:, 2])


def _halve(triangles: Array) -> tuple[Array, Array]:
    """Both halves of triangles (T, 3, 3), cut across their longest edges."""
    side = np.roll(triangles, -1, axis=1) - triangles
    length = np.sqrt(dot(side, side))
    order = (length.argmax(axis=1)[:, None] + np.arange(3)) % 3
    a, b, c = np.moveaxis(np.take_along_axis(triangles, order[..., None], axis=1), 1, 0)
    middle = 0.5 * (a + b)
    return np.stack((a, middle, c), axis=1), np.stack((middle, b, c), axis=1)


@dataclass(frozen=True)
class _Bins:
    """Triangles in a rectangular grid of bins, by the boxes of their pieces: bin k holds members[start[k] : start[k + 1]]."""

    origin: Array
    size: Array
    shape: NDArray[np.int64]
    start: NDArray[np.int64]
    members: NDArray[np.int64]

    @staticmethod
    def of(low: Array, high: Array, whose: NDArray[np.int64]) -> _Bins:
        """Bins of about the average size of the boxes from `low` to `high` (K, 2) of pieces of the triangles `whose` (K,)."""
        origin, extent = low.min(axis=0), high.max(axis=0) - low.min(axis=0)
        average = np.maximum((high - low).mean(axis=0), extent / MOST_BINS)
        shape = np.maximum(np.ceil(extent / np.maximum(average, np.finfo(float).tiny)), 1.0).astype(np.int64)
        size = np.maximum(extent / shape, np.finfo(float).tiny)
        margin = 1e-6 * size
        first = np.clip(np.floor((low - margin - origin) / size).astype(np.int64), 0, shape - 1)
        last = np.clip(np.floor((high + margin - origin) / size).astype(np.int64), 0, shape - 1)
        span = last - first + 1
        box, step = _expand(span.prod(axis=1))
        cell = first[box] + np.stack((step // span[box, 1], step % span[box, 1]), axis=-1)
        # of the many pieces that an oblique triangle may have in a bin one is enough
        count = int(whose.max(initial=0)) + 1
        key, member = np.divmod(distinct((cell[:, 0] * shape[1] + cell[:, 1]) * count + whose[box]), count)
        start = np.concatenate(([0], np.cumsum(np.bincount(key, minlength=int(shape.prod())))))
        return _Bins(origin, size, shape, start, member)

    def pairs(self, flat: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Indices of queries `flat` (N, 2) and of the triangles in their bins."""
        place = (flat - self.origin) / self.size
        within = (place >= -1e-6) & (place <= self.shape + 1e-6)
        inside = within[:, 0] & within[:, 1]
        cell = np.clip(np.where(inside[:, None], place, 0.0).astype(np.int64), 0, self.shape - 1)
        key = cell[:, 0] * self.shape[1] + cell[:, 1]
        query, step = _expand(np.where(inside, self.start[key + 1] - self.start[key], 0))
        return query, self.members[self.start[key[query]] + step]


@dataclass(frozen=True)
class GridFlank:
    """Structured exact points (I, J, 3), own frame, mm, joined by a bicubic spline over the indices.

    I and J are at least 4. `cells`: the polynomials (I - 1, J - 1, 4, 4, 3) of a part of a larger grid, whose spline it keeps.
    """

    grid: Array
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
        """The greatest indices, (2,)."""
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
        """Points and their partials (N, 3) at fractional indices (N, 2)."""
        cell = np.clip(index.astype(np.int64), 0, np.array(self._coefficients.shape[:2]) - 1)
        along_i, along_j = np.moveaxis(np.stack(_powers(index - cell), axis=-2), 1, 0)
        # contraction over i for the value and the slope at once, then over j: two products of small matrices a place
        over_i = along_i @ self._coefficients[cell[:, 0], cell[:, 1]].reshape(-1, 4, 12)
        over_i = over_i.reshape(-1, 2, 4, 3)
        at_place = along_j @ over_i[:, 0]
        return at_place[:, 0], (along_j[:, None, 0] @ over_i[:, 1])[:, 0], at_place[:, 1]

    @cached_property
    def nodes(self) -> tuple[Array, Array, Array]:
        """Points of the grid and their partials, (I J, 3)."""
        shape = self.grid.shape[:2]
        return self.jet(np.stack(np.unravel_index(np.arange(shape[0] * shape[1]), shape), axis=-1).astype(float))

    def between(self, low: float, high: float) -> Self | None:
        z = self.grid[..., 2]
        inside = np.flatnonzero((z.max(axis=0) >= low) & (z.min(axis=0) <= high))
        if not inside.size:
            return None
        # a cell more, and as many lines as a spline needs
        first, last = max(int(inside[0]) - 1, 0), min(int(inside[-1]) + 1, z.shape[1] - 1)
        first = max(min(first, last - 3), 0)
        end = max(last, first + 3)
        return replace(self, grid=self.grid[:, first : end + 1], cells=self._coefficients[:, first:end])

    def over(self, chart: HeightChart, own_to_chart: Rigid, side: float) -> Field:
        return GridField(chart, self, own_to_chart, side)


@dataclass(frozen=True)
class GridField:
    """A grid over a chart: the indices over given flat coordinates by Newton from the nearest grid point.

    Where lines of the chart are tangent to the grid it has two sheets: each is met by itself, and the better counts.
    """

    chart: HeightChart
    flank: GridFlank
    own_to_chart: Rigid
    side: float
    smooth: bool = True

    @cached_property
    def _sheets(self) -> list[tuple[cKDTree, NDArray[np.intp]]]:
        """Trees of the grid points of every sheet over the flat coordinates, and which grid points these are."""
        from scipy.spatial import cKDTree

        own, own_i, own_j = self.flank.nodes
        point = self.own_to_chart.point(own)
        flat = self.chart.split(point)[0]
        turning = plane_cross(
            self.chart.rate(point, self.own_to_chart.vector(own_i)),
            self.chart.rate(point, self.own_to_chart.vector(own_j)),
        )
        slack = FLAT * np.abs(turning).max()
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
        """Hits found from the nearest of some grid points."""
        distance, nearest = tree.query(flat)
        index = np.stack(np.unravel_index(nodes[nearest], self.flank.grid.shape[:2]), axis=-1).astype(float)
        hits = _misses(len(flat))
        # a place in a cell is no farther from its nearest corner than the cell is long
        todo = np.flatnonzero(distance <= self._longest)
        for _ in range(GRID_ITERATIONS):
            if todo.size == 0:
                break
            own, own_i, own_j = self.flank.jet(index[todo])
            point = self.own_to_chart.point(own)
            r_i, r_j = self.own_to_chart.vector(own_i), self.own_to_chart.vector(own_j)
            here, height = self.chart.split(point)
            residual = flat[todo] - here
            met = np.abs(residual).max(axis=-1) <= GRID_RESIDUAL
            done = todo[met]
            hits.height[done], hits.point[done] = height[met], point[met]
            hits.normal[done] = _uphill(self.chart, point[met], cross(r_i[met], r_j[met]))
            wanted = index[todo] + np.clip(
                _solve(self.chart.rate(point, r_i), self.chart.rate(point, r_j), residual), -5.0, 5.0
            )
            # places beyond the rim stay on it with a residual: they are misses
            moved = np.clip(wanted, 0.0, self.flank.last)
            resting = (moved != wanted).any(axis=-1) & (np.abs(moved - index[todo]) < AT_REST).all(axis=-1)
            going = ~met & ~resting & (moved != index[todo]).any(axis=-1) & np.isfinite(moved).all(axis=-1)
            index[todo[going]] = moved[going]
            todo = todo[going]
        return hits


@dataclass(frozen=True)
class PatchedFlank:
    """Several flanks in one frame that are one: the links of a tooth, or the parts of a link between two corners."""

    patches: tuple[HeightFlank, ...]

    @property
    def points(self) -> Array:
        return np.concatenate([patch.points for patch in self.patches])

    def between(self, low: float, high: float) -> Self | None:
        parts = self.parts_between(low, high)
        return replace(self, patches=tuple(parts.values())) if parts else None

    def parts_between(self, low: float, high: float) -> dict[int, HeightFlank]:
        """What patches have between two z (mm), and a little more, by their numbers."""
        return {k: part for k, patch in enumerate(self.patches) if (part := patch.between(low, high)) is not None}

    def over(self, chart: HeightChart, own_to_chart: Rigid, side: float) -> Field:
        return PatchedField(tuple(patch.over(chart, own_to_chart, side) for patch in self.patches), side)


@dataclass(frozen=True)
class PatchedField:
    """Fields over one chart; of several hits the better counts, and the rim is that of every one."""

    fields: tuple[Field, ...]
    side: float

    @cached_property
    def _boxes(self) -> Array:
        """Boxes (K, 2, 2) of the fields, and a little more."""
        boxes = np.stack([field.box for field in self.fields])
        margin = 1e-3 * (boxes[:, 1] - boxes[:, 0]) + GRID_RESIDUAL
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
            own = np.flatnonzero(owner == k)
            places = field.rim(segment[own] - self._first[k], share[own])
            flat[own], rate[own] = places.flat, places.rate
            _put(hits, own, places.hits, k)
        return RimPlaces(flat, rate, hits)

    def at(self, flat: Array) -> Hits:
        best = _misses(len(flat))
        for k, (field, (low, high)) in enumerate(zip(self.fields, self._boxes, strict=True)):
            near = np.flatnonzero(((flat >= low) & (flat <= high)).all(axis=-1))
            if near.size:
                own = _misses(len(flat))
                _put(own, near, field.at(flat[near]), k)
                best = best.better(own, self.side)
        return best


def _put(hits: Hits, where: NDArray[np.intp], some: Hits, part: int) -> None:
    """Write hits of one part into those of all."""
    hits.height[where], hits.point[where], hits.normal[where] = some.height, some.point, some.normal
    hits.part[where] = part


def _powers(t: Array) -> tuple[Array, Array]:
    """Cubes, squares, t, 1 and their derivatives, (..., 4), at t (...,)."""
    one, zero = np.ones_like(t), np.zeros_like(t)
    return np.stack((t**3, t**2, t, one), axis=-1), np.stack((3.0 * t**2, 2.0 * t, one, zero), axis=-1)


def _solve(first: Array, second: Array, right: Array) -> Array:
    """Solutions (N, 2) of x0 first + x1 second = right, all (N, 2); not finite where they are parallel."""
    with np.errstate(all="ignore"):
        determinant = plane_cross(first, second)
        x0, x1 = plane_cross(right, second) / determinant, plane_cross(first, right) / determinant
    return np.stack((x0, x1), axis=-1)


def _uphill(chart: HeightChart, point: Array, normal: Array) -> Array:
    """Unit normals (N, 3) turned to the side where the height grows."""
    normal = unit(normal)
    return np.where(dot(normal, chart.uphill(point)) < 0.0, -1.0, 1.0)[:, None] * normal


def _misses(count: int) -> Hits:
    nan = np.full((count, 3), np.nan)
    return Hits(np.full(count, np.nan), nan, nan.copy(), np.zeros(count, dtype=np.int64))


def _expand(counts: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """For counts (N,): every owner repeated as often as it counts, and the running number within the owner."""
    owner = np.repeat(np.arange(len(counts)), counts)
    return owner, np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)


def _wrap(angle: Array) -> Array:
    """Angles (...,) in [-pi, pi)."""
    return np.mod(angle + np.pi, 2.0 * np.pi) - np.pi
