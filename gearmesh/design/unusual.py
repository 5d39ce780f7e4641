"""Notes on allowed but unusual settings: lengths in another unit, angles in radians, swapped members."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING

from gearmesh.design.explain import LARGEST_ANGLE_RAD, MAIN_ANGLES

if TYPE_CHECKING:
    from gearmesh.design.core import Design

#: largest module of a design in inches that does not look like mm
LARGEST_MODULE_INCH = 3.0


def unusual_settings(design: Design) -> tuple[str, ...]:
    """Notes on what a design sets."""
    return tuple(_notes(design))


def _notes(design: Design) -> Iterator[str]:
    """Yield the notes, one line each."""
    own = dict(design.own())
    module = own.get("module")
    if design.units == "inch" and module is not None and module > LARGEST_MODULE_INCH:
        yield (
            f"module = {module:g} inch is {module * design.mm_per_unit:g} mm; "
            f'a module of {module:g} mm is module = "{module:g}mm", or units = "mm" for all lengths'
        )
    for key, value in own.items():
        if key.rpartition(".")[2] in MAIN_ANGLES and 0.0 < abs(value) <= LARGEST_ANGLE_RAD:
            yield f"{key} = {value:g} deg: angles are in degrees; {value:g} rad is {math.degrees(value):.4g} deg"
    first, second = (getattr(design, name, None) for name in ("pinion", "gear"))
    teeth = [getattr(member, "teeth", None) for member in (first, second)]
    inside = any(getattr(member, "internal", False) for member in (first, second))
    if not inside and teeth[0] is not None and teeth[1] is not None and teeth[0] > teeth[1]:
        yield (
            f"pinion.teeth = {teeth[0]} is more than gear.teeth = {teeth[1]}: are pinion and gear swapped? "
            "phi1, torque and speed are those of the pinion"
        )
