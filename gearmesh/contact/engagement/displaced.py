"""Eccentric members that stay displaced as at phi1 = 0: a pair whose tooth pairs are all alike, which has a mesh cycle.

No two tooth pairs of eccentric members are alike: the displacement of the teeth turns on from pitch to pitch. Displaced by as much
as at phi1 = 0, and turning without eccentricity there, the same members have one cycle in every pitch. That is what is reported
per mesh cycle of an eccentric pair; all tooth pairs as they are take whole turns (`turns`).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearmesh.contact.first_touch.first_touch import first_touch
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.pair import Pair
from gearmesh.teeth.gear_train import GearPair, Member
from gearmesh.teeth.mount import Mount

#: an eccentricity that is none
CONCENTRIC = (0.0, 0.0)


def displaced_pair(pair: Pair) -> Pair:
    """The pair with its members displaced as at phi1 = 0; itself where neither is eccentric."""
    if all(flank.mount.eccentricity == CONCENTRIC for flank in pair.flanks):
        return pair
    first, second = _mounts(pair)
    return replace(pair, pinion=pair.pinion.remount(first), gear=pair.gear.remount(second))


def displaced_gears(pair: GearPair) -> GearPair:
    """The gears with their teeth displaced as at phi1 = 0; themselves where neither is eccentric."""
    if not pair.eccentric:
        return pair

    def at(member: Member, mount: Mount) -> Member:
        return replace(member, mount=mount)

    first, second = _mounts(solver_pair(pair))
    return replace(pair, pinion=at(pair.pinion, first), gear=at(pair.gear, second))


def _mounts(pair: Pair) -> tuple[Mount, Mount]:
    """Both mounts, displaced as at phi1 = 0."""
    first, second = pair.pinion.mount, pair.gear.mount
    return first.displace(0.0), second.displace(_gear_rotation(pair))


def _gear_rotation(pair: Pair) -> float:
    """phi2, rad, at phi1 = 0: of the teeth as they are, or, where they do not meet there, without eccentricity."""
    mounts = [flank.mount.concentric for flank in pair.flanks]
    centred = replace(pair, pinion=pair.pinion.remount(mounts[0]), gear=pair.gear.remount(mounts[1]))
    for own in (pair, centred):
        contacts = first_touch(own, np.zeros(1))
        if contacts.touching[0]:
            return float(contacts.x[0, 4])
    return 0.0
