"""The path of contact in a picture: a curve between its positions, and not joined where contact jumps."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.places import ROOT, SAMPLES

from gearmesh import load
from gearmesh.contact.flanks import analyse
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.view.on_tooth import path_on_surface
from gearmesh.view.scene import MemberContact, ToothView, contact_on, jumps


def contact(points: np.ndarray) -> MemberContact:
    """Contact at points (P, 3), without ellipses."""
    none = np.full(len(points), np.nan)
    normals = np.broadcast_to((0.0, 0.0, 1.0), points.shape)
    return MemberContact(
        points,
        normals,
        np.full(points.shape, np.nan),
        np.full(points.shape, np.nan),
        none,
        none,
        np.zeros(len(none), bool),
    )


def view() -> ToothView:
    """One of a tooth so small that nothing is lifted from it."""
    corners = 1e-9 * np.eye(3)
    mesh = TriangleMesh(
        corners, np.array([[0, 1, 2]]), np.zeros(1, dtype=int), ("flank",), np.ones((1, 3)) / np.sqrt(3.0)
    )
    return ToothView(mesh, lambda points: points)


@pytest.mark.quick
def test_path_between_positions_is_as_round_as_they_are() -> None:
    """On a circle whose chords are 1.5 % of the radius off, spaced unevenly; a corner of 90 deg stays one."""
    angle = np.radians(np.r_[np.arange(0.0, 181.0, 20.0), np.arange(190.0, 301.0, 10.0)])
    circle = np.stack((np.cos(angle), np.sin(angle), np.zeros(len(angle))), axis=-1)
    (curve,) = path_on_surface(view(), contact(circle))
    assert np.abs(np.linalg.norm(curve.points, axis=-1) - 1.0).max() < 1e-3

    across, up = (np.linspace(0.0, 1.0, 6)[:, None] * direction for direction in np.eye(3)[:2])
    (curve,) = path_on_surface(view(), contact(np.concatenate((across, across[-1] + up[1:]))))
    x, y, _ = np.abs(curve.points - (1.0, 0.0, 0.0)).T
    assert np.minimum(x, y).max() < 1e-6


def test_path_has_no_position_twice() -> None:
    """Those of the design are among those of the whole engagement, but for rounding, and between the two is no direction."""
    pair = pair_of(load(str(SAMPLES / "beveloid_crossed.toml"), []))
    rotation = np.radians(np.linspace(-10.0, 10.0, 9))
    contacts = [analyse(pair, turns) for turns in (rotation[2:7], rotation + 1e-12)]
    points = contact_on(0, contacts[0], pair.mounts, contacts[1]).path[0]
    steps = np.linalg.norm(np.diff(points, axis=0), axis=-1)
    assert len(points) == 9
    assert steps.min() > 0.5 * steps.max()


@pytest.mark.sweep
def test_path_of_a_whole_engagement_is_cut_where_it_jumps() -> None:
    """Tip contact on a fillet, then contact of the flanks: between them is none, with another run beside it or without."""
    pair = pair_of(load(str(ROOT / "tests" / "corpus" / "nodes_novikov_sensible_205.toml"), []))
    path = analyse(pair, np.radians(np.linspace(-9.0, 6.0, 31)))
    after = jumps(path.point1, path.kind == "edge", path.rotation)
    assert len(after) >= 1
    for contact in (contact_on(0, path, pair.mounts), contact_on(0, path, pair.mounts, path)):
        assert np.isnan(contact.path[0][after + 1 + np.arange(len(after))]).all()


@pytest.mark.quick
def test_path_is_cut_where_contact_jumps_to_an_edge_elsewhere() -> None:
    """And nowhere else: not where it goes on along the edge that it reaches, nor where positions are far apart."""
    rotation = np.array([0.0, 0.1, 0.2, 0.5, 0.6, 0.7, 0.8])
    edge = np.array([False, False, False, False, True, True, True])
    along = np.stack((10.0 * rotation, np.zeros(7), np.zeros(7)), axis=-1)
    assert jumps(along, edge, rotation).tolist() == []
    elsewhere = along + np.where(edge[:, None], (0.0, 8.0, 0.0), 0.0)
    assert jumps(elsewhere, edge, rotation).tolist() == [3]
    assert jumps(elsewhere[::-1], edge[::-1], 0.8 - rotation[::-1]).tolist() == [2]
    # from the tip of one member to that of the other, but not where it goes on round a corner of edges
    tips = np.where(edge, "gear_tip", "pinion_tip")
    assert jumps(along, tips, rotation).tolist() == []
    assert jumps(elsewhere, tips, rotation).tolist() == [3]
