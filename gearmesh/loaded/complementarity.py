"""Contact as a complementarity problem: pressure where bodies touch, none where they do not, and one rotation for a given torque.

Of cells with areas a, gaps g and levers l, with C the displacements under pressures,

    p >= 0,    w = g + C p - theta l >= 0,    p w = 0,    sum of p a l = torque

Solved by conjugate gradients on the cells that touch, which change as pressures fall below zero or bodies overlap [PK99], here with
levers, with areas that differ, and for a batch of problems of their own at once. Some grids of a problem may have cells 20 times
smaller than others, and w in proportion to their size: steps use w over the deflection of a cell under its own pressure. Where a
tip edge begins to touch, the spur sample takes 79 steps so, and more than 600 by w itself.

Source: [PK99] I. A. Polonsky, L. M. Keer, Wear 231 (1999) 206.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import Status
from gearmesh.kernel.numeric.algebra import Array

#: change of pressures in a step over all of them at which an answer counts as found
TOLERANCE = 1e-7
#: residual over the largest displacement above which an answer does not count as found
EXACT = 1e-4
#: steps at most; 40 to 150 are usual
MOST_STEPS = 600
#: residual over the levers at which a tangent counts as found: the stiffness is exact to the square of it
TANGENT = 1e-4

TINY = np.finfo(float).tiny
#: displacements (B, N) under pressures (B, N) of the problems `which` (B,)
Displacements = Callable[[Array, NDArray[np.intp]], Array]


@dataclass(frozen=True)
class Pressures:
    """`pressure` (B, N), MPa; `rotation` (B,): theta, rad; `residual` (B,), mm: largest |w| where there is pressure, and overlap
    where there is none; `status` (B,) of `errors.Status`; `steps` taken by the slowest."""

    pressure: Array
    rotation: Array
    residual: Array
    status: NDArray[np.int64]
    steps: int


def pressures(
    moved: Displacements,
    gap: Array,
    lever: Array,
    area: Array,
    on: NDArray[np.bool_],
    torque: Array,
    start: Array,
    ease: Array | None = None,
) -> Pressures:
    """Solve problems (B,) of cells (N,): `gap`, `lever` (mm), `area` (mm^2), `on` (B, N): whether a cell may touch; `torque` (B,),
    N mm, above 0. `start` (B, N): pressures from where to go, above 0 somewhere `on`; `ease` (B, N): deflection of cells under
    unit pressure on them alone, up to a factor: the same for all if not given."""
    weight, levers = np.where(on, area, 0.0), np.where(on, lever, 0.0)
    eased = np.ones_like(weight) if ease is None else ease
    every = np.arange(len(gap))
    p = np.where(on, start, 0.0)
    p *= (torque / (weight * levers * p).sum(axis=1))[:, None]
    way, before, fresh = np.zeros_like(p), np.ones(len(p)), np.ones(len(p), dtype=bool)
    status = np.full(len(p), int(Status.MAX_ITERATIONS))
    active, steps = every, 0
    u = moved(p, every)
    stride = (weight * p).sum(axis=1) / (weight * np.abs(u) / eased).sum(axis=1)
    while active.size and steps < MOST_STEPS:
        steps += 1
        own, a, lv, soft = p[active], weight[active], levers[active], eased[active]
        touching = own > 0.0
        w = gap[active] + u[active]
        inner = a * touching
        square = (inner * lv * lv / soft).sum(axis=1)
        w = w - lv * ((inner * lv * w / soft).sum(axis=1) / square)[:, None]
        down_hill = w / soft
        size = (inner * w * down_hill).sum(axis=1)
        turn = np.where(fresh[active] | (before[active] == 0.0), 0.0, size / np.maximum(before[active], TINY))
        before[active] = size
        d = np.where(touching, down_hill + turn[:, None] * way[active], 0.0)
        answer = moved(d, active)
        bend = (inner * answer * d).sum(axis=1)
        # of a single cell there is nothing to go down along: those that overlap are pressed by the step before
        down = bend > 0.0
        stride[active[down]] = (inner * w * d).sum(axis=1)[down] / bend[down]
        step = stride[active][:, None]
        new = np.where(touching, np.maximum(own - step * d, 0.0), 0.0)
        overlap = on[active] & (new == 0.0) & (w < 0.0)
        new = np.where(overlap, -step * down_hill, new)
        carried = (a * lv * new).sum(axis=1)
        # a step after which nothing would touch is too long
        lost = carried <= 0.0
        stride[active[lost]] *= 0.5
        scale = (torque[active] / np.where(lost, 1.0, carried))[:, None]
        new = np.where(lost[:, None], own, new * scale)
        dropped = touching & (new == 0.0)
        bent = (overlap | dropped).any(axis=1) | lost
        fresh[active], way[active], p[active] = bent, d, new
        # where no cell began or ceased to touch all is linear in the step
        u[active] = scale * (u[active] - step * answer)
        if bent.any():
            u[active[bent]] = moved(new[bent], active[bent])
        change = (a * np.abs(new - own)).sum(axis=1) / (a * new).sum(axis=1)
        met = (change < TOLERANCE) & ~overlap.any(axis=1) & ~lost
        status[active[met]] = Status.CONVERGED
        active = active[~met]
    u = moved(p, every)
    inner = weight * (p > 0.0)
    theta = (inner * levers * (gap + u)).sum(axis=1) / (inner * levers**2).sum(axis=1)
    w = gap + u - levers * theta[:, None]
    residual = np.where(p > 0.0, np.abs(w), np.where(on, np.maximum(-w, 0.0), 0.0)).max(axis=1)
    status[residual > EXACT * np.abs(u).max(axis=1)] = Status.MAX_ITERATIONS
    return Pressures(p, theta, residual, status, steps)


def tangent_stiffness(
    moved: Displacements, lever: Array, area: Array, touching: NDArray[np.bool_], start: Array
) -> tuple[Array, NDArray[np.int64]]:
    """Torque over rotation (B,), N mm/rad, of a small turn on from an answer, and the status (B,) of `errors.Status`.

    Cells that are `touching` (B, N) go on to do so, and no others come to: C q = lever there, and the stiffness is sum of q a
    lever. It is stationary at the answer: conjugate gradients need not go far, about 25 steps. `start` (B, N): q, MPa/rad, or what
    is about in proportion to it.
    """
    weight = np.where(touching, area, 0.0)
    every = np.arange(len(lever))
    q = np.where(touching, start, 0.0)
    answer = moved(q, every)
    q = q * ((weight * lever * q).sum(axis=1) / (weight * answer * q).sum(axis=1))[:, None]
    rest = np.where(touching, lever - moved(q, every), 0.0)
    size = (weight * rest**2).sum(axis=1)
    wanted = TANGENT**2 * (weight * lever**2).sum(axis=1)
    way, status = rest.copy(), np.full(len(q), int(Status.MAX_ITERATIONS))
    active, steps = every, 0
    while active.size and steps < MOST_STEPS:
        steps += 1
        d = way[active]
        answer = moved(d, active)
        step = size[active] / np.maximum((weight[active] * answer * d).sum(axis=1), TINY)
        q[active] += step[:, None] * d
        rest[active] -= step[:, None] * np.where(touching[active], answer, 0.0)
        new = (weight[active] * rest[active] ** 2).sum(axis=1)
        way[active] = rest[active] + (new / np.maximum(size[active], TINY))[:, None] * d
        size[active] = new
        met = new <= wanted[active]
        status[active[met]] = Status.CONVERGED
        active = active[~met]
    # the quadratic form whose greatest value the stiffness is
    stiffness: Array = (weight * q * (lever + rest)).sum(axis=1)
    return stiffness, status
