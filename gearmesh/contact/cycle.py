"""The whole mesh cycle: neighbouring tooth pairs carry in turn, the first to touch decides.

All tooth pairs are alike: pair k does at phi1 what pair 0 does at phi1 - k pitches. With te(phi1) of one pair over its whole
engagement, edges included, the transmission error of the gears is the extreme of te(phi1 - k pitch) over k. It is a chain of
smooth arcs; where they change over, where surface contact begins and ends and where an arc has an extreme are roots.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.engagement import PER_PITCH as NODES
from gearmesh.contact.engagement import Engagement, engaged, rates
from gearmesh.contact.events import Event, reaches, root_between
from gearmesh.contact.first_touch import EDGE_SLACK, RCOND, TOLERANCE, Contacts, first_touch, margins
from gearmesh.contact.lines import directions, on_edge
from gearmesh.contact.meshing import Conditions
from gearmesh.contact.pair import EDGES, Pair
from gearmesh.kernel import newton
from gearmesh.kernel.algebra import Array, dot
from gearmesh.kernel.roots import bracketed_root, last_true

#: positions in a pitch at which the cycle is given
PER_PITCH = 24
HARMONICS = 5
#: rad (0.1 arcsec): from here on a step of the transmission error is a break
JUMP = 5e-7
#: rad: tooth pairs closer than this carry together
TOGETHER = 5e-12
#: slopes (rad/rad) that differ by less are level
LEVEL = 1e-9
#: Gauss points on an arc
GAUSS = 16
#: a change of the kind of contact that no equation gives is divided down to this share of a step of the nodes
ROUNDS, SPLIT = 11, 8


@dataclass(frozen=True)
class Break:
    """The transmission error of the flanks' surfaces is discontinuous [LF04 17.8]: edges have to bridge it.

    At phi1 (rad) the surface contact of a pair ends although it is still ahead of the next pair by `jump` (rad), or begins
    although it is ahead already; `jump` is NaN where nothing else has surface contact. `beginning` tells which.
    """

    phi1: float
    jump: float
    beginning: bool


@dataclass(frozen=True)
class Cycle:
    """phi1 (Q,), rad, over one pitch; te (K, Q) of the tooth pairs that touch in it (NaN where they do not) and the
    envelope (Q,) of the gears, rad; contact_ratio: pitches over which one pair has surface contact (NaN if nowhere), of a line of
    contact also its transverse part and the overlap; harmonics: amplitudes of the envelope's first harmonics of the mesh
    frequency, rad; breaks: where one pair's surface contact does not pass on to the next one's smoothly; surface: phi1 (rad)
    between which pair 0 has surface contact; engagement: between which it may be ahead of its neighbours or has surface contact;
    handovers: phi1 (rad) of pair 0 at which another pair takes over from it or it from another."""

    phi1: Array
    te: Array
    envelope: Array
    contact_ratio: float
    harmonics: Array
    breaks: tuple[Break, ...] = ()
    peak_to_peak: float = np.nan
    transverse_ratio: float = np.nan
    overlap_ratio: float = np.nan
    surface: tuple[float, float] = (np.nan, np.nan)
    engagement: tuple[float, float] = (np.nan, np.nan)
    handovers: tuple[float, ...] = ()


def mesh_cycle(pair: Pair, pitch: float, engagement: Engagement | None = None) -> Cycle | None:
    """The cycle of a pair at pinion pitch `pitch` (rad), from its whole `engagement`, which is followed where it is not given.

    Where a pair has surface contact nowhere (misaligned line contact) the contact ratio is NaN. None where nothing touches.
    """
    followed = engaged(pair, pitch) if engagement is None else engagement
    if followed is None or not followed.contacts.touching.any():
        return None
    return _Cycles(followed, pitch).cycle()


class _Cycles:
    """What makes up a cycle, from the engagement of one tooth pair."""

    def __init__(self, engagement: Engagement, pitch: float) -> None:
        self.engagement, self.pair, self.pitch = engagement, engagement.pair, pitch
        self.surface = (np.nan, np.nan)
        self.contacts, self.flanks, self.phi1 = engagement.contacts, engagement.flanks, engagement.phi1

    def cycle(self) -> Cycle:
        self.surface, ratios = surface, _ = self._surface()
        arcs = self._arcs()
        te, envelope = self._sampled()
        low = high = np.nan
        harmonics = np.full(HARMONICS, np.nan)
        if arcs is not None:
            low, high = self._extremes(arcs)
            harmonics = self._harmonics(arcs)
        reference = self._reference()
        return Cycle(
            phi1=np.arange(PER_PITCH) * self.pitch / PER_PITCH,
            te=te - reference,
            envelope=envelope - reference,
            contact_ratio=ratios[0],
            harmonics=harmonics,
            breaks=self._breaks(surface),
            peak_to_peak=high - low,
            transverse_ratio=ratios[1],
            overlap_ratio=ratios[2],
            surface=surface,
            engagement=self._whole(surface, arcs),
            handovers=() if arcs is None else tuple(arc.first for arc in arcs if arc.handover),
        )

    # ---------------------------------------------------------------- one pair

    def _te(self, contacts: Contacts, phi1: Array) -> Array:
        """phi2 - phi1 N1/N2 (N,), rad, NaN where there is no contact."""
        return np.where(contacts.touching, contacts.x[:, 4] - self.pair.ratio * phi1, np.nan)

    def _reference(self) -> float:
        """Transmission error of pair 0 at phi1 = 0, or of the first position that touches."""
        at_zero = np.flatnonzero(np.abs(self.phi1) < 1e-12)
        te = self._te(self.contacts, self.phi1)
        if at_zero.size and np.isfinite(te[at_zero[0]]):
            return float(te[at_zero[0]])
        return float(te[np.isfinite(te)][0])

    def _surface(self) -> tuple[tuple[float, float], tuple[float, float, float]]:
        """phi1 between which the pair has surface contact; contact ratio, its transverse part and the overlap."""
        nothing = (np.nan, np.nan), (np.nan, np.nan, np.nan)
        c = self.flanks
        inside = np.flatnonzero(c.touching & (c.edges[:, 0] < 0))
        if not inside.size:
            return nothing
        runs = np.split(inside, np.flatnonzero(np.diff(inside) > 1) + 1)
        run = max(runs, key=len)
        ends = [self._end(int(run[0]), -1), self._end(int(run[-1]), 1)]
        begin, end = ends[0][0], ends[1][0]
        total = (end - begin) / self.pitch
        overlap = np.nan
        if bool(c.line[run].all()):
            overlaps = [abs(other - own) / self.pitch for own, other in ends if np.isfinite(other)]
            overlap = float(np.mean(overlaps)) if overlaps else 0.0
        return (begin, end), (total, total - overlap, overlap)

    def _end(self, last: int, step: int) -> tuple[float, float]:
        """phi1 where surface contact ends beyond node `last`; of a line also where it would if it ended at its other end."""
        beyond = last + step
        if not 0 <= beyond < len(self.phi1):
            return float(self.phi1[last]), np.nan
        if self.flanks.line[last]:
            found = self._line_end(last, beyond)
            if found is not None:
                return found
        else:
            event = self._point_end(last, beyond)
            if event is not None:
                return event.phi1, np.nan
        return self._divided(last, beyond), np.nan

    def _between(self, phi1: float, last: int, beyond: int) -> bool:
        low, high = sorted((self.phi1[last], self.phi1[beyond]))
        return bool(low - 1e-12 <= phi1 <= high + 1e-12)

    def _point_end(self, last: int, beyond: int) -> Event | None:
        """Where the contact of node `last` comes to an edge."""
        flat = np.zeros(1, dtype=np.intp)
        conditions = Conditions(self.pair.flanks, self.phi1[[beyond]], self.pair.length)
        start = Event(float(self.phi1[last]), self.flanks.x[last])
        # the edges that it would lie beyond at the next node come first
        there = newton.solve(conditions, start.x[None], tolerance=TOLERANCE, max_step=self.pair.max_step, max_iterations=15)
        outside = margins(self.pair, conditions.touch(there.values, flat), there.values)[0][0]
        order = np.argsort(-outside, kind="stable") if there.converged[0] else np.arange(len(outside))
        for number in order:
            bound = self.pair.bounds[number]
            event = None if bound is None else reaches(self.pair, conditions, bound, start)
            if event is None or not self._between(event.phi1, last, beyond):
                continue
            at = replace(conditions, phi1=np.array([event.phi1]))
            touch = at.touch(event.x[None], flat)
            beyond_edges, joint = margins(self.pair, touch, event.x[None])
            beyond_edges[0, number] = 0.0
            facing = dot(touch.fixed[0].n, touch.fixed[1].n)[0] < 0.0
            if (beyond_edges <= EDGE_SLACK).all() and (joint <= EDGE_SLACK).all() and facing:
                return event
        return None

    def _line_end(self, last: int, beyond: int) -> tuple[float, float] | None:
        """Where the line of node `last` has shrunk to a point between two edges; and where it meets the first at its other end.

        Along the line beyond, every edge leaves one side of where it crosses; the two edges that leave nothing between them are
        those between which it ended.
        """
        pair, phi1 = self.pair, self.phi1[[beyond]]
        plain = Conditions(pair.flanks, phi1, pair.length)
        x = self.flanks.x[[last]] + np.array([0.0, 0.0, 0.0, 0.0, pair.ratio]) * (phi1 - self.phi1[last])
        found = newton.solve(plain, x, tolerance=TOLERANCE, rcond=RCOND)
        if not found.converged[0]:
            return None
        x, one = found.values, np.zeros(1, dtype=np.intp)
        along, across = directions(pair, plain, x)
        touch = plain.touch(x, one)
        own = margins(pair, touch, x)[0][0]
        crossing: dict[int, tuple[float, Array]] = {}
        for number, bound in enumerate(pair.bounds):
            if bound is not None:
                meets = on_edge(pair, plain, bound, across, x)
                if meets.converged[0]:
                    r = plain.touch(meets.values, one).fixed[0].r - touch.fixed[0].r
                    crossing[number] = (float(dot(r, along)[0]), meets.values)
        # an edge that the line does not cross has it all inside or all outside
        off = [k for k, bound in enumerate(pair.bounds) if bound is not None and k not in crossing and own[k] > 0.0]
        if off:
            first, others = off[0], list(crossing)
        else:
            sides: dict[bool, list[int]] = {True: [], False: []}
            for k, (place, _) in crossing.items():
                sides[(own[k] > 0.0) == (place > 0.0)].append(k)
            if not sides[True] or not sides[False]:
                return None
            low = max(sides[True], key=lambda k: crossing[k][0])
            high = min(sides[False], key=lambda k: crossing[k][0])
            first, others = (low, [high]) if low % len(EDGES) == 0 else (high, [low])
        if not others:
            return None
        faces = [k for k in crossing if k % len(EDGES) != 0 and k != first]
        ends = {}
        for other in {*others, *faces}:
            start = Event(float(phi1[0]), crossing[other][1][0])
            extra, bound = pair.bounds[first], pair.bounds[other]
            assert extra is not None
            assert bound is not None
            corner = Conditions(pair.flanks, np.zeros(1), pair.length, (bound,), across)
            event = reaches(pair, corner, extra, start)
            if event is None:
                continue
            at = Conditions(pair.flanks, np.array([event.phi1]), pair.length).touch(event.x[None], one)
            outside, joint = margins(pair, at, event.x[None])
            if (outside <= 10.0 * EDGE_SLACK).all() and (joint <= 10.0 * EDGE_SLACK).all():
                ends[other] = event.phi1
        if not ends:
            return None
        own_end = max(ends.values(), key=lambda end: (end - self.phi1[last]) * np.sign(beyond - last))
        if not self._between(own_end, last, beyond):
            return None
        other_end = min(ends.values(), key=lambda end: (end - self.phi1[last]) * np.sign(beyond - last))
        return own_end, other_end if first % len(EDGES) == 0 else np.nan

    def _divided(self, last: int, beyond: int) -> float:
        """The same by repeated division, where nothing but the kind of contact tells."""

        def inside(phi1: Array, _: NDArray[np.intp]) -> NDArray[np.bool_]:
            c = first_touch(self.pair.parts[0], phi1)
            found: NDArray[np.bool_] = c.touching & (c.edges[:, 0] < 0)
            return found

        low, high = (np.array([self.phi1[k]]) for k in (last, beyond))
        low, high = last_true(inside, low, high, rounds=ROUNDS, split=SPLIT)
        return float(0.5 * (low[0] + high[0]))

    # ---------------------------------------------------------------- the gears

    def _lead(self, phi1: Array) -> tuple[Array, Array]:
        """Lead of pair 0 over the nominal ratio (N,), rad, and its slope by phi1 (N,)."""
        c = self.engagement.near(phi1)
        slope = self.pair.drive * (rates(self.pair, phi1, c)[:, 4] - self.pair.ratio)
        return np.where(c.touching, c.lead, np.nan), slope

    def _table(self) -> tuple[Array, int]:
        """Leads (K, NODES + 1) of the tooth pairs at the nodes of one pitch, -inf where they do not touch; the first pair's number."""
        first = int(np.floor(round(float(self.phi1[0] / self.pitch * NODES)) / NODES))
        steps = np.rint(self.phi1 / self.pitch * NODES).astype(int) - first * NODES
        count = int(steps[-1] // NODES) + 1
        flat = np.full((count + 1) * NODES, -np.inf)
        flat[steps] = np.where(self.contacts.touching, self.contacts.lead, -np.inf)
        rows = np.arange(count)[:, None] * NODES + np.arange(NODES + 1)
        return flat[rows], first

    def _arcs(self) -> list[_Arc] | None:
        """The envelope over one pitch, arc by arc; None where nothing touches somewhere in it."""
        table, first = self._table()
        if not np.isfinite(table.max(axis=0)).all():
            return None
        carrier = int(table[:, 0].argmax())
        arcs, begin, handover = [], 0.0, False
        step = self.pitch / NODES
        for j in range(NODES):
            ahead = int(table[:, j + 1].argmax())
            if table[ahead, j + 1] <= table[carrier, j + 1] + TOGETHER:
                continue
            at = self._overtaken(carrier + first, ahead + first, j * step, (j + 1) * step)
            arcs.append(_Arc(carrier + first, begin, at, self.pitch, handover))
            carrier, begin, handover = ahead, at, True
        arcs.append(_Arc(carrier + first, begin, self.pitch, self.pitch, handover))
        return arcs

    def _overtaken(self, carrier: int, ahead: int, low: float, high: float) -> float:
        """Phase (rad) between `low` and `high` at which the pair `ahead` comes to lead over the one that carries."""

        # pairs that carry together part where the surface contact of one of them ends
        for pair, end in ((carrier, self.surface[1]), (ahead, self.surface[0])):
            phase = end - pair * self.pitch
            if low <= phase <= high:
                own = self._lead(phase + np.array([carrier, ahead]) * self.pitch)[0]
                if abs(own[0] - own[1]) < TOGETHER:
                    return float(phase)

        def behind(phase: float) -> tuple[float, float]:
            own, slope = self._lead(phase + np.array([carrier, ahead]) * self.pitch)
            if np.isnan(own).any():
                # a pair that does not touch is behind
                return (-1.0, 0.0) if np.isnan(own[0]) else (1.0, 0.0)
            apart, parting = float(own[0] - own[1]), float(slope[0] - slope[1])
            # together to rounding: the one that carries is counted as ahead
            return (TOGETHER, 0.0) if abs(apart) < TOGETHER and not abs(parting) > LEVEL else (apart, parting)

        return root_between(behind, low, high)

    def _extremes(self, arcs: list[_Arc]) -> tuple[float, float]:
        """Least and greatest lead of the envelope over a pitch, rad: at the ends of its arcs, and where an arc is level."""
        phi1, ends = [], []
        for arc in arcs:
            inner = self.phi1[(self.phi1 > arc.first + 1e-9) & (self.phi1 < arc.last - 1e-9)]
            places = np.concatenate(([arc.first], inner, [arc.last]))
            phi1.append(places)
            ends.append(np.arange(len(places)) == len(places) - 1)
        every, last = np.concatenate(phi1), np.concatenate(ends)
        lead, slope = self._lead(every)
        k = np.flatnonzero(~last[:-1] & (slope[:-1] * slope[1:] < 0.0) & (np.abs(slope[:-1] - slope[1:]) > LEVEL))
        if k.size:
            level = bracketed_root(lambda at, _: self._lead(at)[1], every[k], every[k + 1], tolerance=1e-9)
            lead = np.concatenate((lead, self._lead(level.values)[0]))
        return float(np.nanmin(lead)), float(np.nanmax(lead))

    def _harmonics(self, arcs: list[_Arc]) -> Array:
        """Amplitudes (HARMONICS,), rad, of the envelope: Gauss quadrature from break to break."""
        nodes, weights = np.polynomial.legendre.leggauss(GAUSS)
        places, own, phases = [], [], []
        for arc in arcs:
            inner = self._changes(arc)
            cuts = np.concatenate(([arc.first], inner, [arc.last]))
            for low, high in zip(cuts[:-1], cuts[1:], strict=True):
                half = 0.5 * (high - low)
                places.append(low + half * (nodes + 1.0))
                own.append(half * weights)
                phases.append(places[-1] - arc.pair * self.pitch)
        lead, weight, phase = self._lead(np.concatenate(places))[0], np.concatenate(own), np.concatenate(phases)
        order = np.arange(1, HARMONICS + 1)[:, None]
        wave = np.exp(-2j * np.pi * order * phase / self.pitch)
        amplitudes: Array = 2.0 / self.pitch * np.abs((wave * (lead - lead.mean()) * weight).sum(axis=1))
        return amplitudes

    def _changes(self, arc: _Arc) -> Array:
        """Nodes of an arc between which the kind of contact changes: the curve may bend sharply there."""
        k = np.flatnonzero(~self.engagement.smooth)
        ends = np.unique(np.concatenate((self.phi1[k], self.phi1[k + 1])))
        inner: Array = ends[(ends > arc.first + 1e-9) & (ends < arc.last - 1e-9)]
        return inner

    def _sampled(self) -> tuple[Array, Array]:
        """Transmission error (K, Q) of the tooth pairs, and of the gears (Q,), over one pitch."""
        steps = np.arange(round(float(self.phi1[0] / self.pitch * PER_PITCH)), round(float(self.phi1[-1] / self.pitch * PER_PITCH)) + 1)
        phi1 = steps * self.pitch / PER_PITCH
        te = self._te(self.engagement.near(phi1), phi1)
        rows = np.floor_divide(steps, PER_PITCH)
        table = np.full((int(np.ptp(rows)) + 1, PER_PITCH), np.nan)
        table[rows - rows[0], steps - rows * PER_PITCH] = te
        drive = self.pair.drive
        envelope = drive * np.max(np.where(np.isnan(table), -np.inf, drive * table), axis=0)
        return table[~np.isnan(table).all(axis=1)], np.where(np.isfinite(envelope), envelope, np.nan)

    def _whole(self, surface: tuple[float, float], arcs: list[_Arc] | None) -> tuple[float, float]:
        """phi1 between which the pair is ahead of its neighbours or has surface contact."""
        ends = [end for end in surface if np.isfinite(end)]
        for arc in arcs or ():
            ends += [arc.first, arc.last] if arc.handover or len(arcs or ()) > 1 else []
        if not ends:
            touching = self.phi1[self.contacts.touching]
            ends = [float(touching[0]), float(touching[-1])]
        return min(ends), max(ends)

    def _breaks(self, surface: tuple[float, float]) -> tuple[Break, ...]:
        """Breaks of a pair with surface contact between its two ends, where its neighbours' begins and ends too."""
        begin, end = surface
        if not np.isfinite(begin):
            return ()
        if end - begin < self.pitch:
            return (Break(end, np.nan, beginning=False),)
        at = np.array([begin, begin + self.pitch, end - self.pitch, end])
        te = self._te(self.engagement.at(at), at)
        found = []
        for phi1, (own, other), beginning in ((begin, te[:2], True), (end, te[:1:-1], False)):
            ahead = self.pair.drive * (own - other)
            if ahead > JUMP:
                found.append(Break(phi1, float(ahead), beginning))
        return tuple(found)


@dataclass(frozen=True)
class _Arc:
    """Where one pair carries: its number, the phases (rad) between which it does, and whether it took over at the first."""

    pair: int
    begin: float
    end: float
    pitch: float
    handover: bool

    @property
    def first(self) -> float:
        """phi1 of pair 0 at the beginning."""
        return self.begin + self.pair * self.pitch

    @property
    def last(self) -> float:
        """phi1 of pair 0 at the end."""
        return self.end + self.pair * self.pitch
