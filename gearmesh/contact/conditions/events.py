"""Events in a mesh: a contact reaches an edge, a contact line reaches its end, one tooth pair overtakes another.

Each event is a root in phi1. Newton's method solves for phi1 and the contact together in the first two kinds.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.meshing import Conditions
from gearmesh.contact.pair import Pair
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, distinct, dot
from gearmesh.records import dataclass

#: steps of a bracketed root at most
MAX_STEPS = 60
#: error (rad) of a root
ROOT_TOLERANCE_RAD = 1e-12
#: parts of a bracket in one step without Newton
PARTS_PER_STEP = 16
#: places about the root of the secant, by the bracket
PLACES_NEAR_SECANT = np.array([-1e-2, -1e-3, -1e-4, -1e-6, 0.0, 1e-6, 1e-4, 1e-3, 1e-2])


@dataclass(frozen=True)
class Events:
    """Rotations phi1 (M,), rad, of the pinion at events, unknowns x (M, 5), and True in `reached` (M,) for found roots."""

    phi1: Array
    x: Array
    reached: NDArray[np.bool_]


def reaches(pair: Pair, conditions: Conditions, edge: NDArray[np.intp], x: Array) -> Events:
    """Solve for phi1 at which contacts with `conditions` (M,) reach edges (M,), numbers in `Pair.bounds`, from starts x (M, 5)."""
    limits = np.append(pair.max_step, 0.2)

    def residual(y: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
        there = replace(conditions.repeat(index), phi1=y[:, 5])
        f, whole = np.empty((len(y), 6)), np.zeros((len(y), 6, 6))
        at, f[:, :5], whole[:, :5, :5], whole[:, :5, 5] = there.with_phi1(y[:, :5], np.arange(len(y)))
        for number in distinct(edge[index]):
            bound, own = pair.bounds[number], np.flatnonzero(edge[index] == number)
            assert bound is not None
            jet = at.own[bound.member][own]
            gradient = bound.level.gradient(jet.r)
            whole[own, 5, 2 * bound.member] = dot(gradient, jet.r_u)
            whole[own, 5, 2 * bound.member + 1] = dot(gradient, jet.r_v)
            f[own, 5] = bound.level.value(jet.r)
        return f, whole

    solution = newton.solve(residual, np.column_stack((x, conditions.phi1)), tolerance=pair.tolerance, max_step=limits)
    return Events(solution.values[:, 5], solution.values[:, :5], solution.converged)


def root_between(
    value: Callable[[Array], tuple[Array, Array]], low: float, high: float, tolerance: float = ROOT_TOLERANCE_RAD
) -> float:
    """Solve for the root (rad) between `low` and `high` of a function with values (N,) and slopes (N,), to `tolerance` or better.

    Newton steps inside the bracket continue while each step gains a digit. Otherwise, and without a slope, one call evaluates many
    places, most of them near the root of the secant: a batch costs little more than one place.
    """
    places = np.array([low, 0.5 * (low + high), high])
    ends = np.full(2, np.nan)
    last = np.inf
    for _ in range(MAX_STEPS):
        f, slope = value(places)
        if len(f) > 1:
            change = int(np.argmax(np.sign(f[1:]) != np.sign(f[0])))
            low, high, ends = places[change], places[change + 1], f[change : change + 2]
        elif np.sign(f[0]) == np.sign(ends[0]):
            low, ends = places[0], np.array([f[0], ends[1]])
        else:
            high, ends = places[0], np.array([ends[0], f[0]])
        k = int(np.abs(f).argmin())
        if abs(f[k]) <= 1e-15 or high - low <= tolerance:
            return float(places[k])
        with np.errstate(all="ignore"):
            following = places[k] - f[k] / slope[k]
        if low <= following <= high and abs(f[k]) < 0.1 * last:
            if abs(following - places[k]) <= tolerance:
                return float(following)
            places = np.array([following])
        else:
            about, fall = np.linspace(0.0, 1.0, PARTS_PER_STEP + 1), ends[0] - ends[1]
            # a function that is flat to rounding has no secant
            if fall != 0.0:
                about = np.concatenate((about, np.clip(ends[0] / fall + PLACES_NEAR_SECANT, 0.0, 1.0)))
            places = distinct(low + about * (high - low))
        last = abs(f[k])
    return 0.5 * (low + high)
