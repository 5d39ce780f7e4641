"""Smooth functions on a lattice of equal steps, read by cubic splines, and a little beyond it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.kernel.numeric.algebra import Array

#: steps by which a table goes on beyond its rim, extrapolated
BEYOND = 6


@dataclass(frozen=True)
class SplineTable:
    """Spline coefficients (R + 2 BEYOND, C + 2 BEYOND) of values (R, C)."""

    coefficients: Array

    @staticmethod
    def of(values: Array) -> SplineTable:
        """The table through values (R, C), with R and C 3 or more."""
        # scipy takes longer to load than most contacts to be solved
        from scipy.ndimage import spline_filter

        return SplineTable(spline_filter(_extend(_extend(values).T).T, order=3))

    @property
    def last(self) -> tuple[int, int]:
        """Greatest row and column."""
        rows, columns = self.coefficients.shape
        return rows - 2 * BEYOND - 1, columns - 2 * BEYOND - 1

    def at(self, row: Array, column: Array) -> Array:
        """Values (...,) at rows and columns (...,), real numbers; NaN more than BEYOND steps beyond the rim."""
        from scipy.ndimage import map_coordinates

        places = np.empty((2, *row.shape))
        values = np.zeros(row.shape)
        for k, (place, last) in enumerate(zip((row, column), self.last, strict=True)):
            np.clip(place, -BEYOND, last + BEYOND, out=places[k])
            values[~(np.abs(place - 0.5 * last) <= 0.5 * last + BEYOND)] = np.nan
        places += BEYOND
        values += map_coordinates(self.coefficients, places, order=3, prefilter=False, mode="nearest")
        return values


def _extend(rows: Array) -> Array:
    """Rows (R, C) with BEYOND more at either end, by the parabola through the last three."""
    step = np.arange(1.0, BEYOND + 1.0)[:, None]

    def ahead(a: Array, b: Array, c: Array) -> Array:
        extrapolated: Array = a + step * (a - b) + 0.5 * step * (step + 1.0) * (a - 2.0 * b + c)
        return extrapolated

    return np.concatenate((ahead(*rows[:3])[::-1], rows, ahead(*rows[:-4:-1])))
