"""Construction of conjugate spiral bevel gears, Geometry I and II [CR3553 chapter 2], as head-cut bevel gears.

The machine plane is the pitch plane, so that the teeth have uniform depth. On the pinion's convex side the pinion's
cutter is smaller than the gear's by gear.r_d - pinion.r_d; on the concave side it is larger by the same amount. Both
sides therefore have point contact.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.systems.common.bevel.blank import BevelBlank, basic_data, uniform_blank
from gearmesh.systems.spiral_bevel.conjugate.geometry import ConjugateGeometry
from gearmesh.systems.spiral_bevel.machine.blades import or_else
from gearmesh.systems.spiral_bevel.machine.generated import Generated
from gearmesh.systems.spiral_bevel.machine.machine import MachineSettings
from gearmesh.systems.spiral_bevel.machine.pair import (
    BLADE_SIDES,
    HAND_SIGNS,
    MATING_SIDES,
    CutSides,
    bevel_pair,
    cut_member,
    thinning,
)
from gearmesh.teeth.gear_train import GearTrain
from gearmesh.teeth.region import Side
from gearmesh.tools.head_cutter import Blade

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.conjugate.design import ConjugateDesign

#: largest profile radius rho over the depth of the teeth: within one depth the arc departs from its tangent by 1/8000
#: of the depth
MAX_RHO_DEPTHS = 1000.0


def build(design: ConjugateDesign) -> GearTrain:
    """Return the pair of a conjugate design (in mm). Raises DesignError for blanks and teeth that cannot exist."""
    blank = conjugate_blank(design)
    pinion, gear = {}, {}
    for name, side in BLADE_SIDES.items():
        geometry = conjugate_geometry(design, blank, name)
        pinion[name] = _generate(design, blank, geometry, side, 1)
        gear[MATING_SIDES[name]] = _generate(design, blank, geometry, -side, 2)
    # the pinion's teeth are thinned for the backlash
    set_back = thinning(design.backlash, blank)
    places = tuple(
        {
            name: (0.5 * np.pi / teeth - turn) * (1.0 if side.flank is Side.LEFT else -1.0)
            for name, side in sides.items()
        }
        for sides, teeth, turn in ((pinion, blank.pinion.teeth, set_back), (gear, blank.gear.teeth, 0.0))
    )
    cut = CutSides(blank, pinion, gear, (places[0], places[1]), *(dict.fromkeys(BLADE_SIDES, 0.0) for _ in range(2)))
    # the gear first: a fault of the gear shows on the pinion as well
    wheel = cut_member(design, cut, "gear")
    return bevel_pair(design, cut, cut_member(design, cut, "pinion"), wheel)


def conjugate_blank(design: ConjugateDesign) -> BevelBlank:
    """Return the blank, of uniform depth, of a design in mm.

    Raises DesignError for a blank that cannot exist or be cut with rho.
    """
    data = basic_data(design, design.beta, design.psi_c)
    blank = uniform_blank(data, (design.addendum, design.dedendum), design.gear.r_d)
    _check_rho(design.rho, blank)
    return blank


def _check_rho(rho: float | None, blank: BevelBlank) -> None:
    """Raise DesignError for a profile radius too small for the depth of the tooth, or too large to matter."""
    if rho is None:
        return
    # the arc must not become upright before the tip of the blade, nor level before the tip of the tooth
    sine, pinion = np.sin(blank.pressure_angle), blank.pinion
    low = max(pinion.mean_dedendum / sine, pinion.mean_addendum / (1.0 - sine))
    high = MAX_RHO_DEPTHS * blank.mean_depth
    if not low < rho <= high:
        raise DesignError(
            "rho",
            rho,
            unit="mm",
            allowed=f"more than {low:.4g} mm, which the depth of the teeth needs, and up to {high:.6g} mm; without rho the "
            "blades are straight (Geometry I)",
        )


def conjugate_geometry(design: ConjugateDesign, blank: BevelBlank, name: str) -> ConjugateGeometry:
    """Return the closed forms of one side ("concave" or "convex") of the pinion, for a left-hand pinion."""
    sign = -BLADE_SIDES[name]
    return ConjugateGeometry(
        cone_distance=blank.pinion.mean_cone_distance,
        spiral_angle=blank.pinion.spiral_angle,
        psi_c=sign * blank.pressure_angle,
        r_f=design.gear.r_d - sign * (design.gear.r_d - design.pinion.r_d),
        r_k=design.gear.r_d,
        gamma_1=blank.pinion.pitch_angle,
        gamma_2=blank.gear.pitch_angle,
        rho=np.inf if design.rho is None else design.rho,
    )


def _generate(
    design: ConjugateDesign, blank: BevelBlank, geometry: ConjugateGeometry, side: int, member: int
) -> Generated:
    """Return one side of pinion (1) or gear (2): generating surface F or K in the crown gear's motion."""
    blank_of_member, spec = (blank.pinion, design.pinion) if member == 1 else (blank.gear, design.gear)
    radius = (geometry.r_f, geometry.r_k)[member - 1]
    b, q = geometry.setting(radius)
    machine = MachineSettings(
        radial=b,
        cradle_angle=q,
        ratio_of_roll=float(np.sin(blank_of_member.pitch_angle)),
        machine_root_angle=blank_of_member.pitch_angle,
        sliding_base=-blank_of_member.mean_dedendum,
    )
    profile = -design.rho if member == 1 and design.rho is not None else 0.0
    edge = or_else(spec.edge_radius, blank.edge_radius)
    blade = Blade.through(side, radius, blank_of_member.mean_dedendum, blank.pressure_angle, edge, profile)
    hand = HAND_SIGNS[design.hand] * (1 if member == 1 else -1)
    tip_height = blank_of_member.mean_dedendum + blank_of_member.mean_addendum
    return Generated(machine, blade, hand, blank_of_member.mean_cone_distance, tip_height, spec.edge_radius is None)
