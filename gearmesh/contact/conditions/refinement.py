"""Places where teeth may touch, solved exactly, many at once: what comes of each, and which of a position is ahead.

Every place has edges of its own that it lies on, none, one or two. One that comes out beyond an edge goes on to where its own edge
crosses that one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.meshing import Conditions, Touch
from gearmesh.contact.pair import CORNER, NUMBERED, OF_CORNERS, Pair
from gearmesh.errors import Status
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, cross, dot, turn, unit
from gearmesh.kernel.surface.curvature import contact_ellipse, relative_curvature, tangent_basis

#: a point this far (mm) outside a trimmed flank still counts as on its edge
EDGE_SLACK = 1e-7
#: relative eigenvalue of K1 - K2 below which contact is along a line
FLAT = 1e-7
#: singular values below this share of the largest are taken for the null space of line contact
RCOND = 1e-9
#: advances (rad) that differ by less are equal
EQUAL = 1e-12
#: rise of the advance along an edge (1/mm) that counts as none
RISE = 1e-12
#: mm beside a corner of a tip line at which its directions are taken
BESIDE = 1e-6
#: normals that differ by less agree
AGREE = 1e-8
#: what marks an edge that is solved for from where an edge k crosses it: ALONG - k
ALONG = -2
#: edges added to what is solved for, at most: two cross, and a third may take the place of one of them
ROUNDS = 4
#: evaluations of the conditions in a round; the few places that take more go on so often, together with those of the next
EVALUATIONS, GOES = 12, 4


@dataclass
class Contacts:
    """What touches first at N positions of a tooth pair.

    `x` (N, 5): parameters of the pinion's surface, of the gear's, and rotation of the gear, rad; NaN where there is no contact.
    `edges` (N, 2): numbers of the edges in contact, -1: none. `line` (N,): whether the flanks touch along a line. `status`,
    `residual` (N,): as of every solver. `part` (N,): what touches, a number in `pair.PARTS`, 0 on the flanks. `advance` (N,):
    by how much the gear is ahead of the nominal ratio, rad; -inf where there is no contact.
    """

    x: Array
    edges: NDArray[np.intp]
    line: NDArray[np.bool_]
    status: NDArray[np.int64]
    residual: Array
    part: NDArray[np.intp]
    advance: Array

    @property
    def touching(self) -> NDArray[np.bool_]:
        """Whether there is contact at the positions (N,)."""
        converged: NDArray[np.bool_] = self.status == Status.CONVERGED
        return converged

    @staticmethod
    def nothing(count: int) -> Contacts:
        """Positions at which nothing touches.

        Parameters
        ----------
        count : int
            How many, N.

        Returns
        -------
        Contacts

        Examples
        --------
        >>> gm.Contacts.nothing(2).touching.tolist()
        [False, False]
        """
        return Contacts(
            np.full((count, 5), np.nan),
            np.full((count, 2), -1),
            np.zeros(count, dtype=bool),
            np.full(count, int(Status.NO_CONTACT)),
            np.full(count, np.nan),
            np.zeros(count, dtype=np.intp),
            np.full(count, -np.inf),
        )

    def at(self, position: NDArray[np.intp]) -> Contacts:
        """Those of some positions.

        Parameters
        ----------
        position : ndarray of int
            Their numbers (M,).

        Returns
        -------
        Contacts
            Of M positions.

        Examples
        --------
        >>> contacts = gears.contact().engagement.at(np.radians([0.0, 2.0]))
        >>> contacts.at(np.array([1])).x.shape
        (1, 5)
        """
        return Contacts(*(getattr(self, field.name)[position] for field in fields(self)))

    def put(self, position: NDArray[np.intp], contacts: Contacts) -> None:
        """Put other contacts in the places of some positions.

        Parameters
        ----------
        position : ndarray of int
            Their numbers (M,).
        contacts : Contacts
            Of M positions.

        Examples
        --------
        >>> contacts = gears.contact().engagement.at(np.radians([0.0, 2.0]))
        >>> contacts.put(np.array([1]), gm.Contacts.nothing(1))
        >>> contacts.touching.tolist()
        [True, False]
        """
        for field in fields(self):
            getattr(self, field.name)[position] = getattr(contacts, field.name)


@dataclass
class Trial:
    """Places being solved for (C,): their position, unknowns, edges; and what came of it."""

    position: NDArray[np.intp]
    x: Array
    edges: NDArray[np.intp]
    good: NDArray[np.bool_]
    line: NDArray[np.bool_]
    residual: Array
    #: distance outside each edge (C, B), mm, NaN where not solved
    beyond: Array
    #: unknowns (C, 5) that were started from
    start: Array
    #: the advance (C,), rad, that may be there at most
    most: Array
    #: which of the places that were begun with (C,) it still is, -1: none
    first: NDArray[np.intp]
    #: whether the advance rises from their edge (C,) inwards
    rises: NDArray[np.bool_]
    #: in how many more rounds (C,) it may be solved for
    goes: NDArray[np.intp]

    @staticmethod
    def of(position: NDArray[np.intp], x: Array, edges: NDArray[np.intp]) -> Trial:
        count = len(position)
        nothing = np.zeros(count, dtype=bool)
        beyond = np.full((count, len(NUMBERED)), np.nan)
        return Trial(
            position,
            x,
            edges,
            good=nothing,
            line=nothing.copy(),
            residual=np.full(count, np.nan),
            beyond=beyond,
            start=x.copy(),
            most=np.full(count, np.inf),
            first=np.full(count, -1),
            rises=nothing.copy(),
            goes=np.full(count, GOES),
        )

    def give(
        self, contacts: Contacts, position: NDArray[np.intp], which: NDArray[np.intp], part: int, advance: Array
    ) -> None:
        """Put trials `which` (M,) into contacts as what touches first at positions (M,), with advances (M,)."""
        contacts.part[position], contacts.advance[position] = part, advance
        contacts.x[position], contacts.status[position] = self.x[which], int(Status.CONVERGED)
        contacts.residual[position], contacts.line[position] = self.residual[which], self.line[which]
        contacts.edges[position] = self.edges[which]


def refine_candidates(
    pair: Pair,
    phi1: Array,
    trial: Trial,
    contacts: Contacts,
    number: int,
    *,
    edges: bool = True,
    look: Callable[[NDArray[np.intp], Array], Array] | None = None,
) -> None:
    """Solve for all places of part `number`, go on to edges that they lie beyond, if `edges` count, and keep what is ahead.

    `look` gives what advance (M,), rad, there may be at most about places inside the flanks, by their positions (M,) and unknowns
    (M, 5): asked of those that were not found at once, and may be ahead by what is known of them.

    The trials record afterwards what became of them, not of those that came of them.
    """
    tried: set[tuple[int, int, int]] = set()
    begun = trial
    begun.first[:] = np.arange(len(begun.position))
    for _ in range(ROUNDS):
        if not len(trial.position):
            break
        solve(pair, phi1, trial)
        own = np.flatnonzero(trial.first >= 0)
        begun.x[trial.first[own]], begun.beyond[trial.first[own]] = trial.x[own], trial.beyond[own]
        good = np.flatnonzero(trial.good)
        advance = advances_of(pair, phi1, trial.x[good], trial.position[good])
        # the greatest of each position last; of equals the one on the fewest edges, of those known before too
        ahead = _rank(advance, trial.edges[good])
        order = np.argsort(ahead, kind="stable")
        position = trial.position[good][order]
        best, last, most = np.full(len(phi1), -np.inf), np.full(len(phi1), -1), np.full(len(phi1), -np.inf)
        best[position], last[position], most[position] = ahead[order], good[order], advance[order]
        better = np.flatnonzero(best > _rank(contacts.advance, contacts.edges))
        trial.give(contacts, better, last[better], number, most[better])
        if look is not None and trial is begun:
            unsolved = (trial.edges[:, 0] < 0) & ~trial.good & np.isfinite(trial.most)
            lost = np.flatnonzero(unsolved & (trial.most >= contacts.advance[trial.position]))
            trial.most[lost] = np.minimum(trial.most[lost], look(trial.position[lost], trial.start[lost]))
        trial = _next(pair, phi1, trial, contacts, tried if edges else None)


def _rank(advance: Array, edges: NDArray[np.intp]) -> Array:
    """Advances (N,), rad, that are less by EQUAL for each of their edges (N, 2)."""
    rank: Array = advance - EQUAL * (edges >= 0).sum(axis=1)
    return rank


def advances_of(pair: Pair, phi1: Array, x: Array, position: NDArray[np.intp]) -> Array:
    """By how much (M,), rad, the gear is ahead of the nominal ratio, in the sense of the drive."""
    return pair.drive * (x[:, 4] - pair.ratio * phi1[position])


def solve(pair: Pair, phi1: Array, trial: Trial) -> None:
    """Solve the exact conditions of all trials, and judge what they give: on both flanks, facing, not crossing."""
    every = np.arange(len(trial.position))
    conditions = Conditions(pair.flanks, phi1, pair.length, pair.all_bounds).repeat(trial.position)
    conditions = replace(conditions, choice=pair.numbers[trial.edges])
    # what is slow inside the flanks may well be a line
    lines = trial.line | ((trial.edges[:, 0] < 0) & (trial.goes < GOES))
    converged = np.zeros(len(every), dtype=bool)
    _solve_some(pair, conditions, trial, every, np.where(lines, RCOND, 0.0), converged)
    _judge(pair, conditions, trial, converged)
    # along a line the solution nearest the start is wanted, not one that Newton ran to
    run = np.flatnonzero(trial.line & (trial.edges[:, 0] < 0) & ~lines)
    if run.size:
        trial.x[run] = trial.start[run]
        _solve_some(pair, conditions, trial, run, np.full(run.size, RCOND), converged)
        _judge(pair, conditions, trial, converged)
    trial.edges[trial.line] = -1


def _solve_some(
    pair: Pair,
    conditions: Conditions,
    trial: Trial,
    which: NDArray[np.intp],
    rcond: Array,
    converged: NDArray[np.bool_],
) -> None:
    """Solve trials `which` from their unknowns."""
    solution = newton.solve(
        partial(at_positions, conditions, which),
        trial.x[which],
        tolerance=pair.tolerance,
        max_step=0.5 * pair.max_step,
        max_iterations=15,
        halvings=3,
        rcond=rcond,
        max_evaluations=EVALUATIONS,
    )
    trial.x[which], trial.residual[which], converged[which] = solution.values, solution.residual, solution.converged
    trial.goes[which] = np.where(solution.status == Status.MAX_ITERATIONS, trial.goes[which] - 1, 0)


def _judge(pair: Pair, conditions: Conditions, trial: Trial, converged: NDArray[np.bool_]) -> None:
    """Which trials are contacts, and which of them lines."""
    touch = conditions.touch(trial.x, np.arange(len(trial.position)))
    one, two = touch.fixed
    outside, past = margins(pair, touch, trial.x)
    good = converged & (outside <= EDGE_SLACK).all(axis=1) & (past <= EDGE_SLACK)
    good &= dot(one.n, two.n) < 0.0
    # surfaces that touch may do so along a line, which may run over an edge, and may cross each other
    tangent = np.flatnonzero(converged & (np.abs(one.n + two.n).max(axis=1) < AGREE))
    line, crossing = shape(pair, touch[tangent])
    inside = trial.edges[tangent, 0] < 0
    trial.line[tangent] = line & (inside | good[tangent])
    good[tangent] &= ~(crossing & inside)
    trial.good[:] = good
    trial.rises[:] = good & _rises(pair, conditions, trial, touch)
    trial.beyond[:] = np.where(converged[:, None], outside, np.nan)


def _rises(pair: Pair, conditions: Conditions, trial: Trial, touch: Touch) -> NDArray[np.bool_]:
    """Whether the advance rises towards the inside from the edge that trials (C,) lie on, or from where two edges cross along
    one of them; only of those that are known to be near what may be ahead."""
    rises = np.zeros(len(trial.position), dtype=bool)
    asked = np.flatnonzero(np.isfinite(trial.most) & (trial.edges[:, 0] >= 0) & (trial.edges[:, 0] < CORNER))
    if not asked.size:
        return rises
    one, two = (jet[asked] for jet in touch.fixed)
    way = conditions.mounts(asked)[1].velocity(two.r)
    # steps on the pinion, and how far the gear has to turn for them
    first = unit(one.r_u)
    steps = np.stack((first, cross(one.n, first)), axis=1)
    angle = (steps @ two.n[..., None])[..., 0] / dot(two.n, way)[:, None]
    advance = pair.drive * angle
    over = np.zeros((2, asked.size, 2))
    for number in pair.ends:
        bound = pair.bounds[number]
        if bound is None:
            continue
        for slot in range(2):
            own = np.flatnonzero(trial.edges[asked, slot] == number)
            if not own.size:
                continue
            gradient = bound.level.gradient(touch.own[bound.member].r[asked[own]])
            gradient = (touch.turns[bound.member][asked[own]] @ gradient[..., None])[..., 0]
            on_member = steps[own] if bound.member == 0 else steps[own] - angle[own][..., None] * way[own][:, None]
            over[slot, own] = (on_member @ gradient[..., None])[..., 0]
    alone = trial.edges[asked, 1] < 0
    inwards = -(advance * over[0]).sum(axis=1) > 0.0
    # along either of two edges, to the inside of the other
    along = np.zeros(asked.size, dtype=bool)
    for edge, other in ((0, 1), (1, 0)):
        step = np.stack((-over[edge, :, 1], over[edge, :, 0]), axis=-1)
        step *= -np.sign((step * over[other]).sum(axis=1))[:, None]
        size = np.sqrt((step**2).sum(axis=1))
        along |= (advance * step).sum(axis=1) > RISE * size
    along |= _rises_from_corners(
        pair, trial.edges[asked], touch[asked], steps, angle[..., None] * way[:, None], advance
    )
    rises[asked] = np.where(alone, inwards, along)
    return rises


def _rises_from_corners(
    pair: Pair, edges: NDArray[np.intp], touch: Touch, steps: Array, turned: Array, advance: Array
) -> NDArray[np.bool_]:
    """Whether the advance rises along the tip line, on one side or the other, from those of places (C,) that are corners of it; by
    two steps on the pinion (C, 2, 3), by what the gear's points then turn (C, 2, 3), mm, and the advance rises (C, 2)."""
    rises = np.zeros(len(edges), dtype=bool)
    for tip, corner in pair.tip_corners:
        own = np.flatnonzero((edges[:, 0] == tip) & (edges[:, 1] == corner))
        edge, station = pair.bounds[tip], pair.bounds[corner]
        if not own.size or edge is None or station is None:
            continue
        r, rotation = touch.own[edge.member].r[own], touch.turns[edge.member][own]
        on_member = steps[own] if edge.member == 0 else steps[own] - turned[own]
        along = station.level.gradient(r)
        of_station, *of_tip = (
            (on_member @ turn(rotation, gradient)[..., None])[..., 0]
            for gradient in (along, *(edge.level.gradient(r + side * BESIDE * along) for side in (1.0, -1.0)))
        )
        for side, over in zip((1.0, -1.0), of_tip, strict=True):
            step = np.stack((-over[:, 1], over[:, 0]), axis=-1)
            step *= side * np.sign((step * of_station).sum(axis=1))[:, None]
            rises[own] |= (advance[own] * step).sum(axis=1) > RISE * np.sqrt((step**2).sum(axis=1))
    return rises


def at_positions(
    conditions: Conditions, position: NDArray[np.intp], x: Array, index: NDArray[np.intp]
) -> tuple[Array, Array]:
    """Conditions for a solve at some positions only."""
    return conditions(x, position[index])


def margins(pair: Pair, touch: Touch, x: Array) -> tuple[Array, Array]:
    """Distance (mm) outside each edge of both flanks (M, B), -inf for those that there are not; past the ends of fillets (M,),
    infinite of places on the next winding of the pinion's tooth."""
    outside = np.full((len(x), len(pair.bounds)), -np.inf)
    for k in pair.ends:
        bound = pair.bounds[k]
        assert bound is not None
        outside[:, k] = bound.level.value(touch.own[bound.member].r)
    ends = np.where(pair.next_winding(touch.phi1, touch.own[0].r), np.inf, -np.inf)
    for member, flank in enumerate(pair.flanks):
        if flank.beyond_ends is not None:
            parameters = x[:, 2 * member : 2 * member + 2]
            ends = np.maximum(ends, flank.beyond_ends(parameters, touch.own[member].r))
    return outside, ends


def shape(pair: Pair, touch: Touch) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Whether the surfaces touch along a line (M,), and whether they cross (M,)."""
    one, two = touch.fixed
    e1, e2 = tangent_basis(one)
    ellipse = contact_ellipse(relative_curvature(one, two, e1, e2), e1, e2, pair.delta, flat=FLAT)
    return ellipse.line, ellipse.crossing


def _next(pair: Pair, phi1: Array, trial: Trial, contacts: Contacts, tried: set[tuple[int, int, int]] | None) -> Trial:
    """What to try for places that came out beyond an edge, or nowhere, and may still be ahead: that edge alone, and its crossing
    with their own, which is nearer to where they were started than to where their edge led them, but for what has been `tried`;
    without that no edge. What is not solved yet goes on."""
    spawned: list[tuple[int, Array, int, int, float]] = []
    leading = trial.most >= contacts.advance[trial.position]
    unsolved = np.flatnonzero((trial.goes > 0) & leading)
    if tried is not None:
        # what is ahead already may be followed upwards, even where less was expected there
        advance = np.where(trial.good, advances_of(pair, phi1, trial.x, trial.position), -np.inf)
        ahead = trial.rises & (advance >= contacts.advance[trial.position] - EQUAL)
        trial.most = np.where(ahead, np.maximum(trial.most, advance), trial.most)
        spawned = _edges_next(pair, trial, leading | ahead, tried)
    count = len(spawned)
    position = np.array([place[0] for place in spawned], dtype=np.intp)
    x = np.array([place[1] for place in spawned]).reshape(count, 5)
    edges = np.array([place[2:4] for place in spawned], dtype=np.intp).reshape(count, 2)
    following = Trial.of(
        np.concatenate((position, trial.position[unsolved])),
        np.concatenate((x, trial.x[unsolved])),
        np.concatenate((edges, trial.edges[unsolved])),
    )
    following.most = np.concatenate(([place[4] for place in spawned], trial.most[unsolved]))
    following.goes[count:], following.start[count:] = trial.goes[unsolved], trial.start[unsolved]
    following.first[count:] = trial.first[unsolved]
    return following


def _edges_next(
    pair: Pair, trial: Trial, leading: NDArray[np.bool_], tried: set[tuple[int, int, int]]
) -> list[tuple[int, Array, int, int, float]]:
    """Edges to try next, each with its position, start, second edge (-1: none) and the advance that may be there at most."""
    spawned: list[tuple[int, Array, int, int, float]] = []
    # plain numbers: rows of arrays, one by one, take ten times as long
    position, edges, most = trial.position.tolist(), trial.edges.tolist(), trial.most.tolist()
    outside, smooth = (trial.beyond > EDGE_SLACK).tolist(), pair.smooth.tolist()

    def spawn(k: int, x: Array, first: int, second: int, mark: int) -> None:
        key = (position[k], first, mark)
        if key not in tried:
            tried.add(key)
            spawned.append((position[k], x, first, second, most[k]))

    for k in np.flatnonzero(~np.isnan(trial.beyond[:, 0]) & (trial.edges[:, 1] < 0)).tolist():
        tried.add((position[k], edges[k][0], -1))
    for k in np.flatnonzero(trial.rises & leading).tolist():
        own, crossed = edges[k]
        # from an edge inwards; from where two cross along either of them, though that was solved for from elsewhere before: along
        # one edge the advance may have several summits
        ways = ((-1, own),) if crossed < 0 else ((own, ALONG - crossed), (crossed, ALONG - own))
        for edge, mark in ways[: 1 if crossed >= 0 and OF_CORNERS[crossed] else 2]:
            spawn(k, trial.x[k], edge, -1, mark)
    for k in np.flatnonzero(~trial.good & leading).tolist():
        first, second = edges[k]
        x = trial.x[k] if second >= 0 else trial.start[k]
        over = [number for number, out in enumerate(outside[k]) if out]
        if second < 0:
            # and that one alone
            for other in over:
                if not smooth[other]:
                    spawn(k, trial.x[k], other, -1, -1)
        if first < 0:
            continue
        if second < 0:
            # past a smooth end the tooth goes on, unless its own edge is one
            others = [number for number in over if smooth[first] or not smooth[number]]
            if not others:
                others = [number for number in pair.edges if smooth[first] or not smooth[number]]
            pairs = [(first, other) for other in others if other != first]
            pairs += [corner for corner in pair.tip_corners if corner[0] == first]
        elif OF_CORNERS[second]:
            pairs = []
        else:
            pairs = [(edge, other) for other in over if other not in (first, second) for edge in (first, second)]
        for a, b in pairs:
            spawn(k, x, min(a, b), max(a, b), max(a, b))
    return spawned
