"""Pictures of flanks that wind round their axis: what touches is seen, and not hidden behind the next thread."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import load
from gearmesh.answers.contact.staging import flank_places
from gearmesh.contact.flanks import analyse
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.solid import gear_solid
from gearmesh.view.on_tooth import union_level
from gearmesh.view.pictures import PICTURE_SIZE, contact_picture
from gearmesh.view.scene import beside_bar, contact_on


def test_contact_on_a_thread_is_seen() -> None:
    """Rays from the points of contact near the middle of the picture to the camera do not meet the worm again."""
    pair = pair_of(load(str(SAMPLES / "worm_drive.toml"), ["wheel.form=helical", "wheel.face_width=25"]))
    path = analyse(pair, np.radians(np.linspace(-60.0, 60.0, 13)))
    camera = contact_picture(pair, "worm", path).camera
    contact = contact_on(0, path, pair.mounts)
    near = np.linalg.norm(contact.point - camera.focus, axis=-1) < 0.3 * camera.height
    assert near.sum() >= 2
    starts = contact.point[near] + 0.1 * contact.normal[near]
    mesh = gear_solid(pair.pinion, 0.02)
    assert not any(hidden(start, camera.axes, mesh.vertices[mesh.triangles]) for start in starts)


@pytest.mark.sweep
def test_contact_on_this_side_of_a_worm_is_in_the_picture() -> None:
    """Contact goes more than once round the axis: of its points all that are on the side of the axis that is seen."""
    pair = pair_of(load(str(SAMPLES / "worm_drive.toml"), ["hob.reference_diameter=66"]))
    path = analyse(pair, np.radians(np.linspace(-200.0, 200.0, 21)))
    camera = contact_picture(pair, "worm", path).camera
    contact = contact_on(0, path, pair.mounts)
    lead = 10.0 * np.pi  # two threads of module 5 mm
    near = np.abs(contact.point[:, 2] - contact.middle[2]) < 0.5 * lead
    facing = contact.point[:, :2] @ camera.axes[2, :2] > 0.0
    points = contact.point[np.isfinite(contact.point[:, 0]) & near & facing]
    x, y, _ = camera.pixels(points, PICTURE_SIZE).T
    assert len(points) >= 5
    assert x.min() > 0.03 * PICTURE_SIZE[0]
    assert x.max() < 0.97 * PICTURE_SIZE[0]
    assert y.min() > 0.03 * PICTURE_SIZE[1]
    assert y.max() < 0.97 * PICTURE_SIZE[1]


def test_grid_of_a_thread_is_as_fine_as_that_of_a_tooth() -> None:
    """A pattern is narrower than the 6 mm by which the columns of a tooth's grid would be apart on the worm."""
    pair = pair_of(load(str(SAMPLES / "worm_drive.toml"), []))
    for member, side, fewest in zip(pair.members.values(), pair.flanks, (150, 65), strict=True):
        s, t = flank_places(member.tooth, side)
        root = member.tooth.flank_grid(side, s[:1], t).points[0]
        assert (len(s), len(t) >= fewest) == (41, True)
        assert np.linalg.norm(np.diff(root, axis=0), axis=-1).max() < 2.5  # mm; 0.2 of a depth of 11 mm


def test_pattern_on_a_worm_is_where_its_ellipses_are() -> None:
    """And not on the far side of the thread, which the tangent planes of ellipses cut, too."""
    pair = pair_of(load(str(SAMPLES / "worm_drive.toml"), ["hob.reference_diameter=66"]))
    path = analyse(pair, np.radians(np.linspace(-150.0, 150.0, 31)))
    contact = contact_on(0, path, pair.mounts)
    grid = pair.pinion.tooth.flank_grid(pair.flanks[0], np.linspace(0.0, 1.0, 21), np.linspace(0.0, 1.0, 201)).points
    within = grid[union_level(contact, grid) <= 1.0]
    centres = contact.point[contact.ellipses]
    away = np.linalg.norm(within[:, None] - centres, axis=-1).min(axis=1)
    assert len(within) > 100
    assert away.max() < 1.5 * np.nanmax(contact.semi_major)


def hidden(start: Array, axes: Array, corners: Array) -> bool:
    """True if a triangle, of `corners` (M, 3, 3), lies between a point (3,) and a camera of `axes` (right, up, back) (3, 3)."""
    x, y, z = np.moveaxis((corners - start) @ axes.T, -1, 0)
    after = [1, 2, 0]
    areas = x * y[:, after] - x[:, after] * y
    around = (areas > 0.0).all(axis=1) | (areas < 0.0).all(axis=1)
    depth = (areas[:, after] * z).sum(axis=1)[around] / areas[around].sum(axis=1)
    return bool((depth > 0.0).any())


@pytest.mark.sweep
def test_gap_of_one_position_is_in_the_middle_of_the_picture() -> None:
    """The path of contact of a ZI worm goes round the thread; the roll test of one position touches a part of it at its side."""
    gears = gm.build(load(str(SAMPLES / "worm_drive.toml"), []))
    scene = gears.picture("gap", size=(400, 300))._scene
    (values,) = scene.maps
    points = values.points[np.isfinite(values.values)]
    x, _, _ = scene.camera.pixels(points, beside_bar(scene.size)).T
    assert 0.35 < np.median(x) / beside_bar(scene.size)[0] < 0.65
