"""Pitch deviations of gears within a tolerance class, drawn by a seed, as grinding with single indexing leaves them.

Teeth are off their axis by an eccentricity whose both components are normal, six standard deviations of either the tolerance F_pT,
and every flank by an index error of its own, so that single pitch deviations, of which neighbours share one index error with
the other sign, have a standard deviation of a third of their tolerance:

    sigma_e = F_pT / 6      sigma_i = f_pT / (3 sqrt 2)

Gears any of whose figures are beyond the class are drawn anew.
"""

from __future__ import annotations

import math

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.metrology.measured_teeth import InspectionBasis
from gearmesh.metrology.pitch import PitchDeviations
from gearmesh.teeth.region import Side

#: symbols of the single pitch deviation, and of the total cumulative one
SINGLE, TOTAL = ("f_p", "f_pt"), "F_p"
#: um of a mm, standard deviations in a tolerance, and gears that are drawn at most
UM, SIGMAS, MOST = 1e3, 3.0, 10_000


def drawn_pitch(
    basis: InspectionBasis, teeth: int, tolerance_class: int, seed: tuple[int, ...]
) -> dict[Side, PitchDeviations]:
    """Of both sides of a gear of a class. Raises DesignError beyond the range of its standard."""
    tolerances = basis.sizes.tolerances(tolerance_class)
    if tolerances is None:
        raise DesignError("accuracy_class", reason=f"the gear is beyond the range of {basis.sizes.standard}")
    single = next(tolerances[f"{symbol}T"] for symbol in SINGLE if f"{symbol}T" in tolerances) / UM
    total = tolerances[f"{TOTAL}T"] / UM
    random = np.random.default_rng(seed)
    for _ in range(MOST):
        x, y = random.normal(0.0, 0.5 * total / SIGMAS, 2)
        errors = random.normal(0.0, single / (SIGMAS * math.sqrt(2.0)), (2, teeth))
        waves = basis.eccentric(math.hypot(x, y), math.atan2(y, x), teeth)
        made = {side: PitchDeviations(waves[side].index + own) for side, own in zip(Side, errors, strict=True)}
        if all(own.single_pitch <= single and own.cumulative <= total for own in made.values()):
            return made
    raise DesignError("accuracy_class", tolerance_class, reason=f"no gear of {teeth} teeth was drawn within it")
