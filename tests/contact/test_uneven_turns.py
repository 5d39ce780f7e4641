"""Pitch deviations with eccentricities over whole turns, against teeth that are turned until they touch."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import GearPair, Member
from gearmesh.contact.engagement.pitch_turns import whole_turns
from gearmesh.contact.engagement.turns import FullTurns
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.tca import contact_path
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import Side
from gearmesh.teeth.micro_geometry.index_angles import IndexAngles

SPUR = ("pinion.teeth=16", "gear.teeth=32", "assembly.center_distance=72", "backlash=0.1")


def uneven_pair(*keys: str) -> GearPair:
    """A spur pair whose flanks are up to 2 um (at the pitch circle) off their places at random, both sides apart."""
    pair, random = pair_of(gm.load(SAMPLES / "spur.toml", [*SPUR, *keys])), np.random.default_rng(3)
    members = [
        replace(
            member,
            index=IndexAngles.of_sides(
                {side: 2e-3 / radius * random.uniform(-1.0, 1.0, member.tooth.teeth) for side in Side}
            ),
        )
        for member, radius in zip(pair.both, (24.0, 48.0), strict=True)
    ]
    return replace(pair, pinion=members[0], gear=members[1])


def flank_line(member: Member, side: Side) -> tuple[Array, Array]:
    """Radii (K,) from form point to tip and angles (K,), rad, of the flanks of tooth 0, transverse section, own frame."""
    x, y, _ = member.tooth.flank_grid(side, np.linspace(0.0, 1.0, 400), [0.5]).points.reshape(-1, 3).T
    order = np.argsort(np.hypot(x, y))
    return np.hypot(x, y)[order], np.arctan2(y, x)[order]


def teeth_turned_until_they_touch(pair: GearPair, side: Side, phi1: float, near: float) -> float:
    """The rotation phi2 nearest to `near` at which a flank of the gear passes through a point of the pinion's flanks, the first
    to be passed as the gear turns back from where the pinion has pushed it (driving flanks), or ahead (coast flanks).

    Points of the pinion are on circles about the gear's centre, its tips on flanks of the pinion included.
    """
    first, second = pair.mounts
    (r1, a1), (r2, a2) = (flank_line(member, side) for member in pair.both)
    ahead = pair.drive if side is pair.flanks[0] else -pair.drive
    pitch = pair.gear.tooth.pitch_angle
    turned = first.sign * (phi1 - first.zero)
    centre, phi2 = complex(*first.eccentricity) * np.exp(1j * turned), near
    # the place of the gear's teeth depends on its rotation
    for _ in range(4):
        apart = complex(*second.origin[:2]) + complex(*second.eccentricity) * np.exp(
            1j * second.sign * (phi2 - second.zero)
        )
        found = []
        for number, own in enumerate(pair.pinion.index.of(side, pair.pinion.tooth.teeth)):
            angle = turned + number * pair.pinion.tooth.pitch_angle + own
            if math.cos(angle) < math.cos(2.6 * pair.pinion.tooth.pitch_angle):
                continue
            at = centre + r1 * np.exp(1j * (a1 + angle)) - apart
            radius = np.abs(at)
            crossed = np.flatnonzero((radius[:-1] - r2[-1]) * (radius[1:] - r2[-1]) < 0.0)
            share = (r2[-1] - radius[crossed]) / (radius[crossed + 1] - radius[crossed])
            tips = at[crossed] + share * (at[crossed + 1] - at[crossed])
            points = np.concatenate((at[(radius >= r2[0]) & (radius <= r2[-1])], tips))
            found.append(np.angle(points) - np.interp(np.abs(points), r2, a2))
        places = np.arange(pair.gear.tooth.teeth) * pitch + pair.gear.index.of(side, pair.gear.tooth.teeth)
        rotation = second.zero + second.sign * (np.concatenate(found)[:, None] - places).ravel()
        away = (rotation - near + math.pi) % (2.0 * math.pi) - math.pi
        close = away[np.abs(away) < 0.3 * pitch]
        phi2 = near + ahead * float((ahead * close).max())
    return phi2


def touched(pair: GearPair, turns: FullTurns, positions: Array) -> tuple[Array, Array]:
    """Transmission error less a constant and backlash (P,), rad, of `positions` (P,) of the turns, by turning teeth."""
    driving, coast = pair.flanks[0], next(side for side in Side if side is not pair.flanks[0])
    concentric = solver_pair(
        replace(
            pair,
            **{k: replace(m, mount=m.mount.concentric) for k, m in zip(("pinion", "gear"), pair.both, strict=True)},
        )
    )
    start = float(contact_path(concentric, np.zeros(1)).phi2[0])
    te, play = np.empty(len(positions)), np.empty(len(positions))
    for k, phi1 in enumerate(turns.phi1[positions]):
        even = start + pair.ratio * float(phi1)
        pushed = teeth_turned_until_they_touch(pair, driving, float(phi1), even)
        back = teeth_turned_until_they_touch(pair, coast, float(phi1), pushed)
        te[k], play[k] = pushed - even, pair.drive * (back - pushed)
    return te, play


@pytest.mark.parametrize(
    "keys",
    [
        pytest.param((), id="pitch deviations"),
        pytest.param(("assembly.pinion_eccentricity=0.03", "assembly.pinion_phase=50"), id="eccentric pinion"),
        pytest.param(("assembly.gear_eccentricity=0.03", "assembly.gear_phase=130"), id="eccentric gear"),
    ],
)
@pytest.mark.sweep_cases("eccentric gear", "eccentric pinion")
def test_uneven_teeth_touch_where_turned_teeth_do(keys: tuple[str, ...]) -> None:
    """Flanks of 400 points miss by 0.3 urad; a coast flank of the wrong tooth of the gear misses by up to 60."""
    pair = uneven_pair(*keys)
    turns = whole_turns(pair)
    positions = np.arange(0, turns.phi1.size, 13)
    te, play = touched(pair, turns, positions)
    assert turns.pitches == 32
    assert np.ptp(turns.te[positions]) > 1e-4
    assert np.ptp(turns.te[positions] - te) < 1e-6
    assert turns.backlash[positions] == pytest.approx(play, abs=1e-6)
