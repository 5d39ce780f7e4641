"""Teeth, meshes and solids of real designs: closed chains, tolerances that mean what they say, proofs, refusals."""

from __future__ import annotations

import itertools
import re
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from oracles.built import built_sample
from oracles.examples import some
from oracles.places import SAMPLES

from gearmesh import DesignError, Member
from gearmesh.cad.brep import exact_volume
from gearmesh.check.deviation import deviations
from gearmesh.kernel.numeric.algebra import dot
from gearmesh.kinds import Side
from gearmesh.mesh.solid import gear_solid, prove
from gearmesh.mesh.tessellate import tessellate

NAMES = sorted(path.stem for path in SAMPLES.glob("*.toml"))
#: an undercut pinion at a centre distance without backlash
FEW = ["pinion.teeth=10", "assembly.center_distance=75", "pinion.profile_shift=0", "gear.profile_shift=0"]
BENCH = ["pinion.bore=0"]


def members(sample: str, *overrides: str) -> dict[str, Member]:
    return built_sample(sample, *overrides).members


def pinion(sample: str, *overrides: str) -> Member:
    return members(sample, *overrides)["pinion"]


@pytest.mark.sweep_cases(
    "hypoid_high_ratio",
    "hypoid_formate",
    "hypoid_measured",
    "spiral_bevel_formate",
    "cyclo_palloid",
    "hypoid_face_hobbed",
    "modified_involute",
    "zerol",
    "novikov",
    "planetary",
    "spiral_bevel_basic",
    "worm_drive_zk_oversize",
)
@pytest.mark.parametrize("sample", NAMES)
def test_links_of_the_chain_share_their_ends(sample: str) -> None:
    for member in members(sample).values():
        tooth = member.tooth
        sections = tooth.sections(np.linspace(0.0, 1.0, 7))
        grids = [tooth.grid(region, [0.0, 0.3, 1.0], sections) for region in tooth.regions]
        size = np.abs(grids[0].points).max()
        for before, after in itertools.pairwise(grids):
            np.testing.assert_allclose(before.points[-1], after.points[0], rtol=0, atol=1e-11 * size)
        next_root = grids[-1].points[-1]
        moved = tooth.joint.to(tooth.pitch_angle).point(grids[0].points[0])
        np.testing.assert_allclose(next_root, moved, rtol=0, atol=1e-11 * size)
        # every station is a plane across the axis, a cone across the pitch cone, or a cylinder
        for grid in grids:
            np.testing.assert_allclose(
                tooth.blank.axial.value(grid.points),
                np.broadcast_to(sections.stations, (3, 7)),
                rtol=0,
                atol=1e-11 * size,
            )


@pytest.mark.quick
def test_sides_may_be_named_as_files_name_them() -> None:
    """ "left" is the left side, and what is no side is refused rather than taken for one."""
    tooth = pinion("spur").tooth
    for side in Side:
        assert tooth.side(side.value) is tooth.side(side)  # type: ignore[arg-type]
        named, known = (tooth.flank_grid(which, [0.2], [0.5]).points for which in (side.value, side))  # type: ignore[arg-type]
        np.testing.assert_array_equal(named, known)
    with pytest.raises(ValueError, match="'up' is not a valid Side"):
        tooth.flank_grid("up", [0.2], [0.5])  # type: ignore[arg-type]


@pytest.mark.quick
def test_spur_flank_is_the_involute_and_its_fillet_a_rack_trochoid() -> None:
    member = pinion("spur")
    tooth, teeth, module, alpha = member.tooth, member.tooth.teeth, 3.0, np.radians(20.0)
    base = 0.5 * teeth * module * np.cos(alpha)
    flank = tooth.flank_grid(Side.RIGHT, np.linspace(0.0, 1.0, 21), np.array([0.5])).points[:, 0]
    rho, theta = np.hypot(flank[:, 0], flank[:, 1]), np.arctan2(flank[:, 1], flank[:, 0])
    roll = np.sqrt((rho / base) ** 2 - 1.0)
    # polar angle of an involute grows by inv(alpha) = tan(alpha) - alpha from the base circle
    start = theta - (roll - np.arctan(roll))
    np.testing.assert_allclose(start, start[0], rtol=0, atol=1e-13)
    # fillet: the normal at a generated point passes through the pitch point when it is generated
    grid = tooth.grid("fillet_right", np.linspace(0.0, 1.0, 21), tooth.sections(np.array([0.5])))
    generating = tooth.right.fillet.parameter(grid.p, grid.v)[:, 0]  # type: ignore[attr-defined]
    r = 0.5 * teeth * module
    pitch_point = r * np.stack((np.cos(generating), np.sin(generating)), axis=-1)
    to_pitch = pitch_point - grid.points[:, 0, :2]
    across = to_pitch[:, 0] * grid.normals[:, 0, 1] - to_pitch[:, 1] * grid.normals[:, 0, 0]
    np.testing.assert_allclose(across, 0.0, rtol=0, atol=1e-12 * r)


@pytest.mark.parametrize("radius", ["0.38", "0"])
def test_undercut_ends_at_a_true_intersection(radius: str) -> None:
    member = pinion(
        "spur",
        "pinion.teeth=9",
        "assembly.center_distance=73.5",
        "pinion.profile_shift=0",
        "gear.profile_shift=0",
        f"pinion.tool_tip_radius={radius}",
    )
    tooth = member.tooth
    sections = tooth.sections(np.array([0.0, 1.0]))
    flank = tooth.grid("flank_right", [0.0, 1e-3], sections)
    fillet = tooth.grid("fillet_right", [1.0], sections)
    np.testing.assert_allclose(flank.points[0], fillet.points[0], rtol=0, atol=1e-10)
    joint = np.hypot(*flank.points[0, 0, :2])
    base = 0.5 * 9 * 3.0 * np.cos(np.radians(20.0))
    assert joint > base * 1.001
    # a corner, not a smooth passage: the normals differ
    assert (dot(flank.normals[0], fillet.normals[0]) < 0.999).all()


def test_undercut_beginning_along_the_face_is_a_station() -> None:
    tooth = pinion("beveloid_intersected").tooth
    assert tooth.breaks.size == 1
    t = tooth.breaks[0] + np.array([-1e-3, 1e-3])
    cut = tooth.sections(t).right.form_point_flank != tooth.right.form_point[0]
    assert cut.tolist() == [True, False]


@pytest.mark.sweep
@pytest.mark.sweep_cases("intersected", "helical", "circular_arc")
@pytest.mark.parametrize(
    ("sample", "overrides", "tolerances"),
    some(
        [
            ("helical", BENCH, (1e-2, 1e-3, 1e-4)),
            ("beveloid_crossed", [], (1e-2, 1e-3)),
            ("beveloid_intersected", [], (1e-2, 1e-3)),
            ("spiral_bevel_abdullah_straight", [], (1e-2, 1e-3)),
            ("spiral_bevel_abdullah_curved", ["contact.side=pinion_convex"], (1e-2,)),
            ("circular_arc", [], (1e-2,)),
            (
                "spur",
                FEW,
                (1e-2, 1e-3, 1e-4),
            ),
            ("spur", ["pinion.tip_rounding=0.3", "pinion.tool_tip_radius=0"], (1e-2, 1e-3)),
        ],
        4,
    ),
    ids=["helical", "crossed", "intersected", "bevel", "bevel_curved", "circular_arc", "undercut", "sharp_tool"],
)
def test_tolerance_means_what_it_says(sample: str, overrides: list[str], tolerances: tuple[float, ...]) -> None:
    tooth = pinion(sample, *overrides).tooth
    counts = []
    for tolerance in tolerances:
        mesh = tessellate(tooth, tolerance)
        for region, deviation in deviations(mesh).items():
            assert deviation.largest <= tolerance, (region, tolerance)
        assert mesh.deviation <= tolerance
        # and the mesh is no finer than need be
        for route in ("facets_to_surface", "surface_to_facets"):
            assert max(getattr(d, route) for d in deviations(mesh).values()) > 0.5 * tolerance
        counts.append(mesh.triangles)
    if sample == "helical":
        growth = np.polyfit(np.log(tolerances), np.log(counts), 1)[0]
        assert -1.1 < growth < -0.85


def test_helical_solid_is_lean() -> None:
    member = pinion("helical", *BENCH)
    tooth = tessellate(member.tooth, 0.01)
    solid = gear_solid(member, 0.01, tooth)
    assert max(d.largest for d in deviations(tooth).values()) <= 0.01
    assert len(solid.triangles) <= 11_000


@pytest.mark.parametrize("sample", NAMES)
@pytest.mark.sweep_cases(
    "beveloid_crossed",
    "beveloid_intersected",
    "beveloid_parallel",
    "circular_arc",
    "face_gear",
    "face_gear_conjugate",
    "face_gear_offset",
    "hypoid",
    "hypoid_formate",
    "hypoid_high_ratio",
    "hypoid_measured",
    "modified_involute",
    "novikov",
    "spiral_bevel_abdullah_curved",
    "spiral_bevel_abdullah_straight",
    "spiral_bevel_formate",
    "spiral_bevel_geometry1",
    "spiral_bevel_geometry2",
    "worm_drive",
    "worm_drive_dual_lead",
    "worm_drive_zk_oversize",
    "zerol",
    "cyclo_palloid",
    "double_helical",
    "helical",
    "hypoid_face_hobbed",
    "spiral_bevel_basic",
)
def test_every_solid_is_proved(sample: str) -> None:
    for member in members(sample).values():
        solid = gear_solid(member, 0.05)
        proof = prove(solid, member.genus)
        assert proof.ok, proof
        assert proof.euler == 2 - 2 * member.genus
        # end faces are flat, and no triangle of theirs is folded over
        for face, up in (("face_toe", -1.0), ("face_heel", 1.0)):
            normals = solid.normals[solid.regions == solid.region_names.index(face)]
            np.testing.assert_allclose(normals, np.broadcast_to([0.0, 0.0, up], normals.shape), rtol=0, atol=1e-9)
        # facets lie within 0.05 mm of the surface, so the volume within 0.05 mm times the area
        corners = solid.corners()
        area = (
            0.5 * np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1).sum()
        )
        assert abs(proof.volume - exact_volume(member)) < 0.05 * area
        turns = member.tooth.joint.travel is None
        body = member.plain_body
        bored = ("bore",) if body.bore_radius else ()
        inside = (("rim",) if body.around else bored) if turns else ("back", "end")
        for region in (
            "flank_left",
            "flank_right",
            "fillet_left",
            "fillet_right",
            "land",
            "root",
            *inside,
            "face_heel",
        ):
            assert (solid.regions == solid.region_names.index(region)).any()


def test_proof_is_that_of_trimesh() -> None:
    """Compare a sound solid and broken ones: a hole, a triangle turned over, a triangle twice, no volume, inside out."""
    sound = gear_solid(pinion("spur"), 0.05)
    triangles = sound.triangles
    broken = {
        "hole": triangles[1:],
        "turned": np.concatenate((triangles[:1, ::-1], triangles[1:])),
        "twice": np.concatenate((triangles, triangles[:1])),
        "sheet": np.concatenate((triangles[:1], triangles[:1, ::-1])),
        "inside out": triangles[:, ::-1],
    }
    for name, each in {"sound": triangles, **broken}.items():
        mesh = replace(sound, triangles=each)
        found, other = prove(mesh, 1), trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False)
        with np.errstate(invalid="ignore"):
            assert (found.watertight, found.euler) == (bool(other.is_volume), other.euler_number), name
        assert not found.watertight or found.volume == pytest.approx(float(other.volume), rel=1e-12)
        assert found.ok == (name == "sound")


def test_cell_normals_are_those_of_the_exact_flank() -> None:
    member = pinion("helical")
    solid = gear_solid(member, 0.001)
    flank = solid.only("flank_right", "fillet_left")
    corners = flank.corners()
    facet = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    facet /= np.linalg.norm(facet, axis=1)[:, None]
    np.testing.assert_allclose(np.linalg.norm(flank.normals, axis=1), 1.0, rtol=0, atol=1e-13)
    # right side out, and a facet of half width h is turned by less than about h / rho from the surface
    assert (dot(facet, flank.normals) > np.cos(0.15)).all()
    involute = solid.only("flank_right")
    # the normals of an involute helicoid all make one angle with the axis: sin of the base helix angle
    helix, alpha = np.radians(15.0), np.radians(20.0)
    np.testing.assert_allclose(np.abs(involute.normals[:, 2]), np.sin(helix) * np.cos(alpha), rtol=0, atol=1e-12)


@pytest.mark.parametrize(
    ("sample", "name", "faces"),
    [
        ("spur", "pinion", ("face_toe", "face_heel")),
        ("spiral_bevel_basic", "pinion", ("front_cone", "back_cone")),
        ("spiral_bevel_basic", "gear", ("front_cone", "back_cone")),
        ("face_gear", "gear", ("inner_cylinder", "outer_cylinder")),
    ],
)
@pytest.mark.sweep_cases("face_gear-gear-faces3", "spiral_bevel_basic-pinion-faces1")
def test_end_faces_take_no_more_triangles_than_their_borders_demand(
    sample: str, name: str, faces: tuple[str, str]
) -> None:
    """Between the outline of the teeth and a ring: as many triangles as both have vertices, and none in between."""
    for tolerance in (0.05, 0.005):
        solid = gear_solid(members(sample)[name], tolerance)
        for region in faces:
            face = solid.only(region)
            assert len(face.triangles) == len(face.vertices)


@pytest.mark.parametrize("name", ["pinion", "gear"])
def test_end_faces_of_a_bevel_gear_are_its_front_and_back_cones(name: str) -> None:
    member, tolerance = members("spiral_bevel_abdullah_straight")[name], 0.005
    solid, blank = gear_solid(member, tolerance), member.tooth.blank
    for region, station, sense in (("front_cone", blank.extent[0], -1.0), ("back_cone", blank.extent[1], 1.0)):
        face = solid.only(region)
        off = blank.axial.value(face.vertices) - station
        np.testing.assert_allclose(off, 0.0, rtol=0, atol=1e-9)
        corners = face.corners()
        # facets stay near the cone and point out of the body: no fold, nowhere across
        for weights in ([1, 1, 1], [2, 1, 1], [1, 2, 1], [1, 1, 2], [0, 1, 1], [1, 0, 1], [1, 1, 0]):
            inside = np.einsum("k,nkj->nj", np.array(weights) / sum(weights), corners)
            assert np.abs(blank.axial.value(inside) - station).max() < 1.05 * tolerance
        outwards = sense * blank.axial.gradient(corners.mean(axis=1))
        assert (dot(face.normals, outwards) > 0.95).all()


@pytest.mark.parametrize(
    ("sample", "overrides", "tolerances"),
    [("spur", BENCH, (1e-2, 1e-3, 1e-4)), ("spiral_bevel_basic", [], (1e-2, 2e-3, 4e-4))],
)
@pytest.mark.sweep_cases("spiral_bevel_basic-overrides1-tolerances1")
def test_volume_converges_with_the_tolerance(sample: str, overrides: list[str], tolerances: tuple[float, ...]) -> None:
    member = pinion(sample, *overrides)
    exact = member.tooth.volume(32)
    errors = [abs(gear_solid(member, tolerance).volume() - exact) for tolerance in tolerances]
    order = np.polyfit(np.log(tolerances), np.log(errors), 1)[0]
    assert 0.85 < order < 1.15
    # the tolerance times the 8,000 mm2 of teeth and bore, of either sign
    assert errors[-1] < 0.1 * tolerances[-1] * exact


@pytest.mark.parametrize(
    ("features", "change"),
    [
        (["pinion.keyway={width=8,depth=3}"], "keyway"),
        (["pinion.hub={diameter=40,length=10}"], "hub"),
        (["pinion.keyway={width=8,depth=3}", "pinion.hub={diameter=40,length=10}"], "both"),
    ],
    ids=["keyway", "hub", "both"],
)
def test_features_of_the_body(features: list[str], change: str) -> None:
    plain, member = pinion("spur"), pinion("spur", *features)
    solid = gear_solid(member, 0.01)
    assert prove(solid, 1).ok
    bore, width = plain.tooth.blank.body.bore_radius, 30.0
    removed = added = 0.0
    length = width + (10.0 if change != "keyway" else 0.0)
    if change != "keyway":
        added = np.pi * (20.0**2 - bore**2) * 10.0
    if change != "hub":
        # a slot 8 wide and 3 deep beyond the bore, less what the round bore already takes of it
        half = 4.0
        segment = half * np.sqrt(bore**2 - half**2) + bore**2 * np.arcsin(half / bore)
        removed = (8.0 * (bore + 3.0) - segment) * length
    expected = gear_solid(plain, 0.01).volume() + added - removed
    assert abs(solid.volume() - expected) < 2e-3 * (added + removed)
    untouched = [solid.only(region) for region in ("flank_left", "fillet_right")]
    reference = [gear_solid(plain, 0.01).only(region) for region in ("flank_left", "fillet_right")]
    assert [len(m.triangles) for m in untouched] == [len(m.triangles) for m in reference]


@pytest.mark.parametrize("edge", ["tip_chamfer", "tip_rounding"])
@pytest.mark.sweep_cases("tip_chamfer")
def test_broken_tip_edges(edge: str) -> None:
    plain, member = pinion("helical"), pinion("helical", f"pinion.{edge}=0.5")
    assert prove(gear_solid(member, 0.01), 1).ok
    lost = plain.tooth.volume() - member.tooth.volume()
    # a corner of 120 deg: legs of 0.5 mm cut off about 0.11 mm2, a radius r leaves r^2 (cot 60 - 30 deg) = 0.0134 mm2
    low, high = (0.08, 0.16) if edge == "tip_chamfer" else (0.011, 0.016)
    assert low < lost / (48 * 50.0 / np.cos(np.radians(15.0))) < high


LIMITS = {
    "pointed": ("helical", "pinion.addendum", 1.9, "mm", r"at most ([\d.]+) mm"),
    "fillet": ("spur", "pinion.tool_tip_radius", 0.7, "", r"at most ([\d.]+)"),
    "face": ("beveloid_intersected", "pinion.face_width", 60, "mm", r"at most ([\d.]+) mm"),
    "bore": ("spur", "pinion.bore", 80, "mm", r"diameter, ([\d.]+) mm"),
    "chamfer": ("spur", "pinion.tip_chamfer", 3, "mm", r"at most ([\d.]+) mm"),
}


@pytest.mark.sweep_cases("face", "chamfer", "pointed")
@pytest.mark.parametrize("name", LIMITS)
def test_refusals_name_a_true_limit(name: str) -> None:
    sample, key, value, _, pattern = LIMITS[name]
    with pytest.raises(DesignError, match=pattern) as caught:
        members(sample, f"{key}={value}")
    assert key in str(caught.value)
    assert "\n" not in str(caught.value)
    found = re.search(pattern, str(caught.value))
    assert found is not None
    limit = float(found[1])
    if name == "pointed":
        key = "pinion.tip_diameter"
    members(sample, f"{key}={0.999 * limit}")
    # bounds that are found by trying have four digits
    with pytest.raises(DesignError):
        members(sample, f"{key}={1.001 * limit}")


def test_circular_arc_racks_are_those_of_the_paper() -> None:
    """[LT85] (5), (13): both racks touch along the line theta = 30 deg, at x = 0.21555 in, y = -0.38517 in."""
    gears = members("circular_arc")
    theta, u = np.array(np.radians(30.0)), np.array(0.0)
    section = []
    for member in gears.values():
        tool = member.tooth.right.flank.tool  # type: ignore[attr-defined]
        section.append(tool.axes[:2] @ tool.jet(theta, u).r / 25.4)
    pinion, gear = section
    np.testing.assert_allclose(pinion, [0.675 * 0.5 - 0.12195, 0.1994 - 0.675 * np.sqrt(0.75)], rtol=0, atol=1e-12)
    # the gear's section is the pinion's turned by half a turn, and half a pitch (in the rack's normal section) on
    half_pitch = np.pi * 25.929381226 / 94 * np.sin(np.radians(75.0))
    np.testing.assert_allclose(gear, [-pinion[0], -pinion[1] - half_pitch], rtol=0, atol=1e-8)
