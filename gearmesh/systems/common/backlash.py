"""Reduction of flanks for backlash."""

from __future__ import annotations

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.systems.common.bounds import at_most


def thin(half: float, backlash: float, share: float, alpha: float, whose: str = "") -> float:
    """Half a rack tooth's or space's width (mm) less the share of the normal `backlash` (mm) by which this flank is set back.

    `alpha`: pressure angle, rad. Raises DesignError, naming the limit, where nothing is left.
    """
    left = half - share * backlash / np.cos(alpha)
    if left <= 0.0:
        raise DesignError(
            "backlash",
            backlash,
            unit="mm",
            reason=f"leaves no tooth{whose}",
            allowed=f"less than {at_most(half / share * np.cos(alpha))} mm",
        )
    return float(left)
