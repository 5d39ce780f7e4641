r"""Surfaces of revolution by their meridian: throated, crowned and chamfered lands, and roots left by a plunging tool.

The meridian is a curve w = f(a) of the axial half plane. a is a station coordinate: z, the radius or a cone distance. w
is the coordinate at right angles to a and grows out of the body:

      w ^       ___ corner                a: along the face, from toe to heel
        |  ____/   \____ arc              f: a series, a line, an arc of a throat, or several of them between corners
        +-----------------> a

The level g = w - f(a) is positive outside; its zero is a surface with the parameters u = polar angle (rad) and v = a
(mm).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from itertools import pairwise
from typing import Protocol

import numpy as np
from numpy.polynomial import Chebyshev

from gearmesh.kernel.numeric.algebra import Array, broadcast_pair, components
from gearmesh.kernel.surface.levels import ConeLevel, Level, PlaneLevel, perpendicular, station_normal
from gearmesh.kernel.surface.surface import Jet
from gearmesh.records import dataclass

#: degrees of a fitted series, tried in this order
SERIES_DEGREES = (10, 20, 40)
#: largest distance of a fitted series from the curve
MAX_FIT_ERROR_MM = 1e-10
#: Newton steps to a point of a parallel curve
MAX_PARALLEL_STEPS = 12
#: Newton steps outwards from the middle of a cylinder's meridian: 7 at a tangent of 2, 20 at 1000
MAX_CYLINDER_STEPS = 60
#: Newton step of this tangent that counts as 0, relative to 1 plus the tangent
RELATIVE_ROUNDING = 1e-15

#: the station coordinate z
AXIAL_STATION = PlaneLevel(0.0)
#: halvings of a range of angles
MAX_HALVINGS = 60
#: f, df/da and d2f/da2, (...,) each
Values = tuple[Array, Array, Array]


class MeridianCurve(Protocol):
    """A curve w = f(a), both in mm."""

    @property
    def corners(self) -> tuple[float, ...]:
        """Values of a at the corners, ascending."""

    def at(self, a: Array) -> Values:
        """Return f and its first two derivatives at a (...,), NaN where undefined.

        At a corner the derivatives are those of the following piece.
        """


@dataclass(frozen=True)
class Straight:
    """w = at0 + slope a: the meridian of a cylinder, cone or plane."""

    at0: float
    slope: float = 0.0
    corners: tuple[float, ...] = ()

    def at(self, a: Array) -> Values:
        return self.at0 + self.slope * a, np.full_like(a, self.slope), np.zeros_like(a)


@dataclass(frozen=True)
class CircularMeridian:
    """An arc: below its centre, such as the throat of a wheel around its mating gear's axis, or above its centre."""

    #: centre (a, w), mm
    centre: tuple[float, float]
    #: radius of the arc, mm
    radius: float
    #: True for the arc above the centre
    above: bool = False
    #: no corners
    corners: tuple[float, ...] = ()

    def at(self, a: Array) -> Values:
        away, sign = a - self.centre[0], 1.0 if self.above else -1.0
        # NaN beyond the ends of the arc; vertical at its ends
        with np.errstate(invalid="ignore", divide="ignore"):
            height = np.sqrt(self.radius**2 - away**2)
            return self.centre[1] + sign * height, -sign * away / height, -sign * self.radius**2 / height**3


@dataclass(frozen=True)
class CylinderMeridian:
    """Meridian of the surface that a cylinder leaves on a body turning about z; a = z.

    A point at the angle psi about the cylinder's axis, from the common perpendicular, has the normal (cos(psi),
    sin(psi) sin(tilt), -sin(psi) cos(tilt)) out of the body. This normal is at right angles to the motion where y = x
    tan(psi) sin(tilt). With x = distance - radius cos(psi) it follows

        z = radius sin(psi) cos(tilt) + distance tan(psi) sin(tilt)^2 / cos(tilt)
        rho = x sqrt(1 + tan(psi)^2 sin(tilt)^2)
    """

    #: distance of the cylinder's axis from the z axis, mm
    distance: float
    #: radius of the cylinder, mm
    radius: float
    #: angle (rad) of the cylinder's axis out of the plane across z
    tilt: float
    #: no corners
    corners: tuple[float, ...] = ()

    def at(self, a: Array) -> Values:
        s, c = np.sin(self.tilt), np.cos(self.tilt)
        radius_part, distance_part = self.radius * c, self.distance * s**2 / c
        # solve z(u) = |a| for u = tan(psi): z is increasing and concave, so Newton's steps from u = 0 never overshoot
        u, away = np.zeros_like(a), np.abs(a)
        for _ in range(MAX_CYLINDER_STEPS):
            root = np.sqrt(1.0 + u**2)
            step = (radius_part * u / root + distance_part * u - away) / (radius_part / root**3 + distance_part)
            u = u - step
            if not (np.abs(step) > RELATIVE_ROUNDING * (1.0 + u)).any():
                break
        u = np.copysign(u, a)
        root = np.sqrt(1.0 + u**2)
        narrower = np.sqrt(1.0 + (u * s) ** 2)
        slope = u * c / narrower
        bend = c * root / narrower**3 / (radius_part / root + distance_part * root**2)
        return (self.distance - self.radius / root) * narrower, slope, bend

    def reaching(self, rho: float) -> float:
        """Return z >= 0 (mm) at a radius rho between distance - radius and distance, mm, by bisection."""
        low, high = 0.0, 0.5 * np.pi
        for _ in range(MAX_HALVINGS):
            psi = 0.5 * (low + high)
            x = self.distance - self.radius * np.cos(psi)
            below = x * np.hypot(1.0, np.tan(psi) * np.sin(self.tilt)) < rho
            low, high = (psi, high) if below else (low, psi)
        s, c = np.sin(self.tilt), np.cos(self.tilt)
        return float(self.radius * np.sin(high) * c + self.distance * np.tan(high) * s**2 / c)


@dataclass(frozen=True)
class Series:
    """f = sum of coefficients[k] T_k, mm, with a scaled to -1 ... 1 over `extent`."""

    coefficients: tuple[float, ...]
    extent: tuple[float, float]
    corners: tuple[float, ...] = ()

    @cached_property
    def _derivatives(self) -> tuple[Chebyshev, Chebyshev, Chebyshev]:
        series = Chebyshev(self.coefficients, domain=self.extent)
        return series, series.deriv(1), series.deriv(2)

    def at(self, a: Array) -> Values:
        value, slope, bend = (np.asarray(series(a)) for series in self._derivatives)
        return value, slope, bend


@dataclass(frozen=True)
class Joined:
    """Smooth curves one after the other; each ends at a corner."""

    curves: tuple[MeridianCurve, ...]
    corners: tuple[float, ...]

    @staticmethod
    def polyline(points: tuple[tuple[float, float], ...]) -> Joined:
        """Return the polyline through points (a, w), a ascending; its first and last lines continue beyond the ends."""
        lines = []
        for (a, w), (b, x) in pairwise(points):
            slope = (x - w) / (b - a)
            lines.append(Straight(w - slope * a, slope))
        return Joined(tuple(lines), tuple(a for a, _ in points[1:-1]))

    def at(self, a: Array) -> Values:
        number = np.searchsorted(self.corners, a, side="right")
        if number.size and (number == number.flat[0]).all():
            # the usual case: all points lie between the same two corners
            return self.curves[int(number.flat[0])].at(a)
        pieces = [curve.at(a) for curve in self.curves]
        value, slope, bend = (np.choose(number, of_pieces) for of_pieces in zip(*pieces, strict=True))
        return value, slope, bend


@dataclass(frozen=True)
class ParallelMeridian:
    """The curve at `distance` mm from a smooth curve, positive out of the body.

    Let f' be the slope of the smooth curve at b. Then a = b - d f' / sqrt(1 + f'^2) and w = f + d / sqrt(1 + f'^2),
    with the same slope.
    """

    curve: MeridianCurve
    distance: float
    corners: tuple[float, ...] = ()

    @staticmethod
    def of(curve: MeridianCurve, distance: float) -> MeridianCurve:
        """Return the parallel of a curve with or without corners; its corners are the intersections of its pieces."""
        if not isinstance(curve, Joined):
            return ParallelMeridian(curve, distance)
        pieces = [ParallelMeridian(piece, distance) for piece in curve.curves]
        corners = []
        for corner, (before, after) in zip(curve.corners, pairwise(pieces), strict=True):
            a = np.array(corner)
            for _ in range(MAX_PARALLEL_STEPS):
                (w, slope, _), (x, other_slope, _) = before.at(a), after.at(a)
                a = a - (w - x) / (slope - other_slope)
            corners.append(float(a))
        return Joined(tuple(pieces), tuple(corners))

    def at(self, a: Array) -> Values:
        # solve a(b) = a for the place b on the smooth curve
        b = np.array(a, dtype=float)
        for _ in range(MAX_PARALLEL_STEPS):
            height, slope, bend = self.curve.at(b)
            shorter = 1.0 / np.sqrt(1.0 + slope**2)
            rate = 1.0 - self.distance * bend * shorter**3
            step = (b - self.distance * slope * shorter - a) / rate
            b = b - step
            if not (np.abs(step) > MAX_FIT_ERROR_MM).any():
                break
        height, slope, bend = self.curve.at(b)
        shorter = 1.0 / np.sqrt(1.0 + slope**2)
        return height + self.distance * shorter, slope, bend / (1.0 - self.distance * bend * shorter**3)


@dataclass(frozen=True)
class Meridian:
    """Surface of revolution through a meridian, both a level and a surface; `axial` is its coordinate a."""

    curve: MeridianCurve
    axial: Level = AXIAL_STATION

    @staticmethod
    def through(profile: Callable[[Array], Array], extent: tuple[float, float]) -> Meridian:
        """Return the surface with the meridian rho(z), a smooth function given on `extent`, mm.

        Raises ValueError if no series of the `SERIES_DEGREES` is within `MAX_FIT_ERROR_MM` of it.
        """
        for degree in SERIES_DEGREES:
            fit = Chebyshev.interpolate(profile, degree, domain=extent)
            between = np.linspace(*extent, 3 * degree)
            if np.abs(fit(between) - profile(between)).max() <= MAX_FIT_ERROR_MM:
                return Meridian(Series(tuple(float(c) for c in fit.coef), extent))
        raise ValueError("the profile is not smooth enough for a series")

    @property
    def surface(self) -> Meridian:
        """The surface g = 0, which is this object."""
        return self

    @property
    def cone(self) -> None:
        return None

    def corners(self, axial: Level) -> tuple[float, ...]:
        circles = self.jet(np.zeros(len(self.curve.corners)), np.array(self.curve.corners)).r
        return tuple(sorted(axial.value(circles).tolist()))

    @cached_property
    def _w(self) -> ConeLevel:
        """The coordinate w."""
        return perpendicular(self.axial)

    @cached_property
    def _frame(self) -> tuple[Array, Array, float]:
        """Directions (2,) of a and w over (rho, z), and a at their origin."""
        return np.array(station_normal(self.axial)), np.array(self._w.normal), float(self.axial.value(np.zeros(3)))

    def across(self, axial: Level) -> Level:
        return perpendicular(axial)

    def parallel(self, distance: float) -> Meridian:
        return Meridian(ParallelMeridian.of(self.curve, distance), self.axial)

    def at(self, z: float | Array) -> Array:
        """Return rho, mm, at z, for stations that are planes."""
        z = np.asarray(z, dtype=float)
        a = self.axial.value(components(np.ones_like(z), 0.0, z))
        rho: Array = self.curve.at(a)[0] * self._w.normal[0]
        return rho

    def value(self, r: Array) -> Array:
        distance: Array = self._w.value(r) - self.curve.at(self.axial.value(r))[0]
        return distance

    def gradient(self, r: Array) -> Array:
        slope = self.curve.at(self.axial.value(r))[1]
        gradient: Array = self._w.gradient(r) - slope[..., None] * self.axial.gradient(r)
        return gradient

    def hessian(self, r: Array, w: Array) -> Array:
        _, slope, bend = self.curve.at(self.axial.value(r))
        along = self.axial.gradient(r)
        bending = bend * (along * w).sum(axis=-1)
        hessian: Array = (
            self._w.hessian(r, w) - slope[..., None] * self.axial.hessian(r, w) - bending[..., None] * along
        )
        return hessian

    def jet(self, u: Array, v: Array) -> Jet:
        u, v = broadcast_pair(u, v)
        height, slope, bend = (column[..., None] for column in self.curve.at(v))
        a, w, origin = self._frame
        point = (v - origin)[..., None] * a + height * w
        along = a + slope * w
        shorter = 1.0 / np.sqrt(1.0 + slope**2)
        n = (w - slope * a) * shorter
        # the normal changes along the tangent by minus the curvature
        turned = -bend * shorter**3 * along
        c, s = np.cos(u), np.sin(u)

        def lift(plane: Array) -> Array:
            return components(plane[..., 0] * c, plane[..., 0] * s, plane[..., 1])

        def around(plane: Array) -> Array:
            return components(-plane[..., 0] * s, plane[..., 0] * c, 0.0)

        return Jet(lift(point), lift(n), around(point), lift(along), around(n), lift(turned))

    def meeting(self, axial: Level, stations: Array) -> Array:
        """Return v (...,) near the station coordinates `stations` (...,), mm.

        This is a start value; it is exact for stations along the surface's own coordinate a.
        """
        a, _, origin = self._frame
        way = float(a @ np.array(station_normal(axial)))
        return np.asarray(origin + way * (stations - axial.value(np.zeros(3))))
