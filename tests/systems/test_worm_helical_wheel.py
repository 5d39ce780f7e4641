"""Worm drives whose wheel is a helical gear: the crossed helical gears of kind beveloid, uniform under any error."""

from __future__ import annotations

import math

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import load, parse
from gearmesh.contact.flanks import analyse

SAMPLE = SAMPLES / "worm_drive.toml"
HELICAL = ["wheel.form=helical", "wheel.face_width=30"]


def test_is_the_crossed_helical_pair_of_the_same_rack() -> None:
    """A worm of z1 threads is a helical gear of z1 teeth, its helix angle 90 deg - gamma; there the tooth stands on x at phi1 = 0,
    here the flank, a quarter of the pitch of two threads away."""
    lead = math.atan(2 * 5 / 60)
    member = {"addendum": 1 / math.cos(lead), "dedendum": 1.2 / math.cos(lead), "tool_tip_radius": 0.05}
    crossed = {
        "kind": "beveloid",
        "module": 5 * math.cos(lead),
        "pinion": {"teeth": 2, "helix_angle": 90 - math.degrees(lead), "face_width": 80, **member},
        "gear": {"teeth": 38, "helix_angle": math.degrees(lead), "face_width": 30, **member},
    }
    phi1 = np.radians([-60.0, -20.0, 0.0, 30.0, 80.0])
    one = analyse(pair_of(load(str(SAMPLE), HELICAL)), phi1)
    other = analyse(pair_of(parse(crossed)), phi1 - math.pi / 4)
    for name in ("point", "semi_major", "semi_minor"):
        np.testing.assert_allclose(getattr(one, name), getattr(other, name), rtol=0, atol=1e-9)


@pytest.mark.parametrize(
    "keys",
    [
        ("worm.right_hand=false", "shaft_angle=80", "assembly.dz2=1"),
        ("contact.flank=left", "shaft_angle=97", "center_distance=127", "assembly.da=0.2", "assembly.d_sigma=0.3"),
    ],
)
@pytest.mark.sweep_cases("keys0")
def test_runs_uniformly_under_any_error(keys: tuple[str, ...]) -> None:
    summary = gm.build(gm.load(str(SAMPLE), [*HELICAL, *keys, "contact.phi1.count=5"])).contact().summary
    assert summary["mesh_te_peak_to_peak_arcsec"] < 1e-9 * math.degrees(3600)
    assert summary["contact_ratio"] > 1.5


@pytest.mark.parametrize(
    ("key", "named"),
    [
        ("wheel.tip_form=throated", "wheel.tip_form"),
        ("hob.threads=3", "hob.threads"),
        ("worm.form=ZA", "wheel.form"),
        ("worm.dual_lead=0.01", "worm.dual_lead"),
        ("hob.tip_radius=1", "hob.tip_radius"),
    ],
)
@pytest.mark.sweep_cases("hob.tip_radius=1-hob.tip_radius")
def test_what_a_helical_wheel_does_not_have_is_refused(key: str, named: str) -> None:
    with pytest.raises(gm.DesignError) as refusal:
        gm.build(gm.load(str(SAMPLE), [*HELICAL, key]))
    assert refusal.value.key == named
