"""Batched damped Newton for small systems, and bracketed Newton for one unknown, each with a status per member."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import Status
from gearmesh.frames import Array

Residual = Callable[[Array, NDArray[np.intp]], tuple[Array, Array]]


@dataclass(frozen=True)
class Solution:
    """Unknowns x (N, k), Status codes (N,), residual norms (N,) and the number of iterations used."""

    x: Array
    status: NDArray[np.int64]
    residual: Array
    iterations: int

    @property
    def converged(self) -> NDArray[np.bool_]:
        return self.status == Status.CONVERGED


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
    """Solve function(x) = 0 for a batch of N independent systems of k unknowns.

    `function(x, index)` gets the unknowns (M, k) of the members `index` (M,) still being worked on and returns
    residuals (M, k) and Jacobians (M, k, k), in units that make `tolerance` (on the largest component) meaningful.
    Steps are limited componentwise to `max_step` (k,) and halved, up to `halvings` times, while the residual does
    not decrease; a member whose residual then still grows keeps its place and may never converge. With `rcond` the step is the least-norm one of the truncated pseudo-inverse, so that systems with a
    consistent null space (line contact) converge to the solution nearest the start instead of running away along it.
    Iteration goes on once after the tolerance is met, for the last digits that Newton gives for free.
    """
    x = np.array(start, dtype=float)
    count = x.shape[0]
    status = np.full(count, int(Status.MAX_ITERATIONS))
    active = np.arange(count)
    if count == 0:
        return Solution(x, status, np.zeros(0), 0)
    f, jacobian = function(x, active)
    norm = np.abs(f).max(axis=-1)
    polished = np.zeros(count, dtype=bool)
    iteration = 0
    for iteration in range(1, max_iterations + 1):
        step = _newton_step(f[active], jacobian[active], rcond)
        bad = ~np.isfinite(step).all(axis=-1)
        status[active[bad]] = np.where(np.isfinite(norm[active[bad]]), Status.SINGULAR, Status.NOT_FINITE)
        active, step = active[~bad], step[~bad]
        if max_step is not None and active.size:
            ratio = np.abs(step / max_step).max(axis=-1)
            step = step / np.maximum(ratio, 1.0)[:, None]
        met = norm[active] <= tolerance
        polished[active] |= met
        _line_search(function, x, f, jacobian, norm, active, step, halvings)
        status[active[(norm[active] <= tolerance)]] = Status.CONVERGED
        active = active[~(polished[active] & (norm[active] <= tolerance))]
        if active.size == 0:
            break
    return Solution(x, status, norm, iteration)


def _newton_step(f: Array, jacobian: Array, rcond: float | None) -> Array:
    if rcond is None:
        with np.errstate(all="ignore"):
            try:
                return -np.linalg.solve(jacobian, f[..., None])[..., 0]
            except np.linalg.LinAlgError:
                rcond = 1e-13
    finite = np.isfinite(jacobian).all(axis=(-1, -2)) & np.isfinite(f).all(axis=-1)
    step = np.full_like(f, np.nan)
    if finite.any():
        step[finite] = -np.matmul(np.linalg.pinv(jacobian[finite], rcond=rcond), f[finite][..., None])[..., 0]
    return step


def _line_search(
    function: Residual,
    x: Array,
    f: Array,
    jacobian: Array,
    norm: Array,
    active: NDArray[np.intp],
    step: Array,
    halvings: int,
) -> None:
    """Take the step in place, halved while it does not reduce the residual; where nothing does, stay."""
    scale = 1.0
    todo, todo_step = active, step
    for _ in range(halvings + 1):
        if todo.size == 0:
            return
        trial = x[todo] + scale * todo_step
        f_new, jacobian_new = function(trial, todo)
        norm_new = np.abs(f_new).max(axis=-1)
        better = norm_new < norm[todo]
        taken = todo[better]
        x[taken], f[taken], jacobian[taken], norm[taken] = (
            trial[better],
            f_new[better],
            jacobian_new[better],
            norm_new[better],
        )
        todo, todo_step = todo[~better], todo_step[~better]
        # a residual already at rounding level cannot be reduced further
        todo_step = todo_step[norm[todo] > 1e-14]
        todo = todo[norm[todo] > 1e-14]
        scale *= 0.5


def bracketed_root(
    function: Callable[[Array], tuple[Array, Array]], low: Array, high: Array, *, tolerance: float, max_iterations: int = 80
) -> tuple[Array, NDArray[np.int64]]:
    """Roots (N,) of function(x) -> (value, derivative) between `low` and `high` (N,): Newton, guarded by bisection.

    Returns the roots and a Status each; members whose values at the ends have the same sign are NO_CONTACT.
    """
    low, high = np.array(low, dtype=float), np.array(high, dtype=float)
    f_low, f_high = function(low)[0], function(high)[0]
    status = np.where(f_low * f_high <= 0.0, int(Status.MAX_ITERATIONS), int(Status.NO_CONTACT))
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
        status = np.where(done & (status == Status.MAX_ITERATIONS), int(Status.CONVERGED), status)
        if not (status == Status.MAX_ITERATIONS).any():
            break
    return x, status
