"""Values that designs of pinion and rack leave to their build."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearmesh.systems.cylindrical.pinned import member_values
from gearmesh.systems.cylindrical.rack.design import PINION_NAME, RACK_NAME
from gearmesh.systems.cylindrical.rack.proportions import rack_proportions

if TYPE_CHECKING:
    from gearmesh.systems.common.pinned import Values
    from gearmesh.systems.cylindrical.rack.design import RackDesign
    from gearmesh.teeth.gear_train import GearTrain


def rack_values(design: RackDesign, train: GearTrain) -> Values:
    """Return the values for a complete design in mm and the gear set built from it."""
    geometry = rack_proportions(design)
    return {
        "assembly.mounting_distance": geometry.mesh.mounting_distance,
        f"{RACK_NAME}.teeth": design.rack_teeth,
        f"{RACK_NAME}.length": design.rack_teeth * design.pitch + 2.0 * design.overhang,
        **member_values(geometry.of_pair.gear("pinion"), PINION_NAME, train.members[PINION_NAME]),
    }
