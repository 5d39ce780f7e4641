"""The section through a mesh: its dots are where teeth touch, at every position of a pitch."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from oracles.built import built_sample

import gearmesh as gm
from gearmesh import GearPair
from gearmesh.answers.contact.rolling import rolling_contact
from gearmesh.reports import pictures as reports_pictures
from gearmesh.view import opengl
from gearmesh.view.animation import write_animation
from gearmesh.view.mesh_section import mesh_section
from gearmesh.view.scene import Scene

SAMPLES = Path(__file__).parents[2] / "samples"


@pytest.mark.sweep
def test_contact_of_spur_gears_moves_along_the_line_of_action() -> None:
    gears = gm.build(gm.load(SAMPLES / "spur.toml"))
    pair, contact = gears.pairs[0], gears.contact()
    meshes = dict.fromkeys(pair.members, None)
    frames = mesh_section(rolling_contact(pair, contact.path, np.arange(12) / 12), meshes, (64, 48)).scenes()
    points = np.array([scene.dots[0].points for scene in frames])
    # those before the section are as far before it; z 20, module 3 mm, 20 deg
    base, touching = 30.0 * np.cos(np.radians(20.0)), np.isfinite(points[..., 0])
    flat = points[touching] - pair.pinion.mount.origin
    assert np.ptp(flat @ pair.pinion.mount.axis) < 1e-9
    along = flat - flat.mean(axis=0)
    way = np.linalg.svd(along)[2][0]
    assert np.abs(along - (along @ way)[:, None] * way).max() < 1e-9
    assert np.linalg.norm(np.cross(flat, way) @ pair.pinion.mount.axis) / np.sqrt(len(flat)) == pytest.approx(
        base, rel=1e-9
    )
    # on average as many pairs touch as the contact ratio says
    assert touching.sum(axis=1).mean() == pytest.approx(contact.summary["contact_ratio"], abs=0.1)
    # after a pitch everything is as it was, and the gear has kept pace
    later = mesh_section(rolling_contact(pair, contact.path, (0.0, 1.0)), meshes, (64, 48))
    start = later.points
    np.testing.assert_allclose(
        np.sort(start[0][np.isfinite(start[0])]), np.sort(start[1][np.isfinite(start[1])]), atol=1e-9
    )
    turned = [scene.bodies[1].own_to_scene for scene in later.scenes()]
    teeth = pair.gear.tooth.teeth
    angle = np.arccos(0.5 * (np.trace(turned[0].rotation.T @ turned[1].rotation) - 1.0))
    assert angle == pytest.approx(2.0 * np.pi / teeth, abs=1e-9)


def test_section_has_pitch_circles_line_of_action_and_tooth_numbers() -> None:
    """Spur gears z 20, 40, module 3 mm, 20 deg."""
    gears = gm.build(gm.load(SAMPLES / "spur.toml"))
    pair = gears.pairs[0]
    rolling = rolling_contact(pair, gears.contact(cycle=False).path, np.arange(3) / 3)
    section = mesh_section(rolling, dict.fromkeys(pair.members, None), (640, 480))
    scenes = section.scenes()
    circles, action = scenes[0].curves
    assert [circles.label, action.label] == ["pitch circles", "line of action"]
    back = section.camera.axes[2]
    for mount, part, member in zip(pair.mounts, np.split(circles.points, 2), pair.both, strict=True):
        away = part[:-1] - mount.origin
        radii = np.linalg.norm(away - (away @ back)[:, None] * back, axis=-1)
        assert radii == pytest.approx(1.5 * member.tooth.teeth, rel=1e-9)
    way = np.diff(action.points, axis=0)[0]
    for mount, base in zip(pair.mounts, (30.0, 60.0), strict=True):
        arm = np.cross(action.points[0] - mount.origin, way / np.linalg.norm(way)) @ mount.axis
        assert abs(arm) == pytest.approx(base * np.cos(np.radians(20.0)), rel=1e-6)
    # numbers stand in the middle of teeth, and go with them from picture to picture
    first, second = ({(word.text, *word.inside): word.point for word in scene.words} for scene in scenes[:2])
    steps = [np.linalg.norm(second[key] - first[key]) for key in first.keys() & second.keys()]
    assert len(steps) >= 4
    # a third of a pitch at the pitch circles, of which the numbers stand near
    assert steps == pytest.approx([np.pi] * len(steps), rel=0.06)


def _drawn_section(name: str) -> tuple[gm.Gears, Scene]:
    gears = built_sample(name)
    rolling = rolling_contact(gears.pairs[0], gears.contact([0.0], cycle=False).path, np.zeros(1))
    return gears, mesh_section(rolling, dict.fromkeys(gears.pairs[0].members, None), (640, 480)).scenes()[0]


@pytest.mark.sweep
def test_section_of_bevel_gears_has_the_pitch_cones_of_their_tooth_numbers() -> None:
    """z 13, 44 at 90 deg: tan delta_1 = 13/44. Axes of hypoid gears do not meet: they have numbers alone."""
    gears, scene = _drawn_section("spiral_bevel_basic")
    pair, (cones,) = gears.pairs[0], scene.curves
    assert cones.label == "pitch cones"
    apex = pair.pinion.mount.origin
    for mount, part, tangent in zip(pair.mounts, np.split(cones.points, 2), (13 / 44, 44 / 13), strict=True):
        away = part[np.isfinite(part[:, 0])] - apex - 0.01 * scene.camera.height * scene.camera.axes[2]
        along = away @ mount.axis
        across = np.linalg.norm(away - along[:, None] * mount.axis, axis=-1)
        assert across / np.abs(along) == pytest.approx(tangent, rel=1e-9)
        # on one side of the apex: the teeth's
        assert abs(np.sign(along).sum()) == len(along)
        assert np.abs((away + apex - scene.camera.focus) @ scene.camera.axes[2]).max() < 1e-9
    assert {"0", "12", "43"} <= {word.text for word in scene.words}
    _, scene = _drawn_section("hypoid")
    assert scene.curves == ()
    assert {word.text for word in scene.words} >= {"0", "11"}


@pytest.mark.sweep
def test_section_of_a_rack_has_its_pitch_line() -> None:
    """At the radius z m_n / (2 cos beta) of the pinion: z 20, m_n 2 mm, 19.5283 deg."""
    gears, scene = _drawn_section("rack")
    mounts, curve = gears.pairs[0].mounts, scene.curves[0]
    assert curve.label == "pitch circle and pitch line"
    circle, line = np.split(curve.points, 2)
    axis, radius = mounts[0].axis, 20.0 / np.cos(np.radians(19.5283))
    for part in (circle, line):
        away = part[:-1] - mounts[0].origin
        reach = np.linalg.norm(away - (away @ axis)[:, None] * axis, axis=-1)
        assert reach.min() == pytest.approx(radius, rel=1e-5)
    way = np.diff(line[:-1], axis=0)
    assert np.abs(np.cross(way, mounts[1].velocity(mounts[1].origin))).max() < 1e-9


def test_legend_leaves_out_pitch_circles_beyond_the_picture() -> None:
    """The pitch circles of a cycloidal drive, 19 and 20 eccentricities, are far inside of its pins."""
    gears = gm.build(gm.load(SAMPLES / "cycloidal.toml"))
    pair = gears.pairs[0]
    rolling = rolling_contact(pair, gears.contact([0.0], cycle=False).path, np.zeros(1))
    assert mesh_section(rolling, dict.fromkeys(pair.members, None), (640, 480)).scenes()[0].curves == ()


def test_section_of_a_worm_drive_is_axial_section_and_middle_section() -> None:
    """Through the worm's axis, across the wheel's; lines of contact have their dots where they cross it."""
    gears = gm.build(gm.load(SAMPLES / "worm_drive.toml"))
    pair = gears.pairs[0]
    path = gears.contact([0.0], cycle=False).path
    section = mesh_section(rolling_contact(pair, path), dict.fromkeys(pair.members, None), (64, 48))
    (right, up, back), focus = section.camera.axes, section.camera.focus
    assert abs(back @ pair.gear.mount.axis) == pytest.approx(1.0, abs=1e-12)
    assert abs(right @ pair.pinion.mount.axis) == pytest.approx(1.0, abs=1e-12)
    assert abs((focus - pair.pinion.mount.origin) @ back) < 1e-9
    assert up @ (pair.pinion.mount.origin - focus) > 0.0
    points = section.points[np.isfinite(section.points[..., 0])]
    assert len(points) >= 1
    assert np.abs((points - focus) @ back).max() < 1e-2


@pytest.mark.sweep
def test_sections_of_a_set_name_their_mesh_and_have_no_facets(monkeypatch: pytest.MonkeyPatch) -> None:
    """Meshed within less than half a pixel."""
    asked = []

    def meshes(gears: gm.Gears, mesh: GearPair, tolerance: float) -> dict[str, None]:
        asked.append(tolerance)
        return dict.fromkeys(mesh.members, None)

    monkeypatch.setattr(reports_pictures, "_meshes", meshes)
    gears = gm.build(gm.load(SAMPLES / "planetary.toml", ["mesh.tolerance=0.05"]))
    scene = gears.picture("section", pair="planet_1-ring", size=(1600, 1200))._scene
    assert scene.title.endswith("section of the mesh planet_1-ring")
    assert asked[0] < 0.5 * scene.camera.height / 1200


@pytest.mark.skipif(opengl.missing_opengl_message() is not None, reason="needs OpenGL")
def test_an_animation_moves_and_is_the_same_twice(tmp_path: Path) -> None:
    from PIL import Image

    rolling = gm.build(gm.load(SAMPLES / "beveloid_crossed.toml", ["mesh.tolerance=0.05"])).animation(size=(160, 120))
    assert len(rolling._scenes) == 24
    for name in ("a.gif", "b.gif"):
        write_animation(tmp_path / name, list(rolling._scenes[::12]))
    assert (tmp_path / "a.gif").read_bytes() == (tmp_path / "b.gif").read_bytes()
    with Image.open(tmp_path / "a.gif") as image:
        assert (image.n_frames, image.size) == (2, (160, 120))
        first = np.asarray(image.convert("RGB")).astype(int)
        image.seek(1)
        assert (np.abs(np.asarray(image.convert("RGB")) - first).max(axis=-1) > 40).mean() > 0.01
    with pytest.raises(gm.OutputError, match=r"its suffix must be \.gif or \.mp4"):
        rolling.save(tmp_path / "a.avi")
