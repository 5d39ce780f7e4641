"""Values that cylindrical gears leave to their build: cutters, rims, gaps, angles of hobs, centre distance.

Pairs, single gears, pinion and rack, and planetary sets pin the values of their members alike.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gearmesh.systems.cylindrical.cutting.cutter import cutter_of
from gearmesh.systems.cylindrical.cutting.hobbed import DEFAULT_CHAMFER_ANGLE_DEG
from gearmesh.systems.cylindrical.cutting.run_out import runs_out, tool_radius
from gearmesh.systems.cylindrical.double_helical import gap_heights, half_of
from gearmesh.systems.cylindrical.geometry.nominal import MEMBER_NAMES
from gearmesh.systems.cylindrical.geometry.proportions import proportions
from gearmesh.systems.cylindrical.planetary.build import meshes
from gearmesh.systems.cylindrical.planetary.design import PLANET_NAME, RING_NAME, SUN_NAME
from gearmesh.systems.cylindrical.rack.design import PINION_NAME, RACK_NAME
from gearmesh.systems.cylindrical.rack.proportions import rack_proportions
from gearmesh.systems.cylindrical.single.build import proportions as single_proportions

if TYPE_CHECKING:
    from gearmesh.systems.common.pinned import Values
    from gearmesh.systems.cylindrical.design import CylindricalDesign
    from gearmesh.systems.cylindrical.geometry.proportions import GearProportions
    from gearmesh.systems.cylindrical.planetary.design import PlanetaryDesign
    from gearmesh.systems.cylindrical.rack.design import RackDesign
    from gearmesh.systems.cylindrical.single.design import SingleGearDesign
    from gearmesh.teeth.gear_train import GearTrain, Member


def pair_values(design: CylindricalDesign, train: GearTrain) -> Values:
    """Return the values for a complete design in mm and the gear set built from it."""
    own = half_of(design)
    pair = proportions(own)
    values: Values = {"arrangement": design.arrangement, "assembly.center_distance": pair.mesh.distance}
    for name in MEMBER_NAMES:
        values |= member_values(pair.gear(name), name, train.members[name])
    return values


def member_values(gear: GearProportions, called: str, member: Member) -> Values:
    """Return the values of one gear, under the name `called` of its table.

    They are the diameter of the gap, the cutter's teeth and shift, the rim of an internal gear, and the hob's angles.
    """
    spec, values = gear.spec, dict[str, float]()
    if member.gaps:
        values["gap_diameter"] = member.gaps[0].diameter
    if spec.shaped:
        cutter = cutter_of(gear)
        values |= {"shaper.teeth": cutter.teeth, "shaper.profile_shift": cutter.shift}
    if spec.internal:
        values["rim"] = member.tooth.blank.body.profile[0][0] - gear.root
    if spec.hobbed and runs_out(gear):
        values["run_out_radius"] = tool_radius(gear)
    # asymmetric teeth have another default on each side, which one value cannot say
    same = not gear.own.asymmetric
    if same and spec.hob is not None and spec.hob.protuberance and spec.hob.protuberance_angle is None:
        values["hob.protuberance_angle"] = math.degrees(0.5 * gear.own.alpha)
    if spec.hob is not None and spec.hob.chamfer_diameter is not None and spec.hob.chamfer_angle is None:
        values["hob.chamfer_angle"] = DEFAULT_CHAMFER_ANGLE_DEG
    return {f"{called}.{key}": value for key, value in values.items()}


def single_values(design: SingleGearDesign, train: GearTrain) -> Values:
    """Return the values for a complete design in mm and the gear built from it."""
    name = design.member_name
    return {"arrangement": design.arrangement, **member_values(single_proportions(design), name, train.members[name])}


def rack_values(design: RackDesign, train: GearTrain) -> Values:
    """Return the values for a complete design in mm and the gear set built from it."""
    geometry = rack_proportions(half_of(design))
    return {
        "arrangement": design.arrangement,
        **{f"{RACK_NAME}.gap_height": height for height in gap_heights(train.members[RACK_NAME])},
        "assembly.mounting_distance": geometry.mesh.mounting_distance,
        f"{RACK_NAME}.teeth": design.rack_teeth,
        f"{RACK_NAME}.length": design.rack_teeth * design.pitch + 2.0 * design.overhang,
        **member_values(geometry.of_pair.gear("pinion"), PINION_NAME, train.members[PINION_NAME]),
    }


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
