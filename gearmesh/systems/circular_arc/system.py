"""Circular-arc (Wildhaber-Novikov) helical gears [LT85]."""

from gearmesh.systems.circular_arc.build import ASSEMBLY_DISPLACEMENTS, build
from gearmesh.systems.circular_arc.compensation import compensate
from gearmesh.systems.circular_arc.design import CircularArcDesign
from gearmesh.systems.circular_arc.sheet import contact_sheet
from gearmesh.systems.system import System

GEAR_SYSTEMS = (
    System(
        "circular_arc",
        CircularArcDesign,
        build,
        sheet=contact_sheet,
        compensate=compensate,
        refinish=compensate,
        displacements=ASSEMBLY_DISPLACEMENTS,
    ),
)
