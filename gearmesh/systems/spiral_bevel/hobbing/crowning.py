"""Crowning of flanks that one tool surface generates on both members: curvatures, and the contact that they give.

On the tool's surface x is along the tooth, and y across it, up the blade. An eccentricity of the head parts both flanks
lengthwise, hollow blades along the profile, by (k_x x^2 + 2 c k_x x y + k_y y^2) / 2. They touch where this gap is least
on the line that generates at the roll phi, g_x x + g_y y = phi. With T = k_x (g_y^2 - 2 c g_x g_y) + k_y g_x^2 the gap
there is phi^2 (k_x k_y - c^2 k_x^2) / (2 T). The difference of curvatures along the line is T / (g_x^2 + g_y^2). The
flanks part from the path to all sides.

Beside the line the members part from the tool's surfaces by C (g_x x + g_y y - phi)^2 / 2. With k the gap's second
derivative by phi along the path above, that of both members is k C / (k + C). The determinant of the difference of their
curvatures is T (k + C), and its trace k_x + k_y + C (g_x^2 + g_y^2).
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearmesh.kernel.numeric.algebra import Array, cross, unit
from gearmesh.kernel.surface.surface import Jet
from gearmesh.systems.spiral_bevel.synthesis.local_synthesis import (
    ContactAsked,
    MeanContact,
    conjugate_operator,
    contact_of,
    relative_motion,
)

#: least difference of curvatures along the contact line, over the least one that has the transmission error
MIN_CURVATURE_RATIO = 1.3
#: rounds to the lines of contact of a crowned head; each leaves a few per cent of the change
CROWNING_ROUNDS = 6
#: largest share of the gap's flexibility that is beside the lines of contact
MAX_BESIDE_SHARE = 0.5


def crown_curvatures(
    slopes: tuple[float, float, float], stiffness: float, total: float, *, lengthwise: bool = True
) -> tuple[float, float]:
    """Return the curvatures k_x and k_y (1/mm) with a gap of stiffness phi^2 / 2 on the path.

    A shorter ellipse is taken where `total` leaves no such gap, or only with a path along the face.

    - `slopes`: g_x, g_y (rad/mm) and c
    - `stiffness`: second derivative of the gap by the roll, mm
    - `total`: T, the difference of curvatures along the contact line times g_x^2 + g_y^2
    - `lengthwise`: the solution with more crowning lengthwise, whose path is more across the teeth
    """
    g_x, g_y, twist = slopes
    sheared = g_y - twist * g_x
    least = 4.0 * g_x**2 * sheared**2 * stiffness
    total = max(total, MIN_CURVATURE_RATIO * least)
    root = np.sqrt(total**2 - least * total)
    k_x = (total + (root if lengthwise else -root)) / (2.0 * sheared**2)
    k_y = (total - k_x * (g_y**2 - 2.0 * twist * g_x * g_y)) / g_x**2
    return float(k_x), float(k_y)


def directed_curvatures(slopes: tuple[float, float, float], total: float, share: float) -> tuple[float, float]:
    """Return the curvatures k_x and k_y (1/mm) whose path has a direction between two.

    At a `share` of 0 there is no crowning of the profile, at 1 the path is along the tooth; below 0 blades are convex.

    - `slopes`, `total`: as for `crown_curvatures`
    """
    g_x, g_y, twist = slopes
    angle = 0.5 * np.pi * share
    # both parts of T are in equal units: crowning lengthwise, and along the profile
    k_x, k_y = np.cos(angle), np.sin(angle) * (g_y / g_x) ** 2
    scale = total / (k_x * (g_y**2 - 2.0 * twist * g_x * g_y) + k_y * g_x**2)
    return float(scale * k_x), float(scale * k_y)


def crown_gear_curvatures(
    slopes: tuple[float, float, float], stiffness: float, least: float, parting: float, most: float
) -> tuple[float, float]:
    """Return the curvatures k_x and k_y (1/mm) with which the members have a gap of stiffness phi^2 / 2 on the path.

    - `slopes`, `stiffness`: as for `crown_curvatures`
    - `least`: least difference of the members' curvatures, along the ellipse, 1/mm
    - `parting`: C, mm
    - `most`: largest k_x, 1/mm; a larger one is taken only where that leaves no such gap
    """
    g_x, g_y, twist = slopes
    square = g_x**2 + g_y**2
    # the members yield beside the line as well
    stiffness /= 1.0 - min(stiffness / parting, MAX_BESIDE_SHARE)
    total = square * least
    for _ in range(CROWNING_ROUNDS):
        k_x, k_y = crown_curvatures(slopes, stiffness, total)
        total = least * (parting * square + k_x + k_y - least) / (stiffness + parting)
    if k_x > most > MIN_CURVATURE_RATIO * stiffness * g_x**2:
        k_x = most
        across = stiffness * (g_y**2 - 2.0 * twist * g_x * g_y) + twist**2 * k_x
        k_y = k_x * across / (k_x - stiffness * g_x**2)
    return k_x, k_y


def crowned_contact(
    gear: MeanContact,
    jet: Jet,
    twist: float,
    asked: ContactAsked,
    *,
    lengthwise: bool = True,
    share: float | None = None,
) -> ContactAsked:
    """Return the contact of a pinion that the head of its gear cuts in the gear's place, crowned, for a lag and an ellipse.

    Direction of the path and length of the ellipse are those of the crowned head.

    - `gear`: the gear, not generated, at the mean point
    - `jet`: its flank there, in the pinion's frame, with r_v along the sweep of the blade
    - `twist`: c
    - `asked`: derivative of the ratio, and longest ellipse
    - `lengthwise`: as for `crown_curvatures`
    - `share`: direction of the path, as for `directed_curvatures`; the lag is then that of the head alone
    """
    sliding, turning, rest = relative_motion(gear)
    x = unit(jet.r_v)
    basis = np.stack((x, cross(jet.n, x)))
    moved = float(gear.normal @ np.cross(gear.spin2, gear.point - gear.origin2))
    flexible, crowned = 1.0 / abs(asked.ratio_derivative * moved), gear
    for _ in range(CROWNING_ROUNDS):
        # the crowned head generates the pinion: its curvatures, too, turn the lines of contact
        across = turning + (crowned.gear_operator - gear.gear_operator) @ sliding
        g_x, g_y = (basis @ across / rest).tolist()
        total = (g_x**2 + g_y**2) * 2.0 * asked.delta / asked.semi_major_axis**2
        # beside the line the pinion parts from the crowned head as well
        beside = (across @ sliding - rest) / rest**2
        stiffness = 1.0 / (flexible - min(float(beside), MAX_BESIDE_SHARE * flexible))
        slopes = g_x, g_y, twist
        k_x, k_y = (
            crown_curvatures(slopes, stiffness, total, lengthwise=lengthwise)
            if share is None
            else directed_curvatures(slopes, total, share)
        )
        gap: Array = basis.T @ np.array([[k_x, twist * k_x], [twist * k_x, k_y]]) @ basis
        crowned = replace(gear, gear_operator=gear.gear_operator - gap)
    return contact_of(conjugate_operator(crowned), gear, asked.delta)
