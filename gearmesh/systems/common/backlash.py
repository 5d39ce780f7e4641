"""What flanks give way for backlash."""

from __future__ import annotations

import numpy as np

from gearmesh.errors import DesignError


def thinned(half: float, backlash: float, share: float, alpha: float, whose: str = "") -> float:
    """Half a rack tooth's or space's width (mm) less the share of the normal `backlash` (mm) that this flank gives way.

    `alpha`: pressure angle, rad. Raises DesignError, naming the limit, where nothing is left.
    """
    left = half - share * backlash / np.cos(alpha)
    if left <= 0.0:
        raise DesignError(
            f"backlash = {backlash:g} mm: leaves no tooth{whose}; allowed is less than {half / share * np.cos(alpha):.4g} mm"
        )
    return float(left)
