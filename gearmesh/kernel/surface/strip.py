"""Strips: surfaces between two curves along the face, ruled between the curves at every station."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

import numpy as np
from numpy.polynomial import Chebyshev

from gearmesh.kernel.numeric.algebra import Z_AXIS, Array, broadcast_pair, cross, dot, polar_angle
from gearmesh.kernel.surface.levels import Level, station_normal
from gearmesh.kernel.surface.surface import Jet
from gearmesh.records import dataclass

#: degree of the polynomials of both curves
CURVE_DEGREE = 24
#: largest of the last two coefficients of a smooth curve, relative to its largest coordinate
MAX_LAST_COEFFICIENT = 1e-12


@dataclass(frozen=True)
class Strip:
    """Surface between two curves: the parameter h runs from 0 to 1 between them, v is the station less `middle`, mm.

    At every station of `axial` (a plane, cone or cylinder) the polar angle and the length along the generatrix are
    linear in h. `curves` holds two polynomials of v per curve: angle (rad) and length (mm). The normal points away from
    the axis.
    """

    axial: Level
    middle: float
    curves: tuple[tuple[Chebyshev, Chebyshev], tuple[Chebyshev, Chebyshev]]

    @staticmethod
    def through(
        axial: Level, extent: tuple[float, float], first: Callable[[Array], Array], second: Callable[[Array], Array]
    ) -> Strip:
        """Return the strip between two curves within rounding, over an `extent` of station coordinates.

        Each curve takes station coordinates (T,) to points (T, 3). Raises ValueError for curves that are not smooth.
        """
        middle, half = 0.5 * (extent[0] + extent[1]), 0.5 * (extent[1] - extent[0])
        across, up = station_normal(axial)
        # both coordinates of each curve as Chebyshev series over the stations
        nodes = half * np.polynomial.chebyshev.chebpts1(CURVE_DEGREE + 1)
        curves = []
        for curve in (first, second):
            r = curve(middle + nodes)
            rho, angle = np.hypot(r[:, 0], r[:, 1]), np.unwrap(polar_angle(r))
            length = -up * rho + across * r[:, 2]
            fitted = [
                Chebyshev.fit(nodes, coordinate, CURVE_DEGREE, domain=[-half, half]) for coordinate in (angle, length)
            ]
            scale = np.abs(length).max() + rho.max()
            rest = [np.abs(series.coef[-2:]).max() for series in fitted]
            if not (rest[0] < MAX_LAST_COEFFICIENT and rest[1] < MAX_LAST_COEFFICIENT * scale):
                raise ValueError("no smooth curve along the face")
            curves.append((fitted[0], fitted[1]))
        return Strip(axial, middle, (curves[0], curves[1]))

    @cached_property
    def _derivatives(self) -> tuple[tuple[tuple[Chebyshev, ...], ...], ...]:
        """Angle and length of each curve, each with its first two derivatives."""
        return tuple(tuple((series, series.deriv(), series.deriv(2)) for series in curve) for curve in self.curves)

    def jet(self, u: Array, v: Array) -> Jet:
        u, v = broadcast_pair(u, v)
        across, up = station_normal(self.axial)
        at = [[[d(v) for d in derivatives] for derivatives in curve] for curve in self._derivatives]
        # angle t and length w: value, and partials by h, by v, by h and v, twice by v
        (t, t_h, t_v, t_hv, t_vv), (w, w_h, w_v, w_hv, w_vv) = (
            (a + u * (b - a), b - a, a_v + u * (b_v - a_v), b_v - a_v, a_vv + u * (b_vv - a_vv))
            for (a, a_v, a_vv), (b, b_v, b_vv) in zip(*at, strict=True)
        )
        # the same partials of the polar radius; z is linear in w
        station = v + self.middle - float(self.axial.value(np.zeros(3)))
        rho, z = across * station - up * w, up * station + across * w
        rho_h, rho_v, rho_hv, rho_vv = -up * w_h, across - up * w_v, -up * w_hv, -up * w_vv
        out = np.stack((np.cos(t), np.sin(t), np.zeros_like(t)), axis=-1)
        around = np.stack((-out[..., 1], out[..., 0], np.zeros_like(t)), axis=-1)

        def vector(radial: Array, turning: Array, axial: Array) -> Array:
            sum_of_parts: Array = radial[..., None] * out + turning[..., None] * around + axial[..., None] * Z_AXIS
            return sum_of_parts

        r_h = vector(rho_h, rho * t_h, across * w_h)
        r_v = vector(rho_v, rho * t_v, up + across * w_v)
        r_hh = vector(-rho * t_h**2, 2.0 * rho_h * t_h, np.zeros_like(t))
        r_hv = vector(rho_hv - rho * t_h * t_v, rho_h * t_v + rho_v * t_h + rho * t_hv, across * w_hv)
        r_vv = vector(rho_vv - rho * t_v**2, 2.0 * rho_v * t_v + rho * t_vv, across * w_vv)
        # the normal and its partials, from first and second partials of the point
        area = cross(r_h, r_v)
        size = np.sqrt(dot(area, area))
        size = np.where(dot(area, out) < 0.0, -size, size)[..., None]
        n = area / size
        n_h, n_v = (
            (rate - n * dot(n, rate)[..., None]) / size
            for rate in (cross(r_hh, r_v) + cross(r_h, r_hv), cross(r_hv, r_v) + cross(r_h, r_vv))
        )
        return Jet(rho[..., None] * out + z[..., None] * Z_AXIS, n, r_h, r_v, n_h, n_v)
