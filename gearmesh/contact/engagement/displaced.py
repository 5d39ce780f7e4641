"""Eccentric members that stay displaced as at phi1 = 0: a pair with one mesh cycle in every pitch.

The tooth pairs of eccentric members differ, because the displacement of the teeth turns from pitch to pitch. Members that keep the
displacement of phi1 = 0 and turn about the displaced axes have the same cycle in every pitch. Reports per mesh cycle of an
eccentric pair describe these members; `turns` follows all tooth pairs over whole turns.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearmesh.contact.first_touch.first_touch import first_touch
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.pair import Pair
from gearmesh.teeth.gear_train import GearPair, Member
from gearmesh.teeth.mount import Mount

#: eccentricity of a concentric member
NO_ECCENTRICITY = (0.0, 0.0)


def displaced_pair(pair: Pair) -> Pair:
    """Return the pair with its members displaced as at phi1 = 0; the same pair if no member is eccentric."""
    if all(flank.mount.eccentricity == NO_ECCENTRICITY for flank in pair.flanks):
        return pair
    first, second = _mounts(pair)
    return replace(pair, pinion=pair.pinion.remount(first), gear=pair.gear.remount(second))


def displaced_gears(pair: GearPair) -> GearPair:
    """Return the gears with their teeth displaced as at phi1 = 0; the same gears if no member is eccentric."""
    if not pair.eccentric:
        return pair

    def at(member: Member, mount: Mount) -> Member:
        return replace(member, mount=mount)

    first, second = _mounts(solver_pair(pair))
    return replace(pair, pinion=at(pair.pinion, first), gear=at(pair.gear, second))


def _mounts(pair: Pair) -> tuple[Mount, Mount]:
    """Return the mounts of pinion and gear, displaced as at phi1 = 0."""
    first, second = pair.pinion.mount, pair.gear.mount
    return first.displace(0.0), second.displace(_gear_rotation(pair))


def _gear_rotation(pair: Pair) -> float:
    """Return phi2 (rad) at phi1 = 0: of the eccentric teeth, or of concentric teeth where the eccentric teeth do not meet."""
    mounts = [flank.mount.concentric for flank in pair.flanks]
    centred = replace(pair, pinion=pair.pinion.remount(mounts[0]), gear=pair.gear.remount(mounts[1]))
    for own in (pair, centred):
        contacts = first_touch(own, np.zeros(1))
        if contacts.touching[0]:
            return float(contacts.x[0, 4])
    return 0.0
