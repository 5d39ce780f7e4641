"""Transmission error of eccentric members over whole turns: every tooth pair has a different error until the pattern repeats.

The members may have pitch deviations, too.

At a rotation phi an eccentric member stands like a concentric member that is displaced by `Mount.off(phi)`. Tooth pair k has at
phi1 the contact of pair 0, with this displacement, at phi1 - k pitches. All tooth pairs are one batch, which starts from the
contacts of the concentric pair at the same rotations of its engagement. First touch over the whole of both flanks checks positions
drawn at random. The displacement of the gear depends on phi2, which is found together with the contact in a few rounds.

With pitch deviations flanks are ahead by e1 and e2 (`uneven_teeth`): pair k has the contact of pair 0 at phi1 + e1 - k pitches.
There both members are displaced as at phi1 and phi2 - e2. Teeth that are farther from their axes are displaced by that, too.
"""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.refinement import Contacts, Trial, refine_candidates
from gearmesh.contact.engagement.cycle import engagement_range
from gearmesh.contact.engagement.engagement import Engagement, whole_engagement
from gearmesh.contact.engagement.uneven_teeth import displace, farther_out, flanks_ahead, tooth_direction
from gearmesh.contact.first_touch.first_touch import first_touch
from gearmesh.contact.fit.fit import play, reversed_pair
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.pair import EDGE_CORNER, Pair
from gearmesh.contact.path import ContactPath
from gearmesh.contact.tca import contact_jets, contact_path
from gearmesh.errors import DesignError, NoSolutionError
from gearmesh.kernel.numeric.algebra import ARCSEC, Array, dot
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearPair, Member

#: positions in a pitch at most
POSITIONS_PER_PITCH = 12
#: positions in a pitch at least
MIN_POSITIONS_PER_PITCH = 6
#: positions in all from which on pitches have fewer positions
MAX_POSITIONS = 8_000
#: pitches at most
MAX_PITCHES = 10_000
#: pitches by which a pair is followed beyond its concentric engagement
PITCHES_BEYOND = 1.5
#: lag of a concentric tooth pair, by the rotation of the gear from eccentricities, up to which the eccentric pair may carry
MAX_LAG = 3.0
#: rounds that find the displacement of the gear
DISPLACEMENT_ROUNDS = 6
#: change of phi2 (rad) that ends these rounds
PHI2_TOLERANCE_RAD = 1e-11
#: positions solved at once
MAX_BATCH = 4_000
#: positions that first touch over the whole of both flanks checks
CHECKED_POSITIONS = 96
#: steps each way from which a position may take another kind of contact
STEPS_TO_OTHER_KIND = 2
#: lead (rad) of first touch over the batch that is rounding
ROUNDING_RAD = 1e-9


@dataclass(frozen=True)
class Wave:
    """Wave of the transmission error."""

    #: name of the member with whose turn the wave repeats, or "mesh" if it repeats with every tooth
    member: str
    #: periods in a turn of the member
    per_turn: int
    #: amplitude, rad
    amplitude: float
    #: phi1 of the first crest, rad
    crest: float
    #: amplitude of first order in the eccentricity, contact at the mean point [CR3553 3.4.11-3.4.14], rad, NaN without closed form
    closed_amplitude: float = math.nan
    #: crest of first order in the eccentricity, rad, NaN likewise
    closed_crest: float = math.nan


@dataclass(frozen=True)
class FullTurns:
    """Transmission error and backlash of a pair over the turns after which its pattern repeats."""

    #: pitches of the pinion after which the pattern repeats
    pitches: int
    #: positions in a pitch
    per_pitch: int
    #: rotations (P,) of the pinion from 0 on, rad
    phi1: Array
    #: transmission error (P,) less the error at phi1 = 0, rad, NaN where nothing touches
    te: Array
    #: number (P,) of the tooth pair in contact
    carrier: NDArray[np.intp]
    #: rotation (P,) of the gear between its two first touches, rad, negative where the pair is jammed
    backlash: Array
    #: waves of the transmission error
    waves: tuple[Wave, ...]

    @property
    def peak_to_peak(self) -> float:
        """Total transmission error, rad: greatest less least value."""
        return float(np.ptp(self.te))

    @property
    def runs_free(self) -> bool:
        """True where the pair jams nowhere, to an arc second."""
        return not float(self.backlash.min()) < -ARCSEC

    @property
    def tooth_to_tooth(self) -> float:
        """Greatest change of the transmission error within a pitch, rad."""
        ring = np.concatenate((self.te, self.te[: self.per_pitch]))
        return float(np.ptp(np.lib.stride_tricks.sliding_window_view(ring, self.per_pitch + 1), axis=1).max())


def full_turns(pair: GearPair) -> FullTurns:
    """Compute the transmission error of an eccentric pair over the turns after which it repeats; pitch deviations count, too.

    Raises DesignError where the turns are too many, NoSolutionError where the teeth lose contact.
    """
    pitches, per_pitch = turns_of(pair)
    forwards, backwards, carrier = displaced_advances(pair, pitches, per_pitch)
    return turns_from(pair, (forwards, backwards), carrier, per_pitch, closed=not pair.uneven)


def displaced_advances(pair: GearPair, pitches: int, per_pitch: int) -> tuple[Array, Array, NDArray[np.intp]]:
    """Compute transmission advances (P,), rad, of driving and coast flanks over `pitches`, and the tooth pairs (P,) that drive.

    Every tooth pair is displaced by eccentricities, and by teeth that are farther from their axes. The sum of both advances is the
    play. Raises NoSolutionError where the teeth lose contact.
    """
    both = (pair, reversed_pair(pair))
    first, second = (_concentric_engagement(own) for own in both)
    forwards, carrier = _advance(pair, first, pitches, per_pitch)
    backwards, _ = _advance(both[1], second, pitches, per_pitch, gear_turned(pair, first, second))
    return forwards, backwards, carrier


def turns_from(
    pair: GearPair, advances: tuple[Array, Array], carrier: NDArray[np.intp], per_pitch: int, *, closed: bool
) -> FullTurns:
    """Return the turns from advances (P,), rad, of driving and coast flanks and the tooth pairs (P,) that drive.

    `closed`: True to state the closed forms of the waves, which hold for eccentric members with equal teeth alone.
    """
    forwards, backwards = advances
    pitches = len(forwards) // per_pitch
    te, phi1 = pair.drive * forwards, np.arange(len(forwards), dtype=float) * (pair.pitch / per_pitch)
    waves = waves_of_turns(pair, pitches, phi1, te)
    if not closed:
        waves = tuple(replace(wave, closed_amplitude=math.nan, closed_crest=math.nan) for wave in waves)
    return FullTurns(
        pitches,
        per_pitch,
        phi1,
        te - te[0],
        carrier,
        play(pair, forwards + backwards, wound=solver_pair(pair).wound),
        waves,
    )


def turns_of(pair: GearPair) -> tuple[int, int]:
    """Return the pitches until a pair repeats, and the positions in a pitch. Raises DesignError where the pitches are too many."""
    pitches = pitches_until_repeat(pair)
    if pitches > MAX_PITCHES:
        raise DesignError(
            "teeth",
            (pair.pinion.tooth.teeth, pair.gear.tooth.teeth),
            reason=f"the pattern of both members repeats after {pitches} teeth",
            allowed=f"up to {MAX_PITCHES}; teeth with a common divisor, or one member alone with eccentricity or pitch deviations, "
            "need fewer",
        )
    return pitches, max(MIN_POSITIONS_PER_PITCH, min(POSITIONS_PER_PITCH, MAX_POSITIONS // pitches))


def pitches_until_repeat(pair: GearPair) -> int:
    """Return the teeth after which the same teeth meet again; a member whose teeth are all alike does not count."""
    counted = (m for m in pair.both if m.index.uneven or m.mount.eccentricity != (0.0, 0.0))
    return math.lcm(1, *(member.tooth.teeth for member in counted))


def _concentric_engagement(pair: GearPair) -> Engagement:
    """Solve for the engagement of the concentric pair. Raises NoSolutionError where the teeth never touch."""
    followed = whole_engagement(solver_pair(concentric_pair(pair)), pair.pitch)
    if followed is None:
        raise NoSolutionError(reason="the teeth never touch, so there is no transmission error over whole turns")
    return followed


def gear_turned(pair: GearPair, forwards: Engagement, backwards: Engagement) -> int:
    """Return the pitches by which the gear stands ahead, as phi2 counts, of the contact of coast flanks of the same number.

    Both engagements, of the driving and of the coast flanks, count flanks of the same number. `play` adds these pitches to their
    advances.
    """
    total = np.zeros(1)
    for followed in (forwards, backwards):
        whole = np.flatnonzero(np.abs(followed.phi1 / pair.pitch - np.round(followed.phi1 / pair.pitch)) < ROUNDING_RAD)
        total += np.max(followed.contacts.advance[whole], initial=-np.inf)
    if not np.isfinite(total).all():
        return 0
    added = -total - play(pair, total, wound=forwards.pair.wound)
    return -pair.drive * round(float(added[0] / pair.gear.tooth.pitch_angle))


def _advance(
    pair: GearPair, followed: Engagement, pitches: int, per_pitch: int, turned: int = 0
) -> tuple[Array, NDArray[np.intp]]:
    """Compute transmission advances (P,), rad, of the gears over the turns, and the numbers (P,) of the tooth pairs in contact.

    `followed` is the concentric engagement. `turned` are pitches of the gear in addition to phi2, which turn its eccentricity too.
    """
    concentric = followed.pair
    low, high = engagement_range(followed, pair.pitch)
    step, more = pair.pitch / per_pitch, PITCHES_BEYOND * pair.pitch
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
    """Return the pair without eccentricities."""

    def centre(member: Member) -> Member:
        return replace(member, mount=member.mount.concentric)

    return replace(pair, pinion=centre(pair.pinion), gear=centre(pair.gear))


@dataclass(frozen=True)
class _Turns:
    """Batch of all tooth pairs over their engagement."""

    #: concentric pair
    pair: Pair
    #: pinion and gear with eccentricity
    members: tuple[Member, Member]
    #: pitches of the pinion after which the pattern repeats
    pitches: int
    #: positions in a pitch
    per_pitch: int
    #: places (Q,) of the engagement, in steps of `pitch / per_pitch`, at which the concentric pair touches
    places: NDArray[np.intp]
    #: contacts (Q,) of the concentric pair
    contacts: Contacts
    #: numbers (W,) of the places at which an eccentric pair may carry
    worth: NDArray[np.intp]
    #: pitches of the gear in addition to phi2
    turned: int
    #: angles (pitches,), rad, by which the flanks of pinion and gear of each tooth pair are ahead
    ahead: tuple[Array, Array]
    #: distances (pitches,), mm, by which the teeth of pinion and gear of each tooth pair are farther from their axes
    outwards: tuple[Array, Array]

    @staticmethod
    def of(
        gears: GearPair,
        pair: Pair,
        followed: Engagement,
        pitches: int,
        per_pitch: int,
        places: NDArray[np.intp],
        turned: int,
    ) -> _Turns:
        # contacts of the concentric pair are the starts; a place is worth solving if eccentricity can bring it to the front
        step = gears.pitch / per_pitch
        contacts = followed.at(places.astype(float) * step)
        usable = np.flatnonzero(contacts.touching & (contacts.edges[:, 0] < EDGE_CORNER))
        places, contacts = places[usable], contacts.at(usable)
        phase, most = places % per_pitch, np.full(per_pitch, -np.inf)
        np.maximum.at(most, phase, contacts.advance)
        numbers = np.arange(pitches)
        ahead, outwards = (of_teeth(gears, numbers, turned) for of_teeth in (flanks_ahead, farther_out))
        # the smaller the lever arm of a normal, the farther the gear turns by a way along it
        way = abs(_mean_contact(gears)[1]) * sum(amplitude for amplitude, _ in _closed_waves(gears).values())
        way += sum(float(np.ptp(away)) for away in outwards)
        behind = MAX_LAG * way / _levers(pair, np.asarray(places * step), contacts)
        # differences of pitch deviations count as they are
        behind += float(np.ptp(gears.ratio * ahead[0] - ahead[1]))
        worth = np.flatnonzero(contacts.advance >= most[phase] - behind - ROUNDING_RAD)
        return _Turns(
            pair, gears.both, pitches, per_pitch, places, contacts, worth, turned, (ahead[0], ahead[1]), outwards
        )

    @cached_property
    def unlike(self) -> list[tuple[int, int]]:
        """Numbers of places and of neighbours with another kind of contact, which displaced teeth may have at the place too."""
        kinds = np.column_stack((self.contacts.edges, self.contacts.line, self.contacts.part))
        away = np.abs(self.places[self.worth][:, None] - self.places)
        numbers = []
        for kind in np.unique(kinds, axis=0):
            other = np.where((kinds == kind).all(axis=1), away, STEPS_TO_OTHER_KIND + 1)
            nearest = other.argmin(axis=1)
            taken = (other[np.arange(self.worth.size), nearest] <= STEPS_TO_OTHER_KIND) & (
                kinds[self.worth] != kind
            ).any(axis=1)
            numbers += list(zip(self.worth[taken].tolist(), nearest[taken].tolist(), strict=True))
        return numbers

    @property
    def step(self) -> float:
        """Step from one position to the next, rad."""
        return self.pair.pitch / self.per_pitch

    def greatest(self) -> tuple[Array, NDArray[np.intp]]:
        """Solve for the greatest advance (P,), rad, at every position, -inf without contact, and the number (P,) of the pair."""
        # every tooth pair at every place worth solving
        contacts = Contacts.nothing(self.pitches * self.worth.size)
        tooth, place = (index.ravel() for index in np.meshgrid(np.arange(self.pitches), self.worth, indexing="ij"))
        position = (tooth * self.per_pitch + self.places[place]) % (self.pitches * self.per_pitch)
        for part in self._chunks(np.arange(contacts.advance.size)):
            self._solve(part, tooth[part], place[part], contacts)
        advance, carrier = self._most_advanced(contacts, tooth, position)
        # check samples by the global search: if one is ahead, search all positions anew
        known = np.flatnonzero(contacts.touching)
        checked = np.random.default_rng(0).choice(known, min(CHECKED_POSITIONS, known.size), replace=False)
        lead = self._lead(tooth[checked])
        if (
            self._anew(tooth[checked], place[checked], contacts.x[checked, 4]).advance + lead
            > advance[position[checked]] + ROUNDING_RAD
        ).any():
            for part in self._chunks(known):
                contacts.put(part, self._anew(tooth[part], place[part], contacts.x[part, 4]))
            advance, carrier = self._most_advanced(contacts, tooth, position)
        return advance, tooth[carrier]

    def _lead(self, tooth: NDArray[np.intp]) -> Array:
        """Return the advances (M,), rad, of tooth pairs (M,) that their pitch deviations add to those of their contacts."""
        first, second = self.ahead
        return self.pair.drive * (self.pair.ratio * first[tooth] - second[tooth])

    def _most_advanced(
        self, contacts: Contacts, tooth: NDArray[np.intp], position: NDArray[np.intp]
    ) -> tuple[Array, NDArray[np.intp]]:
        """Return the greatest advance (P,), rad, at every position, and the number (P,) of its contact."""
        advances = contacts.advance + self._lead(tooth)
        order = np.argsort(advances, kind="stable")
        last = np.zeros(self.pitches * self.per_pitch, dtype=np.intp)
        advance = np.full(last.size, -np.inf)
        last[position[order]], advance[position[order]] = order, advances[order]
        return advance, last

    @staticmethod
    def _chunks(index: NDArray[np.intp]) -> Iterator[NDArray[np.intp]]:
        for k in range(0, index.size, MAX_BATCH):
            yield index[k : k + MAX_BATCH]

    def _displace(self, tooth: NDArray[np.intp], place: NDArray[np.intp], phi2: Array) -> Pair:
        """Return the pair displaced as teeth (M,) at places (M,), with the gear's flank at phi2 (M,), rad, as pair 0 counts."""
        pinion, gear = self.members
        turned, gear_turned = tooth * self.pair.pitch, self.turned * gear.tooth.pitch_angle
        at_phi1 = pinion.mount.off(self._phi1(place) + turned)
        at_phi2 = gear.mount.off(phi2 - self.ahead[1][tooth] + self.pair.ratio * turned + gear_turned)
        # teeth farther out are displaced along their own directions
        away_1, away_2 = (away[tooth, None] for away in self.outwards)
        at_phi1 = at_phi1 + away_1 * tooth_direction(pinion, self._flank_phi1(tooth, place))
        at_phi2 = at_phi2 + away_2 * tooth_direction(gear, phi2)
        return displace(self.pair, at_phi1, at_phi2)

    def _solve(
        self, part: NDArray[np.intp], tooth: NDArray[np.intp], place: NDArray[np.intp], contacts: Contacts
    ) -> None:
        """Solve for contacts of teeth (M,) at places (M,), and put them under the numbers `part` (M,)."""
        starts = [(np.arange(place.size), place)]
        starts += [
            (own, np.full(own.size, source)) for to, source in self.unlike if (own := np.flatnonzero(place == to)).size
        ]
        position, source = (np.concatenate(column) for column in zip(*starts, strict=True))
        at = self.contacts.at(source)
        at.x[:, 4] += self.pair.ratio * (
            self.ahead[0][tooth[position]] + self.step * (self.places[place[position]] - self.places[source])
        )
        # the displacement of the gear depends on phi2: fixed-point iteration
        before = at.x[: place.size, 4]
        for _ in range(DISPLACEMENT_ROUNDS):
            now = self._refine(self._displace(tooth, place, before), self._flank_phi1(tooth, place), position, at)
            contacts.put(part, now)
            on = now.touching & (now.edges[:, 0] < EDGE_CORNER) & ~(np.abs(now.x[:, 4] - before) <= PHI2_TOLERANCE_RAD)
            if not on.any():
                break
            part, tooth, place, at = part[on], tooth[on], place[on], now.at(np.flatnonzero(on))
            position, before = np.arange(place.size), at.x[:, 4]

    @staticmethod
    def _refine(displaced: Pair, phi1: Array, position: NDArray[np.intp], at: Contacts) -> Contacts:
        """Solve from S contacts, each for its `position` (S,) in phi1 (M,), and return the most advanced contact at each phi1."""
        contacts = Contacts.nothing(phi1.size)
        with np.errstate(all="ignore"):
            for number, pair in displaced.parts.items():
                on_part = np.flatnonzero(at.part == number)
                trial = Trial.of(position[on_part], at.x[on_part], at.edges[on_part])
                trial.line = at.line[on_part]
                refine_candidates(pair, phi1, trial, contacts, number)
        return contacts

    def _anew(self, tooth: NDArray[np.intp], place: NDArray[np.intp], phi2: Array) -> Contacts:
        return first_touch(self._displace(tooth, place, phi2), self._flank_phi1(tooth, place))

    def _phi1(self, place: NDArray[np.intp]) -> Array:
        """Return phi1 (M,), rad, of places (M,), as tooth pair 0 counts."""
        return self.places[place].astype(float) * self.step

    def _flank_phi1(self, tooth: NDArray[np.intp], place: NDArray[np.intp]) -> Array:
        """Return the rotations (M,), rad, at which the pinion's nominal flank is where those of teeth (M,) are at places (M,)."""
        return self._phi1(place) + self.ahead[0][tooth]


def waves_of_turns(pair: GearPair, pitches: int, phi1: Array, te: Array) -> tuple[Wave, ...]:
    """Compute the waves of both members, once and twice a turn, and of the mesh.

    The turns must hold a whole number of periods of a wave. Waves of the same frequency cannot be distinguished: they are one wave
    with the names of all its members.
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
    """Compute amplitude (rad) and phi1 (rad) of the first crest of the wave of `rate` in an error (P,) over whole periods."""
    part = 2.0 * np.mean((te - te.mean()) * np.exp(1j * rate * phi1))
    return float(np.abs(part)), float(np.angle(part) % (2.0 * np.pi) / rate)


def _closed_waves(pair: GearPair) -> dict[str, tuple[float, float]]:
    """Compute amplitude and phi1 of the first crest by member, rad, of first order in the eccentricity [CR3553 3.4.7, 3.4.11]."""
    # a displacement along the normal at the mean point turns the gear by itself over the lever arm of the normal
    path, lever = _mean_contact(pair)
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


def _levers(pair: Pair, phi1: Array, contacts: Contacts) -> Array:
    """Return the lever arms (N,), mm, of the normals of contacts (N,) about the gear's axis at rotations phi1 (N,), rad."""
    _, (_, gear) = contact_jets(pair, phi1, contacts)
    return np.abs(dot(gear.n, pair.gear.mount.velocity(gear.r)))


def _mean_contact(pair: GearPair) -> tuple[ContactPath, float]:
    """Solve for the contact of the concentric pair at phi1 = 0 and the lever arm (mm) of its normal about the gear's axis."""
    path = contact_path(solver_pair(concentric_pair(pair)), np.zeros(1))
    return path, float(dot(path.normal[0], pair.gear.mount.velocity(path.point[0])))
