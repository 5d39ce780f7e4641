"""Finite-element models in files, read back by other programs' readers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.fe_blocks import block

from gearmesh.contact.hertz import Material
from gearmesh.errors import OutputError
from gearmesh.fe.decks import formats, write_model
from gearmesh.fe.decks.vtu import write_mesh
from gearmesh.fe.model import ContactPair, Model, NodeForces, RigidTie, Support
from gearmesh.fe.results import ContactTotal, NodalSolution, contact_figures, principal_stresses
from gearmesh.kernel.numeric.algebra import Array
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
        {"upper": Material(206000.0, 0.3), "lower": Material(70000.0, 0.33)},
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
    """By the divergence theorem over the faces of a block's six sides, split into triangles finely enough to be exact."""
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


@pytest.mark.parametrize("second_order", [False, True])
def test_an_archive_is_read_as_it_was_written(tmp_path: Path, second_order: bool) -> None:
    """By mapdl-archive's own reader: nodes, elements with their material, components; the cards that it does not know by hand."""
    import mapdl_archive

    wanted, path = model(second_order), tmp_path / "blocks.cdb"
    mesh = wanted.mesh
    write_model(wanted, path)
    found = mapdl_archive.Archive(str(path))
    np.testing.assert_allclose(found.nodes, mesh.nodes, rtol=1e-11, atol=1e-12)
    np.testing.assert_array_equal(found.nnum, np.arange(1, len(mesh.nodes) + 1))
    elements = np.array([each[10 : 10 + mesh.elements.shape[1]] for each in found.elem])
    np.testing.assert_array_equal(elements, mesh.elements + 1)
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
    assert ("KEYOPT,3,2,2" in lines) is not second_order


def test_refusals_are_one_line(tmp_path: Path) -> None:
    wanted = model(False)
    with pytest.raises(OutputError, match=r"unknown suffix .step; allowed .* are .inp, .vtu, .cdb, .msh"):
        write_model(wanted, tmp_path / "a.step")
    with pytest.raises(OutputError, match=r"the suffix of gmsh files is \.msh"):
        write_model(wanted, tmp_path / "a.inp", "gmsh")
    with pytest.raises(OutputError, match=r"unknown format nastran; allowed is one of calculix, abaqus"):
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
