"""Finite-element models in files, read back by other programs' readers."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.fe_blocks import block
from oracles.fe_files import (
    NASTRAN_EDGES,
    USUAL_EDGES,
    dyna_keywords,
    fixed,
    nastran_cards,
    nastran_number,
    nastran_sets,
    whole_numbers,
)

import gearmesh as gm
from gearmesh import OutputError
from gearmesh.contact.hertz import Material
from gearmesh.fe.decks import formats, write_model
from gearmesh.fe.decks.hdf5_times import checksum
from gearmesh.fe.decks.vtu import write_mesh
from gearmesh.fe.model import ContactPair, Model, NodeForces, RigidTie, Support
from gearmesh.fe.results import ContactTotal, NodalSolution, contact_figures, principal_stresses
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.hexahedra.hex_quality import volumes
from gearmesh.mesh.hexahedra.hexes import HexMesh, join

pytestmark = pytest.mark.quick


def bent(points: Array) -> Array:
    """A deformation that no axis or face survives."""
    x, y, z = points.T
    return np.stack([x + 0.1 * y * z, y + 0.07 * z**2 - 1e-9 * x, 1.3 * z + 0.05 * x * y], axis=-1) / 3.0


def model(second_order: bool) -> Model:
    """Two blocks, one on the other, with everything that a deck may hold; sets overlap."""
    upper = block(np.arange(4.0), np.arange(3.0), np.arange(4.0), bent, second_order)
    lower = block(np.arange(3.0), np.arange(3.0), np.arange(-2.0, 1.0), bent, second_order)
    mesh = join({"upper": upper, "lower": lower})
    mesh.element_sets["corner"] = np.array([0, 5])
    mesh.face_sets["corner_faces"] = mesh.face_sets["upper_z0"][[1, 0]]
    return Model(
        "two blocks",
        mesh,
        {"upper": Material(206000.0, 0.3, 7850.0), "lower": Material(70000.0, 0.33)},
        supports=(Support("lower_z0", (0, 2)),),
        ties=(
            RigidTie(
                "upper_z1", np.array([0.5, 1.0 / 3.0, 7.0]), (0.0, 0.0, -0.01, None, None, 0.25), (0, 0, 9, 0, 7, 8)
            ),
        ),
        contacts=(ContactPair("upper_z0", "lower_z1", 1e7),),
        notes=("the model has none of: keyway -- as it is",),
        forces=(NodeForces(np.array([2, 4]), np.array([[1.0, 2.0, 3.0], [4.0, 5.0, -6.0]])),),
    )


def cards(path: Path) -> list[tuple[str, list[list[str]]]]:
    """Keyword lines of a deck with their data lines, fields stripped."""
    found: list[tuple[str, list[list[str]]]] = []
    for line in path.read_text().splitlines():
        if line.startswith("**"):
            continue
        if line.startswith("*"):
            found.append((line, []))
        else:
            found[-1][1].append([field.strip() for field in line.split(",")])
    return found


def data(path: Path, keyword: str) -> list[list[str]]:
    return [row for line, rows in cards(path) if line == keyword for row in rows]


@pytest.mark.parametrize("second_order", [False, True])
@pytest.mark.parametrize("dialect", ["calculix", "abaqus"])
def test_deck_holds_mesh_and_sets(tmp_path: Path, dialect: str, second_order: bool) -> None:
    wanted, path = model(second_order), tmp_path / "blocks.inp"
    write_model(wanted, path, dialect)
    assert all(
        len(row) <= 16 + (row[-1] == "") and len(field) <= 20
        for _, rows in cards(path)[1:]
        for row in rows
        for field in row
    )
    mesh = wanted.mesh
    nodes = np.array(data(path, "*NODE"), float)
    np.testing.assert_array_equal(nodes[:, 0], np.arange(1, len(nodes) + 1))
    np.testing.assert_allclose(nodes[: len(mesh.nodes), 1:], mesh.nodes, rtol=1e-12, atol=0)
    assert data(path, "*NSET, NSET=all_nodes, GENERATE") == [["1", str(len(mesh.nodes)), "1"]]
    kind = "C3D20R" if second_order else "C3D8I"
    fields = [f for row in data(path, f"*ELEMENT, TYPE={kind}, ELSET=all_elements") for f in row if f]
    numbers = np.array(fields, int).reshape(len(mesh.elements), -1)
    np.testing.assert_array_equal(numbers, np.column_stack([np.arange(len(mesh.elements)), mesh.elements]) + 1)
    for sets, keyword in ((mesh.node_sets, "*NSET, NSET="), (mesh.element_sets, "*ELSET, ELSET=")):
        for name, members in sets.items():
            np.testing.assert_array_equal(np.concatenate(data(path, keyword + name)).astype(int), members + 1)
    for name, faces in mesh.face_sets.items():
        rows = data(path, f"*SURFACE, NAME={name}, TYPE=ELEMENT")
        assert rows == [[str(element + 1), f"S{face + 1}"] for element, face in faces]


def test_calculix_and_abaqus_hold_the_reference_node_in_their_own_way(tmp_path: Path) -> None:
    wanted, path = model(False), tmp_path / "blocks.inp"
    count = len(wanted.mesh.nodes)
    first, second = str(count + 1), str(count + 2)
    write_model(wanted, path)  # .inp means CalculiX
    keywords = [line for line, _ in cards(path)]
    assert f"*RIGID BODY, NSET=upper_z1, REF NODE={first}, ROT NODE={second}" in keywords
    assert data(path, "*NODE")[count:] == [
        [n, "5.000000000000e-01", "3.333333333333e-01", "7.000000000000e+00"] for n in (first, second)
    ]
    held = [[first, "1", "1", "0"], [first, "2", "2", "0"], [first, "3", "3", "-0.01"], [second, "3", "3", "0.25"]]
    supports = [["lower_z0", "1", "1", "0"], ["lower_z0", "3", "3", "0"]]
    assert data(path, "*BOUNDARY") == supports + held
    # loads only where the node is free, then the forces on nodes of the mesh
    loads = [(int(a), int(b), float(c)) for a, b, c in data(path, "*CLOAD")]
    forces = [(3, 1, 1.0), (3, 2, 2.0), (3, 3, 3.0), (5, 1, 4.0), (5, 2, 5.0), (5, 3, -6.0)]
    assert loads == [(count + 2, 2, 7.0), *forces]
    assert "*STATIC, SOLVER=ITERATIVE CHOLESKY" in keywords
    write_model(replace(wanted, contacts=()), path)
    assert "*STATIC, SOLVER=SPOOLES" in [line for line, _ in cards(path)]
    write_model(wanted, path, "abaqus")
    keywords = [line for line, _ in cards(path)]
    assert f"*RIGID BODY, REF NODE={first}, TIE NSET=upper_z1" in keywords
    assert data(path, "*BOUNDARY") == supports + held[:3] + [[first, "6", "6", "0.25"]]
    assert data(path, "*CLOAD")[0] == [first, "5", "7"]
    assert "*STATIC" in keywords


@pytest.mark.parametrize("second_order", [False, True])
@pytest.mark.parametrize(("dialect", "references"), [("calculix", 2), ("abaqus", 1)])
def test_meshio_reads_decks(tmp_path: Path, dialect: str, references: int, second_order: bool) -> None:
    """It keeps the nodes of one block only, and cannot read elements whose nodes it has not kept."""
    import meshio

    wanted, path = model(second_order), tmp_path / "blocks.inp"
    mesh = wanted.mesh
    write_model(wanted, path, dialect)
    found = meshio.read(path)
    given = np.concatenate([mesh.nodes, [wanted.ties[0].point] * references])
    np.testing.assert_allclose(found.points, given, rtol=1e-12, atol=0)
    ((kind, elements),) = found.cells_dict.items()
    assert kind == ("hexahedron20" if second_order else "hexahedron")
    np.testing.assert_array_equal(elements, mesh.elements)
    count = len(mesh.nodes)
    named = {"all_nodes": np.arange(count), "upper_z1_reference": [count], **mesh.node_sets}
    named |= {"upper_z1_rotation": [count + 1]} if dialect == "calculix" else {}
    assert set(found.point_sets) == set(named)
    for name, nodes in named.items():
        np.testing.assert_array_equal(found.point_sets[name], nodes)
    for name, members in mesh.element_sets.items():
        np.testing.assert_array_equal(found.cell_sets[name][0], members)


def volume(mesh: HexMesh) -> float:
    """Volume, mm^3, by the divergence theorem over the element faces on the sides of the blocks. Gauss points integrate the
    bilinear faces exactly."""
    sides = [name for name in mesh.face_sets if name.startswith(("upper_", "lower_"))]
    x = np.polynomial.legendre.leggauss(5)
    u, v = np.meshgrid(0.5 * (x[0] + 1.0), 0.5 * (x[0] + 1.0), indexing="ij")
    w = np.outer(x[1], x[1]) / 4.0
    total = 0.0
    for name in sides:
        a, b, c, d = (mesh.nodes[mesh.face_corners(name)[:, k], None, None] for k in range(4))
        u3, v3 = u[..., None], v[..., None]
        point = (1 - u3) * (1 - v3) * a + u3 * (1 - v3) * b + u3 * v3 * c + (1 - u3) * v3 * d
        along_u, along_v = (1 - v3) * (b - a) + v3 * (c - d), (1 - u3) * (d - a) + u3 * (c - b)
        total += float((w * (point * np.cross(along_u, along_v)).sum(axis=-1)).sum()) / 3.0
    return total


@pytest.fixture
def gmsh() -> Iterator[Any]:
    module = pytest.importorskip("gmsh")
    module.initialize(interruptible=False)
    module.option.setNumber("General.Terminal", 0)
    yield module
    module.finalize()


@pytest.mark.parametrize("second_order", [False, True])
def test_gmsh_reads_elements_and_groups(tmp_path: Path, gmsh: Any, second_order: bool) -> None:
    wanted, path = model(second_order), tmp_path / "blocks.msh"
    mesh = wanted.mesh
    write_model(wanted, path)
    gmsh.open(str(path))
    tags, points, _ = gmsh.model.mesh.getNodes()
    np.testing.assert_allclose(points.reshape(-1, 3)[np.argsort(tags)], mesh.nodes, rtol=1e-14, atol=1e-16)
    for dimension, sets in ((3, mesh.element_sets), (2, mesh.face_sets), (0, mesh.node_sets)):
        groups = gmsh.model.getPhysicalGroups(dimension)
        assert {gmsh.model.getPhysicalName(*group) for group in groups} == set(sets)
        for group in groups:
            name = gmsh.model.getPhysicalName(*group)
            rows = mesh.face_outlines(name) if dimension == 2 else sets[name][:, None]
            want = mesh.elements[sets[name]] if dimension == 3 else rows
            found = [
                np.sort(each.reshape(-1, want.shape[1]), axis=1)
                for entity in gmsh.model.getEntitiesForPhysicalGroup(*group)
                for each in gmsh.model.mesh.getElements(dimension, entity)[2]
            ]
            assert sorted(map(tuple, np.concatenate(found))) == sorted(map(tuple, np.sort(want + 1, axis=1)))
    # a wrong order of mid-side nodes folds the elements: their volume tells
    (kind,) = gmsh.model.mesh.getElementTypes(3)
    local, weights = gmsh.model.mesh.getIntegrationPoints(kind, "Gauss6")
    determinants = gmsh.model.mesh.getJacobians(kind, local)[1].reshape(-1, len(weights))
    assert determinants.min() > 0.0
    linear = float((determinants @ weights).sum())
    assert linear == pytest.approx(volume(mesh), rel=2e-3 if second_order else 1e-12)


@pytest.mark.parametrize("second_order", [False, True])
def test_vtk_reads_elements_sets_and_results(tmp_path: Path, second_order: bool) -> None:
    import pyvista

    wanted, path = model(second_order), tmp_path / "blocks.vtu"
    mesh = wanted.mesh
    write_model(wanted, path)
    grid = pyvista.read(path)
    np.testing.assert_array_equal(grid.points, mesh.nodes)
    np.testing.assert_array_equal(grid.cells.reshape(len(mesh.elements), -1)[:, 1:], mesh.elements)
    assert set(grid.celltypes) == {25 if second_order else 12}
    for name, nodes in mesh.node_sets.items():
        np.testing.assert_array_equal(np.flatnonzero(grid.point_data[name]), nodes)
    for name, elements in mesh.element_sets.items():
        np.testing.assert_array_equal(np.flatnonzero(grid.cell_data[name]), np.sort(elements))
    for name, faces in mesh.face_sets.items():
        found = np.argwhere(grid.cell_data[name][:, None] >> np.arange(6) & 1)
        np.testing.assert_array_equal(found, faces[np.lexsort(faces.T[::-1])])
    pressure = np.linspace(0.0, 1.0, len(mesh.nodes))
    write_mesh(mesh, path, {"pressure": pressure, "displacement": mesh.nodes[:, ::-1]})
    grid = pyvista.read(path)
    np.testing.assert_array_equal(grid.point_data["pressure"], pressure)
    np.testing.assert_array_equal(grid.point_data["displacement"], mesh.nodes[:, ::-1])


def check_hexahedra(nodes: Array, elements: Array, edges: Sequence[tuple[int, int]]) -> None:
    """Corners turn to the right, and mid-side nodes lie near the middles of the format's own edges."""
    corners = nodes[elements[:, :8]]
    assert (np.linalg.det(corners[:, [1, 3, 4]] - corners[:, :1]) > 0.0).all()
    if elements.shape[1] == 20:
        first, last = (nodes[elements[:, [edge[k] for edge in edges]]] for k in (0, 1))
        apart = np.linalg.norm(nodes[elements[:, 8:]] - 0.5 * (first + last), axis=-1)
        assert (apart < 0.1 * np.linalg.norm(last - first, axis=-1)).all()


@pytest.mark.parametrize("second_order", [False, True])
def test_an_archive_is_read_as_it_was_written(tmp_path: Path, second_order: bool) -> None:
    """Read nodes, elements with their materials, and components by mapdl-archive's own reader. The test itself reads what that
    reader does not know."""
    import mapdl_archive

    wanted, path = model(second_order), tmp_path / "blocks.cdb"
    mesh = wanted.mesh
    write_model(wanted, path)
    found = mapdl_archive.Archive(str(path))
    points = np.concatenate((mesh.nodes, [wanted.ties[0].point]))
    np.testing.assert_allclose(found.nodes, points, rtol=1e-13, atol=1e-16)
    np.testing.assert_array_equal(found.nnum, np.arange(1, len(points) + 1))
    elements = np.array([each[10 : 10 + mesh.elements.shape[1]] for each in found.elem])
    np.testing.assert_array_equal(elements, mesh.elements + 1)
    check_hexahedra(found.nodes, elements - 1, USUAL_EDGES)
    materials = list(wanted.materials)
    for number, name in enumerate(materials, 1):
        np.testing.assert_array_equal(
            np.flatnonzero(np.asarray(found.material_type) == number), np.sort(mesh.element_sets[name])
        )
    for name, nodes in mesh.node_sets.items():
        np.testing.assert_array_equal(found.node_components[name.upper()], np.sort(nodes) + 1)
    for name, each in mesh.element_sets.items():
        np.testing.assert_array_equal(found.element_components[name.upper()], np.sort(each) + 1)
    lines = path.read_text(encoding="ascii").splitlines()
    for number, each in enumerate(wanted.materials.values(), 1):
        assert f"MP,EX,{number},{each.youngs_modulus:.12g}" in lines
        assert f"MP,PRXY,{number},{each.poisson_ratio:.12g}" in lines
    assert [line for line in lines if line.startswith("MP,DENS")] == ["MP,DENS,1,7.85e-09"]
    assert f"ET,1,{186 if second_order else 185}" in lines
    assert ("KEYOPT,1,2,2" in lines) is not second_order
    # contact elements on the faces, corners first, counterclockwise from outside; a pair has constants of its own
    given = [line.split(",") for line in lines]
    state, faces = "", dict[str, list[list[int]]]()
    for row in given:
        if row[0] == "TYPE":
            state = row[1]
        elif row[0] == "EN":
            faces.setdefault(state, []).append([int(x) - 1 for x in row[2:]])
    for kind, name in (("2", wanted.contacts[0].master), ("3", wanted.contacts[0].slave)):
        outline = mesh.face_outlines(name)
        np.testing.assert_array_equal(np.array(faces[kind])[:, :4], outline[:, ::2] if second_order else outline)
        assert np.array(faces[kind]).shape[1] == (8 if second_order else 4)
        if second_order:
            np.testing.assert_array_equal(np.array(faces[kind])[:, 4:], outline[:, 1::2])
    assert ["R", "11", "0", "0", "-10000000", "0.1"] in given
    assert f"TSHAP,{'QUA8' if second_order else 'QUAD'}" in lines
    reference = str(len(points))
    assert lines[lines.index("CMSEL,S,UPPER_Z1") + 1 :][:2] == [
        f"NSEL,A,NODE,,{reference}",
        f"CERIG,{reference},ALL,UXYZ",
    ]
    held = [row for row in given if row[0] == "D"]
    assert held == [
        *(
            ["D", reference, move, value]
            for move, value in (("UX", "0"), ("UY", "0"), ("UZ", "-0.01"), ("ROTZ", "0.25"))
        ),
        *(["D", "ALL", move, "0"] for move in ("UX", "UZ")),
    ]
    loads = [row[1:] for row in given if row[0] == "F"]
    assert loads[0] == [reference, "MY", "7"]
    assert sorted(loads[1:]) == sorted([n, f"F{x}", str(v)] for n, x, v in NODE_LOADS)
    assert lines[-3:] == ["SOLVE", "FINISH", "/GOPR"]


#: forces of `model` on its nodes: number, direction, value
NODE_LOADS = [("3", "X", 1), ("3", "Y", 2), ("3", "Z", 3), ("5", "X", 4), ("5", "Y", 5), ("5", "Z", -6)]


def test_gmsh_reads_all_nodes_of_nastran_elements(tmp_path: Path, gmsh: Any) -> None:
    """gmsh drops mid-side nodes of elements whose lines have no mark in the last field."""
    wanted, path = model(second_order=True), tmp_path / "blocks.bdf"
    write_model(wanted, path)
    gmsh.open(str(path))
    (kind,) = gmsh.model.mesh.getElementTypes(3)
    local, weights = gmsh.model.mesh.getIntegrationPoints(kind, "Gauss6")
    determinants = gmsh.model.mesh.getJacobians(kind, local)[1].reshape(-1, len(weights))
    assert determinants.min() > 0.0
    exact = volumes(wanted.mesh.nodes, wanted.mesh.elements).sum()
    assert float((determinants @ weights).sum()) == pytest.approx(exact, rel=1e-12)


@pytest.mark.parametrize("second_order", [False, True])
def test_nastran_holds_the_whole_model(tmp_path: Path, second_order: bool) -> None:
    """Read the deck by a strict reader of the format. pyNastran 1.4.1, which needs an older NumPy, reads the same
    (gearmesh/fe/notes.md)."""
    wanted, path = model(second_order), tmp_path / "blocks.bdf"
    mesh, count = wanted.mesh, len(wanted.mesh.nodes)
    write_model(wanted, path)
    cards = nastran_cards(path)
    assert {name for name, _ in cards} == {
        *("PARAM", "GRID", "CHEXA", "PSOLID", "MAT1", "SPC1", "RBE2", "SPCD", "MOMENT", "FORCE"),
        *("BSURFS", "BCTSET", "BCTPARM", "BCTADD"),
    }
    rows = {name: [fields for each, fields in cards if each == name] for name, _ in cards}
    points = np.array([[float(row[k]) for k in (0, 2, 3, 4)] for row in rows["GRID"]])
    np.testing.assert_array_equal(points[:, 0], np.arange(1, count + 2))
    np.testing.assert_allclose(points[:, 1:], [*mesh.nodes, wanted.ties[0].point], rtol=0, atol=6e-14)
    solids = np.array([whole_numbers(row) for row in rows["CHEXA"]])
    np.testing.assert_array_equal(solids[:, 0], np.arange(1, len(mesh.elements) + 1))
    np.testing.assert_array_equal(np.sort(solids[:, 2:]), np.sort(mesh.elements + 1))
    check_hexahedra(mesh.nodes, solids[:, 2:] - 1, NASTRAN_EDGES)
    for number, (name, material) in enumerate(wanted.materials.items(), 1):
        np.testing.assert_array_equal(np.flatnonzero(solids[:, 1] == number), np.sort(mesh.element_sets[name]))
        assert rows["PSOLID"][number - 1][:2] == [str(number)] * 2
        mid, modulus, shear, ratio, density = rows["MAT1"][number - 1][:5]
        assert (int(mid), float(modulus), shear) == (number, material.youngs_modulus, "")
        assert float(ratio) == material.poisson_ratio
        assert float(density) == pytest.approx(1e-12 * (material.density or 0.0), rel=1e-12)
    sets = nastran_sets(path)
    for kind, members in (("nodes", mesh.node_sets), ("elements", mesh.element_sets)):
        for name, own in members.items():
            assert sets[f"{kind} {name}"] == (own + 1).tolist()
    reference = count + 1
    assert whole_numbers(rows["SPC1"][0]) == [1, 13, *(mesh.node_sets["lower_z0"] + 1).tolist()]
    assert whole_numbers(rows["SPC1"][1]) == [1, 1236, reference]
    (tie,) = rows["RBE2"]
    assert whole_numbers(tie) == [len(solids) + 1, reference, 123, *(mesh.node_sets["upper_z1"] + 1).tolist()]
    enforced = [(*whole_numbers(row[:3]), float(row[3])) for row in rows["SPCD"]]
    assert enforced == [(2, reference, 3, -0.01), (2, reference, 6, 0.25)]
    vectors = [(*whole_numbers(row[:3]), *map(float, row[3:7])) for name in ("MOMENT", "FORCE") for row in rows[name]]
    assert vectors == [(2, reference, 0, 1, 0, 7, 0), (2, 3, 0, 1, 1, 2, 3), (2, 5, 0, 1, 4, 5, -6)]
    (pair,), (parameters,) = rows["BCTSET"], rows["BCTPARM"]
    for faces, name in zip(rows["BSURFS"], (wanted.contacts[0].slave, wanted.contacts[0].master), strict=True):
        named = np.array(whole_numbers(faces)[1:]).reshape(-1, 4)
        np.testing.assert_array_equal(named[:, 0] - 1, mesh.face_sets[name][:, 0])
        np.testing.assert_array_equal(named[:, 1:] - 1, mesh.face_corners(name)[:, :3])
    assert [pair[1], pair[2]] == [faces[0] for faces in rows["BSURFS"]]
    assert -nastran_number(pair[4]) == pytest.approx(nastran_number(pair[5]), rel=1e-3)
    assert nastran_number(pair[5]) > 0.3
    assert parameters[:4] == [pair[0], "PENTYP", "2", "PENN"]
    assert nastran_number(parameters[4]) == wanted.contacts[0].stiffness
    head = path.read_text().split("BEGIN BULK")[0].splitlines()
    assert {"SOL 101", "  SPC = 1", "  LOAD = 2", "  BCSET = 100", "$ the model has none of: keyway -- as it is"} <= {
        *head
    }


@pytest.mark.parametrize("second_order", [False, True])
def test_dyna_holds_the_whole_model(tmp_path: Path, second_order: bool) -> None:
    """Read the deck by a strict reader of the format. PyDyna (ansys-dyna-core 0.12.1) reads the same (gearmesh/fe/notes.md)."""
    wanted, path = model(second_order), tmp_path / "blocks.k"
    mesh, count = wanted.mesh, len(wanted.mesh.nodes)
    write_model(wanted, path)
    found: dict[str, list[list[str]]] = {}
    for keyword, data in dyna_keywords(path):
        found.setdefault(keyword, []).append(data)
    (lines,) = found["*NODE"]
    points = np.array([[line[:8], *fixed(line[8:], 16)] for line in lines], float)
    np.testing.assert_array_equal(points[:, 0], np.arange(1, count + 2))
    np.testing.assert_allclose(points[:, 1:], [*mesh.nodes, wanted.ties[0].point], rtol=0, atol=6e-14)
    (lines,) = found["*ELEMENT_SOLID_H20" if second_order else "*ELEMENT_SOLID"]
    numbers = [int(x) for line in lines for x in fixed(line, 8)]
    solids = np.array(numbers).reshape(len(mesh.elements), -1)
    assert {len(line) for line in lines} == ({16, 80} if second_order else {80})
    np.testing.assert_array_equal(solids[:, 0], np.arange(1, len(solids) + 1))
    np.testing.assert_array_equal(np.sort(solids[:, 2:]), np.sort(mesh.elements + 1))
    check_hexahedra(mesh.nodes, solids[:, 2:] - 1, USUAL_EDGES)
    assert found["*SECTION_SOLID"] == [[f"{1:10d}{23 if second_order else 62:10d}"]]
    parts = [(data[0], fixed(data[1], 10)) for data in found["*PART"]]
    assert parts == [("upper", ["1", "1", "1"]), ("lower", ["2", "1", "2"])]
    for (name, (part, *_)), data in zip(parts, found["*MAT_ELASTIC_TITLE"], strict=True):
        np.testing.assert_array_equal(np.flatnonzero(solids[:, 1] == int(part)), np.sort(mesh.element_sets[name]))
        number, density, modulus, ratio = fixed(data[1], 10)
        own = wanted.materials[name]
        assert (data[0], number, float(modulus), float(ratio)) == (name, part, own.youngs_modulus, own.poisson_ratio)
        assert float(density) == (7.85e-9 if own.density else 1e-12)
    of_nodes = {
        data[0]: [int(x) for line in data[1:] for x in fixed(line, 10)] for data in found["*SET_NODE_LIST_TITLE"]
    }
    of_solids = {data[0]: [int(x) for line in data[1:] for x in fixed(line, 10)] for data in found["*SET_SOLID_TITLE"]}
    for sets, ours in ((of_nodes, mesh.node_sets), (of_solids, mesh.element_sets)):
        for name, members in ours.items():
            assert sets[name][1:] == (members + 1).tolist()
    faces = {data[0]: data[1:] for data in found["*SET_SEGMENT_TITLE"]}
    for name in mesh.face_sets:
        named = np.array([fixed(line, 10) for line in faces[name][1:]], int)
        np.testing.assert_array_equal(named - 1, mesh.face_corners(name))
    (data,) = found["*CONTACT_AUTOMATIC_SURFACE_TO_SURFACE_MORTAR_ID"]
    assert fixed(data[1], 10) == [str(int(faces[name][0])) for name in ("upper_z0", "lower_z1")] + ["0", "0"]
    assert (fixed(data[-1], 10)[1:], len(data)) == (["0", "3", "1.0"][1:], 7)
    (data,) = found["*BOUNDARY_SPC_SET"]
    assert fixed(data[0], 10) == [str(of_nodes["lower_z0"][0]), "0", "1", "0", "1"]
    # the centre of the rigid body is the reference node, a member of its set; only what does not move is held
    ((title, body, held, centre, inertia, speed),) = found["*CONSTRAINED_NODAL_RIGID_BODY_SPC_INERTIA_TITLE"]
    rigid = of_nodes["upper_z1_and_reference"]
    assert (title, rigid[1:]) == ("upper_z1", [*(mesh.node_sets["upper_z1"] + 1).tolist(), count + 1])
    assert fixed(body, 10) == ["3", "0", str(rigid[0]), str(count + 1)]
    assert [float(x) for x in fixed(held, 10)] == [1, 4, 0]
    np.testing.assert_allclose([float(x) for x in fixed(centre, 10)[:3]], wanted.ties[0].point, atol=1e-8)
    assert fixed(centre, 10)[4:] == ["0", str(count + 1)]
    assert len(fixed(inertia, 10)) == len(fixed(speed, 10)) == 6
    moved = [fixed(data[0], 10) for data in found["*BOUNDARY_PRESCRIBED_MOTION_RIGID"]]
    assert moved == [["3", "3", "2", "1", "-0.01"], ["3", "7", "2", "1", "0.25"]]
    assert [fixed(data[0], 10) for data in found["*LOAD_RIGID_BODY"]] == [["3", "6", "1", "7"]]
    (data,) = found["*LOAD_NODE_POINT +"]
    loads = [(fixed(line, 20)[0], "XYZ"[int(fixed(line, 20)[1]) - 1], float(fixed(line, 20)[3])) for line in data]
    assert loads == NODE_LOADS


@pytest.mark.parametrize("second_order", [False, True])
def test_med_is_read_by_gmsh_and_medcoupling(tmp_path: Path, gmsh: Any, second_order: bool) -> None:
    """gmsh has the elements the right way round, and groups with names; medcoupling the groups of nodes, too."""
    import medcoupling as mc

    wanted, path = model(second_order), tmp_path / "blocks.med"
    mesh, count = wanted.mesh, len(wanted.mesh.nodes)
    write_model(wanted, path)
    gmsh.open(str(path))
    (kind,) = gmsh.model.mesh.getElementTypes(3)
    assert kind == (17 if second_order else 5)
    local, weights = gmsh.model.mesh.getIntegrationPoints(kind, "Gauss6")
    determinants = gmsh.model.mesh.getJacobians(kind, local)[1].reshape(-1, len(weights))
    assert determinants.min() > 0.0
    assert float((determinants @ weights).sum()) == pytest.approx(volumes(mesh.nodes, mesh.elements).sum(), rel=1e-12)
    # it keeps the blanks that fill a name of the format
    groups = {gmsh.model.getPhysicalName(d, n).strip(): (d, n) for d, n in gmsh.model.getPhysicalGroups()}
    for name in mesh.face_sets:
        entities = gmsh.model.getEntitiesForPhysicalGroup(*groups[name])
        faces = [nodes for entity in entities for nodes in gmsh.model.mesh.getElements(2, entity)[2]]
        ours = mesh.face_outlines(name) + 1
        theirs = np.concatenate([np.sort(each.reshape(-1, ours.shape[1])) for each in faces])
        assert sorted(map(tuple, theirs)) == sorted(map(tuple, np.sort(ours)))
    file = mc.MEDFileUMesh(str(path))
    # meshio refuses others
    assert all(file.getGroupsOnFamily(name) for name in file.getFamiliesNames() if file.getFamilyId(name))
    np.testing.assert_array_equal(file.getCoords().toNumPyArray(), [*mesh.nodes, wanted.ties[0].point])
    assert file.getMeshAtLevel(0).getMeasureField(False).getArray().toNumPyArray().min() > 0.0
    for name, nodes in mesh.node_sets.items():
        np.testing.assert_array_equal(file.getNodeGroupArr(name).toNumPyArray(), np.sort(nodes))
    assert file.getNodeGroupArr("upper_z1_node").toNumPyArray().tolist() == [count]
    for name, elements in mesh.element_sets.items():
        np.testing.assert_array_equal(file.getGroupArr(0, name).toNumPyArray(), np.sort(elements))
    for name in ("upper_z0", "lower_z1"):
        outwards = file.getGroup(-1, name).buildOrthogonalField().getArray().toNumPyArray()
        corners = mesh.nodes[mesh.face_corners(name)]
        normals = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
        assert outwards[:, 2].max() * normals[:, 2].max() > 0.0
        assert (np.sign(outwards[:, 2]) == np.sign(normals[0, 2])).all()


def test_checksum_of_hdf5_is_lookup3() -> None:
    """Published values of the hash, and one header of a file: with another checksum HDF5 would not open the file."""
    assert checksum(b"") == 0xDEADBEEF
    assert checksum(b"Four score and seven years ago") == 0x17770551


def test_med_files_have_no_times(tmp_path: Path) -> None:
    import medcoupling as mc

    write_model(model(False), tmp_path / "blocks.med")
    data = (tmp_path / "blocks.med").read_bytes()
    headers = [place for place in range(len(data)) if data.startswith(b"OHDR\x02", place) and data[place + 5] & 0x20]
    assert len(headers) > 100
    assert {data[place + 6 : place + 22] for place in headers} == {bytes(16)}
    # the library checks the checksums of all headers that it reads
    assert mc.MEDFileUMesh(str(tmp_path / "blocks.med")).getSizeAtLevel(0) == len(model(False).mesh.elements)


def test_commands_of_code_aster_name_the_groups(tmp_path: Path) -> None:
    """Commands are Python: they are run with stand-ins that keep what they are called with."""
    wanted = model(False)
    write_model(wanted, tmp_path / "blocks.med")
    called: list[tuple[str, dict[str, Any]]] = []

    def command(name: str) -> Callable[..., str]:
        return lambda **keywords: called.append((name, keywords)) or name

    text = (tmp_path / "blocks.comm").read_text()
    names = {node.func.id for node in ast.walk(ast.parse(text)) if isinstance(node, ast.Call)}  # type: ignore[attr-defined]
    exec(text, {name: command(name) for name in names - {"_F"}} | {"_F": dict})
    order = [name for name, _ in called]
    assert order == [
        *("DEBUT", "LIRE_MAILLAGE", "AFFE_MODELE", "DEFI_MATERIAU", "DEFI_MATERIAU", "AFFE_MATERIAU", "AFFE_CARA_ELEM"),
        *("AFFE_CHAR_MECA", "AFFE_CHAR_MECA", "DEFI_CONTACT", "DEFI_FONCTION", "DEFI_LIST_REEL", "STAT_NON_LINE"),
        *("CALC_CHAMP", "IMPR_RESU", "FIN"),
    ]
    given = dict(called)
    materials = [keywords["ELAS"] for name, keywords in called if name == "DEFI_MATERIAU"]
    assert materials == [{"E": 206000, "NU": 0.3, "RHO": 7.85e-9}, {"E": 70000, "NU": 0.33}]
    held, loads = (keywords for name, keywords in called if name == "AFFE_CHAR_MECA")
    node = "upper_z1_node"
    assert held["DDL_IMPO"] == (
        {"GROUP_NO": "lower_z0", "DX": 0, "DZ": 0},
        *({"GROUP_NO": node, move: 0} for move in ("DX", "DY")),
    )
    assert held["LIAISON_SOLIDE"] == ({"GROUP_NO": ("upper_z1", node)},)
    assert loads["DDL_IMPO"] == ({"GROUP_NO": node, "DZ": -0.01}, {"GROUP_NO": node, "DRZ": 0.25})
    assert loads["FORCE_NODALE"] == (
        {"GROUP_NO": node, "MY": 7},
        {"GROUP_NO": "N3", "FX": 1, "FY": 2, "FZ": 3},
        {"GROUP_NO": "N5", "FX": 4, "FY": 5, "FZ": -6},
    )
    (zone,) = given["DEFI_CONTACT"]["ZONE"]
    assert (zone["GROUP_MA_ESCL"], zone["GROUP_MA_MAIT"]) == ("upper_z0", "lower_z1")
    assert zone["COEF_PENA_CONT"] == 1e7
    solids, points = given["AFFE_MODELE"]["AFFE"]
    assert solids["GROUP_MA"] == ("upper", "lower", "upper_z0", "lower_z1")
    assert (points["GROUP_MA"], points["MODELISATION"]) == ((node,), "DIS_TR")


def sector_equations(path: Path) -> list[dict[tuple[int, int], float]]:
    """Linear equations of a file: coefficients by node and direction, both from 0."""
    found: list[dict[tuple[int, int], float]] = []
    if path.suffix == ".bdf":
        for name, fields in nastran_cards(path):
            if name == "MPC":
                # after the set: node, direction, coefficient; a blank field ends and begins each line of two
                terms = [fields[1 + 8 * k + 3 * j :][:3] for k in range(-(-len(fields) // 8)) for j in (0, 1)]
                found.append({(int(n) - 1, int(d) - 1): float(c) for n, d, c in filter(len, terms) if n})
    elif path.suffix == ".cdb":
        for line in path.read_text().splitlines():
            if line.startswith("CE,"):
                _, number, *fields = line.split(",")
                terms = [fields[k : k + 3] for k in range(1, len(fields) - 2, 3)]
                if number == "NEXT":
                    found.append({})
                found[-1] |= {(int(n) - 1, "XYZ".index(d[1])): float(c) for n, d, c in terms}
    else:
        for keyword, data in dyna_keywords(path):
            if keyword == "*CONSTRAINED_MULTIPLE_GLOBAL +":
                terms = [fixed(line, 20) for line in data]
                while terms:
                    count = int(terms[1][0])
                    found.append({(int(n) - 1, int(d) - 1): float(c) for n, d, c in terms[2 : 2 + count]})
                    terms = terms[2 + count :]
    return found


@pytest.mark.parametrize("suffix", [".bdf", ".cdb", ".k"])
@pytest.mark.sweep_cases(".bdf", ".k")
def test_equations_of_a_sector_let_it_turn_as_the_whole_gear(suffix: str, tmp_path: Path) -> None:
    """A rotation about the axis and a shift along it fulfil all equations, a shift across none of those across."""
    gear = gm.gear(12, module=2, face=6, helix=20).finite_elements(sector=1)
    mesh, cyclic = gear.mesh, gear._model.cyclic
    assert cyclic is not None
    file = gear.save(tmp_path / f"sector{suffix}")
    equations = sector_equations(file)
    assert len(equations) == 3 * len(mesh.node_sets[cyclic.first])
    x, y, _ = mesh.nodes.T
    turned = np.stack((-y, x, np.full_like(x, 0.3)), axis=-1)
    shifted = np.broadcast_to([1.0, 0.0, 0.0], mesh.nodes.shape)
    left = np.array(
        [[sum(c * field[key] for key, c in row.items()) for field in (turned, shifted)] for row in equations]
    )
    assert np.abs(left[:, 0]).max() < 1e-8
    assert (np.abs(left[:, 1]) > 0.1).sum() == 2 * len(equations) // 3
    assert {key[0] for row in equations for key in row} == {*mesh.node_sets[cyclic.first], *mesh.node_sets[cyclic.last]}
    with pytest.raises(OutputError, match="cyclic symmetry of a sector is written for CalculiX"):
        gear.save(tmp_path / "sector.med")


def test_refusals_are_one_line(tmp_path: Path) -> None:
    wanted = model(False)
    with pytest.raises(
        OutputError, match=r"unknown suffix .step; allowed .* are .bdf, .cdb, .inp, .k, .med, .msh, .vtu"
    ):
        write_model(wanted, tmp_path / "a.step")
    with pytest.raises(OutputError, match=r"the suffix of gmsh files is \.msh"):
        write_model(wanted, tmp_path / "a.inp", "gmsh")
    with pytest.raises(
        OutputError, match=r"unknown format marc; allowed is one of abaqus, ansys, aster, calculix, gmsh"
    ):
        write_model(wanted, tmp_path / "a.inp", "marc")
    with pytest.raises(OutputError, match=r"the suffix of nastran files is \.bdf"):
        write_model(wanted, tmp_path / "a.inp", "nastran")
    broken = replace(wanted, contacts=(ContactPair("upper_z0", "nowhere", 1e7),))
    with pytest.raises(OutputError, match="no face set nowhere; it has upper_z0"):
        write_model(broken, tmp_path / "a.inp")
    assert not list(tmp_path.iterdir())
    assert {name: entry.suffix for name, entry in formats().items()} == {
        "calculix": ".inp",
        "abaqus": ".inp",
        "ansys": ".cdb",
        "gmsh": ".msh",
        "vtu": ".vtu",
        "nastran": ".bdf",
        "lsdyna": ".k",
        "aster": ".med",
    }


def test_principal_stresses_of_a_known_tensor() -> None:
    turn = np.linalg.qr(np.array([[1.0, 2.0, 3.0], [0.5, -1.0, 2.0], [2.0, 0.0, -1.0]]))[0]
    tensor = turn @ np.diag([-3.0, 5.0, 11.0]) @ turn.T
    stress = tensor[[0, 1, 2, 0, 1, 2], [0, 1, 2, 1, 2, 0]]
    np.testing.assert_allclose(principal_stresses(stress), [-3.0, 5.0, 11.0], atol=1e-13)


def test_centre_of_pressure_weighs_by_area() -> None:
    """Even pressure on a side with uneven elements: its centre is the side's; a pair that is apart has none."""
    upper = block(np.array([0.0, 0.1, 0.5, 3.0]), np.array([0.0, 1.5, 2.0]), np.arange(2.0))
    mesh = join({"upper": upper, "lower": block(np.arange(2.0), np.arange(2.0), np.arange(2.0))})
    pairs = (ContactPair("upper_z0", "lower_z1", 1e7), ContactPair("lower_z1", "upper_z0", 1e7))
    pressure = np.zeros(len(mesh.nodes))
    pressure[mesh.node_sets["upper_z0"]] = 7.0
    total = ContactTotal(np.array([0.0, 0.0, 42.0]), np.zeros(3), 6.0)
    count = len(mesh.nodes)
    solution = NodalSolution(np.zeros((count, 3)), np.zeros((count, 6)), pressure, {}, (total, total), 1)
    pressed, apart = contact_figures(Model("pairs", mesh, {}, contacts=pairs), solution)
    np.testing.assert_allclose(pressed.centre, [1.5, 1.0, 0.0], atol=1e-15)
    assert pressed.peak_pressure == 7.0
    assert apart.peak_pressure == 0.0
    assert np.isnan([apart.centre, apart.place]).all()


def test_friction_in_each_programs_way(tmp_path: Path) -> None:
    wanted, path = model(False), tmp_path / "blocks.inp"
    rough = replace(wanted, contacts=tuple(replace(each, friction=0.12) for each in wanted.contacts))
    # of CalculiX the slope before Coulomb's limit, too
    for dialect, row in (("calculix", ["0.12", "1000000"]), ("abaqus", ["0.12"])):
        write_model(rough, path, dialect)
        assert data(path, "*FRICTION") == [row]
        # an unsymmetric matrix
        assert ("*STATIC, SOLVER=SPOOLES" in path.read_text()) is (dialect == "calculix")
        write_model(wanted, path, dialect)
        assert data(path, "*FRICTION") == []
