"""Reduction of flanks for backlash."""

from __future__ import annotations

import numpy as np

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError


def thin(half: float, backlash: float, share: float, alpha: float, whose: str = "") -> float:
    """Return half a width (mm) of a rack's tooth or space, reduced by a share of the normal `backlash` (mm).

    This flank is set back by the share. `alpha`: pressure angle, rad. Raises DesignError, naming the limit, if nothing
    is left.
    """
    left = half - share * backlash / np.cos(alpha)
    if left <= 0.0:
        raise DesignError(
            "backlash",
            backlash,
            unit="mm",
            reason=f"leaves no tooth{whose}",
            allowed=Allowed.less_than(half / share * np.cos(alpha), "mm"),
        )
    return float(left)
