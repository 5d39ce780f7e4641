"""Values that planetary sets leave to their build."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearmesh.systems.cylindrical.geometry.proportions import proportions
from gearmesh.systems.cylindrical.pinned import member_values
from gearmesh.systems.cylindrical.planetary.build import meshes
from gearmesh.systems.cylindrical.planetary.design import PLANET_NAME, RING_NAME, SUN_NAME

if TYPE_CHECKING:
    from gearmesh.systems.common.pinned import Values
    from gearmesh.systems.cylindrical.planetary.design import PlanetaryDesign
    from gearmesh.teeth.gear_train import GearTrain


def planetary_values(design: PlanetaryDesign, train: GearTrain) -> Values:
    """Return the values for a complete design in mm and the gear set built from it."""
    both = meshes(design)
    inner, outer = proportions(both.inner), proportions(both.outer)
    values: Values = {
        "arrangement": design.arrangement,
        "assembly.center_distance": inner.mesh.distance,
        "assembly.planet_angles": ", ".join(repr(angle) for angle in design.angles),
    }
    for gear, name, member in (
        (inner.gear("pinion"), SUN_NAME, SUN_NAME),
        (inner.gear("gear"), PLANET_NAME, f"{PLANET_NAME}_1"),
        (outer.gear("gear"), RING_NAME, RING_NAME),
    ):
        values |= member_values(gear, name, train.members[member])
    return values
