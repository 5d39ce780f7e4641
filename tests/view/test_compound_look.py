"""Marking compound on teeth: bare where they touch, painted where they do not, and refused where there is no pattern."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.built import built_sample

from gearmesh.errors import ArgumentError
from gearmesh.view import opengl
from gearmesh.view.offscreen.letters import Image
from gearmesh.view.render import render


def yellowness(image: Image, x: float, y: float) -> float:
    """Red minus blue at a pixel: 0 for steel, more than 100 for the compound in any light."""
    red, _, blue = image[round(y), round(x)].astype(float)
    return float(red - blue)


@pytest.mark.skipif(opengl.missing_opengl_message() is not None, reason="needs OpenGL")
def test_compound_is_gone_on_the_path_and_stays_beyond_the_ellipses() -> None:
    gears = built_sample("spiral_bevel_basic")
    scene = gears.picture("pattern", look="compound", size=(400, 300))._scene
    image = render(scene)
    grid = scene.films[0].points
    share = scene.films[0].share
    x, y = np.moveaxis(scene.camera.pixels(grid, scene.size)[..., :2], -1, 0)
    inner = np.zeros(share.shape, dtype=bool)
    inner[12:-12, 24:-24] = True
    bare = np.flatnonzero((inner & (share < 0.02)).ravel())[::40]
    painted = np.flatnonzero((inner & (share == 1.0)).ravel())[::400]
    assert min(len(bare), len(painted)) >= 5
    assert max(yellowness(image, x.flat[k], y.flat[k]) for k in bare) < 20.0
    assert min(yellowness(image, x.flat[k], y.flat[k]) for k in painted) > 80.0
    # half way to the thickness of the compound half of it stays
    half = np.flatnonzero((inner & (np.abs(share - 0.5) < 0.02)).ravel())
    between = [yellowness(image, x.flat[k], y.flat[k]) for k in half]
    assert 40.0 < np.median(between) < 100.0


@pytest.mark.quick
def test_another_look_or_view_is_refused_in_one_line() -> None:
    gears = built_sample("spur")
    with pytest.raises(ArgumentError, match="look = shiny: must be one of plain, compound"):
        gears.picture("pattern", look="shiny")
    with pytest.raises(ArgumentError, match="look = compound: is for the views pattern, gap; the view is pair"):
        gears.picture("pair", look="compound")
