"""Sheet of a face gear drive: axodes [LF04 18.2], and the lines of contact of shaper, pinion and gear [LF04 18.4].

Shaper and gear touch along lines L_s2, with one pressure angle in each cross section of the shaper. Shaper and pinion,
which are parallel, touch along lines L_s1, all at the pressure angle of their mesh. Pinion and gear touch where both
pressure angles are equal.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gearmesh.systems.common.plain_sheet import plain_sheet
from gearmesh.systems.common.symbol_table import Row, table, tables_of
from gearmesh.systems.face_gear.build import covered_range, shaped_gear
from gearmesh.systems.face_gear.limits import ShapedGear
from gearmesh.systems.system import Sheet, SheetTable

if TYPE_CHECKING:
    from gearmesh.systems.face_gear.design import FaceGearDesign
    from gearmesh.teeth.gear_train import GearTrain

#: title of the table of axodes
AXODES_TITLE = "Axodes [LF04 18.2, 18.4]"
#: title of the table of lines of contact
LINES_TITLE = "Lines of contact on the shaper [LF04 18.4]"


def data_sheet(design: FaceGearDesign, train: GearTrain) -> Sheet:
    """Return derived keys, members and axes as for every system, then axodes and lines of contact."""
    given = design.in_mm()
    plain, shaped = plain_sheet(design, train), shaped_gear(given)
    face_gear_tables = tables_of(
        (AXODES_TITLE, lambda: _axodes(given, shaped)), (LINES_TITLE, lambda: _lines(given, shaped))
    )
    return Sheet((*plain.tables, *face_gear_tables), plain.values, plain.replaced)


def _axodes(design: FaceGearDesign, shaped: ShapedGear) -> SheetTable:
    """Return the half angles of the axodes of pinion or shaper and the gear.

    Crossed axes have hyperboloids and no half angles.
    """
    teeth, angle = (design.pinion.teeth, design.shaper_teeth), shaped.shaft_angle
    cones = [np.degrees(half_angles(count, shaped.teeth, angle)) for count in teeth]
    meet = shaped.offset == 0.0
    axis_distance = 0.5 * (teeth[1] - teeth[0]) * design.given_module
    rows: list[Row] = [
        ("gamma_1", "half angle of its axode", "deg", tuple(float(c[0]) if meet else None for c in cones)),
        ("gamma_2", "half angle of the gear's axode", "deg", tuple(float(c[1]) if meet else None for c in cones)),
        ("B", "distance of the axis from the pinion's", "mm", (0.0, axis_distance)),
        ("", "pitch point from the apex, along the axis", "mm", (shaped.pitch_distance if meet else None,) * 2),
    ]
    return table(AXODES_TITLE, ("pinion", "shaper"), rows)


def half_angles(teeth: int, mating_teeth: int, shaft_angle: float) -> tuple[float, float]:
    """Return the half angles (rad) of both axodes on intersecting axes, by tooth numbers [LF04 18.2.2]."""
    cosine, sine, ratio = np.cos(shaft_angle), np.sin(shaft_angle), mating_teeth / teeth
    return float(np.arctan2(sine, ratio + cosine)), float(np.arctan2(sine, 1.0 / ratio + cosine))


def _lines(design: FaceGearDesign, shaped: ShapedGear) -> SheetTable:
    """Pressure angles of L_s2 on both flanks, in sections of the shaper at toe, heel and the pinion's contacts."""
    toe, heel = covered_range(shaped, (design.gear.inner_radius, design.gear.outer_radius))
    right, left = (float(side.distance(np.array(side.shaper.pressure_angle))) for side in shaped.sides)
    sections = {"toe": toe, "contact, right": right, "contact, left": left, "heel": heel}
    places = np.array(list(sections.values()))
    kappa = [np.degrees(side.pressure_angle(places)).tolist() for side in shaped.sides]
    rows: list[Row] = [
        ("z", "from the apex, along the shaper's axis", "mm", tuple(sections.values())),
        ("kappa", "pressure angle of L_s2, right", "deg", tuple(kappa[0])),
        ("kappa", "pressure angle of L_s2, left", "deg", tuple(kappa[1])),
        ("alpha", "pressure angle of L_s1", "deg", (design.pressure_angle,) * len(sections)),
    ]
    return table(LINES_TITLE, tuple(sections), rows)
