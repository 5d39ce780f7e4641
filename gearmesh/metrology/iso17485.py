"""Tolerances of bevel and hypoid gears by ISO 17485:2006, 5.4: pitch and runout of one member, by its accuracy grade.

A tolerance is that of grade 4 times sqrt(2) for every coarser grade. It follows from the mean normal module and the
tolerance diameter d_T, which lies in the middle of the working depth at the mean cone distance. The ranges were
compared with the published scope of the standard; the standard itself was not at hand.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from gearmesh.metrology.tolerances import ToleranceSizes
from gearmesh.records import dataclass

#: names of the tolerances by symbol
TOLERANCE_NAMES = {"f_ptT": "single pitch", "F_pT": "total cumulative pitch", "F_rT": "runout"}
#: numbers of teeth of the standard
TEETH_RANGE = (5, 400)
#: tolerance diameters of the standard, mm
DIAMETER_RANGE_MM = (5.0, 2500.0)
#: mean normal modules of the standard, mm
MODULE_RANGE_MM = (1.0, 50.0)
#: runout over cumulative pitch
RUNOUT_RATIO = 0.8


@dataclass(frozen=True)
class BevelSizes(ToleranceSizes):
    """Sizes of a bevel or hypoid gear from which its tolerances follow."""

    #: designation of the standard
    standard: ClassVar[str] = "ISO 17485:2006"
    #: names of the deciding tolerances, by symbol
    names: ClassVar[Mapping[str, str]] = TOLERANCE_NAMES
    #: names of tolerances that do not decide the class
    informative: ClassVar[Mapping[str, str]] = {}
    #: finest and coarsest class
    classes: ClassVar[tuple[int, int]] = (2, 11)
    #: class of `reference_values`
    reference: ClassVar[int] = 4

    #: number of teeth
    teeth: int
    #: tolerance diameter d_T, mm
    diameter: float
    #: mean normal module, mm
    module: float

    @property
    def known(self) -> bool:
        ranges = ((self.teeth, TEETH_RANGE), (self.diameter, DIAMETER_RANGE_MM), (self.module, MODULE_RANGE_MM))
        return all(low <= value <= high for value, (low, high) in ranges)

    @property
    def reference_values(self) -> tuple[float, ...]:
        cumulative = 0.025 * self.diameter + 0.3 * self.module + 19.0
        return 0.003 * self.diameter + 0.3 * self.module + 5.0, cumulative, RUNOUT_RATIO * cumulative
