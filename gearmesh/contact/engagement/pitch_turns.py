"""Transmission error of a pair with pitch deviations over whole turns: one tooth pair, followed beyond its engagement.

All tooth pairs have the contact of this one, shifted as `uneven_teeth` derives it. The gears have the error of the most advanced
tooth pair, edge contact included. Teeth that are farther from their axes are displaced, and solved for one by one as those of
eccentric members are.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.engagement.engagement import NODES_PER_PITCH as NODES
from gearmesh.contact.engagement.engagement import Engagement, follow, whole_engagement
from gearmesh.contact.engagement.transmission_advance import TransmissionAdvance
from gearmesh.contact.engagement.turns import (
    FullTurns,
    displaced_advances,
    full_turns,
    gear_turned,
    turns_from,
    turns_of,
)
from gearmesh.contact.engagement.uneven_teeth import flanks_ahead
from gearmesh.contact.fit.fit import reversed_pair
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.pair import Pair
from gearmesh.errors import NoSolutionError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.progress import in_turn
from gearmesh.teeth.gear_train import GearPair

#: nodes by which a tooth pair is followed beyond its engagement without pitch deviations
NODES_BEYOND = NODES // 2


def whole_turns(pair: GearPair) -> FullTurns:
    """Compute the transmission error of a pair with eccentricities or pitch deviations until it repeats.

    Raises DesignError where the turns are too many, NoSolutionError where the teeth lose contact.
    """
    return full_turns(pair) if pair.eccentric else pitch_turns(pair)


def pitch_turns(pair: GearPair) -> FullTurns:
    """Compute the transmission error of a pair of concentric gears (no rack) with pitch deviations until it repeats.

    Raises as `whole_turns`.
    """
    pitches, per_pitch = turns_of(pair)
    forwards, backwards, carrier = shifted_advances(pair, pitches, per_pitch)
    return turns_from(pair, (forwards, backwards), carrier, per_pitch, closed=False)


def shifted_advances(pair: GearPair, pitches: int, per_pitch: int) -> tuple[Array, Array, NDArray[np.intp]]:
    """Compute transmission advances (P,), rad, of driving and coast flanks over `pitches`, and the tooth pairs (P,) that drive.

    Coast flanks are the driving flanks of the reversed pair; the sum of both advances is the play. Raises NoSolutionError where the
    teeth lose contact.
    """
    if any(member.index.outwards for member in pair.both):
        return displaced_advances(pair, pitches, per_pitch)
    both = (pair, reversed_pair(pair))
    first, second = (_longer_engagement(solver_pair(own), own.pitch) for own in both)
    shifts = (0, gear_turned(pair, first, second))
    (forwards, carrier), (backwards, _) = (
        _shifted_advance(own, followed, pitches, per_pitch, turned)
        for own, followed, turned in in_turn(zip(both, (first, second), shifts, strict=True))
    )
    return forwards, backwards, carrier


def _shifted_advance(
    pair: GearPair, followed: Engagement, pitches: int, per_pitch: int, turned: int
) -> tuple[Array, NDArray[np.intp]]:
    """Compute advances (P,), rad, over `pitches`, and the numbers (P,) of the tooth pairs in contact.

    `turned`: as for `flanks_ahead`.
    """
    of_pair = TransmissionAdvance(followed)
    low, high = (followed.phi1[k] / pair.pitch for k in (0, -1))
    # tooth pairs `number` near each pitch, and their `place` (rad) in the engagement of pair 0
    away = np.arange(math.ceil(-high), math.floor(1.0 - low) + 1)
    phase = np.arange(per_pitch) / per_pitch
    number = np.arange(pitches)[:, None, None] + away
    place = np.broadcast_to((phase[:, None] - away) * pair.pitch, (pitches, per_pitch, away.size))
    # te_k(phi1) of `uneven_teeth`, as advances; the most advanced pair is in contact
    first, second = flanks_ahead(pair, number, turned)
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


def _longer_engagement(flanks: Pair, pitch: float) -> Engagement:
    """Follow a tooth pair beyond its engagement. Raises NoSolutionError where the teeth never meet."""
    known = whole_engagement(flanks, pitch)
    first, last = (round(known.phi1[k] / pitch * NODES) for k in (0, -1)) if known is not None else (0, 0)
    places = np.arange(first - NODES_BEYOND, last + NODES_BEYOND + 1) * (pitch / NODES)
    followed = None if known is None else follow(flanks, places)
    if followed is None:
        raise NoSolutionError(reason="the teeth never touch, so there is no transmission error over whole turns")
    return followed
