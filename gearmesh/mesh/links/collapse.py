"""Edges of a triangulation in the (s, t) plane that may collapse into one node, and which of them may do so at once.

The triangles at either end of an edge, but for those on the edge itself, are its ring: they stay, with one common node in
place of both ends. Where all of them keep their orientation the triangulation stays one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array

Index = NDArray[np.int64]

#: passes in which edges that touch no chosen one are chosen from those left
PASSES = 4
#: area in the (s, t) plane below which a triangle has none
FLAT = 1e-12


@dataclass(frozen=True)
class Incidence:
    """Which edges (E, 2) a triangulation has, which of them are the sides of each triangle (M, 3), in how many triangles
    (E,) each is, and the corners, 3 times the triangle and the corner, at every node: those of node n are `corners` from
    `begins`[n] on."""

    edges: Index
    sides: Index
    count: Index
    corners: Index
    begins: Index

    @staticmethod
    def of(triangles: Index, nodes: int) -> Incidence:
        """Of triangles (M, 3) between so many nodes; side k is opposite to corner k."""
        edges, sides = edges_of(triangles, nodes)
        corners = np.argsort(triangles.ravel(), kind="stable")
        begins = np.searchsorted(triangles.ravel()[corners], np.arange(nodes + 1))
        return Incidence(edges, sides, np.bincount(sides.ravel(), minlength=len(edges)), corners, begins)

    def corners_at(self, nodes: Index) -> tuple[Index, Index]:
        """Corners (K,) at nodes (N,), one node after the other, and at which of them each is (K,)."""
        first, count = self.begins[nodes], self.begins[nodes + 1] - self.begins[nodes]
        place = np.arange(count.sum()) - np.repeat(np.cumsum(count) - count, count)
        return self.corners[np.repeat(first, count) + place], np.repeat(np.arange(nodes.size), count)

    def quadrilaterals(self, triangles: Index) -> tuple[Index, Index, Index, Index, Index, Index]:
        """Of every edge between two triangles of these (M, 3): one and the other, the former's corners off and on the edge, as
        `apex` and `b`, the latter's corner off it, `far`, and the other end `c`; all (K,)."""
        order = np.argsort(self.sides.ravel(), kind="stable")
        inner = np.flatnonzero(self.count == 2)
        begins = np.cumsum(self.count) - self.count
        (one, k), (other, m) = (np.divmod(order[begins[inner] + i], 3) for i in (0, 1))
        apex, far = triangles[one, k], triangles[other, m]
        return one, other, apex, triangles[one, (k + 1) % 3], far, triangles[one, (k + 2) % 3]


def edges_of(triangles: Index, count: int) -> tuple[Index, Index]:
    """Edges (E, 2) between `count` nodes, and which are those of each triangle (M, 3), opposite to its corners."""
    low, high = np.moveaxis(np.sort(triangles[:, [[1, 2], [2, 0], [0, 1]]], axis=-1), -1, 0)
    coded, side = np.unique(low * count + high, return_inverse=True)
    return np.stack(np.divmod(coded, count), axis=-1), side.reshape(-1, 3)


@dataclass(frozen=True)
class Rings:
    """The rings of edges (C, 2): triangles `ring` (J,), the `owner` (J,) of each, in order, and their nodes `after` (J,) and
    `before` (J,) the end of the edge, counterclockwise; `following` (J,): which of them begins at the node before it, -1 if
    none does; `begins` (C,). `taken` (K,) and `taken_by` (K,): all triangles at the edges' ends."""

    ring: Index
    owner: Index
    after: Index
    before: Index
    following: Index
    begins: Index
    taken: Index
    taken_by: Index

    @staticmethod
    def of(triangles: Index, incidence: Incidence, edges: Index) -> Rings:
        ends = edges.ravel()
        corners, end = incidence.corners_at(ends)
        triangle, corner = np.divmod(corners, 3)
        # the other end of the edge
        other = ends[end ^ 1]
        after, before = triangles[triangle, (corner + 1) % 3], triangles[triangle, (corner + 2) % 3]
        ring = (after != other) & (before != other)
        taken_by = end // 2
        owner, after, before = taken_by[ring], after[ring], before[ring]
        follows = following(owner, after, before, incidence.begins.size)
        begins = np.searchsorted(owner, np.arange(len(edges)))
        return Rings(triangle[ring], owner, after, before, follows, begins, triangle, taken_by)

    def collapses(self, edges: Index, at: Array, st: Array) -> Collapses:
        """What they make of nodes st (N, 2) when these edges (C, 2) collapse into their first nodes, at places (C, 2)."""
        keep, (count, size) = edges[:, 0], (len(edges), self.owner.size)
        nodes = np.concatenate((keep, self.after, self.before))
        after = count + np.arange(size)
        corners = np.stack((self.owner, after, after + size), axis=1)
        by = np.concatenate((np.arange(count), self.owner, self.owner))
        return Collapses(edges, self.ring, corners, self.owner, nodes, by, np.concatenate((at, st[nodes[count:]])))

    def of_some(self, chosen: NDArray[np.bool_]) -> Rings:
        """Of the `chosen` (C,) edges alone, numbered as they are among them."""
        own, number = chosen[self.owner], np.cumsum(chosen) - 1
        place = np.cumsum(own) - 1
        owner, taken, follows = number[self.owner[own]], chosen[self.taken_by], self.following[own]
        return Rings(
            self.ring[own],
            owner,
            self.after[own],
            self.before[own],
            np.where(follows < 0, -1, place[follows]),
            np.searchsorted(owner, np.arange(int(chosen.sum()))),
            self.taken[taken],
            number[self.taken_by[taken]],
        )


@dataclass(frozen=True)
class Collapses:
    """Edges (C, 2) collapse into their first nodes: triangles `ring` (J,) get the corners (J, 3) among the `nodes` (V,), which go
    to `places` (V, 2); each of the former is there by the edge `owner` (J,), ascending, of the latter by the edge `by` (V,)."""

    edges: Index
    ring: Index
    corners: Index
    owner: Index
    nodes: Index
    by: Index
    places: Array


def following(owner: Index, after: Index, before: Index, count: int) -> Index:
    """Which of the triangles (J,) at a corner that they have in common, the `owner` (J,), begins at the node before each of
    them, -1 if none does; of so many nodes."""
    codes, wanted = owner * count + after, owner * count + before
    order = np.argsort(codes, kind="stable")
    codes = codes[order]
    place = np.minimum(np.searchsorted(codes, wanted), codes.size - 1)
    follows: Index = np.where(codes[place] == wanted, order[place], -1)
    return follows


def independent(taken: Index, taken_by: Index, cost: Array, triangles: int) -> Index:
    """Which (K,) of several changes of finite cost (C,) can be made at once, cheap ones first: no two have a triangle in common.

    `taken` (K,): triangles, of so many, that the changes `taken_by` (K,) need.
    """
    rank = np.empty(cost.size, dtype=np.int64)
    rank[np.argsort(cost, kind="stable")] = np.arange(cost.size)
    alive, chosen = np.isfinite(cost), np.zeros(cost.size, dtype=bool)
    for _ in range(PASSES):
        held = alive[taken_by]
        if not held.any():
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
    """Twice the areas (...,) of triangles with corners (..., 2), positive if counterclockwise."""
    twice: Array = (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1]) - (c[..., 0] - a[..., 0]) * (b[..., 1] - a[..., 1])
    return twice


def within_link(places: Array, near: Array) -> Array:
    """Places (..., 2) moved into the link of others (..., 2): s goes from 2 k to 2 k + 1 on link k, t from 0 to 1."""
    low = np.stack((2.0 * np.floor(0.5 * near[..., 0]), np.zeros(near.shape[:-1])), axis=-1)
    inside: Array = np.clip(places, low, low + 1.0)
    return inside
