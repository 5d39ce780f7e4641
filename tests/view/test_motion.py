"""Animations: loops close, contact goes over the whole tooth, the compound only ever goes, and films need ffmpeg."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest
from oracles.built import built_sample

from gearmesh import OutputError
from gearmesh.errors import ArgumentError
from gearmesh.view import animation as films
from gearmesh.view import opengl
from gearmesh.view.animation import write_animation
from gearmesh.view.scene import Scene


@pytest.mark.sweep
@pytest.mark.quick
@pytest.mark.parametrize("view", ["section", "pair"])
def test_turning_gears_come_round_after_whole_pitches(view: str) -> None:
    """One step after the last picture both members are turned by whole pitches of theirs."""
    gears = built_sample("spur")
    scenes = gears.animation(view, size=(80, 60))._scenes
    for body, member in enumerate(gears.pairs[0].both):
        motions = [scene.bodies[body].own_to_scene for scene in scenes]
        last = motions[-2].inverse @ motions[-1]
        step = np.arctan2(last.rotation[1, 0], last.rotation[0, 0])
        whole = motions[0].inverse @ motions[-1]
        turn = np.arctan2(whole.rotation[1, 0], whole.rotation[0, 0]) + step
        assert abs(turn * member.tooth.teeth / (2.0 * np.pi)) == pytest.approx(1.0, abs=1e-9)
    assert all(scene.camera is scenes[0].camera for scene in scenes)


def test_contact_rolls_from_one_end_of_the_engagement_to_the_other() -> None:
    """One ellipse at a time, and steps of the path that are nearly alike; at the ends only edges touch."""
    gears = built_sample("spiral_bevel_basic")
    scenes = gears.animation("contact", size=(80, 60))._scenes
    discs = [scene.areas[0].points for scene in scenes if scene.areas]
    assert {len(scene.areas) for scene in scenes} <= {0, 1}
    middles = np.array([disc[0, 0] for disc in discs])
    steps = np.linalg.norm(np.diff(middles, axis=0), axis=-1)
    assert len(middles) >= 10
    assert steps.max() < 3.0 * np.median(steps)


@pytest.mark.sweep
def test_compound_only_goes_and_ends_as_in_the_picture() -> None:
    gears = built_sample("spiral_bevel_basic")
    moving = gears.animation("pattern", size=(80, 60), look="compound")
    shares = np.array([scene.films[0].share for scene in moving._scenes])
    assert (np.diff(shares, axis=0) <= 0.0).all()
    assert (shares[0] < 1.0).mean() < 0.3 * (shares[-1] < 1.0).mean()
    still = gears.picture("pattern", size=(80, 60), look="compound")._scene.films[0].share
    # other positions of the same engagement
    assert np.abs(still - shares[-1]).mean() < 0.02
    assert moving._hold


@pytest.mark.quick
def test_other_views_and_members_do_not_move() -> None:
    gears = built_sample("spur")
    with pytest.raises(ArgumentError, match="view = te: must be one of section, pair, contact, pattern"):
        gears.animation("te")
    with pytest.raises(ArgumentError, match="member = wheel: must be one of pinion, gear"):
        gears.animation("contact", "wheel")
    with pytest.raises(ArgumentError, match="look = compound: is for the views pattern, gap; the view is pair"):
        gears.animation("pair", look="compound")


#: a program in the place of ffmpeg: it notes its arguments and how many bytes it was given
STAND_IN = """#!{python}
import sys
given = sys.stdin.buffer.read()
if {code}:
    sys.exit("no encoder")
with open(sys.argv[-1], "w") as film:
    film.write(" ".join(sys.argv[1:-1]) + f" {{len(given)}}")
"""


@pytest.mark.quick
@pytest.mark.skipif(sys.platform == "win32", reason="a script is a program by its first line")
def test_films_are_written_by_ffmpeg(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Even sides, and pictures repeated for six seconds; its last line is told if it fails, and its absence before drawing."""
    images = iter([np.full((31, 45, 3), k, dtype=np.uint8) for k in range(60)])
    monkeypatch.setattr(films, "render", lambda scene, size: next(images))
    scenes: list[Scene] = [None] * 30  # type: ignore[list-item]
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(OutputError, match=r"a\.mp4: the program ffmpeg is not installed; \.gif needs no program"):
        write_animation(tmp_path / "a.mp4", scenes)
    program = tmp_path / "ffmpeg"
    for code in (0, 1):
        program.write_text(STAND_IN.format(python=sys.executable, code=code))
        program.chmod(0o755)
        if code:
            with pytest.raises(OutputError, match=r"b\.mp4: ffmpeg: no encoder"):
                write_animation(tmp_path / "b.mp4", scenes)
        else:
            write_animation(tmp_path / "a.mp4", scenes)
    told = (tmp_path / "a.mp4").read_text().split()
    assert "44x30" in told
    assert told[-3:-1] == ["-f", "mp4"]
    # 30 pictures of 70 ms, three times
    assert int(told[-1]) == 3 * 30 * 44 * 30 * 3
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.mp4", "ffmpeg"]


@pytest.mark.sweep
@pytest.mark.skipif(opengl.missing_opengl_message() is not None, reason="needs OpenGL")
def test_thin_lines_keep_their_colour_in_a_gif(tmp_path: Path) -> None:
    """The path of contact has few pixels; the ground stays white."""
    from PIL import Image

    file = built_sample("spiral_bevel_basic").animation("contact", size=(200, 150)).save(tmp_path / "a.gif")
    with Image.open(file) as image:
        image.seek(image.n_frames // 2)
        pixels = np.asarray(image.convert("RGB")).astype(int)
    red = (pixels[..., 0] > 140) & (pixels[..., 1] < 60)
    assert red.sum() > 20
    assert (pixels[20:].reshape(-1, 3).max(axis=0) >= 254).all()
