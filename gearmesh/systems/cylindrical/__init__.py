"""Spur and helical gears on parallel axes, external and internal [ISO 21771]."""

from gearmesh.systems.cylindrical.build import build
from gearmesh.systems.cylindrical.design import CylindricalDesign
from gearmesh.systems.cylindrical.proportions import derived
from gearmesh.systems.system import System

SYSTEMS = (System("cylindrical", CylindricalDesign, build, derive=derived),)
