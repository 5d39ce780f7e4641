"""Splines of one variable, and tables with equal steps. Loading scipy's splines takes longer than solving a contact.

B-splines of knots t by the recursion of Cox and de Boor [C. de Boor, A Practical Guide to Splines, 2001, ch. IX, X]:

    N_i,k(x)  = (x - t_i) / (t_i+k - t_i) N_i,k-1(x) + (t_i+k+1 - x) / (t_i+k+1 - t_i+1) N_i+1,k-1(x)
    N_i,k'(x) = k (N_i,k-1(x) / (t_i+k - t_i) - N_i+1,k-1(x) / (t_i+k+1 - t_i+1))
"""

from __future__ import annotations

from functools import cache, cached_property
from math import factorial

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass

#: degree of splines with continuous curvature
CUBIC_DEGREE = 3


@dataclass(frozen=True)
class Polynomials:
    """A function of x made of polynomials between breaks (M + 1,).

    `coefficients` (K + 1, M, ...) belong to the powers K to 0 of the distance of x from the break before it. The first
    and the last polynomial continue beyond the ends.
    """

    breaks: Array
    coefficients: Array

    def __call__(self, x: Array, order: int = 0) -> Array:
        """Return values (order 0) or derivatives at x (...,); the shape of one value is appended to (...,)."""
        return self.derivatives(x, order)[0]

    def derivatives(self, x: Array, *orders: int) -> list[Array]:
        """Return derivatives of several orders at x (...,), one array per order."""
        piece = self.breaks[1:-1].searchsorted(x, side="right")
        beyond = np.asarray(x - self.breaks[piece]).reshape(*np.shape(x), *(1,) * (self.coefficients.ndim - 2))
        values = []
        for order in orders:
            highest, *lower = self._derivative_tables[min(order, len(self.coefficients))][:, piece]
            for coefficient in lower:
                highest = highest * beyond + coefficient
            values.append(highest)
        return values

    @cached_property
    def _derivative_tables(self) -> list[Array]:
        """Coefficients of the derivatives of orders 0 to K + 1, each like `coefficients`; the last table is 0."""
        degree = len(self.coefficients) - 1
        table = []
        for order in range(degree + 1):
            factors = [factorial(power) // factorial(power - order) for power in range(degree, order - 1, -1)]
            shape = (-1, *(1,) * (self.coefficients.ndim - 1))
            table.append(np.array(factors).reshape(shape) * self.coefficients[: len(factors)])
        return [*table, np.zeros_like(self.coefficients[:1])]


def spline_through(x: Array, values: Array, degree: int) -> Polynomials:
    """Return the spline through values (N, ...) at ascending x (N,); the degree is odd, or N - 1.

    The breaks next to either end are left out (not-a-knot).
    """
    knots = knots_of(x, degree)
    control = interpolate(x, values, degree)
    breaks = knots[degree : len(knots) - degree]
    # Taylor series at the left end of each piece, where the derivatives are taken from the right
    taylor = [
        np.tensordot(basis(knots, degree, breaks[:-1], order), control, axes=1) / factorial(order)
        for order in range(degree, -1, -1)
    ]
    return Polynomials(breaks, np.stack(taylor))


def splines_through(x: Array, values: Array, degree: int) -> Polynomials:
    """Return K splines joined into one function, through values (K, N, ...) at ascending places x (K, N).

    Each spline begins at the last place of the spline before it.
    """
    curves = [spline_through(*row, degree) for row in zip(x, values, strict=True)]
    breaks = np.concatenate([curves[0].breaks, *(curve.breaks[1:] for curve in curves[1:])])
    return Polynomials(breaks, np.concatenate([curve.coefficients for curve in curves], axis=1))


def knots_of(x: Array, degree: int) -> Array:
    """Return knots (N + degree + 1,) of the spline through places x (N,)."""
    first = (degree + 1) // 2
    inner = x[first : first + len(x) - degree - 1]
    return np.concatenate((np.full(degree + 1, x[0]), inner, np.full(degree + 1, x[-1])))


def interpolate(x: Array, values: Array, degree: int, knots: Array | None = None) -> Array:
    """Return coefficients (N, ...) of B-splines on `knots` (default `knots_of`) through values (N, ...) at x (N,)."""
    sums = basis(knots_of(x, degree) if knots is None else knots, degree, x)
    return np.asarray(np.linalg.solve(sums, values.reshape(len(x), -1))).reshape(values.shape)


@dataclass(frozen=True)
class SplineCurve:
    """Sum of the B-splines of `knots` and `degree` with coefficients `control` (N, ...)."""

    knots: Array
    control: Array
    degree: int

    @staticmethod
    def through(x: Array, values: Array, degree: int, knots: Array | None = None) -> SplineCurve:
        """Return the spline curve with values (N, ...) at x (N,)."""
        knots = knots_of(x, degree) if knots is None else knots
        return SplineCurve(knots, interpolate(x, values, degree, knots), degree)

    def __call__(self, x: Array) -> Array:
        """Return values (X, ...) at x (X,)."""
        return np.tensordot(basis(self.knots, self.degree, x), self.control, axes=1)


def control_net(places: tuple[Array, Array], points: Array, knots: tuple[Array, Array]) -> Array:
    """Return the control net (S, T, K) of the tensor-product spline through points (S, T, K) at s (S,) and t (T,)."""
    s_degree, t_degree = (len(own) - len(at) - 1 for own, at in zip(knots, places, strict=True))
    across = interpolate(places[0], points, s_degree, knots[0])
    return interpolate(places[1], across.swapaxes(0, 1), t_degree, knots[1]).swapaxes(0, 1)


def tensor_product(knots: tuple[Array, Array], control: Array, places: tuple[Array, Array]) -> Array:
    """Return points (X, Y, K) of a tensor-product spline with control net (S, T, K), at places (X,) and (Y,)."""
    across, along = (
        basis(own, len(own) - count - 1, at) for own, count, at in zip(knots, control.shape, places, strict=False)
    )
    rows = np.tensordot(across, control, axes=1)
    return np.moveaxis(np.tensordot(along, rows, axes=(1, 1)), 0, 1)


def rising_through(x: Array, values: Array) -> Polynomials:
    """Return cubics through rising values (N,) at x (N,) that rise everywhere.

    Inner slopes are weighted harmonic means of the neighbouring slopes; end slopes follow from three values. [F. N.
    Fritsch, J. Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300]
    """
    step, rise = np.diff(x), np.diff(values) / np.diff(x)
    slope = np.empty_like(values)
    before, after = 2.0 * step[1:] + step[:-1], step[1:] + 2.0 * step[:-1]
    slope[1:-1] = (before + after) / (before / rise[:-1] + after / rise[1:])
    # of only two values both ends get the slope of the straight line
    for end, other in ((0, min(1, len(rise) - 1)), (-1, -min(2, len(rise)))):
        outward = ((2.0 * step[end] + step[other]) * rise[end] - step[end] * rise[other]) / (step[end] + step[other])
        slope[end] = max(outward, 0.0)
    first, last = slope[:-1], slope[1:]
    cubic, square = (first + last - 2.0 * rise) / step**2, (3.0 * rise - 2.0 * first - last) / step
    return Polynomials(x, np.stack((cubic, square, first, values[:-1])))


def basis(knots: Array, degree: int, x: Array, order: int = 0) -> Array:
    """Return derivatives (X, N) of an order of all N B-splines of a degree at x (X,); at knots from the right."""
    if order > degree:
        return np.zeros((len(x), len(knots) - degree - 1))
    if order:
        lower = basis(knots, degree - 1, x, order - 1) * _inverse(knots[degree:] - knots[:-degree])
        derivative: Array = degree * (lower[:, :-1] - lower[:, 1:])
        return derivative
    inside = np.flatnonzero(np.diff(knots))
    span = np.clip(np.searchsorted(knots, x, side="right") - 1, inside[0], inside[-1])
    value: Array = (np.arange(len(knots) - 1) == span[:, None]).astype(float)
    for k in range(1, degree + 1):
        lower = value * _inverse(knots[k:] - knots[:-k])
        value = (x[:, None] - knots[: -k - 1]) * lower[:, :-1] + (knots[k + 1 :] - x[:, None]) * lower[:, 1:]
    return value


def _inverse(steps: Array) -> Array:
    """Return 1 / steps; 0 for coinciding knots."""
    inverse = np.zeros_like(steps)
    inverse[steps != 0.0] = 1.0 / steps[steps != 0.0]
    return inverse


@cache
def table_filter(count: int) -> Array:
    """Return the matrix (N, N) from values at equal steps to coefficients of cubic B-splines mirrored at both ends."""
    sums = (4.0 * np.eye(count) + np.eye(count, k=1) + np.eye(count, k=-1)) / 6.0
    sums[0, 1] = sums[-1, -2] = 2.0 / 6.0
    return np.asarray(np.linalg.inv(sums))


def table_weights(part: Array) -> tuple[Array, Array, Array, Array]:
    """Return weights (...,) of the cubic B-splines one step before, at, one and two steps after a grid point.

    The place of evaluation lies a `part` (...,) of a step after the grid point.
    """
    rest = 1.0 - part
    # products: a power of 3 takes five times their time
    square, square_of_rest = part * part, rest * rest
    return (
        square_of_rest * rest / 6.0,
        (4.0 - 3.0 * square * (1.0 + rest)) / 6.0,
        (4.0 - 3.0 * square_of_rest * (1.0 + part)) / 6.0,
        square * part / 6.0,
    )
