"""A rack without a pinion: defaults by the basic rack alone, the member, and its data sheet.

Its own frame is that of the rack of a pair (`member`). Its coordinate counts as that of the rack on a gear of as many teeth as it
has; such a gear has no other influence.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from gearmesh.systems.common.defaults import unusual_defaults
from gearmesh.systems.common.plain_sheet import plain_sheet
from gearmesh.systems.common.symbol_table import tables_by_title
from gearmesh.systems.cylindrical.design import PROFILES
from gearmesh.systems.cylindrical.geometry.allowances import made_allowance
from gearmesh.systems.cylindrical.geometry.geometry import Toothing
from gearmesh.systems.cylindrical.geometry.nominal import refuse_thin_allowance
from gearmesh.systems.cylindrical.geometry.proportions import still_open
from gearmesh.systems.cylindrical.rack.design import PINION, RACK
from gearmesh.systems.cylindrical.rack.member import RackMesh, rack_member
from gearmesh.systems.cylindrical.rack.proportions import bar_defaults, bar_of, bar_rounding, check_land
from gearmesh.systems.cylindrical.rack.sheet import rack_rows
from gearmesh.systems.system import Sheet, complete_design
from gearmesh.teeth.gear_train import GearTrain
from gearmesh.teeth.mount import Mount

if TYPE_CHECKING:
    from gearmesh.systems.common.pinned import Values
    from gearmesh.systems.cylindrical.rack.design import SingleRackDesign


def proportions(design: SingleRackDesign) -> RackMesh:
    """The rack in closed form, on a gear of as many teeth, which touches its reference plane."""
    # the traces have the other hand than such a gear
    hand = -1.0 if design.hand == "right" else 1.0
    own = Toothing(
        teeth=design.rack_teeth,
        module=design.given_module,
        alpha=math.radians(design.normal_angle),
        beta=hand * math.radians(design.helix_angle),
    )
    bar = replace(bar_of(design), allowance=made_allowance(RACK, design.rack, own))
    return RackMesh(own, bar, math.nan, own.radius)


def derived_values(design: SingleRackDesign) -> dict[str, float]:
    """What the basic rack says of keys that the file leaves out, by dotted key, in the design's units."""
    defaults = bar_defaults(design)
    made = design.fill(defaults)
    return defaults | still_open(made, {f"{RACK}.tool_tip_radius": bar_rounding(made, proportions(made))})


def build(design: SingleRackDesign) -> GearTrain:
    """The rack of a design (in mm), which meshes with no pinion. Raises DesignError for teeth or bars that cannot exist."""
    mesh = proportions(design)
    if mesh.rack_thickness <= 0.0:
        refuse_thin_allowance(RACK, design.rack, mesh.rack_thickness)
    check_land(mesh)
    room = PROFILES[design.profile][2], "the tool's tooth has no room for it"
    warnings = unusual_defaults(design, {f"{RACK}.tool_tip_radius": room})
    bar = rack_member(RACK, mesh.rack, mesh.pinion, design.rack)
    # it slides, and its teeth follow each other along it
    member = replace(bar, mount=Mount(bar.mount.base, joint=bar.tooth.joint))
    return GearTrain(design.kind, (), tuple(warnings), unpaired=(member,), lacking=PINION)


def sheet(design: SingleRackDesign, train: GearTrain) -> Sheet:
    """The sheet of a design and the rack built of it."""
    own = complete_design(design).in_mm()
    derived, plain, *others = plain_sheet(own, train).tables
    rows = tables_by_title({"Rack": ((RACK,), lambda: rack_rows(own, proportions(own), train.members[RACK]))})
    # there are no axes that could lie to each other
    return Sheet((derived, *rows, plain, *others[1:]), {})


def pinned_values(design: SingleRackDesign, train: GearTrain) -> Values:
    """What the rack leaves to its build: its number of teeth and its length."""
    return {
        f"{RACK}.teeth": design.rack_teeth,
        f"{RACK}.length": design.rack_teeth * design.pitch + 2.0 * design.overhang,
    }
