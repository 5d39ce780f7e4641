"""Contact all along an edge, as on spur gears with parallel axes where a tip takes over: moved to the middle of the face.

All points of the edge have the same advance, so that rounding decides which point the solver finds.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.meshing import Bound, Conditions
from gearmesh.contact.conditions.refinement import (
    EDGE_SLACK,
    EQUAL_ADVANCE_RAD,
    Contacts,
    advances_of,
    at_positions,
    margins,
)
from gearmesh.contact.pair import IS_TIP_CORNER, NUMBERED_EDGES, Pair
from gearmesh.kernel.motion.rigid import MAX_SINE_OF_PARALLEL
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, cross, dot, turn

#: True for edges that end a face, by number: contact on one of them is never all along it
IS_FACE_END = np.array([name in ("toe", "heel") for _, name in NUMBERED_EDGES])


def to_middle(pair: Pair, phi1: Array, contacts: Contacts, number: int) -> None:
    """Move contacts (N,) of part `number` that extend all along an edge to the middle of the common face."""
    position, edge = _along(contacts, number)
    if not position.size:
        return
    own = Conditions(pair.flanks, phi1, pair.length).repeat(position)
    every, x = np.arange(position.size), contacts.x[position]
    touch = own.touch(x, every)
    axial = pair.pinion.axial, pair.gear.axial
    along = [
        turn(rotation, level.gradient(jet.r))
        for rotation, level, jet in zip(touch.turns, axial, touch.own, strict=True)
    ]
    parallel = np.linalg.norm(cross(*along), axis=-1) < MAX_SINE_OF_PARALLEL
    # ends of the common face, as stations from the contact, in the sense of the pinion's stations
    stations = [level.value(jet.r) for level, jet in zip(axial, touch.own, strict=True)]
    ends = [np.sort(flank.extent)[:, None] - station for flank, station in zip(pair.flanks, stations, strict=True)]
    ends[1] = np.sort(np.sign(dot(*along)) * ends[1], axis=0)
    low, high = np.maximum(ends[0][0], ends[1][0]), np.minimum(ends[0][1], ends[1][1])
    across = Bound(0, axial[0], stations[0] + 0.5 * (low + high))
    choice = np.column_stack((pair.numbers[edge], np.full(position.size, len(pair.all_bounds))))
    bounded = replace(own, bounds=(*pair.all_bounds, across), choice=choice)
    solution = newton.solve(
        partial(at_positions, bounded, every), x, tolerance=pair.tolerance, max_step=pair.max_step, max_iterations=15
    )
    touch = own.touch(solution.values, every)
    outside, past = margins(pair, touch, solution.values)
    good = parallel & solution.converged & (outside <= EDGE_SLACK).all(axis=1) & (past <= EDGE_SLACK)
    good &= dot(touch.fixed[0].n, touch.fixed[1].n) < 0.0
    good &= advances_of(pair, phi1, solution.values, position) >= contacts.advance[position] - EQUAL_ADVANCE_RAD
    contacts.x[position[good]], contacts.residual[position[good]] = solution.values[good], solution.residual[good]
    contacts.edges[position[good]] = np.column_stack((edge[good], np.full(int(good.sum()), -1)))


def _along(contacts: Contacts, number: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return positions (M,) of part `number` with contact on one edge along the face, and the numbers (M,) of the edges."""
    there = np.flatnonzero(contacts.touching & (contacts.part == number) & (contacts.edges[:, 0] >= 0))
    edges = contacts.edges[there]
    goes_along = (edges >= 0) & (edges < len(NUMBERED_EDGES))
    goes_along &= ~(IS_FACE_END | IS_TIP_CORNER)[np.where(goes_along, edges, 0)]
    one = np.flatnonzero(goes_along.sum(axis=1) == 1)
    return there[one], edges[one, goes_along[one].argmax(axis=1)]
