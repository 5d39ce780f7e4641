"""Tolerances of involute splines by DIN 5480-1: grades 5 to 12, deviations a to v of shafts and F to M of hubs.

A size step i is that of the reference diameter d_B plus that of the module. It gives a unit u; the deviation of a letter is a
multiple k of it. The grade n takes row 3 (n - 5) + i of the tolerances, um:

    A_s = k u of shafts, A_e = k u of hubs,   T_G = T_act + T_eff

The effective tolerance T_eff is the effective variation lambda of ISO 4156: deviations of pitch, profile and helix act within it.
The steps, units and rows are recalled, and found alike in one published implementation.
"""

from __future__ import annotations

import re

from gearmesh.systems.common.standards.iso286 import MM_PER_UM
from gearmesh.systems.common.standards.iso4156 import SplineTolerance
from gearmesh.systems.common.standards.size_ranges import range_number

#: largest reference diameters of the size steps, mm; larger ones have the last step
DIAMETER_STEPS_MM = (12.0, 25.0, 50.0, 100.0, 200.0, 400.0)
#: largest modules of the size steps, mm; larger ones have the last step
MODULE_STEPS_MM = (1.5, 4.0)
#: largest module of the tolerances, mm
LARGEST_MODULE_MM = 10.0
#: unit of the deviations by size step, um
STEP_UNITS_UM = (8.0, 9.0, 10.0, 11.0, 12.5, 14.0, 16.0, 18.0, 20.0)
#: units in the deviation of a shaft, positive towards thicker teeth
SHAFT_UNITS = dict(zip("abcdefghjkmnprstuv", (-10, -8, -6, -4, -3, -2, -1, 0, *range(1, 11)), strict=True))
#: units in the deviation of a hub, positive towards wider spaces
HUB_UNITS = {"F": 2, "G": 1, "H": 0, "J": -1, "K": -2, "M": -3}
#: grades of tolerances
TOLERANCE_GRADES = range(5, 13)
#: tolerance of the actual thickness or width by row, um
ACTUAL_TOLERANCES_UM = (
    *(8, 9, 10, 11, 12, 14, 16, 18, 20, 22, 25, 28, 32, 36, 40, 45, 50, 56),
    *(63, 71, 80, 90, 100, 112, 125, 140, 160, 175, 200, 225),
)
#: tolerance of the effective thickness or width by row, um
EFFECTIVE_TOLERANCES_UM = (
    *(4, 5, 6, 7, 8, 8, 9, 10, 12, 14, 15, 17, 18, 20, 23, 26, 30, 34),
    *(37, 41, 45, 50, 60, 68, 75, 84, 90, 105, 120, 135),
)


def parse(text: str, letters: tuple[str, ...]) -> tuple[int, str] | None:
    """Return grade and letter of a tolerance such as "8f"; None for other texts, grades and letters."""
    match = re.fullmatch(r"(\d+)([A-Za-z])", text, re.ASCII)
    if match is None or int(match[1]) not in TOLERANCE_GRADES or match[2] not in letters:
        return None
    return int(match[1]), match[2]


def tolerance(grade: int, letter: str, module: float, reference_diameter: float) -> SplineTolerance:
    """Return the tolerance of a grade and a letter, of a hub if it is a capital; module and d_B in mm.

    The deviation of a hub is that of the thickness of its teeth, as for all internal gears. The module is at most
    LARGEST_MODULE_MM.
    """
    step = range_number(DIAMETER_STEPS_MM, reference_diameter) + range_number(MODULE_STEPS_MM, module)
    units = -HUB_UNITS[letter] if letter.isupper() else SHAFT_UNITS[letter]
    row = 3 * (grade - TOLERANCE_GRADES.start) + step
    actual, effective = ACTUAL_TOLERANCES_UM[row], EFFECTIVE_TOLERANCES_UM[row]
    # deviations are whole um
    deviation = int(units * STEP_UNITS_UM[step])
    return SplineTolerance(MM_PER_UM * deviation, MM_PER_UM * (actual + effective), MM_PER_UM * effective)
