"""One cylindrical gear without a mating gear: its keys, the member built of it, its data sheet."""

from gearmesh.metrology.measured_teeth import InspectionBasis
from gearmesh.systems.cylindrical.single.build import build, derived_values
from gearmesh.systems.cylindrical.single.design import SingleGearDesign
from gearmesh.systems.cylindrical.single.drawn import DRAWN
from gearmesh.systems.cylindrical.single.pinned import single_values
from gearmesh.systems.system import Sheet, System
from gearmesh.teeth.gear_train import GearTrain


def _sheet(design: SingleGearDesign, train: GearTrain) -> Sheet:
    from gearmesh.systems.cylindrical.single.sheet import single_sheet

    return single_sheet(design, train)


def _inspection(design: SingleGearDesign, train: GearTrain, name: str) -> InspectionBasis:
    from gearmesh.systems.cylindrical.inspection.basis import single_inspection

    return single_inspection(design, train, name)


SINGLE_GEAR = System(
    "cylindrical",
    SingleGearDesign,
    build,
    derive=derived_values,
    sheet=_sheet,
    pinned=single_values,
    drawn=DRAWN,
    inspection=_inspection,
)
