"""The methods of ISO 23509 for the pitch cones of a pair: 0 without offset, 1 (Gleason), 2 (Oerlikon), 3 (Klingelnberg) with.

| method | size | spiral angle | the condition that is left |
|---|---|---|---|
| 0 | d_e2, b_2 | of both | none: the cones have one apex |
| 1 | d_e2, b_2, an estimate of delta_2 | pinion | the tooth line is curved as the limit normal asks, rho_mbeta = rho_lim |
| 2 | d_m2 | wheel | in the pitch plane both apexes and the cutter's centre are on one line |
| 3 | d_e2, b_2: mean point in the middle of the wheel's face | wheel | R_m1 = R_mint, (100) to (106) |

The standard goes round by hand until 1 % (methods 1, 2) or 0.01 % is left. Here the wheel's pitch angle is found to rounding:
the pinion's offset angle that gives the offset is a root between 0 and where the pinion's cone shrinks to a line (or its
teeth lie along the pitch circle), at every wheel pitch angle of a table; where the method's condition changes its sign in it
is a root. Of several counts the one that the pitch angle without offset grows into as the offset grows. The spiral angle that
is given is met exactly: the standard's single correction (20) to (26) leaves 0.002 deg in its own sample, and its method 2
leaves cones that touch only nearly (spiral angles 23.981 deg apart, the generatrices 23.969 deg). Lengths in mm, angles in rad.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TypeAlias

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.roots import bracketed_root
from gearmesh.systems.common.bounds import at_least, at_most
from gearmesh.systems.spiral_bevel.iso23509.pitch_cones import (
    PitchCones,
    TangentCones,
    bevel_pitch_angles,
    crown_shaft_angle,
)
from gearmesh.systems.spiral_bevel.iso23509.tooth_line import FaceCutter, ToothLine

#: wheel pitch angles of the table: two roots nearer than their distance, 0.2 deg, are overlooked together
WHEEL_ANGLES = np.radians(np.linspace(0.5, 89.9, 448))
#: the offset grows from 0 in so many steps, or shorter ones where the wheel's pitch angle changes by more than this (rad), down to
#: this share of the offset
STEPS, FARTHEST, FINEST = 8, float(np.radians(8.0)), 1e-6

#: tangent cones (N,) and the pair -> what has to be 0 (N,)
Condition: TypeAlias = "Callable[[OffsetPair, TangentCones], Array]"


def without_offset(
    teeth: tuple[int, int],
    shaft_angle: float,
    outer_diameter: float,
    face_width: float,
    spiral_angle: float,
    mean_cone_distance: float | None = None,
) -> PitchCones:
    """Method 0: `outer_diameter` d_e2; the mean point is in the middle of the face unless its cone distance is given.

    Makes no check: cones whose angle is 90 deg or more are none.
    """
    angles = bevel_pitch_angles(teeth, shaft_angle)
    outer = float(0.5 * outer_diameter / np.sin(angles[1]))
    mean = outer - 0.5 * face_width if mean_cone_distance is None else mean_cone_distance
    return PitchCones(0, teeth, shaft_angle, 0.0, angles, (mean, mean), (spiral_angle, spiral_angle), face_width, outer)


@dataclass(frozen=True)
class OffsetPair:
    """What the methods with an offset start from. `diameter` is the wheel's d_e2, for method 2 d_m2; `spiral_angle` the
    pinion's beta_m1 for method 1, else the wheel's beta_m2; `offset` a is > 0 where it makes the pinion's spiral angle the
    larger one. Without offset the cones are those of method 0.

    Raises DesignError, naming the key.
    """

    method: int
    teeth: tuple[int, int]
    shaft_angle: float
    offset: float
    diameter: float
    face_width: float
    spiral_angle: float
    cutter: FaceCutter

    def __post_init__(self) -> None:
        if self.method not in (1, 2, 3):
            raise DesignError("method", self.method, allowed="1, 2 or 3; 0 is that of pairs without offset")
        if self.method != 1 and not self.cutter.blade_groups:
            raise DesignError(
                "blade_groups", 0, reason=f"method {self.method} is for face hobbing", allowed="1 or more, or method 1"
            )
        if not 0.0 <= self.spiral_angle < 0.5 * np.pi:
            raise DesignError(
                "spiral_angle", np.degrees(self.spiral_angle), unit="deg", allowed="from 0 to less than 90 deg"
            )
        if not 0.0 < self.shaft_angle < np.pi:
            raise DesignError("shaft_angle", np.degrees(self.shaft_angle), unit="deg", allowed="between 0 and 180 deg")
        wheel = bevel_pitch_angles(self.teeth, self.shaft_angle)[1]
        if not wheel < 0.5 * np.pi:
            raise DesignError(
                "shaft_angle",
                np.degrees(self.shaft_angle),
                unit="deg",
                reason=f"with {self.teeth[0]} and {self.teeth[1]} teeth the wheel's pitch angle without offset is "
                f"{np.degrees(wheel):.4g} deg",
                allowed=f"less than {at_most(np.degrees(crown_shaft_angle(self.teeth)))} deg",
            )
        width = float(self.diameter / np.sin(self.estimate if self.method == 1 else wheel))
        if not 0.0 < self.face_width < 0.5 * width:
            raise DesignError(
                "face_width",
                self.face_width,
                unit="mm",
                allowed=f"between 0 and the cone distance, {at_most(0.5 * width)} mm",
            )

    @property
    def estimate(self) -> float:
        """delta_int2: the wheel's pitch angle as method 1 estimates it for the mean radius [ISO 23509 (11)]."""
        ratio, beyond = self.teeth[1] / self.teeth[0], self.shaft_angle - 0.5 * np.pi
        return float(np.arctan2(ratio * np.cos(beyond), 1.2 * (1.0 - ratio * np.sin(beyond))))

    def wheel_radius(self, wheel: Array) -> Array:
        """r_m2 (N,) by the wheel's pitch angle (N,) [ISO 23509 (12), (88)]."""
        if self.method == 1:
            return np.full_like(wheel, 0.5 * (self.diameter - self.face_width * np.sin(self.estimate)))
        across = 0.0 if self.method == 2 else self.face_width * np.sin(wheel)
        return np.asarray(0.5 * (self.diameter - across) + np.zeros_like(wheel))

    def touching(self, wheel: Array) -> TangentCones:
        """The tangent cones (N,) whose axes have the pair's shaft angle and offset, by the wheel's pitch angle (N,): nan where
        there are none.
        """
        roots = bracketed_root(
            lambda turn, at: self._offset_error(wheel[at], turn), np.zeros_like(wheel), self._widest(wheel)
        )
        cones = self._cones(wheel, np.where(roots.converged, roots.values, np.nan))
        steep = (np.abs(cones.spiral_angles) >= 0.5 * np.pi).any(axis=0)
        return TangentCones(*np.where(steep, np.nan, (cones.pitch_angles, cones.cone_distances, cones.spiral_angles)))

    def _widest(self, wheel: Array) -> Array:
        """Offset angle zeta_m (N,), as a size, at which delta_1 is 0 or zeta_mp or beta_m1 is 90 deg, whichever is first; 0 where
        delta_1 would be more than 90 deg.
        """
        cotangent = np.cos(self.shaft_angle) / np.sin(self.shaft_angle)
        flat = np.arccos(np.clip((np.tan(wheel) if cotangent > 0.0 else -1.0 / np.tan(wheel)) * cotangent, -1.0, 1.0))
        flat *= wheel > self.shaft_angle - 0.5 * np.pi
        if self.method == 1 or self.offset < 0.0:
            return np.asarray(flat)
        # tan(zeta_mp) = sin(zeta_m) / (cot(Sigma) cos(delta_2) + cos(zeta_m) sin(delta_2)) is 1 / tan(beta_m2)
        most = np.tan(0.5 * np.pi - self.spiral_angle)
        share = most * np.cos(wheel) * cotangent / np.hypot(1.0, most * np.sin(wheel))
        steep = np.arcsin(np.clip(share, -1.0, 1.0)) + np.arctan(most * np.sin(wheel))
        return np.asarray(np.minimum(flat, steep))

    def _leaning(self, wheel: Array, turn: Array) -> tuple[Array, Array, Array]:
        """delta_1, beta_m1, beta_m2 (N,) for an offset angle zeta_m `turn` (N,), as a size [ISO 23509 (90), (91)]."""
        sine, cosine = np.sin(self.shaft_angle), np.cos(self.shaft_angle)
        pinion = np.arcsin(np.clip(np.cos(turn) * sine * np.cos(wheel) - cosine * np.sin(wheel), -1.0, 1.0))
        along = cosine * np.cos(wheel) + sine * np.cos(turn) * np.sin(wheel)
        apart = np.copysign(1.0, self.offset) * np.arctan2(sine * np.sin(turn), along)
        if self.method == 1:
            return pinion, np.full_like(wheel, self.spiral_angle), self.spiral_angle - apart
        return pinion, self.spiral_angle + apart, np.full_like(wheel, self.spiral_angle)

    def _offset_error(self, wheel: Array, turn: Array) -> Array:
        """Offset of the axes less that of the pair, (N,), times cos(beta_m1) [ISO 23509 (113)]."""
        pinion, first, second = self._leaning(wheel, turn)
        radius = self.wheel_radius(wheel)
        reach = np.cos(first) + np.cos(second) * self.teeth[0] / self.teeth[1] * np.cos(wheel) / np.cos(pinion)
        return np.asarray(radius * np.sin(turn) * reach - abs(self.offset) * np.cos(first))

    def _cones(self, wheel: Array, turn: Array) -> TangentCones:
        pinion, first, second = self._leaning(wheel, turn)
        radius = self.wheel_radius(wheel)
        mating = radius * self.teeth[0] / self.teeth[1] * np.cos(second) / np.cos(first)
        with np.errstate(divide="ignore", invalid="ignore"):
            distances = np.array((mating / np.sin(pinion), radius / np.sin(wheel)))
        return TangentCones(np.array((pinion, wheel)), distances, np.array((first, second)))


def _line(pair: OffsetPair, cones: TangentCones) -> ToothLine:
    crown = pair.teeth[1] / np.sin(cones.pitch_angles[1])
    return ToothLine(pair.cutter, cones.cone_distances[1], cones.spiral_angles[1], crown)


def _as_curved_as_the_limit(pair: OffsetPair, cones: TangentCones) -> Array:
    """Curvatures in place of radii [ISO 23509 (33), (39), (40)]: the limit's radius goes through infinity."""
    return np.asarray(pair.cutter.radius * (_line(pair, cones).curvature - cones.limit_curvature))


def _centres_on_a_line(pair: OffsetPair, cones: TangentCones) -> Array:
    """[ISO 23509 (79)-(82)]: R_m1 = R_mcheck says that the pinion's apex is on the line of the wheel's and the cutter's centre."""
    line, apart, radius = _line(pair, cones), cones.offset_angle, pair.cutter.radius
    first, second = cones.cone_distances
    across = (second - first * np.cos(apart)) * radius * np.sin(line.centre_angle)
    along = first * np.sin(apart) * (second - radius * np.cos(line.centre_angle))
    return np.asarray((across - along) / (radius * second))


def _klingelnberg(pair: OffsetPair, cones: TangentCones) -> Array:
    """[ISO 23509 (99)-(106)], R_m1 less R_mint, times the denominator of (105)."""
    (first, second), apart, radius = cones.cone_distances, cones.offset_angle, pair.cutter.radius
    pinion, wheel = cones.pitch_angles
    beta1, beta2 = cones.spiral_angles
    lead = _line(pair, cones).lead_angle
    axial = np.arcsin(np.sin(apart) * np.cos(pinion) / np.sin(pair.shaft_angle))
    turned = beta2 + np.arctan(np.sin(wheel) * np.tan(axial))
    a3 = radius * np.cos(beta2 - lead) ** 2
    a4 = second * np.cos(turned) * np.cos(beta2)
    a5 = np.sin(apart) * np.cos(turned - beta2) * np.cos(lead)
    a6 = second * np.cos(beta2) + radius * np.sin(lead)
    a7 = np.cos(beta1) * np.cos(turned) - np.sin(turned - lead) * np.sin(apart) / np.cos(beta2 - lead)
    return np.asarray((first * (a5 * a6 + a3 * a7) - a3 * a4) / (radius * second))


CONDITIONS: dict[int, Condition] = {1: _as_curved_as_the_limit, 2: _centres_on_a_line, 3: _klingelnberg}


def with_offset(pair: OffsetPair) -> PitchCones:
    """The pitch cones of a pair with offset, by its method.

    Raises DesignError where there are none, saying up to which offset there are.
    """
    wheel, reached = _follow(pair)
    if reached != pair.offset:
        bound = f"at most {at_most(reached)}" if pair.offset > 0.0 else f"at least {at_least(reached)}"
        raise DesignError(
            "offset",
            pair.offset,
            unit="mm",
            reason=f"method {pair.method} has no pitch cones with this gear.cutter.tip_radius, {pair.cutter.radius:g} "
            f"mm, and spiral_angle, {np.degrees(pair.spiral_angle):g} deg",
            allowed=f"{bound} mm",
        )
    return _place(pair, pair.touching(np.array([wheel])))


def _follow(pair: OffsetPair) -> tuple[float, float]:
    """The wheel's pitch angle, and the offset it belongs to: the pair's, or the largest that the cones without it grow into."""
    wheel, reached = bevel_pitch_angles(pair.teeth, pair.shaft_angle)[1], 0.0
    step = longest = pair.offset / STEPS
    while reached != pair.offset and abs(step) > FINEST * abs(pair.offset):
        ahead = reached + step if abs(pair.offset - reached) > 1.5 * abs(step) else pair.offset
        wheel_angles = _roots(replace(pair, offset=ahead))
        near = wheel_angles[np.abs(wheel_angles - wheel) < FARTHEST]
        if near.size:
            wheel, reached = float(near[np.abs(near - wheel).argmin()]), ahead
            step = min(2.0 * step, longest, key=abs)
        else:
            step *= 0.5
    return wheel, reached


def _roots(pair: OffsetPair) -> Array:
    """All the wheel's pitch angles that meet the condition of the pair's method."""
    condition = CONDITIONS[pair.method]

    def offset_error(wheel: Array) -> Array:
        with np.errstate(invalid="ignore"):
            return condition(pair, pair.touching(wheel))

    table = offset_error(WHEEL_ANGLES)
    changes = np.flatnonzero(table[:-1] * table[1:] <= 0.0)
    roots = bracketed_root(lambda wheel, _: offset_error(wheel), WHEEL_ANGLES[changes], WHEEL_ANGLES[changes + 1])
    return roots.values[roots.converged]


def _place(pair: OffsetPair, cones: TangentCones) -> PitchCones:
    (pinion, wheel), (first, second), spirals = (
        values[:, 0].tolist() for values in (cones.pitch_angles, cones.cone_distances, cones.spiral_angles)
    )
    outer = second + 0.5 * pair.face_width if pair.method != 1 else float(0.5 * pair.diameter / np.sin(wheel))
    return PitchCones(
        pair.method,
        pair.teeth,
        pair.shaft_angle,
        pair.offset,
        (pinion, wheel),
        (first, second),
        (spirals[0], spirals[1]),
        pair.face_width,
        outer,
    )
