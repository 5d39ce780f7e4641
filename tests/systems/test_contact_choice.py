"""Contact of bevel pairs where the design leaves it open, compared with the contact of the built teeth."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from oracles.examples import some

import gearmesh as gm
from gearmesh.check.members import roll_members
from gearmesh.kernel.numeric.algebra import ARCSEC
from gearmesh.systems.spiral_bevel.synthesis import contact_preview
from gearmesh.systems.spiral_bevel.synthesis.contact_choice import contact_said
from gearmesh.systems.spiral_bevel.synthesis.contact_preview import ContactPreviews
from gearmesh.systems.spiral_bevel.synthesis.settings import basic_blank
from gearmesh.systems.spiral_bevel.synthesis.teeth_choice import bevel_teeth

#: few teeth and alike; wide and large, many teeth; high spiral; obtuse; small zerol
PAIRS: dict[str, dict[str, Any]] = {
    "12/13": {"module": 5.189, "spiral_angle": 20.58, "pressure_angle": 20.0, "teeth": (12, 13), "hand": "right"},
    "28/100": {"module": 11.235, "spiral_angle": 10.23, "pressure_angle": 20.0, "teeth": (28, 100), "hand": "left"},
    "14/72": {"module": 0.927, "spiral_angle": 36.28, "pressure_angle": 20.17, "teeth": (14, 72), "hand": "right"},
    "14/49": {"module": 2.0, "spiral_angle": 38.0, "pressure_angle": 17.2, "shaft_angle": 102.0, "teeth": (14, 49)},
    "13/31": {"module": 0.8, "spiral_angle": 0.0, "pressure_angle": 22.5, "teeth": (13, 31), "hand": "left"},
}


def pair(name: str, side: str, **others: Any) -> gm.Design:
    data = dict(PAIRS[name])
    pinion, gear = data.pop("teeth")
    data |= {"kind": "spiral_bevel", "pinion": {"teeth": pinion, side: others}, "gear": {"teeth": gear}}
    return gm.parse({**data, "contact": {"side": f"pinion_{side}"}})


@pytest.mark.sweep
@pytest.mark.parametrize(("name", "side"), some([(name, side) for name in PAIRS for side in ("concave", "convex")], 2))
def test_pairs_hand_over_as_asked(name: str, side: str) -> None:
    """The whole contact of the teeth, edges and all, and the roll of whole members."""
    gears = gm.build(pair(name, side))
    answer = gears.contact()
    assert answer.summary["contact_ratio"] > 1.15
    assert answer.summary["te_breaks_phi1_deg"] == []
    assert answer.summary["mesh_te_peak_to_peak_arcsec"] == pytest.approx(10.0, rel=0.06)
    assert answer.summary["interference_um"] == 0.0
    assert answer.cycle is not None
    assert answer.cycle.curve is not None
    # nothing leads the path: neither at the change of teeth nor where it is farthest from the mean point
    for phi1 in (0.0, 0.5 * gears.pairs[0].pitch):
        phi2 = gears.pairs[0].ratio * phi1 + gears.pairs[0].drive * float(
            answer.cycle.curve.advance(np.array([phi1]))[0]
        )
        (rolled,) = roll_members(gears.pairs[0], phi1, guess_phi2=phi2)
        assert rolled.drive is not None
        assert abs(rolled.drive.phi2 - phi2) < 0.3 * ARCSEC


def test_a_path_is_the_same_from_another_path_and_step_by_step(monkeypatch: pytest.MonkeyPatch) -> None:
    design = pair("14/49", "concave").in_mm()
    blank = basic_blank(design)
    asked = contact_said(design, blank, "concave")
    choices = [
        replace(asked, asked=replace(asked.asked, path_angle=float(np.radians(deg)))) for deg in (90.0, 75.0, 45.0)
    ]
    calls: list[int] = []
    solve = contact_preview.solve

    def counted(function: Any, start: Any, **named: Any) -> Any:
        calls.append(len(start))
        return solve(function, start, **named)

    monkeypatch.setattr(contact_preview, "solve", counted)
    together = ContactPreviews(design, blank, "concave")
    along = [together.of(choice) for choice in choices]
    few = len(calls)
    alone = [ContactPreviews(design, blank, "concave").of(choice) for choice in choices]
    assert few < 0.6 * (len(calls) - few)
    for path, other in zip(along, alone, strict=True):
        assert path is not None
        assert other is not None
        assert path.phi.tolist() == other.phi.tolist()
        np.testing.assert_allclose(path.unknowns, other.unknowns, rtol=0.0, atol=1e-11)


@pytest.mark.sweep
def test_a_prospect_is_the_contact_of_the_teeth() -> None:
    design = pair("14/49", "concave")
    own = design.in_mm()
    path = ContactPreviews(own, basic_blank(own), "concave").of(bevel_teeth(own).choices["concave"])
    assert path is not None
    cycle = gm.build(design).contact().cycle
    assert cycle is not None
    # the path is straight between positions an eighth of a pitch apart
    pitch = 2.0 * np.pi / 14.0
    np.testing.assert_allclose((path.begin, path.end), np.array(cycle.surface) / pitch, rtol=0.0, atol=0.01)
    assert path.at_change == pytest.approx(cycle.peak_to_peak, rel=2e-3)
    assert abs(path.begin + path.end) < 0.05


@pytest.mark.sweep
def test_what_the_design_says_of_the_contact_stands() -> None:
    said = {"path_angle": 70.0, "semi_major_axis": 2.0, "mean_offset": 0.05, "mean_shift": -0.2, "te_at_change": 20.0}
    found = bevel_teeth(pair("14/49", "convex", **said).in_mm()).choices["convex"]
    assert np.degrees(found.asked.path_angle) == pytest.approx(70.0)
    assert (found.asked.semi_major_axis, found.height, found.along) == (2.0, 0.05, -0.2)
    answer = gm.build(pair("14/49", "convex", **said)).contact()
    assert answer.summary["mesh_te_peak_to_peak_arcsec"] == pytest.approx(20.0, rel=0.03)
    fixed = bevel_teeth(pair("14/49", "convex", ratio_derivative=0.01).in_mm()).choices["convex"]
    assert fixed.asked.ratio_derivative == 0.01


@pytest.mark.sweep
def test_modified_roll_comes_where_nothing_else_helps() -> None:
    ordinary = bevel_teeth(pair("14/49", "concave").in_mm()).choices["concave"]
    assert ordinary.roll == (0.0, 0.0, 0.0)
    data = {
        "kind": "spiral_bevel",
        "module": 2.657,
        "spiral_angle": 32.94,
        "pressure_angle": 20.88,
        "shaft_angle": 103.41,
        # as the standard suggests, though undercut
        "depth_factor": 1.895,
        "addendum_factor": 0.309424,
    }
    steep = gm.parse(
        {**data, "face_width": 4.942, "pinion": {"teeth": 8}, "gear": {"teeth": 12}, "hand": "right"}
    ).in_mm()
    bent = bevel_teeth(steep).choices["concave"]
    path = ContactPreviews(steep, basic_blank(steep), "concave").of(bent)
    assert any(bent.roll)
    assert path is not None
    assert path.at_change == pytest.approx(10.0 * ARCSEC, rel=0.06)
    # without it the parabola is bent so much that pairs do not hand over at all
    straight = ContactPreviews(steep, basic_blank(steep), "concave").of(replace(bent, roll=(0.0, 0.0, 0.0)))
    assert straight is not None
    assert abs(straight.orders[3]) > 3.0 * abs(path.orders[3])
