"""Given machine settings of pinions by one crown gear, and their correction by measured flanks."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from oracles.measuring import along_normals

import gearmesh as gm
from gearmesh.answers.inspection.correction import correct_settings, residual_text
from gearmesh.kinds import Side, Tooth
from gearmesh.systems import system as systems
from gearmesh.systems.spiral_bevel.design import CROWN_MACHINE_KEYS
from gearmesh.systems.spiral_bevel.synthesis.teeth_choice import bevel_teeth

#: a pair that no sample resembles
DESIGN = {
    **{"kind": "spiral_bevel", "process": "face_hobbed", "module": 6.3, "spiral_angle": 28, "hand": "right"},
    **{"head": {"blade_groups": 7}, "pinion": {"teeth": 17}, "gear": {"teeth": 44}},
}
#: changes of settings of the concave side: mm, deg, mm
OFF = {"radial": 0.02, "cradle_angle": 0.02, "machining_offset": 0.015}


@pytest.fixture(scope="module")
def pinned() -> gm.Design:
    design = gm.parse(DESIGN)
    return systems.pin(design, systems.build(design))


def pinion(design: gm.Design) -> Tooth:
    return systems.member(design, "pinion").member.one_tooth


def test_given_settings_of_one_crown_gear_make_the_same_flanks(pinned: gm.Design) -> None:
    one, other = (bevel_teeth(each.in_mm()).cut.pinion for each in (gm.parse(DESIGN), pinned))  # type: ignore[arg-type]
    for name, side in one.items():
        spec = pinned.plain()["pinion"][name]
        assert all(spec[key] is not None for key in CROWN_MACHINE_KEYS)
        p = np.array([side.blade.at_height(height) for height in (2.0, 5.0)])
        points = [sides[name].side(0.0).flank.jet(p, np.array([-0.1, 0.1])).r for sides in (one, other)]
        assert points[1] == pytest.approx(points[0], abs=1e-9)


@pytest.mark.sweep
def test_settings_of_one_crown_gear_that_were_off_come_back(pinned: gm.Design, tmp_path: Path) -> None:
    """The pinion is cut with three settings off; a correction of all usual settings finds them, and leaves nothing."""
    nominal = pinion(pinned)
    own = pinned.plain()["pinion"]["concave"]
    off = pinion(pinned.with_values({f"pinion.concave.{key}": own[key] + change for key, change in OFF.items()}))
    grids = {side: along_normals(off, side, nominal) for side in Side}
    before = max(float(np.sqrt(np.mean(grid.values**2))) for grid in grids.values())
    assert before > 5e-3
    path = tmp_path / "pinion.csv"
    path.write_text(residual_text(grids))
    made = correct_settings(gm.parse(DESIGN), "pinion", path)
    assert {setting.plain_name for setting in made.settings} <= {*CROWN_MACHINE_KEYS}
    left = max(float(np.sqrt(np.mean(each.values**2))) for each in made.residual.values())
    assert left < 0.02 * before
