"""Settings that are allowed and look like something else: lengths in another unit, angles in radians, members that are swapped."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from gearmesh.design.core import Design
    from gearmesh.design.keys import Key

#: modules in inches above which a design is taken for one in mm
LARGEST_INCH_MODULE = 3.0
#: angles that are degrees in every design, and the largest value (rad) that is taken for radians
MAIN_ANGLES = ("helix_angle", "spiral_angle", "pressure_angle", "transverse_pressure_angle")
LARGEST_RADIANS = 1.0


def unusual_settings(design: Design) -> tuple[str, ...]:
    """Notes on what a design sets.

    Parameters
    ----------
    design : Design
        In its own units.

    Returns
    -------
    tuple of str
        One line each; the settings count as they are.

    Examples
    --------
    >>> unusual_settings(design)
    ()
    """
    return tuple(_notes(design))


def _notes(design: Design) -> Iterator[str]:
    own = dict(design.own())
    module = own.get("module")
    if design.units == "inch" and module is not None and module > LARGEST_INCH_MODULE:
        yield (
            f"module = {module:g} inch is {module * design.mm_per_unit:g} mm; "
            f'a module of {module:g} mm is module = "{module:g}mm", or units = "mm" for all lengths'
        )
    for key, value in own.items():
        if key.rpartition(".")[2] in MAIN_ANGLES and 0.0 < abs(value) <= LARGEST_RADIANS:
            yield f"{key} = {value:g} deg: angles are in degrees; {value:g} rad is {math.degrees(value):.4g} deg"
    first, second = (getattr(design, name, None) for name in ("pinion", "gear"))
    teeth = [getattr(member, "teeth", None) for member in (first, second)]
    inside = any(getattr(member, "internal", False) for member in (first, second))
    if not inside and teeth[0] is not None and teeth[1] is not None and teeth[0] > teeth[1]:
        yield (
            f"pinion.teeth = {teeth[0]} is more than gear.teeth = {teeth[1]}: are pinion and gear swapped? "
            "phi1, torque and speed are those of the pinion"
        )


def likely_meaning(key: Key, name: str, value: Any, *, hand: bool) -> str:
    """Hint for an angle that its key refuses: radians, or the sign of the other hand.

    Parameters
    ----------
    key : Key
        Declared of the angle.
    name : str
        Last part of its dotted name.
    value : object
        As it was given.
    hand : bool
        Whether the design says the hand by a key of its own.

    Returns
    -------
    str
        To be added to what is allowed; empty where nothing else is likely.

    Examples
    --------
    >>> likely_meaning(gm.CylindricalDesign.key_at("pressure_angle"), "pressure_angle", 0.349, hand=True)
    '; 0.349 rad is 20 deg'
    """
    if key.unit != "angle" or name not in MAIN_ANGLES or isinstance(value, bool) or not isinstance(value, int | float):
        return ""
    if value < 0.0 and key.low == 0.0 and hand and -value <= key.high:
        return '; the key hand, "right" or "left", says the hand of the pinion'
    degrees = math.degrees(abs(value))
    if 0.0 < abs(value) <= LARGEST_RADIANS and key.low <= degrees <= key.high:
        return f"; {value:g} rad is {math.degrees(value):.4g} deg"
    return ""
