"""Batched damped Newton for small systems, with a status per member."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import Solution, Status
from gearmesh.kernel.algebra import Array

Residual = Callable[[Array, NDArray[np.intp]], tuple[Array, Array]]


def solve(
    function: Residual,
    start: Array,
    *,
    tolerance: float,
    max_step: Array | None = None,
    max_iterations: int = 30,
    rcond: float | None = None,
    halvings: int = 8,
) -> Solution:
    """Solve function(x) = 0 for a batch of N independent systems of k unknowns: values (N, k), residual the largest |f|.

    `function(x, index)` gets the unknowns (M, k) of the members `index` (M,) still being worked on and returns
    residuals (M, k) and Jacobians (M, k, k), in units that make `tolerance` (on the largest component) meaningful.
    Steps are limited componentwise to `max_step` (k,) and halved, up to `halvings` times, while the residual does
    not decrease; a member for which nothing helps is given up. With `rcond` the step is the least-norm one of the
    truncated pseudo-inverse, so that systems with a consistent null space (line contact) converge to the solution
    nearest the start instead of running away along it. Iteration goes on once after the tolerance is met, for the
    last digits that Newton gives for free.
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
    iteration = 0
    while iteration < max_iterations:
        iteration += 1
        step = _newton_step(f[active], jacobian[active], rcond)
        bad = ~np.isfinite(step).all(axis=-1)
        status[active[bad]] = np.where(np.isfinite(norm[active[bad]]), Status.SINGULAR, Status.NOT_FINITE)
        active, step = active[~bad], step[~bad]
        if max_step is not None and active.size:
            ratio = np.abs(step / max_step).max(axis=-1)
            step = step / np.maximum(ratio, 1.0)[:, None]
        polished = norm[active] <= tolerance
        moved = _line_search(function, (x, f, jacobian, norm), active, step, tolerance, halvings)
        met = norm[active] <= tolerance
        status[active[met]] = Status.CONVERGED
        active = active[moved & ~(met & polished)]
        if active.size == 0:
            break
    return Solution(x, status, norm, iteration)


def _newton_step(f: Array, jacobian: Array, rcond: float | None) -> Array:
    finite = np.isfinite(jacobian).all(axis=(-1, -2)) & np.isfinite(f).all(axis=-1)
    step: Array = np.full(f.shape, np.nan)
    truncated = finite
    if rcond is None:
        rcond = 1e-13
        with np.errstate(all="ignore"):
            # `solve` refuses the whole batch for one zero pivot, which is where `det`, from the same LU, is 0
            regular = finite & (np.linalg.det(jacobian) != 0.0)
            step[regular] = -np.linalg.solve(jacobian[regular], f[regular][..., None])[..., 0]
        truncated = finite & ~regular
    if truncated.any():
        inverse = np.linalg.pinv(jacobian[truncated], rcond=rcond)
        step[truncated] = -np.matmul(inverse, f[truncated][..., None])[..., 0]
    return step


def _line_search(
    function: Residual,
    state: tuple[Array, Array, Array, Array],
    active: NDArray[np.intp],
    step: Array,
    tolerance: float,
    halvings: int,
) -> NDArray[np.bool_]:
    """Take the step in place, halved while it does not reduce the residual; True for the members that moved.

    Members within the tolerance are only offered the full step: below it the residual is rounding, not a measure.
    """
    x, f, jacobian, norm = state
    moved = np.zeros(active.size, dtype=bool)
    todo = np.arange(active.size)
    scale = 1.0
    for _ in range(halvings + 1):
        index = active[todo]
        trial = x[index] + scale * step[todo]
        f_new, jacobian_new = function(trial, index)
        norm_new = np.abs(f_new).max(axis=-1)
        better = norm_new < norm[index]
        taken = index[better]
        x[taken], f[taken], jacobian[taken], norm[taken] = (
            trial[better],
            f_new[better],
            jacobian_new[better],
            norm_new[better],
        )
        moved[todo[better]] = True
        todo = todo[~better & (norm[index] > tolerance)]
        if todo.size == 0:
            break
        scale *= 0.5
    return moved
