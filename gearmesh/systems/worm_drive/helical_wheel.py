"""Wheels of worm drives that are helical gears: involute worm and wheel have point contact, as crossed helical gears.

The rack that generates the wheel is the worm's rack: normals and normal pitches agree. Its teeth are along the thread
where the worm's reference cylinder intersects the common perpendicular. It is the limit of a hob whose diameter grows
without bound.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gearmesh.errors import DesignError, VagueError
from gearmesh.records import dataclass
from gearmesh.systems.common.backlash import thin
from gearmesh.systems.common.racks.rack_member import Roll, member, rack_parameters
from gearmesh.systems.common.racks.rack_tooth import Heights, RackTooth, round_tips
from gearmesh.systems.common.tooth_edges import with_end_chamfers
from gearmesh.tools.rack import RackLine

if TYPE_CHECKING:
    from gearmesh.systems.worm_drive.design import WormDriveDesign
    from gearmesh.teeth.gear_train import Member


@dataclass(frozen=True)
class _CutterTip:
    """Tip of the hob, in normal modules."""

    #: height of the tip, in normal modules
    dedendum: float
    #: rounding of the tip, in normal modules
    tool_tip_radius: float


def helical_wheel(design: WormDriveDesign) -> Member:
    """Return the wheel of a design (in mm) as a helical gear. Raises DesignError naming key, value and limit."""
    roll = Roll(0.5 * design.wheel_reference_diameter, design.wheel_helix_angle, 0.0)
    made = member("wheel", design.wheel, _rack(design, roll), roll, rack_parameters("p_0", "v_0"), "addendum")
    return with_end_chamfers(made, design.wheel)


def _rack(design: WormDriveDesign, roll: Roll) -> tuple[RackTooth, RackTooth]:
    """Return the worm's rack.

    Its reference plane touches the worm's reference cylinder, and its space has the width of the thread there.
    """
    module, m = design.normal_module, design.axial_module
    shift = design.center_distance - 0.5 * design.reference_diameter - roll.radius
    angle = math.radians(design.pressure_angle)
    half = 0.5 * (math.pi - design.worm.thickness) * module
    flank = RackLine(angle, module, thin(half, design.backlash, 0.5 * (1.0 - design.backlash_share), angle), shift)
    heights = Heights(0.5 * design.wheel.outside_diameter - roll.radius, shift - design.hob.addendum * m)
    tip = _CutterTip(design.hob.addendum * m / module, design.hob.tip_radius * m / module)
    try:
        return round_tips("hob", tip, module, (flank, flank), heights)
    except DesignError as failure:
        key = "addendum" if failure.key == "hob.dedendum" else "tip_radius"
        raise VagueError(f"hob.{key}", getattr(design.hob, key), reason=failure.reason) from failure
