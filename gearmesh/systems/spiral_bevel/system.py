"""Spiral, zerol, straight bevel and hypoid gears cut by head cutters [AB; CR3553; ISO 23509]."""

from gearmesh.systems.common.bevel.displacements import ASSEMBLY_DISPLACEMENTS
from gearmesh.systems.spiral_bevel.build import build, gear_part, left_to_geometry, pinion_part, try_build
from gearmesh.systems.spiral_bevel.design import HypoidDesign, SpiralBevelDesign
from gearmesh.systems.spiral_bevel.errors.compensation import compensate
from gearmesh.systems.spiral_bevel.errors.kinematic_errors import first_order
from gearmesh.systems.spiral_bevel.errors.vh_check import ASSEMBLY_MOVES, vh_check
from gearmesh.systems.spiral_bevel.pinned import settings_values
from gearmesh.systems.spiral_bevel.rexs import BEVEL_FORM, HYPOID_FORM
from gearmesh.systems.spiral_bevel.sheet.accuracy import bevel_inspection
from gearmesh.systems.spiral_bevel.sheet.drawn import DRAWN_ROWS
from gearmesh.systems.spiral_bevel.sheet.member_sheet import member_sheet
from gearmesh.systems.spiral_bevel.sheet.sheet import settings_sheet, tooth_forces
from gearmesh.systems.spiral_bevel.synthesis.teeth_choice import bevel_teeth
from gearmesh.systems.system import PatternCheck, System

GEAR_SYSTEMS = tuple(
    System(
        kind,
        design,
        build,
        members={"pinion": pinion_part, "gear": gear_part},
        tried=try_build,
        derive=left_to_geometry,
        sheet=settings_sheet,
        member_sheet=member_sheet,
        forces=tooth_forces,
        compensate=compensate,
        vh=PatternCheck(
            lambda design, train, moved: vh_check(design, train, bevel_teeth(design).cut.blank.clearance, moved),
            ASSEMBLY_MOVES.keys,
            ("V", "H"),
        ),
        first_order=lambda design: first_order(design, build),
        displacements=ASSEMBLY_DISPLACEMENTS,
        pinned=settings_values,
        drawn=DRAWN_ROWS,
        inspection=bevel_inspection,
        rexs=form,
    )
    for kind, design, form in (
        ("spiral_bevel", SpiralBevelDesign, BEVEL_FORM),
        ("hypoid", HypoidDesign, HYPOID_FORM),
    )
)
