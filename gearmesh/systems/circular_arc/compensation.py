"""Settings that bring the contact of circular-arc gears back to theta0 [LT85 33-37].

A changed centre distance, and racks whose b_F and b_P do not match, move the contact along the profile. The setting b
of the refinished member compensates this (33)-(36). Misaligned axes and unequal lead angles give a transmission error
that grows with phi1. The lead angle of the refinished member compensates it.

The paper's formulas are first approximations (`contact_angle`). Here both values are solved on the exact contact.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gearmesh.contact.flanks import analyse
from gearmesh.contact.path import ContactPath
from gearmesh.errors import NoSolutionError
from gearmesh.kernel.numeric.algebra import ARCSEC, Array
from gearmesh.systems.circular_arc.build import build
from gearmesh.systems.circular_arc.contact_angle import contact_angle, is_off, setting_change
from gearmesh.systems.common.restoring import restoring
from gearmesh.systems.system import Setting

if TYPE_CHECKING:
    from gearmesh.systems.circular_arc.design import CircularArcDesign

#: pinion rotations (rad) between which the slope of the transmission error is measured
SLOPE_RANGE = np.radians((-5.0, 5.0))


def compensate(design: CircularArcDesign, member: str = "pinion") -> list[Setting]:
    """Return setting b and lead angle of the refinished `member`, for theta_F = theta0 and a uniform ratio.

    Raises NoSolutionError if no setting restores the contact.
    """
    nominal = np.radians(design.pressure_angle)
    spec = design.pinion if member == "pinion" else design.gear
    setting, lead = f"{member}.b", f"{member}.lead_angle"
    values = {setting: spec.b, lead: spec.lead_angle}

    def errors(trial: dict[str, float]) -> Array:
        path = _contact(design.with_values(trial))
        slope = (path.te[2] - path.te[0]) / np.ptp(SLOPE_RANGE)
        return np.array([path.params1[1, 0] - nominal, slope])

    # only the values whose error does not vanish are free: b if theta is off, the lead angle if the error has a slope
    errors_before = errors(values)
    has_slope = design.assembly.dgamma != 0.0 or design.pinion.lead_angle != design.gear.lead_angle
    wanted = {setting: is_off(design), lead: has_slope}
    free = [key for key, needed in wanted.items() if needed]
    rows = [list(values).index(key) for key in free]
    solved = restoring(lambda trial: errors(trial)[rows], values, free)
    errors_after = errors(solved)
    first_approximation = np.degrees(contact_angle(design, design.assembly.dC))
    effects = {
        setting: "theta_F at phi1 = 0 from {:.4f} to {:.4f} deg; before by (31) {:.5f}".format(
            *np.degrees(nominal + np.array([errors_before[0], errors_after[0]])), first_approximation
        ),
        lead: "TE per degree of phi1 from {:.5f} to {:.5f} arcsec".format(
            *(np.radians(1.0) / ARCSEC * np.array([errors_before[1], errors_after[1]]))
        ),
    }
    units = {setting: design.units, lead: "deg"}
    return [Setting(key, values[key], solved[key], units[key], effects[key]) for key in values]


def _contact(design: CircularArcDesign) -> ContactPath:
    """Return the contact at both ends of SLOPE_RANGE and at 0."""
    path = analyse(build(design.in_mm()).pairs[0], np.array([SLOPE_RANGE[0], 0.0, SLOPE_RANGE[1]]))
    if (path.kind != "point").any():
        raise NoSolutionError(
            reason="the contact leaves the flanks, so its position cannot be compensated",
            remedy=f"reduce the assembly errors, or start from pinion.b = {design.pinion.b + setting_change(design):.6g}"
            " [LT85 36]",
        )
    return path
