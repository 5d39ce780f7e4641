"""Names of the axes in pictures of tools: each is on the white ground, beside bodies, lines and other names."""

from dataclasses import replace

import numpy as np
import pytest

import gearmesh as gm
from gearmesh import samples
from gearmesh.view.offscreen.letters import LetteredImage
from gearmesh.view.opengl import missing_opengl_message
from gearmesh.view.render import _WORD_POINTS, _placed_words, render
from gearmesh.view.scene import Scene

#: width and height of the pictures
PICTURE_SIZE = (800, 600)
#: brightness of the ground
WHITE_LEVEL = 250


def tool_view(name: str) -> Scene:
    return gm.build(gm.load(samples.folder_path() / f"{name}.toml")).picture("tool", size=PICTURE_SIZE)._scene


@pytest.mark.skipif(missing_opengl_message() is not None, reason="no OpenGL")
@pytest.mark.parametrize("name", ["hypoid_face_hobbed", "zerol"])
@pytest.mark.sweep_cases("zerol")
def test_names_of_axes_cover_nothing(name: str) -> None:
    scene = tool_view(name)
    bare = render(replace(scene, words=()))
    sheet = LetteredImage(PICTURE_SIZE)
    boxes = [
        sheet.box(at, text, _WORD_POINTS, across=across)
        for at, text, across in _placed_words(sheet, scene, PICTURE_SIZE)
    ]
    assert {word.text.split(" of ")[0] for word in scene.words} == {"cradle axis", "axis"}
    assert len(boxes) == 3
    for k, box in enumerate(boxes):
        left, top, right, bottom = (round(edge) for edge in (box.left, box.top, box.right, box.bottom))
        assert bare[top:bottom, left:right].min() >= WHITE_LEVEL, scene.words[k].text
        for other in boxes[:k]:
            apart = (box.left > other.right, box.right < other.left, box.top > other.bottom, box.bottom < other.top)
            assert any(apart)


@pytest.mark.sweep
def test_axis_that_has_no_name_is_not_drawn() -> None:
    """A rack has no axis in the picture; the gear's would look like a crack in its bore."""
    scene = tool_view("helical")
    assert not scene.words
    assert not scene.curves
    assert np.isfinite(scene.dots[0].points).all()


def shown(scene: Scene, body: int) -> np.ndarray:
    """Box (2, 2) of a body in a picture: its left upper and right lower corner, pixels."""
    places = scene.camera.pixels(scene.bodies[body].own_to_scene.point(scene.bodies[body].mesh.vertices), PICTURE_SIZE)[
        :, :2
    ]
    return np.stack((places.min(axis=0), places.max(axis=0)))


@pytest.mark.sweep
def test_no_side_is_blank_where_a_large_gear_is_cut_off() -> None:
    """The rack is small beside the gear of `helical`, which fills the picture to the heading and to the right edge."""
    gears = gm.build(gm.load(samples.folder_path() / "helical.toml"))
    scene = gears.picture("tool", "gear", size=PICTURE_SIZE)._scene
    (wide, high), gear, rack = PICTURE_SIZE, shown(scene, 0), shown(scene, 1)
    everything = np.stack((np.minimum(gear[0], rack[0]), np.maximum(gear[1], rack[1])))
    assert everything[1, 1] > high
    assert 0.09 * high < everything[0, 1] < 0.17 * high
    assert rack[0].min() > 0.0
    assert np.all(rack[1] < (wide, high))


@pytest.mark.parametrize("name", ["beveloid_intersected", "helical"])
@pytest.mark.sweep_cases("beveloid_intersected")
def test_tool_and_tooth_fill_the_room_below_the_legend(name: str) -> None:
    """The edge of the tool's tip is level, however the tooth tapers; both take four fifths of the height, or the width."""
    gears = gm.build(gm.load(samples.folder_path() / f"{name}.toml"))
    scene = gears.picture("contact_lines", "pinion", size=PICTURE_SIZE)._scene
    tool, tooth = shown(scene, 0), shown(scene, 1)
    low, high = np.minimum(tool[0], tooth[0]), np.maximum(tool[1], tooth[1])
    shares = (high - low) / np.array(PICTURE_SIZE)
    assert max(shares[0] / 0.88, shares[1] / 0.79) == pytest.approx(1.0, abs=0.01)
    assert 0.12 * PICTURE_SIZE[1] < low[1] < high[1] < 0.95 * PICTURE_SIZE[1]
    sheet = scene.bodies[0].mesh
    tip = scene.camera.pixels(sheet.only("flank").vertices, PICTURE_SIZE)
    left, right = (tip[np.abs(tip[:, 0] - edge) < 2.0][:, 1].min() for edge in (tip[:, 0].min(), tip[:, 0].max()))
    assert left == pytest.approx(right, abs=1.0)
