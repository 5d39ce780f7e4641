"""Teeth of bevel designs that leave proportions and contact open: whole where they can be, and the same to whoever asks."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from oracles.examples import some

import gearmesh as gm
from gearmesh import NoSolutionError
from gearmesh.kinds import Side
from gearmesh.systems.spiral_bevel.synthesis import teeth_choice
from gearmesh.systems.spiral_bevel.synthesis.settings import basic_blank
from gearmesh.systems.spiral_bevel.synthesis.teeth_choice import bevel_teeth
from gearmesh.teeth.limits import member_limits

#: what the standard suggests is undercut: pinion alone, so that addendum helps; both; or has no room for the pinion's roots
OPEN: dict[str, dict[str, Any]] = {
    "8/30": {"module": 1.18, "spiral_angle": 39.0, "pressure_angle": 17.1, "teeth": (8, 30)},
    "9/21": {"module": 1.5, "spiral_angle": 26.8, "pressure_angle": 16.2, "teeth": (9, 21), "hand": "right"},
    "16/84": {
        "module": 4.0,
        "spiral_angle": 0.0,
        "pressure_angle": 24.6,
        "face_width": 59.0,
        "teeth": (16, 84),
        "backlash": 0.0,
    },
}
EXAMPLE = {"kind": "spiral_bevel", "module": 5, "pinion": {"teeth": 13}, "gear": {"teeth": 44}}


def pair(name: str, **more: Any) -> gm.Design:
    data = dict(OPEN[name])
    pinion, gear = data.pop("teeth")
    return gm.parse({"kind": "spiral_bevel", "pinion": {"teeth": pinion}, "gear": {"teeth": gear}, **data, **more})


def flank_points(gears: gm.Gears, name: str) -> np.ndarray:
    tooth = gears.members[name].tooth
    return np.concatenate([tooth.flank_grid(side, [0.2, 0.8], [0.1, 0.9]).points for side in Side])


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("name", "changed"), some([("8/30", "addendum_factor"), ("16/84", "depth_factor"), ("9/21", "depth_factor")], 2)
)
def test_proportions_that_are_left_open_give_whole_teeth(name: str, changed: str) -> None:
    """The limiting line, found on the prolonged flank, is below the form point all along the face."""
    gears = gm.build(pair(name))
    (line,) = [line for line in gears.warnings if "the default, instead of" in line]
    assert changed in line
    assert not any("is undercut" in line for line in gears.warnings)
    for member in gears.members.values():
        for side in member_limits(member).sides.values():
            assert not (side.h1 < side.form_point_depth).any()


@pytest.mark.sweep
def test_proportions_that_the_design_says_stand() -> None:
    said = {"depth_factor": 1.94, "addendum_factor": 0.2808}
    gears = gm.build(pair("9/21", **said))
    assert any("is undercut" in line for line in gears.warnings)
    blank = bevel_teeth(pair("9/21", **said).in_mm()).cut.blank
    assert blank.mean_working_depth == pytest.approx(1.94 * blank.mean_normal_module)
    # one of the two still follows from the other
    depth = bevel_teeth(pair("9/21", depth_factor=1.94).in_mm()).cut.blank
    assert depth.mean_working_depth == pytest.approx(1.94 * depth.mean_normal_module)
    assert depth.gear.mean_addendum < 0.9 * blank.gear.mean_addendum


@pytest.mark.sweep
def test_whole_teeth_are_as_the_standard_suggests() -> None:
    design = gm.parse(EXAMPLE).in_mm()
    assert bevel_teeth(design).cut.blank == basic_blank(design)


@pytest.mark.sweep
def test_settings_that_are_derived_build_the_same_teeth(monkeypatch: pytest.MonkeyPatch) -> None:
    """Also where teeth with the contact that is best do not close, and plainer ones are built."""
    for design in (pair("9/21"), gm.parse({**EXAMPLE, "module": 5.01})):
        gears = gm.build(design)
        again = gm.build(design.with_values(gears.sheet().values))
        for name in gears.members:
            np.testing.assert_allclose(flank_points(again, name), flank_points(gears, name), rtol=0.0, atol=1e-9)

        def none(*_: Any) -> None:
            raise NoSolutionError("no teeth with this contact")

        monkeypatch.setattr(teeth_choice, "contact_choice", none)


def test_what_is_set_to_its_default_is_set() -> None:
    chosen = bevel_teeth(gm.parse(EXAMPLE).in_mm()).choices["concave"].asked.path_angle
    said = gm.parse({**EXAMPLE, "pinion": {"teeth": 13, "concave": {"path_angle": 90.0}}})
    assert np.degrees(chosen) != pytest.approx(90.0)
    assert np.degrees(bevel_teeth(said.in_mm()).choices["concave"].asked.path_angle) == pytest.approx(90.0)


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("teeth", "data"),
    [
        # teeth touch 90 arcsec behind their neighbours for longer than where they carry
        (
            (26, 84),
            {"module": 4.491, "spiral_angle": 41.19, "pressure_angle": 16.95, "face_width": 69.057, "hand": "left"},
        ),
        # the pinion's corner of toe and tip, narrower than a fifteenth of the depth, would touch before the path
        (
            (15, 58),
            {"module": 9.069, "spiral_angle": 9.37, "pressure_angle": 19.82, "face_width": 84.961, "hand": "right"},
        ),
    ],
)
def test_pairs_that_touch_elsewhere_hand_over_smoothly(teeth: tuple[int, int], data: dict[str, Any]) -> None:
    whole = {"kind": "spiral_bevel", "pinion": {"teeth": teeth[0]}, "gear": {"teeth": teeth[1]}, **data}
    gears = gm.build(gm.parse({**whole, "contact": {"side": "pinion_convex"}}))
    contact = gears.contact()
    summary, cycle = contact.summary, contact.cycle
    assert summary["te_breaks_phi1_deg"] == []
    assert summary["mesh_te_peak_to_peak_arcsec"] == pytest.approx(10.0, rel=0.06)
    assert cycle is not None
    assert cycle.surface[0] < 0.0 < cycle.surface[1]
    assert 1.2 < summary["contact_ratio"] < 1.6
