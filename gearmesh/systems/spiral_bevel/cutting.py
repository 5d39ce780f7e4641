"""How a pair is cut: both sides of both members for the contact that is asked of them, and how they stand in their teeth."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.systems.common.bounds import at_least
from gearmesh.systems.spiral_bevel.pair import (
    HANDS,
    MATES,
    SIDES,
    Angles,
    CutSides,
    Sides,
    beside_space,
    nominal_base,
    thinning,
)
from gearmesh.systems.spiral_bevel.settings import ContactChoice, gear_sides, mean_point, pinion_side
from gearmesh.teeth.region import Side

#: rotation (rad) that a tooth may be too thick for rounding
ROOM = 1e-12

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.blank import BevelBlank
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign

#: what is asked of the contact, by the pinion's sides
Choices = dict[str, ContactChoice]


def cut_sides(design: FaceMilledDesign, blank: BevelBlank, choices: Choices) -> CutSides:
    """Both sides of both members of a design (in mm), for the contact that `choices` ask for.

    Raises NoSolutionError where no pinion gives it, DesignError for cutters that cannot exist.
    """
    nominal, gear = nominal_base(blank, HANDS[design.hand]), gear_sides(design, blank)
    means = {name: mean_point(design, blank, gear[MATES[name]], nominal, choices[name]) for name in SIDES}
    pinion = {name: pinion_side(design, blank, name, means[name]) for name in SIDES}
    turns = {name: mean.gear_turn for name, mean in means.items()}
    places = pinion_places(design, blank, pinion, turns)
    return CutSides(blank, pinion, gear, (places, beside_space(gear, blank.gear.teeth)), turns)


def pinion_places(design: FaceMilledDesign, blank: BevelBlank, sides: Sides, gear_turns: Angles) -> Angles:
    """Places (rad) of the pinion's sides, by the index angles that the design gives, or by the backlash.

    Each side stands where the gear, as cut and turned by `gear_turns` (rad), touches it: turned back, it fits the gear's space.
    Raises DesignError where sides that are cut at once leave too thick a tooth.
    """
    ratio = blank.gear.teeth / blank.pinion.teeth
    fitting = {name: turn * ratio for name, turn in gear_turns.items()}
    given = {name: design.pinion.side(name).index_angle for name in SIDES}
    known = {name: angle for name, angle in given.items() if angle is not None}
    if len(known) == len(SIDES):
        found = {}
    elif design.completing:
        found = _cut_at_once(design, blank, sides, fitting)
    else:
        away = thinning(design, blank)
        found = {name: fitting[name] + (-away if side.flank is Side.LEFT else away) for name, side in sides.items()}
    own, hand = beside_space(sides, blank.pinion.teeth), HANDS[design.hand]
    return found | {
        name: own[name] + hand * float(np.radians(angle)) - sides[name].turned for name, angle in known.items()
    }


def indexed_backlash(design: FaceMilledDesign, cut: CutSides) -> float:
    """The normal backlash (mm) that the places of the pinion's sides leave, at the mean point."""
    ratio = cut.blank.gear.teeth / cut.blank.pinion.teeth
    away = [
        (cut.turns[name] * ratio - cut.places[0][name]) * (1.0 if side.flank is Side.LEFT else -1.0)
        for name, side in cut.pinion.items()
    ]
    return 0.5 * sum(away) / thinning(design.with_values({"backlash": 1.0}), cut.blank)


def _cut_at_once(design: FaceMilledDesign, blank: BevelBlank, sides: Sides, fitting: Angles) -> Angles:
    """Places (rad) of both sides of the pinion in the middle of where each would fit the gear's space: what is left is backlash.

    Raises DesignError where the tooth is too thick for it.
    """
    beside = beside_space(sides, blank.pinion.teeth)
    (left,), (right,) = (
        [name for name, side in sides.items() if side.flank is which] for which in (Side.LEFT, Side.RIGHT)
    )
    # how far the blank would have to be turned after it was cut
    turns = {name: fitting[name] + side.turned - beside[name] for name, side in sides.items()}
    room = turns[left] - turns[right]
    if not room >= -ROOM:
        # the rotation that half a normal backlash of 1 mm takes
        lacking = -0.5 * room / thinning(design.with_values({"backlash": 1.0}), blank)
        width = sides["concave"].blade.tip_radius - sides["convex"].blade.tip_radius
        least = at_least(width + lacking / float(np.cos(blank.pressure_angle)))
        raise DesignError(
            f"pinion.concave.tip_radius = {sides['concave'].blade.tip_radius:g} mm: {width:.6g} mm more than pinion.convex."
            f"tip_radius leaves a tooth {lacking:.4g} mm too thick for the gear's space; allowed is {least} mm more, or about that"
        )
    middle = 0.5 * (turns[left] + turns[right])
    return {name: beside[name] + middle - side.turned for name, side in sides.items()}
