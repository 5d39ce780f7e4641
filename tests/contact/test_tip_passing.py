"""Tips that pass each other beside the mesh, against the closed form of involutes with sharp tips on parallel axes."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import GearmeshError, GearPair
from gearmesh.app.cli import main
from gearmesh.contact.engagement.cycle import gears_curve
from gearmesh.contact.engagement.tip_passing import tip_meetings
from gearmesh.contact.fit.fit import Fit, fit
from gearmesh.contact.flanks import solver_pair
from gearmesh.kinds import Side

#: 38/-40 at a working pressure angle of 40 deg, whose tips are free from a tip diameter of the ring of 79.4645 mm on
LIMIT = {
    "pinion": {"teeth": 38, "face_width": 15, "profile_shift": 0.5, "tip_diameter": 80.8},
    "gear": {"teeth": -40, "face_width": 15, "profile_shift": -0.8463567474586691},
    "assembly": {"center_distance": 2.453363193811355},
}


def gears_of(**keys: Any) -> gm.Gears:
    return gm.build(gm.parse({"kind": "cylindrical", "module": 2, **keys}))


def plain_pair(pinion: int, ring: int, **keys: Any) -> gm.Gears:
    return gears_of(pinion={"teeth": pinion, "face_width": 15}, gear={"teeth": -ring, "face_width": 15}, **keys)


def limit_pair(tip_diameter: float) -> gm.Gears:
    return gears_of(**{**LIMIT, "gear": {**LIMIT["gear"], "tip_diameter": tip_diameter}})


def reserve(pair: GearPair, module: float, angle: float) -> float:
    """Turn of the ring (rad) left between the tips where their circles meet; in angles of the pinion's and the ring's teeth."""

    def inv(alpha: float) -> float:
        return math.tan(alpha) - alpha

    (z1, z2), (tip, ring_tip) = (
        tuple(values)
        for values in zip(
            *((member.tooth.teeth, float(member.tooth.blank.tip.at(0.0))) for member in pair.both), strict=True
        )
    )
    first, second = pair.mounts
    apart = float(np.linalg.norm(second.origin - first.origin))
    base, ring_base = (0.5 * z * module * math.cos(angle) for z in (z1, z2))
    if tip + apart < ring_tip:
        return math.inf
    if tip - apart > ring_tip:
        return -math.inf
    of_pinion = math.acos((ring_tip**2 - tip**2 - apart**2) / (2.0 * apart * tip))
    of_ring = math.acos((ring_tip**2 + apart**2 - tip**2) / (2.0 * apart * ring_tip))
    of_pinion += inv(math.acos(base / tip))
    of_ring += inv(math.acos(min(1.0, ring_base / ring_tip)))
    return (z1 * of_pinion - z2 * of_ring + (z2 - z1) * inv(math.acos((ring_base - base) / apart))) / z2


def fit_of(gears: gm.Gears) -> Fit:
    found = fit(gears.pairs[0])
    assert found is not None
    return found


def check_against_closed_form(gears: gm.Gears, angle: float, module: float = 2.0) -> None:
    """Tips are past each other by what the closed form says, and the gear set warns of it."""
    pair = gears.pairs[0]
    closed, flanks = reserve(pair, module, angle), solver_pair(pair)
    curve = gears_curve(flanks, pair.pitch)
    assert curve is not None
    # conjugate flanks: the gear is at one advance wherever they touch
    of_flanks = curve.engagement.flanks
    conjugate = of_flanks.advance[of_flanks.touching & (of_flanks.edges[:, 0] < 0)].max()
    met = tip_meetings(flanks, float(conjugate))
    excess = met.excess[met.tips]
    assert (excess > 0.0).any() == (closed < 0.0)
    if math.isfinite(closed):
        # the closed form is that of tips that leave each other, not of those that come together
        assert np.abs(excess + closed).min() < 1e-9
    assert any("trochoid" in line for line in gears.warnings) == (closed < 0.0)
    # the mesh is followed where it is, however far from the pitch point
    ratio = (curve.surface.end - curve.surface.begin) / pair.pitch
    assert ratio == pytest.approx(transverse_ratio(pair, module, angle), abs=1e-6)


def transverse_ratio(pair: GearPair, module: float, angle: float) -> float:
    """Transverse contact ratio of an internal pair: the path of contact that both involutes have, from form point to tip."""
    bases, ends = [], []
    for member, flank in zip(pair.both, solver_pair(pair).flanks, strict=True):
        bases.append(0.5 * member.tooth.teeth * module * math.cos(angle))
        rows = flank.surface.jet(flank.grid[[0, -1], 0, 0], flank.grid[[0, -1], 0, 1]).r
        # places on the line of action, from where it touches the member's base circle
        ends.append(np.sqrt(np.maximum(np.sum(rows[:, :2] ** 2, axis=1) - bases[-1] ** 2, 0.0)))
    first, second = pair.mounts
    apart = float(np.linalg.norm(second.origin - first.origin))
    (form, tip), (ring_form, ring_tip) = ends[0], ends[1] - math.sqrt(apart**2 - (bases[1] - bases[0]) ** 2)
    return float(min(tip, ring_form) - max(form, ring_tip)) / (math.pi * module * math.cos(angle))


def random_pairs(count: int, seed: int) -> Iterator[tuple[gm.Gears, float]]:
    """Internal pairs that can be built, with 1 to 12 teeth difference, and their pressure angles (rad)."""
    rng, made = np.random.default_rng(seed), 0
    while made < count:
        pinion, angle = int(rng.integers(14, 60)), float(rng.choice([20.0, 25.0, 30.0]))
        ring = -(pinion + int(rng.integers(1, 13)))
        tables = {
            name: {
                "teeth": teeth,
                "face_width": 10,
                "profile_shift": round(float(rng.uniform(*shifts)), 3),
                "addendum": round(float(rng.uniform(0.3, 1.0)), 3),
            }
            for name, teeth, shifts in (("pinion", pinion, (-0.2, 0.6)), ("gear", ring, (-0.6, 0.6)))
        }
        try:
            gears = gears_of(pressure_angle=angle, backlash=0.1, **tables)
        except GearmeshError:
            continue
        made += 1
        yield gears, math.radians(angle)


@pytest.mark.parametrize(
    ("pressure_angle", "pinion", "ring"),
    [
        # teeth, profile shift and addendum of both: edges are nearly ahead one and two pitches before the mesh
        (25.0, (46, 0.517, 0.638), (58, -0.198, 0.846)),
        # contact ratio 0.6305: edges carry in every pitch
        (30.0, (50, 0.027, 0.616), (60, 0.361, 0.431)),
        # the tips collide apart from the mesh
        (25.0, (51, 0.155, 0.939), (57, 0.023, 0.518)),
    ],
)
@pytest.mark.sweep_cases("25.0-pinion2-ring2", "30.0-pinion1-ring1")
def test_mesh_far_from_the_pitch_point_is_followed(
    pressure_angle: float, pinion: tuple[int, float, float], ring: tuple[int, float, float]
) -> None:
    tables = {
        name: {"teeth": sign * teeth, "face_width": 10, "profile_shift": shift, "addendum": addendum}
        for name, sign, (teeth, shift, addendum) in (("pinion", 1, pinion), ("gear", -1, ring))
    }
    check_against_closed_form(
        gears_of(pressure_angle=pressure_angle, backlash=0.1, **tables), math.radians(pressure_angle)
    )


@pytest.mark.sweep
def test_tips_collide_at_the_limit_of_the_closed_form() -> None:
    found = fit_of(limit_pair(79.44))
    assert 1e3 * found.normal_backlash[0] == pytest.approx(-8.67, abs=0.005)
    assert found.jammed
    check_against_closed_form(limit_pair(79.465), math.radians(20.0))


@pytest.mark.sweep
def test_tips_collide_near_the_limit_however_shortly() -> None:
    for tip_diameter in (79.40, 79.42, 79.464, 79.4646):
        gears = limit_pair(tip_diameter)
        # the normal of contact is tangent to the ring's base circle
        closed = 40.0 * math.cos(math.radians(20.0)) * reserve(gears.pairs[0], 2.0, math.radians(20.0))
        assert fit_of(gears).normal_backlash[0] == pytest.approx(min(closed, 0.0), abs=1e-8)
    for difference in range(2, 9):
        gears = plain_pair(38, 38 + difference)
        check_against_closed_form(gears, math.radians(20.0))
        assert fit_of(gears).jammed == (difference < 8)


@pytest.mark.sweep
def test_jams_beyond_half_a_pitch_are_no_backlash(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    design, figures = tmp_path / "deep.toml", tmp_path / "tca.json"
    design.write_text(
        'kind = "cylindrical"\nmodule = 2\npinion = { teeth = 38, face_width = 15 }\n'
        "gear = { teeth = -40, face_width = 15 }\n"
    )
    assert main(["tca", str(design), "--json", str(figures)]) == 3
    told = json.loads(figures.read_text())
    assert told["fit"]["jammed"]
    assert not told["fit"]["fits"]
    assert {row["status"] for row in told["positions"]} == {"jammed"}
    # one side alone is 3.406 deg of the ring ahead, by 37.6 mm
    assert told["summary"]["backlash_normal_min_mm"] < -2.2
    assert told["summary"]["tip_clearance_pinion_mm"] == pytest.approx(0.5, abs=1e-6)
    assert [tips["flanks"] for tips in told["fit"]["tip_collisions"]] == ["driving", "coast"]
    err = capsys.readouterr().err
    assert "free with gear.tip_diameter of at least 81.68" in err
    assert "the pair is jammed" in err


@pytest.mark.sweep
def test_tips_that_overlap_all_round_fail_the_check(tmp_path: Path) -> None:
    gears = gears_of(
        pressure_angle=25,
        pinion={"teeth": 34, "face_width": 15, "addendum": 0.55},
        gear={"teeth": -35, "face_width": 15},
    )
    assert any("overlap all round" in line for line in gears.warnings)
    check = gears.check_solved({0: gears.contact(np.zeros(1))}, {})
    failed = {verdict.what for verdict in check.verdicts if not verdict.ok}
    assert {"fit: least backlash_normal_mm", "fit: tip_collision_um", "sheet: trochoid_deg"} <= failed


@pytest.mark.sweep
def test_internal_pairs_collide_where_the_closed_form_has_them_do() -> None:
    for teeth in (50, 54):
        check_against_closed_form(plain_pair(teeth, 60, backlash=0.02), math.radians(20.0))


@pytest.mark.sweep
def test_random_internal_pairs_collide_where_the_closed_form_has_them_do() -> None:
    for gears, angle in random_pairs(60, seed=7):
        check_against_closed_form(gears, angle)


def polyline_distance(points: np.ndarray, curve: np.ndarray) -> np.ndarray:
    """Distances (M,) of points (M, 3) from a polyline (N, 3)."""
    along = np.diff(curve, axis=0)
    beyond = points[:, None] - curve[:-1]
    share = np.clip((beyond * along).sum(-1) / (along**2).sum(-1), 0.0, 1.0)
    apart: np.ndarray = np.linalg.norm(beyond - share[..., None] * along, axis=-1).min(axis=1)
    return apart


@pytest.mark.sweep_cases("face_gear_offset", "beveloid_crossed", "hypoid", "helical", "rack")
@pytest.mark.parametrize("name", ["rack", "face_gear_offset", "beveloid_crossed", "hypoid", "worm_drive", "helical"])
def test_tips_meet_where_they_are_said_to(name: str) -> None:
    """The meetings of every kind are on the tips of both exact teeth, whatever their axes."""
    pair = gm.build(gm.load(SAMPLES / f"{name}.toml")).pairs[0]
    flanks = solver_pair(pair)
    curve = gears_curve(flanks, pair.pitch)
    assert curve is not None
    reference = float(np.nanmax(curve.at_nodes()))
    met = tip_meetings(flanks, reference)
    met = met.rows(np.flatnonzero(met.tips))
    assert met.phi1.size
    phi2 = pair.ratio * met.phi1 + pair.drive * (reference + met.excess)
    for member, side, turn in zip(pair.both, pair.flanks, (met.phi1, phi2), strict=True):
        edge = member.tooth.flank_grid(side, [1.0 if side is Side.RIGHT else 0.0], np.linspace(0.0, 1.0, 4001)).points[
            0
        ]
        own = member.mount.at(turn).inverse.point(met.point)
        assert polyline_distance(own, edge).max() < 1e-5 * np.abs(edge).max()
    # beside the mesh flanks part before tips meet
    assert (met.excess < 0.0).all()
