"""Batched roots of one equation in one unknown within brackets, and the last argument at which a condition holds."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import Solution, Status
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.effort import ROOT_STEP, spend
from gearmesh.records import dataclass

#: values (M,) at x (M,) for the batch members `index` (M,)
Function = Callable[[Array, NDArray[np.intp]], Array]
#: real or whole numbers (N,)
Numbers = TypeVar("Numbers", NDArray[np.float64], NDArray[np.int64])

#: exponent p of the steepest sign change |x|^p that counts as a root; anything steeper is a jump or a pole
SMALLEST_ROOT_EXPONENT = 0.2


@dataclass(frozen=True)
class Root(Solution):
    """Roots `values` (N,) with their status and residual |f|."""

    #: end (N,) of the last bracket on the side of `low`; the root itself if f is exactly 0 there
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
    """Return roots (N,) of function(x, index) between `low` and `high` (N,), which may be in either order.

    Chandrupatla's method: inverse quadratic interpolation if it is safe, else bisection. It needs no derivatives and
    about as many evaluations as a guarded Newton iteration. A converged member is not changed by the rest of its batch.
    Status per member:

    - CONVERGED: the sign changes within `tolerance` + `relative` |x|.
    - NO_CONTACT: the sign is the same at both ends.
    - NOT_FINITE: a value is not finite, at an end or during the iteration, or the sign changes at a pole or a jump.
    """
    low, high = (np.array(end, dtype=float) for end in np.broadcast_arrays(low, high))
    if not low.size:
        return Root(low, np.zeros(0, dtype=np.int64), low, 0, low)
    with np.errstate(all="ignore"):
        members = np.arange(low.size)
        f_low, f_high = (np.asarray(function(end, members), dtype=float) for end in (low, high))
        bracket, status, iterations = _shrink_brackets(
            function, np.array((low, f_low, high, f_high)), (tolerance, relative), max_iterations
        )
        spend(low.size, iterations + 2, ROOT_STEP)
        x1, f1, x2, f2 = bracket
        nearer = np.abs(f1) < np.abs(f2)
        x, f = np.where(nearer, x1, x2), np.where(nearer, f1, f2)
        # a pole or a jump keeps its step in f while the bracket shrinks; a root does not
        left, shrunk = np.abs(f2 - f1) / np.abs(f_high - f_low), np.abs(x2 - x1) / np.abs(high - low)
        lost = ~np.isfinite(f_low) | ~np.isfinite(f_high)
        lost |= (status == Status.CONVERGED) & (f != 0.0) & ~(left <= shrunk**SMALLEST_ROOT_EXPONENT)
        # ends sorted by x: the result does not depend on which end was evaluated last
        lower_end, upper_x = np.where(x1 < x2, (x1, f1), (x2, f2)), np.where(x1 < x2, x2, x1)
        before = np.where(f == 0.0, x, np.where(np.sign(lower_end[1]) == np.sign(f_low), lower_end[0], upper_x))
    nowhere = (status == Status.NO_CONTACT) | (status == Status.NOT_FINITE)
    return Root(
        values=np.where(nowhere, np.nan, x),
        status=np.where(lost, int(Status.NOT_FINITE), status),
        residual=np.where(nowhere, np.nan, np.abs(f)),
        iterations=iterations,
        before=before,
    )


def _shrink_brackets(
    function: Function, bracket: Array, tolerances: tuple[float, float], max_iterations: int
) -> tuple[Array, NDArray[np.int64], int]:
    """Return brackets (4, N) shrunk until they are done, their status, and the largest number of iterations.

    The rows of a bracket are x1, f(x1), x2, f(x2): x1 is the newest point, x2 the other end, x3 the end that was
    replaced last. [T. R. Chandrupatla, Adv. Eng. Software 28 (1997) 145]
    """
    tolerance, relative = tolerances
    bracket, status = bracket.copy(), np.full(bracket.shape[1], int(Status.MAX_ITERATIONS), dtype=np.int64)
    member, last = np.arange(bracket.shape[1]), np.zeros((2, bracket.shape[1]))
    iterations = 0
    while True:
        x1, f1, x2, f2 = bracket[:, member]
        nearest, least = np.where(np.abs(f1) < np.abs(f2), (x1, f1), (x2, f2))
        width, allowed = np.abs(x2 - x1), np.abs(nearest) * relative + tolerance
        # a bracket is done at a root, without a change of sign, at values that are not finite, or when narrow enough
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
        # the first step bisects; later steps have three points to interpolate
        share = np.full(member.size, 0.5)
        if iterations:
            share = _next_fraction((x1, f1, x2, f2, *last[:, active]), width, allowed)
        # the new point replaces the end with its sign; the replaced end is kept as x3
        x = x1 + share * (x2 - x1)
        f = np.asarray(function(x, member), dtype=float)
        same = np.sign(f) == np.sign(f1)
        last = np.where(same, (x1, f1), (x2, f2))
        bracket[:, member] = (x, f, *np.where(same, (x2, f2), (x1, f1)))
        iterations += 1


def _next_fraction(points: tuple[Array, ...], width: Array, allowed: Array) -> Array:
    """Return the next point as a fraction (0 to 1) of the way from x1 to x2, from x1, f1, x2, f2, x3, f3.

    The point keeps half of the allowed bracket width away from both ends.
    """
    x1, f1, x2, f2, x3, f3 = points
    xi, phi, alpha = (x1 - x2) / (x3 - x2), (f1 - f2) / (f3 - f2), (x3 - x1) / (x2 - x1)
    # quadratic interpolation is safe if x(f) through the three points is monotonic in the bracket
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
    """Find by division where a condition that holds at `low` (N,) but not at `high` (N,) ceases to hold.

    Returns the last argument known to hold and the first known not to. `low` and `high` may be in either order; they
    are not tested. `holds(x, index)` tests arguments x (M,) of the batch members `index` (M,). Each of the `rounds`
    divides every interval into `split` parts and tests all inner points at once. More than 2 parts pay off if many
    points cost little more than one. Whole numbers end as neighbours. If the condition changes more than once, one of
    the changes is found.
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
        tested = inner[member]
        outcome = np.asarray(holds(tested.reshape(-1), np.repeat(member, split - 1))).reshape(tested.shape)
        last_held = np.where(outcome.all(axis=1), split - 1, outcome.argmin(axis=1))
        ends = np.column_stack((low[member], tested, high[member]))
        row = np.arange(member.size)
        low[member], high[member] = ends[row, last_held], ends[row, last_held + 1]
    return low, high
