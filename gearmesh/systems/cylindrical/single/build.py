"""One cylindrical gear without a mating gear [ISO 21771].

The fixed frame is the gear's own. Its axis is z, and the middle of the face is at z = 0. A tooth is on +x, for external
and internal gears alike.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError
from gearmesh.systems.common.defaults import unusual_defaults
from gearmesh.systems.cylindrical.build import gear_member, own_end, standard_rounding
from gearmesh.systems.cylindrical.cutting.cutter import cut_addendum, other_cutters, trimming_warnings
from gearmesh.systems.cylindrical.design import BASIC_RACKS
from gearmesh.systems.cylindrical.double_helical import double_helical_member, first_halves
from gearmesh.systems.cylindrical.geometry.allowances import made_allowance
from gearmesh.systems.cylindrical.geometry.nominal import ToothedGear, driving_side, refuse_thin_allowance, teeth_of
from gearmesh.systems.cylindrical.geometry.proportions import (
    GearProportions,
    gear_proportions,
    still_open,
    tool_rounding,
)
from gearmesh.teeth.gear_train import GearTrain

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.single.design import SingleGearDesign

#: note that the finite-element model of a double helical gear has one half
HALF_NOTE = "double helical: finite elements are for one half, and the other half is its mirror image"


def single_gear(design: SingleGearDesign) -> ToothedGear:
    """Return the teeth of the gear, with the allowance as made."""
    table, spec = design.member_name, design.spec
    name = design.name_in_texts(table)
    drive = driving_side(table, inside=spec.internal)
    own = teeth_of(design, spec, allowance=made_allowance(name, spec, teeth_of(design, spec)), drive=drive)
    return ToothedGear(table, name, spec, own, design.profile)


def derived_values(design: SingleGearDesign) -> dict[str, float]:
    """Return the values that the basic rack gives to keys left out in the file, by dotted key, in the design's units.

    Raises DesignError for cutters that cannot exist.
    """
    name = design.member_name
    defaults = still_open(design, {f"{name}.profile_shift": 0.0, f"{name}.tip_alteration": 0.0})
    gear = single_gear(design.fill(defaults))
    defaults |= still_open(design, {f"{name}.addendum": cut_addendum(gear, BASIC_RACKS[design.profile][0])})
    rounding = tool_rounding(single_gear(design.fill(defaults)))
    return defaults | still_open(design, {f"{name}.tool_tip_radius": rounding})


def proportions(design: SingleGearDesign) -> GearProportions:
    """Return teeth, tip and root of a complete design; for a double helical gear of its first half."""
    return gear_proportions(single_gear(first_halves(design)))


def build(design: SingleGearDesign) -> GearTrain:
    """Return the gear of a design (in mm), which meshes with no other gear.

    Raises DesignError naming key, value and limit: teeth or cutters that cannot exist.
    """
    gear = proportions(design)
    _refuse_thin(gear)
    member = gear_member(gear)
    if design.double_helical:
        member = double_helical_member(design, member, gear)
    lacking = "gear" if gear.name == "pinion" else "pinion"
    return GearTrain(design.kind, (), _warnings(design, gear), unpaired=(member,), lacking=lacking)


def _refuse_thin(gear: GearProportions) -> None:
    """Refuse a thickness allowance or a profile shift that leaves no tooth."""
    own = gear.own
    if own.thickness > 0.0:
        return
    refuse_thin_allowance(gear.name, gear.spec, own.thickness)
    raise DesignError(
        f"{gear.name}.profile_shift",
        own.shift,
        reason="leaves no tooth",
        allowed=Allowed.more_than(-0.5 * math.pi / own.both_tangents),
    )


def _warnings(design: SingleGearDesign, gear: GearProportions) -> tuple[str, ...]:
    """Return the warnings of a design: adapted defaults, cutters."""
    standard = standard_rounding(gear)
    if gear.own.internal and gear.spec.tip_diameter is None:
        standard[f"{gear.name}.addendum"] = (BASIC_RACKS[design.profile][0], own_end(gear.spec))
    notes = (HALF_NOTE,) if design.double_helical else ()
    return (*unusual_defaults(design, standard), *other_cutters((gear,)), *trimming_warnings((gear,)), *notes)
