"""Where circular-arc gears touch, to first approximation: theta from rack settings and centre distance [LT85 30-36].

    sin(theta) = (dC + b_F - b_P) / (rho_F - rho_P)    (31), without dC (32) and (35)

Lengths and settings in the design's unit, angles in rad.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from gearmesh.systems.circular_arc.design import CircularArcDesign

#: part of the difference of the radii by which settings may miss those of theta0
SAME = 1e-9


def contact_angle(design: CircularArcDesign, change: float = 0.0) -> float:
    """theta (rad) at a `change` dC of the centre distance (31); NaN where no theta has that sine."""
    sine = (change + design.pinion.b - design.gear.b) / _difference(design)
    return float(np.arcsin(sine)) if abs(sine) <= 1.0 else np.nan


def setting_change(design: CircularArcDesign) -> float:
    """Delta b_F that brings theta0 back under the design's dC, b_F and b_P [33, 36]; the gear's b_P needs the opposite."""
    wanted = _difference(design) * np.sin(np.radians(design.pressure_angle))
    return float(wanted - (design.assembly.dC + design.pinion.b - design.gear.b))


def is_off(design: CircularArcDesign) -> bool:
    """Whether dC or the racks' settings take the contact off theta0."""
    return abs(setting_change(design)) > SAME * abs(_difference(design))


def _difference(design: CircularArcDesign) -> float:
    return design.pinion.profile_radius - design.gear.profile_radius
