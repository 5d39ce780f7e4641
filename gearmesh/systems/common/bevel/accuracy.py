"""Table of tolerances of bevel and hypoid gears [ISO 17485:2006]."""

from __future__ import annotations

import math
from collections.abc import Sequence

from gearmesh.metrology.iso17485 import TOLERANCE_NAMES, BevelSizes
from gearmesh.systems.common.bevel.blank import BevelBlank
from gearmesh.systems.common.symbol_table import Row, Values, table
from gearmesh.systems.system import SheetTable

#: names of the members in order
MEMBER_NAMES = ("pinion", "gear")


def tolerance_sizes(blank: BevelBlank, number: int) -> BevelSizes:
    """Return the sizes of the pinion (0) or the gear (1) on which tolerances depend.

    The tolerance diameter is d_T = d_m + 2 (h_am - h_mw / 2) cos(delta), with h_mw the sum of both mean addenda.
    """
    member, addenda = blank.members[number], [depth.addendum for depth in blank.standard_depths]
    above = addenda[number] - 0.5 * sum(addenda)
    diameter = 2.0 * (member.mean_radius + above * math.cos(member.pitch_angle))
    return BevelSizes(member.teeth, diameter, blank.mean_normal_module)


def tolerance_table(grade: int, blank: BevelBlank, members: Sequence[str]) -> SheetTable:
    """Return the table of the named members; it has no tolerances beyond the range of the standard.

    `members`: "pinion", "gear" or both.
    """
    sizes = [tolerance_sizes(blank, MEMBER_NAMES.index(name)) for name in members]
    limits = [member_sizes.tolerances(grade) or {} for member_sizes in sizes]
    diameters: Values = tuple(member_sizes.diameter for member_sizes in sizes)
    rows: list[Row] = [
        ("B", "grade of accuracy", "-", (grade,) * len(sizes)),
        ("d_T", "tolerance diameter", "mm", diameters),
        *(
            (symbol, words, "um", tuple(member_limits.get(symbol) for member_limits in limits))
            for symbol, words in TOLERANCE_NAMES.items()
        ),
    ]
    return table("Tolerances [ISO 17485:2006]", tuple(members), rows)
