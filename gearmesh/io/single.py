"""Meshes with coordinates as files hold them, in float32 or in decimals; a closed surface stays closed.

Decimals are on the grid of `digits`. At 350 mm a step of float32 is 3e-5 mm. Rounding harms a surface in two ways. Vertices
closer than a step become one vertex for every reader that joins equal corners, as all readers of STL do. The surface then has
an edge with four facets, or is pinched at a point. A facet thinner than a step may turn over. The repair:

- Two vertices that round to one point and share an edge are merged; the two facets at the edge are left out. The common
  neighbours of both vertices must be the apexes of these two facets (the link condition), or the result is no surface.
- Other vertices that round to one point move apart, to the nearest free points.
- A facet that turned over or lost its area gets one vertex rounded another way. If that does not help, its shortest edge
  is merged.

The repair goes in the order of vertex numbers, so the same mesh gives the same file. No coordinate moves farther than two
steps of the vertex's largest coordinate. Vertices on open edges that already coincide in the mesh stay: they are meant to
be joined.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from gearmesh.io.digits import VERTEX_STEPS_PER_MM, vertices_on_grid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.grid import ROUND_UP_FRACTION
from gearmesh.mesh.triangles import Facets, TriangleMesh
from gearmesh.records import dataclass

Indices = NDArray[np.int64]
Point = tuple[float, float, float]
Components = tuple[Array, Array, Array]

#: facets that are tested together, so that their arrays stay in the cache
_FACETS_PER_CHUNK = 16384
#: largest move of a coordinate by the repair
MAX_MOVED_STEPS = 2
#: odd multipliers with well mixed bits, for the key of a point
_KEY_FACTORS = (np.uint64(0x9E3779B97F4A7C15), np.uint64(0xC2B2AE3D27D4EB4F), np.uint64(0x165667B19E3779F9))


@dataclass(frozen=True)
class _Numbers:
    """Numbers that a file can hold as coordinates."""

    #: True for float32, False for decimals on their grid
    single: bool
    #: unit of the coordinates, mm
    unit: float = 1.0
    #: float32 numbers are multiples of this (in units); 0 for all float32 numbers
    finest: float = 0.0

    def nearest(self, points: Array) -> Array:
        """Return the nearest numbers of the file as float64, in units; never a negative zero, which has other bits than 0."""
        if not self.single:
            return vertices_on_grid(points)
        single = points.astype(np.float32).astype(float)
        return (np.rint(single / self.finest) * self.finest if self.finest else single) + 0.0

    def nearest_mm(self, vertices: Array) -> Array:
        """Return vertices (N, 3), mm, at the nearest numbers of the file."""
        return self.nearest(vertices / self.unit) * self.unit

    def steps(self, points: Array) -> Array:
        """Return the distances (...) between neighbouring numbers of the file at coordinates (...), both in units."""
        if not self.single:
            return np.full_like(points, 1.0 / VERTEX_STEPS_PER_MM)
        single: Array = np.spacing(np.abs(points).astype(np.float32)).astype(float)
        return np.maximum(single, self.finest)


def in_decimals(mesh: Facets) -> Facets:
    """Return the mesh with its coordinates (mm) on the grid of decimals; facets with equal corner indices are left out."""
    return _in_numbers(mesh, _Numbers(single=False))


def decimal_steps(points: Array) -> Array:
    """Twice the largest distances (N, 3), mm, by which `in_decimals` moves coordinates (N, 3): a little more than a step."""
    return 2.0 * ROUND_UP_FRACTION * _Numbers(single=False).steps(points)


def in_single(mesh: Facets, unit: float = 1.0, finest: float = 0.0) -> Facets:
    """Return the mesh (mm) with coordinates that are float32 numbers of `unit` mm.

    With `finest` coordinates are also multiples of it (in `unit`). This matters close to zero, where float32 numbers are
    closer to each other than the absolute tolerance of some readers. Facets with equal corner indices are left out. A gear
    that repeats one tooth stays so if nothing needs repair.
    """
    return _in_numbers(mesh, _Numbers(True, unit, finest))


def _in_numbers(mesh: Facets, numbers: _Numbers) -> Facets:
    written = mesh.round(numbers.nearest_mm)
    if _is_right(mesh, written, numbers):
        return written
    return _repair_mesh(mesh.whole(), numbers)


def _is_right(mesh: Facets, written: Facets, numbers: _Numbers) -> bool:
    """True if, after rounding, no two vertices coincide and no facet lost its area or turned over."""
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
    """Return the rounded mesh, repaired if rounding did harm."""
    true, unit = mesh.vertices / numbers.unit, numbers.unit
    points = numbers.nearest(true)
    crowd, weak = _coincident(points), _weak(true, points, mesh.triangles)
    if not (len(crowd) or len(weak)):
        return replace(mesh, vertices=points * unit)
    repair = _Repair(true, points, mesh.triangles, crowd, weak, numbers)
    repair.run(_groups(points, crowd), weak.tolist())
    return repair.result(mesh, unit)


def steps(points: Array, unit: float = 1.0, finest: float = 0.0) -> Array:
    """Return the distances (N, 3), mm, between neighbouring float32 numbers of `in_single` at coordinates (N, 3), mm."""
    return _Numbers(True, unit, finest).steps(points / unit) * unit


def rounding(mesh: Facets, written: Facets) -> float:
    """Largest distance (mm) between the surface of a mesh and the surface of the same mesh in a file, `written`.

    The largest vertex displacement; an upper bound if vertices were merged.
    """
    if written is mesh:
        return 0.0
    if _same_triangles(mesh, written):
        pairs = zip(mesh.vertex_pieces(), written.vertex_pieces(), strict=True)
        return float(np.sqrt(max(((after - before) ** 2).sum(axis=1).max(initial=0.0) for before, after in pairs)))
    # a step of float32 is at most this share of the number, in whatever unit
    largest = max(float(np.abs(piece).max()) for piece in mesh.vertex_pieces())
    step = max(float(np.finfo(np.float32).eps) * largest, 1.0 / VERTEX_STEPS_PER_MM)
    return float(np.sqrt(3.0)) * MAX_MOVED_STEPS * step


def _same_triangles(mesh: Facets, written: Facets) -> bool:
    """True if the mesh of the file has the same triangles and the same number of vertices."""
    if not isinstance(written, TriangleMesh):
        # a gear that repeats its teeth: only its vertices were rounded
        return True
    if (written.vertex_count, written.triangle_count) != (mesh.vertex_count, mesh.triangle_count):
        return False
    return np.array_equal(written.whole().triangles, mesh.whole().triangles)


def _keys(points: Array) -> NDArray[np.uint64]:
    """Return keys (N,) of points (N, 3): equal points have equal keys, different points hardly ever."""
    bits = np.ascontiguousarray(points).view(np.uint64)
    key = np.zeros(len(points), np.uint64)
    for column, factor in zip(bits.T, _KEY_FACTORS, strict=True):
        key = (key ^ column) * factor
        key ^= key >> np.uint64(29)
    return key


def _coincident(points: Array) -> Indices:
    """Indices, rising, of vertices that coincide with another vertex."""
    keys = _keys(points)
    ranked = np.sort(keys)
    twice = ranked[1:][ranked[1:] == ranked[:-1]]
    if not len(twice):
        return np.empty(0, np.int64)
    shared = np.flatnonzero(np.isin(keys, twice))
    _, group, count = np.unique(points[shared], axis=0, return_inverse=True, return_counts=True)
    return shared[count[group.reshape(-1)] > 1]


def _groups(points: Array, crowd: Indices) -> list[list[int]]:
    """Group coinciding vertices by their point; groups and vertices in rising order."""
    groups: dict[Point, list[int]] = {}
    for vertex, point in zip(crowd.tolist(), points[crowd].tolist(), strict=True):
        groups.setdefault(_point(point), []).append(vertex)
    return list(groups.values())


def _point(coordinates: list[float]) -> Point:
    x, y, z = coordinates
    return x, y, z


def _weak(true: Array, points: Array, triangles: Indices) -> Indices:
    """Indices of facets that rounding turned over or left without area."""
    given, rounded = np.ascontiguousarray(true.T), np.ascontiguousarray(points.T)
    wrong = []
    for start in range(0, len(triangles), _FACETS_PER_CHUNK):
        corners = np.ascontiguousarray(triangles[start : start + _FACETS_PER_CHUNK].T)
        before, after = (_areas(*points[:, corners].swapaxes(0, 1)) for points in (given, rounded))
        wrong.append(start + np.flatnonzero(~(_agreement(before, after) > 0.0)))
    return np.concatenate(wrong)


def _agreement(before: Components, after: Components) -> Array:
    """Scalar products (T,) of vectors by components; positive if both vectors look to the same side."""
    same = before[0] * after[0]
    same += before[1] * after[1]
    same += before[2] * after[2]
    return same


def _areas(a: Array, b: Array, c: Array) -> Components:
    """Components of the normals of triangles, from components (3, T) of their corners; a normal is as long as twice the area."""
    (ux, vx), (uy, vy), (uz, vz) = ((q - p, r - p) for p, q, r in zip(a, b, c, strict=True))
    return uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx


class _Repair:
    """Repair of the facets around coinciding vertices and around facets that rounding spoilt."""

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
        # a repair can free the way for another one: repeat as long as the number of spoilt facets falls
        left = sorted(facet for facet in self.facets if not self._right(facet, {}))
        while left and (later := [facet for facet in left if not self._mend(facet)]) != left:
            left = [facet for facet in later if facet in self.facets and not self._right(facet, {})]

    def result(self, mesh: TriangleMesh, unit: float) -> TriangleMesh:
        """Return the repaired mesh."""
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
        """Merge the vertices of a group that share an edge; move the others apart."""
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
        """Move a vertex to the nearest free point with all its facets right, or with the fewest wrong ones."""
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
        """Repair a facet without harm to another facet; return True if the facet is right."""
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
        """True if a facet looks to its side of the exact mesh; `places` holds points of moved vertices."""
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (places.get(v) or self._point(v) for v in self.facets[facet])
        ux, uy, uz, vx, vy, vz = bx - ax, by - ay, bz - az, cx - ax, cy - ay, cz - az
        nx, ny, nz = self.reference[facet]
        upright: bool = (uy * vz - uz * vy) * nx + (uz * vx - ux * vz) * ny + (ux * vy - uy * vx) * nz > 0.0
        return upright

    # --- the surface --------------------------------------------------------------------------------------------------

    def _neighbours(self, vertex: int) -> set[int]:
        return {other for facet in self.around[vertex] for other in self.facets[facet]} - {vertex}

    def _open(self, vertex: int) -> bool:
        """True if a vertex lies on an open edge: fewer than two of its facets share a neighbour."""
        ring = [other for facet in self.around[vertex] for other in self.facets[facet] if other != vertex]
        return any(ring.count(other) < 2 for other in ring)

    def _mergeable(self, a: int, b: int) -> bool:
        """True if the edge from a to b can shrink to a point without a change of topology."""
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
        """Return the step of the file's numbers at the largest coordinate of a vertex, in units."""
        return float(self.numbers.steps(np.abs(self.true[vertex]).max(keepdims=True))[0])

    def _candidates(self, vertex: int, steps: int) -> Iterator[Point]:
        """Yield the points of the file within `steps` steps of a vertex, nearest first."""
        offsets = self._step(vertex) * np.array([*product(range(-steps, steps + 1), repeat=3)])
        points = np.unique(self.numbers.nearest(self.true[vertex] + offsets), axis=0)
        away = ((points - self.true[vertex]) ** 2).sum(axis=1)
        yield from map(_point, points[np.argsort(away, kind="stable")].tolist())

    def _within_rounding(self, a: int, b: int) -> bool:
        return bool(np.abs(self.true[a] - self.true[b]).max() <= 2.0 * self._step(a))

    def _is_taken(self, point: Point) -> bool:
        """True if a vertex is at the point."""
        if point in self.at:
            return True
        key = _keys(np.array([point]))[0]
        first, last = (np.searchsorted(self.ranked, key, side) for side in ("left", "right"))
        there = (v for v in self.order[first:last].tolist() if v not in self.moved and v not in self.merged)
        return any(_point(self.points[v].tolist()) == point for v in there)
