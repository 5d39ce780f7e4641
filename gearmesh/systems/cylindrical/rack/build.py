"""A pinion and a rack in mesh, of a design.

Fixed frame: the pinion's own, its axis z, the middle of both faces at z = 0; the rack's teeth point to the axis from x > 0, the bar
lies along y. phi1 turns the pinion clockwise about +z; the rack then slides towards -y.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import rotation_about
from gearmesh.systems.common.defaults import unusual_defaults
from gearmesh.systems.cylindrical.build import THICKER, member_of
from gearmesh.systems.cylindrical.design import PROFILES
from gearmesh.systems.cylindrical.rack.design import PINION, RACK
from gearmesh.systems.cylindrical.rack.member import rack_member, rack_mount, rack_pair
from gearmesh.systems.cylindrical.rack.proportions import RackPairProportions, rack_proportions
from gearmesh.teeth.gear_train import GearTrain
from gearmesh.teeth.mount import Mount
from gearmesh.teeth.region import Side

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.rack.design import RackDesign

#: part of a standard rounding by which a default may differ and is not told of
TOLD = 0.02


def build(design: RackDesign) -> GearTrain:
    """Pinion and rack of a design (in mm).

    Raises DesignError naming key, value and limit: teeth, cutters or bars that cannot exist.
    """
    geometry = rack_proportions(design)
    pinion = member_of(geometry.pair, PINION, geometry.of_pair)
    rack = rack_member(RACK, geometry.mesh.rack, geometry.mesh.pinion, design.rack)
    flank = Side(design.contact.flank)
    mount = rack_mount(geometry.mesh.pinion, geometry.mesh.distance, flank, _errors(design))
    pair = rack_pair(
        replace(pinion, mount=Mount(Rigid.identity(), sign=-1.0)),
        replace(rack, mount=mount),
        flank,
        design.contact.delta,
    )
    return GearTrain(design.kind, (pair,), _warnings(design, geometry))


def _errors(design: RackDesign) -> Rigid:
    """The rack and its guide moved in the fixed frame, and then tilted."""
    errors = design.assembly
    tilt = rotation_about("x", -np.radians(errors.gamma_h)) @ rotation_about("y", np.radians(errors.gamma_v))
    return Rigid(tilt, np.array([errors.dx, 0.0, errors.dz]))


def _warnings(design: RackDesign, geometry: RackPairProportions) -> tuple[str, ...]:
    """Warnings about a design: adapted defaults, teeth thicker than nominal."""
    why = "the tool's tooth has no room for it, or the mating tip needs the flank"
    standard = PROFILES[design.profile][2]
    values = {f"{name}.tool_tip_radius": getattr(design, name).tool_tip_radius for name in (PINION, RACK)}
    far = {key: (standard, why) for key, value in values.items() if abs(value - standard) > TOLD * standard}
    return (*unusual_defaults(design, far), *_thickness_warnings(geometry))


def _thickness_warnings(geometry: RackPairProportions) -> tuple[str, ...]:
    """A warning of teeth that the given backlash makes thicker than nominal."""
    nominal, more = geometry.nominal, geometry.mesh.pinion.allowance
    if more <= THICKER * nominal.pinion.module or more != geometry.mesh.rack.allowance:
        return ()
    tight = nominal.mounting_distance - nominal.radial_backlash
    shift = nominal.pinion.shift + nominal.radial_backlash / nominal.pinion.module
    return (
        f"teeth are {more:.4g} mm thicker than nominal, for the given backlash: with this profile shift the mounting distance "
        f"without backlash is {tight:.7g} mm; for {nominal.mounting_distance:.7g} mm the profile shift must be {shift:.4g}",
    )
