"""Hexahedra of teeth: conforming, right-handed, on the exact surfaces, fine where the contact is."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from oracles.built import model_of, pair_of
from oracles.examples import some
from oracles.places import SAMPLES
from scipy.interpolate import griddata

import gearmesh as gm
from gearmesh import DesignError, GearPair, Member, Rigid, load
from gearmesh.check.roll import roll
from gearmesh.contact.flanks import analyse
from gearmesh.fe.gear_model import Request, gear_model, grid_of, member_mesh
from gearmesh.fe.placing import focus_on, major_axis, minor_axis, place
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.nearest import nearest
from gearmesh.kinds import Region, Tooth
from gearmesh.mesh.hexahedra.grading import Spacing
from gearmesh.mesh.hexahedra.hex_quality import CHUNK_ELEMENTS, CORNER_PLACES, scaled_jacobian, volumes
from gearmesh.mesh.hexahedra.hexahedra import Cells, hex_mesh, plain_grid, rim_of
from gearmesh.mesh.hexahedra.hexes import HEX_EDGES, HEX_FACES, HexMesh, join
from gearmesh.mesh.hexahedra.layers import layers
from gearmesh.mesh.triangles import TriangleMesh

NAMES = sorted(path.stem for path in SAMPLES.glob("*.toml"))
COARSE = Cells(flank=5, fillet=4, thickness=2, rim=2, face=7)
SHAPES = {
    "plain": [],
    "even": ["fe.spacing=even"],
    "focused": ["fe.ellipse=4"],
    "second_order": ["fe.order=2", "fe.flank=6", "fe.face=10"],
}


def pair(sample: str, *overrides: str) -> GearPair:
    return pair_of(load(SAMPLES / f"{sample}.toml", list(overrides)))


def mesh_of(member: Member, teeth: int = 3, cells: Cells = COARSE, rim: float | None = None, order: int = 1) -> HexMesh:
    places = np.arange(teeth) - (teeth - 1) // 2
    return hex_mesh(member.tooth, places, plain_grid(cells), rim, second_order=order == 2)


def off_surface(tooth: Tooth, region: Region, points: Array) -> Array:
    """Distance (K,), mm, of points next to a flank or fillet from its whole exact surface."""
    grid = tooth.grid(region, np.linspace(0.0, 1.0, 41), tooth.sections(np.linspace(0.0, 1.0, 41)))
    assert grid.p is not None
    assert grid.v is not None
    apart = np.linalg.norm(points[:, None] - grid.points.reshape(-1, 3), axis=-1)
    start = apart.argmin(axis=1)
    surface = tooth.chain[region].surface
    assert surface is not None
    return np.linalg.norm(
        points - nearest(surface, points, grid.p.ravel()[start], grid.v.ravel()[start]).jet.r, axis=-1
    )


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize(
    ("sample", "member", "cells", "least"),
    [
        (["cycloidal"], "disc", Cells(face=2), 0.45),
        (["cycloidal"], "ring", Cells(face=2), 0.45),
        (["cycloidal"], "disc", Cells(face=2, flank=40, thickness=9), 0.45),
        (["spur", "pinion.tip_rounding=0.4"], "pinion", Cells(face=2), 0.5),
    ],
)
@pytest.mark.sweep_cases(
    "sample0-disc-cells0-0.45-1",
    "sample0-disc-cells0-0.45-2",
    "sample1-ring-cells1-0.45-2",
    "sample2-disc-cells2-0.45-1",
    "sample2-disc-cells2-0.45-2",
    "sample3-pinion-cells3-0.5-2",
)
def test_no_corner_of_a_block_lies_on_a_smooth_outline(
    sample: list[str], member: str, cells: Cells, least: float, order: int
) -> None:
    """Lobes, pins and rounded tips: corners between flank and land were flat, 0.027 on the disc, 0.10 on the ring."""
    members = {each.name: each for each in pair(*sample).both}
    mesh = mesh_of(members[member], 1, cells, order=order)
    assert scaled_jacobian(mesh.nodes, mesh.elements).min() > least


#: one of every way that teeth are made; the other samples differ where the contact lies, not in what is even or of second order
ONE_OF_A_KIND = (
    *("beveloid_crossed", "circular_arc", "face_gear"),
    *("novikov", "spiral_bevel_abdullah_curved", "spiral_bevel_geometry1"),
)


@pytest.mark.sweep_cases(
    "novikov-focused",
    "zerol-plain",
    "beveloid_crossed-plain",
    "circular_arc-plain",
    "beveloid_crossed-second_order",
    "face_gear-focused",
    "spur-plain",
)
@pytest.mark.parametrize(
    ("sample", "shape"),
    some(
        [
            *((sample, shape) for sample in (*ONE_OF_A_KIND[:5], "spur", "zerol") for shape in ("plain", "focused")),
            *((sample, shape) for sample in ONE_OF_A_KIND[:2] for shape in ("even", "second_order")),
        ],
        8,
    ),
)
def test_every_element_is_well_shaped(sample: str, shape: str) -> None:
    built = model_of(load(SAMPLES / f"{sample}.toml", SHAPES[shape]))
    mesh = built.mesh
    assert volumes(mesh.nodes, mesh.elements).min() > 0.0
    quality = scaled_jacobian(mesh.nodes, mesh.elements).min()
    assert quality > 0.2
    assert built.figures["min_scaled_jacobian"] == quality
    if mesh.second_order:
        # curved elements are as good as those between their corners: no mid-side node lies near a quarter of its edge
        assert quality > 0.95 * scaled_jacobian(mesh.nodes, mesh.elements[:, :8]).min()


def test_lines_of_a_narrow_space_turn_over_its_sharp_fillet() -> None:
    """A spline hub: wide teeth, and a fillet as large as one element between root land and flank."""
    design = load(SAMPLES / "spline.toml", ["fe.face=4", "fe.flank=6"])
    built = gm.build(design).finite_elements(members=["hub"])
    assert built.figures["min_scaled_jacobian"] > 0.4


@pytest.mark.sweep
def test_fine_lines_near_an_edge_leave_the_others_in_place() -> None:
    """The line of contact of this conical pair runs out over the tip."""
    gears = gm.build(load(SAMPLES / "beveloid_parallel.toml", ["fe.ellipse=8", "fe.teeth=1"]))
    built = gears.finite_elements(phi1=6.0)
    assert built.figures["min_scaled_jacobian"] > 0.2
    focus = focus_on("pinion", built._built.at)
    assert focus.s + focus.slope * (0.0 - focus.t) > 1.0


@pytest.mark.sweep
def test_of_pairs_that_are_ahead_alike_the_one_asked_for_leads() -> None:
    """Conjugate gears: all pairs in mesh are ahead alike, to rounding."""
    for sample in ("beveloid_parallel", "face_gear_conjugate"):
        assert (
            model_of(load(SAMPLES / f"{sample}.toml", ["fe.teeth=1", "fe.flank=6", "fe.face=8"])).figures["phi1_deg"]
            == 0.0
        )


@pytest.mark.sweep
def test_default_model_is_the_size_of_the_published_one() -> None:
    """[LF04] 17.10: three pairs of teeth, 71,460 elements with 87,360 nodes."""
    built = model_of(load(SAMPLES / "spiral_bevel_basic.toml", []))
    mesh = built.mesh
    assert len(mesh.elements) == pytest.approx(71_460, rel=0.02)
    assert len(mesh.nodes) == pytest.approx(87_360, rel=0.02)
    # and follows the ellipse: enough for its pressure, where even spacing has less than one element
    over = [n for each in built.measured.resolution.over.values() for n in (each.across, each.along)]
    assert min(over) > 4.0
    assert built.warnings == ()


@pytest.mark.quick
def test_spacing_uses_all_the_cells_there_are() -> None:
    """Fine in the window, never finer elsewhere, and even where the window is all there is."""
    for width, count, focus in ((0.03, 24, 0.6), (0.2, 10, 0.0), (0.6, 12, 0.5)):
        spacing = Spacing.of(width, count, focus, 0.4)
        nodes = spacing.nodes(count, focus)
        steps, middles = np.diff(nodes), 0.5 * (nodes[1:] + nodes[:-1])
        assert len(steps) == count
        inside = np.abs(middles - focus) < width - steps
        np.testing.assert_allclose(steps[inside], spacing.finest, rtol=0.02)
        assert steps.min() > 0.98 * spacing.finest
        # h grows by 0.4 per unit of distance: neighbours by 1.5 at most
        assert (np.abs(np.log(steps[1:] / steps[:-1])) < 0.41).all()
        assert (steps.max() > 2.0 * steps.min()) == (width < 0.5)


@pytest.mark.sweep_cases(
    "spiral_bevel_basic-1", "beveloid_parallel-1", "beveloid_parallel-2", "spiral_bevel_basic-2", "circular_arc-2"
)
@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("sample", ["beveloid_parallel", "circular_arc", "spiral_bevel_basic"])
def test_flank_nodes_lie_on_the_exact_surface(sample: str, order: int) -> None:
    """And those of the fillets, mid-side nodes too, of every tooth."""
    for member in pair(sample).members.values():
        mesh, tooth = mesh_of(member, order=order), member.tooth
        for k in range(3):
            back = Rigid.about_z((1.0 - k) * tooth.pitch_angle)
            for region in ("flank_right", "flank_left"):
                points = back.point(mesh.nodes[mesh.face_nodes(f"{region}_{k + 1}")])
                assert off_surface(tooth, region, points).max() < 1e-9
            # cells at the end of a fillet whose root land changes its width reach over to the land
            points = back.point(mesh.nodes[mesh.face_nodes(f"fillet_right_{k + 1}")])
            on_land = np.abs(tooth.blank.root.value(points)) < 1e-9
            assert off_surface(tooth, "fillet_right", points[~on_land]).max() < 1e-9
        assert np.abs(tooth.blank.root.value(mesh.nodes[mesh.face_nodes("root")])).min() < 1e-9
        assert np.abs(tooth.blank.tip.value(mesh.nodes[mesh.face_nodes("land")])).max() < 1e-9


@pytest.mark.parametrize(
    ("sample", "teeth", "overrides"),
    [
        ("spur", 3, []),
        ("spur", 0, ["pinion.teeth=11", "assembly.center_distance=76.5"]),
        ("zerol", 1, []),
        ("spur", 3, ["pinion.tip_chamfer=0.3"]),
        ("spur", 3, ["pinion.tip_rounding=0.4"]),
        ("cycloidal", 3, []),
        ("cycloidal", 0, []),
    ],
)
def test_faces_are_shared_by_two_elements_or_in_one_set(sample: str, teeth: int, overrides: list[str]) -> None:
    member = pair(sample, *overrides).pinion
    teeth = teeth or member.tooth.teeth
    mesh = mesh_of(member, teeth)
    faces = np.sort(mesh.elements[:, np.array(HEX_FACES)], axis=-1).reshape(-1, 4)
    _, first, count = np.unique(faces, axis=0, return_index=True, return_counts=True)
    assert count.max() == 2
    outside = {(int(i) // 6, int(i) % 6) for i in first[count == 1]}
    named = [tuple(face) for name, each in mesh.face_sets.items() if name != "bore" for face in each.tolist()]
    assert len(named) == len(set(named))
    assert set(named) == outside
    assert ("cut_right" in mesh.face_sets) == (teeth < member.tooth.teeth)
    assert ("edge" in mesh.face_sets) == bool(overrides and "tip_" in overrides[0])
    for k in range(teeth):
        assert len(mesh.face_sets[f"flank_left_{k + 1}"]) == COARSE.flank * COARSE.face
    # outward: by the divergence theorem over the sets the volume is that of the elements
    corners = np.concatenate([mesh.face_corners(name) for name in mesh.face_sets if name != "bore"])
    a, b, c, d = np.moveaxis(mesh.nodes[corners], 1, 0)
    flux = dot(a, np.cross(b, c)) + dot(a, np.cross(c, d)) + dot(a, np.cross(b, d)) + dot(b, np.cross(c, d))
    assert flux.sum() / 12.0 == pytest.approx(volumes(mesh.nodes, mesh.elements).sum(), rel=1e-6)


def test_whole_ring_has_the_volume_of_the_gear() -> None:
    """With the rim down to the bore; the error falls with the square of the cells' size along flank and face."""
    member = pair("helical", "pinion.teeth=12", "pinion.bore=40").pinion
    rim = member.tooth.blank.root.radius - member.tooth.blank.body.bore_radius
    exact, errors = member.tooth.volume(), []
    for fine in (1, 2, 4):
        mesh = mesh_of(member, 12, Cells(4 * fine, 60, 2, 2, 4 * fine), rim)
        assert set(mesh.face_sets["bore"][:, 0]) == set(mesh.face_sets["rim"][:, 0])
        errors.append(volumes(mesh.nodes, mesh.elements).sum() - exact)
    orders = np.log2(np.abs(np.array(errors[:-1]) / errors[1:]))
    assert orders == pytest.approx([2.0, 2.0], abs=0.1)
    assert abs(errors[-1]) < 5e-4 * exact


@pytest.mark.quick
def test_outline_is_evenly_spaced_over_root_and_over_fillet() -> None:
    """At every station: arc lengths of the cells of either differ by what the root land's share is rounded to."""
    member = pair("spiral_bevel_geometry1").gear
    mesh = mesh_of(member, 1, Cells(flank=4, fillet=16, thickness=2, rim=2, face=5))
    on_root, on_fillet = (mesh.face_sets[name][:, 0] for name in ("root", "fillet_right_1"))
    corners = {
        face[0]: c
        for name in ("root", "fillet_right_1")
        for face, c in zip(mesh.face_sets[name].tolist(), mesh.face_corners(name), strict=True)
    }
    for elements in (on_root[: len(on_root) // 2], on_fillet):
        points = mesh.nodes[np.array([corners[e] for e in elements])].reshape(-1, 5, 4, 3)
        # corners 3 and 0 of a face are the first and second line s at its toe
        steps = np.linalg.norm(points[:, :, 3] - points[:, :, 0], axis=-1)
        assert len(steps) >= 3
        np.testing.assert_allclose(steps / steps.mean(axis=0), 1.0, rtol=0, atol=0.02)


def test_mid_side_nodes_are_in_the_middle() -> None:
    """Mid-side nodes are within a tenth of the edge from its middle, on curved flanks and on graded and slanted lines, too."""
    gears = pair("spiral_bevel_basic")
    request = Request(teeth=1, cells=COARSE, ellipse=3, torque=5e4, second_order=True)
    at = place(gears, 0.0, request.torque, request.materials)
    mesh = member_mesh("pinion", request, at)
    corners = mesh.nodes[mesh.elements[:, :8]][:, np.array(HEX_EDGES)]
    off = np.linalg.norm(mesh.nodes[mesh.elements[:, 8:]] - corners.mean(axis=2), axis=-1)
    assert (off / np.linalg.norm(corners[:, :, 0] - corners[:, :, 1], axis=-1)).max() < 0.1
    for name in mesh.face_sets:
        outline = mesh.face_outlines(name)
        np.testing.assert_array_equal(outline[:, ::2], mesh.face_corners(name))
        points = mesh.nodes[outline]
        ends = points[:, ::2], np.roll(points[:, ::2], -1, axis=1)
        away = np.linalg.norm(points[:, 1::2] - 0.5 * (ends[0] + ends[1]), axis=-1)
        assert (away / np.linalg.norm(ends[1] - ends[0], axis=-1)).max() < 0.1


def test_rim_has_the_thickness_asked_for_and_fits_the_body() -> None:
    member = pair("spiral_bevel_basic").gear
    tooth = member.tooth
    sections = layers(tooth, np.linspace(0.0, 1.0, 5))
    mesh = mesh_of(member, 1, rim=2.0)
    on_cut = [np.intersect1d(mesh.face_nodes("cut_right"), mesh.face_nodes(name)) for name in ("root", "rim")]
    chart = rim_of(sections, None)[0]
    heights = []
    for nodes in on_cut:
        points = mesh.nodes[nodes]
        points = points[np.argsort(tooth.blank.axial.value(points))]
        heights.append(chart.height(np.hypot(points[:, 0], points[:, 1]), points[:, 2]))
    np.testing.assert_allclose(heights[0] - heights[1], 2.0, rtol=0, atol=1e-9)
    # by default 1.2 whole depths; at the toe the body is thinner
    default = mesh_of(member, 1)
    points = default.nodes[default.face_nodes("rim")]
    stations = tooth.blank.axial.value(points)
    heights = chart.height(np.hypot(points[:, 0], points[:, 1]), points[:, 2])
    for (rho, z), end in zip(
        (tooth.blank.body.profile[0], tooth.blank.body.profile[-1]), (stations.min(), stations.max()), strict=True
    ):
        at_end = heights[np.abs(stations - end) < 1e-6]
        assert at_end.min() > chart.height(np.array(rho), np.array(z)) - 1e-9
    with pytest.raises(DesignError, match=r"rim = 500 mm: must be at most \d"):
        mesh_of(member, 1, rim=500.0)


@pytest.mark.sweep_cases("beveloid_crossed", "zerol")
@pytest.mark.parametrize("sample", ["beveloid_crossed", "spiral_bevel_basic", "zerol"])
def test_elements_asked_for_over_the_ellipse(sample: str) -> None:
    """Counted on the mesh: layers of flank nodes along both axes of the loaded ellipse."""
    gears = pair(sample)
    request = Request(teeth=1, ellipse=8, torque=5e4)
    at = place(gears, 0.0, request.torque, request.materials)
    built = gear_model(request, at)
    mesh = built.model.mesh
    for name, side in zip(("pinion", "gear"), gears.flanks, strict=True):
        grid = grid_of(name, request, at)
        focus = focus_on(name, at)
        corners = mesh.nodes[mesh.face_corners(f"{name}_flank_{side}_1")]
        from_centre = corners.mean(axis=1) - at.frame.point(at.path.point[0])
        x, y = (from_centre @ at.frame.vector(axis(at.path)) for axis in (major_axis, minor_axis))
        inside = (x / at.semi_major) ** 2 + (y / at.semi_minor) ** 2 < 1.0
        # as many faces as 8 by 8 over its half axes give, with a tenth for those on the rim and for the graded spacing
        assert np.count_nonzero(inside) == pytest.approx(np.pi * 8 * 8, rel=0.1)
        # and as deep there as an eighth of the smaller half axis
        element, face = mesh.face_sets[f"{name}_flank_{side}_1"][np.linalg.norm(from_centre, axis=-1).argmin()]
        corners8 = mesh.nodes[mesh.elements[element]]
        on_flank = np.isin(np.arange(8), HEX_FACES[face])
        depth = (corners8[on_flank].mean(axis=0) - corners8[~on_flank].mean(axis=0)) @ at.frame.vector(
            at.path.normal[0]
        )
        assert abs(depth) == pytest.approx(at.semi_minor / 8.0, rel=0.1)
        assert 0.0 < focus.s < 1.0
        assert grid.t[0] == 0.0
        assert grid.t[-1] == 1.0
        assert (np.diff(grid.t) > 0.0).all()
        assert (np.diff(grid.lines.flank, axis=0) > 0.0).all()


@pytest.mark.parametrize("flank", ["right", "left"])
@pytest.mark.parametrize("sample", ["beveloid_crossed", "spiral_bevel_basic"])
@pytest.mark.sweep_cases("beveloid_crossed-left", "beveloid_crossed-right", "spiral_bevel_basic-left")
def test_members_touch_and_the_torque_drives(sample: str, flank: str) -> None:
    key = "contact.flank" if sample.startswith("beveloid") else "contact.side"
    value = flank if sample.startswith("beveloid") else {"right": "pinion_convex", "left": "pinion_concave"}[flank]
    gears = pair(sample, f"{key}={value}")
    request = Request(teeth=3, cells=COARSE, ellipse=3, torque=5e4)
    at = place(gears, 0.0, request.torque, request.materials)
    built = gear_model(request, at)
    model = built.model
    assert [(c.slave, c.master) for c in model.contacts] == [
        (f"pinion_flank_{gears.flanks[0]}_{k}", f"gear_flank_{gears.flanks[1]}_{4 - k}") for k in (1, 2, 3)
    ]
    # the fine lines across the flank are the leading tooth's alone
    along = len(grid_of("pinion", request, at).t) - 1
    counts = [len(model.mesh.face_sets[f"pinion_flank_{gears.flanks[0]}_{k}"]) // along for k in (1, 2, 3)]
    assert counts[0] == counts[2] == COARSE.flank < counts[1]
    for name in ("pinion", "gear"):
        held = set(model.mesh.node_sets[f"{name}_held"])
        assert held == {
            int(n) for key in ("rim", "cut_right", "cut_left") for n in model.mesh.node_sets[f"{name}_{key}"]
        }
    # a virtual turn of the pinion by the torque's sense brings its flank into the gear
    (tie,) = model.ties
    point, normal = at.frame.point(at.path.point[0]), at.frame.vector(at.path.normal[0])
    turn = np.sign(tie.load[5]) * np.array([0.0, 0.0, 1.0])
    assert np.cross(turn, point) @ normal > 0.0
    assert abs(tie.load[5]) == request.torque
    assert at.force == pytest.approx(request.torque / abs(np.cross(point, normal)[2]), rel=1e-12)
    # the flanks overlap at the contact point by the preload
    overlap = built.preload * np.linalg.norm(np.cross([0, 0, 1], point) @ normal)
    assert overlap == pytest.approx(0.5 * at.approach, rel=1e-9)
    assert abs(built.gap) < 0.5 * at.approach


@pytest.mark.sweep_cases("beveloid_crossed-2", "spur-1", "helical-1")
@pytest.mark.parametrize(
    ("sample", "order"), [("spur", 1), ("helical", 1), ("circular_arc", 1), ("beveloid_crossed", 2)]
)
def test_facets_are_seated_where_the_roll_test_finds_them(sample: str, order: int) -> None:
    gears = pair(sample)
    request = Request(teeth=1, cells=Cells(16, 10, 4, 3, 45), torque=5e4, even=True, second_order=order == 2)
    at = place(gears, 0.0, request.torque, request.materials)
    fan = [(0, 1, 2), (0, 2, 3)] if order == 1 else [(0, 1, 7), (2, 3, 1), (4, 5, 3), (6, 7, 5), (1, 3, 5), (1, 5, 7)]
    flanks = []
    for name, side in zip(("pinion", "gear"), gears.flanks, strict=True):
        mesh = member_mesh(name, request, at)
        triangles = mesh.face_outlines(f"flank_{side}_1")[:, fan].reshape(-1, 3)
        regions, normals = np.zeros(len(triangles), dtype=np.int32), np.zeros((len(triangles), 3))
        flanks.append(TriangleMesh(mesh.nodes, triangles, regions, ("flank",), normals))
    turns = at.turns
    (found,) = roll(*flanks, gears.mounts, gears.ratio, turns[0], gears.drive, guess_phi2=turns[1])
    mount = gears.gear.mount
    arm = np.cross(at.path.point[0] - mount.origin, at.path.normal[0]) @ mount.axis
    gap = -gears.drive * (found.phi2 - turns[1]) * abs(arm)
    # nodes over facets leave out where their edges cross, 0.2 um at most here
    assert gear_model(request, at).gap == pytest.approx(gap, abs=2e-4)
    assert abs(gap) > 5e-4


def test_model_starts_with_the_overlap_it_says() -> None:
    """Half the approach at the contact, measured on the placed nodes: gear over pinion along the normal."""
    gears = pair("beveloid_crossed")
    request = Request(teeth=1, cells=Cells(16, 10, 4, 3, 45), torque=5e4, even=True)
    at = place(gears, 0.0, request.torque, request.materials)
    built = gear_model(request, at)
    assert built.gap > 5e-4
    mesh, seen = built.model.mesh, []
    for name, side in zip(("pinion", "gear"), gears.flanks, strict=True):
        offset = mesh.nodes[mesh.face_nodes(f"{name}_flank_{side}_1")] - at.frame.point(at.path.point[0])
        axes = (major_axis(at.path), minor_axis(at.path), at.path.normal[0])
        seen.append(np.stack([offset @ at.frame.vector(axis) for axis in axes], axis=-1))
    pinion, gear = (each[np.linalg.norm(each[:, :2], axis=-1) < 4.0] for each in seen)
    apart = griddata(gear[:, :2], gear[:, 2], pinion[:, :2]) - pinion[:, 2]
    assert np.nanmin(apart) == pytest.approx(-0.5 * at.approach, rel=0.15)


def test_of_all_teeth_only_those_in_mesh_are_in_contact() -> None:
    gears = pair("spur")
    request = Request(teeth=None, cells=Cells(2, 3, 2, 1, 2), torque=5e4, even=True)
    model = gear_model(request, place(gears, 0.0, request.torque, request.materials)).model
    assert 3 <= len(model.contacts) <= 5
    assert not any("cut" in name for name in model.mesh.face_sets)


def test_one_member_is_pressed_as_by_its_mating_gear() -> None:
    """Forces on the flank's nodes: their resultant is the contact force, their moment the torque."""
    gears = pair("beveloid_crossed")
    for ellipse in (0, 6):
        request = Request(members=("pinion",), teeth=1, ellipse=ellipse, torque=5e4)
        at = place(gears, 0.0, request.torque, request.materials)
        model = gear_model(request, at).model
        (load,) = model.forces
        total = load.forces.sum(axis=0)
        np.testing.assert_allclose(total, -at.force * at.frame.vector(at.path.normal[0]), rtol=0, atol=1e-9 * at.force)
        moment = np.cross(model.mesh.nodes[load.nodes], load.forces).sum(axis=0)[2]
        assert moment == pytest.approx(-np.sign(at.arm) * request.torque, rel=1e-3)
        assert set(load.nodes) <= set(model.mesh.face_nodes(f"pinion_flank_{gears.flanks[0]}_1"))
    assert len(load.nodes) > 60


@pytest.mark.sweep
def test_leading_teeth_are_modelled() -> None:
    """Whole pitches on, other teeth stand where those on +x stood; between, the pair that pushes the gear farthest leads."""
    gears = pair("spiral_bevel_basic")
    pitch, steel = gears.pitch, Request().materials
    here = place(gears, 0.1, 1e5, steel)
    for turns in (1, -2, 40):
        there = place(gears, 0.1 + turns * pitch, 1e5, steel)
        assert there.path.rotation == pytest.approx(here.path.rotation, abs=1e-12)
        assert there.path.phi2 == pytest.approx(here.path.phi2, abs=1e-9)
    phi1 = 0.1 + pitch * np.arange(-1, 2)
    path = analyse(gears, phi1)
    te = gears.drive * np.where(path.touching, path.te, np.nan)
    assert here.path.rotation[0] == pytest.approx(phi1[np.nanargmax(te)], abs=1e-12)


def test_joined_meshes_keep_their_sets() -> None:
    one = mesh_of(pair("spur").pinion, 1)
    two = replace(one, nodes=one.nodes + 100.0)
    both = join({"a": one, "b": two})
    np.testing.assert_array_equal(both.nodes[both.node_sets["b_rim"]], two.nodes[two.node_sets["rim"]])
    np.testing.assert_array_equal(both.nodes[both.face_nodes("b_land")], two.nodes[two.face_nodes("land")])
    np.testing.assert_array_equal(both.element_sets["b"], len(one.elements) + np.arange(len(two.elements)))


def test_quality_of_known_hexahedra() -> None:
    cube = np.array(
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], dtype=float
    )
    element = np.arange(8)[None]
    sheared = cube + cube[:, 2:] * np.array([1.0, 0.0, 0.0])
    frustum = cube * np.where(cube[:, 2:] > 0.0, [0.5, 0.5, 1.0], 1.0)
    assert scaled_jacobian(cube, element)[0] == pytest.approx(1.0, abs=1e-15)
    assert scaled_jacobian(sheared, element)[0] == pytest.approx(np.sqrt(0.5), abs=1e-15)
    assert scaled_jacobian(cube[[4, 5, 6, 7, 0, 1, 2, 3]], element)[0] == pytest.approx(-1.0, abs=1e-15)
    assert volumes(frustum, element)[0] == pytest.approx((1.0 + 0.5 + 0.25) / 3.0, abs=1e-15)


def test_measures_of_many_twisted_elements_are_those_of_each() -> None:
    """The closed form of a volume is the flux of x / 3 through the six bilinear faces; chunks of elements leave none out."""
    count = CHUNK_ELEMENTS + 5
    rng = np.random.default_rng(3)
    corners = CORNER_PLACES + 0.3 * rng.uniform(-1.0, 1.0, (count, 8, 3))
    nodes, elements = corners.reshape(-1, 3), np.arange(8 * count).reshape(-1, 8)
    found, quality = volumes(nodes, elements), scaled_jacobian(nodes, elements)
    assert len(found) == len(quality) == count
    for k in (0, CHUNK_ELEMENTS - 1, CHUNK_ELEMENTS, count - 1):
        flux = 0.0
        for face in HEX_FACES:
            p, q, r, s = corners[k, list(face)]
            # of a bilinear face: the mean over both ways of dividing it into triangles
            halves = ((p, q, r), (p, r, s), (q, r, s), (q, s, p))
            flux += sum(np.linalg.det(np.stack(half)) for half in halves) / 2.0
        assert abs(flux) / 6.0 == pytest.approx(found[k], rel=1e-12)
        assert scaled_jacobian(corners[k], np.arange(8)[None])[0] == pytest.approx(quality[k], abs=1e-15)
