"""Drawing by VTK: no gaps between facets, no specks, nothing that shines through."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from oracles.built import built_sample

from gearmesh import Rigid
from gearmesh.kernel.numeric.algebra import rotation_about
from gearmesh.view.offscreen import shapes
from gearmesh.view.offscreen.shapes import Viewer, drawing_order
from gearmesh.view.on_tooth import area_edges
from gearmesh.view.palette import rgb
from gearmesh.view.scene import Camera, Dots, Scene

SIZE = (400, 300)


@pytest.fixture(scope="module")
def scene() -> Scene:
    """A tooth of a spur gear, its body cut open, its end faces seen edge-on."""
    made = built_sample("spur").picture("contact", size=SIZE)._scene
    assert made.camera.front_normal is not None
    back = made.camera.front_normal
    camera = replace(
        made.camera, position=made.camera.focus + made.camera.distance * back, up=np.array([1.0, 0.0, 0.0])
    )
    return replace(made, camera=camera)


def points(primitive) -> np.ndarray:
    return np.frombuffer(primitive["points"], dtype=np.float32).reshape(-1, 3)


def test_facets_that_share_a_corner_share_its_place_in_the_picture(scene: Scene) -> None:
    """To the bit, though each goes back by its own slope: else pixels between them are left open, and show what is behind."""
    askew = Camera(np.array([31.0, 57.0, 93.0]), np.array([0.1, 0.2, 0.3]), np.array([0.2, 1.0, 0.1]), 2000.0)
    for body in scene.bodies:
        alone = Scene((replace(body, yields=False),), camera=askew)
        (facets,) = (one for one in drawing_order(alone, SIZE)["primitives"] if one["colours"] is not None)
        mesh, (x, y, z) = body.mesh, points(facets).T
        assert len(np.unique(z)) > 1.5 * len(mesh.vertices)
        owner = mesh.triangles.ravel()
        for own in (x, y):
            first = np.full(len(mesh.vertices), np.nan, dtype=np.float32)
            first[owner] = own
            assert (first[owner] == own).all()


def test_parts_behind_an_edge_on_end_face_stay_hidden(scene: Scene) -> None:
    """Its triangles are lines of the colour of the inside, before lines that are farther away, behind its own outline."""
    opened = next(body for body in scene.bodies if body.yields)
    assert scene.camera.front is not None
    lines = [one for one in drawing_order(scene, SIZE)["primitives"] if one["corners"] == 2]
    inside = [one for one in lines if one["colour"] == tuple(part / 255.0 for part in rgb(shapes.SECTION_COLOUR))]
    assert len(inside) == 1
    ends = points(inside[0])[np.frombuffer(inside[0]["cells"], dtype=np.int64)]
    across = np.abs((opened.own_to_scene.point(opened.mesh.vertices) - scene.camera.focus) @ scene.camera.axes[0]).max()
    np.testing.assert_allclose(np.abs(ends[:, 0]), across, rtol=1e-5)
    turned = replace(opened, own_to_scene=opened.own_to_scene @ Rigid(rotation_about("x", 0.2), np.zeros(3)))
    askew = drawing_order(replace(scene, bodies=(turned,)), SIZE)["primitives"]
    assert not [one for one in askew if one["corners"] == 2 and one["colour"] == inside[0]["colour"]]


def test_lines_are_thinner_in_small_pictures_but_not_in_proportion(scene: Scene) -> None:
    """In one of 480x360 dots of 12 pixels hid the path that they mark."""

    dots = Dots(scene.camera.focus[None])

    def widths(size: tuple[int, int]) -> list[float]:
        """Those of a curve and of a dot."""
        marked = Scene((), scene.camera, curves=scene.curves[:1], dots=(dots,))
        return [float(one["width"]) for one in drawing_order(marked, size)["primitives"]]

    assert scene.curves
    usual = np.array(widths((1600, 1200)))
    assert usual == pytest.approx(shapes.OVERSAMPLING_FACTOR * np.array([scene.curves[0].width, dots.size]))
    for size, share in (((400, 300), 0.5), ((800, 600), 0.5**0.5)):
        assert np.array(widths(size)) / usual == pytest.approx(share)
    assert widths((160, 120)) == widths((400, 300))


def test_facets_that_turn_away_by_their_exact_normals_are_of_the_inside(scene: Scene) -> None:
    opened = next(body for body in scene.bodies if body.yields)

    def count(normals: np.ndarray) -> int:
        body = replace(opened, mesh=replace(opened.mesh, normals=normals))
        # all of it in sight
        camera = replace(scene.camera, height=100.0 * scene.camera.height)
        primitives = drawing_order(replace(scene, bodies=(body,), camera=camera), SIZE)["primitives"]
        (outer,) = (one for one in primitives if one["colours"] is not None)
        return len(outer["cells"]) // 24

    mesh = opened.mesh
    a, b, c = np.moveaxis(opened.own_to_scene.point(mesh.corners()), 1, 0)
    facing = np.cross(b - a, c - a) @ scene.camera.axes[2] > 1e-6
    assert 0 < count(mesh.normals) <= facing.sum() < len(facing)
    away = opened.own_to_scene.vector(mesh.normals) @ scene.camera.axes[2] < 0.0
    assert count(-mesh.normals) == (facing & away).sum() < 0.01 * len(facing)


def test_what_is_in_the_picture_is_drawn_as_if_all_were(scene: Scene) -> None:
    """Triangles beyond its edges are left out, and those kept have the same places and colours, nearest first."""
    for body in scene.bodies:
        near = Scene((replace(body, yields=False),), camera=scene.camera)
        far = replace(near, camera=replace(scene.camera, height=50.0 * scene.camera.height))
        # the same pixels in mm, so that lines and slopes push alike
        (few,), (every,) = (
            [one for one in drawing_order(each, size)["primitives"] if one["colours"] is not None]
            for each, size in ((near, SIZE), (far, (50 * SIZE[0], 50 * SIZE[1])))
        )
        corners, cells = (points(every).reshape(-1, 3, 3), np.frombuffer(every["cells"], dtype=np.int64).reshape(-1, 3))
        half = 0.5 * scene.camera.height * np.array([SIZE[0] / SIZE[1], 1.0])
        across = corners[..., :2]
        inside = ((across.max(axis=1) > -half) & (across.min(axis=1) < half)).all(axis=1)
        drawn, all_drawn = _coloured(few), _coloured(every)
        places = [corner.astype(np.float32).tobytes() for corner in corners[inside]]
        assert set(places) <= set(drawn) <= set(all_drawn)
        # rounding may take a colour to the next one
        assert max(int(np.abs(drawn[place] - all_drawn[place]).max()) for place in places) <= 1
        assert body.yields == (len(drawn) < 0.7 * len(all_drawn))
        depth = corners[cells[:, 0] // 3, :, 2].max(axis=1)
        assert (np.diff(depth) <= 0.0).all()


def _coloured(primitive) -> dict[bytes, np.ndarray]:
    """Colours (9,) of triangles by their places."""
    places = points(primitive).reshape(-1, 9)
    colours = np.frombuffer(primitive["colours"], dtype=np.uint8).reshape(-1, 9).astype(int)
    return {place.tobytes(): colour for place, colour in zip(places, colours, strict=True)}


@pytest.mark.quick
def test_lamps_shine_on_what_faces_them_and_colours_are_those_of_paint() -> None:
    """A normal towards the viewer, at right angles to it, and away, which is seen from inside: in closed form."""
    camera = Camera(np.array([0.0, 0.0, 1e6]), np.zeros(3), np.array([0.0, 1.0, 0.0]), 10.0)
    lamps = [
        (np.array(direction) / np.linalg.norm(direction), strength) for direction, strength in shapes._CAMERA_LAMPS
    ]
    normals = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 0.0, -1.0]])
    found = Viewer(camera, 0.1).light(np.zeros((3, 3)), normals, np.full((3, 3), 100, dtype=np.uint8))
    for normal, colour in zip(np.abs(normals), found, strict=True):
        falls = [max(0.0, float(lamp @ normal)) for lamp, _ in lamps]
        shine = [max(0.0, float((2.0 * (lamp @ normal) * normal - lamp)[2])) ** 20 for lamp, _ in lamps]
        wanted = 100.0 * (
            shapes.AMBIENT_SHARE + sum(fall * strength for fall, (_, strength) in zip(falls, lamps, strict=True))
        )
        wanted += 255.0 * 0.12 * sum(s * strength for s, f, (_, strength) in zip(shine, falls, lamps, strict=True) if f)
        np.testing.assert_allclose(colour, wanted, atol=0.6)


@pytest.mark.quick
def test_border_of_an_area_is_drawn_where_it_reaches() -> None:
    """A flank 4 mm wide and 2 mm high, with an area left of x = 2.5: of three sides, those at the bottom and top up to there."""
    x, y = np.meshgrid(np.arange(5.0), np.arange(3.0))
    grid = np.stack((x, y, 0.0 * x), axis=-1)
    bottom, top, left, right = np.split(area_edges(grid, x / 2.5), np.cumsum([6, 6, 4]))
    for side, height in ((bottom, 0.0), (top, 2.0)):
        np.testing.assert_allclose(side[:4], [[0, height, 0], [1, height, 0], [2, height, 0], [2.5, height, 0]])
        assert np.isnan(side[4:]).all()
    np.testing.assert_allclose(left[:3], grid[:, 0])
    assert np.isnan(right).all()


@pytest.mark.quick
def test_lines_that_would_be_a_dark_band_are_left_out() -> None:
    """A comb of 41 lines: at 20 pixels apart all are drawn, at one pixel none; a knot of other lines alone goes."""
    camera = Camera(np.array([0.0, 0.0, 100.0]), np.zeros(3), np.array([0.0, 1.0, 0.0]), 100.0)
    x = np.repeat(np.arange(-20.0, 21.0), 2)
    y = np.tile([-60.0, 60.0], 41)
    edges = np.arange(82).reshape(-1, 2)
    for spacing, count in ((20.0, 41), (1.0, 0)):
        points = np.stack((spacing * x, y, 0.0 * x), axis=-1)
        assert len(Viewer(camera, 1.0).apart(points, edges)) == count
    knot = np.stack((8.0 + 0.05 * x, 0.4 * y, 0.0 * x), axis=-1)
    corner = np.concatenate((np.stack((20.0 * x, 20.0 * y, 0.0 * x), axis=-1), knot))
    kept = Viewer(camera, 1.0).apart(corner, np.arange(164).reshape(-1, 2))
    # the line of the comb beside the knot stays: it is crowded along a fiftieth of its length
    np.testing.assert_array_equal(kept, edges)
