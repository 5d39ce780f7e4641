"""Crossed helical gears, whose contact moves along a straight line: everything is known in closed form, at any shaft angle."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.examples import some

import gearmesh as gm
from gearmesh.check.members import roll_members
from gearmesh.kernel.numeric.algebra import ARCSEC

MODULE, ALPHA = 2.0, np.radians(20.0)
TEETH = np.array([17, 23])


@pytest.mark.parametrize(("first", "second"), some([(30.0, 15.0), (47.0, 45.0), (50.0, 58.0)], 1))
def test_contact_matches_closed_form_on_either_side_of_90_degrees(first: float, second: float) -> None:
    helix = np.radians([first, second])
    gears = gm.build(
        gm.parse(
            {
                "kind": "beveloid",
                "module": MODULE,
                "backlash": 0.1,
                "pinion": {"teeth": int(TEETH[0]), "helix_angle": first, "face_width": 30.0},
                "gear": {"teeth": int(TEETH[1]), "helix_angle": second, "face_width": 30.0},
            }
        )
    )
    answer = gears.contact()
    assert answer.summary["shaft_angle_deg"] == pytest.approx(first + second, abs=1e-12)
    assert answer.summary["te_peak_to_peak_arcsec"] < 1e-8
    # from the pitch point along the normal of the rack to either tip
    radius = 0.5 * MODULE * TEETH / np.cos(helix)
    across, along = radius * np.sin(ALPHA), np.cos(ALPHA) * np.cos(helix)
    tip = radius + MODULE
    square = np.sin(ALPHA) ** 2 + along**2
    length = (-across + np.sqrt(across**2 + square * (tip**2 - radius**2))) / square
    assert answer.summary["contact_ratio"] == pytest.approx(length.sum() / (np.pi * MODULE * np.cos(ALPHA)), abs=1e-9)
    pair, path = gears.pairs[0], answer.path
    middle = len(path.phi1) // 2
    rolled = roll_members(pair, path.rotation[middle], guess_phi2=path.phi2[middle])[0]
    assert rolled.drive is not None
    assert abs(rolled.drive.phi2 - path.phi2[middle]) < 0.05 * ARCSEC
