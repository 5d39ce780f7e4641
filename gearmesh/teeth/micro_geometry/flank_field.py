"""Fields over a flank: functions of its two coordinates in the axial half plane, which make them functions of space.

x runs along the tooth and y across it, from root to tip or back, as the two levels of a `FlankFrame` define them.
Derivatives in space follow from the levels' gradients and Hessians by the chain rule, for planes, cylinders, cones and
racks alike.
"""

from __future__ import annotations

from functools import reduce
from typing import Protocol, TypeAlias

import numpy as np
from numpy.polynomial import Polynomial

from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.numeric.grid_spline import GridSpline, PlaneJet, polynomial
from gearmesh.kernel.numeric.splines import CUBIC_DEGREE, spline_through
from gearmesh.kernel.surface.levels import Level
from gearmesh.kernel.surface.offset import FieldJet
from gearmesh.records import dataclass

#: degree of the curves between which a field fades
FADE_CURVE_DEGREE = 6
#: share of the way between them, at its end, on which the field is 0
LEFT_FREE = 0.05
#: bulge c from which b no longer grows from the first row to the last
MAX_BULGE = 1.0

#: values (...,) of a function and of its first two derivatives
Curve: TypeAlias = tuple[Array, Array, Array]


class PlaneFunction(Protocol):
    """A function of flank coordinates with its first two derivatives."""

    def jet(self, x: Array, y: Array) -> PlaneJet:
        """Return value and partials at x, y (...,), mm."""


@dataclass(frozen=True)
class LevelField:
    """Product of functions of the coordinates of two levels, as a field of space."""

    levels: tuple[Level, Level]
    factors: tuple[PlaneFunction, ...]

    def jet(self, r: Array) -> FieldJet:
        along, across = self.levels
        x, y = along.value(r), across.value(r)
        f = reduce(_product, (factor.jet(x, y) for factor in self.factors))
        to_x, to_y = along.gradient(r), across.gradient(r)

        def hessian(w: Array) -> Array:
            x_w, y_w = dot(to_x, w), dot(to_y, w)
            change: Array = (
                (f.xx * x_w + f.xy * y_w)[..., None] * to_x
                + (f.xy * x_w + f.yy * y_w)[..., None] * to_y
                + f.x[..., None] * along.hessian(r, w)
                + f.y[..., None] * across.hessian(r, w)
            )
            return change

        return FieldJet(f.f, f.x[..., None] * to_x + f.y[..., None] * to_y, hessian)


def _product(f: PlaneJet, g: PlaneJet) -> PlaneJet:
    """Product of two functions, by Leibniz's rule."""
    return PlaneJet(
        f.f * g.f,
        f.x * g.f + f.f * g.x,
        f.y * g.f + f.f * g.y,
        f.xx * g.f + 2.0 * f.x * g.x + f.f * g.xx,
        f.xy * g.f + f.x * g.y + f.y * g.x + f.f * g.xy,
        f.yy * g.f + 2.0 * f.y * g.y + f.f * g.yy,
    )


class SplineCurves:
    """Several functions of x with two derivatives: splines through points, straight beyond the first and the last
    point.
    """

    def __init__(self, x: Array, values: Array) -> None:
        """Interpolate values (X, K) at x (X,), in any order."""
        order = np.argsort(x)
        self.extent = float(x.min()), float(x.max())
        self._spline = spline_through(x[order], values[order], min(CUBIC_DEGREE, len(x) - 1))

    def jets(self, x: Array) -> tuple[tuple[Array, Array, Array], ...]:
        """Return value (...,) and two derivatives of each function at x (...,)."""
        at = np.clip(x, *self.extent)
        value, slope, bend = (self._spline(at, order) for order in range(3))
        value = value + slope * (x - at)[..., None]
        bend = np.where((at == x)[..., None], bend, 0.0)
        return tuple((value[..., k], slope[..., k], bend[..., k]) for k in range(value.shape[-1]))


def share_between(y: Array, begins: Curve, ends: Curve) -> PlaneJet:
    """Share (...,) of the way from one curve of x to another at y, with its partials; a curve is its value and two
    derivatives.
    """
    (e, e_x, e_xx), (b, b_x, b_xx) = begins, ends
    over = 1.0 / (b - e)
    q = (y - e) * over
    q_x = -(e_x + q * (b_x - e_x)) * over
    q_xx = -(e_xx + q * (b_xx - e_xx) + 2.0 * q_x * (b_x - e_x)) * over
    return PlaneJet(q, q_x, over, q_xx, -(b_x - e_x) * over**2, np.zeros_like(q))


@dataclass(frozen=True)
class Band:
    """Coordinates a, b in the plane of a grid's points (x, y) (I, J, 2).

    a grows with x from the first column to the last, and

        b = u + c u (1 - u)

    u runs from 0 on the first row to 1 on the last. Both rows are curves of x; c (x) makes b constant on the row in the
    middle.
    """

    ends: tuple[float, float]
    curves: SplineCurves

    @staticmethod
    def of(points: Array) -> Band:
        """Return the band of points (I, J, 2) whose columns have nearly constant x. Raises ValueError where they
        cross.
        """
        x, y = points[..., 0], points[..., 1]
        columns = x.mean(axis=0)
        if not (np.diff(columns) * np.sign(columns[-1] - columns[0]) > 0.0).all():
            raise ValueError("columns cross each other")
        first, last, middle = (_at_columns(x[k], y[k], columns) for k in (0, len(y) - 1, len(y) // 2))
        share = (middle - first) / (last - first)
        wanted = share.mean()
        bulge = (wanted - share) / (share * (1.0 - share)) if len(y) > 2 else np.zeros_like(share)
        if not (np.isfinite(bulge).all() and np.abs(bulge).max() < MAX_BULGE):
            raise ValueError("rows are not between the first and the last")
        return Band(
            (float(columns[0]), float(columns[-1])), SplineCurves(columns, np.stack((first, last, bulge), axis=-1))
        )

    def jets(self, x: Array, y: Array) -> tuple[PlaneJet, PlaneJet]:
        """Return both coordinates with their partials at x, y (...,)."""
        x, y = np.broadcast_arrays(x, y)
        first, last, (c, c_x, c_xx) = self.curves.jets(x)
        u, none = share_between(y, first, last), np.zeros_like(c)
        over = 1.0 / (self.ends[1] - self.ends[0])
        bow, turn = u.f * (1.0 - u.f), 1.0 - 2.0 * u.f
        by_u, twice = 1.0 + c * turn, -2.0 * c
        return (
            PlaneJet((x - self.ends[0]) * over, none + over, none, none, none, none),
            PlaneJet(
                u.f + c * bow,
                c_x * bow + by_u * u.x,
                by_u * u.y,
                c_xx * bow + 2.0 * c_x * turn * u.x + twice * u.x**2 + by_u * u.xx,
                c_x * turn * u.y + twice * u.x * u.y + by_u * u.xy,
                twice * u.y**2,
            ),
        )


def _at_columns(x: Array, y: Array, columns: Array) -> Array:
    """Interpolate y (J,) of a row of points x, y (J,) at the columns."""
    values = SplineCurves(x, y[:, None]).jets(columns)[0][0]
    return values


@dataclass(frozen=True)
class BandSpline:
    """A spline over the coordinates of a band."""

    band: Band
    spline: GridSpline

    def jet(self, x: Array, y: Array) -> PlaneJet:
        a, b = self.band.jets(x, y)
        f = self.spline.jet(a.f, b.f)
        return PlaneJet(
            f.f,
            f.x * a.x + f.y * b.x,
            f.x * a.y + f.y * b.y,
            f.x * a.xx + f.y * b.xx + f.xx * a.x**2 + 2.0 * f.xy * a.x * b.x + f.yy * b.x**2,
            f.x * a.xy + f.y * b.xy + f.xx * a.x * a.y + f.xy * (a.x * b.y + a.y * b.x) + f.yy * b.x * b.y,
            f.x * a.yy + f.y * b.yy + f.xx * a.y**2 + 2.0 * f.xy * a.y * b.y + f.yy * b.y**2,
        )


@dataclass(frozen=True)
class Fade:
    """A function that is 1 up to one curve, 0 beyond another, and smooth to the second derivative.

    Between the curves it is 10 q^3 - 15 q^4 + 6 q^5, q = 0 on the second curve and 1 on the first. `begins`, `ends`:
    coefficients of y by powers of x less its least. `extent`: range of x, beyond which the curves continue straight.
    """

    begins: Array
    ends: Array
    extent: tuple[float, float]

    @staticmethod
    def between(x: Array, begins: Array, ends: Array) -> Fade:
        """Return the function between curves through y = `begins` and `ends` (K,) at x (K,), mm; it is 0 a little
        before the latter.
        """
        extent = float(x.min()), float(x.max())
        first, last = (
            np.asarray(Polynomial.fit(x - extent[0], y, FADE_CURVE_DEGREE).convert().coef, dtype=float)
            for y in (begins, ends)
        )
        missed = (polynomial(last, x - extent[0])[0] - ends) / (begins - ends)
        # the curve lies on the near side of all points that it stands for
        short = LEFT_FREE + float(np.abs(missed).max())
        return Fade(first, last + short * (first - last), extent)

    def jet(self, x: Array, y: Array) -> PlaneJet:
        q = share_between(y, *(self._curve(curve, x) for curve in (self.ends, self.begins)))
        share = np.clip(q.f, 0.0, 1.0)
        f_q, f_qq = 30.0 * (share * (1.0 - share)) ** 2, 60.0 * share * (1.0 - share) * (1.0 - 2.0 * share)
        return PlaneJet(
            share**3 * (10.0 - 15.0 * share + 6.0 * share**2),
            f_q * q.x,
            f_q * q.y,
            f_q * q.xx + f_qq * q.x**2,
            f_q * q.xy + f_qq * q.x * q.y,
            f_qq * q.y**2,
        )

    def _curve(self, curve: Array, x: Array) -> tuple[Array, Array, Array]:
        """Return a curve and its two derivatives at x."""
        at = np.clip(x, *self.extent)
        y, slope, bend = polynomial(curve, at - self.extent[0])
        return y + slope * (x - at), slope, np.where(at == x, bend, 0.0)
