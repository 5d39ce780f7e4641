"""Planetary sets: sun, planets and ring as cylindrical pairs that share the planet; positions, motion, sheet."""

from gearmesh.systems.cylindrical.force_tables import set_forces
from gearmesh.systems.cylindrical.inspection.basis import planetary_inspection
from gearmesh.systems.cylindrical.pinned import planetary_values
from gearmesh.systems.cylindrical.planetary.build import build, derived_values
from gearmesh.systems.cylindrical.planetary.design import PlanetaryDesign
from gearmesh.systems.cylindrical.planetary.sheet import planetary_reserves, planetary_sheet, set_factors
from gearmesh.systems.cylindrical.rexs.planets import PLANETARY_FORM
from gearmesh.systems.cylindrical.single.drawn import DRAWN_ROWS
from gearmesh.systems.system import System

GEAR_SYSTEMS = (
    System(
        "planetary",
        PlanetaryDesign,
        build,
        derive=derived_values,
        sheet=planetary_sheet,
        reserves=planetary_reserves,
        forces=set_forces,
        nominal=set_factors,
        pinned=planetary_values,
        drawn=DRAWN_ROWS,
        inspection=planetary_inspection,
        rexs=PLANETARY_FORM,
    ),
)
