"""A rack and its pinion: planes and fillets as ISO 53 draws them, contact against what ISO 21771 says in closed form."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import gearmesh as gm
from gearmesh import DesignError, GearPair, Rigid
from gearmesh.check.deviation import deviations
from gearmesh.check.roll import roll
from gearmesh.contact.engagement.cycle import mesh_cycle
from gearmesh.contact.engagement.engagement import whole_engagement
from gearmesh.contact.fit.fit import fit
from gearmesh.contact.flanks import analyse, solver_pair
from gearmesh.kinds import Mount, Side
from gearmesh.mesh.solid import gear_solid, prove, teeth_mesh
from gearmesh.mesh.tessellate import tessellate
from gearmesh.systems.cylindrical.geometry.proportions import proportions
from gearmesh.systems.cylindrical.rack.member import RackMesh, RackProportions, rack_member, rack_mount, rack_pair
from gearmesh.systems.system import complete_design
from gearmesh.teeth.region import FLANK_REGIONS

#: helix angle (deg), hand and profile shift of the pinion; working flank; how far (mm) the rack stands off; the rack itself
CASES: dict[str, Any] = {
    "spur": (0, "right", 0.3, "right", 0.02, {}),
    "right": (20, "right", 0.1, "right", 0.02, {"allowance": -0.05}),
    "left_back": (15, "left", 0.2, "left", 0.0, {"allowance": -0.1, "addendum": 0.9, "face_width": 12.0}),
    "steep": (35, "right", 0.0, "left", 0.1, {"addendum": 0.8, "tool_tip_radius": 0.2}),
}


def pair_of(case: str) -> tuple[RackMesh, GearPair]:
    """A pinion of 20 teeth, module 2 mm, and 20 mm width, and its rack."""
    helix, hand, shift, flank, off, keys = CASES[case]
    pinion = {"teeth": 20, "face_width": 20, "profile_shift": shift, "tip_alteration": 0}
    gear = {"teeth": 45, "face_width": 20}
    design = complete_design(
        gm.parse(
            {"kind": "cylindrical", "module": 2, "helix_angle": helix, "hand": hand, "pinion": pinion, "gear": gear}
        )
    )
    found = proportions(design)
    own = found.mesh.pinion
    spec = RackProportions(**{"teeth": 12, "face_width": 20.0, "height": 12.0, **keys})
    mesh = RackMesh(own, spec, found.tips[0], own.radius + own.shift * own.module + off)
    first = replace(gm.build(design).members["pinion"], mount=Mount(Rigid.identity(), sign=-1.0))
    rack = replace(rack_member("rack", spec, own), mount=rack_mount(own, mesh.distance, Side(flank)))
    return mesh, rack_pair(first, rack, Side(flank), 0.006)


@pytest.fixture(params=CASES, scope="module")
def pair(request: pytest.FixtureRequest) -> tuple[RackMesh, GearPair]:
    return pair_of(request.param)


def test_teeth_are_those_of_the_basic_rack(pair: tuple[RackMesh, GearPair]) -> None:
    mesh, rack = pair[0], pair[1].gear
    spec, m, beta = mesh.rack, mesh.pinion.module, mesh.pinion.beta
    for side in Side:
        grid = rack.tooth.flank_grid(side, np.linspace(0.0, 1.0, 7), np.linspace(0.0, 1.0, 5)).points
        x, y, z = np.moveaxis(grid, -1, 0)
        half = 0.5 * (0.5 * math.pi * m + spec.allowance) - x * math.tan(mesh.pinion.alpha)
        # traces run against those of the pinion's helix, as seen from outside
        assert -side.sign * (y + z * math.tan(beta)) * math.cos(beta) == pytest.approx(half, abs=1e-12)
        assert x[-1] == pytest.approx(spec.addendum * m, abs=1e-12)
        fillet = rack.tooth.chain[f"fillet_{side}"].grid(np.linspace(0.0, 1.0, 9), rack.tooth.even).points  # type: ignore[index]
        normal = np.stack(
            (fillet[..., 0], (fillet[..., 1] + fillet[..., 2] * math.tan(beta)) * math.cos(beta)), axis=-1
        )
        flat = normal.reshape(-1, 2)
        radius = spec.tool_tip_radius * m
        # centre a radius above the root
        centre_x = -spec.dedendum * m + radius
        reach = np.sqrt(radius**2 - (flat[:, 0] - centre_x) ** 2)
        centre_y = flat[:, 1] - side.sign * reach
        assert np.ptp(centre_y) < 1e-7
        assert flat[:, 0].min() == pytest.approx(-spec.dedendum * m, abs=1e-12)


@pytest.mark.sweep_cases("left_back", "right", "spur")
def test_contact_is_that_of_the_closed_form(pair: tuple[RackMesh, GearPair]) -> None:
    mesh, gears = pair
    solver = solver_pair(gears)
    followed = whole_engagement(solver, gears.pitch)
    assert followed is not None
    cycle = mesh_cycle(solver, gears.pitch, followed)
    assert cycle is not None
    radius = mesh.pinion.radius
    assert cycle.transverse_ratio == pytest.approx(mesh.transverse_contact_ratio, abs=1e-9)
    assert cycle.overlap_ratio == pytest.approx(mesh.overlap_ratio, abs=1e-9)
    assert radius * cycle.peak_to_peak < 1e-9
    # the rack lags by half of the play, neither more nor by a pitch
    lines = followed.contacts.line
    play = mesh.circumferential_backlash
    error = radius * (followed.contacts.x[lines, 4] - followed.phi1[lines])
    assert lines.sum() > 10
    assert error == pytest.approx(-0.5 * gears.drive * play, abs=1e-9)
    assert cycle.curve is not None
    found = fit(gears, cycle.curve)
    assert found is not None
    assert not found.interference
    assert found.pitch_radius == pytest.approx(radius, abs=1e-12)
    for values, exact in (
        (found.transverse_backlash, play),
        (found.normal_backlash, play * math.cos(mesh.pinion.alpha_t) * math.cos(mesh.pinion.beta_b)),
    ):
        assert values == pytest.approx((exact, exact), abs=1e-9)
    over_rack = found.clearances[0]
    assert over_rack is not None
    assert over_rack.distance == pytest.approx(mesh.root_clearance, abs=1e-6)


def test_a_fillet_without_room_is_refused() -> None:
    mesh, _ = pair_of("spur")
    with pytest.raises(DesignError, match=r"rack.tool_tip_radius = 0.6: .* allowed is at most 0.47"):
        rack_member("rack", replace(mesh.rack, tool_tip_radius=0.6), mesh.pinion)


def test_solids_are_whole_and_within_tolerance(pair: tuple[RackMesh, GearPair]) -> None:
    rack, tolerance = pair[1].gear, 0.004
    tooth_mesh = tessellate(rack.tooth, tolerance)
    mesh = gear_solid(rack, tolerance, tooth_mesh)
    assert prove(mesh, rack.genus).ok
    assert tooth_mesh.deviation <= tolerance
    assert (
        max(max(found.facets_to_surface, found.surface_to_facets) for found in deviations(tooth_mesh).values())
        <= tolerance
    )
    spec, pitch = pair[0].rack, pair[0].pinion.transverse_module * math.pi
    # a parallelogram as many pitches long as there are teeth
    assert mesh.volume() == pytest.approx(rack.tooth.volume(), rel=1e-4)
    back = mesh.vertices[mesh.vertices[:, 0] == spec.addendum * pair[0].pinion.module - spec.height]
    assert len(back) == 4
    for end in (-0.5, 0.5):
        y = back[back[:, 2] == end * spec.face_width, 1]
        assert np.ptp(y) == pytest.approx(spec.teeth * pitch, abs=1e-9)
    names = np.array(mesh.region_names)[mesh.regions]
    assert set(names) == set(mesh.region_names)
    a, b, c = (mesh.vertices[mesh.triangles[:, k]] for k in range(3))
    area = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    assert area[names == "back"].sum() == pytest.approx(spec.teeth * pitch * spec.face_width, rel=1e-12)


def test_the_volume_is_that_of_the_drawn_section(pair: tuple[RackMesh, GearPair]) -> None:
    mesh, rack = pair[0], pair[1].gear
    spec, m, alpha = mesh.rack, mesh.pinion.module, mesh.pinion.alpha
    high, low, radius = spec.addendum * m, spec.dedendum * m, spec.tool_tip_radius * m
    half = 0.5 * (0.5 * math.pi * m + spec.allowance)
    trapezium = 2.0 * half * (high + low) - math.tan(alpha) * (high**2 - low**2)
    # between a circle and two of its tangents, either side
    turn = 0.5 * math.pi - alpha
    corners = 2.0 * radius**2 * (math.tan(0.5 * turn) - 0.5 * turn)
    bar = math.pi * m * (spec.height - high - low)
    exact = spec.teeth * spec.face_width / math.cos(mesh.pinion.beta) * (trapezium + corners + bar)
    assert rack.tooth.volume() == pytest.approx(exact, rel=1e-12)


def test_a_bar_that_ends_above_the_root_is_refused() -> None:
    mesh, _ = pair_of("spur")
    with pytest.raises(
        DesignError,
        match=r"rack.height = 4 mm: the root lies below the back of the bar; allowed is more than the teeth's, 4.5",
    ):
        rack_member("rack", replace(mesh.rack, height=4.0), mesh.pinion)


@pytest.mark.sweep
@pytest.mark.sweep_cases("left_back", "right", "steep")
def test_rolled_grids_touch_where_the_solver_says(pair: tuple[RackMesh, GearPair]) -> None:
    gears = pair[1]
    phi1 = np.array([-0.1, 0.0, 0.12])
    cells = np.linspace(0.0, 1.0, 41)
    grids = [
        member.tooth.flank_grid(side, cells, cells).points
        for member, side in zip(gears.both, gears.flanks, strict=True)
    ]
    rolled = roll(grids[0], grids[1], gears.mounts, gears.ratio, phi1, gears.drive)
    found = analyse(gears, phi1)
    assert (found.kind == "line").all()
    apart = pair[0].pinion.radius * (np.array([each.phi2 for each in rolled]) - found.phi2)
    # cubic patches through exact points
    assert np.abs(apart).max() < 1e-7


def test_rolled_facets_touch_within_their_tolerance() -> None:
    gears, tolerance = pair_of("right")[1], 0.001
    meshes = [
        teeth_mesh(
            tessellate(member.tooth, tolerance, (FLANK_REGIONS[side],)), member.name, np.zeros(1, dtype=np.int64)
        )
        for member, side in zip(gears.both, gears.flanks, strict=True)
    ]
    phi1 = np.array([0.05])
    (rolled,) = roll(meshes[0], meshes[1], gears.mounts, gears.ratio, phi1, gears.drive)
    apart = (rolled.phi2 - analyse(gears, phi1).phi2[0]) * np.linalg.norm(gears.gear.mount.velocity(np.zeros(3)))
    # the facets of the pinion lie below its flank; the rack's are its planes
    assert abs(apart) < 1.2 * tolerance
