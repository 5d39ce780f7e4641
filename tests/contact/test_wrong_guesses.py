"""Figures at which well-read engineers guess wrong, each against a closed form: page "Where good guesses are wrong"."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.contact.engagement.cycle import mesh_cycle
from gearmesh.contact.engagement.pitch_turns import whole_turns
from gearmesh.contact.flanks import solver_pair
from gearmesh.kernel.numeric.algebra import Array

ALPHA = math.radians(20.0)


def cylindrical(pinion: int, gear: int, *, addendum: float | None = None, **keys: Any) -> gm.Gears:
    """Spur gears, m 2, with addenda of their own or the default ones."""
    own = {} if addendum is None else {"addendum": addendum}
    members = {name: {"teeth": teeth, "face_width": 20, **own} for name, teeth in (("pinion", pinion), ("gear", gear))}
    return gm.build(gm.parse({"kind": "cylindrical", "module": 2, **members, **keys}))


@pytest.mark.sweep
def test_internal_contact_ratio_ends_at_the_root_form_circle() -> None:
    """The formula for tips gives 1.9685, clipped where the line of action touches the pinion's base circle 1.8076. But the hob
    leaves involute only from its own form point on [ISO 21771]: 1.7553."""
    pair, z = cylindrical(18, -54, addendum=1.0).pairs[0], np.array([18.0, 54.0])
    cycle = mesh_cycle(solver_pair(pair), pair.pitch)
    assert cycle is not None
    base, tips, pitch = z * math.cos(ALPHA), z + np.array([2.0, -2.0]), 2.0 * math.pi * math.cos(ALPHA)
    roll = np.sqrt(tips**2 - base**2)
    by_tips = (roll[0] - roll[1] + 36.0 * math.sin(ALPHA)) / pitch
    # of the hob: addendum 1.25, of which the rounding 0.38 leaves 1.25 - 0.38 (1 - sin(alpha)) straight
    form = 18.0 * math.sin(ALPHA) - 2.0 * (1.25 - 0.38 * (1.0 - math.sin(ALPHA))) / math.sin(ALPHA)
    assert by_tips == pytest.approx(1.9685, abs=1e-4)
    assert roll[0] / pitch == pytest.approx(1.8076, abs=1e-4)
    assert cycle.contact_ratio == pytest.approx((roll[0] - form) / pitch, abs=1e-9)
    assert cycle.contact_ratio == pytest.approx(1.7553, abs=1e-4)


@pytest.mark.sweep
def test_an_oversized_hob_swivels_by_the_lead_angles_of_its_working_cylinders() -> None:
    """Worm 2/40, m 4, q 10, x_2 0.4, hob 1.1 times the worm: threads are tangent where both have one normal pitch, at the height
    x_2 m over the reference cylinders. There r sin(gamma) is the same of both; on the reference cylinders 1.0399 deg come out."""
    teeth = {"worm": {"threads": 2, "form": "ZI", "reference_diameter": 40}, "wheel": {"teeth": 40}}
    design = {"kind": "worm_drive", "module": 4, "center_distance": 101.6, "hob": {"reference_diameter": 44}, **teeth}
    gears = gm.build(gm.parse(design))
    table = next(table for table in gears.sheet().tables if "eta_0" in table.symbols)
    swivel = dict(zip(table.symbols, (row[2] for row in table.rows), strict=True))["eta_0"]
    worm = math.atan(4.0 / 21.6)
    hob = math.asin(21.6 * math.sin(worm) / 23.6)
    assert -swivel == pytest.approx(math.degrees(worm - hob), abs=1e-6)
    reference = math.atan(0.2), math.asin(2.0 * 4.0 * math.cos(math.atan(0.2)) / 44.0)
    assert math.degrees(reference[0] - reference[1]) == pytest.approx(1.0399, abs=1e-4)
    # the path of contact crosses the wheel's mid plane on the worm's working cylinder
    contact = gears.contact(cycle=False)
    worm_mount, wheel_mount = contact.pair.mounts
    aside = (contact.path.point - wheel_mount.origin) @ wheel_mount.axis
    away = contact.path.point - worm_mount.origin
    radius = np.linalg.norm(away - (away @ worm_mount.axis)[:, None] * worm_mount.axis, axis=1)
    order = np.argsort(aside)
    assert float(np.interp(0.0, aside[order], radius[order])) == pytest.approx(21.6, abs=1e-3)


@pytest.mark.sweep
@pytest.mark.sweep_cases("70.67-3.125-66.5")
@pytest.mark.parametrize(("phase", "waves", "figure"), [(25.5, 3.52017, 74.95), (70.67, 3.125, 66.5)])
def test_two_eccentricities_add_by_their_phase(phase: float, waves: float, figure: float) -> None:
    """20/40 with 0.02 mm each: waves of e / cos(alpha), once a turn of the pinion and once of the gear. Their sum over a turn of
    the gear, sin 2x + sin(x + phase), spans 3.125 to 3.520 amplitudes, not 4, which 2 (e_1 + e_2) / cos(alpha) would be."""
    errors = {"pinion_eccentricity": 0.02, "gear_eccentricity": 0.02, "gear_phase": phase}
    turns = whole_turns(cylindrical(20, 40, backlash=0.2, assembly=errors).pairs[0])
    single_flank = 1e3 * 40.0 * turns.peak_to_peak
    assert single_flank == pytest.approx(waves * 20.0 / math.cos(ALPHA), abs=0.05)
    assert single_flank == pytest.approx(figure, abs=0.05)


def line_of_contact(axes: Array, origins: Array, helix: Array, base: Array, start: Array) -> tuple[Array, Array]:
    """Direction and a point, at the x of `start`, of the straight line along which crossed involute helicoids touch.

    Its direction makes the base helix angle with either transverse plane, its moment about either axis is r_b cos(beta_b); `start`
    (point and direction) is the nominal one, for the signs.
    """
    point, direction = start
    turned = [float(axis @ direction) for axis in axes]
    assert np.abs(turned) == pytest.approx(np.sin(helix), abs=1e-9)
    moments = [float(np.cross(point - origin, direction) @ axis) for axis, origin in zip(axes, origins, strict=True)]
    assert np.abs(moments) == pytest.approx(base * np.cos(helix), abs=1e-9)
    return np.array(turned), np.array(moments)


def through(axes: Array, origins: Array, turned: Array, moments: Array, start: Array) -> tuple[Array, Array]:
    """The line (direction, point at the x of `start`) with these sines and moments about the axes as they are now."""
    # a unit vector of two given components, on the side of the nominal one
    across = np.cross(*axes)
    within = np.linalg.solve(np.array([*axes, across]), np.array([*turned, 0.0]))
    rest = math.sqrt(1.0 - float(within @ within)) / float(np.linalg.norm(across))
    direction = within + math.copysign(rest, float(start[1] @ across)) * across
    # moments are linear in the point
    rows = [np.cross(direction, axis) for axis in axes]
    known = [
        moment + float(np.cross(origin, direction) @ axis)
        for axis, origin, moment in zip(axes, origins, moments, strict=True)
    ]
    point = np.linalg.solve(np.array([*rows, [1.0, 0.0, 0.0]]), np.array([*known, start[0][0]]))
    return direction, point


@pytest.mark.sweep_cases("gamma_v")
@pytest.mark.parametrize(
    ("error", "moves"), [("gamma_h", (0.5886, -0.6411)), ("gamma_v", (-0.1061, 0.1119))], ids=["gamma_h", "gamma_v"]
)
def test_misaligned_crossed_gears_keep_their_ratio_and_move_their_path(error: str, moves: tuple[float, float]) -> None:
    """Crossed helical gears 20/30, m 2, 45 deg: 0.5 deg leaves no transmission error, but the line along which they touch is
    another. It keeps its angles to both axes and its moments about them, which is the closed form."""
    sizes = ["module=2", "pinion.teeth=20", "gear.teeth=30"]
    screws = [f"{name}.{key}" for name in ("pinion", "gear") for key in ("cone_angle=0", "helix_angle=45")]
    contacts = [
        gm.build(gm.load(SAMPLES / "beveloid_crossed.toml", [*sizes, *screws, f"assembly.{error}={size}"])).contact(
            cycle=False
        )
        for size in (0.0, 0.5, -0.5)
    ]
    places = [
        (np.array([m.axis for m in c.pair.mounts]), np.array([m.origin for m in c.pair.mounts])) for c in contacts
    ]
    path = contacts[0].path
    start = np.array([path.point[0], path.normal[0]])
    helix = math.asin(math.sin(math.radians(45.0)) * math.cos(ALPHA))
    base = np.array([20.0, 30.0]) / math.cos(math.radians(45.0))
    base *= math.cos(math.atan(math.tan(ALPHA) / math.cos(math.radians(45.0))))
    turned, moments = line_of_contact(*places[0], np.full(2, helix), base, start)
    for contact, (axes, origins) in zip(contacts, places, strict=True):
        assert contact.summary["te_peak_to_peak_arcsec"] < 1e-6
        direction, point = through(axes, origins, turned, moments, start)
        away = contact.path.point - point
        assert np.linalg.norm(np.cross(away, direction), axis=1).max() < 1e-6
    for contact, moved in zip(contacts[1:], moves, strict=True):
        along = (contact.path.point - path.point) @ contact.pair.pinion.mount.axis
        assert float(along.mean()) == pytest.approx(moved, abs=1e-3)


@pytest.mark.sweep
@pytest.mark.sweep_cases("jammed")
@pytest.mark.parametrize(("shift", "play"), [(-0.2, 68.404), (0.2, -68.404)], ids=["play", "jammed"])
def test_a_beveloid_pair_has_play_by_an_axial_shift(shift: float, play: float) -> None:
    """Cone angle 30 deg: the gear's teeth get thinner along its axis, so that it is apart by 2 dz sin(30 deg) sin(20 deg) along the
    normal, 68.404 um: neither 0, as of cylindrical gears, nor half of it."""
    design = gm.load(SAMPLES / "beveloid_parallel.toml", [f"assembly.dz={shift}"])
    summary = gm.build(design).contact(np.zeros(1)).summary
    closed = -2e3 * shift * math.sin(math.radians(30.0)) * math.sin(ALPHA)
    assert 1e3 * summary["backlash_normal_min_mm"] == pytest.approx(closed, abs=1e-6)
    assert 1e3 * summary["backlash_normal_max_mm"] == pytest.approx(play, abs=1e-3)
