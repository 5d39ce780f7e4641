"""Notes on allowed but unusual settings: lengths in another unit, angles in radians, swapped members, keys without effect."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

from gearmesh.design.explain import LARGEST_ANGLE_RAD, MAIN_ANGLES
from gearmesh.design.shown import value_text

if TYPE_CHECKING:
    from gearmesh.design.core import Design

#: largest module of a design in inches that does not look like mm
LARGEST_MODULE_INCH = 3.0
#: keys that have an effect beside another key alone, and the keys of which one that is not 0 gives it
PARTNER_KEYS = {
    "toprem_angle": ("toprem_height",),
    "toprem_radius": ("toprem_height",),
    "swivel": ("tilt", "tilt_motion"),
    "swivel_motion": ("tilt", "tilt_motion"),
}
#: ends of names of keys that have an effect beside the key with the other end
PARTNER_ENDS = ("_phase", "_eccentricity")


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
        table, _, name = key.rpartition(".")
        partners = PARTNER_KEYS.get(name, ())
        if name.endswith(PARTNER_ENDS[0]):
            partners = (name.removesuffix(PARTNER_ENDS[0]) + PARTNER_ENDS[1],)
        if value and partners and not any(_has_partner(design, own, table, partner) for partner in partners):
            said = f"{value:g}" if isinstance(value, float) else value_text(value)
            yield f"{key} = {said} has no effect without {' or '.join(partners)}"
    first, second = (getattr(design, name, None) for name in ("pinion", "gear"))
    teeth = [getattr(member, "teeth", None) for member in (first, second)]
    inside = any(getattr(member, "internal", False) for member in (first, second))
    if not inside and teeth[0] is not None and teeth[1] is not None and teeth[0] > teeth[1]:
        yield (
            f"pinion.teeth = {teeth[0]} is more than gear.teeth = {teeth[1]}: are pinion and gear swapped? "
            "phi1, torque and speed are those of the pinion"
        )


def _has_partner(design: Design, own: dict[str, Any], table: str, partner: str) -> bool:
    """Return True if the key `partner` is not 0 in a table or else in the table around it, or in a table inside it.

    Values left to a search are NaN, which counts as not 0.
    """
    value = _value(design, f"{table}.{partner}")
    if value is None:
        value = _value(design, f"{table.rpartition('.')[0]}.{partner}")
    inside = [value for key, value in own.items() if key.startswith(f"{table}.") and key.endswith(f".{partner}")]
    return any((value, *inside))


def _value(design: Design, key: str) -> Any:
    """Return the value of a dotted key; None where there is none."""
    value: Any = design
    for name in key.split("."):
        value = getattr(value, name, None)
    return value
