"""Pictures of a tooth: looked at along the flank's normal, filled by it, its edges named."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial import cKDTree

import gearmesh as gm
from gearmesh.kernel.numeric.algebra import unit
from gearmesh.kinds import Side
from gearmesh.view import palette, pictures
from gearmesh.view.palette import COMPOUND_COLOUR, PATH_COLOUR
from gearmesh.view.projection import flank_projection
from gearmesh.view.views import LOOK_DOWN_RAD, MAX_TURN_RAD

SAMPLES = Path(__file__).parents[2] / "samples"


@pytest.mark.sweep
@pytest.mark.sweep_cases("spiral_bevel_basic")
@pytest.mark.parametrize("sample", ["rack", "spiral_bevel_basic"])
def test_the_flank_fills_the_picture(sample: str) -> None:
    gears = gm.build(gm.load(SAMPLES / f"{sample}.toml"))
    scene = gears.picture("contact", size=(800, 600))._scene
    camera, side = scene.camera, Side(gears.pairs[0].flanks[0])
    grid = gears.members["pinion"].tooth.flank_grid(side, np.linspace(0.0, 1.0, 33), np.linspace(0.0, 1.0, 33)).points
    # area-weighted mean normal, by differences of exact points
    mean = unit(np.cross(grid[1:, :-1] - grid[:-1, :-1], grid[:-1, 1:] - grid[:-1, :-1]).reshape(-1, 3).sum(axis=0))
    assert abs(camera.axes[2] @ mean) > np.cos(MAX_TURN_RAD) * np.cos(LOOK_DOWN_RAD) - 0.02
    seen = camera.pixels(grid, (800, 600))[..., :2]
    assert (seen[-1, :, 1] < seen[0, :, 1]).all()
    span = np.ptp(seen.reshape(-1, 2), axis=0)
    assert 0.8 * 800 < span.max() < 800
    # its ends are level, and it takes this share of the picture
    assert abs(np.diff(seen[:, [0, -1], 1].mean(axis=0))[0]) < 1.0
    outline = np.concatenate((seen[0], seen[1:, -1], seen[-1, -2::-1], seen[-2:0:-1, 0]))
    (x, y), (right, below) = outline.T, np.roll(outline, -1, axis=0).T
    assert 0.5 * abs(np.sum(x * below - right * y)) > {"rack": 0.16, "spiral_bevel_basic": 0.185}[sample] * 800 * 600
    # what is cut away never hides the flank, and each word is beyond its edge
    assert camera.front is not None
    words = {word.text: camera.pixels(word.point, (800, 600))[:2] for word in scene.words}
    assert set(words) == {"toe", "heel", "tip", "root"}
    assert words["tip"][1] < words["root"][1]
    # at half its height a curved flank is shorter than its corners are apart
    assert abs(words["toe"][0] - words["heel"][0]) > 0.75 * 800
    assert str(gears.design.name) in scene.title


@pytest.mark.sweep
@pytest.mark.sweep_cases("internal")
@pytest.mark.parametrize("sample", ["beveloid_crossed", "internal"])
def test_all_that_touches_is_seen_and_no_word_lies_on_it(sample: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The path goes from the first touch to the last, whatever positions are asked for, on the flank; of lines there is none."""
    monkeypatch.setattr(pictures, "FINE_TOLERANCE_PIXELS", 5.0)
    monkeypatch.setattr(pictures, "COARSE_TOLERANCE_PIXELS", 5.0)
    gears, size = gm.build(gm.load(SAMPLES / f"{sample}.toml")), (800, 600)
    scene = gears.picture("contact", size=size)._scene
    drawn = [(curve.label, curve.points[np.isfinite(curve.points[:, 0])]) for curve in scene.curves]
    if sample == "internal":
        assert {label for label, _ in drawn} == {"contact lines", ""}
    else:
        (path,) = (points for label, points in drawn if label == "path of contact")
        whole = gears.contact().whole
        np.testing.assert_allclose(path[[0, -1]], whole.point1[[0, -1]], atol=0.5)  # mm: lifted
        on_flank = flank_projection(gears.members["pinion"], gears.pairs[0].flanks[0])(path)
        assert np.nanmax(np.linalg.norm(path - on_flank, axis=-1)) < 0.5
    seen = scene.camera.pixels(np.concatenate([points for _, points in drawn]), size)[:, :2]
    assert ((seen > 0.0) & (seen < size)).all()
    for word in scene.words:
        edge, inside = (scene.camera.pixels(point, size)[:2] for point in (word.point, word.inside))
        place = edge + 0.028 * size[1] * (edge - inside) / np.hypot(*(edge - inside))
        assert np.linalg.norm(seen - place, axis=1).min() > 10.0, word.text


@pytest.mark.parametrize(
    ("sample", "member", "least"),
    [("circular_arc", "gear", (0.13, 0.0)), ("cycloidal", "disc", (0.6, 0.1)), ("spline", "hub", (0.09, 0.0))],
)
@pytest.mark.sweep_cases("cycloidal-disc-least1", "spline-hub-least2")
def test_long_flank_is_no_strip_and_curved_profile_is_seen(
    sample: str, member: str, least: tuple[float, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Share of the picture that the flank is high, and share of its width over which the profile of an end goes."""
    monkeypatch.setattr(pictures, "FINE_TOLERANCE_PIXELS", 5.0)
    monkeypatch.setattr(pictures, "COARSE_TOLERANCE_PIXELS", 5.0)
    gears, size = gm.build(gm.load(SAMPLES / f"{sample}.toml")), (800, 600)
    camera = gears.picture("contact", member, size=size)._scene.camera
    side = gears.pairs[0].flanks[list(gears.pairs[0].members).index(member)]
    s = np.linspace(0.0, 1.0, 17)
    seen = camera.pixels(gears.members[member].tooth.flank_grid(side, s, s).points, size)[..., :2]
    assert (seen[0, 8, 1] - seen[-1, 8, 1]) / size[1] > least[0]
    assert np.ptp(seen[:, 0, 0]) / size[0] > least[1]
    # the ends of a spline's flank, which is pressed all over, stay in the picture
    assert (sample == "circular_arc") == ((seen[8, :, 0] < 0.0) | (seen[8, :, 0] > size[0])).any()


@pytest.mark.sweep
def test_a_word_for_an_end_beyond_the_picture_is_below_the_root(monkeypatch: pytest.MonkeyPatch) -> None:
    """Face gears touch in the middle of a long pinion's flank: the words at the picture's edges are clear of the flank."""
    monkeypatch.setattr(pictures, "FINE_TOLERANCE_PIXELS", 5.0)
    monkeypatch.setattr(pictures, "COARSE_TOLERANCE_PIXELS", 5.0)
    gears, size = gm.build(gm.load(SAMPLES / "face_gear.toml")), (800, 600)
    scene = gears.picture("contact", size=size)._scene
    grid = gears.members["pinion"].tooth.flank_grid(gears.pairs[0].flanks[0], [0.0], np.linspace(0.0, 1.0, 9)).points
    root = scene.camera.pixels(grid, size)[..., 1].max()
    ends = {word.text: scene.camera.pixels(word.point, size)[:2] for word in scene.words if word.beyond}
    assert set(ends) == {"toe", "heel"}
    assert all(0.0 < place[0] < 800 and place[1] > root + 5.0 for place in ends.values())


@pytest.mark.sweep
def test_what_is_projected_is_the_closest_point_of_the_flank() -> None:
    """Against a dense grid of it; below the root of novikov gears, whose surface folds there, the search does not converge."""
    pair = gm.build(gm.load(SAMPLES / "novikov.toml")).pairs[0]
    grid = pair.pinion.tooth.flank_grid(pair.flanks[0], np.linspace(0.0, 1.0, 31), np.linspace(0.0, 1.0, 121)).points
    root, up = grid[0], unit(grid[1] - grid[0])
    below = root - np.linspace(-0.5, 1.5, 41)[:, None, None] * up
    project = flank_projection(pair.pinion, pair.flanks[0])
    projected = project(below)
    known = np.isfinite(projected[..., 0])
    assert 0.1 < known.mean() < 0.9
    nearest = cKDTree(grid.reshape(-1, 3)).query(below[known])[0]
    assert (np.linalg.norm(projected - below, axis=-1)[known] - nearest).max() < 1e-6


@pytest.mark.quick
def test_the_path_stands_out_from_the_ellipses() -> None:
    """Contrast as WCAG 2.2 counts it, at least 3 : 1."""

    def luminance(colour: str) -> float:
        part = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255.0
        linear = np.where(part <= 0.04045, part / 12.92, ((part + 0.055) / 1.055) ** 2.4)
        return float(linear @ [0.2126, 0.7152, 0.0722])

    assert (luminance(COMPOUND_COLOUR) + 0.05) / (luminance(PATH_COLOUR) + 0.05) > 3.0


@pytest.mark.quick
def test_no_colour_is_written_twice() -> None:
    """Colours that two pictures share are in the palette."""
    found = [
        (colour, path.name)
        for path in sorted(Path(palette.__file__).parent.glob("*.py"))
        for colour in re.findall(r"#[0-9a-fA-F]{6}\b", path.read_text(encoding="utf-8"))
    ]
    colours = [colour.lower() for colour, _ in found]
    assert [each for each in found if colours.count(each[0].lower()) > 1] == []
