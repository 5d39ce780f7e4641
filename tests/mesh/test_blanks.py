"""Blanks before the teeth are cut: volume by Pappus, the finished gear inside, files as other programs read them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from ezdxf.filemanagement import readfile
from ezdxf.math import Vec2
from ezdxf.path import make_path
from oracles.built import built_sample
from oracles.cad_readers import by_opencascade
from oracles.command_line import refused, run
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.formats import DXF_VERSION_WITHOUT_SPLINES, DXF_VERSIONS
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.plane.curves import PlaneLine
from gearmesh.kinds import Region

#: mm
TOLERANCE = 0.02
#: sample, member, changes: keyway and holes that are not turned, shafts and steps, a groove, a ring, a throat, cones, a bar
MEMBERS = {
    "keyed": (
        "helical",
        "gear",
        ("gear.keyway={width=14, depth=3.8}", "gear.holes={count=6, diameter=14, circle=130}"),
    ),
    "throated": ("worm_drive", "wheel", ()),
    "ring": ("internal", "gear", ("gear.tip_chamfer=0.1",)),
    "face": ("face_gear_conjugate", "gear", ()),
    "bar": ("rack", "rack", ()),
    "grooved": ("double_helical", "gear", ()),
    "shaft": ("helical_hub", "pinion", ()),
    "hub": ("helical_hub", "gear", ()),
    "bevel": ("spiral_bevel_formate", "gear", ("gear.end_chamfer=0.3",)),
    "worm": ("worm_drive", "worm", ()),
    "beveloid": ("beveloid_intersected", "pinion", ()),
    "novikov": ("novikov", "pinion", ()),
}


#: radius of the throat of the wheel, mm
THROAT = 25.0

SWEPT = pytest.mark.sweep_cases("throated", "face", "hub", "bevel", "worm", "beveloid", "novikov")


def gears_of(case: str) -> tuple[gm.Gears, str]:
    sample, member, changes = MEMBERS[case]
    return built_sample(sample, *changes), member


def outline(gears: gm.Gears, member: str) -> Array:
    """Points (N, 2), z and rho, all along the half section."""
    (contour,) = gears.section(member, blank=True).loops
    counts = [1 if isinstance(curve, PlaneLine) else 400 for curve in contour.curves]
    curves = zip(contour.curves, counts, strict=True)
    return np.concatenate([curve.at(np.linspace(0.0, 1.0, count, endpoint=False)) for curve, count in curves])


def outside(points: Array, polygon: Array) -> Array:
    """Distances (N,), mm, of points (N, 2) that are outside of a polygon (M, 2); 0 inside."""
    a, b = polygon, np.roll(polygon, -1, axis=0)
    way = b - a
    share = ((points[:, None] - a) * way).sum(axis=-1) / (way * way).sum(axis=-1)
    away = np.linalg.norm(points[:, None] - a - np.clip(share, 0.0, 1.0)[..., None] * way, axis=-1).min(axis=1)
    x, y = points[:, None, 0], points[:, None, 1]
    over = (a[:, 1] > y) != (b[:, 1] > y)
    with np.errstate(invalid="ignore", divide="ignore"):
        crossed = over & (x < a[:, 0] + (y - a[:, 1]) * way[:, 0] / way[:, 1])
    return np.where(crossed.sum(axis=1) % 2 == 1, 0.0, away)


@SWEPT
@pytest.mark.parametrize("case", MEMBERS)
@pytest.mark.sweep_cases("keyed", "ring")
def test_blank_holds_the_finished_gear_and_has_the_volume_of_pappus(case: str) -> None:
    gears, member = gears_of(case)
    blank, finished = (gears.solid(member, TOLERANCE, blank=cut) for cut in (True, False))
    assert blank.measured.watertight
    assert blank.measured.volume is not None
    assert finished.measured.volume is not None
    if case == "bar":
        cut = finished.to_manifold() - blank.to_manifold()
        assert cut.volume() < 1e-6
    else:
        half = outline(gears, member)
        z, rho = half.T
        after = np.roll(half, -1, axis=0)
        areas = 0.5 * (z * after[:, 1] - after[:, 0] * rho)
        # the path of the centroid of every triangle between the origin and a chord
        volume = 2.0 * np.pi * float(areas @ (rho + after[:, 1]) / 3.0)
        # chords of circles take less than the tolerance from the radius
        assert 0.0 < volume - blank.measured.volume < TOLERANCE * blank.to_trimesh().area
        points = finished.mesh.vertices[:: max(1, len(finished.mesh.vertices) // 2000)]
        points = np.stack((points[:, 2], np.hypot(points[:, 0], points[:, 1])), axis=-1)
        # where a hole is cut through chords of circles, its edge is between the circles
        assert outside(points, half).max() < (TOLERANCE if gears.members[member].features.is_cut else 1e-4)
        assert outside(points[:1] + np.array([0.0, 1e3]), half)[0] > 900.0
    # the spaces between the teeth are half of the ring of the teeth, about; holes are cut with them
    tooth = gears.members[member].tooth
    ring = blank.measured.volume - finished.measured.volume
    width = abs(tooth.blank.faces[1] - tooth.blank.faces[0]) * len(gears.members[member].halves)
    length = float(tooth.joint.arm(tooth.grid(Region.LAND, [0.5], tooth.sections([0.5])).points).mean())
    around = 2.0 * np.pi * length if case != "bar" else 200.0
    assert 0.3 < ring / (around * width * tooth.height) < (1.2 if gears.members[member].features.is_cut else 0.8)


@SWEPT
@pytest.mark.parametrize("case", MEMBERS)
def test_step_file_of_a_blank_has_exact_volume_and_named_faces(case: str, tmp_path: Path) -> None:
    gears, member = gears_of(case)
    made = gears.cad(member, blank=True)
    file = made.save(tmp_path / "blank.step")
    (figures,) = made.figures.values()
    assert abs(figures["volume_error"]) < 1e-8
    ((volume, *_),) = by_opencascade(file)
    assert volume == pytest.approx(figures["volume_mm3"], rel=1e-6)
    text = file.read_text()
    assert f"{member}_blank" in text
    assert "'land_1'" in text
    assert "keyway" not in text
    # a region has the area and the height of the same region of the mesh
    mesh = gears.solid(member, TOLERANCE, blank=True).to_trimesh()
    regions = gears.solid(member, TOLERANCE, blank=True).mesh
    for region in {face.region for face in made.parts[0].faces}:
        shapes = [face.shape for face in made.parts[0].faces if face.region == region]
        own = regions.regions == regions.region_names.index(Region(region))
        areas, heights = zip(*(surface(shape) for shape in shapes), strict=True)
        assert sum(areas) == pytest.approx(mesh.area_faces[own].sum(), rel=2e-3)
        height = np.dot(mesh.area_faces[own], mesh.triangles_center[own, 2]) / mesh.area_faces[own].sum()
        assert np.dot(areas, heights) / sum(areas) == pytest.approx(height, abs=TOLERANCE)


def surface(shape: Any) -> tuple[float, float]:
    """Area of a face, mm2, and z of its centre of mass, mm."""
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    found = GProp_GProps()
    BRepGProp.SurfaceProperties_s(shape, found)
    return found.Mass(), found.CentreOfMass().Z()


@SWEPT
@pytest.mark.parametrize("case", MEMBERS)
def test_dxf_file_of_a_blank_is_its_half_section_with_the_axis(case: str, tmp_path: Path) -> None:
    gears, member = gears_of(case)
    file = gears.section(member, blank=True).save(tmp_path / "blank.dxf")
    document = readfile(file)
    assert not document.audit().has_errors
    space = document.modelspace()
    axis = space.query(f'LINE[layer=="{member}_axis"]')
    assert {entity.dxf.layer for entity in space} == {f"{member}_blank", *(entity.dxf.layer for entity in axis)}
    assert len(axis) == (case != "bar")
    for line in axis:
        assert (line.dxf.start.y, line.dxf.end.y) == (0.0, 0.0)
        assert document.layers.get(line.dxf.layer).dxf.linetype == "CENTER"
        assert line.dxf.start.x < outline(gears, member)[:, 0].min() < line.dxf.end.x
    # the throat, and nothing else, is an arc
    assert [arc.dxf.radius for arc in space.query("ARC")] == ([pytest.approx(THROAT)] if case == "throated" else [])


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ("--member all -o parts/ --phi1 3", "--phi1 = 3: must be left out for a folder"),
        ("--member pinion -o a.svg --dxf R12", "--dxf = R12: must be left out for .svg"),
        ("--member pinion -o a.dxf --dxf R13", "--dxf = R13: must be one of R12, R2000"),
        ("--member pinion -o a.dxf --dxf R12 --curves splines", "--curves = splines: DXF R12 has no splines"),
        ("--member all -o a.3mf", "--blank = true: must be left out for --member = all"),
        ("--member pinion -o a.stl --teeth 2", "--teeth = 2: must be left out with --blank"),
        ("--member pinion -o a.step --offset 0.1", "--offset = 0.1: must be left out with --blank"),
        ("--member pinion -o a.dxf --section 3", "--section = 3: must be left out with --blank"),
    ],
)
def test_what_a_blank_has_not_is_refused(options: str, said: str) -> None:
    assert refused("solid", SAMPLES / "spur.toml", "--blank", *options.split()).startswith(said)


@pytest.mark.parametrize("version", DXF_VERSIONS)
def test_dxf_of_every_version_is_read_with_the_same_area(version: str, tmp_path: Path) -> None:
    curves = "arcs" if version == DXF_VERSION_WITHOUT_SPLINES else "splines"
    section = built_sample("spur").section("pinion", curves=curves, tolerance="1um", dxf=version)
    document = readfile(section.save(tmp_path / "pinion.dxf"))
    assert not document.audit().has_errors
    assert document.acad_release == version
    # the curves as they are read, in the plane
    points = [Vec2(point) for entity in document.modelspace() for point in make_path(entity).flattening(1e-4)]
    largest = max(point.magnitude for point in points)
    assert largest == pytest.approx(float(built_sample("spur").members["pinion"].tooth.blank.tip.at(0.0)), abs=1e-3)
    kinds = {entity.dxftype() for entity in document.modelspace()}
    assert kinds == ({"POLYLINE", "CIRCLE"} if curves == "arcs" else {"ARC", "SPLINE", "CIRCLE"})


def test_a_folder_gets_an_stl_file_of_every_member(tmp_path: Path) -> None:
    import trimesh

    folder = tmp_path / "new" / "parts"
    status, out, _ = run("solid", SAMPLES / "spur.toml", "--member", "all", "-o", folder, "--tol", "0.05")
    assert status == 0
    assert sorted(file.name for file in folder.iterdir()) == ["gear.stl", "pinion.stl"]
    for name in ("pinion", "gear"):
        assert name in out
        mesh = trimesh.load_mesh(folder / f"{name}.stl")
        assert mesh.is_watertight
        # in its own frame
        assert np.abs(mesh.bounds.sum(axis=0)[:2]).max() < 0.5


def test_output_pins_have_files_in_the_folder(tmp_path: Path) -> None:
    """Bodies without teeth are parts to make as well; none of them is a blank."""
    import trimesh

    pins = [f"output_pin_{k}" for k in range(1, 7)]
    design = SAMPLES / "cycloidal.toml"
    assert run("solid", design, "--member", "all", "-o", tmp_path / "parts", "--tol", "5um")[0] == 0
    assert sorted(file.stem for file in (tmp_path / "parts").iterdir()) == ["disc", *pins, "ring"]
    mesh = trimesh.load_mesh(tmp_path / "parts" / "output_pin_3.stl")
    assert mesh.is_watertight
    # 8 mm thick, a quarter of the face width of 12 mm beyond both sides
    assert mesh.bounds == pytest.approx(np.array([[-4.0, -4.0, -9.0], [4.0, 4.0, 9.0]]), abs=0.006)
    assert run("solid", design, "--member", "all", "--blank", "-o", tmp_path / "blanks")[0] == 0
    assert sorted(file.stem for file in (tmp_path / "blanks").iterdir()) == ["disc", "ring"]
    status, _, error = run("solid", design, "--member", "output_pin_3", "--teeth", "2", "-o", tmp_path / "a.stl")
    assert status == 2
    assert "--teeth = 2: must be left out for --member = output_pin_3, which is always made whole" in error
