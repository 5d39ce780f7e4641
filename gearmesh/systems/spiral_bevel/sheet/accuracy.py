"""Tolerances of bevel and hypoid gears by ISO 17485:2006, 5.4: pitch and runout of one member, by its grade of accuracy.

Each is that of grade 4 times sqrt(2) for every grade coarser, and follows from the mean normal module and the tolerance diameter
d_T, in the middle of the working depth at the mean cone distance. The ranges were compared with the standard's scope as it is
published; the standard itself was not at hand.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from gearmesh.systems.common.standards.tolerance_rounding import round_tolerance
from gearmesh.systems.common.symbol_table import Row, Values, table
from gearmesh.systems.spiral_bevel.blank.blank import BevelBlank
from gearmesh.systems.system import SheetTable

MEMBERS = ("pinion", "gear")
#: what tolerances are called, by symbol
NAMES = {"f_ptT": "single pitch", "F_pT": "total cumulative pitch", "F_rT": "runout"}
#: ranges of teeth, tolerance diameter and mean normal module (mm)
TEETH, DIAMETER, MODULE = (5, 400), (5.0, 2500.0), (1.0, 50.0)
#: runout over cumulative pitch
RUNOUT = 0.8


@dataclass(frozen=True)
class ToleranceSizes:
    """What the tolerances of a member follow from: teeth, tolerance diameter d_T and mean normal module, mm."""

    teeth: int
    diameter: float
    module: float

    @classmethod
    def of(cls, blank: BevelBlank, number: int) -> ToleranceSizes:
        """Those of the pinion, 0, or the gear, 1: d_T = d_m + 2 (h_am - h_mw / 2) cos(delta), h_mw the sum of both addenda."""
        own, addenda = blank.members[number], [depth.addendum for depth in blank.standard_depths]
        above = addenda[number] - 0.5 * sum(addenda)
        diameter = 2.0 * (own.mean_radius + above * math.cos(own.pitch_angle))
        return cls(own.teeth, diameter, blank.mean_normal_module)


def tolerances(grade: int, sizes: ToleranceSizes) -> dict[str, float] | None:
    """Tolerances (um) by their symbols; None beyond the range of the standard."""
    ranges = ((sizes.teeth, TEETH), (sizes.diameter, DIAMETER), (sizes.module, MODULE))
    if not all(low <= value <= high for value, (low, high) in ranges):
        return None
    single = 0.003 * sizes.diameter + 0.3 * sizes.module + 5.0
    cumulative = 0.025 * sizes.diameter + 0.3 * sizes.module + 19.0
    # exact where it is a whole power of 2
    factor = 2.0 ** (0.5 * (grade - 4))
    values = single, cumulative, RUNOUT * cumulative
    return {symbol: round_tolerance(factor * value) for symbol, value in zip(NAMES, values, strict=True)}


def tolerance_table(grade: int, blank: BevelBlank, members: Sequence[str]) -> SheetTable:
    """The table of the members named, "pinion" and "gear" or one of them."""
    sizes = [ToleranceSizes.of(blank, MEMBERS.index(name)) for name in members]
    limits = [tolerances(grade, own) or {} for own in sizes]
    diameters: Values = tuple(own.diameter for own in sizes)
    rows: list[Row] = [
        ("B", "grade of accuracy", "-", (grade,) * len(sizes)),
        ("d_T", "tolerance diameter", "mm", diameters),
        *((symbol, words, "um", tuple(own.get(symbol) for own in limits)) for symbol, words in NAMES.items()),
    ]
    return table("Tolerances [ISO 17485:2006]", tuple(members), rows)
