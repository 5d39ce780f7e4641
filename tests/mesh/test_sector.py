"""Sectors: closed, their cut faces congruent node by node and through the middles of roots, as heavy together as the gear."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import trimesh
from oracles.built import built
from oracles.places import SAMPLES
from scipy.spatial import cKDTree

import gearmesh as gm
from gearmesh import DesignError, Rigid
from gearmesh.kinds import Region
from gearmesh.mesh.extracts.sector import cyclic, genus_of, sector
from gearmesh.mesh.solid import gear_solid, prove

#: mm; coarse, and fine enough for a row of nodes in the middles of the roots
WITHIN, FINE = 0.05, 0.0005
#: share of a pitch that the cut may be beside the middles of the roots: it is straight between its rows
BESIDE_ROOT = 1.0 / 200.0


def sample(name: str, *settings: str) -> gm.Gears:
    return gm.build(gm.load(SAMPLES / f"{name}.toml", settings))


def gear(teeth: int, **keys: Any) -> gm.Gears:
    helix = {key: keys.pop(key) for key in ("helix_angle",) if key in keys}
    return built({"kind": "cylindrical", "module": 2, **helix, "gear": {"teeth": teeth, "face_width": 20, **keys}})


CASES = {
    "a row of nodes in the middles of the roots": (gear(11, modifications={"helix_crowning": "15um"}), "gear", 3),
    "twisted, without a bore": (gear(7, helix_angle=40, bore=0, profile_shift=0.5), "gear", 6),
    "internal": (gear(41, helix_angle=25, internal=True), "gear", 1),
    "two halves, a web, holes that the cuts go through": (sample("double_helical"), "gear", 19),
    "two halves that meet": (sample("double_helical", "gap=0"), "pinion", 2),
    "cones": (sample("hypoid"), "pinion", 5),
    "cylinders": (sample("face_gear_conjugate"), "gear", 10),
}


@pytest.mark.parametrize("case", CASES)
@pytest.mark.sweep_cases(
    "a row of nodes in the middles of the roots",
    "cones",
    "cylinders",
    "twisted, without a bore",
    "two halves, a web, holes that the cuts go through",
)
def test_sectors_are_closed_congruent_and_together_the_gear(case: str) -> None:
    gears, name, pitches = CASES[case]
    member, _ = cyclic(gears.member(name), pitches)
    whole, teeth = gear_solid(member, FINE if "nodes" in case else WITHIN), member.tooth.teeth
    mesh = sector(whole, member, pitches)
    assert prove(mesh, genus_of(mesh, member, pitches)).ok
    assert trimesh.Trimesh(mesh.vertices, mesh.triangles, process=False).is_volume
    assert mesh.volume() * teeth / pitches == pytest.approx(whole.volume(), rel=1e-12)
    first, last = mesh.only(Region.CUT_RIGHT), mesh.only(Region.CUT_LEFT)
    turned = Rigid.about_z(2.0 * np.pi * pitches / teeth).point(first.vertices)
    apart, partner = cKDTree(last.vertices).query(turned)
    assert apart.max() < 1e-12 * np.abs(mesh.vertices).max()
    assert sorted(partner) == list(range(len(first.vertices)))
    theirs = {frozenset(corners) for corners in last.triangles.tolist()}
    assert {frozenset(corners) for corners in partner[first.triangles].tolist()} == theirs


@pytest.mark.parametrize("case", ["twisted, without a bore", "cones"])
@pytest.mark.sweep_cases("cones")
def test_cuts_follow_the_middles_of_the_roots(case: str) -> None:
    gears, name, _ = CASES[case]
    member = gears.members[name]
    tooth, mesh = member.tooth, sector(gear_solid(member, WITHIN), member, 2)
    root, cut = (mesh.triangles[mesh.regions == mesh.region_names.index(of)] for of in (Region.ROOT, Region.CUT_RIGHT))
    nodes = mesh.vertices[np.intersect1d(root, cut)]
    right, left = tooth.root_ends
    stations, wanted = tooth.blank.axial.value(right), 0.5 * (np.unwrap(polar(right)) + np.unwrap(polar(left)))
    order = np.argsort(stations)
    middle = np.interp(tooth.blank.axial.value(nodes), stations[order], wanted[order]) - 0.5 * tooth.pitch_angle
    # the mean of both ends of a tooth's fillets is half a pitch from the root's
    beside = np.angle(np.exp(1j * (polar(nodes) - middle)))
    assert np.abs(beside).max() < BESIDE_ROOT * tooth.pitch_angle
    assert np.ptp(np.unwrap(np.sort(polar(nodes)))) > 0.5 * tooth.pitch_angle


def polar(points: np.ndarray) -> np.ndarray:
    return np.arctan2(points[..., 1], points[..., 0])


@pytest.mark.sweep
def test_a_sector_made_after_the_gear_has_its_teeth() -> None:
    """The tooth of the whole gear has not been searched for undercut yet. The search changes its sections by rounding alone."""
    gears = gm.build(gm.load(SAMPLES.parent / "tests" / "corpus" / "sector_beveloid_cone.toml"))
    whole, part = gears.solid("pinion", 0.02), gears.solid("pinion", 0.02, sector=1)
    assert part.measured.max_deviation == pytest.approx(whole.measured.max_deviation, rel=1e-9)
    assert 23 * part.mesh.volume() == pytest.approx(whole.mesh.volume(), rel=1e-12)


def test_what_does_not_repeat_is_left_out_with_a_line() -> None:
    gears = sample("double_helical")
    member, warnings = cyclic(gears.member("gear"), 2)
    assert member.holes is None
    assert "none of the 6 holes" in warnings[0]
    solid = gears.solid("pinion", WITHIN, sector=2)
    assert "no keyway" in solid.warnings[-1]
    assert solid.measured.watertight
    assert (solid.figures["pitches"], solid.figures["sector_angle_deg"]) == (2, pytest.approx(720.0 / 23.0))


@pytest.mark.parametrize(
    ("settings", "said"),
    [
        ({"sector": 0}, "sector = 0: must be a whole number above 0"),
        ({"sector": 20}, "from 1 to 19; without it the gear is whole"),
        ({"sector": 2, "teeth": 2}, "teeth = 2: must be left out with sector"),
    ],
)
def test_sectors_that_there_are_not(settings: dict[str, int], said: str) -> None:
    with pytest.raises(DesignError, match=said):
        gear(20).solid("gear", WITHIN, **settings)
    with pytest.raises(DesignError, match="left out for the rack, which does not turn"):
        sample("rack").solid("rack", WITHIN, sector=2)
