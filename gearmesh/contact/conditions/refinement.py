"""Exact solution of places where teeth may touch, many places at once, and the most advanced contact of each position.

Every place lies on no edge, on one edge or on two edges. A solution beyond an edge leads to a new place: the edge itself, or its
crossing with the edge on which the place lies.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.edge_places import EdgePlaces, TriedPlaces, places_beyond, places_upwards
from gearmesh.contact.conditions.meshing import Conditions, Touch
from gearmesh.contact.first_touch.windows import Windows
from gearmesh.contact.pair import EDGE_CORNER, NUMBERED_EDGES, Pair
from gearmesh.errors import Status
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, cross, dot, turn, unit
from gearmesh.kernel.surface.curvature import contact_ellipse, relative_curvature, tangent_basis
from gearmesh.records import dataclass

#: a point this far (mm) outside a trimmed flank still counts as on its edge
EDGE_SLACK = 1e-7
#: relative eigenvalue of K1 - K2 below which the flanks touch along a line
FLAT_EIGENVALUE = 1e-7
#: singular values below this share of the largest one belong to the null space of line contact
NULL_SPACE_SHARE = 1e-9
#: advances (rad) that differ by less are equal
EQUAL_ADVANCE_RAD = 1e-12
#: rise of the advance along an edge (rad/mm) that is rounding
MIN_RISE = 1e-12
#: distance (mm) from a corner of a tip line at which the directions of the line are taken
CORNER_STEP_MM = 1e-6
#: difference of normals that is rounding
NORMAL_ROUNDING = 1e-8
#: rounds of new places: two edges cross, and a third edge may replace one of them
REFINING_ROUNDS = 4
#: evaluations of the conditions in a round
EVALUATIONS_PER_ROUND = 12
#: rounds in which a slow place is solved for, together with the new places
MAX_ROUNDS_PER_PLACE = 4
#: steps of the sampled grid within which a place inside the flanks belongs to the summit that is solved
SAME_SUMMIT_STEPS = 2.0


@dataclass
class Contacts:
    """First contact at N positions of a tooth pair."""

    #: parameters of both surfaces and rotation of the gear (rad), (N, 5), NaN without contact
    x: Array
    #: numbers (N, 2) of the edges in contact, -1 for none
    edges: NDArray[np.intp]
    #: True (N,) where the flanks touch along a line
    line: NDArray[np.bool_]
    #: codes (N,) of `errors.Status`
    status: NDArray[np.int64]
    #: residual (N,) of the conditions, mm
    residual: Array
    #: parts (N,) in contact, numbers in `pair.PARTS`, 0 on the flanks
    part: NDArray[np.intp]
    #: advance (N,) of the gear over the nominal ratio, rad, -inf without contact
    advance: Array

    @property
    def touching(self) -> NDArray[np.bool_]:
        """True (N,) at positions with contact."""
        converged: NDArray[np.bool_] = self.status == Status.CONVERGED
        return converged

    @staticmethod
    def nothing(count: int) -> Contacts:
        """Return positions without contact.

        `count`: number N of positions.
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
        """Return the contacts of some positions.

        `position`: numbers (M,) of the positions.
        """
        return Contacts(*(getattr(self, field.name)[position] for field in fields(self)))

    def put(self, position: NDArray[np.intp], contacts: Contacts) -> None:
        """Replace the contacts of some positions.

        `position`: numbers (M,) of the positions.
        """
        for field in fields(self):
            getattr(self, field.name)[position] = getattr(contacts, field.name)


@dataclass
class Trial:
    """C places that are solved for, and their results."""

    #: positions (C,) of the places
    position: NDArray[np.intp]
    #: unknowns (C, 5)
    x: Array
    #: numbers (C, 2) of the edges on which the places lie, -1 for none
    edges: NDArray[np.intp]
    #: True (C,) for solutions that are contacts
    good: NDArray[np.bool_]
    #: True (C,) for contact along a line
    line: NDArray[np.bool_]
    #: residual (C,), mm
    residual: Array
    #: distance (C, B) beyond each edge, mm, NaN without a solution
    beyond: Array
    #: unknowns (C, 5) at the start
    start: Array
    #: greatest possible advance (C,) near the place, rad
    most: Array
    #: number (C,) of the place among the first places, -1 for new places
    first: NDArray[np.intp]
    #: True (C,) where the advance rises from the edge inwards
    rises: NDArray[np.bool_]
    #: rounds (C,) in which the place may still be solved for
    goes: NDArray[np.intp]

    @staticmethod
    def of(position: NDArray[np.intp], x: Array, edges: NDArray[np.intp]) -> Trial:
        count = len(position)
        nothing = np.zeros(count, dtype=bool)
        beyond = np.full((count, len(NUMBERED_EDGES)), np.nan)
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
            goes=np.full(count, MAX_ROUNDS_PER_PLACE),
        )

    def some(self, which: NDArray[np.intp]) -> Trial:
        """Return some of the trials."""
        return Trial(*(getattr(self, field.name)[which] for field in fields(self)))

    def join(self, other: Trial) -> Trial:
        """Return these trials and others after them."""
        return Trial(*(np.concatenate([getattr(part, field.name) for part in (self, other)]) for field in fields(self)))

    def give(
        self, contacts: Contacts, position: NDArray[np.intp], which: NDArray[np.intp], part: int, advance: Array
    ) -> None:
        """Put trials `which` (M,) into contacts as first contact at positions (M,), with advances (M,), rad."""
        contacts.part[position], contacts.advance[position] = part, advance
        contacts.x[position], contacts.status[position] = self.x[which], int(Status.CONVERGED)
        contacts.residual[position], contacts.line[position] = self.residual[which], self.line[which]
        contacts.edges[position] = self.edges[which]


@dataclass(frozen=True)
class Priority:
    """Order in which C places are solved."""

    #: True (C,) for the most advanced place of each position
    leads: NDArray[np.bool_]
    #: changes (C, 2, 2) of the pinion's parameters by one step of rows and one step of columns of the sampled grid
    steps: Array
    #: nodes about the places
    windows: Windows

    def done(
        self, begun: Trial, later: NDArray[np.intp], first: Trial, contacts: Contacts, number: int
    ) -> NDArray[np.bool_]:
        """Return True (L,) for places `later` (L,) that need no solution after the `first` trials of part `number`.

        These are places that cannot be ahead of the solved contact, and places inside the flanks beside a solved summit: the
        contact within SAME_SUMMIT_STEPS, inside the flanks or on an edge from which the advance falls inwards.
        """
        position = begun.position[later]
        solved = contacts.touching & (contacts.part == number)
        solved[first.position[first.rises]] = False
        with np.errstate(all="ignore"):
            apart = contacts.x[position, :2] - begun.x[later, :2]
            rows, columns = np.moveaxis(self.steps[later], -1, 0)
            area = rows[:, 0] * columns[:, 1] - rows[:, 1] * columns[:, 0]
            away = np.stack(
                (
                    apart[:, 0] * columns[:, 1] - apart[:, 1] * columns[:, 0],
                    rows[:, 0] * apart[:, 1] - rows[:, 1] * apart[:, 0],
                )
            )
            beside = (np.abs(away) <= SAME_SUMMIT_STEPS * np.abs(area)).all(axis=0)
        same = beside & solved[position] & (begun.edges[later, 0] < 0)
        complete = contacts.line[position] & (contacts.part[position] == number)
        done: NDArray[np.bool_] = same | complete | (begun.most[later] < contacts.advance[position])
        left = np.flatnonzero(~done)
        begun.most[later[left]] = np.minimum(begun.most[later[left]], self.windows[later[left]].most(EDGE_SLACK))
        done[left] = begun.most[later[left]] < contacts.advance[position[left]]
        return done


def refine_candidates(
    pair: Pair,
    phi1: Array,
    trial: Trial,
    contacts: Contacts,
    number: int,
    *,
    edges: bool = True,
    look: Callable[[NDArray[np.intp], Array], Array] | None = None,
    priority: Priority | None = None,
) -> None:
    """Solve for all places of part `number` and keep the most advanced contact of each position.

    Solutions beyond edges lead to places on these edges, if `edges` count. `look` returns the greatest possible advance (M,), rad,
    near places inside the flanks, from their positions (M,) and unknowns (M, 5). It is called for places that were not found in the
    first round and may be ahead. With a `priority`, the most advanced place of each position is solved first, and others only if
    they may be ahead of its solution. The given trials hold their own results afterwards, not the results of new places.
    """
    tried = TriedPlaces()
    begun = trial
    begun.first[:] = np.arange(len(begun.position))
    later = begun.first[:0]
    if priority is not None:
        later = np.flatnonzero(~priority.leads)
        trial = begun.some(np.flatnonzero(priority.leads))
    for k in range(REFINING_ROUNDS + (priority is not None)):
        if not len(trial.position) and not later.size:
            break
        solve(pair, phi1, trial)
        own = np.flatnonzero(trial.first >= 0)
        begun.x[trial.first[own]], begun.beyond[trial.first[own]] = trial.x[own], trial.beyond[own]
        good = np.flatnonzero(trial.good)
        advance = advances_of(pair, phi1, trial.x[good], trial.position[good])
        # sort so that the greatest advance of each position is last; of equal advances the contact on fewer edges wins
        ahead = _rank(advance, trial.edges[good])
        order = np.argsort(ahead, kind="stable")
        position = trial.position[good][order]
        best, last, most = np.full(len(phi1), -np.inf), np.full(len(phi1), -1), np.full(len(phi1), -np.inf)
        best[position], last[position], most[position] = ahead[order], good[order], advance[order]
        better = np.flatnonzero(best > _rank(contacts.advance, contacts.edges))
        trial.give(contacts, better, last[better], number, most[better])
        if look is not None and k == 0:
            unsolved = (trial.edges[:, 0] < 0) & ~trial.good & np.isfinite(trial.most)
            lost = np.flatnonzero(unsolved & (trial.most >= contacts.advance[trial.position]))
            trial.most[lost] = np.minimum(trial.most[lost], look(trial.position[lost], trial.start[lost]))
        following = _next(pair, phi1, trial, contacts, number, tried if edges else None)
        if later.size:
            assert priority is not None
            done = priority.done(begun, later, trial, contacts, number)
            begun.most[later[done]] = -np.inf
            following, later = following.join(begun.some(later[~done])), later[:0]
        trial = following


def _rank(advance: Array, edges: NDArray[np.intp]) -> Array:
    """Return advances (N,), rad, less EQUAL_ADVANCE_RAD for each edge of the contact (N, 2)."""
    rank: Array = advance - EQUAL_ADVANCE_RAD * (edges >= 0).sum(axis=1)
    return rank


def advances_of(pair: Pair, phi1: Array, x: Array, position: NDArray[np.intp]) -> Array:
    """Return advances (M,), rad, of the gear over the nominal ratio, in the driving sense."""
    return pair.drive * (x[:, 4] - pair.ratio * phi1[position])


def solve(pair: Pair, phi1: Array, trial: Trial) -> None:
    """Solve the exact conditions of all trials, and mark solutions on both flanks with facing normals and no crossing."""
    every = np.arange(len(trial.position))
    conditions = Conditions(pair.flanks, phi1, pair.length, pair.all_bounds).repeat(trial.position)
    conditions = replace(conditions, choice=pair.numbers[trial.edges])
    # a place inside the flanks that converges slowly is probably a line
    lines = trial.line | ((trial.edges[:, 0] < 0) & (trial.goes < MAX_ROUNDS_PER_PLACE))
    converged = np.zeros(len(every), dtype=bool)
    _solve_some(pair, conditions, trial, every, np.where(lines, NULL_SPACE_SHARE, 0.0), converged)
    _judge(pair, conditions, trial, converged)
    # on a line take the solution nearest to the start, not a point to which Newton has run along the line
    run = np.flatnonzero(trial.line & (trial.edges[:, 0] < 0) & ~lines)
    if run.size:
        trial.x[run] = trial.start[run]
        _solve_some(pair, conditions, trial, run, np.full(run.size, NULL_SPACE_SHARE), converged)
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
    """Solve trials `which` from their present unknowns."""
    solution = newton.solve(
        partial(at_positions, conditions, which),
        trial.x[which],
        tolerance=pair.tolerance,
        max_step=0.5 * pair.max_step,
        max_iterations=15,
        halvings=3,
        rcond=rcond,
        max_evaluations=EVALUATIONS_PER_ROUND,
    )
    trial.x[which], trial.residual[which], converged[which] = solution.values, solution.residual, solution.converged
    trial.goes[which] = np.where(solution.status == Status.MAX_ITERATIONS, trial.goes[which] - 1, 0)


def _judge(pair: Pair, conditions: Conditions, trial: Trial, converged: NDArray[np.bool_]) -> None:
    """Mark trials that are contacts, and contacts along lines."""
    touch = conditions.touch(trial.x, np.arange(len(trial.position)))
    one, two = touch.fixed
    outside, past = margins(pair, touch, trial.x)
    good = converged & (outside <= EDGE_SLACK).all(axis=1) & (past <= EDGE_SLACK)
    good &= dot(one.n, two.n) < 0.0
    # tangent surfaces may touch along a line, which may run over an edge, or may cross each other
    tangent = np.flatnonzero(converged & (np.abs(one.n + two.n).max(axis=1) < NORMAL_ROUNDING))
    line, crossing = shape(pair, touch[tangent])
    inside = trial.edges[tangent, 0] < 0
    trial.line[tangent] = line & (inside | good[tangent])
    good[tangent] &= ~(crossing & inside)
    trial.good[:] = good
    trial.rises[:] = good & _rises(pair, conditions, trial, touch)
    trial.beyond[:] = np.where(converged[:, None], outside, np.nan)


def _rises(pair: Pair, conditions: Conditions, trial: Trial, touch: Touch) -> NDArray[np.bool_]:
    """Return True (C,) where the advance rises inwards from the edge of a trial, or along one of its two edges.

    Only trials with a finite `most` are examined.
    """
    rises = np.zeros(len(trial.position), dtype=bool)
    asked = np.flatnonzero(np.isfinite(trial.most) & (trial.edges[:, 0] >= 0) & (trial.edges[:, 0] < EDGE_CORNER))
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
        along |= (advance * step).sum(axis=1) > MIN_RISE * size
    along |= _rises_from_corners(
        pair, trial.edges[asked], touch[asked], steps, angle[..., None] * way[:, None], advance
    )
    rises[asked] = np.where(alone, inwards, along)
    return rises


def _rises_from_corners(
    pair: Pair, edges: NDArray[np.intp], touch: Touch, steps: Array, turned: Array, advance: Array
) -> NDArray[np.bool_]:
    """Return True (C,) for places at corners of a tip line from which the advance rises along the line, on either side.

    - `steps`: two steps on the pinion (C, 2, 3), mm
    - `turned`: movements of the gear's points (C, 2, 3), mm
    - `advance`: rises of the advance (C, 2)
    """
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
            for gradient in (along, *(edge.level.gradient(r + side * CORNER_STEP_MM * along) for side in (1.0, -1.0)))
        )
        for side, over in zip((1.0, -1.0), of_tip, strict=True):
            step = np.stack((-over[:, 1], over[:, 0]), axis=-1)
            step *= side * np.sign((step * of_station).sum(axis=1))[:, None]
            rises[own] |= (advance[own] * step).sum(axis=1) > MIN_RISE * np.sqrt((step**2).sum(axis=1))
    return rises


def at_positions(
    conditions: Conditions, position: NDArray[np.intp], x: Array, index: NDArray[np.intp]
) -> tuple[Array, Array]:
    """Return residuals and Jacobians at some of the positions of the conditions."""
    return conditions(x, position[index])


def margins(pair: Pair, touch: Touch, x: Array) -> tuple[Array, Array]:
    """Return distances (M, B), mm, beyond each edge, -inf for missing edges, and distances (M,), mm, past ends that are no edges.

    The second distances are infinite for places on the next winding of the pinion's tooth.
    """
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
    """Return True (M,) where the surfaces touch along a line, and True (M,) where they cross."""
    one, two = touch.fixed
    e1, e2 = tangent_basis(one)
    ellipse = contact_ellipse(relative_curvature(one, two, e1, e2), e1, e2, pair.delta, flat=FLAT_EIGENVALUE)
    return ellipse.line, ellipse.crossing


def _next(pair: Pair, phi1: Array, trial: Trial, contacts: Contacts, number: int, tried: TriedPlaces | None) -> Trial:
    """Return the trials of the next round: new places on edges, and places that are not solved yet.

    A place beyond an edge, or without a solution, that may still be ahead leads to this edge alone, and to its crossing with the
    edge of the place. The crossing is nearer to the start of the place than to its end. Places in `tried` are not repeated; None
    stands for no edges. Positions where part `number` touches along a line are complete.
    """
    # nothing of these surfaces is ahead of their contact along a line
    complete = contacts.line[trial.position] & (contacts.part[trial.position] == number)
    leading = (trial.most >= contacts.advance[trial.position]) & ~complete
    unsolved = np.flatnonzero((trial.goes > 0) & leading)
    new = unsolved[:0]
    x, edges = trial.x[new], trial.edges[new]
    if tried is not None:
        # a contact that is already ahead may be followed upwards, even beyond the advance that was expected there
        advance = np.where(trial.good, advances_of(pair, phi1, trial.x, trial.position), -np.inf)
        ahead = trial.rises & (advance >= contacts.advance[trial.position] - EQUAL_ADVANCE_RAD)
        trial.most = np.where(ahead, np.maximum(trial.most, advance), trial.most)
        leading |= ahead
        alone = np.flatnonzero(~np.isnan(trial.beyond[:, 0]) & (trial.edges[:, 1] < 0))
        tried.add(trial.position[alone], trial.edges[alone, 0], np.full(alone.size, -1))
        places = EdgePlaces.together(
            [
                places_upwards(np.flatnonzero(trial.rises & leading), trial.edges),
                places_beyond(pair, np.flatnonzero(~trial.good & leading), trial.edges, trial.beyond > EDGE_SLACK),
            ]
        )
        places = places[tried.add(trial.position[places.origin], places.edges[:, 0], places.mark)]
        new, edges = places.origin, places.edges
        x = np.where(places.from_start[:, None], trial.start[new], trial.x[new])
    count = len(new)
    following = Trial.of(
        np.concatenate((trial.position[new], trial.position[unsolved])),
        np.concatenate((x, trial.x[unsolved])),
        np.concatenate((edges, trial.edges[unsolved])),
    )
    following.most = np.concatenate((trial.most[new], trial.most[unsolved]))
    following.goes[count:], following.start[count:] = trial.goes[unsolved], trial.start[unsolved]
    following.first[count:] = trial.first[unsolved]
    return following
