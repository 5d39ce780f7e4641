"""Tables of smooth functions on a lattice of equal steps, read by cubic splines on the lattice and a little beyond it."""

from __future__ import annotations

from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.splines import table_filter, table_weights
from gearmesh.records import dataclass

#: extrapolated steps of a table beyond its rim
STEPS_BEYOND_RIM = 6


@dataclass(frozen=True)
class SplineTable:
    """Table of values (R, C) by spline coefficients (R + 2 STEPS_BEYOND_RIM, C + 2 STEPS_BEYOND_RIM)."""

    coefficients: Array

    @staticmethod
    def of(values: Array) -> SplineTable:
        """Return the table through values (R, C), with R and C 3 or more."""
        lattice = _extend(_extend(values).T).T
        rows, columns = map(table_filter, lattice.shape)
        return SplineTable(rows @ lattice @ columns.T)

    @property
    def last(self) -> tuple[int, int]:
        """Greatest row and column."""
        rows, columns = self.coefficients.shape
        return rows - 2 * STEPS_BEYOND_RIM - 1, columns - 2 * STEPS_BEYOND_RIM - 1

    def at(self, row: Array, column: Array) -> Array:
        """Return values (...,) at real rows and columns (...,); NaN more than STEPS_BEYOND_RIM steps beyond the rim."""
        (first, by_row), (second, by_column) = (
            _weights(place, last) for place, last in zip((row, column), self.last, strict=True)
        )
        table, across = self._with_rim
        corner = first * across + second
        values = np.zeros(row.shape)
        for i, of_row in enumerate(by_row):
            here = np.zeros(row.shape)
            for j, of_column in enumerate(by_column):
                # a slice of the table in place of a shifted corner saves a third of the time
                here += of_column * table[i * across + j :].take(corner)
            values += of_row * here
        return values

    @cached_property
    def _with_rim(self) -> tuple[Array, int]:
        """Flat coefficients with one mirrored row and column before and two after them, and the number of their columns."""
        wide = np.pad(self.coefficients, (1, 2), mode="reflect")
        return wide.ravel(), wide.shape[1]


def _weights(place: Array, last: int) -> tuple[NDArray[np.intp], tuple[Array, ...]]:
    """Return the number (...,) of the first of four coefficients at places (...,), and weights; NaN beyond the coefficients."""
    # NaN beyond the table, which makes the weights NaN
    step = np.where(np.abs(place - 0.5 * last) <= 0.5 * last + STEPS_BEYOND_RIM, place + STEPS_BEYOND_RIM, np.nan)
    first = np.floor(step)
    part = step - first
    return np.nan_to_num(first, copy=False).astype(np.intp), table_weights(part)


def _extend(rows: Array) -> Array:
    """Return rows (R, C) with STEPS_BEYOND_RIM more rows at each end, by the parabola through the last three rows."""
    step = np.arange(1.0, STEPS_BEYOND_RIM + 1.0)[:, None]

    def ahead(a: Array, b: Array, c: Array) -> Array:
        extrapolated: Array = a + step * (a - b) + 0.5 * step * (step + 1.0) * (a - 2.0 * b + c)
        return extrapolated

    return np.concatenate((ahead(*rows[:3])[::-1], rows, ahead(*rows[:-4:-1])))
