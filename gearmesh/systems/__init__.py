"""Gear systems: a design becomes two members and their assembly. One file a system."""

from __future__ import annotations

from importlib import import_module
from typing import Any

from gearmesh.pair import GearPair

#: kind of a design -> module with `build(design in mm) -> GearPair`
SYSTEMS = {
    "beveloid": "gearmesh.systems.beveloid",
    "circular_arc": "gearmesh.systems.circular_arc",
    "novikov": "gearmesh.systems.parabolic_helical",
    "modified_involute": "gearmesh.systems.parabolic_helical",
    "spiral_bevel": "gearmesh.systems.spiral_bevel",
    "spiral_bevel_conjugate": "gearmesh.systems.spiral_bevel_conjugate",
    "face_gear": "gearmesh.systems.face_gear",
}


def build(design: Any) -> GearPair:
    """The gear pair of a validated design.

    Raises DesignError, with key, value and limit, for geometry that cannot exist.
    """
    return import_module(SYSTEMS[design.kind]).build(design.in_mm())
