"""Tolerances of ISO 17485 for bevel and hypoid gears."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.systems.spiral_bevel.sheet.accuracy import ToleranceSizes, tolerance_table, tolerances
from gearmesh.systems.spiral_bevel.synthesis.settings import basic_blank


@pytest.mark.quick
def test_tolerances_of_iso_17485() -> None:
    """By hand: module 5, 100 mm; a factor of sqrt(2) from grade to grade; rounding in its ranges; silence beyond the range."""
    sizes = ToleranceSizes(20, 100.0, 5.0)
    # grade 4: f_pt 6.8, F_p 23, F_r 18.4
    assert tolerances(4, sizes) == {"f_ptT": 7.0, "F_pT": 23.0, "F_rT": 18.0}
    # grade 6: twice; grade 2: half; grade 7: 19.23, 65.05, 52.04
    assert tolerances(6, sizes) == {"f_ptT": 14.0, "F_pT": 46.0, "F_rT": 37.0}
    assert tolerances(2, sizes) == {"f_ptT": 3.4, "F_pT": 12.0, "F_rT": 9.0}
    assert tolerances(7, sizes) == {"f_ptT": 19.0, "F_pT": 65.0, "F_rT": 52.0}
    for beyond in ((4, 100.0, 5.0), (401, 100.0, 5.0), (20, 4.9, 5.0), (20, 2501.0, 5.0), (20, 100.0, 0.9)):
        assert tolerances(6, ToleranceSizes(*beyond)) is None


@pytest.mark.quick
def test_the_tolerance_diameter_is_in_the_middle_of_the_working_depth() -> None:
    """Both members' circles meet in one point: as far from either axis as their radii say, at the mean cone distance."""
    design = gm.load(SAMPLES / "spiral_bevel_basic.toml")
    blank = basic_blank(design.in_mm())
    table = tolerance_table(design.accuracy_grade, blank, ("pinion", "gear"))
    radii = [0.5 * d for d in table.rows[table.symbols.index("d_T")][2:]]
    # axes through the origin, at the shaft angle to each other; the pinion's tooth above its pitch line
    pinion, (first, second) = blank.pinion, blank.standard_depths
    axes = [np.array([1.0, 0.0]), np.array([np.cos(blank.shaft_angle), np.sin(blank.shaft_angle)])]
    along = np.array([np.cos(pinion.pitch_angle), np.sin(pinion.pitch_angle)])
    up = np.array([-along[1], along[0]])
    tips = pinion.mean_cone_distance * along + np.outer([first.addendum, -second.addendum], up)
    middle = tips.mean(axis=0)
    for axis, radius in zip(axes, radii, strict=True):
        assert abs(axis[0] * middle[1] - axis[1] * middle[0]) == pytest.approx(radius, rel=1e-6)


def test_the_sheet_of_a_pair_and_of_one_member_have_them() -> None:
    design = gm.load(SAMPLES / "hypoid.toml").with_values({"accuracy_grade": 6})
    title = "Tolerances [ISO 17485:2006]"
    alone = gm.build(design, alone="gear").sheet(member="gear").plain_tables[title]
    assert alone["B"][1:] == [6]
    sizes = ToleranceSizes(design.gear.teeth, alone["d_T"][1], basic_blank(design.in_mm()).mean_normal_module)
    assert {symbol: alone[symbol][1] for symbol in ("f_ptT", "F_pT", "F_rT")} == tolerances(6, sizes)
