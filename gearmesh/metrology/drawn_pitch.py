"""Random pitch deviations of gears within a tolerance class, as grinding with single indexing leaves them.

The teeth have an eccentricity, and every flank has an independent index error. Both components of the eccentricity are
normal with a sixth of the tolerance F_pT as standard deviation. A single pitch deviation is the difference of two index
errors; its standard deviation is a third of the tolerance f_pT:

    sigma_e = F_pT / 6      sigma_i = f_pT / (3 sqrt 2)

A gear with any figure beyond the class is drawn again.
"""

from __future__ import annotations

import math

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.metrology.measured_teeth import InspectionBasis
from gearmesh.metrology.pitch import PitchDeviations
from gearmesh.teeth.region import Side

#: symbols of the single pitch deviation in the two standards
SINGLE_SYMBOLS = ("f_p", "f_pt")
#: symbol of the total cumulative pitch deviation
TOTAL_SYMBOL = "F_p"
#: um in a mm
UM_PER_MM = 1e3
#: standard deviations in a tolerance
SIGMAS_PER_TOLERANCE = 3.0
#: largest number of gears that are drawn
MAX_DRAWS = 10_000


def drawn_pitch(
    basis: InspectionBasis, teeth: int, tolerance_class: int, seed: tuple[int, ...]
) -> dict[Side, PitchDeviations]:
    """Draw the pitch deviations of both sides of a gear of a class. Raises DesignError beyond the range of its
    standard."""
    tolerances = basis.sizes.tolerances(tolerance_class)
    if tolerances is None:
        raise DesignError("accuracy_class", reason=f"the gear is beyond the range of {basis.sizes.standard}")
    single = next(tolerances[f"{symbol}T"] for symbol in SINGLE_SYMBOLS if f"{symbol}T" in tolerances) / UM_PER_MM
    total = tolerances[f"{TOTAL_SYMBOL}T"] / UM_PER_MM
    random = np.random.default_rng(seed)
    for _ in range(MAX_DRAWS):
        x, y = random.normal(0.0, 0.5 * total / SIGMAS_PER_TOLERANCE, 2)
        errors = random.normal(0.0, single / (SIGMAS_PER_TOLERANCE * math.sqrt(2.0)), (2, teeth))
        waves = basis.eccentric(math.hypot(x, y), math.atan2(y, x), teeth)
        pitch_of_side = {
            side: PitchDeviations(waves[side].index + error) for side, error in zip(Side, errors, strict=True)
        }
        if all(pitch.single_pitch <= single and pitch.cumulative <= total for pitch in pitch_of_side.values()):
            return pitch_of_side
    raise DesignError("accuracy_class", tolerance_class, reason=f"no gear of {teeth} teeth was drawn within it")
