"""What VTK is told to draw: no gaps between facets, no specks, nothing that shines through."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from oracles.built import built_sample

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import rotation_about
from gearmesh.view.offscreen.shapes import drawing_order
from gearmesh.view.on_tooth import area_edges
from gearmesh.view.scene import Camera, Scene

SIZE = (400, 300)


@pytest.fixture(scope="module")
def scene() -> Scene:
    """A tooth of a spur gear, its body cut open, its end faces seen edge-on."""
    return built_sample("spur").picture("contact", size=SIZE)._scene


def points(primitive) -> np.ndarray:
    return np.frombuffer(primitive["points"], dtype=np.float32).reshape(-1, 3)


def test_facets_that_share_a_corner_share_its_place_in_the_picture(scene: Scene) -> None:
    """To the bit, though each goes back by its own slope: else pixels between them are left open, and show what is behind."""
    askew = Camera(np.array([31.0, 57.0, 93.0]), np.array([0.1, 0.2, 0.3]), np.array([0.2, 1.0, 0.1]), 20.0)
    for body in scene.bodies:
        alone = Scene((replace(body, yields=False),), camera=askew)
        (facets,) = (one for one in drawing_order(alone, SIZE)["primitives"] if one["lit"])
        mesh, (x, y, z) = body.mesh, points(facets).T
        assert len(np.unique(z)) > 1.5 * len(mesh.vertices)
        owner = mesh.triangles.ravel()
        for own in (x, y):
            first = np.full(len(mesh.vertices), np.nan, dtype=np.float32)
            first[owner] = own
            assert (first[owner] == own).all()


def test_what_is_behind_an_end_face_seen_edge_on_does_not_stand_beside_it(scene: Scene) -> None:
    """Its triangles are lines of the colour of the inside, before lines that are farther away, behind its own outline."""
    opened = next(body for body in scene.bodies if body.yields)
    assert scene.camera.front is not None
    lines = [one for one in drawing_order(scene, SIZE)["primitives"] if one["corners"] == 2]
    inside = [one for one in lines if one["colour"] == tuple(part / 255.0 for part in (0xF4, 0xF6, 0xF8))]
    assert len(inside) == 1
    ends = points(inside[0])[np.frombuffer(inside[0]["cells"], dtype=np.int64)]
    across = np.abs((opened.own_to_scene.point(opened.mesh.vertices) - scene.camera.focus) @ scene.camera.axes[0]).max()
    np.testing.assert_allclose(np.abs(ends[:, 0]), across, rtol=1e-5)
    turned = replace(opened, own_to_scene=opened.own_to_scene @ Rigid(rotation_about("x", 0.2), np.zeros(3)))
    askew = drawing_order(replace(scene, bodies=(turned,)), SIZE)["primitives"]
    assert not [one for one in askew if one["corners"] == 2 and one["colour"] == inside[0]["colour"]]


def test_facets_that_turn_away_by_their_exact_normals_are_of_the_inside(scene: Scene) -> None:
    opened = next(body for body in scene.bodies if body.yields)

    def count(normals: np.ndarray) -> int:
        body = replace(opened, mesh=replace(opened.mesh, normals=normals))
        primitives = drawing_order(replace(scene, bodies=(body,)), SIZE)["primitives"]
        (outer,) = (one for one in primitives if one["lit"])
        return len(outer["cells"]) // 24

    mesh = opened.mesh
    a, b, c = np.moveaxis(opened.own_to_scene.point(mesh.corners()), 1, 0)
    facing = np.cross(b - a, c - a) @ scene.camera.axes[2] > 1e-6
    assert 0 < count(mesh.normals) <= facing.sum() < len(facing)
    away = opened.own_to_scene.vector(mesh.normals) @ scene.camera.axes[2] < 0.0
    assert count(-mesh.normals) == (facing & away).sum() < 0.01 * len(facing)


@pytest.mark.quick
def test_the_border_of_an_area_is_drawn_where_the_area_comes_to_it() -> None:
    """A flank 4 mm wide and 2 mm high, with an area left of x = 2.5: of three sides, those at the bottom and top up to there."""
    x, y = np.meshgrid(np.arange(5.0), np.arange(3.0))
    grid = np.stack((x, y, 0.0 * x), axis=-1)
    bottom, top, left, right = np.split(area_edges(grid, x / 2.5), np.cumsum([6, 6, 4]))
    for side, height in ((bottom, 0.0), (top, 2.0)):
        np.testing.assert_allclose(side[:4], [[0, height, 0], [1, height, 0], [2, height, 0], [2.5, height, 0]])
        assert np.isnan(side[4:]).all()
    np.testing.assert_allclose(left[:3], grid[:, 0])
    assert np.isnan(right).all()
