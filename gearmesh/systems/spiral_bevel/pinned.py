"""Values that bevel pairs leave to their build: settings of the sheet, and proportions of the blank."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gearmesh.systems.common.bevel.iso23509.tooth_factors import suggested_thickness_factor
from gearmesh.systems.spiral_bevel.blank.proportion_choice import factors
from gearmesh.systems.spiral_bevel.design import ONE_SIDE_KEYS
from gearmesh.systems.spiral_bevel.sheet.sheet import edge_radius, settings_sheet
from gearmesh.systems.spiral_bevel.synthesis.teeth_choice import bevel_teeth
from gearmesh.teeth.region import Side

if TYPE_CHECKING:
    from gearmesh.systems.common.pinned import Values
    from gearmesh.systems.spiral_bevel.conjugate.design import ConjugateDesign
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign
    from gearmesh.teeth.gear_train import GearTrain


def settings_values(design: FaceMilledDesign, train: GearTrain) -> Values:
    """Return the values of a complete design in mm and its gear set."""
    sheet, made = settings_sheet(design, train), bevel_teeth(design)
    blank, given = made.cut.blank, made.proportions
    depth, share = factors(given, blank)
    thicker = given.thickness_factor
    teeth = blank.pinion.teeth, blank.gear.teeth
    sides = {
        "pinion.concave": made.cut.pinion["concave"],
        "pinion.convex": made.cut.pinion["convex"],
        **({} if design.hobbed else {"gear.cutter": made.cut.gear["concave"]}),
    }
    roots = {key: float(np.degrees(side.settings.machine_root_angle)) for key, side in sides.items()}
    factor_values: Values = {
        "depth_factor": depth,
        "addendum_factor": share,
        "thickness_factor": suggested_thickness_factor(teeth) if thicker is None else thicker,
    }
    if design.one_crown_gear:
        return {**sheet.values, **factor_values}
    values: Values = {
        **sheet.values,
        **sheet.following,
        **{f"{key}.machine_root_angle": angle for key, angle in roots.items()},
        **{f"{key}.sliding_base": side.settings.sliding_base for key, side in sides.items()},
        **factor_values,
        **{f"pinion.{name}.mesh_angle": float(np.degrees(angle)) for name, angle in made.cut.mesh_angles.items()},
        **dict.fromkeys((*sheet.replaced, "pinion.thickness")),
    }
    return _one_machine(values) if design.completing else values


def _one_machine(values: Values) -> Values:
    """Return values in which sides cut at once have equal settings to the last digit, those of the concave side."""
    return {
        key: values.get(f"pinion.concave.{leaf}", value)
        if key.startswith("pinion.convex.") and (leaf := key.rpartition(".")[2]) not in ONE_SIDE_KEYS
        else value
        for key, value in values.items()
    }


def conjugate_values(design: ConjugateDesign, train: GearTrain) -> Values:
    """Return the values of a complete conjugate design in mm and its gear set: face width, and edge radii as they fit."""
    toe, heel = train.members["gear"].tooth.blank.faces
    values: Values = {"face_width": heel - toe}
    for name, member in train.members.items():
        values[f"{name}.edge_radius"] = min(edge_radius(member, flank) for flank in Side)
    return values
