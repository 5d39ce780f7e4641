"""Blank of a pair without offset by the keys of its design."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gearmesh.systems.common.bevel.blank import BasicData, BevelBlank, Proportions, roots_through_apex, tapered_blank
from gearmesh.systems.common.bevel.cone_blank import ConeData, cone_blank

if TYPE_CHECKING:
    from gearmesh.systems.common.bevel.design import ProportionedDesign


def proportions(design: ProportionedDesign) -> Proportions:
    """Return the tooth proportions that a design in mm gives."""
    members = (design.pinion, design.gear)
    pinion_root, gear_root = (_given_radians(spec.root_angle) for spec in members)
    pinion_face, gear_face = (_given_radians(spec.face_angle) for spec in members)
    return Proportions(
        design.depth_factor,
        design.addendum_factor,
        design.thickness_factor,
        design.clearance,
        (pinion_root, gear_root),
        (pinion_face, gear_face),
    )


def pair_blank(
    design: ProportionedDesign, data: BasicData, given: Proportions, cutter_radius: float | None, backlash: float
) -> BevelBlank:
    """Return the blank of a design in mm by its taper.

    - `data`: basic data of the pair
    - `given`: proportions of the teeth
    - `cutter_radius`: radius of the gear's cutter, mm; None for a nominal cutter, infinite for straight teeth
    - `backlash`: normal backlash, mm

    Raises DesignError for a blank that cannot exist.
    """
    if design.taper == "standard" and roots_through_apex(data, given):
        return tapered_blank(data, given, cutter_radius, backlash)
    return cone_blank(ConeData.of_bevel(data, cutter_radius, design.taper), given, backlash)


def _given_radians(degrees: float | None) -> float | None:
    """Return an angle in rad, or None if it is left out."""
    return None if degrees is None else float(np.radians(degrees))
