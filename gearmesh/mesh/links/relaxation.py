"""Edges that collapse while the nodes round them move, where the collapse alone would miss the tolerance.

Single collapses come to rest where facets use three quarters of the tolerance: each of them needs what its ring has left.
Here the triangles at all nodes of the ring are a patch, of which each edge has a copy for itself, so that all edges are tried
at once; the copy's inner nodes, and those of the section curves at toe and heel along these, go one after the other to the best
of eight places round them, time and again. What counts is the sum of a high power of the distances of the triangles at a node,
so that all of them come closer, the worst first.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, distinct
from gearmesh.mesh.links.collapse import Collapses, Incidence, Index, Rings, following, independent, within_link
from gearmesh.mesh.links.prediction import Prediction

#: places tried round a node, the one where it is first
PLACES = np.array([[0.0, 0.0]] + [[x, y] for x in (-1.0, 0.0, 1.0) for y in (-1.0, 0.0, 1.0) if x or y])
#: first as far as this share of the edges opposite to the node, half as far where none is better
REACH, CLOSER = 0.1, 0.5
#: a number without small factors
SPREAD = 7_368_787
#: a diagonal turns for a sum of powers this much smaller
GAIN = 0.98


#: distances of triangles above this share of the tolerance are too large where only those count
ALLOWED = 0.985


@dataclass(frozen=True)
class Patience:
    """How much is tried for an edge: those that miss the tolerance by more than `far` times are not, of those whose patches overlap
    `layers` at once, or up to `many` in all if that is more.

    `stages`: sweeps over all nodes of a patch, and by which factor it may miss the tolerance after them: where it is more it is
    given up. `turning`: diagonals turn before each of them, and only what is too far counts, so that all room is used.
    """

    far: float = 2.0
    layers: int = 3
    many: int = 60
    stages: tuple[tuple[int, float], ...] = ((2, 1.25), (2, 1.1), (4, 1.02))
    turning: bool = False


@dataclass(frozen=True)
class Patches:
    """Copies of the patches of edges (C, 2) once these have collapsed: triangles `ring` (J,) of the net with corners (J, 3), each
    of the patch `owner` (J,), ascending; at corners are `nodes` (V,) of the net, in patches `patch` (V,), at `places` (V, 2).

    Nodes move in their `turn` (V,), none with the same turn as a neighbour, or stay, -1, within `reach` (V, 2), at toe and heel
    along s. `twin` (V,): the node in the same place on the other side of a seam, -1 of others; both move together, along t.
    """

    ring: Index
    corners: Index
    owner: Index
    nodes: Index
    patch: Index
    places: Array
    turn: Index
    reach: Array
    twin: Index

    @staticmethod
    def of(
        triangles: Index, incidence: Incidence, edges: Index, at: Array, st: Array, turn: Index, twin: Index
    ) -> Patches:
        """Of edges that collapse into their first nodes at places (C, 2), of nodes st (N, 2) that take their `turns`; those on
        seams on both sides of these, where their `twin` (N,) nodes are."""
        count = len(st)
        inner, owner, ring = around(triangles, incidence, edges, st, twin)
        corners, on_seam = triangles[ring], on_seams(edges, st, twin)
        (keep, gone), (other_keep, other_gone) = edges.T, np.where(on_seam[:, None], twin[edges], -1).T
        for first, last in ((keep, gone), (other_keep, other_gone)) if on_seam.any() else ((keep, gone),):
            corners = np.where(corners == last[owner, None], first[owner, None], corners)
        left = (corners != np.roll(corners, 1, axis=1)).all(axis=1)
        ring, owner = ring[left], owner[left]
        codes, local = np.unique(owner[:, None] * count + corners[left], return_inverse=True)
        patch, nodes = np.divmod(codes, count)
        places, merged = st[nodes], nodes == keep[patch]
        places[merged] = at[patch[merged]]
        if on_seam.any():
            other = nodes == other_keep[patch]
            places[other, 1] = at[patch[other], 1]
            merged |= other
        # the merged node is next to nodes of all turns
        own = np.where(merged & (turn[nodes] >= 0), 1 + turn.max(), turn[nodes])
        own = np.where(np.isin(codes, inner), own, -1)
        return Patches._of_corners((ring, local.reshape(-1, 3), owner), (nodes, patch), places, own, twin)

    @staticmethod
    def whole(triangles: Index, st: Array, turn: Index, twin: Index) -> Patches:
        """All of a net of nodes st (N, 2) as one patch, in which nothing has collapsed; `turn` and `twin` (N,) as in `of`."""
        nodes, corners = np.unique(triangles, return_inverse=True)
        ring, one = np.arange(len(triangles)), np.zeros(len(triangles), dtype=np.int64)
        patch = np.zeros(nodes.size, dtype=np.int64)
        return Patches._of_corners((ring, corners.reshape(-1, 3), one), (nodes, patch), st[nodes], turn[nodes], twin)

    @staticmethod
    def _of_corners(
        triangles: tuple[Index, Index, Index], nodes: tuple[Index, Index], places: Array, turn: Index, twin: Index
    ) -> Patches:
        """Of `ring`, `corners` and `owner` of triangles, and of `nodes` and their `patch`, ascending by these; twins (N,) of the
        net."""
        (ring, corners, owner), (node, patch) = triangles, nodes
        reach = np.zeros_like(places)
        for k in range(3):
            np.maximum.at(reach, corners[:, k], REACH * np.abs(places[corners[:, k - 1]] - places[corners[:, k - 2]]))
        reach[(places[:, 1] == 0.0) | (places[:, 1] == 1.0), 1] = 0.0
        codes, wanted = patch * twin.size + node, patch * twin.size + twin[node]
        same = np.minimum(np.searchsorted(codes, wanted), codes.size - 1)
        pair = np.where((twin[node] >= 0) & (codes[same] == wanted), same, -1)
        seam = np.flatnonzero(pair >= 0)
        reach[twin[node] >= 0, 0] = 0.0
        reach[seam, 1] = np.minimum(reach[seam, 1], reach[pair[seam], 1])
        return Patches(ring, corners, owner, node, patch, places, turn, reach, pair)

    @staticmethod
    def join(parts: Sequence[Patches]) -> Patches:
        """All of several, numbered on."""
        nodes = np.cumsum([0, *(len(part.nodes) for part in parts)])
        count = np.cumsum([0, *(part.count for part in parts)])
        return Patches(
            np.concatenate([part.ring for part in parts]),
            np.concatenate([part.corners + first for part, first in zip(parts, nodes, strict=False)]),
            np.concatenate([part.owner + first for part, first in zip(parts, count, strict=False)]),
            np.concatenate([part.nodes for part in parts]),
            np.concatenate([part.patch + first for part, first in zip(parts, count, strict=False)]),
            np.concatenate([part.places for part in parts]),
            np.concatenate([part.turn for part in parts]),
            np.concatenate([part.reach for part in parts]),
            np.concatenate([_onward(part.twin, first) for part, first in zip(parts, nodes, strict=False)]),
        )

    @property
    def count(self) -> int:
        """How many patches."""
        return int(self.owner[-1]) + 1 if self.owner.size else 0

    def collapses(self, edges: Index) -> Collapses:
        """What they make of a net when these edges (C, 2) collapse."""
        return Collapses(edges, self.ring, self.corners, self.owner, self.nodes, self.patch, self.places)

    def of_some(self, chosen: NDArray[np.bool_]) -> Patches:
        """The `chosen` (C,) ones, numbered as they are among them."""
        number = np.cumsum(chosen) - 1
        own, kept = chosen[self.owner], chosen[self.patch]
        place = np.cumsum(kept) - 1
        corners, twin = place[self.corners[own]], self.twin[kept]
        return Patches(
            self.ring[own],
            corners,
            number[self.owner[own]],
            self.nodes[kept],
            number[self.patch[kept]],
            self.places[kept],
            self.turn[kept],
            self.reach[kept],
            np.where(twin >= 0, place[twin], -1),
        )

    def worst(self, prediction: Prediction) -> Array:
        """Largest distances (C,), mm."""
        places = self.places[self.corners]
        errors = np.maximum(prediction.triangles(*np.moveaxis(places, 1, 0)), prediction.chords(places))
        return np.maximum.reduceat(errors, np.flatnonzero(np.append(True, self.owner[1:] != self.owner[:-1])))

    def relax(self, prediction: Prediction, tolerance: float, sweeps: int, size: Callable[[Array], Array]) -> Patches:
        """The same with their loose nodes moved so that triangles come within the tolerance, mm, by sums of the `size` of their
        distances over it."""
        places, reach = self.places.copy(), self.reach.copy()
        loose = self.turn >= 0
        if not loose.any():
            return self
        corner = np.flatnonzero(loose[self.corners])
        triangle, k = np.divmod(corner, 3)
        node = self.corners.ravel()[corner]
        # the node that both sides of a seam have, one after the other
        first_of = np.where(self.twin >= 0, np.minimum(self.twin, np.arange(len(places))), np.arange(len(places)))
        order = np.lexsort((node, first_of[node], self.turn[node]))
        node, triangle, k = node[order], triangle[order], k[order]
        after, before = self.corners[triangle, (k + 1) % 3], self.corners[triangle, (k + 2) % 3]
        follows = following(node, after, before, len(places))
        steps = list[tuple[Index, Index, Index, Index, Index, Index, Index]]()
        for part in np.split(np.arange(node.size), np.flatnonzero(np.diff(self.turn[node])) + 1):
            own = node[part]
            first = np.append(True, own[1:] != own[:-1])
            begins = np.flatnonzero(first)
            pairs = first_of[own[begins]]
            alone = np.append(True, pairs[1:] != pairs[:-1])
            then = np.where(follows[part] < 0, -1, follows[part] - part[0])
            of_node = np.cumsum(alone) - 1
            steps.append((own[begins], np.cumsum(first) - 1, of_node, begins[alone], after[part], before[part], then))
        for _ in range(sweeps):
            for own, of, of_node, begins, one, other, then in steps:
                near = places[own]
                tried = within_link(near[:, None] + reach[own, None] * PLACES, near[:, None])
                errors = prediction.stars(near[of], tried[of], places[one], places[other], then)
                best = np.add.reduceat(size(errors / tolerance), begins, axis=0).argmin(axis=1)[of_node]
                places[own] = tried[np.arange(own.size), best]
                reach[own[best == 0]] *= CLOSER
        return replace(self, places=places, reach=reach)

    def flip(
        self, prediction: Prediction, tolerance: float, crease: NDArray[np.bool_], size: Callable[[Array], Array]
    ) -> Patches:
        """The same with diagonals turned that bring triangles closer to the surface, none between nodes on a `crease` (V,)."""
        incidence = Incidence.of(self.corners, len(self.nodes))
        one, other, apex, b, far, c = incidence.quadrilaterals(self.corners)
        wanted = ~(crease[b] & crease[c])
        one, other, apex, b, far, c = (of[wanted] for of in (one, other, apex, b, far, c))
        p, miss = self.places, prediction.triangles
        now = size(miss(p[apex], p[b], p[c]) / tolerance) + size(miss(p[far], p[c], p[b]) / tolerance)
        then = size(miss(p[apex], p[b], p[far]) / tolerance) + size(miss(p[apex], p[far], p[c]) / tolerance)
        cost = np.where(then < GAIN * now, then - now, np.inf)
        pairs = np.stack((one, other), axis=1)
        chosen = independent(pairs.ravel(), np.repeat(np.arange(one.size), 2), cost, len(self.corners))
        if not chosen.size:
            return self
        corners = self.corners.copy()
        corners[pairs[chosen]] = np.stack((apex, b, far, apex, far, c), axis=1)[chosen].reshape(-1, 2, 3)
        turn = turns(Incidence.of(corners, len(self.nodes)), self.turn >= 0, self.twin)
        return replace(self, corners=corners, turn=turn)


def around(triangles: Index, incidence: Incidence, edges: Index, st: Array, twin: Index) -> tuple[Index, Index, Index]:
    """Nodes of the rings of edges (C, 2) between nodes st (N, 2), ends included, as codes (K,), N times the edge and the node,
    ascending, and all triangles at them, on both sides of seams, where the `twin` (N,) nodes are: the edge (J,), ascending, and the
    triangle (J,)."""
    count, on_seam = len(st), np.flatnonzero(on_seams(edges, st, twin))
    every = np.concatenate((np.arange(len(edges)), on_seam))
    rings = Rings.of(triangles, incidence, np.concatenate((edges, twin[edges[on_seam]])))
    inner = distinct(every[rings.taken_by][:, None] * count + triangles[rings.taken])
    other = twin[inner % count]
    if (other >= 0).any():
        inner = distinct(np.append(inner, (inner + other - inner % count)[other >= 0]))
    edge, node = np.divmod(inner, count)
    corner, which = incidence.corners_at(node)
    owner, triangle = np.divmod(distinct(edge[which] * len(triangles) + corner // 3), len(triangles))
    return inner, owner, triangle


def turns(incidence: Incidence, loose: NDArray[np.bool_], twin: Index) -> Index:
    """Numbers (N,) of nodes that are `loose` (N,), -1 of others, so that no two with the same one have a triangle in common; a
    node and its `twin` (N,) have the same."""
    turn, left = np.full(loose.size, -1), np.flatnonzero(loose & (twin < np.arange(loose.size)))
    triangles = len(incidence.sides)
    # in no order: neighbours would wait for each other
    rank = np.arange(loose.size) * SPREAD % (loose.size + 1)
    number = 0
    while left.size:
        paired = np.flatnonzero(twin[left] >= 0)
        corners, of = incidence.corners_at(np.concatenate((left, twin[left[paired]])))
        of = np.concatenate((np.arange(left.size), paired))[of]
        chosen = independent(corners // 3, of, rank[left].astype(float), triangles)
        turn[left[chosen]] = number
        left, number = left[turn[left] < 0], number + 1
    return np.where(loose & (twin >= 0) & (turn < 0), turn[twin], turn)


def on_seams(edges: Index, st: Array, twin: Index) -> NDArray[np.bool_]:
    """Which edges (C, 2) between nodes st (N, 2) are on a seam, so that the edge between their `twin` (N,) nodes is the same."""
    on_seam: NDArray[np.bool_] = (twin[edges] >= 0).all(axis=1) & (st[edges[:, 0], 0] == st[edges[:, 1], 0])
    return on_seam


def _onward(numbers: Index, by: int) -> Index:
    """Numbers (V,) of nodes, -1 of none, so many further on."""
    return np.where(numbers >= 0, numbers + by, -1)


def relax_patches(
    patches: Patches, prediction: Prediction, tolerance: float, patience: Patience, crease: NDArray[np.bool_]
) -> tuple[Patches, Index]:
    """Those patches that keep the tolerance, mm, once relaxed, and which (K,) of all they are; edges between nodes of a `crease`
    (N,) of the net do not turn."""
    left, size = np.arange(patches.count), _excess if patience.turning else _power
    for sweeps, allowed in patience.stages:
        if patience.turning:
            patches = patches.flip(prediction, tolerance, crease[patches.nodes], size)
        patches = patches.relax(prediction, tolerance, sweeps, size)
        good = patches.worst(prediction) <= allowed * tolerance
        patches, left = patches.of_some(good), left[good]
        if not left.size:
            break
    return patches, left


def fourth(ratio: Array) -> Array:
    """To the fourth: large ones count more, and yet all of them."""
    square = ratio * ratio
    power: Array = square * square
    return power


def _power(ratio: Array) -> Array:
    """To the twelfth."""
    by_four = fourth(ratio)
    power: Array = by_four * by_four * by_four
    return power


def _excess(ratio: Array) -> Array:
    """The square of what is too much; no triangles have very much."""
    more: Array = np.clip(ratio - ALLOWED, 0.0, 1e6)
    return more * more
