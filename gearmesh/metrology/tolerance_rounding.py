"""Rounding of tolerances in the standards of gear accuracy [ISO 1328-1:2013 5.2.3; ISO 17485:2006 5.3]."""

from __future__ import annotations

import math

#: um, below which tolerances are rounded to 0.1 um
MAX_TENTH_UM = 5.0
#: um, up to which larger tolerances are rounded to 0.5 um; beyond, to 1 um
MAX_HALF_UM = 10.0


def round_tolerance(tolerance: float) -> float:
    """Round a tolerance (um): to 0.1 below 5 um, to 0.5 up to 10 um, to 1 beyond; halves are rounded up."""
    step = 0.1 if tolerance < MAX_TENTH_UM else 0.5 if tolerance <= MAX_HALF_UM else 1.0
    # a tenth has no exact binary value: return the number that prints as the tolerance
    return round(math.floor(tolerance / step + 0.5) * step, 1)
