"""Spur and helical gears on parallel axes, external and internal, racks, and planetary sets [ISO 21771]."""

from gearmesh.systems.cylindrical import planetary, rack_build, rack_proportions
from gearmesh.systems.cylindrical.build import build
from gearmesh.systems.cylindrical.design import CylindricalDesign
from gearmesh.systems.cylindrical.planetary_design import PlanetaryDesign
from gearmesh.systems.cylindrical.planetary_sheet import planetary_sheet
from gearmesh.systems.cylindrical.proportions import derived
from gearmesh.systems.cylindrical.rack_design import RackDesign
from gearmesh.systems.cylindrical.rack_sheet import rack_sheet
from gearmesh.systems.cylindrical.sheet import data_sheet
from gearmesh.systems.system import System

SYSTEMS = (
    System("cylindrical", CylindricalDesign, build, derive=derived, sheet=data_sheet),
    System("rack", RackDesign, rack_build.build, derive=rack_proportions.derived, sheet=rack_sheet),
    System("planetary", PlanetaryDesign, planetary.build, derive=planetary.derived, sheet=planetary_sheet),
)
