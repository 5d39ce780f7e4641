"""Flanks in other mountings: what is tabulated of a flank goes along, and only where it is the same."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import Rigid
from gearmesh.contact.conditions import meshing
from gearmesh.contact.flanks import solver_pair
from gearmesh.kernel.numeric.algebra import rotation_about


def test_a_table_is_made_once_for_all_mountings(monkeypatch: pytest.MonkeyPatch) -> None:
    made = []
    real = meshing.heights
    monkeypatch.setattr(meshing, "heights", lambda *a, **k: made.append(a) or real(*a, **k))
    flanks = solver_pair(pair_of(gm.load(SAMPLES / "rack.toml")))
    gear, rack = flanks.pinion, flanks.gear
    away = Rigid(rotation_about("x", 0.1), np.array([1.0, 2.0, 3.0]))
    there = gear.remount(replace(gear.mount, base=away @ gear.mount.base))
    further = there.remount(replace(gear.mount, base=away @ there.mount.base))
    assert further.heights is there.heights is gear.heights
    assert len(made) == 1
    np.testing.assert_allclose(further.mount.base.translation, away.point(there.mount.base.translation))
    # another flank of the same mounting, and the same along another joint, have their own
    half = replace(further, grid=further.grid[:, : further.grid.shape[1] // 2 + 1])
    assert half.heights.parameters.shape[1] < gear.heights.parameters.shape[1]
    sliding = further.remount(replace(further.mount, joint=rack.mount.joint))
    assert np.abs(sliding.heights.low - gear.heights.low).max() > 1e-3
    assert len(made) == 3
