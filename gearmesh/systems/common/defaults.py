"""Defaults that adapt to the room on a tooth, and the warnings that they differ from the standard."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from functools import reduce
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gearmesh.design.core import Design

#: part of the available room that a default takes
ROOM_SHARE = 0.9
#: relative difference from which on a default counts as changed
SAME_VALUE_TOLERANCE = 1e-9
#: halvings to the depth that fits
BISECTION_STEPS = 20


def straight_rounding(
    width: float, depth: float, angles: tuple[float, float], standard: float, other: float | None = None
) -> float:
    """Return the `standard` rounding of a straight rack's tip, limited by the room on its tooth; modules.

    - width: width of the tooth at its pitch plane.
    - depth: depth of the tip under this plane.
    - angles: pressure angles (deg) of its flanks.
    - other: rounding at the second flank, where it has one of its own.
    """
    land = width - depth * sum(math.tan(math.radians(angle)) for angle in angles)
    # a rounding of radius 1 takes tan(45 deg - alpha / 2) of the land, either side
    own, opposite = (math.tan(math.radians(45.0 - 0.5 * angle)) for angle in angles)
    largest = land / (own + opposite) if other is None else (land - other * opposite) / own
    return standard if standard <= largest else max(0.0, ROOM_SHARE * largest)


def deepest(fits: Callable[[float], bool], least: float, standard: float) -> float:
    """Return the `standard` depth if it fits, else the largest depth from `least` on that fits.

    If no depth fits, the standard depth is returned.
    """
    if fits(standard) or not (least < standard and fits(least)):
        return standard
    low, high = least, standard
    for _ in range(BISECTION_STEPS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if fits(middle) else (low, middle)
    return low


def unusual_defaults(design: Design, standards: Mapping[str, tuple[float, str]]) -> tuple[str, ...]:
    """Return a warning for every default that differs from its standard value.

    `standards`: by dotted key, the standard value in the design's units, and the reason for another default.
    """
    warnings = []
    for key, (standard, why) in standards.items():
        value = _value(design, key)
        if abs(value - standard) > SAME_VALUE_TOLERANCE * abs(standard) and not design.sets(key):
            name = design.name_in_texts(key)
            warnings.append(f"{name} = {value:.4g}: the default, instead of {standard:g} because {why}")
    return tuple(warnings)


def _value(design: Design, dotted: str) -> Any:
    """Return the value of a dotted key."""
    return reduce(getattr, dotted.split("."), design)
