"""Speeds, phases and pairs of teeth in contact of planetary sets: by rolling, and counted on the exact contact of every planet."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from oracles.examples import some

import gearmesh as gm
from gearmesh.systems.cylindrical.planetary import motion

SETS: dict[str, dict[str, Any]] = {
    "in_phase": {"teeth": (18, 27, 72), "backlash": 0.06},
    "uneven": {"teeth": (19, 26, 71), "backlash": 0.05, "assembly": {"planet_angles": "0 116 240"}},
    "uneven_left": {
        "teeth": (19, 26, 71),
        "helix_angle": 8,
        "contact": {"flank": "left"},
        "assembly": {"planet_angles": "0 116 240"},
    },
    "helical": {"teeth": (20, 31, 82), "helix_angle": 20, "backlash": 0.08, "ring": {"face_width": 9}},
    "shifted": {"teeth": (18, 26, 72), "assembly": {"center_distance": 45.2}, "backlash": 0.05},
}


def gears_of(name: str) -> gm.Gears:
    keys = {"kind": "planetary", "module": 2, **SETS[name]}
    for member, teeth in zip(("sun", "planet", "ring"), keys.pop("teeth"), strict=True):
        keys[member] = {"teeth": teeth, "face_width": 12, **keys.get(member, {})}
    return gm.build(gm.parse(keys))


def rows(gears: gm.Gears, title: str) -> dict[str, Any]:
    """Symbol -> values of a table of the sheet."""
    return {symbol: values[1:] for symbol, values in gears.sheet().plain_tables[title].items()}


@pytest.mark.parametrize("fixed", ["ring", "carrier", "sun"])
def test_speeds_roll_without_slip(fixed: str) -> None:
    """Pitch circles that roll on each other have one velocity where they touch, whichever member stands still."""
    sun, planet, ring = 18, 27, 72
    turns = motion.speeds(sun, planet, ring, fixed)
    radius = np.array([sun, sun + 2.0 * planet]) / 2.0
    middle = turns.carrier * (sun + planet) / 2.0
    assert middle - turns.planet * planet / 2.0 == pytest.approx(turns.sun * radius[0], abs=1e-12)
    assert middle + turns.planet * planet / 2.0 == pytest.approx(turns.ring * radius[1], abs=1e-12)
    assert getattr(turns, fixed) == 0.0
    assert getattr(turns, motion.DRIVING_MEMBER[fixed]) == 1.0
    # the textbook's ratios of this set: 5, -4, 1.25
    driven = getattr(turns, motion.DRIVEN_MEMBER[fixed])
    assert 1.0 / driven == pytest.approx({"ring": 5.0, "carrier": -4.0, "sun": 1.25}[fixed], abs=1e-12)
    assert motion.ratio(sun, ring, fixed) == pytest.approx(1.0 / driven, abs=1e-12)


@pytest.mark.sweep
@pytest.mark.parametrize("name", some(SETS, 2))
def test_phases_and_counts_are_those_of_the_exact_contact(name: str) -> None:
    """Beginnings and ends of contact of a tooth pair of every planet by the solver, in pitches of the sun."""
    gears = gears_of(name)
    count = len(gears.pairs) // 2
    spans = np.empty((2, count, 2))
    for k in range(count):
        inner, outer = gears.contact([0.0], pair=k), gears.contact([0.0], pair=count + k)
        spans[0, k] = np.radians(inner.summary["engagement_phi1_deg"]) / inner.pair.pitch
        # the ring's mesh counts by the planet, which stands at phi2 of the sun's mesh
        ends = np.radians(outer.summary["engagement_phi1_deg"]) - inner.path.phi2[0]
        spans[1, k] = ends / outer.pair.pitch
    # the sun drives with left flanks when it turns counterclockwise, against phi1
    spans = np.sort(gears.pairs[0].drive * spans, axis=-1)
    ahead = (spans[0, 0, 0] - spans[..., 0]) % 1.0
    planets, whole = rows(gears, "Planets"), rows(gears, "Set")
    for found, symbol in zip(ahead, ("phi_s", "phi_r"), strict=True):
        apart = np.array(planets[symbol]) - found
        # the solver ends a line of contact in a corner of the flank within 2.3e-7 pitches (1.4 nm)
        np.testing.assert_allclose(apart - np.round(apart), 0.0, atol=5e-7)
    assert whole["eps_s_sum"][0] == pytest.approx(np.ptp(spans[0], axis=-1).sum(), abs=2e-6)
    assert whole["eps_r_sum"][0] == pytest.approx(np.ptp(spans[1], axis=-1).sum(), abs=2e-6)
    # places of which none is where a contact begins or ends
    at = np.linspace(0.0, 1.0, 9973, endpoint=False)[:, None, None] + np.sqrt(2.0) / 1e5
    counts = (np.floor(at - spans[..., 0]) - np.ceil(at - spans[..., 1]) + 1.0).sum(axis=-1)
    for symbol, each in (("n_s", counts[:, 0]), ("n_r", counts[:, 1]), ("n", counts.sum(axis=-1))):
        assert (whole[f"{symbol}_min"][0], whole[f"{symbol}_max"][0]) == (each.min(), each.max()), symbol


@pytest.mark.sweep
def test_clearance_of_neighbours_is_what_the_refusal_counts() -> None:
    """Planets nearer to each other than by their clearance, as an angle, are refused; further off they are not."""
    gears = gears_of("uneven")
    distance = 45.0
    apart = rows(gears, "Planets")["c_p"]
    assert apart[0] == pytest.approx(2 * distance * np.sin(np.radians(58.0)) - 2.0 * (26.0 + 2.0), abs=1e-9)
    assert apart[2] == pytest.approx(2 * distance * np.sin(np.radians(60.0)) - 2.0 * (26.0 + 2.0), abs=1e-9)
    assert rows(gears, "Set")["c_p"][0] == min(apart)
    assert rows(gears, "Set")["tau_a"][0] == pytest.approx(4.0)
