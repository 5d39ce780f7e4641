"""Sliding and rolling of flanks: closed forms of involute gears, and differences of the contact's own places for all others."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.loaded import loaded_contact
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.contact.sliding import path_motion
from gearmesh.errors import ArgumentError
from gearmesh.kernel.numeric.algebra import dot


def test_a_spur_pair_slides_and_rolls_as_its_line_of_action_says() -> None:
    """Sliding s (1 + N1/N2) at a distance s from the pitch point, rolling with the radii of curvature; Hertz's load per length."""
    speed, torque = 1500.0, 100.0
    contact = gm.build(gm.load(SAMPLES / "spur.toml")).contact(
        [-8.0, 0.5, 8.0], cycle=False, torque=torque, speed=speed
    )
    # 20 and 40 teeth of module 3, shifts that cancel: pitch radii 30 and 60, pressure angle 20 deg
    base, angle = 30.0 * np.cos(np.radians(20.0)), np.radians(20.0)
    for row, place in zip(contact.positions(), contact.path.point, strict=True):
        rho1 = np.sqrt(np.hypot(*place[:2]) ** 2 - base**2)
        s = rho1 - base * np.tan(angle)
        rho2 = 2.0 * base * np.tan(angle) - s
        motion = row.motion
        assert motion.sliding_across == pytest.approx(1.5 * s, rel=1e-9)
        assert motion.sliding == pytest.approx(1.5 * abs(s), rel=1e-9)
        assert [motion.rolling["pinion"], motion.rolling["gear"]] == pytest.approx([rho1, 0.5 * rho2], rel=1e-9)
        assert motion.entrainment == pytest.approx(0.5 * (rho1 + 0.5 * rho2), rel=1e-9)
        assert row.curvature.relative.k2 == pytest.approx(-(1.0 / rho1 + 1.0 / rho2), rel=1e-9)
        assert row.line_load == pytest.approx(1e3 * torque / base / 28.0, rel=1e-9)
        assert row.at_speed is not None
        assert row.at_speed.sliding == pytest.approx(1.5e-3 * abs(s) * speed * np.pi / 30.0, rel=1e-9)
        assert row.at_speed.pressure_velocity == pytest.approx(row.hertz.p0 * row.at_speed.sliding, rel=1e-12)


@pytest.mark.parametrize("sample", ["rack", "internal", "hypoid", "worm_drive_zk_oversize", "double_helical"])
@pytest.mark.sweep_cases("double_helical", "internal", "rack", "worm_drive_zk_oversize")
def test_surfaces_pass_through_the_contact_as_its_places_move(sample: str) -> None:
    """The path's points a little later less those a little earlier say how the contact moves; no curvature is asked for."""
    step, phi1 = 1e-3, np.array([-3.0, 2.0])
    contact = gm.build(gm.load(SAMPLES / f"{sample}.toml")).contact(
        np.concatenate((phi1 - step, phi1, phi1 + step)), cycle=False
    )
    pair, path, motion = contact.pair, contact.path, path_motion(contact.pair, contact.path)
    before, at, after = (slice(2 * k, 2 * k + 2) for k in range(3))
    turned = path.rotation[after] - path.rotation[before]
    moved = (path.point[after] - path.point[before]) / turned[:, None]
    ratio = (path.phi2[after] - path.phi2[before]) / turned
    velocities = pair.pinion.mount.velocity(path.point[at]), ratio[:, None] * pair.gear.mount.velocity(path.point[at])
    rolling = np.stack([dot(velocity - moved, motion.across[at]) for velocity in velocities], axis=-1)
    np.testing.assert_allclose(motion.rolling[at], rolling, rtol=1e-6)
    np.testing.assert_allclose(motion.ratio[at], ratio, rtol=1e-9)
    np.testing.assert_allclose(motion.sliding[at], velocities[0] - velocities[1], rtol=0, atol=1e-6)
    # flanks neither part nor overlap
    np.testing.assert_allclose(dot(motion.sliding, path.normal), 0.0, atol=1e-9 * motion.sliding_speed.max())


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("sample", "module", "teeth", "ratio", "helix"),
    [("spur", 3.0, 20, 0.5, 0.0), pytest.param("double_helical", 4.0, 23, 23 / 57, 28.0, marks=pytest.mark.sweep)],
)
def test_loaded_rows_carry_the_torque_and_slide_in_the_plane_of_action(
    sample: str, module: float, teeth: int, ratio: float, helix: float
) -> None:
    tribology = loaded_contact(sample, (200.0,), 2).tribology(1000.0)
    rows, beta = tribology.rows, np.radians(helix)
    angle = np.arctan(np.tan(np.radians(20.0)) / np.cos(beta))
    base = 0.5 * module * teeth / np.cos(beta) * np.cos(angle)
    lever = base * np.sqrt(1.0 - (np.sin(beta) * np.cos(np.radians(20.0))) ** 2)
    for phi1 in (0.0, 180.0 / teeth):
        at = [row for row in rows if row.phi1 == pytest.approx(phi1)]
        assert sum(row.line_load * row.length for row in at) * lever == pytest.approx(2e5, rel=2e-4)
    # away from tips, whose edges have neither curvature nor rolling velocity
    kept = [row for row in rows if np.isfinite(row.curvature)]
    kept_load, load = (sum(row.line_load * row.length for row in some) for some in (kept, rows))
    assert load > kept_load > 0.9 * load or sample == "spur"
    for row in kept[::9]:
        s = np.sqrt(np.hypot(*row.members["pinion"].point[:2]) ** 2 - base**2) - base * np.tan(angle)
        assert row.motion.sliding == pytest.approx((1.0 + ratio) * abs(s), rel=2e-4, abs=2e-3)
        assert row.at_speed is not None
        assert row.at_speed.pressure_velocity == pytest.approx(row.pressure * row.at_speed.sliding, rel=1e-12)
    assert tribology.totals[0].max_sliding == max(row.motion.sliding for row in rows)
    assert len(tribology.csv().splitlines()) == len(rows) + 1


def test_a_speed_that_is_not_above_0_is_refused() -> None:
    gears = gm.build(gm.load(SAMPLES / "spur.toml"))
    with pytest.raises(ArgumentError, match="speed = 0"):
        gears.contact([0.0], cycle=False, speed=0.0)
    with pytest.raises(ArgumentError, match="speed = -1"):
        loaded_contact("spur", (200.0,), 2).tribology(-1.0)
