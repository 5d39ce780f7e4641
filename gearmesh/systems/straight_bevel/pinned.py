"""Values that straight bevel pairs leave to their build: blank, proportions and edge radii as they fit."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gearmesh.systems.common.bevel.iso23509.tooth_factors import (
    suggested_addendum_factor,
    suggested_depth_factor,
    suggested_thickness_factor,
)
from gearmesh.systems.straight_bevel.build import MEMBER_NAMES, straight_blank
from gearmesh.teeth.region import Side

if TYPE_CHECKING:
    from gearmesh.systems.common.pinned import Values
    from gearmesh.systems.straight_bevel.design import StraightBevelDesign
    from gearmesh.teeth.gear_train import GearTrain


def pinned_values(design: StraightBevelDesign, train: GearTrain) -> Values:
    """Return the values of a complete design in mm and its gear set."""
    blank = straight_blank(design)
    teeth, angles = (
        (blank.pinion.teeth, blank.gear.teeth),
        (blank.pinion.pitch_angle, blank.gear.pitch_angle),
    )
    suggested = {
        "depth_factor": suggested_depth_factor(teeth),
        "addendum_factor": suggested_addendum_factor(teeth, angles),
        "thickness_factor": suggested_thickness_factor(teeth),
    }
    values: Values = {
        key: value if getattr(design, key) is None else getattr(design, key) for key, value in suggested.items()
    }
    values |= {"face_width": blank.gear.face_width, "clearance": blank.clearance}
    for name, own in zip(MEMBER_NAMES, blank.members, strict=True):
        values[f"{name}.root_angle"] = float(np.degrees(own.root_angle))
        values[f"{name}.face_angle"] = float(np.degrees(own.face_angle))
        values[f"{name}.edge_radius"] = min(train.members[name].tooth.side(side).tool.tip_radius for side in Side)
    return values
