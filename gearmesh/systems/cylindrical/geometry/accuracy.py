"""Flank tolerances of ISO 1328-1:2013, by its formulas (5) to (12), its ranges (1) and its rules of rounding (5.2.3).

Each tolerance is that of class 5 times sqrt(2) for every class coarser; form and slope make up the total before any rounding.
Formulas, ranges and rounding were compared with four published programs that name them by number, which agree with each other
(one leaves the diameter out of the profile slope); the standard itself was not at hand.
"""

from __future__ import annotations

import math

from gearmesh.systems.common.standards.tolerance_rounding import round_tolerance
from gearmesh.systems.cylindrical.geometry.geometry import Toothing

#: what tolerances are called, by symbol, in the order of the standard
NAMES = {
    "f_pT": "single pitch",
    "F_pT": "cumulative pitch",
    "f_faT": "profile form",
    "f_HaT": "profile slope",
    "F_aT": "profile, total",
    "f_fbT": "helix form",
    "f_HbT": "helix slope",
    "F_bT": "helix, total",
}
#: largest helix angle, rad, and ranges of teeth, diameter, module and width (mm)
STEEPEST_HELIX = math.radians(45.0)
TEETH, DIAMETER, MODULE, WIDTH = (5, 1000), (5.0, 15000.0), (0.5, 70.0), (4.0, 1200.0)


def tolerances(accuracy_class: int, teeth: Toothing, width: float) -> dict[str, float] | None:
    """Tolerances (um) by their symbols, of teeth with a face `width`, all in mm; None beyond the range of the standard."""
    d, m = 2.0 * teeth.radius, teeth.module
    ranges = ((teeth.teeth, TEETH), (d, DIAMETER), (m, MODULE), (width, WIDTH))
    if abs(teeth.beta) > STEEPEST_HELIX or not all(low <= value <= high for value, (low, high) in ranges):
        return None
    form, slope = 0.55 * m + 5.0, 0.4 * m + 0.001 * d + 4.0
    helix_form = 0.07 * math.sqrt(d) + 0.45 * math.sqrt(width) + 4.0
    helix_slope = 0.05 * math.sqrt(d) + 0.35 * math.sqrt(width) + 4.0
    values = (
        0.001 * d + 0.4 * m + 5.0,
        0.002 * d + 0.55 * math.sqrt(d) + 0.7 * m + 12.0,
        form,
        slope,
        math.hypot(form, slope),
        helix_form,
        helix_slope,
        math.hypot(helix_form, helix_slope),
    )
    # exact where it is a whole power of 2: halves are halves
    factor = 2.0 ** (0.5 * (accuracy_class - 5))
    return {symbol: round_tolerance(factor * value) for symbol, value in zip(NAMES, values, strict=True)}
