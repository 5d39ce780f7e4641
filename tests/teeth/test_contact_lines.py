"""Lines of contact of tool and tooth: n . v = 0 there, v by differences of the motion's matrices; and what they cover."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import DesignError, Rigid
from gearmesh.kernel.envelope.indexed_envelope import IndexedEnvelope
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import Envelope, FeedEnvelope, FeedMotion, Side
from gearmesh.teeth.generation.contact_lines import ContactLine, tool_contact
from gearmesh.view.projection import flank_projection

#: rad or mm to either side at which a motion is differenced; n . v, in reaches of the tool, beyond what this loses: STEP^2 / 6
#: times the third power of how many times faster the blank may turn
STEP, NONE = 1e-4, 2e-7
#: mm by which points of a line may be off the exact flank
OFF = 1e-6


def meeting(before: Rigid, here: Rigid, after: Rigid, line: ContactLine, step: float = STEP) -> Array:
    """n . v (...,) at the points of a line, in its reach from the origin, of which a motion takes the tool to the blank."""
    velocity = (after.point(line.points) - before.point(line.points)) / (2.0 * step)
    reach = np.nanmax(np.linalg.norm(line.points, axis=-1))
    return np.asarray((here.vector(line.normals) * velocity).sum(axis=-1) / reach)


@pytest.mark.sweep_cases("spiral_bevel_basic-pinion", "face_gear-gear")
@pytest.mark.parametrize(
    ("sample", "name"),
    [("helical", "pinion"), ("spiral_bevel_basic", "pinion"), ("face_gear", "gear")],
)
def test_tool_and_tooth_touch_along_the_lines(sample: str, name: str) -> None:
    member = gm.build(gm.load(SAMPLES / f"{sample}.toml")).members[name]
    tooth = member.tooth
    for side in Side:
        project = flank_projection(member, side)
        found, flank = tool_contact(tooth, side), tooth.unmodified_tooth.side(side).flank
        assert isinstance(flank, Envelope)
        generated = flank.parameter(
            *np.moveaxis(tooth.unmodified_tooth.flank_grid(side, [0, 0.5, 1], [0, 0.5, 1]).parameters, -1, 0)
        )
        assert len(found.lines) == 6
        assert found.rolls
        for line in found.lines:
            assert generated.min() < line.at < generated.max()
            assert np.isfinite(line.points[:, 0]).sum() > 10

            def at(phi: float, line: ContactLine = line, flank: Envelope = flank) -> Array:
                places = (flank.motion.at(np.array(phi + step)).tool_to_blank for step in (-STEP, 0.0, STEP))
                return meeting(*places, line)

            assert np.nanmax(np.abs(at(line.at))) < NONE
            # the tooth has them too: on its exact flank, sought without the envelope's parameters, and where the tool stands then
            own, normals = (each[np.isfinite(each[:, 0])] for each in line.on_tooth)
            nearest = project(own)
            off = np.linalg.norm(nearest - own, axis=-1)
            assert np.nanmax(off) < OFF
            assert np.isfinite(off).mean() > 0.8
            standing = flank.motion.at(np.array(line.at)).tool_to_blank
            known = np.isfinite(line.points[:, 0])
            np.testing.assert_allclose(standing.point(line.points[known]), own, rtol=0, atol=OFF)
            np.testing.assert_allclose(standing.vector(line.normals[known]), normals, rtol=0, atol=OFF)
            # a little earlier the tool touches elsewhere
            assert np.nanmin(np.abs(at(line.at - 0.01))) > 100.0 * NONE


@pytest.mark.sweep
def test_edges_that_index_touch_at_rotations_of_the_cradle() -> None:
    """A pinion cut with modified roll has lines as one cut by a crown gear; one line of a feed in mm stood for them."""
    values = {"kind": "spiral_bevel", "process": "face_hobbed_formate", "module": 4.5, "spiral_angle": 33}
    gears = gm.build(gm.parse({**values, "pinion": {"teeth": 13}, "gear": {"teeth": 41}}))
    member = gears.members["pinion"]
    flank = member.tooth.side(Side.RIGHT).flank
    assert isinstance(flank, IndexedEnvelope)
    found, project = tool_contact(member.tooth, Side.RIGHT), flank_projection(member, Side.RIGHT)
    assert found.rolls
    assert len(found.lines) == 6
    rolls = flank.rolls(*np.moveaxis(member.tooth.flank_grid(Side.RIGHT, [0, 1], [0, 1]).parameters, -1, 0))
    for line in found.lines:
        assert rolls.min() < line.at < rolls.max()
        own = line.on_tooth[0][np.isfinite(line.on_tooth[0][:, 0])]
        off = np.linalg.norm(project(own) - own, axis=-1)
        assert np.nanmax(off) < OFF
        assert np.isfinite(off).mean() > 0.8


def test_lines_on_a_face_gear_pinion_match_the_shaper() -> None:
    """L_s1 [LF04 18.4]: shaper, pinion and its rack have normals through one pitch line, where two involutes touch."""
    design = gm.load(SAMPLES / "face_gear.toml")
    member, (teeth, shaper) = gm.build(design).members["pinion"], (25, 28)
    half, alpha = 0.5 * design.in_mm().module, np.radians(design.pressure_angle)  # type: ignore[attr-defined]
    for side in Side:
        beginnings, turns = [], []
        lines = tool_contact(member.tooth, side).lines
        for line in lines:
            points, normals = (each[..., 0] + 1j * each[..., 1] for each in line.on_tooth)
            # about the pinion's axis until the normal leans by alpha: then it passes through the pitch line
            turn = np.exp(1j * np.angle(-1j * side.sign * np.exp(1j * side.sign * alpha) / normals[0]))
            placed, normal = turn * points + half * (shaper - teeth), turn * normals
            apart = ((placed - half * shaper) * np.conj(normal)).imag
            np.testing.assert_allclose(apart, 0.0, atol=OFF)
            # the involute of the shaper's base circle with that normal: where it begins turns with the shaper
            base = half * shaper * np.cos(alpha)
            foot = normal / 1j * (placed * np.conj(normal / 1j)).real
            np.testing.assert_allclose(np.abs(foot), base, rtol=0, atol=OFF)
            rolled = ((placed - foot) * np.conj(foot / 1j)).real / base**2
            beginnings.append(float(np.angle(foot[0]) - rolled[0]))
            turns.append(np.angle(turn))
        turned, begun = np.unwrap(turns), np.unwrap(beginnings)
        np.testing.assert_allclose(np.diff(turned) * teeth / shaper, np.diff(begun), rtol=0, atol=1e-9)
        np.testing.assert_allclose(np.abs(np.diff(turned)), np.diff([line.at for line in lines]), rtol=0, atol=1e-9)


def test_worms_touch_along_one_line_over_the_roll() -> None:
    tooth = gm.build(gm.load(SAMPLES / "novikov.toml")).members["pinion"].tooth
    (line,) = (found := tool_contact(tooth, Side.RIGHT)).lines
    flank = tooth.unmodified_tooth.side(Side.RIGHT).flank
    assert isinstance(flank, FeedEnvelope)
    assert found.name == "grinding worm"
    assert not found.rolls
    assert isinstance(flank.motion, FeedMotion)
    several, turns = flank.motion.at_several, abs(flank.motion.tool_turn)

    def left(psi: Array, own: Array, roll: float, feed: float) -> Array:
        """n . v (...,) of points `own` (...,) of the line at rolls psi (...,) as roll or feed change by so much."""
        part = replace(line, points=line.points[own], normals=line.normals[own])
        places = (several(psi + k * roll, np.array(line.at + k * feed)).tool_to_blank for k in (-1.0, 0.0, 1.0))
        return meeting(*places, part, roll or feed)

    # the rolls at which n . v of the roll is 0 are sought without the solver; one of them must be so for the feed, too
    every, step = np.arange(len(line.points)), STEP / turns
    scan = 3.0 * np.pi / turns * np.linspace(-1.0, 1.0, 301)
    signs = left(scan[:, None], every, step, 0.0) > 0.0
    row, own = np.nonzero(signs[1:] != signs[:-1])
    low, high = scan[row], scan[row + 1]
    for _ in range(40):
        middle = 0.5 * (low + high)
        beyond = (left(middle, own, step, 0.0) > 0.0) != signs[row, own]
        low, high = np.where(beyond, low, middle), np.where(beyond, middle, high)
    least, feeds = np.full(len(every), np.inf), np.abs(left(low, own, 0.0, STEP))
    np.minimum.at(least, own, feeds)
    assert len(every) > 40
    assert least.max() < NONE
    assert np.median(feeds) > 100.0 * NONE


@pytest.mark.sweep
def test_the_picture_shows_the_lines_and_refuses_what_does_not_roll() -> None:
    helical = gm.build(gm.load(SAMPLES / "helical.toml"))
    scene = helical.picture("contact_lines")._scene
    assert scene.title.endswith("pinion and its rack cutter, right flank: lines of contact")
    labels = [curve.label for curve in scene.curves if curve.label]
    assert len(labels) == 6
    assert labels[0] == "rotation -20.75°"
    # none floats: on tool and tooth they are lifted by the same slight amount
    _, tooth = scene.bodies
    project = flank_projection(helical.members["pinion"], Side.RIGHT)
    for curve in scene.curves[2::2]:
        own = tooth.own_to_scene.inverse.point(curve.points[np.isfinite(curve.points[:, 0])])
        lifted = np.linalg.norm(project(own) - own, axis=-1)
        assert np.nanmin(lifted) > 0.0
        assert np.nanmax(lifted) < 0.1
        assert np.nanmax(lifted) - np.nanmin(lifted) < OFF
    # toe and heel are on the same side of both, and the tip of the tool at the root of the tooth
    pairs = zip(scene.curves[1::2], scene.curves[2::2], strict=True)
    axes = scene.camera.axes
    for on_tool, on_tooth in pairs:
        assert (np.nanmean(on_tooth.points, axis=0) - np.nanmean(on_tool.points, axis=0)) @ axes[1] > 0.0
        ends = (points[np.isfinite(points[:, 0])] @ axes[0] for points in (on_tool.points, on_tooth.points))
        assert np.prod([end[-1] - end[0] for end in ends]) > 0.0
    # a spline's, which are six times as long, are turned away until they take as much of the height
    spline = gm.build(gm.load(SAMPLES / "spline.toml")).picture("contact_lines", "shaft", size=(800, 600))._scene
    shown = [body.own_to_scene.point(body.mesh.vertices) for body in spline.bodies]
    assert np.ptp(spline.camera.pixels(np.concatenate(shown), (800, 600))[:, 1]) > 0.38 * 600
    formate = gm.build(gm.load(SAMPLES / "spiral_bevel_formate.toml"))
    with pytest.raises(DesignError, match="view = contact_lines: this flank is cut without generating roll"):
        formate.picture("contact_lines", "gear")
    with pytest.raises(
        DesignError, match="view = contact_lines: the planing tool that cuts this flank cannot be shown"
    ):
        gm.build(gm.load(SAMPLES / "rack.toml")).picture("contact_lines", "rack")


def test_the_tool_is_whole_where_its_tip_undercuts_the_tooth() -> None:
    """Flank and tip rounding of the hob do not meet in the form point of an undercut pinion: the rest of the flank joins them."""
    tool = tool_contact(gm.build(gm.load(SAMPLES / "hob_protuberance.toml")).members["pinion"].tooth, Side.RIGHT)
    flank, rest, tip = (sheet.points for sheet in tool.sheets)
    assert np.linalg.norm(tip[0] - flank[-1], axis=-1).min() > 0.1
    assert np.array_equal(rest, [flank[-1], tip[0]])
    whole = gm.build(gm.load(SAMPLES / "helical.toml")).members["pinion"].tooth
    assert len(tool_contact(whole, Side.RIGHT).sheets) == 2
