"""Splines over a grid in the plane, with exact partials, that go on straight beyond it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import factorial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.splines import CUBIC, basis, interpolate, knots_of


class PlaneJet(NamedTuple):
    """A function f(x, y) (...,) and its first and second partials, (...,) each."""

    f: Array
    x: Array
    y: Array
    xx: Array
    xy: Array
    yy: Array


@dataclass(frozen=True)
class GridSpline:
    """Tensor-product spline of the `knots` in x and y, `degrees` and coefficients (I, J).

    Beyond the first and last knots it goes on straight in either direction, bilinear beyond a corner: values and first partials are
    continuous there, second ones are not.
    """

    knots: tuple[Array, Array]
    degrees: tuple[int, int]
    coefficients: Array

    @staticmethod
    def through(x: Array, y: Array, values: Array) -> GridSpline:
        """The spline through values (I, J) at x (I,) and y (J,), both ascending: cubic, or of one degree less than lines."""
        degrees = _degree(x), _degree(y)
        control = interpolate(y, interpolate(x, values, degrees[0]).T, degrees[1]).T
        return GridSpline((knots_of(x, degrees[0]), knots_of(y, degrees[1])), degrees, control)

    @staticmethod
    def near(x: Array, y: Array, at: Array, values: Array) -> GridSpline:
        """The spline with knots as if its places were x (I,) and y (J,), through values (I, J) at places `at` (I, J, 2) near those.

        The first and last of x and y are moved to where all places lie between them. Raises ValueError for places that are no
        grid: nearer to another line than to their own.
        """
        from scipy.sparse import csr_array
        from scipy.sparse.linalg import spsolve

        degrees, knots = (_degree(x), _degree(y)), []
        for k, lines in enumerate((x, y)):
            own = np.moveaxis(at[..., k], k, 0).reshape(lines.size, -1)
            middles = 0.5 * (lines[1:] + lines[:-1])[:, None]
            if not ((own[:-1] < middles) & (own[1:] > middles)).all():
                raise ValueError("places nearer to another line of the grid than to their own")
            reach = np.concatenate(([own.min()], lines[1:-1], [own.max()]))
            knots.append(knots_of(reach, degrees[k]))
        first, second = (basis(knots[k], degrees[k], at[..., k].ravel()) for k in (0, 1))
        row, i, j = (index.ravel() for index in np.indices((values.size, degrees[0] + 1, degrees[1] + 1)))
        # of each basis those few that are not 0
        i, j = (
            base[row] + offset
            for base, offset in (
                (_first(knots[0], degrees[0], at[..., 0]), i),
                (_first(knots[1], degrees[1], at[..., 1]), j),
            )
        )
        matrix = csr_array((first[row, i] * second[row, j], (row, i * len(y) + j)), shape=(values.size, values.size))
        coefficients = np.asarray(spsolve(matrix.tocsc(), values.ravel()), dtype=float)
        return GridSpline((knots[0], knots[1]), degrees, coefficients.reshape(values.shape))

    @cached_property
    def _cells(self) -> tuple[Array, Array, Array]:
        """Lines in x and in y between which it is one polynomial, and the coefficients (I, J, a, b) of x^a y^b in each cell."""
        lines, local = [], []
        for knots, degree in zip(self.knots, self.degrees, strict=True):
            lines.append(knots[degree : len(knots) - degree])
            # Taylor series at the left ends, to whose right a spline is continuous
            local.append(
                [basis(knots, degree, lines[-1][:-1], order) / factorial(order) for order in range(degree + 1)]
            )
        return lines[0], lines[1], np.einsum("ain,nm,bjm->ijab", local[0], self.coefficients, local[1])

    def jet(self, x: Array, y: Array) -> PlaneJet:
        """Value and partials at x, y (...,)."""
        lines_x, lines_y, cells = self._cells
        x, y = np.broadcast_arrays(x, y)
        at = np.clip(x, lines_x[0], lines_x[-1]), np.clip(y, lines_y[0], lines_y[-1])
        i, j = (
            np.clip(np.searchsorted(lines, place, side="right") - 1, 0, len(lines) - 2)
            for lines, place in zip((lines_x, lines_y), at, strict=True)
        )
        # (b, a, ...): powers of y before those of x
        coefficients = np.moveaxis(cells[i, j], (-1, -2), (0, 1))
        by_y = np.stack(polynomial(coefficients, at[1] - lines_y[j]), axis=1)
        (f, f_y, f_yy), (f_x, f_xy, f_xyy), (f_xx, f_xxy, _) = polynomial(by_y, at[0] - lines_x[i])
        dx, dy = x - at[0], y - at[1]
        # straight on in each direction: bilinear beyond a corner
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
    """Polynomials with coefficients (K, ...) of powers 0 to K - 1 at x (...,), and two derivatives, by Horner's rule."""
    f = np.broadcast_to(coefficients[-1], np.broadcast_shapes(coefficients[-1].shape, x.shape))
    slope, half = np.zeros(f.shape), np.zeros(f.shape)
    for k in range(len(coefficients) - 2, -1, -1):
        half = half * x + slope
        slope = slope * x + f
        f = f * x + coefficients[k]
    return f, slope, 2.0 * half


def _degree(lines: Array) -> int:
    return min(CUBIC, len(lines) - 1)


def _first(knots: Array, degree: int, x: Array) -> NDArray[np.intp]:
    """Number (X,) of the first spline of a basis that is not 0 at x, (X,) when laid flat."""
    span: NDArray[np.intp] = np.clip(
        np.searchsorted(knots, x.ravel(), side="right") - 1, degree, len(knots) - degree - 2
    )
    return span - degree
