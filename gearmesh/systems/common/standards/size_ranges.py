"""Ranges of sizes, by which tables of standards state tolerances."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence

#: share of a size up to which a computed size is above a limit by rounding alone
ROUNDING_SHARE = 1e-12


def range_number(limits: Sequence[float], size: float) -> int:
    """Return the number of the range, from 0, that has a size; a limit is the largest size of the range below it.

    `limits`: largest sizes of the ranges, ascending. A size above the last limit has the number of limits.
    """
    return bisect_left(limits, size * (1.0 - ROUNDING_SHARE))
