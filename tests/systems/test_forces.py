"""Forces by a torque in the sheet: equilibrium of the exact normals at the points of contact, and balance of the whole set."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.command_line import refused, run
from oracles.examples import some

import gearmesh as gm

TORQUE, SPEED = 100.0, 1500.0
PAIRS: dict[str, dict[str, Any]] = {
    "helical_left_flank": {"helix_angle": 15, "backlash": 0.1, "contact": {"flank": "left"}},
    "left_hand_shifted": {"helix_angle": 25, "hand": "left", "pinion": {"profile_shift": 0.4}},
    "internal": {"helix_angle": 20, "gear": {"teeth": -61}},
    "internal_pinion": {"helix_angle": 12, "hand": "left", "pinion": {"teeth": -57}, "gear": {"teeth": 20}},
}


def design_of(kind: str, **more: Any) -> gm.Design:
    """A design of example sizes; keys of members are added to theirs."""
    keys: dict[str, Any] = {"kind": kind}
    for name, table in gm.system(kind).design.example.items():
        keys[name] = dict(table) if isinstance(table, dict) else table
    for name, value in more.items():
        keys[name] = {**keys.get(name, {}), **value} if isinstance(value, dict) else value
    return gm.parse(keys)


def gears_of(kind: str, **more: Any) -> gm.Gears:
    return gm.build(design_of(kind, **more))


def forces_of(design: gm.Design) -> list[dict[str, tuple[Any, ...]]]:
    """Symbol -> values, of the tables that a torque adds to the sheet."""
    forces = gm.system(design.kind).forces
    assert forces is not None
    return [
        {symbol: row[2:] for symbol, row in zip(table.symbols, table.rows, strict=True)}
        for table in forces(design, TORQUE, SPEED)
    ]


def exact(gears: gm.Gears, pair: int, torque: float) -> tuple[Any, Any]:
    """Force (3,) on the pinion of a pair at each of some contact points (P, 3), fixed frame, by the normals of its flanks alone."""
    path = gears.contact(np.array([-2.0, 3.0]), cycle=False, pair=pair).path
    pinion = gears.pairs[pair].mounts[0]
    arm = path.point - pinion.origin
    forces = -path.normal
    moment = np.cross(arm, forces) @ pinion.axis
    return path.point, forces * (1e3 * torque / np.abs(moment))[:, None]


@pytest.mark.parametrize("name", some(PAIRS, 2))
@pytest.mark.sweep_cases("internal_pinion")
def test_forces_are_those_of_the_exact_normals(name: str) -> None:
    """At any point of contact the flanks' normal, with the torque as its moment, has the printed parts along the axes and the
    line between them; on the gear its moment is the printed torque."""
    gears = gears_of("cylindrical", **PAIRS[name])
    (table,) = forces_of(gears.design)
    points, forces = exact(gears, 0, TORQUE)
    first, second = gears.pairs[0].mounts
    between = (second.origin - first.origin) / np.linalg.norm(second.origin - first.origin)
    # towards the pinion's axis from the pitch point, which a ring's axis has beyond the other one
    outside = PAIRS[name].get("pinion", {}).get("teeth", 18) < 0 or PAIRS[name].get("gear", {}).get("teeth", 45) < 0
    pitch = points[0] - first.origin
    inward = -np.sign(pitch @ between) * between
    for point, force in zip(points, forces, strict=True):
        assert abs(force @ np.cross(first.axis, between)) == pytest.approx(table["F_wt"][0], rel=1e-9)
        assert force @ np.array([0.0, 0.0, 1.0]) == pytest.approx(table["F_wa"][0], rel=1e-9, abs=1e-6)
        assert force @ inward == pytest.approx(table["F_wr"][0], rel=1e-9)
        assert np.linalg.norm(force) == pytest.approx(table["F_bn"][0], rel=1e-9)
        moment = np.cross(point - second.origin, -force) @ second.axis
        assert abs(moment) == pytest.approx(1e3 * table["T"][1], rel=1e-9)
    assert table["F_wa"][1] == -table["F_wa"][0]
    assert table["F_wr"][1] == (-1.0 if outside else 1.0) * table["F_wr"][0]
    # what goes in comes out
    assert table["P"] == pytest.approx([TORQUE * SPEED * math.pi / 3e4] * 2, rel=1e-9)
    pinion, gear = gears.design.pinion, gears.design.gear
    d = pinion.teeth * 2.0 / math.cos(math.radians(gears.design.helix_angle))
    assert table["F_t"][0] == pytest.approx(2e3 * TORQUE / d, rel=1e-9)
    distance = np.linalg.norm(second.origin - first.origin)
    working = 2.0 * distance * pinion.teeth / abs(gear.teeth + (-1.0 if outside else 1.0) * pinion.teeth)
    assert table["v_w"] == pytest.approx([working * math.pi * SPEED / 6e4] * 2, rel=1e-9)
    assert table["n"][1] == pytest.approx(SPEED * pinion.teeth / gear.teeth, rel=1e-9)


@pytest.mark.parametrize(("fixed", "ring"), some([("sun", 74), ("ring", 72)], 1))
def test_a_planetary_set_is_in_balance(fixed: str, ring: int) -> None:
    """Add the forces of both meshes of a planet, by the exact normals. The sum is the printed load of its bearing, and the
    moment of all planets is the carrier's torque. A ring of 74 teeth has other working pressure angles in both meshes."""
    gears = gears_of(
        "planetary",
        helix_angle=12,
        fixed=fixed,
        backlash=0.1,
        planets=2,
        sun={"profile_shift": 0.3},
        ring={"teeth": ring},
    )
    whole, inner, outer, pin = forces_of(gears.design)
    assert sum(whole["T"]) == pytest.approx(0.0, abs=1e-6)
    assert whole["T"][0 if fixed == "ring" else 2] == pytest.approx(TORQUE)
    # the fixed member has no power, and none is lost
    assert whole["n"][2 if fixed == "ring" else 0] == 0.0
    assert sum(whole["P"]) == pytest.approx(0.0, abs=1e-6)
    share = 0.5 * whole["T"][0]
    _, on_sun = exact(gears, 0, share)
    sun, planet = gears.pairs[0].mounts
    out = (planet.origin - sun.origin) / np.linalg.norm(planet.origin - sun.origin)
    across = np.cross(sun.axis, out)
    # the planet has no moment about its own axis
    _, on_planet = exact(gears, 2, share * gears.design.planet.teeth / gears.design.sun.teeth)
    for from_sun, from_ring in zip(-on_sun, on_planet, strict=True):
        load = from_sun + from_ring
        assert abs(load @ across) == pytest.approx(pin["F_pt"][0], rel=1e-9)
        assert load @ out == pytest.approx(pin["F_pr"][0], rel=1e-9, abs=1e-6)
        assert load[2] == pytest.approx(pin["F_pa"][0], abs=1e-6)
    assert (pin["F_pr"][0] == 0.0) == (ring == 72)
    assert inner["F_wa"][1] == pytest.approx(-outer["F_wa"][0], rel=1e-9)
    assert outer["F_wr"][1] == -outer["F_wr"][0] < 0.0
    distance = np.linalg.norm(planet.origin - sun.origin)
    assert 2.0 * pin["F_pt"][0] * distance == pytest.approx(1e3 * abs(whole["T"][1]), rel=1e-9)


def test_a_rack_is_pushed_by_its_pinion() -> None:
    gears = gears_of("rack", helix_angle=10, pinion={"profile_shift": 0.2})
    (table,) = forces_of(gears.design)
    _, forces = exact(gears, 0, TORQUE)
    for force in forces:
        assert abs(force[1]) == pytest.approx(table["F_wt"][1], rel=1e-9)
        assert -force[0] == pytest.approx(table["F_wr"][0], rel=1e-9)
        assert force[2] == pytest.approx(table["F_wa"][0], rel=1e-9)
    assert table["F_wt"][1] * table["v_w"][1] == pytest.approx(1e3 * table["P"][0], rel=1e-9)
    assert table["T"][1] is table["P"][1] is None


def test_halves_of_double_helical_gears_hold_each_others_axial_force() -> None:
    keys = {"arrangement": "double_helical", "helix_angle": 25, "gap": 4}
    whole, half = (forces_of(design_of("cylindrical", **more))[0] for more in (keys, {"helix_angle": 25}))
    assert whole["F_wa"] == (0.0, 0.0)
    assert whole["F_waB"] == pytest.approx([0.5 * force for force in half["F_wa"]], rel=1e-9)
    assert whole["F_wt"] == half["F_wt"]


def test_a_speed_needs_a_torque_and_both_are_numbers(tmp_path: Path) -> None:
    file = tmp_path / "pair.toml"
    file.write_text(gm.toml(design_of("cylindrical").resolve()))
    assert "--speed = 1500: needs a torque" in refused("describe", file, "--speed", "1500")
    assert "speed = -1: must be a finite number" in refused("describe", file, "--torque", "1", "--speed", "-1")
    assert "speed" in refused("describe", "cylindrical", "--speed", "1500")
    status, out, _ = run("describe", file, "--torque", "100", "--speed", "1500")
    assert status == 0
    assert "Forces for 100 Nm on the pinion, its right flanks driving" in out
    assert "15.70796" in out
    alone = tmp_path / "gear.toml"
    alone.write_text('kind = "cylindrical"\nmodule = 1\n[gear]\nteeth = 30\nface_width = 10\n')
    assert "--torque = 5: forces need a mating gear" in refused("describe", alone, "--torque", "5")
