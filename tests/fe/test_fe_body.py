"""Whole bodies of hexahedra: they join the rim, have the volume of the gear as it is turned, and twist as webs do."""

from __future__ import annotations

import shutil
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.built import built, built_sample

import gearmesh as gm
from gearmesh import DesignError, Member
from gearmesh.answers.bodies.finite_element_model import omissions
from gearmesh.fe import ccx
from gearmesh.fe.gear_model import MeshRequest, held_mesh
from gearmesh.fe.model import NodeForces
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.hexahedra.hex_quality import CORNER_PLACES, MIDDLE_PLACES, scaled_jacobian, volumes
from gearmesh.mesh.hexahedra.hexahedra import Cells, plain_grid
from gearmesh.mesh.hexahedra.hexes import HEX_FACES, HexMesh
from gearmesh.mesh.hexahedra.turned_body import core_radius, whole_mesh
from gearmesh.teeth.blank.moments import Moments, member_moments

needs_ccx = pytest.mark.skipif(shutil.which("ccx") is None, reason="apt-get install calculix-ccx")
COARSE = Cells(flank=3, fillet=4, thickness=2, rim=1, face=5)
#: a web off the middle's stations, a hub on either side, a counterbore, teeth that wind
WEB: dict[str, Any] = {
    "teeth": 30,
    "face_width": 20,
    "bore": 14,
    "web": {"thickness": 4, "hub_diameter": 26},
    "hub": {"diameter": 24, "length": 5},
    "toe_hub": {"diameter": 22, "length": 3},
    "heel_bore": {"diameters": [18], "lengths": [6]},
}
#: ends of a shaft as cones and shoulders
SHAFT: dict[str, Any] = {
    "teeth": 17,
    "face_width": 20,
    "heel_shaft": {"diameters": [24, 16], "lengths": [8, 20]},
    "toe_shaft": {"diameters": [20], "lengths": [12]},
}


@cache
def wheels() -> gm.Gears:
    return built({"kind": "cylindrical", "module": 2, "helix_angle": 15, "pinion": SHAFT, "gear": WEB})


def mesh_of(member: Member, order: int = 1, cells: Cells = COARSE, size: float | None = None) -> HexMesh:
    places = np.arange(member.tooth.teeth) - (member.tooth.teeth - 1) // 2
    return whole_mesh(member.tooth, member.body, places, plain_grid(cells), None, size, second_order=order == 2)


def turned_volume(member: Member) -> float:
    core, (low, high) = core_radius(member.tooth, member.body), member.body.ends
    uncut = replace(member, features=member.features.uncut)
    return member_moments(uncut).volume - np.pi * core**2 * (high - low)


@pytest.mark.parametrize(("name", "order"), [("pinion", 1), ("gear", 1), ("gear", 2)])
@pytest.mark.sweep_cases("gear-2", "pinion-1")
def test_a_whole_body_conforms_and_every_outer_face_is_in_one_set(name: str, order: int) -> None:
    member = wheels().members[name]
    mesh = mesh_of(member, order)
    assert scaled_jacobian(mesh.nodes, mesh.elements).min() > 0.5
    assert_conforms(mesh)
    bore = mesh.nodes[mesh.node_sets["bore" if name == "gear" else "core"]]
    inner = 7.0 if name == "gear" else core_radius(member.tooth, member.body)
    # with end faces of what is bored the bore is a cylinder
    np.testing.assert_allclose(np.hypot(*bore.T[:2]), inner, rtol=0, atol=1e-9)
    assert {"web", "hub", "counterbore"} <= set(mesh.face_sets) if name == "gear" else "shaft_end" in mesh.face_sets


def assert_conforms(mesh: HexMesh) -> None:
    """No face is shared by more than two elements; every face of one element alone is in one face set."""
    faces = np.sort(mesh.elements[:, :8][:, np.array(HEX_FACES)], axis=-1).reshape(-1, 4)
    _, first, count = np.unique(faces, axis=0, return_index=True, return_counts=True)
    assert count.max() == 2
    named = [tuple(face) for own in mesh.face_sets.values() for face in own.tolist()]
    assert len(named) == len(set(named))
    assert set(named) == {(int(i) // 6, int(i) % 6) for i in first[count == 1]}


#: everything that is cut along the axis: through a web, to a depth, in a bore
CUT: dict[str, Any] = {
    "teeth": 30,
    "face_width": 12,
    "bore": 12,
    "keyway": {},
    "web": {"thickness": 4},
    "holes": {"count": 3},
    "hub": {"diameter": 24, "length": 4},
    "bolts": {"count": 2, "diameter": 2, "circle": 20, "depth": 5, "start_angle": 90},
}


def cut_gear(**keys: Any) -> Member:
    """The gear of `CUT`, or a disc with other keys."""
    own = {"teeth": 24, "face_width": 12, "bore": 20, **keys} if keys else CUT
    return built({"kind": "cylindrical", "module": 2, "helix_angle": 15, "gear": own}).members["gear"]


def cut_mesh(member: Member, order: int, request: MeshRequest | None = None) -> HexMesh:
    wanted = request or MeshRequest(teeth=None, cells=COARSE, whole=True, second_order=order == 2)
    return held_mesh(member, wanted, plain_grid(COARSE))


@pytest.mark.parametrize("order", [1, pytest.param(2, marks=pytest.mark.sweep)])
def test_cut_bodies_conform_and_weigh_what_the_solid_weighs(order: int) -> None:
    """The moments of the solid are closed forms along outlines, those of the elements sums over tetrahedra or Gauss points."""
    member = cut_gear()
    mesh = cut_mesh(member, order)
    assert scaled_jacobian(mesh.nodes, mesh.elements).min() > 0.2
    assert_conforms(mesh)
    exact, found = member_moments(member), element_moments(mesh)
    size = {1: 2e-3, 2: 2e-5}[order]
    assert found.volume == pytest.approx(exact.volume, rel=size)
    assert found.about_axis(7850.0) == pytest.approx(exact.about_axis(7850.0), rel=size)
    # keyway and hub move the centre of gravity by 0.1 and 0.4 mm
    np.testing.assert_allclose(found.centre, exact.centre, rtol=0, atol=20.0 * size)
    assert exact.centre[0] < -0.02
    # walls are prisms: each node of a hole is at its radius, at every height
    holes = mesh.nodes[mesh.node_sets["hole"]]
    assert member.holes is not None
    away = np.linalg.norm(holes[:, None, :2] - member.holes.centres, axis=-1).min(axis=1)
    np.testing.assert_allclose(away[np.abs(holes[:, 2]) < 3.9], 0.5 * member.holes.diameter, rtol=0, atol=1e-7)
    floor = mesh.nodes[mesh.node_sets["bolt"]][:, 2]
    assert (floor.min(), floor.max()) == pytest.approx((5.0, 10.0), abs=1e-9)


@pytest.mark.parametrize(
    ("keys", "region"),
    [
        ({"hex_bore": {"across_flats": 19}}, "bore_flat"),
        pytest.param({"d_bore": {"height": 18}}, "bore_flat", marks=pytest.mark.sweep),
        pytest.param(
            {"keyway": {}, "heel_bore": {"diameters": [30], "lengths": [4]}}, "keyway", marks=pytest.mark.sweep
        ),
    ],
)
def test_bores_of_any_form_are_cut(keys: dict[str, Any], region: str) -> None:
    member = cut_gear(**keys)
    mesh = cut_mesh(member, 2)
    assert_conforms(mesh)
    assert element_moments(mesh).volume == pytest.approx(member_moments(member).volume, rel=1e-5)
    walls = mesh.nodes[mesh.node_sets[region]]
    assert member.bore_form is not None
    assert np.hypot(*walls.T[:2]).max() == pytest.approx(member.bore_form.reach(10.0), abs=1e-9)


@pytest.mark.sweep
def test_steep_rims_of_bevel_gears_have_keyways_and_blind_holes() -> None:
    bolts = {"count": 4, "diameter": 5, "circle": 55, "depth": 6}
    gears = built(
        {
            "kind": "spiral_bevel",
            "module": 4,
            "pinion": {"teeth": 14, "bore": 14, "keyway": {}},
            "gear": {"teeth": 30, "bore": 30, "keyway": {}, "bolts": bolts},
        }
    )
    for member in gears.members.values():
        mesh = cut_mesh(member, 1)
        assert_conforms(mesh)
        assert {"keyway"} <= set(mesh.face_sets)
        assert element_moments(mesh).volume == pytest.approx(member_moments(member).volume, rel=5e-3)
    assert "bolt" in mesh.face_sets


def element_moments(mesh: HexMesh) -> Moments:
    """Moments of hexahedra by Gauss points."""
    along, weights = np.polynomial.legendre.leggauss(3)
    total = Moments.none()
    points = mesh.nodes[mesh.elements]
    for xi, wx in zip(along, weights, strict=True):
        for eta, wy in zip(along, weights, strict=True):
            for zeta, wz in zip(along, weights, strict=True):
                place = np.array([xi, eta, zeta])
                step = 1e-3
                shapes = [shape_functions(place + step * way, points.shape[1]) for way in np.eye(3)]
                behind = [shape_functions(place - step * way, points.shape[1]) for way in np.eye(3)]
                tangents = [
                    np.einsum("k,ekj->ej", (a - b) / (2 * step), points) for a, b in zip(shapes, behind, strict=True)
                ]
                determinant = np.einsum("ej,ej->e", np.cross(tangents[0], tangents[1]), tangents[2])
                centre = np.einsum("k,ekj->ej", shape_functions(place, points.shape[1]), points)
                total += Moments.of(centre, wx * wy * wz * determinant)
    return total


def shape_functions(place: Array, count: int) -> Array:
    """Shape functions of 8 or 20 nodes (serendipity), from their definition."""
    corners = 0.125 * np.prod(1.0 + CORNER_PLACES * place, axis=1)
    if count == 8:
        return corners
    sums = CORNER_PLACES @ place - 2.0
    along = MIDDLE_PLACES == 0.0
    middles = 0.25 * np.prod(np.where(along, 1.0 - place**2, 1.0 + MIDDLE_PLACES * place), axis=1)
    return np.concatenate((corners * sums, middles))


@pytest.mark.parametrize("name", ["pinion", "gear"])
@pytest.mark.sweep_cases("gear")
def test_the_volume_becomes_that_of_the_turned_gear(name: str) -> None:
    """Chords for arcs: the error falls with the square of the cells' size."""
    member = wheels().members[name]
    errors = [
        volumes((mesh := mesh_of(member, cells=Cells(3 * k, 5 * k, 2, 1, 5 * k))).nodes, mesh.elements).sum()
        / turned_volume(member)
        - 1.0
        for k in (1, 2)
    ]
    assert abs(errors[1]) < 1e-3
    assert abs(errors[1]) < 0.35 * abs(errors[0])


@pytest.mark.sweep
def test_bevel_bodies_go_onto_rings() -> None:
    """A steep rim and end faces on cones, with a recess and a hub."""
    gears = built(
        {
            "kind": "spiral_bevel",
            "module": 4,
            "pinion": {"teeth": 14, "toe_shaft": {"diameters": [10], "lengths": [12]}},
            "gear": {"teeth": 43, "web": {"thickness": 8}, "hub": {"diameter": 50, "length": 6}},
        }
    )
    for member in gears.members.values():
        mesh = mesh_of(member)
        assert scaled_jacobian(mesh.nodes, mesh.elements[mesh.element_sets["body"]]).min() > 0.3
        assert volumes(mesh.nodes, mesh.elements).sum() == pytest.approx(turned_volume(member), rel=0.02)


@needs_ccx
def test_a_web_twists_as_by_the_closed_form() -> None:
    """Shear of a disc: d(u_theta / r)/dr = T / (2 pi G t r^3); one pitch with cyclic symmetry, held at the bore."""
    fe = {"body": "whole", "body_size": 1.2, "flank": 2, "fillet": 3, "thickness": 2, "rim_layers": 1, "face": 6}
    gears = built({"kind": "cylindrical", "module": 2, "helix_angle": 15, "fe": fe, "gear": WEB})
    problem = gears.finite_elements(sector=1)
    assert problem.warnings == ()
    mesh, moment = problem.mesh, 40_000.0
    nodes = mesh.node_sets["gear_land"]
    x, y = mesh.nodes[nodes, :2].T
    arm = np.hypot(x, y)
    forces = np.stack((-y, x, 0.0 * x), axis=-1) / arm[:, None] * (moment / WEB["teeth"] / len(nodes) / arm)[:, None]
    solution = ccx.solve(replace(problem._model, forces=(NodeForces(nodes, forces),)))
    twist = _twist(mesh.nodes, solution.displacement)
    rho = np.hypot(mesh.nodes[:, 0], mesh.nodes[:, 1])
    # off the ends of the web by its thickness
    web = (np.abs(mesh.nodes[:, 2]) < 1e-9) & (rho > 17.0) & (rho < 21.0)
    assert np.unique(rho[web].round(6)).size > 2
    slope, _ = np.polyfit(-1.0 / rho[web] ** 2, twist[web], 1)
    shear = 206000.0 / 2.6
    assert slope == pytest.approx(moment / (4.0 * np.pi * shear * 4.0), rel=0.01)
    held = np.isin(np.arange(len(rho)), mesh.node_sets["gear_bore"])
    assert np.abs(solution.displacement[held]).max() < 1e-12


def _twist(nodes: Array, moved: Array) -> Array:
    """Rotation (N,) about z, rad, of nodes."""
    return (nodes[:, 0] * moved[:, 1] - nodes[:, 1] * moved[:, 0]) / (nodes[:, 0] ** 2 + nodes[:, 1] ** 2)


def test_members_without_rings_are_refused_and_omitted_parts_reported(tmp_path: Path) -> None:
    gears = built(
        {
            "kind": "cylindrical",
            "module": 2,
            "fe": {"body": "whole", "teeth": 1, "flank": 2, "fillet": 3, "thickness": 2, "rim_layers": 1, "face": 2},
            "gear": {
                "teeth": 20,
                "face_width": 12,
                "bore": 12,
                "keyway": {},
                "hub": {"diameter": 24, "length": 4},
                "end_rounding_toe": 0.3,
            },
        }
    )
    elements = gears.finite_elements()
    left = (
        "the finite-element model has none of: keyway (gear), ends of the face within chamfers or roundings (gear); "
        "with all teeth it has those that are cut along the axis"
    )
    assert elements.warnings[0] == left
    # the deck says so, too
    elements.save(tmp_path / "gear.inp")
    head = (tmp_path / "gear.inp").read_text(encoding="utf-8").partition("*NODE")[0].splitlines()
    assert " ".join(line.removeprefix("** ") for line in head[3:]) == left
    rack = {
        "kind": "rack",
        "module": 2,
        "fe": {"body": "whole"},
        "pinion": {"teeth": 20, "face_width": 10},
        "rack": {"teeth": 6, "face_width": 10},
    }
    with pytest.raises(DesignError, match=r"body = whole: hexahedra of the rack end with its rim, .* allowed is .rim"):
        built(rack).finite_elements(members=("rack",))


def test_a_plastic_gear_without_density_is_named(tmp_path: Path) -> None:
    plastic = {"teeth": 20, "face_width": 6, "bore": 12, "material": {"youngs_modulus": 3000}}
    fe = {"teeth": 1, "flank": 2, "fillet": 3, "thickness": 2, "rim_layers": 1, "face": 2}
    design = {"kind": "cylindrical", "module": 2, "fe": fe, "gear": plastic}
    elements = built(design).finite_elements()
    told = "without material.density the density is 7850 kg/m^3, as of steel (gear); "
    assert [line for line in elements.warnings if line.startswith(told)]
    # the head of the deck, in lines of its own width
    head = elements.save(tmp_path / "gear.inp").read_text(encoding="utf-8").partition("*NODE")[0]
    assert told in " ".join(line.removeprefix("** ") for line in head.splitlines())
    assert built({**design, "material": {"density": 1140}}).finite_elements().warnings == ()
    assert (
        built({**design, "gear": plastic | {"material": {"youngs_modulus": 210000}}}).finite_elements().warnings == ()
    )


def test_broken_tips_of_threads_are_left_out_and_named() -> None:
    """The wheel's elements have its own."""
    members = built_sample("worm_drive", "worm.tip_rounding=0.3", "wheel.tip_rounding=0.2").members
    left = "the finite-element model has none of: chamfer or rounding of the tip (worm)"
    assert omissions([members["worm"], members["wheel"]], whole=False) == [left]


@pytest.mark.sweep
def test_the_head_of_a_deck_says_that_bodies_are_rims_alone(tmp_path: Path) -> None:
    """The rim of a thin ring goes on to the bore, and nothing is left out; a bar lacks its back and its broken end edges."""
    bar = {"kind": "rack", "module": 2, "rack": {"teeth": 7, "face_width": 10, "height": 30, "end_chamfer": 0.4}}
    for gears, heads in (
        (gm.gear(20, module=2), ["(gear)"]),
        (gm.gear(20, module=2, bore=30), []),
        (gm.build(gm.parse(bar)), ["(rack)"]),
    ):
        model = gears.finite_elements()
        for file, body in (("deck.inp", "*NODE"), ("mesh.msh", "$PhysicalNames"), ("mesh.vtu", "<VTKFile")):
            text = model.save(tmp_path / file).read_text(errors="replace").partition(body)[0]
            head = " ".join(line.lstrip("* ") for line in text.splitlines())
            beyond = "of the bodies the model has rims alone, without what is beyond them "
            assert [f"({part.partition(')')[0]})" for part in head.split(f"{beyond}(")[1:]] == heads
            assert ("ends of the face within chamfers or roundings (rack)" in head) == (heads == ["(rack)"])
