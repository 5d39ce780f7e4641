"""Contact as a complementarity problem: find the pressures and the rotation under a given torque.

A cell has area a, gap g and lever l. C maps pressures p to displacements. The conditions are

    p >= 0,    w = g + C p - theta l >= 0,    p w = 0,    sum of p a l = torque

w is the gap under load: it is 0 where cells touch, and pressure is 0 where they do not.

These are the conditions for the least energy, sum of a p (g + C p / 2), of all pressures that carry the torque; theta is its
multiplier. An elastic compliance is symmetric and positive definite, so there is one solution, the physical one.

Conjugate gradients solve for the pressures of the touching cells [PK99]. The set of touching cells changes when a
pressure falls below zero or when bodies overlap. Three things are added to [PK99]: levers, cells of unequal area, and a
batch of independent problems. Cells of one problem may differ in size by a factor of 20, and w is proportional to the
cell size. Steps therefore use w divided by the deflection of a cell under its own pressure.

Sources: [PK99] I. A. Polonsky, L. M. Keer, Wear 231 (1999) 206. [PR69] E. Polak, G. Ribiere, Rev. Fr. Inform. Rech. Oper.
16 (1969) 35.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields, replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import Status
from gearmesh.kernel.numeric.algebra import Array

#: convergence: area-weighted change of the pressures in a step over the sum of the pressures
PRESSURE_TOLERANCE = 1e-7
#: residual over the largest displacement; a larger residual means no convergence
MAX_RELATIVE_RESIDUAL = 1e-4
#: largest number of steps; 30 to 60 are usual
MAX_STEPS = 600
#: steps after which directions begin anew whenever cells begin or cease to touch: a cell may do both in turns for ever
FREE_STEPS = 40
#: convergence of the tangent: residual over the levers; the error of the stiffness is its square
TANGENT_TOLERANCE = 1e-4

#: least square of a descent that gives a conjugate direction: smaller ones are mere rounding
LEAST_DESCENT = 1e-100
#: smallest normal number: keeps divisions finite
SMALLEST_FLOAT = np.finfo(float).tiny
#: Displacements (B, N) under pressures (B, N) of the problems with these indices (B,)
Displacements = Callable[[Array, NDArray[np.intp]], Array]


@dataclass(frozen=True)
class Pressures:
    """Solution of B contact problems with N cells each."""

    #: pressures (B, N), MPa
    pressure: Array
    #: rotations theta (B,), rad
    rotation: Array
    #: residuals (B,), mm: the larger of |w| at cells under pressure and overlap at cells without pressure
    residual: Array
    #: codes (B,) of `errors.Status`
    status: NDArray[np.int64]
    #: steps that the slowest problem took
    steps: int

    @staticmethod
    def empty(problems: int, cells: int) -> Pressures:
        """Return room for the solutions of problems with a number of cells each."""
        return Pressures(
            np.zeros((problems, cells)), np.zeros(problems), np.zeros(problems), np.zeros(problems, dtype=np.int64), 0
        )

    def copy(self) -> Pressures:
        """Return the solution with arrays of its own."""
        return Pressures(
            self.pressure.copy(), self.rotation.copy(), self.residual.copy(), self.status.copy(), self.steps
        )

    def replaced(self, which: NDArray[np.intp], part: Pressures) -> Pressures:
        """Return the solution with that of the problems `which` (B,) replaced by `part`."""
        whole = self.copy()
        whole.pressure[which], whole.rotation[which] = part.pressure, part.rotation
        whole.residual[which], whole.status[which] = part.residual, part.status
        return replace(whole, steps=max(self.steps, part.steps))


def pressures(
    moved: Displacements,
    gap: Array,
    lever: Array,
    area: Array,
    on: NDArray[np.bool_],
    torque: Array,
    start: Array,
    ease: Array | None = None,
    precondition: Displacements | None = None,
    tolerance: float = PRESSURE_TOLERANCE,
) -> Pressures:
    """Solve B contact problems of N cells for their pressures.

    - `moved`: displacements under pressures.
    - `gap`, `lever` (B, N), mm; `area` (B, N), mm^2.
    - `on` (B, N): True for cells that may touch.
    - `torque` (B,), N mm, above 0.
    - `start` (B, N): initial pressures, above 0 in some cell that is `on`.
    - `ease` (B, N): deflection of each cell under unit pressure on that cell alone, up to a factor; equal for all by
      default.
    - `precondition`: pressures, up to a factor, under which all cells would move by given displacements: a symmetric
      estimate of C^-1; displacements over `ease` by default.
    - `tolerance`: change of the pressures in a step, as `PRESSURE_TOLERANCE`, with which a problem has converged.
    """
    weight, levers = np.where(on, area, 0.0), np.where(on, lever, 0.0)
    cell_ease = np.ones_like(weight) if ease is None else ease
    estimated = precondition or (lambda displacement, which: displacement / cell_ease[which])
    every = np.arange(len(gap))
    # initial pressures, scaled to the torque
    p = np.where(on, start, 0.0)
    p *= (torque / (weight * levers * p).sum(axis=1))[:, None]
    status = np.full(len(p), int(Status.MAX_ITERATIONS))
    u = moved(p, every)
    stride = (weight * p).sum(axis=1) / (weight * np.abs(u) / cell_ease).sum(axis=1)
    # `own` has the values of the active problems, which are copied only when some have converged
    own = _Steps.of(gap, weight, levers, cell_ease, on, torque, p, u, stride)
    active, steps = every, 0
    while active.size and steps < MAX_STEPS:
        steps += 1
        pressure, touching = own.pressure, own.pressure > 0.0
        inner = own.area * touching
        inner_lever = inner * own.lever
        # gap under load w, with the theta for which the descent carries no torque
        w = own.gap + own.u
        stale = np.flatnonzero(own.restarts)
        if stale.size:
            # pressures of touching cells for a unit rotation, by the estimate
            stale_levers = np.where(touching[stale], own.lever[stale], 0.0)
            own.of_levers[stale] = touching[stale] * estimated(stale_levers, active[stale])
        estimate, lever_estimate = touching * estimated(np.where(touching, w, 0.0), active), own.of_levers
        theta = _sums(inner_lever, estimate) / _sums(inner_lever, lever_estimate)
        w -= own.lever * theta[:, None]
        descent = estimate - lever_estimate * theta[:, None]
        # conjugate direction d: the share of the last one [PR69] falls to 0 by itself where the touching cells have changed
        # much
        inner_gap = inner * w
        descent_size = _sums(inner_gap, descent)
        gained = descent_size - _sums(inner, own.last_gap, descent)
        known = own.last_size > LEAST_DESCENT
        conjugate_share = np.divide(np.maximum(gained, 0.0), own.last_size, out=np.zeros_like(gained), where=known)
        if steps > FREE_STEPS:
            conjugate_share[own.restarts] = 0.0
        own.last_size, own.last_gap = descent_size, w
        d = own.direction
        d *= conjugate_share[:, None]
        d += descent
        d *= touching
        response = moved(d, active)
        curvature = _sums(inner, response, d)
        # a single touching cell has no descent direction (curvature 0): overlapping cells then use the step length of
        # before
        convex = curvature > 0.0
        own.stride[convex] = _sums(inner_gap, d)[convex] / curvature[convex]
        step = own.stride[:, None]
        # step; cells whose pressure falls below zero separate, and cells that overlap begin to touch
        moved_on = pressure - step * d
        new = np.where(touching, np.maximum(moved_on, 0.0), 0.0)
        overlap = own.on & (new == 0.0) & (w < 0.0)
        new = np.where(overlap, -step * w / own.ease, new)
        carried_torque = _sums(own.area, own.lever, new)
        # a step that separates every cell is too long: keep the pressures and halve the step
        separated = carried_torque <= 0.0
        own.stride[separated] *= 0.5
        scale = (own.torque / np.where(separated, 1.0, carried_torque))[:, None]
        opened = touching & (new == 0.0)
        changed = (overlap | opened).any(axis=1) | separated
        # what cells that begin or cease to touch add to the step
        mended = np.flatnonzero(changed & ~separated)
        excess = new[mended] - moved_on[mended]
        new *= scale
        # displacements are linear in the step
        response *= step
        u = (own.u - response) * scale
        if separated.any():
            new[separated], u[separated] = pressure[separated], own.u[separated]
        own.u = u
        if mended.size:
            own.u[mended] += scale[mended] * moved(excess, active[mended])
        own.restarts, own.pressure = changed, new
        change = _sums(own.area, np.abs(new - pressure)) / _sums(own.area, new)
        converged = (change < tolerance) & ~overlap.any(axis=1) & ~separated
        if converged.any():
            status[active[converged]] = Status.CONVERGED
            p[active[converged]] = new[converged]
            own, active = own.some(~converged), active[~converged]
    p[active] = own.pressure
    u = moved(p, every)
    # theta and residual of the answers
    inner = weight * (p > 0.0)
    theta = (inner * levers * (gap + u)).sum(axis=1) / (inner * levers**2).sum(axis=1)
    w = gap + u - levers * theta[:, None]
    residual = np.where(p > 0.0, np.abs(w), np.where(on, np.maximum(-w, 0.0), 0.0)).max(axis=1)
    status[residual > MAX_RELATIVE_RESIDUAL * np.abs(u).max(axis=1)] = Status.MAX_ITERATIONS
    return Pressures(p, theta, residual, status, steps)


@dataclass
class _Steps:
    """Values of B problems with N cells between two steps, (B, N) by cell, else (B,)."""

    gap: Array
    area: Array
    lever: Array
    ease: Array
    on: NDArray[np.bool_]
    torque: Array
    pressure: Array
    #: displacements under the pressures
    u: Array
    #: lengths of the last steps
    stride: Array
    #: last directions
    direction: Array
    #: gaps under load, and sizes of the descent, in the last step
    last_gap: Array
    last_size: Array
    #: estimated pressures under a unit rotation
    of_levers: Array
    #: problems whose touching cells have changed
    restarts: NDArray[np.bool_]

    @staticmethod
    def of(
        gap: Array,
        area: Array,
        lever: Array,
        ease: Array,
        on: NDArray[np.bool_],
        torque: Array,
        pressure: Array,
        u: Array,
        stride: Array,
    ) -> _Steps:
        """Return the problems before their first step."""
        directions, last_gaps, of_levers = (np.zeros_like(pressure) for _ in range(3))
        count = len(pressure)
        known = gap, area, lever, ease, on, np.broadcast_to(torque, count), pressure, u, stride
        return _Steps(*known, directions, last_gaps, np.zeros(count), of_levers, np.ones(count, dtype=bool))

    def some(self, kept: NDArray[np.bool_]) -> _Steps:
        """Return the problems that are `kept` (B,)."""
        return _Steps(*(getattr(self, each.name)[kept] for each in fields(self)))


def _sums(*values: Array) -> Array:
    """Return the sums (B,) over the cells of products of values (B, N)."""
    names = ",".join("bn" for _ in values)
    sums: Array = np.einsum(f"{names}->b", *values)
    return sums


def tangent_stiffness(
    moved: Displacements,
    lever: Array,
    area: Array,
    touching: NDArray[np.bool_],
    start: Array,
    precondition: Displacements | None = None,
) -> tuple[Array, NDArray[np.int64]]:
    """Compute the tangent stiffness (B,), torque over rotation in N mm/rad, of solved problems, and their status (B,).

    `touching` (B, N) is the set of touching cells, which is held fixed. The rate of pressure q solves C q = lever on
    them, and the stiffness is the sum of q a lever. It is the stationary value of a quadratic form, so that about 25
    steps of conjugate gradients suffice, 10 with the estimate `precondition` of `pressures`. `start` (B, N): an estimate
    of q, MPa/rad, up to a factor. Status codes are those of `errors.Status`.
    """
    weight = np.where(touching, area, 0.0)
    every = np.arange(len(lever))
    q = np.where(touching, start, 0.0)
    response = moved(q, every)
    # scale the estimate to its best multiple
    q = q * ((weight * lever * q).sum(axis=1) / (weight * response * q).sum(axis=1))[:, None]
    residual = np.where(touching, lever - moved(q, every), 0.0)
    estimated = precondition or (lambda displacement, which: displacement)
    largest_size = TANGENT_TOLERANCE**2 * (weight * lever**2).sum(axis=1)
    descent = touching * estimated(residual, every)
    descent_size = (weight * residual * descent).sum(axis=1)
    direction, status = descent, np.full(len(q), int(Status.MAX_ITERATIONS))
    active, steps = every, 0
    # conjugate gradients on the touching cells
    while active.size and steps < MAX_STEPS:
        steps += 1
        d = direction[active]
        response = moved(d, active)
        step = descent_size[active] / np.maximum((weight[active] * response * d).sum(axis=1), SMALLEST_FLOAT)
        q[active] += step[:, None] * d
        residual[active] -= step[:, None] * np.where(touching[active], response, 0.0)
        descent = touching[active] * estimated(residual[active], active)
        new = (weight[active] * residual[active] * descent).sum(axis=1)
        conjugate_share = new / np.maximum(descent_size[active], SMALLEST_FLOAT)
        direction[active], descent_size[active] = descent + conjugate_share[:, None] * d, new
        converged = (weight[active] * residual[active] ** 2).sum(axis=1) <= largest_size[active]
        status[active[converged]] = Status.CONVERGED
        active = active[~converged]
    # stationary value of the quadratic form: its error is the square of the error of q
    stiffness: Array = (weight * q * (lever + residual)).sum(axis=1)
    return stiffness, status
