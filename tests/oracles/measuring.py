"""Gears as they are measured: planes, balls and chords laid on the exact flanks, by Newton on their points and normals alone.

Nothing here knows of involutes. A member is in its own frame (axis z, a tooth centred on +x), lengths in mm.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq, root

from gearmesh import Member
from gearmesh.answers.inspection.machine_settings import CutFlanks
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import Side, Tooth
from gearmesh.teeth.micro_geometry.deviations import DeviationGrid

#: largest residual of a measurement, mm and rad, and steps that it may take
TOLERANCE, STEPS = 1e-11, 60


def flank(member: Member, side: Side, tooth: float, p: float, v: float) -> tuple[Array, Array]:
    """Point and outward normal of a tooth's flank, `tooth` pitches further round than the one on +x."""
    jet = member.tooth.side(side).flank.jet(np.array(p), np.array(v))
    angle = tooth * member.tooth.pitch_angle
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    return turn @ jet.r, turn @ jet.n


def solved(equations: Callable[[Array], Array], start: Array) -> Array:
    """The root of as many equations as there are (least norm where some unknown is free), by Gauss-Newton."""
    x = np.array(start, dtype=float)
    for _ in range(STEPS):
        f = equations(x)
        step = 1e-6
        slopes = [(equations(x + step * e) - equations(x - step * e)) / (2.0 * step) for e in np.eye(x.size)]
        change = np.linalg.lstsq(np.stack(slopes, axis=-1), -f, rcond=1e-9)[0]
        x = x + change * min(1.0, 5.0 / max(1e-300, float(np.abs(change).max())))
        if np.abs(change).max() < 1e-13:
            break
    assert np.abs(equations(x)).max() < TOLERANCE, np.abs(equations(x)).max()
    return x


def middle(member: Member, side: Side) -> Array:
    """Parameters (p, v) in the middle of a flank."""
    grid = member.tooth.flank_grid(side, [0.5], [0.5])
    return grid.parameters[0, 0]


def _start(member: Member, first: Side, second: Side) -> Array:
    return np.concatenate((middle(member, first), middle(member, second)))


def span(member: Member, count: int, sense: int = 1) -> float:
    """Between two parallel planes that touch a right flank and, `count` teeth over, a left one; of an internal gear from a left
    flank over `count` spaces to a right one."""
    first, second, over = (Side.RIGHT, Side.LEFT, count - 1) if sense > 0 else (Side.LEFT, Side.RIGHT, count)

    def both(x: Array) -> tuple[Array, ...]:
        return *flank(member, first, 0.0, *x[:2]), *flank(member, second, over, *x[2:])

    def equations(x: Array) -> Array:
        r1, n1, r2, n2 = both(x)
        return np.concatenate((n1 + n2, np.cross(r1 - r2, n1) / np.linalg.norm(r1 - r2)))

    r1, n1, r2, _ = both(solved(equations, _start(member, first, second)))
    return float(sense * (r1 - r2) @ n1)


def ball(member: Member, diameter: float, z: float = 0.0) -> tuple[Array, Array]:
    """Centre of the ball at `z` that touches both flanks of the space after the tooth on +x, and where it touches one of them."""

    def centres(x: Array) -> tuple[Array, Array, Array]:
        r1, n1 = flank(member, Side.LEFT, 0.0, *x[:2])
        r2, n2 = flank(member, Side.RIGHT, 1.0, *x[2:])
        return r1 + 0.5 * diameter * n1, r2 + 0.5 * diameter * n2, r1

    def equations(x: Array) -> Array:
        first, second, _ = centres(x)
        return np.append(first - second, first[2] - z)

    first, _, touch = centres(solved(equations, _start(member, Side.LEFT, Side.RIGHT)))
    return first, touch


def over_balls(member: Member, diameter: float, sense: int) -> float:
    """Over two balls, or between them, in spaces as nearly opposite as there are, their centres in one plane across the axis."""
    centre = ball(member, diameter)[0]
    angle = (member.tooth.teeth // 2) * member.tooth.pitch_angle
    c, s = np.cos(angle), np.sin(angle)
    other = np.array([[c, -s], [s, c]]) @ centre[:2]
    return float(np.linalg.norm(centre[:2] - other)) + sense * diameter


def over_pins(member: Member, diameter: float, twist: float) -> float:
    """Over two balls in spaces that stand opposite, one of them slid along its helix until it does; seen along the axis."""
    centre = ball(member, diameter)[0]
    teeth = member.tooth.teeth
    missing = np.pi - (teeth // 2) * member.tooth.pitch_angle
    slid = ball(member, diameter, missing / twist)[0]
    angle = (teeth // 2) * member.tooth.pitch_angle
    c, s = np.cos(angle), np.sin(angle)
    other = np.array([[c, -s], [s, c]]) @ slid[:2]
    assert abs(centre[0] * other[1] - centre[1] * other[0]) < 1e-9
    return float(np.linalg.norm(centre[:2] - other)) + diameter


def constant_chord(member: Member, radius: float) -> tuple[float, float]:
    """Chord between the feet of the flanks' normals through the middle of the tooth at a radius; its distance from the axis."""
    middle_of_tooth = np.array([radius, 0.0, 0.0])
    feet = []
    for side in Side:
        start = np.append(middle(member, side), 0.0)

        def equations(x: Array, side: Side = side) -> Array:
            r, n = flank(member, side, 0.0, *x[:2])
            return r + x[2] * n - middle_of_tooth

        feet.append(flank(member, side, 0.0, *solved(equations, start)[:2])[0])
    return float(np.linalg.norm(feet[0] - feet[1])), float(feet[0][0])


def chord(member: Member, radius: float) -> tuple[float, float]:
    """Shortest chord between the lines of both flanks at a radius, and its distance from the axis."""

    def both(x: Array) -> tuple[Array, ...]:
        return *flank(member, Side.RIGHT, 0.0, *x[:2]), *flank(member, Side.LEFT, 0.0, *x[2:])

    def equations(x: Array) -> Array:
        r1, n1, r2, n2 = both(x)
        out1, out2 = r1 * [1.0, 1.0, 0.0], r2 * [1.0, 1.0, 0.0]
        along1, along2 = np.cross(n1, out1) / radius, np.cross(n2, out2) / radius
        across = r1 - r2
        return np.array(
            [np.hypot(*r1[:2]) - radius, np.hypot(*r2[:2]) - radius, across @ along1 / radius, across @ along2 / radius]
        )

    r1, _, r2, _ = both(solved(equations, _start(member, Side.RIGHT, Side.LEFT)))
    return float(np.linalg.norm(r1 - r2)), float(0.5 * (r1 + r2)[0])


def arc(member: Member, radius: float) -> float:
    """Transverse tooth thickness, an arc, at a radius in the plane z = 0."""
    angles = []
    for side in Side:

        def equations(x: Array, side: Side = side) -> Array:
            r, _ = flank(member, side, 0.0, *x)
            return np.array([np.hypot(*r[:2]) - radius, r[2]])

        r, _ = flank(member, side, 0.0, *solved(equations, middle(member, side)))
        angles.append(np.arctan2(r[1], r[0]))
    return float(radius * abs(angles[0] - angles[1]))


def base(member: Member) -> tuple[float, float]:
    """Radius of the cylinder that a flank's normal touches, and the angle (rad) by which that leaves the plane across the axis."""
    r, n = flank(member, Side.RIGHT, 0.0, *middle(member, Side.RIGHT))
    return float(abs(r[0] * n[1] - r[1] * n[0]) / np.hypot(*n[:2])), float(np.arcsin(n[2]))


def fillet_tangent(member: Member, beta: float, angle: float) -> tuple[float, float, float]:
    """Chord, distance from the axis, and radius of the fillet where its contour makes `angle` with the middle of the tooth (rad).

    From points alone, in the plane across the tooth trace of helix angle `beta`: where the distance from a line at that angle is
    stationary, and the circle through three of them.
    """
    side = member.tooth.right
    first, last = float(member.tooth.sections([0.5]).right.form_point_fillet[0]), side.root

    def contour(q: float) -> Array:
        def miss(v: float) -> float:
            _, y, z = side.fillet.jet(np.array(q), np.array(v)).r
            return float(y * np.sin(beta) + z * np.cos(beta))

        v = brentq(miss, -0.5 * member.tooth.blank.extent[1], 0.5 * member.tooth.blank.extent[1], xtol=1e-14)
        x, y, z = side.fillet.jet(np.array(q), np.array(v)).r
        return np.array([x, np.hypot(y, z)])

    inward = np.sign(contour(last)[0] - contour(first)[0])

    def away(q: float) -> float:
        x, y = contour(q)
        return float(y * np.cos(angle) - inward * x * np.sin(angle))

    low, high = sorted((first, last))
    step = 1e-4 * (high - low)
    q = brentq(lambda at: away(at + step) - away(at - step), low + step, high - step, xtol=1e-13)
    a, b, c = (contour(q + k * 20.0 * step) for k in (-1.0, 0.0, 1.0))
    twice_area = abs((b - a)[0] * (c - a)[1] - (b - a)[1] * (c - a)[0])
    sides = np.linalg.norm(b - a) * np.linalg.norm(c - b) * np.linalg.norm(a - c)
    x, half = contour(q)
    return 2.0 * float(half), float(x), float(sides / (2.0 * twice_area))


def along_normals(tooth: Tooth, side: Side, nominal: Tooth, shape: tuple[int, int] = (5, 9)) -> DeviationGrid:
    """Return distances of a flank from a nominal one on the normals through its points: intersections, found by a library."""
    s, t = (np.linspace(0.1, 0.9, count) for count in shape)
    lines = nominal.flank_grid(side, s, t)
    flank = tooth.side(side).flank
    values = np.empty(shape)
    for i, j in np.ndindex(shape):
        p, n, start = lines.points[i, j], lines.normals[i, j], lines.parameters[i, j]

        def gap(x: Array, p: Array = p, n: Array = n) -> Array:
            point: Array = flank.jet(*(np.array([value]) for value in x[:2])).r[0]
            return point - p - 0.01 * x[2] * n

        values[i, j] = 0.01 * root(gap, [*start, 0.0], tol=1e-13).x[2]
    return DeviationGrid(lines.points, lines.normals, values)


@contextmanager
def flanks_cut_once() -> Iterator[None]:
    """Corrections of one design at the same points cut each flank once: most tests move the same settings by the same steps."""
    known: dict[tuple[object, ...], Array] = {}
    cut = CutFlanks.displacements

    def remembered(flanks: CutFlanks, values: Mapping[str, Any]) -> Array:
        # points that were read from a file are off by rounding
        places = [(side, np.round(grid.points, 9).tobytes()) for side, grid in flanks.grids.items()]
        key = (repr(flanks.design.plain()), flanks.name, repr(sorted(values.items())), *places)
        if key not in known:
            known[key] = cut(flanks, values)
        return known[key].copy()

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(CutFlanks, "displacements", remembered)
        yield
