"""Data sheet of a spline: size, members, measures, limits and clearance, form diameters, gaps of tooth pairs out of place."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from gearmesh.contact.first_touch.first_touch import touches
from gearmesh.contact.fit.fit import reversed_pair
from gearmesh.contact.flanks import solver_pair
from gearmesh.systems.common.plain_sheet import plain_sheet
from gearmesh.systems.common.symbol_table import Row, table, tables_of
from gearmesh.systems.cylindrical.measured import flank_radii
from gearmesh.systems.cylindrical.sheet import SheetGears, member_tables
from gearmesh.systems.cylindrical.single.drawn import THICKNESS_SYMBOLS, TOOTH_SYMBOLS
from gearmesh.systems.cylindrical.spline.build import gears_of, member_design
from gearmesh.systems.cylindrical.spline.design import MEMBER_NAMES, SHAFT_NAME
from gearmesh.systems.cylindrical.spline.fits import SplineFit, fit_of
from gearmesh.systems.system import DrawnRows, Sheet, SheetTable, complete_design
from gearmesh.teeth.gear_train import GearPair, GearTrain

if TYPE_CHECKING:
    from gearmesh.kernel.numeric.algebra import Array
    from gearmesh.systems.cylindrical.geometry.proportions import GearsProportions
    from gearmesh.systems.cylindrical.spline.design import SplineDesign

#: title of the table of the pair
SPLINE_TITLE = "Spline"
#: title of the table of thicknesses and widths
LIMITS_TITLE = "Thickness of the shaft's teeth, width of the hub's spaces, at d"
#: title of the table of clearances
CLEARANCE_TITLE = "Clearance at d"
#: title of the table of form diameters
FORM_TITLE = "Form diameters and the tips that reach them"
#: title of the table of gaps
GAPS_TITLE = "Gaps of the tooth pairs along the normal, without load, phi1 = 0"
#: titles of the tables of cylindrical gears that splines have
MEMBER_TITLES = (
    "Members",
    "Measures of the tooth thickness",
    "Root: tangent of 30 deg, internal 60 deg",
    "Bodies",
)
#: rows of the drawing
DRAWN_ROWS = DrawnRows(
    own=(
        *TOOTH_SYMBOLS,
        *THICKNESS_SYMBOLS,
        "M_dR",
        "d_B",
        "s, e",
        "max",
        "min",
        "max_v",
        "min_v",
        "lambda",
        "tolerance",
    ),
    mating=("z",),
    tip="d_a",
    reference=("d", "d"),
)


def spline_sheet(design: SplineDesign, train: GearTrain) -> Sheet:
    """Return the sheet of a design and the gear set built from it."""
    own = complete_design(design).in_mm()
    gears, members = gears_of(own), tuple(train.members[name] for name in MEMBER_NAMES)
    sheet_gears = SheetGears(member_design(own, SHAFT_NAME), gears, members)
    of_members = {made.title: made for made in member_tables(sheet_gears, MEMBER_NAMES)}
    derived, *plain = plain_sheet(own, train).tables
    fit, pair = fit_of(own, gears), train.pairs[0]
    own_tables = tables_of(
        (SPLINE_TITLE, lambda: _size(own, gears)),
        (LIMITS_TITLE, lambda: _limits(own, fit)),
        (CLEARANCE_TITLE, lambda: _clearance(fit)),
        (FORM_TITLE, lambda: _form(own, gears, train)),
    )
    errors = own.assembly.plain().values()
    gaps = tables_of((GAPS_TITLE, lambda: _gaps(pair, fit.base_radius))) if any(errors) else ()
    shown = [of_members[title] for title in MEMBER_TITLES if title in of_members]
    return Sheet((derived, *own_tables, *gaps, *shown, *plain), {})


def _size(design: SplineDesign, gears: GearsProportions) -> SheetTable:
    """Return the table of designation and size."""
    own = gears.gears[0].own
    rows: list[Row] = [
        ("designation", "designation", "", (design.designation,)),
        ("profile", "basic rack", "", (design.profile,)),
        ("m", "module", "mm", (own.module,)),
        ("alpha", "pressure angle", "deg", (math.degrees(own.alpha),)),
        ("z", "number of teeth", "-", (own.teeth,)),
        ("d_B", "reference diameter", "mm", (design.reference_diameter,)),
        ("x m", "profile shift of the shaft", "mm", (own.shift * own.module,)),
        ("d", "pitch diameter", "mm", (2.0 * own.radius,)),
        ("d_b", "base diameter", "mm", (2.0 * own.base_radius,)),
        ("p", "pitch", "mm", (math.pi * own.module,)),
    ]
    return table(SPLINE_TITLE, ("",), rows)


def _limits(design: SplineDesign, fit: SplineFit) -> SheetTable:
    """Return the table of thickness and space width: limits of actual and effective sizes."""
    both = fit.shaft, fit.hub
    tolerances = tuple(design.tolerance(name) or None for name in MEMBER_NAMES)
    rows: list[Row] = [
        ("tolerance", "tolerance class and deviation", "", tolerances),
        ("s, e", "nominal", "mm", tuple(own.nominal for own in both)),
        ("max_v", "effective, maximum of material", "mm", tuple(own.effective_most for own in both)),
        ("max", "actual, maximum of material", "mm", tuple(own.most for own in both)),
        ("min_v", "effective, minimum of material", "mm", tuple(own.effective_least for own in both)),
        ("min", "actual, minimum of material", "mm", tuple(own.least for own in both)),
        ("made", "as built", "mm", tuple(own.made for own in both)),
        ("T", "tolerance of the actual size", "mm", tuple(own.tolerance for own in both)),
        ("lambda", "effective variation", "mm", tuple(own.variation for own in both)),
    ]
    return table(LIMITS_TITLE, MEMBER_NAMES, rows)


def _clearance(fit: SplineFit) -> SheetTable:
    """Return the table of the clearance: on the pitch circle, along the normal, as a rotation."""
    values = fit.effective_least, fit.effective_largest, fit.made
    rows: list[Row] = [
        ("c_v", "circumferential, at d", "mm", values),
        ("c_vn", "along the normal", "mm", tuple(value * fit.base_radius / fit.radius for value in values)),
        ("phi_v", "rotation of the hub", "deg", tuple(math.degrees(value / fit.radius) for value in values)),
    ]
    return table(CLEARANCE_TITLE, ("least effective", "largest effective", "as built"), rows)


def _form(design: SplineDesign, gears: GearsProportions, train: GearTrain) -> SheetTable:
    """Return the table of form diameters, and how far the mating tips stay from them and from the roots."""
    (shaft_root, shaft_tip), (hub_root, hub_tip) = (flank_radii(train.members[name]) for name in MEMBER_NAMES)
    tips, roots = gears.tips, gears.roots
    standard = design.basic_rack.form_radius(design.counted_teeth) * gears.gears[0].own.module
    rows: list[Row] = [
        ("d_Ff", "root form diameter", "mm", (2.0 * shaft_root, 2.0 * hub_root)),
        ("d_Fa", "tip form diameter", "mm", (2.0 * shaft_tip, 2.0 * hub_tip)),
        ("D_F", "form diameter of ISO 4156, largest", "mm", (None if math.isnan(standard) else 2.0 * standard, None)),
        ("c_F", "form clearance: mating tip over it, radial", "mm", (tips[1] - shaft_root, hub_root - tips[0])),
        ("c", "clearance of its tip to the mating root, radial", "mm", (roots[1] - tips[0], tips[1] - roots[0])),
        ("g", "common height of both flanks", "mm", (min(shaft_tip, hub_root) - max(shaft_root, hub_tip), None)),
    ]
    return table(FORM_TITLE, MEMBER_NAMES, rows)


def _gaps(pair: GearPair, base_radius: float) -> SheetTable:
    """Return the table of the gaps of all tooth pairs, on the driving flanks and on the coast flanks."""
    drive, coast = tooth_gaps(pair, base_radius), tooth_gaps(reversed_pair(pair), base_radius)
    angles = np.degrees(np.arange(pair.pinion.tooth.teeth) * pair.pitch)
    rows: list[Row] = [
        (f"j_{k}", f"tooth {k} of the shaft, at {angle:.5g} deg", "um", (1e3 * float(drive[k]), 1e3 * float(coast[k])))
        for k, angle in enumerate(angles)
    ]
    return table(GAPS_TITLE, ("drive side", "coast side"), rows)


def tooth_gaps(pair: GearPair, base_radius: float) -> Array:
    """Return the gaps (z,), mm along the normal, of the shaft's teeth at phi1 = 0; 0 of the tooth that touches.

    Teeth are counted as their polar angles grow, from the tooth on x. All normals pass the axis at the base radius (mm).
    """
    flanks = solver_pair(pair)
    # tooth k is where tooth 0 is after a rotation by -k pitches, which is counted within half a turn
    low, _ = flanks.turn
    phi1 = low + np.mod(-np.arange(pair.pinion.tooth.teeth) * pair.pitch - low, 2.0 * np.pi)
    advance = touches(flanks, phi1)[0].advance
    return np.asarray((advance.max() - advance) * base_radius)
