"""Rounding of numbers to a grid, because their last digits differ from processor to processor.

A decision based on rounded numbers is the same on every processor, such as a choice between two equally good diagonals.
"""

from __future__ import annotations

import numpy as np

from gearmesh.kernel.numeric.algebra import Array

#: fraction of a grid step from which on a value is rounded away from 0; not 0.5, as values half way between grid points
#: are common
ROUND_UP_FRACTION = 0.5718


def on_grid(values: Array, per_unit: float) -> Array:
    """Round values to a grid with `per_unit` steps per unit; negative zeros become 0."""
    rounded: Array = (
        np.copysign(np.floor(np.abs(values) * per_unit + (1.0 - ROUND_UP_FRACTION)) / per_unit, values) + 0.0
    )
    return rounded


def significant(values: Array, bits: int, least: float) -> Array:
    """Round values to `bits` bits of their mantissas; values smaller than `least` become 0."""
    mantissa, exponent = np.frexp(np.where(np.abs(values) < least, 0.0, values))
    rounded: Array = np.ldexp(on_grid(np.ldexp(mantissa, bits), 1.0), exponent - bits) + 0.0
    return rounded
