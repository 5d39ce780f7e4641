"""The data sheet of one gear without a mating gear: the rows of a pair's sheet that do not depend on the mesh."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gearmesh.systems.common.plain_sheet import plain_sheet
from gearmesh.systems.common.symbol_table import Row, tables_of
from gearmesh.systems.cylindrical.double_helical import first_halves
from gearmesh.systems.cylindrical.geometry.geometry import Toothing
from gearmesh.systems.cylindrical.geometry.proportions import GearsProportions
from gearmesh.systems.cylindrical.sheet import SheetGears, half_tables, member_tables, side_tables
from gearmesh.systems.cylindrical.single.build import proportions
from gearmesh.systems.system import Sheet, complete_design
from gearmesh.teeth.gear_train import GearTrain

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.single.design import SingleGearDesign


def single_sheet(design: SingleGearDesign, train: GearTrain) -> Sheet:
    """Return the sheet of a design and the gear built from it."""
    own = complete_design(design).in_mm()
    members = tuple(train.members.values())
    gears = SheetGears(first_halves(own), GearsProportions((proportions(own),)), members)
    # the table of axes is left out: there is no pair
    derived, plain, _ = plain_sheet(own, train).tables
    # rows of both sides of asymmetric teeth are in the table of their sides
    rows = tables_of(("Gear", lambda: side_tables("Gear", [_toothing_rows(side) for side in gears.teeth[0].sides])[:1]))
    names = tuple(train.members)
    return Sheet((derived, *half_tables(own, members), *rows, *member_tables(gears, names), plain), {})


def _toothing_rows(own: Toothing) -> list[Row]:
    """Return the rows of the basic rack and the helix."""
    values = (
        ("m_n", "normal module", "mm", own.module),
        ("m_t", "transverse module", "mm", own.transverse_module),
        ("alpha_n", "normal pressure angle", "deg", math.degrees(own.alpha)),
        ("alpha_t", "transverse pressure angle", "deg", math.degrees(own.alpha_t)),
        ("beta", "helix angle", "deg", math.degrees(abs(own.beta))),
        ("beta_b", "base helix angle", "deg", math.degrees(abs(own.beta_b))),
        ("p_n", "normal pitch", "mm", math.pi * own.module),
        ("p_t", "transverse pitch", "mm", math.pi * own.transverse_module),
        ("p_et", "transverse base pitch", "mm", own.base_pitch),
    )
    return [(symbol, words, unit, (value,)) for symbol, words, unit, value in values]
