"""Settings sheet of a spiral bevel pair: blank, cutters and machine settings as the shop wants them, given or derived."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from gearmesh.systems.common.axes import gear_base
from gearmesh.systems.spiral_bevel.blank import BevelBlank, MemberBlank
from gearmesh.systems.spiral_bevel.generated import Generated
from gearmesh.systems.spiral_bevel.pair import MATES, SIDES
from gearmesh.systems.spiral_bevel.settings import SYNTHESISED, basic_blank, gear_sides, mean_point, pinion_side
from gearmesh.systems.system import Sheet, SheetTable
from gearmesh.teeth.limits import cutter
from gearmesh.teeth.train import Member, Train
from gearmesh.tools.head_cutter import Revolved
from gearmesh.tools.rack import Arc

if TYPE_CHECKING:
    from gearmesh.systems.spiral_bevel.design import SpiralBevelDesign


def settings_sheet(design: SpiralBevelDesign, train: Train) -> Sheet:
    """The sheet of a spiral bevel design and the train built of it, lengths in the design's units, angles in deg.

    Raises DesignError for blanks that cannot exist, NoSolutionError where local synthesis has none.
    """
    own, unit = design.in_mm(), design.mm_per_unit
    blank = basic_blank(own)
    gear = gear_sides(own, blank)
    base = gear_base(blank.shaft_angle)
    pinion = {
        name: pinion_side(own, blank, name, mean_point(own, blank, name, gear[MATES[name]], base)) for name in SIDES
    }
    # free edge radii as they fit the teeth
    teeth = train.members
    fitted = [
        _fitted(side, teeth[name]) for name, sides in (("pinion", pinion), ("gear", gear)) for side in sides.values()
    ]
    tables = (
        SheetTable("Blank", ("pinion", "gear"), _member_rows(blank, unit, design.units)),
        SheetTable("Pair", ("",), _pair_rows(blank, unit, design.units)),
        SheetTable(
            "Cutters and machine settings",
            ("pinion concave", "pinion convex", "gear concave", "gear convex"),
            tuple(
                (
                    item,
                    noun if noun else design.units,
                    *(_value(side, key, unit if not noun else 1.0) for side in fitted),
                )
                for item, noun, key in _SETTINGS
            ),
        ),
    )
    nouns = {key: noun for _, noun, key in _SETTINGS}
    values = {
        f"{prefix}.{key}": _value(side, key, 1.0 if nouns[key] else unit)
        for prefix, side in (
            ("pinion.concave", pinion["concave"]),
            ("pinion.convex", pinion["convex"]),
            ("gear.cutter", gear["concave"]),
        )
        for key in (*SYNTHESISED, "blade_height")
    }
    values |= {
        "gear.cutter.tip_radius": blank.cutter_radius / unit,
        "gear.cutter.point_width": _point_width(gear) / unit,
    }
    return Sheet(tables, values)


def _fitted(side: Generated, member: Member) -> Generated:
    """The side with the edge radius that its fillet has."""
    rounding = cutter(member.tooth.side(side.flank).fillet)
    assert isinstance(rounding, Revolved)
    assert isinstance(rounding.profile, Arc)
    return replace(side, blade=replace(side.blade, edge_radius=abs(rounding.profile.radius)))


#: item, unit ("" for the design's), key of the design
_SETTINGS = (
    ("blade angle", "deg", "blade_angle"),
    ("blade radius (0 = straight)", "", "blade_radius"),
    ("blade angle holds at height", "", "blade_height"),
    ("tip radius", "", "tip_radius"),
    ("edge radius", "", "edge_radius"),
    ("radial", "", "radial"),
    ("cradle angle", "deg", "cradle_angle"),
    ("ratio of roll (cradle/blank)", "-", "ratio_of_roll"),
    ("machining offset", "", "machining_offset"),
    ("machine centre to back, along root line", "", "machine_centre_to_back"),
    ("sliding base", "", "sliding_base"),
    ("machine root angle", "deg", "machine_root_angle"),
)
_DEGREES = ("blade_angle", "cradle_angle", "machine_root_angle")


def _value(side: Generated, key: str, unit: float) -> float:
    source = {"blade_height": "height"}.get(key, key)
    value = getattr(side.blade if hasattr(side.blade, source) else side.settings, source)
    return float(np.degrees(value)) if key in _DEGREES else float(value) / unit


def _point_width(gear: dict[str, Generated]) -> float:
    return gear["concave"].blade.tip_radius - gear["convex"].blade.tip_radius


def _member_rows(blank: BevelBlank, unit: float, noun: str) -> tuple[tuple[Any, ...], ...]:
    members = (blank.pinion, blank.gear)

    def row(item: str, kind: str, pick: Callable[[MemberBlank], float]) -> tuple[Any, ...]:
        scale = {"deg": np.pi / 180.0, "": unit, "-": 1.0}[kind]
        return (
            item,
            kind or noun,
            *(pick(member) if kind == "-" else float(pick(member) / scale) for member in members),
        )

    outer = blank.outer_cone_distance

    def tip(member: MemberBlank) -> tuple[float, float]:
        """rho and z of the tip on the back cone."""
        c, s = np.cos(member.pitch_angle), np.sin(member.pitch_angle)
        return outer * s + member.outer_addendum * c, outer * c - member.outer_addendum * s

    return (
        row("teeth", "-", lambda m: m.teeth),
        row("pitch angle", "deg", lambda m: m.pitch_angle),
        row("face angle", "deg", lambda m: m.face_angle),
        row("root angle", "deg", lambda m: m.root_angle),
        row("outer pitch diameter", "", lambda m: 2.0 * outer * np.sin(m.pitch_angle)),
        row("outer tip diameter", "", lambda m: 2.0 * tip(m)[0]),
        row("apex to crown", "", lambda m: tip(m)[1]),
        row("face apex beyond pitch apex", "", lambda m: m.tip_radius / np.tan(m.face_angle)),
        row("mean addendum", "", lambda m: m.mean_addendum),
        row("mean dedendum", "", lambda m: m.mean_dedendum),
        row("outer addendum", "", lambda m: m.outer_addendum),
        row("outer dedendum", "", lambda m: m.outer_dedendum),
        row("mean normal thickness", "", lambda m: m.thickness),
    )


def _pair_rows(blank: BevelBlank, unit: float, noun: str) -> tuple[tuple[Any, ...], ...]:
    lengths = [
        ("outer cone distance", blank.outer_cone_distance),
        ("mean cone distance", blank.mean_cone_distance),
        ("inner cone distance", blank.inner_cone_distance),
        ("face width", blank.face_width),
        ("mean normal module", blank.mean_normal_module),
        ("mean working depth", blank.mean_working_depth),
        ("clearance", blank.clearance),
    ]
    angles = [
        ("shaft angle", blank.shaft_angle),
        ("mean spiral angle", blank.spiral_angle),
        ("outer spiral angle", blank.spiral_angle_at(blank.outer_cone_distance)),
        ("inner spiral angle", blank.spiral_angle_at(blank.inner_cone_distance)),
    ]
    return (
        *((item, noun, float(value / unit)) for item, value in lengths),
        *((item, "deg", float(np.degrees(value))) for item, value in angles),
    )
