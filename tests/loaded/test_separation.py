"""Gaps of unloaded flanks against those that circles about the gear's axis give, and where the grids lie."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.contact.first_touch.field import advances
from gearmesh.contact.hertz import STEEL, contact_modulus
from gearmesh.contact.tca import contact_path
from gearmesh.loaded.separation import near_pairs, separation


@pytest.mark.sweep
@pytest.mark.sweep_cases("spiral_bevel_basic")
@pytest.mark.parametrize("sample", ["helical", "spiral_bevel_basic"])
def test_gaps_are_those_of_the_advances(sample: str) -> None:
    """The gap at a point of the pinion is the angle by which the point is behind the touching point, times its lever. 3 % and
    0.2 um, the tables' accuracy. Across the grid the gap is least in the middle."""
    pair = pair_of(gm.load(SAMPLES / f"{sample}.toml"))
    near = near_pairs(pair, pair.pitch * np.array([0.2, 0.55]), 0.05)
    assert len(near.position) >= 4
    force = np.full(len(near.position), 8e3)
    grid = separation(near, force, contact_modulus(STEEL, STEEL), (40, 24), np.ones(len(force)))
    own = near.pair.pinion.mount.at(near.turns[0])
    normals = np.einsum("mij,mxi->mxj", own.rotation, grid.normal)
    every = np.arange(len(force))
    advance = advances(near.pair, near.turns[0], grid.places[0], normals, every).advance
    stands = near.pair.drive * (near.turns[1] - near.pair.ratio * near.turns[0])
    behind = (stands[:, None] - advance) * grid.levers[1]
    middle = 0.5 * (grid.gap[:, :, 11] + grid.gap[:, :, 12]) - 0.125 * (near.kappa[:, 1] * grid.dy**2)[:, None]
    there = grid.on[:, :, 10:14].all(axis=2) & np.isfinite(advance)
    assert there.sum() > 100
    np.testing.assert_allclose(middle[there], behind[there], rtol=0.03, atol=2e-4)
    inside = there & (near.path.kind != "edge")[:, None]
    lowest = np.where(grid.on, grid.gap, np.inf).argmin(axis=2)[inside]
    assert np.isin(lowest, (11, 12)).all()


@pytest.mark.quick
def test_grids_end_where_the_flanks_do() -> None:
    """Grids of a spur pair are as long as the narrower face. Tooth pairs 0 and 1 are a base pitch apart."""
    pair = pair_of(gm.load(SAMPLES / "spur.toml"))
    near = near_pairs(pair, np.array([0.4 * pair.pitch]), 1e-4)
    grid = separation(near, np.full(2, 1e3), contact_modulus(STEEL, STEEL), (40, 24), np.ones(2))
    np.testing.assert_allclose(40 * grid.dx, 28.0, rtol=1e-6)
    assert near.number.tolist() == [0, 1]
    # both on the line of action, a base pitch apart
    apart = np.linalg.norm(np.diff(grid.middle[:, 20], axis=0), axis=-1)
    np.testing.assert_allclose(apart, np.pi * 3.0 * np.cos(np.radians(20.0)), rtol=1e-4)


@pytest.mark.quick
def test_grids_are_as_long_as_lines_of_contact() -> None:
    """Lines of contact of a helical pair run obliquely over the flank and end at tips. The grids' ranges are as long as the
    lines that contact analysis traces, to 10 um; from there the ridge goes on along the tip."""
    pair = pair_of(gm.load(SAMPLES / "helical.toml"))
    near = near_pairs(pair, pair.pitch * np.array([0.1, 0.5]), 1e-3)
    lines = [m for m, line in enumerate(near.path.lines) if line is not None]
    assert len(lines) >= 4
    traced = [float(np.linalg.norm(near.path.lines[m][-1] - near.path.lines[m][0])) for m in lines]
    low, high = near.range
    np.testing.assert_allclose((high - low)[lines], traced, atol=0.01)


@pytest.mark.quick
def test_lines_go_on_along_the_edges_that_end_them() -> None:
    """Ridge of a helical pair beyond the end of the contact line: it is the tip edge, at the tip radius to 1 um. The gap there
    is the gap of the flanks beside the line, half the curvature times the squared distance from the line: 4 % and 0.5 um."""
    pair = pair_of(gm.load(SAMPLES / "helical.toml", ["pinion.face_width=20", "gear.face_width=20"]))
    near = near_pairs(pair, np.array([0.8 * pair.pitch]), 1e-3)
    grid = separation(
        near, np.full(len(near.number), 2e4), contact_modulus(STEEL, STEEL), (40, 24), np.ones(len(near.number))
    )
    low, high = near.range
    found = 0
    for m in np.flatnonzero(near.path.kind == "line"):
        there = grid.middle[m] - near.path.point[m]
        x, y = (there @ near.axes[m, :, k] for k in (0, 1))
        radius = [np.hypot(places[m, :, 0], places[m, :, 1]) for places in grid.places]
        tips = [float(member.tooth.blank.tip.at(0.0)) for member in pair.both]
        beyond = (x < low[m] - 0.3) | (x > high[m] + 0.3)
        on_tip = np.min([np.abs(r - tip) for r, tip in zip(radius, tips, strict=True)], axis=0)
        # of cells on either side of an edge one alone lies on both flanks: continued from there
        rows = grid.gap[m, :, 12:14] if grid.on[m, beyond][:, 12:14].all() else grid.gap[m, :, [11, 10]].T
        gap = 1.5 * rows[:, 0] - 0.5 * rows[:, 1]
        # places are those of the pinion, as far from the gear's tip as the gap
        assert (on_tip < 1e-3 + gap)[beyond].all()
        np.testing.assert_allclose(gap[beyond], (0.5 * near.kappa[m, 1] * y**2)[beyond], rtol=0.04, atol=5e-4)
        found += int(beyond.sum())
    assert found > 10


@pytest.mark.sweep
def test_flanks_do_not_overlap_where_one_of_them_ends() -> None:
    """Lines of contact run into the undercut of a pinion of 11 teeth: beyond it gaps are those of a flank that goes on, and on it
    no cell overlaps, 0.01 um."""
    keys = ["module=2", "pinion.teeth=11", "gear.teeth=113", "pinion.profile_shift=0", "gear.profile_shift=0"]
    pair = pair_of(gm.load(SAMPLES / "helical.toml", [*keys, "pinion.bore=5", "gear.bore=40"]))
    near = near_pairs(pair, np.array([0.25 * pair.pitch]), 0.02)
    assert (near.path.kind == "line").all()
    count = len(near.number)
    grid = separation(near, np.full(count, 1e3), contact_modulus(STEEL, STEEL), (40, 24), np.ones(count))
    ends = (~grid.on).any(axis=2)
    assert ends.sum() > 20
    assert grid.gap[grid.on].min() > -1e-5


@pytest.mark.sweep
def test_levers_are_in_the_ratio_at_which_flanks_drive() -> None:
    """At the first touch of every pair, on flanks and on edges: lever of the pinion over that of the gear is d phi2 / d phi1 of
    that pair alone, 2e-5 (continued from cells that are on no edge). Transmission errors have slopes: with them T2/T1 is not z2/z1
    at every position."""
    pair = pair_of(gm.load(SAMPLES / "spiral_bevel_basic.toml"))
    near = near_pairs(pair, pair.pitch * np.array([0.0, 0.5]), 0.05)
    own, step = near.path.rotation, 1e-5
    behind, ahead = (contact_path(near.pair, own + way * step) for way in (-1, 1))
    same = (behind.kind == near.path.kind) & (ahead.edge == near.path.edge) & (behind.edge == near.path.edge)
    assert same.sum() >= 4
    assert (near.path.kind[same] == "edge").any()
    ratio = np.abs(ahead.phi2 - behind.phi2) / (2.0 * step)
    force = np.full(len(own), 1e3)
    grid = separation(near, force, contact_modulus(STEEL, STEEL), (40, 24), np.ones(len(own)))
    for m in np.flatnonzero(same):
        x = (grid.middle[m] - near.path.point[m]) @ near.axes[m, :, 0]
        # from where the ridge is no edge yet
        inner = np.flatnonzero((x > near.range[0][m]) & (x < near.range[1][m]))
        nearest = inner[np.abs(x[inner]).argsort()[:6]]
        first, second = (np.polyval(np.polyfit(x[nearest], lever[m, nearest], 3), 0.0) for lever in grid.levers)
        assert first / second == pytest.approx(ratio[m], rel=2e-5)
    assert np.ptp(ratio[same]) > 1e-3 * ratio.mean()
