"""Largest values for which a condition holds, in each direction from a start, by bracketing and false position."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass

#: equal steps of the search for the first value that fails
SEARCH_STEPS = 16
#: steps that are evaluated at once
STEPS_PER_BATCH = 4
#: width of the final bracket, relative to the range that is searched
RELATIVE_BRACKET_WIDTH = 1e-6
#: limit of the rounds that refine the bracket
MAX_REFINING_ROUNDS = 60


@dataclass(frozen=True)
class Largest:
    """Brackets of the largest values in S directions."""

    #: last value (S,) for which the condition is known to hold; NaN if there is none
    values: Array
    #: first value (S,) for which it is known to fail; NaN if it holds over the whole range
    beyond: Array
    #: True (S,) if the bracket is as narrow as required
    near: NDArray[np.bool_]


def largest(room: Callable[[Array], Array], start: float, ends: Array) -> Largest:
    """Return how far from `start` towards each of `ends` (S,) a condition holds without a break: room(values) (N,) > 0.

    NaN counts as failed. A bracket with NaN at an end is halved.
    """
    # step outwards in all directions at once until the condition first fails: its first break, not the last one, counts
    steps = start + (ends - start)[:, None] * np.linspace(0.0, 1.0, SEARCH_STEPS + 1)
    rooms = np.full(steps.shape, np.inf)
    rooms[:, 0] = room(np.array([start]))[0]
    for k in range(1, SEARCH_STEPS + 1, STEPS_PER_BATCH):
        holding = np.flatnonzero((rooms > 0.0).all(axis=1))
        if holding.size:
            rooms[holding, k : k + STEPS_PER_BATCH] = room(steps[holding, k : k + STEPS_PER_BATCH].ravel()).reshape(
                holding.size, -1
            )
    # bracket of each direction: the last step before the failure, and the first step that fails
    bad = ~(rooms > 0.0)
    first_bad = np.where(bad.any(axis=1), bad.argmax(axis=1), SEARCH_STEPS + 1)
    directions = np.arange(len(ends))
    inside = np.maximum(first_bad - 1, 0)
    low, room_at_low = steps[directions, inside], rooms[directions, inside]
    beyond = np.minimum(first_bad, SEARCH_STEPS)
    high, room_at_high = steps[directions, beyond], rooms[directions, beyond]
    width = RELATIVE_BRACKET_WIDTH * np.abs(ends - start)
    unlimited = first_bad > SEARCH_STEPS
    last_side = np.zeros(len(ends))
    # shrink the brackets; the condition holds at `low` and fails at `high` throughout
    for k in range(MAX_REFINING_ROUNDS):
        todo = np.flatnonzero(~unlimited & (first_bad > 0) & (np.abs(high - low) > width))
        if not todo.size:
            break
        a, b, fa, fb = low[todo], high[todo], room_at_low[todo], room_at_high[todo]
        with np.errstate(all="ignore"):
            share = fa / (fa - fb)
        # every third round halves the bracket, so that it shrinks for any shape of the condition
        halved = ~np.isfinite(share) | (k % 3 == 2)
        share = np.clip(np.where(halved, 0.5, share), 0.02, 0.98)
        middle = a + share * (b - a)
        room_left = room(middle)
        good = room_left > 0.0
        low[todo], room_at_low[todo] = np.where(good, middle, a), np.where(good, room_left, fa)
        high[todo], room_at_high[todo] = np.where(good, b, middle), np.where(good, fb, room_left)
        # an end that stays for two rounds counts half, so that the other end moves as well (Illinois method)
        side = np.where(good, 1.0, -1.0)
        same = side == last_side[todo]
        room_at_high[todo] = np.where(good & same, 0.5 * room_at_high[todo], room_at_high[todo])
        room_at_low[todo] = np.where(~good & same, 0.5 * room_at_low[todo], room_at_low[todo])
        last_side[todo] = side
    near = ~unlimited & (np.abs(high - low) <= width)
    return Largest(np.where(first_bad == 0, np.nan, low), np.where(unlimited, np.nan, high), near)
