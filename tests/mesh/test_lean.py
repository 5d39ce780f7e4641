"""Triangles of flanks and fillets against the fewest that any mesh can have, by an integral that knows no mesher."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.check.deviation import deviations
from gearmesh.kernel.numeric.algebra import Array, cross, dot
from gearmesh.kernel.surface.curvature import gaussian_curvature, shape_operator, tangent_basis
from gearmesh.kinds import Region, Side, Tooth
from gearmesh.mesh.deviation.bound import patch_bounds, tooth_bound
from gearmesh.mesh.links.collapse import independent
from gearmesh.mesh.tessellate import ToothMesh, tessellate
from gearmesh.systems.system import worm
from gearmesh.teeth.region import FILLET_REGIONS, FLANK_REGIONS

CURVED = {*FLANK_REGIONS.values(), *FILLET_REGIONS.values()}


@cache
def tooth_of(sample: str, member: str) -> Tooth:
    design = gm.load(SAMPLES / f"{sample}.toml")
    return worm(design).member.tooth if member == "worm" else gm.build(design).members[member].tooth


def fewest(tooth: Tooth, region: Region, order: int = 20) -> float:
    """Integral of sqrt(|k1 k2|) dA over c, mm: over the error the fewest triangles, c = 3 sqrt(3) / 2 or, on saddles, 2 sqrt(5)."""
    nodes, weights = np.polynomial.legendre.leggauss(order)
    x, w, step = 0.5 * (nodes + 1.0), 0.5 * weights, 1e-5

    def points(ds: float, dt: float) -> Array:
        return tooth.grid(region, x + ds, tooth.sections(x + dt)).points

    jet = tooth.grid(region, x, tooth.sections(x)).jet
    assert jet is not None
    normal = cross(points(step, 0.0) - points(-step, 0.0), points(0.0, step) - points(0.0, -step)) / (4.0 * step**2)
    gaussian = gaussian_curvature(shape_operator(jet, *tangent_basis(jet)))
    density = np.sqrt(np.abs(gaussian) * dot(normal, normal)) / np.where(gaussian > 0.0, 1.5 * np.sqrt(3.0), 20.0**0.5)
    return float(w @ density @ w)


def ratio(mesh: ToothMesh) -> float:
    """Triangles of flanks and fillets over the fewest, developable ones left out."""
    needs = {region: fewest(mesh.tooth, region) for region in mesh.tooth.regions if region in CURVED}
    bent = {region for region, need in needs.items() if need > 1e-6 * sum(needs.values())}
    taken = sum(len(patch.triangles) for patch in mesh.patches if patch.region in bent)
    return taken * max(patch.deviation for patch in mesh.patches) / sum(needs.values())


@pytest.mark.parametrize(
    ("sample", "member", "most"),
    [
        ("spiral_bevel_basic", "pinion", 1.5),
        ("novikov", "gear", 1.5),
        ("novikov", "worm", 1.5),
        ("circular_arc", "pinion", 1.5),
        ("internal", "gear", 1.5),
        ("double_helical", "pinion", 1.4),
        ("hypoid", "pinion", 1.5),
        # a tooth turns from the toe to the heel into another: triangles of its lines are merged where they are too small
        ("face_gear", "gear", 1.55),
        # borders ask for 1.13 and 1.17 times as many as the integral
        ("beveloid_crossed", "pinion", 1.7),
        ("beveloid_crossed", "gear", 1.8),
    ],
)
@pytest.mark.sweep_cases(
    "beveloid_crossed-gear-1.8",
    "beveloid_crossed-pinion-1.7",
    "face_gear-gear-1.55",
    "hypoid-pinion-1.5",
    "internal-gear-1.5",
    "circular_arc-pinion-1.5",
    "novikov-gear-1.5",
    "novikov-worm-1.5",
    "spiral_bevel_basic-pinion-1.5",
)
def test_flanks_and_fillets_take_few_triangles(sample: str, member: str, most: float) -> None:
    assert ratio(tessellate(tooth_of(sample, member), 0.01)) < most


@pytest.mark.sweep
def test_links_just_below_the_merging_ratio_are_merged_for_the_tooth() -> None:
    """One fillet has 1.49 times the fewest, its flank three times: all of the tooth had 1.51 with that fillet as it was."""
    assert ratio(tessellate(tooth_of("beveloid_crossed", "gear"), 0.0001)) < 1.45


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("sample", "member", "most", "times"),
    [
        ("face_gear", "gear", 80, 1.8),
        ("worm_drive", "wheel", 205, 1.5),
        ("spiral_bevel_basic", "pinion", 112, 1.55),
        ("zerol", "gear", 75, 1.5),
    ],
)
@pytest.mark.sweep_cases("spiral_bevel_basic-pinion-112-1.55", "worm_drive-wheel-205-1.5", "zerol-gear-75-1.5")
def test_seams_of_coarse_meshes_have_few_nodes_that_both_sides_share(
    sample: str, member: str, most: int, times: float
) -> None:
    """92, 240, 119 and 80 triangles with the seams that the plans ask for, 78, 194, 110 and 78 where all nodes stay once edges
    come to rest; nodes are on both surfaces, facets within the tolerance measured another way."""
    tooth = tooth_of(sample, member)
    mesh = tessellate(tooth, 0.1)
    assert mesh.triangles <= most
    assert ratio(mesh) < times
    assert max(measured.largest for measured in deviations(mesh).values()) <= 0.1
    turned = tooth.joint.to(tooth.pitch_angle)
    for k, patch in enumerate(mesh.patches):
        following = mesh.patches[(k + 1) % len(mesh.patches)]
        seam, first = patch.nodes.line(1.0), following.nodes.line(0.0)
        np.testing.assert_array_equal(patch.nodes.t[seam], following.nodes.t[first])
        points = following.points[first] if k + 1 < len(mesh.patches) else turned.point(following.points[first])
        np.testing.assert_allclose(patch.points[seam], points, rtol=0.0, atol=1e-9)


def test_lands_of_threads_that_run_out_have_no_nodes_inside() -> None:
    """A land is part of a cylinder: rulings from seam to seam are enough. It had 1,810 nodes inside."""
    tooth = gm.build(gm.load(SAMPLES / "worm_drive_zk_oversize.toml")).members["worm"].tooth
    land = tessellate(tooth, 0.004, (Region.LAND,)).patches[0]
    s, t = land.nodes.s, land.nodes.t
    assert ((s == 0.0) | (s == 1.0) | (t == 0.0) | (t == 1.0)).all()
    assert len(land.triangles) == s.size - 2
    assert patch_bounds(land, 0.0, 0.0038).largest <= 0.004


@pytest.mark.sweep
def test_links_none_of_whose_edges_can_collapse_stay_as_they_are() -> None:
    """Two links of this wheel have no edge that is near enough to the tolerance to be tried with its neighbours moved."""
    mesh = tessellate(tooth_of("worm_drive", "wheel"), 0.2)
    assert mesh.deviation <= 0.2


@pytest.mark.parametrize(("sample", "tolerance"), [("circular_arc", 0.01), ("spiral_bevel_basic", 0.1)])
@pytest.mark.sweep_cases("spiral_bevel_basic-0.1")
def test_sides_that_are_bent_most_beside_their_middles_keep_the_tolerance(sample: str, tolerance: float) -> None:
    """Distances estimated from middles and from end normals, to third order, left these meshes 0.33 and 1.4 um off, and solids
    were meshed twice."""
    assert tooth_bound(tessellate(tooth_of(sample, "pinion"), tolerance)).largest <= tolerance


@pytest.mark.sweep
def test_merged_triangles_keep_the_tolerance_between_edges_and_centres() -> None:
    """Long ones are bent to both sides: with middles of edges and centres alone measured some were 1.2 um off."""
    fillet = tessellate(tooth_of("hypoid", "pinion"), 0.001, (FILLET_REGIONS[Side.RIGHT],)).patches[0]
    assert patch_bounds(fillet, 0.0, 0.00095).largest <= 0.001


@pytest.mark.sweep
def test_merged_triangles_fill_their_links_upright_and_no_needles() -> None:
    """Every node of a seam stays, triangles fill the rectangle of s and t, none is thinner than the tolerance."""
    mesh = tessellate(tooth_of("face_gear", "gear"), 0.01)
    for patch in (patch for patch in mesh.patches if patch.region in CURVED):
        s, t, corners = patch.nodes.s, patch.nodes.t, patch.triangles
        assert np.unique(s).size > 10  # flanks had seven lines
        (a, b, c), (d, e, f) = s[corners].T, t[corners].T
        areas = 0.5 * ((b - a) * (f - d) - (c - a) * (e - d))
        assert (areas > 0.0).all()
        assert areas.sum() == pytest.approx(1.0, abs=1e-12)
        edges = np.sort(corners[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        counts = np.unique(edges, axis=0, return_counts=True)[1]
        ends = [patch.nodes.line(0.0), patch.nodes.line(1.0), patch.nodes.end(0.0), patch.nodes.end(1.0)]
        assert counts.max() == 2
        assert (counts == 1).sum() == sum(nodes.size - 1 for nodes in ends)
        assert s.size - counts.size + len(corners) == 1
        p, q, r = np.moveaxis(patch.points[corners], 1, 0)
        facet = cross(q - p, r - p)
        longest = np.max([np.linalg.norm(side, axis=1) for side in (q - p, r - q, p - r)], axis=0)
        assert (np.linalg.norm(facet, axis=1) / longest).min() > 0.0097
        assert (dot(facet, patch.normals) > 0.5 * np.linalg.norm(facet, axis=1)).all()


@pytest.mark.sweep
@pytest.mark.parametrize(("sample", "member"), [("beveloid_crossed", "pinion"), ("face_gear", "gear")])
def test_links_have_nodes_of_their_own_and_their_seams_in_common(sample: str, member: str) -> None:
    """Both links at a seam have its nodes, to the bit, the last one those of the next tooth; the lines between have fewer."""
    mesh = tessellate(tooth_of(sample, member), 0.005)
    count = len(mesh.patches)
    for k, patch in enumerate(mesh.patches):
        following, seam, first = mesh.patches[(k + 1) % count], patch.nodes.line(1.0), None
        first = following.nodes.line(0.0)
        np.testing.assert_array_equal(patch.nodes.t[seam], following.nodes.t[first])
        if k + 1 < count:
            np.testing.assert_allclose(patch.points[seam], following.points[first], rtol=0.0, atol=1e-9)
    sizes = {np.count_nonzero(patch.nodes.s == s) for patch in mesh.patches for s in np.unique(patch.nodes.s)}
    assert len(sizes) > 4


def test_a_tenth_of_the_tolerance_takes_ten_times_the_triangles() -> None:
    """First order in triangles: what lines and seams round up to whole numbers of cells becomes less and less."""
    meshes = [tessellate(tooth_of("spiral_bevel_basic", "pinion"), tolerance) for tolerance in (1e-2, 1e-3)]
    coarse, fine = (sum(len(p.triangles) for p in mesh.patches if p.region in CURVED) for mesh in meshes)
    assert 8.0 < fine * meshes[1].deviation / (coarse * meshes[0].deviation) * 10.0 < 10.5
    assert all(mesh.deviation <= mesh.tolerance for mesh in meshes)


@pytest.mark.sweep_cases("hypoid_high_ratio-gear")
@pytest.mark.parametrize(("sample", "member"), [("hypoid_high_ratio", "gear"), ("zerol", "pinion")])
def test_chords_of_seams_that_turn_within_the_surface_stay_beside_them(sample: str, member: str) -> None:
    """Beside the root a fillet's lines have no curvature across it, and all the more along it: chords left it by 0.2 mm."""
    mesh = tessellate(tooth_of(sample, member), 0.03)
    assert max(each.largest for each in deviations(mesh).values()) <= 0.03


def test_changes_that_need_no_triangle_are_chosen() -> None:
    """A link whose loose nodes had all gone was thinned without end: no turn was found for nodes without triangles."""
    nothing = np.empty(0, dtype=np.int64)
    assert independent(nothing, nothing, np.array([0.0, 1.0]), 3).tolist() == [0, 1]
    # beside changes that share a triangle, of which the cheaper one is chosen
    taken, taken_by = np.array([1, 1, 2]), np.array([0, 1, 1])
    assert independent(taken, taken_by, np.array([2.0, 1.0, 3.0, np.inf]), 3).tolist() == [1, 2]
