"""Tolerances of side-fit involute splines by ANSI B92.1: classes 4 to 7, alike for space widths and tooth thicknesses.

The table of class 5 has machining tolerance m and variation allowance lambda for ranges of pitches, in 0.0001 inch. Both grow
by equal steps with the number of teeth N, so that a pair a + b N gives every row:

    T + lambda = f (m + lambda),   f = 0.71, 1, 1.4, 2 for classes 4 to 7

The effective width and the effective thickness at the maximum of material are the basic ones.
"""

from __future__ import annotations

from gearmesh.design.keys import MM_PER
from gearmesh.systems.common.standards.iso4156 import SplineTolerance
from gearmesh.systems.common.standards.size_ranges import range_number

#: factors of the tolerances of class 5, by class
CLASS_FACTORS = {4: 0.71, 5: 1.0, 6: 1.4, 7: 2.0}
#: largest diametral pitches of the ranges of the table, 1/inch
PITCH_LIMITS = (3.0, 5.0, 8.0, 12.0, 20.0, 48.0, 80.0, 128.0)
#: machining tolerance a + b N of class 5, 0.0001 inch, by range of pitches
MACHINING_STEPS = (
    (14.0, 0.18),
    (13.0, 0.15),
    (11.0, 0.15),
    (11.0, 0.10),
    (11.0, 0.07),
    (11.0, 0.07),
    (9.0, 0.06),
    (9.0, 0.05),
)
#: variation allowance a + b N of class 5, 0.0001 inch, by range of pitches
VARIATION_STEPS = (
    (20.0, 0.35),
    (18.0, 0.23),
    (15.0, 0.20),
    (14.0, 0.17),
    (13.0, 0.12),
    (11.0, 0.12),
    (10.0, 0.10),
    (9.0, 0.08),
)
#: coarsest pitch of the table, 1/inch
COARSEST_PITCH = 2.5
#: largest number of teeth of the table
LARGEST_TEETH = 100
#: unit of the table, mm
UNIT_MM = 1e-4 * MM_PER["inch"]


def parse(text: str) -> int | None:
    """Return the class of a tolerance such as "5"; None for other texts."""
    return int(text) if text.isascii() and text.isdigit() and int(text) in CLASS_FACTORS else None


def tolerance(number: int, pitch: float, teeth: int) -> SplineTolerance | None:
    """Return the tolerance (mm) of class `number` for a diametral pitch (1/inch); None outside of the table."""
    if not COARSEST_PITCH <= pitch <= PITCH_LIMITS[-1] or teeth > LARGEST_TEETH:
        return None
    column, factor = range_number(PITCH_LIMITS, pitch), CLASS_FACTORS[number] * UNIT_MM
    machining, variation = (factor * (a + b * teeth) for a, b in (MACHINING_STEPS[column], VARIATION_STEPS[column]))
    return SplineTolerance(0.0, machining + variation, variation)
