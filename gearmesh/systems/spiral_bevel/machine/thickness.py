"""The mean normal circular thickness s_mn [ISO 23509] of a tooth, from its sides as they are cut: measured, and sides that give it.

It is measured along the pitch cone at the mean cone distance, across the tooth by the mean of both flanks' spiral angles there.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.systems.common.bounds import at_most
from gearmesh.systems.spiral_bevel.machine.pair import Angles, Sides, beside_space
from gearmesh.systems.spiral_bevel.sheet.tooth_measures import PitchLines

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.blank.blank import MemberBlank

#: distance (mm) from the thickness asked for that counts as none, and the most steps to it
REACHED, STEPS = 1e-12, 12
#: point width (mean normal modules) from which on a cutter has one
LEAST_WIDTH = 0.05


def mean_pitch_lines(own: MemberBlank, sides: Sides, places: Angles) -> PitchLines:
    """Where the flanks of a tooth whose sides are at `places` (rad) cross its pitch cone at the mean cone distance."""
    hand = sides["concave"].hand
    flanks = {side.flank: side.side(places[name]).flank for name, side in sides.items()}
    starts = {side.flank: np.array([[side.blade.at_height(own.mean_dedendum), 0.0]]) for side in sides.values()}
    levels = own.stations, own.pitch_cone
    return PitchLines.of(flanks, starts, hand, np.array([own.mean_cone_distance]), levels)


def mean_thickness(own: MemberBlank, sides: Sides, places: Angles) -> float:
    """The thickness (mm) of the same tooth."""
    return float(mean_pitch_lines(own, sides, places).normal_thicknesses[0])


def thin_to(thickness: float, own: MemberBlank, sides: Sides, places: Angles) -> float:
    """Rotation (rad) by which each flank has to be set back for a thickness (mm).

    A flank that turns about the axis keeps the radius and the spiral angle of its pitch line: no iteration.
    """
    lines = mean_pitch_lines(own, sides, places)
    return 0.5 * (float(lines.normal_thicknesses[0]) - thickness) / (float(lines.across[0]) * own.mean_radius)


def cut_to(thickness: float, own: MemberBlank, module: float, cut_by: Callable[[float], Sides]) -> Sides:
    """The gear's sides of the point width with which its tooth has a thickness (mm): of those that are `cut_by` point widths (mm).

    A blade that stands closer to the middle of the space by some makes the tooth thicker by about as much: a few secant steps.
    Raises DesignError where no cutter has that point width; `module` is the mean normal one, mm.
    """

    def measure(width: float) -> tuple[Sides, float]:
        sides = cut_by(width)
        return sides, mean_thickness(own, sides, beside_space(sides, own.teeth)) - thickness

    least = LEAST_WIDTH * module
    sides, thin = measure(least)
    if not thin >= 0.0:
        raise DesignError(
            "gear.thickness",
            thickness,
            unit="mm",
            reason="the cutter would have no point width",
            allowed=f"at most {at_most(thickness + thin)} mm",
        )
    width, slope = least, -1.0
    for _ in range(STEPS):
        if abs(thin) <= REACHED:
            break
        step = -thin / slope
        sides, now = measure(width + step)
        width, slope, thin = width + step, (now - thin) / step, now
    return sides
