"""Sheet of a cycloidal drive: the curve of the pins in closed form, lost motion, forces of rigid discs."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.systems.common.plain_sheet import plain_sheet
from gearmesh.systems.common.symbol_table import Row, table, tables_of
from gearmesh.systems.cycloidal.build import Drive, hole_angle
from gearmesh.systems.cycloidal.design import DISC_NAME, RING_NAME
from gearmesh.systems.cycloidal.geometry import PinCurve
from gearmesh.systems.system import DrawnRows, Sheet, SheetTable

if TYPE_CHECKING:
    from gearmesh.systems.cycloidal.design import CycloidalDesign
    from gearmesh.teeth.gear_train import GearTrain

#: title of the table of members
MEMBERS_TITLE = "Cycloidal drive"
#: title of the table of the pair
CURVE_TITLE = "Curve of the pins"
#: title of the table of several discs
DISCS_TITLE = "Discs"
#: part of a pitch up to which angles of discs that are alike differ
SAME_ANGLE_PITCHES = 1e-9
#: title of the table of ratios
RATIOS_TITLE = "Ratios"


def data_sheet(design: CycloidalDesign, train: GearTrain) -> Sheet:
    """Return derived keys, members and axes as for every system, and the closed forms of the drive."""
    given = design.in_mm()
    plain, drive = plain_sheet(design, train), Drive(given)
    own = tables_of(
        (MEMBERS_TITLE, lambda: _members(given, drive)),
        (CURVE_TITLE, lambda: _curve(drive)),
        (RATIOS_TITLE, lambda: _ratios(given)),
    )
    if given.discs > 1:
        own = (*own, *tables_of((DISCS_TITLE, lambda: _discs(given))))
    derived, *rest = plain.tables
    return Sheet((derived, *own, *rest), plain.values, plain.replaced)


def _members(design: CycloidalDesign, drive: Drive) -> SheetTable:
    """Return the table of both members."""
    pins_first = not design.pins_in_ring
    turned = drive.lobe_radius(np.pi)
    tips = (
        2.0 * (drive.curve.circle + (1 if pins_first else -1) * drive.pin),
        (2.0 * turned if design.lobe_diameter is None and drive.ground.difference == 1 else design.lobe_diameter),
    )
    roots = design.support_diameter, 2.0 * drive.lobe_radius(0.0)
    radii = drive.curve.pitch_radius, drive.curve.pitch_radius * drive.curve.lobes / drive.curve.pins

    def both(
        of_pins: float | int | str | None, of_lobes: float | int | str | None
    ) -> tuple[float | int | str | None, ...]:
        return (of_pins, of_lobes) if pins_first else (of_lobes, of_pins)

    rows: list[Row] = [
        ("z", "pins or lobes", "-", (design.disc.teeth, design.ring.teeth)),
        ("form", "form", "", both("pins", "lobes")),
        ("D_p", "diameter of the pins' circle", "mm", both(2.0 * drive.curve.circle, None)),
        ("d_p", "diameter of the pins", "mm", both(2.0 * drive.pin, None)),
        ("D_p0", "diameter of the grinding pin's circle", "mm", both(None, 2.0 * drive.ground.circle)),
        ("d_p0", "diameter of the grinding pin", "mm", both(None, 2.0 * drive.grinding_pin)),
        ("d_w", "pitch diameter", "mm", both(2.0 * radii[0], 2.0 * radii[1])),
        ("d_a", "tip diameter", "mm", both(*tips)),
        ("d_f", "root diameter", "mm", both(*roots)),
    ]
    return table(MEMBERS_TITLE, (DISC_NAME, RING_NAME), rows)


def _curve(drive: Drive) -> SheetTable:
    """Return the table of the curve of the grinding pin and of the limits of the pin's size."""
    curve, ground = drive.curve, drive.ground
    phi, radius = ground.sharpest
    lobes = radius - drive.grinding_pin
    rows: list[Row] = [
        ("e", "eccentricity", "mm", (curve.eccentricity,)),
        ("K_1", "shortening: pitch radius over radius of the pins' circle", "-", (curve.shortening,)),
        ("beta_max", "largest angle between normal and ray to the pin", "deg", (math.degrees(curve.largest_lean),)),
        ("rho_min", "least radius of curvature of the lobes where they are convex", "mm", (lobes,)),
        ("phi_p", "there: rotation of the pins from the middle of a space", "deg", (math.degrees(phi),)),
        ("d_p,max", "largest diameter of the grinding pin without undercut", "mm", (2.0 * radius,)),
        (
            "A",
            "area inside of the lobes, without truncation and relief",
            "mm^2",
            (lobe_area(ground, drive.grinding_pin),),
        ),
        ("j", "lost motion of the ring, arm at rest, without relief", "deg", (math.degrees(drive.lost_motion),)),
    ]
    return table(CURVE_TITLE, ("",), rows)


def lobe_area(curve: PinCurve, pin: float) -> float | None:
    """Return the area (mm^2) inside of whole lobes beside a pin of a radius (mm); None where branches cross.

    The curve has the area pi (R^2 d + s e^2 N) and the length 4 d (R + r_w) E(m), m = 4 R r_w / (R + r_w)^2.
    """
    from scipy.special import ellipe

    if curve.difference != 1:
        return None
    big, small, out = curve.circle, curve.pitch_radius, curve.outside
    area = math.pi * (big**2 + out * curve.pins * curve.eccentricity**2)
    length = 4.0 * (big + small) * float(ellipe(4.0 * big * small / (big + small) ** 2))
    return area - out * pin * length + math.pi * pin**2


def _discs(design: CycloidalDesign) -> SheetTable:
    """Return the table of several discs: eccentrics, places, and holes against lobes."""
    lobe = 2.0 * math.pi / design.disc.teeth
    hole = 2.0 * math.pi / (1 if design.output is None else design.output.pins)
    angles = [hole_angle(design, arm) for arm in design.arm_angles]
    # a disc is another's copy if its holes are whole pitches of the lobes and of the holes away
    reached = [angle + k * hole for angle in angles[:1] for k in range(round(2.0 * math.pi / hole))]
    alike = [any(_whole((angle - other) / lobe) for other in reached) for angle in angles]
    rows: list[Row] = [
        ("theta", "angle of the eccentric", "deg", tuple(map(math.degrees, design.arm_angles))),
        ("z", "middle, from the first disc", "mm", design.disc_places),
    ]
    if design.output is not None:
        rows += [
            ("", "first hole, from tooth 0", "deg", tuple(map(math.degrees, angles))),
            ("", "same part as the first disc", "", tuple("yes" if same else "no" for same in alike)),
        ]
    return table(DISCS_TITLE, design.disc_names, rows)


def _whole(count: float) -> bool:
    """True for a whole number, but for rounding."""
    return abs(count - round(count)) < SAME_ANGLE_PITCHES


def _ratios(design: CycloidalDesign) -> SheetTable:
    """Return the table of the ratios of speeds with one part at rest."""
    disc, ring = design.disc.teeth, design.ring.teeth
    rows: list[Row] = [
        ("i", "eccentric to disc, ring at rest", "-", (-disc / (ring - disc),)),
        ("i", "eccentric to ring, disc kept from turning", "-", (ring / (ring - disc),)),
        ("u", "disc to ring, eccentric at rest", "-", (ring / disc,)),
    ]
    return table(RATIOS_TITLE, ("",), rows)


#: rows of the drawing
DRAWN_ROWS = DrawnRows(own=("z", "form", "D_p", "d_p", "D_p0", "d_p0", "d_f", "e", "K_1"), mating=("z",), tip="d_a")
