"""A rack without a pinion: defaults of the basic rack, the member, and its data sheet.

Its own frame is that of a rack in a pair (`member`). Its coordinate counts as if the rack meshed with a gear of equal
tooth number. This gear has no other influence.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from gearmesh.systems.common.defaults import unusual_defaults
from gearmesh.systems.common.plain_sheet import plain_sheet
from gearmesh.systems.common.symbol_table import tables_by_title
from gearmesh.systems.cylindrical.design import BASIC_RACKS
from gearmesh.systems.cylindrical.double_helical import double_helical_bar, first_halves, gap_heights
from gearmesh.systems.cylindrical.geometry.allowances import made_allowance
from gearmesh.systems.cylindrical.geometry.geometry import Toothing
from gearmesh.systems.cylindrical.geometry.nominal import refuse_thin_allowance
from gearmesh.systems.cylindrical.geometry.proportions import still_open
from gearmesh.systems.cylindrical.rack.design import PINION_NAME, RACK_NAME
from gearmesh.systems.cylindrical.rack.member import RackMesh, rack_member, with_bolts
from gearmesh.systems.cylindrical.rack.proportions import bar_defaults, bar_of, bar_rounding, check_land
from gearmesh.systems.cylindrical.rack.sheet import rack_rows
from gearmesh.systems.cylindrical.sheet import half_tables
from gearmesh.systems.cylindrical.single.build import HALF_NOTE
from gearmesh.systems.system import Sheet, complete_design
from gearmesh.teeth.gear_train import GearTrain
from gearmesh.teeth.mount import Mount

if TYPE_CHECKING:
    from gearmesh.systems.common.pinned import Values
    from gearmesh.systems.cylindrical.rack.design import SingleRackDesign


def proportions(design: SingleRackDesign) -> RackMesh:
    """Return the rack in closed form, on a gear of equal tooth number that touches its reference plane."""
    # the rack's traces have the hand opposite to the gear's
    design = first_halves(design)
    hand = -1.0 if design.hand == "right" else 1.0
    own = Toothing(
        teeth=design.rack_teeth,
        module=design.given_module,
        alpha=math.radians(design.normal_angle),
        beta=hand * math.radians(design.helix_angle),
        coast_alpha=None if design.coast_angle is None else math.radians(design.coast_angle),
    )
    bar = replace(bar_of(design), allowance=made_allowance(RACK_NAME, design.rack, own))
    return RackMesh(own, bar, math.nan, own.radius)


def derived_values(design: SingleRackDesign) -> dict[str, float]:
    """Return the values of keys left out in the file that follow from the basic rack, by dotted key.

    Values are in the design's units.
    """
    defaults = bar_defaults(design)
    made = design.fill(defaults)
    return defaults | still_open(made, {f"{RACK_NAME}.tool_tip_radius": bar_rounding(made, proportions(made))})


def build(design: SingleRackDesign) -> GearTrain:
    """Return the rack of a design (in mm), which meshes with no pinion.

    Raises DesignError for teeth or bars that cannot exist.
    """
    mesh = proportions(design)
    if mesh.rack_thickness <= 0.0:
        refuse_thin_allowance(RACK_NAME, design.rack, mesh.rack_thickness)
    check_land(mesh)
    room = BASIC_RACKS[design.profile][2], "the tool's tooth has no room for it"
    warnings = unusual_defaults(design, {f"{RACK_NAME}.tool_tip_radius": room})
    bar = rack_member(RACK_NAME, mesh.rack, mesh.pinion, first_halves(design).rack)
    bar = with_bolts(double_helical_bar(design, bar) if design.double_helical else bar, design.rack)
    notes = (HALF_NOTE,) if design.double_helical else ()
    # the rack slides, and its teeth are repeated along it
    member = replace(bar, mount=Mount(bar.mount.base, joint=bar.tooth.joint))
    return GearTrain(design.kind, (), (*warnings, *notes), unpaired=(member,), lacking=PINION_NAME)


def sheet(design: SingleRackDesign, train: GearTrain) -> Sheet:
    """Return the sheet of a design and the rack built from it."""
    own = complete_design(design).in_mm()
    derived, plain, *others = plain_sheet(own, train).tables
    rows = tables_by_title({"Rack": ((RACK_NAME,), lambda: rack_rows(own, proportions(own), train.members[RACK_NAME]))})
    halves = half_tables(own, tuple(train.members.values()))
    # the table of axes is left out: there is no pair
    return Sheet((derived, *halves, *rows, plain, *others[1:]), {})


def pinned_values(design: SingleRackDesign, train: GearTrain) -> Values:
    """Return the values that the rack leaves to its build: its number of teeth and its length."""
    return {
        **({"arrangement": design.arrangement} if design.double_helical else {}),
        **{f"{RACK_NAME}.gap_height": height for height in gap_heights(train.members[RACK_NAME])},
        f"{RACK_NAME}.teeth": design.rack_teeth,
        f"{RACK_NAME}.length": design.rack_teeth * design.pitch + 2.0 * design.overhang,
    }
