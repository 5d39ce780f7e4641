"""Tip roundings of shaper cutters and form tools, one for each side of the teeth."""

from __future__ import annotations

from dataclasses import replace

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError
from gearmesh.systems.common.racks.rack_tooth import SidedTip, tip_rounding
from gearmesh.tools.shaper import Shaper


def with_roundings(name: str, spec: SidedTip, module: float, sharp: Shaper, reason: str, note: str = "") -> Shaper:
    """Return a tool with the tip roundings of a member.

    - module: normal module.
    - sharp: the tool without roundings, by the flank that cuts the drive side.
    - reason, note: why there is no room for a rounding, and words after the largest one.

    Raises DesignError if the tool's tooth has no room for them.
    """
    drive, coast = tip_rounding(spec, coast=False), tip_rounding(spec, coast=True)
    own, other = drive.modules * module, coast.modules * module
    room = [(drive, own, sharp)]
    if coast.key != drive.key:
        # the coast side alone, then the drive side beside it
        room = [(coast, other, sharp.rounded(0.0, 0.0).other_flank)]
        if other <= room[0][2].largest_tip_radius:
            room = [(drive, own, sharp.rounded(0.0, other))]
    for rounding, radius, tool in room:
        if radius > (largest := tool.largest_tip_radius):
            most = Allowed.at_most(largest / module, "", note=note)
            raise DesignError(f"{name}.{rounding.key}", rounding.modules, reason=reason, allowed=most)
    return sharp.rounded(own, other) if coast.key != drive.key else replace(sharp, tip_radius=own)
