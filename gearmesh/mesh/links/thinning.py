"""Thinning of the triangles of a link: edges collapse and diagonals turn as long as the tolerance is kept.

A line runs all along a link, and its worst station sets its distance to the next line. A tooth that changes from toe to
heel, or is bent sharply at one corner, therefore has far too small triangles elsewhere. Thinning goes in rounds:

1. An edge becomes one node if all triangles of its ring (see `collapse`) stay within the tolerance. The place of the node,
   on the edge or beside it, is the best one by the second form.
2. The second form chooses the edges that collapse at once, the cheapest first. Each collapse is then measured on the exact
   surface. It is undone if it misses the tolerance, folds facets, or makes a facet thinner than the tolerance. The ratio of
   measured and predicted distance raises the cost of the edge in later rounds.
3. When single edges rest, edges collapse while the nodes around them move (see `relaxation`).
4. When these rest, too, all nodes move to make all distances smaller, which gives room for more collapses.

Nodes on seams, corners and breaks stay. Nodes on the section curves at toe and heel stay on these curves, within the same
tolerance.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import field

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, cross, dot
from gearmesh.kernel.numeric.grid import on_grid
from gearmesh.mesh.links.collapse import Collapses, Incidence, Index, Rings, independent, within_link
from gearmesh.mesh.links.measure import CHORD_SHARES, deviations_of, off_chords
from gearmesh.mesh.links.prediction import Prediction
from gearmesh.mesh.links.relaxation import Patches, Patience, around, fourth, on_seams, relax_patches, turns
from gearmesh.mesh.patch import LinkNodes, PatchMesh
from gearmesh.records import dataclass

#: rounds of collapsing and turning; 6 to 20 are usual
MAX_ROUNDS = 40
#: a round of collapses is the last if it tries no more edges than this share of the nodes
LAST_ROUND_SHARE = 0.01
#: a round of relaxations is the last if it tries no more edges than this share of the triangles
LAST_RELAXATION_SHARE = 0.002
#: effort on edges while the nodes around them move, and again after all nodes have moved
THINNING_PATIENCES = Patience(), Patience(turning=True)
#: moves of each node when all nodes move
NODE_SWEEPS = 8
#: places along an edge at which its node is tried, besides the middle
EDGE_SHARES = np.array([0.25, 0.75, 0.0, 1.0])
#: offsets around the best of these places that are tried next, in units of the reach
TRIED_OFFSETS = np.array([[x, y] for x in (-1.0, 0.0, 1.0) for y in (-1.0, 0.0, 1.0) if x or y])
#: first reach, as a share of the edges of the ring
REACH_SHARE = 0.2
#: factor of the reach after a search in which no place was better
REACH_FACTOR = 0.4
#: searches around the best place
MAX_SEARCHES = 4
#: factor of the tolerance at the middle of an edge beyond which no other place on the edge is tried
MAX_ALONG_RATIO = 3.0
#: factor of the tolerance at the best place on an edge beyond which no place beside the edge is tried
MAX_BESIDE_RATIO = 1.5
#: share of the tolerance below which a predicted error counts as this share
NO_ERROR_SHARE = 1e-9
#: grid of measured distances, in steps per tolerance: last digits do not choose between equal distances
STEPS_PER_TOLERANCE = 2.0**20
#: edges that are evaluated at once
EDGES_PER_BLOCK = 1_000
#: patches that are relaxed at once
PATCHES_PER_BLOCK = 2_000
#: a diagonal turns if the error falls below this share
TURNING_GAIN = 0.98
#: corners whose means are further places of measurement in a triangle: the surface may bend to both sides of a long triangle
INNER_CORNERS = np.array([[0, 0, 0, 0, 1, 2], [1, 1, 1, 1, 2, 0], [2, 2, 2, 2, 0, 1]])
#: least cosine between a facet and the surface at its centre
MIN_FACET_COSINE = 0.5

#: kind of a node that is free within the link
INNER_NODE = 0
#: kind of a node on the section curve at the toe
TOE_NODE = 1
#: kind of a node on the section curve at the heel
HEEL_NODE = 2
#: kind of a node on a seam
SEAM_NODE = 3
#: kind of a node that stays in its place
FIXED_NODE = 4

#: function that returns nodes of a link at s, t (N,)
Place = Callable[[Array, Array], LinkNodes]


def thin(
    patch: PatchMesh,
    place: Place,
    forms: Array,
    outline: Array,
    crease: NDArray[np.bool_],
    tolerance: float,
    enough: int = 0,
    *,
    again: bool = True,
) -> PatchMesh:
    """Return the mesh of a link with fewer nodes and triangles.

    - patch: mesh of the link.
    - place: function that puts nodes on the surface.
    - forms: L, M, N (S, T, 3) of the second form.
    - outline: (2, S) as in `Forms`.
    - crease: True (N,) for nodes that stay.
    - tolerance: mm.
    - enough: number of triangles at which thinning stops.
    - again: True to move all nodes and try more, if there are more triangles than enough.
    """
    net = Net.of(patch, place, Prediction(forms, outline), crease, tolerance)
    for _ in range(MAX_ROUNDS):
        net.turn()
        if net.collapse() <= LAST_ROUND_SHARE * len(net.st):
            break
    net.fresh[:] = True
    net.merge(THINNING_PATIENCES if again else THINNING_PATIENCES[:1], enough, LAST_RELAXATION_SHARE)
    return net.result(patch.deviation)


@dataclass(frozen=True)
class _EdgeTrials:
    """Edges that may collapse into their first nodes, with the predicted result."""

    #: nodes (C, 2)
    edges: Index
    #: best places (C, 2) of the merged nodes
    at: Array
    #: predicted largest distances (C,), mm, of the rings
    cost: Array

    @staticmethod
    def none() -> _EdgeTrials:
        """Return no edges."""
        return _EdgeTrials(np.empty((0, 2), dtype=np.int64), np.empty((0, 2)), np.empty(0))

    def of_some(self, which: Index | NDArray[np.bool_]) -> _EdgeTrials:
        """Return some of the edges."""
        return _EdgeTrials(self.edges[which], self.at[which], self.cost[which])

    def join(self, other: _EdgeTrials) -> _EdgeTrials:
        """Return these edges and others."""
        return _EdgeTrials(
            np.concatenate((self.edges, other.edges)),
            np.concatenate((self.at, other.at)),
            np.concatenate((self.cost, other.cost)),
        )


@dataclass
class Net:
    """A triangulation that is thinned."""

    #: nodes (N,), used or not
    nodes: LinkNodes
    #: places (N, 2) of the nodes
    st: Array
    #: corners (M, 3)
    triangles: Index
    #: measured distances (M,), mm, of the triangles
    errors: Array
    #: kind (N,) of each node
    kind: Index
    #: True (N,) for nodes whose edges must be tried
    fresh: NDArray[np.bool_]
    #: function that puts nodes on the surface
    place: Place
    #: predicted distances
    prediction: Prediction
    #: True (N,) for nodes on creases
    crease: NDArray[np.bool_]
    #: mm
    tolerance: float
    #: node (N,) at the same place on the other side of a seam; -1 for none
    twin: Index
    #: True (N,) for nodes on seams that are sharp edges
    edge: NDArray[np.bool_]
    #: edges that were good but had no room beside others
    waiting: _EdgeTrials = field(default_factory=lambda: _EdgeTrials.none())
    #: codes (K,), rising, of edges whose prediction was too small, and the ratios (K,) of measurement and prediction
    bold: tuple[Index, Array] = field(default_factory=lambda: (np.empty(0, dtype=np.int64), np.empty(0)))

    @staticmethod
    def of(patch: PatchMesh, place: Place, prediction: Prediction, crease: NDArray[np.bool_], tolerance: float) -> Net:
        """Return the net of a single link."""
        nodes, triangles = patch.nodes, patch.triangles
        s, t, count = nodes.s, nodes.t, nodes.s.size
        kind = np.where(t == 0.0, TOE_NODE, np.where(t == 1.0, HEEL_NODE, INNER_NODE))
        kind[(s == 0.0) | (s == 1.0) | crease] = FIXED_NODE
        st, fresh = np.stack((s, t), axis=-1), np.ones(count, dtype=bool)
        errors, alone, edge = np.zeros(len(triangles)), np.full(count, -1), np.zeros(count, dtype=bool)
        net = Net(nodes, st, triangles, errors, kind, fresh, place, prediction, crease, tolerance, alone, edge)
        net.nodes, net.errors = net._copy(np.arange(count)), net._miss(triangles)
        return net

    def result(self, deviation: float) -> PatchMesh:
        """Return the thinned mesh; `deviation`: deviation of the mesh before, mm."""
        used, corners = np.unique(self.triangles, return_inverse=True)
        nodes = self._copy(used)
        triangles = corners.reshape(-1, 3)
        finite = self.errors[np.isfinite(self.errors)]
        return PatchMesh(
            nodes, triangles, nodes.middle(triangles).normals, max(deviation, float(finite.max(initial=0.0)))
        )

    def _miss(self, triangles: Index) -> Array:
        """Return the measured distances (M,), mm, of triangles (M, 3) of the net."""
        return self.miss(self.nodes, triangles, self.crease)

    def miss(self, nodes: LinkNodes, triangles: Index, crease: NDArray[np.bool_]) -> Array:
        """Return the measured distances (M,), mm, of triangles (M, 3) between nodes from the surface."""
        return _miss(nodes, triangles, crease, self.tolerance)

    def turn(self) -> None:
        """Turn diagonals that bring their two triangles closer to the surface."""
        incidence = Incidence.of(self.triangles, len(self.st))
        first, second, apex, b, far, c = incidence.quadrilaterals(self.triangles)
        wanted = ~(self.crease[b] & self.crease[c]) & self.fresh[[apex, far, b, c]].any(axis=0)
        first, second, apex, far, b, c = (part[wanted] for part in (first, second, apex, far, b, c))
        if not first.size:
            return
        p = self.st
        miss = self.prediction.triangles
        # predicted largest distance of both triangles, with the present diagonal and with the other diagonal
        now = np.maximum(miss(p[apex], p[b], p[c]), miss(p[far], p[c], p[b]))
        then = np.maximum(miss(p[apex], p[b], p[far]), miss(p[apex], p[far], p[c]))
        with np.errstate(invalid="ignore"):
            # triangles without area have infinite distances
            cost = np.where(then < TURNING_GAIN * now, then - now, np.inf)
        pairs = np.stack((first, second), axis=1)
        chosen = independent(pairs.ravel(), np.repeat(np.arange(first.size), 2), cost, len(self.triangles))
        if not chosen.size:
            return
        made = np.stack((apex, b, far, apex, far, c), axis=1)[chosen].reshape(-1, 2, 3)
        # a turn is kept only if the distance that is measured on the exact surface falls, too
        errors = self._miss(made.reshape(-1, 3)).reshape(-1, 2)
        good = errors.max(axis=1) < self.errors[pairs[chosen]].max(axis=1)
        at = pairs[chosen[good]]
        self.triangles = self.triangles.copy()
        self.triangles[at], self.errors[at] = made[good], errors[good]
        self.fresh[made[good].ravel()] = True

    def collapse(self) -> int:
        """Collapse edges, no two with a common triangle; return the number of edges tried."""
        incidence, tried = self._trials()
        # predictions are corrected by the ratio of measurement to prediction in earlier trials
        cost = tried.cost * self._boldness(tried.edges)
        cost[cost > self.tolerance] = np.inf
        rings = Rings.of(self.triangles, incidence, tried.edges)
        chosen = independent(rings.taken, rings.taken_by, cost, len(self.triangles))
        some = tried.of_some(chosen)
        rings = Rings.of(self.triangles, incidence, some.edges)
        good = self._apply(rings.collapses(some.edges, some.at, self.st), cost[chosen])
        cost[chosen[good]] = np.inf
        self.waiting = tried.of_some(np.isfinite(cost))
        return len(chosen)

    def relax(self, patience: Patience) -> int:
        """Collapse edges while the nodes around them move; return the number of edges tried."""
        incidence, tried = self._trials()
        cost = tried.cost * self._boldness(tried.edges)
        cost[cost > patience.far * self.tolerance] = np.inf
        turn, made = turns(incidence, self.kind != FIXED_NODE, self.twin), list[tuple[Patches, Index, Array]]()
        layers = self._layers(incidence, tried.edges, cost, patience)
        if not layers.size:
            return 0
        # nodes around the edges move in blocks of patches; the results are measured on the exact surface
        for part in np.split(layers, np.arange(PATCHES_PER_BLOCK, layers.size, PATCHES_PER_BLOCK)):
            some = tried.of_some(part)
            patches = Patches.of(self.triangles, incidence, some.edges, some.at, self.st, turn, self.twin)
            patches, which = relax_patches(patches, self.prediction, self.tolerance, patience, self.crease)
            worst = self._measurement(patches.collapses(some.edges[which]))[1]
            good = worst <= self.tolerance
            made.append((patches.of_some(good), part[which[good]], worst[good]))
        patches = Patches.join([patches for patches, *_ in made])
        # patches that keep the tolerance and do not overlap are taken, the best first
        good, worst = np.concatenate([which for _, which, _ in made]), np.concatenate([worst for *_, worst in made])
        chosen = independent(patches.ring, patches.owner, worst, len(self.triangles))
        mine = np.zeros(good.size, dtype=bool)
        mine[chosen] = True
        self._apply(patches.of_some(mine).collapses(tried.edges[good[chosen]]), worst[chosen])
        # edges without room wait; edges that missed the tolerance are tried again when a node there changes
        cost[layers] = np.inf
        cost[good[~mine]] = worst[~mine]
        self.waiting = tried.of_some(np.isfinite(cost))
        return len(chosen)

    def merge(self, patiences: Sequence[Patience], enough: int, fewer: float = 0.0) -> None:
        """Collapse edges while the nodes around them move, with one patience after the other, until few edges are tried.

        - patiences: efforts; before each one but the first all nodes move.
        - enough: number of triangles at which merging stops.
        - fewer: a round is the last if it tries no more edges than this share of the triangles.
        """
        for k, patience in enumerate(patiences):
            if k:
                self.relax_nodes(NODE_SWEEPS)
                self.turn()
            for _ in range(MAX_ROUNDS):
                if len(self.triangles) <= enough:
                    return
                if self.relax(patience) <= fewer * len(self.triangles):
                    break
                self.turn()

    def relax_nodes(self, sweeps: int) -> None:
        """Move all loose nodes to make distances smaller everywhere; then all edges are tried anew.

        Nodes whose triangles would miss the tolerance stay.
        """
        turn = turns(Incidence.of(self.triangles, len(self.st)), self.kind != FIXED_NODE, self.twin)
        before = Patches.whole(self.triangles, self.st, turn, self.twin)
        after = before.relax(self.prediction, self.tolerance, sweeps, fourth)
        places, bad = after.places, np.zeros(len(before.nodes), dtype=bool)
        while True:
            # twins stay together
            bad[before.twin[bad & (before.twin >= 0)]] = True
            places = np.where(bad[:, None], before.places, places)
            errors, largest, nodes = self._distances(before.nodes, places, before.corners)
            off = np.zeros(bad.size, dtype=bool)
            off[before.corners[largest > self.tolerance].ravel()] = True
            if not (off & ~bad).any():
                break
            bad |= off
        _put(self.nodes, before.nodes, nodes)
        self.st[before.nodes], self.errors = places, errors
        self.fresh[:], self.waiting = True, _EdgeTrials.none()
        self.bold = np.empty(0, dtype=np.int64), np.empty(0)

    def _layers(self, incidence: Incidence, edges: Index, cost: Array, patience: Patience) -> Index:
        """Return the edges (K,) of (C, 2) to try together, the cheapest first: several layers of edges without overlap."""
        left = np.flatnonzero(np.isfinite(cost))
        _, owner, ring = around(self.triangles, incidence, edges[left], self.st, self.twin)
        cost, chosen, count = cost[left], list[Index](), 0
        while np.isfinite(cost).any() and (len(chosen) < patience.layers or count < patience.many):
            layer = independent(ring, owner, cost, len(self.triangles))
            cost[layer] = np.inf
            chosen.append(left[layer])
            count += layer.size
        return np.sort(np.concatenate(chosen)) if chosen else left

    def _trials(self) -> tuple[Incidence, _EdgeTrials]:
        """Return the edges that must be tried, with the best places of their merged nodes."""
        incidence, twins = Incidence.of(self.triangles, len(self.st)), np.flatnonzero(self.twin >= 0)
        self.fresh[twins] |= self.fresh[self.twin[twins]]
        edges, moving = self._candidates(incidence)
        at, cost = np.empty((len(edges), 2)), np.empty(len(edges))
        for low in range(0, len(edges), EDGES_PER_BLOCK):
            part = slice(low, low + EDGES_PER_BLOCK)
            rings = Rings.of(self.triangles, incidence, edges[part])
            at[part], cost[part] = self._best(edges[part], moving[part], rings)
        on_seam = np.flatnonzero(on_seams(edges, self.st, self.twin))
        if on_seam.size:
            # the triangles on the other side of a seam count, too
            rings = Rings.of(self.triangles, incidence, self.twin[edges[on_seam]])
            there = self.st[self.twin[edges[on_seam, 0]]]
            places = np.stack((there[:, 0], at[on_seam, 1]), axis=1)
            cost[on_seam] = np.maximum(cost[on_seam], self._errors(rings, there, places[:, None])[:, 0])
        self.fresh = np.zeros(len(self.st), dtype=bool)
        return incidence, _EdgeTrials(edges, at, cost).join(self.waiting)

    def _candidates(self, incidence: Incidence) -> tuple[Index, NDArray[np.bool_]]:
        """Return the edges (C, 2) that may collapse, and True (C,) if both nodes may move; else the first node stays."""
        edges, kind = incidence.edges, self.kind
        # the freer node comes last
        edges = np.where((kind[edges[:, 0]] < kind[edges[:, 1]])[:, None], edges[:, ::-1], edges)
        first, last = kind[edges].T
        same_end = self.st[edges[:, 0], 1] == self.st[edges[:, 1], 1]
        inner, on_end = (
            last == INNER_NODE,
            ((last == TOE_NODE) | (last == HEEL_NODE)) & (incidence.count == 1) & same_end,
        )
        # an edge on a seam occurs on both sides of it: one of the two is taken
        on_seam = (last == SEAM_NODE) & on_seams(edges, self.st, self.twin)
        on_seam &= edges.min(axis=1) < self.twin[edges].min(axis=1)
        wanted = (inner | on_end | on_seam) & self.fresh[edges].any(axis=1)
        # waiting edges at fresh nodes are tried anew; the others have not changed
        self.waiting = self.waiting.of_some(np.flatnonzero(~self.fresh[self.waiting.edges].any(axis=1)))
        return edges[wanted], (first == last)[wanted]

    def _codes(self, edges: Index) -> Index:
        """Return a number (C,) for each edge (C, 2)."""
        codes: Index = edges.min(axis=1) * len(self.st) + edges.max(axis=1)
        return codes

    def _boldness(self, edges: Index) -> Array:
        """Return the largest ratio (C,) of measured and predicted distance at edges (C, 2) so far; 1 if they were not tried."""
        codes, factors = self.bold
        last = np.searchsorted(codes, self._codes(edges), side="right") - 1
        same = last >= 0
        same[same] = codes[last[same]] == self._codes(edges[same])
        return np.where(same, np.append(factors, 1.0)[last], 1.0)

    def _best(self, edges: Index, moving: NDArray[np.bool_], rings: Rings) -> tuple[Array, Array]:
        """Return the best places (C, 2) of the merged nodes, and the predicted largest distances (C,), mm, of their rings."""
        a, b = self.st[edges[:, 0]], self.st[edges[:, 1]]
        at, cost = a.copy(), np.full(len(edges), np.inf)
        if not rings.owner.size:
            return at, cost
        # a node that stays is the place; else the middle of the edge, then other places on it
        self._take(~moving, a[~moving, None], rings, at, cost)
        at[moving] += 0.5 * (b - a)[moving]
        self._take(moving, at[moving, None], rings, at, cost)
        likely = moving & (cost < MAX_ALONG_RATIO * self.tolerance)
        self._take(likely, a[likely, None] + EDGE_SHARES[:, None] * (b - a)[likely, None], rings, at, cost)
        # then places beside the edge, within the link
        span = np.zeros((len(edges), 2))
        np.maximum.at(span, rings.owner, np.abs(self.st[rings.after] - self.st[rings.before]))
        near = moving & (self.kind[edges[:, 1]] == INNER_NODE) & (cost < MAX_BESIDE_RATIO * self.tolerance)
        reach = REACH_SHARE * span
        for _ in range(MAX_SEARCHES):
            if not near.any():
                break
            places = within_link(at[near, None] + reach[near, None] * TRIED_OFFSETS, at[near, None])
            better = self._take(near, places, rings, at, cost)
            reach[np.flatnonzero(near)[~better]] *= REACH_FACTOR
        return at, cost

    def _take(self, which: NDArray[np.bool_], places: Array, rings: Rings, at: Array, cost: Array) -> NDArray[np.bool_]:
        """Try places (W, K, 2) for the edges `which` (C,); put better ones into `at` and `cost`; return True (W,) if any."""
        errors = self._errors(rings.of_some(which), at[which], places)
        best = errors.argmin(axis=1)
        least = errors[np.arange(len(places)), best]
        better: NDArray[np.bool_] = least < cost[which]
        taken = np.flatnonzero(which)[better]
        at[taken], cost[taken] = places[better, best[better]], least[better]
        return better

    def _errors(self, rings: Rings, near: Array, places: Array) -> Array:
        """Return the predicted largest distances (C, K), mm, of rings with their node at places (C, K, 2).

        `near` (C, 2): place of the node at which the second form is taken.
        """
        worst = np.full(places.shape[:2], np.inf)
        if not rings.owner.size:
            return worst
        owner = rings.owner
        after, before = self.st[rings.after], self.st[rings.before]
        errors = self.prediction.stars(near[owner], places[owner], after, before, rings.following)
        owners = np.flatnonzero(np.append(True, owner[1:] != owner[:-1]))
        worst[owner[owners]] = np.maximum.reduceat(errors, owners, axis=0)
        return worst

    def _measurement(self, new: Collapses) -> tuple[Array, Array, LinkNodes]:
        """Return the measured distances (J,), mm, of triangles, the largest of each edge (C,), and the nodes (V,)."""
        errors, largest, nodes = self._distances(new.nodes, new.places, new.corners)
        begins = np.searchsorted(new.owner, np.arange(len(new.edges)))
        return errors, np.maximum.reduceat(largest, begins) if begins.size else largest, nodes

    def _distances(self, which: Index, places: Array, corners: Index) -> tuple[Array, Array, LinkNodes]:
        """Return the measured distances, mm, of triangles whose nodes have moved.

        - which: nodes (V,).
        - places: new places (V, 2).
        - corners: corners (J, 3) of the triangles, as indices in `which`.

        Three results: distances (J,) from the surface; the larger of these and the distances from the section curves (J,); the
        nodes at the new places.
        """
        nodes = self._copy(which)
        moved = np.flatnonzero((places != self.st[which]).any(axis=1))
        _put(nodes, moved, self.place(*places[moved].T))
        errors = self.miss(nodes, corners, self.crease[which])
        off = on_grid(self.off_ends(nodes, corners, self.edge[which]), STEPS_PER_TOLERANCE / self.tolerance)
        return errors, np.maximum(errors, off), nodes

    def _apply(self, new: Collapses, cost: Array) -> NDArray[np.bool_]:
        """Collapse the edges that keep the tolerance on the exact surface; return True (C,) for these.

        `cost` (C,): predicted distances, mm.
        """

        if not len(new.edges):
            return np.zeros(0, dtype=bool)
        errors, worst, nodes = self._measurement(new)
        good = worst <= self.tolerance
        # the ratio of measurement and prediction: the edge is tried again if its prediction leaves room for it
        bad = self._codes(new.edges[~good])
        codes = np.append(self.bold[0], bad)
        factors = np.append(self.bold[1], worst[~good] / np.maximum(cost[~good], NO_ERROR_SHARE * self.tolerance))
        order = np.lexsort((factors, codes))
        self.bold = codes[order], factors[order]
        moved, changed = good[new.by], good[new.owner]
        _put(self.nodes, new.nodes[moved], nodes, moved)
        self.st[new.nodes[moved]] = new.places[moved]
        edges = new.edges[good]
        keep, gone = np.concatenate((edges, self.twin[edges[on_seams(edges, self.st, self.twin)]])).T
        number = np.arange(len(self.st))
        number[gone] = keep
        triangles = number[self.triangles]
        # the corners come from the collapse, because diagonals may have turned in it
        triangles[new.ring[changed]] = new.nodes[new.corners[changed]]
        self.errors[new.ring[changed]] = errors[changed]
        left = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
        self.triangles, self.errors = triangles[left], self.errors[left]
        self.fresh[new.nodes[new.corners[changed]].ravel()] = True
        return good

    def off_ends(self, nodes: LinkNodes, triangles: Index, edge: NDArray[np.bool_]) -> Array:
        """Return the largest distances (M,), mm, of sides of triangles (M, 3) on toe or heel from the section curves; else 0."""
        off, s, t = np.zeros(len(triangles)), nodes.s[triangles], nodes.t[triangles]
        after = np.roll(t, -1, axis=1)
        on, side = np.nonzero((t == after) & ((t == 0.0) | (t == 1.0)))
        if on.size:
            ends = np.stack((side, (side + 1) % 3), axis=1)
            first, last = s[on[:, None], ends].T
            along = first[:, None] + (last - first)[:, None] * CHORD_SHARES
            curve = self.place(along.ravel(), np.repeat(t[on, side], CHORD_SHARES.size)).points
            np.maximum.at(
                off, on, off_chords(nodes.points[triangles[on[:, None], ends]], curve.reshape(*along.shape, 3))
            )
        return off

    def _copy(self, which: Index) -> LinkNodes:
        """Return a copy of some nodes."""
        nodes = self.nodes
        parameters = None if nodes.parameters is None else nodes.parameters[which]
        return LinkNodes(
            nodes.tooth,
            nodes.region,
            nodes.s[which],
            nodes.t[which],
            nodes.points[which],
            nodes.normals[which],
            parameters,
        )


def _put(nodes: LinkNodes, which: Index, new: LinkNodes, some: NDArray[np.bool_] | slice = slice(None)) -> None:
    """Overwrite the nodes `which` with some of the new nodes."""
    for name in ("s", "t", "points", "normals", "parameters"):
        part, values = getattr(nodes, name), getattr(new, name)
        if part is not None:
            part[which] = values[some]


def _miss(nodes: LinkNodes, triangles: Index, crease: NDArray[np.bool_], tolerance: float) -> Array:
    """Return the measured distances (M,), mm, of triangles from the surface; inf if they are turned over or too thin."""
    sides = np.arange(3 * len(triangles)).reshape(-1, 3)
    edges = triangles[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2)
    _, errors, normals = deviations_of(nodes, triangles, edges, sides, crease)
    a, b, c = np.moveaxis(nodes.points[triangles], 1, 0)
    square = cross(b - a, c - a)
    size = np.sqrt(dot(square, square))
    longest = np.sqrt(np.maximum(np.maximum(dot(b - a, b - a), dot(c - b, c - b)), dot(a - c, a - c)))
    good = (dot(square, normals) >= MIN_FACET_COSINE * size) & (size >= tolerance * longest)
    inside = np.abs(nodes.height(triangles[:, INNER_CORNERS].reshape(-1, len(INNER_CORNERS[0])))[0]).reshape(
        -1, len(INNER_CORNERS)
    )
    errors = on_grid(np.maximum(errors, inside.max(axis=1, initial=0.0)), STEPS_PER_TOLERANCE / tolerance)
    return np.where(good, errors, np.inf)
