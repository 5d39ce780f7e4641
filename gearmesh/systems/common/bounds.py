"""Bounds as printed in messages: rounded so that they are never beyond the allowed value."""

from __future__ import annotations

import math
from collections.abc import Callable

#: significant digits
BOUND_DIGITS = 6


def at_most(bound: float) -> str:
    """Return an upper bound as text, rounded down."""
    return _round(bound, math.floor)


def at_least(bound: float) -> str:
    """Return a lower bound as text, rounded up."""
    return _round(bound, math.ceil)


def _round(bound: float, whole: Callable[[float], int]) -> str:
    """Return a bound as text, rounded by `whole`."""
    if bound == 0.0 or not math.isfinite(bound):
        return f"{bound:g}"
    unit = 10.0 ** (math.floor(math.log10(abs(bound))) + 1 - BOUND_DIGITS)
    # a number that is whole up to rounding is taken as whole
    nearest = round(bound / unit)
    return f"{(nearest if abs(bound / unit - nearest) < 1e-6 else whole(bound / unit)) * unit:.{BOUND_DIGITS}g}"
