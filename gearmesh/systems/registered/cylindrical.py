"""Spur and helical gears on parallel axes, external and internal, pairs and one alone [ISO 21771]."""

from gearmesh.systems.cylindrical.build import DISPLACEMENTS, build
from gearmesh.systems.cylindrical.design import CylindricalDesign
from gearmesh.systems.cylindrical.force_tables import pair_forces
from gearmesh.systems.cylindrical.geometry.proportions import derived_values
from gearmesh.systems.cylindrical.inspection.basis import pair_inspection
from gearmesh.systems.cylindrical.pinned import pair_values
from gearmesh.systems.cylindrical.rexs.pair import PAIR
from gearmesh.systems.cylindrical.sheet import data_sheet
from gearmesh.systems.cylindrical.single.design import is_single
from gearmesh.systems.cylindrical.single.drawn import DRAWN
from gearmesh.systems.registered.single_gear import SINGLE_GEAR
from gearmesh.systems.system import System

SYSTEMS = (
    System(
        "cylindrical",
        CylindricalDesign,
        build,
        derive=derived_values,
        sheet=data_sheet,
        forces=pair_forces,
        displacements=DISPLACEMENTS,
        pinned=pair_values,
        drawn=DRAWN,
        inspection=pair_inspection,
        rexs=PAIR,
        single=SINGLE_GEAR,
        is_single=is_single,
    ),
)
