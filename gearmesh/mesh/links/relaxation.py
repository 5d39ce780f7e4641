"""Edges that collapse while the nodes round them move, where the collapse alone would miss the tolerance.

Single collapses come to rest where facets use three quarters of the tolerance: each of them needs what its ring has left.
Here the triangles at all nodes of the ring are a patch, of which each edge has a copy for itself, so that all edges are tried
at once; the copy's inner nodes, and those of the section curves at toe and heel along these, go one after the other to the best
of eight places round them, time and again. What counts is the sum of a high power of the distances of the triangles at a node,
so that all of them come closer, the worst first.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.links.collapse import Collapses, Incidence, Index, Rings, following, independent
from gearmesh.mesh.links.prediction import Prediction

#: places tried round a node, the one where it is first
PLACES = np.array([[0.0, 0.0]] + [[x, y] for x in (-1.0, 0.0, 1.0) for y in (-1.0, 0.0, 1.0) if x or y])
#: first as far as this share of the edges opposite to the node, half as far where none is better
REACH, CLOSER = 0.1, 0.5
#: a number without small factors
SPREAD = 7_368_787
#: sweeps over all nodes, and by which factor patches may miss the tolerance after them: where it is more they are given up
STAGES = ((2, 1.25), (2, 1.1), (4, 1.02))


@dataclass(frozen=True)
class Patches:
    """Copies of the patches of edges (C, 2) once these have collapsed: triangles `ring` (J,) of the net with corners (J, 3), each
    of the patch `owner` (J,), ascending; at corners are `nodes` (V,) of the net, in patches `patch` (V,), at `places` (V, 2).

    Nodes move in their `turn` (V,), none with the same turn as a neighbour, or stay, -1, within `reach` (V, 2), at toe and heel
    along s.
    """

    ring: Index
    corners: Index
    owner: Index
    nodes: Index
    patch: Index
    places: Array
    turn: Index
    reach: Array

    @staticmethod
    def of(triangles: Index, incidence: Incidence, edges: Index, at: Array, st: Array, turn: Index) -> Patches:
        """Of edges that collapse into their first nodes at places (C, 2), of nodes st (N, 2) that take their `turns`."""
        count = len(st)
        inner, owner, ring = around(triangles, incidence, edges, count)
        keep, gone = edges.T
        corners = triangles[ring]
        corners = np.where(corners == gone[owner, None], keep[owner, None], corners)
        left = (corners != np.roll(corners, 1, axis=1)).all(axis=1)
        ring, owner = ring[left], owner[left]
        codes, local = np.unique(owner[:, None] * count + corners[left], return_inverse=True)
        patch, nodes = np.divmod(codes, count)
        places, merged = st[nodes], nodes == keep[patch]
        places[merged] = at[patch[merged]]
        local = local.reshape(-1, 3)
        reach = np.zeros_like(places)
        for k in range(3):
            np.maximum.at(reach, local[:, k], REACH * np.abs(places[local[:, k - 1]] - places[local[:, k - 2]]))
        reach[(places[:, 1] == 0.0) | (places[:, 1] == 1.0), 1] = 0.0
        # the merged node is next to nodes of all turns
        own = np.where(merged & (turn[nodes] >= 0), 1 + turn.max(), turn[nodes])
        return Patches(ring, local, owner, nodes, patch, places, np.where(np.isin(codes, inner), own, -1), reach)

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
            *(np.concatenate([getattr(part, name) for part in parts]) for name in ("places", "turn", "reach")),
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
        corners = (np.cumsum(kept) - 1)[self.corners[own]]
        return Patches(
            self.ring[own],
            corners,
            number[self.owner[own]],
            self.nodes[kept],
            number[self.patch[kept]],
            self.places[kept],
            self.turn[kept],
            self.reach[kept],
        )

    def worst(self, prediction: Prediction) -> Array:
        """Largest distances (C,), mm."""
        places = self.places[self.corners]
        errors = np.maximum(prediction.triangles(*np.moveaxis(places, 1, 0)), prediction.chords(places))
        return np.maximum.reduceat(errors, np.flatnonzero(np.append(True, self.owner[1:] != self.owner[:-1])))

    def relax(self, prediction: Prediction, tolerance: float, sweeps: int) -> Patches:
        """The same with their loose nodes moved so that triangles come within the tolerance, mm."""
        places, reach = self.places.copy(), self.reach.copy()
        loose = self.turn >= 0
        if not loose.any():
            return self
        corner = np.flatnonzero(loose[self.corners])
        triangle, k = np.divmod(corner, 3)
        node = self.corners.ravel()[corner]
        order = np.lexsort((node, self.turn[node]))
        node, triangle, k = node[order], triangle[order], k[order]
        after, before = self.corners[triangle, (k + 1) % 3], self.corners[triangle, (k + 2) % 3]
        follows = following(node, after, before, len(places))
        steps = list[tuple[Index, Index, Index, Index, Index, Index]]()
        for part in np.split(np.arange(node.size), np.flatnonzero(np.diff(self.turn[node])) + 1):
            own = node[part]
            first = np.append(True, own[1:] != own[:-1])
            begins = np.flatnonzero(first)
            then = np.where(follows[part] < 0, -1, follows[part] - part[0])
            steps.append((own[begins], np.cumsum(first) - 1, begins, after[part], before[part], then))
        for _ in range(sweeps):
            for own, of, begins, one, other, then in steps:
                near = places[own]
                tried = np.clip(near[:, None] + reach[own, None] * PLACES, 0.0, 1.0)
                errors = prediction.stars(near[of], tried[of], places[one], places[other], then)
                best = np.add.reduceat(_power(errors / tolerance), begins, axis=0).argmin(axis=1)
                places[own] = tried[np.arange(own.size), best]
                reach[own[best == 0]] *= CLOSER
        return replace(self, places=places, reach=reach)


def around(triangles: Index, incidence: Incidence, edges: Index, count: int) -> tuple[Index, Index, Index]:
    """Nodes of the rings of edges (C, 2), ends included, as codes (K,), `count` times the edge and the node, ascending, and all
    triangles at them: the edge (J,), ascending, and the triangle (J,)."""
    rings = Rings.of(triangles, incidence, edges)
    inner = np.unique((rings.taken_by[:, None] * count + triangles[rings.taken]).ravel())
    edge, node = np.divmod(inner, count)
    corner, which = incidence.corners_at(node)
    owner, triangle = np.divmod(np.unique(edge[which] * len(triangles) + corner // 3), len(triangles))
    return inner, owner, triangle


def turns(incidence: Incidence, loose: NDArray[np.bool_]) -> Index:
    """Numbers (N,) of nodes that are `loose` (N,), -1 of others, so that no two with the same one have a triangle in common."""
    turn, left = np.full(loose.size, -1), np.flatnonzero(loose)
    triangles = len(incidence.sides)
    # in no order: neighbours would wait for each other
    rank = np.arange(loose.size) * SPREAD % (loose.size + 1)
    number = 0
    while left.size:
        corners, of = incidence.corners_at(left)
        chosen = independent(corners // 3, of, rank[left].astype(float), triangles)
        turn[left[chosen]] = number
        left, number = left[turn[left] < 0], number + 1
    return turn


def relax_patches(patches: Patches, prediction: Prediction, tolerance: float) -> tuple[Patches, Index]:
    """Those patches that keep the tolerance, mm, once relaxed, and which (K,) of all they are."""
    left = np.arange(patches.count)
    for sweeps, allowed in STAGES:
        patches = patches.relax(prediction, tolerance, sweeps)
        good = patches.worst(prediction) <= allowed * tolerance
        patches, left = patches.of_some(good), left[good]
        if not left.size:
            break
    return patches, left


def _power(ratio: Array) -> Array:
    """To the twelfth."""
    square = ratio * ratio
    fourth = square * square
    power: Array = fourth * fourth * fourth
    return power
