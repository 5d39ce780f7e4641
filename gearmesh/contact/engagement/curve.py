"""Transmission advance of the gears over a pitch: the greatest advance of all tooth pairs at every phase.

All tooth pairs have the same curve, one pitch apart. The envelope is a chain of smooth arcs. The phases at which one pair overtakes
another, and at which an arc is level, are roots.
"""

from __future__ import annotations

from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.events import ROOT_TOLERANCE_RAD, root_between
from gearmesh.contact.engagement.engagement import NODES_PER_PITCH as NODES
from gearmesh.contact.engagement.engagement import Engagement
from gearmesh.contact.engagement.surface_contact import SurfaceContact, surface_contact
from gearmesh.contact.engagement.transmission_advance import TransmissionAdvance
from gearmesh.kernel.numeric.algebra import Array, distinct
from gearmesh.kernel.numeric.roots import bracketed_root
from gearmesh.records import dataclass

#: harmonics of the mesh frequency that are given
HARMONIC_COUNT = 5
#: difference of advances (rad) below which two tooth pairs carry together
SHARED_CONTACT_RAD = 5e-12
#: slopes (rad/rad) below this are level, slopes that differ by less are parallel
LEVEL_SLOPE = 1e-9
#: distance (rad) between roots of interpolated and of solved advances
MAX_ROOT_CORRECTION_RAD = 1e-5
#: error (rad) in phi1 of an extreme advance where no slope is known
EXTREME_TOLERANCE_RAD = 1e-6
#: Gauss points on an arc
GAUSS_POINTS = 16


@dataclass(frozen=True)
class MeshArc:
    """Arc of the envelope on which one tooth pair is in contact."""

    #: number of the tooth pair
    pair: int
    #: phase at which the tooth pair takes over, rad; 0 on the first arc
    begin: float
    #: phase at which the next tooth pair takes over, rad; the pitch on the last arc
    end: float
    #: pitch of the pinion, rad
    pitch: float

    @property
    def first(self) -> float:
        """phi1 (rad) of pair 0 at the beginning."""
        return self.begin + self.pair * self.pitch

    @property
    def last(self) -> float:
        """phi1 (rad) of pair 0 at the end."""
        return self.end + self.pair * self.pitch


class MeshCurve:
    """Transmission advance of the gears, from the engagement of one tooth pair and the pinion's pitch (rad).

    Phases at which pairs change over have the error `tolerance` (rad). The error of the advance there is the product of this
    tolerance and a slope.
    """

    def __init__(self, engagement: Engagement, pitch: float, tolerance: float = ROOT_TOLERANCE_RAD) -> None:
        self.engagement, self.pair, self.pitch, self.tolerance = engagement, engagement.pair, pitch, tolerance
        self.contacts, self.phi1 = engagement.contacts, engagement.phi1

    @cached_property
    def surface(self) -> SurfaceContact:
        """Surface contact of pair 0."""
        advances, first = self._table()
        flat = np.append(advances[:, :NODES].ravel(), advances[-1, NODES])
        ahead = np.resize(advances[:, :NODES].max(axis=0), flat.size)
        steps = np.rint(self.phi1 / self.pitch * NODES).astype(int) - first * NODES
        return surface_contact(self.engagement, (flat >= ahead - SHARED_CONTACT_RAD)[steps])

    @cached_property
    def of_pair(self) -> TransmissionAdvance:
        """Transmission advance of pair 0."""
        return TransmissionAdvance(self.engagement, (self.surface.begin, self.surface.end))

    def _table(self) -> tuple[Array, int]:
        """Return advances (K, NODES_PER_PITCH + 1) of K tooth pairs at the nodes of a pitch, and the number of the first pair.

        Advances are in rad, -inf where a pair does not touch.
        """
        first = int(np.floor(round(float(self.phi1[0] / self.pitch * NODES)) / NODES))
        steps = np.rint(self.phi1 / self.pitch * NODES).astype(int) - first * NODES
        count = int(steps[-1] // NODES) + 1
        flat = np.full((count + 1) * NODES, -np.inf)
        flat[steps] = np.where(self.contacts.touching, self.contacts.advance, -np.inf)
        rows = np.arange(count)[:, None] * NODES + np.arange(NODES + 1)
        return flat[rows], first

    def at_nodes(self) -> Array:
        """Return advances (NODES_PER_PITCH + 1,), rad, of the gears at the nodes of a pitch; NaN where nothing touches."""
        advances = self._table()[0].max(axis=0)
        return np.where(np.isfinite(advances), advances, np.nan)

    @property
    def whole(self) -> bool:
        """True if a tooth pair touches at every node of a pitch."""
        return bool(np.isfinite(self.at_nodes()).all())

    @cached_property
    def _takeovers(self) -> list[tuple[int, int, int]]:
        """Takeovers (pair that carries, pair that overtakes it, node of the pitch before it) of the pair that is the most advanced.

        The first entry has the first pair twice, at node 0. No entry if contact breaks off in the pitch.
        """
        if not self.whole:
            return []
        # from node to node, follow which pair is the most advanced
        table, first = self._table()
        carrier = int(table[:, 0].argmax())
        changes = [(carrier + first, carrier + first, 0)]
        for j in range(NODES):
            # of pairs that carry together take the pair that was ahead at the node before: the others come to it in between
            leading = np.flatnonzero(table[:, j + 1] >= table[:, j + 1].max() - SHARED_CONTACT_RAD)
            ahead = int(leading[table[leading, j].argmax()])
            if table[ahead, j + 1] > table[carrier, j + 1] + SHARED_CONTACT_RAD:
                changes.append((carrier + first, ahead + first, j))
                carrier = ahead
        return changes

    @cached_property
    def arcs(self) -> list[MeshArc]:
        """Arcs of the envelope over one pitch; none if contact breaks off in it."""
        # each change is solved for between its two nodes
        step = self.pitch / NODES
        begins = [
            0.0 if carrier == ahead else self._overtaking(carrier, ahead, j * step, (j + 1) * step)
            for carrier, ahead, j in self._takeovers
        ]
        return [
            MeshArc(ahead, begin, end, self.pitch)
            for (_, ahead, _), (begin, end) in zip(self._takeovers, pairwise([*begins, self.pitch]), strict=True)
        ]

    @property
    def within_surface(self) -> bool:
        """True if the nodes show that surface contact of a pair begins before it takes over, and ends after it is overtaken."""
        if not self._takeovers:
            return False
        # phi1 of pair 0 at the nodes before it takes over and after it is overtaken, and at both ends of the pitch
        step = self.pitch / NODES
        first = [ahead * self.pitch + j * step for _, ahead, j in self._takeovers]
        last = [carrier * self.pitch + (j + 1) * step for carrier, _, j in self._takeovers[1:]]
        last.append((self._takeovers[-1][1] + 1) * self.pitch)
        return self.surface.begin < min(first) and max(last) < self.surface.end

    def handovers(self) -> Array:
        """Solve for phi1 (M,), rad, of pair 0 at which it takes over from another pair, with exact advances."""
        arcs = self.arcs
        phase = np.array([arc.begin for arc in arcs[1:]])
        pairs = np.array([[arc.pair for arc in arcs[:-1]], [arc.pair for arc in arcs[1:]]])
        if not phase.size:
            return phase
        advances, slope = (
            pair_values.reshape(2, -1) for pair_values in self.of_pair.exactly((phase + pairs * self.pitch).ravel())
        )
        # one Newton step from the root of the interpolated curves; a larger step means curves that touch
        step, parting = advances[0] - advances[1], slope[1] - slope[0]
        good = (np.abs(parting) > LEVEL_SLOPE) & (np.abs(step) < MAX_ROOT_CORRECTION_RAD * np.abs(parting))
        phase[good] += step[good] / parting[good]
        phi1: Array = phase + pairs[1] * self.pitch
        return phi1

    def _overtaking(self, carrier: int, ahead: int, low: float, high: float) -> float:
        """Solve for the phase (rad) between `low` and `high` at which the pair `ahead` overtakes the pair `carrier`."""
        before = self.of_pair.at(low + np.array([carrier, ahead]) * self.pitch)[0]
        if abs(before[0] - before[1]) < SHARED_CONTACT_RAD:
            # pairs that carry together part where the surface contact of one of them ends
            for pair, end in ((carrier, self.surface.end), (ahead, self.surface.begin)):
                phase = end - pair * self.pitch
                if low <= phase <= high:
                    return float(phase)

        def behind(phase: Array) -> tuple[Array, Array]:
            """Return the lead (N,) of the pair in contact, and its slope; a pair that does not touch is behind."""
            advances, slope = self.of_pair.at(
                np.concatenate((phase + carrier * self.pitch, phase + ahead * self.pitch))
            )
            (first, second), parting = advances.reshape(2, -1), -np.diff(slope.reshape(2, -1), axis=0)[0]
            apart = np.where(np.isnan(first), -1.0, np.where(np.isnan(second), 1.0, first - second))
            # equal to rounding: the pair that carries counts as ahead
            together = (np.abs(apart) < SHARED_CONTACT_RAD) & ~(np.abs(parting) > LEVEL_SLOPE)
            return np.where(together, SHARED_CONTACT_RAD, apart), np.where(together, np.nan, parting)

        return root_between(behind, low, high, self.tolerance)

    @cached_property
    def marks(self) -> tuple[Array, Array]:
        """Phases (M,), rad, at which the envelope changes over, is level, bends or was solved for, and advances (M,), rad.

        The envelope bends where its slope jumps, for instance where contact passes to another place on the flanks. Passages from
        an edge to the surfaces, or to another edge, are solved for too.
        """
        # changes of the pair in contact, nodes, and ends of surface contact
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
        # level places between nodes: roots of the slope; a slope that is level at a node does not change its sign there
        steep = np.minimum(np.abs(slope[:-1]), np.abs(slope[1:])) > LEVEL_SLOPE
        k = np.flatnonzero(~end[:-1] & (slope[:-1] * slope[1:] < 0.0) & steep)
        if k.size:
            # the root is one of the places that the root finder asks for: its advance is known with its slope
            known_there = dict[float, float]()

            def slope_at(at: Array, _: NDArray[np.intp]) -> Array:
                advances, slopes = self.of_pair.at(at)
                known_there.update(zip(at.tolist(), advances.tolist(), strict=True))
                return slopes

            root = bracketed_root(slope_at, phi1[k], phi1[k + 1], tolerance=1e-9)
            # where the slope jumps the root is the corner
            converged = np.isfinite(root.values)
            level, k = root.values[converged], k[converged]
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
        """phi1 (M,), rad, ascending, of the nodes of pair 0 and of the ends of its surface contact."""
        ends = np.array([self.surface.begin, self.surface.end])
        return distinct(np.concatenate((self.of_pair.phi1, ends[np.isfinite(ends)])))

    def _summits(self, phi1: Array, advance: Array, slope: Array, end: NDArray[np.bool_]) -> list[tuple[float, int]]:
        """Find extremes of the advance at nodes without a slope; return phi1 (rad) of the extremes and numbers of the nodes.

        Slopes are unknown, for instance, along a tip that touches a fillet over the whole face.
        """
        inner = np.flatnonzero(~end[:-2] & ~end[1:-1] & np.isnan(slope[1:-1])) + 1
        if not inner.size:
            return []
        from scipy.optimize import minimize_scalar

        summits = []
        for k in inner:
            # only a node above both neighbours, or below both, has an extreme beside it
            steps = advance[k] - advance[[k - 1, k + 1]]
            if not (steps > 0.0).all() and not (steps < 0.0).all():
                continue
            sense = -1.0 if steps[0] > 0.0 else 1.0
            level = minimize_scalar(
                lambda at, sense=sense: sense * float(self.of_pair.at(np.array([at]))[0][0]),
                bounds=(phi1[k - 1], phi1[k + 1]),
                method="bounded",
                options={"xatol": EXTREME_TOLERANCE_RAD},
            )
            summits.append((float(level.x), int(k)))
        return summits

    def carrier(self, phase: Array) -> NDArray[np.intp]:
        """Return numbers (N,) of the tooth pairs in contact at phases (N,) of a pitch; contact must not break off."""
        begins = np.array([arc.begin for arc in self.arcs[1:]])
        numbers: NDArray[np.intp] = np.array([arc.pair for arc in self.arcs])[np.searchsorted(begins, phase, "right")]
        return numbers

    def slope(self, phase: Array, number: NDArray[np.intp]) -> Array:
        """Return slopes (N,) by phi1 of the advance of tooth pairs with numbers (N,) at phases (N,)."""
        return self.of_pair.at(phase + number * self.pitch)[1]

    @property
    def peak_to_peak(self) -> float:
        """Transmission error of the gears peak to peak, rad; NaN if contact breaks off."""
        advance = self.marks[1]
        return float(np.ptp(advance)) if advance.size and np.isfinite(advance).all() else np.nan

    def advance(self, phase: Array) -> Array:
        """Return advances (N,), rad, of the gears at phases (N,) of a pitch; NaN where nothing touches."""
        advances = np.full(len(phase), np.nan)
        phase = np.where((phase < 0.0) | (phase > self.pitch), np.mod(phase, self.pitch), phase)
        for arc in self.arcs:
            on_arc = np.flatnonzero((phase >= arc.begin) & (phase <= arc.end))
            if on_arc.size:
                advances[on_arc] = self.of_pair.at(phase[on_arc] + arc.pair * self.pitch)[0]
        return advances

    def advance_as_known(self, phase: Array) -> Array:
        """Return the `advance`, also for gears whose contact breaks off within the pitch: NaN only where no tooth pair touches."""
        first, last = (int(np.floor(end / self.pitch)) for end in self.phi1[[0, -1]])
        places = phase + np.arange(first - 1, last + 1)[:, None] * self.pitch
        inside = (places >= self.phi1[0]) & (places <= self.phi1[-1])
        advances = np.full(places.shape, -np.inf)
        advances[inside] = np.nan_to_num(self.of_pair.at(places[inside])[0], nan=-np.inf)
        best: Array = np.where(np.isfinite(advances.max(axis=0)), advances.max(axis=0), np.nan)
        return best

    def harmonics(self) -> Array:
        """Compute amplitudes (HARMONIC_COUNT,), rad, by Gauss quadrature between breaks; NaN where contact breaks off."""
        if not self.arcs:
            return np.full(HARMONIC_COUNT, np.nan)
        # integrate between changes of the kind of contact, where the advance may bend sharply
        nodes, weights = np.polynomial.legendre.leggauss(GAUSS_POINTS)
        places, arc_weights, phases = [], [], []
        for arc in self.arcs:
            inner = self._changes(arc)
            cuts = np.concatenate(([arc.first], inner, [arc.last]))
            for low, high in pairwise(cuts):
                half = 0.5 * (high - low)
                places.append(low + half * (nodes + 1.0))
                arc_weights.append(half * weights)
                phases.append(places[-1] - arc.pair * self.pitch)
        advance, weight, phase = (
            self.of_pair.at(np.concatenate(places))[0],
            np.concatenate(arc_weights),
            np.concatenate(phases),
        )
        # Fourier integrals over one pitch of the curve, whose arcs belong to different tooth pairs
        order = np.arange(1, HARMONIC_COUNT + 1)[:, None]
        wave = np.exp(-2j * np.pi * order * phase / self.pitch)
        amplitudes: Array = 2.0 / self.pitch * np.abs((wave * (advance - advance.mean()) * weight).sum(axis=1))
        return amplitudes

    def _changes(self, arc: MeshArc) -> Array:
        """Return the nodes of an arc at which the kind of contact changes: the curve may bend sharply there."""
        fine = self.of_pair.engagement
        k = np.flatnonzero(~fine.smooth)
        ends = distinct(np.concatenate((fine.phi1[k], fine.phi1[k + 1])))
        inner: Array = ends[(ends > arc.first + 1e-9) & (ends < arc.last - 1e-9)]
        return inner
