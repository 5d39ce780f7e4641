"""Bounds of how far meshes are from their exact surfaces: never exceeded, and close to what is measured."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from oracles.places import SAMPLES
from scipy.spatial import cKDTree

import gearmesh as gm
from gearmesh import Member, io
from gearmesh.check.deviation import deviations
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import ConeLevel, Jet
from gearmesh.mesh.deviation.bound import DeviationBound, patch_bounds, solid_bound, tooth_bound
from gearmesh.mesh.deviation.edges import between_wedges
from gearmesh.mesh.deviation.facets import facet_bounds
from gearmesh.mesh.deviation.revolution import facet_distances
from gearmesh.mesh.solid import gear_solid
from gearmesh.mesh.tessellate import tessellate, tessellate_alike
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.systems.system import worm
from gearmesh.teeth.offset import offset_member

CORPUS = Path(__file__).parents[1] / "corpus"
#: how much larger than what is measured a bound may be
CLOSE = 1.25
#: designs, as different as they are: file, member, tolerance in mm
FEW = (
    ("internal", "gear", 0.1),
    ("undercut_modified_involute_sensible_2066", "pinion", 0.1),
    # its flanks are singular just below the form point, which chords of the seam with the fillet pass
    ("circular_arc", "pinion", 0.1),
)
MANY = (
    *FEW,
    ("fold_spiral_bevel_edge_2080", "pinion", 0.1),
    ("helical", "pinion", 0.01),
    ("thread_beveloid_one_tooth", "pinion", 0.1),
    ("overlap_beveloid_five_teeth_wide", "pinion", 0.05),
    ("novikov", "worm", 0.05),
    ("face_gear", "gear", 0.05),
    ("hypoid", "gear", 0.02),
    ("saddle_spiral_bevel_tilted", "pinion", 0.1),
    ("double_helical", "pinion", 0.05),
    ("solid_beveloid_sensible_2019", "pinion", 0.01),
)


def member_of(name: str, part: str) -> Member:
    """Without what is cut into the body, of which another mesh cannot be the same."""
    files = (SAMPLES / f"{name}.toml", CORPUS / f"{name}.toml")
    design = gm.load(next(file for file in files if file.exists()))
    member = worm(design).member if part == "worm" else gm.build(design).members[part]
    return replace(member, features=member.features.uncut)


def solid_within(member: Member, tolerance: float) -> tuple[TriangleMesh, DeviationBound]:
    teeth = tessellate_alike(member.different_teeth, tolerance)
    solid = gear_solid(member, tolerance, *teeth)
    return solid, solid_bound(member, teeth, solid)


def places(mesh: TriangleMesh, count: int, pitch: float) -> Array:
    """Points (count, 3) of the mesh near one tooth, half of them as many on every facet, a quarter on edges."""
    rng, corners = np.random.default_rng(29), mesh.corners()
    near = np.flatnonzero(np.abs(np.arctan2(*corners.mean(axis=1).T[1::-1])) < 1.5 * pitch)
    area = np.linalg.norm(np.cross(*np.moveaxis(np.diff(corners[near], axis=1), 1, 0)), axis=1)
    facets = np.concatenate((rng.choice(near, count // 2), rng.choice(near, count - count // 2, p=area / area.sum())))
    shares = rng.dirichlet((1.0, 1.0, 1.0), count)
    shares[::4, 0] = 0.0
    points: Array = np.einsum("nk,nkx->nx", shares / shares.sum(axis=1, keepdims=True), corners[facets])
    return points


def farthest(points: Array, mesh: TriangleMesh) -> float:
    """Largest distance (mm) of points (N, 3) from a mesh, by VTK."""
    import pyvista as pv

    surface = pv.PolyData.from_regular_faces(mesh.vertices, mesh.triangles.astype(int))
    return float(np.abs(pv.PolyData(points).compute_implicit_distance(surface)["implicit_distance"]).max())


def holds(name: str, part: str, tolerance: float, count: int, finer: float) -> None:
    """Random points of the solid against a much finer one, which stands for the exact gear, and of this against the solid."""
    member = member_of(name, part)
    solid, bound = solid_within(member, tolerance)
    exact, rest = solid_within(member, tolerance / finer)
    pitch = member.tooth.pitch_angle
    there, back = farthest(places(solid, count, pitch), exact), farthest(places(exact, count, pitch), solid)
    assert rest.largest < CLOSE * tolerance / finer
    assert max(there, back) <= bound.largest + rest.largest
    assert bound.sampled <= bound.largest <= CLOSE * bound.sampled
    # what is measured is there
    assert bound.sampled - rest.largest <= CLOSE * max(there, back)


@pytest.mark.sweep_cases("undercut_modified_involute_sensible_2066-pinion-0.1", "internal-gear-0.1")
@pytest.mark.parametrize(("name", "part", "tolerance"), FEW)
def test_random_points_never_exceed_the_bound(name: str, part: str, tolerance: float) -> None:
    holds(name, part, tolerance, 3_000, 12.0)


@pytest.mark.sweep
@pytest.mark.parametrize(("name", "part", "tolerance"), MANY)
def test_a_million_random_points_never_exceed_the_bound(name: str, part: str, tolerance: float) -> None:
    holds(name, part, tolerance, 500_000 // len(MANY), 100.0)


@pytest.mark.sweep
@pytest.mark.sweep_cases("hypoid-gear")
@pytest.mark.parametrize(("name", "part"), [("spiral_bevel_basic", "pinion"), ("hypoid", "gear")])
def test_the_bound_is_above_what_another_route_measures(name: str, part: str) -> None:
    """Closest points by iteration, at other places of the facets, and closest facets of points of the surface."""
    mesh = tessellate(member_of(name, part).tooth, 0.1)
    measured = deviations(mesh)
    for patch in mesh.patches:
        found = patch_bounds(patch)
        assert measured[patch.region].largest <= found.largest * (1.0 + 1e-9)
        assert found.largest <= CLOSE * measured[patch.region].facets_to_surface


@pytest.mark.sweep_cases(
    "face_gear-gear--0.1",
    "worm_drive-wheel-0.2",
    "internal-gear-0.1",
    "helical-pinion--0.2",
    "spiral_bevel_basic-gear-0.15",
    "spur-pinion-0.3",
)
@pytest.mark.parametrize(
    ("name", "part", "distance"),
    [
        ("spur", "pinion", 0.3),
        ("helical", "pinion", -0.2),
        ("internal", "gear", 0.1),
        ("rack", "rack", -0.3),
        ("spiral_bevel_basic", "gear", 0.15),
        ("face_gear", "gear", -0.1),
        ("worm_drive", "wheel", 0.2),
    ],
)
def test_bounds_of_teeth_whose_surfaces_are_moved(name: str, part: str, distance: float) -> None:
    """Bounds of offset teeth are as close as bounds of the teeth themselves. They are not below the distances to closest
    points, found by iteration."""
    mesh = tessellate(offset_member(member_of(name, part), distance).tooth, 0.02)
    bound, measured = tooth_bound(mesh), max(one.largest for one in deviations(mesh).values())
    assert measured <= bound.largest * (1.0 + 1e-9)
    assert bound.sampled <= bound.largest <= CLOSE * bound.sampled
    assert bound.largest <= CLOSE * measured


def test_facets_of_a_cylinder() -> None:
    """A facet with an edge across is farthest in its middle: radius (1 - cos half the angle)."""
    surface, u, v = ConeLevel.of(20.0).surface, np.array([0.0, 0.3, 0.1]), np.array([0.0, 0.0, 30.0])
    points = surface.jet(u, v).r
    found = facet_bounds(surface, np.stack((u, v), axis=-1), points, np.array([[0, 1, 2]]))
    exact = 20.0 * (1.0 - np.cos(0.15))
    assert found.sampled == pytest.approx(exact, rel=1e-9)
    assert exact <= found.largest < 1.01 * exact
    assert found.sides.middles[0, 2] == pytest.approx(-exact, rel=1e-6)


@dataclass(frozen=True)
class Involute:
    """A cylinder over the involute of a circle by its roll angle u (rad), which is singular at its base, u = 0; v = z."""

    radius: float = 30.0

    def jet(self, u: Array, v: Array) -> Jet:
        u, v = np.broadcast_arrays(u, v)
        c, s, zero, r = np.cos(u), np.sin(u), np.zeros_like(u), self.radius
        along, normal = np.stack((c, s, zero), axis=-1), np.stack((s, -c, zero), axis=-1)
        place = r * (along + u[..., None] * normal) + v[..., None] * np.array([0.0, 0.0, 1.0])
        none = np.zeros_like(place)
        return Jet(place, normal, r * u[..., None] * along, none + np.array([0.0, 0.0, 1.0]), along, none)


def test_facets_at_the_base_of_an_involute() -> None:
    """The curvature there is infinite."""
    surface, u, v = Involute(), np.array([0.0, 0.25, 0.0, 0.25]), np.array([0.0, 0.0, 9.0, 9.0])
    points, triangles = surface.jet(u, v).r, np.array([[0, 1, 2], [1, 3, 2]])
    found = facet_bounds(surface, np.stack((u, v), axis=-1), points, triangles)
    chord, fine = points[1] - points[0], surface.jet(np.linspace(0.0, 0.25, 100_001), np.zeros(1)).r - points[0]
    exact = np.linalg.norm(np.cross(fine, chord), axis=1).max() / np.linalg.norm(chord)
    assert exact <= found.largest * (1.0 + 1e-9)
    assert found.largest <= CLOSE * exact


def wedge_points(first: float, second: float, edge: NDArray[np.float64]) -> Array:
    """Points of two half planes (in the plane) from `edge`, whose outward normals point at two angles."""
    along = np.linspace(0.0, 5.0, 5_001)[:, None]
    tangents = (np.array([np.sin(first), -np.cos(first)]), np.array([-np.sin(second), np.cos(second)]))
    return np.concatenate([edge + along * tangent for tangent in tangents])


@pytest.mark.parametrize("angle", [0.05, 0.9, 2.3])
@pytest.mark.parametrize("turn", [-2.5, 0.0, 0.3, 1.2])
def test_wedges_apart(angle: float, turn: float) -> None:
    """The distance of two wedges as sets of points."""
    w = 0.1 * np.array([np.cos(turn), np.sin(turn)])
    one, other = wedge_points(-0.5 * angle, 0.5 * angle, np.zeros(2)), wedge_points(-0.5 * angle, 0.5 * angle, w)
    inner = [each[np.linalg.norm(each, axis=1) < 3.0] for each in (one, other)]
    exact = max(cKDTree(other).query(inner[0])[0].max(), cKDTree(one).query(inner[1])[0].max())
    normals = [np.array([np.cos(a), np.sin(a)]) for a in (-0.5 * angle, 0.5 * angle)]
    found = between_wedges(*(np.array(normal @ w) for normal in normals), np.array(np.cos(angle)))
    assert found == pytest.approx(exact, abs=1e-5)


def test_facets_between_rings() -> None:
    """Against many points of facets of a cone, a cylinder and a plane."""
    rng = np.random.default_rng(1)
    level = ConeLevel.of(12.0, -0.7)
    z, angle = rng.uniform(0.0, 9.0, (200, 3)), rng.uniform(-0.3, 0.3, (200, 3))
    for slope in (-0.7, 0.0):
        level = ConeLevel.of(12.0, slope)
        rho = level.at(z)
        corners = np.stack((rho * np.cos(angle), rho * np.sin(angle), z), axis=-1)
        q = rng.dirichlet((0.5, 0.5, 0.5), 3_000) @ corners
        exact = np.abs(level.value(q)).max(axis=1)
        found = facet_distances(corners)
        assert (exact <= found + 1e-12).all()
        assert (found <= 1.03 * exact + 1e-6).all()
    plane = np.stack((z * np.cos(angle), z * np.sin(angle), np.full_like(z, 5.0)), axis=-1)
    assert facet_distances(plane).max() == 0.0


def test_rounding_of_the_file_is_part_of_the_bound(tmp_path: Path) -> None:
    """Half a step of float32 at 64 to 128 mm is 3.8e-6 mm a coordinate, and the file is read as it was proved."""
    gears = gm.build(gm.load(SAMPLES / "helical.toml", ["pinion.bore=0"]))
    exact = gears.solid("pinion", 0.1, file=tmp_path / "pinion.ply")
    rounded = gears.solid("pinion", 0.1, file=tmp_path / "pinion.stl")
    rounded.save(tmp_path / "pinion.stl")
    vertices = io.read(tmp_path / "pinion.stl").vertices
    moved = 1e3 * float(cKDTree(rounded.mesh.vertices).query(vertices)[0].max())
    added = float(rounded.measured.max_deviation - exact.measured.max_deviation)
    assert 1e-3 < moved < np.sqrt(3.0) * 3.82e-3
    assert added == pytest.approx(moved, rel=1e-6)
    assert rounded.measured.sampled_deviation == exact.measured.sampled_deviation


def test_a_file_keeps_the_tolerance_with_its_rounding() -> None:
    """The mesh within it is not within it any more as STL: a finer one is."""
    gears = gm.build(gm.load(SAMPLES / "spur.toml"))
    exact, rounded = (gears.solid("pinion", "0.05um", file=name) for name in ("x.ply", "x.stl"))
    assert exact.measured.max_deviation <= 0.05
    assert exact.measured.max_deviation + 1e-3 > 0.05
    assert rounded.measured.triangles > exact.measured.triangles
    assert rounded.measured.max_deviation <= 0.05
    assert rounded.complaints == []


def test_a_part_of_a_tooth_has_edges_between_its_links() -> None:
    member = member_of("helical", "pinion")
    few = tessellate(member.tooth, 0.1, member.tooth.regions[1:4])
    bound = tooth_bound(few)
    assert 0.0 < bound.sampled <= bound.largest <= 0.1


@pytest.mark.sweep
def test_facets_beside_a_reversing_fillet_are_compared_with_its_near_part() -> None:
    """The bound was 4.4 m, of 1 m measured, and the mesh that was asked for then filled the memory."""
    wheel = member_of("bound_worm_drive_81", "wheel")
    bound = tooth_bound(tessellate(wheel.one_tooth, 0.02))
    assert bound.largest <= CLOSE * bound.sampled
    assert bound.sampled < 0.025
