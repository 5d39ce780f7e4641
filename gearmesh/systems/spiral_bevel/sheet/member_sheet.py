"""Sheet of one member of a bevel pair: blank, cutters and machines, and measures of its teeth, without its mating gear."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gearmesh.systems.common.bevel.accuracy import tolerance_table
from gearmesh.systems.common.symbol_table import tables_of
from gearmesh.systems.spiral_bevel.build import cut_alone
from gearmesh.systems.spiral_bevel.hobbing.secondary_cut import HeadRoom
from gearmesh.systems.spiral_bevel.machine.pair import BLADE_SIDES, index_angles
from gearmesh.systems.spiral_bevel.sheet.dimension_sheet import CutTooth, measured_table, measures_of, point_width
from gearmesh.systems.spiral_bevel.sheet.sheet import (
    fit_edge_radius,
    head_part,
    member_rows,
    pair_rows_of,
    setting_tables,
    slot_rows,
)
from gearmesh.systems.spiral_bevel.sheet.slots import slot_widths_of
from gearmesh.systems.system import SheetTable

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign

#: rows of the blank that depend on the mating gear's cutter
PAIR_ROWS = ("mean normal thickness",)


def member_sheet(design: FaceMilledDesign, name: str) -> tuple[SheetTable, ...]:
    """Return the tables of the member "pinion" or "gear" of a design in its units. Raises as `build` does."""
    design_mm, unit, noun = design.in_mm(), design.mm_per_unit, design.units
    made = cut_alone(design_mm, name)
    pinion, member, blank = name == "pinion", made.cut.member, made.blank
    member_blank = blank.pinion if pinion else blank.gear
    sides = {key: fit_edge_radius(side, member) for key, side in made.sides.items()}
    slots = slot_widths_of(member.tooth, member_blank)
    angles = index_angles(made.sides, member_blank.teeth, made.places) if pinion and not design.hobbed else {}
    one_cutter = not design.hobbed and (not pinion or design_mm.completing)
    names = tuple(f"{name} {side}" for side in BLADE_SIDES)
    rows = [row for row in member_rows((member_blank,), unit, noun) if row[0] not in PAIR_ROWS]
    tooth = CutTooth(
        member,
        member_blank,
        sides,
        measures_of(member, member_blank, sides),
        float(slots.min()),
        point_width(sides) if one_cutter else None,
        around=pinion and bool(blank.offset),
    )
    return (
        SheetTable("Blank", (name,), (*rows, *slot_rows([slots], unit, noun))),
        SheetTable("Pair", ("",), pair_rows_of(blank, unit, noun)),
        *tables_of(
            *head_part(
                design, list(sides.values()), names, blank, lambda: [HeadRoom.of(member, made.sides, made.places)]
            )
        ),
        *setting_tables(
            list(sides.values()),
            names,
            tuple(float(np.degrees(angles[side])) for side in BLADE_SIDES) if angles else (),
            unit,
            noun,
        ),
        measured_table((tooth,), blank, unit, noun),
        tolerance_table(design_mm.accuracy_grade, blank, (name,)),
    )
