"""Flanks as height fields: where a circle about an axis, or a straight ray, meets a triangle mesh or an exact grid.

A `HeightChart` splits space into two flat coordinates (a, b) and a height, so that a flank is a function height(a, b):

    Arcs: a = rho, b = z, height = +-theta     circles about the z axis (how far may a body turn?)
    Rays: a = x,   b = y, height = z           straight lines along z   (how far apart are two bodies?)

Arcs cross the *plane* of a triangle in closed form, so that a mesh is met exactly as the polyhedron it is: straight
chords are curved in (rho, z, theta), and interpolating theta between the vertices would be wrong by as much as the
facets are. A structured grid of exact points is met as the bicubic spline through it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.spatial import cKDTree

from gearmesh.errors import DesignError
from gearmesh.kernel.algebra import Array, cross, dot, plane_cross, polar_angle, unit
from gearmesh.kernel.rigid import Rigid
from gearmesh.mesh.triangles import TriangleMesh

# Barycentric slack: closes the cracks between neighbouring triangles; rounding is about 1e-12 for the thinnest facets.
INSIDE = 1e-9
# A Newton step on the grid ends when the flat coordinates are met to this, mm.
GRID_RESIDUAL = 1e-11
GRID_ITERATIONS = 8
MOST_BINS = 200


class HeightChart(Protocol):
    """Two flat coordinates and a height; all in the chart's own frame, mm (heights of `Arcs` in rad)."""

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
        side = np.sign(_wrapped(polar_angle(near) - middle))
        return self._height(middle + side * half)

    def lowest(self, corners: Array) -> Array:
        # a chord passes closer to the axis than its ends
        start, end = corners[..., :2], np.roll(corners, -1, axis=1)[..., :2]
        edge = end - start
        square = np.maximum((edge**2).sum(-1), np.finfo(float).tiny)
        along = np.clip(-(start * edge).sum(-1) / square, 0.0, 1.0)
        closest = np.linalg.norm(start + along[..., None] * edge, axis=-1)
        return np.stack((closest.min(axis=1), corners[..., 2].min(axis=1)), axis=-1)

    def slope(self, r: Array, normal: Array) -> Array:
        """Partials of the height by (rho, z), (..., 2) in rad/mm, of surfaces with `normal` at r (..., 3)."""
        rho = np.hypot(r[..., 0], r[..., 1])
        outward = (r[..., 0] * normal[..., 0] + r[..., 1] * normal[..., 1]) / rho
        return -np.stack((outward, normal[..., 2]), axis=-1) / (rho * dot(normal, self.uphill(r)))[..., None]

    def _height(self, theta: Array) -> Array:
        return self.sense * (self.reference + _wrapped(theta - self.reference))


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
        found: Array = corners[..., :2].min(axis=1)
        return found


@dataclass(frozen=True)
class Hits:
    """Where the lines of a chart meet a flank: heights (N,), points and unit normals (N, 3); NaN where they miss.

    Points and normals are in the chart's frame; normals look uphill, whatever the orientation of the triangles.
    """

    height: Array
    point: Array
    normal: Array


class Field(Protocol):
    """A flank over a chart."""

    @property
    def box(self) -> Array:
        """Least and greatest flat coordinates, (2, 2)."""

    def at(self, flat: Array) -> Hits:
        """Hits over flat coordinates (N, 2)."""


class HeightFlank(Protocol):
    """A tooth flank in its member's own frame."""

    @property
    def points(self) -> Array:
        """Points (K, 3) on it, that tell where it lies."""

    def over(self, chart: HeightChart, own_to_chart: Rigid, side: float) -> Field:
        """The flank as a height field; of several hits the highest (`side` +1) or the lowest (-1) counts."""


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
            raise DesignError(f"flank mesh of {self.corners.shape[0]} triangles, allowed 1 or more with finite corners")

    @property
    def points(self) -> Array:
        return self.corners.reshape(-1, 3)

    def over(self, chart: HeightChart, own_to_chart: Rigid, side: float) -> Field:
        return MeshField(chart, own_to_chart.point(self.corners), side)


@dataclass(frozen=True)
class MeshField:
    """Triangles (T, 3, 3) in the chart's frame, sorted into bins over the flat coordinates."""

    chart: HeightChart
    corners: Array
    side: float

    @cached_property
    def _bounds(self) -> tuple[Array, Array]:
        return self.chart.lowest(self.corners), self.chart.split(self.corners)[0].max(axis=1)

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
        return _Bins.of(*self._bounds)

    @property
    def box(self) -> Array:
        low, high = self._bounds
        return np.stack((low.min(axis=0), high.max(axis=0)))

    def at(self, flat: Array) -> Hits:
        query, triangle = self._bins.pairs(flat)
        low, high = self._bounds
        margin = 1e-9 * (high.max(axis=0) - low.min(axis=0))
        near = ((flat[query] >= low[triangle] - margin) & (flat[query] <= high[triangle] + margin)).all(axis=-1)
        query, triangle = query[near], triangle[near]

        corner, normal = self.corners[triangle, 0], self._area_vectors[triangle]
        with np.errstate(all="ignore"):  # lines that run along a plane or miss it
            height = self.chart.plane_height(
                flat[query], normal, dot(normal, corner), self.corners[triangle].mean(axis=1)
            )
            point = self.chart.join(flat[query], height)
            weights = np.einsum("nkj,nj->nk", self._duals[triangle], point - corner)
            hit = (weights >= -INSIDE).all(axis=-1) & (weights.sum(axis=-1) <= 1.0 + INSIDE)
        query, triangle, height, point = query[hit], triangle[hit], height[hit], point[hit]

        first = np.lexsort((-self.side * height, query))
        first = first[np.diff(query[first], prepend=-1) > 0]
        hits = _missed(len(flat))
        hits.height[query[first]] = height[first]
        hits.point[query[first]] = point[first]
        hits.normal[query[first]] = _uphill(self.chart, point[first], self._area_vectors[triangle[first]])
        return hits


@dataclass(frozen=True)
class _Bins:
    """Boxes sorted into a rectangular grid of bins: bin k holds members[start[k] : start[k + 1]]."""

    origin: Array
    size: Array
    shape: NDArray[np.int64]
    start: NDArray[np.int64]
    members: NDArray[np.int64]

    @staticmethod
    def of(low: Array, high: Array) -> _Bins:
        """Bins of about the average size of the boxes from `low` to `high` (T, 2)."""
        origin, extent = low.min(axis=0), high.max(axis=0) - low.min(axis=0)
        average = np.maximum((high - low).mean(axis=0), extent / MOST_BINS)
        shape = np.maximum(np.ceil(extent / np.maximum(average, np.finfo(float).tiny)), 1.0).astype(np.int64)
        size = np.maximum(extent / shape, np.finfo(float).tiny)
        margin = 1e-6 * size
        first = np.clip(np.floor((low - margin - origin) / size).astype(np.int64), 0, shape - 1)
        last = np.clip(np.floor((high + margin - origin) / size).astype(np.int64), 0, shape - 1)
        span = last - first + 1
        box, step = _expanded(span.prod(axis=1))
        cell = first[box] + np.stack((step // span[box, 1], step % span[box, 1]), axis=-1)
        key = cell[:, 0] * shape[1] + cell[:, 1]
        start = np.concatenate(([0], np.cumsum(np.bincount(key, minlength=int(shape.prod())))))
        return _Bins(origin, size, shape, start, box[np.argsort(key, kind="stable")])

    def pairs(self, flat: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Indices of queries `flat` (N, 2) and of the boxes in their bins."""
        place = (flat - self.origin) / self.size
        inside = np.all((place >= -1e-6) & (place <= self.shape + 1e-6), axis=-1)
        cell = np.clip(np.where(inside[:, None], place, 0.0).astype(np.int64), 0, self.shape - 1)
        key = cell[:, 0] * self.shape[1] + cell[:, 1]
        query, step = _expanded(np.where(inside, self.start[key + 1] - self.start[key], 0))
        return query, self.members[self.start[key[query]] + step]


@dataclass(frozen=True)
class GridFlank:
    """Structured exact points (I, J, 3), own frame, mm, joined by a bicubic spline over the indices.

    I and J are at least 4. The flank must have one height over each place of the charts it is used with.
    """

    grid: Array

    def __post_init__(self) -> None:
        if self.grid.ndim != 3 or self.grid.shape[-1] != 3 or min(self.grid.shape[:2]) < 4:
            raise DesignError(f"flank grid has shape {self.grid.shape}, allowed (I, J, 3) with I and J at least 4")
        if not np.isfinite(self.grid).all():
            raise DesignError("flank grid has coordinates that are not finite")

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
        along_i = CubicSpline(np.arange(self.grid.shape[0]), self.grid, axis=0).c
        along_j = CubicSpline(np.arange(self.grid.shape[1]), along_i, axis=2).c
        return np.ascontiguousarray(np.transpose(along_j, (3, 1, 2, 0, 4)))

    def jet(self, index: Array) -> tuple[Array, Array, Array]:
        """Points and their partials (N, 3) at fractional indices (N, 2)."""
        cell = np.clip(index.astype(np.int64), 0, np.array(self._coefficients.shape[:2]) - 1)
        powers, slopes = _powers(index - cell)
        local = self._coefficients[cell[:, 0], cell[:, 1]]
        # contraction over j once for the value and once for the slope, then over i
        value = (powers[:, 1, None, None, :] @ local)[:, :, 0]
        turned = (slopes[:, 1, None, None, :] @ local)[:, :, 0]
        point = (powers[:, 0, None, :] @ value)[:, 0]
        return point, (slopes[:, 0, None, :] @ value)[:, 0], (powers[:, 0, None, :] @ turned)[:, 0]

    def over(self, chart: HeightChart, own_to_chart: Rigid, side: float) -> Field:
        return GridField(chart, self, own_to_chart)


@dataclass(frozen=True)
class GridField:
    """A grid over a chart: the indices over given flat coordinates by Newton from the nearest grid point."""

    chart: HeightChart
    flank: GridFlank
    own_to_chart: Rigid

    @cached_property
    def _tree(self) -> cKDTree:
        return cKDTree(self.chart.split(self.own_to_chart.point(self.flank.points))[0])

    @property
    def box(self) -> Array:
        return np.stack((self._tree.mins, self._tree.maxes))

    def at(self, flat: Array) -> Hits:
        nearest = self._tree.query(flat)[1]
        index = np.stack(np.unravel_index(nearest, self.flank.grid.shape[:2]), axis=-1).astype(float)
        hits = _missed(len(flat))
        todo = np.arange(len(flat))
        for _ in range(GRID_ITERATIONS):
            own, own_i, own_j = self.flank.jet(index[todo])
            point = self.own_to_chart.point(own)
            r_i, r_j = self.own_to_chart.vector(own_i), self.own_to_chart.vector(own_j)
            here, height = self.chart.split(point)
            residual = flat[todo] - here
            met = np.abs(residual).max(axis=-1) <= GRID_RESIDUAL
            done = todo[met]
            hits.height[done], hits.point[done] = height[met], point[met]
            hits.normal[done] = _uphill(self.chart, point[met], cross(r_i[met], r_j[met]))
            step = _solved(self.chart.rate(point, r_i), self.chart.rate(point, r_j), residual)
            # places beyond the rim stay on it with a residual: they are misses
            moved = np.clip(index[todo] + np.clip(step, -5.0, 5.0), 0.0, self.flank.last)
            going = ~met & (moved != index[todo]).any(axis=-1) & np.isfinite(moved).all(axis=-1)
            index[todo[going]] = moved[going]
            todo = todo[going]
            if todo.size == 0:
                break
        return hits


def _powers(t: Array) -> tuple[Array, Array]:
    """Cubes, squares, t, 1 and their derivatives, (..., 4), at t (...,)."""
    one, zero = np.ones_like(t), np.zeros_like(t)
    return np.stack((t**3, t**2, t, one), axis=-1), np.stack((3.0 * t**2, 2.0 * t, one, zero), axis=-1)


def _solved(first: Array, second: Array, right: Array) -> Array:
    """Solutions (N, 2) of x0 first + x1 second = right, all (N, 2); not finite where they are parallel."""
    with np.errstate(all="ignore"):
        determinant = plane_cross(first, second)
        x0, x1 = plane_cross(right, second) / determinant, plane_cross(first, right) / determinant
    return np.stack((x0, x1), axis=-1)


def _uphill(chart: HeightChart, point: Array, normal: Array) -> Array:
    """Unit normals (N, 3) turned to the side where the height grows."""
    normal = unit(normal)
    return np.where(dot(normal, chart.uphill(point)) < 0.0, -1.0, 1.0)[:, None] * normal


def _missed(count: int) -> Hits:
    return Hits(np.full(count, np.nan), np.full((count, 3), np.nan), np.full((count, 3), np.nan))


def _expanded(counts: NDArray[np.int64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """For counts (N,): every owner repeated as often as it counts, and the running number within the owner."""
    owner = np.repeat(np.arange(len(counts)), counts)
    return owner, np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)


def _wrapped(angle: Array) -> Array:
    """Angles (...,) in [-pi, pi)."""
    return np.mod(angle + np.pi, 2.0 * np.pi) - np.pi
