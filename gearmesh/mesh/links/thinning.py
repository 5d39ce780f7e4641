"""Triangles of a link merged where they are smaller than the tolerance asks for: edges collapse, diagonals turn.

Lines run the whole way along a link and are as close as the worst of their stations asks, so that a tooth that turns into
another one from toe to heel, or is bent sharply at one corner, has triangles that are far too small elsewhere. Here an edge
between two nodes becomes one node, where all triangles of its ring (see `collapse`) stay within the tolerance: at the place
along the edge and beside it at which the second form says that the worst of them is best. Which of them collapse at once,
cheapest first, is decided by the second form; each is then measured on the exact surface and left as it was where that
misses the tolerance, where facets would fold, or be thinner than the tolerance. What the form was too bold by counts for the
nodes there from then on. Nodes on seams, on corners and on breaks stay, those of the section curves at toe and heel collapse
on these curves, within the same tolerance.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, cross, dot
from gearmesh.mesh.links.collapse import FLAT, Incidence, Index, Rings, area, independent
from gearmesh.mesh.links.lines import between
from gearmesh.mesh.links.measure import measured, off_chords, peaks
from gearmesh.mesh.patch import LinkNodes, PatchMesh

#: rounds of collapsing and turning, at most; the usual number is 6 to 20
ROUNDS = 40
#: share of the nodes: where no more edges than that are tried in a round it is the last
FEW = 0.01
#: places along an edge at which its node is tried first
ALONG = np.array([0.25, 0.75, 0.0, 1.0])
#: then places round the best one, so many times, first as far as this share of the edges of the ring, then closer
AROUND = np.array([[x, y] for x in (-1.0, 0.0, 1.0) for y in (-1.0, 0.0, 1.0) if x or y])
REACH, CLOSER, SEARCHES = 0.2, 0.4, 4
#: edges that miss the tolerance by more than this factor at all places along them are not tried beside them
LIKELY, NEAR = 3.0, 1.5
#: share of the tolerance below which errors are nothing
TINY = 1e-9
#: edges tried at once
BLOCK = 20_000
#: a diagonal turns for an error this much smaller
GAIN = 0.98
#: corners whose means are where distances are measured besides centres and edges: long triangles are bent to both sides
INSIDE = ([0, 0, 0, 0, 1, 2], [1, 1, 1, 1, 2, 0], [2, 2, 2, 2, 0, 1])
#: least cosine between a facet and the surface at its centre
UPRIGHT = 0.5

#: nodes that collapse within the link, on its section curve at toe or heel, or not at all
INNER, TOE, HEEL, FIXED = range(4)

#: nodes of a link at s, t (N,)
Place = Callable[[Array, Array], LinkNodes]


def thin(
    patch: PatchMesh, place: Place, forms: Array, outline: Array, crease: NDArray[np.bool_], tolerance: float
) -> PatchMesh:
    """A link with fewer nodes and triangles.

    `place` puts nodes on its surface; `forms` (S, T, 3): L, M, N; `outline` (2, S) as that of `Forms`; `crease` (N,): nodes
    that stay; `tolerance` in mm.
    """
    net = _Net.of(patch, place, forms, outline, crease, tolerance)
    for _ in range(ROUNDS):
        net.turn()
        if net.collapse() <= FEW * len(net.st):
            break
    return net.result(patch.deviation)


@dataclass
class _Net:
    """A triangulation that is being thinned: nodes st (N, 2), of which some are used, and their `kind` (N,); what has to be
    tried again is `fresh` (N,); `bold`: codes (K,), ascending, of edges at which the second form was too bold, and by how much."""

    nodes: LinkNodes
    st: Array
    triangles: Index
    errors: Array
    kind: Index
    fresh: NDArray[np.bool_]
    place: Place
    forms: Array
    outline: Array
    crease: NDArray[np.bool_]
    tolerance: float
    bold: tuple[Index, Array] = field(default_factory=lambda: (np.empty(0, dtype=np.int64), np.empty(0)))

    @staticmethod
    def of(
        patch: PatchMesh, place: Place, forms: Array, outline: Array, crease: NDArray[np.bool_], tolerance: float
    ) -> _Net:
        nodes, triangles = patch.nodes, patch.triangles
        s, t, count = nodes.s, nodes.t, nodes.s.size
        kind = np.where(t == 0.0, TOE, np.where(t == 1.0, HEEL, INNER))
        kind[(s == 0.0) | (s == 1.0) | crease] = FIXED
        parameters = None if nodes.parameters is None else nodes.parameters.copy()
        own = LinkNodes(
            nodes.tooth, nodes.region, s.copy(), t.copy(), nodes.points.copy(), nodes.normals.copy(), parameters
        )
        st, fresh = np.stack((s, t), axis=-1), np.ones(count, dtype=bool)
        errors = np.zeros(len(triangles))
        net = _Net(own, st, triangles, errors, kind, fresh, place, forms, outline, crease, tolerance)
        net.errors = net.miss(triangles)
        return net

    def result(self, deviation: float) -> PatchMesh:
        """The nodes that are left, and the triangles between them; `deviation`: that of the patch before, mm."""
        used, corners = np.unique(self.triangles, return_inverse=True)
        own = self.nodes
        parameters = None if own.parameters is None else own.parameters[used]
        nodes = LinkNodes(
            own.tooth, own.region, own.s[used], own.t[used], own.points[used], own.normals[used], parameters
        )
        triangles = corners.reshape(-1, 3)
        finite = self.errors[np.isfinite(self.errors)]
        return PatchMesh(
            nodes, triangles, nodes.middle(triangles).normals, max(deviation, float(finite.max(initial=0.0)))
        )

    def miss(self, triangles: Index) -> Array:
        """Measured distances (M,) of triangles from the surface, mm; inf where they lie on their face or are too thin."""
        sides = np.arange(3 * len(triangles)).reshape(-1, 3)
        edges = triangles[:, [[1, 2], [2, 0], [0, 1]]].reshape(-1, 2)
        _, errors, centres = measured(self.nodes, triangles, edges, sides, self.crease)
        a, b, c = np.moveaxis(self.nodes.points[triangles], 1, 0)
        square = cross(b - a, c - a)
        size = np.sqrt(dot(square, square))
        longest = np.sqrt(np.maximum(np.maximum(dot(b - a, b - a), dot(c - b, c - b)), dot(a - c, a - c)))
        good = (dot(square, centres.normals) >= UPRIGHT * size) & (size >= self.tolerance * longest)
        for places in INSIDE:
            np.maximum(errors, np.abs(self.nodes.height(triangles[:, places])), out=errors)
        return np.where(good, errors, np.inf)

    def form(self, places: Array) -> Array:
        """Second forms L, M, N (N, 3) at places (N, 2)."""
        return between(self.forms, places[:, 0], places[:, 1])

    def prediction(self, a: Array, b: Array, c: Array) -> Array:
        """Distances (N,), mm, of triangles with corners (N, 2) by the second form; inf where they are no triangles."""
        sides = ((b, c), (c, a), (a, b))
        heights = np.stack([_height(self.form(0.5 * (p + q)), q - p) for p, q in sides], axis=-1)
        return _worst(heights, area(a, b, c))

    def turn(self) -> None:
        """Turn diagonals of two triangles that are nearer to the surface with the other one."""
        incidence = Incidence.of(self.triangles, len(self.st))
        order = np.argsort(incidence.sides.ravel(), kind="stable")
        inner = np.flatnonzero(incidence.count == 2)
        begins = np.cumsum(incidence.count) - incidence.count
        (one, k), (other, m) = (np.divmod(order[begins[inner] + i], 3) for i in (0, 1))
        apex, far = self.triangles[one, k], self.triangles[other, m]
        b, c = self.triangles[one, (k + 1) % 3], self.triangles[one, (k + 2) % 3]
        wanted = ~(self.crease[b] & self.crease[c]) & self.fresh[[apex, far, b, c]].any(axis=0)
        one, other, apex, far, b, c = (x[wanted] for x in (one, other, apex, far, b, c))
        if not one.size:
            return
        p = self.st
        now = np.maximum(self.prediction(p[apex], p[b], p[c]), self.prediction(p[far], p[c], p[b]))
        then = np.maximum(self.prediction(p[apex], p[b], p[far]), self.prediction(p[apex], p[far], p[c]))
        cost = np.where(then < GAIN * now, then - now, np.inf)
        pairs = np.stack((one, other), axis=1)
        chosen = independent(pairs.ravel(), np.repeat(np.arange(one.size), 2), cost, len(self.triangles))
        if not chosen.size:
            return
        made = np.stack((apex, b, far, apex, far, c), axis=1)[chosen].reshape(-1, 2, 3)
        errors = self.miss(made.reshape(-1, 3)).reshape(-1, 2)
        good = errors.max(axis=1) < self.errors[pairs[chosen]].max(axis=1)
        at = pairs[chosen[good]]
        self.triangles = self.triangles.copy()
        self.triangles[at], self.errors[at] = made[good], errors[good]
        self.fresh[made[good].ravel()] = True

    def collapse(self) -> int:
        """Collapse edges, no two with a triangle in common, and say how many were tried."""
        incidence = Incidence.of(self.triangles, len(self.st))
        edges, moving = self._candidates(incidence)
        rings = Rings.of(self.triangles, incidence, edges)
        at, cost = np.empty((len(edges), 2)), np.empty(len(edges))
        for low in range(0, len(edges), BLOCK):
            part = slice(low, low + BLOCK)
            own = Rings.of(self.triangles, incidence, edges[part])
            at[part], cost[part] = self._best(edges[part], moving[part], own)
        cost = np.where(cost * self._boldness(edges) <= self.tolerance, cost, np.inf)
        fresh = np.zeros(len(self.st), dtype=bool)
        fresh[edges[np.isfinite(cost)].ravel()] = True
        chosen = independent(rings.taken, rings.taken_by, cost, len(self.triangles))
        self._apply(edges[chosen], at[chosen], cost[chosen], Rings.of(self.triangles, incidence, edges[chosen]), fresh)
        self.fresh = fresh
        return len(chosen)

    def _candidates(self, incidence: Incidence) -> tuple[Index, NDArray[np.bool_]]:
        """Edges (C, 2) that may collapse, into the first node where not both are `moving` (C,)."""
        edges, kind = incidence.edges, self.kind
        # the node that is freer comes last
        edges = np.where((kind[edges[:, 0]] < kind[edges[:, 1]])[:, None], edges[:, ::-1], edges)
        first, last = kind[edges].T
        same_end = self.st[edges[:, 0], 1] == self.st[edges[:, 1], 1]
        inner, on_end = last == INNER, ((last == TOE) | (last == HEEL)) & (incidence.count == 1) & same_end
        wanted = (inner | on_end) & self.fresh[edges].any(axis=1)
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
            places = np.clip(at[near, None] + reach[near, None] * AROUND, 0.0, 1.0)
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
        a, b, c = places[rings.owner], self.st[rings.after], self.st[rings.before]
        along, opposite = near[rings.owner], rings.following
        to_after = _height(self.form(0.5 * (along + b))[:, None], a - b[:, None])
        to_before = to_after[opposite]
        last = np.flatnonzero(opposite < 0)
        to_before[last] = _height(self.form(0.5 * (along[last] + c[last]))[:, None], a[last] - c[last, None])
        base = np.broadcast_to(_height(self.form(0.5 * (b + c)), c - b)[:, None], to_after.shape)
        errors = _worst(np.stack((base, to_before, to_after), axis=-1), area(a, b[:, None], c[:, None]))
        for end, chord, node in self._chords(rings, places[:, 0, 1]):
            errors[chord] = np.maximum(errors[chord], self._sag(end, a[chord, :, 0], self.st[node, 0][:, None]))
        owners = np.flatnonzero(np.append(True, rings.owner[1:] != rings.owner[:-1]))
        worst[rings.owner[owners]] = np.maximum.reduceat(errors, owners, axis=0)
        return worst

    def _chords(self, rings: Rings, t: Array) -> Iterator[tuple[int, Index, Index]]:
        """Those sides of rings (K,) with their nodes at t (C,) that are chords of a section curve, and their other ends (K,):
        at the toe, 0, and at the heel, 1."""
        for end in (0, 1):
            for node in (rings.after, rings.before):
                on = np.flatnonzero((self.st[node, 1] == end) & (t[rings.owner] == end))
                if on.size:
                    yield end, on, node[on]

    def _sag(self, end: int, a: Array, b: Array) -> Array:
        """Distances (...,), mm, of chords between s a and b from the section curve at toe (0) or heel (1)."""
        outline = self.outline[end]
        sag: Array = 0.125 * np.interp(0.5 * (a + b), np.linspace(0.0, 1.0, outline.size), outline) * (b - a) ** 2
        return sag

    def _apply(self, edges: Index, at: Array, cost: Array, rings: Rings, fresh: NDArray[np.bool_]) -> None:
        """Collapse edges (C, 2) at places (C, 2), where the exact surface agrees with the cost (C,)."""
        if not len(edges):
            return
        keep, gone = edges.T
        moved = (at != self.st[keep]).any(axis=1)
        before = self._at(keep[moved])
        self._put(keep[moved], self.place(*at[moved].T))
        made = np.stack((keep[rings.owner], rings.after, rings.before), axis=1)
        errors = self.miss(made)
        worst = np.maximum.reduceat(errors, rings.begins)
        worst = np.maximum(worst, self._off_ends(keep, rings))
        bad = worst > self.tolerance
        # neighbours of what missed the tolerance are as bold
        # the same edge is tried again where the form leaves room for what it was too bold by
        codes = np.append(self.bold[0], self._codes(edges[bad]))
        factors = np.append(self.bold[1], worst[bad] / np.maximum(cost[bad], TINY * self.tolerance))
        order = np.lexsort((factors, codes))
        self.bold = codes[order], factors[order]
        back = bad[moved]
        self._put(keep[moved][back], tuple(None if part is None else part[back] for part in before))
        good = ~bad
        number = np.arange(len(self.st))
        number[gone[good]] = keep[good]
        triangles = number[self.triangles]
        self.errors[rings.ring[good[rings.owner]]] = errors[good[rings.owner]]
        left = (triangles != np.roll(triangles, 1, axis=1)).all(axis=1)
        self.triangles, self.errors = triangles[left], self.errors[left]
        fresh[made[good[rings.owner]].ravel()] = True

    def _off_ends(self, keep: Index, rings: Rings) -> Array:
        """Largest distances (C,), mm, of chords of the rings at toe and heel from the section curves there."""
        off, chords = np.zeros(keep.size), list(self._chords(rings, self.st[keep, 1]))
        if chords:
            owner = np.concatenate([rings.owner[chord] for _, chord, _ in chords])
            ends = np.stack((keep[owner], np.concatenate([node for *_, node in chords])), axis=1)
            middles = self.place(*self.st[ends].mean(axis=1).T).points
            np.maximum.at(off, owner, off_chords(self.nodes.points[ends], middles))
        return off

    def _at(self, which: Index) -> tuple[Array | None, ...]:
        own = self.nodes
        parts = (own.s, own.t, own.points, own.normals, own.parameters)
        return tuple(None if part is None else part[which] for part in parts)

    def _put(self, which: Index, new: LinkNodes | tuple[Array | None, ...]) -> None:
        own = self.nodes
        if isinstance(new, LinkNodes):
            new = new.s, new.t, new.points, new.normals, new.parameters
        for part, values in zip((own.s, own.t, own.points, own.normals, own.parameters), new, strict=True):
            if part is not None and values is not None:
                part[which] = values
        self.st[which, 0], self.st[which, 1] = own.s[which], own.t[which]


def _height(form: Array, away: Array) -> Array:
    """Signed distances (...,), mm, of the middles of edges `away` (..., 2) long by second forms (..., 3) there."""
    ds, dt = away[..., 0], away[..., 1]
    height: Array = 0.125 * ((form[..., 0] * ds + 2.0 * form[..., 1] * dt) * ds + form[..., 2] * dt**2)
    return height


def _worst(heights: Array, areas: Array) -> Array:
    """Largest distances (...,) of triangles by those of the middles of their sides (..., 3); inf without area (...,)."""
    sides = heights.reshape(-1, 3)
    errors = peaks(sides, 4.0 / 9.0 * (sides[:, 0] + sides[:, 1] + sides[:, 2])).reshape(areas.shape)
    return np.where(areas > FLAT, errors, np.inf)
