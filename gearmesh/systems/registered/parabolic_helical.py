"""Helical gears of parabolic racks, ground by worms and disks: Novikov-Wildhaber and modified involute [LF04 17]."""

from gearmesh.systems.parabolic_helical.build import DISPLACEMENTS, build, pinned_values, worm_part
from gearmesh.systems.parabolic_helical.design import ModifiedInvoluteDesign, NovikovDesign
from gearmesh.systems.system import System

SYSTEMS = (
    System("novikov", NovikovDesign, build, worm=worm_part, displacements=DISPLACEMENTS, pinned=pinned_values),
    System(
        "modified_involute",
        ModifiedInvoluteDesign,
        build,
        worm=worm_part,
        displacements=DISPLACEMENTS,
        pinned=pinned_values,
    ),
)
