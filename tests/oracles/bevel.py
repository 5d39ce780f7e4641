"""Proportions of bevel teeth as ISO 23509 suggests them, undercut or not: designs that say them get no others."""

from __future__ import annotations

import numpy as np

from gearmesh.systems.common.bevel.iso23509.pitch_cones import bevel_pitch_angles
from gearmesh.systems.common.bevel.iso23509.tooth_factors import suggested_addendum_factor, suggested_depth_factor


def standard_factors(pinion: int, gear: int, shaft_angle: float = 90.0) -> dict[str, float]:
    """The keys of a pair of teeth on axes at an angle (deg)."""
    angles = bevel_pitch_angles((pinion, gear), float(np.radians(shaft_angle)))
    return {
        "depth_factor": suggested_depth_factor((pinion, gear)),
        "addendum_factor": suggested_addendum_factor((pinion, gear), angles),
    }
