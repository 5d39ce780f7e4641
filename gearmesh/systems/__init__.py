"""Gear systems: a design becomes two members and their assembly. One file a system."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from gearmesh.errors import DesignError
from gearmesh.teeth.pair import GearPair

if TYPE_CHECKING:
    from gearmesh.systems.parabolic_helical.worm_thread import WormPart

#: kind of a design -> module with `build(design in mm) -> GearPair`
SYSTEMS = {
    "beveloid": "gearmesh.systems.beveloid.build",
    "circular_arc": "gearmesh.systems.circular_arc.build",
    "novikov": "gearmesh.systems.parabolic_helical.build",
    "modified_involute": "gearmesh.systems.parabolic_helical.build",
    "spiral_bevel": "gearmesh.systems.spiral_bevel.build",
    "spiral_bevel_conjugate": "gearmesh.systems.spiral_bevel.conjugate_build",
    "face_gear": "gearmesh.systems.face_gear.build",
}
#: those whose module also has `worm_part(design in mm) -> WormPart`
WITH_WORM = ("novikov", "modified_involute")


def build(design: Any) -> GearPair:
    """The gear pair of a validated design.

    Raises DesignError, with key, value and limit, for geometry that cannot exist.
    """
    return import_module(SYSTEMS[design.kind]).build(design.in_mm())


def worm_part(design: Any) -> WormPart:
    """The worm of a validated design's table `worm`, for a kind that has one.

    Raises DesignError, with key, value and limit, for a worm that cannot exist, and for kinds without one.
    """
    if design.kind not in WITH_WORM:
        raise DesignError(f"--member = worm: must be pinion or gear, {design.kind} has no worm")
    part: WormPart = import_module(SYSTEMS[design.kind]).worm_part(design.in_mm())
    return part
