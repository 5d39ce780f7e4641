"""Table of the head of a face-hobbed pair, and the values by which a file keeps it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.systems.common.bevel.blank import BevelBlank
from gearmesh.systems.common.bevel.iso23509.tooth_line import FaceCutter, ToothLine, Value
from gearmesh.systems.common.bevel.sheet_rows import in_unit
from gearmesh.systems.common.symbol_table import Row, table
from gearmesh.systems.spiral_bevel.hobbing.secondary_cut import HeadRoom
from gearmesh.systems.spiral_bevel.hobbing.sides import HobbedContact
from gearmesh.systems.spiral_bevel.machine.pair import BLADE_SIDES
from gearmesh.systems.system import SheetTable

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import FaceMilledDesign
    from gearmesh.systems.spiral_bevel.machine.generated import Generated


def tooth_line(side: Generated, blank: BevelBlank) -> ToothLine:
    """Return the tooth line that a side's blade cuts on the crown gear."""
    assert side.indexing is not None
    return replace(blank.tooth_line, cutter=FaceCutter(side.indexing.radius, side.indexing.blade_groups))


def head_table(
    sides: list[Generated],
    names: tuple[str, ...],
    blank: BevelBlank,
    rooms: Sequence[HeadRoom],
    unit: float,
    noun: str,
    *,
    one_crown_gear: bool,
) -> SheetTable:
    """Return the table of the head, a column per side; lengths over `unit` (mm) in `noun`.

    `rooms`: room for the blades of each member. The tooth line of a pinion with a crown gear of its own is not that of
    its machine: its rows have no value.
    """
    lines = [tooth_line(side, blank) for side in sides]
    alike = [one_crown_gear or not name.startswith("pinion") for name in names]
    toe, heel = blank.gear.extent
    heads = [(side.settings, side.indexing) for side in sides if side.indexing is not None]
    # a gear that is not generated has the crown gear of its blank
    crowns = [
        float(line.crown_teeth) if machine.formate else index.teeth / machine.ratio_of_roll
        for line, (machine, index) in zip(lines, heads, strict=True)
    ]
    bases = [
        machine.radial / (1.0 + index.blade_groups / crown)
        for (machine, index), crown in zip(heads, crowns, strict=True)
    ]

    def row(symbol: str, words: str, kind: str, value: Callable[[ToothLine], Value]) -> Row:
        return (
            symbol,
            words,
            kind,
            tuple(float(value(line)) if own else None for line, own in zip(lines, alike, strict=True)),
        )

    rows: list[Row] = [
        ("z_0", "blade groups", "-", tuple(index.blade_groups for _, index in heads)),
        ("z_p", "teeth of the crown gear", "-", tuple(crowns)),
        ("r_c0", "cutter radius at the mean point", "mm", tuple(index.radius for _, index in heads)),
        (
            "nu",
            "lead angle of the cutter: angle between blade and radius",
            "deg",
            tuple(abs(float(np.degrees(index.offset_angle))) for _, index in heads),
        ),
        ("rho_P0", "crown gear to cutter distance", "mm", tuple(machine.radial for machine, _ in heads)),
        ("rho_b", "epicycloid base circle radius", "mm", tuple(bases)),
        (
            "rho_r",
            "rolling circle radius",
            "mm",
            tuple(machine.radial - base for (machine, _), base in zip(heads, bases, strict=True)),
        ),
        row("rho_mb", "radius of curvature of the tooth line", "mm", lambda line: 1.0 / line.curvature),
        row("beta_e", "outer spiral angle", "deg", lambda line: np.degrees(line.spiral_angle_at(heel))),
        row("beta_i", "inner spiral angle", "deg", lambda line: np.degrees(line.spiral_angle_at(toe))),
        (
            "z_0/z",
            "turns of the blank per turn of the cutter",
            "-",
            tuple(index.blade_groups / index.teeth for _, index in heads),
        ),
        # a blade group cuts one tooth out of so many
        (
            "(z_0, z)",
            "common factor of blade groups and teeth; 1: each group cuts each tooth",
            "-",
            tuple(math.gcd(index.blade_groups, index.teeth) for _, index in heads),
        ),
        (
            "W_b",
            "point width of blades that together clear the widest slot",
            "mm",
            tuple(room.width for room in rooms for _ in room.sides),
        ),
        (
            "j_b",
            "least room from the flank to such a blade of the other side; < 0: secondary cut",
            "mm",
            tuple(cut.least for room in rooms for cut in room.sides.values()),
        ),
    ]
    return table("Face hobbing head [ISO 23509]", names, in_unit(rows, unit, noun))


def head_values(design: FaceMilledDesign, blank: BevelBlank, unit: float) -> dict[str, float]:
    """Return head and crownings of a design (in mm) by dotted key, lengths over `unit` (mm)."""
    values: dict[str, float] = {}
    for name in BLADE_SIDES:
        contact = HobbedContact.of(design, blank, name)
        if design.head.eccentricity is None:
            values[f"pinion.{name}.ease_off.length_crowning"] = contact.length_crowning / unit
        values[f"pinion.{name}.ease_off.profile_crowning"] = contact.profile_crowning / unit
    return values
