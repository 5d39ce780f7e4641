"""From where a pair is looked at."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.built import built_sample
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.kernel.numeric.algebra import rotation_about
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


@pytest.mark.sweep
def test_a_rack_is_level_and_a_ring_fills_its_picture() -> None:
    """Both ends of an edge of the rack are at one height. Face gears fill the picture; 35 % above them was blank."""
    scene = built_sample("rack").picture("pair", size=(800, 600))._scene
    rack = scene.bodies[1]
    low, high = (rack.own_to_scene.point(rack.mesh.vertices[end]) for end in _ends(rack.mesh.vertices))
    seen = scene.camera.pixels(np.stack((low, high)), (800, 600))
    assert abs(seen[1, 1] - seen[0, 1]) < 1.0 < 800.0 < abs(seen[1, 0] - seen[0, 0])
    # it goes on beyond the picture; with both ends seen a third of the height was blank
    both = np.concatenate(
        [scene.camera.pixels(body.own_to_scene.point(body.mesh.vertices), (800, 600)) for body in scene.bodies]
    )
    assert 0.75 * 600 < np.ptp(both[:, 1]) < 0.9 * 600
    assert seen[:, 0].max() > 800.0
    assert seen[:, 0].min() < 0.0
    scene = built_sample("face_gear").picture("pair", size=(800, 600))._scene
    seen = np.concatenate(
        [scene.camera.pixels(body.own_to_scene.point(body.mesh.vertices), (800, 600)) for body in scene.bodies]
    )
    assert np.ptp(seen[:, 0]) * np.ptp(seen[:, 1]) > 0.55 * 800 * 600
    # under the heading, and within the picture
    assert seen[:, 1].min() > 0.09 * 600
    assert seen[:, 1].max() < 600
    # gear sets fill theirs as pairs do; they took 0.77 of the height
    scene = built_sample("planetary").picture("pair", size=(800, 600))._scene
    ring = scene.bodies[-1]
    seen = scene.camera.pixels(ring.own_to_scene.point(ring.mesh.vertices), (800, 600))
    assert np.ptp(seen[:, 1]) > 0.82 * 600
    assert 0.09 * 600 < seen[:, 1].min() < seen[:, 1].max() < 600


@pytest.mark.sweep
def test_gear_sets_stand_at_the_position_that_is_asked_for() -> None:
    """The first member has turned by it about its axis, in the sense of phi1."""
    gears = built_sample("planetary")
    still, turned = (gears.picture("pair", size=(80, 60), phi1=phi1)._scene.bodies[0] for phi1 in (0.0, 7.0))
    before, after = (body.own_to_scene.point(body.mesh.vertices) for body in (still, turned))
    turn = rotation_about("z", -gears.train.pairs[0].drive * np.radians(7.0))
    np.testing.assert_allclose(after, before @ turn.T, atol=1e-9)


@pytest.mark.quick
@pytest.mark.parametrize("view", ["pair", "section", "zone", "te", "backlash", "turns"])
def test_views_of_all_members_take_none(view: str) -> None:
    with pytest.raises(gm.DesignError, match=f"member = gear: the view {view} shows all members"):
        built_sample("spur").picture(view, "gear")


@pytest.mark.quick
@pytest.mark.parametrize("view", ["tool", "contact_lines", "backlash", "turns"])
def test_views_without_a_position_take_none(view: str) -> None:
    with pytest.raises(gm.DesignError, match=f"phi1 = 5: the view {view} shows"):
        built_sample("spur").picture(view, phi1=5)


def _ends(vertices: np.ndarray) -> tuple[int, int]:
    """Numbers of the ends of the longest straight edge along a rack: alike but for their place along it."""
    spread = np.ptp(vertices, axis=0)
    along = int(spread.argmax())
    across = np.delete(vertices, along, axis=1).round(6)
    first = int(vertices[:, along].argmin())
    alike = np.flatnonzero((across == across[first]).all(axis=1))
    return first, int(alike[vertices[alike, along].argmax()])
