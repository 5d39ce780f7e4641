"""Root stress: default elements against converged plane strain, the estimate of the error, and what is the contact's own field."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.examples import some
from oracles.places import SAMPLES
from oracles.plane_strain import bending, nominal, pressed_nodes
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu

import gearmesh as gm
from gearmesh import GearPair
from gearmesh.contact.hertz import STEEL
from gearmesh.fe.results import principal_stresses
from gearmesh.loaded.compliance.compliance import COARSER_CELLS, SECTOR_CELLS, FilletStress, assemble
from gearmesh.loaded.compliance.incompatible_modes import corner_stresses, unknowns
from gearmesh.loaded.compliance.sector_grid import crowd, sector_grid
from gearmesh.loaded.root_stress import MESH_ERROR_SHARE, OWN_FIELD_SHARE, Pressed
from gearmesh.mesh.hexahedra.hexahedra import Cells, hex_mesh, plain_grid, whole_rim

#: places of the load on the flank: the elements next to it do not reach a large fillet, but one that is small beside them
HEIGHT, LOW, HIGH = 0.55, 0.3, 0.8
PAIRS = {
    "27/35": (
        "spur",
        *("module=3", "pinion.teeth=27", "gear.teeth=35", "pinion.profile_shift=0", "gear.profile_shift=0"),
        *("assembly.center_distance=93", "pinion.bore=40.5", "gear.bore=52.5"),
    ),
    "12/60": (
        "spur",
        *("module=2", "pinion.teeth=12", "gear.teeth=60", "pinion.profile_shift=0.5", "gear.profile_shift=-0.5"),
        *("assembly.center_distance=72", "pinion.bore=10", "gear.bore=60"),
    ),
    "ring": ("internal",),
    # sharp fillets on deep bodies; of the last two tangents never are at 30 deg
    "modified_involute": ("modified_involute",),
    "novikov": ("novikov",),
    "circular_arc": ("circular_arc",),
}


@cache
def pair(name: str) -> GearPair:
    sample, *keys = PAIRS[name]
    return pair_of(gm.load(SAMPLES / f"{sample}.toml", keys))


def by_bricks(name: str, member: int, cells: Cells, height: float, teeth: int = 5) -> float:
    """Stress of `bending`, but by the bricks and lines of `loaded`: the section at the toe, 1 mm wide, without displacement
    along the axis."""
    tooth, side = pair(name).both[member].tooth, pair(name).flanks[member]
    one = Cells(cells.flank, cells.fillet, cells.thickness, cells.rim, 1)
    rim = whole_rim(tooth, np.linspace(0.0, 1.0, 2))
    twisted = hex_mesh(tooth, np.arange(teeth) - teeth // 2, sector_grid(tooth, side, one), rim)
    toe, heel = np.split(twisted.nodes, 2)
    width = np.array([0.0, 0.0, np.sign((heel - toe)[0, 2])])
    mesh = replace(twisted, nodes=np.concatenate((toe, toe + width)))
    held = np.zeros((len(mesh.nodes), 3), dtype=bool)
    held[:, 2] = held[mesh.node_sets["rim"]] = True
    free, right, moved = np.flatnonzero(~held), np.zeros(held.shape), np.zeros(held.size)
    at_toe, middle = np.arange(len(mesh.nodes)) < len(toe), teeth // 2 + 1
    nodes, force = pressed_nodes(mesh, f"flank_{side}_{middle}", at_toe, tooth, side, height)
    right[nodes, :2] = right[nodes + len(toe), :2] = 0.5 * force
    moved[free] = splu(csc_array(assemble(mesh, STEEL))[free][:, free]).solve(right.ravel()[free])
    fillet = mesh.node_sets[f"fillet_{side}_{middle}"]
    fillet = fillet[at_toe[fillet]]
    element, corner = np.nonzero(np.isin(mesh.elements, fillet))
    stress = corner_stresses(mesh.nodes[mesh.elements], STEEL) @ moved[unknowns(mesh.elements)][:, None, :, None]
    total = np.zeros((len(mesh.nodes), 6))
    np.add.at(total, mesh.elements[element, corner], stress[element, corner, :, 0])
    mean = total[fillet] / np.bincount(mesh.elements[element, corner], minlength=len(total))[fillet, None]
    return nominal(tooth, side, mesh.nodes[fillet], principal_stresses(mean)[:, 2])


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("name", "member", "height", "within"),
    some(
        [
            ("27/35", 1, HEIGHT, 0.025),
            ("12/60", 0, HEIGHT, 0.025),
            ("ring", 1, HEIGHT, 0.025),
            ("modified_involute", 1, LOW, 0.025),
            ("novikov", 1, LOW, 0.025),
            ("novikov", 1, HEIGHT, 0.025),
            ("circular_arc", 1, LOW, 0.025),
            ("circular_arc", 1, HIGH, 0.03),
        ],
        3,
    ),
)
def test_default_elements_are_close_to_converged_plane_strain(
    name: str, member: int, height: float, within: float
) -> None:
    """Compare with quadrilaterals of second order, twice as fine as the bricks."""
    teeth, side = pair(name).both[member].tooth, pair(name).flanks[member]
    coarse, converged = (
        bending(teeth, side, STEEL, crowd(plain_grid(cells)), height)
        for cells in (Cells(16, 16, 6, 8, 1), Cells(24, 24, 9, 12, 1))
    )
    assert abs(converged / coarse - 1.0) < 0.01
    found = by_bricks(name, member, SECTOR_CELLS, height)
    assert found == pytest.approx(converged, rel=within)
    if height > LOW:
        # the error is a quarter to twice the estimate of it
        estimate = MESH_ERROR_SHARE * (found - by_bricks(name, member, COARSER_CELLS, height)) / found
        assert 0.25 < (1.0 - found / converged) / estimate < 2.0


def fillet_of(places: np.ndarray) -> FilletStress:
    """Places of a fillet, far from the ends of a flank of 100 mm with a lowest eighth of 1 mm."""
    points = np.stack(np.meshgrid([0.0], [0.0, 1.0], np.linspace(-50.0, 50.0, 11), indexing="ij"), axis=-1)[0]
    tooth = pair("27/35").pinion.tooth
    return FilletStress(tooth, points, places, np.zeros((1, len(places), 6, 22)), np.zeros((0, len(places))), 1.0)


def pressed(line: np.ndarray, places: np.ndarray) -> Pressed:
    none = np.zeros(0, dtype=np.intp)
    return Pressed(line[None], places[None], np.zeros(1, dtype=np.intp), (none, none, none), 0.3)


@pytest.mark.quick
def test_the_contacts_own_field_ends_where_boussinesq_says() -> None:
    """Beside a force: (1 - 2 nu) F / (2 pi r^2) is the share OWN of the stress there; twice that at an end face; of a line only
    what is next to it, and that beyond its ends."""
    force, stress = 1000.0, 40.0
    radius = np.sqrt(0.4 * force / (2.0 * np.pi * OWN_FIELD_SHARE * stress))
    assert radius > 3.0
    away = np.array([[0.0, -r, 0.0] for r in (0.99 * radius, 1.01 * radius)])
    ends = np.array([[0.0, 0.0, -0.1], [0.0, 0.0, 0.1]])
    point = pressed(np.array([0.5 * force, 0.5 * force]), ends)
    np.testing.assert_array_equal(point.field(fillet_of(away), away, np.full((1, 2), stress)), [[True, False]])
    at_end = pressed(np.array([0.5 * force, 0.5 * force]), ends + np.array([0.0, 0.0, 49.9]))
    close = np.array([[0.0, -r * np.sqrt(2.0), 49.9] for r in (0.98 * radius, 1.02 * radius)])
    np.testing.assert_array_equal(at_end.field(fillet_of(close), close, np.full((1, 2), stress)), [[True, False]])
    z = np.linspace(-40.0, 40.0, 801)
    line = pressed(np.full(801, 30.0), np.stack((0.0 * z, 0.0 * z, z), axis=-1))
    beside = np.array([[0.0, -0.9, 0.0], [0.0, -1.5, 0.0], [0.0, 0.0, 41.5]])
    np.testing.assert_array_equal(line.field(fillet_of(beside), beside, np.full((1, 3), 100.0)), [[True, False, True]])


@pytest.mark.quick
def test_nodes_that_carry_the_load_are_no_places_of_the_fillet() -> None:
    places = np.array([[0.0, 0.0, -50.0], [0.0, 0.0, 10.0], [0.0, -1e-3, 10.0], [0.0, -1.0, 0.0]])
    assert fillet_of(places).below_flank.tolist() == [False, False, True, True]


@pytest.mark.sweep
def test_a_corner_that_is_pressed_does_not_raise_the_stress_of_the_fillet() -> None:
    """At 9.4 deg contact begins at an end face next to the fillet of the pinion. There the node on the border of flank and fillet
    has 78 MPa; with elements graded to the end face, or twice as fine, this tooth has 48 to 51 MPa in all, another one the most."""
    rows = gm.build(gm.load(SAMPLES / "helical.toml")).loaded_contact(500.0, [9.0, 9.4, 9.8]).rows
    before, pressed_corner, after = (row.fillets["pinion"].root_stress for row in rows)
    assert pressed_corner == pytest.approx(0.5 * (before + after), rel=0.01)
    assert rows[1].fillets["pinion"].contact_stress > 1.1 * pressed_corner
