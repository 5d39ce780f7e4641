"""How a member moves and how its teeth follow each other: a turn about its z axis, or a slide along its y axis.

Either is a group of one parameter, the angle (rad). It sees a member by three coordinates: the angle along the course, the reach at
right angles to it, and z. A tooth at some angle is the first one moved by it.

                 angle               reach               a point moves with the angle by
    turning      polar angle         rho = hypot(x, y)   z axis x r
    sliding      y / `radius`        x                   `radius` along y

The `radius` (mm) of a slide is that of the circle which rolls along it without slip, such as a pinion's pitch circle: its angle is
then the pinion's rotation. Teeth that slide are the limit of those of a gear whose axis goes to x = -inf.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import AXIS, Array, plane_cross, polar_angle


class Course(Protocol):
    """A turn or a slide, in a member's own frame; points are (..., 3), mm, angles (...,), rad."""

    @property
    def drift(self) -> Array | None:
        """Velocity (3,), mm/rad, of all points alike; None where there is none."""

    @property
    def spin(self) -> Array:
        """Angular velocity (3,), rad/rad."""

    def pitch(self, teeth: int) -> float:
        """Angle, rad, from one of so many teeth to the next."""

    def places(self, teeth: int) -> NDArray[np.int64]:
        """Numbers (teeth,) of all teeth, counted along the course from the one at angle 0."""

    def to(self, angle: ArrayLike) -> Rigid:
        """The motion by an angle."""

    def angle(self, r: Array) -> Array:
        """Where points are along the course."""

    def angle_gradient(self, r: Array) -> Array:
        """Gradient (..., 3), 1/mm, of that angle."""

    def angle_hessian(self, r: Array, w: Array) -> Array:
        """Its Hessian applied to vectors w (..., 3), (..., 3)."""

    def reach(self, r: Array) -> Array:
        """Coordinate (...,), mm, at right angles to course and z, growing out of the body."""

    def outward(self, r: Array) -> Array:
        """Gradient (..., 2) of the reach over x and y."""

    def arm(self, r: Array) -> Array:
        """How far (...,), mm/rad, points move along the course."""

    def along(self, r: Array, w: Array) -> Array:
        """Scalar product (...,) of vectors w (..., 3) with the velocity of points r, mm/rad."""

    def within(self, angle: Array) -> Array:
        """Differences of angles less the full turns that bring them next to zero; those that are there stay to the last digit."""

    def counted(self, angle: Array) -> Array:
        """Angles counted from -pi/2 to 3 pi/2, where a full turn is none."""

    def running(self, angle: Array) -> Array:
        """Angles (N,) in a row without jumps by full turns."""


@dataclass(frozen=True)
class Turning:
    """The turn about z."""

    @property
    def drift(self) -> None:
        return None

    @property
    def spin(self) -> Array:
        return AXIS

    def pitch(self, teeth: int) -> float:
        return 2.0 * np.pi / teeth

    def places(self, teeth: int) -> NDArray[np.int64]:
        return np.arange(teeth)

    def to(self, angle: ArrayLike) -> Rigid:
        return Rigid.about_z(angle)

    def angle(self, r: Array) -> Array:
        return polar_angle(r)

    def angle_gradient(self, r: Array) -> Array:
        square = r[..., 0] ** 2 + r[..., 1] ** 2
        return np.stack((-r[..., 1] / square, r[..., 0] / square, np.zeros_like(square)), axis=-1)

    def angle_hessian(self, r: Array, w: Array) -> Array:
        around, square = self.angle_gradient(r), (r[..., 0] ** 2 + r[..., 1] ** 2)[..., None]
        turned = np.stack((-w[..., 1], w[..., 0], np.zeros_like(w[..., 0])), axis=-1) / square
        outward = r[..., 0] * w[..., 0] + r[..., 1] * w[..., 1]
        hessian: Array = turned - 2.0 * around * outward[..., None] / square
        return hessian

    def reach(self, r: Array) -> Array:
        radius: Array = np.hypot(r[..., 0], r[..., 1])
        return radius

    def outward(self, r: Array) -> Array:
        direction: Array = r[..., :2] / self.reach(r)[..., None]
        return direction

    def arm(self, r: Array) -> Array:
        return self.reach(r)

    def along(self, r: Array, w: Array) -> Array:
        return plane_cross(r, w)

    def within(self, angle: Array) -> Array:
        return angle - 2.0 * np.pi * np.round(angle / (2.0 * np.pi))

    def counted(self, angle: Array) -> Array:
        wrapped: Array = (angle + 0.5 * np.pi) % (2.0 * np.pi) - 0.5 * np.pi
        return wrapped

    def running(self, angle: Array) -> Array:
        return np.unwrap(angle)


@dataclass(frozen=True)
class Sliding:
    """The slide along y, `radius` (mm) for every rad; `step` (rad) from one tooth to the next."""

    radius: float
    step: float

    @property
    def drift(self) -> Array:
        return np.array([0.0, self.radius, 0.0])

    @property
    def spin(self) -> Array:
        return np.zeros(3)

    def pitch(self, teeth: int) -> float:
        return self.step

    def places(self, teeth: int) -> NDArray[np.int64]:
        # the one at 0 is in the middle, or the last before it
        return np.arange(teeth) - (teeth - 1) // 2

    def to(self, angle: ArrayLike) -> Rigid:
        way = np.asarray(angle, dtype=float)[..., None] * self.drift
        return Rigid(np.broadcast_to(np.eye(3), (*way.shape[:-1], 3, 3)), way)

    def angle(self, r: Array) -> Array:
        turn: Array = r[..., 1] / self.radius
        return turn

    def angle_gradient(self, r: Array) -> Array:
        return np.broadcast_to(np.array([0.0, 1.0 / self.radius, 0.0]), r.shape)

    def angle_hessian(self, r: Array, w: Array) -> Array:
        return np.zeros_like(w)

    def reach(self, r: Array) -> Array:
        height: Array = r[..., 0]
        return height

    def outward(self, r: Array) -> Array:
        return np.broadcast_to(np.array([1.0, 0.0]), (*r.shape[:-1], 2))

    def arm(self, r: Array) -> Array:
        return np.full(r.shape[:-1], self.radius)

    def along(self, r: Array, w: Array) -> Array:
        travel: Array = self.radius * w[..., 1]
        return travel

    def within(self, angle: Array) -> Array:
        return angle

    def counted(self, angle: Array) -> Array:
        return angle

    def running(self, angle: Array) -> Array:
        return angle


TURNING = Turning()
