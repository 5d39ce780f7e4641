"""The index of a pinion's blank: free on the machine, found by the backlash, given in a design, kept by compensation."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import Design
from gearmesh.contact.fit.fit import fit
from gearmesh.kernel.numeric.algebra import ARCSEC, Array
from gearmesh.kinds import Side
from gearmesh.systems.spiral_bevel.sheet.sheet import settings_sheet

#: all settings printed, and a backlash of 0.05 mm
GIVEN = SAMPLES / "spiral_bevel_abdullah_straight.toml"
BACKLASH = 0.05
#: rotation (rad) of the pinion by which the printed settings miss contact at the mean point, at most
CLOSURE = 3.0 * ARCSEC


def index_angles(design: Design) -> dict[str, float]:
    """Index angles of the pinion's blank from the sheet, deg, by side."""
    rows = {row[0]: row[2:] for table in gm.build(design).sheet().tables for row in table.rows}
    return dict(zip(("concave", "convex"), rows["index angle of the blank"], strict=False))


def points_of(design: Design) -> Array:
    """Flanks of the pinion's tooth in its own frame, (2, ...)."""
    tooth = gm.build(design).members["pinion"].tooth
    s, t = np.linspace(0.0, 1.0, 6), np.linspace(0.0, 1.0, 5)
    return np.array([tooth.flank_grid(which, s, t).points for which in Side])


def backlash_of(design: Design) -> float:
    fitted = fit(gm.build(design).pairs[0])
    assert fitted is not None
    return fitted.normal_backlash[0]


@pytest.mark.sweep_cases("1.0", "0.5")
@pytest.mark.parametrize("shift", [1.0, 0.5, -25.0])
def test_another_zero_of_the_cradle_is_another_index_and_the_same_tooth(shift: float) -> None:
    """If the cradle stands farther at its zero, the blank stands back by as much over the ratio of roll."""
    design: Any = gm.load(GIVEN)
    before = index_angles(design)
    angle = design.pinion.concave.cradle_angle + shift
    moved = design.with_values({"pinion.concave.cradle_angle": angle})
    after = index_angles(moved)
    assert before["concave"] - after["concave"] == pytest.approx(shift / design.pinion.concave.ratio_of_roll, abs=1e-8)
    assert after["convex"] == before["convex"]
    np.testing.assert_allclose(points_of(moved), points_of(design), rtol=0, atol=1e-8)
    # the position as cut is that of contact within a tenth of a pitch only: else phi1 = 0 is contact at the mean point
    zeros = [gm.build(each).pairs[0].pinion.mount.zero for each in (design, moved)]
    apart = np.radians(shift) / design.pinion.concave.ratio_of_roll
    near = abs(apart) < 0.1 * 2.0 * np.pi / design.pinion.teeth
    assert zeros[1] - zeros[0] == pytest.approx(-apart if near else 0.0, abs=2.0 * CLOSURE)


@pytest.mark.sweep
def test_given_settings_leave_the_backlash_asked_for_and_touch_at_phi1_0() -> None:
    design = gm.load(GIVEN)
    contact = gm.build(design.with_values({"mean_point": "mean_cone_distance"})).contact(phi1=0.0, cycle=False)
    assert abs(contact.path.phi2[0]) < 1e-11
    # at the mean point that cradle rotation 0 generates phi1 = 0 is the position as cut
    assert 0.1 * ARCSEC < abs(gm.build(design).contact(phi1=0.0, cycle=False).path.phi2[0]) < CLOSURE
    # the gear leads at the change of teeth, which takes some um
    assert backlash_of(design) == pytest.approx(BACKLASH, abs=8e-3)
    assert backlash_of(design.with_values({"backlash": 0.3})) - backlash_of(design) == pytest.approx(0.25, rel=0.02)


@pytest.mark.sweep
def test_given_index_makes_the_same_tooth_for_any_backlash() -> None:
    design: Any = gm.load(GIVEN)
    sheet = settings_sheet(design, gm.build(design).train)
    keys = {"pinion.concave.index_angle", "pinion.convex.index_angle"}
    assert sheet.following.keys() == keys
    assert not keys & sheet.values.keys()
    again = design.with_values({**sheet.values, **sheet.following})
    np.testing.assert_allclose(points_of(again), points_of(design), rtol=0, atol=1e-12)
    other = again.with_values({"backlash": 0.4})
    np.testing.assert_allclose(points_of(other), points_of(design), rtol=0, atol=1e-12)
    # the sheet tells the backlash that there is, not the one that nobody asks for
    tables = [gm.build(each).sheet().plain_tables for each in (design, other)]
    one, two = (next(table["j_mt"] for table in each.values() if "j_mt" in table) for each in tables)
    assert two[1:] == pytest.approx(one[1:], abs=1e-9)
    # 0.1 deg of one flank of a right-hand pinion, at the mean radius, across the tooth
    thicker = again.with_values({"pinion.concave.index_angle": sheet.following["pinion.concave.index_angle"] + 0.1})
    blank = {row[0]: row[2] for table in gm.build(design).sheet().tables for row in table.rows}
    radius = blank["mean cone distance"] * np.sin(np.arctan2(10.0, 41.0))
    less = np.radians(0.1) * radius * np.cos(np.radians(35.0)) * np.cos(np.radians(20.0))
    assert backlash_of(design) - backlash_of(thicker) == pytest.approx(less, rel=0.05)


@pytest.mark.sweep
def test_compensating_settings_keep_the_backlash() -> None:
    errors = {"assembly.dV": 0.1, "assembly.dA": -0.08, "assembly.dG": 0.15, "assembly.d_delta": 0.05}
    design = gm.load(GIVEN)
    bent = design.with_values(errors)
    found = gm.build(bent).compensate()
    assert {"pinion.concave.index_angle", "pinion.convex.index_angle"} <= {row.key for row in found.rows}
    asked = backlash_of(design)
    assert abs(backlash_of(bent) - asked) > 0.05
    assert backlash_of(found.apply()) == pytest.approx(asked, abs=2e-3)
