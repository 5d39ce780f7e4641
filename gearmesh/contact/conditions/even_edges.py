"""Contact all along an edge, as spur gears on parallel axes have it where a tip takes over: told at the middle of the face.

All of the edge is as far ahead then, and which of its points was solved for, its ends among them, is a matter of rounding.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.meshing import Bound, Conditions
from gearmesh.contact.conditions.refinement import EDGE_SLACK, EQUAL, Contacts, advances_of, at_positions, margins
from gearmesh.contact.pair import NUMBERED, OF_CORNERS, Pair
from gearmesh.kernel.motion.rigid import MAX_SINE_OF_PARALLEL
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, cross, dot, turn

#: the edges that end a face, by number: what touches on one of them alone does not do so all along it
FACE_ENDS = np.array([name in ("toe", "heel") for _, name in NUMBERED])


def to_middle(pair: Pair, phi1: Array, contacts: Contacts, number: int) -> None:
    """Move those contacts (N,) of part `number` of the teeth that are as far ahead all along an edge to the middle of the face that
    both have."""
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
    # the face that both have, from the contact, in the sense of the pinion's stations
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
    good &= advances_of(pair, phi1, solution.values, position) >= contacts.advance[position] - EQUAL
    contacts.x[position[good]], contacts.residual[position[good]] = solution.values[good], solution.residual[good]
    contacts.edges[position[good]] = np.column_stack((edge[good], np.full(int(good.sum()), -1)))


def _along(contacts: Contacts, number: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Positions (M,) of a part at which one edge along the face touches, alone or at its ends, and the number of the edge."""
    there = np.flatnonzero(contacts.touching & (contacts.part == number) & (contacts.edges[:, 0] >= 0))
    edges = contacts.edges[there]
    goes_along = (edges >= 0) & (edges < len(NUMBERED))
    goes_along &= ~(FACE_ENDS | OF_CORNERS)[np.where(goes_along, edges, 0)]
    one = np.flatnonzero(goes_along.sum(axis=1) == 1)
    return there[one], edges[one, goes_along[one].argmax(axis=1)]
