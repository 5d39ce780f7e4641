"""Cutting of a pair: both sides of both members for the requested contact, and their index positions."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.systems.common.bounds import at_least, at_most
from gearmesh.systems.spiral_bevel.machine.index import MAX_CONTACT_TURN_PITCHES
from gearmesh.systems.spiral_bevel.machine.pair import (
    BLADE_SIDES,
    HAND_SIGNS,
    MATING_SIDES,
    Angles,
    CutSides,
    Sides,
    beside_space,
    nominal_base,
    thinning,
)
from gearmesh.systems.spiral_bevel.machine.thickness import thin_to
from gearmesh.systems.spiral_bevel.synthesis.settings import ContactChoice, gear_sides, mean_point, pinion_side
from gearmesh.teeth.region import Side

#: largest excess of a tooth's thickness (mm, along the normal) that counts as rounding
MAX_THICKNESS_ROUNDING_MM = 1e-10

if TYPE_CHECKING:
    from gearmesh.systems.common.bevel.blank import BevelBlank
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign

#: requested contact by side of the pinion
Choices = dict[str, ContactChoice]


def cut_sides(design: FaceMilledDesign, blank: BevelBlank, choices: Choices) -> CutSides:
    """Return both sides of both members of a design (in mm) for the contact of `choices`.

    Raises NoSolutionError if no pinion has this contact. Raises DesignError for cutters that cannot exist, and for
    sides cut at once that leave too thick a tooth on the pinion.
    """
    gear = gear_sides(design, blank)
    pinion, turns = cut_pinion(design, blank, choices, gear)
    places = pinion_places(design, blank, pinion, turns)
    starts = {name: _start(design, blank, name, side.turned) for name, side in pinion.items()}
    cut = CutSides(blank, pinion, gear, (places, beside_space(gear, blank.gear.teeth)), turns, starts)
    if design.pinion.thickness is not None:
        _refuse_thicker(design.pinion.thickness, cut)
    elif design.completing and not design.indexed:
        _refuse_thick(design, cut)
    return cut


def cut_pinion(design: FaceMilledDesign, blank: BevelBlank, choices: Choices, gear: Sides) -> tuple[Sides, Angles]:
    """Return the pinion's sides, and by side the gear's rotation (rad) at contact.

    The rotation brings the gear, as cut, to contact with the pinion's side at its mean point. Raises as `cut_sides`.
    """
    nominal = nominal_base(blank, HAND_SIGNS[design.hand])
    means = {name: mean_point(design, blank, gear[MATING_SIDES[name]], nominal, choices[name]) for name in BLADE_SIDES}
    pinion = {name: pinion_side(design, blank, name, means[name]) for name in BLADE_SIDES}
    return pinion, {name: mean.gear_turn for name, mean in means.items()}


def _start(design: FaceMilledDesign, blank: BevelBlank, name: str, turned: float) -> float:
    """Return the rotation (rad) of the pinion from contact at the mean point to phi1 = 0.

    `turned` (rad) is the rotation of the pinion from cutting a side to contact. Machines that generate the mean point
    at cradle rotation 0 define phi1 = 0: the position as cut. If the cradle angle counts from elsewhere, as in a
    maker's summary, that position is far from any contact. phi1 = 0 is then contact at the mean point.
    """
    far = abs(turned) >= MAX_CONTACT_TURN_PITCHES * 2.0 * np.pi / blank.pinion.teeth
    fixed = design.pinion.side(name).mesh_angle is not None
    return 0.0 if far or fixed or design.mean_point != "cradle_zero" else -turned


def pinion_places(design: FaceMilledDesign, blank: BevelBlank, sides: Sides, gear_turns: Angles) -> Angles:
    """Return the index positions (rad) of the pinion's sides.

    They follow from the index angles or the thickness of the design, else from the backlash. `gear_turns` (rad):
    rotation of the gear, as cut, to contact with each side.
    """
    ratio = blank.gear.teeth / blank.pinion.teeth
    # positions without backlash: each side touches the gear; the turn of the gear is transferred to the pinion
    fitting = {name: turn * ratio for name, turn in gear_turns.items()}
    given = {name: design.pinion.side(name).index_angle for name in BLADE_SIDES}
    known = {name: angle for name, angle in given.items() if angle is not None}
    if len(known) == len(BLADE_SIDES):
        places = {}
    elif design.completing:
        places = _cut_at_once(blank, sides, fitting)
    else:
        thickness = design.pinion.thickness
        set_back = (
            thinning(design.backlash, blank) if thickness is None else thin_to(thickness, blank.pinion, sides, fitting)
        )
        places = {
            name: fitting[name] + (-set_back if side.flank is Side.LEFT else set_back) for name, side in sides.items()
        }
    # given index angles replace these positions
    in_space, hand = beside_space(sides, blank.pinion.teeth), HAND_SIGNS[design.hand]
    return places | {
        name: in_space[name] + hand * float(np.radians(angle)) - sides[name].turned for name, angle in known.items()
    }


def indexed_backlash(cut: CutSides) -> float:
    """Return the normal backlash (mm) at the mean point that the index positions of the pinion's sides leave."""
    ratio = cut.blank.gear.teeth / cut.blank.pinion.teeth
    gaps = [
        (cut.turns[name] * ratio - cut.places[0][name]) * (1.0 if side.flank is Side.LEFT else -1.0)
        for name, side in cut.pinion.items()
    ]
    return 0.5 * sum(gaps) / thinning(1.0, cut.blank)


def _refuse_thicker(thickness: float, cut: CutSides) -> None:
    """Raise DesignError for a pinion whose mean normal `thickness` (mm) does not fit the gear's tooth space."""
    lacking = -indexed_backlash(cut)
    if lacking <= MAX_THICKNESS_ROUNDING_MM:
        return
    most = at_most(thickness - lacking / float(np.cos(cut.blank.pressure_angle)))
    raise DesignError(
        "pinion.thickness",
        thickness,
        unit="mm",
        reason=f"the tooth is {lacking:.4g} mm too thick, along the normal, for the gear's tooth space",
        allowed=f"at most about {most} mm",
    )


def _cut_at_once(blank: BevelBlank, sides: Sides, fitting: Angles) -> Angles:
    """Return the index positions (rad) of the pinion's sides, both cut at once.

    The pinion is in the middle between the positions in which each side would touch the gear. The remaining gap is the
    backlash.
    """
    in_space = beside_space(sides, blank.pinion.teeth)
    # mean of the two index angles at which the one or the other side would touch the gear
    middle = 0.5 * sum(fitting[name] + side.turned - in_space[name] for name, side in sides.items())
    return {name: in_space[name] + middle - side.turned for name, side in sides.items()}


def _refuse_thick(design: FaceMilledDesign, cut: CutSides) -> None:
    """Raise DesignError for sides cut at once that leave a tooth too thick for the gear's space."""
    lacking = -indexed_backlash(cut)
    if lacking <= MAX_THICKNESS_ROUNDING_MM:
        return
    blades = {name: cut.pinion[name].blade.tip_radius for name in BLADE_SIDES}
    width = blades["concave"] - blades["convex"]
    least = at_least(width + lacking / float(np.cos(cut.blank.pressure_angle)))
    raise DesignError(
        "pinion.concave.tip_radius",
        blades["concave"],
        unit="mm",
        reason=f"it is {width:.6g} mm more than pinion.convex.tip_radius; the tooth is then {lacking:.4g} mm too thick for "
        "the gear's tooth space",
        allowed=f"about {least} mm more than pinion.convex.tip_radius, or above",
    )
