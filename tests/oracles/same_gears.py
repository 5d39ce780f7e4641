"""Comparison of two gear sets to the last digits: points of teeth and bodies, and places of the members."""

from __future__ import annotations

import numpy as np

from gearmesh import GearTrain
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import Region

REGIONS = (
    Region.ROOT,
    Region.FILLET_RIGHT,
    Region.FILLET_LEFT,
    Region.FLANK_RIGHT,
    Region.FLANK_LEFT,
    Region.LAND,
)


def places(train: GearTrain, mounts: bool = True) -> Array:
    """Points (N, 3), mm, of all members in their own frames; with `mounts`, rotations and translations of these at two
    rotations."""
    found = []
    for member in train.members.values():
        sections = member.tooth.sections(np.linspace(0.0, 1.0, 3))
        found += [member.tooth.grid(each, np.linspace(0.0, 1.0, 4), sections).points.reshape(-1, 3) for each in REGIONS]
        found.append(np.array([(rho, z, 0.0) for rho, z in member.plain_body.profile]))
        for half in member.halves[1:]:
            assert half.plane is not None
            found.append(np.array([[half.plane, sum(gap.diameter for gap in member.gaps), 0.0]]))
        features = (member.keyway, member.hub, member.holes)
        found += [
            np.array([[float(x) for x in list(vars(each).values())[:2]] + [0.0]])
            for each in features
            if each is not None
        ]
    for pair in train.pairs if mounts else ():
        for mount in pair.mounts:
            for phi in (0.0, 0.3):
                placed = mount.at(phi)
                found += [placed.rotation, placed.translation[None, :]]
    return np.vstack(found)
