"""The dimension sheet of a bevel pair: what ISO 23509 has of it, and what its teeth, as they are cut, measure.

The dimensions of ISO 23509 are nominal. Their thicknesses follow from the cutters' blades where these meet the pitch line, so that
a given point width counts, but not from given machine settings. Measures are taken on the exact flanks and roots, see
`tooth_measures`; lengths are in the design's units.
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

MEMBERS = ("pinion", "gear")
CUT = "Teeth as cut, measured on their flanks"
#: symbols of dimensions of ISO 23509 that teeth as they are cut need not have
NOMINAL = frozenset(
    (
        *("theta_a", "delta_f", "theta_f", "beta_e", "beta_m", "beta_i"),
        *("ham", "hfm", "hae", "hfe", "he", "hai", "hfi", "hi"),
        *("xsm", "smn", "smt", "smnc", "hamc", "dae", "dai", "dfe", "dfi", "txo", "txi", "tzR"),
    )
)
#: width (mm) by which two blades together are wider than the narrowest slot [AGMA 929]
BLADE_OVERLAP = 0.05
#: width (mm) of the flat that a rounding leaves at the tip of a blade [AGMA 929]
BLADE_FLAT = 0.2
#: number of the mean among the stations of the measures
MEAN = 1
#: sums of dedendum angles (rad) that count as those of a taper
ALIKE = 1e-9
INCH = 25.4


@dataclass(frozen=True)
class CutPair:
    """A pair as it is cut.

    `blank`, sides of both by "concave" and "convex", `members`; `backlash`: normal backlash (mm) between contacts of both sides at
    their mean points; `at_once`: True if one cutter cuts both sides of the pinion.
    """

    blank: BevelBlank
    pinion: dict[str, Generated]
    gear: dict[str, Generated]
    members: tuple[Member, Member]
    backlash: float
    at_once: bool

    @cached_property
    def measures(self) -> tuple[ToothMeasures, ToothMeasures]:
        """Measures of the teeth of pinion and gear at inner, mean and outer cone distance."""
        sides = self.pinion, self.gear
        first, second = (
            measures_of(member, own, member_sides)
            for member, own, member_sides in zip(self.members, self.blank.members, sides, strict=True)
        )
        return first, second

    @property
    def thicknesses(self) -> tuple[float, float]:
        """Mean normal circular thicknesses (mm) of pinion and gear as they are cut."""
        first, second = (float(measures.pitch_lines.normal_thicknesses[MEAN]) for measures in self.measures)
        return first, second

    @property
    def nominal_thicknesses(self) -> tuple[float, float]:
        """The same by the cutters' blades: from the normal width of the gear's spaces between the blades at the pitch line."""
        pitch, gear_space = np.pi * self.blank.mean_normal_module, _between(self.gear, self.blank.gear)
        if self.at_once:
            pinion = pitch - _between(self.pinion, self.blank.pinion)
        else:
            pinion = gear_space - self.backlash / np.cos(self.blank.pressure_angle)
        return float(pinion), float(pitch - gear_space)

    @property
    def point_widths(self) -> tuple[float | None, float]:
        """Distances (mm) between the tips of the blades of one cutter; None where the pinion's sides have one each."""
        pinion, gear = point_width(self.pinion), point_width(self.gear)
        return (pinion if self.at_once else None), gear

    def dimensions(self, k: int) -> MemberDimensions:
        """The nominal member `k` in the terms of ISO 23509."""
        blank = self.blank
        own = blank.members[k]
        mean, (inner, outer), angle = own.mean_cone_distance, own.extent, own.pitch_angle
        module, alpha = blank.mean_normal_module, blank.pressure_angle
        depth, other = blank.standard_depths[k], blank.standard_depths[1 - k]
        thickness = self.nominal_thicknesses[k]
        thicker = thickness - 0.5 * np.pi * module - (depth.addendum - other.addendum) * np.tan(alpha)
        return MemberDimensions(
            teeth=own.teeth,
            pitch_angle=angle,
            face_angle=own.face_angle,
            root_angle=own.root_angle,
            addendum_angle=own.face_angle - angle,
            dedendum_angle=own.dedendum_angle,
            crossing_distance=float(mean * np.cos(angle)) - own.pitch_apex,
            pitch_apex=own.pitch_apex,
            face_apex=float(own.tip_radius / np.tan(own.face_angle)),
            root_apex=own.root_apex,
            mean_cone_distance=mean,
            mean_spiral_angle=own.spiral_angle,
            face=FaceSpan(outer - mean, mean - inner),
            spiral_angles=own.end_spiral_angles,
            mean_depth=depth,
            thickness_modification=float(0.5 * thicker / module),
            normal_thickness=thickness,
            normal_diameter=normal_diameter(own, alpha),
        )


def normal_diameter(own: MemberBlank, pressure_angle: float) -> float:
    """d_mn [ISO 23509 (213)]: diameter (mm) of the virtual gear in the normal section at the mean point."""
    across = (1.0 - (np.sin(own.spiral_angle) * np.cos(pressure_angle)) ** 2) * np.cos(own.pitch_angle)
    return 2.0 * own.mean_radius / float(across)


def measures_of(member: Member, own: MemberBlank, sides: dict[str, Generated]) -> ToothMeasures:
    """Measures of a member's tooth at inner, mean and outer cone distance."""
    stations = np.array([own.inner_cone_distance, own.mean_cone_distance, own.outer_cone_distance])
    return ToothMeasures(member.tooth, sides["concave"].hand, stations, own.pitch_cone)


def point_width(sides: dict[str, Generated]) -> float:
    """Distance (mm) between the tips of the blades of both sides."""
    return float(sides["concave"].blade.tip_radius - sides["convex"].blade.tip_radius)


def _between(sides: dict[str, Generated], own: MemberBlank) -> float:
    """Distance (mm) between outside and inside blade as high as the pitch line is over the tip plane at the mean."""
    height = own.mean_dedendum * np.cos(own.dedendum_angle)
    return float(sides["concave"].blade.radius_at(height) - sides["convex"].blade.radius_at(height))


def dimension_tables(
    cut: CutPair, hand: str, slots: tuple[float, float], unit: float, noun: str
) -> tuple[SheetTable, ...]:
    """The tables of a pair whose pinion has a `hand`; `slots`: the narrowest slots (mm) of both; lengths over `unit` in `noun`."""
    dimensions = cut.dimensions(0), cut.dimensions(1)
    rows = [member_rows(member) for member in dimensions]
    hands = (hand, "left" if hand == "right" else "right")
    iso: list[Row] = [
        ("hand", "hand of spiral", "", hands),
        ("z", "teeth", "-", tuple(member.teeth for member in dimensions)),
    ]
    iso += [
        (symbol, f"{words}, nominal" if symbol in NOMINAL else words, kind, (value, other[3]))
        for (symbol, words, kind, value), other in zip(*rows, strict=True)
    ]  # fmt: skip
    iso += _mounting(cut, dimensions)
    return (
        table("Ratios, depths and backlash", ("",), _scale(_pair(cut, dimensions), unit, noun)),
        table("Dimensions [ISO 23509]", MEMBERS, _scale(iso, unit, noun)),
        measured_table(_teeth(cut, slots), cut.blank, unit, noun),
    )


def _scale(rows: list[Row], unit: float, noun: str) -> list[Row]:
    """Rows in mm in another unit."""
    return [
        (symbol, words, noun, tuple(v / unit if isinstance(v, float) else v for v in values))
        if kind == "mm"
        else (symbol, words, kind, values)
        for symbol, words, kind, values in rows
    ]


def _pair(cut: CutPair, dimensions: tuple[MemberDimensions, MemberDimensions]) -> list[Row]:
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
        ("P_d", "outer transverse diametral pitch", "1/inch", INCH / module),
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
    """The name of the taper that the root angles make."""
    mean = blank.gear.mean_cone_distance
    standard = sum(standard_dedendum_angle(member.mean_dedendum, mean) for member in blank.members)
    for name, angle in (
        ("uniform", 0.0),
        ("standard", standard),
        ("duplex", _duplex(blank)),
        ("tilted root line", MAX_TILT_RATIO * standard),
    ):
        if abs(_dedenda(blank) - angle) < ALIKE:
            return name
    return "as given"


def _dedenda(blank: BevelBlank) -> float:
    """Sum (rad) of the dedendum angles; with offset the gear's alone, whose addendum is where the pinion's dedendum is."""
    gear = blank.gear
    mating = gear.face_angle - gear.pitch_angle if blank.offset else blank.pinion.dedendum_angle
    return mating + gear.dedendum_angle


def _duplex(blank: BevelBlank) -> float:
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
    """What the shop sets and turns by; the back face is the body's, hub included."""
    backs = [member.tooth.blank.body.ends[1] for member in cut.members]
    crowns = [(own.crown(own.outer_cone_distance), own.crown(own.inner_cone_distance)) for own in cut.blank.members]
    # the cones at both ends are square to the pitch cone
    angles = tuple(float(np.degrees(own.pitch_angle)) for own in dimensions)
    return [
        ("t_B", "mounting distance: crossing point to back face", "mm", tuple(backs)),
        ("t_xoB", "crown to back face", "mm", tuple(b - outer for b, (outer, _) in zip(backs, crowns, strict=True))),
        ("t_xio", "front crown to crown", "mm", tuple(outer - inner for outer, inner in crowns)),
        ("delta_b", "back angle", "deg", angles),
        ("delta_v", "front angle", "deg", angles),
    ]


@dataclass(frozen=True)
class CutTooth:
    """A tooth as it is cut: its member with blank and sides, its `measures` at inner, mean and outer cone distance, and the
    narrowest `slot` (mm). `around`: True if contact also goes round the member."""

    member: Member
    own: MemberBlank
    sides: dict[str, Generated]
    measures: ToothMeasures
    slot: float
    point_width: float | None
    around: bool = False

    def rows(self, blank: BevelBlank) -> list[tuple[str, str, str, float | None]]:
        """Symbol, words, unit and value of all that is measured; `blank`: of the pair."""
        measures, lines = self.measures, self.measures.pitch_lines
        spirals = np.mean([lines.spiral_angles(which) for which in Side], axis=0)
        transverse, normal, lands = lines.transverse_thicknesses, lines.normal_thicknesses, measures.top_lands
        addenda, root = self.own.addendum_at(measures.stations), measures.root_heights
        rows: list[tuple[str, str, str, float | None]] = []
        for k, (letter, place) in enumerate((("i", "inner"), ("m", "mean"), ("e", "outer"))):
            rows += [
                (f"beta_{letter}", f"{place} spiral angle", "deg", float(np.degrees(spirals[k]))),
                (f"s_{letter}t", f"{place} transverse circular thickness", "mm", float(transverse[k])),
                (f"s_{letter}n", f"{place} normal circular thickness", "mm", float(normal[k])),
                (f"s_a{letter}n", f"{place} normal top land", "mm", float(lands[k])),
                (f"h_a{letter}", f"{place} addendum", "mm", float(addenda[k])),
                (f"h_{letter}", f"{place} whole depth, in the middle of the space", "mm", float(addenda[k] - root[k])),
            ]
        tongue = self._chordal_addendum(float(normal[MEAN]), float(addenda[MEAN]), blank.pressure_angle)
        turn = float(np.mean([measures.advance(which) for which in Side]) / self.member.tooth.pitch_angle)
        clearing = min(_clearing_edge(side.blade, blank.clearance) for side in self.sides.values())
        return [
            *rows,
            ("s_mnc", "mean normal chordal thickness, at the chordal addendum", "mm", measures.chord(MEAN, tongue)),
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
        """Point width W_B (mm) of one blade [AGMA 929]: outside and inside blade together cut a little more than the narrowest
        slot."""
        return 0.5 * (self.slot + BLADE_OVERLAP)

    def _chordal_addendum(self, thickness: float, addendum: float, pressure_angle: float) -> float:
        """Depth (mm) of a calliper's tongue [ISO 23509 (215)] for a mean normal circular `thickness` and `addendum` (mm)."""
        diameter = normal_diameter(self.own, pressure_angle)
        rise = 1.0 - np.cos(thickness / diameter)
        return float(addendum + 0.5 * diameter * np.cos(self.own.pitch_angle) * rise)

    def _outline(self, root: Array) -> list[tuple[str, str, str, float | None]]:
        """Rows of the tip at the heel, and of the line through the middle of the root from toe to heel, at `root` (3,) heights (mm)
        over the pitch cone."""
        own, (inner, _, outer) = self.own, self.measures.stations
        c, s = np.cos(own.pitch_angle), np.sin(own.pitch_angle)
        (toe_rho, toe_z), (heel_rho, heel_z) = (
            (distance * s + height * c, distance * c - height * s - own.pitch_apex)
            for distance, height in ((inner, root[0]), (outer, root[2]))
        )
        slope = (heel_rho - toe_rho) / (heel_z - toe_z)
        return [
            ("d_ae", "outer tip diameter", "mm", float(2.0 * (outer * s + own.addendum_at(outer) * c))),
            ("t_xo", "crossing point to crown along the axis", "mm", own.crown(outer)),
            ("d_fe", "outer root diameter", "mm", float(2.0 * heel_rho)),
            ("delta_f", "root angle", "deg", float(np.degrees(np.arctan(slope)))),
            ("t_zR", "root apex beyond crossing point", "mm", float(heel_rho / slope - heel_z)),
        ]


def measured_table(teeth: tuple[CutTooth, ...], blank: BevelBlank, unit: float, noun: str) -> SheetTable:
    """What teeth of a `blank` measure, a column each; lengths over `unit` (mm) in `noun`."""
    columns = [tooth.rows(blank) for tooth in teeth]
    rows: list[Row] = [
        (symbol, words, kind, (value, *(other[k][3] for other in columns[1:])))
        for k, (symbol, words, kind, value) in enumerate(columns[0])
    ]
    names = tuple(tooth.member.name for tooth in teeth)
    return table(CUT, names, _scale(rows, unit, noun))


def _teeth(cut: CutPair, slots: tuple[float, float]) -> tuple[CutTooth, ...]:
    return tuple(
        # across an offset the contact also goes round the pinion
        CutTooth(member, own, sides, measures, slot, width, bool(cut.blank.offset) and own is cut.blank.pinion)
        for member, own, sides, measures, slot, width in zip(
            cut.members, cut.blank.members, (cut.pinion, cut.gear), cut.measures, slots, cut.point_widths, strict=True
        )
    )


def _last_angle(blade: Blade) -> float:
    """Angle (rad) between cutter axis and what is next to the rounding of a blade, a straight toprem or the cutting edge's end."""
    if blade.toprem is not None and blade.toprem.kinked:
        return blade.toprem.angle
    return blade.angle_at(0.0)


def _rounding_share(blade: Blade) -> float:
    """Width that a rounding takes from the tip of a blade, over its radius: tan(45 deg - alpha/2)."""
    return float(np.tan(0.25 * np.pi - 0.5 * _last_angle(blade)))


def _blade_edge(blade: Blade, width: float) -> float:
    """Largest edge radius (mm) of a blade of a point width (mm) [AGMA 929]; 0 where the blade is too narrow for any."""
    return max(0.0, width - BLADE_FLAT) / _rounding_share(blade)


def _fitting_edge(sides: dict[str, Generated], slot: float) -> float:
    """Edge radius (mm) with which the roundings of both blades meet in the middle of a slot."""
    return slot / sum(_rounding_share(side.blade) for side in sides.values())


def _clearing_edge(blade: Blade, clearance: float) -> float:
    """Edge radius (mm) whose rounding is no higher than the clearance, so that the mating gear's tip meets flank alone."""
    return float(clearance / (1.0 - np.sin(_last_angle(blade))))
