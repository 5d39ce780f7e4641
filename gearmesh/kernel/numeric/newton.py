"""Batched damped Newton iteration for small systems, with a status per member."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import Solution, Status
from gearmesh.kernel.numeric.algebra import Array

#: singular values below this fraction of the largest count as 0 if a system is singular
LEAST_RCOND = 1e-13
#: step lengths that are tried in one evaluation, of all members together
MAX_TRIALS_AT_ONCE = 256

#: residuals (M, k) and Jacobians (M, k, k) at unknowns (M, k) of the batch members `index` (M,)
Residual = Callable[[Array, NDArray[np.intp]], tuple[Array, Array]]


def solve(
    function: Residual,
    start: Array,
    *,
    tolerance: float,
    max_step: Array | None = None,
    max_iterations: int = 30,
    rcond: float | Array | None = None,
    halvings: int = 8,
    max_evaluations: int | None = None,
    at_once: int = MAX_TRIALS_AT_ONCE,
) -> Solution:
    """Solve function(x) = 0 for N independent systems of k unknowns.

    The result has `values` (N, k); the residual is the largest |f| of a system. `function(x, index)` gets unknowns
    (M, k) of the unfinished members `index` (M,), in which a member may occur several times. It returns residuals
    (M, k) and Jacobians (M, k, k), in units in which `tolerance` on the largest component is meaningful.

    - `max_step` (k,): limit of a step per component.
    - `halvings`: a step is halved up to so many times while the residual does not decrease; then the member is STALLED.
    - `at_once`: shortened steps are tried together, up to so many of all members in one evaluation. This changes no
      more than the last digits of functions that depend on the rest of their batch.
    - `max_evaluations`: a member unsolved after so many evaluations of its function stays as it is.
    - `rcond`: one number or (N,), 0 for a plain step. Otherwise the step is the least-norm step of the truncated
      pseudo-inverse. A system with a consistent null space (line contact) then converges to the solution nearest the
      start and does not run away along the null space.

    One more iteration follows after the tolerance is met, because Newton gains the last digits for free.
    """
    x = np.array(start, dtype=float)
    count = x.shape[0]
    status = np.full(count, int(Status.MAX_ITERATIONS))
    active = np.arange(count)
    if count == 0:
        return Solution(x, status, np.zeros(0), 0)
    # copies, because both are updated in place and a constant Jacobian may be a read-only broadcast
    f, jacobian = (np.array(a, dtype=float) for a in function(x, active))
    norm = np.abs(f).max(axis=-1)
    iteration, tried, spent = (np.zeros(count, dtype=np.intp) for _ in range(3))
    if max_iterations < 1:
        return Solution(x, status, norm, 0)
    step, fresh, polished = np.empty_like(x), active, np.zeros(count, dtype=bool)
    cutoff = np.broadcast_to(0.0 if rcond is None else rcond, count)
    evaluation_limit = np.iinfo(np.intp).max if max_evaluations is None else max_evaluations
    active = active[:0] if evaluation_limit == 0 else active
    while active.size:
        # `fresh` members get a new step, the other active members try a shorter one: all share one evaluation
        iteration[fresh] += 1
        step[fresh], tried[fresh] = _newton_step(f[fresh], jacobian[fresh], cutoff[fresh]), 0
        bad = fresh[~np.isfinite(step[fresh]).all(axis=-1)]
        if bad.size:
            status[bad] = np.where(np.isfinite(norm[bad]), Status.SINGULAR, Status.NOT_FINITE)
            active, fresh = np.setdiff1d(active, bad), np.setdiff1d(fresh, bad)
            if not active.size:
                break
        if max_step is not None:
            step[fresh] /= np.maximum(np.abs(step[fresh] / max_step).max(axis=-1), 1.0)[:, None]
        polished[fresh] = norm[fresh] <= tolerance
        # evaluate every active member at one or several lengths of its step
        member, halved = _trial_lengths(
            active, tried[active], np.minimum(halvings + 1, tried + evaluation_limit - spent)[active], at_once
        )
        trial = x[member] + 0.5 ** halved[:, None] * step[member]
        f_new, jacobian_new = function(trial, member)
        norm_new = np.abs(f_new).max(axis=-1)
        # accept the longest step of each member that decreases its residual
        better = np.flatnonzero(norm_new < norm[member])
        if member is not active:
            better = better[np.diff(member[better], prepend=-1) > 0]
        fresh = member[better]
        x[fresh], f[fresh], jacobian[fresh], norm[fresh] = (
            trial[better],
            f_new[better],
            jacobian_new[better],
            norm_new[better],
        )
        tried_before = tried[active]
        tried[member] = halved + 1
        tried[fresh] = halved[better] + 1
        spent[active] += tried[active] - tried_before
        met = norm[active] <= tolerance
        status[active[met]] = Status.CONVERGED
        improved = np.zeros(count, dtype=bool)
        improved[fresh] = True
        better = improved[active]
        # only the full step is tried below the tolerance, where the residual is mere rounding
        held = ~better & ~met
        status[active[held & (tried[active] > halvings)]] = Status.STALLED
        continuing = better & ~(met & polished[active]) & (iteration[active] < max_iterations)
        affordable = spent[active] < evaluation_limit
        active, fresh = (
            active[affordable & (continuing | (held & (tried[active] <= halvings)))],
            active[affordable & continuing],
        )
    return Solution(x, status, norm, int(iteration.max()))


def _trial_lengths(
    active: NDArray[np.intp], tried: NDArray[np.intp], most: NDArray[np.intp], at_once: int
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return the members (R,) to evaluate, repeated per step length, and the number of halvings (R,) of each.

    Members (M,) whose full step failed have `tried` some lengths. They try several shorter lengths together, up to
    `most` in all, as long as the total stays within `at_once`.
    """
    shorter = tried > 0
    if not shorter.any():
        return active, tried
    together = max(1, at_once // int(shorter.sum()))
    repeats = np.where(shorter, np.minimum(most - tried, together), 1)
    first = np.repeat(repeats.cumsum() - repeats, repeats)
    return np.repeat(active, repeats), np.repeat(tried, repeats) + np.arange(len(first)) - first


def _newton_step(f: Array, jacobian: Array, rcond: Array) -> Array:
    if not rcond.any() and np.isfinite(jacobian).all() and np.isfinite(f).all():
        # the usual case: all systems are regular and solved in one call
        try:
            return np.asarray(-np.linalg.solve(jacobian, f[..., None])[..., 0])
        except np.linalg.LinAlgError:
            pass
    finite = np.isfinite(jacobian).all(axis=(-1, -2)) & np.isfinite(f).all(axis=-1)
    step: Array = np.full(f.shape, np.nan)
    regular = finite & (rcond == 0.0)
    if regular.any():
        with np.errstate(all="ignore"):
            # `np.linalg.solve` refuses the whole batch for one zero pivot; `det` from the same LU is 0 for that member
            regular &= np.linalg.det(jacobian) != 0.0
            step[regular] = -np.linalg.solve(jacobian[regular], f[regular][..., None])[..., 0]
    truncated = finite & ~regular
    if truncated.any():
        inverse = np.linalg.pinv(jacobian[truncated], rcond=np.maximum(rcond[truncated], LEAST_RCOND))
        step[truncated] = -np.matmul(inverse, f[truncated][..., None])[..., 0]
    return step
