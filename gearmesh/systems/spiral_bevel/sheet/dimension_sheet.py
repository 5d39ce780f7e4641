"""The dimension sheet of a bevel pair: what ISO 23509 has of it, and what its teeth, as they are cut, measure.

Thicknesses by formula go by the cutters' blades where these meet the pitch line, so that a point width that is given counts;
lengths are in the design's units. What is measured is measured on the exact flanks, see `tooth_measures`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.systems.common.symbol_table import Row, table
from gearmesh.systems.spiral_bevel.blank.blank import BevelBlank, MemberBlank
from gearmesh.systems.spiral_bevel.iso23509.dimension_table import member_rows
from gearmesh.systems.spiral_bevel.iso23509.dimensions import FaceSpan, MemberDimensions
from gearmesh.systems.spiral_bevel.iso23509.pitch_cones import PitchCones
from gearmesh.systems.spiral_bevel.iso23509.tapers import MOST_TILT, duplex_sum, standard_dedendum_angle
from gearmesh.systems.spiral_bevel.machine.generated import Generated
from gearmesh.systems.spiral_bevel.sheet.contact_ratios import contact_ratios
from gearmesh.systems.spiral_bevel.sheet.tooth_measures import ToothMeasures
from gearmesh.systems.system import SheetTable
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Side
from gearmesh.tools.head_cutter import Blade

MEMBERS = ("pinion", "gear")
#: sums of dedendum angles (rad) that count as those of a taper
ALIKE = 1e-9
INCH = 25.4


@dataclass(frozen=True)
class CutPair:
    """A pair as it is cut: its blank, sides by "concave" and "convex", members, and the normal backlash (mm) that is asked for,
    None where it is what the cutters leave."""

    blank: BevelBlank
    pinion: dict[str, Generated]
    gear: dict[str, Generated]
    members: tuple[Member, Member]
    asked_backlash: float | None

    @property
    def gear_space(self) -> float:
        """Normal width (mm) of the gear's spaces on the pitch cone, at the mean: between the blades there."""
        return _between(self.gear, self.blank.gear)

    @property
    def thicknesses(self) -> tuple[float, float]:
        """Mean normal circular thicknesses (mm) of pinion and gear."""
        pitch = np.pi * self.blank.mean_normal_module
        if self.asked_backlash is None:
            pinion = pitch - _between(self.pinion, self.blank.pinion)
        else:
            pinion = self.gear_space - self.asked_backlash / np.cos(self.blank.pressure_angle)
        return float(pinion), float(pitch - self.gear_space)

    @property
    def backlash(self) -> float:
        """Normal backlash (mm) at the mean point."""
        if self.asked_backlash is not None:
            return self.asked_backlash
        return float((self.gear_space - self.thicknesses[0]) * np.cos(self.blank.pressure_angle))

    @property
    def point_widths(self) -> tuple[float | None, float]:
        """Distances (mm) between the tips of the blades of one cutter; None where the pinion's sides have one each."""
        pinion, gear = point_width(self.pinion), point_width(self.gear)
        return (pinion if self.asked_backlash is None else None), gear

    def dimensions(self, k: int) -> MemberDimensions:
        """The member `k` in the terms of ISO 23509."""
        blank = self.blank
        own = blank.members[k]
        mean, (inner, outer), angle = own.mean_cone_distance, own.extent, own.pitch_angle
        module, alpha = blank.mean_normal_module, blank.pressure_angle
        across = (1.0 - (np.sin(own.spiral_angle) * np.cos(alpha)) ** 2) * np.cos(angle)
        depth, other = blank.standard_depths[k], blank.standard_depths[1 - k]
        thicker = self.thicknesses[k] - 0.5 * np.pi * module - (depth.addendum - other.addendum) * np.tan(alpha)
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
            normal_thickness=self.thicknesses[k],
            normal_diameter=2.0 * own.mean_radius / float(across),
        )


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
        (symbol, words, kind, (value, other[3]))
        for (symbol, words, kind, value), other in zip(*rows, strict=True)
    ]  # fmt: skip
    iso += _mounting(cut, dimensions)
    return (
        table("Ratios, depths and backlash", ("",), _scale(_pair(cut, dimensions), unit, noun)),
        table("Dimensions [ISO 23509]", MEMBERS, _scale(iso, unit, noun)),
        measured_table(_teeth(cut, dimensions, slots), cut.blank.clearance, unit, noun),
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
        ("c", "clearance", "mm", blank.clearance),
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
        ("tilted root line", MOST_TILT * standard),
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
    """A tooth as it is cut: its member with blank and sides, and the narrowest `slot` (mm).

    `chordal_addendum`: depth (mm) of a calliper's tongue, None where no mating gear is known, which has a part in it; `around`:
    whether contact also goes round the member.
    """

    member: Member
    own: MemberBlank
    sides: dict[str, Generated]
    slot: float
    point_width: float | None
    chordal_addendum: float | None = None
    around: bool = False

    @property
    def measures(self) -> ToothMeasures:
        """At inner, mean and outer cone distance."""
        own = self.own
        stations = np.array([own.inner_cone_distance, own.mean_cone_distance, own.outer_cone_distance])
        return ToothMeasures(self.member.tooth, self.sides["concave"].hand, stations, own.pitch_cone)

    def rows(self, clearance: float) -> list[tuple[str, str, str, float | None]]:
        """Symbol, words, unit and value of all that is measured; `clearance`: mm."""
        measures, lines = self.measures, self.measures.pitch_lines
        spirals = np.mean([lines.spiral_angles(which) for which in Side], axis=0)
        transverse, normal, lands = lines.transverse_thicknesses, lines.normal_thicknesses, measures.top_lands
        rows: list[tuple[str, str, str, float | None]] = []
        for k, (letter, place) in enumerate((("i", "inner"), ("m", "mean"), ("e", "outer"))):
            rows += [
                (f"beta_{letter}", f"{place} spiral angle", "deg", float(np.degrees(spirals[k]))),
                (f"s_{letter}t", f"{place} transverse circular thickness", "mm", float(transverse[k])),
                (f"s_{letter}n", f"{place} normal circular thickness", "mm", float(normal[k])),
                (f"s_a{letter}n", f"{place} normal top land", "mm", float(lands[k])),
            ]
        depth = self.chordal_addendum
        chord = None if depth is None else measures.chord(1, depth)
        turn = float(np.mean([measures.advance(which) for which in Side]) / self.member.tooth.pitch_angle)
        clearing = min(_clearing_edge(side.blade, clearance) for side in self.sides.values())
        return [
            *rows,
            ("s_mnc", "mean normal chordal thickness, at the chordal addendum", "mm", chord),
            ("W_0", "point width of a cutter that cuts both sides", "mm", self.point_width),
            ("W_i", "narrowest slot: between the blades' edges at the root", "mm", self.slot),
            ("eps_beta", "face contact ratio of the pitch lines", "-", None if self.around else turn),
            (
                "rho_a0_w",
                "largest edge radius of the blades: by the narrowest slot",
                "mm",
                _fitting_edge(self.sides, self.slot),
            ),
            ("rho_a0_c", "the same: by the mating tip, clearance", "mm", clearing),
        ]


def measured_table(teeth: tuple[CutTooth, ...], clearance: float, unit: float, noun: str) -> SheetTable:
    """What teeth measure, a column each; `clearance` in mm, lengths over `unit` (mm) in `noun`."""
    columns = [tooth.rows(clearance) for tooth in teeth]
    rows: list[Row] = [
        (symbol, words, kind, (value, *(other[k][3] for other in columns[1:])))
        for k, (symbol, words, kind, value) in enumerate(columns[0])
    ]
    names = tuple(tooth.member.name for tooth in teeth)
    return table("Teeth as cut, measured on their flanks", names, _scale(rows, unit, noun))


def _teeth(
    cut: CutPair, dimensions: tuple[MemberDimensions, MemberDimensions], slots: tuple[float, float]
) -> tuple[CutTooth, ...]:
    return tuple(
        # across an offset the contact also goes round the pinion
        CutTooth(
            member,
            own,
            sides,
            slot,
            width,
            own_dimensions.chordal_addendum,
            bool(cut.blank.offset) and own is cut.blank.pinion,
        )
        for member, own, sides, slot, width, own_dimensions in zip(
            cut.members, cut.blank.members, (cut.pinion, cut.gear), slots, cut.point_widths, dimensions, strict=True
        )
    )


def _last_angle(blade: Blade) -> float:
    """Angle (rad) between cutter axis and what is next to the rounding of a blade, a straight toprem or the cutting edge's end."""
    if blade.toprem is not None and blade.toprem.kinked:
        return blade.toprem.angle
    return blade.angle_at(0.0)


def _fitting_edge(sides: dict[str, Generated], slot: float) -> float:
    """Edge radius (mm) with which the roundings of both blades meet in the middle of a slot."""
    taken = [np.cos(angle) / (1.0 + np.sin(angle)) for angle in (_last_angle(side.blade) for side in sides.values())]
    return float(slot / sum(taken))


def _clearing_edge(blade: Blade, clearance: float) -> float:
    """Edge radius (mm) whose rounding is no higher than the clearance, so that the mating gear's tip meets flank alone."""
    return float(clearance / (1.0 - np.sin(_last_angle(blade))))
