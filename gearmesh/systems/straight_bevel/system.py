"""Straight bevel gears: octoids of a flat crown gear and spherical involutes [ISO 23509]."""

from gearmesh.systems.common.bevel.displacements import ASSEMBLY_DISPLACEMENTS
from gearmesh.systems.straight_bevel.build import build
from gearmesh.systems.straight_bevel.design import StraightBevelDesign
from gearmesh.systems.straight_bevel.pinned import pinned_values
from gearmesh.systems.straight_bevel.sheet import DRAWN_ROWS, straight_forces, straight_inspection, straight_sheet
from gearmesh.systems.system import System

GEAR_SYSTEMS = (
    System(
        "straight_bevel",
        StraightBevelDesign,
        build,
        sheet=straight_sheet,
        forces=straight_forces,
        displacements=ASSEMBLY_DISPLACEMENTS,
        pinned=pinned_values,
        drawn=DRAWN_ROWS,
        inspection=straight_inspection,
    ),
)
