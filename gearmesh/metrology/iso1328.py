"""Flank tolerances of ISO 1328-1:2013, by its formulas (5) to (12), its ranges (1) and its rules of rounding (5.2.3).

Each tolerance is that of class 5 times sqrt(2) for every class coarser; form and slope make up the total before any rounding.
Formulas, ranges and rounding were compared with four published programs that name them by number, which agree with each other
(one leaves the diameter out of the profile slope); the standard itself was not at hand. The runout, 0.9 F_pT, is informative there.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from gearmesh.metrology.tolerances import ToleranceSizes

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
#: runout over cumulative pitch
RUNOUT = 0.9


@dataclass(frozen=True)
class CylindricalSizes(ToleranceSizes):
    """Number of teeth, normal module, reference diameter, face width (mm) and helix angle (rad) of a cylindrical gear."""

    standard: ClassVar[str] = "ISO 1328-1:2013"
    names: ClassVar[Mapping[str, str]] = NAMES
    informative: ClassVar[Mapping[str, str]] = {"F_rT": "runout"}
    classes: ClassVar[tuple[int, int]] = (1, 11)
    reference: ClassVar[int] = 5

    teeth: int
    module: float
    diameter: float
    width: float
    helix: float = 0.0

    @property
    def known(self) -> bool:
        ranges = ((self.teeth, TEETH), (self.diameter, DIAMETER), (self.module, MODULE), (self.width, WIDTH))
        return abs(self.helix) <= STEEPEST_HELIX and all(low <= value <= high for value, (low, high) in ranges)

    @property
    def reference_values(self) -> tuple[float, ...]:
        d, m, root_d, root_b = self.diameter, self.module, math.sqrt(self.diameter), math.sqrt(self.width)
        form, slope = 0.55 * m + 5.0, 0.4 * m + 0.001 * d + 4.0
        helix_form, helix_slope = 0.07 * root_d + 0.45 * root_b + 4.0, 0.05 * root_d + 0.35 * root_b + 4.0
        cumulative = 0.002 * d + 0.55 * root_d + 0.7 * m + 12.0
        return (
            0.001 * d + 0.4 * m + 5.0,
            cumulative,
            form,
            slope,
            math.hypot(form, slope),
            helix_form,
            helix_slope,
            math.hypot(helix_form, helix_slope),
            RUNOUT * cumulative,
        )
