"""Tooth thickness that is given: the finished teeth have it, in place of the backlash and of the gear's point width."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import Design, DesignError

GIVEN = SAMPLES / "spiral_bevel_abdullah_straight.toml"
BASIC = {"kind": "spiral_bevel", "units": "inch", "module": 0.18, "pinion": {"teeth": 10}, "gear": {"teeth": 41}}
ASKED = {"pinion.thickness": 5.9, "gear.thickness": 3.4}


def measured(gears: gm.Gears) -> list[float]:
    """s_mn of pinion and gear, measured on the flanks of the built teeth."""
    (table,) = (each for each in gears.sheet().tables if each.title.startswith("Teeth as cut"))
    (row,) = (row for row in table.rows if row[0] == "mean normal circular thickness")
    return list(row[2:])


def without_backlash(design: Design, **values: Any) -> Design:
    """The design with `values` in the place of what makes its thicknesses."""
    own = dict(design.own())
    return design.with_values({key: None for key in ("backlash", "gear.cutter.point_width") if key in own} | values)


@pytest.mark.sweep
@pytest.mark.parametrize("design", [gm.load(GIVEN), gm.parse(BASIC)], ids=["given", "inch"])
def test_built_teeth_are_as_thick_as_asked(design: Design) -> None:
    unit = design.mm_per_unit
    asked = {key: value / unit for key, value in ASKED.items()}
    thick = without_backlash(design, **asked)
    gears = gm.build(thick)
    # both are measured within 1e-10 mm of the pitch cone, and rounded to 1e-9 in the sheet
    assert measured(gears) == pytest.approx(list(asked.values()), abs=2e-9)
    # a sheet in its place asks for the same teeth, by the point width; and so does a pinned design, by the index too
    again = gears.sheet().apply()
    assert again.sets("pinion.thickness")
    assert again.sets("gear.cutter.point_width")
    pinned = gears.pin().design
    assert not pinned.sets("pinion.thickness")
    assert pinned.sets("pinion.convex.index_angle")
    for other in (again, pinned):
        assert measured(gm.build(other)) == pytest.approx(list(asked.values()), abs=2e-9)


@pytest.mark.sweep
def test_backlash_is_what_the_thicknesses_leave() -> None:
    """Measure backlash by first contact of both sides, a route that knows no thickness. It grows by what the teeth are thinned,
    along the normal."""
    least = []
    for thinner in (0.0, 0.05):
        values = {"pinion.thickness": 5.9 - thinner, "gear.thickness": 3.9 - 2.0 * thinner}
        gears = gm.build(without_backlash(gm.load(GIVEN), **values))
        least.append(gears.contact().summary["backlash_normal_min_mm"])
    # not at the mean point, where thicknesses are measured, but where the backlash is least: by a little of the face
    assert least[1] - least[0] == pytest.approx(3.0 * 0.05 * np.cos(np.radians(20.0)), rel=0.03)


@pytest.mark.sweep
def test_compensation_keeps_the_backlash_by_the_thickness() -> None:
    design = without_backlash(gm.load(GIVEN), **ASKED)
    found = gm.build(design.with_values({"assembly.dA": 0.1, "assembly.dV": 0.05})).compensate()
    (row,) = (row.row for row in found.rows if "index" in row.key or "thickness" in row.key)
    assert row["key"] == "pinion.thickness"
    kept, before = (gm.build(each).contact().summary["backlash_normal_min_mm"] for each in (found.apply(), design))
    assert kept == pytest.approx(before, abs=2e-3)
    assert abs(row["value_after"] - row["value_before"]) > 0.01


@pytest.mark.sweep_cases("no room")
@pytest.mark.parametrize(
    ("values", "message"),
    [
        (
            {"pinion.thickness": 5.9, "backlash": 0.1},
            r"^pinion.thickness = 5.9 mm: cannot be given together with backlash",
        ),
        (
            {"pinion.thickness": 5.9, "pinion.convex.index_angle": 9.0},
            r"^pinion.thickness = 5.9 mm: cannot be given together with pinion.convex.index_angle",
        ),
        (
            {"gear.thickness": 3.9, "gear.cutter.point_width": 2.0},
            r"^gear.thickness = 3.9 mm: cannot be given together with gear.cutter.point_width",
        ),
        (
            {"gear.thickness": 9.0},
            r"^gear.thickness = 9 mm: allowed is at most \S+ mm, .*: the cutter would have no point width$",
        ),
        ({"pinion.thickness": 0.0}, r"^pinion.thickness = 0.0: must be a length in mm above 0"),
        ({"pinion.thickness": 7.0}, r"^pinion.thickness = 7 mm: the tooth is \S+ mm too thick"),
    ],
    ids=["backlash", "index", "point width", "no room", "none", "jammed"],
)
def test_thickness_refused(values: dict[str, Any], message: str) -> None:
    with pytest.raises(DesignError, match=message):
        gm.build(without_backlash(gm.load(GIVEN), **values))


def test_blades_of_one_cut_leave_no_thickness_to_ask_for() -> None:
    given = dict(gm.load(GIVEN).own())
    one = {key.replace("concave", "convex"): value for key, value in given.items() if key.startswith("pinion.concave.")}
    own = {key: given[key] for key in ("pinion.convex.tip_radius", "pinion.convex.blade_angle")}
    # the outside blade, which cuts the concave side, is the wider one: blades that cross are refused
    own["pinion.convex.tip_radius"] = given["pinion.concave.tip_radius"] - 2.0
    bases = {f"pinion.{name}.sliding_base": 0.0 for name in ("concave", "convex")}
    design = gm.load(GIVEN).with_values({**one, **own, **bases, "process": "completing"})
    with pytest.raises(DesignError, match=r'^pinion.thickness = 5.9 mm: process = "completing" determines it by'):
        design.with_values({"backlash": None, "pinion.thickness": 5.9})


@pytest.mark.sweep
def test_the_thickness_that_is_said_to_be_allowed_has_no_backlash() -> None:
    design = without_backlash(gm.load(GIVEN))
    with pytest.raises(DesignError) as refused:
        gm.build(design.with_values({"pinion.thickness": 7.0}))
    most = float(str(refused.value).split("at most about ")[1].split(" mm")[0])
    (j_mn,) = (
        row[2]
        for table in gm.build(design.with_values({"pinion.thickness": most - 0.001})).sheet().tables
        for row in table.rows
        if row[0] == "mean normal backlash"
    )
    # the formula of the normal is that of the pitch cone: the tooth is curved
    assert 0.0 < j_mn < 0.02
