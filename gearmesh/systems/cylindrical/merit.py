"""Merits of a mesh without regard to strength: contact ratios, sliding, tips, reserves, and its faults [ISO 21771]."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gearmesh.errors import VagueError
from gearmesh.records import dataclass
from gearmesh.systems.cylindrical.geometry.geometry import flank_sides
from gearmesh.systems.cylindrical.geometry.interference import reserves
from gearmesh.systems.cylindrical.geometry.line_of_action import LineOfAction, form_roll_length, undercut_reserve
from gearmesh.systems.cylindrical.geometry.measures import thickness_at
from gearmesh.systems.cylindrical.geometry.nominal import MEMBER_NAMES
from gearmesh.systems.cylindrical.geometry.proportions import GearProportions, PairProportions, proportions
from gearmesh.teeth.region import Side

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.design import CylindricalDesign

#: least transverse contact ratio of a sound mesh
MIN_CONTACT_RATIO = 1.1
#: least tip thickness of a sound mesh, modules
MIN_TIP_MODULES = 0.2
#: fault of tips that meet outside the path of contact
INTERFERENCE_FAULT = "interference"
#: difference of lengths that is rounding
LENGTH_ROUNDING_MM = 1e-9


@dataclass(frozen=True)
class MeshMerit:
    """Merits of a mesh. The contact ratio is not reduced by undercut."""

    #: teeth of pinion and gear
    teeth: tuple[int, int]
    #: helix angle, deg
    helix_angle: float
    #: profile shifts of pinion and gear, modules
    shifts: tuple[float, float]
    #: transverse contact ratio
    eps_alpha: float
    #: overlap ratio
    eps_beta: float
    #: specific sliding of the pinion at A and of the gear at E
    sliding: tuple[float, float]
    #: normal tip thicknesses, modules
    tips: tuple[float, float]
    #: least reserve of both members against undercut, roll length, mm
    undercut: float
    #: least reserve of both members against interference, roll length, mm
    interference: float
    #: faults, as text
    faults: tuple[str, ...]


def mesh_merit(design: CylindricalDesign) -> MeshMerit:
    """Return the merits of the mesh of a complete design. Raises DesignError for teeth that cannot exist."""
    geometry = proportions(design)
    mesh, both = geometry.mesh, (geometry.mesh.pinion, geometry.mesh.gear)
    lines = side_lines(geometry)
    line = lines[0]
    points = line.points
    eps_alpha = min(of_side.contact_ratio for of_side in lines)
    width = min(design.pinion.face_width, design.gear.face_width)
    first, second = tip_thicknesses(geometry)
    for name, thickness, tip in zip(MEMBER_NAMES, (first, second), geometry.tips, strict=True):
        if thickness <= 0.0:
            raise VagueError(
                f"{name}.addendum",
                reason=f"the tooth is pointed below its tip diameter of {2.0 * tip:.6g} mm",
                excess=-thickness,
            )
    undercut = min(undercut_reserve(gear, side) for gear in geometry.gears for side in flank_sides(gear.own))
    interference = min(of_side.interference_reserve(number) for of_side in lines for number in (0, 1))
    passing = reserves(mesh, geometry.tips).trochoid if design.gear.internal else math.inf
    faults = {
        "undercut": undercut < -LENGTH_ROUNDING_MM,
        INTERFERENCE_FAULT: min(interference, passing) < -LENGTH_ROUNDING_MM,
        f"tip below {MIN_TIP_MODULES:g} modules": min(first, second) < MIN_TIP_MODULES,
        f"contact ratio below {MIN_CONTACT_RATIO:g}": eps_alpha < MIN_CONTACT_RATIO,
    }
    return MeshMerit(
        teeth=(both[0].teeth, both[1].teeth),
        helix_angle=design.helix_angle,
        shifts=(both[0].shift, both[1].shift),
        eps_alpha=eps_alpha,
        eps_beta=width * math.sin(abs(both[0].beta)) / (math.pi * both[0].module),
        sliding=(line.mesh.sliding(points["A"])[0], line.mesh.sliding(points["E"])[1]),
        tips=(first, second),
        undercut=undercut,
        interference=interference,
        faults=tuple(fault for fault, there in faults.items() if there),
    )


def tip_thicknesses(geometry: PairProportions) -> tuple[float, float]:
    """Return the normal thicknesses of both tips in modules."""
    members = geometry.mesh.pinion, geometry.mesh.gear
    pinion_tip, gear_tip = (
        thickness_at(toothing, tip) / toothing.module for toothing, tip in zip(members, geometry.tips, strict=True)
    )
    return pinion_tip, gear_tip


def side_lines(geometry: PairProportions) -> tuple[LineOfAction, ...]:
    """Return the lines of action of drive and coast side, or the one of symmetric teeth.

    Flanks are in closed form, from the form point as cut, or the base circle, to the tip.
    """
    lines = []
    for number, side in enumerate(geometry.mesh.sides):
        first, second = (_flank(gear, flank_sides(gear.own)[number]) for gear in geometry.gears)
        lines.append(LineOfAction(side, (first, second)))
    return tuple(lines)


def _flank(gear: GearProportions, side: Side) -> tuple[float, float]:
    """Return the roll lengths of a side of a member at root and tip, as cut by its tool.

    An undercut flank begins at the base circle.
    """
    return max(0.0, form_roll_length(gear, side)), gear.own.side(side).roll_length(gear.tip)
