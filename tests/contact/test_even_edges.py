"""Contact all along an edge of spur gears: its place is no matter of rounding."""

from __future__ import annotations

import numpy as np
import pytest

import gearmesh as gm

SIZES = {"pinion": {"teeth": 7, "face_width": 22}, "gear": {"teeth": 9, "face_width": 20}}


@pytest.mark.sweep
@pytest.mark.parametrize(("shift", "middle"), [(0.0, 0.0), (3.0, 2.0)])
def test_contact_along_a_whole_edge_is_reported_at_mid_common_face(shift: float, middle: float) -> None:
    """Undercut ridges and tips of parallel axes touch over the whole face that both have: -11 .. 11 and -10 .. 10 mm, shifted."""
    gears = gm.build(gm.parse({"kind": "cylindrical", "module": 2, **SIZES, "assembly": {"dz": shift}}))
    positions = [position for position in gears.contact(cycle=False).positions() if position.edge]
    assert {position.edge for position in positions} == {"pinion_joint", "gear_joint", "pinion_tip"}
    np.testing.assert_allclose([position.point[2] for position in positions], middle, rtol=0, atol=1e-9)


def test_an_edge_of_which_one_end_leads_touches_there() -> None:
    gears = gm.build(gm.parse({"kind": "cylindrical", "module": 2, **SIZES, "assembly": {"gamma_v": 0.001}}))
    positions = gears.contact(cycle=False).positions()
    assert {float(np.sign(position.point[2])) for position in positions} in ({-1.0}, {1.0})
    assert all(position.edge and "gear_" in position.edge for position in positions)
