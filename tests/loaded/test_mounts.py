"""Shafts and bearings that give way under load: closed forms of a spur pair, and the rigid limit."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.contact import STEEL
from gearmesh.errors import DesignError, Status
from gearmesh.loaded.compliance import FlankCompliance, flank_compliance
from gearmesh.loaded.mounts import FlexibleMount
from gearmesh.loaded.sharing import LoadedMesh, loaded_mesh
from gearmesh.mesh.hexahedra import Cells
from gearmesh.teeth import GearPair

INF = np.inf
BASE = 30.0 * np.cos(np.radians(20.0))
#: of 100 Nm, N
FORCE = 1e5 / BASE


@lru_cache
def spur() -> tuple[GearPair, tuple[FlankCompliance, FlankCompliance]]:
    pair = pair_of(gm.load(SAMPLES / "spur.toml"))
    cells = Cells(flank=6, fillet=4, thickness=3, rim=4, face=8)
    first, second = (
        flank_compliance(m.tooth, side, STEEL, cells) for m, side in zip(pair.both, pair.flanks, strict=True)
    )
    return pair, (first, second)


def under(pinion: FlexibleMount | None, gear: FlexibleMount | None = None) -> LoadedMesh:
    pair, bodies = spur()
    return loaded_mesh(pair, pair.pitch * np.array([0.0, 0.4]), np.array([1e5]), bodies, flexible=(pinion, gear))


def mean_station(found: LoadedMesh) -> float:
    """z of the middle of the load, mm."""
    (load,) = found.loads
    line = load.pressure.sum(axis=2) * (load.separation.dx * load.separation.dy)[:, None]
    return float((line * load.separation.middle[..., 2]).sum() / line.sum())


def test_what_hardly_gives_way_is_rigid() -> None:
    """Against no mounts at all: 1e-8 of the rotation, stresses as far as pressures settle."""
    rigid, stiff = under(None), under(FlexibleMount.of([1e16] * 3 + [1e20] * 3), FlexibleMount.of([INF] * 6))
    np.testing.assert_allclose(stiff.rotation, rigid.rotation, rtol=1e-8)
    np.testing.assert_allclose(stiff.root_stress, rigid.root_stress, rtol=1e-6)


def test_soft_bearings_shift_along_the_line_of_action() -> None:
    """Of either member: by F / k against the force, so that the pinion turns by that over its base radius; the transmission error
    falls behind by as much. 0.1 %: the centre distance grows and the angle of the force with it."""
    rigid = under(None)
    pair, _ = spur()
    for k, flexible in enumerate(
        ((FlexibleMount.of([2e4, 2e4, *[INF] * 4]), None), (None, FlexibleMount.of([2e4, 2e4, *[INF] * 4])))
    ):
        found = under(*flexible)
        assert (found.status == Status.CONVERGED).all()
        np.testing.assert_allclose(np.linalg.norm(found.displacement[..., k, :3], axis=-1), FORCE / 2e4, rtol=1e-3)
        np.testing.assert_array_equal(found.displacement[..., 1 - k, :], 0.0)
        np.testing.assert_allclose((found.rotation - rigid.rotation) * BASE, FORCE / 2e4, rtol=1e-3)
        np.testing.assert_allclose(
            found.te - rigid.te, -pair.drive * 0.5 * (found.rotation - rigid.rotation), rtol=1e-9
        )
    # the shaft's torsion: T / k
    twisted = under(FlexibleMount.of([*[INF] * 5, 1e8]))
    np.testing.assert_allclose(twisted.rotation - rigid.rotation, 1e5 / 1e8, rtol=1e-3)


def test_load_goes_to_the_bearing_of_an_overhung_pinion() -> None:
    """The tooth at the far end gives way, on whichever side the bearing is; moments are those of the force about it."""
    for z in (40.0, -40.0):
        found = under(FlexibleMount.of([INF, INF, INF, 1e7, 1e7, INF], z))
        assert (found.status == Status.CONVERGED).all()
        assert np.sign(z) * mean_station(found) > 5.0
        moment = 1e7 * np.linalg.norm(found.displacement[0, :, 0, 3:5], axis=-1)
        np.testing.assert_allclose(moment.mean(), FORCE * abs(z - mean_station(found)), rtol=5e-3)


def test_the_answer_tells_displacements_and_refuses_what_is_no_mount() -> None:
    gears = gm.build(gm.load(SAMPLES / "spur.toml"))
    row = gears.loaded(100, [0.0], mounts={"gear": FlexibleMount.of(np.diag([2e4, 2e4, 1e9, 1e12, 1e12, 1e12]))}).rows[
        0
    ]
    assert np.linalg.norm(row["gear_displacement_um"]) == pytest.approx(1e3 * FORCE / 2e4, rel=1e-3)
    assert "pinion_displacement_um" not in row
    with pytest.raises(DesignError, match="mounts = sun: must be of pinion or gear"):
        gears.loaded(100, [0.0], mounts={"sun": FlexibleMount.of([INF] * 6)})
    with pytest.raises(DesignError, match=r"stiffness = -1 in place 2 of 6: must be above 0; inf is rigid"):
        FlexibleMount.of([1, -1, 1, 1, 1, 1])
    with pytest.raises(DesignError, match="stiffness: must be symmetric and positive definite"):
        FlexibleMount.of(np.diag([1.0, 1.0, 1.0, 1.0, 1.0, -1.0]))
    with pytest.raises(DesignError, match=r"stiffness: has shape \(3,\); must be 6"):
        FlexibleMount.of([1, 1, 1])
    rack = pair_of(gm.load(SAMPLES / "rack.toml"))
    with pytest.raises(DesignError, match="mounts = pinion: those that give way are of gears of one row of teeth"):
        loaded_mesh(rack, np.zeros(1), np.array([1e3]), spur()[1], flexible=(FlexibleMount.of([INF] * 6), None))
