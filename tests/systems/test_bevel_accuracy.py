"""Tolerances of ISO 17485 for bevel and hypoid gears."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.metrology.iso17485 import BevelSizes
from gearmesh.systems.common.bevel.accuracy import tolerance_table
from gearmesh.systems.spiral_bevel.synthesis.settings import basic_blank


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
    alone = gm.build(design, alone=True).sheet(member="gear").plain_tables[title]
    assert alone["B"][1:] == [6]
    sizes = BevelSizes(design.gear.teeth, alone["d_T"][1], basic_blank(design.in_mm()).mean_normal_module)
    assert {symbol: alone[symbol][1] for symbol in ("f_ptT", "F_pT", "F_rT")} == sizes.tolerances(6)
