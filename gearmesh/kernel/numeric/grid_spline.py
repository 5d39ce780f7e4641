"""Splines over a rectangular grid in the plane, with exact partial derivatives, continued linearly beyond the grid."""

from __future__ import annotations

from functools import cached_property
from math import factorial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.splines import CUBIC_DEGREE, basis, interpolate, knots_of
from gearmesh.records import dataclass


class PlaneJet(NamedTuple):
    """Value of a function f(x, y) with its partial derivatives."""

    #: values (...,)
    f: Array
    #: first derivatives by x (...,)
    x: Array
    #: first derivatives by y (...,)
    y: Array
    #: second derivatives by x (...,)
    xx: Array
    #: derivatives by x and y (...,)
    xy: Array
    #: second derivatives by y (...,)
    yy: Array


@dataclass(frozen=True)
class GridSpline:
    """Tensor-product spline with `knots` and `degrees` in x and y, and coefficients (I, J).

    Beyond the first and last knots the spline continues linearly in either direction, and bilinearly beyond a corner.
    Values and first partials are continuous there; second partials are not.
    """

    knots: tuple[Array, Array]
    degrees: tuple[int, int]
    coefficients: Array

    @staticmethod
    def through(x: Array, y: Array, values: Array) -> GridSpline:
        """Return the spline through values (I, J) at ascending x (I,) and y (J,); cubic, or lower for few lines."""
        degrees = _degree(x), _degree(y)
        control = interpolate(y, interpolate(x, values, degrees[0]).T, degrees[1]).T
        return GridSpline((knots_of(x, degrees[0]), knots_of(y, degrees[1])), degrees, control)

    @staticmethod
    def near(x: Array, y: Array, at: Array, values: Array) -> GridSpline:
        """Return the spline through values (I, J) at places `at` (I, J, 2), with the knots of a grid x (I,), y (J,).

        Every place lies near its grid point. The first and last lines of the grid are moved outwards to contain all
        places. Raises ValueError if a place is nearer to another grid line than to its own.
        """
        from scipy.sparse import csr_array
        from scipy.sparse.linalg import spsolve

        degrees, knots = (_degree(x), _degree(y)), []
        for k, lines in enumerate((x, y)):
            on_lines = np.moveaxis(at[..., k], k, 0).reshape(lines.size, -1)
            middles = 0.5 * (lines[1:] + lines[:-1])[:, None]
            if not ((on_lines[:-1] < middles) & (on_lines[1:] > middles)).all():
                raise ValueError("places nearer to another line of the grid than to their own")
            extended = np.concatenate(([on_lines.min()], lines[1:-1], [on_lines.max()]))
            knots.append(knots_of(extended, degrees[k]))
        x_basis, y_basis = (basis(knots[k], degrees[k], at[..., k].ravel()) for k in (0, 1))
        row, i, j = (index.ravel() for index in np.indices((values.size, degrees[0] + 1, degrees[1] + 1)))
        # a sparse collocation matrix: only degree + 1 splines of each basis differ from 0 at a place
        i, j = (
            base[row] + offset
            for base, offset in (
                (_first_spline(knots[0], degrees[0], at[..., 0]), i),
                (_first_spline(knots[1], degrees[1], at[..., 1]), j),
            )
        )
        matrix = csr_array((x_basis[row, i] * y_basis[row, j], (row, i * len(y) + j)), shape=(values.size, values.size))
        coefficients = np.asarray(spsolve(matrix.tocsc(), values.ravel()), dtype=float)
        return GridSpline((knots[0], knots[1]), degrees, coefficients.reshape(values.shape))

    @cached_property
    def _cells(self) -> tuple[Array, Array, Array]:
        """Grid lines in x and y that bound the pieces, and coefficients (I, J, a, b) of x^a y^b in each piece."""
        lines, local = [], []
        for knots, degree in zip(self.knots, self.degrees, strict=True):
            lines.append(knots[degree : len(knots) - degree])
            # Taylor series at the left end of each cell, where the derivatives are taken from the right
            local.append(
                [basis(knots, degree, lines[-1][:-1], order) / factorial(order) for order in range(degree + 1)]
            )
        # one product after the other: all three at once would cost the product of all lengths
        by_x = np.tensordot(np.stack(local[0]), self.coefficients, axes=1)
        return lines[0], lines[1], np.moveaxis(np.tensordot(by_x, np.stack(local[1]), axes=(2, 2)), (0, 2), (2, 3))

    def jet(self, x: Array, y: Array) -> PlaneJet:
        """Return value and partials at x, y (...,)."""
        lines_x, lines_y, cells = self._cells
        x, y = np.broadcast_arrays(x, y)
        inside = np.clip(x, lines_x[0], lines_x[-1]), np.clip(y, lines_y[0], lines_y[-1])
        i, j = (
            np.clip(np.searchsorted(lines, place, side="right") - 1, 0, len(lines) - 2)
            for lines, place in zip((lines_x, lines_y), inside, strict=True)
        )
        # axes (b, a, ...): Horner's rule first over the powers of y, then over those of x
        coefficients = np.moveaxis(cells[i, j], (-1, -2), (0, 1))
        by_y = np.stack(polynomial(coefficients, inside[1] - lines_y[j]), axis=1)
        (f, f_y, f_yy), (f_x, f_xy, f_xyy), (f_xx, f_xxy, _) = polynomial(by_y, inside[0] - lines_x[i])
        dx, dy = x - inside[0], y - inside[1]
        # linear continuation beyond the grid: second partials vanish, and the result is bilinear beyond a corner
        inside_x, inside_y = dx == 0.0, dy == 0.0
        f_xx, f_xxy = np.where(inside_x, f_xx, 0.0), np.where(inside_x, f_xxy, 0.0)
        f_yy, f_xyy = np.where(inside_y, f_yy, 0.0), np.where(inside_y, f_xyy, 0.0)
        return PlaneJet(
            f + f_x * dx + f_y * dy + f_xy * dx * dy,
            f_x + f_xy * dy,
            f_y + f_xy * dx,
            f_xx + f_xxy * dy,
            f_xy,
            f_yy + f_xyy * dx,
        )


def polynomial(coefficients: Array, x: Array) -> tuple[Array, Array, Array]:
    """Return values and two derivatives at x (...,) of polynomials with coefficients (K, ...) of rising powers.

    Evaluated by Horner's rule.
    """
    f = np.broadcast_to(coefficients[-1], np.broadcast_shapes(coefficients[-1].shape, x.shape))
    slope, half = np.zeros(f.shape), np.zeros(f.shape)
    for k in range(len(coefficients) - 2, -1, -1):
        half = half * x + slope
        slope = slope * x + f
        f = f * x + coefficients[k]
    return f, slope, 2.0 * half


def _degree(lines: Array) -> int:
    return min(CUBIC_DEGREE, len(lines) - 1)


def _first_spline(knots: Array, degree: int, x: Array) -> NDArray[np.intp]:
    """Return the number (X,) of the first basis spline that differs from 0 at each x, flattened to (X,)."""
    span: NDArray[np.intp] = np.clip(
        np.searchsorted(knots, x.ravel(), side="right") - 1, degree, len(knots) - degree - 2
    )
    return span - degree
