"""Mean normal circular thickness s_mn [ISO 23509] of a tooth by its cut sides, and sides that have a given thickness.

The thickness is along the pitch cone at the mean cone distance, across the tooth by the mean of both flanks' spiral
angles there.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError
from gearmesh.systems.common.bevel.tooth_measures import PitchLines
from gearmesh.systems.spiral_bevel.machine.pair import Angles, Sides, beside_space

if TYPE_CHECKING:
    from gearmesh.systems.common.bevel.blank import MemberBlank

#: distance (mm) from the given thickness that counts as 0
THICKNESS_TOLERANCE_MM = 1e-12
#: largest number of secant steps to the given thickness
MAX_SECANT_STEPS = 12
#: least point width of a cutter (mean normal modules)
MIN_POINT_WIDTH_MODULES = 0.05


def mean_pitch_lines(member: MemberBlank, sides: Sides, places: Angles) -> PitchLines:
    """Return the points at which the flanks of a tooth cross its pitch cone at the mean cone distance.

    `places`: index positions of the sides, rad.
    """
    hand = sides["concave"].hand
    flanks = {side.flank: side.side(places[name]).flank for name, side in sides.items()}
    starts = {side.flank: np.array([[side.blade.at_height(member.mean_dedendum), 0.0]]) for side in sides.values()}
    levels = member.stations, member.pitch_cone
    return PitchLines.of(flanks, starts, hand, np.array([member.mean_cone_distance]), levels)


def mean_thickness(member: MemberBlank, sides: Sides, places: Angles) -> float:
    """Return the mean normal circular thickness (mm) of a tooth whose sides are at `places` (rad)."""
    return float(mean_pitch_lines(member, sides, places).normal_thicknesses[0])


def thin_to(thickness: float, member: MemberBlank, sides: Sides, places: Angles) -> float:
    """Return the rotation (rad) that sets each flank back to a thickness (mm).

    A flank turned about the axis keeps the radius and the spiral angle of its pitch line, so that no iteration is
    needed.
    """
    lines = mean_pitch_lines(member, sides, places)
    return 0.5 * (float(lines.normal_thicknesses[0]) - thickness) / (float(lines.across[0]) * member.mean_radius)


def cut_to(thickness: float, own: MemberBlank, module: float, cut_by: Callable[[float], Sides]) -> Sides:
    """Return the gear's sides whose tooth has a thickness (mm).

    - `own`: blank of the gear
    - `module`: mean normal module, mm
    - `cut_by`: returns the sides of a point width (mm)

    A smaller point width makes the tooth thicker by about the same amount; a few secant steps suffice. Raises
    DesignError if no cutter has the necessary point width.
    """

    def measure(width: float) -> tuple[Sides, float]:
        sides = cut_by(width)
        return sides, mean_thickness(own, sides, beside_space(sides, own.teeth)) - thickness

    # the least point width gives the thickest tooth
    least = MIN_POINT_WIDTH_MODULES * module
    sides, thin = measure(least)
    if not thin >= 0.0:
        raise DesignError(
            "gear.thickness",
            thickness,
            unit="mm",
            reason="the cutter would have no point width",
            allowed=Allowed.at_most(thickness + thin, "mm"),
        )
    # secant steps from there; the first slope is that of a blade without lean
    width, slope = least, -1.0
    for _ in range(MAX_SECANT_STEPS):
        if abs(thin) <= THICKNESS_TOLERANCE_MM:
            break
        step = -thin / slope
        sides, now = measure(width + step)
        width, slope, thin = width + step, (now - thin) / step, now
    return sides
