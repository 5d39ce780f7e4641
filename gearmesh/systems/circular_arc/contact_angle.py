"""Contact angle theta of circular-arc gears in first approximation, from rack settings [LT85 30-36].

    sin(theta) = (dC + b_F - b_P) / (rho_F - rho_P)    (31), without dC (32) and (35)

dC is the change of the centre distance. Lengths and settings are in the design's unit, angles in rad.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from gearmesh.systems.circular_arc.design import CircularArcDesign

#: part of the difference of the radii by which settings may differ from those of theta0
SETTING_TOLERANCE = 1e-9


def contact_angle(design: CircularArcDesign, change: float = 0.0) -> float:
    """Return theta (rad) at a `change` dC of the centre distance (31); NaN if no theta has this sine."""
    sine = (change + design.pinion.b - design.gear.b) / _difference(design)
    return float(np.arcsin(sine)) if abs(sine) <= 1.0 else np.nan


def setting_change(design: CircularArcDesign) -> float:
    """Return Delta b_F that restores theta0 under the design's dC, b_F and b_P [33, 36].

    The gear's b_P needs the opposite change.
    """
    wanted = _difference(design) * np.sin(np.radians(design.pressure_angle))
    return float(wanted - (design.assembly.dC + design.pinion.b - design.gear.b))


def is_off(design: CircularArcDesign) -> bool:
    """True if dC or the racks' settings move the contact away from theta0."""
    return abs(setting_change(design)) > SETTING_TOLERANCE * abs(_difference(design))


def _difference(design: CircularArcDesign) -> float:
    """Return rho_F - rho_P."""
    return design.pinion.profile_radius - design.gear.profile_radius
