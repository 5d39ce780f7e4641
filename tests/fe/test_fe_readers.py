"""What meshio and VTK make of our finite-element files, as the README's table says it."""

from __future__ import annotations

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


def _bent_cubes(count: int) -> Array:
    """Nodes (count, 20, 3) of unit cubes whose corners, and more so mid-side nodes, are displaced at random."""
    rng = np.random.default_rng(7)
    corners = 0.5 * CORNER_PLACES + 0.04 * rng.standard_normal((count, 8, 3))
    first, last = np.array(HEX_EDGES).T
    middles = 0.5 * (corners[:, first] + corners[:, last]) + 0.1 * rng.standard_normal((count, 12, 3))
    return np.concatenate((corners, middles), axis=1)
