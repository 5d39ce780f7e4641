"""Face hobbing with modified roll and motions: flanks against moved blades, and the contact by modified roll."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from oracles.moved_blades import clearances

import gearmesh as gm
from gearmesh.contact.flanks import analyse
from gearmesh.kernel.envelope.indexed_envelope import IndexedEnvelope
from gearmesh.systems.spiral_bevel.errors.compensation import compensate
from gearmesh.systems.spiral_bevel.machine.generated import Generated
from gearmesh.systems.spiral_bevel.synthesis.teeth_choice import bevel_teeth

#: motions of the machine of any side: lengths in mm, angles in rad
MOTIONS: dict[str, tuple[float, ...]] = {
    "modified_roll": (0.06, -0.1, 0.2),
    "helical_motion": (1.5, -3.0),
    "vertical_motion": (-0.8, 2.0),
    "radial_motion": (0.6, 1.0),
    "tilt_motion": (0.01, 0.03),
    "swivel_motion": (-0.02,),
}
ROLL_ALONE = {"modified_roll": (0.08, 0.1, -0.2)}
#: a gear with many teeth that is not generated: the crowned head of the pinion left it no room for its roots
MANY_TEETH: dict[str, Any] = {
    **{"kind": "spiral_bevel", "process": "face_hobbed_formate", "module": 3.193, "pressure_angle": 19.39},
    **{"hand": "right", "spiral_angle": 31.27, "head": {"blade_groups": 16}},
    **{"pinion": {"teeth": 25}, "gear": {"teeth": 145}},
}
NAMES = ("concave", "convex")
#: errors of assembly, mm and deg
ERRORS = {"assembly.dV": 0.1, "assembly.dA": -0.08, "assembly.d_delta": 0.05}


def pinion_sides(process: str) -> dict[str, Generated]:
    """Sides of a left-hand pinion, tilted where its gear is not generated."""
    if process == "face_hobbed":
        values = {"kind": "spiral_bevel", "module": 5, "spiral_angle": 32, "head": {"blade_groups": 7}}
        design = gm.parse({**values, "process": process, "pinion": {"teeth": 14}, "gear": {"teeth": 39}})
    else:
        design = gm.load("samples/hypoid_face_hobbed.toml")
    return dict(bevel_teeth(design.in_mm()).cut.pinion)  # type: ignore[arg-type]


def envelope_of(side: Generated, motions: dict[str, tuple[float, ...]]) -> tuple[Generated, IndexedEnvelope]:
    made = replace(side, turned=0.0, settings=replace(side.settings, **motions))
    flank = made.envelope(made.blade.flank)
    assert isinstance(flank, IndexedEnvelope)
    return made, flank


def grid_of(side: Generated) -> tuple[np.ndarray, np.ndarray]:
    p, v = np.meshgrid([side.blade.at_height(x) for x in (2.0, 4.0, 6.0)], [-0.12, 0.0, 0.1], indexing="ij")
    return p.ravel(), v.ravel()


@pytest.mark.parametrize("motions", [MOTIONS, ROLL_ALONE], ids=["motions", "modified_roll"])
@pytest.mark.parametrize("process", ["face_hobbed", "face_hobbed_formate"])
@pytest.mark.sweep_cases("face_hobbed-motions", "face_hobbed_formate-modified_roll", "face_hobbed_formate-motions")
def test_flanks_of_moved_machines_are_the_lower_envelope_of_the_blades(
    process: str, motions: dict[str, tuple[float, ...]]
) -> None:
    """No blade comes nearer than the flank, over rotation and roll; one blade touches it."""
    for side in pinion_sides(process).values():
        made, flank = envelope_of(side, motions)
        u, v = grid_of(made)
        jet, roll = flank.jet(u, v), flank.rolls(u, v)
        unknowns, gaps = np.stack((v, u, np.zeros_like(u)), axis=-1), []
        for sign in (1.0, -1.0):
            x = unknowns
            for k in range(12):
                x = clearances(made, roll + sign * 0.01 * k, (jet.r, jet.n), x)
                gaps.append(x[:, 2])
        gap = np.array(gaps)
        assert np.abs(gap.min(axis=0)).max() < 1e-9
        assert (gap[11] > 1e-4).all()
        # far from the flank of the constant ratio
        constant = replace(side, turned=0.0).envelope(side.blade.flank).jet(u, v)
        assert np.abs(((jet.r - constant.r) * constant.n).sum(axis=-1)).max() > 0.01


@pytest.mark.parametrize("motions", [MOTIONS, ROLL_ALONE], ids=["motions", "modified_roll"])
@pytest.mark.sweep_cases("motions")
def test_jets_of_indexed_envelopes_agree_with_differences(motions: dict[str, tuple[float, ...]]) -> None:
    side = pinion_sides("face_hobbed_formate")["convex"]
    made, flank = envelope_of(side, motions)
    u, v = grid_of(made)
    jet = flank.jet(u, v)
    for du, dv, r_x, n_x in ((1e-7, 0.0, jet.r_u, jet.n_u), (0.0, 1e-5, jet.r_v, jet.n_v)):
        more, less = flank.jet(u + du, v + dv), flank.jet(u - du, v - dv)
        for change, partial in ((more.r - less.r, r_x), (more.n - less.n, n_x)):
            assert change / (2.0 * (du + dv)) == pytest.approx(partial, rel=1e-5, abs=1e-5 * np.abs(partial).max())
    assert np.abs((jet.n * jet.r_u).sum(axis=-1)).max() < 1e-9
    placed = flank.tool_to_blank(*flank.generating(u, v))
    assert placed.point(flank.tool.jet(*flank.on_tool(u, v)).r) == pytest.approx(jet.r, abs=1e-11)


def test_no_motion_leaves_the_envelope_of_the_crown_gear() -> None:
    for side in pinion_sides("face_hobbed_formate").values():
        crown = side.envelope(side.blade.flank)
        _, moved = envelope_of(side, {"modified_roll": (1e-300,)})
        u, v = grid_of(side)
        one, other = replace(side, turned=0.0).envelope(side.blade.flank).jet(u, v), moved.jet(u, v)
        assert not isinstance(crown, IndexedEnvelope)
        for key in ("r", "n", "r_u", "r_v", "n_u", "n_v"):
            assert getattr(other, key) == pytest.approx(getattr(one, key), rel=1e-10, abs=1e-10)


@pytest.mark.sweep
@pytest.mark.parametrize("name", NAMES)
@pytest.mark.sweep_cases("concave")
def test_modified_roll_gives_the_parabola_of_a_formed_gear(name: str) -> None:
    """The head stays near the gear's, and nearly straight; the contact is the one that is chosen, exactly."""
    gears = gm.build(gm.parse({**MANY_TEETH, "contact": {"side": f"pinion_{name}"}}))
    made = bevel_teeth(gears.design.in_mm())  # type: ignore[arg-type]
    side, choice, ratio = made.cut.pinion[name], made.choices[name], 25 / 145
    assert choice.by_roll
    assert side.settings.modified_roll[0] == pytest.approx(0.5 * choice.asked.ratio_derivative / ratio, rel=1e-12)
    assert side.settings.ratio_of_roll == pytest.approx(ratio, rel=2e-3)
    assert abs(side.blade.blade_radius) > 100.0 * made.cut.blank.mean_working_depth
    (mesh,) = gears.pairs
    step = 0.01
    path = analyse(mesh, step * np.array([-2.0, -1.0, 0.0, 1.0, 2.0]))
    assert path.semi_major[2] == pytest.approx(choice.asked.semi_major_axis, rel=1e-4)
    error = path.phi2 - mesh.ratio * path.phi1
    bend = (16.0 * (error[1] + error[3]) - error[0] - error[4] - 30.0 * error[2]) / (12.0 * step**2)
    assert bend / mesh.ratio == pytest.approx(choice.asked.ratio_derivative, rel=2e-3)


@pytest.mark.sweep
@pytest.mark.parametrize("name", NAMES)
def test_pair_by_modified_roll_is_good(name: str) -> None:
    answer = gm.build(gm.parse({**MANY_TEETH, "contact": {"side": f"pinion_{name}"}})).contact().summary
    assert not answer["interference_um"]
    assert not answer["te_breaks_phi1_deg"]
    assert answer["mesh_te_peak_to_peak_arcsec"] == pytest.approx(10.0, rel=0.1)
    assert answer["contact_ratio"] > 1.1


def test_chosen_modified_roll_is_written_and_read_again() -> None:
    design = gm.parse(MANY_TEETH)
    gears = gm.build(design)
    given = gears.sheet().apply()
    one, other = (bevel_teeth(each.in_mm()).cut.pinion for each in (design, given))  # type: ignore[arg-type]
    for name in NAMES:
        assert given.plain()["pinion"][name]["modified_roll_c2"] == one[name].settings.modified_roll[0]
        p = np.array([one[name].blade.at_height(height) for height in (1.0, 4.0)])
        points = [sides[name].side(0.0).flank.jet(p, np.array([-0.1, 0.1])).r for sides in (one, other)]
        assert points[1] == pytest.approx(points[0], abs=1e-9)


@pytest.mark.sweep
def test_compensation_restores_the_contact_of_a_misassembled_pair() -> None:
    """Ellipse and derivative of the ratio at the mean point are off by up to 9 %, and come back within 1.5 %."""
    design = gm.load("samples/hypoid_face_hobbed.toml").with_values(ERRORS)
    given = design.with_values({row.key: row.after for row in compensate(design)})
    for name in NAMES:
        spec = design.plain()["pinion"][name]
        off, left = list[float](), list[float]()
        for errors, each in ((off, design), (left, given)):
            (mesh,) = gm.build(each.with_values({"contact.side": f"pinion_{name}"})).pairs
            step = 0.01
            path = analyse(mesh, step * np.array([-1.0, 0.0, 1.0]))
            error = path.phi2 - mesh.ratio * path.phi1
            bend = (error[0] - 2.0 * error[1] + error[2]) / step**2 / mesh.ratio
            errors.append(bend / spec["ratio_derivative"] - 1.0)
            errors.append(path.semi_major[1] / spec["semi_major_axis"] - 1.0)
        assert np.abs(off).max() > 0.04
        assert np.abs(left).max() < 0.015
