"""Names of faces beside a STEP file, of occurrences and colours in it, as gmsh, build123d and FreeCAD read them."""

from __future__ import annotations

import csv
import importlib.util
import json
import pickle
import re
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.cad_readers import by_freecad, needs_freecad
from oracles.command_line import refused
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import Rigid
from gearmesh.answers.bodies.face_names import face_names
from gearmesh.app.cli import main
from gearmesh.cad.step import NamedFace, Occurrence, Part, PartAssembly, write_step
from gearmesh.io.palette import region_colours
from gearmesh.kinds import Region

#: few teeth, which differ
PAIR = ["pinion.teeth=12", "gear.teeth=13"]
#: mm
COARSE = 0.05

needs_build123d = pytest.mark.skipif(importlib.util.find_spec("build123d") is None, reason='pip install ".[build123d]"')

#: of all faces by their tags area and centre, and of all solids names, colours and numbers of faces
GMSH = r"""
import json, sys
import gmsh
gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.model.occ.importShapes(sys.argv[1])
gmsh.model.occ.synchronize()
solids = [solid for _, solid in gmsh.model.getEntities(3)]
print(json.dumps({
    "faces": {
        face: [gmsh.model.occ.getMass(2, face), *gmsh.model.occ.getCenterOfMass(2, face)]
        for _, face in gmsh.model.getEntities(2)
    },
    "named": sum(bool(gmsh.model.getEntityName(2, face)) for _, face in gmsh.model.getEntities(2)),
    "solids": [gmsh.model.getEntityName(3, solid) for solid in solids],
    "colours": [gmsh.model.getColor(3, solid)[:3] for solid in solids],
    "counts": [len(gmsh.model.getBoundary([(3, solid)])) for solid in solids],
}))
"""
BUILD123D = r"""
import json, sys
import build123d
read = build123d.import_step(sys.argv[1])
print(json.dumps([[part.label, list(part.color)[:3]] for part in read.children]))
"""


@cache
def gears(changes: tuple[str, ...] = tuple(PAIR)) -> gm.Gears:
    return gm.build(gm.load(SAMPLES / "helical.toml", changes))


def run(program: str, file: Path) -> Any:
    done = subprocess.run([sys.executable, "-c", program, str(file)], capture_output=True, text=True, check=True)
    return json.loads(done.stdout.splitlines()[-1])


def measures(shape: Any) -> list[float]:
    """Area (mm^2) and centre (mm) of a face."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    own = GProp_GProps()
    BRepGProp.SurfaceProperties_s(shape, own)
    centre = own.CentreOfMass()
    return [own.Mass(), centre.X(), centre.Y(), centre.Z()]


def box(name: str, size: float) -> Part:
    """A cube whose six faces are called by regions of a tooth, in another order than the cube's."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeBox

    from gearmesh.cad.occ import mapped_shapes

    solid = BRepPrimAPI_MakeBox(size, size, size).Solid()
    shapes, regions = mapped_shapes(solid, "FACE"), tuple(Region)[:6]
    faces = [NamedFace(shapes.FindKey(k), f"{region}_{k}", region) for k, region in enumerate(regions, 1)]
    return Part(name, solid, tuple(reversed(faces)), regions)


def cubes() -> PartAssembly:
    """One cube and, twice, another."""
    first, second = box("sun", 1.0), box("planet", 2.0)
    ways = {"sun": (first, 0.0), "planet_1": (second, 5.0), "planet_2": (second, 9.0)}
    places = {name: Rigid(np.eye(3), np.array([way, 0.0, 0.0])) for name, (_, way) in ways.items()}
    return PartAssembly("set", tuple(Occurrence(name, part, places[name]) for name, (part, _) in ways.items()))


@pytest.mark.sweep
def test_names_of_occurrences_and_colours_of_solids_arrive_in_gmsh(tmp_path: Path) -> None:
    """Occurrences have names and solids colours; faces have neither name nor member, which is why there is a table."""
    made, file = cubes(), tmp_path / "set.step"
    write_step(made, file, "cubes")
    read = run(GMSH, file)
    assert read["solids"] == ["Shapes/set/sun/sun", "Shapes/set/planet_1/planet", "Shapes/set/planet_2/planet"]
    np.testing.assert_allclose(np.array(read["colours"]) / 255.0, made.colours, atol=0.01)
    assert read["named"] < 18
    rows = face_names(gears().design, made).faces
    assert [row.face for row in rows] == list(map(int, read["faces"]))
    assert [row.member for row in rows] == [name for name in ("sun", "planet_1", "planet_2") for _ in range(6)]
    for row in rows:
        area, *centre = read["faces"][str(row.face)]
        (occurrence,) = (own for own in made.occurrences if own.name == row.member)
        (face,) = (own for own in occurrence.part.faces if own.name == row.name)
        expected, *middle = measures(face.shape)
        assert area == pytest.approx(expected)
        np.testing.assert_allclose(centre, occurrence.place.point(np.array(middle)), atol=1e-9)


@pytest.mark.parametrize("asked", [{}, {"flank_only": "both"}])
@pytest.mark.sweep_cases("asked0")
def test_solids_from_other_processes_make_the_same_file(asked: dict[str, Any], tmp_path: Path) -> None:
    """The data of the file are the same but for the numbers of occurrences, which count on."""
    made = gears().cad("pinion" if asked else None, COARSE, **asked)
    again = pickle.loads(pickle.dumps(made))
    assert again.document() == made.document()
    texts = [one.save(tmp_path / "set.step").read_text().partition("DATA;")[2] for one in (made, again)]
    mine, theirs = (re.sub(r"OCCURRENCE\('\d+'", "OCCURRENCE('1'", text) for text in texts)
    assert theirs == mine
    assert again.face_names().faces == made.face_names().faces


def test_parts_that_occur_twice_are_one_part_in_other_processes() -> None:
    again = pickle.loads(pickle.dumps(cubes()))
    assert len(again.parts) == 2
    assert again.colours == cubes().colours


@needs_build123d
@pytest.mark.sweep
def test_build123d_reads_each_solid_with_its_colour_and_part_name(tmp_path: Path) -> None:
    made, file = cubes(), tmp_path / "set.step"
    write_step(made, file, "cubes")
    read = run(BUILD123D, file)
    assert [label for label, _ in read] == ["sun", "planet", "planet"]
    np.testing.assert_allclose([colour for _, colour in read], made.colours, atol=1e-6)
    assert len({tuple(colour) for _, colour in read}) == 2


@needs_build123d
@pytest.mark.sweep
def test_occurrences_keep_their_labels_through_files_of_build123d(tmp_path: Path) -> None:
    import build123d

    from gearmesh.cad.programs.shapes import build123d_shape

    made = build123d_shape(cubes())
    build123d.export_step(made, tmp_path / "set.step")
    read = build123d.import_step(tmp_path / "set.step")
    assert [part.label for part in read.children] == ["sun", "planet_1", "planet_2"]
    assert [part.volume for part in read.children] == pytest.approx([1.0, 8.0, 8.0])


@needs_freecad
@pytest.mark.sweep
def test_freecad_has_the_names_of_parts(tmp_path: Path) -> None:
    """Occurrences of one part are one link with as many elements, without names of their own."""
    file = tmp_path / "set.step"
    write_step(cubes(), file, "cubes")
    assert by_freecad(file)["features"].items() >= {"sun": 1, "planet": 1, "planet001": 2, "set": 3}.items()


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("member", "asked"),
    [("pinion", {"sector": 1}), pytest.param("gear", {"flank_only": "both", "teeth": 2}, marks=pytest.mark.sweep)],
)
def test_numbers_are_the_tags_of_gmsh(member: str, asked: dict[str, Any], tmp_path: Path) -> None:
    """Area and centre of each face; a sector's faces stand in the file in another order than they are named in."""
    made = gears().cad(member, COARSE, **asked)
    made.save(tmp_path / "part.step")
    read, rows = run(GMSH, tmp_path / "part.step")["faces"], made.face_names().faces
    assert [row.face for row in rows] == list(map(int, read))
    shapes = {face.name: face.shape for face in made.parts[0].faces}
    for row in rows:
        np.testing.assert_allclose(read[str(row.face)], measures(shapes[row.name]), rtol=1e-6, atol=1e-5)
    flanks = {row.name: (row.side, row.tooth) for row in rows if row.region == Region.FLANK_LEFT}
    assert flanks == {f"flank_left_{k}": ("left", k) for k in range(1, 2 if "sector" in asked else 3)}


def test_names_stand_beside_the_file(tmp_path: Path) -> None:
    step, table = tmp_path / "pinion.step", tmp_path / "names.csv"
    settings = [word for change in PAIR for word in ("--set", change)]
    asked = ["solid", str(SAMPLES / "helical.toml"), *settings, "--member", "pinion", "--flank-only", "right"]
    assert main([*asked, "--teeth", "2", "-o", str(step), "--names", str(table), "--tol", "0.05"]) == 0
    rows = list(csv.DictReader(table.read_text().splitlines()))
    assert rows == [
        {
            **{"face": str(k), "member": "pinion", "member_face": str(k), "name": f"flank_right_{k}"},
            **{"region": "flank_right", "side": "right", "tooth": str(k)},
        }
        for k in (1, 2)
    ]
    others = ("solid", SAMPLES / "helical.toml", "--member", "pinion", "--names", tmp_path / "names.txt", "-o")
    assert refused(*others, tmp_path / "a.step").endswith("its suffix must be .csv or .json")
    assert "--names" in refused(*others, tmp_path / "a.stl")


def test_a_lone_solid_has_a_colour_of_its_own(tmp_path: Path) -> None:
    """Readers with one colour a part took that of a face."""
    write_step(box("sun", 1.0), tmp_path / "one.step", "cube")
    read = run(GMSH, tmp_path / "one.step")
    np.testing.assert_allclose(np.array(read["colours"][0]) / 255.0, region_colours(1)[0], atol=0.01)
