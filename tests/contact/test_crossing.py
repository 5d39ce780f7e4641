"""Flanks that cross where they are tangent: found, and told with what helps against it."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.contact.first_touch.crossing import crossing, crossing_over_a_pitch
from gearmesh.contact.first_touch.field import advances
from gearmesh.contact.flanks import solver_pair
from gearmesh.kinds import Region

STEEP = Path(__file__).parents[1] / "corpus" / "crossing_worm_drive_87.toml"


def test_steep_threads_cross_the_wheel_of_a_larger_hob() -> None:
    """The rotation of first touch over the flank, from tables alone: where the flanks are tangent, the same at every position, it
    is neither greatest nor least; of a wheel that a larger hob leaves for gentle threads it is greatest."""
    positions = np.linspace(-1.0, 1.0, 5)
    highest = []
    for design, crossed in ((STEEP, True), (SAMPLES / "worm_drive.toml", False)):
        pair = gm.build(gm.load(design, [] if crossed else ["hob.reference_diameter=66"])).train.pairs[0]
        part = solver_pair(pair).parts[0]
        assert (crossing(part, positions) == crossed).all()
        assert crossing_over_a_pitch(part, 2.0 * pair.pitch * np.array([-1.0, 1.0]), pair.pitch) == crossed
        nodes = part.pinion.grid.reshape(-1, 2)
        jet = part.pinion.surface.jet(nodes[:, 0], nodes[:, 1])
        field = advances(part, positions, jet.r, jet.n, np.arange(len(positions)))
        on = np.where((field.beyond <= 0.0).all(axis=0), field.advance, np.nan)
        # by theory 0 where they are tangent; over 0.01 mm at the wheel's radius of 80 to 110 mm
        highest.append(np.nanmax(on, axis=1) > 1e-4)
    assert highest[0].all()
    assert not highest[1].any()


@pytest.mark.sweep
def test_the_warning_names_what_keeps_them_apart() -> None:
    """And the worm's own hob does; what errors of mounting leave of lines keeps the usual remedy."""
    crossed = gm.build(gm.load(STEEP)).contact()
    (line,) = (line for line in crossed.warnings if line.startswith("edge contact alone"))
    assert "they cross" in line
    assert "hob.reference_diameter left out" in line
    assert "errors of assembly" not in line
    keys = tomllib.loads(STEEP.read_text(encoding="utf-8"))
    del keys["hob"]
    gears = gm.build(gm.parse(keys))
    # where flanks turn back along the face their grids went to another sheet, 5.7 mm beyond the tip
    wheel = gears.members["wheel"].tooth
    tips = wheel.grid(Region.FLANK_RIGHT, np.array([1.0]), wheel.sections(np.linspace(0.0, 1.0, 97))).points
    assert np.abs(wheel.blank.tip.value(tips)).max() < 1e-6
    contact = gears.contact()
    assert (contact.path.kind == "line").any()
    assert not any("edge contact alone" in line for line in contact.warnings)
    leant = gm.build(gm.load(SAMPLES / "worm_drive.toml", ["assembly.da=0.05", "assembly.d_sigma=0.05"])).contact()
    (line,) = (line for line in leant.warnings if line.startswith("edge contact alone"))
    assert line.endswith("crowning, or smaller errors of assembly, bring the contact there")
