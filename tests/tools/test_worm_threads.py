"""Contact of a grinding disk with the flank of a worm."""

from __future__ import annotations

import numpy as np
import pytest

from gearmesh.kinds import Arc, RackLine
from gearmesh.tools.worm_threads import DiskLine

#: angles (rad) about the disk's axis that are looked at, and by how much (rad) a place may differ
TURNS, PLACE = np.linspace(-1.2, 1.2, 4801), 1e-3


def _touched(disk: DiskLine, point: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """Angles at which a point of the profile passes the thread along it, by sampling the speed along the normal of the disk that is
    turned about its axis as a whole."""
    axis = np.array([0.0, -np.sin(disk.tilt), np.cos(disk.tilt)])
    foot = np.array([disk.distance, 0.0, disk.middle])

    def turned(vector: np.ndarray) -> np.ndarray:
        # Rodrigues
        c, s = np.cos(TURNS)[:, None], np.sin(TURNS)[:, None]
        return c * vector + s * np.cross(axis, vector) + (1.0 - c) * (axis @ vector) * axis

    r, n = foot + turned(point - foot), turned(normal)
    speed = n[:, 1] * r[:, 0] - n[:, 0] * r[:, 1] + disk.screw * n[:, 2]
    change = np.flatnonzero(speed[:-1] * speed[1:] <= 0.0)
    return TURNS[change]


@pytest.mark.parametrize("arc", [False, True], ids=["ZK", "ZC"])
def test_a_disk_touches_where_it_passes_along_the_thread(*, arc: bool) -> None:
    rng = np.random.default_rng(5)
    found = 0
    for _ in range(12):
        screw, radius = 0.5 * rng.integers(1, 7), rng.uniform(3.0, 10.0)
        angle, b = np.radians(rng.uniform(15.0, 25.0)), rng.uniform(-0.9, -0.6)
        centre = (6.0 * np.sin(angle), -b - 6.0 * np.cos(angle))
        profile = Arc(centre, -6.0) if arc else RackLine(angle, 0.0, b)
        disk = DiskLine(
            profile, radius, screw, np.arctan(screw / radius), 0.5 * np.pi, radius - 1.2 + rng.uniform(12.0, 40.0)
        )
        p = angle + np.linspace(-0.25, 0.25, 9) if arc else np.linspace(-2.0, 2.0, 9)
        at, section = disk.at(p), profile.section(p)
        across = np.array([0.0, -np.sin(disk.tilt), np.cos(disk.tilt)])
        for k in range(p.size):
            (x, y), (n_x, n_y) = section[0][k], section[2][k]
            start = np.array([radius + x, 0.0, disk.middle]) - y * across
            turns = _touched(disk, start, n_x * np.array([1.0, 0.0, 0.0]) - n_y * across)
            if not turns.size:
                assert np.isnan(at.c[k]).all()
                continue
            away = at.c[k] - np.array([disk.distance, 0.0, disk.middle])
            angle_of = np.arctan2(-away @ np.cross(across, [1.0, 0.0, 0.0]), -away[0])
            assert abs(angle_of - turns[np.abs(turns).argmin()]) < PLACE
            speed = at.n[k, 1] * at.c[k, 0] - at.n[k, 0] * at.c[k, 1] + screw * at.n[k, 2]
            assert abs(speed) < 1e-12
            found += 1
    assert found > 50


def test_derivatives_along_the_line_of_a_disk_are_those_of_its_points() -> None:
    disk = DiskLine(RackLine(0.35, 0.0, -0.7), 5.0, 1.5, np.arctan(0.3), 0.5 * np.pi, 24.0)
    p, step = np.linspace(-0.8, 0.8, 5), 1e-5
    at, before, after = (disk.at(p + change) for change in (0.0, -step, step))
    assert np.abs((after.c - before.c) / (2.0 * step) - at.c_p).max() < 1e-8
    assert np.abs((after.n - before.n) / (2.0 * step) - at.n_p).max() < 1e-8


def test_a_disk_touches_nowhere_beyond_the_profile_left_by_a_steep_thread() -> None:
    disk = DiskLine(RackLine(0.35, 0.0, -0.7), 3.0, 3.0, np.arctan(1.0), 0.5 * np.pi, 31.8)
    p = np.array([-1.0, 1.0, 3.0, 10.0, 20.0])
    section, across = disk.profile.section(p), np.array([0.0, -np.sin(disk.tilt), np.cos(disk.tilt)])
    starts = np.array([3.0, 0.0, disk.middle]) + _outward(section[0]) - section[0][:, 1:] * across
    normals = _outward(section[2]) - section[2][:, 1:] * across
    touched = [bool(_touched(disk, *both).size) for both in zip(starts, normals, strict=True)]
    assert touched == [True, True, False, False, False]
    assert (np.isfinite(disk.at(p).c).all(axis=-1) == touched).all()


def _outward(plane: np.ndarray) -> np.ndarray:
    """The part along x of points or vectors of the profile."""
    return plane[:, :1] * np.array([1.0, 0.0, 0.0])
