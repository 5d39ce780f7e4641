"""The table of tolerances of bevel and hypoid gears, and what they are inspected by [ISO 17485:2006]."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

from gearmesh.metrology.iso17485 import NAMES, BevelSizes
from gearmesh.metrology.measured_teeth import InspectionBasis
from gearmesh.systems.common.symbol_table import Row, Values, table
from gearmesh.systems.spiral_bevel.blank.blank import BevelBlank
from gearmesh.systems.spiral_bevel.synthesis.teeth_choice import bevel_teeth
from gearmesh.systems.system import SheetTable

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign
    from gearmesh.teeth.gear_train import GearTrain

MEMBERS = ("pinion", "gear")


def tolerance_sizes(blank: BevelBlank, number: int) -> BevelSizes:
    """Those of the pinion, 0, or the gear, 1: d_T = d_m + 2 (h_am - h_mw / 2) cos(delta), h_mw the sum of both addenda."""
    own, addenda = blank.members[number], [depth.addendum for depth in blank.standard_depths]
    above = addenda[number] - 0.5 * sum(addenda)
    diameter = 2.0 * (own.mean_radius + above * math.cos(own.pitch_angle))
    return BevelSizes(own.teeth, diameter, blank.mean_normal_module)


def tolerance_table(grade: int, blank: BevelBlank, members: Sequence[str]) -> SheetTable:
    """The table of the members named, "pinion" and "gear" or one of them; without tolerances beyond the range of the standard."""
    sizes = [tolerance_sizes(blank, MEMBERS.index(name)) for name in members]
    limits = [own.tolerances(grade) or {} for own in sizes]
    diameters: Values = tuple(own.diameter for own in sizes)
    rows: list[Row] = [
        ("B", "grade of accuracy", "-", (grade,) * len(sizes)),
        ("d_T", "tolerance diameter", "mm", diameters),
        *((symbol, words, "um", tuple(own.get(symbol) for own in limits)) for symbol, words in NAMES.items()),
    ]
    return table("Tolerances [ISO 17485:2006]", tuple(members), rows)


def bevel_inspection(design: FaceMilledDesign, train: GearTrain, name: str) -> InspectionBasis:
    """Of the "pinion" or the "gear" of a design: pitch and runout have tolerances, flanks have not."""
    own = design.in_mm()
    return InspectionBasis(tolerance_sizes(bevel_teeth(own).cut.blank, MEMBERS.index(name)), own.accuracy_grade)
