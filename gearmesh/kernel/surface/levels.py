"""Levels: functions whose zero bounds a body, and the planes, cones and cylinders about z that they are on gears."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np

from gearmesh.kernel.motion.joint import REVOLUTE, Joint
from gearmesh.kernel.numeric.algebra import Array, broadcast_pair, components, dot
from gearmesh.kernel.numeric.splines import Polynomials
from gearmesh.kernel.surface.surface import Jet, Surface

#: sines and cosines below this are those of a right angle, to rounding
RIGHT_ANGLE = 4e-16


class Level(Protocol):
    """A function g(r) whose zero level bounds a body (g < 0 inside), with gradient and Hessian."""

    def value(self, r: Array) -> Array:
        """The function at points.

        Parameters
        ----------
        r : ndarray
            Points (..., 3), mm.

        Returns
        -------
        ndarray
            g (...,), negative inside.

        Examples
        --------
        >>> tip = gears.members["pinion"].tooth.chain[gm.Region.LAND].cone
        >>> float(tip.value(np.array([19.0, 0.0, 0.0])))
        -1.0
        """

    def gradient(self, r: Array) -> Array:
        """Its gradient.

        Parameters
        ----------
        r : ndarray
            Points (..., 3), mm.

        Returns
        -------
        ndarray
            (..., 3).

        Examples
        --------
        >>> tip = gears.members["pinion"].tooth.chain[gm.Region.LAND].cone
        >>> tip.gradient(np.array([19.0, 0.0, 0.0])).tolist()
        [1.0, 0.0, 0.0]
        """

    def hessian(self, r: Array, w: Array) -> Array:
        """Its Hessian, applied to vectors.

        Parameters
        ----------
        r : ndarray
            Points (..., 3), mm.
        w : ndarray
            Vectors (..., 3).

        Returns
        -------
        ndarray
            (..., 3).

        Examples
        --------
        >>> tip = gears.members["pinion"].tooth.chain[gm.Region.LAND].cone
        >>> tip.hessian(np.array([20.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])).tolist()
        [-0.0, 0.05, 0.0]
        """


class LandSurface(Surface, Protocol):
    """The surface of a land or root; its first parameter is the angle along which teeth follow each other."""

    def meeting(self, axial: Level, stations: Array) -> Array:
        """Second parameter near places along the face.

        Parameters
        ----------
        axial : Level
            The coordinate along the face.
        stations : ndarray
            Its values (...,), mm.

        Returns
        -------
        ndarray
            (...,), in the surface's own unit.

        Examples
        --------
        >>> blank = gears.members["pinion"].tooth.blank
        >>> blank.tip.surface.meeting(blank.axial, np.array([0.0, 1.0])).tolist()
        [0.0, 1.0]
        """

    @property
    def cone(self) -> ConeLevel | None:
        """The plane, cylinder or cone that it is, None for any other surface."""


class LandLevel(Level, Protocol):
    """What lands and roots lie on: a surface of revolution, or a plane along which a rack slides."""

    @property
    def surface(self) -> LandSurface:
        """The surface g = 0."""

    def corners(self, axial: Level) -> tuple[float, ...]:
        """Corners of its meridian.

        Parameters
        ----------
        axial : Level
            The coordinate along the face.

        Returns
        -------
        tuple of float
            Values of that coordinate, mm, ascending.

        Examples
        --------
        >>> blank = gears.members["pinion"].tooth.blank
        >>> blank.tip.corners(blank.axial)
        ()
        """

    def at(self, z: float | Array) -> Array:
        """Its distance from the axis, or from a rack's reference plane.

        Parameters
        ----------
        z : float or ndarray
            (...,), mm, along the axis.

        Returns
        -------
        ndarray
            (...,), mm.

        Examples
        --------
        >>> float(gears.members["pinion"].tooth.blank.tip.at(0.0))
        20.0
        """

    def across(self, axial: Level) -> Level:
        """The coordinate at right angles to that along the face.

        Parameters
        ----------
        axial : Level
            The coordinate along the face.

        Returns
        -------
        Level
            mm, across it.

        Examples
        --------
        >>> blank = gears.members["pinion"].tooth.blank
        >>> across = blank.tip.across(blank.axial)
        >>> across.gradient(np.array([19.0, 0.0, 0.0])).tolist()
        [1.0, 0.0, 0.0]
        """

    def parallel(self, distance: float) -> LandLevel:
        """The level of the parallel surface.

        Parameters
        ----------
        distance : float
            mm, positive out of the body.

        Returns
        -------
        LandLevel

        Examples
        --------
        >>> float(gears.members["pinion"].tooth.blank.tip.parallel(0.5).at(0.0))
        20.5
        """


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
    """g = (r - point) . normal: distance (mm) from a plane of any direction, by its unit normal (3,) and a point (3,) of it."""

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
    """g = sin(angle) rho + cos(angle) z - offset: every plane, cone or cylinder about z, and all those parallel to it.

    `angle` (rad): of the normal, from z towards rho; 0 and pi: planes across the axis, pi/2: cylinders. g is the distance
    along the normal, mm. As stations of a bevel gear the angle is that of its pitch cone and g the cone distance.
    """

    angle: float
    offset: float = 0.0

    @staticmethod
    def of(radius: float, slope: float = 0.0) -> ConeLevel:
        """The cone rho = radius + slope z, with the axis inside.

        Parameters
        ----------
        radius : float
            At z = 0, mm.
        slope : float
            d rho / dz.

        Returns
        -------
        ConeLevel

        Examples
        --------
        >>> gm.ConeLevel.of(20.0).radius
        20.0
        """
        length = float(np.hypot(1.0, slope))
        return ConeLevel(float(np.arctan2(1.0, -slope)), radius / length)

    @cached_property
    def normal(self) -> tuple[float, float]:
        """Unit gradient (rho, z); planes and cylinders exactly so."""
        s, c = float(np.sin(self.angle)), float(np.cos(self.angle))
        return (s if abs(s) > RIGHT_ANGLE else 0.0), (c if abs(c) > RIGHT_ANGLE else 0.0)

    @property
    def radius(self) -> float:
        """rho, mm, at z = 0; not of a plane."""
        return self.offset / self.normal[0]

    @property
    def slope(self) -> float:
        """d rho / dz; not of a plane."""
        return -self.normal[1] / self.normal[0]

    def corners(self, axial: Level) -> tuple[float, ...]:
        return ()

    def across(self, axial: Level) -> Level:
        return perpendicular(axial)

    def at(self, z: float | Array) -> Array:
        """Its radius at some z; not of a plane.

        Parameters
        ----------
        z : float or ndarray
            (...,), mm.

        Returns
        -------
        ndarray
            (...,), mm.

        Examples
        --------
        >>> round(float(gm.ConeLevel.of(20.0, 0.1).at(10.0)), 12)
        21.0
        """
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
    """Unit gradient (rho, z) of a station coordinate, which is linear in rho and z with a gradient of length 1."""
    gradient = level.gradient(np.array([1.0, 0.0, 0.0]))
    return float(gradient[0]), float(gradient[2])


def perpendicular(axial: Level) -> ConeLevel:
    """The coordinate at right angles to a station coordinate in the axial half plane, away from the axis of a cylinder."""
    across, up = station_normal(axial)
    return ConeLevel(float(np.arctan2(up, -across)))


@dataclass(frozen=True)
class ConeSurface:
    """The surface g = 0 of a level, its normal along the gradient of g.

    Parameters: u the polar angle (rad), v the length (mm) along the generatrix (rho, z) = offset (sin, cos) + v (-cos, sin)
    of the level's angle: on a cylinder v = z, on a plane that bounds z from below (angle pi) v = rho.
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
        """Its second parameter where it has given station coordinates.

        Parameters
        ----------
        axial : Level
            The station coordinate.
        stations : ndarray
            (...,), mm.

        Returns
        -------
        ndarray
            v (...,), mm.

        Examples
        --------
        >>> axial = gm.ConeLevel(0.0)
        >>> gm.ConeLevel.of(20.0).surface.meeting(axial, np.array([-5.0, 5.0])).tolist()
        [-5.0, 5.0]
        """
        (a, b), (across, up) = self.level.normal, station_normal(axial)
        distance = stations - axial.value(np.zeros(3))
        return (distance - self.level.offset * (across * a + up * b)) / (up * a - across * b)


@dataclass(frozen=True)
class Shifted:
    """sign * (level - offset): the same family of surfaces, another member of it, either side."""

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
    """g = sign (f(a) - w): the surface of revolution through a curve w = f(a) of the axial half plane; +1 bounds w from below.

    a (mm) is the station coordinate `axial` and w (mm) the coordinate `across` at right angles to it; `curve` gives f.
    """

    axial: Level
    across: Level
    curve: Polynomials
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
    """g = radius (theta - f(a)): the surface across a joint, through a curve of angles theta = f(a), rad, f by `curve`.

    a (mm) is the station coordinate `axial`; the `radius` (mm) makes g a length, its sign says which side is inside.
    """

    axial: Level
    curve: Polynomials
    radius: float
    joint: Joint = REVOLUTE

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
