"""Eccentric members: figures of a mesh cycle are those of members that stay displaced as at phi1 = 0, and no jump is invented."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import GearPair
from gearmesh.contact.engagement.engagement import whole_engagement
from gearmesh.contact.engagement.transmission_advance import TransmissionAdvance
from gearmesh.contact.flanks import solver_pair
from gearmesh.kernel.numeric.algebra import ARCSEC
from gearmesh.kinds import Mount

#: normal backlash, mm, and centre distance, mm, of the spur pair
PLAY, APART = 0.1, 60.0
#: base and tip radii, mm
BASE, TIP = np.array([20.0, 40.0]) * np.cos(np.radians(20.0)), np.array([22.0, 42.0])


def spur(**errors: float) -> gm.Gears:
    """20/40, m 2, without tip alteration; lengths in mm, phases in deg."""
    members = {name: {"teeth": teeth, "face_width": 20} for name, teeth in (("pinion", 20), ("gear", 40))}
    design = {"kind": "cylindrical", "module": 2, "backlash": PLAY, **members, "assembly": errors}
    return gm.build(gm.parse(design))


def moved_apart(mm: float) -> tuple[float, float]:
    """Contact ratio and normal backlash, mm, of the involutes at a centre distance so much larger, in closed form."""
    old, new = np.radians(20.0), np.arccos(BASE.sum() / (APART + mm))
    path = np.sqrt(TIP**2 - BASE**2).sum() - (APART + mm) * np.sin(new)
    opened = 2.0 * BASE.sum() * ((np.tan(new) - new) - (np.tan(old) - old))
    return path / (2.0 * np.pi * BASE[0] / 20.0), PLAY + opened


@pytest.mark.sweep_cases("farther", "both")
@pytest.mark.parametrize(
    ("errors", "nearer", "within"),
    [
        ({"pinion_eccentricity": 0.02}, 0.02, 1e-9),
        ({"pinion_eccentricity": 0.02, "pinion_phase": 180.0}, -0.02, 1e-9),
        # backlash turns the gear by some minutes of arc
        ({"pinion_eccentricity": 0.02, "gear_eccentricity": 0.03, "gear_phase": -4.5}, 0.05, 1e-7),
    ],
    ids=["nearer", "farther", "both"],
)
def test_displaced_involutes_have_no_jump_and_the_cycle_of_their_distance(
    errors: dict[str, float], nearer: float, within: float
) -> None:
    """At phi1 = 0 a space of the gear is towards the pinion, half a pitch, 4.5 deg, beside its own +x."""
    contact = spur(**errors).contact()
    summary = contact.summary
    assert not any("jumps" in line or "edge" in line for line in contact.warnings)
    assert contact.cycle is not None
    assert contact.cycle.breaks == ()
    assert summary["mesh_te_peak_to_peak_arcsec"] < 1e-6
    ratio, play = moved_apart(-nearer)
    assert summary["contact_ratio"] == pytest.approx(ratio, abs=within)
    assert summary["backlash_normal_min_mm"] == pytest.approx(play, abs=within)
    assert summary["backlash_normal_max_mm"] == pytest.approx(play, abs=within)
    # the path is that of the eccentric tooth pair itself, on the flanks alone
    assert set(contact.path.kind) == {"line"}
    assert summary["te_peak_to_peak_arcsec"] > 10.0


def next_teeth(pair: GearPair) -> GearPair:
    """The pair as its next teeth meet, counted as if they were the first: the eccentricities are turned instead."""

    def turned(mount: Mount, angle: float) -> Mount:
        x, y = mount.eccentricity
        c, s = np.cos(mount.sign * angle), np.sin(mount.sign * angle)
        return replace(mount, eccentricity=(float(c * x - s * y), float(s * x + c * y)))

    pinion, gear = pair.both
    return replace(
        pair,
        pinion=replace(pinion, mount=turned(pinion.mount, pair.pitch)),
        gear=replace(gear, mount=turned(gear.mount, pair.ratio * pair.pitch)),
    )


def test_neighbouring_eccentric_teeth_agree_where_they_change_over() -> None:
    """Both tooth pairs solved as they are: where the first ends, the second is neither ahead nor behind."""
    gears = spur(pinion_eccentricity=0.02, gear_eccentricity=0.03, gear_phase=70.0)
    pair = gears.pairs[0]
    ends = np.radians([9.0])
    advances = [
        TransmissionAdvance(whole_engagement(solver_pair(own), pair.pitch)).at(ends - k * pair.pitch)[0][0]
        for k, own in enumerate((pair, next_teeth(pair)))
    ]
    assert abs(advances[1] - advances[0]) < 1e-6 * ARCSEC


@cache
def bevel(eccentricity: float) -> gm.Contact:
    errors = [f"assembly.pinion_eccentricity={eccentricity}", "assembly.pinion_phase=0"]
    return gm.build(gm.load(SAMPLES / "spiral_bevel_basic.toml", errors)).contact()


@pytest.mark.sweep
def test_the_cycle_of_bevel_gears_is_that_of_a_small_displacement() -> None:
    """Figures of the mesh cycle change little: within one pitch an eccentric pinion acts like an assembly error of the same
    size. Over the whole path the transmission error more than doubles."""
    plain, eccentric = bevel(0.0), bevel(0.02)
    assert eccentric.summary["te_peak_to_peak_arcsec"] > 2.0 * plain.summary["te_peak_to_peak_arcsec"]
    assert eccentric.summary["te_breaks_phi1_deg"] == []
    for key, most in (("mesh_te_peak_to_peak_arcsec", 0.3), ("contact_ratio", 0.01), ("backlash_min_deg", 0.02)):
        assert eccentric.summary[key] == pytest.approx(plain.summary[key], abs=most)


@pytest.mark.sweep
def test_check_has_a_verdict_on_whole_turns() -> None:
    """Teeth that stand apart at phi1 = 0 and jam half a turn later; without eccentricity there is no such verdict."""
    verdicts = {}
    for size in (0.0, 0.2):
        gears = spur(pinion_eccentricity=size, pinion_phase=180.0)
        check = gears.check_solved({0: gears.contact(np.zeros(1))}, {})
        verdicts[size] = {verdict.what: verdict for verdict in check.verdicts}
    turns = "fit: least turns_backlash_deg"
    assert turns not in verdicts[0.0]
    assert verdicts[0.2]["fit: least backlash_normal_mm"].ok
    assert not verdicts[0.2][turns].ok
    _, play = moved_apart(-0.2)
    assert verdicts[0.2][turns].value == pytest.approx(np.degrees(play / BASE[1]), abs=1e-4)


@pytest.mark.sweep
def test_studies_report_the_same_cycle() -> None:
    gears = spur()
    study = gears.study({"assembly.pinion_eccentricity": [0.0, 0.02]}, record="cycle", workers=1)
    columns = {
        key: np.array(study.columns[key]) for key in ("mesh_te_peak_to_peak_arcsec", "te_breaks", "contact_ratio")
    }
    assert np.abs(columns["mesh_te_peak_to_peak_arcsec"]).max() < 1e-6
    assert columns["te_breaks"].tolist() == [0, 0]
    assert columns["contact_ratio"] == pytest.approx([moved_apart(0.0)[0], moved_apart(-0.02)[0]], abs=1e-9)
