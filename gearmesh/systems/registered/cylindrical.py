"""Spur and helical gears on parallel axes, external and internal, pairs and single gears [ISO 21771].

Functions that few commands need are loaded on their first call: everything loaded here delays the first solid of a
gear.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gearmesh.exchange.stage_form import StageForm
from gearmesh.systems.cylindrical.build import ASSEMBLY_DISPLACEMENTS, build
from gearmesh.systems.cylindrical.design import CylindricalDesign
from gearmesh.systems.cylindrical.geometry.proportions import derived_values
from gearmesh.systems.cylindrical.single.design import is_single
from gearmesh.systems.cylindrical.single.drawn import DRAWN_ROWS
from gearmesh.systems.registered.single_gear import SINGLE_GEAR
from gearmesh.systems.system import Reserve, Sheet, SheetTable, System

if TYPE_CHECKING:
    from gearmesh.exchange.model import Component
    from gearmesh.exchange.stage import StageReader
    from gearmesh.exchange.stage_writer import StageWriter
    from gearmesh.metrology.measured_teeth import InspectionBasis
    from gearmesh.systems.common.pinned import Values
    from gearmesh.teeth.gear_train import GearTrain


def _sheet(design: CylindricalDesign, train: GearTrain) -> Sheet:
    from gearmesh.systems.cylindrical.sheet import data_sheet

    return data_sheet(design, train)


def _reserves(design: CylindricalDesign, train: GearTrain) -> tuple[Reserve, ...]:
    from gearmesh.systems.cylindrical.sheet import pair_reserves

    return pair_reserves(design, train)


def _forces(design: CylindricalDesign, torque: float, speed: float | None) -> tuple[SheetTable, ...]:
    from gearmesh.systems.cylindrical.force_tables import pair_forces

    return pair_forces(design, torque, speed)


def _values(design: CylindricalDesign, train: GearTrain) -> Values:
    from gearmesh.systems.cylindrical.pinned import pair_values

    return pair_values(design, train)


def _inspection(design: CylindricalDesign, train: GearTrain, name: str) -> InspectionBasis:
    from gearmesh.systems.cylindrical.inspection.basis import pair_inspection

    return pair_inspection(design, train, name)


def _read(file: StageReader) -> dict[str, Any]:
    from gearmesh.systems.cylindrical.rexs.pair import read_pair

    return read_pair(file)


def _write(file: StageWriter, design: CylindricalDesign, known: Component | None) -> Component:
    from gearmesh.systems.cylindrical.rexs.pair import write_pair

    return write_pair(file, design, known)


GEAR_SYSTEMS = (
    System(
        "cylindrical",
        CylindricalDesign,
        build,
        derive=derived_values,
        sheet=_sheet,
        reserves=_reserves,
        forces=_forces,
        displacements=ASSEMBLY_DISPLACEMENTS,
        pinned=_values,
        drawn=DRAWN_ROWS,
        inspection=_inspection,
        rexs=StageForm(("cylindrical_stage",), _read, _write),
        single=SINGLE_GEAR,
        is_single=is_single,
    ),
)
