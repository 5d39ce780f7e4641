"""A pinion and a rack in mesh.

The fixed frame is the pinion's own: its axis is z, and the middle of both faces is at z = 0. The rack's teeth point
from x > 0 to the axis, and the bar lies along y. phi1 turns the pinion clockwise about +z; the rack then slides towards
-y.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import rotation_about
from gearmesh.systems.common.defaults import unusual_defaults
from gearmesh.systems.cylindrical.build import MIN_WARNED_ALLOWANCE, member_of
from gearmesh.systems.cylindrical.design import BASIC_RACKS
from gearmesh.systems.cylindrical.double_helical import (
    HALF_NOTE,
    double_helical_bar,
    double_helical_member,
    half_of,
)
from gearmesh.systems.cylindrical.rack.design import PINION_NAME, RACK_NAME
from gearmesh.systems.cylindrical.rack.member import rack_member, rack_mount, rack_pair, with_bolts
from gearmesh.systems.cylindrical.rack.proportions import RackPairProportions, rack_proportions
from gearmesh.teeth.gear_train import GearTrain
from gearmesh.teeth.mount import Mount
from gearmesh.teeth.region import Side

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.rack.design import RackDesign

#: relative difference between a default and the standard rounding from which on a warning is given
MIN_WARNED_CHANGE = 0.02


def build(design: RackDesign) -> GearTrain:
    """Return pinion and rack of a design (in mm).

    Raises DesignError naming key, value and limit: teeth, cutters or bars that cannot exist.
    """
    whole, design = design, half_of(design)
    geometry = rack_proportions(design)
    pinion = member_of(geometry.pair, PINION_NAME, geometry.of_pair)
    rack = rack_member(RACK_NAME, geometry.mesh.rack, geometry.mesh.pinion, design.rack)
    if whole.double_helical:
        pinion = double_helical_member(whole, pinion, geometry.of_pair.gear(PINION_NAME))
        rack = double_helical_bar(whole, rack)
    rack = with_bolts(rack, whole.rack)
    flank = Side(design.contact.flank)
    mount = rack_mount(geometry.mesh.pinion, geometry.mesh.distance, flank, _errors(design))
    pair = rack_pair(
        replace(pinion, mount=Mount(Rigid.identity(), sign=-1.0)),
        replace(rack, mount=mount),
        flank,
        design.contact.delta,
    )
    notes = (HALF_NOTE,) if whole.double_helical else ()
    return GearTrain(design.kind, (pair,), (*_warnings(design, geometry), *notes))


def _errors(design: RackDesign) -> Rigid:
    """Return the displacement of rack and guide in the fixed frame: a translation after a tilt."""
    errors = design.assembly
    tilt = rotation_about("x", -np.radians(errors.gamma_h)) @ rotation_about("y", np.radians(errors.gamma_v))
    return Rigid(tilt, np.array([errors.dx, 0.0, errors.dz]))


def _warnings(design: RackDesign, geometry: RackPairProportions) -> tuple[str, ...]:
    """Return the warnings of a design: adapted defaults, teeth thicker than nominal."""
    why = "the tool's tooth has no room for it, or the mating tip needs the flank"
    standard = BASIC_RACKS[design.profile][2]
    values = {f"{name}.tool_tip_radius": getattr(design, name).tool_tip_radius for name in (PINION_NAME, RACK_NAME)}
    unusual = {
        key: (standard, why) for key, value in values.items() if abs(value - standard) > MIN_WARNED_CHANGE * standard
    }
    return (*unusual_defaults(design, unusual), *_thickness_warnings(geometry))


def _thickness_warnings(geometry: RackPairProportions) -> tuple[str, ...]:
    """Return the warning of teeth that the given backlash makes thicker than nominal."""
    nominal, allowance = geometry.nominal, geometry.mesh.pinion.allowance
    if allowance <= MIN_WARNED_ALLOWANCE * nominal.pinion.module or allowance != geometry.mesh.rack.allowance:
        return ()
    tight_distance = nominal.mounting_distance - nominal.radial_backlash
    shift = nominal.pinion.shift + nominal.radial_backlash / nominal.pinion.module
    return (
        f"teeth are {allowance:.4g} mm thicker than nominal, for the given backlash: with this profile shift "
        f"the mounting distance without backlash is {tight_distance:.7g} mm; "
        f"for {nominal.mounting_distance:.7g} mm the profile shift must be {shift:.4g}",
    )
