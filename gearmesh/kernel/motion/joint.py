"""The joint in which a member moves and its teeth follow each other: revolute about z, or prismatic along y.

Both joints have one degree of freedom, the angle (rad). A joint describes points of a member by three coordinates: the
angle, the radius at right angles to the motion, and z. A tooth at some angle is the first tooth moved by this angle.

                  angle          radius               velocity of a point per rad
    revolute      polar angle    rho = hypot(x, y)    z axis x r
    prismatic     y / `travel`   x                    `travel` along y

The `travel` (mm/rad) of a prismatic joint is the radius of the circle that rolls along it without slip, such as a
pinion's pitch circle: the angle is then the pinion's rotation. A rack's teeth are the limit of a gear's teeth whose
axis goes to x = -inf.
"""

from __future__ import annotations

from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import ARCSEC, Array, components, cross, plane_cross, polar_angle
from gearmesh.records import dataclass

#: an angle (rad), torque or radius, or an array of them
Quantity = TypeVar("Quantity", float, Array)


@dataclass(frozen=True)
class MotionUnits:
    """Units in which a motion is given in tables."""

    #: name of the motion in tables
    quantity: str
    #: rad in one unit of the motion, and the unit's name
    motion: tuple[float, str]
    #: rad in one unit of its error, and the unit's name
    error: tuple[float, str]


class Joint(Protocol):
    """A revolute or prismatic joint, in a member's own frame. Points are (..., 3), mm; angles are (...,), rad."""

    @property
    def travel(self) -> float | None:
        """Displacement, mm/rad, of all points of a prismatic joint; None for a revolute joint."""

    @property
    def radius_name(self) -> str:
        """Name of the radius in diagrams."""

    @property
    def reading(self) -> MotionUnits:
        """Units in which the motion is given."""

    def way(self, angle: Quantity) -> Quantity | None:
        """Return the displacement (mm) for an angle (rad); None for a revolute joint."""

    def force(self, torque: Quantity) -> Quantity | None:
        """Return the force (N) that does the same work as a torque (N mm) about the angle; None for a revolute joint."""

    def diameter(self, radius: Quantity) -> Quantity | None:
        """Return the diameter (mm) at a radius (mm); None for a prismatic joint."""

    def height(self, radius: Quantity) -> Quantity | None:
        """Return the height (mm) over x = 0 at a radius (mm); None for a revolute joint."""

    def spin(self, base: Rigid) -> Array:
        """Return the angular velocity (..., 3), rad/rad, in the frame to which `base` takes the member's frame.

        It is the axis of a revolute joint, and 0 for a prismatic joint.
        """

    def velocity(self, base: Rigid, r: Array) -> Array:
        """Return the velocity (..., 3), mm/rad, of points r (..., 3) in the frame to which `base` takes the member's
        frame."""

    def pitch(self, teeth: int) -> float:
        """Return the angle (rad) from one tooth to the next."""

    def places(self, teeth: int) -> NDArray[np.int64]:
        """Return the numbers (teeth,) of all teeth, counted in the direction of motion from the tooth at angle 0."""

    def cycle(self, teeth: int) -> float:
        """Return the number of pitches after which the first tooth returns; inf for a prismatic joint, in which it
        never does."""

    def rotation_angle(self, rotation: Array, tolerance: float) -> float | None:
        """Return the angle (rad) of the joint's motion with a rotation matrix (3, 3); None if there is none.

        `tolerance`: largest difference of the matrix from the rotation of that motion.
        """

    def to(self, angle: ArrayLike) -> Rigid:
        """Return the motion by angles (...,), rad, in the member's frame."""

    def angle(self, r: Array) -> Array:
        """Return the angle (...,), rad, of points r (..., 3): their polar angle, or y over the `travel`."""

    def place(self, angle: Array, radius: Array) -> Array:
        """Return x and y (..., 2), mm, of points at an angle (...,), rad, and a radius (...,), mm."""

    def angle_gradient(self, r: Array) -> Array:
        """Return the gradient (..., 3), 1/mm, of the angle of points r (..., 3)."""

    def angle_hessian(self, r: Array, w: Array) -> Array:
        """Return the Hessian of the angle of points r (..., 3), applied to vectors w (..., 3)."""

    def radius(self, r: Array) -> Array:
        """Return the radius (...,), mm, of points r (..., 3), which grows out of the body: the polar radius, or x."""

    def outward(self, r: Array) -> Array:
        """Return the gradient (..., 2) of the radius of points r (..., 3) over x and y."""

    def arm(self, r: Array) -> Array:
        """Return the speed (...,), mm/rad, of points r (..., 3): the radius in a revolute joint, else the `travel`."""

    def along(self, r: Array, w: Array) -> Array:
        """Return the scalar product (...,) of vectors w (..., 3) with the velocity (mm/rad) of points r (..., 3)."""

    def within(self, angle: Array) -> Array:
        """Return differences of angles (...,), rad, without full turns, so that they are next to zero.

        Differences that are already next to zero stay to the last digit.
        """

    def wrap(self, angle: Array) -> Array:
        """Return angles (...,), rad, moved to the range from -pi/2 to 3 pi/2 by full turns; unchanged for a prismatic
        joint."""

    def running(self, angle: Array) -> Array:
        """Return angles (N,), rad, in a row without their jumps by full turns."""

    def nearest(self, angle: float, guess: float) -> float:
        """Return the angle (rad) nearest to `guess` among all angles that differ from `angle` by full turns."""


@dataclass(frozen=True)
class Revolute:
    """Revolute joint: rotation about z."""

    @property
    def travel(self) -> None:
        return None

    @property
    def radius_name(self) -> str:
        return "radius"

    @property
    def reading(self) -> MotionUnits:
        return MotionUnits("phi2", (np.pi / 180.0, "deg"), (ARCSEC, "arcsec"))

    def way(self, angle: Quantity) -> None:
        return None

    def force(self, torque: Quantity) -> None:
        return None

    def diameter(self, radius: Quantity) -> Quantity:
        return 2.0 * radius

    def height(self, radius: Quantity) -> None:
        return None

    def spin(self, base: Rigid) -> Array:
        return base.rotation[..., 2]

    def velocity(self, base: Rigid, r: Array) -> Array:
        return cross(self.spin(base), r - base.translation)

    def pitch(self, teeth: int) -> float:
        return 2.0 * np.pi / teeth

    def places(self, teeth: int) -> NDArray[np.int64]:
        return np.arange(teeth)

    def cycle(self, teeth: int) -> float:
        return teeth

    def rotation_angle(self, rotation: Array, tolerance: float) -> float | None:
        return float(np.arctan2(rotation[1, 0], rotation[0, 0]))

    def to(self, angle: ArrayLike) -> Rigid:
        return Rigid.about_z(angle)

    def angle(self, r: Array) -> Array:
        return polar_angle(r)

    def place(self, angle: Array, radius: Array) -> Array:
        return components(radius * np.cos(angle), radius * np.sin(angle))

    def angle_gradient(self, r: Array) -> Array:
        square = r[..., 0] ** 2 + r[..., 1] ** 2
        return np.stack((-r[..., 1] / square, r[..., 0] / square, np.zeros_like(square)), axis=-1)

    def angle_hessian(self, r: Array, w: Array) -> Array:
        around, square = self.angle_gradient(r), (r[..., 0] ** 2 + r[..., 1] ** 2)[..., None]
        turned = np.stack((-w[..., 1], w[..., 0], np.zeros_like(w[..., 0])), axis=-1) / square
        outward = r[..., 0] * w[..., 0] + r[..., 1] * w[..., 1]
        hessian: Array = turned - 2.0 * around * outward[..., None] / square
        return hessian

    def radius(self, r: Array) -> Array:
        radius: Array = np.hypot(r[..., 0], r[..., 1])
        return radius

    def outward(self, r: Array) -> Array:
        direction: Array = r[..., :2] / self.radius(r)[..., None]
        return direction

    def arm(self, r: Array) -> Array:
        return self.radius(r)

    def along(self, r: Array, w: Array) -> Array:
        return plane_cross(r, w)

    def within(self, angle: Array) -> Array:
        return angle - 2.0 * np.pi * np.round(angle / (2.0 * np.pi))

    def wrap(self, angle: Array) -> Array:
        wrapped: Array = (angle + 0.5 * np.pi) % (2.0 * np.pi) - 0.5 * np.pi
        return wrapped

    def running(self, angle: Array) -> Array:
        return np.unwrap(angle)

    def nearest(self, angle: float, guess: float) -> float:
        return float(angle + 2.0 * np.pi * np.round((guess - angle) / (2.0 * np.pi)))


@dataclass(frozen=True)
class Prismatic:
    """Prismatic joint: translation along y."""

    #: displacement, mm/rad
    travel: float
    #: angle from one tooth to the next, rad
    step: float

    @property
    def radius_name(self) -> str:
        return "height"

    @property
    def reading(self) -> MotionUnits:
        return MotionUnits("displacement", (1.0 / self.travel, "mm"), (1e-3 / self.travel, "um"))

    def way(self, angle: Quantity) -> Quantity:
        return self.travel * angle

    def force(self, torque: Quantity) -> Quantity:
        return torque / self.travel

    def diameter(self, radius: Quantity) -> None:
        return None

    def height(self, radius: Quantity) -> Quantity:
        return radius

    def spin(self, base: Rigid) -> Array:
        return np.zeros_like(base.translation)

    def velocity(self, base: Rigid, r: Array) -> Array:
        way = base.vector(np.array([0.0, self.travel, 0.0]))
        return np.broadcast_to(way, np.broadcast_shapes(way.shape, r.shape))

    def pitch(self, teeth: int) -> float:
        return self.step

    def places(self, teeth: int) -> NDArray[np.int64]:
        # tooth 0 is in the middle, or the last tooth before the middle
        return np.arange(teeth) - (teeth - 1) // 2

    def cycle(self, teeth: int) -> float:
        return np.inf

    def rotation_angle(self, rotation: Array, tolerance: float) -> float | None:
        return 0.0 if abs(rotation[1, 0]) <= tolerance and rotation[0, 0] > 0.0 else None

    def to(self, angle: ArrayLike) -> Rigid:
        way = np.asarray(angle, dtype=float)[..., None] * np.array([0.0, self.travel, 0.0])
        return Rigid(np.broadcast_to(np.eye(3), (*way.shape[:-1], 3, 3)), way)

    def angle(self, r: Array) -> Array:
        angle: Array = r[..., 1] / self.travel
        return angle

    def place(self, angle: Array, radius: Array) -> Array:
        return components(radius, self.travel * angle)

    def angle_gradient(self, r: Array) -> Array:
        return np.broadcast_to(np.array([0.0, 1.0 / self.travel, 0.0]), r.shape)

    def angle_hessian(self, r: Array, w: Array) -> Array:
        return np.zeros_like(w)

    def radius(self, r: Array) -> Array:
        height: Array = r[..., 0]
        return height

    def outward(self, r: Array) -> Array:
        return np.broadcast_to(np.array([1.0, 0.0]), (*r.shape[:-1], 2))

    def arm(self, r: Array) -> Array:
        return np.full(r.shape[:-1], self.travel)

    def along(self, r: Array, w: Array) -> Array:
        power: Array = self.travel * w[..., 1]
        return power

    def within(self, angle: Array) -> Array:
        return angle

    def wrap(self, angle: Array) -> Array:
        return angle

    def running(self, angle: Array) -> Array:
        return angle

    def nearest(self, angle: float, guess: float) -> float:
        return angle


#: the revolute joint, the default of levels and members
REVOLUTE_JOINT = Revolute()
