"""Gears handed over to CAD programs: build123d and CadQuery in memory, assemblies in a file for three readers."""

from __future__ import annotations

import ast
import importlib.util
import json
import re
import subprocess
import sys
import tomllib
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from oracles.cad_readers import by_freecad, by_gmsh, by_opencascade, needs_freecad
from oracles.command_line import refused
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.answers.bodies.freecad import macro
from gearmesh.app.cli import main
from gearmesh.cad.brep import exact_volume
from gearmesh.cad.part21 import basic_alphabet
from gearmesh.io.palette import region_colours

#: few teeth, which differ
PAIR = ["pinion.teeth=12", "gear.teeth=13"]
#: three planets, of as few teeth as can be
SET = [
    "sun.teeth=15",
    "planet.teeth=15",
    "ring.teeth=-45",
    "sun.face_width=8",
    "planet.face_width=7",
    "ring.face_width=8",
    "name=Räder 齿 15",
]
#: mm
COARSE = 0.001

needs_build123d = pytest.mark.skipif(importlib.util.find_spec("build123d") is None, reason='pip install ".[build123d]"')
needs_cadquery = pytest.mark.skipif(importlib.util.find_spec("cadquery") is None, reason='pip install ".[cadquery]"')


@cache
def gears(sample: str = "helical", changes: tuple[str, ...] = tuple(PAIR)) -> gm.Gears:
    return gm.build(gm.load(SAMPLES / f"{sample}.toml", changes))


def exact_volumes(of: gm.Gears) -> dict[str, float]:
    return {name: exact_volume(member) for name, member in of.members.items()}


# ---------------------------------------------------------------- libraries of Python


@needs_build123d
@pytest.mark.sweep
def test_build123d_has_named_placed_solids() -> None:
    """Exact bodies, not facets, in mesh at another phi1: touching, with no material in common."""
    import build123d

    assembly = gears().to_build123d(COARSE, phi1=7.0)
    assert assembly.label == gears().title
    pinion, gear = assembly.children
    assert [pinion.label, gear.label] == ["pinion", "gear"]
    for part, colour in zip((pinion, gear), region_colours(2), strict=True):
        assert part.is_valid
        assert part.volume == pytest.approx(exact_volumes(gears())[part.label], rel=1e-6)
        np.testing.assert_allclose(tuple(part.color)[:3], colour, atol=1e-6)
    assert pinion.intersect(gear) is None
    kinds = {face.geom_type for face in pinion.faces()}
    assert kinds == {build123d.GeomType[name] for name in ("BSPLINE", "CYLINDER", "PLANE")}


@needs_build123d
@pytest.mark.sweep
def test_a_mesh_for_build123d_is_the_exact_solid_where_it_is() -> None:
    solid = gears().solids(0.05, phi1=-3.0).parts["gear"]
    made = solid.to_build123d()
    assert (made.label, made.is_valid) == ("gear", True)
    assert made.volume == pytest.approx(exact_volumes(gears())["gear"], rel=2e-5)
    box = made.bounding_box()
    low, high = solid.mesh.vertices.min(axis=0), solid.mesh.vertices.max(axis=0)
    np.testing.assert_allclose([tuple(box.min), tuple(box.max)], [low, high], atol=0.06)


@needs_cadquery
@pytest.mark.sweep
def test_to_cadquery_has_named_placed_solids_with_tagged_faces() -> None:
    import cadquery

    assembly = gears().to_cadquery(COARSE, phi1=7.0)
    assert assembly.name == gears().title
    for part, colour in zip(assembly.children, region_colours(2), strict=True):
        place = gears().places_at(7.0)[part.name]
        assert part.loc.toTuple()[0] == pytest.approx(place.translation.tolist())
        assert part.color.toTuple()[:3] == pytest.approx(colour, abs=1e-6)
        (solid,) = part.obj.vals()
        assert isinstance(solid, cadquery.Solid)
        assert solid.isValid()
        assert solid.Volume() == pytest.approx(exact_volumes(gears())[part.name], rel=1e-6)
        assert part.obj.faces(tag="flank_left").size() == gears().members[part.name].tooth.teeth
        assert part.obj.faces(tag="bore").val().geomType() == "CYLINDER"
    assert gears().solid("pinion", 0.05).to_cadquery().val().isValid()


def test_without_the_library_one_line_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    part, mesh = gears().cad("pinion", 0.05), gears().solid("pinion", 0.05)
    for library, name in (("build123d", "build123d"), ("cadquery", "CadQuery")):
        monkeypatch.setitem(sys.modules, library, None)
        for made in (part, mesh):
            with pytest.raises(gm.OutputError) as raised:
                getattr(made, f"to_{library}")()
            assert str(raised.value) == f'to_{library} needs {name}: pip install "gearmesh[{library}]"'


def test_a_mesh_for_manifold3d_is_the_same_body() -> None:
    solid = gears().solid("pinion", 0.05)
    body = solid.to_manifold()
    assert body.status().name == "NoError"
    assert body.volume() == pytest.approx(solid.mesh.volume(), rel=1e-12)
    with pytest.raises(gm.DesignError, match="pinion: open surfaces are no body"):
        gears().solid("pinion", 0.05, teeth=2).to_manifold()


# ---------------------------------------------------------------- positions


@pytest.mark.sweep
@pytest.mark.quick
def test_members_are_in_mesh_at_any_position() -> None:
    """Helical involute gears roll without transmission error: the gear turns by the ratio, the pinion clockwise by phi1."""
    first, then = gears().places_at(0.0), gears().places_at(100.0)
    for name, angle in (("pinion", -100.0), ("gear", 100.0 * 12 / 13)):
        turn = first[name].rotation.T @ then[name].rotation
        assert np.degrees(np.arctan2(turn[1, 0], turn[0, 0])) == pytest.approx(angle, abs=1e-9)
    with pytest.raises(gm.DesignError, match="phi1 = nan: must be a finite number of degrees"):
        gears().places_at(float("nan"))
    with pytest.raises(gm.DesignError, match="phi1 = 7: must be left out for one member"):
        gears().cad("pinion", phi1=7.0)


# ---------------------------------------------------------------- assemblies in a file


@pytest.fixture(scope="module")
def planetary(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A set of three planets as one file."""
    return gears("planetary", tuple(SET)).cad(None, 10 * COARSE).save(tmp_path_factory.mktemp("set") / "set.step")


@pytest.mark.sweep
def test_planets_are_one_part_that_occurs_three_times(planetary: Path) -> None:
    text = planetary.read_text()
    names = re.findall(r"=PRODUCT\('([^']*)'", text)
    assert names == [r"R\X2\00E4\X0\der \X2\9F7F\X0\ 15", "sun", "planet", "ring"]
    used = re.findall(r"NEXT_ASSEMBLY_USAGE_OCCURRENCE\('\d+','([^']*)','',#\d+,(#\d+)", text)
    assert [name for name, _ in used] == ["sun", "planet_1", "planet_2", "planet_3", "ring"]
    assert len({product for _, product in used}) == 3
    assert text.count("MANIFOLD_SOLID_BREP") == 3


def test_texts_have_the_alphabet_of_the_standard() -> None:
    assert basic_alphabet("Rad 'x' 12\n\U0001d11eäx") == r"Rad 'x' 12\X4\0000000A0001D11E000000E4\X0\x"


def test_a_planet_with_other_flanks_is_a_part_of_its_own() -> None:
    of = gears("planetary", tuple(SET))
    other = of.with_deviations("planet_2", "left", 0.001 * np.ones((2, 2)))
    members = list(of.members.values())
    assert members[1].is_shaped_as(members[3])
    assert not members[1].is_shaped_as(other.members["planet_2"])
    assert not members[0].is_shaped_as(members[1])


@pytest.mark.sweep
@pytest.mark.parametrize("reader", ["opencascade", "gmsh", pytest.param("freecad", marks=needs_freecad)])
def test_readers_have_every_solid_in_its_place(reader: str, planetary: Path) -> None:
    """Volumes and centres of mass: of spur gears the middle of the face."""
    of = gears("planetary", tuple(SET))
    if reader == "freecad":
        read = by_freecad(planetary)
        assert read["valid"]
        # planets as one link that has them three times
        assert read["features"].items() >= {"sun": 1, "planet": 1, "ring": 1, "planet001": 3, of.title: 5}.items()
        solids = read["solids"]
    else:
        solids = {"opencascade": by_opencascade, "gmsh": by_gmsh}[reader](planetary)
    volumes = exact_volumes(of)
    middles = [np.array([0.0, 0.0, 0.5 * sum(member.extent)]) for member in of.members.values()]
    expected = [[volumes[name], *of.places[name].point(z)] for name, z in zip(of.members, middles, strict=True)]
    np.testing.assert_allclose(np.array(solids)[:, 0], np.array(expected)[:, 0], rtol=3e-5)
    np.testing.assert_allclose(np.array(solids)[:, 1:], np.array(expected)[:, 1:], atol=1e-4)


# ---------------------------------------------------------------- FreeCAD

STATE = r"""
import json
import FreeCAD

def keep(step):
    features = FreeCAD.ActiveDocument.Objects
    shapes = {own.Label: own.Shape for own in features if hasattr(own, "member")}
    kept = {
        "volumes": {name: shape.Volume for name, shape in shapes.items()},
        "valid": all(shape.isValid() for shape in shapes.values()),
        "turn": {name: shape.Placement.Rotation.Angle for name, shape in shapes.items()},
        "states": [list(own.State) for own in features],
    }
    open(step + ".json", "w").write(json.dumps(kept))
"""
#: parameters change in a document that the macro has just made
CHANGED = r"""
exec(open("gears.FCMacro").read())
document = FreeCAD.ActiveDocument
gears = document.getObject("Gears")
keep("first")
gears.pinion_teeth, gears.overrides, gears.phi1 = 14, ["gear.bore=20"], 90.0
document.recompute()
keep("changed")
gears.pinion_teeth = 2
document.recompute()
keep("refused")
gears.pinion_teeth = 14
document.saveAs("gears.FCStd")
"""
#: and in one that was opened
OPENED = r"""
document = FreeCAD.openDocument("gears.FCStd")
exec(open("gears.FCMacro").read())
document.getObject("Gears").gear_teeth = 15
document.recompute()
keep("opened")
"""
SMALL = ["pinion.teeth=12", "gear.teeth=13", "pinion.face_width=10", "gear.face_width=10", "gear.bore=0"]


def write_macro(folder: Path) -> str:
    settings = [word for change in SMALL for word in ("--set", change)]
    file = folder / "gears.FCMacro"
    assert main(["freecad", str(SAMPLES / "helical.toml"), "-o", str(file), "--tol", "1um", *settings]) == 0
    return file.read_text()


def test_a_macro_has_the_keys_of_the_design_as_typed_properties(tmp_path: Path) -> None:
    tree = ast.parse(write_macro(tmp_path))
    (setup,) = (
        ast.literal_eval(node.value)
        for node in tree.body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "SETUP"
    )
    kinds = {key["key"]: (key["type"], key["value"]) for key in setup["keys"].values()}
    assert kinds["pinion.teeth"] == ("Integer", 12)
    assert kinds["module"] == ("Float", 5.0)
    assert setup["keys"]["pinion_teeth"]["about"] == "number of teeth: a whole number from 3 to 10000"
    assert not {"kind", "units", "name"} & set(kinds)
    design = gm.load(SAMPLES / "helical.toml", SMALL)
    assert gm.parse(tomllib.loads(setup["design"])) == design
    assert (setup["tolerance"], setup["folder"]) == ("1um", str(SAMPLES))


@pytest.mark.parametrize("kind", sorted({tomllib.loads(file.read_text())["kind"] for file in SAMPLES.glob("*.toml")}))
@pytest.mark.sweep_cases("hypoid")
def test_the_macro_of_every_kind_is_python_with_plain_values(kind: str) -> None:
    """FreeCAD's own Python has no gearmesh: words that a key chooses from are plain strings, and the value is one of them."""
    file = next(file for file in sorted(SAMPLES.glob("*.toml")) if tomllib.loads(file.read_text())["kind"] == kind)
    data = tomllib.loads(file.read_text())
    tree = ast.parse(macro(gm.load(file), data, file.read_text(), SAMPLES, "1um"))
    (setup,) = (
        ast.literal_eval(node.value)
        for node in tree.body
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "SETUP"
    )
    assert setup["keys"]
    assert all(key["value"] in key["choices"] for key in setup["keys"].values() if "choices" in key)


def test_macros_have_a_suffix_of_their_own(tmp_path: Path) -> None:
    words = refused("freecad", SAMPLES / "helical.toml", "-o", tmp_path / "gears.py")
    assert words == f"cannot write {tmp_path / 'gears.py'}: its suffix must be .FCMacro"
    assert "--tol = 0" in refused("freecad", SAMPLES / "helical.toml", "-o", tmp_path / "a.FCMacro", "--tol", "0")


@needs_freecad
@pytest.mark.sweep
def test_features_follow_their_parameters(tmp_path: Path) -> None:
    """Exact volumes after changes, the program's line where it refuses them, and again in a document that was opened."""
    write_macro(tmp_path)
    printed = ""
    for program in (CHANGED, OPENED):
        (tmp_path / "run.py").write_text(STATE + program)
        done = subprocess.run(
            ["freecadcmd", "run.py"], input="", capture_output=True, text=True, check=False, cwd=tmp_path
        )
        printed += done.stdout + done.stderr
    steps = {file.stem: json.loads(file.read_text()) for file in tmp_path.glob("*.json")}
    bored = [*SMALL, "pinion.teeth=14", "gear.bore=20"]
    for step, changes in (
        ("first", SMALL),
        ("changed", bored),
        ("refused", bored),
        ("opened", [*bored, "gear.teeth=15"]),
    ):
        assert steps[step]["valid"]
        expected = exact_volumes(gears("helical", tuple(changes)))
        assert steps[step]["volumes"] == pytest.approx(expected, rel=1e-6)
        assert [words == ["Up-to-date"] for words in steps[step]["states"]] == [step != "refused", True, True]
    assert np.degrees(steps["changed"]["turn"]["pinion"]) == pytest.approx(90.0, abs=1e-9)
    assert "gearmesh: error: pinion.teeth = 2: must be a whole number from 3 to 10000" in printed
    # three times solids were made anew, and one was refused
    assert printed.count("gearmesh: solids of Helical gears z 24/48\n") == 4
