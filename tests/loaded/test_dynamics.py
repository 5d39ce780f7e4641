"""Tables for rotor dynamics: a simulation of two masses with them, mesh phases by the places where flanks do not slide."""

from __future__ import annotations

import json

import numpy as np
import pytest
from numpy.typing import NDArray
from oracles.loaded import loaded_contact
from oracles.places import SAMPLES
from scipy.integrate import solve_ivp

import gearmesh as gm
from gearmesh import Dynamics
from gearmesh.answers.load.dynamics import mesh_phases, whole_pitches
from gearmesh.contact.pitch_point import pitch_point_phi1
from gearmesh.errors import ArgumentError

TORQUES = 150.0, 153.0


def tables() -> Dynamics:
    """Tables of the spur pair at 8 positions under two torques."""
    loaded = loaded_contact("spur", TORQUES, 8)
    return Dynamics(loaded.design, gm.build(loaded.design).train, {0: loaded}, ())


@pytest.mark.sweep
def test_two_masses_with_these_tables_follow_the_static_transmission_error() -> None:
    """Slow rotation: inertia does not count, so that the masses must be where the torque and the stiffness put them."""
    document = json.loads(tables().json())
    (mesh,), rows = document["meshes"], [row for row in document["grid"] if row["torque_nm"] == TORQUES[0]]
    pitch, l1, l2 = np.radians(mesh["pitch_deg"]), 1e-3 * mesh["lever_mm"], 1e-3 * mesh["gear_lever_mm"]
    assert [l1, l2] == pytest.approx([0.03 * np.cos(np.radians(20.0)), 0.06 * np.cos(np.radians(20.0))], rel=1e-4)

    def curve(*keys: str) -> NDArray[np.float64]:
        """A column of the grid over one pitch, its first value again at the end."""
        values = [row[keys[0]] if len(keys) == 1 else row[keys[0]][keys[1]] for row in rows]
        return np.array([*values, values[0]])

    phi = np.append(np.radians([row["phi1_deg"] for row in rows]), pitch)
    k, x0, static = (
        curve("mesh_stiffness", "secant_n_per_m"),
        1e-6 * curve("unloaded_line_te_um"),
        1e-6 * curve("line_te_um"),
    )
    torque, speed, natural = TORQUES[0], 0.2, 2000.0
    mass = k.mean() / natural**2
    # 2 m l^2 on either side: m along the line of action
    inertia1, inertia2, damping = 2.0 * mass * l1**2, 2.0 * mass * l2**2, 0.6 * mass * natural

    def motion(_: float, state: NDArray[np.float64]) -> list[float]:
        phi1, phi2, omega1, omega2 = state
        at = phi1 % pitch
        # compliance is linear between positions, as the errors are
        force = (l1 * phi1 - l2 * phi2 - np.interp(at, phi, x0)) / np.interp(at, phi, 1.0 / k)
        force += damping * (l1 * omega1 - l2 * omega2)
        return [omega1, omega2, (torque - l1 * force) / inertia1, (l2 * force - torque * l2 / l1) / inertia2]

    times = np.linspace(0.1, 1.1, 40) * pitch / speed
    start = [0.0, -static[0] / l2, speed, speed * l1 / l2]
    run = solve_ivp(motion, (0.0, times[-1]), start, t_eval=times, method="LSODA", rtol=1e-8, atol=1e-12)
    found = l1 * run.y[0] - l2 * run.y[1]
    np.testing.assert_allclose(found, np.interp(run.y[0] % pitch, phi, static), rtol=3e-3)
    assert np.ptp(found) > 0.2 * found.max()


@pytest.mark.sweep
def test_tangent_stiffness_is_the_change_of_force_over_the_change_of_error() -> None:
    answer = tables()
    rows, lever = answer.grid, 1e-3 * answer.meshes[0].lever
    for low, high in zip(rows[:8], rows[8:], strict=True):
        change = (TORQUES[1] - TORQUES[0]) / lever / (1e-6 * (high.line_te - low.line_te))
        assert low.mesh_stiffness.tangent_line == pytest.approx(change, rel=0.02)
        assert low.mesh_stiffness.tangent == pytest.approx(low.mesh_stiffness.tangent_line * lever**2, rel=1e-12)
        assert low.tooth_stiffness is not None
        assert low.tooth_stiffness.secant_line > low.mesh_stiffness.secant_line
    # the sum of all harmonics is the curve
    te = answer.meshes[0].harmonics[0].te
    assert te.phases_pitch_point is not None
    turns = [2.0 * np.pi * row.phase_pitch_point for row in rows[:8]]  # type: ignore[operator]
    order = np.arange(1, len(te.amplitudes) + 1)
    waves = [te.mean + te.amplitudes @ np.cos(order * turn + np.radians(te.phases_pitch_point)) for turn in turns]
    rest = np.array([row.line_te for row in rows[:8]]) - waves
    # 8 positions have 3 harmonics and the alternating rest
    np.testing.assert_allclose(rest, rest[0] * (-1.0) ** np.arange(8), atol=1e-9)


@pytest.mark.parametrize(
    ("planets", "angles"), [pytest.param(3, "0, 120, 240", marks=pytest.mark.sweep), (4, "0, 88, 180, 268")]
)
def test_phases_of_a_planetary_set_are_at_pitch_points(planets: int, angles: str) -> None:
    """Sliding of spur flanks is linear in the rotation: two contacts of every mesh say where it is 0, turned by real planets."""
    keys = [f"planets={planets}", f'assembly.planet_angles="{angles}"', "sun.teeth=18"]
    gears = gm.build(gm.load(SAMPLES / "planetary.toml", keys))
    at, planet = np.array([-2.0, 1.0]), {}
    found = []
    for k, pair in enumerate(gears.pairs):
        contact = gears.contact(at, pair=k, cycle=False)
        sliding = [row.motion.sliding_across for row in contact.positions()]
        still = np.radians(at[0] - sliding[0] * np.diff(at)[0] / (sliding[1] - sliding[0]))
        if pair.pinion.name == "sun":
            planet[pair.gear.name] = float(contact.path.phi2[0] - pair.ratio * contact.path.rotation[0])
            found.append(still)
        else:
            ratio = gears.pairs[0].ratio
            found.append((still - planet[pair.pinion.name]) / ratio)
    period = gears.pairs[0].pitch
    wanted = [((turn - found[0]) / period) % 1.0 for turn in found]
    phases = [phase.phase for phase in mesh_phases(gears.train)]
    np.testing.assert_allclose(
        np.exp(2j * np.pi * np.array(phases, dtype=float)), np.exp(2j * np.pi * np.array(wanted)), atol=1e-6
    )
    # Parker's closed forms: z_sun psi/360 deg and z_ring psi/360 deg
    psi = np.array([float(angle) for angle in angles.split(",")])
    for own, teeth in ((phases[:planets], 18), (phases[planets:], 72)):
        steps = np.array(own, dtype=float) - float(own[0] or 0.0)
        closed = [np.exp(2j * np.pi * sign * teeth * psi / 360.0) for sign in (1.0, -1.0)]
        assert min(np.abs(np.exp(2j * np.pi * steps) - form).max() for form in closed) < 1e-6


@pytest.mark.parametrize(
    "sample", ["helical", "internal", "rack", pytest.param("straight_bevel", marks=pytest.mark.sweep)]
)
@pytest.mark.sweep_cases("internal", "rack")
def test_flanks_do_not_slide_at_the_pitch_point(sample: str) -> None:
    gears = gm.build(gm.load(SAMPLES / f"{sample}.toml"))
    phi1 = pitch_point_phi1(gears.pairs[0])[0]
    (row,) = gears.contact([np.degrees(phi1)], cycle=False).positions()
    # the rack's flanks are crowned: contact is beside the pitch point by as much as the error of transmission
    assert row.motion.sliding == pytest.approx(0.0, abs=0.3 if sample == "rack" else 1e-9)
    assert row.motion.entrainment > 1.0


def test_skew_axes_have_no_pitch_point() -> None:
    assert np.isnan(pitch_point_phi1(gm.build(gm.load(SAMPLES / "worm_drive.toml")).pairs[0])).all()


def test_positions_must_cover_whole_pitches() -> None:
    pair = loaded_contact("spur", TORQUES, 8).pair
    assert whole_pitches(pair, np.radians(np.linspace(0.0, 36.0, 25))) == (list(range(24)), 2)
    for wrong in ([0.0, 1.0, 2.0], [0.0], [0.0, 3.0, 9.0, 12.0, 18.0], [18.0, 9.0, 0.0]):
        with pytest.raises(ArgumentError, match=r"phi1 = .* deg, \d positions: .* one pitch of the pinion \(18 deg\)"):
            whole_pitches(pair, np.radians(wrong))
