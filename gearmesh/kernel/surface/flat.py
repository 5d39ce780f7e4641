"""Planes along a sliding member, which take the place of a gear's tip and root cylinders on a rack."""

from __future__ import annotations

import numpy as np

from gearmesh.kernel.motion.joint import Prismatic
from gearmesh.kernel.numeric.algebra import Array, broadcast_pair
from gearmesh.kernel.surface.levels import Level
from gearmesh.kernel.surface.surface import Jet
from gearmesh.records import dataclass


@dataclass(frozen=True)
class FlatLevel:
    """g = x - `radius` (mm): a plane that contains the direction in which the `joint` moves a rack.

    `radius` has the name of the cylinder radius that it replaces.
    """

    radius: float
    joint: Prismatic

    def corners(self, axial: Level) -> tuple[float, ...]:
        return ()

    def across(self, axial: Level) -> Level:
        return FlatLevel(0.0, self.joint)

    @property
    def surface(self) -> FlatSurface:
        """The plane g = 0."""
        return FlatSurface(self)

    def at(self, z: float | Array) -> Array:
        """Return x, mm, at z."""
        return np.asarray(self.radius + 0.0 * np.asarray(z))

    def parallel(self, distance: float) -> FlatLevel:
        return FlatLevel(self.radius + distance, self.joint)

    def value(self, r: Array) -> Array:
        distance: Array = r[..., 0] - self.radius
        return distance

    def gradient(self, r: Array) -> Array:
        return np.broadcast_to(np.array([1.0, 0.0, 0.0]), r.shape)

    def hessian(self, r: Array, w: Array) -> Array:
        return np.zeros_like(w)


@dataclass(frozen=True)
class FlatSurface:
    """Plane of a level with its normal along x; parameters: u the angle of the joint (rad), v = z (mm)."""

    level: FlatLevel

    @property
    def cone(self) -> None:
        return None

    def jet(self, u: Array, v: Array) -> Jet:
        u, v = broadcast_pair(u, v)
        travel, zero, one = self.level.joint.travel, np.zeros_like(u), np.ones_like(u)
        none = np.zeros((*u.shape, 3))
        return Jet(
            r=np.stack((self.level.radius * one, travel * u, v), axis=-1),
            n=np.stack((one, zero, zero), axis=-1),
            r_u=np.stack((zero, travel * one, zero), axis=-1),
            r_v=np.stack((zero, zero, one), axis=-1),
            n_u=none,
            n_v=none,
        )

    def meeting(self, axial: Level, stations: Array) -> Array:
        """Return v (...,) of the plane at station coordinates `stations` (...,), mm; stations are planes across z."""
        v: Array = stations - axial.value(np.zeros(3))
        return v
