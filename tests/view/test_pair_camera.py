"""From where a pair is looked at."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.view.views import pair_camera


@pytest.mark.parametrize("aside", [(-1e-9, -1e-9), (-1e-9, 1e-9), (1e-9, -1e-9), (1e-9, 1e-9)])
def test_a_worm_is_in_front_whatever_rounding_says(aside: tuple[float, float]) -> None:
    """It lies on both sides of the wheel, which lies on both sides of its axis: vertices whose mean is beside that tell nothing."""
    pair = gm.build(gm.load(SAMPLES / "worm_drive.toml")).train.pairs[0]
    corners = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
    bodies = []
    sizes = (20.0, 20.0, 40.0), (100.0, 100.0, 20.0)
    for mount, size, away in zip(pair.mounts, sizes, aside, strict=True):
        own = corners * size + [0.0, 0.0, away]
        bodies.append(own @ mount.base.rotation.T + mount.base.translation)
    camera = pair_camera(pair, *bodies, (800, 600))
    worm, wheel = (body.mean(axis=0) for body in bodies)
    assert (camera.position - camera.focus) @ (worm - wheel) > 0.0
