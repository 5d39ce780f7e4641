"""Dashes of a sheet: a value that it cannot have is a dash with its reason and never brings down the sheet, and every measure can
be taken by an instrument."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import DesignError
from gearmesh.kinds import Side
from gearmesh.systems.cylindrical.geometry import measures
from gearmesh.systems.cylindrical.geometry.geometry import Toothing
from gearmesh.systems.cylindrical.measured import flank_radii

CUT, MEASURES = "As cut by feeding the tool for the allowance", "Measures of the tooth thickness"


def ring(module: float = 2.0, teeth: int = 50, of_both: dict[str, Any] | None = None, **keys: Any) -> gm.Design:
    """A pair of 20 teeth and an internal gear; keys of both members, and of the design or, as a table, of the gear."""
    both = {"face_width": 10, **(of_both or {})}
    gear = {"teeth": -teeth, **both, **keys.pop("gear", {})}
    pinion = keys.pop("pinion", {"teeth": 20, **both})
    return gm.parse({"kind": "cylindrical", "module": module, "pinion": pinion, "gear": gear, **keys})


@pytest.mark.sweep
@pytest.mark.sweep_cases("much")
@pytest.mark.parametrize(
    ("design", "keys"),
    [
        ({"backlash": 0.25}, {}),
        ({"backlash": 0.5}, {}),
        ({"module": 0.5, "teeth": 60}, {"face_width": 5, "thickness_allowance": "cd25"}),
    ],
    ids=["some", "much", "fine"],
)
def test_rows_as_cut_by_feed_match_the_fed_design(design: dict[str, Any], keys: dict[str, Any]) -> None:
    """Against the teeth of the same order with allowance_by = "feed", as they are built: its tool has a rounding of its own."""
    given, fed = (ring(of_both={**keys, **by}, **design) for by in ({}, {"allowance_by": "feed"}))
    rows, members = gm.build(given).sheet().plain_tables[CUT], gm.build(fed).members
    gears = members["pinion"], members["gear"]
    built = [flank_radii(member)[0] for member in gears]
    assert rows["d_fE"][1:] == pytest.approx([2.0 * float(own.tooth.blank.root.at(0.0)) for own in gears], abs=1e-9)
    for value, radius in zip(rows["d_FfE"][1:], built, strict=True):
        assert value is None or value == pytest.approx(2.0 * radius, abs=1e-6)
    assert rows["d_FfE"][2] is not None


def test_a_value_that_cannot_be_had_is_a_dash_with_its_reason() -> None:
    """A rounding that the order gives and that the fed tool, whose teeth are narrower, has no room for."""
    sheet = gm.build(ring(backlash=0.5, gear={"tool_tip_radius": 0.38})).sheet()
    assert sheet.plain_tables[CUT]["d_FfE"] == ["mm", None, None]
    reasons = {(value.symbol, value.column): value.reason for value in sheet.missing if value.table == CUT}
    assert reasons == {
        ("d_FfE", "pinion"): "the tool undercuts the flank",
        ("d_FfE", "gear"): "the shaper's tooth is too narrow for the fillet",
    }
    assert [row[0] for row in sheet.listings[-1].rows] == ["d_FfE", "d_FfE"]


#: where a sheet of every kind asks for a figure, and the table that is lost without it
REFUSED = {
    "spur": ("gearmesh.systems.cylindrical.sheet._reserves", "Reserves (negative: none)"),
    "rack": ("gearmesh.systems.cylindrical.rack.sheet._contact_rows", "Contact from A to E"),
    "planetary": ("gearmesh.systems.cylindrical.planetary.sheet._apart", "Set"),
    "face_gear": ("gearmesh.systems.face_gear.sheet.half_angles", "Axodes [LF04 18.2, 18.4]"),
    "circular_arc": ("gearmesh.systems.circular_arc.sheet.analyse", "Point of contact [LT85]"),
    "worm_drive": ("gearmesh.systems.worm_drive.sheet.lost_flank", "Wheel: undercut"),
    "spiral_bevel_basic": ("gearmesh.systems.spiral_bevel.sheet.sheet.tolerance_table", "Tolerances"),
    "beveloid_crossed": ("gearmesh.systems.common.plain_sheet._axes", "Axes"),
}


def test_pinion_larger_than_rings_hole_has_no_trimming_reserve() -> None:
    """The dash stood without a word, as where the tips never come near each other."""
    pinion = {"teeth": 34, "face_width": 10, "addendum": 0.55}
    sheet = gm.build(ring(teeth=35, pressure_angle=25, pinion=pinion)).sheet()
    (value,) = (value for value in sheet.missing if value.symbol == "trimming")
    assert value.reason == "the pinion is larger than the hole of the ring and goes in from its end alone"


@pytest.mark.sweep_cases("spiral_bevel_basic", "planetary", "face_gear", "rack", "spur", "worm_drive")
@pytest.mark.parametrize("sample", REFUSED)
def test_no_refused_figure_brings_down_the_sheet(sample: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def refused(*_: object) -> None:
        raise DesignError("nothing", 1.0, reason="no such figure")

    place, title = REFUSED[sample]
    gears = gm.build(gm.load(SAMPLES / f"{sample}.toml"))
    whole = [table.title for table in gears.sheet().tables]
    monkeypatch.setattr(place, refused)
    sheet = gears.sheet()
    assert {value.reason for value in sheet.missing if value.table == title} == {"no such figure"}
    left = [table.title for table in sheet.tables if table.rows]
    assert set(left) <= set(whole)
    assert len(left) > 3


def test_no_flat_anvils_on_helical_internal_gears() -> None:
    rows = gm.build(ring(helix_angle=15)).sheet()
    table = rows.plain_tables[MEASURES]
    assert [table[symbol][2] for symbol in ("k_W", "W_k", "d_W", "b_W", "M_dR")] == [None] * 5
    assert None not in (table["W_k"][1], table["M_dR"][1], table["M_dK"][2])
    assert any("hollow" in value.reason for value in rows.missing if (value.symbol, value.column) == ("W_k", "gear"))
    with pytest.raises(DesignError, match=r"gear\.span\.teeth = 6: flat anvils cannot touch the hollow flanks"):
        gm.build(ring(helix_angle=15, gear={"span": {"teeth": 6}}))


def test_rounded_anvils_of_an_internal_span_touch_where_they_should() -> None:
    """Circles that touch the flank of a built tooth where the span does: of the largest radius they are free of both flanks of the
    space, of one a little larger they are not."""
    gears = gm.build(ring())
    table = gears.sheet().plain_tables[MEASURES]
    anvil, contact = table["r_W"][2], 0.5 * table["d_W"][2]
    tooth = gears.members["gear"].tooth
    shares, middle = np.linspace(0.0, 1.0, 4001), np.array([0.5])
    flanks = {side: tooth.flank_grid(side, shares, middle).points[:, 0, :2] for side in Side}
    right = flanks[Side.RIGHT]
    at = int(np.abs(np.hypot(*right.T) - contact).argmin())
    tangent = right[at + 1] - right[at - 1]
    normal = np.array([-tangent[1], tangent[0]]) / np.hypot(*tangent)
    # across the space, away from the tooth's other flank
    normal *= -np.sign(normal @ (flanks[Side.LEFT][at] - right[at]))
    step = 2.0 * math.pi / 50
    turn = np.array([[math.cos(step), math.sin(step)], [-math.sin(step), math.cos(step)]])
    others = np.concatenate((right, flanks[Side.LEFT] @ turn, flanks[Side.LEFT] @ turn.T))

    def depth(radius: float) -> float:
        """Return the depth, mm, of the circle inside either flank."""
        return float(radius - np.hypot(*(others - right[at] - radius * normal).T).min())

    assert depth(anvil) < 1e-3
    assert depth(1.05 * anvil) > 1e-2


@pytest.mark.sweep
def test_pins_over_odd_helical_teeth_need_room_to_slide() -> None:
    """Spaces of 21 teeth are opposite each other where the helix has turned them by half a pitch: 12.1 mm apart here."""
    design = {"kind": "cylindrical", "module": 2, "helix_angle": 15, "gear": {"teeth": 40, "face_width": 30}}
    wide, narrow = (
        gm.build(gm.parse({**design, "pinion": {"teeth": 21, "face_width": width}})).sheet() for width in (14, 12)
    )
    own = Toothing(21, 2.0, math.radians(20.0), math.radians(15.0), 0.0)
    apart = math.pi * 2.0 / math.sin(math.radians(15.0)) / 2.0
    ball = wide.plain_tables[MEASURES]["D_M"][1]
    assert measures.pin_width(own, ball) - measures.ball_width(own, ball) == pytest.approx(apart, rel=1e-12)
    assert wide.plain_tables[MEASURES]["M_dR"][1] is not None
    assert narrow.plain_tables[MEASURES]["M_dR"][1] is None
    assert narrow.plain_tables[MEASURES]["M_dK"][1] is not None
    assert any("slide" in value.reason for value in narrow.missing if value.symbol == "M_dR")
