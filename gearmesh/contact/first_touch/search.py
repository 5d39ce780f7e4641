"""Search from samples whose advance is above the solved contact: the exact advance there, followed to its maximum.

The search assumes no tangency: a point of the pinion meets the gear's flank where its circle about the gear's axis does.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.meshing import Conditions, Flank, Touch
from gearmesh.contact.conditions.refinement import EDGE_SLACK, Contacts, Trial, advances_of, margins, refine_candidates
from gearmesh.contact.pair import EDGE_CORNER, Pair
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.surface import Jet
from gearmesh.records import dataclass
from gearmesh.teeth.mount import Mount

#: advance of a sample over the solved contact above which the search starts (0.01 arcsec)
UNSEEN_LEAD_RAD = 5e-8
#: steps of the search at most
MAX_CLIMBS = 40
#: first step, by the size of the flank
FIRST_STEP = 0.04
#: step by the step before, where no step rises
STEP_SHRINKAGE = 0.4
#: last step by the first step
LEAST_STEP = 1e-7
#: sizes of steps that are tried at once at most
MAX_STEP_SIZES = 6
#: places that are tried at once at most
MAX_TRIED_PLACES = 512
#: difference (rad) between a climbed maximum and its solution: climbing may stand outside an edge by the edge's slack
CLIMBING_SLACK_RAD = 2e-8


def refine_missed(
    pair: Pair, phi1: Array, position: NDArray[np.intp], x: Array, contacts: Contacts, number: int
) -> None:
    """Find the exact contact at positions (M,) whose places x (M, 5) seem to be ahead of the solved contact."""
    conditions = Conditions(pair.flanks, phi1, pair.length)
    x, advance = circle_contacts(pair, conditions, position, x)
    worth = np.flatnonzero(advance > contacts.advance[position] + UNSEEN_LEAD_RAD)
    if not worth.size:
        return
    position = position[worth]
    x, advance = _climb(pair, conditions, position, x[worth], advance[worth])
    trial = Trial.of(position, x, np.full((len(position), 2), -1))
    trial.edges[:, 0], trial.residual[:] = EDGE_CORNER, 0.0
    better = np.flatnonzero(advance > contacts.advance[position])
    trial.give(contacts, position[better], better, number, advance[better])
    # solve for the maximum as contact inside the flanks or on an edge
    numbers = [-1, *pair.edges]
    edges = np.full((len(numbers) * len(position), 2), -1)
    edges[:, 0] = np.repeat(numbers, len(position))
    again = Trial.of(np.tile(position, len(numbers)), np.tile(x, (len(numbers), 1)), edges)
    contacts.advance[position] -= CLIMBING_SLACK_RAD
    refine_candidates(pair, phi1, again, contacts, number)
    kept = position[contacts.edges[position, 0] == EDGE_CORNER]
    contacts.advance[kept] += CLIMBING_SLACK_RAD


def _climb(
    pair: Pair, conditions: Conditions, position: NDArray[np.intp], x: Array, advance: Array
) -> tuple[Array, Array]:
    """Follow places x (M, 5) with advances (M,), rad, upwards over points on both flanks while the advances rise."""
    # steps in eight directions over the pinion's parameters
    steps = FIRST_STEP * np.ptp(pair.pinion.grid.reshape(-1, 2), axis=0)
    size, climbs = np.ones(len(position)), np.zeros(len(position), dtype=np.intp)
    directions = np.array([(a, b) for a in (-1.0, 0.0, 1.0) for b in (-1.0, 0.0, 1.0) if (a, b) != (0.0, 0.0)])
    while (going := np.flatnonzero((size > LEAST_STEP) & (climbs < MAX_CLIMBS))).size:
        # try several shrinking steps at once while positions are few; the largest step that rises counts
        count = max(1, min(MAX_STEP_SIZES, MAX_TRIED_PLACES // (len(directions) * going.size)))
        sizes = np.multiply.accumulate(
            np.insert(np.full((going.size, count), STEP_SHRINKAGE), 0, size[going], axis=1), axis=1
        )
        start = np.repeat(x[going], count * len(directions), axis=0)
        start[:, :2] += (sizes[:, :-1, None, None] * directions * steps).reshape(-1, 2)
        tried, tried_advances = circle_contacts(
            pair, conditions, np.repeat(position[going], count * len(directions)), start
        )
        tried_advances, tried = (
            tried_advances.reshape(-1, count, len(directions)),
            tried.reshape(-1, count, len(directions), 5),
        )
        higher = tried_advances.max(axis=2) > advance[going, None]
        higher &= (sizes[:, :-1] > LEAST_STEP) & (climbs[going, None] + np.arange(count) < MAX_CLIMBS)
        rises, first, rows = higher.any(axis=1), higher.argmax(axis=1), np.arange(going.size)
        best = tried_advances[rows, first].argmax(axis=1)
        up = going[rises]
        x[up], advance[up] = tried[rows, first, best][rises], tried_advances[rows, first, best][rises]
        size[going] = np.where(rises, sizes[rows, first], sizes[:, -1])
        climbs[going] += np.where(rises, first + 1, count)
    return x, advance


def circle_contacts(pair: Pair, conditions: Conditions, position: NDArray[np.intp], x: Array) -> tuple[Array, Array]:
    """Solve for the meeting of circles through the pinion's points of x (M, 5) with the gear's flank.

    Returns unknowns (M, 5) and advances (M,), rad, -inf for points that are not on both flanks or do not face the gear.
    """
    circles = _Circles.through(conditions, position, x)
    free = np.array([2, 3, 4])
    solution = newton.solve(
        circles, x[:, free], tolerance=pair.tolerance, max_step=pair.max_step[free], max_iterations=12, halvings=3
    )
    whole = x.copy()
    whole[:, free] = solution.values
    touch = circles.touch(solution.values, np.arange(len(x)))
    outside, past = margins(pair, touch, whole)
    good = solution.converged & (outside <= EDGE_SLACK).all(axis=1) & (past <= EDGE_SLACK)
    good &= dot(touch.fixed[0].n, touch.fixed[1].n) < 0.0
    advance = advances_of(pair, conditions.phi1, whole, position)
    return whole, np.where(good, advance, -np.inf)


@dataclass(frozen=True)
class _Circles:
    """Circles of M points of the pinion about the gear's axis; unknowns are the gear's parameters and phi2."""

    #: rotations (M,) of the pinion, rad
    phi1: Array
    #: jets (M,) of the points in the pinion's frame
    own: Jet
    #: jets (M,) of the points in the fixed frame
    fixed: Jet
    #: rotations from the pinion's frame to the fixed frame
    turns: Array
    #: flank of the gear
    flank: Flank
    #: mounts of the gear
    mount: Mount

    @staticmethod
    def through(conditions: Conditions, position: NDArray[np.intp], x: Array) -> _Circles:
        """Return the circles through the pinion's points of x (M, 5) at positions (M,)."""
        (pinion, gear), (first, second) = conditions.flanks, conditions.mounts(position)
        own, phi1 = pinion.surface.jet(x[:, 0], x[:, 1]), conditions.phi1[position]
        placed = first.at(phi1)
        return _Circles(phi1, own, own.move(placed), placed.rotation, gear, second)

    def touch(self, y: Array, index: NDArray[np.intp]) -> Touch:
        """Return both flanks at the gear's parameters and phi2 (K, 3) of points `index` (K,)."""
        own = self.flank.surface.jet(y[:, 0], y[:, 1])
        placed = self.mount.rows(index).at(y[:, 2])
        turns = self.turns if self.turns.ndim == 2 else self.turns[index]
        return Touch(
            self.phi1[index],
            (self.own[index], own),
            (self.fixed[index], own.move(placed)),
            (turns, placed.rotation),
        )

    def __call__(self, y: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
        """Return residuals (K, 3), mm, and Jacobians (K, 3, 3) of the points `index` (K,)."""
        mount = self.mount.rows(index)
        two = self.flank.surface.jet(y[:, 0], y[:, 1]).move(mount.at(y[:, 2]))
        return self.fixed.r[index] - two.r, -np.stack((two.r_u, two.r_v, mount.velocity(two.r)), axis=-1)
