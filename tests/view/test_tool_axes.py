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


def test_axis_that_has_no_name_is_not_drawn() -> None:
    """A rack has no axis in the picture; the gear's would look like a crack in its bore."""
    scene = tool_view("helical")
    assert not scene.words
    assert not scene.curves
    assert np.isfinite(scene.dots[0].points).all()
