"""Where a sampled advance is above what was solved for: what is there really, followed to where it is greatest.

Nothing is taken for tangent here: a point of one flank meets the other where its circle about the gear's axis does.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.meshing import Conditions, Flank, Touch
from gearmesh.contact.conditions.refinement import EDGE_SLACK, Contacts, Trial, advances_of, margins, refine_candidates
from gearmesh.contact.pair import CORNER, Pair
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.surface import Jet
from gearmesh.teeth.mount import Mount

#: an advance sampled this far (rad; 0.01 arcsec) above what was found is looked into
UNSEEN = 5e-8
#: steps of the search for it at most, the share of the flank that the first of them are, how they shrink, and what part of the
#: first the last is at least
CLIMBS, FIRST_STEP, SHRINK, LEAST_STEP = 40, 0.04, 0.4, 1e-7
#: sizes of steps, and places, that are tried at once at most
SIZES, AT_ONCE = 6, 512
#: by how much (rad) what is solved for may come short of a summit that was climbed: climbing may stand outside an edge by its slack
SUMMIT = 2e-8


def refine_missed(
    pair: Pair, phi1: Array, position: NDArray[np.intp], x: Array, contacts: Contacts, number: int
) -> None:
    """Positions (M,) at which places x (M, 5) seem to be further ahead than what was found: what they really do, and why."""
    conditions = Conditions(pair.flanks, phi1, pair.length)
    x, advance = circle_contacts(pair, conditions, position, x)
    worth = np.flatnonzero(advance > contacts.advance[position] + UNSEEN)
    if not worth.size:
        return
    position = position[worth]
    x, advance = _climb(pair, conditions, position, x[worth], advance[worth])
    trial = Trial.of(position, x, np.full((len(position), 2), -1))
    trial.edges[:, 0], trial.residual[:] = CORNER, 0.0
    better = np.flatnonzero(advance > contacts.advance[position])
    trial.give(contacts, position[better], better, number, advance[better])
    # a summit inside the flanks, or on an edge, is solved for as such
    numbers = [-1, *pair.edges]
    edges = np.full((len(numbers) * len(position), 2), -1)
    edges[:, 0] = np.repeat(numbers, len(position))
    again = Trial.of(np.tile(position, len(numbers)), np.tile(x, (len(numbers), 1)), edges)
    contacts.advance[position] -= SUMMIT
    refine_candidates(pair, phi1, again, contacts, number)
    kept = position[contacts.edges[position, 0] == CORNER]
    contacts.advance[kept] += SUMMIT


def _climb(
    pair: Pair, conditions: Conditions, position: NDArray[np.intp], x: Array, advance: Array
) -> tuple[Array, Array]:
    """Places x (M, 5) with advances (M,), followed upwards over points that both flanks have as long as the advances rise."""
    steps = FIRST_STEP * np.ptp(pair.pinion.grid.reshape(-1, 2), axis=0)
    size, climbs = np.ones(len(position)), np.zeros(len(position), dtype=np.intp)
    ways = np.array([(a, b) for a in (-1.0, 0.0, 1.0) for b in (-1.0, 0.0, 1.0) if (a, b) != (0.0, 0.0)])
    while (going := np.flatnonzero((size > LEAST_STEP) & (climbs < CLIMBS))).size:
        # steps that shrink, several sizes at once while positions are few: the largest that rises counts
        count = max(1, min(SIZES, AT_ONCE // (len(ways) * going.size)))
        sizes = np.multiply.accumulate(np.insert(np.full((going.size, count), SHRINK), 0, size[going], axis=1), axis=1)
        start = np.repeat(x[going], count * len(ways), axis=0)
        start[:, :2] += (sizes[:, :-1, None, None] * ways * steps).reshape(-1, 2)
        tried, own = circle_contacts(pair, conditions, np.repeat(position[going], count * len(ways)), start)
        own, tried = own.reshape(-1, count, len(ways)), tried.reshape(-1, count, len(ways), 5)
        higher = own.max(axis=2) > advance[going, None]
        higher &= (sizes[:, :-1] > LEAST_STEP) & (climbs[going, None] + np.arange(count) < CLIMBS)
        rises, first, every = higher.any(axis=1), higher.argmax(axis=1), np.arange(going.size)
        best = own[every, first].argmax(axis=1)
        up = going[rises]
        x[up], advance[up] = tried[every, first, best][rises], own[every, first, best][rises]
        size[going] = np.where(rises, sizes[every, first], sizes[:, -1])
        climbs[going] += np.where(rises, first + 1, count)
    return x, advance


def circle_contacts(pair: Pair, conditions: Conditions, position: NDArray[np.intp], x: Array) -> tuple[Array, Array]:
    """Where the circles through the pinion's points of x (M, 5) meet the gear's flank: unknowns, and advances (M,), -inf where the
    point is not on both flanks or does not face it."""
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
    """Points (M,) of the pinion at rotations phi1 (M,), rad, and what their circles about the gear's axis meet: the gear's flank,
    by its parameters and phi2."""

    phi1: Array
    own: Jet
    fixed: Jet
    turns: Array
    flank: Flank
    mount: Mount

    @staticmethod
    def through(conditions: Conditions, position: NDArray[np.intp], x: Array) -> _Circles:
        """The circles through the pinion's points of x (M, 5) at positions (M,)."""
        (pinion, gear), (first, second) = conditions.flanks, conditions.mounts(position)
        own, phi1 = pinion.surface.jet(x[:, 0], x[:, 1]), conditions.phi1[position]
        placed = first.at(phi1)
        return _Circles(phi1, own, own.move(placed), placed.rotation, gear, second)

    def touch(self, y: Array, index: NDArray[np.intp]) -> Touch:
        """Both flanks at the gear's parameters and phi2 (K, 3) of points `index` (K,)."""
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
        """By how much (K, 3), mm, the points `index` (K,) miss the flank, and Jacobians (K, 3, 3)."""
        mount = self.mount.rows(index)
        two = self.flank.surface.jet(y[:, 0], y[:, 1]).move(mount.at(y[:, 2]))
        return self.fixed.r[index] - two.r, -np.stack((two.r_u, two.r_v, mount.velocity(two.r)), axis=-1)
