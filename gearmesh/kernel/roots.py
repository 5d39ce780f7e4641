"""Batched roots of one equation in one unknown: Newton guarded by a bracket, with a status per member."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import Status
from gearmesh.kernel.algebra import Array


def bracketed_root(
    function: Callable[[Array], tuple[Array, Array]],
    low: Array,
    high: Array,
    *,
    tolerance: float,
    max_iterations: int = 80,
) -> tuple[Array, NDArray[np.int64]]:
    """Roots (N,) of function(x) -> (value, derivative) between `low` and `high` (N,): Newton, guarded by bisection.

    Returns the roots and a Status each: NO_CONTACT where the values at the ends have the same sign, NOT_FINITE where
    a value is not finite, at an end or where the iteration leads (a pole changes sign as well, and is no root).
    """
    low, high = np.array(low, dtype=float), np.array(high, dtype=float)
    f_low, f_high = function(low)[0], function(high)[0]
    largest = np.maximum(np.abs(f_low), np.abs(f_high))
    status = np.where(f_low * f_high <= 0.0, int(Status.MAX_ITERATIONS), int(Status.NO_CONTACT))
    status = np.where(np.isfinite(largest), status, int(Status.NOT_FINITE))
    rising = f_high > f_low
    x = 0.5 * (low + high)
    for _ in range(max_iterations):
        f, slope = function(x)
        above = (f > 0.0) == rising
        high = np.where(above, x, high)
        low = np.where(above, low, x)
        with np.errstate(all="ignore"):
            x_new = x - f / slope
        inside = np.isfinite(x_new) & (x_new > low) & (x_new < high)
        x_new = np.where(f == 0.0, x, np.where(inside, x_new, 0.5 * (low + high)))
        done = np.abs(x_new - x) <= tolerance
        x = x_new
        # at a pole bisection ends at a value larger than those at the ends; without a value there is no bracket left
        lost = ~np.isfinite(f) | (done & (np.abs(f) > largest))
        outcome = np.where(lost, int(Status.NOT_FINITE), int(Status.CONVERGED))
        status = np.where((done | lost) & (status == Status.MAX_ITERATIONS), outcome, status)
        if not (status == Status.MAX_ITERATIONS).any():
            break
    return x, status
