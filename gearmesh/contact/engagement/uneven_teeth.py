"""Places of the teeth of members with pitch deviations.

A flank that is turned about its gear's axis by e has the contact of the nominal flank at a rotation that differs by e, exactly.
te = phi2 - i phi1 is the transmission error of one nominal tooth pair. The flanks of tooth pair k are e1 and e2 ahead, as phi1 and
phi2 count, so its transmission error is

    te_k(phi1) = te(phi1 + e1 - k pitch) + i e1 - e2

A tooth that is r farther from its axis, as a pin that is set into a ring, moves along the normal n at the contact. The gear
follows by an angle at which nothing moves along the normal, to first order in r. With the direction x of the tooth and the
velocity v2 of the gear at a unit rotation, this adds to e2

    r x n / (v2 n)  for teeth of the gear,      -r x n / (v2 n)  for teeth of the pinion

Pair k of the drive flanks has the gear's tooth k. Coast flanks of the same gear touch other teeth of it: pair k of theirs has the
gear's tooth k + `turned`, where the gear is turned by so many pitches from the contact of flanks of the same number.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.path import ContactPath
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.teeth.gear_train import GearPair, Member
from gearmesh.teeth.region import Side


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


def farther_out_ahead(pair: GearPair, path: ContactPath, number: NDArray[np.intp]) -> Array:
    """Return angles (M,), rad, by which the gear's flanks are ahead for teeth that are farther from their axes, as phi2 counts.

    `path`: contacts (M,) of a tooth pair at its nominal place. `number` (M,) counts tooth pairs as `flanks_ahead` does.
    """
    found = np.zeros(len(path.phi1))
    for rate, away in zip(farther_out_rates(pair, path), farther_out(pair, number), strict=True):
        found += rate * away
    return found


def farther_out_rates(pair: GearPair, path: ContactPath) -> list[Array]:
    """Return angles (M,), rad/mm, by which flanks of the gear are ahead for each mm that a tooth of either member is farther
    out; 0 without contact."""
    moved = dot(path.normal, pair.gear.mount.velocity(path.point))
    rates = []
    for member, turn, sense in zip(pair.both, (path.rotation, path.phi2), (-1.0, 1.0), strict=True):
        with np.errstate(divide="ignore", invalid="ignore"):
            rate = sense * dot(path.normal, tooth_direction(member, turn)) / moved
        rates.append(np.where(path.touching, rate, 0.0))
    return rates


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
