"""The transmission advance of the gears over a pitch: of all tooth pairs, which are alike, the greatest at every phase.

It is a chain of smooth arcs. Where one pair overtakes another, and where an arc is level, are roots.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.events import TOLERANCE, root_between
from gearmesh.contact.engagement.engagement import PER_PITCH as NODES
from gearmesh.contact.engagement.engagement import Engagement
from gearmesh.contact.engagement.surface_contact import SurfaceContact, surface_contact
from gearmesh.contact.engagement.transmission_advance import TransmissionAdvance
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.roots import bracketed_root

HARMONICS = 5
#: rad: tooth pairs closer than this carry together
TOGETHER = 5e-12
#: slopes (rad/rad) of less, or that differ by less, are level
LEVEL = 1e-9
#: rad: roots of interpolated advances are this close to those of solved ones
CLOSE = 1e-5
#: rad to which a greatest advance is found where no slope tells of it
SUMMIT = 1e-6
#: Gauss points on an arc
GAUSS = 16


@dataclass(frozen=True)
class MeshArc:
    """Where one tooth pair is in contact: its number, and the phases (rad) between which it is; at every one but the first it
    took over."""

    pair: int
    begin: float
    end: float
    pitch: float

    @property
    def first(self) -> float:
        """phi1 of pair 0 at the beginning."""
        return self.begin + self.pair * self.pitch

    @property
    def last(self) -> float:
        """phi1 of pair 0 at the end."""
        return self.end + self.pair * self.pitch


class MeshCurve:
    """The transmission advance of the gears, from the engagement of one tooth pair and the pinion's pitch (rad); where pairs
    change over is found to `tolerance` (rad), of which the advances there know no more than the product with their slopes."""

    def __init__(self, engagement: Engagement, pitch: float, tolerance: float = TOLERANCE) -> None:
        self.engagement, self.pair, self.pitch, self.tolerance = engagement, engagement.pair, pitch, tolerance
        self.contacts, self.phi1 = engagement.contacts, engagement.phi1

    @cached_property
    def surface(self) -> SurfaceContact:
        """The surface contact of pair 0, where it has any."""
        advances, first = self._table()
        flat = np.append(advances[:, :NODES].ravel(), advances[-1, NODES])
        ahead = np.resize(advances[:, :NODES].max(axis=0), flat.size)
        steps = np.rint(self.phi1 / self.pitch * NODES).astype(int) - first * NODES
        return surface_contact(self.engagement, (flat >= ahead - TOGETHER)[steps])

    @cached_property
    def of_pair(self) -> TransmissionAdvance:
        """The transmission advance of pair 0."""
        return TransmissionAdvance(self.engagement, (self.surface.begin, self.surface.end))

    def _table(self) -> tuple[Array, int]:
        """Advances (K, NODES + 1) of the tooth pairs at the nodes of one pitch, -inf where they do not touch; number of the
        first."""
        first = int(np.floor(round(float(self.phi1[0] / self.pitch * NODES)) / NODES))
        steps = np.rint(self.phi1 / self.pitch * NODES).astype(int) - first * NODES
        count = int(steps[-1] // NODES) + 1
        flat = np.full((count + 1) * NODES, -np.inf)
        flat[steps] = np.where(self.contacts.touching, self.contacts.advance, -np.inf)
        rows = np.arange(count)[:, None] * NODES + np.arange(NODES + 1)
        return flat[rows], first

    def at_nodes(self) -> Array:
        """Advances (NODES + 1,), rad, of the gears at even phases of one pitch, as the nodes have them; NaN where nothing
        touches."""
        advances = self._table()[0].max(axis=0)
        return np.where(np.isfinite(advances), advances, np.nan)

    @property
    def whole(self) -> bool:
        """Whether some tooth pair touches at every node of a pitch."""
        return bool(np.isfinite(self.at_nodes()).all())

    @cached_property
    def arcs(self) -> list[MeshArc]:
        """The envelope over one pitch, arc by arc; none where nothing touches somewhere in it."""
        if not self.whole:
            return []
        table, first = self._table()
        carrier = int(table[:, 0].argmax())
        arcs, begin = [], 0.0
        step = self.pitch / NODES
        for j in range(NODES):
            # of pairs that carry together the one that was ahead before: the others may only come to it in between
            leading = np.flatnonzero(table[:, j + 1] >= table[:, j + 1].max() - TOGETHER)
            ahead = int(leading[table[leading, j].argmax()])
            if table[ahead, j + 1] <= table[carrier, j + 1] + TOGETHER:
                continue
            at = self._overtaking(carrier + first, ahead + first, j * step, (j + 1) * step)
            arcs.append(MeshArc(carrier + first, begin, at, self.pitch))
            carrier, begin = ahead, at
        arcs.append(MeshArc(carrier + first, begin, self.pitch, self.pitch))
        return arcs

    def handovers(self) -> Array:
        """phi1 (M,), rad, of pair 0 at which it takes over from another: roots of the advances as they are solved for."""
        arcs = self.arcs
        phase = np.array([arc.begin for arc in arcs[1:]])
        pairs = np.array([[arc.pair for arc in arcs[:-1]], [arc.pair for arc in arcs[1:]]])
        if not phase.size:
            return phase
        own, slope = (
            pair_values.reshape(2, -1) for pair_values in self.of_pair.exactly((phase + pairs * self.pitch).ravel())
        )
        step, parting = own[0] - own[1], slope[1] - slope[0]
        good = (np.abs(parting) > LEVEL) & (np.abs(step) < CLOSE * np.abs(parting))
        phase[good] += step[good] / parting[good]
        phi1: Array = phase + pairs[1] * self.pitch
        return phi1

    def _overtaking(self, carrier: int, ahead: int, low: float, high: float) -> float:
        """Phase (rad) between `low` and `high` at which the pair `ahead` overtakes the one in contact."""
        before = self.of_pair.at(low + np.array([carrier, ahead]) * self.pitch)[0]
        if abs(before[0] - before[1]) < TOGETHER:
            # pairs that carry together part where the surface contact of one of them ends
            for pair, end in ((carrier, self.surface.end), (ahead, self.surface.begin)):
                phase = end - pair * self.pitch
                if low <= phase <= high:
                    return float(phase)

        def behind(phase: Array) -> tuple[Array, Array]:
            """By how much the pair in contact is ahead, and its slope; a pair that does not touch is behind."""
            own, slope = self.of_pair.at(np.concatenate((phase + carrier * self.pitch, phase + ahead * self.pitch)))
            (first, second), parting = own.reshape(2, -1), -np.diff(slope.reshape(2, -1), axis=0)[0]
            apart = np.where(np.isnan(first), -1.0, np.where(np.isnan(second), 1.0, first - second))
            # together to rounding: the one that carries is counted as ahead
            together = (np.abs(apart) < TOGETHER) & ~(np.abs(parting) > LEVEL)
            return np.where(together, TOGETHER, apart), np.where(together, np.nan, parting)

        return root_between(behind, low, high, self.tolerance)

    @cached_property
    def marks(self) -> tuple[Array, Array]:
        """Phases (M,), rad, at which the envelope changes over, is level, bends or was solved for, and its advances there (M,),
        rad.

        It bends where its slope jumps, as where contact passes from one place to another; where contact on an edge passes to that
        of the surfaces, and to another edge, is solved for too.
        """
        places, pair, last = [], [], []
        known = self._known_phi1
        for arc in self.arcs:
            inner = known[(known > arc.first + 1e-9) & (known < arc.last - 1e-9)]
            places.append(np.concatenate(([arc.first], inner, [arc.last])))
            pair.append(np.full(len(places[-1]), arc.pair))
            last.append(np.arange(len(places[-1])) == len(places[-1]) - 1)
        if not places:
            return np.zeros(0), np.zeros(0)
        phi1, number, end = np.concatenate(places), np.concatenate(pair), np.concatenate(last)
        advance, slope = self.of_pair.at(phi1)
        # level already, at a node, is no change of sign
        steep = np.minimum(np.abs(slope[:-1]), np.abs(slope[1:])) > LEVEL
        k = np.flatnonzero(~end[:-1] & (slope[:-1] * slope[1:] < 0.0) & steep)
        if k.size:
            # the root is one of the places that were asked: where it is solved for, its advance is known with its slope
            known_there = dict[float, float]()

            def slope_at(at: Array, _: NDArray[np.intp]) -> Array:
                own, slopes = self.of_pair.at(at)
                known_there.update(zip(at.tolist(), own.tolist(), strict=True))
                return slopes

            root = bracketed_root(slope_at, phi1[k], phi1[k + 1], tolerance=1e-9)
            # where the slope jumps there is a corner, and it is found all the same
            there = np.isfinite(root.values)
            level, k = root.values[there], k[there]
            phi1, number = np.concatenate((phi1, level)), np.concatenate((number, number[k]))
            advance = np.concatenate((advance, [known_there[at] for at in level.tolist()]))
        summits = self._summits(phi1, advance, slope, end)
        if summits:
            at, k = (np.array(column) for column in zip(*summits, strict=True))
            phi1, number = np.concatenate((phi1, at)), np.concatenate((number, number[k]))
            advance = np.concatenate((advance, self.of_pair.at(at)[0]))
        return phi1 - number * self.pitch, advance

    @property
    def _known_phi1(self) -> Array:
        """phi1 (M,), rad, ascending, at which pair 0 was solved for, and where its surface contact begins and ends."""
        ends = np.array([self.surface.begin, self.surface.end])
        return np.unique(np.concatenate((self.of_pair.phi1, ends[np.isfinite(ends)])))

    def _summits(self, phi1: Array, advance: Array, slope: Array, end: NDArray[np.bool_]) -> list[tuple[float, int]]:
        """phi1 (rad) near nodes of the arcs, and their numbers, at which the advance is greatest or least and its slope unknown,
        as along a tip that touches a fillet over the whole face."""
        inner = np.flatnonzero(~end[:-2] & ~end[1:-1] & np.isnan(slope[1:-1])) + 1
        if not inner.size:
            return []
        from scipy.optimize import minimize_scalar

        summits = []
        for k in inner:
            steps = advance[k] - advance[[k - 1, k + 1]]
            if not (steps > 0.0).all() and not (steps < 0.0).all():
                continue
            sense = -1.0 if steps[0] > 0.0 else 1.0
            level = minimize_scalar(
                lambda at, sense=sense: sense * float(self.of_pair.at(np.array([at]))[0][0]),
                bounds=(phi1[k - 1], phi1[k + 1]),
                method="bounded",
                options={"xatol": SUMMIT},
            )
            summits.append((float(level.x), int(k)))
        return summits

    def carrier(self, phase: Array) -> NDArray[np.intp]:
        """Numbers (N,) of the tooth pairs in contact at phases (N,) of a pitch; there must be arcs."""
        begins = np.array([arc.begin for arc in self.arcs[1:]])
        numbers: NDArray[np.intp] = np.array([arc.pair for arc in self.arcs])[np.searchsorted(begins, phase, "right")]
        return numbers

    def slope(self, phase: Array, number: NDArray[np.intp]) -> Array:
        """Slope (N,) by phi1 of the advance of the tooth pairs with given numbers (N,) at phases (N,)."""
        return self.of_pair.at(phase + number * self.pitch)[1]

    @property
    def peak_to_peak(self) -> float:
        """Transmission error of the gears peak to peak, rad; NaN where the contact breaks off."""
        advance = self.marks[1]
        return float(np.ptp(advance)) if advance.size and np.isfinite(advance).all() else np.nan

    def advance(self, phase: Array) -> Array:
        """Advance (N,), rad, of the gears at phases (N,) of a pitch; NaN where nothing touches."""
        advances = np.full(len(phase), np.nan)
        phase = np.where((phase < 0.0) | (phase > self.pitch), np.mod(phase, self.pitch), phase)
        for arc in self.arcs:
            own = np.flatnonzero((phase >= arc.begin) & (phase <= arc.end))
            if own.size:
                advances[own] = self.of_pair.at(phase[own] + arc.pair * self.pitch)[0]
        return advances

    def advance_as_known(self, phase: Array) -> Array:
        """As `advance`, also of gears whose contact breaks off in the pitch: NaN only where none of the tooth pairs touches."""
        first, last = (int(np.floor(end / self.pitch)) for end in self.phi1[[0, -1]])
        places = phase + np.arange(first - 1, last + 1)[:, None] * self.pitch
        inside = (places >= self.phi1[0]) & (places <= self.phi1[-1])
        advances = np.full(places.shape, -np.inf)
        advances[inside] = np.nan_to_num(self.of_pair.at(places[inside])[0], nan=-np.inf)
        best: Array = np.where(np.isfinite(advances.max(axis=0)), advances.max(axis=0), np.nan)
        return best

    def harmonics(self) -> Array:
        """Amplitudes (HARMONICS,), rad, of the envelope: Gauss quadrature from break to break; NaN where the contact breaks off."""
        if not self.arcs:
            return np.full(HARMONICS, np.nan)
        nodes, weights = np.polynomial.legendre.leggauss(GAUSS)
        places, own, phases = [], [], []
        for arc in self.arcs:
            inner = self._changes(arc)
            cuts = np.concatenate(([arc.first], inner, [arc.last]))
            for low, high in pairwise(cuts):
                half = 0.5 * (high - low)
                places.append(low + half * (nodes + 1.0))
                own.append(half * weights)
                phases.append(places[-1] - arc.pair * self.pitch)
        advance, weight, phase = self.of_pair.at(np.concatenate(places))[0], np.concatenate(own), np.concatenate(phases)
        order = np.arange(1, HARMONICS + 1)[:, None]
        wave = np.exp(-2j * np.pi * order * phase / self.pitch)
        amplitudes: Array = 2.0 / self.pitch * np.abs((wave * (advance - advance.mean()) * weight).sum(axis=1))
        return amplitudes

    def _changes(self, arc: MeshArc) -> Array:
        """Nodes of an arc between which the kind of contact changes: the curve may bend sharply there."""
        fine = self.of_pair.engagement
        k = np.flatnonzero(~fine.smooth)
        ends = np.unique(np.concatenate((fine.phi1[k], fine.phi1[k + 1])))
        inner: Array = ends[(ends > arc.first + 1e-9) & (ends < arc.last - 1e-9)]
        return inner
