"""A pair of eccentric members over whole turns: every tooth pair has another error, until the pattern repeats.

Teeth off their axis go round it. At a rotation phi an eccentric member stands as one without eccentricity that is displaced by
`Mount.off(phi)`, and tooth pair k does at phi1 what pair 0, so displaced, does at phi1 - k pitches. All of them are one batch,
solved from what the pair does without eccentricity at the same place of its engagement, held against first touch over the whole of
both flanks at places drawn at random. The gear is displaced by its own phi2, which is found with the contact in a few rounds.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.refinement import Contacts, Trial, refine_candidates
from gearmesh.contact.engagement.cycle import engagement_range
from gearmesh.contact.engagement.engagement import Engagement, whole_engagement
from gearmesh.contact.first_touch.first_touch import first_touch
from gearmesh.contact.fit.fit import play, reversed_pair
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.pair import CORNER, Pair
from gearmesh.contact.tca import contact_path
from gearmesh.errors import DesignError, NoSolutionError
from gearmesh.kernel.numeric.algebra import ARCSEC, Array, dot
from gearmesh.teeth.gear_train import GearPair, Member
from gearmesh.teeth.mount import Mount

#: positions in a pitch; fewer, down to LEAST, where they come to more than PLENTY in all; more pitches than MOST are refused
PER_PITCH, LEAST, PLENTY, MOST = 12, 6, 8_000, 10_000
#: pitches by which a pair is followed beyond its engagement without eccentricity
BEYOND = 1.5
#: by how much a tooth pair may fall behind without eccentricity and yet carry with it, in what eccentricities turn the gear by
BEHIND = 3.0
#: rounds in which the gear's own displacement is found, and the change of phi2 (rad) that ends them
ROUNDS, TOLERANCE = 6, 1e-11
#: positions solved at once, and those that are solved over the whole of both flanks to be sure
CHUNK, CHECKED = 4_000, 96
#: steps to either side from which a place may take another kind of contact
NEAR = 2
#: rad by which those may be ahead more
SAME = 1e-9


@dataclass(frozen=True)
class Wave:
    """Part of the transmission error that repeats `per_turn` times in a turn of a `member`, or "mesh": with every tooth.

    `amplitude`, rad, and the phi1 (rad) of its first `crest`; `closed_amplitude`, `closed_crest`: of first order in the
    eccentricity, contact taken at the mean point throughout [CR3553 3.4.11-3.4.14], NaN where the closed form has no such wave.
    """

    member: str
    per_turn: int
    amplitude: float
    crest: float
    closed_amplitude: float = math.nan
    closed_crest: float = math.nan


@dataclass(frozen=True)
class FullTurns:
    """A pair over the `pitches` of the pinion after which its pattern repeats, `per_pitch` positions in each.

    At rotations `phi1` (P,), rad, from 0 on: transmission error `te` (P,), rad, relative to that at 0, NaN where nothing touches;
    `carrier` (P,): the number of the tooth pair in contact; `backlash` (P,): rotation (rad) of the gear between its two first
    touches, negative where the pair is jammed. `mean`: the mean of the error over all of it. `waves`: each as a `Wave`.
    """

    pitches: int
    per_pitch: int
    phi1: Array
    te: Array
    carrier: NDArray[np.intp]
    backlash: Array
    waves: tuple[Wave, ...]

    @property
    def peak_to_peak(self) -> float:
        """Total transmission error, rad: the greatest less the least position."""
        return float(np.ptp(self.te))

    @property
    def runs_free(self) -> bool:
        """True where the pair jams nowhere, to an arc second."""
        return not float(self.backlash.min()) < -ARCSEC

    @property
    def tooth_to_tooth(self) -> float:
        """The greatest change of the error within any one pitch, rad."""
        ring = np.concatenate((self.te, self.te[: self.per_pitch]))
        return float(np.ptp(np.lib.stride_tricks.sliding_window_view(ring, self.per_pitch + 1), axis=1).max())


def full_turns(pair: GearPair) -> FullTurns:
    """A pair over the turns after which it repeats.

    Raises DesignError where these are too many, NoSolutionError where the teeth do not meet all the time.
    """
    pitches = pitches_until_repeat(pair)
    if pitches > MOST:
        raise DesignError(
            "teeth",
            (pair.pinion.tooth.teeth, pair.gear.tooth.teeth),
            reason=f"the pattern of both eccentricities repeats after {pitches} teeth",
            allowed=f"up to {MOST}; teeth with a common divisor, or one eccentric member alone, need fewer",
        )
    per_pitch = max(LEAST, min(PER_PITCH, PLENTY // pitches))
    both = (pair, reversed_pair(pair))
    first, second = (_concentric_engagement(own) for own in both)
    forwards, carrier = _advance(pair, first, pitches, per_pitch)
    # the coast flanks of the same gear, which is turned by whole pitches from where its flank touches that of the same number
    turned = -pair.drive * _pitches_apart(pair, first, second) * pair.gear.tooth.pitch_angle
    backwards, _ = _advance(both[1], second, pitches, per_pitch, turned)
    te, phi1 = pair.drive * forwards, np.arange(pitches * per_pitch, dtype=float) * (pair.pitch / per_pitch)
    waves = waves_of_turns(pair, pitches, phi1, te)
    return FullTurns(
        pitches,
        per_pitch,
        phi1,
        te - te[0],
        carrier,
        play(pair, forwards + backwards, wound=solver_pair(pair).wound),
        waves,
    )


def pitches_until_repeat(pair: GearPair) -> int:
    """After how many teeth the same teeth of eccentric members meet again: those of a member without eccentricity are alike."""
    teeth = (member.tooth.teeth for member in pair.both if member.mount.eccentricity != (0.0, 0.0))
    return math.lcm(1, *teeth)


def _concentric_engagement(pair: GearPair) -> Engagement:
    """The engagement without eccentricities. Raises NoSolutionError where the teeth never touch."""
    followed = whole_engagement(solver_pair(concentric_pair(pair)), pair.pitch)
    if followed is None:
        raise NoSolutionError(reason="the teeth never touch, so there is no transmission error over whole turns")
    return followed


def _pitches_apart(pair: GearPair, forwards: Engagement, backwards: Engagement) -> int:
    """Pitches of the gear that `play` adds to the advances of both sides, whose flanks touch those of the same number."""
    total = np.zeros(1)
    for followed in (forwards, backwards):
        whole = np.flatnonzero(np.abs(followed.phi1 / pair.pitch - np.round(followed.phi1 / pair.pitch)) < SAME)
        total += np.max(followed.contacts.advance[whole], initial=-np.inf)
    if not np.isfinite(total).all():
        return 0
    added = -total - play(pair, total, wound=forwards.pair.wound)
    return round(float(added[0] / pair.gear.tooth.pitch_angle))


def _advance(
    pair: GearPair, followed: Engagement, pitches: int, per_pitch: int, turned: float = 0.0
) -> tuple[Array, NDArray[np.intp]]:
    """Transmission advances (P,), rad, of the gears over the turns, and the tooth pairs in contact (P,).

    `followed`: the engagement without eccentricities; `turned` (rad): rotation of the gear beside its phi2, which its eccentricity
    has as well.
    """
    concentric = followed.pair
    low, high = engagement_range(followed, pair.pitch)
    step, more = pair.pitch / per_pitch, BEYOND * pair.pitch
    places = np.arange(math.floor((low - more) / step), math.ceil((high + more) / step) + 1)
    turns = _Turns.of(pair, concentric, followed, pitches, per_pitch, places, turned)
    advance, carrier = turns.greatest()
    if not np.isfinite(advance).all():
        raise NoSolutionError(
            reason="the eccentric teeth lose contact, so there is no transmission error over whole turns",
            remedy="reduce the eccentricities",
        )
    return advance, carrier


def concentric_pair(pair: GearPair) -> GearPair:
    """The pair without eccentricities."""

    def centre(member: Member) -> Member:
        return replace(member, mount=member.mount.concentric)

    return replace(pair, pinion=centre(pair.pinion), gear=centre(pair.gear))


@dataclass(frozen=True)
class _Turns:
    """All tooth pairs over their engagement: `places` (Q,), in steps of a pitch, at which the `pair` without eccentricity touches
    as in `contacts` (Q,), and the numbers of those that are `worth` looking at (W,); `mounts`: with eccentricity; the gear is
    `turned` (rad) beside its phi2."""

    pair: Pair
    mounts: tuple[Mount, Mount]
    pitches: int
    per_pitch: int
    places: NDArray[np.intp]
    contacts: Contacts
    worth: NDArray[np.intp]
    turned: float

    @staticmethod
    def of(
        gears: GearPair,
        pair: Pair,
        followed: Engagement,
        pitches: int,
        per_pitch: int,
        places: NDArray[np.intp],
        turned: float,
    ) -> _Turns:
        contacts = followed.at(places.astype(float) * (gears.pitch / per_pitch))
        own = np.flatnonzero(contacts.touching & (contacts.edges[:, 0] < CORNER))
        places, contacts = places[own], contacts.at(own)
        phase, most = places % per_pitch, np.full(per_pitch, -np.inf)
        np.maximum.at(most, phase, contacts.advance)
        behind = BEHIND * sum(amplitude for amplitude, _ in _closed_waves(gears).values())
        worth = np.flatnonzero(contacts.advance >= most[phase] - behind - SAME)
        return _Turns(pair, gears.mounts, pitches, per_pitch, places, contacts, worth, turned)

    @cached_property
    def unlike(self) -> list[tuple[int, int]]:
        """Numbers of places and of others near by at which the teeth touch in another way: displaced, they may do so here."""
        kinds = np.column_stack((self.contacts.edges, self.contacts.line, self.contacts.part))
        away = np.abs(self.places[self.worth][:, None] - self.places)
        numbers = []
        for kind in np.unique(kinds, axis=0):
            other = np.where((kinds == kind).all(axis=1), away, NEAR + 1)
            nearest = other.argmin(axis=1)
            taken = (other[np.arange(self.worth.size), nearest] <= NEAR) & (kinds[self.worth] != kind).any(axis=1)
            numbers += list(zip(self.worth[taken].tolist(), nearest[taken].tolist(), strict=True))
        return numbers

    @property
    def step(self) -> float:
        """From one position to the next, rad."""
        return self.pair.pitch / self.per_pitch

    def greatest(self) -> tuple[Array, NDArray[np.intp]]:
        """Of every position (P,) the greatest advance, rad, -inf where nothing touches, and the number of the tooth pair."""
        contacts = Contacts.nothing(self.pitches * self.worth.size)
        tooth, place = (index.ravel() for index in np.meshgrid(np.arange(self.pitches), self.worth, indexing="ij"))
        position = (tooth * self.per_pitch + self.places[place]) % (self.pitches * self.per_pitch)
        for part in self._chunks(np.arange(contacts.advance.size)):
            self._solve(part, tooth[part], place[part], contacts)
        advance, carrier = self._ahead(contacts, position)
        known = np.flatnonzero(contacts.touching)
        some = np.random.default_rng(0).choice(known, min(CHECKED, known.size), replace=False)
        if (self._anew(tooth[some], place[some], contacts.x[some, 4]).advance > advance[position[some]] + SAME).any():
            for part in self._chunks(known):
                contacts.put(part, self._anew(tooth[part], place[part], contacts.x[part, 4]))
            advance, carrier = self._ahead(contacts, position)
        return advance, tooth[carrier]

    def _ahead(self, contacts: Contacts, position: NDArray[np.intp]) -> tuple[Array, NDArray[np.intp]]:
        """The greatest advance at every position (P,), and the number of its contact."""
        order = np.argsort(contacts.advance, kind="stable")
        last = np.zeros(self.pitches * self.per_pitch, dtype=np.intp)
        advance = np.full(last.size, -np.inf)
        last[position[order]], advance[position[order]] = order, contacts.advance[order]
        return advance, last

    @staticmethod
    def _chunks(index: NDArray[np.intp]) -> Iterator[NDArray[np.intp]]:
        for k in range(0, index.size, CHUNK):
            yield index[k : k + CHUNK]

    def _displace(self, tooth: NDArray[np.intp], place: NDArray[np.intp], phi2: Array) -> Pair:
        """The pair with eccentric teeth (M,) at their places (M,), the gear at phi2 (M,), rad, as tooth pair 0 counts it."""
        first, second = self.mounts
        turned = tooth * self.pair.pitch
        at_phi1 = first.off(self._phi1(place) + turned)
        at_phi2 = second.off(phi2 + self.pair.ratio * turned + self.turned)
        return replace(
            self.pair,
            pinion=self.pair.pinion.remount(self.pair.pinion.mount.shift(at_phi1)),
            gear=self.pair.gear.remount(self.pair.gear.mount.shift(at_phi2)),
        )

    def _solve(
        self, part: NDArray[np.intp], tooth: NDArray[np.intp], place: NDArray[np.intp], contacts: Contacts
    ) -> None:
        """Contacts of teeth (M,) at places (M,), kept under the numbers `part` (M,)."""
        starts = [(np.arange(place.size), place)]
        starts += [
            (own, np.full(own.size, source)) for to, source in self.unlike if (own := np.flatnonzero(place == to)).size
        ]
        position, source = (np.concatenate(column) for column in zip(*starts, strict=True))
        at = self.contacts.at(source)
        at.x[:, 4] += self.pair.ratio * self.step * (self.places[place[position]] - self.places[source])
        before = at.x[: place.size, 4]
        for _ in range(ROUNDS):
            now = self._refine(self._displace(tooth, place, before), self._phi1(place), position, at)
            contacts.put(part, now)
            on = now.touching & (now.edges[:, 0] < CORNER) & ~(np.abs(now.x[:, 4] - before) <= TOLERANCE)
            if not on.any():
                break
            part, tooth, place, at = part[on], tooth[on], place[on], now.at(np.flatnonzero(on))
            position, before = np.arange(place.size), at.x[:, 4]

    @staticmethod
    def _refine(there: Pair, phi1: Array, position: NDArray[np.intp], at: Contacts) -> Contacts:
        """What is ahead at positions phi1 (M,) of contacts that are solved for from others (S,), each at its position (S,)."""
        contacts = Contacts.nothing(phi1.size)
        with np.errstate(all="ignore"):
            for number, pair in there.parts.items():
                own = np.flatnonzero(at.part == number)
                trial = Trial.of(position[own], at.x[own], at.edges[own])
                trial.line = at.line[own]
                refine_candidates(pair, phi1, trial, contacts, number)
        return contacts

    def _anew(self, tooth: NDArray[np.intp], place: NDArray[np.intp], phi2: Array) -> Contacts:
        return first_touch(self._displace(tooth, place, phi2), self._phi1(place))

    def _phi1(self, place: NDArray[np.intp]) -> Array:
        """phi1 (M,), rad, of places (M,), as tooth pair 0 counts it."""
        return self.places[place].astype(float) * self.step


def waves_of_turns(pair: GearPair, pitches: int, phi1: Array, te: Array) -> tuple[Wave, ...]:
    """Waves of both members, once and twice a turn, and of the mesh, as far as the turns hold them a whole number of times.

    Waves of one frequency cannot be distinguished: they are one, called by all its members.
    """
    closed = _closed_waves(pair)
    by_rate: dict[float, tuple[list[str], int, complex]] = {}
    for times in (1, 2):
        for member, rate in ((pair.pinion, 1.0), (pair.gear, abs(pair.ratio))):
            if pitches % member.mount.joint.cycle(member.tooth.teeth):
                continue
            names, per_turn, known = by_rate.setdefault(round(times * rate, 9), ([], times, 0j))
            if times == per_turn:
                amplitude, crest = closed[member.name] if times == 1 else (math.nan, 0.0)
                more = known + cmath.rect(amplitude, rate * crest)
                by_rate[round(times * rate, 9)] = ([*names, member.name], per_turn, more)
    waves = []
    for rate, (names, per_turn, known) in by_rate.items():
        crest = cmath.phase(known) % (2.0 * np.pi) / rate if cmath.isfinite(known) else math.nan
        waves.append(Wave(" and ".join(names), per_turn, *_wave(rate, phi1, te), abs(known), crest))
    return (*waves, Wave("mesh", 1, *_wave(pair.pinion.tooth.teeth, phi1, te)))


def _wave(rate: float, phi1: Array, te: Array) -> tuple[float, float]:
    """Amplitude and phi1 of the first crest of the wave cos(rate phi1 - crest) in an error (P,) over whole periods."""
    part = 2.0 * np.mean((te - te.mean()) * np.exp(1j * rate * phi1))
    return float(np.abs(part)), float(np.angle(part) % (2.0 * np.pi) / rate)


def _closed_waves(pair: GearPair) -> dict[str, tuple[float, float]]:
    """Amplitude and phi1 of the first crest by member, rad, of first order [CR3553 3.4.7, 3.4.11]."""
    centred = concentric_pair(pair)
    path = contact_path(solver_pair(centred), np.zeros(1))
    lever = dot(path.normal[0], pair.gear.mount.velocity(path.point[0]))
    waves = {}
    for member, turned, ratio, sense in (
        (pair.pinion, path.rotation[0], 1.0, 1.0),
        (pair.gear, path.phi2[0], pair.ratio, -1.0),
    ):
        rate = abs(ratio)
        quarter = turned + np.array([0.0, 0.5 * np.pi]) / rate * ratio
        now, later = sense * dot(path.normal[0], member.mount.off(quarter)) / lever
        waves[member.name] = float(np.hypot(now, later)), float(np.arctan2(later, now) % (2.0 * np.pi) / rate)
    return waves
