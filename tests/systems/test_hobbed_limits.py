"""Where undercut ends the flanks of face-hobbed pinions: against blades moved axis by axis."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from oracles.moved_blades import clearances

import gearmesh as gm
from gearmesh.kinds import along
from gearmesh.systems.spiral_bevel.machine.generated import Generated
from gearmesh.systems.spiral_bevel.synthesis.teeth_choice import bevel_teeth

#: few teeth of full depth: both sides are undercut from the toe on
FEW_TEETH: dict[str, Any] = {
    **{"kind": "spiral_bevel", "process": "face_hobbed", "module": 5, "spiral_angle": 32, "gear": {"teeth": 39}},
    **{"depth_factor": 2, "pinion": {"teeth": 8}, "addendum_factor": 0.35},
}
#: height over and under the end of the flank, mm
STEP = 0.01


def least(side: Generated, points: tuple[np.ndarray, np.ndarray], x: np.ndarray, roll: np.ndarray) -> np.ndarray:
    """Least distance (N,) along normals of the tip roundings, over rotation of the head and roll.

    `x`: rotation of the cutter, parameter of the rounding, and distance (N, 3) near it; `roll`: rolls (N,) near it.
    """
    step, best = 0.003, clearances(side, roll, points, x, rounding=True)
    start = best, roll
    for sign in (1.0, -1.0):
        x, at = start
        for _ in range(6):
            at = at + sign * step
            x = clearances(side, at, points, x, rounding=True)
            nearer = (x[:, 2] < best[:, 2]) & (x[:, 1] > side.blade.form_point[1]) & (x[:, 1] < side.blade.root)
            best, roll = np.where(nearer[:, None], x, best), np.where(nearer, at, roll)
    for _ in range(6):
        # least of three rolls, and the vertex of the parabola through them
        tried = [clearances(side, roll + k * step, points, best, rounding=True)[:, 2] for k in (-1.0, 0.0, 1.0)]
        bend, slope = tried[0] - 2.0 * tried[1] + tried[2], 0.5 * (tried[2] - tried[0])
        assert (bend > 0.0).all()
        roll, step = roll - step * slope / bend, 0.4 * step
        best = clearances(side, roll, points, best, rounding=True)
    return np.asarray(best[:, 2])


@pytest.mark.parametrize("name", ["concave", "convex"])
@pytest.mark.sweep_cases("concave")
def test_undercut_ends_the_flank_where_moved_blades_graze_it(name: str) -> None:
    """The least distance of the rounding is 0 at the end of the flank; it clears the flank above, and cuts it below."""
    teeth = bevel_teeth(gm.parse(FEW_TEETH).in_mm())  # type: ignore[arg-type]
    made, tooth = replace(teeth.cut.pinion[name], turned=0.0), teeth.pinion.member.tooth
    own, t = tooth.side(made.flank), np.linspace(0.0, 1.0, 7)
    ends, stations = tooth.sections(t).of(made.flank), tooth.stations(t)
    cut = ends.form_point_flank > own.form_point[0] + 1e-6
    assert cut[0]
    assert cut.sum() >= 3
    p, q, stations = ends.form_point_flank[cut], ends.form_point_fillet[cut], stations[cut]
    v_fillet, _ = along(own.fillet, q, stations, tooth.blank.axial)
    assert made.indexing is not None
    crown = made.hand * made.settings.ratio_of_roll * made.indexing.blade_groups / made.indexing.teeth
    roll = made.envelope(made.blade.tip).parameter(q, v_fillet) + crown * v_fillet
    per_height = np.sign(ends.tip[cut] - p) / (abs(made.blade.blade_radius) or 1.0)
    found = []
    for height in (STEP, 0.0, -STEP):
        u = p + height * per_height
        v, _ = along(own.flank, u, stations, tooth.blank.axial)
        jet = made.envelope(made.blade.flank).jet(u, v)
        found.append(least(made, (jet.r, jet.n), np.stack((v_fillet, q, np.zeros_like(q)), axis=-1), roll))
    above, at_end, below = found
    assert np.abs(at_end).max() < 1e-9
    assert (above > 1e-7).all()
    assert (below < -1e-7).all()
