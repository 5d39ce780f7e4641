"""Diagrams of micro-geometry: what they draw is what the points of the flanks are off their true involutes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from oracles.built import pair_of

from gearmesh import parse
from gearmesh.kinds import Side
from gearmesh.teeth.micro_geometry.screw_involute import ScrewInvolute
from gearmesh.view.diagrams.modification_diagrams import flank_map, is_modified, plot_modifications

FIELDS = {"tip_relief": {"amount": "20um", "start_roll_length": 13}, "helix_crowning": "8um"}


@pytest.mark.sweep
def test_maps_are_measured_on_the_flanks(tmp_path: Path) -> None:
    pinion = {"teeth": 22, "face_width": 24, "helix_angle": 18, "modifications": FIELDS}
    gear = {"teeth": 40, "face_width": 22, "helix_angle": -18}
    pair = pair_of(parse({"kind": "beveloid", "module": 3, "pinion": pinion, "gear": gear}))
    assert is_modified(pair.pinion)
    assert not is_modified(pair.gear)
    for side in Side:
        found = flank_map(pair.pinion, side, 401)
        assert found.breaks == ((13.0,), ())
        grid = pair.pinion.tooth.flank_grid(side, np.linspace(0.0, 1.0, 9), [0.0, 0.5, 1.0])
        flank = pair.pinion.tooth.side(side).flank
        assert isinstance(flank, ScrewInvolute)
        r, base = grid.points, flank.base_radius
        length = np.sqrt(r[..., 0] ** 2 + r[..., 1] ** 2 - base**2)
        # the polar angle of an involute is that of its beginning and inv(alpha)
        along = length / base - np.arctan(length / base)
        begun = np.arctan2(r[..., 1], r[..., 0]) - side.sign * along - flank.rate * r[..., 2] - flank.start
        measured = 1e3 * base * side.sign * (begun + np.pi * 2.0 * np.round(-begun / (2.0 * np.pi)))
        for j, k in enumerate((0, 200, 400)):
            np.testing.assert_allclose(
                measured[:, j], np.interp(length[:, j], found.length, found.removed[:, k]), atol=0.05
            )
            ends = [0, -1]
            np.testing.assert_allclose(measured[ends, j], found.removed[ends, k], atol=1e-6)
    file = tmp_path / "m.png"
    plot_modifications(file, pair.pinion)
    first = file.read_bytes()
    plot_modifications(file, pair.pinion)
    assert file.read_bytes() == first
