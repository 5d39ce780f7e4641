"""Surfaces of revolution by their meridian: throated, crowned, chamfered lands, and the roots that a plunging tool leaves.

The meridian is a curve w = f(a) of the axial half plane over a station coordinate a, z or the radius or a cone distance; w is the
coordinate at right angles to it, growing out of the body:

      w ^       ___ corner                a: along the face, from toe to heel
        |  ____/   \\____ arc              f: a series, a line, an arc of a throat, or several of them between corners
        +-----------------> a

The level g = w - f(a) is positive outside; its zero is a surface with the parameters u = polar angle (rad) and v = a (mm).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Protocol

import numpy as np
from numpy.polynomial import Chebyshev

from gearmesh.kernel.numeric.algebra import Array, broadcast_pair, components
from gearmesh.kernel.surface.levels import ConeLevel, Level, PlaneLevel, perpendicular, station_normal
from gearmesh.kernel.surface.surface import Jet

#: degrees of a fitted series that are tried, and the largest distance (mm) that it may be off
DEGREES, EXACT = (10, 20, 40), 1e-10
#: Newton steps to a place of a parallel curve
STEPS = 12
#: of Newton steps outwards from the middle of a cylinder's meridian: 7 where its tangent is 2, 20 where it is 1000; and the part
#: of a tangent that counts as none
STEPS_OUT, ROUNDING = 60, 1e-15

#: the station coordinate z
AXIAL = PlaneLevel(0.0)
#: f, df/da and d2f/da2 (...,)
Values = tuple[Array, Array, Array]


class MeridianCurve(Protocol):
    """w = f(a), both mm."""

    @property
    def corners(self) -> tuple[float, ...]:
        """a of its corners, ascending."""

    def at(self, a: Array) -> Values:
        """f and its first two derivatives at a (...,), NaN where there is none; at a corner those of what follows."""


@dataclass(frozen=True)
class Straight:
    """w = at0 + slope a: of a cylinder, cone or plane."""

    at0: float
    slope: float = 0.0
    corners: tuple[float, ...] = ()

    def at(self, a: Array) -> Values:
        return self.at0 + self.slope * a, np.full_like(a, self.slope), np.zeros_like(a)


@dataclass(frozen=True)
class CircularMeridian:
    """An arc about the `centre` (a, w), mm: below it, the throat of a wheel on whose mating gear's axis it lies, or (`above`)
    over it."""

    centre: tuple[float, float]
    radius: float
    above: bool = False
    corners: tuple[float, ...] = ()

    def at(self, a: Array) -> Values:
        away, sign = a - self.centre[0], 1.0 if self.above else -1.0
        # beside the arc there is none, at its ends it is upright
        with np.errstate(invalid="ignore", divide="ignore"):
            height = np.sqrt(self.radius**2 - away**2)
            return self.centre[1] + sign * height, -sign * away / height, -sign * self.radius**2 / height**3


@dataclass(frozen=True)
class CylinderMeridian:
    """What a cylinder leaves that turns about the axis, which it crosses at `distance` mm, a = z: `radius` in mm, `tilt` (rad) of
    its own axis out of the plane across.

    A point at the angle psi about the cylinder's axis, from the common perpendicular, has the normal (cos(psi), sin(psi) sin(tilt),
    -sin(psi) cos(tilt)) out of the body. It is at right angles to the motion where y = x tan(psi) sin(tilt), which gives, with
    x = distance - radius cos(psi),

        z = radius sin(psi) cos(tilt) + distance tan(psi) sin(tilt)^2 / cos(tilt),   rho = x sqrt(1 + tan(psi)^2 sin(tilt)^2)
    """

    distance: float
    radius: float
    tilt: float
    corners: tuple[float, ...] = ()

    def at(self, a: Array) -> Values:
        s, c = np.sin(self.tilt), np.cos(self.tilt)
        own, along = self.radius * c, self.distance * s**2 / c
        # z grows with u = tan(psi), ever more slowly: from the middle Newton's steps never go too far
        u, away = np.zeros_like(a), np.abs(a)
        for _ in range(STEPS_OUT):
            root = np.sqrt(1.0 + u**2)
            step = (own * u / root + along * u - away) / (own / root**3 + along)
            u = u - step
            if not (np.abs(step) > ROUNDING * (1.0 + u)).any():
                break
        u = np.copysign(u, a)
        root = np.sqrt(1.0 + u**2)
        narrower = np.sqrt(1.0 + (u * s) ** 2)
        slope = u * c / narrower
        bend = c * root / narrower**3 / (own / root + along * root**2)
        return (self.distance - self.radius / root) * narrower, slope, bend


@dataclass(frozen=True)
class Series:
    """f = sum of coefficients[k] T_k, mm, a from -1 to 1 over `extent`."""

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
    """Smooth curves one after the other, each up to a corner."""

    curves: tuple[MeridianCurve, ...]
    corners: tuple[float, ...]

    @staticmethod
    def polyline(points: tuple[tuple[float, float], ...]) -> Joined:
        """Straight from one point (a, w) to the next, a ascending; the first and the last line go on."""
        lines = []
        for (a, w), (b, x) in pairwise(points):
            slope = (x - w) / (b - a)
            lines.append(Straight(w - slope * a, slope))
        return Joined(tuple(lines), tuple(a for a, _ in points[1:-1]))

    def at(self, a: Array) -> Values:
        number = np.searchsorted(self.corners, a, side="right")
        if number.size and (number == number.flat[0]).all():
            # as mostly, all between the same corners
            return self.curves[int(number.flat[0])].at(a)
        pieces = [curve.at(a) for curve in self.curves]
        value, slope, bend = (np.choose(number, of_pieces) for of_pieces in zip(*pieces, strict=True))
        return value, slope, bend


@dataclass(frozen=True)
class ParallelMeridian:
    """The curve `distance` mm from a smooth one all along, positive out of the body.

    With f' the slope of that at b: a = b - d f' / sqrt(1 + f'^2), w = f + d / sqrt(1 + f'^2), and the slope is the same.
    """

    curve: MeridianCurve
    distance: float
    corners: tuple[float, ...] = ()

    @staticmethod
    def of(curve: MeridianCurve, distance: float) -> MeridianCurve:
        """Of a curve with or without corners: those of the parallel are where its pieces meet."""
        if not isinstance(curve, Joined):
            return ParallelMeridian(curve, distance)
        pieces = [ParallelMeridian(piece, distance) for piece in curve.curves]
        corners = []
        for corner, (one, other) in zip(curve.corners, pairwise(pieces), strict=True):
            a = np.array(corner)
            for _ in range(STEPS):
                (w, slope, _), (x, other_slope, _) = one.at(a), other.at(a)
                a = a - (w - x) / (slope - other_slope)
            corners.append(float(a))
        return Joined(tuple(pieces), tuple(corners))

    def at(self, a: Array) -> Values:
        b = np.array(a, dtype=float)
        for _ in range(STEPS):
            height, slope, bend = self.curve.at(b)
            shorter = 1.0 / np.sqrt(1.0 + slope**2)
            rate = 1.0 - self.distance * bend * shorter**3
            step = (b - self.distance * slope * shorter - a) / rate
            b = b - step
            if not (np.abs(step) > EXACT).any():
                break
        height, slope, bend = self.curve.at(b)
        shorter = 1.0 / np.sqrt(1.0 + slope**2)
        return height + self.distance * shorter, slope, bend / (1.0 - self.distance * bend * shorter**3)


@dataclass(frozen=True)
class Meridian:
    """The surface of revolution through a meridian; a level and a surface. `axial` is its coordinate a, linear in rho and z."""

    curve: MeridianCurve
    axial: Level = AXIAL

    @staticmethod
    def through(profile: Callable[[Array], Array], extent: tuple[float, float]) -> Meridian:
        """The one whose meridian is rho(z), a smooth function given on `extent`, mm.

        Raises ValueError where no series of the `DEGREES` is within `EXACT` of it.
        """
        for degree in DEGREES:
            fit = Chebyshev.interpolate(profile, degree, domain=extent)
            between = np.linspace(*extent, 3 * degree)
            if np.abs(fit(between) - profile(between)).max() <= EXACT:
                return Meridian(Series(tuple(float(c) for c in fit.coef), extent))
        raise ValueError("the profile is not smooth enough for a series")

    @property
    def surface(self) -> Meridian:
        """Itself."""
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
        """rho, mm, at z; where stations are planes."""
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
        more = bend * (along * w).sum(axis=-1)
        hessian: Array = self._w.hessian(r, w) - slope[..., None] * self.axial.hessian(r, w) - more[..., None] * along
        return hessian

    def jet(self, u: Array, v: Array) -> Jet:
        u, v = broadcast_pair(u, v)
        height, slope, bend = (column[..., None] for column in self.curve.at(v))
        a, w, origin = self._frame
        point = (v - origin)[..., None] * a + height * w
        along = a + slope * w
        shorter = 1.0 / np.sqrt(1.0 + slope**2)
        n = (w - slope * a) * shorter
        # the meridian's normal turns against its tangent by the curvature
        turned = -bend * shorter**3 * along
        c, s = np.cos(u), np.sin(u)

        def lift(plane: Array) -> Array:
            return components(plane[..., 0] * c, plane[..., 0] * s, plane[..., 1])

        def around(plane: Array) -> Array:
            return components(-plane[..., 0] * s, plane[..., 0] * c, 0.0)

        return Jet(lift(point), lift(n), around(point), lift(along), around(n), lift(turned))

    def meeting(self, axial: Level, stations: Array) -> Array:
        """v (...,) near the station coordinates `stations` (...,), mm: a start value, exact for stations along its own."""
        a, _, origin = self._frame
        way = float(a @ np.array(station_normal(axial)))
        return np.asarray(origin + way * (stations - axial.value(np.zeros(3))))
