"""Crowned teeth under more and more torque: a parabola of transmission error that flattens, then inverts."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.loaded import geared

import gearmesh as gm
from gearmesh.loaded.sharing import loaded_mesh

CROWNED = tuple(
    f"{name}.modifications.{key}=20um" for name in ("pinion", "gear") for key in ("profile_crowning", "helix_crowning")
)


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("sample", "keys", "torques", "crest"),
    [
        ("spiral_bevel_basic", (), (2.0, 55.0, 150.0), 0.0),
        ("helical", CROWNED, (20.0, 1000.0, 2200.0), 0.68),
    ],
)
def test_there_is_a_torque_at_which_crowned_gears_run_most_evenly(
    sample: str, keys: tuple[str, ...], torques: tuple[float, ...], crest: float
) -> None:
    """Peak to peak is less at the middle torque than at both ends, and the bend at the crest of the unloaded error changes over."""
    pair, bodies = geared(sample, *keys)
    phases = crest + np.array([-0.45, -0.12, 0.0, 0.12, 0.45])
    found = loaded_mesh(pair, pair.pitch * phases, 1e3 * np.array(torques), bodies)
    te = found.te
    little, even, much = np.ptp(te, axis=1)
    assert even < 0.5 * little
    assert even < 0.7 * much
    bend = te[:, 1] - 2.0 * te[:, 2] + te[:, 3]
    assert bend[0] < 0.0 < bend[2]
    # under little torque it is nearly that of rigid gears
    assert little == pytest.approx(np.ptp(found.unloaded), rel=0.1)


@pytest.mark.sweep
def test_teeth_that_touch_beyond_their_flanks_are_refused() -> None:
    tables = {
        "pinion": {"teeth": 17, "tip_diameter": 53.5},
        "gear": {"teeth": 40, "tip_diameter": 121.5, "dedendum": 0.4},
    }
    faces = {name: {**table, "face_width": 20} for name, table in tables.items()}
    design = {"kind": "cylindrical", "module": 3, "backlash": 0.8, "assembly": {"dx": 0.1}, **faces}
    with pytest.raises(gm.NoSolutionError, match=r"at phi1 = .* deg the teeth touch beyond their flanks"):
        gm.build(gm.parse(design)).loaded_contact(50.0, [0.0])
