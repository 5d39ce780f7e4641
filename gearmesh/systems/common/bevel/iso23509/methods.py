"""Methods of ISO 23509 for pitch cones: 0 without offset, 1 (Gleason), 2 (Oerlikon), 3 (Klingelnberg) with offset.

| method | given size | given spiral angle | remaining condition |
|---|---|---|---|
| 0 | d_e2, b_2 | both | none: the cones have one apex |
| 1 | d_e2, b_2, an estimate of delta_2 | pinion | curvature of the tooth line: rho_mbeta = rho_lim of the limit normal |
| 2 | d_m2 | wheel | in the pitch plane both apexes and the cutter's centre are on one line |
| 3 | d_e2, b_2: mean point in the middle of the wheel's face | wheel | R_m1 = R_mint, (100) to (106) |

The standard iterates until 1 % (methods 1, 2) or 0.01 % is left. Here the wheel's pitch angle is found to rounding, in
two nested searches.

- Inner search: at a given wheel pitch angle, the pinion's offset angle that gives the offset is a root. It lies between
  0 and the offset angle at which the pinion's cone becomes a line or its teeth lie along the pitch circle.
- Outer search: the method's condition is tabulated over the wheel's pitch angle. Each change of its sign contains a
  root. Of several roots, the physical root is continuous in the offset and starts from the pitch angle without offset.

The given spiral angle is met exactly. In the standard's own sample, its single correction (20) to (26) leaves 0.002
deg. Its method 2 leaves cones that do not quite touch: spiral angles 23.981 deg apart, generatrices 23.969 deg. Lengths
in mm, angles in rad.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache
from typing import TypeAlias

import numpy as np

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.roots import bracketed_root
from gearmesh.records import dataclass
from gearmesh.systems.common.bevel.iso23509.pitch_cones import (
    PitchCones,
    TangentCones,
    bevel_pitch_angles,
    crown_shaft_angle,
)
from gearmesh.systems.common.bevel.iso23509.tooth_line import FaceCutter, ToothLine
from gearmesh.systems.common.bounds import at_most

#: wheel pitch angles of the table (rad); two roots closer than their distance, 0.2 deg, are both overlooked
WHEEL_ANGLES = np.radians(np.linspace(0.5, 89.9, 448))
#: number of steps in which the offset grows from 0
OFFSET_STEPS = 8
#: largest change of the wheel's pitch angle (rad) in a step; if it is exceeded, the step is halved
MAX_ANGLE_CHANGE = float(np.radians(8.0))
#: shortest step over the offset
MIN_STEP_SHARE = 1e-6
#: largest number of pairs whose pitch angles are kept
MAX_CACHED_PAIRS = 64

#: condition of a method: (pair, tangent cones (N,)) -> residuals (N,)
Condition: TypeAlias = "Callable[[OffsetPair, TangentCones], Array]"


def without_offset(
    teeth: tuple[int, int],
    shaft_angle: float,
    outer_diameter: float,
    face_width: float,
    spiral_angle: float,
    mean_cone_distance: float | None = None,
) -> PitchCones:
    """Return the pitch cones of method 0 by the wheel's outer diameter `outer_diameter` d_e2.

    The mean point is in the middle of the face unless its cone distance is given. Makes no check: cones with an angle
    of 90 deg or more cannot exist.
    """
    angles = bevel_pitch_angles(teeth, shaft_angle)
    outer = float(0.5 * outer_diameter / np.sin(angles[1]))
    mean = outer - 0.5 * face_width if mean_cone_distance is None else mean_cone_distance
    return PitchCones(0, teeth, shaft_angle, 0.0, angles, (mean, mean), (spiral_angle, spiral_angle), face_width, outer)


@dataclass(frozen=True)
class OffsetPair:
    """Input of the methods with offset. Without offset the cones are those of method 0.

    Raises DesignError, naming the key.
    """

    #: method of ISO 23509: 1, 2 or 3
    method: int
    #: numbers of teeth (pinion, wheel)
    teeth: tuple[int, int]
    #: shaft angle, rad
    shaft_angle: float
    #: offset a, mm; > 0 makes the pinion's spiral angle the larger one
    offset: float
    #: outer pitch diameter d_e2 of the wheel, mm; mean pitch diameter d_m2 in method 2 unless `by_outer`
    diameter: float
    #: face width b_2 of the wheel, mm
    face_width: float
    #: mean spiral angle, rad: beta_m1 of the pinion in method 1, else beta_m2 of the wheel
    spiral_angle: float
    #: face cutter of the wheel
    cutter: FaceCutter
    #: True if `diameter` is the outer one in method 2, too: the mean point is then in the middle of the face
    by_outer: bool = False

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
                allowed=Allowed.less_than(np.degrees(crown_shaft_angle(self.teeth)), "deg"),
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
        """Wheel pitch angle delta_int2 that method 1 estimates for the mean radius [ISO 23509 (11)]."""
        ratio, beyond = self.teeth[1] / self.teeth[0], self.shaft_angle - 0.5 * np.pi
        return float(np.arctan2(ratio * np.cos(beyond), 1.2 * (1.0 - ratio * np.sin(beyond))))

    def wheel_radius(self, wheel: Array) -> Array:
        """Return the wheel's mean radii r_m2 (N,) by its pitch angles (N,) [ISO 23509 (12), (88)]."""
        if self.method == 1:
            return np.full_like(wheel, 0.5 * (self.diameter - self.face_width * np.sin(self.estimate)))
        by_mean = self.method == 2 and not self.by_outer
        across = 0.0 if by_mean else self.face_width * np.sin(wheel)
        return np.asarray(0.5 * (self.diameter - across) + np.zeros_like(wheel))

    def touching(self, wheel: Array) -> TangentCones:
        """Return the tangent cones (N,) with the pair's shaft angle and offset, by the wheel's pitch angles (N,).

        Cones that cannot exist are nan.
        """
        # the offset grows from 0 with the offset angle, up to the largest possible one
        roots = bracketed_root(
            lambda turn, at: self._offset_error(wheel[at], turn), np.zeros_like(wheel), self._widest(wheel)
        )
        cones = self._cones(wheel, np.where(roots.converged, roots.values, np.nan))
        # a spiral angle of 90 deg and more is no tooth
        steep = (np.abs(cones.spiral_angles) >= 0.5 * np.pi).any(axis=0)
        return TangentCones(*np.where(steep, np.nan, (cones.pitch_angles, cones.cone_distances, cones.spiral_angles)))

    def _widest(self, wheel: Array) -> Array:
        """Return upper bounds (N,) of |zeta_m|, the offset angle, rad.

        The bound is the least angle at which delta_1 is 0, or zeta_mp or beta_m1 is 90 deg. It is 0 where delta_1 would
        be more than 90 deg.
        """
        cotangent = np.cos(self.shaft_angle) / np.sin(self.shaft_angle)
        # delta_1 = 0: the pinion's cone shrinks to a line
        flat = np.arccos(np.clip((np.tan(wheel) if cotangent > 0.0 else -1.0 / np.tan(wheel)) * cotangent, -1.0, 1.0))
        flat *= wheel > self.shaft_angle - 0.5 * np.pi
        if self.method == 1 or self.offset < 0.0:
            return np.asarray(flat)
        # tan(zeta_mp) = sin(zeta_m) / (cot(Sigma) cos(delta_2) + cos(zeta_m) sin(delta_2)) is 1 / tan(beta_m2)
        steepest_tangent = np.tan(0.5 * np.pi - self.spiral_angle)
        share = steepest_tangent * np.cos(wheel) * cotangent / np.hypot(1.0, steepest_tangent * np.sin(wheel))
        steep = np.arcsin(np.clip(share, -1.0, 1.0)) + np.arctan(steepest_tangent * np.sin(wheel))
        return np.asarray(np.minimum(flat, steep))

    def _leaning(self, wheel: Array, turn: Array) -> tuple[Array, Array, Array]:
        """Return delta_1, beta_m1, beta_m2 (N,), rad, for sizes |zeta_m| `turn` (N,) [ISO 23509 (90), (91)]."""
        sine, cosine = np.sin(self.shaft_angle), np.cos(self.shaft_angle)
        pinion = np.arcsin(np.clip(np.cos(turn) * sine * np.cos(wheel) - cosine * np.sin(wheel), -1.0, 1.0))
        along = cosine * np.cos(wheel) + sine * np.cos(turn) * np.sin(wheel)
        offset_angle = np.copysign(1.0, self.offset) * np.arctan2(sine * np.sin(turn), along)
        if self.method == 1:
            return pinion, np.full_like(wheel, self.spiral_angle), self.spiral_angle - offset_angle
        return pinion, self.spiral_angle + offset_angle, np.full_like(wheel, self.spiral_angle)

    def _offset_error(self, wheel: Array, turn: Array) -> Array:
        """Return the axes' offset less the pair's offset, times cos(beta_m1), (N,), mm [ISO 23509 (113)]."""
        pinion, pinion_spiral, wheel_spiral = self._leaning(wheel, turn)
        radius = self.wheel_radius(wheel)
        reach = np.cos(pinion_spiral) + np.cos(wheel_spiral) * self.teeth[0] / self.teeth[1] * np.cos(wheel) / np.cos(
            pinion
        )
        return np.asarray(radius * np.sin(turn) * reach - abs(self.offset) * np.cos(pinion_spiral))

    def _cones(self, wheel: Array, turn: Array) -> TangentCones:
        """Return the tangent cones (N,) by the wheel's pitch angles and the sizes of the offset angle, (N,)."""
        pinion, pinion_spiral, wheel_spiral = self._leaning(wheel, turn)
        radius = self.wheel_radius(wheel)
        mating = radius * self.teeth[0] / self.teeth[1] * np.cos(wheel_spiral) / np.cos(pinion_spiral)
        with np.errstate(divide="ignore", invalid="ignore"):
            distances = np.array((mating / np.sin(pinion), radius / np.sin(wheel)))
        return TangentCones(np.array((pinion, wheel)), distances, np.array((pinion_spiral, wheel_spiral)))


def _line(pair: OffsetPair, cones: TangentCones) -> ToothLine:
    """Return the tooth lines (N,) of the pair's cutter on tangent cones (N,)."""
    crown = pair.teeth[1] / np.sin(cones.pitch_angles[1])
    return ToothLine(pair.cutter, cones.cone_distances[1], cones.spiral_angles[1], crown)


def _as_curved_as_the_limit(pair: OffsetPair, cones: TangentCones) -> Array:
    """Return the residuals (N,) of method 1: curvature of the tooth line less the limit's [ISO 23509 (33), (39), (40)].

    Curvatures replace the radii of the standard because the limit's radius goes through infinity.
    """
    return np.asarray(pair.cutter.radius * (_line(pair, cones).curvature - cones.limit_curvature))


def _centres_on_a_line(pair: OffsetPair, cones: TangentCones) -> Array:
    """Return the residuals (N,) of method 2 [ISO 23509 (79)-(82)].

    R_m1 = R_mcheck says that the pinion's apex is on the line through the wheel's apex and the cutter's centre.
    """
    line, offset_angle, radius = _line(pair, cones), cones.offset_angle, pair.cutter.radius
    pinion_distance, wheel_distance = cones.cone_distances
    across = (wheel_distance - pinion_distance * np.cos(offset_angle)) * radius * np.sin(line.centre_angle)
    along = pinion_distance * np.sin(offset_angle) * (wheel_distance - radius * np.cos(line.centre_angle))
    return np.asarray((across - along) / (radius * wheel_distance))


def _klingelnberg(pair: OffsetPair, cones: TangentCones) -> Array:
    """Return the residuals (N,) of method 3: R_m1 less R_mint, times the denominator of (105) [ISO 23509 (99)-(106)]."""
    (pinion_distance, wheel_distance), offset_angle, radius = (
        cones.cone_distances,
        cones.offset_angle,
        pair.cutter.radius,
    )
    pinion, wheel = cones.pitch_angles
    beta1, beta2 = cones.spiral_angles
    lead = _line(pair, cones).lead_angle
    axial = np.arcsin(np.sin(offset_angle) * np.cos(pinion) / np.sin(pair.shaft_angle))
    turned = beta2 + np.arctan(np.sin(wheel) * np.tan(axial))
    a3 = radius * np.cos(beta2 - lead) ** 2
    a4 = wheel_distance * np.cos(turned) * np.cos(beta2)
    a5 = np.sin(offset_angle) * np.cos(turned - beta2) * np.cos(lead)
    a6 = wheel_distance * np.cos(beta2) + radius * np.sin(lead)
    a7 = np.cos(beta1) * np.cos(turned) - np.sin(turned - lead) * np.sin(offset_angle) / np.cos(beta2 - lead)
    return np.asarray((pinion_distance * (a5 * a6 + a3 * a7) - a3 * a4) / (radius * wheel_distance))


#: conditions of the methods with offset, by the number of the method
METHOD_CONDITIONS: dict[int, Condition] = {1: _as_curved_as_the_limit, 2: _centres_on_a_line, 3: _klingelnberg}


def with_offset(pair: OffsetPair) -> PitchCones:
    """Return the pitch cones of a pair with offset, by its method.

    Raises DesignError, with the largest possible offset, for an offset that has no pitch cones.
    """
    wheel, reached = _follow(pair)
    if reached != pair.offset:
        bound = Allowed.at_most(reached, "mm") if pair.offset > 0.0 else Allowed.at_least(reached, "mm")
        key = "head.radius" if pair.cutter.blade_groups else "gear.cutter.tip_radius"
        raise DesignError(
            "offset",
            pair.offset,
            unit="mm",
            reason=f"method {pair.method} has no pitch cones with this {key}, {pair.cutter.radius:g} mm, "
            f"and spiral_angle, {np.degrees(pair.spiral_angle):g} deg",
            allowed=bound,
        )
    return _place(pair, pair.touching(np.array([wheel])))


@lru_cache(maxsize=MAX_CACHED_PAIRS)
def _follow(pair: OffsetPair) -> tuple[float, float]:
    """Return the wheel's pitch angle (rad), and the offset (mm) that it belongs to.

    The offset is the pair's, or the largest that is reached from the cones without offset. Designs that differ in other
    keys, as machine settings, share the result.
    """
    wheel, reached = bevel_pitch_angles(pair.teeth, pair.shaft_angle)[1], 0.0
    step = longest = pair.offset / OFFSET_STEPS
    # The offset grows in steps. The root nearest to the last one belongs to the same branch as the pitch angle without
    # offset.
    while reached != pair.offset and abs(step) > MIN_STEP_SHARE * abs(pair.offset):
        ahead = reached + step if abs(pair.offset - reached) > 1.5 * abs(step) else pair.offset
        wheel_angles = _roots(replace(pair, offset=ahead))
        near = wheel_angles[np.abs(wheel_angles - wheel) < MAX_ANGLE_CHANGE]
        if near.size:
            wheel, reached = float(near[np.abs(near - wheel).argmin()]), ahead
            step = min(2.0 * step, longest, key=abs)
        else:
            step *= 0.5
    return wheel, reached


def _roots(pair: OffsetPair) -> Array:
    """Return all wheel pitch angles (rad) that meet the condition of the pair's method."""
    condition = METHOD_CONDITIONS[pair.method]

    def offset_error(wheel: Array) -> Array:
        with np.errstate(invalid="ignore"):
            return condition(pair, pair.touching(wheel))

    table = offset_error(WHEEL_ANGLES)
    changes = np.flatnonzero(table[:-1] * table[1:] <= 0.0)
    roots = bracketed_root(lambda wheel, _: offset_error(wheel), WHEEL_ANGLES[changes], WHEEL_ANGLES[changes + 1])
    return roots.values[roots.converged]


def _place(pair: OffsetPair, cones: TangentCones) -> PitchCones:
    """Return the pitch cones of tangent cones (1,): the mean point is placed in the wheel's face."""
    (pinion, wheel), (pinion_distance, wheel_distance), spirals = (
        values[:, 0].tolist() for values in (cones.pitch_angles, cones.cone_distances, cones.spiral_angles)
    )
    outer = wheel_distance + 0.5 * pair.face_width if pair.method != 1 else float(0.5 * pair.diameter / np.sin(wheel))
    return PitchCones(
        pair.method,
        pair.teeth,
        pair.shaft_angle,
        pair.offset,
        (pinion, wheel),
        (pinion_distance, wheel_distance),
        (spirals[0], spirals[1]),
        pair.face_width,
        outer,
    )
