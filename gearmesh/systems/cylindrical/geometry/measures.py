"""Dimensions by which tooth thickness is measured [ISO 21771; DIN 3960]: span, balls, pins, chords.

All of them are dimensions of the exact surfaces in closed form, in the unit of the teeth:

- Span: distance of parallel planes that touch two flanks. On an internal gear it is measured along the common normal of
  two flanks, between rounded anvils.
- Ball: touches both flanks of a space.
- Constant chord: joins the feet of the normals from the middle of the tooth at the reference cylinder.
- Chord at the reference cylinder: the shortest distance between the two flank lines there.

Asymmetric teeth have neither span nor constant chord: no parallel planes touch involutes of two base circles. A ball
touches both flanks of their spaces at different radii, and its centre is not in the middle of the space.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TypeAlias

import numpy as np

from gearmesh.kernel.numeric.roots import bracketed_root
from gearmesh.systems.cylindrical.geometry.geometry import Toothing, common_angle, involute, mean_of

#: radii of the ends of a usable flank
Flank: TypeAlias = "tuple[float, float]"

#: diameters of balls and pins [DIN 3977 table 1], and larger diameters that are available
STANDARD_DIAMETERS_MM = (
    *(0.17, 0.195, 0.22, 0.25, 0.29, 0.335, 0.39, 0.455, 0.53, 0.62, 0.725),
    *(0.895, 1.0, 1.1, 1.25, 1.4, 1.5, 1.75, 2.0, 2.25, 2.5, 2.75),
    *(3.0, 3.25, 3.5, 3.75, 4.0, 4.25, 4.5, 5.0, 5.25, 5.5, 6.0),
    *(6.5, 7.0, 7.5, 8.0, 9.0, 10.0, 10.5, 11.0, 12.0, 14.0, 15.0),
    *(16.0, 18.0, 20.0, 22.0, 25.0, 28.0, 30.0, 35.0, 40.0, 45.0, 50.0),
    *(55.0, 60.0, 70.0, 80.0, 90.0, 100.0),
)
#: reason why asymmetric teeth have no span
NO_ASYMMETRIC_SPAN = "no parallel planes touch the flanks of asymmetric teeth, which are involutes of two base circles"
#: relative difference of diameters that is rounding
DIAMETER_ROUNDING = 1e-9
#: halvings of an interval until its length is rounding
BISECTION_STEPS = 40


# ---------------------------------------------------------------- span


def span(teeth: Toothing, count: int) -> float:
    """Return the span W_k along the normal of the flanks, over `count` teeth or, on an internal gear, spaces.

    W_k = (k - 1) p_bn + s_bn, in the plane that touches the base cylinder. The spaces of an internal member are the
    teeth of an external member, so that e_bn takes the place of s_bn.
    """
    pitch = teeth.base_pitch * math.cos(teeth.beta_b)
    half = math.pi / teeth.teeth - _half_at_reference(teeth) if teeth.internal else _half_at_reference(teeth)
    arc = 2.0 * teeth.base_radius * (half + involute(teeth.alpha_t))
    return (count - 1) * pitch + arc * math.cos(teeth.beta_b)


def span_radius(teeth: Toothing, count: int) -> float:
    """Return the radius at which the anvils touch the flanks, equally far from the middle of the face."""
    return math.hypot(teeth.base_radius, 0.5 * span(teeth, count) * math.cos(teeth.beta_b))


def span_width(teeth: Toothing, count: int) -> float:
    """Return the distance along the axis between the points of contact; a narrower face has no such span."""
    return span(teeth, count) * abs(math.sin(teeth.beta_b))


def has_span(teeth: Toothing) -> bool:
    """True if anvils can touch the flanks: external teeth, or spur internal teeth.

    Flat anvils touch convex flanks, and rounded anvils touch the hollow flanks of a spur internal gear. Hollow flanks
    of a helical gear would be touched at points that are also apart along the axis. No parallel planes touch the flanks of
    asymmetric teeth.
    """
    return not (teeth.asymmetric or (teeth.internal and teeth.beta != 0.0))


def anvil_radius(teeth: Toothing, count: int) -> float:
    """Return the largest radius of rounded anvils for the span of a spur internal gear.

    The radius is limited by the hollow flanks where the anvil touches them, and by the ball that touches both flanks of
    the space there.
    """
    radius = span_radius(teeth, count)
    return min(abs(teeth.roll_length(radius)), 0.5 * best_ball(teeth, radius))


def span_teeth(teeth: Toothing, flank: Flank, face: float) -> int | None:
    """Return the number of teeth, or spaces, whose span is touched nearest to the V cylinder; None without one.

    `flank`: radii of the flank's ends; `face`: face width.
    """
    middle = v_radius(teeth)
    return min(
        span_numbers(teeth, flank, face), key=lambda count: abs(span_radius(teeth, count) - middle), default=None
    )


def span_numbers(teeth: Toothing, flank: Flank, face: float) -> list[int]:
    """Return the numbers of teeth, or spaces, whose span anvils can touch on the flank and within the face.

    `flank`: radii of the flank's ends; `face`: face width.
    """
    if not has_span(teeth):
        return []
    pitch = teeth.base_pitch * math.cos(teeth.beta_b)
    most = int(2.0 * max(flank) / pitch) + 2
    return [
        count
        for count in range(1, min(most, teeth.teeth) + 1)
        if min(flank) < span_radius(teeth, count) < max(flank) and span_width(teeth, count) < face
    ]


def v_radius(teeth: Toothing) -> float:
    """Return the radius of the V cylinder, d/2 + x m_n, which is near the middle of the flank."""
    return teeth.radius_at(teeth.shift * teeth.module)


# ---------------------------------------------------------------- balls and pins


def ball_radius(teeth: Toothing, diameter: float) -> float:
    """Return the radius d_K / 2 of the centre of a ball or pin that touches both flanks of a space.

    inv(alpha_Kt) = sense (D_M / (2 r_b cos(beta_b)) - eta_b), where eta_b is half of the space's angle at the base
    circle. The centre is at the same radius for both sides of asymmetric teeth, whose means fulfil the equation. NaN if
    the centre lies below the base circle of a side.
    """
    largest = teeth.largest_base_radius
    wanted = mean_of([_ball_involute(side, diameter) for side in teeth.sides])
    return largest / math.cos(common_angle(wanted, [side.base_radius / largest for side in teeth.sides]))


def _ball_involute(side: Toothing, diameter: float) -> float:
    """Return inv(alpha_Kt) of the centre of a ball in the middle of a space, which touches the flank of a side."""
    offset = 0.5 * diameter / (side.base_radius * math.cos(side.beta_b))
    return side.sense * (offset - _base_space(side))


def ball_contact_radius(teeth: Toothing, diameter: float) -> float:
    """Return the radius at which a ball or pin touches the flanks; the drive side of asymmetric teeth."""
    return ball_contact_radii(teeth, diameter)[0]


def ball_contact_radii(teeth: Toothing, diameter: float) -> tuple[float, ...]:
    """Return the radius at which a ball or pin touches the flanks of each side of the teeth."""
    centre = ball_radius(teeth, diameter)
    return tuple(
        math.hypot(
            side.base_radius,
            side.roll_length(centre) - side.sense * 0.5 * diameter * math.cos(side.beta_b),
        )
        for side in teeth.sides
    )


def best_ball(teeth: Toothing, radius: float, side: int = 0) -> float:
    """Return the diameter of the ball that touches the flanks at a radius; NaN if there is none.

    The diameter is the root of the equation of `ball_radius`. `side`: number of the side of asymmetric teeth that the
    ball touches at the radius.
    """
    touched, others = teeth.sides[side], [other for k, other in enumerate(teeth.sides) if k != side]
    length, largest = touched.roll_length(radius), 4.0 * math.pi * teeth.transverse_module

    def miss(diameter: float) -> float:
        away = teeth.sense * 0.5 * diameter * math.cos(touched.beta_b)
        tangent = max(0.0, (length + away) / touched.base_radius)
        centre = touched.base_radius * math.hypot(1.0, tangent)
        slopes = {touched: tangent, **{other: other.roll_length(centre) / other.base_radius for other in others}}
        return mean_of([_ball_involute(of, diameter) - (slope - math.atan(slope)) for of, slope in slopes.items()])

    roots = bracketed_root(
        lambda x, _: np.array([miss(float(diameter)) for diameter in x]), np.zeros(1), np.array([largest])
    )
    return float(roots.values[0])


def ball_fits(teeth: Toothing, diameter: float, flanks: Sequence[Flank], circles: tuple[float, float]) -> bool:
    """True if a ball touches the flanks, stands out of the space and clears its ground.

    `flanks`: radii of the ends of the flanks of each side of the teeth, in any order; `circles`: radii of tip and root.
    """
    centre, half = ball_radius(teeth, diameter), 0.5 * teeth.sense * diameter
    over, under = (centre + half - circles[0]) * teeth.sense, (centre - half - circles[1]) * teeth.sense
    touched = zip(flanks, ball_contact_radii(teeth, diameter), strict=True)
    return all(min(ends) < radius < max(ends) for ends, radius in touched) and over > 0.0 and under > 0.0


def _touching(teeth: Toothing, flanks: Sequence[Flank]) -> tuple[float, float]:
    """Return the least and the largest diameter of a ball that touches the flanks of all sides.

    A larger ball touches nearer to the tip.
    """
    ends = [sorted(best_ball(teeth, radius, k) for radius in flank) for k, flank in enumerate(flanks)]
    return max(low for low, _ in ends), min(high for _, high in ends)


def ball_range(teeth: Toothing, flanks: Sequence[Flank], circles: tuple[float, float]) -> tuple[float, float] | None:
    """Return the least and the largest diameter of a ball that `ball_fits`; None if no ball does.

    A larger ball touches nearer to the tip and stands out farther.
    """
    ends = _touching(teeth, flanks)
    inside = [ends[0] + share * (ends[1] - ends[0]) for share in np.linspace(0.0, 1.0, 65)[1:-1]]
    fit = [diameter for diameter in inside if ball_fits(teeth, diameter, flanks, circles)]
    if not fit:
        return None
    # bisect between the smallest sample that fits and the end of the range
    least, below = fit[0], ends[0]
    for _ in range(BISECTION_STEPS):
        middle = 0.5 * (least + below)
        least, below = (middle, below) if ball_fits(teeth, middle, flanks, circles) else (least, middle)
    return least, ends[1]


def ball_diameter(
    teeth: Toothing, flanks: Sequence[Flank], circles: tuple[float, float], unit: float = 1.0
) -> float | None:
    """Return the proposed diameter of a ball or pin; None if no ball fits.

    On external teeth it is the smallest standard diameter [DIN 3977] not below the ball that touches at the V cylinder.
    On internal teeth it is the standard diameter that touches nearest to that cylinder. If no standard diameter fits,
    it is the ball that touches at the V cylinder. On asymmetric teeth the drive side is touched there.

    - flanks: radii of the ends of the flanks of each side of the teeth, in any order.
    - circles: radii of tip and root; the ball stands out of the space and clears its ground.
    - unit: the teeth's unit, mm.
    """
    low, high = sorted(flanks[0])
    middle = v_radius(teeth)
    best = best_ball(teeth, min(max(middle, low), high))
    # a larger ball touches nearer to the tip: diameters outside this range do not touch the flank
    least, most = _touching(teeth, flanks)
    standard = [
        size / unit
        for size in STANDARD_DIAMETERS_MM
        if not (size / unit < least or size / unit > most) and ball_fits(teeth, size / unit, flanks, circles)
    ]
    larger = [] if teeth.internal else [size for size in standard if size >= best * (1.0 - DIAMETER_ROUNDING)]
    if larger:
        return larger[0]
    if standard:
        return min(standard, key=lambda diameter: abs(ball_contact_radius(teeth, diameter) - middle))
    return best if ball_fits(teeth, best, flanks, circles) else None


def over_balls(teeth: Toothing, diameter: float) -> float:
    """Return the dimension M_dK over two balls (internal teeth: between them) in nearly opposite spaces."""
    apart = 2.0 * ball_radius(teeth, diameter)
    if teeth.teeth % 2:
        apart *= math.cos(0.5 * math.pi / teeth.teeth)
    return apart + teeth.sense * diameter


def over_pins(teeth: Toothing, diameter: float) -> float | None:
    """Return the dimension M_dR over two pins; None for helical internal teeth.

    Pins of helical external teeth slide along their spaces until they are opposite each other. In a helical internal
    space a straight pin touches at its ends.
    """
    if teeth.beta == 0.0:
        return over_balls(teeth, diameter)
    return None if teeth.internal else 2.0 * ball_radius(teeth, diameter) + diameter


def ball_width(teeth: Toothing, diameter: float) -> float:
    """Return the distance along the axis between the points of contact with both flanks: D_M sin(beta_b)."""
    return diameter * mean_of([abs(math.sin(side.beta_b)) for side in teeth.sides])


def pin_width(teeth: Toothing, diameter: float) -> float:
    """Return the least face width for pins over external teeth.

    On helical teeth of an odd number the pins slide half an axial pitch apart.
    """
    apart = math.pi / (teeth.teeth * abs(teeth.twist)) if teeth.beta != 0.0 and teeth.teeth % 2 else 0.0
    return apart + ball_width(teeth, diameter)


# ---------------------------------------------------------------- thicknesses that are measured


def thickness_by_span(teeth: Toothing, count: int, size: float) -> float:
    """Return the normal thickness at the reference cylinder of teeth with a span `size`.

    The span over `count` teeth changes by cos(alpha_n) times the change of thickness. Wider spaces of internal teeth
    are thinner teeth.
    """
    return teeth.thickness + teeth.sense * (size - span(teeth, count)) / math.cos(teeth.alpha)


def thickness_over_balls(teeth: Toothing, diameter: float, size: float, *, opposite: bool) -> float:
    """Return the normal thickness at the reference cylinder of teeth with a `size` over balls or pins.

    The size of internal teeth is measured between them. The equation of `ball_radius` is solved for the thickness. NaN
    if the centres would be below the base circle.

    - diameter: diameter of balls or pins.
    - opposite: True if they are opposite each other for odd numbers of teeth, too.
    """
    odd = teeth.teeth % 2 == 1 and not opposite
    centre = 0.5 * (size - teeth.sense * diameter) / (math.cos(0.5 * math.pi / teeth.teeth) if odd else 1.0)
    if centre < teeth.largest_base_radius:
        return math.nan
    halves = []
    for side in teeth.sides:
        offset = 0.5 * diameter / (side.base_radius * math.cos(side.beta_b))
        space = offset - side.sense * involute(math.acos(side.base_radius / centre))
        halves.append(math.pi / side.teeth - space - side.sense * involute(side.alpha_t))
    return 2.0 * mean_of(halves) * teeth.radius * math.cos(teeth.beta)


# ---------------------------------------------------------------- chords


def constant_chord(teeth: Toothing, tip: float) -> tuple[float, float]:
    """Return the constant chord s_c and its height h_c under the `tip` radius.

    It joins the points at which a rack's straight flanks touch a tooth in its middle. Asymmetric teeth have none: the two
    points are at different heights.
    """
    chord = teeth.thickness * math.cos(teeth.alpha) ** 2
    rise = 0.5 * teeth.thickness * math.sin(teeth.alpha) * math.cos(teeth.alpha)
    return chord, abs(tip - teeth.radius) - rise


def chord(teeth: Toothing, tip: float) -> tuple[float, float]:
    """Return the normal chord at the reference cylinder and its height under the `tip` radius.

    The chord is the shortest distance between the two flank lines. The first is the line of angle theta = psi + tau z;
    the second is its image, turned by 180 deg about the middle of the tooth. The square of half of this distance, r^2
    sin(theta)^2 + z^2, is least where r^2 sin(2 theta) tau / 2 + z = 0.
    """
    psi, tau, r = _half_at_reference(teeth), abs(teeth.twist), teeth.radius

    def slope(z: float) -> float:
        return 0.5 * r * r * math.sin(2.0 * (psi + tau * z)) * tau + z

    # the root between the transverse section (z = 0) and the middle of the tooth (theta = 0)
    z = 0.0
    if tau:
        roots = bracketed_root(
            lambda x, _: np.array([slope(float(place)) for place in x]), np.array([-psi / tau]), np.zeros(1)
        )
        z = float(roots.values[0])
    theta = psi + tau * z
    return 2.0 * math.hypot(r * math.sin(theta), z), teeth.sense * (tip - r * math.cos(theta))


def thickness_at(teeth: Toothing, radius: float) -> float:
    """Return the normal tooth thickness at a radius: an arc times the cosine of the helix angle there."""
    return 2.0 * radius * teeth.half_angle(radius) / math.hypot(1.0, teeth.twist * radius)


def _half_at_reference(teeth: Toothing) -> float:
    """Return half of the tooth's transverse thickness at the reference cylinder, rad."""
    return 0.5 * teeth.thickness / math.cos(teeth.beta) / teeth.radius


def _base_space(teeth: Toothing) -> float:
    """Return half of a space's angle (rad) at the base circle, to which the involutes are extended."""
    return math.pi / teeth.teeth - _half_at_reference(teeth) - teeth.sense * involute(teeth.alpha_t)
