"""Whole members rolled: backlash in closed form, teeth of eccentric members, fillets, and the overlap of their solids."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.overlap import Overlap, overlap
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import GearPair, load
from gearmesh.check.members import MemberRoll, ToothTouch, roll_members, root_clearance
from gearmesh.check.roll import roll
from gearmesh.kernel.numeric.algebra import ARCSEC
from gearmesh.kinds import Region, Side
from gearmesh.mesh.solid import gear_solid, teeth_mesh
from gearmesh.mesh.tessellate import tessellate
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.teeth.region import FILLET_REGIONS, FLANK_REGIONS

CELLS = 20


def sample(name: str, *overrides: str) -> GearPair:
    return pair_of(load(SAMPLES / f"{name}.toml", overrides))


def both(rolled: MemberRoll) -> tuple[ToothTouch, ToothTouch]:
    assert rolled.drive is not None
    assert rolled.coast is not None
    return rolled.drive, rolled.coast


def overlap_at(pair: GearPair, tolerance: float, phi1: float, phi2: float) -> Overlap:
    pinion, gear = (gear_solid(member, tolerance) for member in pair.both)
    return overlap(pair, (pinion, gear), phi1, phi2)


@pytest.mark.sweep
def test_backlash_of_a_spur_pair_is_that_of_its_closed_form() -> None:
    """A normal backlash of 0.06 mm turns the gear by 0.06 / r_b2, whichever teeth touch."""
    pair = sample("spur")
    base = 0.5 * 40 * 3.0 * np.cos(np.radians(20.0))
    for rolled in roll_members(pair, np.array([-0.4, 0.3]) * pair.pitch, CELLS):
        drive, coast = both(rolled)
        assert abs(rolled.backlash - 0.06 / base) < 0.005 * ARCSEC
        assert [region.side for region in drive.regions] == list(pair.flanks)
        assert [region.side for region in coast.regions] == [side.other for side in pair.flanks]
        # conjugate: two pairs in mesh touch together, those that are past it are behind
        lags = sorted(pair.drive * (drive.phi2 - phi2) for phi2 in rolled.pairs.values())
        assert lags[0] >= 0.0
        assert lags[-1] > 100.0 * ARCSEC


@pytest.mark.sweep
def test_play_grows_with_the_centre_distance_as_involutes_have_it() -> None:
    """At the working angle of a larger centre distance the teeth part by 2 r_b (inv a' - inv a) on the base circles."""
    pair = sample("spur", "assembly.dx=0.4")
    base = np.array([10.0, 20.0]) * 3.0 * np.cos(np.radians(20.0))
    new, old = np.arccos(base.sum() / 90.4), np.radians(20.0)
    opened = 2.0 * base.sum() * ((np.tan(new) - new) - (np.tan(old) - old))
    (rolled,) = roll_members(pair, 0.02, CELLS)
    assert abs(rolled.backlash - (0.06 + opened) / base[1]) < 0.005 * ARCSEC


def tooth_meshes(pair: GearPair, coast: bool, tooth: int, tolerance: float) -> tuple[TriangleMesh, TriangleMesh]:
    """Flanks and fillets of the teeth of a pair, turned by whole pitches in the members' own frames."""
    meshes = []
    for k, (member, side) in enumerate(zip(pair.both, pair.flanks, strict=True)):
        which = side.other if coast else side
        links = [FILLET_REGIONS[which], FLANK_REGIONS[which]]
        mesh = tessellate(member.tooth, tolerance, tuple(links if which is Side.RIGHT else links[::-1]))
        back = tooth if k == 0 else tooth * int(np.sign(pair.ratio)) + (pair.drive if coast else 0)
        meshes.append(teeth_mesh(mesh, member.name, np.array([-round(member.mount.sign) * back])))
    return meshes[0], meshes[1]


@cache
def askew() -> tuple[GearPair, float, MemberRoll]:
    """Eccentric misaligned members, rolled at a rotation of the pinion."""
    pair = sample(
        "spiral_bevel_basic",
        *("assembly.gear_eccentricity=0.1", "assembly.gear_phase=70", "assembly.pinion_eccentricity=0.05"),
        *("assembly.dV=0.05", "assembly.d_delta=0.05"),
    )
    (rolled,) = roll_members(pair, phi1 := 0.2, CELLS)
    return pair, phi1, rolled


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("tooth", "coast"),
    [
        pytest.param(-1, False, marks=pytest.mark.sweep),
        (1, True),
        pytest.param(1, False, marks=pytest.mark.sweep),
        pytest.param(-1, True, marks=pytest.mark.sweep),
    ],
)
def test_every_tooth_of_eccentric_misaligned_members_stands_where_it_is(tooth: int, coast: bool) -> None:
    """Against meshes of that very tooth: the pairs of eccentric members are not alike."""
    pair, phi1, rolled = askew()
    phi2 = (rolled.coast_pairs if coast else rolled.pairs)[tooth]
    drive = -pair.drive if coast else pair.drive
    (met,) = roll(*tooth_meshes(pair, coast, tooth, 2e-4), pair.mounts, pair.ratio, phi1, drive, guess_phi2=phi2)
    # 0.4 um of facets at 70 mm are 1.2 arcsec; another tooth would stand 40 arcsec off
    assert abs(met.phi2 - phi2) < 1.5 * ARCSEC
    alike = rolled.pairs[0] if not coast else rolled.coast_pairs[0]
    assert alike != phi2


@pytest.mark.sweep
def test_a_tip_edge_in_a_fillet_is_found_with_its_region() -> None:
    """With the pinion's root as round as is standard the gear's tip is in its fillet on the coast side, 2.9 arcsec deep."""
    pair = sample("face_gear", "pinion.dedendum=1.25", "pinion.tool_tip_radius=0.25")
    phi1 = float(np.radians(-11.0))
    (rolled,) = roll_members(pair, phi1, 40)
    drive, coast = both(rolled)
    (later,) = roll_members(pair, float(np.radians(0.0)), 40)
    found = [each for each in (drive, coast, *both(later)) if any(not region.is_flank for region in each.regions)]
    assert found
    assert min(rolled.backlash, later.backlash) < -1.0 * ARCSEC
    # the gear's edge, on the pinion's fillet
    assert {each.regions[0].value.split("_")[0] for each in found} == {"fillet"}
    assert all(each.on_rims == (False, True) for each in found)


@pytest.mark.sweep
def test_members_that_are_free_do_not_overlap_and_those_that_jam_do() -> None:
    free, jammed = sample("spur"), sample("spur", "assembly.dx=-0.3")
    tolerance = 0.002
    (rolled,) = roll_members(free, 0.05, CELLS)
    middle = 0.5 * sum(each.phi2 for each in both(rolled))
    assert overlap_at(free, tolerance, 0.05, middle).volume == 0.0
    (rolled,) = roll_members(jammed, 0.05, CELLS)
    assert rolled.backlash < -100.0 * ARCSEC
    middle = 0.5 * sum(each.phi2 for each in both(rolled))
    found = overlap_at(jammed, tolerance, 0.05, middle)
    assert found.beyond(tolerance, tolerance)
    # teeth as wide as the gear's face: pieces are not longer, and lie between the axes
    for piece in found.beyond(tolerance, tolerance):
        assert np.ptp(piece.box[:, 2]) < 28.0 + 1e-6
        assert (np.abs(piece.box[:, 0]) < 89.7).all()


@pytest.mark.sweep
@pytest.mark.sweep_cases("0.005")
@pytest.mark.parametrize("tolerance", [0.02, 0.005])
def test_what_only_touches_overlaps_by_facets_alone(tolerance: float) -> None:
    pair = sample("spiral_bevel_basic")
    (rolled,) = roll_members(pair, 0.0, CELLS, coast=False)
    assert rolled.drive is not None
    solids = gear_solid(pair.pinion, tolerance), gear_solid(pair.gear, tolerance)
    found = overlap(pair, solids, 0.0, rolled.drive.phi2)
    assert found.pieces or tolerance < 0.02
    assert found.thickness < 2.0 * tolerance
    assert not found.beyond(tolerance, tolerance)
    # pushed into each other by five times the tolerance at the mean radius they do overlap
    push = 10.0 * tolerance / 70.0
    assert overlap(pair, solids, 0.0, rolled.drive.phi2 - pair.drive * push).beyond(tolerance, tolerance)


@pytest.mark.sweep
def test_a_lens_of_overlap_is_two_thirds_as_thick_as_deep() -> None:
    """Involutes pushed into each other by t along their common normal overlap in a lens with parabolas for faces."""
    pair = sample("spur")
    depth, base = 0.02, 0.5 * 40 * 3.0 * np.cos(np.radians(20.0))
    (rolled,) = roll_members(pair, 0.05, CELLS, coast=False)
    assert rolled.drive is not None
    found = overlap_at(pair, 0.0005, 0.05, rolled.drive.phi2 - pair.drive * depth / base)
    assert abs(found.thickness / depth - 2.0 / 3.0) < 0.1


def test_root_clearance_is_what_the_design_leaves() -> None:
    pair = sample("spur")
    found = np.array([root_clearance(pair, phi1, pair.ratio * phi1) for phi1 in np.linspace(0.0, pair.pitch, 9)])
    # dedendum 1.25 less addendum 1, on the nominal centre distance
    np.testing.assert_allclose(found.min(axis=0), 0.25 * 3.0, atol=2e-3)
    tight = sample("spur", "assembly.dx=-0.9")
    assert min(root_clearance(tight, 0.0, 0.0)) < -0.1


@pytest.mark.sweep
def test_the_gears_of_the_api_roll_too() -> None:
    gears = gm.build(gm.load(SAMPLES / "novikov.toml"))
    (rolled,) = roll_members(gears.pairs[0], 0.0, CELLS)
    drive, _ = both(rolled)
    assert drive.regions == (Region.FLANK_RIGHT, Region.FLANK_RIGHT)
    assert 0.0 < rolled.backlash < 10.0 * ARCSEC
