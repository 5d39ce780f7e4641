"""Sizing of cylindrical pairs: what is proposed is all that there is, meshes without backlash, and is worth what is said of it."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.command_line import refused, run
from oracles.examples import some

import gearmesh as gm
from gearmesh.systems.cylindrical.geometry.proportions import proportions

#: wishes whose pairs are few enough to be built: spur, helical, internal, some with faults, all undercut
WISHES: dict[str, dict[str, Any]] = {
    "spur": {"ratio": 2.5, "center_distance": 64.0, "module": 2.0, "tolerance": 0.06},
    "helical": {"ratio": 2.5, "center_distance": 64.0, "module": 2.0, "helix": (8.0, 14.0), "face_width": 18.0},
    "internal": {"ratio": 3.0, "center_distance": 41.0, "module": 2.0, "internal": True, "tolerance": 0.04},
    "mixed": {"ratio": 4.5, "center_distance": 64.0, "module": 2.0, "tolerance": 0.2, "shifts": (-1.0, 1.0)},
    "few_teeth": {"ratio": 8.0, "center_distance": 64.0, "module": 2.0, "tolerance": 0.05, "shifts": (-1.0, 1.0)},
}


@pytest.mark.sweep
@pytest.mark.sweep_cases("few_teeth")
@pytest.mark.parametrize("name", some(WISHES, 2))
def test_every_pair_is_as_wanted_and_worth_what_is_said(name: str) -> None:
    wanted = WISHES[name]
    found = gm.size(**wanted)
    assert found.candidates
    for number, row in enumerate([each.row for each in found.rows], start=1):
        design = found.design(number)
        assert row["teeth_gear"] / row["teeth_pinion"] == pytest.approx(
            wanted["ratio"], rel=wanted.get("tolerance", 0.01) + 1e-9
        )
        tables = gm.build(design).sheet().plain_tables
        sheet = {symbol: values for rows in tables.values() for symbol, (_, *values) in rows.items()}
        assert sheet["a"] == [wanted["center_distance"]]
        assert sheet["j_bn"][0] == pytest.approx(0.0, abs=1e-9)
        assert sheet["x"] == pytest.approx([row["profile_shift_pinion"], row["profile_shift_gear"]], abs=1e-9)
        modules = [row["tip_thickness_pinion_modules"], row["tip_thickness_gear_modules"]]
        assert sheet["s_an"] == pytest.approx([2.0 * each for each in modules], abs=1e-9)
        assert sheet["eps_beta"][0] == pytest.approx(row["eps_beta"], abs=1e-9)
        assert min(sheet["undercut"]) == pytest.approx(row["undercut_reserve_mm"], abs=1e-9)
        assert ("undercut" in row["faults"]) == (min(sheet["undercut"]) < 0.0)
        if "undercut" not in row["faults"]:
            assert sheet["eps_alpha"][0] == pytest.approx(row["eps_alpha"], abs=1e-9)
            assert sheet["zeta_A"][0] == pytest.approx(row["specific_sliding_pinion"], rel=1e-6)
            assert sheet["zeta_E"][1] == pytest.approx(row["specific_sliding_gear"], rel=1e-6)
            assert min(sheet["interference"]) == pytest.approx(row["interference_reserve_mm"], abs=1e-9)
    faults = [len(row.faults) for row in found.rows]
    assert faults == sorted(faults)
    assert name != "few_teeth" or any("undercut" in row.faults for row in found.rows)
    # sharing is by equal sliding where tips allow it
    for row in (each.row for each in found.rows):
        if row["tip_thickness_pinion_modules"] > 0.201 and not row["faults"]:
            assert row["specific_sliding_pinion"] == pytest.approx(row["specific_sliding_gear"], rel=2e-3)
    sound = [min(row.specific_sliding_pinion, row.specific_sliding_gear) for row in found.rows if not row.faults]
    assert sound == sorted(sound, reverse=True)


@pytest.mark.parametrize("name", some(WISHES, 2))
@pytest.mark.sweep_cases("few_teeth")
def test_no_pair_is_left_out(name: str) -> None:
    """All tooth numbers and whole degrees by trial: sum of the shifts with which both working circles touch."""
    wanted = WISHES[name]
    low, high = wanted.get("helix", (0.0, 0.0))
    sign = -1 if wanted.get("internal") else 1
    least, most = wanted.get("shifts", (-0.5, 1.2))
    expected = set()
    for first in range(7, 120):
        for second in range(7, 400):
            off = second / first / wanted["ratio"] - 1.0
            if abs(off) > wanted.get("tolerance", 0.01) + 1e-12 or second + sign * first <= 0:
                continue
            for degrees in range(math.ceil(low), math.floor(high) + 1):
                alpha_t = math.atan(math.tan(math.radians(20)) / math.cos(math.radians(degrees)))
                base = (second + sign * first) * math.cos(alpha_t) / math.cos(math.radians(degrees))
                cosine = base / wanted["center_distance"]
                if cosine > 1.0:
                    continue
                inv = math.tan(math.acos(cosine)) - math.acos(cosine) - math.tan(alpha_t) + alpha_t
                total = (first + sign * second) * inv / (2.0 * math.tan(math.radians(20)))
                if least <= total <= most:
                    expected.add((first, second, float(degrees)))
    rows = [each.row for each in gm.size(**wanted).rows]
    found = {(row["teeth_pinion"], row["teeth_gear"], row["helix_angle_deg"]) for row in rows}
    whole = {each for each in found if each[2].is_integer()}
    assert whole <= expected
    # what is left out cannot be made
    for first, second, degrees in expected - whole:
        with pytest.raises(gm.DesignError, match=r"pointed|no involute up to the tip|no cutter of"):
            gm.build(
                gm.parse(
                    {
                        "kind": "cylindrical",
                        "module": wanted["module"],
                        "helix_angle": degrees,
                        "pinion": {"teeth": first, "face_width": 20},
                        "gear": {"teeth": sign * second, "face_width": 20},
                        "assembly": {"center_distance": wanted["center_distance"]},
                    }
                )
            )
    assert len(expected - whole) < 0.5 * len(expected)
    # between whole degrees the one without profile shift
    for row in rows:
        if not row["helix_angle_deg"].is_integer():
            assert row["profile_shift_pinion"] + row["profile_shift_gear"] == pytest.approx(0.0, abs=1e-4)
    assert any(not each[2].is_integer() for each in found) == (name == "helical")


@pytest.mark.sweep
def test_the_command_writes_the_design_that_is_chosen(tmp_path: Path) -> None:
    wish = ["size", "--ratio", "2.5", "--center-distance", "64mm", "--module", "2", "--helix", "8:14"]
    target = tmp_path / "pair.toml"
    status, out, _ = run(*wish, "--most", "3", "--choose", "2", "-o", target)
    assert status == 0
    assert max(map(len, out.splitlines())) <= 80
    assert [line.split()[0] for line in out.splitlines()[-3:]] == ["1", "2", "3"]
    status, text, _ = run(*wish, "--json", "-")
    rows = json.loads(text)["candidates"]
    design = gm.load(target).resolve()
    assert [design[member]["teeth"] for member in ("pinion", "gear")] == [
        rows[1]["teeth_pinion"],
        rows[1]["teeth_gear"],
    ]
    assert design["helix_angle"] == rows[1]["helix_angle_deg"]
    assert design["gear"]["profile_shift"] == rows[1]["profile_shift_gear"]
    assert refused(*wish, "-o", target).endswith("it exists already")


@pytest.mark.quick
@pytest.mark.parametrize(
    ("more", "message"),
    [
        ("--ratio 0.5", "--ratio = 0.5: must be from 1 to 100"),
        ("--module 0", "--module = 0: must be from 0.01 to 100"),
        ("--module x", "--module = x: must be a length as 64mm or 2.5in"),
        ("--helix 20:10", "--helix = 20 to 10: the first must not be above the second"),
        ("--helix 10:nan", "--helix = 10:nan: must be a number, or two as LOW:HIGH"),
        ("--shifts low", "--shifts = low: must be a number, or two as LOW:HIGH"),
        (
            "--ratio 1 --internal",
            "--ratio = 1: the ratio of an internal pair must be above 1 by more than the tolerance, 0.01",
        ),
        ("--choose 5", "--choose = 5: must be a number from 1 to 1"),
        (
            "--module 6 --tolerance 0.1",
            "center_distance = 64 mm: no numbers of teeth have ratio 2.5 within 0.1 % and profile",
        ),
        ("-o pair.json", "cannot write pair.json: its suffix must be .toml"),
    ],
)
def test_wishes_that_cannot_be_are_refused(more: str, message: str) -> None:
    wish = {"--ratio": "2.5", "--center-distance": "64", "--module": "2"}
    words = more.split()
    kept = [word for option, value in wish.items() if option not in words for word in (option, value)]
    assert refused("size", *kept, *words).startswith(message)


def room_of_tip_corners(keys: dict[str, Any]) -> float:
    """Least arc (mm) between the corners of either member's tips and the flanks that they may enter, over a pitch; negative inside.

    In the plane, by involutes alone: the pinion about the origin, the ring's axis at -a, a space of the ring on a tooth at +x.
    """
    geometry = proportions(gm.parse(keys))
    mesh, (tip, ring_tip) = geometry.mesh, geometry.tips
    members = ((mesh.pinion, tip, 0.0, mesh.distance), (mesh.gear, ring_tip, math.pi / mesh.gear.teeth, -mesh.distance))
    turn = np.linspace(0.0, 2.0 * np.pi / mesh.pinion.teeth, 600, endpoint=False)[:, None]
    least = math.inf
    for (own, radius, at, away), (other, far, other_at, _) in (members, members[::-1]):
        turned, other_turned = (turn * mesh.pinion.teeth / member.teeth for member in (own, other))
        corners = np.arange(own.teeth) * 2.0 * np.pi / own.teeth
        for half in (own.half_angle(radius), -own.half_angle(radius)):
            angle = turned + at + corners + half
            x, y = radius * np.cos(angle) + away, radius * np.sin(angle)
            r = np.hypot(x, y)
            within = (r > far) if other.internal else (r < far) & (r > other.base_radius)
            tooth = np.mod(np.arctan2(y, x) - other_turned - other_at + np.pi / other.teeth, 2.0 * np.pi / other.teeth)
            from_middle = np.abs(tooth - np.pi / other.teeth)
            room = [
                (f - other.half_angle(float(at))) * at for f, at in zip(from_middle[within], r[within], strict=True)
            ]
            least = min([least, *room])
    return least


def test_internal_pairs_of_few_teeth_difference_have_stub_tips_that_pass() -> None:
    """38/-40 at a working pressure angle of 40 deg: with full teeth the tips collide, and only that was reported."""
    found = gm.size(ratio=40 / 38, center_distance=2.453363, module=2.0, internal=True, tolerance=0.001)
    (number,) = (k for k, each in enumerate(found.rows, start=1) if each.row["teeth_pinion"] == 38)
    assert found.rows[number - 1].row["eps_alpha"] > 1.2
    assert not found.rows[number - 1].row["faults"]
    keys = dict(found.keys(number))
    assert keys["pinion"]["tip_diameter"] > keys["pinion"]["teeth"] * 2.0
    # the flanks touch, and nothing is deeper
    assert room_of_tip_corners(keys) == pytest.approx(0.0, abs=2e-3)
    full = {
        name: {key: value for key, value in keys[name].items() if key != "tip_diameter"} for name in ("pinion", "gear")
    }
    assert room_of_tip_corners({**keys, **full}) < -0.1


@pytest.mark.quick
def test_shifts_that_add_up_to_nothing_have_the_helix_angle_of_the_distance() -> None:
    """cos beta = m (z1 + z2) / 2a; the angle is proposed with four decimals, so that the sum is not 0 to the last bit."""
    found = gm.size(ratio=3.0, center_distance=125.0, module=3.0, helix=(10.0, 20.0), shifts=(0.0, 0.0))
    rows = [each.row for each in found.rows]
    assert [(row["teeth_pinion"], row["teeth_gear"]) for row in rows] == [(20, 60)]
    assert rows[0]["helix_angle_deg"] == pytest.approx(math.degrees(math.acos(0.96)), abs=5.1e-5)
    assert rows[0]["profile_shift_pinion"] + rows[0]["profile_shift_gear"] == pytest.approx(0.0, abs=1e-4)
