"""Spur and helical gears on parallel axes, external and internal, pairs and single gears [ISO 21771].

Functions that few commands need are loaded on their first call: everything loaded here delays the first solid of a
gear.
"""

from gearmesh.exchange.stage_form import StageForm
from gearmesh.systems.cylindrical.build import ASSEMBLY_DISPLACEMENTS, build
from gearmesh.systems.cylindrical.design import CylindricalDesign
from gearmesh.systems.cylindrical.geometry.proportions import derived_values
from gearmesh.systems.cylindrical.single.design import SingleGearDesign, is_single
from gearmesh.systems.cylindrical.single.drawn import DRAWN_ROWS
from gearmesh.systems.system import System, late

GEAR_SYSTEMS = (
    System(
        "cylindrical",
        CylindricalDesign,
        build,
        derive=derived_values,
        sheet=late("cylindrical.sheet:data_sheet"),
        reserves=late("cylindrical.sheet:pair_reserves"),
        forces=late("cylindrical.force_tables:pair_forces"),
        nominal=late("cylindrical.sheet:pair_factors"),
        displacements=ASSEMBLY_DISPLACEMENTS,
        pinned=late("cylindrical.pinned:pair_values"),
        drawn=DRAWN_ROWS,
        inspection=late("cylindrical.inspection.basis:pair_inspection"),
        rexs=StageForm(
            ("cylindrical_stage",), late("cylindrical.rexs.pair:read_pair"), late("cylindrical.rexs.pair:write_pair")
        ),
        single=System(
            "cylindrical",
            SingleGearDesign,
            late("cylindrical.single.build:build"),
            derive=late("cylindrical.single.build:derived_values"),
            sheet=late("cylindrical.single.sheet:single_sheet"),
            pinned=late("cylindrical.pinned:single_values"),
            drawn=DRAWN_ROWS,
            inspection=late("cylindrical.inspection.basis:single_inspection"),
        ),
        is_single=is_single,
    ),
)
