"""The command `fe`: what it writes, prints and refuses; pictures of solved models."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import matplotlib
import meshio
import numpy as np
import pytest
from oracles.built import model_of
from oracles.command_line import refused, run
from oracles.examples import some
from oracles.places import SAMPLES
from scipy.special import ellipk

from gearmesh import FiniteElements, load
from gearmesh.fe.gear_model import ELEMENTS_PER_SEMI_AXIS
from gearmesh.fe.placing import major_axis, minor_axis
from gearmesh.fe.results import ContactTotal, NodalSolution, ReferenceNode
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.view.load.fe_views import STRESS_SHARE, pressure_scene, stress_scene
from gearmesh.view.opengl import missing_opengl_message
from gearmesh.view.palette import RESULT_COLOUR_MAP
from gearmesh.view.render import render
from gearmesh.view.scene import Camera, beside_bar

CROSSED = SAMPLES / "beveloid_crossed.toml"
COARSE = ["--set", "fe.flank=5", "--set", "fe.fillet=4", "--set", "fe.thickness=2", "--set", "fe.face=6"]

needs_ccx = pytest.mark.skipif(shutil.which("ccx") is None, reason="apt-get install calculix-ccx")
needs_opengl = pytest.mark.skipif(missing_opengl_message() is not None, reason="off-screen OpenGL")


@pytest.mark.quick
def test_deck_and_figures(tmp_path: Path) -> None:
    file = tmp_path / "pair.inp"
    status, out, err = run("fe", CROSSED, "-o", file, "--torque", "50", "--json", "-", *COARSE)
    assert status == 0
    assert "does not resolve the contact pressure: 0.22 elements over a semi-axis" in err
    document = json.loads(out)
    model = document["model"]
    assert document["solution"] is None
    assert document["design"]["fe"]["torque"] == 50.0
    deck = file.read_text()
    assert deck.count("\n*CONTACT PAIR") == 3
    assert "SOLVER=ITERATIVE CHOLESKY" in deck
    assert "TYPE=SURFACE TO SURFACE" in deck
    # the torque, against the sense of z here, on the node of the pinion's rotations
    assert f"*CLOAD\n{model['nodes'] + 2}, 3, -50000\n" in deck
    # springs are pressed in by 1.5 % of the approach; of an ellipse that is 3 F K(m) / (2 pi E* a)
    a, b, modulus = model["hertz_a_mm"], model["hertz_b_mm"], 206000.0 / (2.0 * (1.0 - 0.3**2))
    approach = 1.5 * model["normal_force_n"] * ellipk(1.0 - (b / a) ** 2) / (np.pi * modulus * a)
    spring = float(deck.split("PRESSURE-OVERCLOSURE=LINEAR\n")[1].split("\n")[0].split(",")[0])
    assert model["hertz_p0_mpa"] / spring == pytest.approx(0.015 * approach, rel=1e-3)
    for name in (
        "pinion_flank_right_2",
        "gear_fillet_left_3",
        "pinion_root",
        "gear_rim",
        "pinion_cut_right",
        "gear_heel",
    ):
        assert f"NSET={name}\n" in deck
        assert f"*SURFACE, NAME={name}, TYPE=ELEMENT\n" in deck


@pytest.mark.sweep
def test_material_and_rotation_reach_the_deck(tmp_path: Path) -> None:
    file = tmp_path / "pair.inp"
    steel = ["--set", "material.youngs_modulus=2.068e5", "--set", "material.poisson_ratio=0.29"]
    arguments = ["fe", CROSSED, "-o", file, "--teeth", "1", "--for", "abaqus", "--rotation", "0.01"]
    status, out, _ = run(*arguments, *steel, "--torque", "50", "--json", "-", *COARSE)
    assert status == 0
    by_tca = [
        json.loads(run("tca", CROSSED, *more, "--torque", "50", "--json", "-", "--set", "contact.phi1.count=3")[1])
        for more in (steel, [])
    ]
    pressures = [each["positions"][1]["hertz"]["p0_mpa"] for each in by_tca]
    assert json.loads(out)["model"]["hertz_p0_mpa"] == pytest.approx(pressures[0], rel=1e-9)
    # p0 goes with (E / (1 - nu^2))^(2/3)
    steels = 206800.0 / (1.0 - 0.29**2), 206000.0 / 0.91
    assert pressures[0] / pressures[1] == pytest.approx((steels[0] / steels[1]) ** (2.0 / 3.0), rel=1e-9)
    deck = file.read_text()
    assert "206800, 0.29" in deck
    assert f"{-np.radians(0.01):.12g}" in deck
    assert "CLOAD" not in deck


@pytest.mark.sweep
def test_several_positions_are_a_folder_with_a_script(tmp_path: Path) -> None:
    folder, calls = tmp_path / "decks", tmp_path / "calls"
    keyed = ["--set", "pinion.bore=8", "--set", "pinion.keyway={width=2, depth=1}", "--set", "gear.bore=8"]
    keyed += ["--set", "gear.hub={diameter=14, length=5}"]
    arguments = ["fe", CROSSED, "--teeth", "1", "--friction", "0.08", *keyed, *COARSE]
    status, out, err = run(*arguments, "-o", folder, "--phi1=-4:4:3", "--json", "-")
    assert status == 0
    names = [f"position_{k}.inp" for k in (1, 2, 3)]
    assert sorted(each.name for each in folder.iterdir()) == [*names, "run.sh"]
    rows = json.loads(out)["positions"]
    assert [row["deck"] for row in rows] == names
    assert [row["model"]["phi1_deg"] for row in rows] == pytest.approx([-4.0, 0.0, 4.0])
    assert not any(row["pressure_resolved"] for row in rows)
    # what holds of every position is said once
    assert err.count("warning") == 2
    assert "the finite-element model has none of: keyway (pinion), hub (gear)" in err
    assert "(at 3 of 3 positions)" in err
    # each is the deck of its position alone
    for row, angle in zip(rows, ("-4", "0", "4"), strict=True):
        assert run(*arguments, "-o", tmp_path / "one.inp", f"--phi1={angle}")[0] == 0
        assert (tmp_path / "one.inp").read_bytes() == (folder / row["deck"]).read_bytes()
    solver = tmp_path / "ccx"
    solver.write_text(f'#!/bin/sh\necho "$PWD $@" >> {calls}\n')
    solver.chmod(0o755)
    environment = {**os.environ, "GEARMESH_CCX": str(solver)}
    subprocess.run([folder / "run.sh"], env=environment, cwd=tmp_path, check=True)
    assert calls.read_text().splitlines() == [f"{folder} -i position_{k}" for k in (1, 2, 3)]


@pytest.mark.sweep
@pytest.mark.sweep_cases("spiral_bevel_basic")
@pytest.mark.parametrize("sample", some(["helical", "face_gear", "planetary", "spiral_bevel_basic"], 2))
def test_default_models_resolve_the_contact_pressure(sample: str) -> None:
    """Counted on the mesh: rows of flank faces that the contact ellipse covers, at the station of its middle."""
    built = model_of(load(SAMPLES / f"{sample}.toml"))
    figures, at = built.figures, built._built.at
    assert built.coarse == ""
    assert not any("resolve" in line for line in built.warnings)
    assert figures["elements"] < 150_000
    assert figures["elements_to_resolve"] is None
    mesh, place = built.mesh, at.frame.point(at.path.point[0])
    for contact in (built._model.contacts[1].slave, built._model.contacts[1].master):
        offset = mesh.nodes[mesh.face_corners(contact)].mean(axis=1) - place
        along, across = (offset @ at.frame.vector(axis(at.path)) for axis in (major_axis, minor_axis))
        inside = (along / at.semi_major) ** 2 + (across / at.semi_minor) ** 2 < 1.0
        assert np.count_nonzero(inside) > 0.85 * np.pi * ELEMENTS_PER_SEMI_AXIS**2


@pytest.mark.sweep
def test_default_says_how_many_elements_it_would_take() -> None:
    """A line of contact that is curved takes too many; own numbers of elements stand, and so does fe.ellipse."""
    (line,) = [each for each in model_of(load(SAMPLES / "face_gear_conjugate.toml")).warnings if "resolve" in each]
    assert re.search(r"fe.ellipse = \d+ resolves it, and so do \d{6} elements with the default spacing", line)
    own = model_of(load(SAMPLES / "spur.toml", ["fe.flank=24", "fe.teeth=1"]))
    assert "2.9 elements over a semi-axis" in own.coarse


@pytest.mark.sweep
def test_unresolved_pressures_are_said_in_their_line(monkeypatch: pytest.MonkeyPatch) -> None:
    """In table, headline and title of the picture; also where another pair than the leading one has the largest."""
    design = load(CROSSED, ["fe.teeth=3", "fe.ellipse=4", "fe.order=1"])
    coarse = load(CROSSED, ["fe.teeth=3", *COARSE[1::2]])
    for wanted, pressed, words in (
        (coarse, 1, "elements over a semi-axis"),
        (design, 1, ""),
        (design, 0, "not on the leading tooth pair"),
    ):
        built = model_of(wanted)
        solution, _ = pretended(built, pressed)
        monkeypatch.setattr("gearmesh.fe.ccx.solve", lambda *_, found=solution, **__: found)
        solved = built.solve()
        assert solved.document()["solution"]["pressure_resolved"] is (not words)
        line = next(row for row in str(solved).splitlines() if row.startswith("max_pressure_mpa"))
        assert ("(unresolved:" in line) is ("(unresolved:" in solved.headline) is bool(words)
        assert words in solved.headline
        scene = pressure_scene(built._model, solution, built._built.at, note=solved.reserve)
        assert scene.title.endswith(" MPa" if not words else f" MPa by Hertz ({solved.reserve})")
        # nobody may use a pressure that is not resolved: it ends no scale, and stands last
        by_hertz = built.measured.hertz_p0
        assert scene.maps[0].limit == pytest.approx(by_hertz if words else 1000.0, rel=1e-2)
        rows = [row for row in str(solved).splitlines() if row[:1].strip()]
        assert rows[-1].startswith("max_pressure_mpa") is bool(words)
        assert (f"pressure by Hertz {by_hertz:.5g} MPa" in solved.headline) is bool(words)


def test_a_pair_that_its_load_turns_back_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    """Coarse lobes of cycloidal drives bear on facets beside the pins: their drive turned back by 800 arcsec."""
    built = model_of(load(CROSSED, COARSE[1::2]))
    solution, _ = pretended(built)
    sense, reported = np.sign(built._built.at.arm), []
    for turn in (1e-3, -1e-3):
        held = replace(solution.references["pinion_held"], rotation=np.array([0.0, 0.0, sense * turn]))
        found = replace(solution, references={"pinion_held": held})
        monkeypatch.setattr("gearmesh.fe.ccx.solve", lambda *_, found=found, **__: found)
        solved = built.solve()
        reported.append(sorted({*solved.warnings} - {*built.warnings}))
    back = -solved.measured.contact.rotation
    assert reported[0] == []
    assert back == pytest.approx(3600.0 * np.degrees(1e-3 - built._built.preload), rel=1e-9)
    assert reported[1][0].startswith(f"the load turns the pinion back by {back:.3g} arcsec")


@pytest.mark.parametrize("suffix", [".msh", ".vtu"])
@pytest.mark.sweep_cases(".msh")
def test_other_formats_hold_the_same_mesh(tmp_path: Path, suffix: str) -> None:
    file = tmp_path / f"pair{suffix}"
    status, out, _ = run("fe", CROSSED, "-o", file, "--teeth", "1", "--json", "-", *COARSE)
    assert status == 0
    model, mesh = json.loads(out)["model"], meshio.read(file)
    assert len(mesh.points) == model["nodes"]
    assert sum(len(block.data) for block in mesh.cells if block.type == "hexahedron") == model["elements"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "--output: missing"),
        (["-o", "x.inp", "--teeth", "2"], "--teeth = 2: must be an odd number, or all"),
        (["-o", "x.inp", "--set", "fe.teeth=4"], "fe.teeth = 4: must be an odd number"),
        (["-o", "x.inp", "--teeth", "99"], "fe.teeth = 99: must be an odd number up to 35, or 0 for all teeth"),
        (["-o", "x.inp", "--torque", "0"], "fe.torque = 0.0: must be a torque in Nm above 0"),
        (["-o", "x.inp", "--rotation", "2"], "--rotation = 2: must be above 0 and up to 1 deg"),
        (["-o", "x.inp", "--phi1", "inf"], "--phi1 = inf: must be a finite number of degrees"),
        (["-o", "x.inp", "--phi1", "0:4"], "--phi1 = 0:4: must be a finite number of degrees, or START:STOP:COUNT"),
        (["-o", "x.inp", "--phi1", "0:4:3"], "--output = x.inp: must be a folder for several positions"),
        (["--solve", "--phi1", "0:4:3"], "--phi1 = 0:4:3: must be one position with --solve"),
        (["-o", "x.inp", "--friction", "2"], "--friction = 2: must be a coefficient from 0 to 1"),
        (
            ["-o", "x.inp", "--friction", "0.1", "--member", "gear"],
            "--friction = 0.1: must be left out with --member gear",
        ),
        (["-o", "x.inp", "--set", "fe.rim=500"], "rim = 500 mm: must be at most"),
        (["-o", "x.inp", "--picture", "x.png"], "--picture = x.png: must be left out without --solve"),
        (["-o", "x.inp", "--keep", "kept"], "--keep = kept: must be left out without --solve"),
        (["-o", "x"], "cannot write x: no suffix"),
        (["-o", "x.med", "--sector", "1", "--member", "pinion"], "--sector = 1: must be left out for .med files"),
        (["--frequencies", "0"], "--frequencies = 0: must be a number from 1 to 100"),
        (["--frequencies", "3", "--sector", "1"], "--frequencies = 3: must be left out for a sector"),
        (["--frequencies", "3", "--solve"], "--frequencies = 3: must be left out with --solve"),
        (["--frequencies", "3"], "--frequencies = 3: must be left out for members in mesh; choose one member"),
        (
            ["-o", "x.stl"],
            "unknown suffix .stl; allowed for finite-element models are .bdf, .cdb, .inp, .k, .med, .msh, .vtu",
        ),
        (["-o", "x.msh", "--for", "abaqus"], "the suffix of abaqus files is .inp"),
        (["-o", "x.inp", "--for", "nastran"], "the suffix of nastran files is .bdf"),
        (["-o", "x", "--for", "nastran", "--phi1", "0:2:2"], "--for = nastran: must be calculix or abaqus for several"),
        (["-o", "nowhere/x.inp"], "the folder nowhere does not exist"),
    ],
)
@pytest.mark.sweep_cases("arguments12-rim = 500 mm: must be at most")
def test_refusals_name_key_value_and_what_is_allowed(
    arguments: list[str], words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert words in refused("fe", CROSSED, *arguments, *COARSE)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.quick
def test_without_medcoupling(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Named before the design is built."""
    monkeypatch.setattr("gearmesh.build", None)
    monkeypatch.setattr("gearmesh.fe.decks.aster.find_spec", lambda _: None)
    message = refused("fe", CROSSED, "-o", tmp_path / "x.med", *COARSE)
    assert 'MED files need medcoupling: pip install "gearmesh[med]"' in message
    assert list(tmp_path.iterdir()) == []


@pytest.mark.quick
def test_without_calculix(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GEARMESH_CCX", "no-such-program")
    # named before the design is built
    monkeypatch.setattr("gearmesh.build", None)
    message = refused("fe", CROSSED, "-o", tmp_path / "x.inp", "--solve", *COARSE)
    assert "apt-get install calculix-ccx" in message
    assert list(tmp_path.iterdir()) == []


@pytest.mark.sweep
@needs_ccx
def test_natural_frequencies_fall_as_the_root_of_the_density(tmp_path: Path) -> None:
    arguments = ["fe", CROSSED, "--member", "pinion", "--teeth", "1", "--frequencies", "3", "--json", "-", *COARSE]
    found = []
    for density in ("7850", "1962.5"):
        status, out, _ = run(*arguments, "--set", f"material.density={density}", "--keep", tmp_path / density)
        assert status == 0
        rows = json.loads(out)["natural_frequencies"]
        assert [row["mode"] for row in rows] == [1, 2, 3]
        found.append([row["frequency_hz"] for row in rows])
        assert "*FREQUENCY\n3\n" in (tmp_path / density / "model.inp").read_text()
    np.testing.assert_allclose(found[1], 2.0 * np.array(found[0]), rtol=1e-5)
    assert found[0][0] > 1e4


@pytest.mark.sweep
@needs_ccx
@needs_opengl
def test_one_member_solved(tmp_path: Path) -> None:
    """Reactions are not reported for it; tension is on the loaded side's fillet, compression on the other."""
    picture = tmp_path / "pinion.png"
    status, out, _ = run(
        *("fe", CROSSED, "--member", "pinion", "--teeth", "1", "--solve", "--json", "-", "--picture", picture),
        *("-o", tmp_path / "found", *COARSE),
    )
    assert status == 0
    assert {"result.vtu", "result.json", "model.inp", "model.frd", "model.dat"} <= {
        file.name for file in (tmp_path / "found").iterdir()
    }
    solved = meshio.read(tmp_path / "found" / "result.vtu")
    worst = max(
        float(solved.point_data["max_principal_stress_mpa"][solved.point_data[name] == 1].max())
        for name in solved.point_data
        if "_fillet_" in name
    )
    assert worst == pytest.approx(json.loads(out)["solution"]["fillets"]["pinion"]["max_tension_mpa"], rel=1e-12)
    solution = json.loads(out)["solution"]
    assert "max_pressure_mpa" not in solution
    fillets = solution["fillets"]["pinion"]
    # the right flank (y < 0 of the tooth on +x) works
    assert fillets["tension_point_mm"][1] < 0.0 < fillets["compression_point_mm"][1]
    assert 20.0 < fillets["max_tension_mpa"] < 300.0
    assert 20.0 < fillets["max_compression_mpa"] < 300.0
    assert matplotlib.image.imread(picture).shape[:2] == (1200, 1600)


def pretended(built: FiniteElements, pressed: int = 1) -> tuple[NodalSolution, Array]:
    """A solution with a pressure on a slave flank, the leading one's or that of another contact, and a tension that grows with the
    station; its place.
    """
    model, at = built._model, built._built.at
    mesh, place = model.mesh, at.frame.point(at.path.point[0])
    if pressed != 1:
        place = mesh.nodes[mesh.face_nodes(model.contacts[pressed].slave)].mean(axis=0)
    apart = np.linalg.norm(mesh.nodes - place, axis=-1)
    flank = np.isin(np.arange(len(mesh.nodes)), mesh.face_nodes(model.contacts[pressed].slave))
    pressure = np.where(flank, 1000.0 * np.sqrt(np.maximum(1.0 - (apart / 1.5) ** 2, 0.0)), 0.0)
    stress = np.zeros((len(mesh.nodes), 6))
    stress[:, 2] = 10.0 + mesh.nodes[:, 2]
    held = {"pinion_held": ReferenceNode(*np.zeros((4, 3)))}
    totals = tuple(ContactTotal(np.zeros(3), np.zeros(3), 1.0) for _ in model.contacts)
    return NodalSolution(np.zeros_like(mesh.nodes), stress, pressure, held, totals, 1), place


@pytest.mark.sweep
@needs_opengl
def test_pictures_show_what_was_solved() -> None:
    design = load(CROSSED, ["fe.teeth=3", "fe.ellipse=3", *COARSE[1::2]])
    built = model_of(design)
    solution, place = pretended(built)
    scene = pressure_scene(built._model, solution, built._built.at, (800, 600))
    (value_map,) = scene.maps
    assert value_map.limit == pytest.approx(1000.0, rel=1e-2)
    # the pressed tooth alone, whole and closed, with the edges of its elements
    (body,), (edges,) = scene.bodies, scene.curves
    shown = body.mesh.vertices[np.unique(body.mesh.triangles)]
    x, y, _ = np.moveaxis(scene.camera.pixels(shown, beside_bar((800, 600))), -1, 0)
    assert (x > 0.0).all()
    assert (x < beside_bar((800, 600))[0]).all()
    assert (y > 0.0).all()
    assert (y < 600.0).all()
    sides = np.sort(body.mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    assert (np.unique(sides, axis=0, return_counts=True)[1] == 2).all()
    drawn = edges.points.reshape(-1, 3, 3)[:, :2]
    assert np.isin(drawn.reshape(-1, 3).round(9), built.mesh.nodes.round(9)).all()
    assert len(drawn) > 100
    assert np.linalg.norm(value_map.points - place, axis=-1).max() < 3.0
    image = render(replace(scene, title=""))
    darkest = 255 * np.array(matplotlib.colormaps[RESULT_COLOUR_MAP](1.0)[:3])
    assert np.abs(pixel(image, scene.camera, place) - darkest).max() < 25

    scene = stress_scene(built._model, solution, built._built.at, (800, 600))
    (value_map,) = scene.maps
    # the gear is askew: its fillets reach higher than the pinion's
    fillets = [name for name in built.mesh.face_sets if name.startswith("gear_fillet")]
    worst = 10.0 + max(built.mesh.nodes[built.mesh.face_corners(name), 2].max() for name in fillets)
    assert worst > 18.0
    assert value_map.limit == pytest.approx(STRESS_SHARE * worst, rel=1e-9)
    assert f"{worst:.0f} MPa" in scene.title
    heel = built.mesh.nodes[built.mesh.face_corners("pinion_heel")].mean(axis=1)
    image = render(replace(scene, curves=()))
    expected = 255 * np.array(matplotlib.colormaps[RESULT_COLOUR_MAP](17.0 / value_map.limit)[:3])
    seen = [np.abs(pixel(image, scene.camera, point) - expected).max() < 12 for point in heel]
    # what is not behind an edge or the gear
    assert np.mean(seen) > 0.8


def pixel(image: Array, camera: Camera, point: Array) -> Array:
    """Colour (3,) where a point appears, beside the colour bar."""
    x, y, _ = camera.pixels(point, beside_bar((image.shape[1], image.shape[0])))
    return image[round(float(y)), round(float(x))].astype(float)
