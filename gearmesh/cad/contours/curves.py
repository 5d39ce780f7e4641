"""Curves in the plane of a section: cubic splines, beside lines and arcs, and closed contours of such curves.

Points are (x, y), mm; contours go counterclockwise, with material inside or outside.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from gearmesh.kernel.numeric.algebra import Array, distinct
from gearmesh.kernel.plane.curves import PlaneCurve, rotation
from gearmesh.records import dataclass

#: degree of the splines, which DXF readers and SVG support
CUBIC_DEGREE = 3


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
        i, j = np.triu_indices(CUBIC_DEGREE + 1, 1)
        crossed = x[:, i] * y[:, j] - x[:, j] * y[:, i]
        return 0.5 * float((crossed @ _BERNSTEIN_WRONSKIANS).sum())

    @cached_property
    def beziers(self) -> Array:
        """The curve as Bezier segments: control points (N, 4, 2), mm, with equal ends of neighbouring segments."""
        from scipy.interpolate import BSpline

        ends = distinct(self.knots)
        wide, spline = np.diff(ends)[:, None], BSpline(self.knots, self.control, CUBIC_DEGREE)
        place, slope = spline(ends[:-1]), wide * spline(ends[:-1], 1)
        square, cubic = wide**2 / 2.0 * spline(ends[:-1], 2), wide**3 / 6.0 * spline(ends[:-1], 3)
        control = np.stack(
            (place, place + slope / 3.0, place + (2.0 * slope + square) / 3.0, place + slope + square + cubic), axis=1
        )
        control[1:, 0] = control[:-1, -1]
        control[0, 0], control[-1, -1] = self.start, self.end
        return np.asarray(control)

    def at(self, s: Array) -> Array:
        from scipy.interpolate import BSpline

        return np.asarray(BSpline(self.knots, self.control, CUBIC_DEGREE)(s))

    def slope(self, s: Array) -> Array:
        from scipy.interpolate import BSpline

        return np.asarray(BSpline(self.knots, self.control, CUBIC_DEGREE)(s, 1))

    def between(self, start: Array, end: Array) -> PlaneSpline:
        """Return the spline with its ends moved a little."""
        return PlaneSpline(np.concatenate(([start], self.control[1:-1], [end])), self.knots)

    def turn(self, angle: float) -> PlaneSpline:
        return PlaneSpline(self.control @ rotation(angle).T, self.knots)

    def move(self, way: Array) -> PlaneSpline:
        return PlaneSpline(self.control + way, self.knots)


#: integrals of b_i b_j' - b_j b_i' of Bernstein polynomials for i < j, in the order of `np.triu_indices`
_BERNSTEIN_WRONSKIANS = np.array([0.6, 0.3, 0.1, 0.3, 0.3, 0.6])


@dataclass(frozen=True)
class Contour:
    """A closed counterclockwise loop of curves, each of which begins at the end of the curve before.

    `material` is True if the material is inside. `name` is "teeth" or the bounded part of the body.
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
