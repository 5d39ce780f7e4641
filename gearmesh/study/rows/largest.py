"""The largest errors with which a condition still holds, either way from where it does, by bracketing and false position."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array

#: even steps in which it is looked for where the condition first fails
STEPS = 16
#: steps that are asked at once
TOGETHER = 4
#: width of the bracket that is good enough, as a part of what is looked over; rounds at most
CLOSE, ROUNDS = 1e-4, 60


@dataclass(frozen=True)
class Largest:
    """`values` (S,): the last known to be good, NaN where none is; `beyond` (S,): the first known not to be, NaN where all are
    good.
    `near` (S,): whether the two are as near as wanted."""

    values: Array
    beyond: Array
    near: NDArray[np.bool_]


def largest(room: Callable[[Array], Array], start: float, ends: Array) -> Largest:
    """How far from `start` to each of `ends` (S,) a condition holds without a break: `room` (N,) of values (N,) is above 0.

    A room that is not a number is none; between one and a number it is halved.
    """
    steps = start + (ends - start)[:, None] * np.linspace(0.0, 1.0, STEPS + 1)
    rooms = np.full(steps.shape, np.inf)
    rooms[:, 0] = room(np.array([start]))[0]
    for k in range(1, STEPS + 1, TOGETHER):
        on = np.flatnonzero((rooms > 0.0).all(axis=1))
        if on.size:
            rooms[on, k : k + TOGETHER] = room(steps[on, k : k + TOGETHER].ravel()).reshape(on.size, -1)
    bad = ~(rooms > 0.0)
    first = np.where(bad.any(axis=1), bad.argmax(axis=1), STEPS + 1)
    every = np.arange(len(ends))
    inside = np.maximum(first - 1, 0)
    low, at_low = steps[every, inside], rooms[every, inside]
    beyond = np.minimum(first, STEPS)
    high, at_high = steps[every, beyond], rooms[every, beyond]
    width = CLOSE * np.abs(ends - start)
    free = first > STEPS
    last_side = np.zeros(len(ends))
    for k in range(ROUNDS):
        todo = np.flatnonzero(~free & (first > 0) & (np.abs(high - low) > width))
        if not todo.size:
            break
        a, b, fa, fb = low[todo], high[todo], at_low[todo], at_high[todo]
        with np.errstate(all="ignore"):
            share = fa / (fa - fb)
        # every third step halves, so that a bracket shrinks whatever the condition is like
        halved = ~np.isfinite(share) | (k % 3 == 2)
        share = np.clip(np.where(halved, 0.5, share), 0.02, 0.98)
        middle = a + share * (b - a)
        room_left = room(middle)
        good = room_left > 0.0
        low[todo], at_low[todo] = np.where(good, middle, a), np.where(good, room_left, fa)
        high[todo], at_high[todo] = np.where(good, b, middle), np.where(good, fb, room_left)
        # an end that stays twice counts half (Illinois)
        side = np.where(good, 1.0, -1.0)
        same = side == last_side[todo]
        at_high[todo] = np.where(good & same, 0.5 * at_high[todo], at_high[todo])
        at_low[todo] = np.where(~good & same, 0.5 * at_low[todo], at_low[todo])
        last_side[todo] = side
    near = ~free & (np.abs(high - low) <= width)
    return Largest(np.where(first == 0, np.nan, low), np.where(free, np.nan, high), near)
