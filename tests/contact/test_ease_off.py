"""The ease-off map against circles that meet a dense exact grid of the gear, and where it must be nothing."""

from __future__ import annotations

import json
from pathlib import Path

import meshio
import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import GearPair, Rigid
from gearmesh.check.heightfield import Arcs, GridFlank
from gearmesh.contact.engagement import ease_off as ease_off_module
from gearmesh.contact.first_touch.field import Advances
from gearmesh.contact.pair import Pair


def turn_of_first_touch(pair: GearPair, field: object, sense: float, point: np.ndarray, phi1: np.ndarray) -> np.ndarray:
    """Rotation (rad, in the sense of the drive) by which a point of the pinion puts the gear ahead of the nominal ratio."""
    first, second = pair.mounts
    placed = second.base.inverse.point(first.at(phi1).point(point))
    flat = np.stack((np.hypot(placed[:, 0], placed[:, 1]), placed[:, 2]), axis=-1)
    turned = sense * np.arctan2(placed[:, 1], placed[:, 0]) - field.at(flat).height  # type: ignore[attr-defined]
    ahead = pair.drive * second.zero + turned - pair.drive * pair.ratio * phi1
    return np.asarray((ahead + np.pi) % (2.0 * np.pi) - np.pi)


@pytest.mark.sweep_cases("novikov")
@pytest.mark.parametrize("name", ["spiral_bevel_basic", "novikov"])
def test_the_map_is_what_circles_through_the_gear_say(name: str) -> None:
    gears = gm.build(gm.load(SAMPLES / f"{name}.toml"))
    (pair,) = gears.pairs
    found = gears.ease_off().map
    s, t = np.linspace(0.0, 1.0, 81), np.linspace(0.0, 1.0, 81)
    grid = pair.gear.tooth.flank_grid(pair.flanks[1], s, t).points
    sense = pair.drive * pair.gear.mount.sign
    centre = grid.reshape(-1, 3).mean(axis=0)
    field = GridFlank(grid).over(Arcs(sense, float(np.arctan2(centre[1], centre[0]))), Rigid.identity(), -1.0)
    # gone on beyond the gear's edges it is the same inside of them, and lies beyond them where it is not
    known = np.isfinite(found.distance)
    np.testing.assert_array_equal(found.continued[known], found.distance[known])
    assert found.beyond[known].max() <= 0.0
    assert np.nanmin(found.beyond[~known]) > -0.05
    assert 0.0 < np.nanmax(found.continued[~known]) < 3.0 * np.nanmax(found.distance)
    inside = [(i, j) for i in (3, 6, 9) for j in (6, 10, 14, 18) if np.isfinite(found.distance[i, j])]
    greatest, arms = [], []
    for i, j in inside:
        near = found.phi1[i, j] + np.linspace(-0.02, 0.02, 9)
        ahead = turn_of_first_touch(pair, field, sense, found.points[i, j], near)
        curve = np.polynomial.Polynomial.fit(near - near[4], ahead, 4)
        tops = curve.deriv().roots()
        top = min((float(x.real) for x in tops if abs(x.imag) < 1e-9), key=abs)
        assert abs(top) < 2e-4
        greatest.append(float(curve(top)))
        arms.append(found.distance[i, j])
    assert len(inside) >= 8
    # differences between points, which the reference common to all of them leaves out
    advances, distances = np.array(greatest), np.array(arms)
    k = int(advances.argmax())
    lever = (distances - distances[k])[advances < advances[k]] / (advances[k] - advances)[advances < advances[k]]
    radius = np.hypot(grid[..., 0], grid[..., 1]).max()
    far = lever[(advances[k] - advances)[advances < advances[k]] > 1e-5]
    assert far.size >= 4
    assert (far > 0.4 * radius).all()
    assert (far < 1.0 * radius).all()
    assert np.ptp(far) < 0.25 * far.mean()


def test_a_conjugate_pair_has_none() -> None:
    distance = gm.build(gm.load(SAMPLES / "helical.toml")).ease_off().map.distance
    assert np.isfinite(distance).mean() > 0.7
    assert np.nanmax(distance) < 2e-5


def test_clearance_below_contact_matches_line_of_action() -> None:
    """Near its base circle a point seems to touch the flank that goes on past the tip twice; by the second it is 1.3 mm."""
    found = gm.build(gm.load(SAMPLES / "helical.toml")).ease_off().map
    transverse = np.arctan(np.tan(np.radians(20.0)) / np.cos(np.radians(15.0)))
    radius, pitch_radii = (
        np.hypot(*found.points[:3, :, :2].T).T,
        2.5 * np.array([24.0, 48.0]) / np.cos(np.radians(15.0)),
    )
    base = pitch_radii * np.cos(transverse)
    roll = pitch_radii.sum() * np.sin(transverse) - np.sqrt(radius**2 - base[0] ** 2)
    past = np.hypot(base[1], roll) - (pitch_radii[1] + 5.0)
    # the flank's table past its end; toe and heel, where both flanks end, are no edges of these
    np.testing.assert_allclose(found.beyond[:, 1:-1][:1], past[:1, 1:-1], atol=0.1)
    np.testing.assert_allclose(found.beyond[1:3, 1:-1], past[1:, 1:-1], atol=2e-3)


def test_files_hold_the_map(tmp_path: Path) -> None:
    found = gm.build(gm.load(SAMPLES / "zerol.toml")).ease_off()
    told = json.loads(found.save(tmp_path / "map.json").read_text())
    assert told["shape"] == list(found.map.distance.shape)
    mesh = meshio.read(found.save(tmp_path / "map.vtu"))
    np.testing.assert_array_equal(mesh.points, found.map.points.reshape(-1, 3))
    um = np.array([np.nan if row["ease_off_um"] is None else row["ease_off_um"] for row in told["ease_off"]])
    np.testing.assert_allclose(mesh.point_data["ease_off_um"], um, rtol=1e-9, atol=1e-9)
    assert np.nanmin(um) == 0.0
    assert mesh.cells_dict["quad"].shape == ((found.map.distance.shape[0] - 1) * (found.map.distance.shape[1] - 1), 4)


@pytest.mark.sweep
@pytest.mark.parametrize("hob", [{}, {"hob.reference_diameter": 63.0}])
def test_ease_off_of_worm_drives_is_known_on_half_of_their_field(hob: dict[str, float]) -> None:
    """The gear's flank passes the threads again where it comes from behind; the first meeting counts."""
    gears = gm.build(gm.load(SAMPLES / "worm_drive.toml").with_values(hob))
    distance = gears.ease_off().map.distance
    assert np.isfinite(distance).sum() > 0.4 * distance.size
    assert -1e-6 < np.nanmin(distance) < 1e-4


@pytest.mark.sweep
def test_single_thread_touches_its_wheel_along_lines_on_the_coast_side() -> None:
    """The coast flank faces the wheel half a turn before the driving one does: it was taken to be on its next winding on half of
    the face, where the wheel of the worm's own hob has its lines of contact as elsewhere."""
    driving, coast = gm.build(gm.load(SAMPLES / "worm_drive_dual_lead.toml")).contact().sides
    assert sum(line is not None for line in coast.whole.lines) >= 39
    assert np.nanmax(np.abs(coast.whole.te)) < 1e-9
    # of its own tooth of the wheel, not of the next one
    assert (
        abs(coast.whole.phi2[20] - coast.pair.ratio * coast.whole.rotation[20])
        < 0.25 * coast.pair.ratio * coast.pair.pitch
    )
    # what passes the wheel in part of a turn is seen there: 215 and 240 points at 48 positions of a turn
    for side in (driving, coast):
        assert (side.ease_off.distance < 5e-3).sum() > 300


def test_points_of_a_worm_are_read_where_they_touch_first() -> None:
    """The wheel of an identical hob touches points of the worm twice: along the thread one goes over into the other once."""
    ease_off = gm.build(gm.load(SAMPLES / "worm_drive.toml")).ease_off().map
    touching = [phi1[distance < 2e-3] for phi1, distance in zip(ease_off.phi1, ease_off.distance, strict=True)]
    steps = [np.diff(phi1) for phi1 in touching if len(phi1) > 8]
    assert len(steps) >= 9
    for along in steps:
        assert np.median(along) > 0.0
        assert (along < 0.0).sum() == 1


@pytest.mark.sweep
def test_a_fine_grid_takes_no_more_memory_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """The page of a worm drive asks at 7,500 points and some 1,300 positions: 0.5 GB where all are held at once."""
    followed = gm.build(gm.load(SAMPLES / "spur.toml")).contact().engagement
    assert followed is not None
    flank = followed.pair.parts[0].pinion
    (low, left), (high, right) = flank.grid[0, 0], flank.grid[-1, -1]
    fine = np.stack(np.meshgrid(np.linspace(low, high, 71), np.linspace(left, right, 81), indexing="ij"), axis=-1)
    held: list[int] = []
    advances = ease_off_module.advances

    def measured(pair: Pair, phi1: np.ndarray, r: np.ndarray, n: np.ndarray, index: np.ndarray) -> Advances:
        held.append(len(index) * len(r))
        return advances(pair, phi1, r, n, index)

    monkeypatch.setattr(ease_off_module, "advances", measured)
    found = ease_off_module.ease_off(followed, 2.0 * np.pi / 20, fine)
    assert sum(held) > 2 * max(held)
    assert max(held) <= 2**18
    # blocks of points are the same as one by one
    monkeypatch.setattr(ease_off_module, "LARGEST_TABLE", 10**9)
    np.testing.assert_array_equal(ease_off_module.ease_off(followed, 2.0 * np.pi / 20, fine).distance, found.distance)
