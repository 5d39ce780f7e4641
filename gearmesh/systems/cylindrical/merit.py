"""What a mesh is worth without regard to strength: contact ratios, sliding, tips, reserves, and its faults [ISO 21771]."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from gearmesh.errors import VagueError
from gearmesh.systems.cylindrical.geometry.interference import reserves
from gearmesh.systems.cylindrical.geometry.line_of_action import LineOfAction, form_roll_length, undercut_reserve
from gearmesh.systems.cylindrical.geometry.measures import thickness_at
from gearmesh.systems.cylindrical.geometry.nominal import MEMBER_NAMES
from gearmesh.systems.cylindrical.geometry.proportions import GearProportions, PairProportions, proportions

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.design import CylindricalDesign

#: what a sound mesh has at least: contact ratio, tip thickness in modules
LEAST_RATIO, LEAST_TIP = 1.1, 0.2
#: the fault of tips that meet outside the path of contact
INTERFERENCE = "interference"
#: mm that are nothing but rounding
ROUNDING = 1e-9


@dataclass(frozen=True)
class MeshMerit:
    """Tooth numbers, helix angle (deg) and shifts of a mesh, and what it is worth.

    `sliding`: specific sliding of the pinion at A and of the gear at E; `tips`: normal tip thicknesses in modules; `undercut`,
    `interference`: roll lengths left, the less of both members, mm; `faults`: what is wrong with it, in words. What undercut takes
    of the contact ratio is not taken off.
    """

    teeth: tuple[int, int]
    helix_angle: float
    shifts: tuple[float, float]
    eps_alpha: float
    eps_beta: float
    sliding: tuple[float, float]
    tips: tuple[float, float]
    undercut: float
    interference: float
    faults: tuple[str, ...]


def mesh_merit(design: CylindricalDesign) -> MeshMerit:
    """What the mesh of a complete design is worth. Raises DesignError for teeth that cannot exist."""
    geometry = proportions(design)
    mesh, both = geometry.mesh, (geometry.mesh.pinion, geometry.mesh.gear)
    line = LineOfAction(mesh, (_flank(geometry.gears[0]), _flank(geometry.gears[1])))
    points = line.points
    eps_alpha = line.contact_ratio
    width = min(design.pinion.face_width, design.gear.face_width)
    first, second = tip_thicknesses(geometry)
    for name, thickness, tip in zip(MEMBER_NAMES, (first, second), geometry.tips, strict=True):
        if thickness <= 0.0:
            raise VagueError(
                f"{name}.addendum", reason=f"the tooth is pointed below its tip diameter of {2.0 * tip:.6g} mm"
            )
    undercut = min(undercut_reserve(gear) for gear in geometry.gears)
    interference = min(line.interference_reserve(toothing) for toothing in both)
    passing = reserves(mesh, geometry.tips).trochoid if design.gear.internal else math.inf
    faults = {
        "undercut": undercut < -ROUNDING,
        INTERFERENCE: min(interference, passing) < -ROUNDING,
        f"tip below {LEAST_TIP:g} modules": min(first, second) < LEAST_TIP,
        f"contact ratio below {LEAST_RATIO:g}": eps_alpha < LEAST_RATIO,
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
    """Normal thicknesses of both tips in modules."""
    both = geometry.mesh.pinion, geometry.mesh.gear
    first, second = (
        thickness_at(toothing, tip) / toothing.module for toothing, tip in zip(both, geometry.tips, strict=True)
    )
    return first, second


def _flank(gear: GearProportions) -> tuple[float, float]:
    """Roll lengths of a member's flank at root and tip, as its tool leaves it; from the base circle where that undercuts it."""
    return max(0.0, form_roll_length(gear)), gear.own.roll_length(gear.tip)
