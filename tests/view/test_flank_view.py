"""Pictures of a tooth: looked at along the flank's normal, filled by it, its edges named."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

import gearmesh as gm
from gearmesh.kernel.numeric.algebra import unit
from gearmesh.teeth.region import Side
from gearmesh.view import palette
from gearmesh.view.palette import COMPOUND, PATH

SAMPLES = Path(__file__).parents[2] / "samples"


@pytest.mark.sweep_cases("spiral_bevel_basic")
@pytest.mark.parametrize("sample", ["rack", "spiral_bevel_basic"])
def test_the_flank_fills_the_picture(sample: str) -> None:
    gears = gm.build(gm.load(SAMPLES / f"{sample}.toml"))
    scene = gears.picture("contact", size=(800, 600)).scene
    camera, side = scene.camera, Side(gears.pairs[0].flanks[0])
    grid = gears.members["pinion"].tooth.flank_grid(side, np.linspace(0.0, 1.0, 33), np.linspace(0.0, 1.0, 33)).points
    # area-weighted mean normal, by differences of exact points
    mean = unit(np.cross(grid[1:, :-1] - grid[:-1, :-1], grid[:-1, 1:] - grid[:-1, :-1]).reshape(-1, 3).sum(axis=0))
    assert abs(camera.axes[2] @ mean) == pytest.approx(1.0, abs=1e-3)
    seen = camera.pixels(grid, (800, 600))[..., :2]
    assert (seen[-1, :, 1] < seen[0, :, 1]).all()
    # a long flank is cut off beside the contact, and as high as it can be
    span = np.ptp(seen.reshape(-1, 2), axis=0)
    assert span.max() > 0.8 * 800
    assert span[1] > 0.3 * 600
    # what is cut away never hides the flank, and each word is beyond its edge
    assert camera.front is not None
    words = {word.text: camera.pixels(word.point, (800, 600))[:2] for word in scene.words}
    assert set(words) == {"toe", "heel", "tip", "root"}
    assert words["tip"][1] < words["root"][1]
    assert abs(words["toe"][0] - words["heel"][0]) > 0.8 * 800
    assert str(gears.design.name) in scene.title


@pytest.mark.quick
def test_the_path_stands_out_from_the_ellipses() -> None:
    """Contrast as WCAG 2.2 counts it, at least 3 : 1."""

    def luminance(colour: str) -> float:
        part = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255.0
        linear = np.where(part <= 0.04045, part / 12.92, ((part + 0.055) / 1.055) ** 2.4)
        return float(linear @ [0.2126, 0.7152, 0.0722])

    assert (luminance(COMPOUND) + 0.05) / (luminance(PATH) + 0.05) > 3.0


@pytest.mark.quick
def test_no_colour_is_written_twice() -> None:
    """What two pictures share is in the palette."""
    found = [
        (colour, path.name)
        for path in sorted(Path(palette.__file__).parent.glob("*.py"))
        for colour in re.findall(r"#[0-9a-fA-F]{6}\b", path.read_text(encoding="utf-8"))
    ]
    colours = [colour.lower() for colour, _ in found]
    assert [each for each in found if colours.count(each[0].lower()) > 1] == []
