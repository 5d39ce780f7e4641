"""Worm drives under torque: equilibrium, Hertz on the lines of contact, threads that are the same after a turn, either hand."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

import gearmesh as gm
from gearmesh import GearPair, WormDriveDesign
from gearmesh.contact.hertz import STEEL, Material, contact_modulus
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.loaded.compliance.compliance import FlankCompliance, flank_compliance
from gearmesh.loaded.sharing import LoadedMesh, loaded_mesh, reach_of
from gearmesh.mesh.hexahedra.hexahedra import Cells
from gearmesh.systems.worm_drive.build import worm_thread
from gearmesh.systems.worm_drive.contact.conjugate import ThreadMesh

BRONZE = Material(95000.0, 0.35)
COARSE = Cells(flank=6, fillet=6, thickness=3, rim=3, face=9)
pytestmark = pytest.mark.sweep


@cache
def pair_of(hand: bool = True, hob: float = 40.0, flank: str = "right") -> tuple[WormDriveDesign, GearPair]:
    keys: dict[str, Any] = {"threads": 2, "right_hand": hand}
    made = gm.parse(
        {
            "kind": "worm_drive",
            "module": 4,
            "worm": keys,
            "wheel": {"teeth": 40},
            "hob": {"reference_diameter": hob},
            "contact": {"flank": flank},
        }
    )
    assert isinstance(made, WormDriveDesign)
    return made, gm.build(made).train.pairs[0]


@cache
def bodies_of(
    hand: bool = True, hob: float = 40.0, flank: str = "right", bronze: bool = False
) -> tuple[FlankCompliance, FlankCompliance]:
    pair = pair_of(hand, hob, flank)[1]
    materials = (STEEL, BRONZE if bronze else STEEL)
    first, second = (
        flank_compliance(member.one_tooth, side, material, COARSE, reach=reach_of(pair))
        for member, side, material in zip(pair.both, pair.flanks, materials, strict=True)
    )
    return first, second


def loaded(
    phi1: Array, torque: Array, hand: bool = True, hob: float = 40.0, flank: str = "right", bronze: bool = False
) -> LoadedMesh:
    materials = (STEEL, BRONZE if bronze else STEEL)
    return loaded_mesh(pair_of(hand, hob, flank)[1], phi1, torque, bodies_of(hand, hob, flank, bronze), materials)


PHI1 = np.radians([-40.0, 25.0, 100.0])


@pytest.mark.parametrize("hob", [40.0, 44.0])
def test_the_wheel_takes_the_ratio_times_the_torque(hob: float) -> None:
    """Without friction and where loaded gears turn at their ratio T2 = i T1; of the pairs' moments all of T1; of a small torque
    nothing but the unloaded transmission error is left."""
    torque = np.array([10.0, 2e4])
    found = loaded(PHI1, torque, hob=hob)
    np.testing.assert_allclose(found.gear_torque[0], 20.0 * torque[0], rtol=2e-4)
    np.testing.assert_allclose(found.gear_torque[1], 20.0 * torque[1], rtol=2e-3)
    for own, load in zip(torque, found.loads, strict=True):
        np.testing.assert_allclose(np.bincount(load.position, load.moment), own, rtol=1e-9)
    assert (found.status == 0).all()
    late = np.abs(found.te - found.unloaded).max(axis=1)
    assert late[0] < 3e-6
    # contact in points gives way by the torque to 2/3, the rest in proportion
    assert late[1] / late[0] > 100.0


def peaks_and_hertz(bronze: bool = False) -> tuple[Array, Array]:
    """Peaks of rows of cells across lines of contact, and sqrt(w kappa E* / pi), with kappa of the closed form for the thread at
    the place itself."""
    made, pair = pair_of()
    mesh = ThreadMesh(worm_thread(made), 1, made.wheel.teeth, made.center_distance, 0.0)
    load = loaded(PHI1, np.array([2e3]), bronze=bronze).loads[0]
    grid, modulus = load.separation, contact_modulus(STEEL, BRONZE if bronze else STEEL)
    width = grid.dy
    peaks, hertz = [], []
    for m in np.flatnonzero(load.force > 100.0):
        w = load.pressure[m].sum(axis=1) * width[m]
        peak = load.pressure[m].max(axis=1)
        flank = pair.pinion.one_tooth.side(pair.flanks[0]).flank
        rho = np.hypot(*grid.middle[m][:, :2].T)
        p = np.array([worm_thread(made).at_radius(radius) for radius in rho])
        kappa = mesh.at(p, np.arctan2(grid.middle[m][:, 1], grid.middle[m][:, 0])).curvature
        assert flank is not None
        inner = np.zeros(len(w), dtype=bool)
        inner[6:-6] = True
        # rows whose cells are all on both flanks
        inner &= grid.on[m].all(axis=1) & (w > 0.2 * w.max())
        peaks.append(peak[inner])
        hertz.append(np.sqrt(w * kappa * modulus / np.pi)[inner])
    return np.concatenate(peaks), np.concatenate(hertz)


@pytest.mark.parametrize("bronze", [False, True], ids=["steel", "bronze"])
def test_pressure_across_lines_of_contact_is_hertz(bronze: bool) -> None:
    """Line by line of cells."""
    peaks, hertz = peaks_and_hertz(bronze)
    np.testing.assert_allclose(peaks, hertz, rtol=0.03)
    assert peaks.size > 60


def test_threads_are_the_same_after_a_turn() -> None:
    """After a whole turn of the worm, and after half a turn with two threads, other turns of its threads carry just as much."""
    start = np.radians([25.0])
    first, half, whole = (loaded(start + turn, np.array([2e4])) for turn in (0.0, np.pi, 2.0 * np.pi))
    for other in (half, whole):
        np.testing.assert_allclose(np.sort(other.loads[0].force), np.sort(first.loads[0].force), rtol=1e-6)
        np.testing.assert_allclose(other.rotation, first.rotation, rtol=1e-6)
        np.testing.assert_allclose(other.bending, first.bending, rtol=1e-5)


@pytest.mark.parametrize(("flank", "sense"), [("right", 1.0), ("left", -1.0)])
def test_hands_are_mirror_images(flank: str, sense: float) -> None:
    """In the plane across the worm, which leaves its sense and its flank, and in one along it, which leaves neither. Of lines of
    contact rounding says which point is first."""
    right, left = (
        loaded(way * PHI1, np.array([2e4]), hand=hand, hob=44.0, flank=side)
        for way, hand, side in ((1.0, True, "right"), (sense, False, flank))
    )
    np.testing.assert_allclose(left.rotation, right.rotation, rtol=1e-6)
    np.testing.assert_allclose(np.sort(left.loads[0].force), np.sort(right.loads[0].force), rtol=1e-5)
    np.testing.assert_allclose(left.bending, right.bending, rtol=1e-5)


def test_a_bronze_wheel_gives_way_more() -> None:
    """Rotation under load is larger with a wheel of bronze than with one of steel, but by less than the ratio of the moduli.
    The whole ratio would need a worm of bronze, too."""
    steel, bronze = (loaded(PHI1, np.array([2e4]), bronze=soft) for soft in (False, True))
    ratio = STEEL.youngs_modulus / BRONZE.youngs_modulus
    assert (bronze.rotation > 1.2 * steel.rotation).all()
    assert (bronze.rotation < ratio * steel.rotation).all()


def test_loads_move_along_the_helix() -> None:
    """A thread under a load is what it is under the same load further along its helix, away from the ends of the arc."""
    body = bodies_of()[0]
    tooth, count = body.tooth, body.points.shape[1]
    angle = np.arctan2(body.points[3, :, 1], body.points[3, :, 0])
    np.testing.assert_allclose(np.diff(angle), np.diff(angle).mean(), rtol=0, atol=1e-9)
    middle = count // 2
    smooth = body.smooth[body.reach].reshape(*body.points.shape[:2], *body.points.shape[:2])
    for step in (1, 2):
        np.testing.assert_allclose(
            smooth[:, middle + step, :, middle + step], smooth[:, middle, :, middle], rtol=0, atol=2e-3 * smooth.max()
        )
    assert tooth.screw is not None
