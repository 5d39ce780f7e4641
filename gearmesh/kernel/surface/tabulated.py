"""Surface through points, with an exact jet: Chebyshev series in u across it, and splines in v along it.

    r(u, v) = sum_k c_k(v) T_k(2 u - 1),   0 <= u <= 1

The series represents smooth curves, such as arcs of up to a right angle, to rounding with `SERIES_DEGREE` + 1 points.
The normal is r_u x r_v of this surface, and its partials follow from the second partials of r.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.polynomial import chebyshev

from gearmesh.kernel.numeric.algebra import Array, cross, dot
from gearmesh.kernel.numeric.splines import Polynomials, splines_through
from gearmesh.kernel.surface.surface import Jet
from gearmesh.records import dataclass

#: degree of the series in u: an arc of 90 deg is within 1e-13 of its radius
SERIES_DEGREE = 11
#: degree of the splines in v
SPLINE_DEGREE = 5


def nodes_across() -> Array:
    """Return the places u (SERIES_DEGREE + 1,), ascending between 0 and 1, at which a surface is tabulated."""
    return 0.5 - 0.5 * np.cos(np.pi * (np.arange(SERIES_DEGREE + 1) + 0.5) / (SERIES_DEGREE + 1))


@dataclass(frozen=True)
class TabulatedSurface:
    """Surface by coefficients c_k(v) (SERIES_DEGREE + 1, 3), mm, of the series in u."""

    series: Polynomials
    #: +1 if r_u x r_v points out of the material, else -1
    sense: float

    @staticmethod
    def through(points: Array, stations: Array, outward: Array) -> TabulatedSurface:
        """Surface through points at `nodes_across` and at stations.

        `points`: (SERIES_DEGREE + 1, K, T, 3), mm, of K smooth stretches. `stations`: v (K, T), ascending over all
        stretches; each begins where the one before it ends. `outward`: directions out of the material at the points,
        of the same shape.
        """
        vandermonde = chebyshev.chebvander(2.0 * nodes_across() - 1.0, SERIES_DEGREE)
        coefficients = np.tensordot(np.linalg.inv(vandermonde), points, axes=1)
        series = splines_through(stations, np.moveaxis(coefficients, 0, 2), SPLINE_DEGREE)
        surface = TabulatedSurface(series, 1.0)
        middle = SERIES_DEGREE // 2, 0, points.shape[2] // 2
        jet = surface.jet(nodes_across()[[middle[0]]], stations[middle[1:]].reshape(1))
        return TabulatedSurface(series, float(np.sign(dot(jet.n, outward[middle][None])[0])))

    def jet(self, u: Array, v: Array) -> Jet:
        """Return point, unit normal and their first partial derivatives at u, v (...,)."""
        u, v = np.broadcast_arrays(np.asarray(u, dtype=float), np.asarray(v, dtype=float))
        across = [self._basis(u.ravel(), order) for order in range(3)]
        along = self.series.derivatives(v.ravel(), 0, 1, 2)

        def partial(by_u: int, by_v: int) -> Array:
            return np.asarray((across[by_u][:, None, :] @ along[by_v])[:, 0].reshape(*u.shape, 3))

        r_u, r_v, r_uv = partial(1, 0), partial(0, 1), partial(1, 1)
        area = self.sense * cross(r_u, r_v)
        size = np.sqrt(dot(area, area))[..., None]
        n = area / size
        changes = (
            self.sense * (cross(first, r_v) + cross(r_u, second)) / size
            for first, second in ((partial(2, 0), r_uv), (r_uv, partial(0, 2)))
        )
        n_u, n_v = (change - n * dot(n, change)[..., None] for change in changes)
        return Jet(partial(0, 0), n, r_u, r_v, n_u, n_v)

    def _basis(self, u: Array, order: int) -> Array:
        """Return the derivatives (M, SERIES_DEGREE + 1) by u, of an order, of the polynomials T_k at u (M,)."""
        return np.asarray(chebyshev.chebvander(2.0 * u - 1.0, SERIES_DEGREE - order) @ self._derivatives[order])

    @cached_property
    def _derivatives(self) -> list[Array]:
        """Matrices (SERIES_DEGREE + 1 - order, SERIES_DEGREE + 1) from a series to its derivative by u, per order."""
        series = np.eye(SERIES_DEGREE + 1)
        return [series, *(np.asarray(2.0**order * chebyshev.chebder(series, order, axis=0)) for order in (1, 2))]
