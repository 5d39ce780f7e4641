"""Spiral, zerol and straight bevel gears cut by head cutters [AB; CR3553; ISO 23509]."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.systems.spiral_bevel.flank_form import form_figures, form_warnings
from gearmesh.systems.spiral_bevel.pair import SIDES, bevel_pair
from gearmesh.systems.spiral_bevel.settings import longer_than_standard
from gearmesh.systems.spiral_bevel.teeth_choice import bevel_teeth, closing_teeth
from gearmesh.teeth.train import Train

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign
    from gearmesh.systems.spiral_bevel.teeth_choice import BevelTeeth


def build(design: FaceMilledDesign) -> Train:
    """The pair of a spiral bevel design (in mm).

    Raises DesignError for blanks and teeth that cannot exist, NoSolutionError where no pinion gives the contact asked for.
    """
    teeth = bevel_teeth(design)
    train = bevel_pair(design, teeth.cut, teeth.pinion, teeth.gear)
    forms = {name: choice.form for name, choice in teeth.choices.items()}
    told = form_figures(forms[design.contact.pinion_side])
    return replace(
        train,
        pairs=tuple(replace(pair, figures=told) for pair in train.pairs),
        warnings=(*train.warnings, *form_warnings(design, forms), *longer_than_standard(design, teeth.cut.blank)),
    )


def tried(design: FaceMilledDesign) -> BevelTeeth:
    """Fails as `build` does, but chooses a contact only where there are no teeth without."""
    return closing_teeth(design)


def sliding_bases(design: FaceMilledDesign) -> dict[str, float]:
    """Sliding bases that only geometry knows, of tilted cutters and of pairs with offset, in the design's units, by dotted key.

    Raises DesignError and NoSolutionError as `build`.
    """
    members = design.pinion.concave, design.pinion.convex, design.gear.cutter
    open_bases = [np.isnan(each.sliding_base) for each in members]
    if not any(open_bases):
        return {}
    cut = bevel_teeth(design.in_mm()).cut
    found = {"gear.cutter": cut.gear["concave"], **{f"pinion.{name}": cut.pinion[name] for name in SIDES}}
    keys = ("pinion.concave", "pinion.convex", "gear.cutter")
    return {
        f"{key}.sliding_base": found[key].settings.sliding_base / design.mm_per_unit
        for key, left_open in zip(keys, open_bases, strict=True)
        if left_open
    }
