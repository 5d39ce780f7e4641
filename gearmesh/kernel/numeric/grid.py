"""Numbers without their last digits, which differ from processor to processor.

What is decided by such numbers (which of two equally good diagonals, where a node goes) is the same on every processor.
"""

from __future__ import annotations

import numpy as np

from gearmesh.kernel.numeric.algebra import Array

#: share of a step of a grid from which on a value is rounded away from 0: not a half, as middles of multiples are common
BORDER = 0.5718


def on_grid(values: Array, per_unit: float) -> Array:
    """Values on a grid of so many steps per unit, without negative zeros."""
    rounded: Array = np.copysign(np.floor(np.abs(values) * per_unit + (1.0 - BORDER)) / per_unit, values) + 0.0
    return rounded


def significant(values: Array, bits: int, least: float) -> Array:
    """Values with so many bits of their mantissas; 0 where they are smaller than `least`."""
    mantissa, exponent = np.frexp(np.where(np.abs(values) < least, 0.0, values))
    rounded: Array = np.ldexp(on_grid(np.ldexp(mantissa, bits), 1.0), exponent - bits) + 0.0
    return rounded
