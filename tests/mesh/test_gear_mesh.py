"""Gears that repeat their teeth: pieces against arrays of the whole, files of both, and what one pitch proves."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import Member, Rigid, io
from gearmesh.answers.bodies import solid as solids
from gearmesh.mesh.gear_mesh import GearMesh
from gearmesh.mesh.pitch import Pitch
from gearmesh.mesh.solid import BEYOND_SECTOR, gear_facets, prove, prove_pitch
from gearmesh.mesh.triangles import Facets

#: members with all that a gear between two ends may have; worms have fewer teeth than one pitch stands for
CASES = {
    "chamfered": ("helical", "pinion", ["pinion.end_chamfer=0.5"]),
    "on its axis": ("helical", "pinion", ["pinion.bore=0"]),
    "double helical": ("double_helical", "pinion", []),
    "bevel": ("spiral_bevel_basic", "pinion", []),
    "internal": ("internal", "gear", []),
    "worm": ("worm_drive", "worm", []),
    "one thread on its axis": ("worm_drive", "worm", ["worm.threads=1", "worm.bore=0"]),
}
TOLERANCE = 0.05


@cache
def member_of(case: str) -> Member:
    sample, name, keys = CASES[case]
    member = gm.build(gm.load(SAMPLES / f"{sample}.toml", keys)).members[name]
    return replace(member, features=member.features.uncut)


@cache
def mesh_of(case: str) -> GearMesh:
    mesh = gear_facets(member_of(case), TOLERANCE)
    assert isinstance(mesh, GearMesh)
    return mesh


@cache
def with_other_tooth() -> GearMesh:
    member = member_of("chamfered")
    again = replace(member.tooth)
    mesh = gear_facets(member.with_teeth({3: again, 7: again}), TOLERANCE)
    assert isinstance(mesh, GearMesh)
    assert len(mesh.ring.kinds) == 2
    return mesh


def pieces_are_whole(mesh: Facets) -> None:
    whole, labels = mesh.whole(), range(len(mesh.region_names))
    assert (mesh.vertex_count, mesh.triangle_count) == (len(whole.vertices), len(whole.triangles))
    np.testing.assert_array_equal(np.concatenate(list(mesh.vertex_pieces())), whole.vertices)
    np.testing.assert_array_equal(np.concatenate(list(mesh.corner_pieces())), whole.corners())
    np.testing.assert_array_equal(np.concatenate(list(mesh.triangle_pieces())), whole.triangles)
    np.testing.assert_array_equal(np.concatenate(list(mesh.region_pieces())), whole.regions)
    for k in labels:
        here = whole.regions == k
        parts = [
            np.concatenate([*of([k]), np.zeros((0, *end))])
            for of, end in ((mesh.triangle_pieces, (3,)), (mesh.corner_pieces, (3, 3)))
        ]
        np.testing.assert_array_equal(parts[0], whole.triangles[here])
        np.testing.assert_array_equal(parts[1], whole.corners()[here])
    assert mesh.volume() == pytest.approx(whole.volume(), rel=1e-12)


@pytest.mark.parametrize("case", CASES)
@pytest.mark.sweep_cases("bevel", "chamfered", "internal")
def test_pieces_are_those_of_the_whole(case: str, monkeypatch: pytest.MonkeyPatch) -> None:
    # pieces of some teeth, and of one
    monkeypatch.setattr("gearmesh.mesh.gear_mesh.ROWS_PER_PIECE", 1000)
    place = Rigid(Rigid.about_z(0.3).rotation[:, [1, 2, 0]], np.array([3.0, -20.0, 0.1]))
    for mesh in (mesh_of(case), io.mesh_in_file(mesh_of(case).move(place), "a.stl")):
        pieces_are_whole(mesh)


def test_a_single_thread_without_a_bore_is_closed() -> None:
    member, mesh = member_of("one thread on its axis"), mesh_of("one thread on its axis")
    triangles = mesh.whole().triangles
    assert (triangles != np.roll(triangles, 1, axis=1)).all()
    assert prove(mesh, member.genus).ok


def test_pieces_of_teeth_that_differ() -> None:
    pieces_are_whole(with_other_tooth())
    assert Pitch.of(with_other_tooth()) is None
    assert prove(with_other_tooth(), 1).ok


@pytest.mark.parametrize("suffix", [".stl", ".obj", ".ply", ".3mf", ".glb", ".vtu"])
def test_files_have_the_same_bytes_piece_by_piece(suffix: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("gearmesh.mesh.gear_mesh.ROWS_PER_PIECE", 1000)
    files = [tmp_path / f"{name}{suffix}" for name in ("pieces", "whole")]
    for file, mesh in zip(files, (mesh_of("chamfered"), mesh_of("chamfered").whole()), strict=True):
        io.write(mesh, file)
    assert files[0].read_bytes() == files[1].read_bytes()


def test_solids_are_proved_and_written_without_arrays_of_all(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    gears = gm.build(gm.load(SAMPLES / "spur.toml"))

    def refuse(mesh: GearMesh) -> None:
        raise AssertionError("arrays of the whole gear")

    monkeypatch.setattr(GearMesh, "whole", refuse)
    for suffix in (".stl", ".obj", ".ply", ".3mf"):
        file = tmp_path / f"gear{suffix}"
        solid = gears.solid("gear", 0.05, file=file)
        assert solid.figures["watertight"]
        assert len(io.read(solid.save(file)).triangles) == solid.figures["triangles"]
    with pytest.raises(AssertionError, match="arrays of the whole"):
        gears.solid("gear", 0.05).save(tmp_path / "gear.vtu")


@pytest.mark.parametrize("case", [case for case in CASES if "worm_drive" not in CASES[case]])
def test_one_pitch_proves_what_all_of_them_do(case: str) -> None:
    mesh, genus = mesh_of(case), member_of(case).genus
    pitch = Pitch.of(mesh)
    assert pitch is not None
    found, whole = prove_pitch(mesh, pitch, genus), prove(mesh.whole(), genus)
    assert found.ok
    assert replace(found, volume=0.0) == replace(whole, volume=0.0)
    assert found.volume == pytest.approx(whole.volume, rel=1e-12)


def flipped(mesh: GearMesh) -> GearMesh:
    return with_tooth_triangle(mesh, 5, lambda corners: corners[::-1])


def on_no_next_tooth(mesh: GearMesh) -> GearMesh:
    """A corner on the cut that is a vertex of its own, which the next tooth does not have."""
    triangles, count = mesh.ring.kinds[0].triangles, len(mesh.ring.kinds[0].vertices)
    k = int(np.flatnonzero((triangles >= count).any(axis=1))[0])
    tooth = mesh.ring.kinds[0]
    at = int(np.argmax(triangles[k] >= count))
    torn = replace(
        tooth,
        vertices=np.concatenate((tooth.vertices, tooth.vertices[:1])),
        triangles=np.where(triangles >= count, triangles + 1, triangles),
    )
    torn.triangles[k, at] = count
    numbers = (np.append(tooth.numbers[0], count), *tooth.numbers[1:])
    ring = replace(mesh.ring, kinds=(replace(torn, numbers=numbers),))
    body = mesh.body
    more = np.where(
        body.triangles < mesh.ring.size, body.triangles + body.triangles // count, body.triangles + mesh.ring.teeth
    )
    return replace(mesh, ring=ring, body=replace(body, triangles=more))


def missing(mesh: GearMesh) -> GearMesh:
    tooth = mesh.ring.kinds[0]
    ring = replace(mesh.ring, kinds=(replace(tooth, triangles=tooth.triangles[1:]),))
    return replace(mesh, ring=ring, regions=(mesh.regions[0][1:],), normals=(mesh.normals[0][1:],))


def twice(mesh: GearMesh) -> GearMesh:
    return with_tooth_triangle(mesh, 5, lambda _: mesh.ring.kinds[0].triangles[9])


def with_tooth_triangle(mesh: GearMesh, k: int, change: Callable[[np.ndarray], np.ndarray]) -> GearMesh:
    tooth = mesh.ring.kinds[0]
    triangles = tooth.triangles.copy()
    triangles[k] = change(triangles[k])
    return replace(mesh, ring=replace(mesh.ring, kinds=(replace(tooth, triangles=triangles),)))


@pytest.mark.parametrize("harm", [flipped, on_no_next_tooth, missing, twice])
@pytest.mark.parametrize("case", ["chamfered", "bevel"])
def test_pitches_that_are_not_closed_are_refused(case: str, harm: Callable[[GearMesh], GearMesh]) -> None:
    broken = harm(mesh_of(case))
    pitch = Pitch.of(broken)
    assert pitch is not None
    assert not pitch.closed
    found = prove_pitch(broken, pitch, 1)
    assert (found.watertight, found.status) == (False, "NotManifold")
    # nor as a whole, by its own count
    assert not prove(broken, 1).watertight


@pytest.mark.parametrize("case", ["chamfered", "bevel", "double helical"])
def test_teeth_beyond_their_sectors_are_refused(case: str) -> None:
    """A vertex of the tip, most of a pitch on: closed, with the right Euler number, and through the next tooth."""
    mesh = mesh_of(case)
    tooth = mesh.ring.kinds[0]
    vertex = int(np.hypot(*tooth.vertices[:, :2].T).argmax())
    for pitches, within in ((0.05, True), (0.9, False), (-0.9, False)):
        vertices = tooth.vertices.copy()
        vertices[vertex] = Rigid.about_z(pitches * mesh.ring.pitch).point(vertices[vertex])
        moved = replace(mesh, ring=replace(mesh.ring, kinds=(replace(tooth, vertices=vertices),)))
        pitch = Pitch.of(moved)
        assert pitch is not None
        found = prove_pitch(moved, pitch, 1)
        assert (found.ok, found.status) == (within, "NoError" if within else BEYOND_SECTOR)


def test_bodies_that_do_not_repeat_are_no_pitches() -> None:
    mesh = mesh_of("chamfered")
    triangles = mesh.body.triangles.copy()
    triangles[[0, 1]] = triangles[[1, 0]]
    odd = replace(mesh, body=replace(mesh.body, triangles=triangles))
    assert Pitch.of(odd) is None
    # the same triangles in another order are proved as a whole
    assert prove(odd, 1).ok


def test_gears_are_meshed_once_where_rounding_is_sure_to_pass_the_tolerance(monkeypatch: pytest.MonkeyPatch) -> None:
    spur, asked = gm.load(SAMPLES / "spur.toml", ["module=30", "assembly.center_distance=900"]), list[float]()
    member = gm.build(spur).members["gear"]
    mesh_it = solids.Extract.mesh
    monkeypatch.setattr(
        solids.Extract,
        "mesh",
        lambda self, own, within, teeth=None: asked.append(within) or mesh_it(self, own, within, teeth),
    )
    _, written, largest = solids.mesh_within(member, 5e-4, file="gear.stl")
    # 600 mm from the axis float32 has steps of 0.06 um
    assert len(asked) == 1
    assert 4.3e-4 < asked[0] < 4.9e-4
    assert largest <= 5e-4
    assert isinstance(written, GearMesh)
    solids.mesh_within(member, 5e-3, file="gear.ply")
    assert asked[1:] == [5e-3]
