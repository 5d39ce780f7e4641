"""Defaults that adapt: what a standard value becomes where there is no room for it, and the warning of it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import reduce
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gearmesh.design.core import Design

#: part of the room that there is that a default takes
ROOM = 0.9
#: from which part of itself on a default counts as changed
SAME = 1e-9
#: halvings to the depth that fits
HALVINGS = 20


def straight_rounding(width: float, depth: float, angles: tuple[float, float], standard: float) -> float:
    """The `standard` rounding of a straight rack's tip, or what its tooth has room for, all in modules.

    The tooth is `width` wide at its pitch plane, `depth` deep under it, between flanks of pressure `angles` (deg).
    """
    land = width - depth * sum(math.tan(math.radians(angle)) for angle in angles)
    # a rounding of radius 1 takes tan(45 deg - alpha / 2) of the land, either side
    largest = land / sum(math.tan(math.radians(45.0 - 0.5 * angle)) for angle in angles)
    return standard if standard <= largest else max(0.0, ROOM * largest)


def deepest(fits: Callable[[float], bool], least: float, standard: float) -> float:
    """The `standard` depth, or the largest one from `least` on that fits; the standard one where none does."""
    if fits(standard) or not (least < standard and fits(least)):
        return standard
    low, high = least, standard
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if fits(middle) else (low, middle)
    return low


def unusual_defaults(design: Design, standards: Mapping[str, tuple[float, str]]) -> tuple[str, ...]:
    """A warning for every (dotted) key that the design leaves out and whose value is not its standard one.

    `standards`: that value by key, in the design's units, and what keeps the default from it.
    """
    warnings = []
    for key, (standard, why) in standards.items():
        value = _value(design, key)
        if abs(value - standard) > SAME * abs(standard) and not design.sets(key):
            name = design.name_in_texts(key)
            warnings.append(f"{name} = {value:.4g}: the default, instead of {standard:g} because {why}")
    return tuple(warnings)


def _value(design: Design, dotted: str) -> Any:
    return reduce(getattr, dotted.split("."), design)
