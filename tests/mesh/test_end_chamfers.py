"""Chamfers of end faces: their form against distances and offset polygons, their solids, and the face that is left for contact."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from oracles.built import built_sample
from oracles.places import SAMPLES
from oracles.plane_curves import from_polylines

import gearmesh as gm
from gearmesh import DesignError, Member
from gearmesh.contact.flanks import analyse
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.levels import station_normal
from gearmesh.kinds import REVOLUTE_JOINT, BodyFeatures, EndChamfer, Region, TipEdge, Tooth
from gearmesh.mesh.deviation.bound import CHAMFER_BOUND_FACTOR
from gearmesh.mesh.ends import end_mesh
from gearmesh.mesh.solid import gear_solid, prove
from gearmesh.mesh.tessellate import tessellate
from gearmesh.teeth.blank.moments import member_moments

#: width and depth, mm, and whether it is a rounding
End = tuple[float, float] | tuple[float, float, bool]


def chamfered(sample: str, name: str, *ends: End | None, tip: TipEdge | None = None) -> Member:
    """A member of a sample with chamfers or roundings at toe and heel."""
    member = built_sample(sample).pairs[0].members[name]
    first, last = (None if end is None else EndChamfer(*end) for end in ends)
    blank = member.tooth.blank.with_ends((first, last))
    return replace(member, tooth=replace(member.tooth, blank=blank, tip_edge=tip or member.tooth.tip_edge))


def outline(tooth: Tooth, t: float, points: int) -> Array:
    """The transverse section of one tooth, as a polyline (N, 2) with so many points a link."""
    s, sections = np.linspace(0.0, 1.0, points), tooth.sections([t])
    return np.concatenate([tooth.grid(region, s, sections).points[:, 0, :2] for region in tooth.regions])


def turned(points: Array, angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return points @ np.array([[c, s], [-s, c]])


@pytest.mark.quick
@pytest.mark.parametrize(
    ("name", "tip"), [("pinion", None), ("gear", TipEdge(0.3)), ("gear", TipEdge(0.3, rounded=True))]
)
def test_end_face_is_inside_the_sharp_outline_by_the_chamfer_width(name: str, tip: TipEdge | None) -> None:
    """Nowhere nearer, so that all corners are cut where they must be: of sharp helical teeth, with tip chamfers that reach the end
    face, and with roundings smaller than the chamfer, which do not."""
    width = 0.5
    tooth = chamfered("helical", name, (width, 0.3), None, tip=tip).tooth
    strip = tooth.end_strips[0]
    assert strip is not None
    inside = np.concatenate([strip.at(piece, np.linspace(0.0, 1.0, 41), np.zeros(1)) for piece in strip.pieces])
    assert inside[:, 2] == pytest.approx(tooth.blank.faces[0], abs=1e-12)
    own = outline(tooth.sharp_ends, 0.0, 801)
    three = np.concatenate([turned(own, k * tooth.pitch_angle) for k in (-1, 0, 1)])
    assert from_polylines(inside[:, :2], [three]) == pytest.approx(width, abs=2e-5)


@pytest.mark.quick
def test_chamfer_wider_than_the_involute_radius_at_the_base_circle() -> None:
    """The flank's parallel curve turns back there and is cut off where the fillet's crosses it: 17 teeth, and 9, undercut."""
    for teeth, width in ((17, 0.1), (9, 0.15)):
        members = {name: {"teeth": z, "face_width": 8} for name, z in (("pinion", teeth), ("gear", 50))}
        tooth = gm.build(gm.parse({"kind": "cylindrical", "module": 1, **members})).pairs[0].pinion.tooth
        tooth = replace(tooth, blank=tooth.blank.with_ends((EndChamfer(width, 0.1), None)))
        strip = tooth.end_strips[0]
        assert strip is not None
        inside = np.concatenate([strip.at(piece, np.linspace(0.0, 1.0, 41), np.zeros(1)) for piece in strip.pieces])
        own = outline(tooth.sharp_ends, 0.0, 2001)
        three = np.concatenate([turned(own, k * tooth.pitch_angle) for k in (-1, 0, 1)])
        assert from_polylines(inside[:, :2], [three]) == pytest.approx(width, abs=1e-5)


def test_what_chamfers_take_off_spur_teeth() -> None:
    """Against polygons offset inwards by manifold3d, with mitres, at three depths, by Simpson's rule. On the curved flanks beside a
    mitre the rulings lean: 3e-4 of what is taken off."""
    import manifold3d

    members = {name: {"teeth": teeth, "face_width": 20} for name, teeth in (("pinion", 12), ("gear", 31))}
    tooth = gm.build(gm.parse({"kind": "cylindrical", "module": 3, **members})).pairs[0].pinion.tooth
    width, depth = 0.4, 0.25
    broken = replace(tooth, blank=tooth.blank.with_ends((EndChamfer(width, depth), None)))
    own = outline(tooth, 0.5, 81)
    section = manifold3d.CrossSection([np.concatenate([turned(own, k * tooth.pitch_angle) for k in range(12)])])
    areas = [section.offset(-share * width, manifold3d.JoinType.Miter, 20.0).area() for share in (0.0, 0.5, 1.0)]
    removed = depth * (areas[0] - (areas[0] + 4.0 * areas[1] + areas[2]) / 6.0)
    assert tooth.volume() - broken.volume() == pytest.approx(removed, rel=5e-4)


@pytest.mark.sweep_cases(
    "spiral_bevel_geometry2-pinion-ends1-None",
    "helical-gear-ends3-tip3",
    "spiral_bevel_geometry2-gear-ends4-None",
    "helical-pinion-ends0-tip0",
)
@pytest.mark.parametrize(
    ("sample", "name", "ends", "tip"),
    [
        ("helical", "pinion", ((0.5, 0.5), (1.0, 0.6)), TipEdge(0.3)),
        ("spiral_bevel_geometry2", "pinion", ((0.4, 0.4), (0.8, 0.4)), None),
        ("internal", "gear", ((0.3, 0.3), None), None),
        ("helical", "gear", ((0.8, 0.8, True), (0.5, 0.3)), TipEdge(0.3, rounded=True)),
        ("spiral_bevel_geometry2", "gear", (None, (0.6, 0.6, True)), None),
    ],
)
def test_solids_are_closed_and_weigh_what_the_sections_say(
    sample: str, name: str, ends: tuple[End | None, ...], tip: TipEdge | None
) -> None:
    member, tolerance = replace(chamfered(sample, name, *ends, tip=tip), features=BodyFeatures()), 0.04
    mesh = tessellate(member.tooth, tolerance)
    assert mesh.deviation <= tolerance
    assert len(mesh.end_meshes()) == sum(end is not None for end in ends)
    solid = gear_solid(member, tolerance, mesh)
    assert prove(solid, member.genus).ok
    assert solid.volume() == pytest.approx(member.plain_volume(), rel=1e-3)


@pytest.mark.quick
def test_a_chamfer_on_a_back_cone_is_as_wide_as_asked() -> None:
    """Distances of the end face's outline from that of sharp teeth, on the cone, where no corner is near."""
    width = 0.7
    tooth = chamfered("spiral_bevel_geometry2", "gear", None, (width, 0.5)).tooth
    strip = tooth.end_strips[1]
    assert strip is not None
    up = abs(station_normal(tooth.blank.axial)[1])
    sharp = tooth.sharp_ends
    s, sections = np.linspace(0.0, 1.0, 2001), sharp.sections([1.0])
    curve = np.concatenate([sharp.grid(region, s, sections).points[:, 0] for region in sharp.regions])
    for piece in strip.pieces:
        if piece.region not in (Region.FLANK_LEFT, Region.FLANK_RIGHT, Region.LAND):
            continue
        r = strip.at(piece, np.array([0.3, 0.5, 0.7]), np.zeros(1))
        assert tooth.blank.axial.value(r) == pytest.approx(tooth.blank.faces[1], abs=1e-9)
        a, b = np.hypot(r[:, 0], r[:, 1])[:, None] / up, np.hypot(curve[:, 0], curve[:, 1]) / up
        turn = up * (np.arctan2(r[:, 1], r[:, 0])[:, None] - np.arctan2(curve[:, 1], curve[:, 0]))
        apart = np.sqrt((a - b) ** 2 + 4.0 * a * b * np.sin(0.5 * turn) ** 2).min(axis=1)
        assert apart == pytest.approx(width, abs=2e-5)


@pytest.mark.quick
def test_contact_is_on_the_face_between_the_chamfers() -> None:
    """Lines of contact of helical teeth end where the chamfer begins, and where the other end face, which is sharp, is."""
    pair = built_sample("helical", "gear.end_chamfer=2", "gear.end_chamfer_heel=0", "gear.end_chamfer_angle=60").pairs[
        0
    ]
    depth = 2.0 * np.tan(np.radians(60.0))
    assert pair.gear.tooth.blank.extent == pytest.approx((depth - 25.0, 25.0), abs=1e-12)
    assert pair.gear.extent == pytest.approx((-25.0, 25.0), abs=1e-12)
    path = analyse(pair, np.linspace(-0.5, 0.5, 5) * pair.pitch)
    z = np.concatenate([line[:, 2] for line in path.lines if line is not None])
    assert z.min() == pytest.approx(depth - 25.0, abs=1e-6)
    assert z.max() == pytest.approx(25.0, abs=1e-6)


def test_a_rounding_is_an_arc_between_tooth_and_end_face() -> None:
    """Rounding of spur teeth, whose flanks are at right angles to the end face. Distances from the sharp outline and depths lie
    on an arc of the given radius."""
    radius = 0.6
    tooth = chamfered("spur", "pinion", (radius, radius, True), None).tooth
    strip = tooth.end_strips[0]
    assert strip is not None
    own = outline(tooth.sharp_ends, 0.0, 2001)
    three = np.concatenate([turned(own, k * tooth.pitch_angle) for k in (-1, 0, 1)])
    tau = np.linspace(0.0, 1.0, 7)
    for piece in strip.pieces:
        r = strip.at(piece, np.linspace(0.0, 1.0, 9)[:, None], tau).reshape(-1, 3)
        inside, depth = from_polylines(r[:, :2], [three]), r[:, 2] - tooth.blank.faces[0]
        # between curves that are parallel the lines from outline to section lean beside mitres
        assert np.hypot(radius - inside, radius - depth) == pytest.approx(radius, abs=2e-3 * radius)


@pytest.mark.quick
@pytest.mark.parametrize(("sample", "name"), [("helical", "gear"), ("spiral_bevel_geometry2", "pinion")])
def test_a_rounding_is_tangent_to_end_face_and_tooth(sample: str, name: str) -> None:
    """Leaving the end face by the square of the way, and the tooth by its curvature within the depth alone."""
    depth, step = 0.02, 1e-4
    tooth = chamfered(sample, name, (depth, depth, True), None).tooth
    strip, sections = tooth.end_strips[0], tooth.sections([0.0])
    assert strip is not None
    for piece in strip.pieces:
        if piece.region not in (Region.FLANK_LEFT, Region.FLANK_RIGHT):
            continue
        first, near = (strip.at(piece, np.full(1, 0.5), np.full(1, tau))[0] for tau in (0.0, step))
        way = np.linalg.norm(near - first)
        assert abs(tooth.blank.axial.value(near) - tooth.blank.faces[0]) < 2.0 * way * step
        last, before = (strip.at(piece, np.full(1, 0.5), np.full(1, tau))[0] for tau in (1.0, 1.0 - step))
        s = 0.5 * sum(piece.inner)
        normal = piece.link.grid(np.array([s]), sections).normals[0, 0]
        assert abs((last - before) @ normal) < 2e-3 * np.linalg.norm(last - before)


def test_refusals() -> None:
    for override, message in (
        ("gear.end_rounding=9", r"gear.end_rounding = 9 mm: larger than .* at most \d\.\d+ mm"),
        ("gear.end_chamfer_toe=9", r"gear.end_chamfer_toe = 9 mm: larger than .* at most \d\.\d+ mm"),
        ("gear.end_chamfer_angle=30", r"gear.end_chamfer_angle = 30.*: needs end_chamfer"),
    ):
        with pytest.raises(DesignError, match=message):
            gm.build(gm.load(SAMPLES / "spur.toml", [override]))
    with pytest.raises(
        DesignError, match=r"end_rounding_toe = 0\.2.*: cannot be given together with end_chamfer, for the toe"
    ):
        gm.load(SAMPLES / "spur.toml", ["gear.end_chamfer=0.3", "gear.end_rounding_toe=0.2"])


@pytest.mark.sweep
def test_corners_at_a_root_that_touches_neither_fillet() -> None:
    """Roots straight from fillet to fillet: the outline is as far inside that of three sharp teeth everywhere, so at the corners to
    both neighbours too, which one of the two has in an arc. Nearest points of the sharp outline are 0.01 mm apart: 1e-4 mm."""
    width = 0.3
    tooth = chamfered("spiral_bevel_formate", "pinion", (width, 0.2), (width, 0.2)).tooth
    up = abs(station_normal(tooth.blank.axial)[1])
    s, sharp = np.linspace(0.0, 1.0, 1001), tooth.sharp_ends
    sections = sharp.sections([0.0, 1.0])
    outlines = np.concatenate([sharp.grid(region, s, sections).points for region in sharp.regions])
    for strip, curve in zip(tooth.end_strips, outlines.swapaxes(0, 1), strict=True):
        assert strip is not None
        assert sum(piece.round is not None for piece in strip.pieces) == 1
        r = np.concatenate([strip.at(piece, np.linspace(0.0, 1.0, 9), np.zeros(1)) for piece in strip.pieces])
        assert tooth.joint.to(tooth.pitch_angle).point(r[0]) == pytest.approx(r[-1], abs=1e-8)
        a, b = np.hypot(r[:, 0], r[:, 1])[:, None] / up, np.tile(np.hypot(curve[:, 0], curve[:, 1]), 3) / up
        angles = np.arctan2(curve[:, 1], curve[:, 0]) + tooth.pitch_angle * np.array([[-1.0], [0.0], [1.0]])
        turn = REVOLUTE_JOINT.within(np.arctan2(r[:, 1], r[:, 0])[:, None] - angles.ravel())
        apart = np.sqrt((a - b) ** 2 + 4.0 * a * b * np.sin(0.5 * up * turn) ** 2).min(axis=1)
        assert apart == pytest.approx(width, abs=1e-4)


@pytest.mark.quick
@pytest.mark.parametrize(("sample", "name"), [("helical", "pinion"), ("spiral_bevel_geometry2", "gear")])
@pytest.mark.sweep_cases("spiral_bevel_geometry2-gear")
def test_samples_for_room_of_chamfers_are_as_exact_as_the_surfaces(sample: str, name: str) -> None:
    tooth = chamfered(sample, name, (0.5, 0.3), (0.3, 0.3)).tooth
    for strip, sharp, width in zip(tooth.end_strips, tooth.sharp_outlines, (0.5, 0.3), strict=True):
        assert strip is not None
        assert sharp.inside(width) == pytest.approx(strip.outline, abs=1e-7)


@pytest.mark.sweep
@pytest.mark.parametrize(("tolerance", "rounded"), [(0.05, False), (0.001, False), (0.05, True)])
@pytest.mark.sweep_cases("0.001-False", "0.05-True")
def test_no_place_of_a_chamfer_is_farther_than_its_bound(
    tolerance: float, rounded: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Facets measured at a thousand random places each are within the bound, which is no more than 1.10 of what is measured."""
    mesh = tessellate(chamfered("helical", "pinion", (1.5, 1.5, rounded), (0.5, 0.3)).tooth, tolerance)
    measured = max(end.deviation for end in mesh.end_meshes().values())
    places = np.random.default_rng(1).dirichlet(np.ones(3), 1000)
    monkeypatch.setattr(end_mesh, "MEASURED_PLACES", places)
    again = replace(mesh)
    farthest = max(end.deviation for end in again.end_meshes().values())
    assert 0.9 * measured < farthest <= CHAMFER_BOUND_FACTOR * measured <= 1.1001 * measured


@pytest.mark.sweep
def test_a_chamfer_as_wide_as_the_tip_rounding_ends_in_its_centre() -> None:
    """Between slightly narrower and wider ones, whose strips go on or end before, volumes go on as evenly as between them."""
    volumes, steps = [], (-1e-4, 0.0, 1e-4)
    for step in steps:
        keys = ["pinion.tip_rounding=0.3", f"pinion.end_chamfer={0.3 * (1.0 + step)!r}"]
        member = gm.build(gm.load(SAMPLES / "spur.toml", keys)).members["pinion"]
        volumes.append(member.plain_volume())
    assert volumes[0] > volumes[1] > volumes[2]
    assert volumes[1] == pytest.approx(0.5 * (volumes[0] + volumes[2]), rel=1e-3 * (volumes[0] / volumes[2] - 1.0))
    middle = gm.build(gm.load(SAMPLES / "spur.toml", ["pinion.tip_rounding=0.3", "pinion.end_chamfer=0.3"]))
    assert prove(gear_solid(middle.members["pinion"], 0.02), 1).ok


#: helical, the bar longer than its teeth; spur teeth with sharp roots
BARS = {
    "helical": {"helix_angle": 20, "rack": {"teeth": 5, "face_width": 20, "length": 45}},
    "sharp roots": {"rack": {"teeth": 4, "face_width": 15, "tool_tip_radius": 0}},
}


def bar(case: str, **keys: object) -> gm.Gears:
    """A rack alone, with these keys more."""
    design = {"kind": "rack", "module": 2, **BARS[case]}
    return gm.build(gm.parse({**design, "rack": {**BARS[case]["rack"], **keys}}))  # type: ignore[dict-item]


@pytest.mark.quick
@pytest.mark.parametrize("case", BARS)
@pytest.mark.parametrize("rounded", [False, True])
@pytest.mark.sweep_cases("False-helical", "True-sharp roots")
def test_what_broken_edges_take_off_a_bar(case: str, rounded: bool) -> None:
    """In closed form: d inside an outline of length L it is L d less at every corner of the lands d^2 tan(theta / 2), more at every
    root fillet, whose radius does not count, d^2 theta / 2, theta = 90 deg - alpha_t. Helical teeth are that sheared."""
    width, depth = (0.4, 0.4) if rounded else (0.5, 0.5 * np.tan(np.radians(35.0)))
    sharp = bar(case).members["rack"]
    keys = {"end_rounding_toe": width} if rounded else {"end_chamfer_toe": width, "end_chamfer_angle": 35}
    broken = bar(case, **keys).members["rack"]
    one = outline(sharp.tooth, 0.0, 4001)
    length = sharp.tooth.teeth * np.linalg.norm(np.diff(one, axis=0), axis=-1).sum() + 2.0 * sharp.overhang
    alpha = np.arctan(np.tan(np.radians(20.0)) / np.cos(np.radians(20.0 if case == "helical" else 0.0)))
    theta = 0.5 * np.pi - alpha
    corners = sharp.tooth.teeth * (theta - 2.0 * np.tan(0.5 * theta))
    # integrals of d and d^2 over the depth
    first, second = (
        (width**2 * (1.0 - 0.25 * np.pi), width**3 * (5.0 / 3.0 - 0.5 * np.pi))
        if rounded
        else (0.5 * width * depth, width**2 * depth / 3.0)
    )
    removed = length * first + corners * second
    assert sharp.plain_volume() - broken.plain_volume() == pytest.approx(removed, rel=1e-6)


@pytest.mark.parametrize(
    ("case", "keys"),
    [
        ("helical", {"end_chamfer_toe": 0.6, "end_rounding_heel": 0.4, "tip_chamfer": 0.3}),
        ("helical", {"end_chamfer": 0.3, "tip_rounding": 0.4, "modifications": {"helix_crowning": 0.02}}),
        ("sharp roots", {"end_chamfer_heel": 0.5}),
    ],
)
@pytest.mark.sweep_cases("helical-keys1", "helical-keys0")
def test_bars_are_closed_and_weigh_what_the_sheet_says(case: str, keys: dict[str, object]) -> None:
    """The chamfers go on along the root lands to the bar's ends. Centre of gravity and inertia against the mesh's."""
    gears, tolerance = bar(case, **keys), 0.002
    member, solid = gears.members["rack"], gears.solid("rack", tolerance)
    mesh, moments = solid.to_trimesh(), member_moments(member)
    length, lean = (45.0, np.tan(np.radians(20.0))) if case == "helical" else (8.0 * np.pi, 0.0)
    assert prove(solid.mesh, member.genus).ok
    assert solid.figures["sampled_deviation_um"] <= solid.figures["max_deviation_um"] <= 1e3 * tolerance
    assert moments.volume == pytest.approx(member.plain_volume(), rel=1e-12)
    assert mesh.volume == pytest.approx(moments.volume, abs=tolerance * mesh.area)
    assert mesh.center_mass == pytest.approx(moments.centre, abs=tolerance)
    assert mesh.moment_inertia == pytest.approx(1e9 * moments.about_centre(1.0), rel=1e-3, abs=tolerance * mesh.area)
    for name, end in zip(("edge_toe", "edge_heel"), member.tooth.blank.ends, strict=True):
        numbers = [k for k, region in enumerate(solid.mesh.region_names) if region == name]
        assert bool(numbers) == (end is not None)
        if end is not None:
            y = mesh.vertices[mesh.faces[solid.mesh.regions == numbers[0]]][..., 1]
            assert np.ptp(y) == pytest.approx(length + end.depth * lean, abs=1e-6)


@pytest.mark.sweep
def test_a_bar_has_no_room_for_larger_chamfers() -> None:
    """Up to half of the land, to the back, and to a hole; each with what fits."""
    for keys, message in (
        ({"end_rounding": 5}, r"rack.end_rounding = 5 mm: larger than .* at most 1\.20372 mm"),
        (
            {"end_chamfer": 0.8, "end_chamfer_angle": 30, "height": 5},
            r"rack.end_chamfer = 0\.8 mm.* at most 0\.499999 mm",
        ),
        (
            {
                "end_chamfer": 1.0,
                "addendum": 0.3,
                "dedendum": 0.35,
                "bolts": {"count": 2, "diameter": 2, "height": 4.2},
            },
            r"rack.end_chamfer = 1 mm.* at most 0\.799999 mm",
        ),
    ):
        with pytest.raises(DesignError, match=message):
            bar("sharp roots", **keys)
