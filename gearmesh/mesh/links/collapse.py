"""Collapse of edges of a triangulation in the (s, t) plane, and choice of edges that can collapse at once.

The ring of an edge consists of the triangles at either end without those on the edge itself. They stay when the edge
collapses, with one common node in place of both ends. The result is a triangulation if they all keep their orientation.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass

Index = NDArray[np.int64]

#: passes of the choice of independent edges; each takes edges beside no chosen edge
CHOICE_PASSES = 4
#: largest area in the (s, t) plane that counts as 0
FLAT_AREA = 1e-12


@dataclass(frozen=True)
class Incidence:
    """Edges, triangles and nodes of a triangulation, and how they meet."""

    #: nodes (E, 2) of the edges
    edges: Index
    #: edges (M, 3) opposite to the corners of the triangles
    sides: Index
    #: number of triangles (E,) at each edge
    count: Index
    #: corners (3 M,), numbered 3 triangle + corner, sorted by their nodes
    corners: Index
    #: index (N + 1,) in `corners` at which the corners of each node begin
    begins: Index

    @staticmethod
    def of(triangles: Index, nodes: int) -> Incidence:
        """Return the incidence of triangles (M, 3) between `nodes` nodes; side k is opposite to corner k."""
        edges, sides = edges_of(triangles, nodes)
        corners = np.argsort(triangles.ravel(), kind="stable")
        begins = np.searchsorted(triangles.ravel()[corners], np.arange(nodes + 1))
        return Incidence(edges, sides, np.bincount(sides.ravel(), minlength=len(edges)), corners, begins)

    def corners_at(self, nodes: Index) -> tuple[Index, Index]:
        """Return the corners (K,) at nodes (N,), node by node, and the index (K,) of the node of each corner."""
        first, count = self.begins[nodes], self.begins[nodes + 1] - self.begins[nodes]
        place = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
        return self.corners[np.repeat(first, count) + place], np.repeat(np.arange(nodes.size), count)

    def quadrilaterals(self, triangles: Index) -> tuple[Index, Index, Index, Index, Index, Index]:
        """Return the quadrilaterals of two triangles with a common edge; six arrays (K,).

        - first and second triangle.
        - corner `apex` of the first triangle off the edge.
        - start `b` of the edge.
        - corner `far` of the second triangle off the edge.
        - end `c` of the edge.
        """
        order = np.argsort(self.sides.ravel(), kind="stable")
        inner = np.flatnonzero(self.count == 2)
        begins = np.cumsum(self.count) - self.count
        (first, k), (second, m) = (np.divmod(order[begins[inner] + i], 3) for i in (0, 1))
        apex, far = triangles[first, k], triangles[second, m]
        return first, second, apex, triangles[first, (k + 1) % 3], far, triangles[first, (k + 2) % 3]


def edges_of(triangles: Index, count: int) -> tuple[Index, Index]:
    """Return the edges (E, 2) of triangles (M, 3) between `count` nodes, and the edges (M, 3) opposite to their corners."""
    low, high = np.moveaxis(np.sort(triangles[:, [[1, 2], [2, 0], [0, 1]]], axis=-1), -1, 0)
    coded, side = np.unique(low * count + high, return_inverse=True)
    return np.stack(np.divmod(coded, count), axis=-1), side.reshape(-1, 3)


@dataclass(frozen=True)
class Rings:
    """Rings of C edges: the triangles that stay when an edge collapses."""

    #: triangles (J,) of the rings, edge by edge
    ring: Index
    #: edge (J,) of each triangle, rising
    owner: Index
    #: node (J,) of each triangle after the end of the edge, counterclockwise
    after: Index
    #: node (J,) of each triangle before the end of the edge
    before: Index
    #: triangle (J,) of the ring that begins at the node before; -1 if there is none
    following: Index
    #: index (C,) at which the ring of each edge begins
    begins: Index
    #: triangles (K,) at the ends of the edges, those on the edges included
    taken: Index
    #: edge (K,) of each of them
    taken_by: Index

    @staticmethod
    def of(triangles: Index, incidence: Incidence, edges: Index) -> Rings:
        """Return the rings of edges (C, 2) of a triangulation (M, 3)."""
        ends = edges.ravel()
        corners, end = incidence.corners_at(ends)
        triangle, corner = np.divmod(corners, 3)
        # triangles on the edge have its other end as a corner: they are not in the ring
        other = ends[end ^ 1]
        after, before = triangles[triangle, (corner + 1) % 3], triangles[triangle, (corner + 2) % 3]
        ring = (after != other) & (before != other)
        taken_by = end // 2
        owner, after, before = taken_by[ring], after[ring], before[ring]
        follows = following(owner, after, before, incidence.begins.size)
        begins = np.searchsorted(owner, np.arange(len(edges)))
        return Rings(triangle[ring], owner, after, before, follows, begins, triangle, taken_by)

    def collapses(self, edges: Index, at: Array, st: Array) -> Collapses:
        """Return the collapse of edges (C, 2) into their first nodes, at places `at` (C, 2); `st` (N, 2): all nodes."""
        keep, (count, size) = edges[:, 0], (len(edges), self.owner.size)
        nodes = np.concatenate((keep, self.after, self.before))
        after = count + np.arange(size)
        corners = np.stack((self.owner, after, after + size), axis=1)
        by = np.concatenate((np.arange(count), self.owner, self.owner))
        return Collapses(edges, self.ring, corners, self.owner, nodes, by, np.concatenate((at, st[nodes[count:]])))

    def of_some(self, chosen: NDArray[np.bool_]) -> Rings:
        """Return the rings of the `chosen` (C,) edges, which are numbered anew."""
        kept, number = chosen[self.owner], np.cumsum(chosen) - 1
        place = np.cumsum(kept) - 1
        owner, taken, follows = number[self.owner[kept]], chosen[self.taken_by], self.following[kept]
        return Rings(
            self.ring[kept],
            owner,
            self.after[kept],
            self.before[kept],
            np.where(follows < 0, -1, place[follows]),
            np.searchsorted(owner, np.arange(int(chosen.sum()))),
            self.taken[taken],
            number[self.taken_by[taken]],
        )


@dataclass(frozen=True)
class Collapses:
    """Collapse of C edges into their first nodes."""

    #: nodes (C, 2) of the edges
    edges: Index
    #: triangles (J,) that stay and change
    ring: Index
    #: their new corners (J, 3), as indices in `nodes`
    corners: Index
    #: edge (J,) that changes each triangle, rising
    owner: Index
    #: nodes (V,) of the changed triangles
    nodes: Index
    #: edge (V,) that each node belongs to
    by: Index
    #: places (V, 2) of the nodes after the collapse
    places: Array


def following(owner: Index, after: Index, before: Index, count: int) -> Index:
    """Return for each of J triangles around a common corner the triangle that begins at its node before; -1 if there is none.

    - owner: number (J,) of the common corner.
    - after, before: nodes (J,) of the triangles after and before the common corner.
    - count: number of nodes.
    """
    codes, wanted = owner * count + after, owner * count + before
    order = np.argsort(codes, kind="stable")
    codes = codes[order]
    place = np.minimum(np.searchsorted(codes, wanted), codes.size - 1)
    follows: Index = np.where(codes[place] == wanted, order[place], -1)
    return follows


def independent(taken: Index, taken_by: Index, cost: Array, triangles: int) -> Index:
    """Return the changes that can be made at once, the cheapest first: no two of them share a triangle.

    - taken: triangles (K,) that the changes need.
    - taken_by: change (K,) that needs each of them.
    - cost: costs (C,) of the changes; infinite costs are never chosen.
    - triangles: number of triangles.
    """
    rank = np.empty(cost.size, dtype=np.int64)
    rank[np.argsort(cost, kind="stable")] = np.arange(cost.size)
    alive, chosen = np.isfinite(cost), np.zeros(cost.size, dtype=bool)
    for _ in range(CHOICE_PASSES):
        # a change is chosen if it has the least cost at all its triangles; then its triangles are gone for the others
        held = alive[taken_by]
        if not held.any():
            # what needs no triangle is in nobody's way
            chosen |= alive
            break
        claim = np.full(triangles, cost.size)
        np.minimum.at(claim, taken[held], rank[taken_by[held]])
        first = alive.copy()
        first[taken_by[claim[taken] != rank[taken_by]]] = False
        chosen |= first
        free = np.ones(triangles, dtype=bool)
        free[taken[first[taken_by]]] = False
        alive[taken_by[~free[taken]]] = False
    return np.flatnonzero(chosen)


def area(a: Array, b: Array, c: Array) -> Array:
    """Return twice the areas (...,) of triangles with corners (..., 2); positive if counterclockwise."""
    twice: Array = (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1]) - (c[..., 0] - a[..., 0]) * (b[..., 1] - a[..., 1])
    return twice


def within_link(places: Array, near: Array) -> Array:
    """Return places (..., 2) moved into the link of places `near` (..., 2).

    Link k has s from 2 k to 2 k + 1, and t from 0 to 1.
    """
    low = np.stack((2.0 * np.floor(0.5 * near[..., 0]), np.zeros(near.shape[:-1])), axis=-1)
    inside: Array = np.clip(places, low, low + 1.0)
    return inside
