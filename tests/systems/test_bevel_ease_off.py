"""Ease-off asked for of bevel pairs: settings whose exact ease-off map is the polynomial, conjugate pairs, ellipses, refusals."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from oracles.examples import in_turn

import gearmesh as gm
from gearmesh.kinds import Side
from gearmesh.systems.spiral_bevel.synthesis.settings import basic_blank

#: basic data of pairs that have little in common
PAIRS: dict[str, dict[str, Any]] = {
    "basic": {"module": 4, "face_width": 25, "pinion": {"teeth": 13}, "gear": {"teeth": 44}},
    "zerol": {"module": 4, "face_width": 20, "spiral_angle": 0, "pinion": {"teeth": 15}, "gear": {"teeth": 30}},
    "right": {"module": 6, "hand": "right", "spiral_angle": 30, "pinion": {"teeth": 20}, "gear": {"teeth": 41}},
    "inch": {
        "units": "inch",
        "diametral_pitch": 6,
        "shaft_angle": 75,
        "spiral_angle": 25,
        "pinion": {"teeth": 17},
        "gear": {"teeth": 31},
    },
    "mitre": {
        "module": 3,
        "pressure_angle": 22.5,
        "pinion": {"teeth": 24, "concave": {"blade_radius": 400}},
        "gear": {"teeth": 24, "cutter": {"tip_radius": 50}},
    },
    "hypoid": {"module": 4.5, "offset": 25, "pinion": {"teeth": 12}, "gear": {"teeth": 41}},
    "formate": {
        "module": 4,
        "face_width": 25,
        "process": "formate_fixed",
        "pinion": {
            "teeth": 13,
            "concave": {"tilt": 15, "swivel": -153, "machine_root_angle": 0},
            "convex": {"tilt": 15, "swivel": -146, "machine_root_angle": 0},
        },
        "gear": {"teeth": 44},
    },
}
#: missing (um) at the rims, of each pair
TARGETS = {
    "basic": (0, 0, 12, 40, 0),
    "zerol": (5, -5, 10, 40, 15),
    "right": (-4, 6, 15, 20, -10),
    "inch": (6, 0, 5, 30, -8),
    "mitre": (0, 10, 8, 25, 5),
    "hypoid": (4, 0, 20, 40, 10),
    "formate": (0, 0, 0, 30, 0),
}
KEYS = ("pressure_angle", "spiral_angle", "profile_crowning", "length_crowning", "twist")


def asked(pair: dict[str, Any], side: str, um: tuple[float, ...], **more: Any) -> gm.Design:
    table = {key: f"{value}um" for key, value in zip(KEYS, um, strict=True)}
    kind = gm.HypoidDesign if "offset" in pair else gm.SpiralBevelDesign
    return kind(**{**pair, "contact": {"side": f"pinion_{side}", "ease_off": table}, **more})


def parameters_of_map(design: gm.Design, gears: gm.Gears) -> tuple[np.ndarray, np.ndarray]:
    """The five parameters (um) of the exact ease-off map, and what it has beside them, over what is as high as the grid."""
    blank = basic_blank(design.in_mm())
    found = gears.ease_off().map
    rho, z = np.hypot(found.points[..., 0], found.points[..., 1]), found.points[..., 2]
    s, c = np.sin(blank.pinion.pitch_angle), np.cos(blank.pinion.pitch_angle)
    own, z = blank.pinion, z + blank.pinion.pitch_apex
    x = 2.0 * (rho * s + z * c - own.outer_cone_distance) / own.face_width + 1.0
    across = rho * c - z * s
    first, second = (
        each.mean_addendum
        + (each.outer_cone_distance + 0.5 * (x - 1.0) * each.face_width - each.mean_cone_distance)
        * np.tan(each.face_angle - each.pitch_angle)
        for each in blank.members
    )
    y = (2.0 * across - first + second) / (first + second)
    used = np.isfinite(found.distance) & (y > -0.85)
    x, y, um = x[used], y[used], 1e3 * found.distance[used]
    # a pinion that is turned gives way as its normals are from its axis
    normals = np.cross(np.gradient(found.points, axis=0), np.gradient(found.points, axis=1))
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    lever = (normals * np.cross([0.0, 0.0, 1.0], found.points)).sum(axis=-1)[used]
    columns = np.stack((lever, y, x, y * y, x * x, x * y), axis=-1)
    parameters = np.linalg.lstsq(columns, um, rcond=None)[0]
    return parameters[1:], um - columns @ parameters


@pytest.mark.sweep_cases(
    "formate-concave", "inch-convex", "zerol-convex", "right-concave", "basic-concave", "hypoid-convex", "mitre-concave"
)
@pytest.mark.parametrize(("name", "side"), in_turn(PAIRS, ["concave", "convex"]))
def test_the_exact_map_is_what_was_asked_for(name: str, side: str) -> None:
    target = TARGETS[name]
    design = asked(PAIRS[name], side, target)
    gears = gm.build(design)
    found, rest = parameters_of_map(design, gears)
    # of what is asked for in a corner
    assert np.abs(found - target).max() < max(1.0, 0.03 * np.abs(target).sum())
    summary = gears.contact(phi1=[0.0], cycle=False).summary
    assert [summary[f"ease_off_{key}_um"] for key in KEYS] == pytest.approx(target, abs=0.1)
    # the topography that is told is that of the map, on other points
    assert np.sqrt((rest**2).mean()) == pytest.approx(summary["ease_off_residual_rms_um"], rel=0.35, abs=0.1)


@pytest.mark.sweep
@pytest.mark.parametrize("side", ["concave", "convex"])
def test_nothing_asked_for_is_a_pair_that_is_nearly_conjugate(side: str) -> None:
    design = gm.SpiralBevelDesign(
        module=2,
        face_width=8,
        pinion={"teeth": 40},
        gear={"teeth": 61},
        contact={"side": f"pinion_{side}", "ease_off": {}},
    )
    gears = gm.build(design)
    # with the parabola of a default it is some 10
    assert gears.contact().summary["mesh_te_peak_to_peak_arcsec"] < 1.0
    assert np.nanmax(gears.ease_off().map.distance) < 1e-3


@pytest.mark.sweep
def test_length_crowning_sets_the_length_of_the_ellipse() -> None:
    lengths = []
    for crowning in (20.0, 80.0):
        design = asked(PAIRS["right"], "concave", (0, 0, 10, crowning, 0))
        path = gm.build(design).contact(phi1=[0.0], cycle=False).path
        blank = basic_blank(design.in_mm())
        # along the major axis the flanks part by C x^2 + P y^2, delta at its end
        pitch = blank.pinion.pitch_angle
        radial = path.point[0] * [1.0, 1.0, 0.0] / np.hypot(*path.point[0, :2])
        along = path.major[0] @ (np.sin(pitch) * radial + [0.0, 0.0, np.cos(pitch)]) / (0.5 * blank.gear.face_width)
        up = path.major[0] @ (np.cos(pitch) * radial - [0.0, 0.0, np.sin(pitch)]) / (0.5 * blank.mean_working_depth)
        parted = 1e-3 * (crowning * along**2 + 10.0 * up**2)
        lengths.append(path.semi_major[0] / np.sqrt(design.contact.delta / parted))
    assert lengths == pytest.approx([1.0, 1.0], rel=0.08)


def test_given_settings_have_the_same_flanks(tmp_path: Any) -> None:
    design = asked(PAIRS["basic"], "convex", TARGETS["basic"])
    gears = gm.build(design)
    given = gm.load(gears.sheet().save(tmp_path / "given.toml"))
    assert not given.sets("contact.ease_off.length_crowning")
    assert given.sets("pinion.convex.modified_roll_c3")
    again = gm.build(given)
    for side in Side:
        s = np.linspace(0.0, 1.0, 4)
        first, second = (each.train.members["pinion"].tooth.flank_grid(side, s, s).points for each in (gears, again))
        np.testing.assert_allclose(first, second, rtol=0, atol=1e-7)


@pytest.mark.sweep
def test_too_much_is_told_with_its_figure() -> None:
    gears = gm.build(asked(PAIRS["basic"], "convex", (0, 0, 0, 0, 0)))
    told = [line for line in gears.warnings if "residual topography of pinion.convex" in line]
    residual = gears.contact(phi1=[0.0], cycle=False).summary["ease_off_residual_max_um"]
    assert residual > 1.0
    assert f"up to {residual:.3g} um, the requested ease-off up to 0 um" in told[0]


@pytest.mark.sweep
def test_settings_that_are_given_far_away_are_refused_in_one_line() -> None:
    pinion = {"teeth": 13, "concave": {"radial": 71, "ratio_of_roll": 0.3, "tip_radius": 78}}
    with pytest.raises(gm.GearmeshError) as refused:
        gm.build(asked({**PAIRS["basic"], "pinion": pinion}, "concave", TARGETS["basic"]))
    assert "around that point" in str(refused.value)
    assert "\n" not in str(refused.value)


ALL = (
    "radial",
    "cradle_angle",
    "ratio_of_roll",
    "machining_offset",
    "machine_centre_to_back",
    "blade_angle",
    "tip_radius",
)


@pytest.mark.parametrize(
    ("more", "line"),
    [
        (
            {"concave": {"path_angle": 80}},
            "pinion.concave.path_angle = 80 deg: cannot be given together with contact.ease_off",
        ),
        ({"convex": {"semi_major_axis": 5}}, "pinion.convex.semi_major_axis = 5 mm: cannot be given together with"),
        ({"concave": {"te_at_change": 5}}, "pinion.concave.te_at_change = 5.0: cannot be given together with"),
        (
            {"concave": {"ease_off": {}, "ratio_derivative": 0.01}},
            "pinion.concave.ratio_derivative = 0.01: cannot be given together with pinion.concave.ease_off",
        ),
        (
            {"convex": dict.fromkeys(ALL, 10)},
            "contact.ease_off: pinion.convex already gives all settings",
        ),
    ],
)
def test_what_contradicts_is_refused(more: dict[str, Any], line: str) -> None:
    pinion = {"teeth": 13, **more}
    with pytest.raises(gm.DesignError) as refused:
        asked({**PAIRS["basic"], "pinion": pinion}, "concave", TARGETS["basic"])
    assert str(refused.value).startswith(line)
    assert "\n" not in str(refused.value)


def test_compensation_wants_the_settings_given() -> None:
    gears = gm.build(asked(PAIRS["basic"], "concave", TARGETS["basic"]))
    with pytest.raises(gm.DesignError, match=r"^contact\.ease_off: compensation .* gearmesh settings"):
        gears.compensate()
