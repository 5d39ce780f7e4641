"""Batched roots of one equation in one unknown between two ends, and the last place where a condition holds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import Solution, Status
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.effort import spend

#: Values (M,) at x (M,) of the members `index` (M,)
Function = Callable[[Array, NDArray[np.intp]], Array]
#: numbers (N,), real or whole
Numbers = TypeVar("Numbers", NDArray[np.float64], NDArray[np.int64])

#: where more is left of a change of sign than of one like |x|^(1/5), as the bracket shrank, it is a jump or a pole, no root
STEEPEST = 0.2


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
    many evaluations as a guarded Newton (9 for a sine to rounding), and a member that has converged stays as it is. CONVERGED
    says that the sign changes within `tolerance` + `relative` |x|, NO_CONTACT that it is the same at both ends, NOT_FINITE
    that a value is not finite, at an end or where the iteration leads, or that the sign changes in a pole or a jump.
    """
    low, high = (np.array(end, dtype=float) for end in np.broadcast_arrays(low, high))
    if not low.size:
        return Root(low, np.zeros(0, dtype=np.int64), low, 0, low)
    with np.errstate(all="ignore"):
        every = np.arange(low.size)
        f_low, f_high = (np.asarray(function(end, every), dtype=float) for end in (low, high))
        bracket, status, iterations = _shrunk(
            function, np.array((low, f_low, high, f_high)), (tolerance, relative), max_iterations
        )
        spend(low.size, iterations + 2, linear=True)
        x1, f1, x2, f2 = bracket
        nearer = np.abs(f1) < np.abs(f2)
        x, f = np.where(nearer, x1, x2), np.where(nearer, f1, f2)
        # what is left of the change of sign, and of the bracket
        left, shrunk = np.abs(f2 - f1) / np.abs(f_high - f_low), np.abs(x2 - x1) / np.abs(high - low)
        lost = ~np.isfinite(f_low) | ~np.isfinite(f_high)
        lost |= (status == Status.CONVERGED) & (f != 0.0) & ~(left <= shrunk**STEEPEST)
        # the lower end first, so that it is the same one of two ends alike whichever was asked last
        first, second = np.where(x1 < x2, (x1, f1), (x2, f2)), np.where(x1 < x2, x2, x1)
        before = np.where(f == 0.0, x, np.where(np.sign(first[1]) == np.sign(f_low), first[0], second))
    nowhere = (status == Status.NO_CONTACT) | (status == Status.NOT_FINITE)
    return Root(
        values=np.where(nowhere, np.nan, x),
        status=np.where(lost, int(Status.NOT_FINITE), status),
        residual=np.where(nowhere, np.nan, np.abs(f)),
        iterations=iterations,
        before=before,
    )


def _shrunk(
    function: Function, bracket: Array, tolerances: tuple[float, float], max_iterations: int
) -> tuple[Array, NDArray[np.int64], int]:
    """Brackets (4, N), rows x1, f(x1), x2, f(x2), shrunk till they are done; their status; iterations of the longest.

    Chandrupatla, Adv. Eng. Software 28 (1997) 145: x1 is the last place asked, x3 the one that x2 or x1 took the place of.
    """
    tolerance, relative = tolerances
    bracket, status = bracket.copy(), np.full(bracket.shape[1], int(Status.MAX_ITERATIONS), dtype=np.int64)
    member, last = np.arange(bracket.shape[1]), np.zeros((2, bracket.shape[1]))
    iterations = 0
    while True:
        x1, f1, x2, f2 = bracket[:, member]
        nearest, least = np.where(np.abs(f1) < np.abs(f2), (x1, f1), (x2, f2))
        width, allowed = np.abs(x2 - x1), np.abs(nearest) * relative + tolerance
        done = np.select(
            [
                np.abs(least) <= np.finfo(float).smallest_normal,
                np.sign(f1) == np.sign(f2),
                ~(np.isfinite(x1) & np.isfinite(x2)) | (np.isnan(f1) & np.isnan(f2)),
                width < allowed,
            ],
            [int(s) for s in (Status.CONVERGED, Status.NO_CONTACT, Status.NOT_FINITE, Status.CONVERGED)],
            int(Status.MAX_ITERATIONS),
        )
        status[member] = done
        active = done == Status.MAX_ITERATIONS
        if iterations == max_iterations or not active.any():
            return bracket, status, iterations
        member = member[active]
        x1, f1, x2, f2, width, allowed = (row[active] for row in (x1, f1, x2, f2, width, allowed))
        share = np.full(member.size, 0.5)
        if iterations:
            share = _step((x1, f1, x2, f2, *last[:, active]), width, allowed)
        x = x1 + share * (x2 - x1)
        f = np.asarray(function(x, member), dtype=float)
        same = np.sign(f) == np.sign(f1)
        last = np.where(same, (x1, f1), (x2, f2))
        bracket[:, member] = (x, f, *np.where(same, (x2, f2), (x1, f1)))
        iterations += 1


def _step(points: tuple[Array, ...], width: Array, allowed: Array) -> Array:
    """Where between x1 and x2 (0 to 1) to ask next, by x1, f1, x2, f2, x3, f3: not nearer to an end than is asked for."""
    x1, f1, x2, f2, x3, f3 = points
    xi, phi, alpha = (x1 - x2) / (x3 - x2), (f1 - f2) / (f3 - f2), (x3 - x1) / (x2 - x1)
    safe = (1.0 - np.sqrt(1.0 - xi) < phi) & (phi < np.sqrt(xi))
    quadratic = f1 / (f1 - f2) * f3 / (f3 - f2) - alpha * f1 / (f3 - f1) * f2 / (f2 - f3)
    least = 0.5 * allowed / width
    return np.clip(np.where(safe, quadratic, 0.5), least, 1.0 - least)


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
