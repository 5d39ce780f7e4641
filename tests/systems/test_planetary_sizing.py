"""Sizing of planetary sets: all that there is, by trial of all tooth numbers; what is proposed builds and is as wanted."""

from __future__ import annotations

import json
import math
from itertools import product
from pathlib import Path

import pytest
from oracles.command_line import refused, run

import gearmesh as gm
from gearmesh import PlanetarySizing

Numbers = tuple[int, int, int]


@pytest.fixture(scope="module")
def sizing() -> PlanetarySizing:
    """The newcomer's set: ratio 5.2 in 150 mm, of one module."""
    return gm.size_planetary(5.2, outside_diameter="150mm", module=2)


def shift_sum(first: int, second: int, distance: float, module: float) -> float:
    """x1 + x2 at a centre distance of spur gears of 20 deg; `second` is negative of a ring."""
    alpha, total = math.radians(20.0), first + second
    cosine = 0.5 * abs(total) * module * math.cos(alpha) / distance
    if cosine > 1.0:
        return math.nan
    working = math.acos(cosine)
    return total * (math.tan(working) - working - math.tan(alpha) + alpha) / (2.0 * math.tan(alpha))


def by_trial(module: float) -> set[tuple[Numbers, float]]:
    """Sets of three planets with ratio 5.2 within 1 %, and distances, whose shifts add up within the ranges."""
    expected = set()
    for sun, ring in product(range(7, 60), range(21, 200)):
        if abs((1.0 + ring / sun) / 5.2 - 1.0) > 0.01 + 1e-12 or (sun + ring) % 3:
            continue
        for planet in range(7, 100):
            if not -2 <= ring - sun - 2 * planet <= 4:
                continue
            first, second = 0.5 * module * (sun + planet), 0.5 * module * (ring - planet)
            for distance in {first, second, 0.5 * (first + second)}:
                inner, outer = (shift_sum(*teeth, distance, module) for teeth in ((sun, planet), (planet, -ring)))
                if -0.5 <= inner <= 1.2 and abs(outer) <= 1.2:
                    expected.add(((sun, planet, ring), round(distance, 4)))
    return expected


@pytest.mark.sweep
def test_no_set_is_left_out(sizing: PlanetarySizing) -> None:
    rows = sizing.rows
    listed = {((row.teeth_sun, row.teeth_planet, row.teeth_ring), row.center_distance) for row in rows}
    rejected = {
        ((row.teeth_sun, row.teeth_planet, row.teeth_ring), row.center_distance): row.reason
        for row in sizing.rejections
    }
    expected = by_trial(2.0)
    assert len(listed) == len(rows) >= 4
    assert listed <= expected
    reasons = {"teeth that cannot be made", "rim thicker than 8 modules", "rim thinner than 3 modules"}
    for teeth, distance in expected - listed:
        if (teeth, distance) in rejected:
            assert rejected[teeth, distance] in reasons
        else:
            # the root of a ring whose shift is anything from -2 to 2 modules leaves no such rim in 150 mm
            rim = 0.5 * (150.0 / 2.0 - teeth[2]) - 1.25
            assert rim + 2.0 < 3.0 or rim - 2.0 > 8.0
    # nothing else is called impossible
    assert {key for key, reason in rejected.items() if reason in reasons} <= expected
    assert sum(sizing.search.reasons.values()) == len(sizing.rejections)
    assert not any(row.faults for row in rows[: rows.index(next((r for r in rows if r.faults), rows[-1]))])


def test_the_best_set_is_as_wanted_when_built(sizing: PlanetarySizing) -> None:
    best = sizing.rows[0]
    tables = gm.build(sizing.design()).sheet().plain_tables
    assert tables["Set"]["i_ring"][1] == best.ratio == 5.2
    assert tables["Set"]["c_p"][1] == pytest.approx(best.planet_clearance, abs=1e-9)
    inner, outer = (
        {
            symbol: values
            for title, rows in tables.items()
            if title.startswith(names)
            for symbol, (_, *values) in rows.items()
        }
        for names in ("Sun and planet", "Planet and ring")
    )
    assert inner["a"] == outer["a"] == [best.center_distance]
    rim = sizing.design().resolve()["ring"]["rim"]
    assert outer["d_f"][1] + 2.0 * rim == pytest.approx(150.0, abs=2e-6)
    assert [*inner["x"], outer["x"][1]] == pytest.approx(
        [best.profile_shift_sun, best.profile_shift_planet, best.profile_shift_ring], abs=1e-9
    )
    assert [inner["eps_alpha"][0], outer["eps_alpha"][0]] == pytest.approx(
        [best.eps_alpha_sun, best.eps_alpha_ring], abs=1e-9
    )
    sliding = [*inner["zeta_A"], *inner["zeta_E"], *outer["zeta_A"], *outer["zeta_E"]]
    assert min(sliding) == pytest.approx(best.specific_sliding, rel=1e-6)
    assert min(*inner["c"], *outer["c"]) == pytest.approx(2.0 * best.tip_clearance, abs=1e-9)
    assert min(*inner["undercut"], *outer["undercut"]) > 0.0


def test_unequal_planets_stand_where_they_can_be_assembled() -> None:
    with pytest.raises(gm.DesignError, match=r"10 planets cannot be equally spaced.*; admit unequal spacing"):
        gm.size_planetary(5.2, center_distance=40.0, module=2.0, planets=4, helix=(12.0, 12.0))
    sizing = gm.size_planetary(5.2, center_distance=40.0, module=2.0, planets=4, helix=(12.0, 12.0), unequal=True)
    for row in sizing.rows:
        step = 360.0 / (row.teeth_sun + row.teeth_ring)
        assert [angle / step for angle in row.planet_angles] == pytest.approx(
            [round(angle / step) for angle in row.planet_angles], abs=1e-9
        )
        assert max(abs(angle - 90.0 * k) for k, angle in enumerate(row.planet_angles)) <= 0.5 * step + 1e-9
    angles = sizing.keys()["assembly"]["planet_angles"]
    assert [float(angle) for angle in angles.split(",")] == sizing.rows[0].planet_angles


def test_the_command_lists_the_search_and_writes_a_design(tmp_path: Path) -> None:
    wish = ["size", "--planetary", "--ratio", "5.2", "--outside-diameter", "150mm", "--module", "2", "--tolerance", "0"]
    target = tmp_path / "set.toml"
    status, out, _ = run(*wish, "--choose", "2", "-o", target, "--json", tmp_path / "search.json")
    assert status == 0
    assert max(map(len, out.splitlines())) <= 80
    document = json.loads((tmp_path / "search.json").read_text(encoding="utf-8"))
    assert f"Rejected: {len(document['rejections'])}" in out
    assert sum(document["rejections_by_reason"].values()) == len(document["rejections"])
    design = gm.load(target).resolve()
    second = document["candidates"][1]
    assert [design[name]["teeth"] for name in ("sun", "planet", "ring")] == [
        second[f"teeth_{name}"] for name in ("sun", "planet", "ring")
    ]
    assert design["assembly"]["center_distance"] == second["center_distance_mm"]


@pytest.mark.quick
@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("--planetary --ratio 4", "--outside-diameter: missing; give the ring's outside diameter or the centre distance"),
        ("--planetary --ratio 1.5 --center-distance 50", "--ratio = 1.5: must be above 2 with the ring fixed"),
        ("--planetary --ratio 5 --center-distance 50 --fixed x", "--fixed = x: must be ring, carrier or sun"),
        ("--planetary --ratio 5 --center-distance 50 --internal", "--internal: cannot be given together with --planetary"),
        ("--ratio 5 --center-distance 50 --module 2 --planets 3", "--planets: needs --planetary"),
        ("--ratio 5 --center-distance 50", "--module: missing; give a length"),
        (
            "--planetary --ratio 5.2 --outside-diameter 40 --module 4",
            "ratio = 5.2: no numbers of teeth of module 4 mm have this ratio",
        ),
        (
            "--planetary --ratio 5.2 --center-distance 40 --module 2 --tolerance 0 --planets 9",
            "ratio = 5.2: none of 4 sets can be used: 4 planets cannot be equally spaced",
        ),
    ],
)  # fmt: skip
def test_wishes_that_cannot_be_are_refused(words: str, message: str) -> None:
    assert refused("size", *words.split()).startswith(message)


@pytest.mark.sweep
@pytest.mark.parametrize("number", [1, 3])
def test_a_set_is_checked(sizing: PlanetarySizing, number: int) -> None:
    verdicts = gm.build(sizing.design(number)).check().verdicts
    assert verdicts
    assert all(verdict.ok for verdict in verdicts)


@pytest.mark.quick
def test_helical_sun_and_planet_without_shifts_are_found() -> None:
    """At a = m (zs + zp) / (2 cos beta), which is proposed with four decimals, so that the sum is not 0 to the last bit."""
    found = gm.size_planetary(
        5.0, outside_diameter=200.0, module=2.0, helix=(15.0, 15.0), shifts=(0.0, 0.0), tolerance=0.001
    )
    assert found.rows
    for row in (each.row for each in found.rows):
        distance = (row["teeth_sun"] + row["teeth_planet"]) / math.cos(math.radians(15.0))
        assert row["center_distance_mm"] == pytest.approx(distance, abs=5.1e-5)
        assert row["profile_shift_sun"] + row["profile_shift_planet"] == pytest.approx(0.0, abs=1e-4)
