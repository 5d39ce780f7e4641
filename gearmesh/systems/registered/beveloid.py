"""Beveloid gears: involute spur, helical and conical gears on any axes [LT02]."""

from gearmesh.systems.beveloid.build import DISPLACEMENTS, build, pinned_values
from gearmesh.systems.beveloid.design import BeveloidDesign
from gearmesh.systems.system import System

SYSTEMS = (System("beveloid", BeveloidDesign, build, displacements=DISPLACEMENTS, pinned=pinned_values),)
