"""Table of the head of a face-hobbed pair, and the values by which a file keeps it."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.systems.common.bevel.blank import BevelBlank
from gearmesh.systems.common.bevel.iso23509.tooth_line import FaceCutter, ToothLine, Value
from gearmesh.systems.common.bevel.sheet_rows import in_unit
from gearmesh.systems.common.symbol_table import Row, table
from gearmesh.systems.spiral_bevel.hobbing.sides import HobbedContact
from gearmesh.systems.spiral_bevel.machine.pair import BLADE_SIDES
from gearmesh.systems.system import SheetTable

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import SpiralBevelDesign
    from gearmesh.systems.spiral_bevel.machine.generated import Generated


def tooth_line(side: Generated, blank: BevelBlank) -> ToothLine:
    """Return the tooth line that a side's blade cuts on the crown gear."""
    assert side.indexing is not None
    cutter = FaceCutter(side.indexing.radius, side.indexing.blade_groups)
    nominal = blank.tooth_line
    return ToothLine(cutter, nominal.mean_cone_distance, nominal.spiral_angle, nominal.crown_teeth)


def head_table(sides: list[Generated], names: tuple[str, ...], blank: BevelBlank, unit: float, noun: str) -> SheetTable:
    """Return the table of the head, a column per side; lengths over `unit` (mm) in `noun`."""
    lines = [tooth_line(side, blank) for side in sides]
    toe, heel = blank.gear.extent

    def row(symbol: str, words: str, kind: str, value: Callable[[ToothLine], Value]) -> Row:
        return symbol, words, kind, tuple(float(value(line)) for line in lines)

    groups, teeth = blank.blade_groups, [side.indexing.teeth for side in sides if side.indexing is not None]
    rows: list[Row] = [
        ("z_0", "blade groups", "-", tuple(groups for _ in lines)),
        ("z_p", "teeth of the crown gear", "-", tuple(float(line.crown_teeth) for line in lines)),
        row("r_c0", "cutter radius at the pitch point", "mm", lambda line: line.cutter.radius),
        row(
            "nu",
            "lead angle of the cutter: angle between blade and radius",
            "deg",
            lambda line: np.degrees(line.lead_angle),
        ),
        row("rho_P0", "crown gear to cutter distance", "mm", lambda line: line.centre_distance),
        row("rho_b", "epicycloid base circle radius", "mm", lambda line: line.base_radius),
        row("rho_r", "rolling circle radius", "mm", lambda line: line.centre_distance - line.base_radius),
        row("rho_mb", "radius of curvature of the tooth line", "mm", lambda line: 1.0 / line.curvature),
        row("beta_e", "outer spiral angle", "deg", lambda line: np.degrees(line.spiral_angle_at(heel))),
        row("beta_i", "inner spiral angle", "deg", lambda line: np.degrees(line.spiral_angle_at(toe))),
        ("z_0/z", "turns of the blank per turn of the cutter", "-", tuple(groups / z for z in teeth)),
    ]
    return table("Face hobbing head [ISO 23509]", names, in_unit(rows, unit, noun))


def head_values(design: SpiralBevelDesign, blank: BevelBlank, unit: float) -> dict[str, float]:
    """Return head and crownings of a design (in mm) by dotted key, lengths over `unit` (mm)."""
    values = {"head.radius": blank.cutter_radius / unit}
    for name in BLADE_SIDES:
        contact = HobbedContact.of(design, blank, name)
        if design.head.eccentricity is None:
            values[f"pinion.{name}.ease_off.length_crowning"] = contact.length_crowning / unit
        values[f"pinion.{name}.ease_off.profile_crowning"] = contact.profile_crowning / unit
    return values
