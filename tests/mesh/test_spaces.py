"""Spaces between teeth and flanks as parts of their own, and teeth whose surfaces are moved along their normals."""

from __future__ import annotations

from pathlib import Path

import manifold3d
import meshio
import numpy as np
import pytest
from oracles.built import built_sample
from oracles.command_line import refused
from oracles.examples import some
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import Member
from gearmesh.kernel.envelope.limiting_line import area_density
from gearmesh.kernel.numeric.algebra import unit
from gearmesh.kernel.surface.meridian import CircularMeridian, Joined, Meridian, ParallelMeridian
from gearmesh.kernel.surface.nearest import nearest
from gearmesh.kinds import Body, Region, Tooth, along
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.teeth.offset import OFFSET_ACCURACY, offset_member, offset_tooth
from gearmesh.teeth.space import Space

SADDLE = Path(__file__).parents[1] / "corpus" / "saddle_spiral_bevel_tilted.toml"
#: flanks that begin so near their base circle that moved inwards they cross the fillet beyond its own end
NEAR_BASE = [
    "pinion.teeth=18",
    "pinion.profile_shift=0",
    "gear.profile_shift=0",
    "pinion.modifications={profile_crowning=0.008}",
]
#: mm, of the meshes
TOLERANCE = 0.01
MEMBERS = [
    ("spiral_bevel_basic", "gear"),
    ("hypoid_formate", "gear"),
    ("face_gear_conjugate", "gear"),
    ("double_helical", "pinion"),
    ("internal", "gear"),
    ("beveloid_intersected", "gear"),
    ("circular_arc", "pinion"),
    ("face_gear", "gear"),
    ("hob_protuberance", "pinion"),
    ("spiral_bevel_geometry2", "gear"),
    ("zerol", "pinion"),
    ("planetary", "ring"),
]


def member_of(sample: str, name: str) -> Member:
    return built_sample(sample).members[name]


def tip_body(tooth: Tooth) -> Body:
    """The gear body with its teeth, and the spaces between them filled up to the tip cylinder or cone."""
    blank = tooth.blank
    stations, surface = np.array(blank.extent), blank.tip.surface
    tip = along(surface, np.zeros(2), stations, blank.axial, surface.meeting(blank.axial, stations))[1].r
    (toe, heel), body = [(float(np.hypot(*r[:2])), float(r[2])) for r in tip], blank.body
    return Body((*body.profile, heel, toe), (*body.bands, Region.FACE_HEEL, Region.LAND))


def area(mesh: TriangleMesh) -> float:
    a, b, c = np.moveaxis(mesh.corners(), 1, 0)
    return 0.5 * float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum())


@pytest.mark.parametrize(("sample", "name"), some(MEMBERS, 3))
@pytest.mark.parametrize("share", [pytest.param(0.0, marks=pytest.mark.sweep), 0.02])
@pytest.mark.sweep_cases("0.02-circular_arc-pinion", "0.02-planetary-ring")
def test_spaces_and_teeth_fill_the_blank(sample: str, name: str, share: float) -> None:
    """Exactly, in a way that knows no tooth: the blank is a body of revolution; the space's mesh within its tolerance."""
    nominal = member_of(sample, name)
    offset = share * nominal.tooth.height
    tooth = offset_member(nominal, offset).tooth
    exact = Space.before(tooth).volume()
    blank = abs(tip_body(tooth).enclosed_volume())
    assert tooth.volume() + tooth.teeth * exact == pytest.approx(blank, rel=1e-11)
    solid = built_sample(sample).solid(name, TOLERANCE, space=True, offset=offset, file="a.stl")
    assert solid.measured.watertight
    assert solid.complaints == []
    # nothing is farther than the tolerance from the exact surfaces, so what is between has no more than that times the area
    assert abs(solid.mesh.volume() - exact) < TOLERANCE * area(solid.mesh)


def test_the_space_of_a_rack_is_what_its_teeth_leave() -> None:
    tooth = member_of("rack", "rack").tooth
    (back, low), (_, high) = tooth.blank.body.profile
    pitch = float(tooth.joint.to(tooth.pitch_angle).translation[1])
    whole = (float(tooth.blank.tip.at(0.0)) - back) * pitch * (high - low)
    assert tooth.volume() / tooth.teeth + Space.before(tooth).volume() == pytest.approx(whole, rel=1e-12)
    solid = built_sample("rack").solid("rack", TOLERANCE, space=True)
    assert solid.measured.watertight


def test_a_space_is_between_its_teeth_in_the_frame_of_its_gear() -> None:
    """The overlap of gear and space is no thicker than what both may be off; together they are one body."""
    gears = built_sample("spiral_bevel_basic")
    meshes = [gears.solid("gear", TOLERANCE).mesh, gears.solid("gear", TOLERANCE, space=True).mesh]
    gear, space = (
        manifold3d.Manifold(manifold3d.Mesh64(mesh.vertices, mesh.triangles.astype(np.uint64))) for mesh in meshes
    )
    assert (gear ^ space).volume() < TOLERANCE * area(meshes[1])
    assert abs((gear + space).volume() - gear.volume() - space.volume()) < TOLERANCE * area(meshes[1])


def test_parallel_of_a_screw_involute_has_the_same_base_cylinder() -> None:
    """Flanks are turned by d / (r_b cos(beta_b)): all vertices of the solid are on the screw involute of the thicker tooth."""
    gears, beta, d = gm.gear(21, module=3.0, helix=18.0), np.radians(18.0), -0.3
    radius = 1.5 * 21 / np.cos(beta)
    base = radius * np.cos(np.arctan(np.tan(np.radians(20.0)) / np.cos(beta)))
    cos_base = np.sqrt(1.0 - (np.sin(beta) * np.cos(np.radians(20.0))) ** 2)
    thickness = []
    for offset in (0.0, d):
        mesh = gears.solid("gear", TOLERANCE, offset=offset).mesh.only("flank_left")
        x, y, z = mesh.vertices[np.hypot(*mesh.vertices[:, :2].T) > base].T
        pressure = np.arccos(base / np.hypot(x, y))
        angle = np.arctan2(y, x) + np.tan(pressure) - pressure - z * np.tan(beta) / radius
        pitch = 2.0 * np.pi / 21
        angle -= pitch * np.round(angle / pitch)
        assert np.ptp(angle) < 1e-10
        thickness.append(angle.mean())
    assert thickness[1] - thickness[0] == pytest.approx(d / (base * cos_base), rel=1e-8)


@pytest.mark.parametrize("share", [0.02, pytest.param(-0.02, marks=pytest.mark.sweep)])
@pytest.mark.parametrize(
    ("design", "settings"),
    [
        (SADDLE, []),
        (SAMPLES / "helical.toml", ["pinion.hob={chamfer_diameter=130.5}"]),
        (SAMPLES / "hob_protuberance.toml", []),
        (SAMPLES / "rack.toml", []),
        (SAMPLES / "spur.toml", NEAR_BASE),
    ],
    ids=["drawn_root", "chamfer", "sharp_form_point", "crowned", "crowned_from_the_base_circle_on"],
)
@pytest.mark.sweep_cases("crowned-0.02", "crowned_from_the_base_circle_on-0.02")
def test_surfaces_meeting_in_edges_end_in_edges_of_moved_surfaces(
    design: Path, settings: list[str], share: float
) -> None:
    """Two tilted cutters leave fillets that end 60 deg beside the normal of the root drawn between them; hobs' chamfers meet flank
    and land at angles; ground flanks end in an edge of 12 deg. All that is generated is where it should be."""
    tooth = gm.build(gm.load(design, settings), alone=True).members["pinion"].tooth
    made, s = offset_tooth(tooth, share * tooth.height), np.linspace(0.0, 1.0, 5)
    grids = [made.grid(region, s, made.sections(s)) for region in made.regions]
    ends = [grid.points for grid in grids]
    for one, other in zip(ends, [*ends[1:], made.joint.to(made.pitch_angle).point(ends[0])], strict=True):
        assert np.abs(one[-1] - other[0]).max() < 1e-8
    for region, grid in zip(made.regions, grids, strict=True):
        surface = tooth.chain[region].surface
        if region.side is None or surface is None:
            continue
        places = grid.parameters[1:-1, 1:-1].reshape(-1, 2)
        points = grid.points[1:-1, 1:-1].reshape(-1, 3)
        # from beside it, for the foot to be found
        foot = nearest(surface, points, *(places + 1e-3).T)
        assert foot.converged.all()
        assert np.linalg.norm(points - foot.jet.r, axis=1) == pytest.approx(abs(share) * tooth.height, abs=1e-9)


def test_a_space_is_a_cad_solid() -> None:
    figures = built_sample("spiral_bevel_basic").cad("gear", 1e-3, space=True, offset=0.1).figures["gear"]
    assert figures["faces"] == 8
    assert abs(figures["volume_error"]) < 1e-6


@pytest.mark.sweep
def test_the_largest_offset_is_the_least_radius_of_curvature_of_the_fillet() -> None:
    """Least radius of curvature of a rack's fillet is the tool's own rounding. On a gear the rounding's centre, at the depth c,
    turns back on a curve of radius c^2 / (r + c) [Euler-Savary], which adds to the rounding. An offset the other way makes the
    tooth pointed."""
    rack, gear = member_of("rack", "rack"), member_of("spur", "pinion")
    c = 3.0 * (1.25 - 0.38 - 0.3)
    for member, radius in ((rack, 0.38 * 2.0), (gear, 0.38 * 3.0 + c**2 / (30.0 + c))):
        off = OFFSET_ACCURACY * member.tooth.height
        with pytest.raises(gm.errors.DesignError, match="would have a cusp") as refusal:
            offset_member(member, 50.0)
        bound = float(refusal.value.allowed.split()[2])
        assert bound == pytest.approx(radius, abs=2.0 * off)
        assert offset_member(member, bound).tooth.blank.tip != member.tooth.blank.tip


@pytest.mark.sweep
def test_largest_offset_turns_no_place_of_a_fillet_inside_out() -> None:
    """Face gear whose fillet is bent most between two of the sections at which an offset is proved. The largest offset is
    checked at 257 sections."""
    member = member_of("face_gear", "gear")
    with pytest.raises(gm.errors.DesignError, match="fillet right would have a cusp") as refusal:
        offset_member(member, 5.0)
    tooth = offset_member(member, float(refusal.value.allowed.split()[2])).tooth
    jet = tooth.grid(Region.FILLET_RIGHT, np.linspace(0.0, 1.0, 33), tooth.sections(np.linspace(0.0, 1.0, 257))).jet
    assert jet is not None
    density = area_density(jet)
    density = density * np.sign(density[0, 0])
    assert 0.0 <= density.min() < 0.01 * density.max()


@pytest.mark.sweep
@pytest.mark.parametrize("outer", [540.0, None])
def test_fillet_of_a_sharp_shaper_ends_with_its_corner_on_the_axis(outer: float | None) -> None:
    """At a radius R the axis of rolling is r = R N_s / N_2 from the shaper's, whose corner is c below it: what it leaves turns back
    with the radius c^2 / (r + c), nothing where the corner lies on that axis; outward offsets go as far."""
    keys = ["shaper.tip_radius=0", *([] if outer is None else [f"gear.outer_radius={outer}"])]
    member = gm.build(gm.load(SAMPLES / "face_gear.toml", keys)).members["gear"]
    radii = np.linspace(*member.tooth.blank.extent, 1001)
    corner = 0.5 * 28 * 6.35 + 1.25 * 6.35
    least = float(((corner - radii * 28 / 160) ** 2).min() / corner)
    with pytest.raises(gm.errors.DesignError, match="would have a cusp") as refusal:
        offset_member(member, 1.0)
    most = float(refusal.value.allowed.split()[2])
    # it is found to 1e-4 of the tooth's height, never beyond what there is
    assert least - 2e-3 <= most <= least + 1e-5
    assert (most == 0.0) == (outer is None)


@pytest.mark.sweep
def test_an_offset_leaves_a_land_and_a_body_under_the_teeth(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("gearmesh.teeth.offset.OFFSET_ACCURACY", 0.1)
    for bore, reason in ((53.4, "cut through the body"), (20.0, "is pointed")):
        with pytest.raises(gm.errors.DesignError, match=reason):
            gm.gear(21, module=3.0, bore=bore).solid("gear", offset="-1.2mm" if bore > 50.0 else "-5mm")


def test_parallel_of_an_arc_is_an_arc_and_corners_are_equidistant() -> None:
    arc, a = CircularMeridian((1.0, 20.0), 15.0), np.linspace(-4.0, 5.0, 7)
    for made, exact in zip(ParallelMeridian(arc, 0.5).at(a), CircularMeridian((1.0, 20.0), 14.5).at(a), strict=True):
        assert made == pytest.approx(exact, abs=1e-12)
    roof = Meridian(Joined.polyline(((-5.0, 10.0), (0.0, 12.0), (5.0, 11.0)))).parallel(0.5)
    (corner,) = roof.curve.corners
    r = np.array([[rho, 0.0, corner] for rho in roof.at(corner)[None]])
    # as far from both lines
    for slope in (0.4, -0.2):
        away = (r[0, 0] - 12.0 - slope * corner) / np.hypot(1.0, slope)
        assert away == pytest.approx(0.5, abs=1e-12)


def test_flanks_for_metrology_have_the_exact_surface_at_every_vertex(tmp_path: Path) -> None:
    gears = built_sample("double_helical")
    for suffix in (".vtp", ".ply"):
        gears.solid("pinion", TOLERANCE, flank_only="left", teeth=2).save(tmp_path / f"flank{suffix}")
    solid = gears.solid("pinion", TOLERANCE, flank_only="left", teeth=2)
    assert solid.complaints == []
    mesh, tooth = gm.io.read(tmp_path / "flank.vtp"), gears.members["pinion"].tooth
    data = meshio.read(tmp_path / "flank.ply").point_data
    assert set(mesh.region_names) == {"flank_left"}
    count = len(mesh.vertices) // 4
    # both teeth in either half
    jet = tooth.left.flank.jet(data["p"][:count], data["v"][:count])
    normals = np.stack([data[name][:count] for name in ("nx", "ny", "nz")], axis=-1)
    assert np.abs(jet.r - mesh.vertices[:count]).max() < 1e-12
    assert np.abs(jet.n - normals).max() < 1e-12
    every = np.stack([data[name] for name in ("nx", "ny", "nz")], axis=-1)
    a, b, c = np.moveaxis(mesh.corners(), 1, 0)
    facets = unit(np.cross(b - a, c - a))
    assert np.einsum("tki,ti->tk", every[mesh.triangles], facets).min() > 0.99
    assert np.abs(np.linalg.norm(every, axis=1) - 1.0).max() < 1e-12
    sections = tooth.sections(data["t"][:count])
    points = tooth.grid(Region.FLANK_LEFT, data["s"][None, :count], sections).points[0]
    assert np.abs(points - mesh.vertices[:count]).max() < 1e-9


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (
            "-o a.stl --offset 9",
            "--offset = 9 mm: the fillet right would have a cusp: its radius of curvature is smaller; allowed",
        ),
        ("-o a.stl --space --flank-only left", "--flank-only = left: a space has both flanks"),
        ("-o a.stl --space --teeth 2", "--teeth = 2: must be left out for --space"),
        ("-o a.svg --space", "--space = true: must be left out for .svg"),
        ("-o a.stl --flank-only top", "--flank-only = top: must be one of right, left, both"),
    ],
)
def test_refusals(arguments: str, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("gearmesh.teeth.offset.OFFSET_ACCURACY", 0.1)
    monkeypatch.chdir(tmp_path)
    assert refused("solid", SAMPLES / "helical.toml", "--member", "pinion", *arguments.split()).startswith(words)
    assert not list(tmp_path.iterdir())
