"""Basis of the inspection of bevel and hypoid gears [ISO 17485:2006]."""

from __future__ import annotations

from typing import TYPE_CHECKING

from gearmesh.metrology.measured_teeth import InspectionBasis
from gearmesh.systems.common.bevel.accuracy import MEMBER_NAMES, tolerance_sizes
from gearmesh.systems.spiral_bevel.synthesis.teeth_choice import bevel_teeth

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign
    from gearmesh.teeth.gear_train import GearTrain


def bevel_inspection(design: FaceMilledDesign, train: GearTrain, name: str) -> InspectionBasis:
    """Return the inspection basis of the "pinion" or the "gear" of a design.

    Pitch and runout have tolerances, flanks have none.
    """
    design_mm = design.in_mm()
    return InspectionBasis(
        tolerance_sizes(bevel_teeth(design_mm).cut.blank, MEMBER_NAMES.index(name)), design_mm.accuracy_grade
    )
