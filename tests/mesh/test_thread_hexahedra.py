"""Hexahedra of threads, which are cut by half planes through the axis: on the exact helicoids, of any length and either hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import gearmesh as gm
from gearmesh import WormDriveDesign
from gearmesh.kernel.numeric.algebra import about_z
from gearmesh.kinds import Side, Tooth
from gearmesh.mesh.hexahedra.hex_quality import scaled_jacobian, volumes
from gearmesh.mesh.hexahedra.hexahedra import Cells, hex_mesh, plain_grid
from gearmesh.mesh.hexahedra.hexes import HexMesh
from gearmesh.mesh.hexahedra.layers import HALF_ARC, layers, running_angle
from gearmesh.systems.worm_drive.build import worm_thread

COARSE = Cells(flank=6, fillet=5, thickness=2, rim=3, face=12)


def design(**worm: Any) -> WormDriveDesign:
    made = gm.parse({"kind": "worm_drive", "module": 4, "worm": {"threads": 1, **worm}, "wheel": {"teeth": 40}})
    assert isinstance(made, WormDriveDesign)
    return made


def tooth_of(made: WormDriveDesign) -> Tooth:
    return gm.build(made).members["worm"].one_tooth


def meshed(tooth: Tooth, second_order: bool = False) -> HexMesh:
    return hex_mesh(tooth, np.array([-1, 0, 1]), plain_grid(COARSE), second_order=second_order)


@pytest.mark.parametrize("second_order", [False, True])
@pytest.mark.parametrize("worm", [{}, {"threads": 3, "form": "ZA", "right_hand": False}], ids=["ZI 1", "ZA 3 left"])
@pytest.mark.sweep_cases("ZA 3 left-False", "ZA 3 left-True", "ZI 1-True")
def test_flanks_of_threads_are_the_helicoids(worm: dict[str, Any], second_order: bool) -> None:
    """Moved along the helix to the half plane y = 0 all nodes lie on the curve of the axial section, that of a thread a pitch
    further for a neighbour's; the elements are well shaped."""
    made = design(**worm)
    mesh, thread = meshed(tooth_of(made), second_order), worm_thread(made)
    screw = thread.hand * thread.screw
    for side, sign in (("right", 1), ("left", -1)):
        for k in (1, 2, 3):
            points = mesh.nodes[mesh.node_sets[f"flank_{side}_{k}"]]
            rho = np.hypot(points[:, 0], points[:, 1])
            z = points[:, 2] - screw * np.arctan2(points[:, 1], points[:, 0])
            own = z + (k - 2) * thread.hand * thread.axial_pitch
            # the right side looks along the hand's way, and is that of the thread's own
            exact = [sign * thread.hand * thread.half_thickness(radius) for radius in rho]
            np.testing.assert_allclose(own, exact, rtol=0, atol=1e-9)
    assert scaled_jacobian(mesh.nodes, mesh.elements).min() > 0.4


def test_run_outs_change_no_thread_between_them() -> None:
    """The same nodes as of a thread cut square, over half a turn in the middle; the end of a run-out is none of a screw surface."""
    square, withdrawn = (meshed(tooth_of(design(length=40.0, run_out=way))) for way in (0.0, 10.0))
    np.testing.assert_allclose(withdrawn.nodes, square.nodes, rtol=0, atol=1e-9)
    assert scaled_jacobian(withdrawn.nodes, withdrawn.elements).min() > 0.4


def test_volume_of_a_screwed_section() -> None:
    """A section in a half plane sweeps its area times the way of its centroid about the axis: by Gauss over the radius, from the
    thread's axial thickness; the hexahedra are short of it by second order."""
    made = design()
    tooth, thread = tooth_of(made), worm_thread(made)
    tip, root = (0.5 * made.reference_diameter + k * made.axial_module for k in (1.0, -1.2))
    rounding = thread.root_rounding(root, made.worm.root_rounding * made.axial_module)
    form = float(thread.section.axial_section(np.array(rounding.form_point[0]))[0][0])
    nodes, weights = np.polynomial.legendre.leggauss(24)

    def above(low: float, high: float, width: Any) -> float:
        rho = 0.5 * (low + high) + 0.5 * (high - low) * nodes
        return float(0.5 * (high - low) * (weights * rho * np.array([width(radius) for radius in rho])).sum())

    # the arc of the rounding, tangent to flank and root
    size, (x, y) = made.worm.root_rounding * made.axial_module, rounding.arc.centre
    centre = thread.radius + float(x)

    def fillet(rho: float) -> float:
        return 2.0 * (-float(y) - np.sqrt(size**2 - (rho - centre) ** 2))

    moment = above(form, tip, lambda rho: 2.0 * thread.half_thickness(rho)) + above(root, form, fillet)
    coarse = meshed(tooth)
    inner = np.hypot(*coarse.nodes[coarse.node_sets["rim"], :2].T).min()
    moment += thread.axial_pitch * 0.5 * (root**2 - inner**2)
    exact = 2.0 * HALF_ARC * moment
    short = []
    for finer in (1, 2):
        cells = Cells(*(finer * n for n in (6, 5, 2, 3, 12)), edge=1)
        mesh = hex_mesh(tooth, np.array([0]), plain_grid(cells))
        short.append(exact - volumes(mesh.nodes, mesh.elements).sum())
    assert 0.0 < short[1] < 0.01 * exact
    assert 3.7 < short[0] / short[1] < 4.3


def test_hands_are_mirror_images() -> None:
    right, left = (meshed(tooth_of(design(threads=2, right_hand=hand))) for hand in (True, False))
    mirrored = right.nodes * np.array([1.0, -1.0, 1.0])
    for name, other in (("flank_right_1", "flank_left_3"), ("fillet_left_2", "fillet_right_2"), ("land", "land")):
        a, b = mirrored[right.node_sets[name]], left.nodes[left.node_sets[other]]
        order = [np.lexsort(np.round(points, 6).T) for points in (a, b)]
        np.testing.assert_allclose(a[order[0]], b[order[1]], rtol=0, atol=1e-12)


def test_threads_of_two_leads_fit_together() -> None:
    """The cut between two threads is one and the same, seen from either."""
    tooth = tooth_of(design(dual_lead=0.02))
    mesh = hex_mesh(tooth, np.array([0]), plain_grid(COARSE))
    step = layers(tooth, [0.5]).step
    right, left = (mesh.nodes[mesh.node_sets[f"cut_{side}"]] for side in Side)
    moved = step.point(right)
    apart = np.linalg.norm(moved[:, None] - left, axis=-1).min(axis=1)
    assert apart.max() < 1e-12


def test_angles_run_on_along_threads() -> None:
    tooth = tooth_of(design())
    flank = tooth.side(Side.RIGHT).flank
    v = np.linspace(-9.0, 9.0, 37)
    jet = flank.jet(np.full_like(v, tooth.right.tip), v)
    np.testing.assert_allclose(np.diff(running_angle(tooth, jet.r)), 0.5, rtol=0, atol=1e-12)
    assert tooth.screw == pytest.approx(2.0, abs=1e-12)
    turned = about_z(np.cos(1.0), np.sin(1.0), jet.r) + np.array([0.0, 0.0, 2.0])
    np.testing.assert_allclose(running_angle(tooth, turned), running_angle(tooth, jet.r) + 1.0, rtol=0, atol=1e-12)
