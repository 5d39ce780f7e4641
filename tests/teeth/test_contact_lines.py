"""Lines of contact on the tool: n . v = 0 there, v by differences of the motion's matrices; and what they cover."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.errors import DesignError
from gearmesh.kernel.algebra import Array
from gearmesh.kernel.envelope import Envelope
from gearmesh.kernel.feed_envelope import FeedEnvelope
from gearmesh.kernel.feed_motion import FeedMotion
from gearmesh.kernel.rigid import Rigid
from gearmesh.teeth.contact_lines import ContactLine, tool_contact
from gearmesh.teeth.region import Side

#: rad or mm to either side at which a motion is differenced; n . v, in reaches of the tool, beyond what this loses: STEP^2 / 6
#: times the third power of how many times faster the blank may turn
STEP, NONE = 1e-4, 2e-7


def meeting(before: Rigid, here: Rigid, after: Rigid, line: ContactLine, step: float = STEP) -> Array:
    """n . v (...,) at the points of a line, in its reach from the origin, of which a motion takes the tool to the blank."""
    velocity = (after.point(line.points) - before.point(line.points)) / (2.0 * step)
    reach = np.nanmax(np.linalg.norm(line.points, axis=-1))
    return np.asarray((here.vector(line.normals) * velocity).sum(axis=-1) / reach)


@pytest.mark.parametrize(
    ("sample", "name"),
    [("helical", "pinion"), ("spiral_bevel_basic", "pinion"), ("face_gear", "gear")],
)
def test_tool_and_tooth_touch_along_the_lines(sample: str, name: str) -> None:
    tooth = gm.build(gm.load(SAMPLES / f"{sample}.toml")).members[name].tooth
    for side in Side:
        found, flank = tool_contact(tooth, side), tooth.unmodified.side(side).flank
        assert isinstance(flank, Envelope)
        generated = flank.parameter(
            *np.moveaxis(tooth.unmodified.flank_grid(side, [0, 0.5, 1], [0, 0.5, 1]).parameters, -1, 0)
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
            # a little earlier the tool touches elsewhere
            assert np.nanmin(np.abs(at(line.at - 0.01))) > 100.0 * NONE


def test_worms_touch_along_one_line_over_the_roll() -> None:
    tooth = gm.build(gm.load(SAMPLES / "novikov.toml")).members["pinion"].tooth
    (line,) = (found := tool_contact(tooth, Side.RIGHT)).lines
    flank = tooth.unmodified.side(Side.RIGHT).flank
    assert isinstance(flank, FeedEnvelope)
    assert found.name == "grinding worm"
    assert not found.rolls
    assert isinstance(flank.motion, FeedMotion)
    several, turns = flank.motion.at_several, abs(flank.motion.tool_turn)

    def left(psi: Array, own: Array, roll: float, feed: float) -> Array:
        """n . v (...,) of points `own` (...,) of the line at rolls psi (...,) as roll or feed change by so much."""
        part = ContactLine(line.at, line.points[own], line.normals[own])
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


def test_the_picture_shows_the_lines_and_refuses_what_does_not_roll() -> None:
    scene = gm.build(gm.load(SAMPLES / "helical.toml")).picture("contact_lines").scene
    assert scene.title.endswith("rack cutter of pinion, right flank: lines of contact")
    labels = [curve.label for curve in scene.curves if curve.label]
    assert len(labels) == 6
    assert labels[0] == "rotation -20.75°"
    formate = gm.build(gm.load(SAMPLES / "spiral_bevel_formate.toml"))
    with pytest.raises(DesignError, match="view = contact_lines: this flank is cut without a generating roll"):
        formate.picture("contact_lines", "gear")
    with pytest.raises(DesignError, match=r"view = contact_lines: .* \(Twisted\) is not shown"):
        gm.build(gm.load(SAMPLES / "internal.toml")).picture("contact_lines", "gear")
