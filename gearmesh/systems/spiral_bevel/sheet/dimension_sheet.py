"""Dimension sheet of a bevel pair: dimensions of ISO 23509, and measures of the teeth as cut.

The dimensions of ISO 23509 are nominal. Their thicknesses follow from the cutters' blades at the pitch line. They
therefore include a given point width, but not given machine settings. Measures are computed on the exact flanks and
roots: see `tooth_measures`. Lengths are in the design's units.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.systems.common.symbol_table import Row, table
from gearmesh.systems.spiral_bevel.blank.blank import BevelBlank, MemberBlank
from gearmesh.systems.spiral_bevel.iso23509.dimension_table import member_rows
from gearmesh.systems.spiral_bevel.iso23509.dimensions import FaceSpan, MemberDimensions
from gearmesh.systems.spiral_bevel.iso23509.pitch_cones import PitchCones
from gearmesh.systems.spiral_bevel.iso23509.tapers import MAX_TILT_RATIO, duplex_sum, standard_dedendum_angle
from gearmesh.systems.spiral_bevel.machine.generated import Generated
from gearmesh.systems.spiral_bevel.sheet.contact_ratios import contact_ratios
from gearmesh.systems.spiral_bevel.sheet.tooth_measures import ToothMeasures
from gearmesh.systems.system import SheetTable
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Side
from gearmesh.tools.head_cutter import Blade

#: names of the members in order
MEMBER_NAMES = ("pinion", "gear")
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
#: width (mm) by which two blades together are wider than the narrowest slot [AGMA 929]
BLADE_OVERLAP_MM = 0.05
#: width (mm) of the flat that a rounding leaves at the tip of a blade [AGMA 929]
BLADE_FLAT_MM = 0.2
#: index of the mean cone distance among the stations of the measures
MEAN_STATION = 1
#: largest difference (rad) of the sum of dedendum angles from the sum of a named taper
TAPER_ANGLE_TOLERANCE = 1e-9
#: millimetres per inch
MM_PER_INCH = 25.4


@dataclass(frozen=True)
class CutPair:
    """A pair as it is cut."""

    #: blank of the pair
    blank: BevelBlank
    #: sides of the pinion, "concave" and "convex"
    pinion: dict[str, Generated]
    #: sides of the gear, "concave" and "convex"
    gear: dict[str, Generated]
    #: pinion and gear
    members: tuple[Member, Member]
    #: normal backlash between the contacts of both sides at their mean points, mm
    backlash: float
    #: True if one cutter cuts both sides of the pinion
    at_once: bool

    @cached_property
    def measures(self) -> tuple[ToothMeasures, ToothMeasures]:
        """Measures of the teeth of pinion and gear at inner, mean and outer cone distance."""
        sides = self.pinion, self.gear
        pinion_measures, gear_measures = (
            measures_of(member, member_blank, member_sides)
            for member, member_blank, member_sides in zip(self.members, self.blank.members, sides, strict=True)
        )
        return pinion_measures, gear_measures

    @property
    def thicknesses(self) -> tuple[float, float]:
        """Mean normal circular thicknesses (mm) of pinion and gear as cut."""
        pinion_thickness, gear_thickness = (
            float(measures.pitch_lines.normal_thicknesses[MEAN_STATION]) for measures in self.measures
        )
        return pinion_thickness, gear_thickness

    @property
    def nominal_thicknesses(self) -> tuple[float, float]:
        """Mean normal circular thicknesses (mm) of pinion and gear by the cutters' blades.

        They follow from the normal width of the gear's spaces between the blades at the pitch line.
        """
        pitch, gear_space = np.pi * self.blank.mean_normal_module, _between(self.gear, self.blank.gear)
        if self.at_once:
            pinion = pitch - _between(self.pinion, self.blank.pinion)
        else:
            pinion = gear_space - self.backlash / np.cos(self.blank.pressure_angle)
        return float(pinion), float(pitch - gear_space)

    @property
    def point_widths(self) -> tuple[float | None, float]:
        """Distances (mm) between the tips of a cutter's blades; None for a pinion with a cutter per side."""
        pinion, gear = point_width(self.pinion), point_width(self.gear)
        return (pinion if self.at_once else None), gear

    def dimensions(self, k: int) -> MemberDimensions:
        """Return the nominal dimensions of member `k` (0 pinion, 1 gear) in the terms of ISO 23509."""
        blank = self.blank
        member = blank.members[k]
        mean, (inner, outer), angle = member.mean_cone_distance, member.extent, member.pitch_angle
        module, alpha = blank.mean_normal_module, blank.pressure_angle
        depth, mating_depth = blank.standard_depths[k], blank.standard_depths[1 - k]
        thickness = self.nominal_thicknesses[k]
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


def measures_of(member: Member, member_blank: MemberBlank, sides: dict[str, Generated]) -> ToothMeasures:
    """Return the measures of a member's tooth at inner, mean and outer cone distance."""
    stations = np.array(
        [member_blank.inner_cone_distance, member_blank.mean_cone_distance, member_blank.outer_cone_distance]
    )
    return ToothMeasures(member.tooth, sides["concave"].hand, stations, member_blank.pitch_cone)


def point_width(sides: dict[str, Generated]) -> float:
    """Return the distance (mm) between the tips of the blades of both sides."""
    return float(sides["concave"].blade.tip_radius - sides["convex"].blade.tip_radius)


def _between(sides: dict[str, Generated], member: MemberBlank) -> float:
    """Return the distance (mm) between outside and inside blade at the height of the pitch line over the tip plane.

    The height is that at the mean cone distance.
    """
    height = member.mean_dedendum * np.cos(member.dedendum_angle)
    return float(sides["concave"].blade.radius_at(height) - sides["convex"].blade.radius_at(height))


def dimension_tables(
    cut: CutPair, hand: str, slots: tuple[float, float], unit: float, noun: str
) -> tuple[SheetTable, ...]:
    """Return the tables of a pair.

    - `hand`: hand of the pinion
    - `slots`: narrowest slots of pinion and gear, mm
    - `unit`, `noun`: unit of lengths (mm) and its name
    """
    dimensions = cut.dimensions(0), cut.dimensions(1)
    rows = [member_rows(member) for member in dimensions]
    hands = (hand, "left" if hand == "right" else "right")
    iso: list[Row] = [
        ("hand", "hand of spiral", "", hands),
        ("z", "teeth", "-", tuple(member.teeth for member in dimensions)),
    ]
    iso += [
        (symbol, f"{words}, nominal" if symbol in NOMINAL_SYMBOLS else words, kind, (value, gear_row[3]))
        for (symbol, words, kind, value), gear_row in zip(*rows, strict=True)
    ]  # fmt: skip
    iso += _mounting(cut, dimensions)
    return (
        table("Ratios, depths and backlash", ("",), _scale(_pair(cut, dimensions), unit, noun)),
        table("Dimensions [ISO 23509]", MEMBER_NAMES, _scale(iso, unit, noun)),
        measured_table(_teeth(cut, slots), cut.blank, unit, noun),
    )


def _scale(rows: list[Row], unit: float, noun: str) -> list[Row]:
    """Return rows whose values in mm are converted to another unit."""
    return [
        (symbol, words, noun, tuple(v / unit if isinstance(v, float) else v for v in values))
        if kind == "mm"
        else (symbol, words, kind, values)
        for symbol, words, kind, values in rows
    ]


def _pair(cut: CutPair, dimensions: tuple[MemberDimensions, MemberDimensions]) -> list[Row]:
    """Return the rows of ratios, depths and backlash."""
    blank, ratios = cut.blank, contact_ratios(cut.blank)
    gear = blank.gear
    outer, mean, beta = gear.outer_cone_distance, gear.mean_cone_distance, gear.spiral_angle
    module = 2.0 * outer * float(np.sin(gear.pitch_angle)) / gear.teeth
    dedenda = _dedenda(blank)
    transverse = cut.backlash / float(np.cos(blank.pressure_angle) * np.cos(beta))
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
        ("j_mn", "mean normal backlash", "mm", cut.backlash),
        ("j_mt", "mean transverse backlash", "mm", transverse),
        ("j_en", "outer normal backlash", "mm", transverse * steeper * outer / mean),
        ("j_et", "outer transverse backlash", "mm", transverse * outer / mean),
        ("eps_v_alpha", "transverse contact ratio, virtual gears", "-", ratios.transverse),
        ("eps_v_beta", "face contact ratio", "-", ratios.face),
        ("eps_v_gamma", "modified contact ratio", "-", ratios.modified_ratio),
    ]
    return [(symbol, words, kind, (value,)) for symbol, words, kind, value in values]


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


def _mounting(cut: CutPair, dimensions: tuple[MemberDimensions, MemberDimensions]) -> list[Row]:
    """Return the rows for mounting and turning; the back face is the body's, hub included."""
    backs = [member.tooth.blank.body.ends[1] for member in cut.members]
    crowns = [
        (blank.crown(blank.outer_cone_distance), blank.crown(blank.inner_cone_distance)) for blank in cut.blank.members
    ]
    # the cones at both ends are perpendicular to the pitch cone
    angles = tuple(float(np.degrees(member.pitch_angle)) for member in dimensions)
    return [
        ("t_B", "mounting distance: crossing point to back face", "mm", tuple(backs)),
        ("t_xoB", "crown to back face", "mm", tuple(b - outer for b, (outer, _) in zip(backs, crowns, strict=True))),
        ("t_xio", "front crown to crown", "mm", tuple(outer - inner for outer, inner in crowns)),
        ("delta_b", "back angle", "deg", angles),
        ("delta_v", "front angle", "deg", angles),
    ]


@dataclass(frozen=True)
class CutTooth:
    """A tooth as it is cut."""

    #: the member
    member: Member
    #: blank of the member
    own: MemberBlank
    #: its sides, "concave" and "convex"
    sides: dict[str, Generated]
    #: its measures at inner, mean and outer cone distance
    measures: ToothMeasures
    #: its narrowest slot, mm
    slot: float
    #: point width of the cutter that cuts both sides, mm; None where each side has a cutter
    point_width: float | None
    #: True if the contact also moves around the member, as on a pinion with offset
    around: bool = False

    def rows(self, blank: BevelBlank) -> list[tuple[str, str, str, float | None]]:
        """Return symbol, words, unit and value of all measures; `blank`: blank of the pair."""
        measures, lines = self.measures, self.measures.pitch_lines
        spirals = np.mean([lines.spiral_angles(side_of_tooth) for side_of_tooth in Side], axis=0)
        transverse, normal, lands = lines.transverse_thicknesses, lines.normal_thicknesses, measures.top_lands
        addenda, root = self.own.addendum_at(measures.stations), measures.root_heights
        rows: list[tuple[str, str, str, float | None]] = []
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
        tongue = self._chordal_addendum(float(normal[MEAN_STATION]), float(addenda[MEAN_STATION]), blank.pressure_angle)
        turn = float(
            np.mean([measures.advance(side_of_tooth) for side_of_tooth in Side]) / self.member.tooth.pitch_angle
        )
        clearing = min(_clearing_edge(side.blade, blank.clearance) for side in self.sides.values())
        return [
            *rows,
            (
                "s_mnc",
                "mean normal chordal thickness, at the chordal addendum",
                "mm",
                measures.chord(MEAN_STATION, tongue),
            ),
            ("h_amc", "mean chordal addendum", "mm", tongue),
            *self._outline(root),
            ("W_0", "point width of a cutter that cuts both sides", "mm", self.point_width),
            ("W_i", "narrowest slot: between the blades' edges at the root", "mm", self.slot),
            ("eps_beta", "face contact ratio of the pitch lines", "-", None if self.around else turn),
            ("W_B", "point width of a blade, by the narrowest slot [AGMA 929]", "mm", self.blade_point_width),
            (
                "rho_a0_B",
                "largest edge radius of a blade of that point width [AGMA 929]",
                "mm",
                min(_blade_edge(side.blade, self.blade_point_width) for side in self.sides.values()),
            ),
            (
                "rho_a0_w",
                "edge radius with which both roundings meet in the narrowest slot",
                "mm",
                _fitting_edge(self.sides, self.slot),
            ),
            ("rho_a0_c", "edge radius whose rounding ends where the mating tip reaches, clearance", "mm", clearing),
        ]

    @property
    def blade_point_width(self) -> float:
        """Point width W_B (mm) of one blade [AGMA 929].

        Outside and inside blade together cut a little more than the narrowest slot.
        """
        return 0.5 * (self.slot + BLADE_OVERLAP_MM)

    def _chordal_addendum(self, thickness: float, addendum: float, pressure_angle: float) -> float:
        """Return the depth (mm) of a calliper's tongue for a mean normal circular `thickness` and an `addendum` (mm).

        [ISO 23509 (215)].
        """
        diameter = normal_diameter(self.own, pressure_angle)
        rise = 1.0 - np.cos(thickness / diameter)
        return float(addendum + 0.5 * diameter * np.cos(self.own.pitch_angle) * rise)

    def _outline(self, root: Array) -> list[tuple[str, str, str, float | None]]:
        """Return the rows of the tip at the heel, and of the line through the middle of the root from toe to heel.

        `root`: heights (3,) of the root over the pitch cone, mm.
        """
        member, (inner, _, outer) = self.own, self.measures.stations
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


def measured_table(teeth: tuple[CutTooth, ...], blank: BevelBlank, unit: float, noun: str) -> SheetTable:
    """Return the table of measures of teeth of a `blank`, a column each; lengths over `unit` (mm) in `noun`."""
    columns = [tooth.rows(blank) for tooth in teeth]
    rows: list[Row] = [
        (symbol, words, kind, (value, *(column[k][3] for column in columns[1:])))
        for k, (symbol, words, kind, value) in enumerate(columns[0])
    ]
    names = tuple(tooth.member.name for tooth in teeth)
    return table(CUT_TEETH_TITLE, names, _scale(rows, unit, noun))


def _teeth(cut: CutPair, slots: tuple[float, float]) -> tuple[CutTooth, ...]:
    """Return both teeth of a pair as they are cut."""
    return tuple(
        # with offset the contact also moves around the pinion
        CutTooth(
            member,
            member_blank,
            sides,
            measures,
            slot,
            width,
            bool(cut.blank.offset) and member_blank is cut.blank.pinion,
        )
        for member, member_blank, sides, measures, slot, width in zip(
            cut.members, cut.blank.members, (cut.pinion, cut.gear), cut.measures, slots, cut.point_widths, strict=True
        )
    )


def _last_angle(blade: Blade) -> float:
    """Return the angle (rad) from the cutter's axis of the straight toprem, or else of the end of the cutting edge.

    This is the part of the blade next to its rounding.
    """
    if blade.toprem is not None and blade.toprem.kinked:
        return blade.toprem.angle
    return blade.angle_at(0.0)


def _rounding_share(blade: Blade) -> float:
    """Return the width that a rounding takes from the tip of a blade, over its radius: tan(45 deg - alpha/2)."""
    return float(np.tan(0.25 * np.pi - 0.5 * _last_angle(blade)))


def _blade_edge(blade: Blade, width: float) -> float:
    """Largest edge radius (mm) of a blade of a point width (mm) [AGMA 929]; 0 for a blade too narrow for any."""
    return max(0.0, width - BLADE_FLAT_MM) / _rounding_share(blade)


def _fitting_edge(sides: dict[str, Generated], slot: float) -> float:
    """Return the edge radius (mm) with which the roundings of both blades meet in the middle of a slot."""
    return slot / sum(_rounding_share(side.blade) for side in sides.values())


def _clearing_edge(blade: Blade, clearance: float) -> float:
    """Edge radius (mm) whose rounding is no higher than the clearance: the mating tip then meets only the flank."""
    return float(clearance / (1.0 - np.sin(_last_angle(blade))))
