"""Every format against one round-trip oracle and an independent reader; files whole or not at all."""

from __future__ import annotations

import errno
import json
import os
import re
import signal
import subprocess
import sys
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np
import pytest
from scipy.spatial import cKDTree

import gearmesh
from gearmesh import OutputError, Rigid, io
from gearmesh.io.rebuild import merge
from gearmesh.io.texts import quote
from gearmesh.mesh.triangles import TriangleMesh

pytestmark = pytest.mark.quick

EXACT = (".ply", ".vtp", ".vtu", ".vtm")
DECIMALS = (".obj", ".3mf")
SINGLE_PRECISION = (".stl", ".glb")
WITH_NORMALS = (".vtp", ".vtu", ".vtm")
SEVERAL = (".glb", ".obj", ".3mf", ".vtm")
# Seven decimals, rounded away from zero from 0.57 of the last on; three coordinates give sqrt(3) of that.
# Half a unit in the last place of float32 is 0.95e-6 mm between 16 and 32 mm; three coordinates give sqrt(3) of that.
TOLERANCE = {**dict.fromkeys(EXACT, 0.0), **dict.fromkeys(DECIMALS, 1e-7), **dict.fromkeys(SINGLE_PRECISION, 1.7e-6)}
# Names that XML must escape; the last region has no triangle and must not be lost either.
NAMES = ("flank_left", "fillet_left", 'land<a&"b">', "flank_right", "fillet_right", "ends", "empty")


def torus(name: str = "pinion", rings: int = 24, sides: int = 10) -> TriangleMesh:
    """Closed surface of Euler number 0, outer radius 27 mm, regions in six sectors, triangles out of region order."""
    i, j = np.divmod(np.arange(rings * sides), sides)
    a, b = 2 * np.pi * i / rings + 0.1, 2 * np.pi * j / sides + 0.2
    outward = np.stack((np.cos(b) * np.cos(a), np.cos(b) * np.sin(a), np.sin(b)), axis=-1)
    vertices = 3.0 * outward + 24.0 * np.stack((np.cos(a), np.sin(a), np.zeros_like(a)), axis=-1)

    def at(di: int, dj: int) -> np.ndarray:
        return (i + di) % rings * sides + (j + dj) % sides

    lower, upper = (
        np.stack((at(0, 0), second, third), -1) for second, third in ((at(1, 0), at(1, 1)), (at(1, 1), at(0, 1)))
    )
    regions = (6 * i // rings).astype(np.int32)
    return TriangleMesh(
        vertices, np.concatenate((lower, upper)), np.tile(regions, 2), NAMES, np.tile(outward, (2, 1)), name
    )


def assert_same(found: TriangleMesh, given: TriangleMesh, tolerance: float, regions: bool, normals: bool) -> None:
    """The oracle: the same closed surface up to the order of vertices and triangles.

    Vertices are paired one to one within `tolerance` (mm); oriented triangles, their region names and their normals
    must then be those of `given`.
    """
    distance, pair = cKDTree(given.vertices).query(found.vertices)
    assert distance.max() <= tolerance
    assert np.array_equal(np.sort(pair), np.arange(len(given.vertices)))
    (here, here_order), (there, there_order) = _canonical(pair[found.triangles]), _canonical(given.triangles)
    assert np.array_equal(here, there)
    if regions:
        assert found.region_names == given.region_names
        assert np.array_equal(found.regions[here_order], given.regions[there_order])
    if normals:
        assert np.array_equal(found.normals[here_order], given.normals[there_order])


def _canonical(triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Triangles turned to begin at their smallest vertex, sorted, and the order that sorts them."""
    turned = np.take_along_axis(triangles, (triangles.argmin(axis=1)[:, None] + np.arange(3)) % 3, axis=1)
    order = np.lexsort(turned.T[::-1])
    return turned[order], order


@pytest.mark.parametrize("suffix", sorted(io.formats()))
def test_round_trip(tmp_path: Path, suffix: str) -> None:
    mesh, path = torus(), tmp_path / f"pinion{suffix.upper()}"
    io.write(mesh, path)
    found = io.read(path)
    assert_same(found, mesh, TOLERANCE[suffix], regions=suffix != ".stl", normals=suffix in WITH_NORMALS)
    assert found.name == "pinion"
    assert found.triangles.dtype == np.int64
    # Normals that the file does not carry are those of the facets, so the divergence theorem holds for them.
    area = np.linalg.norm(np.cross(*np.moveaxis(np.diff(found.corners(), axis=1), 1, 0)), axis=1) / 2.0
    if suffix not in WITH_NORMALS:
        flux = np.einsum("tk,tk,t->", found.normals, found.vertices[found.triangles[:, 0]], area)
        assert flux / 3.0 == pytest.approx(mesh.volume(), rel=1e-6)


def pair() -> dict[str, TriangleMesh]:
    """Two bodies as they may stand in mesh: beside each other, one on an axis of its own."""
    placed = Rigid.about_z(0.1).rotation @ np.array([[1.0, 0.0, 0.0], [0.0, 0.6, -0.8], [0.0, 0.8, 0.6]])
    return {"pinion": torus(), "gear": torus("gear", 30, 8).move(Rigid(placed, np.array([60.0, 0.0, 0.5])))}


@pytest.mark.parametrize("suffix", SEVERAL)
def test_several_meshes_in_one_file(tmp_path: Path, suffix: str) -> None:
    scene = pair()
    assert suffix in io.formats(several=True)
    io.write_scene(scene, tmp_path / f"pair{suffix}")
    found = io.read_scene(tmp_path / f"pair{suffix}")
    assert list(found) == ["pinion", "gear"]
    for name, mesh in scene.items():
        # Out to 87 mm a float32 is good to 3.8e-6 mm a coordinate.
        assert_same(found[name], mesh, 4 * TOLERANCE[suffix], regions=True, normals=suffix == ".vtm")
    with pytest.raises(OutputError, match="pinion, gear"):
        io.read(tmp_path / f"pair{suffix}")


@pytest.mark.parametrize("suffix", [".3mf", ".glb", ".obj"])
def test_trimesh_finds_several_meshes_in_place(tmp_path: Path, suffix: str) -> None:
    """Meshes that trimesh reads have their names, and each is a closed body in its place. A GLB file is in metres and has a
    geometry for each region."""
    import trimesh

    io.write_scene(pair(), tmp_path / f"pair{suffix}")
    options = {"split_objects": True} if suffix == ".obj" else {}
    loaded = trimesh.load_scene(tmp_path / f"pair{suffix}", process=False, **options)
    assert loaded.units == {".3mf": "millimeter", ".glb": "meters", ".obj": None}[suffix]
    parts: dict[str, list[Any]] = {"pinion": [], "gear": []}
    for node in loaded.graph.nodes_geometry:
        transform, geometry = loaded.graph[node]
        parts[re.sub(r"_\d+$", "", geometry)].append(loaded.geometry[geometry].copy().apply_transform(transform))
    for name, mesh in pair().items():
        found = trimesh.util.concatenate(parts[name])
        found.apply_scale(1000.0 if suffix == ".glb" else 1.0)
        found.merge_vertices(merge_tex=True, merge_norm=True, digits_vertex=5)
        assert found.is_volume
        assert found.volume == pytest.approx(mesh.volume(), rel=1e-6)
        bounds = [mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)]
        np.testing.assert_allclose(found.bounds, bounds, rtol=0, atol=4 * 1.7e-6 if suffix == ".glb" else 1e-5)


@pytest.mark.parametrize(
    "text", ["plain", "a & b < c > d", 'say "so"', "it's", """both ' and " """, "tab\tline\nend\r"]
)
def test_attributes_are_quoted_as_by_the_library(text: str) -> None:
    assert quote(text) == quoteattr(text)


def test_several_meshes_refused_where_one_fits(tmp_path: Path) -> None:
    for suffix in sorted(set(io.formats()) - set(SEVERAL)):
        with pytest.raises(OutputError, match=r"one mesh, not 2; several go into .*\.vtm"):
            io.write_scene({"pinion": torus(), "gear": torus("gear")}, tmp_path / f"pair{suffix}")
    assert not list(tmp_path.iterdir())


# --- independent readers ---------------------------------------------------------------------------------------------


def through_trimesh(path: Path) -> TriangleMesh:
    """Return the mesh as trimesh reads it, in mm; geometries of a scene are the regions, joined again by equal coordinates."""
    import trimesh

    # The options leave the order and the number of vertices as they are in the file.
    loaded = trimesh.load_scene(path, process=False, split_groups=True, maintain_order=True)
    parts = list(loaded.geometry.items())
    corners = np.concatenate([part.triangles for _, part in parts])
    names = [name.removeprefix("pinion_") for name, _ in parts]
    if path.suffix == ".glb":
        corners, names = corners * 1000.0, [part.visual.material.name for _, part in parts]
    if path.suffix == ".ply":
        counts = re.findall(rb"^comment region \d+ (\d+) ", path.read_bytes(), re.MULTILINE)
        labels = np.repeat(np.arange(len(counts)), [*map(int, counts)])
    else:
        order = [NAMES.index(name) if name in NAMES else 0 for name in names]
        labels = np.repeat(order, [len(part.faces) for _, part in parts])
    vertices, place = merge(corners.reshape(-1, 3))
    return TriangleMesh(vertices, place.reshape(-1, 3), labels, NAMES, corners[:, 0])


@pytest.mark.parametrize("suffix", [".stl", ".ply", ".obj", ".3mf", ".glb"])
def test_trimesh_reads_the_same(tmp_path: Path, suffix: str) -> None:
    mesh, path = torus(), tmp_path / f"pinion{suffix}"
    io.write(mesh, path)
    found = through_trimesh(path)
    assert_same(found, mesh, TOLERANCE[suffix], regions=suffix in (".ply", ".obj", ".glb"), normals=False)


@pytest.mark.parametrize("suffix", [".vtp", ".vtu"])
def test_pyvista_reads_the_same(tmp_path: Path, suffix: str) -> None:
    import pyvista

    mesh, path = torus(), tmp_path / f"pinion{suffix}"
    io.write(mesh, path)
    data = pyvista.read(path)
    surface = data if suffix == ".vtp" else data.extract_surface(algorithm=None)
    assert surface.is_manifold
    assert np.array_equal(data.points, mesh.vertices)
    assert np.array_equal(data.cell_data["region"], mesh.regions)
    assert np.array_equal(data.cell_data["Normals"], mesh.normals)
    assert {name: int(data.field_data[name][0]) for name in data.field_data} == {
        name: i for i, name in enumerate(NAMES)
    }


def test_meshio_and_pyvista_read_the_same_ply(tmp_path: Path) -> None:
    import meshio
    import pyvista

    mesh, path = torus(), tmp_path / "pinion.ply"
    io.write(mesh, path)
    (cells,), points = (data := meshio.read(path)).cells, data.points
    assert_same(replace(mesh, vertices=points, triangles=cells.data), mesh, 0.0, regions=False, normals=False)
    surface = pyvista.read(path)
    assert surface.is_manifold
    # VTK holds coordinates of a PLY as float32
    faces = surface.regular_faces
    assert_same(replace(mesh, vertices=surface.points, triangles=faces), mesh, 1.7e-6, regions=False, normals=False)


def test_meshio_reads_the_same_vtu(tmp_path: Path) -> None:
    import meshio

    mesh, path = torus(), tmp_path / "pinion.vtu"
    io.write(mesh, path)
    data = meshio.read(path)
    found = TriangleMesh(
        data.points, data.cells_dict["triangle"], data.cell_data["region"][0], NAMES, data.cell_data["Normals"][0]
    )
    assert_same(found, mesh, 0.0, regions=True, normals=True)


def test_vtm_has_a_block_for_each_region(tmp_path: Path) -> None:
    import pyvista

    mesh = torus()
    io.write(mesh, tmp_path / "pinion.vtm")
    blocks: Any = pyvista.read(tmp_path / "pinion.vtm")
    assert blocks.keys() == list(NAMES[:-1])
    assert [block.n_cells for block in blocks] == np.bincount(mesh.regions).tolist()
    io.write_scene({"pinion": mesh, "gear <2>": mesh}, tmp_path / "pair.vtm")
    pair: Any = pyvista.read(tmp_path / "pair.vtm")
    assert pair.keys() == ["pinion", "gear <2>"]
    assert pair[1].keys() == list(NAMES[:-1])


# --- what users of a format rely on ----------------------------------------------------------------------------------


def test_stl_is_binary_with_facet_normals(tmp_path: Path) -> None:
    mesh = replace(torus(), name="solid gear")
    io.write(mesh, tmp_path / "gear.stl")
    data = (tmp_path / "gear.stl").read_bytes()
    assert data[:80].rstrip() == f"gearmesh {gearmesh.__version__} mm, own frame of body gear".encode()
    facets = np.frombuffer(data, np.dtype([("f", "<f4", (4, 3)), ("attribute", "<u2")]), offset=84)["f"]
    edges = mesh.corners()[:, 1:] - mesh.corners()[:, :1]
    normal = np.cross(edges[:, 0], edges[:, 1])
    # of the corners as they are in the file: an edge of 2 mm turns by 1e-6 when its ends are rounded
    assert np.allclose(facets[:, 0], normal / np.linalg.norm(normal, axis=1)[:, None], atol=2e-6)
    corners = facets[:, 1:].astype(float)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    assert np.allclose(facets[:, 0], normal / np.linalg.norm(normal, axis=1)[:, None], atol=1e-7)
    for name, header in (
        ("ß" * 80, "mm, ?"),
        ("SOLID", "mm, BODY in the common"),
        ("pinion", "mm, pinion in the common"),
    ):
        moved = replace(mesh, name=name).move(Rigid.about_z(0.1))
        io.write(moved, tmp_path / "gear.stl")
        data = (tmp_path / "gear.stl").read_bytes()
        assert header.lower() in data[:80].decode().lower()
        assert len(data) == 84 + 50 * len(mesh.triangles)


def test_facet_without_area_gets_no_nan(tmp_path: Path) -> None:
    mesh = torus()
    flat = replace(
        mesh,
        triangles=np.append(mesh.triangles, [[0, 0, 1]], axis=0),
        regions=np.append(mesh.regions, 6),
        normals=np.append(mesh.normals, [[0.0, 0.0, 1.0]], axis=0),
    )
    io.write(flat, tmp_path / "flat.ply")
    assert np.array_equal(io.read(tmp_path / "flat.ply").normals[-1], np.zeros(3))
    # joined corners make an edge of four facets of it
    io.write(flat, tmp_path / "flat.stl")
    assert len(io.read(tmp_path / "flat.stl").triangles) == len(mesh.triangles)


def test_3mf_says_millimetre_and_colours_regions(tmp_path: Path) -> None:
    io.write(torus(), tmp_path / "gear.3mf")
    with zipfile.ZipFile(tmp_path / "gear.3mf") as archive:
        model = archive.read("3D/3dmodel.model").decode()
        assert {"[Content_Types].xml", "_rels/.rels"} < set(archive.namelist())
    assert 'unit="millimeter"' in model
    colours = {line.split("displaycolor=")[1] for line in model.splitlines() if line.startswith("<base ")}
    assert len(colours) == len(NAMES)


def test_glb_has_a_differently_coloured_primitive_for_each_region(tmp_path: Path) -> None:
    io.write(torus(), tmp_path / "gear.glb")
    data = (tmp_path / "gear.glb").read_bytes()
    document = json.loads(data[20 : 20 + int.from_bytes(data[12:16], "little")])
    primitives = document["meshes"][0]["primitives"]
    colours = [document["materials"][p["material"]]["pbrMetallicRoughness"]["baseColorFactor"] for p in primitives]
    assert len(primitives) == len(NAMES) - 1
    assert min(np.abs(np.subtract(a, b)).max() for i, a in enumerate(colours) for b in colours[:i]) > 0.1
    # Metres: the outer radius is 27 mm.
    assert 0.026 < max(document["accessors"][0]["max"]) < 0.0271


def test_a_plain_foreign_surface_can_be_read(tmp_path: Path) -> None:
    import trimesh

    box = trimesh.creation.box((1.0, 2.0, 3.0))
    for suffix in (".stl", ".ply", ".obj"):
        box.export(tmp_path / f"box{suffix}")
    for path in sorted(tmp_path.iterdir()):
        found = io.read(path)
        assert found.region_names == ("surface",), path.name
        assert found.volume() == pytest.approx(6.0, abs=1e-6)
        assert len(found.vertices) == 8


# --- refusals --------------------------------------------------------------------------------------------------------


def test_unknown_suffix_names_what_is_allowed(tmp_path: Path) -> None:
    for name, found in (("gear.step", "unknown suffix .step"), ("gear", "no suffix")):
        with pytest.raises(OutputError, match=found) as caught:
            io.write(torus(), tmp_path / name)
        assert all(suffix in str(caught.value) for suffix in io.formats())
        assert "\n" not in str(caught.value)
        assert caught.value.exit_status == 2


def test_a_mesh_without_triangles_is_refused(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match="pinion has no triangles"):
        io.write(torus().only("empty"), tmp_path / "gear.glb")
    with pytest.raises(OutputError, match="no mesh"):
        io.write_scene({}, tmp_path / "gear.glb")


@pytest.mark.parametrize("suffix", sorted(io.formats()))
def test_damaged_file_is_one_line(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"gear{suffix}"
    with pytest.raises(OutputError, match="No such file"):
        io.read(path)
    io.write(torus(), path)
    whole = path.read_bytes()
    for damaged in (whole[: len(whole) // 3 * 2], whole[:-50], b"\xff" * 200, b""):
        path.write_bytes(damaged)
        if suffix == ".obj" and damaged and damaged in whole:
            continue  # text without a length or an end mark
        with pytest.raises(OutputError, match=f"cannot read .*gear{suffix}: not a usable") as caught:
            io.read(path)
        assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("faces", "reason"),
    [
        ("", "no triangles"),
        ("f 1 2 3 4\nf 1 2 3 4\nf 1 2 3 4\n", "not a triangle"),
        ("f -1 -2 -3\n", "from the end"),
        ("f 1 2 9\n", "a vertex that is not there|index 8"),
        ("f 1 2 3\no gear\nf 1 2 3\no gear\nf 1 2 3\n", "two meshes are named gear"),
    ],
)
def test_obj_that_is_not_understood(tmp_path: Path, faces: str, reason: str) -> None:
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n" + faces)
    with pytest.raises(OutputError, match=reason):
        io.read(tmp_path / "a.obj")


def test_obj_faces_before_the_first_name_are_kept(tmp_path: Path) -> None:
    text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\ng land\nf 3/1 2//4 1/2/3\no gear\nf 1 2 3\n"
    (tmp_path / "a.obj").write_text(text)
    found = io.read_scene(tmp_path / "a.obj")
    assert {name: mesh.region_names for name, mesh in found.items()} == {"a": ("surface", "land"), "gear": ("surface",)}
    assert found["a"].triangles.tolist() == [[0, 1, 2], [2, 1, 0]]
    assert found["a"].regions.tolist() == [0, 1]


# --- whole or not at all ---------------------------------------------------------------------------------------------


class SmallFiles:
    """Context in which no file may grow beyond `limit` bytes: a write fails midway, as on a full disk."""

    def __init__(self, limit: int) -> None:
        self.resource = pytest.importorskip("resource")
        self.limit = limit

    def __enter__(self) -> None:
        self.handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        self.before = self.resource.getrlimit(self.resource.RLIMIT_FSIZE)
        self.resource.setrlimit(self.resource.RLIMIT_FSIZE, (self.limit, self.before[1]))

    def __exit__(self, *_: object) -> None:
        self.resource.setrlimit(self.resource.RLIMIT_FSIZE, self.before)
        signal.signal(signal.SIGXFSZ, self.handler)


def contents(folder: Path) -> dict[str, bytes]:
    return {str(file.relative_to(folder)): file.read_bytes() for file in sorted(folder.rglob("*")) if file.is_file()}


@pytest.mark.parametrize("suffix", sorted(io.formats()))
def test_failed_write_leaves_everything_as_it_was(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"gear{suffix}"
    for existing in (False, True):
        before = contents(tmp_path)
        with (
            SmallFiles(2000),
            pytest.raises(OutputError, match=rf"cannot write .*gear({suffix}|_pieces): File too large"),
        ):
            io.write(torus("gear"), path)
        assert contents(tmp_path) == before
        assert existing or not list(tmp_path.iterdir())
        io.write(torus("gear", 12, 6), path)


def test_rewritten_vtm_keeps_no_stale_piece_and_spares_other_folders(tmp_path: Path) -> None:
    path = tmp_path / "gear.vtm"
    io.write(torus(), path)
    io.write(torus().only("ends", "flank_left"), path)
    assert len(list((tmp_path / "gear_pieces").iterdir())) == 2
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["gear.vtm", "gear_pieces"]
    (tmp_path / "gear_pieces" / "notes.txt").write_text("mine")
    before = contents(tmp_path)
    with pytest.raises(OutputError, match="holds other files"):
        io.write(torus(), path)
    assert contents(tmp_path) == before


def test_folder_comes_back_if_the_exchange_fails(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path, rename = tmp_path / "gear.vtm", os.rename
    io.write(torus(), path)
    before = contents(tmp_path)

    def second_fails(source: os.PathLike[str], target: os.PathLike[str]) -> None:
        if Path(target).name == "gear_pieces" and not Path(source, "marker").exists() and len(calls) == 1:
            calls.append("failed")
            raise OSError(errno.EIO, os.strerror(errno.EIO))
        calls.append("done")
        rename(source, target)

    calls: list[str] = []
    monkeypatch.setattr(os, "rename", second_fails)
    with pytest.raises(OutputError, match="Input/output error"):
        io.write(torus("gear", 12, 6), path)
    assert calls == ["done", "failed", "done"]
    assert contents(tmp_path) == before
    assert len(list(tmp_path.iterdir())) == 2


@pytest.mark.parametrize(
    "failure", [OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)), ValueError("bad"), KeyboardInterrupt()]
)
def test_whole_file_survives_any_failure(tmp_path: Path, failure: BaseException) -> None:
    path = tmp_path / "report.json"
    io.whole_text(path, "old")

    def half_written() -> None:
        with io.whole_file(path) as temporary:
            assert temporary.suffix == ".json"
            assert temporary.parent == tmp_path
            temporary.write_text("half")
            raise failure

    expected = OutputError if isinstance(failure, OSError) else type(failure)
    with pytest.raises(expected) as caught:
        half_written()
    if expected is OutputError:
        assert str(caught.value) == f"cannot write {path}: No space left on device"
    assert contents(tmp_path) == {"report.json": b"old"}


def test_whole_file_says_why(tmp_path: Path) -> None:
    (tmp_path / "plain").write_text("x")
    (tmp_path / "folder.csv").mkdir()
    os.mkfifo(tmp_path / "pipe.csv")
    before = sorted(tmp_path.rglob("*"))
    for path, reason in (
        (tmp_path / "missing" / "a.csv", f"the folder {tmp_path / 'missing'} does not exist"),
        (tmp_path / "plain" / "a.csv", "Not a directory"),
        (tmp_path / "folder.csv", "it is a folder"),
        (tmp_path / "pipe.csv", "it is not a regular file"),
        (tmp_path / ("a" * 300 + ".csv"), "File name too long"),
    ):
        with pytest.raises(OutputError) as caught:
            io.whole_text(path, "text")
        assert str(caught.value) == f"cannot write {path}: {reason}"
    with pytest.raises(OutputError, match="produced nothing"), io.whole_file(tmp_path / "silent.csv"):
        pass
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_unwritable_folder(tmp_path: Path) -> None:
    tmp_path.chmod(0o500)
    with pytest.raises(OutputError, match="Permission denied"):
        io.whole_text(tmp_path / "a.csv", "text")


def test_whole_file_has_usual_permissions_and_follows_links(tmp_path: Path) -> None:
    (tmp_path / "usual").write_text("x")
    (tmp_path / "real.txt").write_text("old")
    (tmp_path / "link.txt").symlink_to("real.txt")
    io.whole_text(tmp_path / "link.txt", "new é\n")
    assert (tmp_path / "link.txt").is_symlink()
    assert (tmp_path / "real.txt").read_bytes() == "new é\n".encode()
    assert (tmp_path / "real.txt").stat().st_mode == (tmp_path / "usual").stat().st_mode


def test_writing_loads_no_mesh_library_and_needs_no_display(tmp_path: Path) -> None:
    io.write(torus(), tmp_path / "in.ply")
    program = """
import sys
from gearmesh import io
mesh = io.read("in.ply")
for suffix in io.formats():
    io.write(mesh, "out" + suffix)
print(sorted({"trimesh", "meshio", "pyvista", "vtk", "vtkmodules", "lxml", "matplotlib"} & set(sys.modules)))
print(len(io.read("out.vtm").triangles))
"""
    environment = {key: os.environ[key] for key in ("PATH", "PYTHONPATH") if key in os.environ}
    command = [sys.executable, "-c", program]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=True)
    assert done.stdout.split("\n")[:2] == ["[]", str(len(torus().triangles))]
