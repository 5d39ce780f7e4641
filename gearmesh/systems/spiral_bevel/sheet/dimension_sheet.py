"""Dimension sheet of a bevel pair: dimensions of ISO 23509, and measures of the teeth as cut.

The dimensions of ISO 23509 are nominal. Their thicknesses follow from the cutters' blades at the pitch line. They
therefore include a given point width, but not given machine settings. Measures are computed on the exact flanks and
roots: see `tooth_measures`. Lengths are in the design's units.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np

from gearmesh.records import dataclass
from gearmesh.systems.common.bevel.blank import BevelBlank, MemberBlank
from gearmesh.systems.common.bevel.sheet_rows import (
    CUT_TEETH_TITLE,
    MEAN_STATION,
    in_unit,
    iso_rows,
    measures_rows,
    member_dimensions,
    ratio_rows,
)
from gearmesh.systems.common.bevel.tooth_measures import ToothMeasures
from gearmesh.systems.common.symbol_table import Row, table
from gearmesh.systems.spiral_bevel.machine.generated import Generated
from gearmesh.systems.system import SheetTable
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Side
from gearmesh.tools.head_cutter import Blade

#: names of the members in order
MEMBER_NAMES = ("pinion", "gear")
#: width (mm) by which two blades together are wider than the narrowest slot [AGMA 929]
BLADE_OVERLAP_MM = 0.05
#: width (mm) of the flat that a rounding leaves at the tip of a blade [AGMA 929]
BLADE_FLAT_MM = 0.2


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

        They follow from the normal width of the gear's spaces between the blades at the pitch line. The blades of face
        hobbing cut a side each: thicknesses are those of the blank.
        """
        if self.blank.blade_groups:
            return self.blank.pinion.thickness, self.blank.gear.thickness
        pitch, gear_space = np.pi * self.blank.mean_normal_module, _between(self.gear, self.blank.gear)
        if self.at_once:
            pinion = pitch - _between(self.pinion, self.blank.pinion)
        else:
            pinion = gear_space - self.backlash / np.cos(self.blank.pressure_angle)
        return float(pinion), float(pitch - gear_space)

    @property
    def point_widths(self) -> tuple[float | None, float | None]:
        """Distances (mm) between the tips of a cutter's blades; None for a blade per side."""
        if self.blank.blade_groups:
            return None, None
        pinion, gear = point_width(self.pinion), point_width(self.gear)
        return (pinion if self.at_once else None), gear


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
    blank = cut.blank
    dimensions = tuple(member_dimensions(blank, k, cut.nominal_thicknesses[k]) for k in range(2))
    hands = (hand, "left" if hand == "right" else "right")
    iso: list[Row] = [("hand", "hand of spiral", "", hands), *iso_rows(blank, dimensions, cut.members)]
    return (
        table("Ratios, depths and backlash", ("",), in_unit(ratio_rows(blank, dimensions, cut.backlash), unit, noun)),
        table("Dimensions [ISO 23509]", MEMBER_NAMES, in_unit(iso, unit, noun)),
        measured_table(_teeth(cut, slots), cut.blank, unit, noun),
    )


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
        measures = self.measures
        turn = float(
            np.mean([measures.advance(side_of_tooth) for side_of_tooth in Side]) / self.member.tooth.pitch_angle
        )
        clearing = min(_clearing_edge(side.blade, blank.clearance) for side in self.sides.values())
        return [
            *measures_rows(self.own, measures, blank.pressure_angle),
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


def measured_table(teeth: tuple[CutTooth, ...], blank: BevelBlank, unit: float, noun: str) -> SheetTable:
    """Return the table of measures of teeth of a `blank`, a column each; lengths over `unit` (mm) in `noun`."""
    columns = [tooth.rows(blank) for tooth in teeth]
    rows: list[Row] = [
        (symbol, words, kind, (value, *(column[k][3] for column in columns[1:])))
        for k, (symbol, words, kind, value) in enumerate(columns[0])
    ]
    names = tuple(tooth.member.name for tooth in teeth)
    return table(CUT_TEETH_TITLE, names, in_unit(rows, unit, noun))


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
