"""Tolerances of bevel and hypoid gears by ISO 17485:2006, 5.4: pitch and runout of one member, by its grade of accuracy.

Each is that of grade 4 times sqrt(2) for every grade coarser, and follows from the mean normal module and the tolerance diameter
d_T, in the middle of the working depth at the mean cone distance. The ranges were compared with the standard's scope as it is
published; the standard itself was not at hand.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar

from gearmesh.metrology.tolerances import ToleranceSizes

#: what tolerances are called, by symbol
NAMES = {"f_ptT": "single pitch", "F_pT": "total cumulative pitch", "F_rT": "runout"}
#: ranges of teeth, tolerance diameter and mean normal module (mm)
TEETH, DIAMETER, MODULE = (5, 400), (5.0, 2500.0), (1.0, 50.0)
#: runout over cumulative pitch
RUNOUT = 0.8


@dataclass(frozen=True)
class BevelSizes(ToleranceSizes):
    """Number of teeth, tolerance diameter d_T and mean normal module (mm) of a bevel or hypoid gear."""

    standard: ClassVar[str] = "ISO 17485:2006"
    names: ClassVar[Mapping[str, str]] = NAMES
    informative: ClassVar[Mapping[str, str]] = {}
    classes: ClassVar[tuple[int, int]] = (2, 11)
    reference: ClassVar[int] = 4

    teeth: int
    diameter: float
    module: float

    @property
    def known(self) -> bool:
        ranges = ((self.teeth, TEETH), (self.diameter, DIAMETER), (self.module, MODULE))
        return all(low <= value <= high for value, (low, high) in ranges)

    @property
    def reference_values(self) -> tuple[float, ...]:
        cumulative = 0.025 * self.diameter + 0.3 * self.module + 19.0
        return 0.003 * self.diameter + 0.3 * self.module + 5.0, cumulative, RUNOUT * cumulative
