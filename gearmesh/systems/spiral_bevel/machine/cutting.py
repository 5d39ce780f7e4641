"""How a pair is cut: both sides of both members for the requested contact, and the positions of the sides on their teeth."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.systems.common.bounds import at_least, at_most
from gearmesh.systems.spiral_bevel.machine.index import FARTHEST
from gearmesh.systems.spiral_bevel.machine.pair import (
    HANDS,
    MATING,
    SIDES,
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

#: how much (mm) a tooth may be too thick for rounding
ROOM = 1e-10

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.blank.blank import BevelBlank
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign

#: what is asked of the contact, by the pinion's sides
Choices = dict[str, ContactChoice]


def cut_sides(design: FaceMilledDesign, blank: BevelBlank, choices: Choices) -> CutSides:
    """Both sides of both members of a design (in mm), for the contact that `choices` ask for.

    Raises NoSolutionError where no pinion gives it, DesignError for cutters that cannot exist, and where sides that are cut at once
    leave the pinion too thick a tooth.
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
    """The pinion's sides, and how far (rad) the gear, as cut, is turned when it meets each at its mean point.

    Raises as `cut_sides`.
    """
    nominal = nominal_base(blank, HANDS[design.hand])
    means = {name: mean_point(design, blank, gear[MATING[name]], nominal, choices[name]) for name in SIDES}
    pinion = {name: pinion_side(design, blank, name, means[name]) for name in SIDES}
    return pinion, {name: mean.gear_turn for name, mean in means.items()}


def _start(design: FaceMilledDesign, blank: BevelBlank, name: str, turned: float) -> float:
    """Rotation (rad) of the pinion from contact at the mean point, where a side is `turned` (rad) since it was cut, to phi1 = 0.

    Machines that generate the mean point at cradle rotation 0 define phi1 = 0: the position as cut. A cradle angle that counts from
    elsewhere, as in a maker's summary, puts that position far from any contact; phi1 = 0 is then contact at the mean point.
    """
    far = abs(turned) >= FARTHEST * 2.0 * np.pi / blank.pinion.teeth
    fixed = design.pinion.side(name).mesh_angle is not None
    return 0.0 if far or fixed or design.mean_point != "cradle_zero" else -turned


def pinion_places(design: FaceMilledDesign, blank: BevelBlank, sides: Sides, gear_turns: Angles) -> Angles:
    """Places (rad) of the pinion's sides, by the index angles or the thickness that the design gives, or by the backlash.

    Each side stands where the gear, as cut and turned by `gear_turns` (rad), touches it: turned back, it fits the gear's space.
    """
    ratio = blank.gear.teeth / blank.pinion.teeth
    fitting = {name: turn * ratio for name, turn in gear_turns.items()}
    given = {name: design.pinion.side(name).index_angle for name in SIDES}
    known = {name: angle for name, angle in given.items() if angle is not None}
    if len(known) == len(SIDES):
        places = {}
    elif design.completing:
        places = _cut_at_once(blank, sides, fitting)
    else:
        thickness = design.pinion.thickness
        away = (
            thinning(design.backlash, blank) if thickness is None else thin_to(thickness, blank.pinion, sides, fitting)
        )
        places = {name: fitting[name] + (-away if side.flank is Side.LEFT else away) for name, side in sides.items()}
    own, hand = beside_space(sides, blank.pinion.teeth), HANDS[design.hand]
    return places | {
        name: own[name] + hand * float(np.radians(angle)) - sides[name].turned for name, angle in known.items()
    }


def indexed_backlash(cut: CutSides) -> float:
    """The normal backlash (mm) that the places of the pinion's sides leave, at the mean point."""
    ratio = cut.blank.gear.teeth / cut.blank.pinion.teeth
    away = [
        (cut.turns[name] * ratio - cut.places[0][name]) * (1.0 if side.flank is Side.LEFT else -1.0)
        for name, side in cut.pinion.items()
    ]
    return 0.5 * sum(away) / thinning(1.0, cut.blank)


def _refuse_thicker(thickness: float, cut: CutSides) -> None:
    """Raises DesignError where a pinion of a given mean normal `thickness` (mm) has no room in the gear's space."""
    lacking = -indexed_backlash(cut)
    if lacking <= ROOM:
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
    """Places (rad) of both sides of the pinion in the middle of where each would fit the gear's space: what is left is backlash."""
    beside = beside_space(sides, blank.pinion.teeth)
    # how far the blank would have to be turned before each side was cut
    middle = 0.5 * sum(fitting[name] + side.turned - beside[name] for name, side in sides.items())
    return {name: beside[name] + middle - side.turned for name, side in sides.items()}


def _refuse_thick(design: FaceMilledDesign, cut: CutSides) -> None:
    """Raises DesignError where sides that are cut at once leave a tooth that is too thick for the gear's space."""
    lacking = -indexed_backlash(cut)
    if lacking <= ROOM:
        return
    blades = {name: cut.pinion[name].blade.tip_radius for name in SIDES}
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
