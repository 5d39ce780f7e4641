"""Finite-element models of worm drives: polygons of both flanks that conform once the load has turned the worm."""

from __future__ import annotations

import shutil
from typing import Any

import numpy as np
import pytest
from oracles.fe_cases import worm_pair

import gearmesh as gm
from gearmesh import FiniteElements, Rigid
from gearmesh.fe.placing import major_axis, minor_axis
from gearmesh.kernel.numeric.algebra import Array

needs_ccx = pytest.mark.skipif(shutil.which("ccx") is None, reason="apt-get install calculix-ccx")


def corners(problem: FiniteElements, name: str, turn: float) -> Array:
    """Corners (F, 4, 2) of the faces of a contact surface after the worm's turn (rad, from where flanks touch unloaded), along the
    ellipse and across it, over its semi-axes."""
    at, mesh = problem._built.at, problem.mesh
    points = mesh.nodes[mesh.face_corners(name)]
    if name.startswith("worm"):
        points = Rigid.about_z(turn - np.sign(at.arm) * problem._built.preload).point(points)
    away = at.frame.inverse.point(points) - at.path.point[0]
    return np.stack((away @ major_axis(at.path) / at.semi_major, away @ minor_axis(at.path) / at.semi_minor), axis=-1)


def crossings(faces: Array) -> Array:
    """Return the places (K,) where lines from form point to tip cross the major axis."""
    low, high = faces, np.roll(faces, -1, axis=1)
    with np.errstate(all="ignore"):
        share = low[..., 1] / (low[..., 1] - high[..., 1])
        place = low[..., 0] + share * (high[..., 0] - low[..., 0])
    # further out edges along the ellipse cross its axis, too
    steep = (share >= 0.0) & (share < 1.0) & (np.abs(high - low)[..., 0] < np.abs(high - low)[..., 1])
    return np.unique(place[steep & (np.abs(place) < 0.65)].round(9))


@pytest.mark.sweep_cases("keys0")
@pytest.mark.parametrize("keys", [{}, {"worm": {"threads": 2, "right_hand": False}, "contact": {"flank": "left"}}])
def test_stations_of_both_flanks_lie_over_each_other_under_load(keys: dict[str, Any]) -> None:
    """To a tenth of an element, in the middle to a fiftieth; where flanks touch unloaded they are a third of one apart."""
    problem = worm_pair(**keys)
    at, (contact,) = problem._built.at, problem._model.contacts
    wheel = crossings(corners(problem, contact.master, 0.0))
    apart = []
    for turn in (at.turn, 0.0):
        worm = crossings(corners(problem, contact.slave, turn))
        assert len(wheel) == len(worm) > 12
        apart.append(np.abs(worm - wheel) / np.diff(wheel).mean())
    assert apart[0].max() < 0.1
    assert np.median(apart[0]) < 0.02
    assert apart[1].min() > 0.25


@pytest.mark.sweep
@needs_ccx
def test_pressure_in_the_middle_is_that_of_the_loaded_contact() -> None:
    """Under 39 Nm on three pairs the leading one has nearly as much force as here; by Hertz the pressure is 4 % higher. Contact
    springs that are harder than facets fit touch on 78 % of the ellipse and are pressed 11 % harder; where stations of worm and
    wheel do not lie over each other it is 2.3 to 3.4 times as much. At one end, where lines are coarser, it is still too large,
    which is reported."""
    problem = worm_pair()
    solved = problem.solve()
    wanted, (contact,) = problem.figures, problem._model.contacts
    nodes = problem.mesh.face_nodes(contact.slave)
    away = np.linalg.norm(
        corners(problem, contact.slave, np.sign(problem._built.at.arm) * problem._built.preload), axis=-1
    )
    inside = np.unique(problem.mesh.face_corners(contact.slave)[away < 0.3])
    assert len(inside) > 10
    pressure = solved.solution.pressure[inside]
    (loaded,) = gm.build(problem.design).loaded_contact([39.0], [0.0]).rows
    (leading,) = (own for own in loaded.tooth_pairs if own.pair == 0)
    of_force = leading.peak_pressure * (wanted["normal_force_n"] / leading.force) ** (1 / 3)
    assert of_force == pytest.approx(wanted["hertz_p0_mpa"], rel=0.04)
    assert pressure.max() == pytest.approx(of_force, rel=0.06)
    area = np.pi * wanted["hertz_a_mm"] * wanted["hertz_b_mm"]
    assert 0.85 * area < solved.figures["contact_area_mm2"] < area
    assert solved.solution.pressure[nodes].max() > pressure.max()
    assert solved.reserve == "unresolved: at the rim of the ellipse, where lines are coarser"
