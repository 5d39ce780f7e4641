"""Dual lead worms: a shift of the worm changes the backlash linearly, and nothing else, of both hands."""

from __future__ import annotations

import math

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.systems.designs import load
from gearmesh.systems.worm_drive.build import worm_thread

SAMPLE = SAMPLES / "worm_drive_dual_lead.toml"
E, WAY = 0.015, 0.5 * 3.0 * 45


@pytest.mark.sweep
@pytest.mark.parametrize("hand", [1, -1])
def test_shift_of_the_worm_changes_the_backlash_linearly(hand: int) -> None:
    """A thread shifted by s is one turned by s / P: the wheel's flanks lie s / K (1 + e) and s / K (1 - e) farther."""
    backlash = []
    for shift in (0.0, 0.8):
        keys = [f"worm.right_hand={str(hand > 0).lower()}", f"assembly.dz1={hand * shift}", "contact.phi1.count=5"]
        summary = gm.build(gm.load(str(SAMPLE), keys)).contact().summary
        backlash.append(summary["backlash_min_deg"])
        assert summary["backlash_max_deg"] == pytest.approx(backlash[-1], abs=1e-7)
        assert summary["mesh_te_peak_to_peak_arcsec"] * math.pi / 648000.0 < 1e-9
    grown = 2.0 * E * 0.8 / (WAY * (1.0 - E**2))
    assert math.radians(backlash[1] - backlash[0]) == pytest.approx(grown, abs=1e-9)


@pytest.mark.parametrize("hand", [1, -1])
def test_threads_grow_thicker_along_the_axis(hand: int) -> None:
    """Axial thickness on the reference cylinder at z: that of the middle and 2 e z, along +z of right-hand worms."""
    design = load(str(SAMPLE), [f"worm.right_hand={str(hand > 0).lower()}"])
    ways = []
    for angle in (-9.0, 0.0, 7.0):
        z = []
        for side in (1, -1):
            thread = worm_thread(design, side)
            at = thread.flank(side).jet(np.array(thread.at_radius(thread.radius)), np.array(0.0))
            # the same point of the helix in the plane at the polar angle
            z.append(at.r[2] + hand * thread.screw * (angle - math.atan2(at.r[1], at.r[0])))
        middle = 0.5 * (z[0] + z[1])
        ways.append(abs(z[0] - z[1]) - 2.0 * E * hand * middle)
    # in the plane at a polar angle: of the middle between the flanks, 2 e z to the second order of e
    np.testing.assert_allclose(ways, ways[1], rtol=0, atol=2.0 * E**2 * 3.0 + 1e-9)
