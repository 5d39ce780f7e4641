"""Conjugate spiral bevel gears, Geometry I and II [CR3553]."""

from gearmesh.systems.common.bevel.displacements import ASSEMBLY_DISPLACEMENTS
from gearmesh.systems.spiral_bevel.conjugate.build import build, conjugate_blank
from gearmesh.systems.spiral_bevel.conjugate.compensation import compensate
from gearmesh.systems.spiral_bevel.conjugate.design import ConjugateDesign
from gearmesh.systems.spiral_bevel.errors.kinematic_errors import first_order
from gearmesh.systems.spiral_bevel.errors.vh_check import ASSEMBLY_MOVES, vh_check
from gearmesh.systems.spiral_bevel.pinned import conjugate_values
from gearmesh.systems.system import PatternCheck, System

GEAR_SYSTEMS = (
    System(
        "spiral_bevel_conjugate",
        ConjugateDesign,
        build,
        compensate=compensate,
        vh=PatternCheck(
            lambda design, train, moved: vh_check(design, train, conjugate_blank(design).clearance, moved),
            ASSEMBLY_MOVES.keys,
            ("V", "H"),
        ),
        first_order=lambda design: first_order(design, build),
        displacements=ASSEMBLY_DISPLACEMENTS,
        pinned=conjugate_values,
    ),
)
