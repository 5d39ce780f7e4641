"""How the standards of gear accuracy round their tolerances [ISO 1328-1:2013 5.2.3; ISO 17485:2006 5.3]."""

from __future__ import annotations

import math

#: um up to which tolerances are rounded to 0.1 and to 0.5; beyond it is to 1
FINE, MIDDLE = 5.0, 10.0


def round_tolerance(tolerance: float) -> float:
    """A tolerance (um): to 0.1 below 5 um, to 0.5 up to 10 um, to 1 beyond; halves go up."""
    step = 0.1 if tolerance < FINE else 0.5 if tolerance <= MIDDLE else 1.0
    # a tenth has no exact number: what is printed is
    return round(math.floor(tolerance / step + 0.5) * step, 1)
