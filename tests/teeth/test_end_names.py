"""Toe and heel: the ends of the face by one name in keys, files, contact and finite elements, of internal gears too."""

from __future__ import annotations

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.tca import contact_path
from gearmesh.kernel.surface.levels import station_normal
from gearmesh.kinds import Region
from gearmesh.mesh.solid import gear_solid
from gearmesh.teeth.blank.body import end_names

RING = (
    "gear.rim=16",
    "gear.end_chamfer_toe=0.4",
    "gear.end_rounding_heel=0.2",
    "gear.toe_bore={diameters=[164],lengths=[3]}",
    "gear.bolts={count=1,diameter=4,circle=172,depth=7}",
)


@pytest.mark.parametrize(
    "sample", ["internal", "planetary", "beveloid_crossed", "rack", "spiral_bevel_abdullah_straight", "face_gear"]
)
@pytest.mark.sweep_cases("planetary", "spiral_bevel_abdullah_straight")
def test_the_toe_is_the_lower_or_inner_end(sample: str) -> None:
    for member in gm.build(gm.load(SAMPLES / f"{sample}.toml")).members.values():
        axial = member.tooth.blank.axial
        points = member.tooth.grid(Region.LAND, np.array([0.5]), member.tooth.sections([0.0, 1.0])).points[0]
        place = dict(zip(end_names(axial), points, strict=True))
        # planes: along the axis; cones and cylinders: away from apex or axis
        out = np.array([0.0, 0.0, 1.0]) if station_normal(axial)[0] == 0.0 else None
        toe, heel = (r @ out if out is not None else np.linalg.norm(r) for r in (place["toe"], place["heel"]))
        assert toe < heel


@pytest.mark.sweep
def test_keys_of_a_ring_are_of_the_ends_that_files_name() -> None:
    ring = gm.build(gm.load(SAMPLES / "internal.toml", RING)).members["gear"]
    mesh = gear_solid(ring, 0.02)
    z = {name: mesh.only(name).vertices[:, 2] for name in mesh.region_names}
    assert z["face_toe"].max() == z["face_toe"].min() == pytest.approx(-10.0)
    assert z["face_heel"].max() == z["face_heel"].min() == pytest.approx(10.0)
    # as wide as each asks for; a blind hole goes down from the heel
    assert np.ptp(z["edge_toe"]) == pytest.approx(0.4)
    assert z["edge_toe"].max() < 0.0
    assert np.ptp(z["edge_heel"]) == pytest.approx(0.2)
    assert z["edge_heel"].min() > 0.0
    assert (z["bolt"].min(), z["bolt"].max()) == pytest.approx((3.0, 10.0))
    outside = mesh.only("rim").vertices
    step = np.abs(np.hypot(outside[:, 0], outside[:, 1]) - 82.0) < 1e-9
    assert (outside[step, 2].min(), outside[step, 2].max()) == pytest.approx((-10.0, -7.0))


@pytest.mark.parametrize("tilt", [0.2, -0.2])
@pytest.mark.sweep_cases("-0.2")
def test_edge_contact_of_a_ring_is_named_by_where_it_is(tilt: float) -> None:
    pair = pair_of(gm.load(SAMPLES / "internal.toml", [f"assembly.gamma_v={tilt}"]))
    path = contact_path(solver_pair(pair).parts[0], np.linspace(-0.1, 0.1, 3))
    on = np.char.find(path.edge, "gear_toe") >= 0, np.char.find(path.edge, "gear_heel") >= 0
    assert on[0].any() or on[1].any()
    for own, z in zip(on, (-10.0, 10.0), strict=True):
        np.testing.assert_allclose(path.point2[own, 2], z, atol=1e-6)
