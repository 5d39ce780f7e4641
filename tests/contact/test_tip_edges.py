"""Chamfers and roundings of tips touch the mating teeth: against a closed form, and against the roll test of whole teeth."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from oracles.built import pair_of
from scipy.optimize import brentq

from gearmesh import GearPair, parse
from gearmesh.check.members import roll_teeth
from gearmesh.contact.flanks import separation_curvatures, solver_pair
from gearmesh.contact.tca import contact_path
from gearmesh.kernel.numeric.algebra import ARCSEC

#: keys of cylindrical pairs, and rotations (deg) at which a chamfer or a rounding touches
TIP_CONTACTS = {
    "rounding on an edge": (
        {"pinion": {"teeth": 20, "tip_rounding": 0.4}, "gear": {"teeth": 31}, "assembly": {"gamma_v": 0.05}},
        [7.9, 9.6],
    ),
    "ring": (
        {
            "pinion": {"teeth": 19, "tip_rounding": 0.5},
            "gear": {"teeth": -60, "tip_rounding": 0.4},
            "assembly": {"gamma_v": 0.05},
        },
        [7.8, 9.6],
    ),
    "rounding along a line": (
        {
            "pinion": {"teeth": 24, "tip_chamfer": 0.6},
            "gear": {"teeth": 31, "tip_rounding": 0.45},
            "assembly": {"center_distance": 54.6},
        },
        [-16.265, -14.294, 7.39],
    ),
}


def pair(**keys: Any) -> GearPair:
    """Cylindrical pair of module 2 and face widths of 12 and 10 mm, where the keys do not say otherwise."""
    tables = {"pinion": {"face_width": 12.0} | keys.pop("pinion"), "gear": {"face_width": 10.0} | keys.pop("gear")}
    return pair_of(parse({"kind": "cylindrical", "module": 2.0} | tables | keys))


def test_a_rounding_touches_an_edge_where_its_circle_does() -> None:
    """In a section a rounding is a circle that touches tip circle and involute: its centre lies on a parallel involute."""
    module, rounding, phi1 = 94.3, 10.2, np.radians(-27.2189)
    gears = pair(
        module=module,
        helix_angle=8.02,
        profile="D",
        pinion={"teeth": 6, "face_width": 84.62, "tip_rounding": rounding},
        gear={"teeth": -61, "face_width": 54.88},
        assembly={"gamma_v": 0.0404},
        contact={"flank": "left"},
    )
    path = contact_path(solver_pair(gears), np.array([phi1]))
    assert path.edge.tolist() == ["pinion_tip+gear_toe"]
    assert [region.tolist() for region in path.regions] == [["tip_edge"], ["flank"]]

    helix = math.radians(8.02)
    radius = 0.5 * 6 * module / math.cos(helix)
    pressure = math.atan(math.tan(math.radians(20.0)) / math.cos(helix))
    base, centre = radius * math.cos(pressure), radius + module - rounding
    involute = math.tan(pressure) - pressure - (math.tan(angle := math.acos(base / centre)) - angle)
    middle = 0.25 * math.pi * module / math.cos(helix) / radius + involute - rounding / base
    turn = math.tan(helix) / radius
    # the end of the gear's flank that the rounding touches
    edge = gears.gear.tooth.flank_grid(gears.flanks[1], np.linspace(0.0, 1.0, 2001), [1.0]).points[:, 0]
    to_pinion = gears.pinion.mount.at(phi1).inverse

    def gap(phi2: float) -> float:
        """Distance of the edge from the circle in its section."""
        r = to_pinion.point(gears.gear.mount.at(phi2).point(edge))
        w = (r[:, 0] + 1j * r[:, 1]) * np.exp(-1j * (middle + turn * r[:, 2]))
        return float((np.abs(w - centre) - rounding)[np.abs(w) > centre].min())

    contact = brentq(gap, path.phi2[0] - 1e-5, path.phi2[0] + 1e-5, xtol=1e-13)
    assert abs(contact - path.phi2[0]) < 1e-3 * ARCSEC


@pytest.mark.sweep
@pytest.mark.sweep_cases("rounding along a line", "rounding on an edge")
@pytest.mark.parametrize("case", TIP_CONTACTS)
def test_chamfers_and_roundings_touch_where_whole_teeth_roll(case: str) -> None:
    keys, phi1 = TIP_CONTACTS[case]
    gears = pair(**keys)
    path = contact_path(solver_pair(gears), np.radians(phi1))
    assert (path.kind == "edge").all()
    assert any("tip_edge" in region for region in path.regions)
    for touch, phi2 in zip(roll_teeth(gears, path.rotation, guess_phi2=path.phi2), path.phi2, strict=True):
        assert touch is not None
        assert abs(touch.phi2 - phi2) < 2e-3 * ARCSEC
    # curvatures are those of the surfaces that touch
    assert np.isfinite(separation_curvatures(gears, path)).all()
