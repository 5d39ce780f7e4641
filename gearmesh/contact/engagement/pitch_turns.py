"""Transmission error of a pair with pitch deviations over whole turns.

A flank that is turned about its gear's axis by e has the contact of the nominal flank at a rotation that differs by e, exactly.
te = phi2 - i phi1 is the transmission error of one nominal tooth pair. The flanks of tooth pair k are e1 and e2 ahead, as phi1 and
phi2 count, so its transmission error is

    te_k(phi1) = te(phi1 + e1 - k pitch) + i e1 - e2

A tooth that is r farther from its axis, as a pin that is set into a ring, moves along the normal n at the contact. The gear
follows by an angle at which nothing moves along the normal, to first order in r. With the direction x of the tooth and the
velocity v2 of the gear at a unit rotation, this adds to e2

    r x n / (v2 n)  for teeth of the gear,      -r x n / (v2 n)  for teeth of the pinion

The gears have the error of the most advanced tooth pair, edge contact included.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.engagement.engagement import NODES_PER_PITCH as NODES
from gearmesh.contact.engagement.engagement import Engagement, follow, whole_engagement
from gearmesh.contact.engagement.transmission_advance import TransmissionAdvance
from gearmesh.contact.engagement.turns import (
    MAX_PITCHES,
    MAX_POSITIONS,
    MIN_POSITIONS_PER_PITCH,
    POSITIONS_PER_PITCH,
    FullTurns,
    full_turns,
    pitches_until_repeat,
    waves_of_turns,
)
from gearmesh.contact.fit.fit import play, reversed_pair
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.pair import Pair
from gearmesh.contact.path import ContactPath
from gearmesh.contact.tca import contact_path
from gearmesh.errors import DesignError, NoSolutionError
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.progress import in_turn
from gearmesh.teeth.gear_train import GearPair, Member
from gearmesh.teeth.region import Side

#: nodes by which a tooth pair is followed beyond its engagement without pitch deviations
NODES_BEYOND = NODES // 2


def whole_turns(pair: GearPair) -> FullTurns:
    """Compute the transmission error of a pair with eccentricities or pitch deviations until it repeats.

    Raises as `full_turns` and `pitch_turns`.
    """
    return pitch_turns(pair) if pair.uneven else full_turns(pair)


def pitch_turns(pair: GearPair) -> FullTurns:
    """Compute the transmission error of a pair of gears (no rack) with pitch deviations until it repeats.

    Raises DesignError where the turns are too many or a member is eccentric too, NoSolutionError where the teeth lose contact.
    """
    refuse_too_many(pair)
    pitches = pitches_until_repeat(pair)
    per_pitch = max(MIN_POSITIONS_PER_PITCH, min(POSITIONS_PER_PITCH, MAX_POSITIONS // pitches))
    # the drive flanks forwards, and the coast flanks as the drive flanks of the reversed pair: their sum is the backlash
    (forwards, carrier), (backwards, _) = (
        shifted_advance(own, pitches, per_pitch) for own in in_turn((pair, reversed_pair(pair)))
    )
    te, phi1 = pair.drive * forwards, np.arange(pitches * per_pitch, dtype=float) * (pair.pitch / per_pitch)
    # closed forms hold for eccentric members alone
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
    """Raise DesignError if a member is eccentric or the turns are too many."""
    if pair.eccentric:
        raise DesignError(
            "assembly",
            reason="members with pitch deviations cannot have eccentricities too",
            remedy="pitch deviations that were measured about the axis of rotation contain them: leave the eccentricities out",
        )
    pitches = pitches_until_repeat(pair)
    if pitches > MAX_PITCHES:
        raise DesignError(
            "teeth",
            (pair.pinion.tooth.teeth, pair.gear.tooth.teeth),
            reason=f"the pattern of both members' pitch deviations repeats after {pitches} teeth",
            allowed=f"up to {MAX_PITCHES}; deviations of one member alone need fewer",
        )


def shifted_advance(pair: GearPair, pitches: int, per_pitch: int) -> tuple[Array, NDArray[np.intp]]:
    """Compute transmission advances (P,), rad, of the gears over `pitches`, and the numbers (P,) of the tooth pairs in contact."""
    flanks = solver_pair(pair)
    followed = _longer_engagement(flanks, pair.pitch)
    if followed is None:
        raise NoSolutionError(reason="the teeth never touch, so there is no transmission error over whole turns")
    of_pair = TransmissionAdvance(followed)
    low, high = (followed.phi1[k] / pair.pitch for k in (0, -1))
    # tooth pairs `number` near each pitch, and their `place` (rad) in the engagement of pair 0
    away = np.arange(math.ceil(-high), math.floor(1.0 - low) + 1)
    phase = np.arange(per_pitch) / per_pitch
    number = np.arange(pitches)[:, None, None] + away
    place = np.broadcast_to((phase[:, None] - away) * pair.pitch, (pitches, per_pitch, away.size))
    # te_k(phi1) of the module's head, as advances; the most advanced pair is in contact
    first, second = flanks_ahead(pair, number)
    there = (place + first).ravel()
    inside = (there >= followed.phi1[0]) & (there <= followed.phi1[-1])
    if any(member.index.outwards for member in pair.both):
        second = second + _farther_out_by_place(pair, followed, number, place + first)
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
    """Return angles (...,), rad, by which the flanks of pinion and gear are ahead of their nominal places, as phi1 and phi2 count.

    `number` (...,) counts tooth pairs: pair k stands where pair 0 stood k pitches before.
    """
    first, second = _of_pairs(pair, number, _index_angles)
    return first, second


def _of_pairs(pair: GearPair, number: NDArray[np.intp], values: Callable[[Member, Side], Array]) -> list[Array]:
    """Return values (N,) of the teeth of pinion and gear for tooth pairs `number` (...,)."""
    return [
        values(member, side)[np.mod(-int(member.mount.sign) * sense * number, member.tooth.teeth)]
        for member, side, sense in zip(pair.both, pair.flanks, (1, int(np.sign(pair.ratio))), strict=True)
    ]


def farther_out_ahead(pair: GearPair, path: ContactPath, number: NDArray[np.intp]) -> Array:
    """Return angles (M,), rad, by which the gear's flanks are ahead for teeth that are farther from their axes, as phi2 counts.

    `path`: contacts (M,) of a tooth pair at its nominal place. `number` (M,) counts tooth pairs as `flanks_ahead` does.
    """
    found = np.zeros(len(path.phi1))
    for rate, away in zip(_farther_out_rates(pair, path), _of_pairs(pair, number, _farther_out), strict=True):
        found += rate * away
    return found


def _farther_out_rates(pair: GearPair, path: ContactPath) -> list[Array]:
    """Return angles (M,), rad/mm, by which flanks of the gear are ahead for each mm that a tooth of either member is farther
    out; 0 without contact."""
    moved = dot(path.normal, pair.gear.mount.velocity(path.point))
    rates = []
    for member, turn, sense in zip(pair.both, (path.rotation, path.phi2), (-1.0, 1.0), strict=True):
        x = member.mount.at(turn).vector(np.array([1.0, 0.0, 0.0]))
        with np.errstate(divide="ignore", invalid="ignore"):
            rates.append(np.where(path.touching, sense * dot(path.normal, x) / moved, 0.0))
    return rates


def _farther_out_by_place(pair: GearPair, followed: Engagement, number: NDArray[np.intp], place: Array) -> Array:
    """Return the angles of `farther_out_ahead` of tooth pairs `number` (...,) at rotations `place` (...,), rad, of pair 0."""
    from scipy.interpolate import CubicSpline

    nodes = followed.phi1
    path = contact_path(solver_pair(pair), nodes)
    found = np.zeros(np.broadcast_shapes(number.shape, place.shape))
    for rate, away in zip(_farther_out_rates(pair, path), _of_pairs(pair, number, _farther_out), strict=True):
        found += CubicSpline(nodes[path.touching], rate[path.touching])(place) * away
    return found


def _farther_out(member: Member, side: Side) -> Array:
    return member.index.farther_out(member.tooth.teeth)


def _index_angles(member: Member, side: Side) -> Array:
    """Return angles (N,), rad, by which flanks are ahead, as the member's rotation counts."""
    return member.mount.sign * member.index.of(side, member.tooth.teeth)


def _longer_engagement(flanks: Pair, pitch: float) -> Engagement | None:
    """Follow a tooth pair beyond its engagement; None where the teeth never meet."""
    known = whole_engagement(flanks, pitch)
    if known is None:
        return None
    first, last = (round(known.phi1[k] / pitch * NODES) for k in (0, -1))
    return follow(flanks, np.arange(first - NODES_BEYOND, last + NODES_BEYOND + 1) * (pitch / NODES))
