"""Flanks in other mountings: what is tabulated of a flank goes along, and only where it is the same."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import GearPair, Rigid
from gearmesh.contact.conditions import meshing
from gearmesh.contact.first_touch.first_touch import first_touch
from gearmesh.contact.flanks import solver_pair
from gearmesh.kernel.numeric.algebra import rotation_about
from gearmesh.teeth.kept_by_tooth import stand_for


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


@pytest.mark.sweep
def test_a_tooth_that_moves_keeps_the_tables_of_the_solver() -> None:
    def built() -> GearPair:
        return gm.build(gm.load(SAMPLES / "helical.toml")).train.pairs[0]

    def moved(pair: GearPair, by: float) -> GearPair:
        mount = pair.gear.mount
        base = replace(mount.base, translation=mount.base.translation + np.array([by, 0.0, 0.0]))
        return replace(pair, gear=replace(pair.gear, mount=replace(mount, base=base)))

    pair, other = built(), built()
    first, second = solver_pair(pair), solver_pair(moved(pair, 0.02))
    assert second.gear.heights is first.gear.heights
    assert second.gear.mount is not first.gear.mount
    phi1 = np.linspace(-0.2, 0.2, 5)
    fresh = solver_pair(moved(other, 0.02))
    assert fresh.gear.heights is not first.gear.heights
    assert first_touch(second, phi1).advance.tolist() == first_touch(fresh, phi1).advance.tolist()
    # another tooth uses the tables as soon as it is known to be the same
    again = built()
    stand_for(pair.gear.tooth, again.gear.tooth)
    assert solver_pair(again).gear.heights is first.gear.heights
    assert solver_pair(again).pinion.heights is not first.pinion.heights
