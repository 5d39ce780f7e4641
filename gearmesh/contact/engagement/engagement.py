"""A tooth pair followed through its whole engagement: solved at nodes, and from there at any rotation.

At the nodes first touch is decided over the whole of both flanks. Between two nodes whose contact is of one kind it is the same
contact, started by a cubic through both; where the kinds differ everything is looked at anew. All tooth pairs of a mesh are alike:
pair k does at phi1 what pair 0 does at phi1 - k pitches.
"""

from __future__ import annotations

from dataclasses import dataclass
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
from gearmesh.contact.first_touch.search import UNSEEN
from gearmesh.contact.pair import CORNER, NUMBERED, Pair
from gearmesh.kernel.numeric.algebra import Array, dot

#: nodes in a pitch
PER_PITCH = 12
#: no pair is followed farther than this many pitches either way, or its thread's windings
MOST_PITCHES = 8
#: pitches beyond those in which the pinion's tooth goes round its axis in which it may touch
BESIDE = 3
#: by how much (rad) what collides is ahead of any pair in mesh
AHEAD = 2.5e-7
#: steps in a pitch at which it is looked whether the flanks meet at all
LOOKS = 6
#: positions solved at once
CHUNK = 20_000
#: share of the largest Newton step by which two nodes' predictions may differ half way and be of one contact
ALIKE = 0.1
#: rad by which their phi2 may differ there and nothing be told by it
NEAR = 1e-6
#: by how much the slope between two nodes may be outside of those at them, in their difference
JUMP = 0.5
#: rounds in which the contacts of nodes are followed to their neighbours
SWEEPS = 3
#: part of itself up to which the slope of phi2 along a line is the ratio: rounding of where the line is found
ROUNDED = 1e-8


@dataclass(frozen=True)
class Engagement:
    """Contacts of a tooth pair at nodes phi1 (K,), rad, ascending; `flanks`: those of the flanks alone; `step` (rad): that of the
    nodes which it was begun with."""

    pair: Pair
    phi1: Array
    contacts: Contacts
    flanks: Contacts
    step: float

    @cached_property
    def rates(self) -> Array:
        """d x / d phi1 (K, 5) at the nodes; NaN where there is no contact."""
        return rates(self.pair, self.phi1, self.contacts)

    @cached_property
    def smooth(self) -> NDArray[np.bool_]:
        """Whether the contacts of neighbouring nodes (K - 1,) are one."""
        c, h = self.contacts, np.diff(self.phi1)[:, None]
        same = c.touching[:-1] & c.touching[1:] & (c.part[:-1] == c.part[1:]) & (c.line[:-1] == c.line[1:])
        same &= (c.edges[:-1] == c.edges[1:]).all(axis=1) & (c.edges[1:, 0] < CORNER)
        with np.errstate(invalid="ignore"):
            apart = np.abs(c.x[1:] - c.x[:-1] - 0.5 * h * (self.rates[1:] + self.rates[:-1]))
            # two places of one kind, as where edges cross twice, differ in phi2 more than in where they are
            turned = np.abs(np.diff(self.rates[:, 4])) * h[:, 0]
            moved = (apart / self.pair.max_step).max(axis=1) < ALIKE
        alike = (moved | (self.free[1:] & self.free[:-1])) & (apart[:, 4] < ALIKE * turned + NEAR)
        same_contact: NDArray[np.bool_] = same & (c.line[1:] | alike)
        return same_contact

    @property
    def free(self) -> NDArray[np.bool_]:
        """Nodes (K,) whose contact is known by its phi2 alone: its place is any along a line or an edge that lies on the mating
        gear."""
        undetermined: NDArray[np.bool_] = self.contacts.line | (
            np.isnan(self.rates[:, 0]) & np.isfinite(self.rates[:, 4])
        )
        return undetermined

    @property
    def jumps(self) -> NDArray[np.bool_]:
        """Whether the advance jumps between neighbouring nodes (K - 1,): it changes otherwise than at slopes between those
        there."""
        slope, h = self.pair.drive * (self.rates[:, 4] - self.pair.ratio), np.diff(self.phi1)
        low, high = np.minimum(slope[1:], slope[:-1]), np.maximum(slope[1:], slope[:-1])
        play = JUMP * (high - low)
        with np.errstate(invalid="ignore"):
            steep = np.diff(self.contacts.advance) / h
            jumping: NDArray[np.bool_] = np.isfinite(steep) & ~(
                (steep > low - play - NEAR) & (steep < high + play + NEAR)
            )
        return jumping

    @property
    def followable(self) -> NDArray[np.bool_]:
        """Nodes (K,) whose contact can be followed beyond them: no line, and nothing that touches at a corner."""
        at_points: NDArray[np.bool_] = ~self.contacts.line & (self.contacts.edges[:, 0] < CORNER)
        return at_points

    def at(self, phi1: Array) -> Contacts:
        """First touch at rotations of the pinion, over the whole of both flanks.

        Parameters
        ----------
        phi1 : (P,)
            rad.

        Returns
        -------
        Contacts
            Parameters of both flanks, their status, and the rotations of the gear `x[:, 4]` (rad).

        Examples
        --------
        >>> engagement = gears.contact().engagement
        >>> engagement.at(np.radians([0.0, 2.0])).x.shape
        (2, 5)
        """
        contacts = Contacts.nothing(len(phi1))
        for k in range(0, len(phi1), CHUNK):
            part = np.arange(k, min(k + CHUNK, len(phi1)))
            contacts.put(part, self._at(phi1[part]))
        return contacts

    def near(self, phi1: Array) -> Contacts:
        """As `at`, without holding what is found against the samples of the field: for places between nodes.

        Parameters
        ----------
        phi1 : (P,)
            rad.

        Returns
        -------
        Contacts
            As of `at`.

        Examples
        --------
        >>> engagement = gears.contact().engagement
        >>> bool(np.allclose(engagement.near(np.radians([1.0])).x[:, 4], engagement.at(np.radians([1.0])).x[:, 4]))
        True
        """
        return self._at(phi1, checked=False)

    def _at(self, phi1: Array, *, checked: bool = True) -> Contacts:
        left = np.clip(np.searchsorted(self.phi1, phi1) - 1, 0, len(self.phi1) - 2)
        inside = (phi1 >= self.phi1[0]) & (phi1 <= self.phi1[-1])
        smooth = inside & self.smooth[left]
        contacts = Contacts.nothing(len(phi1))
        # between contacts of two kinds both are followed
        both = self.followable[left] & self.followable[left + 1]
        beside_line = inside & (self.contacts.line[left] | self.contacts.line[left + 1]) & self.pair.wound
        if beside_line.any():
            self._on_lines(phi1, np.flatnonzero(beside_line), left, contacts)
        # beyond the end of a line what comes after it is followed
        beyond = beside_line & ~contacts.line & ~smooth
        smooth &= ~beside_line
        known, two = np.flatnonzero(smooth), np.flatnonzero((inside & ~smooth & ~beside_line & both) | beyond)
        with np.errstate(all="ignore"):
            place, ends = np.tile(two, 2), np.concatenate((left[two], left[two] + 1))
            place, ends = place[self.followable[ends]], ends[self.followable[ends]]
            start = np.concatenate((self._interpolate(phi1[known], left[known]), self._predict(phi1[place], ends)))
            self._refine(phi1, np.concatenate((known, place)), start, np.concatenate((left[known], ends)), contacts)
        rest = ~contacts.touching
        if checked and two.size:
            seen = tooth_outlook(self.pair, phi1[two]).best
            rest[two[seen > contacts.advance[two] + UNSEEN]] = True
        anew = np.flatnonzero(rest)
        if anew.size:
            contacts.put(anew, first_touch(self.pair, phi1[anew]))
        return contacts

    def _on_lines(self, phi1: Array, which: NDArray[np.intp], left: NDArray[np.intp], contacts: Contacts) -> None:
        """What both flanks have, at positions `which` (M,), of the lines of a node beside them: of a line nodes have any point, and
        half way between two of these there may be none."""
        part, line = self.pair.parts[0], self.contacts.line
        first, second = left[which], left[which] + 1
        nearer = phi1[which] - self.phi1[first] < self.phi1[second] - phi1[which]
        node = np.where((nearer & line[first]) | ~line[second], first, second)
        with np.errstate(all="ignore"):
            touch_along_lines(part, phi1, which, self._predict(phi1[which], node), contacts)

    def along_line(self, phi1: Array, node: NDArray[np.intp]) -> Contacts:
        """The contact lines of nodes at other rotations, whatever of them both flanks have there.

        Parameters
        ----------
        phi1 : (M,)
            rad.
        node : (M,) of int
            Numbers of nodes of the engagement.

        Returns
        -------
        Contacts
            As of `at`.

        Examples
        --------
        >>> engagement = gears.contact().engagement
        >>> middle = np.array([len(engagement.phi1) // 2])
        >>> engagement.along_line(engagement.phi1[middle], middle).line.tolist()
        [True]
        """
        contacts = Contacts.nothing(len(phi1))
        for number, part in self.pair.parts.items():
            own = np.flatnonzero(self.contacts.part[node] == number)
            trial = Trial.of(own, self._predict(phi1[own], node[own]), self.contacts.edges[node[own]])
            trial.line[:] = True
            solve(part, phi1, trial)
            trial.give(contacts, own, np.arange(own.size), number, advances_of(part, phi1, trial.x, own))
        contacts.line[:] = True
        return contacts

    def as_at(self, phi1: Array, node: NDArray[np.intp]) -> Contacts:
        """Contacts of the kinds that nodes have at other rotations, whatever else is ahead there.

        Parameters
        ----------
        phi1 : (M,)
            rad.
        node : (M,) of int
            Numbers of nodes of the engagement, which touch on the flanks.

        Returns
        -------
        Contacts
            As of `at`; nothing where there is no contact of that kind on both flanks.

        Examples
        --------
        >>> engagement = gears.contact().engagement
        >>> middle = np.array([len(engagement.phi1) // 2])
        >>> engagement.as_at(engagement.phi1[middle], middle).touching.tolist()
        [True]
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
        """Solve at positions (M,) from starts (M, 5) for what touches at nodes (M,)."""
        for number, part in self.pair.parts.items():
            own = np.flatnonzero(self.contacts.touching[node] & (self.contacts.part[node] == number))
            own = own[self.contacts.edges[node[own], 0] < CORNER]
            trial = Trial.of(position[own], start[own], self.contacts.edges[node[own]])
            trial.line = self.contacts.line[node[own]]
            refine_candidates(part, phi1, trial, contacts, number)

    def _predict(self, phi1: Array, node: NDArray[np.intp]) -> Array:
        """Unknowns (M, 5) by the tangents at nodes (M,)."""
        step = (phi1 - self.phi1[node])[:, None]
        slope = np.where(np.isnan(self.rates[node]), 0.0, self.rates[node])
        unknowns: Array = self.contacts.x[node] + step * slope
        return unknowns

    def _interpolate(self, phi1: Array, left: NDArray[np.intp]) -> Array:
        """Unknowns (M, 5) by the cubics between nodes; of contacts that are known by their phi2 alone straight."""
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
    """A tooth pair at nodes phi1 (K,), rad, ascending.

    Where the advance jumps from one node to the next, more than its slopes have it, what touches at the one is followed to the
    other:
    it may be ahead there all the same.
    """
    step = float(np.diff(phi1).max())
    engagement = Engagement(pair, phi1, *touches(pair, phi1), step=step)
    for _ in range(SWEEPS):
        contacts, flanks, k = engagement.contacts, engagement.flanks, np.flatnonzero(engagement.jumps)
        node, at = np.concatenate((k, k + 1)), np.concatenate((k + 1, k))
        own = engagement.followable[node] & contacts.touching[node]
        if not own.any():
            break
        before = contacts.advance.copy()
        with np.errstate(all="ignore"):
            engagement._refine(phi1, at[own], engagement._predict(phi1[at[own]], node[own]), node[own], contacts)
        better = np.flatnonzero((contacts.part == 0) & (contacts.advance > flanks.advance))
        flanks.put(better, contacts.at(better))
        if not (contacts.advance > before + UNSEEN).any():
            break
        engagement = Engagement(pair, phi1, contacts, flanks, step)
    return engagement


def whole_engagement(pair: Pair, pitch: float) -> Engagement | None:
    """A tooth pair over its whole engagement, at nodes that are whole parts of a pitch (rad); None where the teeth never meet.

    That is where it may touch before its neighbours do, or has contact inside both flanks; and on to where it collides apart
    from there. Teeth of a pinion in an internal gear leave those far from their mesh, where tips may collide for less than a step:
    `tip_passing` has the places.
    """
    reach = _reach(pair, pitch)
    looks = np.arange(-reach * LOOKS, reach * LOOKS + 1)
    seen = tooth_outlook(pair, looks.astype(float) * (pitch / LOOKS))
    best = seen.best
    ahead = np.zeros(len(looks), dtype=bool)
    if np.isfinite(best).any():
        before, after = (np.full(len(looks), -np.inf) for _ in range(2))
        after[:-LOOKS], before[LOOKS:] = best[LOOKS:], best[:-LOOKS]
        ahead = np.isfinite(best) & (seen.inside | (best + seen.gain >= np.maximum(before, after)))
    met = np.flatnonzero(ahead)
    if not met.size:
        return None
    runs = np.split(met, np.flatnonzero(np.diff(met) > 1) + 1)
    run = min(runs, key=lambda run: _distance_from_mesh(looks[run], seen.inside[run], best[run], best, looks))
    most = np.full(LOOKS, -np.inf)
    np.maximum.at(most, looks[run] % LOOKS, best[run])
    if not pair.nested:
        # a turn on the same teeth meet again, as another pair
        near = met[np.abs(looks[met]) * (pitch / LOOKS) < _half_turn(pair)]
        collides = near[best[near] > most[looks[near] % LOOKS] + AHEAD]
        run = np.concatenate((run, collides))
    step = PER_PITCH // LOOKS
    first, last = (looks[run.min()] - 1) * step, (looks[run.max()] + 1) * step
    engagement = follow(pair, np.arange(first, last + 1) * (pitch / PER_PITCH))
    # surface contact that goes on is followed to its end
    for _ in range(MOST_PITCHES):
        inside = engagement.flanks.touching[[0, -1]] & (engagement.flanks.edges[[0, -1], 0] < 0)
        if not inside.any():
            break
        first, last = first - PER_PITCH // 2 * int(inside[0]), last + PER_PITCH // 2 * int(inside[1])
        engagement = follow(pair, np.arange(first, last + 1) * (pitch / PER_PITCH))
    return engagement


def _distance_from_mesh(
    run: NDArray[np.intp], inside: NDArray[np.bool_], own: Array, best: Array, looks: NDArray[np.intp]
) -> tuple[bool, bool, float, int]:
    """Rank of a run of looks as the mesh of the teeth, the least first.

    A run with contact inside both flanks comes first, then one that is ahead of all others at some phase of the pitch; edges
    that are nearly ahead beside the mesh are neither. Of equals, such as a mesh and tips that collide apart from it, the run
    nearest to phi1 = 0 is the mesh.
    """
    most = np.full(LOOKS, -np.inf)
    np.maximum.at(most, looks % LOOKS, np.where(np.isfinite(best), best, -np.inf))
    leads = bool((own >= most[run % LOOKS]).any())
    return not inside.any(), not leads, float(np.abs(run).min()), -len(run)


def _reach(pair: Pair, pitch: float) -> int:
    """Pitches either way in which the pair's teeth may be in mesh: all windings of a thread."""
    return max(MOST_PITCHES, int(np.ceil(pair.pinion.winding / pitch)) + BESIDE)


def _half_turn(pair: Pair) -> float:
    """Rotation (rad) of the pinion in which either member turns half round at most."""
    return float(np.pi * min(1.0, 1.0 / pair.ratio))


def tooth_outlook(pair: Pair, phi1: Array) -> Outlook:
    """What advances may be expected of the teeth at phi1 (N,), and whether the flanks' own is greatest inside."""
    with np.errstate(all="ignore"):
        parts = [outlook(part, phi1) for part in pair.parts.values()]
    best, gain = (np.max([getattr(part, name) for part in parts], axis=0) for name in ("best", "gain"))
    return Outlook(best, gain, parts[0].inside)


def rates(pair: Pair, phi1: Array, contacts: Contacts) -> Array:
    """d x / d phi1 (N, 5) of contacts; NaN where there is none, and along lines all but that of phi2."""
    slopes = np.full(contacts.x.shape, np.nan)
    known = contacts.touching & (contacts.edges[:, 0] < CORNER)
    for number, part in pair.parts.items():
        own = np.flatnonzero(known & (contacts.part == number))
        if not own.size:
            continue
        choice = part.numbers[np.where(known[:, None], contacts.edges, -1)]
        conditions = Conditions(part.flanks, phi1, pair.length, part.all_bounds, choice=choice)
        slopes[own] = conditions.rate(contacts.x[own], own)
        # along an edge that lies on the mating gear all its length the place is no more determined than along a line
        edges = contacts.edges[own]
        free = own[contacts.line[own] | ((edges[:, 0] >= 0) & (edges[:, 1] < 0) & np.isnan(slopes[own, 4]))]
        if free.size:
            slopes[free, :4], slopes[free, 4] = np.nan, _turning(conditions, contacts, free, pair.ratio)
    return slopes


def _turning(conditions: Conditions, contacts: Contacts, own: NDArray[np.intp], ratio: float) -> Array:
    """d phi2 / d phi1 (M,) of contacts `own` where the place on the flanks is not determined: neither parts from the other nor
    enters it, along the normal of the one that has one. What is the `ratio` but for rounding is the ratio."""
    touch, (pinion, gear) = conditions.touch(contacts.x[own], own), conditions.mounts(own)
    of_gear = np.array([number < 0 or NUMBERED[number][0] == 0 for number in contacts.edges[own, 0]], dtype=bool)
    one, two = touch.fixed
    n = np.where(of_gear[:, None], two.n, one.n)
    ahead, away = (dot(n, m.velocity(jet.r)) for m, jet in ((pinion, one), (gear, two)))
    turning = ahead / away
    return np.where(np.abs(turning - ratio) <= ROUNDED * abs(ratio), ratio, turning)
