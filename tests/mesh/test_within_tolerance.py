"""Meshes whose deviation was once told wrong: they keep their tolerance, and what is said of them is what they are."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from oracles.examples import some
from oracles.places import SAMPLES
from scipy.spatial import cKDTree

import gearmesh as gm
from gearmesh.check import deviation
from gearmesh.check.deviation import deviations
from gearmesh.kinds import Region
from gearmesh.mesh.tessellate import tessellate
from gearmesh.teeth.region import FLANK_REGIONS

#: triangles of a tooth that any of the corpus takes at most
MOST = 100_000
CORPUS = sorted((Path(__file__).parents[1] / "corpus").glob("solid_*.toml"))
#: of the solids, in modules, and mm at least
TOLERANCE, FINEST = 1e-3, 1e-3


@pytest.mark.sweep_cases("solid_spiral_bevel_edge_1009", "solid_worm_drive_172")
@pytest.mark.parametrize("file", some(CORPUS, 2), ids=lambda file: file.stem)
def test_a_random_design_keeps_its_tolerance(file: Path) -> None:
    built = gm.build(gm.load(file))
    tolerance = max(TOLERANCE * built.design.in_mm().given_module, FINEST)
    for name in built.members:
        tooth = tessellate(built.members[name].tooth, tolerance)
        # halving cells does not end where a cell is no better for being halved
        assert tooth.triangles < MOST
        assert built.solid(name, tolerance, file="x.stl").complaints == []


def test_a_flank_that_ends_at_its_base_is_continued_by_the_fillet() -> None:
    """Facets beside the form point lie over the fillet; turned back along its helix every section of the tooth is the middle
    one."""
    tooth = gm.build(gm.load(CORPUS[0].with_name("solid_beveloid_sensible_2019.toml"))).members["pinion"].tooth
    mesh = tessellate(tooth, 2.622e-3)
    found, sections, s = deviations(mesh), tooth.sections([0.0, 0.5, 1.0]), np.linspace(0.0, 1.0, 20_001)
    outline = [tooth.grid(region, s, sections[1:2]).points[:, 0, :2] for region in tooth.regions]
    tree, beyond = cKDTree(np.concatenate(outline)), 0
    turn = sections.right.tip_angle
    for patch in mesh.patches:
        if patch.region not in FLANK_REGIONS.values():
            continue
        q, t = ((deviation.SAMPLE_WEIGHTS @ each[patch.triangles]) for each in (patch.points, patch.nodes.t[:, None]))
        back = turn[1] - turn[0] - (turn[2] - turn[0]) * t[..., 0]
        x, y = q[..., 0], q[..., 1]
        turned = np.stack((x * np.cos(back) - y * np.sin(back), x * np.sin(back) + y * np.cos(back)), axis=-1)
        # a transverse distance is at most as much longer as the teeth are inclined
        assert 0.97 < found[patch.region].facets_to_surface / float(tree.query(turned)[0].max()) < 1.001
        beyond += int((np.hypot(x, y) < np.hypot(*outline[2][0])).sum())
    assert beyond > 10


@pytest.mark.sweep_cases("0.001")
@pytest.mark.parametrize("tolerance", [4e-3, 1e-3])
def test_what_the_mesher_says_is_what_is_measured(tolerance: float) -> None:
    """The largest distance may be neither at the centre of a facet nor in the middle of an edge."""
    mesh = tessellate(gm.build(gm.load(SAMPLES / "spiral_bevel_basic.toml")).members["pinion"].tooth, tolerance)
    found = deviations(mesh)
    for patch in mesh.patches:
        assert found[patch.region].largest < 1.005 * patch.deviation


@pytest.mark.sweep
def test_chords_of_end_faces_keep_the_tolerance_beside_their_middles() -> None:
    """Thread that runs out: its section curve is bent most at one end of a chord that grew by merging."""
    tolerance = 5e-3
    tooth = gm.build(gm.load(SAMPLES / "worm_drive_zk_oversize.toml")).members["worm"].tooth
    patch = tessellate(tooth, tolerance, (Region.FILLET_RIGHT,)).patches[0]
    for end in (0.0, 1.0):
        line = patch.nodes.end(end)
        s, points = patch.nodes.s[line], patch.points[line]
        fine = s[:-1, None] + np.diff(s)[:, None] * np.linspace(0.0, 1.0, 41)
        curve = tooth.grid(patch.region, fine.ravel(), tooth.sections([end])).points[:, 0].reshape(*fine.shape, 3)
        along = np.diff(points, axis=0)[:, None]
        off = np.linalg.norm(np.cross(curve - points[:-1, None], along), axis=-1) / np.linalg.norm(along, axis=-1)
        assert off.max() <= tolerance
