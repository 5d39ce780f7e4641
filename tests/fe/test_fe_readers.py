"""Our finite-element files as meshio and VTK read them: rows of the table in gearmesh/fe/notes.md."""

from __future__ import annotations

import shutil
import subprocess
from functools import cache
from pathlib import Path

import meshio
import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.hexahedra.hex_quality import CORNER_PLACES, scaled_jacobian
from gearmesh.mesh.hexahedra.hexes import HEX_EDGES

#: corners of the edges of gmsh's hexahedron of 20 nodes, in the order of its mid-side nodes
GMSH_EDGES = ((0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7))
#: one tooth of a pinion, few elements
SMALL = ("fe.torque=20.0", "fe.teeth=1", "fe.flank=4", "fe.fillet=3")


@cache
def model(order: int) -> gm.FiniteElements | gm.UnloadedFiniteElements:
    gears = gm.build(gm.load(SAMPLES / "spur.toml", [*SMALL, f"fe.order={order}"]))
    return gears.finite_elements(members=["pinion"])


@pytest.mark.parametrize(("order", "kind"), [(1, "C3D8RH"), (2, "C3D20RH")])
@pytest.mark.sweep_cases("2-C3D20RH")
def test_meshio_rewrites_elements_and_numbers(order: int, kind: str, tmp_path: Path) -> None:
    ours, theirs = tmp_path / "ours.inp", tmp_path / "theirs.inp"
    model(order).save(ours)
    read = meshio.read(ours)
    assert sum(len(block.data) for block in read.cells) == model(order).measured.elements
    assert "pinion_flank_right_1" in read.point_sets
    read.write(theirs)
    lines = theirs.read_text().splitlines()
    words = {line.split(",")[0] for line in lines if line.startswith("*")}
    assert words == {"*HEADING", "*NODE", "*ELEMENT", "*ELSET", "*NSET"}
    assert f"*ELEMENT, TYPE={kind}" in lines
    node = lines[lines.index("*NODE") + 1].split(",")
    # CalculiX reads 20 characters a field; ours fit
    assert max(len(field.strip()) for field in node[1:]) >= 22
    text = ours.read_text().splitlines()
    assert max(len(field.strip()) for field in text[text.index("*NODE") + 1].split(",")) <= 20


def test_vtk_has_no_quality_of_hexahedra_of_second_order() -> None:
    first, second = (model(order) for order in (1, 2))
    quality = first.to_pyvista().cell_quality("scaled_jacobian")["scaled_jacobian"]
    assert quality.min() == pytest.approx(first.measured.min_scaled_jacobian, rel=1e-9)
    assert first.to_pyvista().compute_cell_sizes()["Volume"].sum() == pytest.approx(first.measured.volume, rel=1e-9)
    quality = second.to_pyvista().cell_quality("scaled_jacobian")["scaled_jacobian"]
    np.testing.assert_array_equal(quality, -1.0)
    assert second.measured.min_scaled_jacobian > 0.5
    volume = second.to_pyvista().compute_cell_sizes()["Volume"].sum()
    assert 1e-5 < abs(volume / second.measured.volume - 1.0) < 3e-3


def test_volumes_and_shapes_of_second_order_are_those_of_gmsh(tmp_path: Path) -> None:
    """gmsh integrates the curved elements; those between the corners alone have 0.07 % less. It samples minSIGE at the nodes."""
    import gmsh

    second, file = model(2), tmp_path / "tooth.msh"
    second.save(file)
    bent = _bent_cubes(200)
    gmsh.initialize()
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(file))
        (tags,) = gmsh.model.mesh.getElements(3)[1]
        volume = gmsh.model.mesh.getElementQualities(tags, "volume").sum()
        worst = gmsh.model.mesh.getElementQualities(tags, "minSIGE").min()
        gmsh.model.add("bent")
        gmsh.model.addDiscreteEntity(3, 1)
        numbers = np.arange(1, 1 + bent.size // 3)
        gmsh.model.mesh.addNodes(3, 1, numbers, bent.ravel())
        of_edge = {frozenset(edge): 8 + k for k, edge in enumerate(HEX_EDGES)}
        order = [*range(8), *(of_edge[frozenset(edge)] for edge in GMSH_EDGES)]
        elements = numbers.reshape(-1, 20)
        gmsh.model.mesh.addElementsByType(1, 17, np.arange(1, 1 + len(bent)), elements[:, order].ravel())
        shapes = gmsh.model.mesh.getElementQualities(np.arange(1, 1 + len(bent)), "minSIGE")
    finally:
        gmsh.finalize()
    assert volume == pytest.approx(second.measured.volume, rel=1e-12)
    assert worst == pytest.approx(second.measured.min_scaled_jacobian, abs=1e-12)
    # inverted ones among them; of two an integration point, where gmsh does not look, is worse than all nodes
    ours = scaled_jacobian(bent.reshape(-1, 3), elements - 1)
    alike = np.abs(ours - shapes) < 1e-12
    assert (ours <= shapes + 1e-12).all()
    assert alike.sum() >= len(bent) - 2
    corners = scaled_jacobian(bent[:, :8].reshape(-1, 3), np.arange(8 * len(bent)).reshape(-1, 8))
    assert corners.min() > 0.5
    assert ours.min() < 0.0


def test_gmsh_volume_of_tetrahedra_of_second_order_is_that_of_straight_ones() -> None:
    """A cylinder; the Jacobians that gmsh returns have the curved elements."""
    import gmsh

    gmsh.initialize()
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.option.setNumber("Mesh.MeshSizeMax", 2.0)
        gmsh.model.occ.addCylinder(0.0, 0.0, 0.0, 0.0, 0.0, 2.0, 5.0)
        gmsh.model.occ.synchronize()
        gmsh.model.mesh.generate(3)
        told = []
        for order in (1, 2):
            gmsh.model.mesh.setOrder(order)
            (kind,) = gmsh.model.mesh.getElementTypes(3)
            tags, _ = gmsh.model.mesh.getElementsByType(kind)
            told.append(gmsh.model.mesh.getElementQualities(tags, "volume").sum())
        points, weights = gmsh.model.mesh.getIntegrationPoints(kind, "Gauss6")
        _, determinants, _ = gmsh.model.mesh.getJacobians(kind, points)
    finally:
        gmsh.finalize()
    curved = (determinants.reshape(-1, len(weights)) @ weights).sum()
    assert told[1] == pytest.approx(told[0], rel=1e-9)
    assert curved == pytest.approx(50.0 * np.pi, rel=1e-4)
    assert told[1] < 0.995 * curved


def _bent_cubes(count: int) -> Array:
    """Nodes (count, 20, 3) of unit cubes whose corners, and more so mid-side nodes, are displaced at random."""
    rng = np.random.default_rng(7)
    corners = 0.5 * CORNER_PLACES + 0.04 * rng.standard_normal((count, 8, 3))
    first, last = np.array(HEX_EDGES).T
    middles = 0.5 * (corners[:, first] + corners[:, last]) + 0.1 * rng.standard_normal((count, 12, 3))
    return np.concatenate((corners, middles), axis=1)


needs_ccx = pytest.mark.skipif(shutil.which("ccx") is None, reason="apt-get install calculix-ccx")


@needs_ccx
def test_ccx_ties_within_a_share_of_the_masters_edge_unless_told(tmp_path: Path) -> None:
    """Cubes of 2 mm: a gap of 0.0070 of their edge is tied, one of 0.0073 is not, and is with a tolerance of one's own."""
    tied, free, wide = (
        _solved(tmp_path, 2.0, 2.0 * gap, f"*TIE, NAME=TIE{told}\nLOW, TOP\n")
        for gap, told in ((0.0070, ""), (0.0073, ""), (0.0073, ", POSITION TOLERANCE=0.05"))
    )
    message = "no tied MPC"
    assert message in free[0]
    assert message not in tied[0] + wide[0]


@needs_ccx
@pytest.mark.parametrize(("pair", "sign"), [("LOW, TOP", 1.0), ("TOP, LOW", -1.0)])
def test_ccx_prints_the_force_on_the_slave(pair: str, sign: float, tmp_path: Path) -> None:
    """The upper cube, of whose face is `LOW`, is pressed down with 1000 N: the force on it points up."""
    contact = (
        "*SURFACE INTERACTION, NAME=I\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR\n1e7\n"
        f"*CONTACT PAIR, INTERACTION=I, TYPE=SURFACE TO SURFACE\n{pair}\n"
    )
    slave, master = pair.split(", ")
    _, table = _solved(tmp_path, 1.0, -1e-5, contact, f"*CONTACT PRINT, SLAVE={slave}, MASTER={master}\nCF\n")
    force = [float(x) for x in table.split("moment about the origin (mx,my,mz)")[1].split()[:3]]
    area, normal = (float(x) for x in table.split("shear force (size)")[1].split()[:2])
    assert force[2] == pytest.approx(sign * 1000.0, rel=1e-5)
    assert (area, normal) == (pytest.approx(1.0, rel=1e-5), pytest.approx(-1000.0, rel=1e-5))


def _solved(folder: Path, edge: float, gap: float, joint: str, wanted: str = "") -> tuple[str, str]:
    """Messages and tables of ccx for two cubes, one above the other beyond a gap (mm) and pressed down with 1000 N."""
    square = ((0.0, 0.0), (edge, 0.0), (edge, edge), (0.0, edge))
    points = [(x, y, z) for z in (0.0, edge, edge + gap, 2.0 * edge + gap) for x, y in square]
    nodes = "".join(f"{k}, {x}, {y}, {z:.7f}\n" for k, (x, y, z) in enumerate(points, 1))
    upper = "".join(f"{k}, 1, 2\n" for k in range(9, 17))
    loads = "".join(f"{k}, 3, -250.\n" for k in range(13, 17))
    (folder / "cubes.inp").write_text(
        f"*NODE\n{nodes}*ELEMENT, TYPE=C3D8, ELSET=A\n1, 1,2,3,4,5,6,7,8\n"
        "*ELEMENT, TYPE=C3D8, ELSET=B\n2, 9,10,11,12,13,14,15,16\n*SURFACE, NAME=TOP, TYPE=ELEMENT\nA, S2\n"
        "*SURFACE, NAME=LOW, TYPE=ELEMENT\nB, S1\n*MATERIAL, NAME=S\n*ELASTIC\n210000., 0.\n"
        f"*SOLID SECTION, ELSET=A, MATERIAL=S\n*SOLID SECTION, ELSET=B, MATERIAL=S\n{joint}"
        f"*BOUNDARY\n1, 1, 3\n2, 1, 3\n3, 1, 3\n4, 1, 3\n{upper}*STEP\n*STATIC\n*CLOAD\n{loads}{wanted}*END STEP\n"
    )
    done = subprocess.run(["ccx", "cubes"], cwd=folder, capture_output=True, text=True)
    table = folder / "cubes.dat"
    return done.stdout + done.stderr, table.read_text() if table.exists() else ""
