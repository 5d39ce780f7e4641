"""Helical gears of parabolic racks, ground by worms and disks: Novikov-Wildhaber and modified involute [LF04 17]."""

from gearmesh.systems.parabolic_helical.build import ASSEMBLY_DISPLACEMENTS, build, pinned_values, worm_part
from gearmesh.systems.parabolic_helical.design import ModifiedInvoluteDesign, NovikovDesign
from gearmesh.systems.system import System

GEAR_SYSTEMS = (
    System("novikov", NovikovDesign, build, worm=worm_part, displacements=ASSEMBLY_DISPLACEMENTS, pinned=pinned_values),
    System(
        "modified_involute",
        ModifiedInvoluteDesign,
        build,
        worm=worm_part,
        displacements=ASSEMBLY_DISPLACEMENTS,
        pinned=pinned_values,
    ),
)
