"""A pair whose teeth have pitch deviations over whole turns: every tooth pair is as long ahead or behind as its flanks are.

A flank that is turned about its gear's own axis by e does what it does without, at a rotation that differs by e, exactly. With
the transmission error te of one tooth pair, phi2 - i phi1, tooth pair k has, its flanks e1 and e2 ahead as phi1 and phi2 count,

    te_k(phi1) = te(phi1 + e1 - k pitch) + i e1 - e2

and the gears the one that is most advanced, edge contact of flanks that are ahead of the next included.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.engagement.engagement import PER_PITCH as NODES
from gearmesh.contact.engagement.engagement import Engagement, follow, whole_engagement
from gearmesh.contact.engagement.transmission_advance import TransmissionAdvance
from gearmesh.contact.engagement.turns import LEAST, MOST, PER_PITCH, PLENTY, FullTurns, full_turns, waves_of_turns
from gearmesh.contact.fit.fit import play, reversed_pair
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.pair import Pair
from gearmesh.errors import DesignError, NoSolutionError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.progress import in_turn
from gearmesh.teeth.gear_train import GearPair, Member
from gearmesh.teeth.region import Side

#: nodes by which a tooth pair is followed beyond where it is ahead without pitch deviations
BEYOND = NODES // 2


def pitches_until_repeat(pair: GearPair) -> int:
    """After how many teeth the same meet again: those of a member without deviations are alike."""
    return math.lcm(1, *(member.tooth.teeth for member in pair.both if member.index.uneven))


def whole_turns(pair: GearPair) -> FullTurns:
    """A pair over the turns after which it repeats, its members eccentric or with pitch deviations. Raises as `full_turns` and
    `pitch_turns`."""
    return pitch_turns(pair) if pair.uneven else full_turns(pair)


def pitch_turns(pair: GearPair) -> FullTurns:
    """A pair of gears, no rack, with the pitch deviations of its members, over the turns after which it repeats.

    Raises DesignError where these are too many, and where members are eccentric too, NoSolutionError where the teeth do
    not meet all the time.
    """
    refuse_too_many(pair)
    pitches = pitches_until_repeat(pair)
    per_pitch = max(LEAST, min(PER_PITCH, PLENTY // pitches))
    (forwards, carrier), (backwards, _) = (
        shifted_advance(own, pitches, per_pitch) for own in in_turn((pair, reversed_pair(pair)))
    )
    te, phi1 = pair.drive * forwards, np.arange(pitches * per_pitch, dtype=float) * (pair.pitch / per_pitch)
    waves = tuple(
        replace(wave, closed_amplitude=math.nan, closed_crest=math.nan)
        for wave in waves_of_turns(pair, pitches, phi1, te)
    )
    return FullTurns(
        pitches,
        per_pitch,
        phi1,
        te - te[0],
        carrier,
        play(pair, forwards + backwards, wound=solver_pair(pair).wound),
        waves,
    )


def refuse_too_many(pair: GearPair) -> None:
    """Raise DesignError as `pitch_turns`."""
    if pair.eccentric:
        raise DesignError(
            "assembly",
            reason="members with pitch deviations cannot have eccentricities too",
            remedy="pitch deviations that were measured about the axis of rotation contain them: leave the eccentricities out",
        )
    pitches = pitches_until_repeat(pair)
    if pitches > MOST:
        raise DesignError(
            "teeth",
            (pair.pinion.tooth.teeth, pair.gear.tooth.teeth),
            reason=f"the pattern of both members' pitch deviations repeats after {pitches} teeth",
            allowed=f"up to {MOST}; deviations of one member alone need fewer",
        )


def shifted_advance(pair: GearPair, pitches: int, per_pitch: int) -> tuple[Array, NDArray[np.intp]]:
    """Transmission advances (P,), rad, of the gears over so many pitches, and the tooth pairs in contact (P,)."""
    flanks = solver_pair(pair)
    followed = _longer_engagement(flanks, pair.pitch)
    if followed is None:
        raise NoSolutionError(reason="the teeth never touch, so there is no transmission error over whole turns")
    of_pair = TransmissionAdvance(followed)
    low, high = (followed.phi1[k] / pair.pitch for k in (0, -1))
    # where tooth pair `pitch number + away` is, counted as pair 0 counts it
    away = np.arange(math.ceil(-high), math.floor(1.0 - low) + 1)
    phase = np.arange(per_pitch) / per_pitch
    number = np.arange(pitches)[:, None, None] + away
    place = np.broadcast_to((phase[:, None] - away) * pair.pitch, (pitches, per_pitch, away.size))
    first, second = flanks_ahead(pair, number)
    there = (place + first).ravel()
    inside = (there >= followed.phi1[0]) & (there <= followed.phi1[-1])
    advance = np.full(there.shape, -np.inf)
    own_advance = of_pair.at(there[inside])[0]
    advance[inside] = np.where(np.isnan(own_advance), -np.inf, own_advance)
    advance = advance.reshape(place.shape) + pair.drive * (pair.ratio * first - second)
    flat = advance.reshape(-1, away.size)
    leading = flat.argmax(axis=1)
    greatest = flat[np.arange(len(flat)), leading]
    if not np.isfinite(greatest).all():
        raise NoSolutionError(reason="the teeth lose contact, so there is no transmission error over whole turns")
    return greatest, np.repeat(np.arange(pitches), per_pitch) + away[leading]


def flanks_ahead(pair: GearPair, number: NDArray[np.intp]) -> tuple[Array, Array]:
    """Angles (...,), rad, by which the flanks of pinion and gear are ahead of their places, as phi1 and phi2 count: of tooth pairs
    by their numbers, pair k being where pair 0 was k pitches before."""
    first, second = (
        _ahead(member, side)[np.mod(-int(member.mount.sign) * sense * number, member.tooth.teeth)]
        for member, side, sense in zip(pair.both, pair.flanks, (1, int(np.sign(pair.ratio))), strict=True)
    )
    return first, second


def _ahead(member: Member, side: Side) -> Array:
    """Angles (N,), rad, by which flanks are ahead as the member's rotation counts."""
    return member.mount.sign * member.index.of(side, member.tooth.teeth)


def _longer_engagement(flanks: Pair, pitch: float) -> Engagement | None:
    """A tooth pair, followed beyond where it is ahead."""
    known = whole_engagement(flanks, pitch)
    if known is None:
        return None
    first, last = (round(known.phi1[k] / pitch * NODES) for k in (0, -1))
    return follow(flanks, np.arange(first - BEYOND, last + BEYOND + 1) * (pitch / NODES))
