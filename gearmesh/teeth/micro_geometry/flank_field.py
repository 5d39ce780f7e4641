"""Fields over a flank: functions of its two coordinates in the axial half plane, which make them functions of space.

x runs along the tooth and y across it, from root to tip or back, as the two levels of a `FlankFrame` have them. With the levels'
gradients and Hessians the derivatives in space follow by the chain rule, for planes, cylinders, cones and racks alike.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, reduce
from typing import Protocol

import numpy as np
from numpy.polynomial import Polynomial

from gearmesh.kernel.numeric.algebra import Array, components, dot, plane_cross
from gearmesh.kernel.numeric.grid_spline import GridSpline, PlaneJet, polynomial
from gearmesh.kernel.surface.levels import Level
from gearmesh.kernel.surface.offset import FieldJet

#: degree of the curves between which a field fades
DEGREE = 6
#: share of the way between them at whose end nothing is left
LEFT_FREE = 0.05


class PlaneFunction(Protocol):
    """A function of flank coordinates with its first two derivatives."""

    def jet(self, x: Array, y: Array) -> PlaneJet:
        """Value and partials at x, y (...,), mm."""


@dataclass(frozen=True)
class LevelField:
    """The product of functions of the coordinates that two levels are, as a field of space."""

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
    """Of two functions, by Leibniz's rule."""
    return PlaneJet(
        f.f * g.f,
        f.x * g.f + f.f * g.x,
        f.y * g.f + f.f * g.y,
        f.xx * g.f + 2.0 * f.x * g.x + f.f * g.xx,
        f.xy * g.f + f.x * g.y + f.y * g.x + f.f * g.xy,
        f.yy * g.f + 2.0 * f.y * g.y + f.f * g.yy,
    )


@dataclass(frozen=True)
class Quadrangle:
    """Coordinates a, b in the plane, 0 and 1 on opposite sides of a quadrangle and even between them.

    Its `corners` (4, 2), mm, are where (a, b) = (0, 0), (1, 0), (1, 1) and (0, 1), and with r = (x, y)

        r = c_0 + c_1 a + c_2 b + c_3 a b

    which is of second degree in a: of its roots that which is finite where opposite sides are parallel. NaN far off, where
    there is none.
    """

    corners: Array

    @cached_property
    def _bilinear(self) -> Array:
        """c_0 to c_3, (4, 2)."""
        first, second, third, fourth = self.corners
        return np.stack((first, second - first, fourth - first, first - second + third - fourth))

    def jets(self, x: Array, y: Array) -> tuple[PlaneJet, PlaneJet]:
        """Both coordinates with their partials at x, y (...,)."""
        c0, c1, c2, c3 = self._bilinear
        r = components(x, y) - c0
        square, linear, rest = -plane_cross(c1, c3), plane_cross(r, c3) - plane_cross(c1, c2), plane_cross(r, c2)
        with np.errstate(invalid="ignore"):
            root = np.copysign(np.sqrt(linear**2 - 4.0 * square * rest), -plane_cross(c1, c2))
        a = -2.0 * rest / (linear + root)
        way = c2 + a[..., None] * c3
        b = ((r - a[..., None] * c1) * way).sum(axis=-1) / (way**2).sum(axis=-1)
        by_a, area = c1 + b[..., None] * c3, plane_cross(c1 + b[..., None] * c3, way)
        # the inverse of the Jacobian (by_a, way), and its change
        a_x, a_y, b_x, b_y = (partial / area for partial in (way[..., 1], -way[..., 0], -by_a[..., 1], by_a[..., 0]))
        bent_a, bent_b = (-(way_rate[0] * c3[0] + way_rate[1] * c3[1]) for way_rate in ((a_x, a_y), (b_x, b_y)))
        twice = 2.0 * a_x * b_x, a_x * b_y + a_y * b_x, 2.0 * a_y * b_y
        return (
            PlaneJet(a, a_x, a_y, *(bent_a * second for second in twice)),
            PlaneJet(b, b_x, b_y, *(bent_b * second for second in twice)),
        )


@dataclass(frozen=True)
class QuadrangleSpline:
    """A spline over the coordinates that a quadrangle gives the plane."""

    quadrangle: Quadrangle
    spline: GridSpline

    def jet(self, x: Array, y: Array) -> PlaneJet:
        a, b = self.quadrangle.jets(x, y)
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
    """1 up to one curve, 0 from another on, and smooth to the second derivative; y of both by powers of x less its least.

    With q from 0 to 1 on the way back between them it is 10 q^3 - 15 q^4 + 6 q^5. Beyond the `extent` in x the curves go on
    straight.
    """

    begins: Array
    ends: Array
    extent: tuple[float, float]

    @staticmethod
    def between(x: Array, begins: Array, ends: Array) -> Fade:
        """Between curves through y = `begins` and `ends` (K,) at x (K,), mm; nothing is left a little before the latter."""
        extent = float(x.min()), float(x.max())
        first, last = (
            np.asarray(Polynomial.fit(x - extent[0], y, DEGREE).convert().coef, dtype=float) for y in (begins, ends)
        )
        missed = (polynomial(last, x - extent[0])[0] - ends) / (begins - ends)
        # the curve lies on the near side of all points that it stands for
        short = LEFT_FREE + float(np.abs(missed).max())
        return Fade(first, last + short * (first - last), extent)

    def jet(self, x: Array, y: Array) -> PlaneJet:
        (b, b_x, b_xx), (e, e_x, e_xx) = (self._curve(curve, x) for curve in (self.begins, self.ends))
        over = 1.0 / (b - e)
        q = (y - e) * over
        q_x = -(e_x + q * (b_x - e_x)) * over
        q_xx = -(e_xx + q * (b_xx - e_xx) + 2.0 * q_x * (b_x - e_x)) * over
        q_xy = -(b_x - e_x) * over**2
        on = np.clip(q, 0.0, 1.0)
        f_q, f_qq = 30.0 * (on * (1.0 - on)) ** 2, 60.0 * on * (1.0 - on) * (1.0 - 2.0 * on)
        return PlaneJet(
            on**3 * (10.0 - 15.0 * on + 6.0 * on**2),
            f_q * q_x,
            f_q * over,
            f_q * q_xx + f_qq * q_x**2,
            f_q * q_xy + f_qq * q_x * over,
            f_qq * over**2,
        )

    def _curve(self, curve: Array, x: Array) -> tuple[Array, Array, Array]:
        """A curve and two derivatives at x."""
        at = np.clip(x, *self.extent)
        y, slope, bend = polynomial(curve, at - self.extent[0])
        return y + slope * (x - at), slope, np.where(at == x, bend, 0.0)
