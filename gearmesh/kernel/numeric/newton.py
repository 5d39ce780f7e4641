"""Batched damped Newton for small systems, with a status per member."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import Solution, Status
from gearmesh.kernel.numeric.algebra import Array

#: singular values below this share of the largest count as 0 where a system is singular
LEAST_RCOND = 1e-13
#: lengths of steps that are tried in one evaluation, of all members together
AT_ONCE = 256

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
    at_once: int = AT_ONCE,
) -> Solution:
    """Solve function(x) = 0 for a batch of N independent systems of k unknowns: values (N, k), residual the largest |f|.

    `function(x, index)` gets unknowns (M, k) of the members `index` (M,) still being worked on, which may come more than once, and
    returns residuals (M, k) and Jacobians (M, k, k), in units that make `tolerance` (on the largest component) meaningful.
    Steps are limited componentwise to `max_step` (k,) and halved, up to `halvings` times, while the residual does
    not decrease; a member for which nothing helps is STALLED. Shorter steps are tried together, up to `at_once` of all members
    in one evaluation: that changes no more than the last digits, of functions that depend on what else they are asked for. After
    `max_evaluations` of its function a member that is not solved is left where it is. With `rcond`, one for all or (N,), 0 for
    members without, the step is the least-norm one of the truncated pseudo-inverse, so that systems with a consistent null
    space (line contact) converge to the solution nearest the start instead of running away along it. Iteration goes on once
    after the tolerance is met, for the last digits that Newton gives for free.
    """
    x = np.array(start, dtype=float)
    count = x.shape[0]
    status = np.full(count, int(Status.MAX_ITERATIONS))
    active = np.arange(count)
    if count == 0:
        return Solution(x, status, np.zeros(0), 0)
    # own copies: they are updated in place, and a constant Jacobian may be a read-only broadcast
    f, jacobian = (np.array(a, dtype=float) for a in function(x, active))
    norm = np.abs(f).max(axis=-1)
    iteration, tried, spent = (np.zeros(count, dtype=np.intp) for _ in range(3))
    if max_iterations < 1:
        return Solution(x, status, norm, 0)
    step, fresh, polished = np.empty_like(x), active, np.zeros(count, dtype=bool)
    cut = np.broadcast_to(0.0 if rcond is None else rcond, count)
    most = np.iinfo(np.intp).max if max_evaluations is None else max_evaluations
    active = active[:0] if most == 0 else active
    while active.size:
        # every member goes its own way: one halves its step while others go on, for an evaluation costs much and a member little
        iteration[fresh] += 1
        step[fresh], tried[fresh] = _newton_step(f[fresh], jacobian[fresh], cut[fresh]), 0
        bad = fresh[~np.isfinite(step[fresh]).all(axis=-1)]
        if bad.size:
            status[bad] = np.where(np.isfinite(norm[bad]), Status.SINGULAR, Status.NOT_FINITE)
            active, fresh = np.setdiff1d(active, bad), np.setdiff1d(fresh, bad)
            if not active.size:
                break
        if max_step is not None:
            step[fresh] /= np.maximum(np.abs(step[fresh] / max_step).max(axis=-1), 1.0)[:, None]
        polished[fresh] = norm[fresh] <= tolerance
        member, halved = _lengths(
            active, tried[active], np.minimum(halvings + 1, tried + most - spent)[active], at_once
        )
        trial = x[member] + 0.5 ** halved[:, None] * step[member]
        f_new, jacobian_new = function(trial, member)
        norm_new = np.abs(f_new).max(axis=-1)
        # of a member's steps the longest that is better
        better = np.flatnonzero(norm_new < norm[member])
        better = better[np.diff(member[better], prepend=-1) > 0]
        fresh = member[better]
        x[fresh], f[fresh], jacobian[fresh], norm[fresh] = (
            trial[better],
            f_new[better],
            jacobian_new[better],
            norm_new[better],
        )
        before = tried[active]
        tried[member] = halved + 1
        tried[fresh] = halved[better] + 1
        spent[active] += tried[active] - before
        met = norm[active] <= tolerance
        status[active[met]] = Status.CONVERGED
        improved = np.zeros(count, dtype=bool)
        improved[fresh] = True
        better = improved[active]
        # within the tolerance only the full step is offered: below it the residual is rounding, not a measure
        held = ~better & ~met
        status[active[held & (tried[active] > halvings)]] = Status.STALLED
        going = better & ~(met & polished[active]) & (iteration[active] < max_iterations)
        left = spent[active] < most
        active, fresh = (
            active[left & (going | (held & (tried[active] <= halvings)))],
            active[left & going],
        )
    return Solution(x, status, norm, int(iteration.max()))


def _lengths(
    active: NDArray[np.intp], tried: NDArray[np.intp], most: NDArray[np.intp], at_once: int
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Members (R,), each as often as its step is tried in lengths, and how often (R,) it is halved.

    Members (M,) whose full step led nowhere, of which shorter ones have been `tried`, try several together, up to `most` in all, as
    long as those are no more than `at_once`: that saves evaluations.
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
        # as nearly always: the whole batch at once, in half the time of what follows
        try:
            return np.asarray(-np.linalg.solve(jacobian, f[..., None])[..., 0])
        except np.linalg.LinAlgError:
            pass
    finite = np.isfinite(jacobian).all(axis=(-1, -2)) & np.isfinite(f).all(axis=-1)
    step: Array = np.full(f.shape, np.nan)
    regular = finite & (rcond == 0.0)
    if regular.any():
        with np.errstate(all="ignore"):
            # `solve` refuses the whole batch for one zero pivot, which is where `det`, from the same LU, is 0
            regular &= np.linalg.det(jacobian) != 0.0
            step[regular] = -np.linalg.solve(jacobian[regular], f[regular][..., None])[..., 0]
    truncated = finite & ~regular
    if truncated.any():
        inverse = np.linalg.pinv(jacobian[truncated], rcond=np.maximum(rcond[truncated], LEAST_RCOND))
        step[truncated] = -np.matmul(inverse, f[truncated][..., None])[..., 0]
    return step
