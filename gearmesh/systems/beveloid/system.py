"""Beveloid gears: involute spur, helical and conical gears on any axes [LT02]."""

from gearmesh.systems.beveloid.build import ASSEMBLY_DISPLACEMENTS, build, pinned_values
from gearmesh.systems.beveloid.design import BeveloidDesign
from gearmesh.systems.beveloid.sheet import beveloid_sheet
from gearmesh.systems.system import System

GEAR_SYSTEMS = (
    System(
        "beveloid",
        BeveloidDesign,
        build,
        displacements=ASSEMBLY_DISPLACEMENTS,
        pinned=pinned_values,
        sheet=beveloid_sheet,
    ),
)
