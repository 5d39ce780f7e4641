"""Collapse of edges while the nodes around them move, where the collapse alone would miss the tolerance.

Collapses without moves end when facets use three quarters of the tolerance, because each needs the rest of its ring.
Here the triangles at all nodes of the ring form a patch. Each edge has its own copy of its patch, so all edges are
tried at once. The inner nodes of a patch go one after the other to the best of eight places around them, in several
sweeps. Nodes on the section curves at toe and heel move along these curves. The measure is the sum of a high power of
the distances of the triangles at a node: all triangles come closer, the worst ones first.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, distinct
from gearmesh.mesh.links.collapse import Collapses, Incidence, Index, Rings, following, independent, within_link
from gearmesh.mesh.links.prediction import Prediction
from gearmesh.records import dataclass

#: offsets that are tried around a node, in units of its reach; the first one is 0
TRIED_OFFSETS = np.array([[0.0, 0.0]] + [[x, y] for x in (-1.0, 0.0, 1.0) for y in (-1.0, 0.0, 1.0) if x or y])
#: first reach of a node, as a share of the edges opposite to it
REACH_SHARE = 0.1
#: factor of the reach after a sweep in which no place was better
REACH_FACTOR = 0.5
#: number without small factors, which spreads ranks over the nodes
RANK_STEP = 7_368_787
#: a diagonal turns if the sum of powers falls below this share
TURNING_GAIN = 0.98
#: share of the tolerance above which the distance of a triangle is too large, if only such triangles count
ALLOWED_SHARE = 0.985


@dataclass(frozen=True)
class Patience:
    """Effort that is spent on an edge."""

    #: factor of the tolerance beyond which an edge is not tried
    far: float = 2.0
    #: number of edges with overlapping patches that are tried at once
    layers: int = 3
    #: number of edges that are tried at once in any case
    many: int = 60
    #: sweeps over all nodes of a patch, and the factor of the tolerance beyond which it is given up after them
    stages: tuple[tuple[int, float], ...] = ((2, 1.25), (2, 1.1), (4, 1.02))
    #: True to turn diagonals before each stage, and to count only triangles beyond the tolerance
    turning: bool = False


@dataclass(frozen=True)
class Patches:
    """Copies of the patches of C edges, after the collapse of the edges."""

    #: triangles (J,) of the net
    ring: Index
    #: corners (J, 3) of the triangles, as indices in `nodes`
    corners: Index
    #: patch (J,) of each triangle, rising
    owner: Index
    #: nodes (V,) of the net
    nodes: Index
    #: patch (V,) of each node
    patch: Index
    #: places (V, 2) of the nodes
    places: Array
    #: turn (V,) in which each node moves; neighbours have different turns; -1 for nodes that stay
    turn: Index
    #: largest step (V, 2) of each node; at toe and heel along s alone
    reach: Array
    #: node (V,) at the same place on the other side of a seam, which moves with this node along t; -1 for none
    twin: Index

    @staticmethod
    def of(
        triangles: Index, incidence: Incidence, edges: Index, at: Array, st: Array, turn: Index, twin: Index
    ) -> Patches:
        """Return the patches of edges that collapse into their first nodes; edges on seams collapse on both sides.

        - triangles: (M, 3).
        - edges: nodes (C, 2).
        - at: places (C, 2) of the merged nodes.
        - st: places (N, 2) of all nodes.
        - turn: turns (N,) of all nodes.
        - twin: twins (N,) of all nodes on seams, else -1.
        """
        count = len(st)
        inner, owner, ring = around(triangles, incidence, edges, st, twin)
        corners, on_seam = triangles[ring], on_seams(edges, st, twin)
        # the collapse puts the first node in the place of the last, on both sides of a seam; triangles with both nodes
        # vanish
        (keep, gone), (other_keep, other_gone) = edges.T, np.where(on_seam[:, None], twin[edges], -1).T
        for first, last in ((keep, gone), (other_keep, other_gone)) if on_seam.any() else ((keep, gone),):
            corners = np.where(corners == last[owner, None], first[owner, None], corners)
        left = (corners != np.roll(corners, 1, axis=1)).all(axis=1)
        ring, owner = ring[left], owner[left]
        # each patch has its own copy of its nodes, so that patches may overlap
        codes, local = np.unique(owner[:, None] * count + corners[left], return_inverse=True)
        patch, nodes = np.divmod(codes, count)
        places, merged = st[nodes], nodes == keep[patch]
        places[merged] = at[patch[merged]]
        if on_seam.any():
            other = nodes == other_keep[patch]
            places[other, 1] = at[patch[other], 1]
            merged |= other
        # the merged node has neighbours of all turns: it moves last
        new_turn = np.where(merged & (turn[nodes] >= 0), 1 + turn.max(), turn[nodes])
        new_turn = np.where(np.isin(codes, inner), new_turn, -1)
        return Patches._of_corners((ring, local.reshape(-1, 3), owner), (nodes, patch), places, new_turn, twin)

    @staticmethod
    def whole(triangles: Index, st: Array, turn: Index, twin: Index) -> Patches:
        """Return a whole net as one patch, without a collapse; the arguments are those of `of`."""
        nodes, corners = np.unique(triangles, return_inverse=True)
        ring, owner = np.arange(len(triangles)), np.zeros(len(triangles), dtype=np.int64)
        patch = np.zeros(nodes.size, dtype=np.int64)
        return Patches._of_corners((ring, corners.reshape(-1, 3), owner), (nodes, patch), st[nodes], turn[nodes], twin)

    @staticmethod
    def _of_corners(
        triangles: tuple[Index, Index, Index], nodes: tuple[Index, Index], places: Array, turn: Index, twin: Index
    ) -> Patches:
        """Return patches with reach and twins computed.

        - triangles: ring, corners and owner.
        - nodes: nodes and their patch, sorted by patch and node.
        - places: (V, 2).
        - turn: (V,).
        - twin: twins (N,) of the net.
        """
        (ring, corners, owner), (node, patch) = triangles, nodes
        # reach: a share of the opposite edges; nodes on toe and heel move along s only, nodes on seams along t only
        reach = np.zeros_like(places)
        for k in range(3):
            np.maximum.at(
                reach, corners[:, k], REACH_SHARE * np.abs(places[corners[:, k - 1]] - places[corners[:, k - 2]])
            )
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
        """Return several sets of patches as one set."""
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
        """Number of patches."""
        return int(self.owner[-1]) + 1 if self.owner.size else 0

    def collapses(self, edges: Index) -> Collapses:
        """Return the collapse of the edges (C, 2) of these patches."""
        return Collapses(edges, self.ring, self.corners, self.owner, self.nodes, self.patch, self.places)

    def of_some(self, chosen: NDArray[np.bool_]) -> Patches:
        """Return the `chosen` (C,) patches, numbered anew."""
        number = np.cumsum(chosen) - 1
        kept_triangles, kept = chosen[self.owner], chosen[self.patch]
        place = np.cumsum(kept) - 1
        corners, twin = place[self.corners[kept_triangles]], self.twin[kept]
        return Patches(
            self.ring[kept_triangles],
            corners,
            number[self.owner[kept_triangles]],
            self.nodes[kept],
            number[self.patch[kept]],
            self.places[kept],
            self.turn[kept],
            self.reach[kept],
            np.where(twin >= 0, place[twin], -1),
        )

    def worst(self, prediction: Prediction) -> Array:
        """Return the largest predicted distances (C,), mm, of the patches."""
        places = self.places[self.corners]
        errors = np.maximum(prediction.triangles(*np.moveaxis(places, 1, 0)), prediction.chords(places))
        return np.maximum.reduceat(errors, np.flatnonzero(np.append(True, self.owner[1:] != self.owner[:-1])))

    def relax(self, prediction: Prediction, tolerance: float, sweeps: int, size: Callable[[Array], Array]) -> Patches:
        """Return the patches with loose nodes moved to bring triangles closer to the surface.

        - tolerance: mm.
        - sweeps: number of moves of each node.
        - size: function of distance over tolerance whose sum at a node is made small.
        """
        places, reach = self.places.copy(), self.reach.copy()
        loose = self.turn >= 0
        if not loose.any():
            return self
        corner = np.flatnonzero(loose[self.corners])
        triangle, k = np.divmod(corner, 3)
        node = self.corners.ravel()[corner]
        # corners sorted by turn, then by node; twins follow each other
        first_of = np.where(self.twin >= 0, np.minimum(self.twin, np.arange(len(places))), np.arange(len(places)))
        order = np.lexsort((node, first_of[node], self.turn[node]))
        node, triangle, k = node[order], triangle[order], k[order]
        after, before = self.corners[triangle, (k + 1) % 3], self.corners[triangle, (k + 2) % 3]
        follows = following(node, after, before, len(places))
        # nodes with the same turn have no common triangle, so that they move at the same time
        steps = list[tuple[Index, Index, Index, Index, Index, Index, Index]]()
        for part in np.split(np.arange(node.size), np.flatnonzero(np.diff(self.turn[node])) + 1):
            moved = node[part]
            first = np.append(True, moved[1:] != moved[:-1])
            begins = np.flatnonzero(first)
            pairs = first_of[moved[begins]]
            alone = np.append(True, pairs[1:] != pairs[:-1])
            then = np.where(follows[part] < 0, -1, follows[part] - part[0])
            of_node = np.cumsum(alone) - 1
            steps.append((moved[begins], np.cumsum(first) - 1, of_node, begins[alone], after[part], before[part], then))
        for _ in range(sweeps):
            for moved, corner_node, of_node, begins, next_node, last_node, then in steps:
                near = places[moved]
                tried = within_link(near[:, None] + reach[moved, None] * TRIED_OFFSETS, near[:, None])
                errors = prediction.stars(
                    near[corner_node], tried[corner_node], places[next_node], places[last_node], then
                )
                # the present place is one of the tried places: a move never makes the sum at a node larger
                best = np.add.reduceat(size(errors / tolerance), begins, axis=0).argmin(axis=1)[of_node]
                places[moved] = tried[np.arange(moved.size), best]
                reach[moved[best == 0]] *= REACH_FACTOR
        return replace(self, places=places, reach=reach)

    def flip(
        self, prediction: Prediction, tolerance: float, crease: NDArray[np.bool_], size: Callable[[Array], Array]
    ) -> Patches:
        """Return the patches with diagonals turned that bring triangles closer to the surface.

        Diagonals between nodes on a `crease` (V,) stay. The other arguments are those of `relax`.
        """
        incidence = Incidence.of(self.corners, len(self.nodes))
        first, second, apex, b, far, c = incidence.quadrilaterals(self.corners)
        wanted = ~(crease[b] & crease[c])
        first, second, apex, b, far, c = (part[wanted] for part in (first, second, apex, b, far, c))
        p, miss = self.places, prediction.triangles
        # sums of both triangles with the present diagonal, and with the other diagonal
        now = size(miss(p[apex], p[b], p[c]) / tolerance) + size(miss(p[far], p[c], p[b]) / tolerance)
        then = size(miss(p[apex], p[b], p[far]) / tolerance) + size(miss(p[apex], p[far], p[c]) / tolerance)
        cost = np.where(then < TURNING_GAIN * now, then - now, np.inf)
        pairs = np.stack((first, second), axis=1)
        chosen = independent(pairs.ravel(), np.repeat(np.arange(first.size), 2), cost, len(self.corners))
        if not chosen.size:
            return self
        corners = self.corners.copy()
        corners[pairs[chosen]] = np.stack((apex, b, far, apex, far, c), axis=1)[chosen].reshape(-1, 2, 3)
        turn = turns(Incidence.of(corners, len(self.nodes)), self.turn >= 0, self.twin)
        return replace(self, corners=corners, turn=turn)


def around(triangles: Index, incidence: Incidence, edges: Index, st: Array, twin: Index) -> tuple[Index, Index, Index]:
    """Return the nodes of the rings of edges (C, 2), and all triangles at these nodes, on both sides of seams.

    - st: places (N, 2) of the nodes.
    - twin: twins (N,) of nodes on seams, else -1.

    Three arrays: codes (K,) = N edge + node of the nodes, rising; the edge (J,), rising, and the triangle (J,).
    """
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
    """Return turns (N,) of the `loose` (N,) nodes, -1 for others: nodes with a common triangle have different turns.

    A node and its `twin` (N,) have the same turn.
    """
    turn, left = np.full(loose.size, -1), np.flatnonzero(loose & (twin < np.arange(loose.size)))
    triangles = len(incidence.sides)
    # ranks are spread over the nodes: with ranks in order neighbours would wait for each other
    rank = np.arange(loose.size) * RANK_STEP % (loose.size + 1)
    number = 0
    while left.size:
        paired = np.flatnonzero(twin[left] >= 0)
        corners, place = incidence.corners_at(np.concatenate((left, twin[left[paired]])))
        taken_by = np.concatenate((np.arange(left.size), paired))[place]
        chosen = independent(corners // 3, taken_by, rank[left].astype(float), triangles)
        turn[left[chosen]] = number
        left, number = left[turn[left] < 0], number + 1
    return np.where(loose & (twin >= 0) & (turn < 0), turn[twin], turn)


def on_seams(edges: Index, st: Array, twin: Index) -> NDArray[np.bool_]:
    """True (C,) for edges (C, 2) on a seam: their `twin` (N,) nodes have the same edge. `st` (N, 2): places of the nodes."""
    on_seam: NDArray[np.bool_] = (twin[edges] >= 0).all(axis=1) & (st[edges[:, 0], 0] == st[edges[:, 1], 0])
    return on_seam


def _onward(numbers: Index, by: int) -> Index:
    """Return node numbers (V,) raised by an amount; -1, for no node, stays."""
    return np.where(numbers >= 0, numbers + by, -1)


def relax_patches(
    patches: Patches, prediction: Prediction, tolerance: float, patience: Patience, crease: NDArray[np.bool_]
) -> tuple[Patches, Index]:
    """Return the relaxed patches that keep the tolerance, mm, and their numbers (K,).

    Edges between nodes of a `crease` (N,) of the net do not turn.
    """
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
    """Return the fourth power: all values count, large ones more."""
    square = ratio * ratio
    power: Array = square * square
    return power


def _power(ratio: Array) -> Array:
    """Return the twelfth power."""
    by_four = fourth(ratio)
    power: Array = by_four * by_four * by_four
    return power


def _excess(ratio: Array) -> Array:
    """Return the square of the part above ALLOWED_SHARE; it is limited, because degenerate triangles are infinitely far."""
    more: Array = np.clip(ratio - ALLOWED_SHARE, 0.0, 1e6)
    return more * more
