"""Events in a mesh: a contact reaches an edge, a line of contact its end, one tooth pair overtakes another.

Each is a root in phi1, of the first kinds found together with the contact itself by Newton.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.meshing import Conditions
from gearmesh.contact.pair import Pair
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, dot

#: steps after which a root between two ends is as good as it gets; rad that it need not be closer; parts of a bracket, and places
#: about the secant's root, in brackets
STEPS, TOLERANCE, PARTS = 60, 1e-12, 16
NEAR = np.array([-1e-2, -1e-3, -1e-4, -1e-6, 0.0, 1e-6, 1e-4, 1e-3, 1e-2])


@dataclass(frozen=True)
class Events:
    """Rotations phi1 (M,), rad, of the pinion, the unknowns x (M, 5) there, and whether each was `reached` (M,)."""

    phi1: Array
    x: Array
    reached: NDArray[np.bool_]


def reaches(pair: Pair, conditions: Conditions, edge: NDArray[np.intp], x: Array) -> Events:
    """Where contacts with the given conditions (M,) reach edges (M,), numbers in `Pair.bounds`, from starts x (M, 5) near it."""
    limits = np.append(pair.max_step, 0.2)

    def residual(y: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
        there = replace(conditions.repeat(index), phi1=y[:, 5])
        f, whole = np.empty((len(y), 6)), np.zeros((len(y), 6, 6))
        at, f[:, :5], whole[:, :5, :5], whole[:, :5, 5] = there.with_phi1(y[:, :5], np.arange(len(y)))
        for number in np.unique(edge[index]):
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
    value: Callable[[Array], tuple[Array, Array]], low: float, high: float, tolerance: float = TOLERANCE
) -> float:
    """Root (rad), to `tolerance` or better, between `low` and `high` of a function that gives values (N,) and slopes (N,) and
    changes its sign there.

    Newton within the bracket as long as it gains a digit a step; where it does not, or there is no slope, many places are taken at
    once, most of them about the secant's root, for many cost little more than one.
    """
    places = np.array([low, 0.5 * (low + high), high])
    ends = np.full(2, np.nan)
    last = np.inf
    for _ in range(STEPS):
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
            about, fall = np.linspace(0.0, 1.0, PARTS + 1), ends[0] - ends[1]
            # of a function that is flat but for rounding there is no secant
            if fall != 0.0:
                about = np.concatenate((about, np.clip(ends[0] / fall + NEAR, 0.0, 1.0)))
            places = np.unique(low + about * (high - low))
        last = abs(f[k])
    return 0.5 * (low + high)
