"""Rotations of the members of a gear set together, and gaps of flanks on the way."""

from __future__ import annotations

import math

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.contact.engagement.ease_off import gaps_at
from gearmesh.contact.engagement.pitch_turns import whole_turns
from gearmesh.contact.engagement.train_turns import leading_turns, train_turns
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.hertz import Material
from gearmesh.fe.placing import place
from gearmesh.view.on_tooth import union_level
from gearmesh.view.scene import contact_on

#: pitch deviations of both members, um: the pair of teeth next to the pitch point leads at few positions
UNEVEN = [
    f"measured.{name}_pitch_{side}_um=[{','.join(f'{15 * math.sin(k * k + k + first):.2f}' for k in range(teeth))}]"
    for name, side, teeth, first in (("pinion", "right", 20, 0), ("gear", "right", 40, 1))
]


@pytest.mark.sweep
def test_trains_turn_together_whichever_pair_is_known() -> None:
    """From the sun, from a planet and the ring, all meshes of a set close, the last one of a loop too."""
    gears = gm.build(gm.load(SAMPLES / "planetary.toml"))
    # the last one, too, of whose neighbours the first is not the first mesh of the set
    for number in (*gears.train.different, len(gears.pairs) - 1):
        pair = gears.train.pairs[number]
        path = gears.contact(np.array([-3.0, 1.0]), cycle=False, pair=number).path
        turns = train_turns(gears.train, pair, path.rotation, path.phi2)
        assert set(turns) == set(gears.members)
        for each in gears.pairs:
            driven = leading_turns(each, turns[each.pinion.name])[1]
            pitches = (turns[each.gear.name] - driven) / each.gear.tooth.pitch_angle
            assert np.abs(pitches - np.round(pitches)).max() < 1e-7, each.name
        # at their ratios members turn as in the middle, and elsewhere within the transmission errors
        plain = train_turns(gears.train, pair, path.rotation, path.phi2, nominal=True)
        for name, turn in turns.items():
            assert plain[name][1] == pytest.approx(turn[1], abs=1e-9)
            assert plain[name] == pytest.approx(turn, abs=1e-4)


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("sample", "overrides"),
    [
        ("spur", ["assembly.gear_eccentricity=0.02"]),
        ("spur", ["assembly.pinion_eccentricity=0.02", "assembly.pinion_phase=50", "gear.teeth=40"]),
        ("cycloidal", ["modification.equidistant=0.03", "assembly.dx=0.01"]),
        ("spline", ["assembly.dx=0.004", "assembly.gamma_h=0"]),
        ("spur", UNEVEN),
        ("spur", [*UNEVEN, "assembly.gear_eccentricity=0.02", "assembly.gear_phase=50"]),
    ],
)
def test_members_stand_where_whole_turns_say(sample: str, overrides: list[str]) -> None:
    """Gears stood 1.8 um apart, or cut into each other by 6 um: other tooth pairs lead, and eccentricity turns with the teeth.

    Reference: the error over whole turns, which follows every tooth pair in another way.
    """
    pair = gm.build(gm.load(SAMPLES / f"{sample}.toml", overrides)).pairs[0]
    turns = whole_turns(pair)
    some = np.unique(np.linspace(0, len(turns.phi1) - 1, 9).astype(int))
    rotation, phi2 = leading_turns(pair, turns.phi1[some])
    assert np.abs(rotation - turns.phi1[some]).max() < 1e-12
    te = phi2 - pair.ratio * rotation
    assert te - te[0] == pytest.approx(turns.te[some], abs=1e-9)
    assert np.ptp(turns.te[some]) > 1e-8


def test_finite_elements_of_a_spline_stand_on_the_pair_that_leads() -> None:
    """Of 21 pairs the 5 next to the position were looked at: the model's teeth were 3.6 um inside each other."""
    gears = gm.build(gm.load(SAMPLES / "spline.toml", ["assembly.dx=0.004", "assembly.gamma_h=0"]))
    steel = Material(206000.0, 0.3)
    rotation, phi2 = place(gears.pairs[0], 0.0, 1e5, (steel, steel)).turns
    assert phi2 == pytest.approx(leading_turns(gears.pairs[0], np.array([rotation]))[1][0], abs=1e-10)


def test_finite_elements_of_eccentric_members_stand_where_solids_do() -> None:
    """Teeth were those of another rotation, 12 um nearer, or were said not to touch at all.

    Reference: distances of the axes of the teeth in closed form, and the error over whole turns.
    """
    pair = gm.build(gm.load(SAMPLES / "spur.toml", ["assembly.pinion_eccentricity=0.05", "gear.teeth=40"])).pairs[0]
    turns, steel = whole_turns(pair), Material(206000.0, 0.3)
    at_0 = leading_turns(pair, np.zeros(1))[1][0]
    for k in (27, 87, 149):
        phi1 = float(turns.phi1[k])
        at = place(pair, phi1, 1e5, (steel, steel))
        first, second = (member.mount.at(turn) for member, turn in zip(at.pair.both, at.turns, strict=True))
        apart = math.hypot(90.0 - 0.05 * math.cos(phi1), 0.05 * math.sin(phi1))
        assert np.linalg.norm((first.translation - second.translation)[:2]) == pytest.approx(apart, abs=1e-9)
        # turned by whole pitches, so that the teeth that lead are on x
        error = at.turns[1] - at_0 - pair.ratio * at.turns[0]
        assert abs(at.turns[0]) < 1.5 * pair.pitch
        assert error == pytest.approx(turns.te[k], abs=1e-9)


def test_gaps_grow_as_the_ellipse_of_contact_says() -> None:
    """The field of advances against curvatures: inside the ellipse the gap is the compound's thickness times the level squared."""
    gears = gm.build(gm.load(SAMPLES / "beveloid_crossed.toml"))
    pair = gears.pairs[0]
    path = gears.contact(np.zeros(1), cycle=False).path
    lines = np.linspace(0.02, 0.98, 97)
    grid = pair.pinion.tooth.flank_grid(pair.flanks[0], lines, lines)
    gap = gaps_at(solver_pair(pair), path.rotation, path.phi2, grid.parameters)[0] / pair.delta
    level = union_level(contact_on(0, path, pair.mounts), grid.points)
    inside = level < 1.0
    assert inside.sum() > 50
    assert np.abs(gap - level**2)[inside].max() < 0.05
    assert np.nanmin(gap[level > 1.2]) > 1.2
