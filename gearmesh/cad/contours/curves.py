"""Curves in the plane of a section: straight lines, arcs and cubic splines, and the closed contours that they make.

Points are (x, y), mm; contours go counterclockwise, whether material is inside or not.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from scipy.interpolate import BSpline

from gearmesh.kernel.numeric.algebra import Array

#: degree of the splines: what DXF readers and SVG take
DEGREE = 3


class PlaneCurve(Protocol):
    """A curve in the plane of a section."""

    @property
    def start(self) -> Array:
        """(2,), mm."""

    @property
    def end(self) -> Array:
        """(2,), mm."""

    @property
    def swept(self) -> float:
        """Area (mm^2) that the line from the origin to the curve's point sweeps, counterclockwise."""

    def at(self, s: Array) -> Array:
        """Points (K, 2), mm, at s (K,) from 0 to 1."""

    def slope(self, s: Array) -> Array:
        """Derivatives (K, 2), mm, of the points by s (K,)."""

    def turn(self, angle: float) -> PlaneCurve:
        """The same about the origin by an angle (rad)."""

    def move(self, way: Array) -> PlaneCurve:
        """The same moved by `way` (2,), mm."""


@dataclass(frozen=True)
class PlaneLine:
    """A straight line between two points (2,), mm."""

    start: Array
    end: Array

    @property
    def swept(self) -> float:
        return 0.5 * float(self.start[0] * self.end[1] - self.start[1] * self.end[0])

    def at(self, s: Array) -> Array:
        return np.asarray(self.start + s[:, None] * (self.end - self.start))

    def slope(self, s: Array) -> Array:
        return np.broadcast_to(self.end - self.start, (len(s), 2))

    def turn(self, angle: float) -> PlaneLine:
        rotation = _rotation(angle)
        return PlaneLine(rotation @ self.start, rotation @ self.end)

    def move(self, way: Array) -> PlaneLine:
        return PlaneLine(self.start + way, self.end + way)


@dataclass(frozen=True)
class PlaneArc:
    """An arc about `centre` (2,), mm, from polar angle `first` by `width` (rad), clockwise where that is negative."""

    centre: Array
    radius: float
    first: float
    width: float

    @staticmethod
    def circle(radius: float, centre: Sequence[float] | Array = (0.0, 0.0)) -> PlaneArc:
        """A full circle."""
        return PlaneArc(np.array(centre, dtype=float), radius, 0.0, 2.0 * np.pi)

    @property
    def closed(self) -> bool:
        """Whether it is a full circle."""
        return abs(self.width) == 2.0 * np.pi

    @property
    def start(self) -> Array:
        return np.asarray(self.at(np.zeros(1))[0])

    @property
    def end(self) -> Array:
        return np.asarray(self.at(np.ones(1))[0])

    @property
    def swept(self) -> float:
        (x, y), last = self.centre, self.first + self.width
        lever = x * (np.sin(last) - np.sin(self.first)) - y * (np.cos(last) - np.cos(self.first))
        return 0.5 * self.radius * float(self.radius * self.width + lever)

    def at(self, s: Array) -> Array:
        angle = self.first + s * self.width
        return np.asarray(self.centre + self.radius * np.stack((np.cos(angle), np.sin(angle)), axis=-1))

    def slope(self, s: Array) -> Array:
        angle = self.first + s * self.width
        return self.radius * self.width * np.stack((-np.sin(angle), np.cos(angle)), axis=-1)

    def turn(self, angle: float) -> PlaneArc:
        return PlaneArc(_rotation(angle) @ self.centre, self.radius, self.first + angle, self.width)

    def move(self, way: Array) -> PlaneArc:
        return PlaneArc(self.centre + way, self.radius, self.first, self.width)


@dataclass(frozen=True)
class PlaneSpline:
    """A clamped cubic B-spline with control points (K, 2), mm, and knots (K + 4,) from 0 to 1."""

    control: Array
    knots: Array

    @property
    def start(self) -> Array:
        return np.asarray(self.control[0])

    @property
    def end(self) -> Array:
        return np.asarray(self.control[-1])

    @property
    def swept(self) -> float:
        # Bernstein polynomials of degree 3: the integrals of b_i b_j' - b_j b_i' over 0..1
        x, y = np.moveaxis(self.beziers, -1, 0)
        i, j = np.triu_indices(DEGREE + 1, 1)
        crossed = x[:, i] * y[:, j] - x[:, j] * y[:, i]
        return 0.5 * float((crossed @ _WRONSKIANS).sum())

    @cached_property
    def beziers(self) -> Array:
        """The same curve as Bezier segments, control points (N, 4, 2), mm, neighbours' ends the same."""
        ends = np.unique(self.knots)
        wide, spline = np.diff(ends)[:, None], BSpline(self.knots, self.control, DEGREE)
        place, slope = spline(ends[:-1]), wide * spline(ends[:-1], 1)
        square, cubic = wide**2 / 2.0 * spline(ends[:-1], 2), wide**3 / 6.0 * spline(ends[:-1], 3)
        control = np.stack(
            (place, place + slope / 3.0, place + (2.0 * slope + square) / 3.0, place + slope + square + cubic), axis=1
        )
        control[1:, 0] = control[:-1, -1]
        control[0, 0], control[-1, -1] = self.start, self.end
        return np.asarray(control)

    def at(self, s: Array) -> Array:
        return np.asarray(BSpline(self.knots, self.control, DEGREE)(s))

    def slope(self, s: Array) -> Array:
        return np.asarray(BSpline(self.knots, self.control, DEGREE)(s, 1))

    def between(self, start: Array, end: Array) -> PlaneSpline:
        """The same with its ends moved a little."""
        return PlaneSpline(np.concatenate(([start], self.control[1:-1], [end])), self.knots)

    def turn(self, angle: float) -> PlaneSpline:
        return PlaneSpline(self.control @ _rotation(angle).T, self.knots)

    def move(self, way: Array) -> PlaneSpline:
        return PlaneSpline(self.control + way, self.knots)


#: by pairs i < j of the Bernstein polynomials, in the order of `np.triu_indices`
_WRONSKIANS = np.array([0.6, 0.3, 0.1, 0.3, 0.3, 0.6])


@dataclass(frozen=True)
class Contour:
    """A closed loop of curves, counterclockwise, each beginning where the one before ends.

    `material`: whether that is inside. `name` is "teeth" or what part of the body it bounds.
    """

    name: str
    curves: tuple[PlaneCurve, ...]
    material: bool

    @property
    def area(self) -> float:
        """Enclosed area, mm^2."""
        return sum(curve.swept for curve in self.curves)

    @property
    def gap(self) -> float:
        """Largest distance (mm) between the end of a curve and the beginning of the next."""
        ends = np.array([curve.end for curve in self.curves])
        starts = np.array([curve.start for curve in self.curves])
        return float(np.linalg.norm(np.roll(starts, -1, axis=0) - ends, axis=-1).max())


def _rotation(angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([(c, -s), (s, c)])
