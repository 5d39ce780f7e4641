"""Levels: functions whose zero bounds a body, such as planes, cones and cylinders about z on gears."""

from __future__ import annotations

from functools import cached_property
from typing import Protocol

import numpy as np

from gearmesh.kernel.motion.joint import REVOLUTE_JOINT, Joint
from gearmesh.kernel.numeric.algebra import Array, broadcast_pair, components, dot
from gearmesh.kernel.numeric.splines import Polynomials
from gearmesh.kernel.surface.surface import Jet, Surface
from gearmesh.records import dataclass

#: sines and cosines below this are those of a right angle, up to rounding
MAX_ROUNDED_ZERO = 4e-16


class Level(Protocol):
    """A function g(r) with gradient and Hessian, whose zero level bounds a body (g < 0 inside)."""

    def value(self, r: Array) -> Array:
        """Return g (...,) at points r (..., 3), mm, negative inside."""

    def gradient(self, r: Array) -> Array:
        """Return the gradient (..., 3) of g at points r (..., 3)."""

    def hessian(self, r: Array, w: Array) -> Array:
        """Return the Hessian of g at points r (..., 3), applied to vectors w (..., 3)."""


class LandSurface(Surface, Protocol):
    """Surface of a land or root; its first parameter is the angle along which teeth follow each other."""

    def meeting(self, axial: Level, stations: Array) -> Array:
        """Return the second parameter near places along the face.

        `axial`: the coordinate along the face. `stations`: values (...,) of this coordinate, mm. Result: (...,), in
        the surface's own unit.
        """

    @property
    def cone(self) -> ConeLevel | None:
        """The plane, cylinder or cone that the surface is; None for any other surface."""


class LandLevel(Level, Protocol):
    """Level of lands and roots: a surface of revolution, or a plane along which a rack slides."""

    @property
    def surface(self) -> LandSurface:
        """The surface g = 0."""

    def corners(self, axial: Level) -> tuple[float, ...]:
        """Return the corners of the meridian: values (mm) of the `axial` coordinate along the face, ascending."""

    def at(self, z: float | Array) -> Array:
        """Return the distance (...,), mm, from the axis, or from a rack's reference plane, at z (...,), mm."""

    def across(self, axial: Level) -> Level:
        """Return the coordinate (mm) at right angles to the `axial` coordinate along the face."""

    def parallel(self, distance: float) -> LandLevel:
        """Return the level of the parallel surface at a distance (mm), positive out of the body."""


@dataclass(frozen=True)
class PlaneLevel:
    """g = sign (z - z0): an end face across the axis; `sign` +1 bounds z < z0."""

    z0: float
    sign: float = 1.0

    def value(self, r: Array) -> Array:
        return self.sign * (r[..., 2] - self.z0)

    def gradient(self, r: Array) -> Array:
        gradient = np.zeros(r.shape)
        gradient[..., 2] = self.sign
        return gradient

    def hessian(self, r: Array, w: Array) -> Array:
        return np.zeros_like(w)


@dataclass(frozen=True)
class SlantedLevel:
    """g = (r - point) . normal: distance (mm) from a plane given by its unit normal (3,) and one of its points (3,)."""

    normal: Array
    point: Array

    def value(self, r: Array) -> Array:
        value: Array = (r - self.point) @ self.normal
        return value

    def gradient(self, r: Array) -> Array:
        return np.broadcast_to(self.normal, r.shape)

    def hessian(self, r: Array, w: Array) -> Array:
        return np.zeros_like(w)


@dataclass(frozen=True)
class ConeLevel:
    """g = sin(angle) rho + cos(angle) z - offset: the plane, cone or cylinder g = 0 about z, with parallels at other g.

    `angle` (rad) is the angle of the normal from z towards rho: 0 and pi are planes across the axis, pi/2 is a
    cylinder. g is the distance along the normal, mm. As the station coordinate of a bevel gear, `angle` is the pitch
    cone angle and g the cone distance.
    """

    angle: float
    offset: float = 0.0

    @staticmethod
    def of(radius: float, slope: float = 0.0) -> ConeLevel:
        """Return the cone rho = radius + slope z (mm), with the axis inside."""
        length = float(np.hypot(1.0, slope))
        return ConeLevel(float(np.arctan2(1.0, -slope)), radius / length)

    @cached_property
    def normal(self) -> tuple[float, float]:
        """Unit gradient (rho, z), without rounding errors for planes and cylinders."""
        s, c = float(np.sin(self.angle)), float(np.cos(self.angle))
        return (s if abs(s) > MAX_ROUNDED_ZERO else 0.0), (c if abs(c) > MAX_ROUNDED_ZERO else 0.0)

    @property
    def radius(self) -> float:
        """rho, mm, at z = 0; undefined for a plane."""
        return self.offset / self.normal[0]

    @property
    def slope(self) -> float:
        """d rho / dz; undefined for a plane."""
        return -self.normal[1] / self.normal[0]

    def corners(self, axial: Level) -> tuple[float, ...]:
        return ()

    def across(self, axial: Level) -> Level:
        return perpendicular(axial)

    def at(self, z: float | Array) -> Array:
        """Return the radius (...,), mm, at z (...,), mm; undefined for a plane."""
        return np.asarray(self.radius + self.slope * z)

    def parallel(self, distance: float) -> ConeLevel:
        return ConeLevel(self.angle, self.offset + distance)

    @property
    def surface(self) -> ConeSurface:
        """The surface g = 0."""
        return ConeSurface(self)

    def value(self, r: Array) -> Array:
        s, c = self.normal
        return s * np.hypot(r[..., 0], r[..., 1]) + c * r[..., 2] - self.offset

    def gradient(self, r: Array) -> Array:
        s, c = self.normal
        outward = s / np.hypot(r[..., 0], r[..., 1])
        return components(r[..., 0] * outward, r[..., 1] * outward, c)

    def hessian(self, r: Array, w: Array) -> Array:
        rho = np.hypot(r[..., 0], r[..., 1])
        x, y = r[..., 0] / rho, r[..., 1] / rho
        across = self.normal[0] * (x * w[..., 1] - y * w[..., 0]) / rho
        return components(-y * across, x * across, 0.0)


def station_normal(level: Level) -> tuple[float, float]:
    """Return the unit gradient (rho, z) of a station coordinate, which is linear in rho and z."""
    gradient = level.gradient(np.array([1.0, 0.0, 0.0]))
    return float(gradient[0]), float(gradient[2])


def perpendicular(axial: Level) -> ConeLevel:
    """Return the coordinate at right angles to a station coordinate in the axial half plane.

    For stations z it is rho, which grows away from the axis.
    """
    across, up = station_normal(axial)
    return ConeLevel(float(np.arctan2(up, -across)))


@dataclass(frozen=True)
class ConeSurface:
    """The surface g = 0 of a `ConeLevel`, with its normal along the gradient of g.

    Parameters: u is the polar angle (rad), v the length (mm) along the generatrix (rho, z) = offset (sin, cos) + v
    (-cos, sin) of the level's angle. On a cylinder v = z; on a plane that bounds z from below (angle pi) v = rho.
    """

    level: ConeLevel

    @property
    def cone(self) -> ConeLevel:
        return self.level

    def jet(self, u: Array, v: Array) -> Jet:
        u, v = broadcast_pair(u, v)
        (a, b), offset = self.level.normal, self.level.offset
        c, s, zero, one = np.cos(u), np.sin(u), np.zeros_like(u), np.ones_like(u)
        rho = offset * a - v * b
        return Jet(
            r=np.stack((rho * c, rho * s, offset * b + v * a), axis=-1),
            n=np.stack((a * c, a * s, b * one), axis=-1),
            r_u=np.stack((-rho * s, rho * c, zero), axis=-1),
            r_v=np.stack((-b * c, -b * s, a * one), axis=-1),
            n_u=np.stack((-a * s, a * c, zero), axis=-1),
            n_v=np.zeros((*u.shape, 3)),
        )

    def meeting(self, axial: Level, stations: Array) -> Array:
        """Return the second parameter at given station coordinates.

        `axial`: the station coordinate. `stations`: (...,), mm. Result: v (...,), mm.
        """
        (a, b), (across, up) = self.level.normal, station_normal(axial)
        distance = stations - axial.value(np.zeros(3))
        return (distance - self.level.offset * (across * a + up * b)) / (up * a - across * b)


@dataclass(frozen=True)
class Shifted:
    """sign * (level - offset): the surface at another value of a level; `sign` -1 exchanges inside and outside."""

    level: Level
    offset: float
    sign: float = 1.0

    def value(self, r: Array) -> Array:
        return self.sign * (self.level.value(r) - self.offset)

    def gradient(self, r: Array) -> Array:
        return self.sign * self.level.gradient(r)

    def hessian(self, r: Array, w: Array) -> Array:
        return self.sign * self.level.hessian(r, w)


@dataclass(frozen=True)
class CurveLevel:
    """g = sign (f(a) - w): surface of revolution through a curve w = f(a) of the axial half plane."""

    #: station coordinate a, mm
    axial: Level
    #: coordinate w at right angles to a, mm
    across: Level
    #: the function f
    curve: Polynomials
    #: +1 if the surface bounds w from below, -1 if from above
    sign: float = 1.0

    def value(self, r: Array) -> Array:
        value: Array = self.sign * (self.curve(self.axial.value(r)) - self.across.value(r))
        return value

    def gradient(self, r: Array) -> Array:
        slope = self.curve(self.axial.value(r), 1)
        gradient: Array = self.sign * (slope[..., None] * self.axial.gradient(r) - self.across.gradient(r))
        return gradient

    def hessian(self, r: Array, w: Array) -> Array:
        a, along = self.axial.value(r), self.axial.gradient(r)
        slope, bend = self.curve.derivatives(a, 1, 2)
        bend = bend * dot(along, w)
        hessian: Array = self.sign * (
            bend[..., None] * along + slope[..., None] * self.axial.hessian(r, w) - self.across.hessian(r, w)
        )
        return hessian


@dataclass(frozen=True)
class ScrewLevel:
    """g = radius (theta - f(a)): surface across the motion of a joint, through a curve of angles theta = f(a)."""

    #: station coordinate a, mm
    axial: Level
    #: the function f, rad
    curve: Polynomials
    #: factor (mm) that makes g a length; its sign determines the inside
    radius: float
    #: joint that defines the angle theta
    joint: Joint = REVOLUTE_JOINT

    def value(self, r: Array) -> Array:
        value: Array = self.radius * self.joint.within(self.joint.angle(r) - self.curve(self.axial.value(r)))
        return value

    def gradient(self, r: Array) -> Array:
        around, slope = self.joint.angle_gradient(r), self.curve(self.axial.value(r), 1)
        gradient: Array = self.radius * (around - slope[..., None] * self.axial.gradient(r))
        return gradient

    def hessian(self, r: Array, w: Array) -> Array:
        a, along = self.axial.value(r), self.axial.gradient(r)
        slope, bend = self.curve.derivatives(a, 1, 2)
        bend = bend * dot(along, w)
        by_curve = bend[..., None] * along + slope[..., None] * self.axial.hessian(r, w)
        hessian: Array = self.radius * (self.joint.angle_hessian(r, w) - by_curve)
        return hessian
