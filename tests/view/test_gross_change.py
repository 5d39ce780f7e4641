"""Pictures against coarse copies of what was looked at: a gross change is seen, a shifted pixel or another driver is not.

`python tests/view/test_gross_change.py` writes the copies anew, after every picture was opened and found right.
"""

from __future__ import annotations

import json
import sys
import tempfile
from pathlib import Path

import numpy as np
import pytest

import gearmesh as gm
from gearmesh.view import opengl

ROOT = Path(__file__).parents[2]
COPIES = ROOT / "tests" / "data" / "pictures.json"
#: cells of a copy, and by how much (of 255) one may differ, and all on average
CELLS, ONE, MEAN = (16, 12), 40, 3.0
PICTURES = {
    "tooth": ("beveloid_crossed", "contact", ()),
    "long tooth": ("circular_arc", "contact", ()),
    "pattern": ("rack", "pattern", ()),
    "pair": ("beveloid_crossed", "pair", ("mesh.tolerance=0.05",)),
    "planes": ("rack", "flank", ()),
    "error": ("rack", "te", ()),
}
FLAT = ("planes", "error")


def copy(name: str, folder: Path) -> np.ndarray:
    """Mean colours (12, 16, 3) of the cells of a picture."""
    from PIL import Image

    sample, view, settings = PICTURES[name]
    gears = gm.build(gm.load(ROOT / "samples" / f"{sample}.toml", list(settings)))
    file = gears.picture(view, size=(640, 480), dpi=60).save(folder / "a.png")
    with Image.open(file) as image:
        return np.asarray(image.convert("RGB").resize(CELLS, Image.Resampling.BOX))


@pytest.mark.sweep_cases("long tooth", "pattern", "tooth")
@pytest.mark.parametrize("name", [name for name in PICTURES if name not in FLAT])
@pytest.mark.skipif(opengl.missing_opengl_message() is not None, reason="needs OpenGL")
def test_scenes_look_as_they_did(name: str, tmp_path: Path) -> None:
    assert_alike(name, tmp_path)


@pytest.mark.sweep
@pytest.mark.parametrize("name", FLAT)
def test_figures_look_as_they_did(name: str, tmp_path: Path) -> None:
    assert_alike(name, tmp_path)


def assert_alike(name: str, folder: Path) -> None:
    change = copy(name, folder).astype(float) - np.array(json.loads(COPIES.read_text())[name])
    assert np.abs(change).max() < ONE
    assert np.abs(change).mean() < MEAN


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as made:
        found = {name: copy(name, Path(made)).tolist() for name in PICTURES}
    COPIES.write_text(json.dumps(found, separators=(",", ":")) + "\n")
    sys.stdout.write(f"{COPIES.stat().st_size} bytes\n")
