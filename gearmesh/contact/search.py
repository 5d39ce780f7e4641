"""Where a sampled lead is above what was solved for: what is there really, followed to where it is greatest.

Nothing is taken for tangent here: a point of one flank meets the other where its circle about the gear's axis does.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.heights import cubic
from gearmesh.contact.meshing import Conditions
from gearmesh.contact.pair import Pair
from gearmesh.contact.settle import EDGE_SLACK, JOINTS, TOLERANCE, Contacts, Trial, leads_of, margins, pushing, settle
from gearmesh.kernel import newton
from gearmesh.kernel.algebra import Array

#: a lead sampled this far (rad; 0.01 arcsec) above what was found is looked into
UNSEEN = 5e-8
#: rounds of the search for it, and the share of the flank that its first steps are
CLIMBS, FIRST_STEP = 40, 0.04
#: rounds in which the end of a flank is searched, each four times as fine
END_ROUNDS = 8
#: by how much (rad) a search may come short of a summit
SUMMIT = 1e-11


def looked_into(pair: Pair, phi1: Array, position: NDArray[np.intp], x: Array, contacts: Contacts, number: int) -> None:
    """Positions (M,) at which places x (M, 5) seem to lead more than what was found: what they really do, and why.

    Where flank or fillet ends without an edge of the solver, at the ridge that undercut leaves between them or at the root, these
    ends are searched; what leads more still is followed upwards.
    """
    conditions = Conditions(pair.flanks, phi1, pair.length)
    x, lead = _met(pair, conditions, position, x)
    worth = np.flatnonzero(lead > contacts.lead[position] + UNSEEN)
    if not worth.size:
        return
    position, x, lead = position[worth], x[worth], lead[worth]
    for member in (0, 1):
        _along_end(pair, conditions, position, x, member, contacts, number)
    left = np.flatnonzero(lead > contacts.lead[position] + UNSEEN)
    if left.size:
        climb(pair, phi1, position[left], x[left], contacts, number)


def _along_end(
    pair: Pair,
    conditions: Conditions,
    position: NDArray[np.intp],
    x: Array,
    member: int,
    contacts: Contacts,
    number: int,
) -> None:
    """Search the end of a member's flank (row 0 of its grid) for what leads at positions (M,); x (M, 5): starts."""
    end = pair.flanks[member].grid[0]
    last = len(end) - 1
    place = np.broadcast_to(np.arange(0.0, last + 1.0, 2.0), (len(position), last // 2 + 1))
    step = 2.0
    best, lead = np.zeros(len(position)), np.full(len(position), -np.inf)
    start = x
    for _ in range(END_ROUNDS):
        count = place.shape[1]
        tried = np.repeat(start, count, axis=0)
        own = slice(2 * member, 2 * member + 2)
        tried[:, own] = np.stack([cubic(end[:, k], place.ravel()) for k in range(2)], axis=-1)
        solved, found = _met(pair, conditions, np.repeat(position, count), tried, member)
        found = found.reshape(-1, count)
        k = found.argmax(axis=1)
        rows = np.arange(len(position))
        higher = found[rows, k] > lead
        lead = np.where(higher, found[rows, k], lead)
        best = np.where(higher, place[rows, k], best)
        start = np.where(higher[:, None], solved.reshape(-1, count, 5)[rows, k], start)
        place = np.clip(best[:, None] + step * np.linspace(-1.0, 1.0, 9), 0.0, last)
        step *= 0.25
    ends = Trial.of(position, start, np.full((len(position), 2), -1))
    ends.edges[:, 0] = JOINTS[member]
    ends.residual[:] = 0.0
    better = np.flatnonzero(lead > contacts.lead[position])
    contacts.take(position[better], ends, better, number, lead[better])


def climb(pair: Pair, phi1: Array, position: NDArray[np.intp], x: Array, contacts: Contacts, number: int) -> None:
    """Follow the lead upwards from places x (M, 5) that lead more than what was found, over points that both flanks have."""
    conditions = Conditions(pair.flanks, phi1, pair.length)
    steps = FIRST_STEP * np.ptp(pair.pinion.grid.reshape(-1, 2), axis=0)
    x, lead = _met(pair, conditions, position, x)
    size = np.ones(len(position))
    ways = np.array([(a, b) for a in (-1.0, 0.0, 1.0) for b in (-1.0, 0.0, 1.0) if (a, b) != (0.0, 0.0)])
    for _ in range(CLIMBS):
        going = np.flatnonzero(size > 1e-7)
        if not going.size:
            break
        start = np.repeat(x[going], len(ways), axis=0)
        start[:, :2] += (size[going][:, None, None] * ways * steps).reshape(-1, 2)
        tried, own = _met(pair, conditions, np.repeat(position[going], len(ways)), start)
        own = own.reshape(-1, len(ways))
        best = own.argmax(axis=1)
        higher = own[np.arange(len(going)), best] > lead[going]
        up = going[higher]
        x[up] = tried.reshape(-1, len(ways), 5)[higher, best[higher]]
        lead[up] = own[higher, best[higher]]
        size[going[~higher]] *= 0.4
    joints = np.stack([_past_joint(pair, conditions, position, x, member) for member in (0, 1)], axis=1)
    found = Trial.of(position, x, np.full((len(position), 2), -1))
    found.edges[:, 0] = np.array(JOINTS)[joints.argmax(axis=1)]
    found.residual[:] = 0.0
    better = np.flatnonzero(lead > contacts.lead[position])
    contacts.take(position[better], found, better, number, lead[better])
    # a summit inside the flanks, or on an edge, is solved for as such
    near = [
        np.full(len(position), -1),
        *(np.full(len(position), k) for k in range(len(pair.bounds)) if pair.numbers[k] >= 0),
    ]
    edges = np.stack((np.concatenate(near), np.full(len(near) * len(position), -1)), axis=-1)
    again = Trial.of(np.tile(position, len(near)), np.tile(x, (len(near), 1)), edges)
    contacts.lead[position] -= SUMMIT
    settle(pair, phi1, again, contacts, number)
    kept = position[contacts.edges[position, 0] >= JOINTS[0]]
    contacts.lead[kept] += SUMMIT


def _past_joint(pair: Pair, conditions: Conditions, position: NDArray[np.intp], x: Array, member: int) -> Array:
    beyond, parameters = pair.flanks[member].beyond_joint, x[:, 2 * member : 2 * member + 2]
    if beyond is None:
        return np.full(len(x), -np.inf)
    return beyond(parameters, conditions.touch(x, position).own[member].r)


def _met(
    pair: Pair, conditions: Conditions, position: NDArray[np.intp], x: Array, held: int = 0
) -> tuple[Array, Array]:
    """Where the circles through the points of x (M, 5) on one member, which is `held` (0 pinion, 1 gear), meet the other's flank:
    unknowns, and leads (M,), -inf where the point is not on both flanks or does not push."""
    free = np.array([2, 3, 4] if held == 0 else [0, 1, 4])

    def residual(y: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
        all_five = x[index].copy()
        all_five[:, free] = y
        f, jacobian = conditions(all_five, position[index])
        return f[:, :3], jacobian[:, :3][:, :, free]

    found = newton.solve(
        residual, x[:, free], tolerance=TOLERANCE, max_step=pair.max_step[free], max_iterations=12, halvings=3
    )
    whole = x.copy()
    whole[:, free] = found.values
    touch = conditions.touch(whole, position)
    outside, joint = margins(pair, touch, whole)
    good = found.converged & (outside <= EDGE_SLACK).all(axis=1) & (joint <= EDGE_SLACK)
    good &= pushing(pair, conditions.mounts(position), touch)
    lead = leads_of(pair, conditions.phi1, whole, position)
    return whole, np.where(good, lead, -np.inf)
