"""Local synthesis: pinion machine settings that give the requested contact at the mean point [AB; Litvin & Lee].

All vectors are in the pinion's frame (z along its axis from the apex to the heel), with the pinion in its position as
cut. The blank turns with unit rate about z. The cradle turns with the ratio of roll m about its axis c, which points
from the cutter into the blank. n is the outward normal of the pinion at the mean point B. All shape operators K (3, 3)
refer to n: dn = -K dr in the tangent plane.

1. The contact. With w12 = w1 - w2 and v12 = v1 - v2 at B, contact in the neighbourhood requires [AB 8; CR3553 1.1]

       (K1 - K2) u1 = b,   b = w12 x n + K2 v12,   u2 = u1 + v12,
       b . u2 = (w2 x n) . v12 + n . (w12 x v2) - m2' n . v2,   m2' = (d2 phi2 / d phi1^2) / (N1/N2)

where u1, u2 are the velocities of the contact point over pinion and gear. The direction of u2 is given; the second
equation gives its length. K1 - K2 has the eigenvalue -2 delta / a^2 along the major axis of the ellipse; the first
equation gives the rest of K1 - K2.

2. The tool. Its normal at B is n, which gives the blade angle. The pinion is the envelope of the tool, so that K1 - Kt
has rank one [AB 17-19], which gives the cutter's radius. Direction and size of the rank-one part are linear in the
ratio of roll [AB 20-50]; for a tilted cutter the size is quadratic. This gives m and the sliding velocity, hence the
machine centre [AB 51, 52]. The position of B gives radial setting and cradle angle [AB 53-56].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.errors import NoSolutionError
from gearmesh.kernel.numeric.algebra import Z_AXIS, Array, cross, dot


@dataclass(frozen=True)
class ContactAsked:
    """Requested contact at the mean point."""

    #: (d2 phi2 / d phi1^2) / (N1/N2), 1/rad; phi1 grows as the pinion turns (Table 2 of [AB])
    ratio_derivative: float
    #: direction of the contact's path on the gear, rad, from the lengthwise principal direction (towards the toe)
    #: towards the gear's root
    path_angle: float
    #: half the length of the ellipse, mm
    semi_major_axis: float
    #: separation of the flanks at the edge of the ellipse, mm
    delta: float


@dataclass(frozen=True)
class MeanContact:
    """Geometry of the gear at the mean point in contact. The pinion's axis passes through the origin."""

    #: mean point B (3,), mm
    point: Array
    #: outward normal n (3,) of the pinion
    normal: Array
    #: shape operator K2 (3, 3) of the gear, 1/mm
    gear_operator: Array
    #: unit vector (3,) along the gear's lengthwise principal direction, towards the toe
    lengthwise: Array
    #: unit vector (3,) along the gear's other principal direction, towards its root
    profilewise: Array
    #: angular velocity (3,) of the pinion per unit of phi1
    spin1: Array
    #: angular velocity (3,) of the gear per unit of phi1, at the nominal ratio
    spin2: Array
    #: point (3,) of the gear's axis, mm
    origin2: Array


@dataclass(frozen=True)
class ToolSettings:
    """Settings of the tool that follow from the mean contact.

    Positions in the machine plane are (along the machine root line from the apex to the heel, along cradle axis x root
    line).
    """

    #: blade angle, rad
    blade_angle: float
    #: radius of the cutter at the mean point, mm
    radius: float
    #: height of the mean point over the tip plane of the cutter, mm
    height: float
    #: rotation of the cradle over rotation of the blank
    ratio_of_roll: float
    #: position of the machine centre in the machine plane, mm
    centre: tuple[float, float]
    #: position of the cutter's centre from the machine centre in the machine plane, mm
    cutter: tuple[float, float]
    #: position of the cutter's centre along the cradle axis, from the origin, mm
    tip_plane: float
    #: 1/R of the blade, 1/mm; 0 straight, > 0 convex
    blade_curvature: float


@dataclass(frozen=True)
class MachinePlanes:
    """Axes of a machine, and the plane in which the blade of its cutter ends."""

    #: cradle axis (3,)
    cradle: Array
    #: position of the cutter's centre along the cradle axis from the origin, mm; None by `floor`
    tip_plane: float | None
    #: axis (3,) of a tilted cutter; None if it is parallel to the cradle axis
    leaning: Array | None = None
    #: normal (3,) and distance (mm) of the plane in which the prolonged blade ends if no tip plane is given
    floor: tuple[Array, float] | None = None
    #: rotation (rad) of the cradle from the position in which the floor is there to the mean point
    rolled: float = 0.0

    @property
    def tool(self) -> Array:
        """Axis (3,) of the cutter."""
        return self.cradle if self.leaning is None else self.leaning


@dataclass(frozen=True)
class BladeAtMean:
    """Blade of a cutter at the mean point."""

    #: blade angle, rad
    angle: float
    #: radius of the cutter, mm
    radius: float
    #: unit vector (3,) from the cutter's axis to the mean point
    radial: Array
    #: direction (3,) down the edge to its tip, per unit of height
    down: Array
    #: 1/R, 1/mm; 0 straight, > 0 convex
    curvature: float


def pinion_operator(gear: MeanContact, asked: ContactAsked) -> Array:
    """Return the shape operator K1 (3, 3) of the pinion that gives the requested contact.

    Raises NoSolutionError if the flanks would have to cut into each other.
    """
    operator, n = gear.gear_operator, gear.normal
    v12, turning, rest = relative_motion(gear)
    direction = np.cos(asked.path_angle) * gear.lengthwise + np.sin(asked.path_angle) * gear.profilewise
    # m2' is normalised because axis2 x (B - O2) is scaled with the gear's speed
    rest -= float(asked.ratio_derivative * (n @ cross(gear.spin2, gear.point - gear.origin2)))
    # u1: the second equation gives the length of u2 along the requested direction
    over_pinion = direction * (rest / (turning @ direction)) - v12
    # K1 - K2 = flat + rank one: `flat` along the major axis, and the rest so that (K1 - K2) u1 = b
    flat = -2.0 * asked.delta / asked.semi_major_axis**2
    across = turning - flat * over_pinion
    # the rest must separate the flanks as well
    share = across @ over_pinion
    if not share < 0.0:
        raise NoSolutionError(
            reason="no pinion gives this contact without cutting into the gear",
            remedy="change the path angle, the parabola or the length of the ellipse",
        )
    tangent = np.eye(3) - np.outer(n, n)
    pinion_operator: Array = operator + flat * tangent + np.outer(across, across) / share
    return pinion_operator


def conjugate_operator(gear: MeanContact) -> Array:
    """Shape operator K1 (3, 3) of the pinion that is conjugate to the gear: K1 - K2 = b b^T / (b . u1), for any u1."""
    v12, turning, rest = relative_motion(gear)
    conjugate_operator: Array = gear.gear_operator + np.outer(turning, turning) / (rest - turning @ v12)
    return conjugate_operator


def generated_operator(
    operator: Array,
    at: tuple[Array, Array, Array],
    spins: tuple[Array, Array],
    tool_velocity: Array,
    modified: tuple[Array, Array],
) -> Array:
    """Return shape operators (N, 2, 2) of flanks that tools generate: `conjugate_operator` for many tools at one point.

    - `operator`: shape operators (N, 2, 2) of the tools
    - `at`: point (3,), normal (3,), and the tangents (2, 3) that are the basis of the operators
    - `spins`: angular velocities of the blank (3,) and of the tools (N, 3)
    - `tool_velocity`: velocities (N, 3) of the tools at the point
    - `modified`: derivatives (N,) of the ratios of roll, over the ratios, by the rotation of the blank with the roll; and
      gradients (N, 2), 1/mm, of that rotation along the tools' surfaces, with the index of a cutter
    """
    point, n, basis = at
    spin1, spin2 = spins
    w12, v12 = spin1 - spin2, cross(spin1, point) - tool_velocity
    in_plane, (bend, along) = v12 @ basis.T, modified
    turning = cross(w12, n) @ basis.T + (operator @ in_plane[..., None])[..., 0]
    rest = dot(cross(spin2, n), v12) + cross(w12, tool_velocity) @ n - (turning * in_plane).sum(axis=-1)
    # modified roll moves the tool along the normal by half of `bend` x^2, x the rotation with the roll
    bend, rolled = bend * (tool_velocity @ n), 1.0 + (along * in_plane).sum(axis=-1)
    operator = operator + bend[:, None, None] * along[:, :, None] * along[:, None]
    turning, rest = turning + (bend * rolled)[:, None] * along, rest - bend * rolled**2
    added: Array = turning[:, :, None] * turning[:, None] / rest[:, None, None]
    return operator + added


def contact_of(operator: Array, gear: MeanContact, delta: float) -> ContactAsked:
    """Return the contact at the mean point of a pinion with shape operator K1 (3, 3): the inverse of `pinion_operator`.

    The path angle is between 0 and pi.
    """
    basis = np.stack((gear.lengthwise, gear.profilewise))
    difference = basis @ (operator - gear.gear_operator) @ basis.T
    v12, turning, rest = relative_motion(gear)
    over_gear = np.linalg.solve(difference, basis @ turning) @ basis + v12
    moved = gear.normal @ cross(gear.spin2, gear.point - gear.origin2)
    flat = np.abs(np.linalg.eigvalsh(difference)).min()
    return ContactAsked(
        ratio_derivative=float((rest - turning @ over_gear) / moved),
        path_angle=float(np.arctan2(*(basis @ over_gear)[::-1]) % np.pi),
        semi_major_axis=float(np.sqrt(2.0 * delta / flat)),
        delta=delta,
    )


def relative_motion(gear: MeanContact) -> tuple[Array, Array, float]:
    """Return v12, b = w12 x n + K2 v12, and the known part of d/dt (n . v12) = 0.

    The known part excludes the motion of the contact point and the derivative of the ratio.
    """
    w12, n = gear.spin1 - gear.spin2, gear.normal
    v2 = cross(gear.spin2, gear.point - gear.origin2)
    v12 = cross(gear.spin1, gear.point) - v2
    rest = cross(gear.spin2, n) @ v12 + n @ cross(w12, v2)
    return v12, cross(w12, n) + gear.gear_operator @ v12, float(rest)


def tool_settings(
    operator: Array, mean: tuple[Array, Array], planes: MachinePlanes, side: int, blade_curvature: float
) -> ToolSettings:
    """Settings of the tool whose envelope has a given point, normal and shape operator (see the module's text).

    - `operator`: shape operator (3, 3) of the pinion, 1/mm
    - `mean`: mean point (3,) and normal (3,)
    - `planes`: axes of cradle and cutter, and the plane in which the blade ends
    - `side`: +1 for outside, -1 for inside blades
    - `blade_curvature`: 1/R of the blade, 1/mm; 0 straight, > 0 convex

    Raises NoSolutionError if no cutter of that side gives the contact.
    """
    point, normal = mean
    axis, cradle, tool = planes.leaning, planes.cradle, planes.tool
    # blade angle by the normal; e1 along the rotation of the cutter, e2 along the blade
    sin_blade = -float(normal @ tool)
    cos_blade = float(np.sqrt(1.0 - sin_blade**2))
    e1 = cross(tool, normal) / cos_blade
    e2 = cross(normal, e1)
    # K1 - Kt has rank one with the principal curvatures (around, blade_curvature) of the tool along e1 and e2: its
    # determinant is 0, which gives the curvature around the cutter's axis and hence the radius
    k11, k12, k22 = e1 @ operator @ e1, e1 @ operator @ e2, e2 @ operator @ e2 - blade_curvature
    around = k11 - k12**2 / k22
    radius = side * cos_blade / around
    if not radius > 0.0:
        raise NoSolutionError(
            reason="no head cutter gives this contact", remedy="change the path angle or the length of the ellipse"
        )

    # components along e1 and e2 of the cradle axis, and of the turning of the normal about it
    along2 = float(e2 @ cradle)
    along1, turning1, turning2 = 0.0, cos_blade, 0.0
    if axis is not None:
        by_cradle = cross(cradle, normal)
        along1, turning1, turning2 = (float(x) for x in (e1 @ cradle, by_cradle @ e1, by_cradle @ e2))
    velocity1, turned = cross(Z_AXIS, point), cross(Z_AXIS, normal)
    # Sliding velocity (s1, s2) and vector (a1, a2) of the rank-one part, both linear in m. Conditions: the sliding along
    # the cradle axis is that of the pinion alone, since the cradle has none; and a1 / a2 = k12 / k22.
    level, share = -(velocity1 @ cradle) / along2, along1 / along2
    stiff = around + blade_curvature * share * k12 / k22
    s1 = ((blade_curvature * level - turned @ e2) * k12 / k22 + turned @ e1) / stiff
    s1_m = (turning2 * k12 / k22 - turning1) / stiff
    s2, s2_m = level - share * s1, -share * s1_m
    a2, a2_m = blade_curvature * s2 - turned @ e2, blade_curvature * s2_m + turning2
    a1, a1_m = a2 * k12 / k22, a2_m * k12 / k22
    lever1, lever2 = a1 - normal @ cross(Z_AXIS, e1), normal @ cross(Z_AXIS, e2)
    constant = -normal @ cross(Z_AXIS, velocity1) - lever2 * s2 + a2 * s2 + lever1 * s1
    slope = normal @ cross(cradle, velocity1) + lever1 * s1_m
    # size of the rank-one part: square m^2 + slope m + constant = 0; square is 0 for an upright cutter
    constant = a2**2 / k22 + constant
    slope += 2.0 * a2 * a2_m / k22 + (a2 - lever2) * s2_m + a2_m * s2 + a1_m * s1
    square = a2_m**2 / k22 + a2_m * s2_m + a1_m * s1_m
    inner = slope**2 - 4.0 * square * constant
    if not inner >= 0.0:
        raise NoSolutionError(
            reason="no ratio of roll gives this contact with this tilt",
            remedy="change tilt, swivel or the path angle",
        )
    # the root that tends to -constant / slope, the ratio of an upright cutter, as square tends to 0
    ratio = float(-2.0 * constant / (slope + np.sign(slope) * np.sqrt(inner)))

    # machine centre: the cradle moves the mean point with the sliding velocity plus the pinion's
    sliding = (s1 + s1_m * ratio) * e1 + (s2 + s2_m * ratio) * e2
    arm = -cross(cradle, sliding + velocity1) / ratio
    radial = -side * (normal + sin_blade * tool) / cos_blade
    down = tool - side * sin_blade / cos_blade * radial
    blade = BladeAtMean(float(np.arcsin(sin_blade)), float(radius), radial, down, blade_curvature)
    return placed_tool(point, planes, blade, ratio, arm)


def placed_tool(point: Array, planes: MachinePlanes, blade: BladeAtMean, ratio: float, arm: Array) -> ToolSettings:
    """Return the settings of a tool by its blade at the mean point.

    - `point`: mean point (3,)
    - `ratio`: rotation of the cradle over rotation of the blank
    - `arm`: mean point (3,) from the machine centre, in the plane of the cradle

    The blade is prolonged from the mean point to the given plane, or to the tip plane.
    """
    cradle, tool, radial, tip_plane = planes.cradle, planes.tool, blade.radial, planes.tip_plane
    root = np.array([cradle[2], 0.0, -cradle[0]])
    across = cross(cradle, root)
    if tip_plane is None:
        floor, over = (cradle, 0.0) if planes.floor is None else planes.floor
        if planes.rolled:
            # the plane turns with the cutter about the cradle axis
            c, s = np.cos(planes.rolled), np.sin(planes.rolled)
            turned = c * floor + s * cross(cradle, floor) + (1.0 - c) * (cradle @ floor) * cradle
            over, floor = over + float((turned - floor) @ (point - arm)), turned
        height = float((over - point @ floor) / (blade.down @ floor))
    else:
        height = float(tip_plane - point @ cradle)
        if planes.leaning is not None:
            height = float((height + blade.radius * (radial @ cradle)) / (tool @ cradle))
    offset = blade.radius * radial if planes.leaning is None else blade.radius * radial - height * tool

    def plane(vector: Array) -> tuple[float, float]:
        return float(vector @ root), float(vector @ across)

    return ToolSettings(
        blade_angle=blade.angle,
        radius=blade.radius,
        height=height,
        ratio_of_roll=ratio,
        centre=plane(point - arm),
        cutter=plane(arm - offset),
        tip_plane=float((point - offset) @ cradle) if tip_plane is None else tip_plane,
        blade_curvature=blade.curvature,
    )
