"""The sheet of a circular-arc pair: theta of its point of contact, in closed form and exactly [LT85]."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from gearmesh.contact.flanks import analyse
from gearmesh.systems.circular_arc.contact_angle import contact_angle, setting_change
from gearmesh.systems.common.plain_sheet import plain_sheet
from gearmesh.systems.common.symbol_table import tables_of
from gearmesh.systems.system import Sheet, SheetTable, complete_design

if TYPE_CHECKING:
    from gearmesh.systems.circular_arc.design import CircularArcDesign
    from gearmesh.teeth.gear_train import GearTrain

#: title of the table
CONTACT_TITLE = "Point of contact [LT85]"


def contact_sheet(design: CircularArcDesign, train: GearTrain) -> Sheet:
    """Return the sheet of a design and the gear set built from it.

    It contains the tables that every system has.
    """
    own = complete_design(design).in_mm()
    derived, *plain = plain_sheet(own, train).tables
    return Sheet((derived, *tables_of((CONTACT_TITLE, lambda: _contact_table(own, train))), *plain), {})


def _contact_table(design: CircularArcDesign, train: GearTrain) -> SheetTable:
    """Return theta by the formulas and on the exact contact at phi1 = 0; None if there is none. Lengths are in mm."""
    change, delta = design.assembly.dC, setting_change(design)
    racks, moved = contact_angle(design), contact_angle(design, change)
    path = analyse(train.pairs[0], np.zeros(1))
    exact = float(path.params1[0, 0]) if path.kind[0] == "point" else np.nan
    difference = design.pinion.profile_radius - design.gear.profile_radius
    h1, h2 = (member.pitch_radius * np.tan(np.radians(member.lead_angle)) for member in (design.pinion, design.gear))
    rows = (
        ("theta0", "specified pressure angle (pressure_angle)", "deg", design.pressure_angle),
        ("theta", "of the racks' settings b_F, b_P (32, 35)", "deg", _degrees(racks)),
        ("theta", "with the change dC of the centre distance (31)", "deg", _degrees(moved)),
        ("theta_F", "on the exact contact at phi1 = 0 (19, 20)", "deg", _degrees(exact)),
        ("dtheta/dC", "by (31)", "deg/mm", _degrees(1.0 / (difference * np.cos(moved)))),
        ("Delta b_F", "that brings theta0 back (33, 36); of b_P the opposite", "mm", delta),
        ("b_F", "with it", "mm", design.pinion.b + delta),
        ("h1", "screw parameter of the pinion (4)", "mm/rad", float(h1)),
        ("h2", "screw parameter of the gear (4)", "mm/rad", float(h2)),
        ("h1 N2/(h2 N1)", "1 where the ratio is uniform (3)", "-", float(h1 / h2 / train.pairs[0].ratio)),
    )
    return SheetTable(
        CONTACT_TITLE,
        ("",),
        tuple((item, unit, value) for _, item, unit, value in rows),
        tuple(symbol for symbol, *_ in rows),
    )


def _degrees(angle: float) -> float | None:
    """Return an angle in deg; None if it is NaN."""
    return None if np.isnan(angle) else float(np.degrees(angle))
