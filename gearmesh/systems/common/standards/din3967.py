"""Tooth thickness allowances of DIN 3967:1978, tables 1 and 2: upper allowances by letter, tolerances by series.

Both depend on the reference diameter. The tables agree in all values with a published program, and with the worked
example of the standard (27 cd, 100 mm: -70 and -170 um). The standard itself was not at hand.
"""

from __future__ import annotations

import re

from gearmesh.errors import nearest
from gearmesh.systems.common.standards.size_ranges import range_number

#: largest reference diameter of each range, which begins above the limit before it
DIAMETER_LIMITS_MM = (10, 50, 125, 280, 560, 1000, 1600, 2500, 4000, 6300, 10000)
#: upper allowances A_sne by letter
UPPER_ALLOWANCES_UM = {
    "a": (-100, -135, -180, -250, -330, -450, -600, -820, -1100, -1500, -2000),
    "ab": (-85, -110, -150, -200, -280, -370, -500, -680, -920, -1250, -1650),
    "b": (-70, -95, -125, -170, -230, -310, -420, -560, -760, -1020, -1350),
    "bc": (-58, -75, -105, -140, -190, -260, -340, -460, -620, -840, -1150),
    "c": (-48, -65, -85, -115, -155, -210, -290, -390, -520, -700, -940),
    "cd": (-40, -54, -70, -95, -130, -175, -240, -320, -430, -580, -780),
    "d": (-33, -44, -60, -80, -110, -145, -200, -270, -360, -480, -640),
    "e": (-22, -30, -40, -56, -75, -100, -135, -180, -250, -330, -450),
    "f": (-10, -14, -19, -26, -35, -48, -64, -85, -115, -155, -210),
    "g": (-5, -7, -9, -12, -17, -22, -30, -41, -56, -75, -100),
    "h": (0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0),
}
#: tolerances T_sn by series
TOLERANCE_SERIES_UM = {
    21: (3, 5, 6, 8, 10, 12, 16, 20, 25, 30, 40),
    22: (5, 8, 10, 12, 16, 20, 25, 30, 40, 50, 60),
    23: (8, 12, 16, 20, 25, 30, 40, 50, 60, 80, 100),
    24: (12, 20, 25, 30, 40, 50, 60, 80, 100, 130, 160),
    25: (20, 30, 40, 50, 60, 80, 100, 130, 160, 200, 250),
    26: (30, 50, 60, 80, 100, 130, 160, 200, 250, 300, 400),
    27: (50, 80, 100, 130, 160, 200, 250, 300, 400, 500, 600),
    28: (80, 130, 160, 200, 250, 300, 400, 500, 600, 800, 1000),
    29: (130, 200, 250, 300, 400, 500, 600, 800, 1000, 1300, 1600),
    30: (200, 300, 400, 500, 600, 800, 1000, 1300, 1600, 2000, 2400),
}
#: millimetres in a micrometre
MM_PER_UM = 1e-3


def _parts(text: str) -> tuple[str, str] | None:
    """Return letter and series of a text such as "cd25", or "25 cd" as on drawings; None for other texts."""
    match = re.fullmatch(r"\s*(?:([A-Za-z]+)\s*(\d+)|(\d+)\s*([A-Za-z]+))\s*", text, re.ASCII)
    return None if match is None else (match[1] or match[4], match[2] or match[3])


def refusal(text: str) -> str:
    """Return the allowed letters and series, with the nearest, if a text has other ones; "" if it is allowed."""
    letters, series = ", ".join(UPPER_ALLOWANCES_UM), f"{min(TOLERANCE_SERIES_UM)} to {max(TOLERANCE_SERIES_UM)}"
    allowed = f'a letter ({letters}) and a tolerance series ({series}), as "cd25"'
    parts = _parts(text)
    if parts is None:
        return allowed
    letter, number = parts
    near_letter = letter if letter in UPPER_ALLOWANCES_UM else nearest(letter.lower(), UPPER_ALLOWANCES_UM)
    near_number = min(max(int(number), min(TOLERANCE_SERIES_UM)), max(TOLERANCE_SERIES_UM))
    if letter in UPPER_ALLOWANCES_UM and int(number) == near_number:
        return ""
    return allowed if near_letter is None else f'{allowed}; the nearest is "{near_letter}{near_number}"'


def allowances(text: str, diameter: float) -> tuple[float, float]:
    """Return upper and lower allowance A_sne and A_sni = A_sne - T_sn, mm, of an allowed text.

    `diameter`: reference diameter (mm), up to the last of DIAMETER_LIMITS_MM.
    """
    parts = _parts(text)
    assert parts is not None
    row = range_number(DIAMETER_LIMITS_MM, diameter)
    upper = UPPER_ALLOWANCES_UM[parts[0]][row]
    return MM_PER_UM * upper, MM_PER_UM * (upper - TOLERANCE_SERIES_UM[int(parts[1])][row])
