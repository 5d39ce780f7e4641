"""The range of a key: the values with which the gears can be built, found by trying."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

from gearmesh.design.core import Design
from gearmesh.design.keys import Key
from gearmesh.errors import DesignError, NoSolutionError
from gearmesh.records import dataclass
from gearmesh.systems.system import try_build

#: limit of steps away from the present value, each twice as long as the one before
MAX_STEPS_OUT = 8
#: first step, over the value
FIRST_STEP_SHARE = 0.1
#: first step of lengths that are 0, over the module
FIRST_STEP_MODULES = 0.05
#: first step of angles that are 0, deg
FIRST_STEP_DEG = 1.0
#: rounds that halve the gap between a value that builds and one that does not
HALVING_ROUNDS = 6


@dataclass(frozen=True)
class BuildRange:
    """Range of a key around its present value."""

    #: least value that was tried and builds
    low: float
    #: greatest value that was tried and builds
    high: float
    #: True if smaller values were tried and refused, or are not allowed
    low_known: bool
    #: True if larger values were tried and refused, or are not allowed
    high_known: bool


def builds(design: Design, changes: Mapping[str, Any]) -> bool:
    """True if the gears can be built with other values of some keys."""
    try:
        try_build(design.with_values(changes) if changes else design)
    except (DesignError, NoSolutionError):
        return False
    return True


def halved(
    good: float, bad: float, works: Callable[[float], bool], rounds: int, rounded: Callable[[float], float]
) -> float:
    """Return the value nearest to a bad one that works, by halving the gap to a good one; tried values are `rounded`."""
    for _ in range(rounds):
        middle = rounded((good + bad) / 2.0)
        if middle in (good, bad):
            break
        good, bad = (middle, bad) if works(middle) else (good, middle)
    return good


def key_range(design: Design, dotted: str, value: float, works: Callable[[float], bool] | None = None) -> BuildRange:
    """Return the range of a numeric key around its `value`, in the design's units.

    `works`: True for a value with which the gears can be built, by default by trying.
    """
    key = type(design).key_at(dotted)
    assert key is not None
    scale = design.mm_per_unit**key.power
    low, high = key.low / scale, key.high / scale
    works = works or (lambda tried: builds(design, {dotted: tried}))
    whole, step = key.unit == "count", _first_step(design, key, value)
    ends = []
    for sign, bound in ((-1, low), (1, high)):
        good, bad, distance = value, math.nan, step
        for _ in range(MAX_STEPS_OUT):
            tried = max(value - distance, low) if sign < 0 else min(value + distance, high)
            tried = round(tried) if whole else tried
            if tried == good:
                bad = tried + sign
                break
            if not works(tried):
                bad = tried
                break
            good, distance = tried, 2.0 * distance
        known = not math.isnan(bad)
        if known and good != bound:
            good = halved(good, bad, works, HALVING_ROUNDS, math.trunc if whole else float)
        ends.append((good, known))
    return BuildRange(ends[0][0], ends[1][0], ends[0][1], ends[1][1])


def _first_step(design: Design, key: Key, value: float) -> float:
    """Return the first step away from a value."""
    if key.unit == "count":
        return max(1.0, round(FIRST_STEP_SHARE * abs(value)))
    if value:
        return FIRST_STEP_SHARE * abs(value)
    if key.power == 1:
        return FIRST_STEP_MODULES * design.given_module
    return FIRST_STEP_DEG if key.unit == "angle" else FIRST_STEP_SHARE
