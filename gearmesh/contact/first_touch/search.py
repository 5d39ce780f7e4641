"""Where a sampled advance is above what was solved for: what is there really, followed to where it is greatest.

Nothing is taken for tangent here: a point of one flank meets the other where its circle about the gear's axis does.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.meshing import Conditions
from gearmesh.contact.conditions.refinement import EDGE_SLACK, Contacts, Trial, advances_of, margins, refine_candidates
from gearmesh.contact.pair import CORNER, Pair
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, dot

#: an advance sampled this far (rad; 0.01 arcsec) above what was found is looked into
UNSEEN = 5e-8
#: rounds of the search for it, and the share of the flank that its first steps are
CLIMBS, FIRST_STEP = 40, 0.04
#: by how much (rad) what is solved for may come short of a summit that was climbed: climbing may stand outside an edge by its slack
SUMMIT = 2e-8


def refine_missed(
    pair: Pair, phi1: Array, position: NDArray[np.intp], x: Array, contacts: Contacts, number: int
) -> None:
    """Positions (M,) at which places x (M, 5) seem to be further ahead than what was found: what they really do, and why."""
    conditions = Conditions(pair.flanks, phi1, pair.length)
    x, advance = meeting_points(pair, conditions, position, x)
    worth = np.flatnonzero(advance > contacts.advance[position] + UNSEEN)
    if not worth.size:
        return
    position = position[worth]
    x, advance = _climb(pair, conditions, position, x[worth], advance[worth])
    trial = Trial.of(position, x, np.full((len(position), 2), -1))
    trial.edges[:, 0], trial.residual[:] = CORNER, 0.0
    better = np.flatnonzero(advance > contacts.advance[position])
    contacts.take(position[better], trial, better, number, advance[better])
    # a summit inside the flanks, or on an edge, is solved for as such
    numbers = [-1, *(k for k, bound in enumerate(pair.bounds) if bound is not None)]
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
    size = np.ones(len(position))
    ways = np.array([(a, b) for a in (-1.0, 0.0, 1.0) for b in (-1.0, 0.0, 1.0) if (a, b) != (0.0, 0.0)])
    for _ in range(CLIMBS):
        going = np.flatnonzero(size > 1e-7)
        if not going.size:
            break
        start = np.repeat(x[going], len(ways), axis=0)
        start[:, :2] += (size[going][:, None, None] * ways * steps).reshape(-1, 2)
        tried, own = meeting_points(pair, conditions, np.repeat(position[going], len(ways)), start)
        own = own.reshape(-1, len(ways))
        best = own.argmax(axis=1)
        higher = own[np.arange(len(going)), best] > advance[going]
        up = going[higher]
        x[up] = tried.reshape(-1, len(ways), 5)[higher, best[higher]]
        advance[up] = own[higher, best[higher]]
        size[going[~higher]] *= 0.4
    return x, advance


def meeting_points(pair: Pair, conditions: Conditions, position: NDArray[np.intp], x: Array) -> tuple[Array, Array]:
    """Where the circles through the pinion's points of x (M, 5) meet the gear's flank: unknowns, and advances (M,), -inf where the
    point is not on both flanks or does not face it."""
    free = np.array([2, 3, 4])

    def residual(y: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
        all_five = x[index].copy()
        all_five[:, free] = y
        f, jacobian = conditions(all_five, position[index])
        return f[:, :3], jacobian[:, :3][:, :, free]

    solution = newton.solve(
        residual, x[:, free], tolerance=pair.tolerance, max_step=pair.max_step[free], max_iterations=12, halvings=3
    )
    whole = x.copy()
    whole[:, free] = solution.values
    touch = conditions.touch(whole, position)
    outside, past = margins(pair, touch, whole)
    good = solution.converged & (outside <= EDGE_SLACK).all(axis=1) & (past <= EDGE_SLACK)
    good &= dot(touch.fixed[0].n, touch.fixed[1].n) < 0.0
    advance = advances_of(pair, conditions.phi1, whole, position)
    return whole, np.where(good, advance, -np.inf)
