"""The zone of contact of worm drives in line contact: against a worm that sweeps past points of the wheel, and the closed form."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.built import built
from oracles.worm_drives import BASE, drive

import gearmesh as gm
from gearmesh import GearPair
from gearmesh.answers.contact.rolling import rolling_contact
from gearmesh.contact.zone import contact_zone, limit_lines
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.systems.system import complete_design
from gearmesh.systems.worm_drive.build import worm_thread
from gearmesh.systems.worm_drive.contact.conjugate import ContactField
from gearmesh.systems.worm_drive.force_tables import thread_mesh

#: a worm too short on one side for the zone of its wheel, by an error of its place
SHORT = {"worm": {"length": 36.0}, "assembly": {"dz1": 4.0}}


def closed_form(gears: gm.Gears, fixed: Array) -> ContactField:
    """The contact in closed form on the rays of the worm's axis through points (K, 3) in contact, fixed frame."""
    mesh = thread_mesh(complete_design(gears.design).in_mm())
    asked = np.hypot(fixed[:, 0], fixed[:, 1])
    p = np.linspace(*(mesh.thread.at_radius(radius) for radius in (asked.min() - 0.1, asked.max() + 0.1)), 4001)
    start = mesh.thread.flank(mesh.side).jet(p, np.zeros_like(p)).r
    radius = np.hypot(start[:, 0], start[:, 1])
    order = np.argsort(radius)
    at = np.interp(asked, radius[order], p[order])
    return mesh.at(at, np.arctan2(fixed[:, 1], fixed[:, 0]))


def swept_gap(pair: GearPair, gears: gm.Gears, points: Array) -> Array:
    """Least distance (K,), mm along z, of the worm's flank, in 2000 positions of the mesh, from points (K, 3) of the wheel, wheel's
    frame: over those positions alone in which the point is between root and tip of the worm and between its ends."""
    design = complete_design(gears.design).in_mm()
    side = pair.flanks[0].sign
    thread = worm_thread(design, side)
    flank = thread.flank(side)
    root, tip = (pair.pinion.tooth.flank_grid(pair.flanks[0], [s], [0.5]).points[0, 0] for s in (0.0, 1.0))
    p = np.linspace(thread.at_radius(np.hypot(*root[:2])), thread.at_radius(np.hypot(*tip[:2])), 2001)
    r = flank.jet(p, np.zeros_like(p)).r
    radius, angle = np.hypot(r[:, 0], r[:, 1]), np.unwrap(np.arctan2(r[:, 1], r[:, 0]))
    screw, lead = thread.hand * thread.screw, thread.axial_pitch
    phi1 = np.linspace(-3.0, 3.0, 2000) * pair.pitch
    path = gears.contact(cycle=False).path
    shift = float((path.phi2 - pair.ratio * path.rotation)[path.touching][0])
    least = np.full(len(points), np.inf)
    for turn in phi1:
        fixed = pair.gear.mount.at(pair.ratio * turn + shift).point(points)
        own = pair.pinion.mount.at(turn).inverse.point(fixed)
        rho, theta = np.hypot(own[:, 0], own[:, 1]), np.arctan2(own[:, 1], own[:, 0])
        z = np.interp(rho, radius, r[:, 2]) + screw * (theta - np.interp(rho, radius, angle))
        # the nearest thread
        gap = (own[:, 2] - z + 0.5 * lead) % lead - 0.5 * lead
        here = (rho >= radius.min()) & (rho <= radius.max()) & (np.abs(own[:, 2]) <= 0.5 * design.worm.length)
        least = np.minimum(least, np.where(here, np.abs(gap), np.inf))
    return least


@pytest.mark.sweep
@pytest.mark.parametrize("keys", [{}, SHORT])
def test_zone_of_contact_is_where_a_sweeping_worm_touches_the_wheel(keys: dict[str, dict[str, float]]) -> None:
    """Points of the wheel deeper than 0.3 mm within the zone are touched, to what 2,000 positions leave; those 2 mm outside are
    not."""
    gears = built(
        {**{k: v for k, v in BASE.items() if k != "backlash"}, **{k: {**BASE.get(k, {}), **v} for k, v in keys.items()}}
    )
    pair = gears.pairs[0]
    zone = contact_zone(pair)
    assert zone is not None
    every = np.argwhere(np.abs(zone.depth) > 0.3)
    chosen = every[:: max(1, len(every) // 60)]
    depth = zone.depth[tuple(chosen.T)]
    gap = swept_gap(pair, gears, zone.points[tuple(chosen.T)])
    assert (depth > 0.3).sum() > 40
    assert gap[depth > 0.3].max() < 2e-3
    if keys:
        assert (depth < -2.0).sum() >= 3
        assert gap[depth < -2.0].min() > 5e-3


@pytest.mark.sweep
def test_share_of_the_zone() -> None:
    """Second order in the steps; a worm that is too short leaves as much of the wheel as it is too short, nothing more."""
    pair = drive("ZI").pairs[0]
    coarse, fine = contact_zone(pair), contact_zone(pair, (81, 161))
    assert coarse is not None
    assert fine is not None
    assert coarse.share == pytest.approx(fine.share, abs=3e-3)
    assert 0.96 < fine.share < 0.98
    short = contact_zone(drive("ZI", **SHORT).pairs[0])
    assert short is not None
    assert short.share < 0.93


@pytest.mark.parametrize("name", ["ZI", "ZK", "ZC"])
@pytest.mark.sweep_cases("ZC", "ZK")
def test_limit_lines_are_those_of_the_closed_form(name: str) -> None:
    """On the limiting line the contact does not move over the wheel, on the envelope it does not move over the worm."""
    gears = drive(name, wheel={"profile_shift": 0.5}) if name == "ZC" else drive(name)
    pair = gears.pairs[0]
    zone = contact_zone(pair)
    assert zone is not None
    lines = limit_lines(pair, zone)
    limits = lines["wheel"].fixed, lines["worm"].fixed
    for points, rate in zip(limits, ("over_wheel", "over_worm"), strict=True):
        known = points[np.isfinite(points[:, 0])]
        assert len(known) > 20
        at = closed_form(gears, known)
        assert np.abs(at.r - known).max() < 2e-4
        inside = closed_form(gears, zone.fixed[zone.depth > 0.0])
        assert np.abs(getattr(at, rate)).max() < 1e-3 * np.abs(getattr(inside, rate)).max()


@pytest.mark.sweep
def test_tooth_pairs_in_contact_over_a_pitch() -> None:
    """Those that roll, on average as many as the contact ratio says, least and most as reported."""
    gears = drive("ZI")
    contact = gears.contact()
    rolling = rolling_contact(gears.pairs[0], contact.path, (np.arange(40) + 0.37) / 40.0)
    count = rolling.engaged.sum(axis=1)
    assert [count.min(), count.max()] == contact.summary["pairs_in_contact"]
    assert count.mean() == pytest.approx(contact.summary["contact_ratio"], abs=1.0 / 40.0)
    assert contact.summary["contact_zone_share"] == pytest.approx(0.97, abs=0.005)
    # each with its line, but for the last, which may be as short as a point
    assert rolling.contacts.touching.all()
    assert sum(line is not None for line in rolling.contacts.lines) >= count.sum() - 1
