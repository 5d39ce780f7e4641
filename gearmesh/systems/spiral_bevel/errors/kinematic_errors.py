"""First-order kinematic errors of gears in closed form, and their compensation [CR3553 ch. 3].

If errors move the point of a driving flank by ds1 and the point of the driven flank by ds2, the gear turns until the
flanks touch again [3.3.16]:

    dphi2 (axis2 x rho2) . n = (ds1 - ds2) . n

with the nominal contact point, its normal n and the signed axis of the gear. All vectors are in the fixed frame (the
pinion's frame at its nominal position), lengths in mm, angles in rad; shapes broadcast to (...,). The errors of the
exact contact differ by terms of second order.

Differences from the printed source:

- Chapter 3 is chapter 2 with the other sense of x_f. Matrices L_fh and L_fp of (3.4.1) and (3.4.3) are transposed
  against (2.3.1) and (2.3.3). This reverses the sign of sin(gamma_i) in (3.4.2), (3.4.4) and in b_1, b_2 of (3.4.13),
  and both eccentricities turn the other way. Here all equations follow chapter 2. Denominators are unchanged: their
  terms in cos(gamma_2) cancel on the line of action, where y n_x = x n_y (2.2.16).
- (3.1.3) and (3.2.17) count the error as nominal less actual, (3.2.5) and (3.3.16) as actual less nominal. Here it is
  actual less nominal.
- (3.4.14) has + before its second term, and phi_1 in it; (3.4.12) gives - and phi_2 (see `parallel_axes_eccentricity`).
- (3.5.5) lacks the sign of (3.5.4), and y of (3.5.17) lacks the factor x_f of (2.2.25).
- (3.5.31) must be + cot(q_d) tan(psi_c) / (sin(gamma_2) cos(beta)) Delta delta; (3.5.34) and (3.5.35) follow from this
  equation, not from the printed one.

The transmission error of a misassembled or eccentric pair follows from its nominal contact, without errors: each error
adds a scalar product [CR3553 3.4, 3.5].
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import field
from typing import TYPE_CHECKING, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from gearmesh.contact.flanks import analyse
from gearmesh.design.runout import runout
from gearmesh.kernel.numeric.algebra import Array, cross, dot, unit
from gearmesh.records import dataclass
from gearmesh.systems.spiral_bevel.machine.pair import without_errors
from gearmesh.systems.system import FirstOrder
from gearmesh.teeth.gear_train import GearTrain

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import HandedDesign


@dataclass(frozen=True)
class NominalContact:
    """Contact without errors. Axes point from the apex to the heel.

    The pinion's axis passes through the origin, the gear's axis through `gear_origin`. Both points are the feet of the
    common perpendicular.
    """

    #: points of contact (..., 3), mm
    point: Array
    #: unit normals (..., 3)
    normal: Array
    #: direction of the pinion's axis (3,)
    pinion_axis: Array
    #: direction of the gear's axis (3,)
    gear_axis: Array
    #: +1 where the pinion turns right-handed about its axis as phi1 grows (right-hand pinions), else -1; the gear turns
    #: in the opposite sense
    sense: float
    #: point of the gear's axis (3,), mm
    gear_origin: Array = field(default_factory=lambda: np.zeros(3))

    @property
    def across(self) -> Array:
        """Direction of the common perpendicular, (3,): y of the pinion's frame where the axes intersect."""
        return unit(cross(self.pinion_axis, self.gear_axis))

    @property
    def lever(self) -> Array:
        """n . (axis2 x rho2), (...,), mm: velocity of the gear's flank along the normal per unit of phi2."""
        return dot(self.normal, cross(-self.sense * self.gear_axis, self.point - self.gear_origin))

    def error(self, shift: Array) -> Array:
        """Return the error of phi2 (...,) for a displacement ds1 - ds2 (..., 3) [3.3.16]."""
        return dot(self.normal, shift) / self.lever

    def pinion_axial(self, shift: ArrayLike) -> Array:
        """Return the error for a pinion displaced by `shift` along its axis away from the apex."""
        return self.error(np.asarray(shift, dtype=float)[..., None] * self.pinion_axis)

    def gear_axial(self, shift: ArrayLike) -> Array:
        """Return the error for a gear displaced by `shift` along its axis away from the apex."""
        return self.error(-np.asarray(shift, dtype=float)[..., None] * self.gear_axis)

    def crown_axial(self, shift: ArrayLike, pitch_angle: float) -> Array:
        """Return the error for a pinion displaced by `shift` along -x_f, the axis of the crown gear [3.5.1, 3.5.3].

        `pitch_angle`: pitch angle of the pinion.
        """
        x_f = np.array([np.cos(pitch_angle), 0.0, -np.sin(pitch_angle)])
        return self.error(-np.asarray(shift, dtype=float)[..., None] * x_f)

    def offset(self, shift: ArrayLike) -> Array:
        """Return the error for a pinion displaced by `shift` along the common perpendicular, +y.

        The source's Delta E is along -y [3.5.4, 3.5.5].
        """
        return self.error(np.asarray(shift, dtype=float)[..., None] * self.across)

    def shaft_angle(self, angle: ArrayLike) -> Array:
        """Return the error for a shaft angle opened by `angle`, with the gear turned about y, the common perpendicular.

        The source closes the shaft angle [3.5.6-3.5.9].
        """
        turned = cross(self.across, self.point)
        return self.error(-np.asarray(angle, dtype=float)[..., None] * turned)

    def eccentricity(self, pinion: Array, gear: Array) -> Array:
        """Error for teeth displaced by the vectors `pinion` and `gear` (..., 3) in the fixed frame [3.4.5, 3.4.7]."""
        return self.error(pinion - gear)


@dataclass(frozen=True)
class Harmonics:
    """Error of phi2 as a_1 sin(t1) + b_1 cos(t1) + a_2 sin(t2) + b_2 cos(t2) [3.4.11-3.4.13].

    t1 = phi1 + alpha1 and t2 = phi2 + alpha2 are the directions of the eccentricities. They count in the sense of phi1
    and phi2 from the members' x axes towards the pitch line. The period of t1 is a turn of the pinion, the period of t2
    a turn of the gear.
    """

    #: coefficient of sin(t1), rad
    a1: float
    #: coefficient of cos(t1), rad
    b1: float
    #: coefficient of sin(t2), rad
    a2: float
    #: coefficient of cos(t2), rad
    b2: float

    def at(self, t1: ArrayLike, t2: ArrayLike) -> Array:
        """Return the error (...,), rad, at t1 and t2 (...,), rad."""
        t1, t2 = np.asarray(t1, dtype=float), np.asarray(t2, dtype=float)
        error: Array = self.a1 * np.sin(t1) + self.b1 * np.cos(t1) + self.a2 * np.sin(t2) + self.b2 * np.cos(t2)
        return error

    @property
    def amplitudes(self) -> tuple[float, float]:
        """Amplitudes of the pinion's and the gear's wave, rad."""
        return float(np.hypot(self.a1, self.b1)), float(np.hypot(self.a2, self.b2))

    @property
    def phases(self) -> tuple[float, float]:
        """t1 and t2 (rad) of the crests of the pinion's and the gear's wave."""
        return float(np.arctan2(self.a1, self.b1)), float(np.arctan2(self.a2, self.b2))


def harmonics(mean: NominalContact, pinion: float, gear: float) -> Harmonics:
    """Return the four harmonics of the eccentricities `pinion` and `gear` (mm) [3.4.11].

    The contact is at the mean point throughout.

    They are smooth where (3.4.7) has a corner, at the change of teeth.
    """
    y = np.array([0.0, 1.0, 0.0])
    x1, x2 = cross(y, mean.pinion_axis), cross(mean.gear_axis, y)
    return Harmonics(
        a1=float(mean.error(pinion * mean.sense * y)),
        b1=float(mean.error(pinion * x1)),
        # the y axis of the gear's frame is -y, and phi2 turns the gear in the opposite sense
        a2=float(mean.error(-gear * mean.sense * y)),
        b2=float(mean.error(-gear * x2)),
    )


def parallel_axes_eccentricity(
    pinion: float, gear: float, t1: ArrayLike, t2: ArrayLike, pitch_radius: float, pressure_angle: float
) -> Array:
    """Return the error of phi2 (...,), rad, by eccentricities `pinion` and `gear` (mm) of spur gears [3.4.12, 3.4.14].

    - `t1`, `t2`: directions of the eccentricities (..., rad), from the direction from the gear's axis to the pinion's;
      each counts in the sense of rotation of its member
    - `pitch_radius`, `pressure_angle`: working values of the gear, mm and rad; as in the source, the angle is > 0 where
      the pinion pushes the gear towards smaller phi2, < 0 where towards larger phi2

    With equal teeth and eccentricities the error is 0 for t2 - t1 = pi - 2 pressure_angle. At the source's value, pi,
    the error is 2 e tan(pressure_angle) / pitch_radius.
    """
    t1, t2 = np.asarray(t1, dtype=float), np.asarray(t2, dtype=float)
    waves = pinion * np.sin(pressure_angle - t1) - gear * np.sin(pressure_angle + t2)
    error: Array = waves / (pitch_radius * np.cos(pressure_angle))
    return error


def compensation(
    spiral_angle: float, psi_c: float, cone_distance: float, closed: float, cradle_angle: float | None = None
) -> tuple[float, float]:
    """Return the displacements of the pinion (mm) that cancel a shaft angle closed by `closed` (rad).

    The displacements are along y, and along the pitch line to the heel. To first order they cancel the error at the
    mean point and its slope. Geometry I: (3.5.28), (3.5.29). Geometry II, with the cradle angle q of the gear's cutter:
    (3.5.34), (3.5.35). Both are for a left-hand pinion's convex side, as in `conjugate`. The source's Delta E and Delta
    L cause the same error; they have the opposite sign.
    """
    s, c, size = np.sin(spiral_angle), np.cos(spiral_angle), cone_distance * np.tan(psi_c) * closed
    if cradle_angle is None:
        return float(-np.cos(2.0 * spiral_angle) / c * size), float(-2.0 * s * size)
    t = np.tan(cradle_angle)
    return float(-(c - s * t) * size), float(-(s + c * t) * size)


BevelT = TypeVar("BevelT", bound="HandedDesign")


def first_order(design: BevelT, build: Callable[[BevelT], GearTrain]) -> FirstOrder | None:
    """Return the closed form for a design in mm that `build` builds, or None for a design without errors."""
    errors = design.assembly
    # phases alone are no errors
    if not any(value for key, value in errors.plain().items() if not key.endswith("_phase")):
        return None

    def transmission_error(phi1: Array) -> Array:
        pair = build(design.with_values(without_errors(design))).pairs[0]
        # nominal contact at phi1, and at the mean point as the last one
        path = analyse(pair, np.append(phi1, 0.0))
        pinion_mount, gear_mount = pair.mounts
        nominal = NominalContact(
            path.point, path.normal, pinion_mount.axis, gear_mount.axis, pinion_mount.sign, gear_mount.origin
        )
        # displacement of the teeth of each member by its eccentricity, in the fixed frame
        teeth = [
            member.mount.at(turn).vector(np.array([*runout(design, member.name), 0.0]))
            for member, turn in zip(pair.both, (path.rotation, path.phi2), strict=True)
        ]
        error = (
            nominal.pinion_axial(errors.dA)
            + nominal.gear_axial(errors.dG)
            + nominal.offset(errors.dV)
            + nominal.shaft_angle(np.radians(errors.d_delta))
            + nominal.eccentricity(*teeth)
        )
        total: Array = path.te + error
        # relative to the mean point
        relative: Array = (total - total[-1])[:-1]
        return relative

    return transmission_error
