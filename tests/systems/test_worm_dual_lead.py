"""Dual lead worms: a shift of the worm changes the backlash linearly, and nothing else, of both hands."""

from __future__ import annotations

import math

import numpy as np
import pytest
from oracles.places import SAMPLES
from scipy.optimize import fsolve, minimize

import gearmesh as gm
from gearmesh import load
from gearmesh.systems.worm_drive.build import worm_thread

SAMPLE = SAMPLES / "worm_drive_dual_lead.toml"
E, WAY = 0.015, 0.5 * 3.0 * 45


@pytest.mark.sweep
@pytest.mark.parametrize("hand", [1, -1])
def test_shift_of_the_worm_changes_the_backlash_linearly(hand: int) -> None:
    """A thread shifted by s is one turned by s / P: the wheel's flanks lie s / K (1 + e) and s / K (1 - e) farther."""
    backlash = []
    for shift in (0.0, 0.8):
        keys = [f"worm.right_hand={str(hand > 0).lower()}", f"assembly.dz1={hand * shift}", "contact.phi1.count=5"]
        summary = gm.build(gm.load(str(SAMPLE), keys)).contact().summary
        backlash.append(summary["backlash_min_deg"])
        assert summary["backlash_max_deg"] == pytest.approx(backlash[-1], abs=1e-7)
        assert summary["mesh_te_peak_to_peak_arcsec"] * math.pi / 648000.0 < 1e-9
    grown = 2.0 * E * 0.8 / (WAY * (1.0 - E**2))
    assert math.radians(backlash[1] - backlash[0]) == pytest.approx(grown, abs=1e-9)


@pytest.mark.parametrize("hand", [1, -1])
def test_threads_grow_thicker_along_the_axis(hand: int) -> None:
    """Axial thickness on the reference cylinder at z: that of the middle and 2 e z, along +z of right-hand worms."""
    design = load(str(SAMPLE), [f"worm.right_hand={str(hand > 0).lower()}"])
    ways = []
    for angle in (-9.0, 0.0, 7.0):
        z = []
        for side in (1, -1):
            thread = worm_thread(design, side)
            at = thread.flank(side).jet(np.array(thread.at_radius(thread.radius)), np.array(0.0))
            # the same point of the helix in the plane at the polar angle
            z.append(at.r[2] + hand * thread.screw * (angle - math.atan2(at.r[1], at.r[0])))
        middle = 0.5 * (z[0] + z[1])
        ways.append(abs(z[0] - z[1]) - 2.0 * E * hand * middle)
    # in the plane at a polar angle: of the middle between the flanks, 2 e z to the second order of e
    np.testing.assert_allclose(ways, ways[1], rtol=0, atol=2.0 * E**2 * 3.0 + 1e-9)


@pytest.mark.parametrize(("hand", "form"), [(1, "ZI"), (-1, "ZA")])
@pytest.mark.sweep_cases("-1-ZA")
def test_sheet_has_both_leads_and_the_thickness_along_the_axis(hand: int, form: str) -> None:
    """Leads by hand. At z = 2.5 pitches, by brute force: the ball of the sheet's height is as near to both flanks as its radius, in
    a space as wide as the axial section of both helicoids is there."""
    wires, length = 4.6, 5.0 * math.pi * 3.0
    keys = [f"worm.right_hand={str(hand > 0).lower()}", f"worm.form={form}", f"worm.wire_diameter={wires}"]
    gears = gm.build(gm.load(str(SAMPLE), [*keys, f"worm.length={length}", "worm.addendum=0.8"]))
    rows = {
        (table.title, symbol): row[2:]
        for table in gears.sheet().tables
        for symbol, row in zip(table.symbols, table.rows, strict=False)
    }
    both, along = "Worm: flanks of both leads", "Worm: thickness along the axis"
    leads = np.pi * 3.0 * np.array([1.0 + E, 1.0 - E])
    np.testing.assert_allclose(rows[both, "p_z"], leads, rtol=1e-9)
    gamma = np.arctan(leads / (np.pi * 35.0))
    np.testing.assert_allclose(rows[both, "gamma_m"], np.degrees(gamma), rtol=1e-9)
    if form == "ZI":
        base = 35.0 * np.cos(np.arctan(np.tan(np.radians(20.0)) / np.sin(gamma)))
        np.testing.assert_allclose(rows[both, "d_b"], base, rtol=1e-9)
    design = gears.design.in_mm()
    threads = {side: worm_thread(design, side) for side in (1, -1)}
    flanks = {side: thread.flank(side) for side, thread in threads.items()}
    # turns of the flanks beside the space at 2.5 pitches, where threads are thicker
    turns = {1: 2, -1: 3}

    def away(centre: np.ndarray, side: int) -> float:
        def far(x: np.ndarray) -> float:
            return float(np.linalg.norm(flanks[side].jet(np.array(x[0]), np.array(x[1])).r - centre))

        start = [threads[side].at_radius(17.5), 2.0 * np.pi * turns[side]]
        scales = {"xatol": 1e-10, "fatol": 1e-13, "maxiter": 2000}
        simplex = np.array([start, [start[0] * 1.02 + 0.1, start[1]], [start[0], start[1] + 0.02]])
        return float(minimize(far, start, method="Nelder-Mead", options={**scales, "initial_simplex": simplex}).fun)

    end = 2 if hand > 0 else 0
    measured = rows[along, "M_d"][end]
    x = 0.5 * (measured - wires)

    def miss(u: np.ndarray) -> list[float]:
        centre = np.array([u[0], 0.0, u[1]])
        return [away(centre, side) - 0.5 * wires for side in (1, -1)]

    radius, height = fsolve(miss, [x + 0.01, 0.5 * hand * length], xtol=1e-10)
    assert radius == pytest.approx(x, abs=1e-6)
    # half way between threads whose middles are 2.5 pitches away: that of the flanks is e p_x / 2 beside
    assert height == pytest.approx(hand * (0.5 * length - E * 1.5 * math.pi), abs=1e-3)
    # of the thread there, in the axial section
    z = 0.5 * hand * length
    assert rows[along, "z"][end] == pytest.approx(z)
    width = rows[along, "s_mx"][1] + 2.0 * E * hand * z
    assert rows[along, "s_mx"][end] == pytest.approx(width, abs=1e-9)
    assert rows[along, "s_mx"][end] + rows[along, "e_mx"][end] == pytest.approx(3.0 * math.pi, abs=1e-9)
