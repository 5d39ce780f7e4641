"""Tolerances of side-fit involute splines by ISO 4156-1: classes 4 to 7, deviations d, e, f, h, js, k of shafts and H of hubs.

The total tolerance T + lambda is a multiple of the tolerance units of ISO 286 for the pitch diameter D and the basic space
width E, in um of mm:

    T + lambda = a i(D) + 4 a i(E),   a = 10, 16, 25, 40,   i(x) = 0.45 x^(1/3) + 0.001 x  (D > 500: 0.004 D + 2.1)
    lambda = 0.6 sqrt(F_p^2 + F_alpha^2 + F_beta^2)

lambda is the effective variation: deviations of pitch, profile and helix let a shaft act thicker, and a hub narrower, by it.
"""

from __future__ import annotations

import math
import re

from gearmesh.records import dataclass
from gearmesh.systems.common.standards.iso286 import MM_PER_UM, SIZE_LIMITS_MM
from gearmesh.systems.common.standards.size_ranges import range_number

#: tolerance classes, and the factor of the tolerance unit of the pitch diameter
CLASS_FACTORS = {4: 10.0, 5: 16.0, 6: 25.0, 7: 40.0}
#: factor of the tolerance unit of the space width, in factors of that of the pitch diameter
SPACE_FACTOR = 4.0
#: pitch diameter (mm) above which its tolerance unit is linear
LINEAR_UNIT_FROM_MM = 500.0
#: largest pitch diameter of the fundamental deviations, mm
LARGEST_DIAMETER_MM = 1000
#: part of the root of the sum of the squares of deviations that is the effective variation
VARIATION_SHARE = 0.6
#: pitch deviation F_p = a sqrt(L) + b, L half of the pitch circle's circumference in mm, by class, um
PITCH_FACTORS = {4: (2.5, 6.3), 5: (3.55, 9.0), 6: (5.0, 12.5), 7: (7.1, 18.0)}
#: profile deviation F_alpha = a (m + 0.0125 m z) + b, by class, um
PROFILE_FACTORS = {4: (1.6, 10.0), 5: (2.5, 16.0), 6: (4.0, 25.0), 7: (6.3, 40.0)}
#: helix deviation F_beta = a sqrt(b) + b, b length in mm, by class, um
HELIX_FACTORS = {4: (0.8, 4.0), 5: (1.0, 5.0), 6: (1.25, 6.3), 7: (2.0, 10.0)}
#: fundamental deviations of shafts by letter, um, below zero, for the ranges of diameters of `SIZE_LIMITS_MM` up to 1000 mm
FUNDAMENTAL_DEVIATIONS_UM = {
    "d": (20, 30, 40, 50, 65, 80, 100, 120, 145, 170, 190, 210, 230, 260, 290, 320),
    "e": (14, 20, 25, 32, 40, 50, 60, 72, 85, 100, 110, 125, 135, 145, 160, 170),
    "f": (6, 10, 13, 16, 20, 25, 30, 36, 43, 50, 56, 62, 68, 76, 80, 86),
    "h": (0,) * 16,
}
#: letters of shafts whose thickness is beyond the basic one, with their deviation in total tolerances
WIDER_LETTERS = {"js": 0.5, "k": 1.0}
#: letters of shafts
SHAFT_LETTERS = (*FUNDAMENTAL_DEVIATIONS_UM, *WIDER_LETTERS)
#: letters of hubs
HUB_LETTERS = ("H",)


@dataclass(frozen=True)
class SplineTolerance:
    """Limits of a tooth thickness or space width, mm, as deviations from the basic one."""

    #: deviation of the effective thickness or width at its maximum material
    effective: float
    #: total tolerance T + lambda
    total: float
    #: effective variation lambda
    variation: float


def parse(text: str, letters: tuple[str, ...]) -> tuple[int, str] | None:
    """Return class and letter of a tolerance such as "5f"; None for other texts, classes and letters."""
    match = re.fullmatch(r"(\d+)([A-Za-z]+)", text, re.ASCII)
    if match is None or int(match[1]) not in CLASS_FACTORS or match[2] not in letters:
        return None
    return int(match[1]), match[2]


def tolerance(number: int, letter: str, module: float, teeth: int, length: float) -> SplineTolerance:
    """Return the tolerance of class `number` and deviation `letter`; module and length of the spline in mm.

    The deviation of a shaft is the deviation of its thickness. A hub has the letter H and the deviation 0. The pitch diameter
    is at most LARGEST_DIAMETER_MM.
    """
    diameter, width, factor = module * teeth, 0.5 * math.pi * module, CLASS_FACTORS[number]
    of_diameter = 0.004 * diameter + 2.1 if diameter > LINEAR_UNIT_FROM_MM else _unit(diameter)
    total = factor * of_diameter + SPACE_FACTOR * factor * _unit(width)
    (a, b), (c, d), (e, f) = PITCH_FACTORS[number], PROFILE_FACTORS[number], HELIX_FACTORS[number]
    deviations = (
        a * math.sqrt(0.5 * math.pi * diameter) + b,
        c * (module + 0.0125 * diameter) + d,
        e * math.sqrt(length) + f,
    )
    variation = VARIATION_SHARE * math.hypot(*deviations)
    effective = WIDER_LETTERS[letter] * total if letter in WIDER_LETTERS else -fundamental_deviation(letter, diameter)
    return SplineTolerance(MM_PER_UM * effective, MM_PER_UM * total, MM_PER_UM * variation)


def fundamental_deviation(letter: str, diameter: float) -> float:
    """Return the fundamental deviation (um) of a shaft, positive towards thinner teeth; 0 for hubs and thicker shafts."""
    table = FUNDAMENTAL_DEVIATIONS_UM.get(letter)
    return 0.0 if table is None else float(table[range_number(SIZE_LIMITS_MM, diameter)])


def _unit(size: float) -> float:
    """Return the tolerance unit, um, of a size in mm."""
    return float(0.45 * math.cbrt(size) + 0.001 * size)
