"""Triangles of a link merged where they are smaller than the tolerance asks for: edges collapse, diagonals turn.

Lines run the whole way along a link and are as close as the worst of their stations asks, so that a tooth that turns into
another one from toe to heel, or is bent sharply at one corner, has triangles that are far too small elsewhere. Here an edge
between two nodes becomes one node, where all triangles of its ring (see `collapse`) stay within the tolerance: at the place
along the edge and beside it at which the second form says that the worst of them is best. Which of them collapse at once,
cheapest first, is decided by the second form; each is then measured on the exact surface and left as it was where that
misses the tolerance, where facets would fold, or be thinner than the tolerance. What the form was too bold by counts for the
nodes there from then on. Where single edges come to rest others collapse while the nodes round them move (see `relaxation`),
and where that comes to rest all nodes move so that distances are smaller everywhere, which leaves room for more.
Nodes on seams, on corners and on breaks stay, those of the section curves at toe and heel collapse on these curves, within
the same tolerance.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, cross, dot
from gearmesh.kernel.numeric.grid import on_grid
from gearmesh.mesh.links.collapse import Collapses, Incidence, Index, Rings, independent, within_link
from gearmesh.mesh.links.measure import CHORD_SHARES, deviations_of, off_chords
from gearmesh.mesh.links.prediction import Prediction
from gearmesh.mesh.links.relaxation import Patches, Patience, around, fourth, on_seams, relax_patches, turns
from gearmesh.mesh.patch import LinkNodes, PatchMesh

#: rounds of collapsing and turning, at most; the usual number is 6 to 20
ROUNDS = 40
#: share of the nodes: where no more edges than that are tried in a round it is the last
FEW, FEWER = 0.01, 0.002
#: what is tried for edges while nodes round them move, and again after all nodes have moved
PATIENCES = Patience(), Patience(turning=True)
#: sweeps in which all nodes move
SWEEPS = 8
#: places along an edge at which its node is tried first
ALONG = np.array([0.25, 0.75, 0.0, 1.0])
#: then places round the best one, so many times, first as far as this share of the edges of the ring, then closer
AROUND = np.array([[x, y] for x in (-1.0, 0.0, 1.0) for y in (-1.0, 0.0, 1.0) if x or y])
REACH, CLOSER, SEARCHES = 0.2, 0.4, 4
#: edges that miss the tolerance by more than this factor at all places along them are not tried beside them
LIKELY, NEAR = 3.0, 1.5
#: share of the tolerance below which errors are nothing
TINY = 1e-9
#: steps of the grid of measured distances in the tolerance: of equal ones last digits do not choose
STEPS_PER_TOLERANCE = 2.0**20
#: edges tried at once
BLOCK = 20_000
#: and patches relaxed at once
PATCHES = 2_000
#: a diagonal turns for an error this much smaller
GAIN = 0.98
#: corners whose means are where distances are measured besides centres and edges: long triangles are bent to both sides
INSIDE = np.array([[0, 0, 0, 0, 1, 2], [1, 1, 1, 1, 2, 0], [2, 2, 2, 2, 0, 1]])
#: least cosine between a facet and the surface at its centre
UPRIGHT = 0.5

#: nodes that collapse within the link, on its section curve at toe or heel, on a seam, or not at all
INNER, TOE, HEEL, SEAM, FIXED = range(5)

#: nodes of a link at s, t (N,)
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
    """A link with fewer nodes and triangles, but hardly fewer than are `enough`; `again`: where there are more all
    nodes move, and more is tried.

    `place` puts nodes on its surface; `forms` (S, T, 3): L, M, N; `outline` (2, S) as that of `Forms`; `crease` (N,): nodes
    that stay; `tolerance` in mm.
    """
    net = Net.of(patch, place, Prediction(forms, outline), crease, tolerance)
    for _ in range(ROUNDS):
        net.turn()
        if net.collapse() <= FEW * len(net.st):
            break
    net.fresh[:] = True
    net.merge(PATIENCES if again else PATIENCES[:1], enough, FEWER)
    return net.result(patch.deviation)


@dataclass(frozen=True)
class _EdgeTrials:
    """Edges (C, 2) that may collapse into their first nodes, where they do so best, `at` (C, 2), and by how much their rings miss
    the surface then by the second form, `cost` (C,), mm."""

    edges: Index
    at: Array
    cost: Array

    @staticmethod
    def none() -> _EdgeTrials:
        return _EdgeTrials(np.empty((0, 2), dtype=np.int64), np.empty((0, 2)), np.empty(0))

    def of_some(self, which: Index | NDArray[np.bool_]) -> _EdgeTrials:
        return _EdgeTrials(self.edges[which], self.at[which], self.cost[which])

    def join(self, other: _EdgeTrials) -> _EdgeTrials:
        return _EdgeTrials(
            np.concatenate((self.edges, other.edges)),
            np.concatenate((self.at, other.at)),
            np.concatenate((self.cost, other.cost)),
        )


@dataclass
class Net:
    """A triangulation that is being thinned: nodes st (N, 2), of which some are used, and their `kind` (N,).

    Edges at `fresh` (N,) nodes have to be tried, others are `waiting` until there is room for them; `bold`: codes (K,),
    ascending, of edges at which the second form was too bold, and by how much.
    """

    nodes: LinkNodes
    st: Array
    triangles: Index
    errors: Array
    kind: Index
    fresh: NDArray[np.bool_]
    place: Place
    prediction: Prediction
    crease: NDArray[np.bool_]
    tolerance: float
    twin: Index
    edge: NDArray[np.bool_]
    waiting: _EdgeTrials = field(default_factory=lambda: _EdgeTrials.none())
    bold: tuple[Index, Array] = field(default_factory=lambda: (np.empty(0, dtype=np.int64), np.empty(0)))

    @staticmethod
    def of(patch: PatchMesh, place: Place, prediction: Prediction, crease: NDArray[np.bool_], tolerance: float) -> Net:
        nodes, triangles = patch.nodes, patch.triangles
        s, t, count = nodes.s, nodes.t, nodes.s.size
        kind = np.where(t == 0.0, TOE, np.where(t == 1.0, HEEL, INNER))
        kind[(s == 0.0) | (s == 1.0) | crease] = FIXED
        st, fresh = np.stack((s, t), axis=-1), np.ones(count, dtype=bool)
        errors, alone, edge = np.zeros(len(triangles)), np.full(count, -1), np.zeros(count, dtype=bool)
        net = Net(nodes, st, triangles, errors, kind, fresh, place, prediction, crease, tolerance, alone, edge)
        net.nodes, net.errors = net._copy(np.arange(count)), net._miss(triangles)
        return net

    def result(self, deviation: float) -> PatchMesh:
        """The nodes that are left, and the triangles between them; `deviation`: that of the patch before, mm."""
        used, corners = np.unique(self.triangles, return_inverse=True)
        nodes = self._copy(used)
        triangles = corners.reshape(-1, 3)
        finite = self.errors[np.isfinite(self.errors)]
        return PatchMesh(
            nodes, triangles, nodes.middle(triangles).normals, max(deviation, float(finite.max(initial=0.0)))
        )

    def _miss(self, triangles: Index) -> Array:
        return self.miss(self.nodes, triangles, self.crease)

    def miss(self, nodes: LinkNodes, triangles: Index, crease: NDArray[np.bool_]) -> Array:
        """Measured distances (M,) of triangles (M, 3) between nodes from the surface, mm."""
        return _miss(nodes, triangles, crease, self.tolerance)

    def turn(self) -> None:
        """Turn diagonals of two triangles that are nearer to the surface with the other one."""
        incidence = Incidence.of(self.triangles, len(self.st))
        one, other, apex, b, far, c = incidence.quadrilaterals(self.triangles)
        wanted = ~(self.crease[b] & self.crease[c]) & self.fresh[[apex, far, b, c]].any(axis=0)
        one, other, apex, far, b, c = (x[wanted] for x in (one, other, apex, far, b, c))
        if not one.size:
            return
        p = self.st
        miss = self.prediction.triangles
        now = np.maximum(miss(p[apex], p[b], p[c]), miss(p[far], p[c], p[b]))
        then = np.maximum(miss(p[apex], p[b], p[far]), miss(p[apex], p[far], p[c]))
        with np.errstate(invalid="ignore"):
            # of triangles that are none
            cost = np.where(then < GAIN * now, then - now, np.inf)
        pairs = np.stack((one, other), axis=1)
        chosen = independent(pairs.ravel(), np.repeat(np.arange(one.size), 2), cost, len(self.triangles))
        if not chosen.size:
            return
        made = np.stack((apex, b, far, apex, far, c), axis=1)[chosen].reshape(-1, 2, 3)
        errors = self._miss(made.reshape(-1, 3)).reshape(-1, 2)
        good = errors.max(axis=1) < self.errors[pairs[chosen]].max(axis=1)
        at = pairs[chosen[good]]
        self.triangles = self.triangles.copy()
        self.triangles[at], self.errors[at] = made[good], errors[good]
        self.fresh[made[good].ravel()] = True

    def collapse(self) -> int:
        """Collapse edges, no two with a triangle in common, and say how many were tried."""
        incidence, tried = self._trials()
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
        """The same with edges that miss the tolerance as long as the nodes round them stay."""
        incidence, tried = self._trials()
        cost = tried.cost * self._boldness(tried.edges)
        cost[cost > patience.far * self.tolerance] = np.inf
        turn, made = turns(incidence, self.kind != FIXED, self.twin), list[tuple[Patches, Index, Array]]()
        layers = self._layers(incidence, tried.edges, cost, patience)
        if not layers.size:
            return 0
        for part in np.split(layers, np.arange(PATCHES, layers.size, PATCHES)):
            some = tried.of_some(part)
            patches = Patches.of(self.triangles, incidence, some.edges, some.at, self.st, turn, self.twin)
            patches, which = relax_patches(patches, self.prediction, self.tolerance, patience, self.crease)
            worst = self._measurement(patches.collapses(some.edges[which]))[1]
            good = worst <= self.tolerance
            made.append((patches.of_some(good), part[which[good]], worst[good]))
        patches = Patches.join([patches for patches, *_ in made])
        good, worst = np.concatenate([which for _, which, _ in made]), np.concatenate([worst for *_, worst in made])
        chosen = independent(patches.ring, patches.owner, worst, len(self.triangles))
        mine = np.zeros(good.size, dtype=bool)
        mine[chosen] = True
        self._apply(patches.of_some(mine).collapses(tried.edges[good[chosen]]), worst[chosen])
        # those that had no room are tried again, those that missed the tolerance where something changes
        cost[layers] = np.inf
        cost[good[~mine]] = worst[~mine]
        self.waiting = tried.of_some(np.isfinite(cost))
        return len(chosen)

    def merge(self, patiences: Sequence[Patience], enough: int, fewer: float = 0.0) -> None:
        """Let edges collapse while the nodes round them move until there are `enough` triangles, with one patience after the other,
        before each of which but the first all nodes move, until no more than a share of `fewer` of them is tried in a round."""
        for k, patience in enumerate(patiences):
            if k:
                self.relax_nodes(SWEEPS)
                self.turn()
            for _ in range(ROUNDS):
                if len(self.triangles) <= enough:
                    return
                if self.relax(patience) <= fewer * len(self.triangles):
                    break
                self.turn()

    def relax_nodes(self, sweeps: int) -> None:
        """Move all loose nodes so that distances become smaller all over, but for those whose triangles miss the tolerance then,
        and let all edges be tried anew: where they came to rest there is room again, and in other places."""
        turn = turns(Incidence.of(self.triangles, len(self.st)), self.kind != FIXED, self.twin)
        before = Patches.whole(self.triangles, self.st, turn, self.twin)
        after = before.relax(self.prediction, self.tolerance, sweeps, fourth)
        places, bad = after.places, np.zeros(len(before.nodes), dtype=bool)
        while True:
            # both nodes in one place on a seam stay
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
        """Which (K,) of edges (C, 2) to try together, cheap ones first: several times as many as have room beside each other."""
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
        """The edges that have to be tried, and how they collapse best."""
        incidence, twins = Incidence.of(self.triangles, len(self.st)), np.flatnonzero(self.twin >= 0)
        self.fresh[twins] |= self.fresh[self.twin[twins]]
        edges, moving = self._candidates(incidence)
        at, cost = np.empty((len(edges), 2)), np.empty(len(edges))
        for low in range(0, len(edges), BLOCK):
            part = slice(low, low + BLOCK)
            own = Rings.of(self.triangles, incidence, edges[part])
            at[part], cost[part] = self._best(edges[part], moving[part], own)
        on_seam = np.flatnonzero(on_seams(edges, self.st, self.twin))
        if on_seam.size:
            own = Rings.of(self.triangles, incidence, self.twin[edges[on_seam]])
            there = self.st[self.twin[edges[on_seam, 0]]]
            places = np.stack((there[:, 0], at[on_seam, 1]), axis=1)
            cost[on_seam] = np.maximum(cost[on_seam], self._errors(own, there, places[:, None])[:, 0])
        self.fresh = np.zeros(len(self.st), dtype=bool)
        return incidence, _EdgeTrials(edges, at, cost).join(self.waiting)

    def _candidates(self, incidence: Incidence) -> tuple[Index, NDArray[np.bool_]]:
        """Edges (C, 2) that may collapse, into the first node where not both are `moving` (C,)."""
        edges, kind = incidence.edges, self.kind
        # the node that is freer comes last
        edges = np.where((kind[edges[:, 0]] < kind[edges[:, 1]])[:, None], edges[:, ::-1], edges)
        first, last = kind[edges].T
        same_end = self.st[edges[:, 0], 1] == self.st[edges[:, 1], 1]
        inner, on_end = last == INNER, ((last == TOE) | (last == HEEL)) & (incidence.count == 1) & same_end
        # of the two edges of a seam, on either side of it, one
        on_seam = (last == SEAM) & on_seams(edges, self.st, self.twin)
        on_seam &= edges.min(axis=1) < self.twin[edges].min(axis=1)
        wanted = (inner | on_end | on_seam) & self.fresh[edges].any(axis=1)
        # of those that wait, the others have not changed
        self.waiting = self.waiting.of_some(np.flatnonzero(~self.fresh[self.waiting.edges].any(axis=1)))
        return edges[wanted], (first == last)[wanted]

    def _codes(self, edges: Index) -> Index:
        codes: Index = edges.min(axis=1) * len(self.st) + edges.max(axis=1)
        return codes

    def _boldness(self, edges: Index) -> Array:
        """By how much the second form was too bold at edges (C, 2) before, at most; 1 where they were not tried."""
        codes, factors = self.bold
        last = np.searchsorted(codes, self._codes(edges), side="right") - 1
        same = last >= 0
        same[same] = codes[last[same]] == self._codes(edges[same])
        return np.where(same, np.append(factors, 1.0)[last], 1.0)

    def _best(self, edges: Index, moving: NDArray[np.bool_], rings: Rings) -> tuple[Array, Array]:
        """Places (C, 2) at which edges collapse best, and the largest distance (C,), mm, of their rings then."""
        a, b = self.st[edges[:, 0]], self.st[edges[:, 1]]
        at, cost = a.copy(), np.full(len(edges), np.inf)
        if not rings.owner.size:
            return at, cost
        self._take(~moving, a[~moving, None], rings, at, cost)
        at[moving] += 0.5 * (b - a)[moving]
        self._take(moving, at[moving, None], rings, at, cost)
        likely = moving & (cost < LIKELY * self.tolerance)
        self._take(likely, a[likely, None] + ALONG[:, None] * (b - a)[likely, None], rings, at, cost)
        # beside the edge, within the link
        span = np.zeros((len(edges), 2))
        np.maximum.at(span, rings.owner, np.abs(self.st[rings.after] - self.st[rings.before]))
        near = moving & (self.kind[edges[:, 1]] == INNER) & (cost < NEAR * self.tolerance)
        reach = REACH * span
        for _ in range(SEARCHES):
            if not near.any():
                break
            places = within_link(at[near, None] + reach[near, None] * AROUND, at[near, None])
            better = self._take(near, places, rings, at, cost)
            reach[np.flatnonzero(near)[~better]] *= CLOSER
        return at, cost

    def _take(self, which: NDArray[np.bool_], places: Array, rings: Rings, at: Array, cost: Array) -> NDArray[np.bool_]:
        """Put the better ones of places (W, K, 2) of the edges `which` (C,) into `at` and `cost`; whether there are any (W,)."""
        errors = self._errors(rings.of_some(which), at[which], places)
        best = errors.argmin(axis=1)
        least = errors[np.arange(len(places)), best]
        better: NDArray[np.bool_] = least < cost[which]
        taken = np.flatnonzero(which)[better]
        at[taken], cost[taken] = places[better, best[better]], least[better]
        return better

    def _errors(self, rings: Rings, near: Array, places: Array) -> Array:
        """Largest distances (C, K), mm, of rings with their node at places (C, K, 2), by the second form with it `near`
        (C, 2)."""
        worst = np.full(places.shape[:2], np.inf)
        if not rings.owner.size:
            return worst
        own = rings.owner
        after, before = self.st[rings.after], self.st[rings.before]
        errors = self.prediction.stars(near[own], places[own], after, before, rings.following)
        owners = np.flatnonzero(np.append(True, own[1:] != own[:-1]))
        worst[own[owners]] = np.maximum.reduceat(errors, owners, axis=0)
        return worst

    def _measurement(self, new: Collapses) -> tuple[Array, Array, LinkNodes]:
        """By how much triangles (J,), and the worst of each edge (C,), miss the exact surface, mm; and the nodes (V,)."""
        errors, largest, nodes = self._distances(new.nodes, new.places, new.corners)
        begins = np.searchsorted(new.owner, np.arange(len(new.edges)))
        return errors, np.maximum.reduceat(largest, begins) if begins.size else largest, nodes

    def _distances(self, which: Index, places: Array, corners: Index) -> tuple[Array, Array, LinkNodes]:
        """By how much triangles (J,) with corners (J, 3) among the nodes `which` (V,), at places (V, 2), miss the exact surface,
        and that or the section curves, mm; and the nodes."""
        nodes = self._copy(which)
        moved = np.flatnonzero((places != self.st[which]).any(axis=1))
        _put(nodes, moved, self.place(*places[moved].T))
        errors = self.miss(nodes, corners, self.crease[which])
        off = on_grid(self.off_ends(nodes, corners, self.edge[which]), STEPS_PER_TOLERANCE / self.tolerance)
        return errors, np.maximum(errors, off), nodes

    def _apply(self, new: Collapses, cost: Array) -> NDArray[np.bool_]:
        """Collapse edges where the exact surface agrees with the cost (C,), mm, and say which (C,) did."""
        if not len(new.edges):
            return np.zeros(0, dtype=bool)
        errors, worst, nodes = self._measurement(new)
        good = worst <= self.tolerance
        # neighbours of what missed the tolerance are as bold
        # the same edge is tried again where the form leaves room for what it was too bold by
        bad = self._codes(new.edges[~good])
        codes = np.append(self.bold[0], bad)
        factors = np.append(self.bold[1], worst[~good] / np.maximum(cost[~good], TINY * self.tolerance))
        order = np.lexsort((factors, codes))
        self.bold = codes[order], factors[order]
        moved, own = good[new.by], good[new.owner]
        _put(self.nodes, new.nodes[moved], nodes, moved)
        self.st[new.nodes[moved]] = new.places[moved]
        edges = new.edges[good]
        keep, gone = np.concatenate((edges, self.twin[edges[on_seams(edges, self.st, self.twin)]])).T
        number = np.arange(len(self.st))
        number[gone] = keep
        triangles = number[self.triangles]
        # their diagonals may have turned
        triangles[new.ring[own]] = new.nodes[new.corners[own]]
        self.errors[new.ring[own]] = errors[own]
        left = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
        self.triangles, self.errors = triangles[left], self.errors[left]
        self.fresh[new.nodes[new.corners[own]].ravel()] = True
        return good

    def off_ends(self, nodes: LinkNodes, triangles: Index, edge: NDArray[np.bool_]) -> Array:
        """Largest distances (M,), mm, of those sides of triangles (M, 3) that are chords of the section curves from these."""
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
        own = self.nodes
        parameters = None if own.parameters is None else own.parameters[which]
        return LinkNodes(
            own.tooth, own.region, own.s[which], own.t[which], own.points[which], own.normals[which], parameters
        )


def _put(nodes: LinkNodes, which: Index, new: LinkNodes, some: NDArray[np.bool_] | slice = slice(None)) -> None:
    """Put `some` new nodes in the places of `which` ones."""
    for name in ("s", "t", "points", "normals", "parameters"):
        part, values = getattr(nodes, name), getattr(new, name)
        if part is not None:
            part[which] = values[some]


def _miss(nodes: LinkNodes, triangles: Index, crease: NDArray[np.bool_], tolerance: float) -> Array:
    """Measured distances (M,) of triangles from the surface, mm; inf where they lie on their face or are too thin."""
    sides = np.arange(3 * len(triangles)).reshape(-1, 3)
    edges = triangles[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2)
    _, errors, normals = deviations_of(nodes, triangles, edges, sides, crease)
    a, b, c = np.moveaxis(nodes.points[triangles], 1, 0)
    square = cross(b - a, c - a)
    size = np.sqrt(dot(square, square))
    longest = np.sqrt(np.maximum(np.maximum(dot(b - a, b - a), dot(c - b, c - b)), dot(a - c, a - c)))
    good = (dot(square, normals) >= UPRIGHT * size) & (size >= tolerance * longest)
    inside = np.abs(nodes.height(triangles[:, INSIDE].reshape(-1, len(INSIDE[0])))[0]).reshape(-1, len(INSIDE))
    errors = on_grid(np.maximum(errors, inside.max(axis=1, initial=0.0)), STEPS_PER_TOLERANCE / tolerance)
    return np.where(good, errors, np.inf)
