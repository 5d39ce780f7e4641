"""Broken tip edges on stations that are cones: their form, what they take off, and contact that ends where they begin."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from oracles.built import built_sample

import gearmesh as gm
from gearmesh.check.members import roll_teeth
from gearmesh.contact.flanks import analyse
from gearmesh.kernel.numeric.algebra import ARCSEC, Array
from gearmesh.kernel.surface.levels import station_normal
from gearmesh.kinds import Region, Side, TipEdge, Tooth, TrimError
from gearmesh.mesh.solid import gear_solid, prove
from gearmesh.systems.common.tooth_edges import edge_refusal
from gearmesh.teeth.region import TIP_EDGES

SIZE = 0.6


def tooth_of(edge: TipEdge) -> Tooth:
    return replace(built_sample("spiral_bevel_geometry2").pairs[0].pinion.tooth, tip_edge=edge)


def on_cone(tooth: Tooth, first: Array, second: Array) -> Array:
    """Distance (...,), mm, of points on one conical station along the cone: in a sector of a plane, by the law of cosines."""
    up = abs(station_normal(tooth.blank.axial)[1])
    a, b = (np.hypot(r[..., 0], r[..., 1]) / up for r in (first, second))
    theta = np.arctan2(first[..., 1], first[..., 0]) - np.arctan2(second[..., 1], second[..., 0])
    turn = up * np.arctan2(np.sin(theta), np.cos(theta))
    return np.asarray(np.sqrt((a - b) ** 2 + 4.0 * a * b * np.sin(0.5 * turn) ** 2))


@pytest.mark.quick
@pytest.mark.parametrize("side", Side)
def test_the_legs_of_a_chamfer_on_a_back_cone_are_its_size(side: Side) -> None:
    tooth = tooth_of(TipEdge(SIZE))
    t = np.linspace(0.0, 1.0, 5)
    sharp = replace(tooth, tip_edge=None).flank_grid(side, [1.0], t).points[0]
    first, middle, last = tooth.grid(TIP_EDGES[side], [0.0, 0.5, 1.0], tooth.sections(t)).points
    first, last = (first, last) if side is Side.RIGHT else (last, first)
    up = abs(station_normal(tooth.blank.axial)[1])
    rho, land = np.hypot(*first.T[:2]), np.hypot(*sharp.T[:2])
    theta = np.arctan2(*last.T[1::-1]) - np.arctan2(*sharp.T[1::-1])
    assert (land - rho) / up == pytest.approx(SIZE, abs=1e-10)
    assert side.sign * theta * land == pytest.approx(SIZE, abs=1e-10)
    assert np.hypot(*last.T[:2]) == pytest.approx(land, abs=1e-10)
    # straight on the cone
    assert on_cone(tooth, first, middle) + on_cone(tooth, middle, last) == pytest.approx(on_cone(tooth, first, last))


@pytest.mark.quick
def test_rounding_on_a_back_cone_is_a_tangent_circle() -> None:
    tooth = tooth_of(TipEdge(SIZE, rounded=True))
    sections = tooth.sections(np.linspace(0.0, 1.0, 5))
    edge = sections.right.edge
    assert edge is not None
    centre = edge[2]
    up = abs(station_normal(tooth.blank.axial)[1])
    round_it = tooth.grid(Region.EDGE_RIGHT, np.linspace(0.0, 1.0, 7), sections).points
    assert on_cone(tooth, round_it, centre) == pytest.approx(SIZE, abs=1e-10)
    land = np.hypot(*tooth.grid(Region.LAND, [0.0], sections).points[0].T[:2])
    assert (land - np.hypot(*centre.T[:2])) / up == pytest.approx(SIZE, abs=1e-10)
    # the nearest point of the flank is where the rounding begins
    flank = tooth.grid(Region.FLANK_RIGHT, 1.0 - np.array([0.0, 1e-4, 1e-3, 1e-2]), sections).points
    apart = on_cone(tooth, flank, centre)
    assert (apart[1:] > SIZE).all()
    assert (apart[1] - SIZE < 1e-6).all()


@pytest.mark.quick
@pytest.mark.parametrize("rounded", [False, True])
@pytest.mark.sweep_cases("False")
def test_what_a_tip_edge_takes_off(*, rounded: bool) -> None:
    """The area between flank, land and edge on each station, by Green's theorem in polar coordinates; stations are 1 mm apart."""
    tooth = tooth_of(TipEdge(SIZE, rounded))
    sharp = replace(tooth, tip_edge=None)
    nodes, weights = np.polynomial.legendre.leggauss(12)
    t, up = 0.5 * (nodes + 1.0), abs(station_normal(tooth.blank.axial)[1])
    area = np.zeros(t.size)
    s = np.linspace(0.0, 1.0, 2001)
    for one, sign in ((tooth, -1.0), (sharp, 1.0)):
        sections = one.sections(t)
        for region in one.regions:
            r = one.grid(region, s, sections).points
            square, theta = r[..., 0] ** 2 + r[..., 1] ** 2, np.unwrap(np.arctan2(r[..., 1], r[..., 0]), axis=0)
            area += sign * (0.5 * (square[1:] + square[:-1]) * np.diff(theta, axis=0)).sum(axis=0) / (2.0 * up)
    toe, heel = tooth.blank.extent
    removed = tooth.teeth * 0.5 * (heel - toe) * float(weights @ area)
    assert removed > 0.1 * SIZE**2 * tooth.teeth * (heel - toe)
    assert sharp.volume() - tooth.volume() == pytest.approx(removed, rel=1e-5)


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("sample", "size", "places"),
    [("spiral_bevel_geometry1", 1.0, (1.0, 0.75)), ("beveloid_crossed", 0.8, (-1.2, -0.8))],
)
def test_contact_ends_where_a_large_chamfer_begins(sample: str, size: float, places: tuple[float, ...]) -> None:
    """The solver's edge contact is at the chamfer's beginning, and the roll test, which rolls flank, chamfer and land, agrees."""
    plain = built_sample(sample).pairs[0]
    tooth = replace(plain.gear.tooth, tip_edge=TipEdge(size))
    pair = replace(plain, gear=replace(plain.gear, tooth=tooth))
    phi1 = np.array(places) * pair.pitch
    path, before = analyse(pair, phi1), analyse(plain, phi1)
    assert path.kind[0] == "edge"
    changed = np.abs(path.phi2 - before.phi2) > 0.1 * ARCSEC
    assert changed[0]
    side = pair.flanks[1]
    level = tooth.blank.tip.value(tooth.side(side).flank.jet(*path.params2[changed].T).r)
    assert level == pytest.approx(-size, rel=0.1)
    turns = np.array([touch.phi2 for touch in roll_teeth(pair, phi1, cells=24)])
    apart = np.angle(np.exp(1j * (turns - path.phi2)))
    assert np.abs(apart).max() < 0.002 * ARCSEC


@pytest.mark.sweep
def test_a_solid_with_roundings_on_back_cones_is_closed() -> None:
    pair = built_sample("spiral_bevel_geometry2").pairs[0]
    member = replace(pair.pinion, tooth=tooth_of(TipEdge(0.4, rounded=True)))
    solid = gear_solid(member, 0.05)
    assert prove(solid, member.genus).ok
    assert solid.volume() == pytest.approx(member.plain_volume(), rel=2e-3)


@pytest.mark.quick
@pytest.mark.parametrize(("angle", "lowest"), [(4.0, 0.0), (-4.0, 1.0)])
@pytest.mark.sweep_cases("-4.0-1.0")
def test_refusals_of_tip_edges_name_the_station_of_the_lowest_flank(angle: float, lowest: float) -> None:
    """They named the toe, wherever the flank was too low."""
    tip = {"teeth": 30, "face_width": 10, "tip_cone_angle": angle, "addendum": 0.2, "dedendum": 0.6}
    design = gm.parse({"kind": "cylindrical", "module": 2, "pinion": tip, "gear": {"teeth": 40, "face_width": 10}})
    tooth = replace(gm.build(design).members["pinion"].tooth, tip_edge=TipEdge(0.9))
    t = np.linspace(0.0, 1.0, 9)
    refused = []
    for k in range(t.size):
        try:
            tooth.sections(t[[k]])
        except TrimError:
            refused.append(t[k])
    # some are sound, and the lowest is not
    assert 0 < len(refused) < t.size
    assert lowest in refused
    with pytest.raises(TrimError, match="larger than the flank") as failure:
        tooth.sections(t)
    assert failure.value.station == lowest
    # the flank is as much lower than the chamfer
    excess = failure.value.excess
    assert excess is not None
    replace(tooth, tip_edge=TipEdge(0.9 - 1.001 * excess)).sections(t)
    with pytest.raises(TrimError):
        replace(tooth, tip_edge=TipEdge(0.9 - 0.999 * excess)).sections(t)


@pytest.mark.quick
def test_overlapping_fillets_name_the_station_where_they_overlap_most() -> None:
    tooth, t = tooth_of(TipEdge(SIZE)), np.array([0.0, 0.5, 1.0])
    with pytest.raises(TrimError, match="overlap") as failure:
        tooth._width_of_root(np.array([0.1, 0.0, -0.2]), np.zeros(3), t)
    assert (failure.value.station, failure.value.excess) == (1.0, pytest.approx(0.2))


@pytest.mark.quick
def test_too_large_tip_edges_are_refused_with_the_largest_that_fits() -> None:
    tooth = tooth_of(TipEdge(4.0))
    with pytest.raises(TrimError, match=r"pointed|larger than the flank") as failure:
        tooth.prove()
    refusal = edge_refusal("pinion", tooth, failure.value)
    assert str(refusal).startswith("pinion.tip_chamfer = 4 mm: larger than the tooth's tip allows; allowed is at most")
    limit = float(str(refusal).split("at most ")[1].split()[0])
    tooth_of(TipEdge(limit)).prove()
    with pytest.raises(TrimError):
        tooth_of(TipEdge(1.001 * limit)).prove()


@pytest.mark.quick
def test_the_keys_of_a_face_gear() -> None:
    assert built_sample("face_gear", "gear.tip_rounding=0.05").pairs[0].gear.tooth.tip_edge == TipEdge(0.05, True)
