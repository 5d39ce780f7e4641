"""A mesh as files hold it, in float32 or in decimals: the same surface, closed where it was, proved on the rounded coordinates.

Decimals are on the grid of `digits`. At 350 mm one step of float32 is 3e-5 mm. Vertices closer than a step become one for whoever
joins equal corners, which every reader of STL does: an edge with four facets, or a surface pinched at a point. And a facet thinner
than a step may turn over.

- Vertices that fall on one point and are joined by an edge are merged, with the two facets between them left out, where
  that keeps the surface a surface: their neighbours in common must be the apexes of those two facets (the link condition).
- Others that fall on one point go apart, to the free points nearest to where they are.
- A facet that turned over or lost its area gets a vertex rounded another way, or else its edge of rounding's length merged.

All of it in the order of vertex numbers, so the same mesh gives the same file. Nothing moves farther than two steps (of the
vertex' largest coordinate) a coordinate. Vertices that the mesh itself has at one place, on open edges, stay: they are meant
to be joined.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from gearmesh.io.digits import VERTEX_STEPS_PER_MM, vertices_on_grid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.grid import BORDER
from gearmesh.mesh.triangles import Facets, TriangleMesh

Indices = NDArray[np.int64]
Point = tuple[float, float, float]
Components = tuple[Array, Array, Array]

_CHUNK = 16384
#: steps that a coordinate is moved at most
STEPS = 2
# Odd multipliers with well mixed bits, for the key of a point.
_KEYS = (np.uint64(0x9E3779B97F4A7C15), np.uint64(0xC2B2AE3D27D4EB4F), np.uint64(0x165667B19E3779F9))


@dataclass(frozen=True)
class _Numbers:
    """Numbers, of `unit` mm, that coordinates may be.

    They are decimals on their grid, or `single` ones (float32), multiples of a `finest` above 0.
    """

    single: bool
    unit: float = 1.0
    finest: float = 0.0

    def nearest(self, points: Array) -> Array:
        """Points, in units, as float64; no negative zero, which is another bit pattern of the same number."""
        if not self.single:
            return vertices_on_grid(points)
        single = points.astype(np.float32).astype(float)
        return (np.rint(single / self.finest) * self.finest if self.finest else single) + 0.0

    def nearest_mm(self, vertices: Array) -> Array:
        """Vertices (N, 3), mm."""
        return self.nearest(vertices / self.unit) * self.unit

    def steps(self, points: Array) -> Array:
        """Steps (...), in units, between neighbours of coordinates (...), in units."""
        if not self.single:
            return np.full_like(points, 1.0 / VERTEX_STEPS_PER_MM)
        single: Array = np.spacing(np.abs(points).astype(np.float32)).astype(float)
        return np.maximum(single, self.finest)


def in_decimals(mesh: Facets) -> Facets:
    """The mesh with its coordinates (mm) on the grid of decimals. Facets without area, by their indices, are left out."""
    return _in_numbers(mesh, _Numbers(single=False))


def decimal_steps(points: Array) -> Array:
    """Twice the distances (N, 3), mm, by which `in_decimals` moves coordinates (N, 3) at most: a little more than their steps."""
    return 2.0 * BORDER * _Numbers(single=False).steps(points)


def in_single(mesh: Facets, unit: float = 1.0, finest: float = 0.0) -> Facets:
    """The mesh (mm) with coordinates that are float32 numbers of `unit` mm, what a file of such numbers holds.

    With `finest` coordinates are also multiples of it (in `unit`), which matters close to zero, where float32 distinguishes
    what a reader with an absolute tolerance does not. Facets without area, by their indices, are left out. A gear of which
    nothing is to be repaired stays one that repeats its teeth.
    """
    return _in_numbers(mesh, _Numbers(True, unit, finest))


def _in_numbers(mesh: Facets, numbers: _Numbers) -> Facets:
    written = mesh.round(numbers.nearest_mm)
    if _is_right(mesh, written, numbers):
        return written
    return _repair_mesh(mesh.whole(), numbers)


def _is_right(mesh: Facets, written: Facets, numbers: _Numbers) -> bool:
    """True where rounding leaves every vertex a point of its own, and no facet without area or turned over."""
    keys = np.concatenate([_keys(piece / numbers.unit) for piece in written.vertex_pieces()])
    keys.sort()
    if (keys[1:] == keys[:-1]).any():
        return False
    for true, rounded in zip(mesh.corner_pieces(), written.corner_pieces(), strict=True):
        # exactly the numbers of the file
        in_file = numbers.nearest(rounded / numbers.unit)
        before, after = (_areas(*np.ascontiguousarray(np.moveaxis(corners, 0, -1))) for corners in (true, in_file))
        if not (_agreement(before, after) > 0.0).all():
            return False
    return True


def _repair_mesh(mesh: TriangleMesh, numbers: _Numbers) -> TriangleMesh:
    """The mesh as files hold it, where rounding may do harm."""
    true, unit = mesh.vertices / numbers.unit, numbers.unit
    points = numbers.nearest(true)
    crowd, weak = _coincident(points), _weak(true, points, mesh.triangles)
    if not (len(crowd) or len(weak)):
        return replace(mesh, vertices=points * unit)
    repair = _Repair(true, points, mesh.triangles, crowd, weak, numbers)
    repair.run(_groups(points, crowd), weak.tolist())
    return repair.result(mesh, unit)


def steps(points: Array, unit: float = 1.0, finest: float = 0.0) -> Array:
    """Distances (N, 3), mm, between the numbers that `in_single` may put in the place of coordinates (N, 3), mm."""
    return _Numbers(True, unit, finest).steps(points / unit) * unit


def rounding(mesh: Facets, written: Facets) -> float:
    """How far (mm) the surface of a mesh is at most from that of the same mesh as a file holds it, `written`.

    Where no vertex was merged that is how far the one moved farthest, else what none of them exceeds.
    """
    if written is mesh:
        return 0.0
    if _same_triangles(mesh, written):
        pairs = zip(mesh.vertex_pieces(), written.vertex_pieces(), strict=True)
        return float(np.sqrt(max(((after - before) ** 2).sum(axis=1).max(initial=0.0) for before, after in pairs)))
    # a step of float32 is at most this share of the number, in whatever unit
    largest = max(float(np.abs(piece).max()) for piece in mesh.vertex_pieces())
    step = max(float(np.finfo(np.float32).eps) * largest, 1.0 / VERTEX_STEPS_PER_MM)
    return float(np.sqrt(3.0)) * STEPS * step


def _same_triangles(mesh: Facets, written: Facets) -> bool:
    """True where a file has all vertices of a mesh, and its triangles."""
    if not isinstance(written, TriangleMesh):
        # the same teeth, whose vertices are rounded
        return True
    if (written.vertex_count, written.triangle_count) != (mesh.vertex_count, mesh.triangle_count):
        return False
    return np.array_equal(written.whole().triangles, mesh.whole().triangles)


def _keys(points: Array) -> NDArray[np.uint64]:
    """A number (N,) for each of the points (N, 3), equal for equal points and hardly ever otherwise."""
    bits = np.ascontiguousarray(points).view(np.uint64)
    key = np.zeros(len(points), np.uint64)
    for column, factor in zip(bits.T, _KEYS, strict=True):
        key = (key ^ column) * factor
        key ^= key >> np.uint64(29)
    return key


def _coincident(points: Array) -> Indices:
    """Vertices, rising, that share their point with another."""
    keys = _keys(points)
    ranked = np.sort(keys)
    twice = ranked[1:][ranked[1:] == ranked[:-1]]
    if not len(twice):
        return np.empty(0, np.int64)
    shared = np.flatnonzero(np.isin(keys, twice))
    _, group, count = np.unique(points[shared], axis=0, return_inverse=True, return_counts=True)
    return shared[count[group.reshape(-1)] > 1]


def _groups(points: Array, crowd: Indices) -> list[list[int]]:
    """The crowd by point, groups and their vertices rising."""
    groups: dict[Point, list[int]] = {}
    for vertex, point in zip(crowd.tolist(), points[crowd].tolist(), strict=True):
        groups.setdefault(_point(point), []).append(vertex)
    return list(groups.values())


def _point(coordinates: list[float]) -> Point:
    x, y, z = coordinates
    return x, y, z


def _weak(true: Array, points: Array, triangles: Indices) -> Indices:
    """Facets that rounding turned over, or that have no area after it."""
    given, rounded = np.ascontiguousarray(true.T), np.ascontiguousarray(points.T)
    wrong = []
    for start in range(0, len(triangles), _CHUNK):
        corners = np.ascontiguousarray(triangles[start : start + _CHUNK].T)
        before, after = (_areas(*points[:, corners].swapaxes(0, 1)) for points in (given, rounded))
        wrong.append(start + np.flatnonzero(~(_agreement(before, after) > 0.0)))
    return np.concatenate(wrong)


def _agreement(before: Components, after: Components) -> Array:
    """Products (T,) of vectors, positive where they look to the same side."""
    same = before[0] * after[0]
    same += before[1] * after[1]
    same += before[2] * after[2]
    return same


def _areas(a: Array, b: Array, c: Array) -> Components:
    """Components of the normals, twice as long as the area, of triangles by components (3, T) of their corners."""
    (ux, vx), (uy, vy), (uz, vz) = ((q - p, r - p) for p, q, r in zip(a, b, c, strict=True))
    return uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx


class _Repair:
    """The facets round the vertices in trouble, and what is done to them."""

    def __init__(
        self, true: Array, points: Array, triangles: Indices, crowd: Indices, weak: Indices, numbers: _Numbers
    ) -> None:
        self.true, self.points, self.numbers = true, points, numbers
        keys = _keys(points)
        self.order = np.argsort(keys, kind="stable")
        self.ranked = keys[self.order]
        subjects = np.zeros(len(points), bool)
        subjects[crowd] = True
        subjects[triangles[weak]] = True
        near = np.flatnonzero(subjects[triangles].any(axis=1))
        self.facets = dict(zip(near.tolist(), triangles[near].tolist(), strict=True))
        reference = np.stack(_areas(*true.T[:, triangles[near].T].swapaxes(0, 1)), axis=-1)
        self.reference = dict(zip(near.tolist(), reference.tolist(), strict=True))
        self.around: dict[int, set[int]] = {vertex: set() for vertex in np.flatnonzero(subjects).tolist()}
        for facet, corners in self.facets.items():
            for vertex in corners:
                if vertex in self.around:
                    self.around[vertex].add(facet)
        self.at: dict[Point, int] = {}  # points that vertices were moved to
        self.moved: dict[int, Point] = {}
        self.merged: set[int] = set()
        self.dropped: set[int] = set()

    def run(self, groups: list[list[int]], weak: list[int]) -> None:
        for facet in weak:
            if len(set(self.facets[facet])) < 3:
                self._drop(facet)
        for group in groups:
            self._disperse([vertex for vertex in group if self.around[vertex]])
        # a repair may stand in the way of another one: a few rounds, as long as something gets better
        left = sorted(facet for facet in self.facets if not self._right(facet, {}))
        while left and (later := [facet for facet in left if not self._mend(facet)]) != left:
            left = [facet for facet in later if facet in self.facets and not self._right(facet, {})]

    def result(self, mesh: TriangleMesh, unit: float) -> TriangleMesh:
        """The mesh with everything done."""
        points, triangles = self.points.copy(), mesh.triangles.copy()
        for vertex, point in self.moved.items():
            points[vertex] = point
        for facet, corners in self.facets.items():
            triangles[facet] = corners
        kept = np.ones(len(points), bool)
        kept[sorted(self.merged)] = False
        facets = np.ones(len(triangles), bool)
        facets[sorted(self.dropped)] = False
        number = np.cumsum(kept) - 1
        return replace(
            mesh,
            vertices=points[kept] * unit,
            triangles=number[triangles[facets]],
            regions=mesh.regions[facets],
            normals=mesh.normals[facets],
        )

    # --- vertices on one point ---------------------------------------------------------------------------------------

    def _disperse(self, group: list[int]) -> None:
        """Merge those of a group that an edge joins; part the others."""
        merging = True
        while merging:
            merging = False
            for keep, gone in product(group, group):
                if keep < gone and self._mergeable(keep, gone):
                    self._merge(keep, gone)
                    group.remove(gone)
                    merging = True
                    break
        first, *others = group or [-1]
        for vertex in others:
            if not (np.array_equal(self.true[first], self.true[vertex]) and (self._open(first) or self._open(vertex))):
                self._part(vertex)

    def _part(self, vertex: int) -> None:
        """Move a vertex to the nearest free point where its facets are right, or as many of them as can be."""
        best, fewest = None, len(self.around[vertex]) + 1
        for point in self._candidates(vertex, 2):
            if not self._is_taken(point):
                wrong = sum(not self._right(facet, {vertex: point}) for facet in self.around[vertex])
                if wrong < fewest:
                    best, fewest = point, wrong
                if not wrong:
                    break
        if best is not None:
            self._move(vertex, best)

    # --- facets turned over or without area ---------------------------------------------------------------------------

    def _mend(self, facet: int) -> bool:
        """Put a facet right, without harm to another; whether that could be done."""
        if facet not in self.facets or self._right(facet, {}):
            return True
        corners = sorted(self.facets[facet])
        for vertex in corners:
            for point in self._candidates(vertex, 1):
                if not self._is_taken(point) and all(self._right(f, {vertex: point}) for f in self.around[vertex]):
                    self._move(vertex, point)
                    return True
        for keep, gone in ((a, b) for a in corners for b in corners if a != b):
            if self._within_rounding(keep, gone) and self._mergeable(keep, gone):
                kept = self.around[gone] - self.around[keep]
                if all(self._right(f, {gone: self._point(keep)}) for f in kept):
                    self._merge(keep, gone)
                    return True
        return False

    def _right(self, facet: int, places: dict[int, Point]) -> bool:
        """Whether a facet looks to the side it should, with some vertices at other `places`."""
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (places.get(v) or self._point(v) for v in self.facets[facet])
        ux, uy, uz, vx, vy, vz = bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az
        nx, ny, nz = self.reference[facet]
        upright: bool = (uy * vz - uz * vy) * nx + (uz * vx - ux * vz) * ny + (ux * vy - uy * vx) * nz > 0.0
        return upright

    # --- the surface --------------------------------------------------------------------------------------------------

    def _neighbours(self, vertex: int) -> set[int]:
        return {other for facet in self.around[vertex] for other in self.facets[facet]} - {vertex}

    def _open(self, vertex: int) -> bool:
        """Whether a vertex lies on an open edge: a neighbour that fewer than two of its facets have."""
        ring = [other for facet in self.around[vertex] for other in self.facets[facet] if other != vertex]
        return any(ring.count(other) < 2 for other in ring)

    def _mergeable(self, a: int, b: int) -> bool:
        """Whether the edge from a to b can shrink to a point and leave a surface of the same topology."""
        between = self.around[a] & self.around[b]
        if not between or len(between) > 2 or between == self.around[a] | self.around[b]:
            return False
        apexes = {other for facet in between for other in self.facets[facet]} - {a, b}
        if self._neighbours(a) & self._neighbours(b) != apexes or len(apexes) != len(between):
            return False
        if len(between) == 2 and self._open(a) and self._open(b):
            return False
        # a tetrahedron would become two facets back to back
        return not all(any(apexes <= {*self.facets[f]} for f in self.around[v] - between) for v in (a, b))

    def _merge(self, keep: int, gone: int) -> None:
        for facet in self.around[keep] & self.around[gone]:
            self._drop(facet)
        for facet in self.around.pop(gone):
            self.facets[facet] = [keep if vertex == gone else vertex for vertex in self.facets[facet]]
            self.around[keep].add(facet)
        self._leave(gone)
        self.merged.add(gone)

    def _drop(self, facet: int) -> None:
        for vertex in self.facets.pop(facet):
            if vertex in self.around:
                self.around[vertex].discard(facet)
        self.dropped.add(facet)

    # --- places -------------------------------------------------------------------------------------------------------

    def _point(self, vertex: int) -> Point:
        return self.moved.get(vertex) or _point(self.points[vertex].tolist())

    def _move(self, vertex: int, point: Point) -> None:
        self._leave(vertex)
        self.moved[vertex], self.at[point] = point, vertex

    def _leave(self, vertex: int) -> None:
        if vertex in self.moved:
            del self.at[self.moved[vertex]]

    def _step(self, vertex: int) -> float:
        """The step of the numbers at the largest coordinate of a vertex."""
        return float(self.numbers.steps(np.abs(self.true[vertex]).max(keepdims=True))[0])

    def _candidates(self, vertex: int, steps: int) -> Iterator[Point]:
        """Points that the file holds within so many steps of a vertex, nearest first."""
        offsets = self._step(vertex) * np.array([*product(range(-steps, steps + 1), repeat=3)])
        points = np.unique(self.numbers.nearest(self.true[vertex] + offsets), axis=0)
        away = ((points - self.true[vertex]) ** 2).sum(axis=1)
        yield from map(_point, points[np.argsort(away, kind="stable")].tolist())

    def _within_rounding(self, a: int, b: int) -> bool:
        return bool(np.abs(self.true[a] - self.true[b]).max() <= 2.0 * self._step(a))

    def _is_taken(self, point: Point) -> bool:
        """Whether a vertex is at a point."""
        if point in self.at:
            return True
        key = _keys(np.array([point]))[0]
        first, last = (np.searchsorted(self.ranked, key, side) for side in ("left", "right"))
        there = (v for v in self.order[first:last].tolist() if v not in self.moved and v not in self.merged)
        return any(_point(self.points[v].tolist()) == point for v in there)
