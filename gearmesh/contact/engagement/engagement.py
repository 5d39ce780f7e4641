"""Engagement of a tooth pair from entering to leaving the mesh: solved at nodes, and from the nodes at any rotation.

First touch at the nodes is found over the whole of both flanks. Between two nodes with the same kind of contact the solver starts
from a cubic through both nodes. Between nodes of different kinds first touch is found anew. Pair k of a mesh has at phi1 the
contact of pair 0 at phi1 - k pitches.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.line_ends import touch_along_lines
from gearmesh.contact.conditions.meshing import Conditions
from gearmesh.contact.conditions.refinement import (
    Contacts,
    Trial,
    advances_of,
    refine_candidates,
    solve,
)
from gearmesh.contact.first_touch.field import Outlook, outlook
from gearmesh.contact.first_touch.first_touch import first_touch, touches
from gearmesh.contact.first_touch.search import UNSEEN_LEAD_RAD
from gearmesh.contact.pair import EDGE_CORNER, NUMBERED_EDGES, Pair
from gearmesh.kernel.numeric.algebra import Array, distinct, dot
from gearmesh.records import dataclass

#: nodes in a pitch
NODES_PER_PITCH = 12
#: pitches each way over which a pair is followed, at least; threads are followed over all their windings
MAX_PITCHES = 8
#: pitches beyond the windings of a thread in which it may touch
PITCHES_BEYOND_WINDINGS = 3
#: least lead (rad) over every pair in mesh that is a collision
MIN_COLLISION_LEAD_RAD = 2.5e-7
#: positions in a pitch at which the field is asked whether flanks meet
LOOKS_PER_PITCH = 6
#: positions solved at once
MAX_BATCH = 20_000
#: difference of the predictions of two neighbouring nodes, by the largest Newton step, up to which both are one contact
SAME_CONTACT_STEP = 0.1
#: difference of phi2 (rad) of these predictions that says nothing
SAME_PHI2_RAD = 1e-6
#: distance of the slope between two nodes from the slopes at the nodes, by their difference, up to which nothing jumps
SLOPE_ALLOWANCE = 0.5
#: rounds in which contacts of nodes are followed to neighbouring nodes
FOLLOWING_ROUNDS = 3
#: relative difference of d phi2/d phi1 on a line from the ratio that is rounding
RATIO_ROUNDING = 1e-8


@dataclass(frozen=True)
class Engagement:
    """Contacts of a tooth pair at K nodes."""

    #: tooth pair
    pair: Pair
    #: rotations (K,) of the pinion at the nodes, rad, ascending
    phi1: Array
    #: first touch of flanks, fillets and edges at the nodes
    contacts: Contacts
    #: first touch of the flanks alone at the nodes
    flanks: Contacts
    #: step of the first nodes, rad, before nodes were added
    step: float

    @cached_property
    def rates(self) -> Array:
        """d x / d phi1 (K, 5) at the nodes; NaN without contact."""
        return rates(self.pair, self.phi1, self.contacts)

    @cached_property
    def smooth(self) -> NDArray[np.bool_]:
        """True (K - 1,) where neighbouring nodes have one and the same contact."""
        c, h = self.contacts, np.diff(self.phi1)[:, None]
        same = c.touching[:-1] & c.touching[1:] & (c.part[:-1] == c.part[1:]) & (c.line[:-1] == c.line[1:])
        same &= (c.edges[:-1] == c.edges[1:]).all(axis=1) & (c.edges[1:, 0] < EDGE_CORNER)
        with np.errstate(invalid="ignore"):
            apart = np.abs(c.x[1:] - c.x[:-1] - 0.5 * h * (self.rates[1:] + self.rates[:-1]))
            # two contacts of one kind, for instance where edges cross twice, differ in phi2 more than in place
            turned = np.abs(np.diff(self.rates[:, 4])) * h[:, 0]
            moved = (apart / self.pair.max_step).max(axis=1) < SAME_CONTACT_STEP
        alike = (moved | (self.free[1:] & self.free[:-1])) & (apart[:, 4] < SAME_CONTACT_STEP * turned + SAME_PHI2_RAD)
        same_contact: NDArray[np.bool_] = same & (c.line[1:] | alike)
        return same_contact

    @property
    def free(self) -> NDArray[np.bool_]:
        """True (K,) where only phi2 of the contact is determined: the place is any point of a line, or of an edge on the mating
        flank."""
        undetermined: NDArray[np.bool_] = self.contacts.line | (
            np.isnan(self.rates[:, 0]) & np.isfinite(self.rates[:, 4])
        )
        return undetermined

    @property
    def jumps(self) -> NDArray[np.bool_]:
        """True (K - 1,) where the advance jumps between neighbouring nodes: its change does not fit the slopes at the nodes."""
        slope, h = self.pair.drive * (self.rates[:, 4] - self.pair.ratio), np.diff(self.phi1)
        low, high = np.minimum(slope[1:], slope[:-1]), np.maximum(slope[1:], slope[:-1])
        play = SLOPE_ALLOWANCE * (high - low)
        with np.errstate(invalid="ignore"):
            steep = np.diff(self.contacts.advance) / h
            jumping: NDArray[np.bool_] = np.isfinite(steep) & ~(
                (steep > low - play - SAME_PHI2_RAD) & (steep < high + play + SAME_PHI2_RAD)
            )
        return jumping

    @property
    def followable(self) -> NDArray[np.bool_]:
        """True (K,) where the contact can be followed beyond the node: neither a line nor a corner."""
        at_points: NDArray[np.bool_] = ~self.contacts.line & (self.contacts.edges[:, 0] < EDGE_CORNER)
        return at_points

    def at(self, phi1: Array) -> Contacts:
        """Find first touch at rotations of the pinion, over the whole of both flanks.

        Result: parameters of both flanks, their status, and the rotations of the gear `x[:, 4]` (rad).
        """
        contacts = Contacts.nothing(len(phi1))
        for k in range(0, len(phi1), MAX_BATCH):
            part = np.arange(k, min(k + MAX_BATCH, len(phi1)))
            contacts.put(part, self._at(phi1[part]))
        return contacts

    def near(self, phi1: Array) -> Contacts:
        """Find first touch as `at` does, but without the check against the samples of the field: for rotations between nodes."""
        return self._at(phi1, checked=False)

    def _at(self, phi1: Array, *, checked: bool = True) -> Contacts:
        # between nodes of one contact: start from a cubic through both nodes
        left = np.clip(np.searchsorted(self.phi1, phi1) - 1, 0, len(self.phi1) - 2)
        inside = (phi1 >= self.phi1[0]) & (phi1 <= self.phi1[-1])
        smooth = inside & self.smooth[left]
        contacts = Contacts.nothing(len(phi1))
        # between nodes of two contacts: follow both along their tangents; the more advanced solution is the contact
        both_followable = self.followable[left] & self.followable[left + 1]
        at_line = self.contacts.line[left] | self.contacts.line[left + 1]
        # straight lines between two lines are interpolated, bent ones of threads are searched
        beside_line = inside & at_line & (self.pair.wound | ~smooth)
        if beside_line.any():
            self._on_lines(phi1, np.flatnonzero(beside_line), left, contacts)
        # beyond the end of a line follow the contact that comes after the line
        beyond = beside_line & ~contacts.line & ~smooth
        smooth &= ~beside_line
        known, two = (
            np.flatnonzero(smooth),
            np.flatnonzero((inside & ~smooth & ~beside_line & both_followable) | beyond),
        )
        with np.errstate(all="ignore"):
            place, ends = np.tile(two, 2), np.concatenate((left[two], left[two] + 1))
            place, ends = place[self.followable[ends]], ends[self.followable[ends]]
            start = np.concatenate((self._interpolate(phi1[known], left[known]), self._predict(phi1[place], ends)))
            self._refine(phi1, np.concatenate((known, place)), start, np.concatenate((left[known], ends)), contacts)
        # find first touch anew where nothing was found, or where a sample of the field is ahead of the solution
        rest = ~contacts.touching
        looked = two if self.pair.wound else distinct(np.append(two, np.flatnonzero(beside_line)))
        if checked and looked.size:
            seen = tooth_outlook(self.pair, phi1[looked]).best
            rest[looked[seen > contacts.advance[looked] + UNSEEN_LEAD_RAD]] = True
        anew = np.flatnonzero(rest)
        if anew.size:
            contacts.put(anew, first_touch(self.pair, phi1[anew]))
        return contacts

    def _on_lines(self, phi1: Array, which: NDArray[np.intp], left: NDArray[np.intp], contacts: Contacts) -> None:
        """Put contacts on the line of a neighbouring node at positions `which` (M,), as far as the line lies on both flanks.

        A node knows one point of its line, so that half way between the points of two nodes there may be no contact.
        """
        # start from the line of the nearer node that touches along a line
        part, line = self.pair.parts[0], self.contacts.line
        first, second = left[which], left[which] + 1
        nearer = phi1[which] - self.phi1[first] < self.phi1[second] - phi1[which]
        node = np.where((nearer & line[first]) | ~line[second], first, second)
        with np.errstate(all="ignore"):
            touch_along_lines(part, phi1, which, self._predict(phi1[which], node), contacts)

    def along_line(self, phi1: Array, node: NDArray[np.intp]) -> Contacts:
        """Solve for the contact lines of nodes at other rotations, even beyond the ends of the flanks.

        `node`: numbers of nodes of the engagement.
        """
        contacts = Contacts.nothing(len(phi1))
        for number, part in self.pair.parts.items():
            on_part = np.flatnonzero(self.contacts.part[node] == number)
            trial = Trial.of(on_part, self._predict(phi1[on_part], node[on_part]), self.contacts.edges[node[on_part]])
            trial.line[:] = True
            solve(part, phi1, trial)
            trial.give(contacts, on_part, np.arange(on_part.size), number, advances_of(part, phi1, trial.x, on_part))
        contacts.line[:] = True
        return contacts

    def as_at(self, phi1: Array, node: NDArray[np.intp]) -> Contacts:
        """Solve for contacts of the kinds of nodes at other rotations, even if another contact is ahead.

        `node`: numbers of nodes of the engagement, which touch on the flanks.
        """
        contacts, part = Contacts.nothing(len(phi1)), self.pair.parts[0]
        trial = Trial.of(np.arange(len(phi1)), self._predict(phi1, node), self.contacts.edges[node])
        trial.line = self.contacts.line[node]
        solve(part, phi1, trial)
        good = np.flatnonzero(trial.good)
        trial.give(contacts, good, good, 0, advances_of(part, phi1, trial.x[good], good))
        return contacts

    def _refine(
        self, phi1: Array, position: NDArray[np.intp], start: Array, node: NDArray[np.intp], contacts: Contacts
    ) -> None:
        """Solve at positions (M,) from starts (M, 5) for the contacts of nodes (M,)."""
        for number, part in self.pair.parts.items():
            on_part = np.flatnonzero(self.contacts.touching[node] & (self.contacts.part[node] == number))
            on_part = on_part[self.contacts.edges[node[on_part], 0] < EDGE_CORNER]
            trial = Trial.of(position[on_part], start[on_part], self.contacts.edges[node[on_part]])
            trial.line = self.contacts.line[node[on_part]]
            refine_candidates(part, phi1, trial, contacts, number)

    def _predict(self, phi1: Array, node: NDArray[np.intp]) -> Array:
        """Extrapolate unknowns (M, 5) by the tangents at nodes (M,)."""
        step = (phi1 - self.phi1[node])[:, None]
        slope = np.where(np.isnan(self.rates[node]), 0.0, self.rates[node])
        unknowns: Array = self.contacts.x[node] + step * slope
        return unknowns

    def _interpolate(self, phi1: Array, left: NDArray[np.intp]) -> Array:
        """Interpolate unknowns (M, 5) by cubics between nodes; linearly where only phi2 is determined."""
        h = self.phi1[left + 1] - self.phi1[left]
        t = ((phi1 - self.phi1[left]) / h)[:, None]
        x, free = self.contacts.x, self.free[left]
        first, last = x[left], x[left + 1]
        slopes = [h[:, None] * self.rates[k] for k in (left, left + 1)]
        cubic = (
            (1.0 + 2.0 * t) * (1.0 - t) ** 2 * first
            + t * (1.0 - t) ** 2 * slopes[0]
            + t**2 * (3.0 - 2.0 * t) * last
            - t**2 * (1.0 - t) * slopes[1]
        )
        unknowns: Array = np.where(free[:, None], first + t * (last - first), cubic)
        return unknowns


def follow(pair: Pair, phi1: Array) -> Engagement:
    """Solve for a tooth pair at nodes phi1 (K,), rad, ascending.

    Where the advance jumps between two nodes, the contact of each node is followed to the other node. It may be ahead there
    although the search of the field missed it.
    """
    step = float(np.diff(phi1).max())
    engagement = Engagement(pair, phi1, *touches(pair, phi1), step=step)
    for _ in range(FOLLOWING_ROUNDS):
        contacts, flanks, k = engagement.contacts, engagement.flanks, np.flatnonzero(engagement.jumps)
        # solve at both ends of each jump for the contact of the other end; the more advanced contact stays
        node, at = np.concatenate((k, k + 1)), np.concatenate((k + 1, k))
        can_follow = engagement.followable[node] & contacts.touching[node]
        if not can_follow.any():
            break
        before = contacts.advance.copy()
        with np.errstate(all="ignore"):
            engagement._refine(
                phi1,
                at[can_follow],
                engagement._predict(phi1[at[can_follow]], node[can_follow]),
                node[can_follow],
                contacts,
            )
        better = np.flatnonzero((contacts.part == 0) & (contacts.advance > flanks.advance))
        flanks.put(better, contacts.at(better))
        if not (contacts.advance > before + UNSEEN_LEAD_RAD).any():
            break
        engagement = Engagement(pair, phi1, contacts, flanks, step)
    return engagement


def whole_engagement(pair: Pair, pitch: float) -> Engagement | None:
    """Solve for a tooth pair over its whole engagement at nodes that divide the pitch (rad); None where the teeth never meet.

    The engagement holds all rotations at which the pair may touch before its neighbours or has contact inside both flanks, and
    collisions apart from the mesh. In an internal gear tips may collide far from the mesh over less than a step; `tip_passing`
    finds these.
    """
    # looks at which the pair may be ahead of its neighbours, by the samples of the field
    reach = _reach(pair, pitch)
    looks = np.arange(-reach * LOOKS_PER_PITCH, reach * LOOKS_PER_PITCH + 1)
    seen = tooth_outlook(pair, looks.astype(float) * (pitch / LOOKS_PER_PITCH))
    best = seen.best
    ahead = np.zeros(len(looks), dtype=bool)
    if np.isfinite(best).any():
        before, after = (np.full(len(looks), -np.inf) for _ in range(2))
        after[:-LOOKS_PER_PITCH], before[LOOKS_PER_PITCH:] = best[LOOKS_PER_PITCH:], best[:-LOOKS_PER_PITCH]
        ahead = np.isfinite(best) & (seen.inside | (best + seen.gain >= np.maximum(before, after)))
    met = np.flatnonzero(ahead)
    if not met.size:
        return None
    # of connected runs of such looks take the mesh of the teeth
    runs = np.split(met, np.flatnonzero(np.diff(met) > 1) + 1)
    run = min(runs, key=lambda run: _distance_from_mesh(looks[run], seen.inside[run], best[run], best, looks))
    most = np.full(LOOKS_PER_PITCH, -np.inf)
    np.maximum.at(most, looks[run] % LOOKS_PER_PITCH, best[run])
    if not pair.nested:
        # collisions within half a turn; after a turn the same teeth meet again as another pair
        near = met[np.abs(looks[met]) * (pitch / LOOKS_PER_PITCH) < _half_turn(pair)]
        collides = near[best[near] > most[looks[near] % LOOKS_PER_PITCH] + MIN_COLLISION_LEAD_RAD]
        run = np.concatenate((run, collides))
    step = NODES_PER_PITCH // LOOKS_PER_PITCH
    first, last = _one_side(pair, (int(looks[run.min()]) - 1) * step, (int(looks[run.max()]) + 1) * step)
    engagement = follow(pair, np.arange(first, last + 1, dtype=float) * (pitch / NODES_PER_PITCH))
    # surface contact at an end of the nodes is followed to its end
    for _ in range(MAX_PITCHES):
        inside = engagement.flanks.touching[[0, -1]] & (engagement.flanks.edges[[0, -1], 0] < 0)
        followed = first, last
        first, last = first - NODES_PER_PITCH // 2 * int(inside[0]), last + NODES_PER_PITCH // 2 * int(inside[1])
        first, last = _one_side(pair, first, last)
        if (first, last) == followed:
            break
        engagement = follow(pair, np.arange(first, last + 1, dtype=float) * (pitch / NODES_PER_PITCH))
    return engagement


def _one_side(pair: Pair, first: int, last: int) -> tuple[int, int]:
    """Return the nodes of a pair that an eccentric drives which lie on the side of the eccentric that carries the load.

    A pin with clearance passes the middle of its space and would touch the same flank again, once the gear has turned back by
    far more than the backlash.
    """
    if not pair.arm_turns:
        return first, last
    return (max(first, 0), max(last, 1)) if pair.drive > 0 else (min(first, -1), min(last, 0))


def _distance_from_mesh(
    run: NDArray[np.intp], inside: NDArray[np.bool_], run_best: Array, best: Array, looks: NDArray[np.intp]
) -> tuple[bool, bool, float, int]:
    """Return the rank of a run of looks as the mesh of the teeth, the least first.

    A run with contact inside both flanks comes first, then a run that is ahead of all other runs at some phase of the pitch.
    Edges that are nearly ahead beside the mesh are neither. Of equal runs, such as a mesh and tips that collide apart from it, the
    run nearest to phi1 = 0 is the mesh.
    """
    most = np.full(LOOKS_PER_PITCH, -np.inf)
    np.maximum.at(most, looks % LOOKS_PER_PITCH, np.where(np.isfinite(best), best, -np.inf))
    leads = bool((run_best >= most[run % LOOKS_PER_PITCH]).any())
    return not inside.any(), not leads, float(np.abs(run).min()), -len(run)


def _reach(pair: Pair, pitch: float) -> int:
    """Return the pitches each way in which the pair may be in mesh: all windings of a thread, half a turn of coupled members."""
    if pair.coupled:
        return int(np.ceil(np.pi / pitch)) + 1
    return max(MAX_PITCHES, int(np.ceil(pair.pinion.winding / pitch)) + PITCHES_BEYOND_WINDINGS)


def _half_turn(pair: Pair) -> float:
    """Return the rotation (rad) of the pinion in which no member turns by more than half a turn."""
    return float(np.pi * min(1.0, 1.0 / pair.ratio))


def tooth_outlook(pair: Pair, phi1: Array) -> Outlook:
    """Estimate the advances of the teeth at phi1 (N,), rad; `inside` is True where the flanks touch away from their edges."""
    with np.errstate(all="ignore"):
        parts = [outlook(part, phi1) for part in pair.parts.values()]
    best, gain = (np.max([getattr(part, name) for part in parts], axis=0) for name in ("best", "gain"))
    return Outlook(best, gain, parts[0].inside)


def rates(pair: Pair, phi1: Array, contacts: Contacts) -> Array:
    """Compute d x / d phi1 (N, 5) of contacts; NaN without contact, and on lines in all columns but phi2."""
    slopes = np.full(contacts.x.shape, np.nan)
    known = contacts.touching & (contacts.edges[:, 0] < EDGE_CORNER)
    for number, part in pair.parts.items():
        on_part = np.flatnonzero(known & (contacts.part == number))
        if not on_part.size:
            continue
        choice = part.numbers[np.where(known[:, None], contacts.edges, -1)]
        conditions = Conditions(part.flanks, phi1, pair.length, part.all_bounds, choice=choice)
        slopes[on_part] = conditions.rate(contacts.x[on_part], on_part)
        # on an edge that lies on the mating flank the place is as free as on a line
        edges = contacts.edges[on_part]
        free = on_part[contacts.line[on_part] | ((edges[:, 0] >= 0) & (edges[:, 1] < 0) & np.isnan(slopes[on_part, 4]))]
        if free.size:
            slopes[free, :4], slopes[free, 4] = np.nan, _turning(conditions, contacts, free, pair.ratio)
    return slopes


def _turning(conditions: Conditions, contacts: Contacts, own: NDArray[np.intp], ratio: float) -> Array:
    """Compute d phi2 / d phi1 (M,) of contacts `own` whose place on the flanks is free.

    The velocities of both members along the normal are equal; the normal is the normal of the member that touches with a surface.
    A slope that differs from the `ratio` by rounding is the ratio.
    """
    # n . v1 = n . v2: the velocity of the contact on either flank is tangential and drops out
    touch, (pinion, gear) = conditions.touch(contacts.x[own], own), conditions.mounts(own)
    of_gear = np.array([number < 0 or NUMBERED_EDGES[number][0] == 0 for number in contacts.edges[own, 0]], dtype=bool)
    pinion_jet, gear_jet = touch.fixed
    n = np.where(of_gear[:, None], gear_jet.n, pinion_jet.n)
    ahead, away = (dot(n, m.velocity(jet.r)) for m, jet in ((pinion, pinion_jet), (gear, gear_jet)))
    turning = ahead / away
    return np.where(np.abs(turning - ratio) <= RATIO_ROUNDING * abs(ratio), ratio, turning)
