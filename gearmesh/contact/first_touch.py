"""First touch of two trimmed flanks, position by position: of all places where they may touch, the one that leads.

`field` finds the places, over the whole of both flanks; here the exact conditions are solved from each of them. What they give
are points that both flanks have, so none of them can lead more than the first touch does: the greatest is the contact, whether
it lies inside both flanks, on an edge or where two edges cross.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.field import INTERIOR, candidates
from gearmesh.contact.meshing import Conditions, Touch
from gearmesh.contact.pair import EDGES, Pair
from gearmesh.errors import Status
from gearmesh.kernel import newton
from gearmesh.kernel.algebra import Array, dot
from gearmesh.kernel.curvature import contact_ellipse, relative_curvature, tangent_basis

#: residual (mm) below which a position counts as solved; Newton goes one step further, to rounding
TOLERANCE = 1e-11
#: a point this far (mm) outside a trimmed flank still counts as on its edge
EDGE_SLACK = 1e-7
#: relative eigenvalue of K1 - K2 below which contact is along a line
FLAT = 1e-7
#: singular values below this share of the largest are taken for the null space of line contact
RCOND = 1e-9
#: leads (rad) that differ by less are equal
EQUAL = 1e-12
#: normals that differ by less agree
AGREE = 1e-8
#: edges added to what is solved for, at most: two cross, and a third may take the place of one of them
ROUNDS = 4
#: a lead sampled this far (rad; 0.01 arcsec) above what was found is looked into
UNSEEN = 5e-8
#: rounds of the search for it, and the share of the flank that its first steps are
CLIMBS, FIRST_STEP = 40, 0.04
#: rounds in which the end of a flank is searched, each four times as fine
END_ROUNDS = 8
#: by how much (rad) a search may come short of a summit
SUMMIT = 1e-11
#: numbers, in `Contacts.edges`, of the ends of flank and fillet that are no edges of the solver: pinion's and gear's
JOINTS = (6, 7)


@dataclass
class Contacts:
    """First touch at N positions: unknowns x (N, 5), NaN where there is none; `edges` (N, 2), the edges that carry by their numbers
    in `Pair.bounds` (-1: none); `line` (N,) where the flanks touch along a line; `status`, `residual` (N,) as of a `Solution`;
    `part` (N,): 0 on the flanks, 1 on the pinion's fillet, 2 on the gear's; `lead` (N,), rad, and `on_flanks` (N,), that of the
    flanks alone, -inf where there is none; `sampled` (N,): the greatest lead that the field saw."""

    x: Array
    edges: NDArray[np.intp]
    line: NDArray[np.bool_]
    status: NDArray[np.int64]
    residual: Array
    part: NDArray[np.intp]
    lead: Array
    on_flanks: Array
    sampled: Array

    @property
    def touching(self) -> NDArray[np.bool_]:
        found: NDArray[np.bool_] = self.status == Status.CONVERGED
        return found

    @staticmethod
    def nothing(count: int) -> Contacts:
        return Contacts(
            np.full((count, 5), np.nan),
            np.full((count, 2), -1),
            np.zeros(count, dtype=bool),
            np.full(count, int(Status.NO_CONTACT)),
            np.full(count, np.nan),
            np.zeros(count, dtype=np.intp),
            *(np.full(count, -np.inf) for _ in range(3)),
        )

    def put(self, position: NDArray[np.intp], found: Contacts) -> None:
        """Other contacts (M,) in the places of positions (M,)."""
        for each in fields(self):
            getattr(self, each.name)[position] = getattr(found, each.name)

    def take(self, position: NDArray[np.intp], found: Trial, which: NDArray[np.intp], part: int) -> None:
        """Trials `which` (M,) as what touches first at positions (M,)."""
        self.part[position] = part
        self.x[position], self.status[position] = found.x[which], int(Status.CONVERGED)
        self.residual[position], self.line[position] = found.residual[which], found.line[which]
        self.edges[position] = found.edges[which]


@dataclass
class Trial:
    """Places being solved for (C,): their position, unknowns, edges; and what came of it."""

    position: NDArray[np.intp]
    x: Array
    edges: NDArray[np.intp]
    good: NDArray[np.bool_]
    line: NDArray[np.bool_]
    residual: Array
    #: distance outside each edge (C, 6), mm, NaN where not solved
    beyond: Array
    #: unknowns (C, 5) that were started from
    start: Array

    @staticmethod
    def of(position: NDArray[np.intp], x: Array, edges: NDArray[np.intp]) -> Trial:
        count = len(position)
        nothing = np.zeros(count, dtype=bool)
        beyond = np.full((count, 2 * len(EDGES)), np.nan)
        return Trial(position, x, edges, nothing, nothing.copy(), np.full(count, np.nan), beyond, x.copy())


def first_touch(pair: Pair, phi1: Array) -> Contacts:
    """First touch at rotations phi1 (N,); the flanks' mounts may be N of their own. Nothing is raised or warned of."""
    return touches(pair, phi1)[0]


def touches(pair: Pair, phi1: Array, *, edges: bool = True) -> tuple[Contacts, Contacts]:
    """First touch of the teeth at rotations phi1 (N,), tips on fillets too, and of the flanks alone.

    Without `edges` only tangency inside both flanks counts.
    """
    contacts = Contacts.nothing(len(phi1))
    flanks = contacts
    with np.errstate(all="ignore"):
        for number, part in enumerate(pair.parts):
            found = candidates(part, phi1, trimmed=edges)
            contacts.sampled = np.maximum(contacts.sampled, found.best)
            # on fillets only what may be ahead of the flanks
            worth = (found.best + found.gain > contacts.lead)[found.position]
            if not edges:
                worth &= found.edge == INTERIOR
            on = np.full((int(worth.sum()), 2), -1)
            on[:, 0] = found.edge[worth]
            settle(part, phi1, Trial.of(found.position[worth], found.x[worth], on), contacts, number)
            missed = np.flatnonzero((found.best > contacts.lead + UNSEEN) & (found.top >= 0))
            if edges and missed.size:
                looked_into(part, phi1, missed, found.x[found.top[missed]], contacts, number)
            if number == 0:
                flanks = replace(
                    contacts, **{each.name: getattr(contacts, each.name).copy() for each in fields(contacts)}
                )
    return contacts, flanks


def settle(pair: Pair, phi1: Array, trial: Trial, contacts: Contacts, number: int) -> None:
    """Solve for all places of part `number`, go on to edges that they lie beyond, and keep what leads."""
    tried: set[tuple[int, int, int]] = set()
    for _ in range(ROUNDS):
        if not len(trial.position):
            break
        solve(pair, phi1, trial)
        good = np.flatnonzero(trial.good)
        own = leads_of(pair, phi1, trial.x[good], trial.position[good])
        # the greatest of each position last; of equals the one on the fewest edges
        order = np.argsort(own - EQUAL * (trial.edges[good] >= 0).sum(axis=1), kind="stable")
        position = trial.position[good][order]
        best, last = np.full(len(phi1), -np.inf), np.full(len(phi1), -1)
        best[position], last[position] = own[order], good[order]
        better = np.flatnonzero(best > contacts.lead)
        contacts.take(better, trial, last[better], number)
        contacts.lead[better] = best[better]
        trial = _next(pair, trial, tried)


def leads_of(pair: Pair, phi1: Array, x: Array, position: NDArray[np.intp]) -> Array:
    """By how much (M,), rad, the gear is ahead of the nominal ratio, in the sense of the drive."""
    return pair.drive * (x[:, 4] - pair.ratio * phi1[position])


def solve(pair: Pair, phi1: Array, trial: Trial) -> None:
    """Solve the exact conditions of all trials, and judge what they give: on both flanks, facing, not crossing."""
    every = np.arange(len(trial.position))
    conditions = Conditions(pair.flanks, phi1, pair.length, pair.all_bounds).repeated(trial.position)
    conditions = replace(conditions, choice=pair.numbers[trial.edges])
    plain, lines = np.flatnonzero(~trial.line), np.flatnonzero(trial.line)
    converged = np.zeros(len(every), dtype=bool)
    for which, rcond in ((plain, None), (lines, RCOND)):
        _solve_some(pair, conditions, trial, which, rcond, converged)
    _judge(pair, conditions, trial, converged)
    # along a line the solution nearest the start is wanted, not one that Newton ran to
    run = np.flatnonzero(trial.line & (trial.edges[:, 0] < 0) & ~np.isin(every, lines))
    if run.size:
        trial.x[run] = trial.start[run]
        _solve_some(pair, conditions, trial, run, RCOND, converged)
        _judge(pair, conditions, trial, converged)
    trial.edges[trial.line] = -1


def _solve_some(
    pair: Pair,
    conditions: Conditions,
    trial: Trial,
    which: NDArray[np.intp],
    rcond: float | None,
    converged: NDArray[np.bool_],
) -> None:
    """Solve trials `which` from their unknowns."""
    found = newton.solve(
        partial(at_positions, conditions, which),
        trial.x[which],
        tolerance=TOLERANCE,
        max_step=0.5 * pair.max_step,
        max_iterations=15,
        halvings=3,
        rcond=rcond,
    )
    trial.x[which], trial.residual[which], converged[which] = found.values, found.residual, found.converged


def _judge(pair: Pair, conditions: Conditions, trial: Trial, converged: NDArray[np.bool_]) -> None:
    """Which trials are contacts, and which of them lines."""
    touch = conditions.touch(trial.x, np.arange(len(trial.position)))
    one, two = touch.fixed
    outside, joint = margins(pair, touch, trial.x)
    good = converged & (outside <= EDGE_SLACK).all(axis=1) & (joint <= EDGE_SLACK)
    good &= dot(one.n, two.n) < 0.0
    # surfaces that touch may do so along a line, which may run over an edge, and may cross each other
    tangent = np.flatnonzero(converged & (np.abs(one.n + two.n).max(axis=1) < AGREE))
    line, crossing = shape(pair, touch[tangent])
    inside = trial.edges[tangent, 0] < 0
    trial.line[tangent] = line & (inside | good[tangent])
    good[tangent] &= ~(crossing & inside)
    trial.good[:] = good
    trial.beyond[:] = np.where(converged[:, None], outside, np.nan)


def at_positions(
    conditions: Conditions, position: NDArray[np.intp], x: Array, index: NDArray[np.intp]
) -> tuple[Array, Array]:
    """Conditions for a solve at some positions only."""
    return conditions(x, position[index])


def margins(pair: Pair, touch: Touch, x: Array) -> tuple[Array, Array]:
    """Distance outside each edge of both flanks (M, 6), mm, -inf for those that there are not, and past the joints (M,)."""
    outside = np.full((len(x), len(pair.bounds)), -np.inf)
    for k, bound in enumerate(pair.bounds):
        if bound is not None:
            outside[:, k] = bound.level.value(touch.own[bound.member].r)
    joint = np.full(len(x), -np.inf)
    for member, flank in enumerate(pair.flanks):
        if flank.beyond_joint is not None:
            parameters = x[:, 2 * member : 2 * member + 2]
            joint = np.maximum(joint, flank.beyond_joint(parameters, touch.own[member].r))
    return outside, joint


def shape(pair: Pair, touch: Touch) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Whether the surfaces touch along a line (M,), and whether they cross (M,)."""
    one, two = touch.fixed
    e1, e2 = tangent_basis(one)
    ellipse = contact_ellipse(relative_curvature(one, two, e1, e2), e1, e2, pair.delta, flat=FLAT)
    return ellipse.line, ellipse.crossing


def _next(pair: Pair, trial: Trial, tried: set[tuple[int, int, int]]) -> Trial:
    """What to try for places that came out beyond an edge, or nowhere: the crossing of their edge with that one."""
    spawned: list[tuple[int, Array, int, int]] = []
    for k in np.flatnonzero(~trial.good & (trial.edges[:, 0] >= 0)):
        first, second = trial.edges[k]
        beyond = trial.beyond[k]
        if second < 0:
            others = np.flatnonzero(beyond > EDGE_SLACK) if np.isfinite(beyond[first]) else range(len(pair.bounds))
            pairs = [(first, other) for other in others if other != first and pair.bounds[other] is not None]
        else:
            others = np.flatnonzero(beyond > EDGE_SLACK)
            pairs = [(edge, other) for other in others if other not in (first, second) for edge in (first, second)]
        for a, b in pairs:
            key = (int(trial.position[k]), int(min(a, b)), int(max(a, b)))
            if key not in tried:
                tried.add(key)
                spawned.append((int(trial.position[k]), trial.x[k], key[1], key[2]))
    if not spawned:
        return Trial.of(np.zeros(0, dtype=np.intp), np.zeros((0, 5)), np.zeros((0, 2), dtype=np.intp))
    positions, x, first, second = (np.array(column) for column in zip(*spawned, strict=True))
    return Trial.of(positions, x, np.stack((first, second), axis=-1))


def looked_into(pair: Pair, phi1: Array, position: NDArray[np.intp], x: Array, contacts: Contacts, number: int) -> None:
    """Positions (M,) at which places x (M, 5) seem to lead more than what was found: what they really do, and why.

    Where flank or fillet ends without an edge of the solver, at the ridge that undercut leaves between them or at the root, these
    ends are searched; what leads more still is followed upwards.
    """
    conditions = Conditions(pair.flanks, phi1, pair.length)
    x, lead = _met(pair, conditions, position, x)
    worth = np.flatnonzero(lead > contacts.lead[position] + UNSEEN)
    if not worth.size:
        return
    position, x, lead = position[worth], x[worth], lead[worth]
    for member in (0, 1):
        _along_end(pair, conditions, position, x, member, contacts, number)
    left = np.flatnonzero(lead > contacts.lead[position] + UNSEEN)
    if left.size:
        climb(pair, phi1, position[left], x[left], contacts, number)


def _along_end(
    pair: Pair,
    conditions: Conditions,
    position: NDArray[np.intp],
    x: Array,
    member: int,
    contacts: Contacts,
    number: int,
) -> None:
    """Search the end of a member's flank (row 0 of its grid) for what leads at positions (M,); x (M, 5): starts."""
    end = pair.flanks[member].grid[0]
    last = len(end) - 1
    place = np.broadcast_to(np.arange(0.0, last + 1.0, 2.0), (len(position), last // 2 + 1))
    step = 2.0
    best, lead = np.zeros(len(position)), np.full(len(position), -np.inf)
    start = x
    for _ in range(END_ROUNDS):
        count = place.shape[1]
        tried = np.repeat(start, count, axis=0)
        own = slice(2 * member, 2 * member + 2)
        tried[:, own] = np.stack([_cubic(end[:, k], place.ravel()) for k in range(2)], axis=-1)
        solved, found = _met(pair, conditions, np.repeat(position, count), tried, member)
        found = found.reshape(-1, count)
        k = found.argmax(axis=1)
        rows = np.arange(len(position))
        higher = found[rows, k] > lead
        lead = np.where(higher, found[rows, k], lead)
        best = np.where(higher, place[rows, k], best)
        start = np.where(higher[:, None], solved.reshape(-1, count, 5)[rows, k], start)
        place = np.clip(best[:, None] + step * np.linspace(-1.0, 1.0, 9), 0.0, last)
        step *= 0.25
    ends = Trial.of(position, start, np.full((len(position), 2), -1))
    ends.edges[:, 0] = JOINTS[member]
    ends.residual[:] = 0.0
    better = np.flatnonzero(lead > contacts.lead[position])
    contacts.take(position[better], ends, better, number)
    contacts.lead[position[better]] = lead[better]


def _cubic(values: Array, place: Array) -> Array:
    """Values (M,) between those of a row (K,) at places (M,) in its steps, by the cubic through the nearest four."""
    first = np.clip(np.floor(place).astype(np.intp) - 1, 0, len(values) - 4)
    t = place - first
    weights = (
        -(t - 1.0) * (t - 2.0) * (t - 3.0) / 6.0,
        t * (t - 2.0) * (t - 3.0) / 2.0,
        -t * (t - 1.0) * (t - 3.0) / 2.0,
        t * (t - 1.0) * (t - 2.0) / 6.0,
    )
    found: Array = sum((w * values[first + k] for k, w in enumerate(weights)), np.zeros(len(place)))
    return found


def climb(pair: Pair, phi1: Array, position: NDArray[np.intp], x: Array, contacts: Contacts, number: int) -> None:
    """Follow the lead upwards from places x (M, 5) that lead more than what was found, over points that both flanks have."""
    conditions = Conditions(pair.flanks, phi1, pair.length)
    steps = FIRST_STEP * np.ptp(pair.pinion.grid.reshape(-1, 2), axis=0)
    x, lead = _met(pair, conditions, position, x)
    size = np.ones(len(position))
    ways = np.array([(a, b) for a in (-1.0, 0.0, 1.0) for b in (-1.0, 0.0, 1.0) if (a, b) != (0.0, 0.0)])
    for _ in range(CLIMBS):
        going = np.flatnonzero(size > 1e-7)
        if not going.size:
            break
        start = np.repeat(x[going], len(ways), axis=0)
        start[:, :2] += (size[going][:, None, None] * ways * steps).reshape(-1, 2)
        tried, own = _met(pair, conditions, np.repeat(position[going], len(ways)), start)
        own = own.reshape(-1, len(ways))
        best = own.argmax(axis=1)
        higher = own[np.arange(len(going)), best] > lead[going]
        up = going[higher]
        x[up] = tried.reshape(-1, len(ways), 5)[higher, best[higher]]
        lead[up] = own[higher, best[higher]]
        size[going[~higher]] *= 0.4
    joints = np.stack([_past_joint(pair, conditions, position, x, member) for member in (0, 1)], axis=1)
    found = Trial.of(position, x, np.full((len(position), 2), -1))
    found.edges[:, 0] = np.array(JOINTS)[joints.argmax(axis=1)]
    found.residual[:] = 0.0
    better = np.flatnonzero(lead > contacts.lead[position])
    contacts.take(position[better], found, better, number)
    contacts.lead[position[better]] = lead[better]
    # a summit inside the flanks, or on an edge, is solved for as such
    near = [
        np.full(len(position), -1),
        *(np.full(len(position), k) for k in range(len(pair.bounds)) if pair.numbers[k] >= 0),
    ]
    edges = np.stack((np.concatenate(near), np.full(len(near) * len(position), -1)), axis=-1)
    again = Trial.of(np.tile(position, len(near)), np.tile(x, (len(near), 1)), edges)
    contacts.lead[position] -= SUMMIT
    settle(pair, phi1, again, contacts, number)
    kept = position[contacts.edges[position, 0] >= JOINTS[0]]
    contacts.lead[kept] += SUMMIT


def _past_joint(pair: Pair, conditions: Conditions, position: NDArray[np.intp], x: Array, member: int) -> Array:
    beyond, parameters = pair.flanks[member].beyond_joint, x[:, 2 * member : 2 * member + 2]
    if beyond is None:
        return np.full(len(x), -np.inf)
    return beyond(parameters, conditions.touch(x, position).own[member].r)


def _met(
    pair: Pair, conditions: Conditions, position: NDArray[np.intp], x: Array, held: int = 0
) -> tuple[Array, Array]:
    """Where the circles through the points of x (M, 5) on one member, which is `held` (0 pinion, 1 gear), meet the other's flank:
    unknowns, and leads (M,), -inf where the point is not on both flanks or does not push."""
    free = np.array([2, 3, 4] if held == 0 else [0, 1, 4])

    def residual(y: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
        all_five = x[index].copy()
        all_five[:, free] = y
        f, jacobian = conditions(all_five, position[index])
        return f[:, :3], jacobian[:, :3][:, :, free]

    found = newton.solve(
        residual, x[:, free], tolerance=TOLERANCE, max_step=pair.max_step[free], max_iterations=12, halvings=3
    )
    whole = x.copy()
    whole[:, free] = found.values
    touch = conditions.touch(whole, position)
    outside, joint = margins(pair, touch, whole)
    good = found.converged & (outside <= EDGE_SLACK).all(axis=1) & (joint <= EDGE_SLACK)
    good &= dot(touch.fixed[0].n, touch.fixed[1].n) < 0.0
    lead = leads_of(pair, conditions.phi1, whole, position)
    return whole, np.where(good, lead, -np.inf)
