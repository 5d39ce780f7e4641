"""Spiral, zerol and straight bevel gears cut by head cutters [AB; CR3553; ISO 23509]."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.systems.common.axes import gear_base
from gearmesh.systems.spiral_bevel.pair import MATES, SIDES, bevel_pair, thinning
from gearmesh.systems.spiral_bevel.settings import (
    basic_blank,
    gear_sides,
    longer_than_standard,
    mean_point,
    pinion_side,
)
from gearmesh.teeth.region import Side
from gearmesh.teeth.train import Train

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import SpiralBevelDesign


def build(design: SpiralBevelDesign) -> Train:
    """The pair of a spiral bevel design (in mm).

    Raises DesignError for blanks and teeth that cannot exist, NoSolutionError where no pinion gives the contact asked for.
    """
    blank = basic_blank(design)
    nominal = gear_base(blank.shaft_angle)
    gear = gear_sides(design, blank)
    means = {name: mean_point(design, blank, name, gear[MATES[name]], nominal) for name in SIDES}
    pinion = {name: pinion_side(design, blank, name, means[name]) for name in SIDES}
    ratio, away = blank.gear.teeth / blank.pinion.teeth, thinning(design, blank)
    # a pinion flank stands as it was cut when the gear is turned to its mean contact: turned back, it fits the gear's space
    pinion_places = {
        name: means[name].gear_turn * ratio + (-away if side.flank is Side.LEFT else away)
        for name, side in pinion.items()
    }
    # the cutter's space is at the x axis, the tooth between two of them half a pitch beside
    half_pitch = np.pi / blank.gear.teeth
    gear_places = {name: half_pitch if side.flank is Side.LEFT else -half_pitch for name, side in gear.items()}
    turns = {name: mean.gear_turn for name, mean in means.items()}
    train = bevel_pair(design, blank, pinion, gear, (pinion_places, gear_places), turns)
    return replace(train, warnings=(*train.warnings, *longer_than_standard(design, blank)))
