"""One cylindrical gear without a mating gear: its keys, the member, its data sheet."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearmesh.systems.cylindrical.single.design import SingleGearDesign
from gearmesh.systems.cylindrical.single.drawn import DRAWN_ROWS
from gearmesh.systems.system import Sheet, System

if TYPE_CHECKING:
    from gearmesh.metrology.measured_teeth import InspectionBasis
    from gearmesh.systems.common.pinned import Values
    from gearmesh.teeth.gear_train import GearTrain


def _build(design: SingleGearDesign) -> GearTrain:
    from gearmesh.systems.cylindrical.single.build import build

    return build(design)


def _derive(design: SingleGearDesign) -> dict[str, float]:
    from gearmesh.systems.cylindrical.single.build import derived_values

    return derived_values(design)


def _sheet(design: SingleGearDesign, train: GearTrain) -> Sheet:
    from gearmesh.systems.cylindrical.single.sheet import single_sheet

    return single_sheet(design, train)


def _values(design: SingleGearDesign, train: GearTrain) -> Values:
    from gearmesh.systems.cylindrical.single.pinned import single_values

    return single_values(design, train)


def _inspection(design: SingleGearDesign, train: GearTrain, name: str) -> InspectionBasis:
    from gearmesh.systems.cylindrical.inspection.basis import single_inspection

    return single_inspection(design, train, name)


SINGLE_GEAR = System(
    "cylindrical",
    SingleGearDesign,
    _build,
    derive=_derive,
    sheet=_sheet,
    pinned=_values,
    drawn=DRAWN_ROWS,
    inspection=_inspection,
)
