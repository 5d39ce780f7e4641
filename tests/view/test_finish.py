"""Light in hollows, depth of a section, and its outline: against closed forms; and what is seen of them."""

from __future__ import annotations

import tracemalloc

import numpy as np
import pytest
from oracles.built import built_sample
from PIL import Image as pillow

from gearmesh.kernel.numeric.algebra import unit
from gearmesh.view import opengl
from gearmesh.view.offscreen.finish import (
    HALVED_ROWS_AT_ONCE,
    HATCH_SPACING_SHARE,
    HATCH_WIDTH_SHARE,
    LOST_LIGHT_SHARE,
    _halved,
    _hatch,
    _hollow_light,
    _plane_depth,
    _words,
)
from gearmesh.view.offscreen.front_plane import section_lines
from gearmesh.view.render import render
from gearmesh.view.scene import Camera


@pytest.mark.quick
def test_a_groove_is_darker_than_a_slope_beside_it() -> None:
    """A plane at 45 degrees keeps all its light; a groove 8 pixels wide and 8 deep does not, whatever is beyond the body."""
    row, column = np.indices((120, 160)).astype(np.float32)
    seen = column < 140
    light = _hollow_light(row + 8.0 * (np.abs(column - 60.0) < 4.0), seen, 1.0)
    assert light[20:100, 55:66].min() > 1.0 - LOST_LIGHT_SHARE
    assert light[20:100, 60].max() < 0.9
    # the surroundings at the largest distance, 6 pixels, are flat; slopes that leave the picture were dark at its border
    np.testing.assert_allclose(light[:, 80:130], 1.0, atol=1e-6)
    assert light[:, 60].max() < 0.95


@pytest.mark.quick
def test_depth_of_a_section_is_depth_of_its_plane() -> None:
    """Points of the plane, told by the camera's own projection."""
    normal = unit(np.array([0.3, -0.2, 0.9]))
    camera = Camera(
        np.array([30.0, 20.0, 60.0]),
        np.array([1.0, 2.0, 3.0]),
        np.array([0.1, 1.0, 0.0]),
        24.0,
        front=1.5,
        front_normal=normal,
    )
    depth = _plane_depth(camera, (12, 16), 2.0)
    across = np.random.default_rng(3).uniform(-5.0, 5.0, (50, 3))
    points = camera.focus + across + (camera.front - across @ normal)[:, None] * normal
    x, y, expected = camera.pixels(points, (16, 12)).T
    # bilinear between pixel centres, rows from below
    i, j = 12.0 - y - 0.5, x - 0.5
    inside = (i > 0) & (i < 10) & (j > 0) & (j < 14)
    i, j, expected = i[inside], j[inside], expected[inside]
    low, left = i.astype(int), j.astype(int)
    found = (
        depth[low, left]
        + (i - low) * (depth[low + 1, left] - depth[low, left])
        + (j - left) * (depth[low, left + 1] - depth[low, left])
    )
    assert inside.sum() > 20
    np.testing.assert_allclose(found, expected, atol=1e-4)


@pytest.mark.quick
def test_outline_of_a_cut_tetrahedron_is_a_triangle() -> None:
    corners = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]])
    cells = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
    lines = section_lines(corners, cells, 1.0 - corners[:, 2])
    assert lines.shape == (3, 2, 3)
    ends = {tuple(point) for point in lines.reshape(-1, 3).round(12).tolist()}
    assert ends == {(0.0, 0.0, 1.0), (1.0, 0.0, 1.0), (0.0, 1.0, 1.0)}


@pytest.mark.skipif(opengl.missing_opengl_message() is not None, reason="needs OpenGL")
def test_no_part_of_a_tooth_or_its_body_is_nearly_white() -> None:
    """Below the heading a pixel is ground, white, or body; a third of this picture was a slab of #f4f6f8."""
    image = render(built_sample("spur").picture("contact", size=(320, 240))._scene)[24:]
    palest = image.min(axis=-1)
    assert (palest == 255).mean() < 0.25
    assert ((palest >= 235) & (palest < 255)).mean() < 0.02


@pytest.mark.quick
def test_hatching_takes_little_more_memory_than_the_picture() -> None:
    """Rows are hatched one by one, in place; indices of all pixels took five times as much as the picture."""
    colours = ["#c4d1e3", "#d9cdb8"]
    first, second = _words(colours)
    pixels = np.full((900, 1200), first)
    pixels[:, 700:] = second
    before = pixels.copy()
    tracemalloc.start()
    _hatch(pixels, colours)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    rows, columns = np.indices(pixels.shape)
    period = HATCH_SPACING_SHARE * len(pixels)
    # lines of the first colour lean to the right, of the second to the left
    lean = np.where(before == first, columns - rows, columns + rows)
    np.testing.assert_array_equal(pixels != before, lean % period < HATCH_WIDTH_SHARE * period)
    assert (pixels != before).mean() == pytest.approx(HATCH_WIDTH_SHARE, rel=0.03)
    assert most < 0.1 * pixels.nbytes


@pytest.mark.quick
@pytest.mark.parametrize("shape", [(2, 2), (6, 4), (2 * HALVED_ROWS_AT_ONCE + 2, 10), (4 * HALVED_ROWS_AT_ONCE, 6)])
def test_drawn_pixels_are_averaged_as_by_a_bilinear_filter(shape: tuple[int, int]) -> None:
    """The second route is Pillow's, which rounds twice, and has other weights along the rim."""
    drawn = np.random.default_rng(7).integers(0, 256, (*shape, 4), dtype=np.uint8)
    small = (shape[1] // 2, shape[0] // 2)
    halved = _halved(drawn.view(np.uint32)[..., 0]).view(np.uint8).reshape(*small[::-1], 4).astype(int)
    expected = np.asarray(
        pillow.frombuffer("RGBX", shape[::-1], drawn, "raw", "RGBX", 0, 1).resize(small, pillow.Resampling.BILINEAR)
    )
    apart = np.abs(halved - expected)[..., :3]
    assert apart[1:-1, 1:-1].max(initial=0) <= 1
    # a weight of an eighth belongs to the nearest drawn pixel
    assert apart.max() <= 255 / 8 + 1
    even = np.full(shape, 0x01FE80FF, dtype=np.uint32)
    assert (_halved(even) == even[::2, ::2]).all()
