"""Bounds as messages print them: never beyond what is allowed."""

from __future__ import annotations

import math
from collections.abc import Callable

#: significant digits
DIGITS = 6


def at_most(bound: float) -> str:
    """An upper bound, rounded down."""
    return _round(bound, math.floor)


def at_least(bound: float) -> str:
    """A lower bound, rounded up."""
    return _round(bound, math.ceil)


def _round(bound: float, whole: Callable[[float], int]) -> str:
    if bound == 0.0 or not math.isfinite(bound):
        return f"{bound:g}"
    unit = 10.0 ** (math.floor(math.log10(abs(bound))) + 1 - DIGITS)
    # what is whole but for rounding is whole
    nearest = round(bound / unit)
    return f"{(nearest if abs(bound / unit - nearest) < 1e-6 else whole(bound / unit)) * unit:.{DIGITS}g}"
