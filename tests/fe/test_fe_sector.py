"""Sectors with cyclic symmetry: ccx finds of one what it finds of the whole gear under the load of every sector."""

from __future__ import annotations

import re
import shutil
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.built import built
from scipy.spatial import cKDTree

import gearmesh as gm
from gearmesh import DesignError, FiniteElements, Rigid
from gearmesh.fe import ccx
from gearmesh.fe.gear_model import held_mesh
from gearmesh.fe.model import Model, NodeForces, Support
from gearmesh.mesh.hexahedra.hexahedra import plain_grid
from gearmesh.mesh.hexahedra.hexes import join

needs_ccx = pytest.mark.skipif(shutil.which("ccx") is None, reason="apt-get install calculix-ccx")
TEETH, PITCHES = 12, 3


@cache
def pair(order: int = 1) -> gm.Gears:
    """A small gear beside a pinion, so that its axis is not that of the model."""
    fe: dict[str, Any] = {"flank": 3, "fillet": 3, "thickness": 2, "rim_layers": 2, "face": 3, "spacing": "even"}
    wheels = {"pinion": {"teeth": 30, "face_width": 8}, "gear": {"teeth": TEETH, "face_width": 8, "profile_shift": 0.4}}
    return built({"kind": "cylindrical", "module": 2, "helix_angle": 20, "fe": {**fe, "order": order}, **wheels})


def sector_of(gears: gm.Gears, pitches: int = PITCHES) -> FiniteElements:
    model = gears.finite_elements(members=("gear",), sector=pitches)
    assert isinstance(model, FiniteElements)
    return model


def whole_of(gears: gm.Gears, sector: FiniteElements) -> Model:
    """The whole gear of the same elements, at its place, with the sector's forces on every sector."""
    member, at, own = gears.members["gear"], sector._built.at, sector._model
    request = replace(sector._request, sector=None, teeth=None)
    place = at.frame @ member.mount.at(at.turns[1])
    mesh = join({"gear": held_mesh(member, request, plain_grid(request.cells)).move(place)})
    forces = np.zeros_like(mesh.nodes)
    for k in range(TEETH // PITCHES):
        turn = place @ Rigid.about_z(k * PITCHES * member.tooth.pitch_angle) @ place.inverse
        nodes = same_nodes(mesh.nodes, turn.point(own.mesh.nodes[own.forces[0].nodes]))
        forces[nodes] += turn.vector(own.forces[0].forces)
    loaded = np.flatnonzero(forces.any(axis=1))
    return Model(
        "whole",
        mesh,
        own.materials,
        supports=(Support("gear_held"),),
        forces=(NodeForces(loaded, forces[loaded]),),
    )


def same_nodes(nodes: np.ndarray, places: np.ndarray) -> np.ndarray:
    apart, nearest = cKDTree(nodes).query(places)
    assert apart.max() < 1e-9
    return np.asarray(nearest)


@pytest.mark.sweep
@needs_ccx
def test_a_sector_bends_as_the_whole_gear() -> None:
    gears = pair()
    sector = sector_of(gears)
    whole, own = whole_of(gears, sector), sector._model
    one, every = ccx.solve(own), ccx.solve(whole)
    nodes = same_nodes(whole.mesh.nodes, own.mesh.nodes)
    largest = np.abs(every.displacement).max()
    assert np.abs(one.displacement - every.displacement[nodes]).max() < 1e-4 * largest
    # the cut bends too: with it held the sector would be stiffer
    cut = own.mesh.node_sets["gear_cut_right"]
    assert np.abs(one.displacement[cut]).max() > 0.05 * largest
    # at the nodes of the cuts only the elements of one side are averaged
    inner = np.setdiff1d(np.arange(len(nodes)), np.union1d(cut, own.mesh.node_sets["gear_cut_left"]))
    stress = every.stress[nodes]
    assert np.abs(one.stress - stress)[inner].max() < 1e-3 * np.abs(stress).max()


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.sweep_cases("2")
def test_nodes_of_the_cuts_are_pairs_and_named_in_the_deck(tmp_path: Path, order: int) -> None:
    model = sector_of(pair(order))
    symmetry, mesh = model._model.cyclic, model.mesh
    assert symmetry is not None
    assert (symmetry.sectors, model.figures["sectors"]) == (4, 4)
    axis = symmetry.axis[1] - symmetry.axis[0]
    first, last = (mesh.nodes[mesh.node_sets[name]] - symmetry.axis[0] for name in (symmetry.first, symmetry.last))
    assert len(first) == model.figures["node_pairs"]
    # a quarter of a turn about the axis
    turned = np.cross(axis, first) + np.outer(first @ axis, axis)
    np.testing.assert_allclose(last, turned, rtol=0, atol=1e-12 * np.abs(mesh.nodes).max())
    for program in ("calculix", "abaqus"):
        text = model.save(tmp_path / f"{program}.inp", program=program).read_text()
        tie = re.search(r"\*TIE, CYCLIC SYMMETRY, NAME=(.*)\ngear_cut_left, gear_cut_right\n", text)
        assert tie is not None
        # Abaqus takes no name of a tie
        named = f", TIE={tie[1]}" if program == "calculix" else ""
        assert f"*CYCLIC SYMMETRY MODEL, N=4{named}\n" in text
        assert "*NSET, NSET=gear_cut_right\n" in text


@pytest.mark.parametrize(
    ("how", "said"),
    [
        (
            {"sector": 5, "members": ("gear",)},
            "sector = 5: must be a divisor of the 12 teeth of the gear: 1, 2, 3, 4, 6",
        ),
        ({"sector": 12, "members": ("gear",)}, "a divisor of the 12 teeth of the gear: 1, 2, 3, 4, 6"),
        ({"sector": 3, "members": ("ring",)}, "members = ring: must be members of the pair pinion-gear"),
        ({"sector": 3}, "sector = 3: must be left out for members in mesh; choose one of them"),
    ],
)
def test_refused_sectors(how: dict[str, Any], said: str) -> None:
    with pytest.raises(DesignError, match=said):
        pair().finite_elements(**how)
