"""Flank tolerances of ISO 1328-1:2013: formulas (5) to (12), ranges (1) and rounding rules (5.2.3).

A tolerance is that of class 5 times sqrt(2) for every coarser class. Form and slope are combined to the total before
rounding. Formulas, ranges and rounding were compared with four published programs that quote them by number. The
programs agree with each other, except that one neglects the diameter in the profile slope. The standard itself was not
at hand. The runout, 0.9 F_pT, is informative there.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import ClassVar

from gearmesh.metrology.tolerances import ToleranceSizes
from gearmesh.records import dataclass

#: names of the tolerances by symbol, in the order of the standard
TOLERANCE_NAMES = {
    "f_pT": "single pitch",
    "F_pT": "cumulative pitch",
    "f_faT": "profile form",
    "f_HaT": "profile slope",
    "F_aT": "profile, total",
    "f_fbT": "helix form",
    "f_HbT": "helix slope",
    "F_bT": "helix, total",
}
#: largest helix angle, rad, of the standard
MAX_HELIX = math.radians(45.0)
#: numbers of teeth of the standard
TEETH_RANGE = (5, 1000)
#: reference diameters of the standard, mm
DIAMETER_RANGE_MM = (5.0, 15000.0)
#: normal modules of the standard, mm
MODULE_RANGE_MM = (0.5, 70.0)
#: face widths of the standard, mm
WIDTH_RANGE_MM = (4.0, 1200.0)
#: runout over cumulative pitch
RUNOUT_RATIO = 0.9


@dataclass(frozen=True)
class CylindricalSizes(ToleranceSizes):
    """Sizes of a cylindrical gear from which its tolerances follow."""

    #: designation of the standard
    standard: ClassVar[str] = "ISO 1328-1:2013"
    #: names of the deciding tolerances, by symbol
    names: ClassVar[Mapping[str, str]] = TOLERANCE_NAMES
    #: names of tolerances that do not decide the class
    informative: ClassVar[Mapping[str, str]] = {"F_rT": "runout"}
    #: finest and coarsest class
    classes: ClassVar[tuple[int, int]] = (1, 11)
    #: class of `reference_values`
    reference: ClassVar[int] = 5

    #: number of teeth
    teeth: int
    #: normal module, mm
    module: float
    #: reference diameter, mm
    diameter: float
    #: face width, mm
    width: float
    #: helix angle, rad
    helix: float = 0.0

    @property
    def known(self) -> bool:
        ranges = (
            (self.teeth, TEETH_RANGE),
            (self.diameter, DIAMETER_RANGE_MM),
            (self.module, MODULE_RANGE_MM),
            (self.width, WIDTH_RANGE_MM),
        )
        return abs(self.helix) <= MAX_HELIX and all(low <= value <= high for value, (low, high) in ranges)

    @property
    def reference_values(self) -> tuple[float, ...]:
        diameter, module, root_diameter, root_width = (
            self.diameter,
            self.module,
            math.sqrt(self.diameter),
            math.sqrt(self.width),
        )
        form, slope = 0.55 * module + 5.0, 0.4 * module + 0.001 * diameter + 4.0
        helix_form, helix_slope = (
            0.07 * root_diameter + 0.45 * root_width + 4.0,
            0.05 * root_diameter + 0.35 * root_width + 4.0,
        )
        cumulative = 0.002 * diameter + 0.55 * root_diameter + 0.7 * module + 12.0
        return (
            0.001 * diameter + 0.4 * module + 5.0,
            cumulative,
            form,
            slope,
            math.hypot(form, slope),
            helix_form,
            helix_slope,
            math.hypot(helix_form, helix_slope),
            RUNOUT_RATIO * cumulative,
        )
