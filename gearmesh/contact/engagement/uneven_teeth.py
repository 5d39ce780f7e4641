"""Places of the teeth of members with pitch deviations.

A flank that is turned about its gear's axis by e has the contact of the nominal flank at a rotation that differs by e, exactly.
te = phi2 - i phi1 is the transmission error of one nominal tooth pair. The flanks of tooth pair k are e1 and e2 ahead, as phi1 and
phi2 count, so its transmission error is

    te_k(phi1) = te(phi1 + e1 - k pitch) + i e1 - e2

A tooth that is r farther from its axis, as a pin that is set into a ring, has the contact of a nominal tooth whose gear is
displaced by r in the direction of the tooth. What the gear lags by that adds to e2.

Pair k of the drive flanks has the gear's tooth k. Coast flanks of the same gear touch other teeth of it: pair k of theirs has the
gear's tooth k + `turned`, where the gear is turned by so many pitches from the contact of flanks of the same number.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.first_touch.first_touch import first_touch
from gearmesh.contact.pair import Pair
from gearmesh.contact.path import ContactPath
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.teeth.gear_train import GearPair, Member
from gearmesh.teeth.region import Side

#: rounds that find the direction of a tooth that is farther out: the first is off by less than a tenth of a degree
DIRECTION_ROUNDS = 2


def flanks_ahead(pair: GearPair, number: NDArray[np.intp], turned: int = 0) -> tuple[Array, Array]:
    """Return angles (...,), rad, by which the flanks of pinion and gear are ahead of their nominal places, as phi1 and phi2 count.

    `number` (...,) counts tooth pairs: pair k stands where pair 0 stood k pitches before. `turned`: pitches of the gear, as phi2
    counts, by which it stands ahead of the contact of pair 0.
    """
    first, second = _of_pairs(pair, number, turned, _index_angles)
    return first, second


def farther_out(pair: GearPair, number: NDArray[np.intp], turned: int = 0) -> tuple[Array, Array]:
    """Return distances (...,), mm, by which the teeth of pinion and gear are farther from their axes.

    Arguments: as for `flanks_ahead`.
    """
    first, second = _of_pairs(pair, number, turned, _outwards)
    return first, second


def farther_out_ahead(gears: GearPair, pair: Pair, path: ContactPath, number: NDArray[np.intp]) -> Array:
    """Return angles (M,), rad, by which the gear's flanks are ahead for teeth that are farther from their axes, as phi2 counts.

    `pair`: flanks of one tooth pair at its nominal place. `path`: its contacts (M,). `number` (M,) counts tooth pairs as
    `flanks_ahead` does. Infinite for teeth that do not touch where they are.
    """
    ahead, outwards = np.zeros(len(path.phi1)), farther_out(gears, number)
    moved = np.flatnonzero(path.touching & np.any([away != 0.0 for away in outwards], axis=0))
    if moved.size:
        turns = [path.rotation[moved], path.phi2[moved]]
        # the direction of the gear's tooth is that where it touches
        for _ in range(DIRECTION_ROUNDS):
            first, second = (
                away[moved, None] * tooth_direction(member, turn)
                for member, turn, away in zip(gears.both, turns, outwards, strict=True)
            )
            contacts = first_touch(displace(pair, first, second), turns[0])
            turns[1] = np.where(contacts.touching, contacts.x[:, 4], turns[1])
        ahead[moved] = np.where(contacts.touching, path.phi2[moved] - turns[1], np.inf)
    return ahead


def displace(pair: Pair, first: Array, second: Array) -> Pair:
    """Return a pair whose pinion and gear are displaced by `first` and `second` (M, 3), mm, at M positions."""
    return replace(
        pair,
        pinion=pair.pinion.remount(pair.pinion.mount.shift(first)),
        gear=pair.gear.remount(pair.gear.mount.shift(second)),
    )


def tooth_direction(member: Member, turn: Array) -> Array:
    """Return the direction (..., 3) from the axis to a tooth at rotations (...,), rad, of its member, fixed frame."""
    return member.mount.at(turn).vector(np.array([1.0, 0.0, 0.0]))


def _of_pairs(
    pair: GearPair, number: NDArray[np.intp], turned: int, values: Callable[[Member, Side], Array]
) -> list[Array]:
    """Return values (N,) of the teeth of pinion and gear for tooth pairs `number` (...,)."""
    sense = int(np.sign(pair.ratio))
    return [
        values(member, side)[np.mod(-int(member.mount.sign) * pitches, member.tooth.teeth)]
        for member, side, pitches in zip(pair.both, pair.flanks, (number, sense * number + turned), strict=True)
    ]


def _outwards(member: Member, side: Side) -> Array:
    return member.index.farther_out(member.tooth.teeth)


def _index_angles(member: Member, side: Side) -> Array:
    """Return angles (N,), rad, by which flanks are ahead, as the member's rotation counts."""
    return member.mount.sign * member.index.of(side, member.tooth.teeth)
