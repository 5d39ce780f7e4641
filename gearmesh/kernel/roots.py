"""Batched roots of one equation in one unknown between two ends, and the last place where a condition holds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import Solution, Status
from gearmesh.kernel.algebra import Array

#: Values (M,) at x (M,) of the members `index` (M,)
Function = Callable[[Array, NDArray[np.intp]], Array]
#: numbers (N,), real or whole
Numbers = TypeVar("Numbers", NDArray[np.float64], NDArray[np.int64])

#: where more is left of a change of sign than of one like |x|^(1/5), as the bracket shrank, it is a jump or a pole, no root
STEEPEST = 0.2
_STATUS = {0: Status.CONVERGED, -1: Status.NO_CONTACT, -2: Status.MAX_ITERATIONS, -3: Status.NOT_FINITE}


@dataclass(frozen=True)
class Root(Solution):
    """Roots `values` (N,) with their status and residual |f|; `before` (N,): the end towards `low` of the last bracket.

    Where a value is exactly 0 that is the root itself.
    """

    before: Array


def bracketed_root(
    function: Function,
    low: Array,
    high: Array,
    *,
    tolerance: float = 0.0,
    relative: float = 4.0 * float(np.finfo(float).eps),
    max_iterations: int = 200,
) -> Root:
    """Roots (N,) of function(x, index) between `low` and `high` (N,), in either order.

    Chandrupatla's method: inverse quadratic interpolation where it is safe, else bisection; it needs no slopes, about as
    many evaluations as a guarded Newton (9 for a sine to rounding), and a member that has settled stays as it is. CONVERGED
    says that the sign changes within `tolerance` + `relative` |x|, NO_CONTACT that it is the same at both ends, NOT_FINITE
    that a value is not finite, at an end or where the iteration leads, or that the sign changes in a pole or a jump.
    """
    # loading it takes longer than most contacts, which need no root
    from scipy.optimize.elementwise import find_root

    low, high = (np.array(end, dtype=float) for end in np.broadcast_arrays(low, high))
    if not low.size:
        return Root(low, np.zeros(0, dtype=np.int64), low, 0, low)
    at_ends: list[Array] = []

    def valued(x: Array, member: Array) -> Array:
        values = np.asarray(function(x, member.astype(np.intp)), dtype=float)
        if len(at_ends) < 2:
            # the search begins with all of `low`, then all of `high`
            at_ends.append(values)
        return values

    with np.errstate(all="ignore"):
        found = find_root(
            valued,
            (low, high),
            args=(np.arange(low.size, dtype=float),),
            tolerances={"xatol": tolerance, "xrtol": relative},
            maxiter=max_iterations,
        )
        f_low, f_high = at_ends
        # what is left of the change of sign, and of the bracket
        left = np.abs(found.f_bracket[1] - found.f_bracket[0]) / np.abs(f_high - f_low)
        shrunk = np.abs(found.bracket[1] - found.bracket[0]) / np.abs(high - low)
        status = np.select([found.status == code for code in _STATUS], [int(s) for s in _STATUS.values()])
        lost = ~np.isfinite(f_low) | ~np.isfinite(f_high)
        lost |= (status == Status.CONVERGED) & (found.f_x != 0.0) & ~(left <= shrunk**STEEPEST)
        towards_low = np.sign(found.f_bracket[0]) == np.sign(f_low)
    status = np.where(lost, int(Status.NOT_FINITE), status)
    before = np.where(towards_low, found.bracket[0], found.bracket[1])
    return Root(
        values=found.x,
        status=status,
        residual=np.abs(found.f_x),
        iterations=int(found.nit.max(initial=0)),
        before=np.where(found.f_x == 0.0, found.x, before),
    )


def last_true(
    holds: Callable[[Numbers, NDArray[np.intp]], NDArray[np.bool_]],
    low: Numbers,
    high: Numbers,
    *,
    rounds: int = 60,
    split: int = 2,
) -> tuple[Numbers, Numbers]:
    """Where a condition that holds at `low` (N,) and not at `high` (N,), in either order, ceases to hold, by division.

    Returns the last place known to hold and the first known not to. `holds(x, index)` says for places x (M,) of the members
    `index` (M,); the ends are taken as given. Each round parts every interval by `split` and asks all places between at once: more
    than 2 parts serve where many places cost little more than one. Whole numbers end as neighbours. Where it changes more
    than once, one of the changes is found.
    """
    low, high = (np.array(end) for end in np.broadcast_arrays(low, high))
    whole = np.issubdtype(low.dtype, np.integer)
    share = np.arange(1, split)
    for _ in range(rounds):
        steps: Any = (high - low)[:, None] * share
        inner = low[:, None] + (steps // split if whole else steps / split)
        # an interval with nothing between its ends is done
        member = np.flatnonzero(((inner != low[:, None]) & (inner != high[:, None])).any(axis=1))
        if not member.size:
            break
        places = inner[member]
        asked = np.asarray(holds(places.reshape(-1), np.repeat(member, split - 1))).reshape(places.shape)
        held = np.where(asked.all(axis=1), split - 1, asked.argmin(axis=1))
        ends = np.column_stack((low[member], places, high[member]))
        row = np.arange(member.size)
        low[member], high[member] = ends[row, held], ends[row, held + 1]
    return low, high
