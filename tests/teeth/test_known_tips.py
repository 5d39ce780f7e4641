"""Tips of teeth from the stations at which the tooth was proved: against teeth that were never proved."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.kinds import Side
from gearmesh.systems import system as systems

#: stations that no proof has
OTHER_STATIONS = np.linspace(0.01, 0.99, 17)


@pytest.mark.sweep_cases("worm_drive", "hypoid_high_ratio", "internal", "novikov")
@pytest.mark.parametrize(
    "name", ["helical", "spiral_bevel_basic", "face_gear", "worm_drive", "hypoid_high_ratio", "internal", "novikov"]
)
def test_proved_teeth_have_the_tips_of_others(name: str) -> None:
    teeth = [member.tooth for member in systems.build(gm.load(SAMPLES / f"{name}.toml")).members.values()]
    known = [tooth for tooth in teeth if tooth._known_tips]
    assert known
    for proved in known:
        fresh = replace(proved)
        assert not fresh._known_tips
        assert proved.height == pytest.approx(fresh.height, rel=1e-13)
        for which in Side:
            (p, jet), (own, own_jet) = (tooth._tip_of(which, OTHER_STATIONS) for tooth in (proved, fresh))
            np.testing.assert_allclose(p, own, rtol=0.0, atol=1e-11)
            np.testing.assert_allclose(jet.r, own_jet.r, rtol=0.0, atol=1e-10)
            middle, own_middle = (tooth._tip_in_middle(which)[1].r for tooth in (proved, fresh))
            np.testing.assert_allclose(middle, own_middle, rtol=0.0, atol=1e-10)
