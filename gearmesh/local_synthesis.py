"""Local synthesis: pinion machine settings that give the contact asked for at the mean point [AB; Litvin & Lee].

Everything is in the pinion's own frame (z along its axis from the apex to the heel), where the pinion stands as it is
being cut: the blank turns with unit rate about z, the cradle with the ratio of roll m about its axis c, which points
from the cutter into the blank. n is the outward normal of the pinion at the mean point B, and all shape operators
K (3, 3) are taken with it: dn = -K dr in the tangent plane.

1. The contact. With w12 = w1 - w2 and v12 = v1 - v2 at B, contact in the neighbourhood asks for [AB 8; CR3553 1.1]

       (K1 - K2) u1 = b,   b = w12 x n + K2 v12,   u2 = u1 + v12,
       -b . u2 + n . (w2 x v12 ...) + ... = m2' n . (axis2 x (B - O2)),    m2' = d2(phi2)/d(phi1)2

   where u1, u2 are the velocities of the contact point over pinion and gear. The direction of u2 is given, the second
   equation gives its length; K1 - K2 has the eigenvalue -2 delta / a^2 along the ellipse's major axis, and the first
   equation gives the rest of it.
2. The tool. Its normal at B is n, which gives the blade angle; the pinion is the envelope of the tool, so that
   K1 - Kt is of rank one [AB 17-19], which gives the cutter's radius; direction and size of that rank-one part are
   linear in the ratio of roll [AB 20-50], which gives m and the sliding velocity, hence the machine centre [AB 51, 52];
   the position of B gives radial setting and cradle angle [AB 53-56].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.errors import NoSolutionError
from gearmesh.frames import AXIS, Array


@dataclass(frozen=True)
class ContactAsked:
    """What the contact shall be at the mean point.

    `ratio_derivative`: (d2 phi2 / d phi1^2) / (N1/N2), phi1 growing as the pinion turns, rad^-1 (Table 2 of [AB]);
    `path_angle` (rad): direction in which the contact moves over the gear, up to sign, from the gear's lengthwise principal
    direction, taken towards the toe, towards the gear's root; `semi_major_axis` (mm) of the ellipse for `delta` (mm).
    """

    ratio_derivative: float
    path_angle: float
    semi_major_axis: float
    delta: float


@dataclass(frozen=True)
class MeanContact:
    """The gear at the mean point: point B and n (3,), its shape operator K2 (3, 3), and directions `lengthwise` (towards
    the toe) and `profilewise` (towards the gear's root), unit vectors along its principal directions.

    `spin1`, `spin2` (3,) are the angular velocities per unit of phi1 at the nominal ratio, `origin2` (3,) a point of the gear's axis; the
    pinion's axis passes through the origin.
    """

    point: Array
    normal: Array
    gear_operator: Array
    lengthwise: Array
    profilewise: Array
    spin1: Array
    spin2: Array
    origin2: Array


@dataclass(frozen=True)
class ToolSettings:
    """What the mean contact leaves of a pinion's settings, in the machine plane: `root` along the machine root line from the
    apex to the heel, `across` = cradle axis x root line (mm, rad).

    `centre`: machine centre (root, across); `cutter`: cutter centre less machine centre; `radius`, `height`: the cutter's at the mean point.
    """

    blade_angle: float
    radius: float
    height: float
    ratio_of_roll: float
    centre: tuple[float, float]
    cutter: tuple[float, float]


def pinion_operator(gear: MeanContact, asked: ContactAsked) -> Array:
    """Shape operator K1 (3, 3) of the pinion that gives the contact asked for.

    Raises NoSolutionError where the flanks would have to cut into each other.
    """
    b, n = gear.point, gear.normal
    w12 = gear.spin1 - gear.spin2
    v1, v2 = np.cross(gear.spin1, b), np.cross(gear.spin2, b - gear.origin2)
    v12 = v1 - v2
    operator = gear.gear_operator
    turning = np.cross(w12, n) + operator @ v12
    direction = np.cos(asked.path_angle) * gear.lengthwise + np.sin(asked.path_angle) * gear.profilewise
    # d/dt (n . v12) = 0, per unit of phi1; axis2 x (B - O2) scales with the gear's speed, hence the normalised derivative
    rest = np.cross(gear.spin2, n) @ v12 + n @ np.cross(w12, v2) - asked.ratio_derivative * (n @ v2)
    over_gear = direction * (rest / (turning @ direction))
    over_pinion = over_gear - v12
    flat = -2.0 * asked.delta / asked.semi_major_axis**2
    across = turning - flat * over_pinion
    share = across @ over_pinion
    if not share < 0.0:
        raise NoSolutionError(
            "no pinion gives this contact without cutting into the gear: change the path angle, "
            "the parabola or the length of the ellipse"
        )
    tangent = np.eye(3) - np.outer(n, n)
    return operator + flat * tangent + np.outer(across, across) / share


def tool_settings(
    operator: Array, point: Array, normal: Array, cradle: Array, side: int, blade_curvature: float, tip_plane: float
) -> ToolSettings:
    """Settings of the tool whose envelope has the given point, normal and shape operator (see the module's text).

    `cradle` is the cradle axis (3,); `side` +1 for outside, -1 for inside blades; `blade_curvature` 1/R of the blade
    (1/mm; 0 straight, > 0 convex); `tip_plane` (mm) the tip plane's position along the cradle axis from the apex.
    Raises NoSolutionError where no cutter of that side does it.
    """
    sin_blade = -float(normal @ cradle)
    cos_blade = float(np.sqrt(1.0 - sin_blade**2))
    e1 = np.cross(cradle, normal) / cos_blade
    e2 = np.cross(normal, e1)
    k11, k12, k22 = e1 @ operator @ e1, e1 @ operator @ e2, e2 @ operator @ e2 - blade_curvature
    around = k11 - k12**2 / k22
    radius = side * cos_blade / around
    if not radius > 0.0:
        raise NoSolutionError("no head cutter gives this contact: change the path angle or the length of the ellipse")

    velocity1, turned = np.cross(AXIS, point), np.cross(AXIS, normal)
    slide2 = -(velocity1 @ cradle) / (e2 @ cradle)
    a2 = blade_curvature * slide2 - turned @ e2
    a1 = a2 * k12 / k22
    # sliding along e1 = slide_0 + slide_m m, and the denominator of the rank-one part is linear in m as well
    slide_0, slide_m = (a1 + turned @ e1) / around, -cos_blade / around
    lever = a1 - normal @ np.cross(AXIS, e1)
    constant = (
        -normal @ np.cross(AXIS, velocity1) - normal @ np.cross(AXIS, e2) * slide2 + a2 * slide2 + lever * slide_0
    )
    slope = normal @ np.cross(cradle, velocity1) + lever * slide_m
    ratio = float((-(a2**2) / k22 - constant) / slope)

    sliding = (slide_0 + slide_m * ratio) * e1 + slide2 * e2
    arm = -np.cross(cradle, sliding + velocity1) / ratio
    root = np.array([cradle[2], 0.0, -cradle[0]])
    across = np.cross(cradle, root)
    radial = -side * (normal + sin_blade * cradle) / cos_blade

    def plane(vector: Array) -> tuple[float, float]:
        return float(vector @ root), float(vector @ across)

    return ToolSettings(
        blade_angle=float(np.arcsin(sin_blade)),
        radius=float(radius),
        height=float(tip_plane - point @ cradle),
        ratio_of_roll=ratio,
        centre=plane(point - arm),
        cutter=plane(arm - radius * radial),
    )
