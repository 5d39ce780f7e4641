"""Solids of modified gears: within the tolerance and closed, corners on lines of the grids, valid in CAD, hexahedra sound."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from oracles.built import pair_of

from gearmesh import Member, parse
from gearmesh.cad.brep import exact_volume, spline_tooth
from gearmesh.cad.solid_part import solid_part
from gearmesh.cad.volume import volume
from gearmesh.check.deviation import deviations
from gearmesh.design.modifications import Modifications, Modified
from gearmesh.kinds import Region, Side
from gearmesh.mesh.hexahedra.hex_quality import volumes
from gearmesh.mesh.hexahedra.hexahedra import Cells, hex_mesh, plain_grid
from gearmesh.mesh.solid import gear_solid, prove
from gearmesh.mesh.tessellate import tessellate
from gearmesh.systems.common.micro_geometry import with_modifications
from gearmesh.teeth.micro_geometry.modified import TrueInvolute
from gearmesh.teeth.micro_geometry.screw_involute import ScrewInvolute

FIELDS: dict[str, Any] = {
    "tip_relief": {"amount": "20um", "start_roll_length": 13.0},
    "root_relief": {"amount": "10um", "start_roll_length": 7.0, "shape": "parabolic"},
    "helix_crowning": "8um",
    "profile_slope": "-5um",
    "profile_twist": "6um",
    "end_relief_toe": {"amount": "15um", "length": 3},
    "end_relief_heel": {"amount": "15um", "length": 4, "shape": "circular"},
}


def modified(helix: float, **changes: Any) -> Member:
    fields = FIELDS | ({"triangular_end_relief_tip": {"amount": "12um", "length": 6}} if helix else {})
    common = {"face_width": 24, "helix_angle": helix}
    design = {
        "kind": "beveloid",
        "module": 3,
        "pinion": {
            "teeth": 22,
            **common,
            "modifications": fields,
            "modifications_left": {"profile_crowning": "9um"},
            **changes,
        },
        "gear": {"teeth": 40, **common, "helix_angle": -helix},
    }
    return pair_of(parse(design)).pinion


@pytest.mark.sweep
@pytest.mark.sweep_cases("0.0-changes1-0.0005", "18.0-changes0-0.0005")
@pytest.mark.parametrize("tolerance", [5e-3, 5e-4])
@pytest.mark.parametrize(("helix", "changes"), [(18.0, {}), (0.0, {"tip_chamfer": 0.2})])
def test_within_tolerance_and_closed_with_lines_on_the_corners(helix: float, changes: Any, tolerance: float) -> None:
    member = modified(helix, **changes)
    mesh = tessellate(member.tooth, tolerance)
    assert mesh.deviation <= tolerance
    assert max(each.largest for each in deviations(mesh).values()) <= tolerance
    assert prove(gear_solid(member, tolerance, mesh), 1).ok
    for patch in mesh.patches:
        t = np.sort(patch.nodes.t[patch.triangles], axis=1)
        for place in member.tooth.face_breaks:
            assert not ((t[:, 0] < place) & (t[:, 2] > place)).any()
        if patch.region.is_flank:
            assert patch.nodes.parameters is not None
            length = np.sort(patch.nodes.parameters[patch.triangles][..., 0], axis=1)
            for corner in (7.0, 13.0):
                assert not ((length[:, 0] < corner - 1e-9) & (length[:, 2] > corner + 1e-9)).any()


@pytest.mark.sweep
@pytest.mark.sweep_cases("15.0")
@pytest.mark.parametrize("helix", [0.0, 15.0])
def test_internal_gears_by_a_shaper(helix: float) -> None:
    """Their tips are nearer to the base circle; the fillets, of another tool, turn with them, and the ring loses material."""
    design = {"kind": "cylindrical", "module": 2, "helix_angle": helix, "pinion": {"teeth": 20, "face_width": 20}}
    ring = pair_of(parse({**design, "gear": {"teeth": 60, "face_width": 20, "internal": True}})).gear
    extent = TrueInvolute.of(ring.tooth, Side.RIGHT, internal=True).extent
    assert extent.tip < extent.root
    start = extent.tip + 0.35 * (extent.root - extent.tip)
    fields = Modifications.model_validate(
        {
            "tip_relief": {"amount": 0.02, "start_roll_length": start},
            "helix_crowning": 0.01,
            "end_relief_heel": {"amount": 0.01, "length": 4},
        }
    )
    made = with_modifications(ring, Modified(modifications=fields), internal=True)
    mesh = tessellate(made.tooth, 1e-3)
    assert max(each.largest for each in deviations(mesh).values()) <= 1e-3
    assert -200.0 < made.tooth.volume() - ring.tooth.volume() < -20.0
    flank = made.tooth.right.flank
    assert isinstance(flank, ScrewInvolute)
    assert flank.amount is not None
    tip = flank.amount.jet(np.array([extent.tip]), np.zeros(1)).a
    assert tip == pytest.approx(0.02, abs=1e-14)
    # the point of the same circle has gone into the material, towards the middle of the tooth
    before, after = (
        np.arctan2(*side.jet(np.array([extent.tip]), np.zeros(1)).r[0, 1::-1]) for side in (ring_flank(ring), flank)
    )
    assert flank.base_radius * (after - before) == pytest.approx(0.02, abs=1e-9)


def ring_flank(ring: Member) -> ScrewInvolute:
    return TrueInvolute.of(ring.tooth, Side.RIGHT, internal=True).involute


def test_flank_and_fillet_share_their_form_point_and_the_root_stays() -> None:
    tooth = modified(18.0).tooth
    sections = tooth.sections(np.linspace(0.0, 1.0, 7))
    for regions in (tooth.regions, tooth.regions[1:] + tooth.regions[:1]):
        for first, second in pairwise(regions):
            here, there = tooth.grid(first, [1.0], sections).points, tooth.grid(second, [0.0], sections).points
            if (first, second) == (Region.FILLET_LEFT, Region.ROOT):
                assert np.hypot(*here[0].T[:2]) == pytest.approx(np.hypot(*there[0].T[:2]), abs=1e-11)
            else:
                np.testing.assert_allclose(here, there, atol=1e-11)


def test_volume_is_less_by_what_is_removed() -> None:
    """The amounts over the flank, times the height of its points over the base circle, to first order; fillets turned with it."""
    member = modified(18.0)
    tooth = member.tooth
    assert tooth.volume(24) == pytest.approx(tooth.volume(64), abs=2e-2)
    removed, nodes = 0.0, np.polynomial.legendre.leggauss(200)
    for side in Side:
        flank = tooth.side(side).flank
        assert isinstance(flank, ScrewInvolute)
        assert flank.amount is not None
        low, high = tooth.side(side).form_point[0], float(tooth.sections([0.5]).of(side).tip[0])
        length, z = low + 0.5 * (high - low) * (nodes[0] + 1.0), 12.0 * nodes[0]
        a = flank.amount.jet(*np.meshgrid(length, z, indexing="ij")).a
        # arcs a r / r_b between radii, r dr = L dL
        removed += float((0.5 * (high - low) * nodes[1] * length / flank.base_radius) @ a @ (12.0 * nodes[1]))
        below = flank.amount.jet(np.full_like(z, low), z).a @ (12.0 * nodes[1]) / flank.base_radius
        root, form_point = tooth.blank.root.radius, np.hypot(flank.base_radius, low)
        removed += float(below) * 0.5 * (form_point**2 - root**2)
    assert tooth.unmodified_tooth.volume() - tooth.volume() == pytest.approx(tooth.teeth * removed, rel=2e-3)


@pytest.mark.sweep
def test_step_has_its_faces_end_at_the_corners() -> None:
    pytest.importorskip("OCP")
    member = modified(18.0)
    teeth = spline_tooth(member.tooth, 1e-4)
    assert [piece.region for piece in teeth.links].count(Region.FLANK_RIGHT) == 3
    assert len(teeth.bounds) == 4
    assert max(max(patch.control.shape[:2]) for each in teeth.patches.values() for patch in each) < 30
    part = solid_part(member, teeth)
    assert volume(part) == pytest.approx(exact_volume(member), rel=1e-6)


@pytest.mark.parametrize("second_order", [False, True])
@pytest.mark.sweep_cases("True")
def test_hexahedra_have_lines_on_the_corners(second_order: bool) -> None:
    tooth = modified(18.0).tooth
    mesh = hex_mesh(tooth, np.array([0, 1]), plain_grid(Cells()), second_order=second_order)
    assert volumes(mesh.nodes, mesh.elements).min() > 0.0
    for side in Side:
        flank = tooth.side(side).flank
        assert isinstance(flank, ScrewInvolute)
        r = mesh.nodes[mesh.node_sets[f"flank_{side}_1"]]
        radius = np.hypot(r[:, 0], r[:, 1])
        for corner in (7.0, 13.0):
            assert (np.abs(radius - np.hypot(flank.base_radius, corner)) < 1e-9).sum() >= len(
                np.unique(r[:, 2].round(6))
            )
        for place in tooth.face_breaks:
            assert (np.abs(r[:, 2] - (-12.0 + 24.0 * place)) < 1e-9).any()
