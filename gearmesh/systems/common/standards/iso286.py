"""Standard tolerances and deviations of ISO 286-1:2010: IT5 to IT12 of sizes up to 3150 mm, positions h and js."""

from __future__ import annotations

import re

from gearmesh.errors import nearest
from gearmesh.records import dataclass
from gearmesh.systems.common.standards.size_ranges import range_number

#: largest size of each range, which begins above the limit before it
SIZE_LIMITS_MM = (3, 6, 10, 18, 30, 50, 80, 120, 180, 250, 315, 400, 500, 630, 800, 1000, 1250, 1600, 2000, 2500, 3150)
#: standard tolerances by grade
STANDARD_TOLERANCES_UM = {
    5: (4, 5, 6, 8, 9, 11, 13, 15, 18, 20, 23, 25, 27, 32, 36, 40, 47, 55, 65, 78, 96),
    6: (6, 8, 9, 11, 13, 16, 19, 22, 25, 29, 32, 36, 40, 44, 50, 56, 66, 78, 92, 110, 135),
    7: (10, 12, 15, 18, 21, 25, 30, 35, 40, 46, 52, 57, 63, 70, 80, 90, 105, 125, 150, 175, 210),
    8: (14, 18, 22, 27, 33, 39, 46, 54, 63, 72, 81, 89, 97, 110, 125, 140, 165, 195, 230, 280, 330),
    9: (25, 30, 36, 43, 52, 62, 74, 87, 100, 115, 130, 140, 155, 175, 200, 230, 260, 310, 370, 440, 540),
    10: (40, 48, 58, 70, 84, 100, 120, 140, 160, 185, 210, 230, 250, 280, 320, 360, 420, 500, 600, 700, 860),
    11: (60, 75, 90, 110, 130, 160, 190, 220, 250, 290, 320, 360, 400, 440, 500, 560, 660, 780, 920, 1100, 1350),
    12: (100, 120, 150, 180, 210, 250, 300, 350, 400, 460, 520, 570, 630, 700, 800, 900, 1050, 1250, 1500, 1750, 2100),
}
#: millimetres in a micrometre
MM_PER_UM = 1e-3


@dataclass(frozen=True)
class Deviations:
    """Upper and lower deviation of a size, mm."""

    upper: float
    lower: float


def standard_tolerance(grade: int, size: float) -> float:
    """Return the standard tolerance, mm, of a size (mm) up to the last of SIZE_LIMITS_MM."""
    return MM_PER_UM * STANDARD_TOLERANCES_UM[grade][range_number(SIZE_LIMITS_MM, size)]


def refusal(text: str, letters: tuple[str, ...], grades: range) -> str:
    """Return the allowed tolerance classes as text if a class such as "js7" is not allowed; "" if it is."""
    match = re.fullmatch(r"([A-Za-z]+) ?(\d+)", text, re.ASCII)
    if match is not None and match[1] in letters and int(match[2]) in grades:
        return ""
    classes = [f"{letter}{grade}" for letter in letters for grade in grades]
    if match is not None and match[1] in letters:
        # the letter is allowed, so that the grade is wrong
        near: str | None = f"{match[1]}{min(max(int(match[2]), grades[0]), grades[-1])}"
    else:
        near = nearest(text, classes)
    hint = f'; the nearest is "{near}"' if near else ""
    spans = " or ".join(f'"{letter}{grades[0]}" to "{letter}{grades[-1]}"' for letter in letters)
    return f"{spans}{hint}"


def deviations(text: str, size: float) -> Deviations:
    """Return the deviations of a size (mm) by its tolerance class.

    The deviations of h (shafts) and H (holes) are from the size into the material; those of js and JS are on both sides
    of it.
    """
    letter, grade = text.rstrip("0123456789 "), int(re.sub(r"\D", "", text))
    whole = standard_tolerance(grade, size)
    if letter.lower() == "js":
        return Deviations(0.5 * whole, -0.5 * whole)
    return Deviations(whole, 0.0) if letter == "H" else Deviations(0.0, -whole)
