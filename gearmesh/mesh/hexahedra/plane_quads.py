"""Quadrilaterals in a plane between closed lines, for bodies that are cut along the axis.

Triangles are refined by the circumcentres of those that are too large or too flat (Chew, Ruppert), smoothed, and divided
into three quadrilaterals each. Edges follow the lines: their nodes are on the exact curves.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, distinct, plane_cross
from gearmesh.kernel.numeric.polylines import contains
from gearmesh.records import dataclass

#: largest circumradius of a triangle over the wanted length of its edges there; 0.577 if equilateral
MAX_RADIUS_SHARE = 0.7
#: largest circumradius over the shortest edge: angles of 27 deg and more
MAX_RADIUS_PER_EDGE = 1.1
#: growth of the edges' length per unit of distance from the lines
EDGE_GROWTH = 0.4
#: least distance of two new points, in wanted lengths of edges
MIN_APART_LENGTHS = 0.75
#: shortest edge that is divided for its angle alone, in wanted lengths
MIN_EDGE_LENGTHS = 0.35
#: part of a first edge on a line down to which it is divided for the angles beside it
MIN_DIVIDED_SHARE = 0.3
#: largest number of rounds of refinement
MAX_ROUNDS = 60
#: rounds of smoothing
SMOOTHING_ROUNDS = 4
#: largest number of points
MAX_POINTS = 60_000
#: rounding of the points that decide which triangles are formed, as a share of the size of the figure
ROUNDING_SHARE = 1e-10
#: segments whose circles a new point is checked against
SEGMENTS_CHECKED = 6

Index = NDArray[np.int64]


class PlaneMeshError(Exception):
    """The area cannot be meshed with edges on its lines."""


class EdgeCurve(Protocol):
    """A curve with points at s from 0 to 1."""

    def at(self, s: Array) -> Array:
        """Return points (K, 2) at s (K,), mm."""


@dataclass(frozen=True)
class NodeLine:
    """Closed line whose nodes are given: edges have their ends at every other node, or every fourth with mid-side nodes."""

    #: nodes (N, 2), mm, counterclockwise
    nodes: Array

    def at(self, s: Array) -> Array:
        """Return the nodes nearest to s (K,)."""
        return np.asarray(self.nodes[np.rint(s * len(self.nodes)).astype(int) % len(self.nodes)])


@dataclass(frozen=True)
class Line:
    """A closed line of curves that edges follow."""

    #: curves, each beginning where the one before ends
    curves: tuple[EdgeCurve, ...]
    #: number of edges of triangles on each curve
    edges: tuple[int, ...]
    #: True if edges may not be divided
    fixed: bool = False


@dataclass(frozen=True)
class PlaneQuads:
    """Quadrilaterals with their edges."""

    #: nodes (N, 2), mm
    points: Array
    #: corners (Q, 4), counterclockwise
    quads: Index
    #: edges (Q, 4) of the quadrilaterals, from each corner to the next
    edges_of: Index
    #: mid-side nodes (E, 2), mm, of the edges, on their curves
    middles: Array
    #: number of the line (E,) that an edge is on; -1 for none
    line: Index
    #: number of the curve (E,) in its line
    curve: Index
    #: places (N,) of nodes on a line of given nodes, 0 to 1; NaN elsewhere
    node_place: Array
    #: places (E,) of middles on a line of given nodes, 0 to 1; NaN elsewhere
    middle_place: Array


def plane_quads(lines: Sequence[Line], size: float) -> PlaneQuads:
    """Return the quadrilaterals between lines.

    - lines: the outer and the inner boundary of the area, then lines inside it, apart from each other.
    - size: largest length, mm, of the edges of triangles, which are twice as long as those of quadrilaterals.

    Raises PlaneMeshError.
    """
    return _Refinement(lines, size).quads()


class _Refinement:
    """Points, and segments of lines between them."""

    def __init__(self, lines: Sequence[Line], size: float) -> None:
        self._lines, self._size = lines, size
        points, segments, places, count = [], [], [], 0
        for number, line in enumerate(lines):
            first = count
            for k, (curve, edges) in enumerate(zip(line.curves, line.edges, strict=True)):
                s = np.linspace(0.0, 1.0, edges + 1)
                points.append(curve.at(s[:-1]))
                index = count + np.arange(edges)
                segments.append(np.column_stack((index, index + 1, np.full(edges, number), np.full(edges, k))))
                places.append(np.column_stack((s[:-1], s[1:])))
                count += edges
            segments[-1][-1, 1] = first
        self._points = np.concatenate(points)
        self._segments, self._places = np.concatenate(segments), np.concatenate(places)
        start, end = (self._points[self._segments[:, k]] for k in (0, 1))
        # lengths (S,) that segments had before they were divided for angles
        self._spacing = np.linalg.norm(end - start, axis=-1)
        self._free = np.zeros(count, dtype=bool)
        self._rounding = ROUNDING_SHARE * float(np.ptp(self._points, axis=0).max())

    def quads(self) -> PlaneQuads:
        """Return the refined quadrilaterals."""
        for _ in range(MAX_ROUNDS):
            triangles = self._triangles()
            if not self._refine(triangles):
                break
        for _ in range(SMOOTHING_ROUNDS):
            self._smooth(triangles)
            triangles = self._triangles()
        return self._divide(triangles)

    def _triangles(self) -> Index:
        """Return the triangles (T, 3), counterclockwise, in the area, after dividing segments that are no edges."""
        from scipy.spatial import Delaunay

        for _ in range(MAX_ROUNDS):
            points = np.rint(self._points / self._rounding) * self._rounding
            triangles = Delaunay(points).simplices.astype(np.int64)
            edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
            keys = distinct(edges[:, 0] * len(points) + edges[:, 1])
            ends = np.sort(self._segments[:, :2], axis=1)
            missing = ~np.isin(ends[:, 0] * len(points) + ends[:, 1], keys)
            if not missing.any():
                break
            self._mend(np.flatnonzero(missing))
            if len(self._points) > MAX_POINTS:
                raise PlaneMeshError
        else:
            raise PlaneMeshError
        a, b, c = np.moveaxis(self._points[triangles], 1, 0)
        area = plane_cross(b - a, c - a)
        triangles[area < 0.0] = triangles[area < 0.0][:, ::-1]
        inside: Index = triangles[(np.abs(area) > self._rounding**2) & self._inside((a + b + c) / 3.0)]
        return inside

    def _inside(self, centres: Array) -> NDArray[np.bool_]:
        """Return True for points (T, 2) in the area: between the boundaries, whose edges are chords."""
        ends = [self._segments[self._segments[:, 2] == k] for k in (0, 1)]
        outlines = [self._points[line[:, 0]] for line in (_in_order(part) for part in ends)]
        return np.asarray(contains(outlines[0], centres) & ~contains(outlines[1], centres))

    def _mend(self, missing: Index) -> None:
        """Divide segments; remove free points near those that may not be divided."""
        fixed = np.array([self._lines[k].fixed for k in self._segments[missing, 2]])
        self._spacing[missing[~fixed]] *= 0.5
        self._split(missing[~fixed])
        if not fixed.any():
            return
        from scipy.spatial import cKDTree

        start, end = (self._points[self._segments[missing[fixed], k]] for k in (0, 1))
        near = cKDTree(self._points).query_ball_point(0.5 * (start + end), 0.5 * np.linalg.norm(end - start, axis=-1))
        there = distinct(np.concatenate([np.array(found, dtype=int) for found in near]))
        self._remove(there[self._free[there]])

    def _remove(self, gone: Index) -> None:
        if not gone.size:
            raise PlaneMeshError
        kept = np.setdiff1d(np.arange(len(self._points)), gone)
        number = np.full(len(self._points), -1)
        number[kept] = np.arange(len(kept))
        self._points, self._free = self._points[kept], self._free[kept]
        self._segments[:, :2] = number[self._segments[:, :2]]

    def _split(self, which: Index) -> None:
        """Divide segments in the middle of their curves."""
        if not which.size:
            return
        middle = self._places[which].mean(axis=1)
        points = np.array([self._curve(k).at(np.array([s]))[0] for k, s in zip(which, middle, strict=True)])
        new = len(self._points) + np.arange(len(which))
        second, places = self._segments[which].copy(), self._places[which].copy()
        second[:, 0], places[:, 0] = new, middle
        self._segments[which, 1], self._places[which, 1] = new, middle
        self._segments = np.concatenate((self._segments, second))
        self._places = np.concatenate((self._places, places))
        self._spacing = np.concatenate((self._spacing, self._spacing[which]))
        self._points = np.concatenate((self._points, points))
        self._free = np.concatenate((self._free, np.zeros(len(new), dtype=bool)))

    def _curve(self, segment: int) -> EdgeCurve:
        _, _, line, curve = self._segments[segment]
        found: EdgeCurve = self._lines[line].curves[curve]
        return found

    def _lengths(self, places: Array) -> Array:
        """Return the wanted lengths (K,) of edges at places (K, 2): they grow away from the segments."""
        distance, nearest = self._tree.query(places)
        length = self._spacing[nearest]
        return np.asarray(np.minimum(self._size, length + EDGE_GROWTH * np.maximum(distance - 0.5 * length, 0.0)))

    def _refine(self, triangles: Index) -> bool:
        """Add circumcentres of bad triangles; return False if there are none."""
        from scipy.spatial import cKDTree

        a, b, c = np.moveaxis(self._points[triangles], 1, 0)
        u, v = b - a, c - a
        area = plane_cross(u, v)
        # circumcentre relative to a
        across = (u**2).sum(axis=-1)[:, None] * v - (v**2).sum(axis=-1)[:, None] * u
        centre = np.stack((across[:, 1], -across[:, 0]), axis=-1) / (2.0 * area[:, None])
        radius, places = np.linalg.norm(centre, axis=-1), a + centre
        shortest = np.min([np.linalg.norm(side, axis=-1) for side in (u, v, v - u)], axis=0)
        start, end = (self._points[self._segments[:, k]] for k in (0, 1))
        self._tree = cKDTree(0.5 * (start + end))
        wanted = self._lengths((a + b + c) / 3.0)
        flat = (radius > MAX_RADIUS_PER_EDGE * shortest) & (shortest > MIN_EDGE_LENGTHS * wanted)
        badness = np.where(flat | (radius > MAX_RADIUS_SHARE * wanted), radius / wanted, 0.0)
        order = np.argsort(-badness, kind="stable")[: np.count_nonzero(badness)]
        if not order.size:
            return False
        # a centre in the circle over a segment divides the segment instead
        half = 0.5 * np.linalg.norm(end - start, axis=-1)
        count = min(SEGMENTS_CHECKED, len(half))
        distance, near = self._tree.query(places[order], k=count)
        encroached = distance < half[near] * (1.0 - 1e-9)
        divided = distinct(near[encroached])
        fixed = np.array([self._lines[k].fixed for k in self._segments[divided, 2]], dtype=bool)
        width = np.diff(self._places[divided], axis=1)[:, 0]
        edges = np.array([self._lines[k].edges[curve] for k, curve in self._segments[divided, 2:]], dtype=int)
        divided = divided[~fixed & (width * edges > MIN_DIVIDED_SHARE)]
        clear = order[~encroached.any(axis=1)]
        chosen = _apart(places[clear], MIN_APART_LENGTHS * np.minimum(wanted[clear], radius[clear]))
        added = places[clear[chosen]]
        self._points = np.concatenate((self._points, added))
        self._free = np.concatenate((self._free, np.ones(len(added), dtype=bool)))
        self._split(divided)
        return bool(len(added) or len(divided))

    def _smooth(self, triangles: Index) -> None:
        """Move free points to the means of their neighbours."""
        pairs = triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
        total, count = np.zeros_like(self._points), np.zeros(len(self._points))
        for i, j in (pairs.T, pairs.T[::-1]):
            np.add.at(total, i, self._points[j])
            np.add.at(count, i, 1.0)
        moved = self._free & (count > 0)
        self._points[moved] = total[moved] / count[moved, None]

    def _divide(self, triangles: Index) -> PlaneQuads:
        """Return three quadrilaterals for each triangle."""
        pairs = triangles[:, [[0, 1], [1, 2], [2, 0]]]
        edges, edge_of = np.unique(np.sort(pairs.reshape(-1, 2), axis=1), axis=0, return_inverse=True)
        edge_of = edge_of.reshape(-1, 3)
        segment_of = {tuple(sorted(ends)): k for k, ends in enumerate(self._segments[:, :2].tolist())}
        segment = np.array([segment_of.get((i, j), -1) for i, j in edges.tolist()])
        on = np.flatnonzero(segment >= 0)
        middle = self._points[edges].mean(axis=1)
        middle[on] = self._at(segment[on], 0.5)
        first_middle, first_centre = len(self._points), len(self._points) + len(edges)
        points = np.concatenate((self._points, middle, middle[edge_of].mean(axis=1)))
        centre = first_centre + np.arange(len(triangles))
        v, m = triangles, first_middle + edge_of
        quads = np.concatenate([np.column_stack((v[:, k], m[:, k], centre, m[:, k - 1])) for k in range(3)])
        ends = np.stack((quads, np.roll(quads, -1, axis=1)), axis=-1)
        halves, edges_of = np.unique(np.sort(ends.reshape(-1, 2), axis=1), axis=0, return_inverse=True)
        middles = points[halves].mean(axis=1)
        line, curve = np.full((2, len(halves)), -1)
        node_place, middle_place = np.full(len(points), np.nan), np.full(len(halves), np.nan)
        # edges from a vertex to the middle of a segment
        at = halves[:, 1] - first_middle
        half_segment = np.where((at >= 0) & (at < len(edges)) & (halves[:, 0] < first_middle), at, -1)
        half_segment = np.where(half_segment >= 0, segment[half_segment], -1)
        which = np.flatnonzero(half_segment >= 0)
        its = half_segment[which]
        line[which], curve[which] = self._segments[its, 2], self._segments[its, 3]
        share = np.where(self._segments[its, 0] == halves[which, 0], 0.25, 0.75)
        middles[which] = self._at(its, share)
        fixed = np.array([self._lines[k].fixed for k in line[which]], dtype=bool)
        low, high = self._places[its[fixed]].T
        middle_place[which[fixed]] = low + share[fixed] * (high - low)
        node_place[halves[which[fixed], 1]] = 0.5 * (low + high)
        node_place[halves[which[fixed], 0]] = np.where(share[fixed] < 0.5, low, high)
        used, number = np.unique(quads, return_inverse=True)
        return PlaneQuads(
            points[used],
            number.reshape(-1, 4),
            edges_of.reshape(-1, 4),
            middles,
            line,
            curve,
            node_place[used],
            middle_place,
        )

    def _at(self, segments: Index, share: float | Array) -> Array:
        """Return points (K, 2) on segments' curves, at a share of each segment."""
        low, high = self._places[segments].T
        places = low + share * (high - low)
        return np.array([self._curve(k).at(np.array([s]))[0] for k, s in zip(segments, places, strict=True)])


def _in_order(segments: Index) -> Index:
    """Return the segments (K, 4) of a closed line, each beginning where the one before ends."""
    following = {int(row[0]): k for k, row in enumerate(segments)}
    order, at = [], 0
    for _ in range(len(segments)):
        order.append(at)
        at = following[int(segments[at, 1])]
    return segments[order]


def _apart(places: Array, distances: Array) -> Index:
    """Return the numbers of places (K, 2), in their order, that are not nearer to an earlier one than `distances` (K,)."""
    from scipy.spatial import cKDTree

    taken = np.zeros(len(places), dtype=bool)
    free = np.ones(len(places), dtype=bool)
    near = cKDTree(places).query_ball_point(places, distances) if len(places) else []
    for k, others in enumerate(near):
        if free[k]:
            taken[k] = True
            free[others] = False
    return np.flatnonzero(taken)
