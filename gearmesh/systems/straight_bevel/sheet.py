"""Sheet of a straight bevel pair: dimensions of ISO 23509, measures of the teeth, tolerances of ISO 17485, forces."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gearmesh.metrology.iso17485 import TOLERANCE_NAMES
from gearmesh.metrology.measured_teeth import InspectionBasis
from gearmesh.systems.common.axes import gear_base
from gearmesh.systems.common.bevel.accuracy import MEMBER_NAMES, tolerance_sizes, tolerance_table
from gearmesh.systems.common.bevel.forces import along_normal, by_formula, force_rows
from gearmesh.systems.common.bevel.machine_frame import own_axes
from gearmesh.systems.common.bevel.sheet_rows import (
    CUT_TEETH_TITLE,
    in_unit,
    iso_rows,
    measures_rows,
    member_dimensions,
    ratio_rows,
)
from gearmesh.systems.common.bevel.tooth_measures import ToothMeasures
from gearmesh.systems.common.plain_sheet import plain_sheet
from gearmesh.systems.common.symbol_table import Row, running_rows, table, tables_of
from gearmesh.systems.straight_bevel.build import cut_side, straight_blank
from gearmesh.systems.straight_bevel.generated import CrownCut, DiscCut
from gearmesh.systems.system import DrawnRows, Sheet, SheetTable
from gearmesh.teeth.region import Side

if TYPE_CHECKING:
    from gearmesh.systems.common.bevel.blank import BevelBlank, MemberBlank
    from gearmesh.systems.straight_bevel.design import StraightBevelDesign
    from gearmesh.teeth.gear_train import GearTrain

#: title of the table of ratios
RATIOS_TITLE = "Ratios, depths and backlash"
#: title of the table of dimensions
DIMENSIONS_TITLE = "Dimensions [ISO 23509]"
#: title of the table of tolerances
TOLERANCES_TITLE = "Tolerances [ISO 17485:2006]"
#: title of the table of disc cutters
DISCS_TITLE = "Disc cutters of the right flanks"
#: symbol, words and unit of its rows
DISC_ROWS = (
    ("r_c0", "radius where edge and land meet", "mm"),
    ("epsilon", "dish angle", "deg"),
    ("c_i", "crowning at the toe, on the pitch line", "mm"),
    ("c_e", "crowning at the heel, on the pitch line", "mm"),
    ("i", "tilt of the axis against the crown gear's axis", "deg"),
    ("x_c", "centre from the apex, along the pitch line", "mm"),
    ("y_c", "centre beside the pitch line, > 0 over the tooth", "mm"),
    ("h_c", "centre over the pitch plane", "mm"),
)
#: beginning of the symbols of spiral angles, which straight teeth do not have
SPIRAL_SYMBOL = "beta"
#: rows of a workshop drawing
DRAWN_ROWS = DrawnRows(
    own=(
        *("z", "m_et", "m_mn", "alpha_n", "delta", "delta_a", "delta_f", "Re", "Rm", "b"),
        *("de", "d_ae", "h_ae", "h_e", "h_am", "s_mnc", "h_amc", "tzF", "t_zR", "t_B", "t_xoB", "delta_b"),
        *("Sigma", "c", "j_en"),
    ),
    mating=("z",),
    tip="d_ae",
    reference=("di", "de"),
    tolerances=("B", *TOLERANCE_NAMES),
    accuracy="accuracy_grade",
    measured=CUT_TEETH_TITLE,
)


def straight_sheet(design: StraightBevelDesign, train: GearTrain) -> Sheet:
    """Return the sheet of a design in its own units and its gear set. Raises DesignError for an impossible blank."""
    own, unit, noun = design.in_mm(), design.mm_per_unit, design.units
    blank, members = straight_blank(own), tuple(train.members.values())
    dimensions = tuple(member_dimensions(blank, k, blank.members[k].thickness) for k in range(2))
    plain = plain_sheet(design, train)
    tables = tables_of(
        (
            RATIOS_TITLE,
            lambda: table(
                RATIOS_TITLE, ("",), in_unit(_straight(ratio_rows(blank, dimensions, own.backlash)), unit, noun)
            ),
        ),
        (
            DIMENSIONS_TITLE,
            lambda: table(
                DIMENSIONS_TITLE, MEMBER_NAMES, in_unit(_straight(iso_rows(blank, dimensions, members)), unit, noun)
            ),
        ),
        (CUT_TEETH_TITLE, lambda: _measured_table(blank, train, unit, noun)),
        (TOLERANCES_TITLE, lambda: tolerance_table(own.accuracy_grade, blank, MEMBER_NAMES)),
    )
    cut = [cut_side(own, blank, k, Side.RIGHT) for k in range(2)]
    if any(isinstance(side, DiscCut) for side in cut):
        tables = (*tables, *tables_of((DISCS_TITLE, lambda: _disc_table(blank, cut, unit, noun))))
    return Sheet((*tables, *plain.tables), plain.values, plain.replaced)


def _disc_table(blank: BevelBlank, cut: list[CrownCut | DiscCut], unit: float, noun: str) -> SheetTable:
    """Return the table of the discs that cut the right flanks; those of left flanks are their mirror images.

    Lengths are over `unit` (mm) in `noun`.
    """
    columns = [_disc_values(own, side) for own, side in zip(blank.members, cut, strict=True)]
    rows: list[Row] = [
        (symbol, words, kind, tuple(column[k] for column in columns))
        for k, (symbol, words, kind) in enumerate(DISC_ROWS)
    ]
    return table(DISCS_TITLE, MEMBER_NAMES, in_unit(rows, unit, noun))


def _disc_values(own: MemberBlank, side: CrownCut | DiscCut) -> tuple[float | None, ...]:
    """Return the values of DISC_ROWS of a member, in mm and deg; None for a member without discs."""
    if not isinstance(side, DiscCut):
        return (None,) * len(DISC_ROWS)
    blade, mean = side.blade, own.mean_cone_distance
    radius = float(np.hypot(*side.place.inverse.point(np.array([mean, 0.0, 0.0]))[:2]))
    # the edges turn about the axis by theta from the mean point to the ends of the face
    turns = np.arcsin((np.array(own.extent) - mean) / radius)
    toe, heel = (float(c) for c in radius * (1.0 - np.cos(turns)) * np.sin(blade.dish_angle))
    tilt = float(np.degrees(np.arccos(side.place.rotation[2, 2])))
    x, y, z = (float(coordinate) for coordinate in side.place.translation)
    return blade.radius, float(np.degrees(blade.dish_angle)), toe, heel, tilt, x, y, -z


def _straight(rows: list[Row]) -> list[Row]:
    """Return rows without those of spiral angles."""
    return [row for row in rows if not row[0].startswith(SPIRAL_SYMBOL)]


def _measured_table(blank: BevelBlank, train: GearTrain, unit: float, noun: str) -> SheetTable:
    """Return the table of measures of both teeth, lengths over `unit` (mm) in `noun`."""
    columns = []
    for own, name in zip(blank.members, MEMBER_NAMES, strict=True):
        stations = np.array([own.inner_cone_distance, own.mean_cone_distance, own.outer_cone_distance])
        measures = ToothMeasures(train.members[name].tooth, 1, stations, own.pitch_cone)
        columns.append(measures_rows(own, measures, blank.pressure_angle))
    rows: list[Row] = [
        (symbol, words, kind, (value, gear_row[3]))
        for (symbol, words, kind, value), gear_row in zip(*columns, strict=True)
    ]
    return table(CUT_TEETH_TITLE, MEMBER_NAMES, in_unit(_straight(rows), unit, noun))


def straight_forces(design: StraightBevelDesign, torque: float, speed: float | None) -> tuple[SheetTable, ...]:
    """Return the forces on the members for a torque (Nm) on the pinion, which turns at a speed (1/min)."""
    own = design.in_mm()
    blank = straight_blank(own)
    pinion, alpha, side = blank.pinion, blank.pressure_angle, Side(own.contact.flank)
    tangential = 1e3 * torque / pinion.mean_radius
    formulas = [by_formula(tangential, member, alpha, 1) for member in blank.members]
    # the crown gear's flank touches both members in the mean point, on the x axis of the pinion's frame
    c, s = np.cos(pinion.pitch_angle), np.sin(pinion.pitch_angle)
    point = pinion.mean_cone_distance * np.array([s, 0.0, c])
    normal = own_axes(pinion.pitch_angle) @ np.array([0.0, -side.sign * np.cos(alpha), -np.sin(alpha)])
    normals = along_normal(1e3 * torque, point, normal, gear_base(blank.shaft_angle))
    ratio = own.gear.teeth / own.pinion.teeth
    speeds = None if speed is None else (speed, speed / ratio)
    forces = table(f"Forces for {torque:g} Nm on the pinion", MEMBER_NAMES, force_rows(formulas, normals))
    running = table("Torque, speed and power", MEMBER_NAMES, running_rows((torque, torque * ratio), speeds))
    return (forces,) if speed is None else (forces, running)


def straight_inspection(design: StraightBevelDesign, train: GearTrain, name: str) -> InspectionBasis:
    """Return the inspection basis of the "pinion" or the "gear" of a design.

    Pitch and runout have tolerances, flanks have none.
    """
    own = design.in_mm()
    return InspectionBasis(tolerance_sizes(straight_blank(own), MEMBER_NAMES.index(name)), own.accuracy_grade)
