"""Positions of the axes of a pair."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.examples import some
from oracles.places import SAMPLES

import gearmesh as gm


@pytest.mark.parametrize(
    ("sample", "given", "angle"),
    some(
        [
            *(
                (sample, [f"shaft_angle={angle}"], angle)
                for sample in ("face_gear", "zerol")
                for angle in (75, 90, 105)
            ),
            ("zerol", ["shaft_angle=105", "hand=right", "contact.side=pinion_convex"], 105),
            ("spiral_bevel_geometry1", ["shaft_angle=100"], 100),
            ("helical", [], 0),
            ("beveloid_parallel", [], 0),
            ("beveloid_intersected", ["contact.flank=left"], 60),
        ],
        4,
    ),
)
@pytest.mark.sweep_cases("zerol-given3-75")
def test_the_shaft_angle_is_that_of_the_design(sample: str, given: list[str], angle: float) -> None:
    pair = gm.build(gm.load(SAMPLES / f"{sample}.toml", given)).pairs[0]
    assert np.degrees(pair.shaft_angle) == pytest.approx(angle, abs=1e-9)
    assert np.degrees(pair.acute_angle) == pytest.approx(min(angle, 180 - angle), abs=1e-9)
