"""Planetary sets: what lets the planets in, how sun, planets and ring stand, and both meshes of them."""

from __future__ import annotations

import itertools
import json
from pathlib import Path
from typing import Any

import manifold3d
import numpy as np
import pytest
from oracles import measuring
from oracles.command_line import refused, run
from oracles.examples import some
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import DesignError, Rigid
from gearmesh.app.cli import main
from gearmesh.mesh.triangles import TriangleMesh


def planetary(sun: int, planet: int, ring: int, /, **keys: Any) -> gm.Gears:
    members = {"sun": sun, "planet": planet, "ring": ring}
    tables = {name: {"teeth": teeth, "face_width": 12, **keys.pop(name, {})} for name, teeth in members.items()}
    return gm.build(gm.parse({"kind": "planetary", "module": 2, **tables, **keys}))


#: even, uneven and helical sets, one of them on a centre distance that is not the nominal one
SETS: dict[str, Any] = {
    "even": ((18, 27, -72), {"backlash": 0.06}),
    "uneven": (
        (19, 26, 71),
        {"assembly": {"planet_angles": "0 116 240"}, "planets": 3, "circumferential_backlash": 0.05},
    ),
    "helical": ((20, 31, 82), {"helix_angle": 20, "hand": "left", "backlash": 0.08, "planets": 2}),
    "shifted": ((18, 26, 72), {"assembly": {"center_distance": 45.2}, "backlash": 0.05, "planets": 3}),
}


def _body(mesh: TriangleMesh) -> manifold3d.Manifold:
    made = manifold3d.Mesh64 if hasattr(manifold3d, "Mesh64") else manifold3d.Mesh
    kind = np.float64 if hasattr(manifold3d, "Mesh64") else np.float32
    index = np.uint64 if hasattr(manifold3d, "Mesh64") else np.uint32
    return manifold3d.Manifold(made(mesh.vertices.astype(kind), mesh.triangles.astype(index)))


@pytest.mark.sweep_cases("even")
@pytest.mark.parametrize("name", some(SETS, 2))
def test_members_that_stand_in_mesh_touch_and_do_not_overlap(name: str) -> None:
    """Solids of all members, placed: no two of them share more than their facets' error where they touch."""
    teeth, keys = SETS[name]
    gears = planetary(*teeth, **keys)
    tolerance = 0.004
    parts = gears.solids(tolerance).parts
    bodies = {part: _body(solid.mesh) for part, solid in parts.items()}
    for one, two in itertools.combinations(bodies, 2):
        common = (bodies[one] ^ bodies[two]).volume()
        # a strip of the facets' error along a line of contact of the whole face, two tooth pairs at most in the way
        assert common < 2.0 * tolerance * 12.0 * 1.5, (one, two)
    # turned a little on, against its mating gears, a planet is in the way of both: it was in touch
    axis = gears.members["planet_2"].mount.base
    turned = parts["planet_2"].mesh.move(axis.inverse).move(Rigid.about_z(0.02)).move(axis)
    assert (_body(turned) ^ bodies["ring"]).volume() > 1.0


@pytest.mark.sweep
@pytest.mark.sweep_cases("even")
@pytest.mark.parametrize("name", some(SETS, 2))
def test_every_mesh_has_the_backlash_that_is_asked_for(name: str) -> None:
    teeth, keys = SETS[name]
    gears = planetary(*teeth, **keys)
    assert len(gears.pairs) == 2 * len([each for each in gears.members if each.startswith("planet")])
    for k in gears.train.different:
        summary = gears.contact(pair=k).summary
        wanted, key = (
            (keys["backlash"], "backlash_normal_min_mm")
            if "backlash" in keys
            else (keys["circumferential_backlash"], None)
        )
        if key is None:
            # on the working pitch circle, which goes through the pitch point
            key = "backlash_transverse_min_mm"
        assert summary[key] == pytest.approx(wanted, abs=1e-9)
        assert summary["mesh_te_peak_to_peak_arcsec"] < 1e-6
        assert summary["interference_um"] == 0.0


@pytest.mark.sweep
def test_all_planets_mesh_alike() -> None:
    gears = planetary(19, 26, 71, backlash=0.05, planets=3, assembly={"planet_angles": "0 116 240"})
    for first, last in ((0, 3), (3, 6)):
        ratios = [gears.contact(pair=k).summary["contact_ratio"] for k in range(first, last)]
        assert np.ptp(ratios) < 1e-9


@pytest.mark.sweep
def test_rounded_planet_angles_are_moved_to_assembly_positions() -> None:
    """30 and 60 steps of 360/91 deg to four decimals were refused for 15 nm on the planets' circle; 0.01 deg stay refused."""
    teeth, step = (18, 27, 73), 360.0 / 91.0
    angles = f"0, {30.0 * step:.4f}, {60.0 * step:.4f}"
    gears = planetary(*teeth, backlash=0.05, assembly={"planet_angles": angles})
    assert gears.design.angles == pytest.approx([0.0, 30.0 * step, 60.0 * step], abs=1e-12)
    (line,) = (line for line in gears.warnings if "planet_angles" in line)
    assert line.startswith("assembly.planet_angles: 118.6813, 237.3626 deg: taken as 118.6813187, 237.3626374 deg")
    exact = planetary(*teeth, backlash=0.05, assembly={"planet_angles": f"0, {30.0 * step!r}, {60.0 * step!r}"})
    assert not [line for line in exact.warnings if "planet_angles" in line]
    with pytest.raises(DesignError, match=r"planet_angles = 118.69: the planet cannot be assembled"):
        planetary(*teeth, backlash=0.05, assembly={"planet_angles": "0 118.69 237.3626"})


@pytest.mark.parametrize(
    ("teeth", "keys", "named"),
    [
        (
            (18, 27, 72),
            {"planets": 4},
            "planets = 4: 18 + 72 teeth cannot be shared evenly; allowed is 2, 3, 5, 6, 9, 10",
        ),
        ((18, 27, 72), {"planets": 3, "assembly": {"planet_angles": "0 120 241"}}, "planet_angles = 241"),
        ((18, 27, 72), {"planets": 4, "assembly": {"planet_angles": "0 120 240"}}, "planets = 4: must be 3"),
        ((18, 27, 72), {"assembly": {"planet_angles": "0 120 x"}}, "assembly.planet_angles"),
        (
            (18, 45, 108),
            {"planets": 6},
            "planets = 6: allowed is at most 3, with the other keys unchanged: tips of neighbouring planets",
        ),
        ((18, 27, 20), {}, "ring.teeth = 20"),
        ((18, 27, 40), {}, "ring"),
        (
            (18, 27, 72),
            {"ring": {"teeth": 72, "face_width": 12, "shaper": {"teeth": 500}}},
            "ring.shaper.teeth = 500: must be fewer than the internal gear's, 72",
        ),
    ],
)
@pytest.mark.sweep_cases("teeth6-keys6-ring")
def test_what_cannot_be_assembled_is_refused(teeth: tuple[int, int, int], keys: dict[str, Any], named: str) -> None:
    with pytest.raises(DesignError) as failure:
        planetary(*teeth, **keys)
    assert named in str(failure.value)
    assert "\n" not in str(failure.value)
    assert "pinion" not in str(failure.value)


@pytest.mark.sweep
def test_run_does_all_of_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # its pictures are the same code as of a pair, and cost more than all the rest
    monkeypatch.setattr("gearmesh.view.opengl.missing_opengl_message", lambda: "none today")
    assert main(["run", str(SAMPLES / "planetary.toml"), "-o", str(tmp_path), "--tol", "20um", "--no-report"]) == 0
    report = json.loads((tmp_path / "report.json").read_text(encoding="utf-8"))
    assert set(report["mesh"]) == {"sun", "planet_1", "planet_2", "planet_3", "ring"}
    assert all(each["ok"] for each in report["verdicts"])
    for name in report["files"]:
        assert (tmp_path / name).exists()
    assert {"sun_planet_1_contact.json", "planet_1_ring_contact.json", "ring.stl"} <= set(report["files"])
    assert list(report["meshes"]) == ["sun-planet_1", "planet_1-ring"]
    assert report["meshes"]["sun-planet_1"] == report["contact"]
    for mesh, title in (("sun-planet_1", "Sun and planet: Pair"), ("planet_1-ring", "Planet and ring: Pair")):
        ratio = report["sheet"][title]["eps_gamma"][1]
        assert report["meshes"][mesh]["contact_ratio"] == pytest.approx(ratio, abs=1e-8)


@pytest.mark.sweep
def test_commands_look_at_the_mesh_that_is_named(tmp_path: Path) -> None:
    design = SAMPLES / "planetary.toml"
    status, _, told = run("tca", design, "--json", tmp_path / "first.json")
    assert status == 0
    others = "planet_2, sun-planet_3, planet_1-ring, planet_2-ring, planet_3-ring\n"
    assert told.endswith(f"the contact is that of sun-planet_1; --pair has the others: sun-{others}")
    for names in ("planet_1-ring", "ring-planet_1"):
        assert run("tca", design, "--pair", names, "--json", tmp_path / "ring.json")[0] == 0
        positions = json.loads((tmp_path / "ring.json").read_text())["positions"]
        assert {"planet_1", "ring"} < positions[0].keys()
    assert run("fe", design, "--pair", "planet_1-ring", "--teeth", "1", "-o", tmp_path / "a.inp")[0] == 0
    for command in (["tca"], ["fe", "-o", tmp_path / "a.inp"], ["render", "-o", tmp_path / "a.png"]):
        assert refused(*command, design, "--pair", "sun-ring").startswith(
            "--pair = sun-ring: must be one of sun-planet_1, "
        )
    message = refused("render", design, "--pair", "planet_1-ring", "--member", "sun", "-o", tmp_path / "a.png")
    assert message == "--member = sun: must be one of planet_1, ring"
    assert "pair = 5-6: must be one of pinion-gear" in refused("tca", SAMPLES / "spur.toml", "--pair", "5-6")


@pytest.mark.sweep
def test_members_of_a_set_have_the_thickness_allowances_that_are_given() -> None:
    """The flanks that touch have the backlash of the middles of both allowances, less what the base helix takes."""
    ends = {"sun": (-0.04, -0.06), "planet": (-0.02, -0.05), "ring": (-0.01, -0.03)}
    tables = {
        name: {
            "teeth": teeth,
            "face_width": 12,
            "thickness_allowance": {"upper": ends[name][0], "lower": ends[name][1]},
        }
        for name, teeth in (("sun", 18), ("planet", 27), ("ring", 72))
    }
    gears = gm.build(gm.parse({"kind": "planetary", "module": 2, **tables}))
    cosine = np.cos(np.radians(20.0))
    for mesh, members in (("sun-planet_1", ("sun", "planet")), ("planet_1-ring", ("planet", "ring"))):
        thinner = -sum(0.5 * sum(ends[name]) for name in members)
        found = gears.contact(pair=mesh).summary
        assert found["backlash_normal_min_mm"] == pytest.approx(thinner * cosine, abs=1e-9)
        assert found["backlash_normal_max_mm"] == pytest.approx(thinner * cosine, abs=1e-9)
    with pytest.raises(
        DesignError, match=r"backlash = 0\.1 mm: cannot be given together with sun\.thickness_allowance"
    ):
        gm.parse({"kind": "planetary", "module": 2, "backlash": 0.1, **tables})
    # one alone: the others are nominal
    del tables["sun"]["thickness_allowance"], tables["ring"]["thickness_allowance"]
    one = gm.build(gm.parse({"kind": "planetary", "module": 2, **tables}))
    for mesh in ("sun-planet_1", "planet_1-ring"):
        assert one.contact(pair=mesh).summary["backlash_normal_min_mm"] == pytest.approx(0.035 * cosine, abs=1e-9)


@pytest.mark.sweep
def test_symbols_of_a_set_match_balls_and_backlash() -> None:
    """Balls laid between the exact flanks, and the solver's backlash in both meshes, of a set made to the upper allowances."""
    letters = {"sun": "cd25", "planet": "d26", "ring": "b24"}
    shape = {"ring": {"manufacture": "formed"}}

    def of_allowances(given: dict[str, Any]) -> tuple[gm.Gears, dict[str, Any]]:
        tables = {name: {"thickness_allowance": given[name], **shape.get(name, {})} for name in letters}
        made = planetary(18, 27, 72, helix_angle=12, **tables)
        return made, made.sheet().plain_tables

    _, stated = of_allowances(letters)
    inner, outer = (stated[f"{pair}: Members"]["A_sne"][1:] for pair in ("Sun and planet", "Planet and ring"))
    assert [*inner, outer[1]] == pytest.approx([-0.054, -0.06, -0.17], abs=1e-12)
    assert outer[0] == inner[1]
    ends = dict(zip(letters, (*inner, outer[1]), strict=True))
    made, _ = of_allowances({name: {"upper": value, "lower": value} for name, value in ends.items()})
    for pair, names in (("Sun and planet", ("sun", "planet_1")), ("Planet and ring", ("planet_1", "ring"))):
        measures, backlash = stated[f"{pair}: Measures of the tooth thickness"], stated[f"{pair}: Backlash"]
        for k, name in enumerate(names, 1):
            measured = measuring.over_balls(made.members[name], measures["D_M"][k], -1 if name == "ring" else 1)
            assert measured == pytest.approx(measures["M_dK_upper"][k], abs=1e-9)
        # theoretical, working, least, largest
        summary = made.contact([0.0], pair="-".join(names)).summary
        assert summary["backlash_normal_min_mm"] == pytest.approx(backlash["j_bn"][3], abs=1e-9)
        assert summary["backlash_transverse_min_mm"] == pytest.approx(backlash["j_wt"][3], abs=1e-9)


@pytest.mark.sweep
def test_refusals_and_warnings_name_members_of_the_set() -> None:
    """In the fields of a refusal too, and in words where the mesh's own members have other names."""
    with pytest.raises(DesignError, match=r"^sun\.addendum = 2\.5: .*: the tooth is pointed") as pointed:
        _ = planetary(18, 27, 72, sun={"teeth": 18, "face_width": 12, "addendum": 2.5}).train
    assert pointed.value.topic == "sun: pointed"
    with pytest.raises(DesignError, match=r"42\.2862 mm with sun\.teeth = 18, planet\.teeth = 27$"):
        planetary(18, 27, 72, assembly={"center_distance": 30})
    ring = planetary(18, 27, 72, ring={"teeth": 72, "face_width": 12, "shaper": {"teeth": 60}})
    (trimmed,) = (line for line in ring.warnings if "trims" in line)
    assert trimmed.startswith("ring.shaper.teeth = 60: the cutter trims the tips")


@pytest.mark.sweep
def test_an_eccentric_sun_is_displaced_alike_for_all_planets() -> None:
    gears = planetary(18, 27, -72, backlash=0.06, assembly={"sun_eccentricity": 0.03, "sun_phase": 25})
    meshes = [pair for pair in gears.train.pairs if pair.pinion.name == "sun"]
    rotation = np.radians([0.0, 40.0, 200.0])
    first = meshes[0].pinion.mount.off(rotation)
    np.testing.assert_allclose(first[0], [0.03 * np.cos(np.radians(25)), 0.03 * np.sin(np.radians(25)), 0], atol=1e-15)
    for mesh in meshes[1:]:
        np.testing.assert_allclose(mesh.pinion.mount.off(rotation), first, atol=1e-15)
    # the sun turns clockwise: the crest that planet 1 sees comes to planet 2, at 120 deg, 240 deg later
    crests = [
        wave.crest
        for number in (0, 1)
        for wave in gears.contact(pair=number, turns=True).turns.waves
        if (wave.member, wave.per_turn) == ("sun", 1)
    ]
    later = np.degrees(crests[1] - crests[0]) % 360.0
    assert later == pytest.approx(240.0, abs=1.0)


def test_pitch_deviations_of_a_sun_meet_each_planet_at_its_own_teeth() -> None:
    teeth = 18
    deviations = [float(k % 5) for k in range(teeth)]
    gears = planetary(teeth, 27, -72, backlash=0.06, measured={"sun_pitch_right_um": deviations})
    whole = gears.member("sun").index.right
    assert not gears.train.alike
    for number, mesh in enumerate(gears.train.pairs[:3]):
        # planet k is at k thirds of the teeth
        first = number * teeth // 3
        assert mesh.pinion.index.right == whole[first:] + whole[:first]
        # counted from there, the body is the same one
        angle = np.degrees(mesh.pinion.mount.turn_from(gears.member("sun").mount)) % 360.0
        assert angle == pytest.approx(120.0 * number, abs=1e-9)


def test_changed_members_keep_their_places_in_every_mesh() -> None:
    gears = planetary(18, 27, -72, backlash=0.06)
    changed = gears.with_deviations("sun", "right", np.full((5, 9), 0.001))
    for old, new in zip(gears.train.pairs, changed.train.pairs, strict=True):
        np.testing.assert_allclose(new.pinion.mount.base.rotation, old.pinion.mount.base.rotation, atol=1e-15)
        np.testing.assert_allclose(new.gear.mount.base.rotation, old.gear.mount.base.rotation, atol=1e-15)
