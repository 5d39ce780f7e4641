"""Rows of the sheet of a bevel pair: dimensions of ISO 23509, ratios, and measures of the teeth as cut.

Lengths are in mm.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.systems.common.bevel.blank import BevelBlank, MemberBlank
from gearmesh.systems.common.bevel.contact_ratios import contact_ratios
from gearmesh.systems.common.bevel.iso23509.dimension_table import member_rows
from gearmesh.systems.common.bevel.iso23509.dimensions import FaceSpan, MemberDimensions
from gearmesh.systems.common.bevel.iso23509.pitch_cones import PitchCones
from gearmesh.systems.common.bevel.iso23509.tapers import MAX_TILT_RATIO, duplex_sum, standard_dedendum_angle
from gearmesh.systems.common.bevel.tooth_measures import ToothMeasures
from gearmesh.systems.common.symbol_table import Row
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Side

#: symbol, words, unit and value of a measure
ToothRow = tuple[str, str, str, "float | None"]

#: title of the table of measures
CUT_TEETH_TITLE = "Teeth as cut, measured on their flanks"
#: symbols of dimensions of ISO 23509 from which the teeth as cut may differ
NOMINAL_SYMBOLS = frozenset(
    (
        *("theta_a", "delta_f", "theta_f", "beta_e", "beta_m", "beta_i"),
        *("ham", "hfm", "hae", "hfe", "he", "hai", "hfi", "hi"),
        *("xsm", "smn", "smt", "smnc", "hamc", "dae", "dai", "dfe", "dfi", "txo", "txi", "tzR"),
    )
)
#: symbols of figures of a head cutter and of the spiral that it cuts
CUTTER_SYMBOLS = frozenset(("r_c0", "d_c0"))
#: index of the mean cone distance among the stations of the measures
MEAN_STATION = 1
#: largest difference (rad) of the sum of dedendum angles from the sum of a named taper
TAPER_ANGLE_TOLERANCE = 1e-9
#: millimetres per inch
MM_PER_INCH = 25.4


def member_dimensions(blank: BevelBlank, k: int, thickness: float) -> MemberDimensions:
    """Return the nominal dimensions of member `k` (0 pinion, 1 gear) in the terms of ISO 23509.

    `thickness`: mean normal circular thickness, mm.
    """
    member = blank.members[k]
    mean, (inner, outer), angle = member.mean_cone_distance, member.extent, member.pitch_angle
    module, alpha = blank.mean_normal_module, blank.pressure_angle
    depth, mating_depth = blank.standard_depths[k], blank.standard_depths[1 - k]
    thicker = thickness - 0.5 * np.pi * module - (depth.addendum - mating_depth.addendum) * np.tan(alpha)
    return MemberDimensions(
        teeth=member.teeth,
        pitch_angle=angle,
        face_angle=member.face_angle,
        root_angle=member.root_angle,
        addendum_angle=member.face_angle - angle,
        dedendum_angle=member.dedendum_angle,
        crossing_distance=float(mean * np.cos(angle)) - member.pitch_apex,
        pitch_apex=member.pitch_apex,
        face_apex=float(member.tip_radius / np.tan(member.face_angle)),
        root_apex=member.root_apex,
        mean_cone_distance=mean,
        mean_spiral_angle=member.spiral_angle,
        face=FaceSpan(outer - mean, mean - inner),
        spiral_angles=member.end_spiral_angles,
        mean_depth=depth,
        thickness_modification=float(0.5 * thicker / module),
        normal_thickness=thickness,
        normal_diameter=normal_diameter(member, alpha),
    )


def normal_diameter(member: MemberBlank, pressure_angle: float) -> float:
    """Return the diameter d_mn (mm) of the virtual gear in the normal section at the mean point [ISO 23509 (213)]."""
    across = (1.0 - (np.sin(member.spiral_angle) * np.cos(pressure_angle)) ** 2) * np.cos(member.pitch_angle)
    return 2.0 * member.mean_radius / float(across)


def iso_rows(blank: BevelBlank, dimensions: Sequence[MemberDimensions], members: Sequence[Member]) -> list[Row]:
    """Return the rows of dimensions of ISO 23509, mounting and turning, a column for pinion and gear each.

    - `dimensions`: nominal dimensions
    - `members`: pinion and gear
    """
    rows = [member_rows(member) for member in dimensions]
    iso: list[Row] = [("z", "teeth", "-", tuple(member.teeth for member in dimensions))]
    iso += [
        (symbol, f"{words}, nominal" if symbol in NOMINAL_SYMBOLS else words, kind, (value, gear_row[3]))
        for (symbol, words, kind, value), gear_row in zip(*rows, strict=True)
    ]  # fmt: skip
    return [*iso, *_mounting(blank, dimensions, members)]


def in_unit(rows: list[Row], unit: float, noun: str) -> list[Row]:
    """Return rows whose values in mm are converted to another unit."""
    return [
        (symbol, words, noun, tuple(v / unit if isinstance(v, float) else v for v in values))
        if kind == "mm"
        else (symbol, words, kind, values)
        for symbol, words, kind, values in rows
    ]


def ratio_rows(blank: BevelBlank, dimensions: Sequence[MemberDimensions], backlash: float) -> list[Row]:
    """Return the rows of ratios, depths and backlash.

    - `dimensions`: nominal dimensions of pinion and gear
    - `backlash`: mean normal backlash, mm
    """
    ratios, straight = contact_ratios(blank), math.isinf(blank.cutter_radius)
    gear = blank.gear
    outer, mean, beta = gear.outer_cone_distance, gear.mean_cone_distance, gear.spiral_angle
    module = 2.0 * outer * float(np.sin(gear.pitch_angle)) / gear.teeth
    dedenda = _dedenda(blank)
    transverse = backlash / float(np.cos(blank.pressure_angle) * np.cos(beta))
    steeper = float(np.cos(blank.pressure_angle) * np.cos(gear.end_spiral_angles[0]))
    deg = 180.0 / np.pi
    values: list[tuple[str, str, str, float | str]] = [
        ("u", "gear ratio", "-", gear.teeth / blank.pinion.teeth),
        ("Sigma", "shaft angle", "deg", blank.shaft_angle * deg),
        ("a", "offset", "mm", blank.offset),
        ("m_et", "outer transverse module", "mm", module),
        ("P_d", "outer transverse diametral pitch", "1/inch", MM_PER_INCH / module),
        ("m_mn", "mean normal module", "mm", blank.mean_normal_module),
        ("alpha_n", "nominal pressure angle", "deg", blank.pressure_angle * deg),
        ("r_c0", "cutter radius", "mm", blank.cutter_radius),
        ("d_c0", "cutter diameter", "mm", 2.0 * blank.cutter_radius),
        ("taper", "depth taper", "", _taper(blank)),
        ("theta_f", "sum of the dedendum angles", "deg", dedenda * deg),
        ("theta_fC", "the same of the duplex taper", "deg", _duplex(blank) * deg),
        ("h_mw", "mean working depth", "mm", blank.mean_working_depth),
        (
            "h_ew",
            "outer working depth",
            "mm",
            sum(member.depth(member.cone_distances[0]).addendum for member in dimensions),
        ),
        ("c", "clearance, nominal", "mm", blank.clearance),
        ("j_mn", "mean normal backlash", "mm", backlash),
        ("j_mt", "mean transverse backlash", "mm", transverse),
        ("j_en", "outer normal backlash", "mm", transverse * steeper * outer / mean),
        ("j_et", "outer transverse backlash", "mm", transverse * outer / mean),
        ("eps_v_alpha", "transverse contact ratio, virtual gears", "-", ratios.transverse),
        ("eps_v_beta", "face contact ratio", "-", ratios.face),
        ("eps_v_gamma", "modified contact ratio", "-", ratios.modified_ratio),
    ]
    return [
        (symbol, words, kind, (value,))
        for symbol, words, kind, value in values
        if not (straight and symbol in CUTTER_SYMBOLS)
    ]


def _taper(blank: BevelBlank) -> str:
    """Return the name of the taper that the root angles make."""
    mean = blank.gear.mean_cone_distance
    standard = sum(standard_dedendum_angle(member.mean_dedendum, mean) for member in blank.members)
    for name, angle in (
        ("uniform", 0.0),
        ("standard", standard),
        ("duplex", _duplex(blank)),
        ("tilted root line", MAX_TILT_RATIO * standard),
    ):
        if abs(_dedenda(blank) - angle) < TAPER_ANGLE_TOLERANCE:
            return name
    return "as given"


def _dedenda(blank: BevelBlank) -> float:
    """Return the sum (rad) of the dedendum angles.

    With offset it is the sum of the gear's dedendum and addendum angle; the pinion's dedendum follows the gear's
    addendum.
    """
    gear = blank.gear
    mating = gear.face_angle - gear.pitch_angle if blank.offset else blank.pinion.dedendum_angle
    return mating + gear.dedendum_angle


def _duplex(blank: BevelBlank) -> float:
    """Return the sum (rad) of the dedendum angles of the duplex taper."""
    pinion, gear = blank.members
    cones = PitchCones(
        method=0,
        teeth=(pinion.teeth, gear.teeth),
        shaft_angle=blank.shaft_angle,
        offset=blank.offset,
        pitch_angles=(pinion.pitch_angle, gear.pitch_angle),
        mean_cone_distances=(pinion.mean_cone_distance, gear.mean_cone_distance),
        spiral_angles=(pinion.spiral_angle, gear.spiral_angle),
        face_width=gear.face_width,
        outer_cone_distance=gear.outer_cone_distance,
    )
    return duplex_sum(cones, blank.pressure_angle, blank.cutter_radius)


def _mounting(blank: BevelBlank, dimensions: Sequence[MemberDimensions], members: Sequence[Member]) -> list[Row]:
    """Return the rows for mounting and turning; the back face is the body's, hub included."""
    backs = [member.tooth.blank.body.ends[1] for member in members]
    crowns = [(own.crown(own.outer_cone_distance), own.crown(own.inner_cone_distance)) for own in blank.members]
    # the cones at both ends are perpendicular to the pitch cone
    angles = tuple(float(np.degrees(member.pitch_angle)) for member in dimensions)
    return [
        ("t_B", "mounting distance: crossing point to back face", "mm", tuple(backs)),
        ("t_xoB", "crown to back face", "mm", tuple(b - outer for b, (outer, _) in zip(backs, crowns, strict=True))),
        ("t_xio", "front crown to crown", "mm", tuple(outer - inner for outer, inner in crowns)),
        ("delta_b", "back angle", "deg", angles),
        ("delta_v", "front angle", "deg", angles),
    ]


def measures_rows(own: MemberBlank, measures: ToothMeasures, pressure_angle: float) -> list[ToothRow]:
    """Return the measures of a tooth as cut: thicknesses, lands, depths, chord and outline.

    - `own`: blank of the member
    - `measures`: measures at inner, mean and outer cone distance
    - `pressure_angle`: mean normal pressure angle, rad
    """
    lines = measures.pitch_lines
    spirals = np.mean([lines.spiral_angles(side_of_tooth) for side_of_tooth in Side], axis=0)
    transverse, normal, lands = lines.transverse_thicknesses, lines.normal_thicknesses, measures.top_lands
    addenda, root = own.addendum_at(measures.stations), measures.root_heights
    rows: list[ToothRow] = []
    for k, (letter, place_name) in enumerate((("i", "inner"), ("m", "mean"), ("e", "outer"))):
        rows += [
            (f"beta_{letter}", f"{place_name} spiral angle", "deg", float(np.degrees(spirals[k]))),
            (f"s_{letter}t", f"{place_name} transverse circular thickness", "mm", float(transverse[k])),
            (f"s_{letter}n", f"{place_name} normal circular thickness", "mm", float(normal[k])),
            (f"s_a{letter}n", f"{place_name} normal top land", "mm", float(lands[k])),
            (f"h_a{letter}", f"{place_name} addendum", "mm", float(addenda[k])),
            (
                f"h_{letter}",
                f"{place_name} whole depth, in the middle of the space",
                "mm",
                float(addenda[k] - root[k]),
            ),
        ]
    tongue = _chordal_addendum(own, float(normal[MEAN_STATION]), float(addenda[MEAN_STATION]), pressure_angle)
    return [
        *rows,
        ("s_mnc", "mean normal chordal thickness, at the chordal addendum", "mm", measures.chord(MEAN_STATION, tongue)),
        ("h_amc", "mean chordal addendum", "mm", tongue),
        *_outline(own, measures, root),
    ]


def _chordal_addendum(own: MemberBlank, thickness: float, addendum: float, pressure_angle: float) -> float:
    """Return the depth (mm) of a calliper's tongue for a mean normal circular `thickness` and an `addendum` (mm).

    [ISO 23509 (215)].
    """
    diameter = normal_diameter(own, pressure_angle)
    rise = 1.0 - np.cos(thickness / diameter)
    return float(addendum + 0.5 * diameter * np.cos(own.pitch_angle) * rise)


def _outline(member: MemberBlank, measures: ToothMeasures, root: Array) -> list[ToothRow]:
    """Return the rows of the tip at the heel, and of the line through the middle of the root from toe to heel.

    `root`: heights (3,) of the root over the pitch cone, mm.
    """
    inner, _, outer = measures.stations
    c, s = np.cos(member.pitch_angle), np.sin(member.pitch_angle)
    (toe_rho, toe_z), (heel_rho, heel_z) = (
        (distance * s + height * c, distance * c - height * s - member.pitch_apex)
        for distance, height in ((inner, root[0]), (outer, root[2]))
    )
    slope = (heel_rho - toe_rho) / (heel_z - toe_z)
    return [
        ("d_ae", "outer tip diameter", "mm", float(2.0 * (outer * s + member.addendum_at(outer) * c))),
        ("t_xo", "crossing point to crown along the axis", "mm", member.crown(outer)),
        ("d_fe", "outer root diameter", "mm", float(2.0 * heel_rho)),
        ("delta_f", "root angle", "deg", float(np.degrees(np.arctan(slope)))),
        ("t_zR", "root apex beyond crossing point", "mm", float(heel_rho / slope - heel_z)),
    ]
