"""Tips and ends are any surface of revolution: throats, chamfered and conical tips, conical ends."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import GearPair, Member
from gearmesh.cad.brep import exact_volume, spline_tooth
from gearmesh.cad.section import member_section
from gearmesh.cad.solid_part import solid_part
from gearmesh.cad.step import write_step
from gearmesh.check.deviation import deviations
from gearmesh.check.members import roll_teeth
from gearmesh.contact.flanks import analyse
from gearmesh.kernel.surface.meridian import CircularMeridian, Joined, Meridian, Straight
from gearmesh.kinds import Body, ConeLevel, Level, PlaneLevel, Region, Side, TipEdge
from gearmesh.mesh.hexahedra.hex_quality import scaled_jacobian
from gearmesh.mesh.hexahedra.hexahedra import Cells, hex_mesh, plain_grid
from gearmesh.mesh.solid import gear_solid, prove
from gearmesh.mesh.tessellate import tessellate
from gearmesh.teeth.limits import member_limits

#: half of the face width, angle of conical ends from planes across the axis (rad), tolerance of meshes, mm
HALF, ANGLE, TOLERANCE = 25.0, 0.3, 5e-3
#: helix angle (rad) and pitch radius (mm) of the sample
HELIX = np.radians(15.0)
PITCH_RADIUS = 0.5 * 24 * 5.0 / np.cos(HELIX)
#: surface of the teeth, mm^2, at most
AREA = 1e5
#: mm within which points are on a surface
ON = 1e-12


@cache
def pair() -> GearPair:
    return gm.build(gm.load(SAMPLES / "helical.toml")).train.pairs[0]


def tip_radius() -> float:
    return float(pair().pinion.tooth.blank.tip.at(0.0))


def tips() -> dict[str, Meridian]:
    """A throat, one with a cylinder on either side, and a cylinder with conical ends."""
    radius = tip_radius()
    arc, corner = CircularMeridian((0.0, radius + 198.5), 200.0), float(np.sqrt(200.0**2 - 199.0**2))
    edge = Straight(radius - 0.5)
    polyline = ((-HALF, radius - 2.5), (-15.0, radius), (10.0, radius), (HALF, radius - 4.0))
    return {
        "throat": Meridian(arc),
        "throat_and_cylinder": Meridian(Joined((edge, arc, edge), (-corner, corner))),
        "conical_tip": Meridian(Joined.polyline(polyline)),
    }


def member(name: str, cone: float = 0.0) -> Member:
    """The pinion with a tip by its name, between planes or cones of an angle."""
    own = pair().pinion
    blank = replace(own.tooth.blank, tip=tips()[name])
    if cone:
        axial = ConeLevel(cone)
        across, up = axial.normal
        toe, heel = (across * tip_radius() + up * z for z in (-HALF, HALF))
        points = [
            (rho, (at - across * 45.0) / up) for at, rho in ((toe, 45.0), (toe, 20.0), (heel, 20.0), (heel, 45.0))
        ]
        body = Body(tuple(points), (Region.FACE_TOE, Region.BORE, Region.FACE_HEEL))
        blank = replace(blank, axial=axial, extent=(toe, heel), body=body)
    return replace(own, tooth=replace(own.tooth, blank=blank))


@pytest.mark.parametrize("axial", [PlaneLevel(0.0), ConeLevel(np.pi, 0.5), ConeLevel(0.5 * np.pi), ConeLevel(0.4, 3.0)])
@pytest.mark.parametrize(
    "curve", [CircularMeridian((24.0, 70.0), 40.0), Joined.polyline(((20.0, 35.0), (25.0, 34.0), (30.0, 36.0)))]
)
def test_level_and_surface_of_a_meridian_are_one(curve: Any, axial: Level) -> None:
    """r(z), z(r), or over any station coordinate: derivatives by differences, and the level is 0 on the surface."""
    if axial.gradient(np.array([1.0, 0.0, 0.0]))[2] < 0.0:
        # as that of an internal gear, w goes towards the axis
        curve = CircularMeridian((24.0, -70.0), 40.0, above=True)
    meridian, step = Meridian(curve, axial), 1e-6
    v = np.array([21.0, 24.3, 27.0])
    u = np.array([0.3, 2.0, -1.1])
    jet = meridian.jet(u, v)
    np.testing.assert_allclose(meridian.value(jet.r), 0.0, atol=ON * 100.0)
    np.testing.assert_allclose(axial.value(jet.r), v, atol=ON * 100.0)
    np.testing.assert_allclose(meridian.meeting(axial, v), v, atol=ON * 100.0)
    for k, (r_x, n_x) in enumerate(((jet.r_u, jet.n_u), (jet.r_v, jet.n_v))):
        ahead, behind = (meridian.jet(*(x + sign * step * (j == k) for j, x in enumerate((u, v)))) for sign in (1, -1))
        np.testing.assert_allclose(r_x, (ahead.r - behind.r) / (2.0 * step), atol=1e-7)
        np.testing.assert_allclose(n_x, (ahead.n - behind.n) / (2.0 * step), atol=1e-7)
    gradient = meridian.gradient(jet.r)
    np.testing.assert_allclose(gradient / np.linalg.norm(gradient, axis=-1)[:, None], jet.n, atol=1e-12)
    w = np.array([0.2, -0.5, 0.7])
    changed = (meridian.gradient(jet.r + step * w) - meridian.gradient(jet.r - step * w)) / (2.0 * step)
    np.testing.assert_allclose(meridian.hessian(jet.r, np.broadcast_to(w, jet.r.shape)), changed, atol=1e-7)


@pytest.mark.sweep_cases(
    "throat_and_cylinder-0.0", "conical_tip-0.3", "conical_tip-0.0", "throat-0.0", "throat_and_cylinder-0.3"
)
@pytest.mark.parametrize("cone", [0.0, ANGLE])
@pytest.mark.parametrize("name", ["throat", "throat_and_cylinder", "conical_tip"])
def test_a_member_with_any_tip_is_a_closed_solid_within_tolerance(name: str, cone: float) -> None:
    made = member(name, cone)
    tooth, tip = made.tooth, made.tooth.blank.tip
    for side in Side:
        # the tip edge lies on the flank and on the tip's own circles
        edge = tooth.flank_grid(side, [1.0], np.linspace(0.0, 1.0, 33)).points[0]
        np.testing.assert_allclose(tip.value(edge), 0.0, atol=ON * tip_radius())
        np.testing.assert_allclose(np.hypot(edge[:, 0], edge[:, 1]), tip.at(edge[:, 2]), atol=ON * tip_radius())
        # the involute helicoid in closed form: less its turn along the face and inv(alpha), all points have one angle
        rho, transverse = np.hypot(edge[:, 0], edge[:, 1]), np.arctan(np.tan(np.radians(20.0)) / np.cos(HELIX))
        pressure = np.arccos(PITCH_RADIUS * np.cos(transverse) / rho)
        turned = np.arctan2(edge[:, 1], edge[:, 0]) - edge[:, 2] * np.tan(HELIX) / PITCH_RADIUS
        assert np.ptp(turned - side.sign * (np.tan(pressure) - pressure)) * PITCH_RADIUS < ON * PITCH_RADIUS
        corners = tip.corners(tooth.blank.axial)
        assert np.isin(tooth.stations(tooth.face_breaks).round(9), np.round(corners, 9)).all()
        assert tooth.face_breaks.size == len(corners) == {"throat": 0}.get(name, 2)
    mesh = tessellate(tooth, TOLERANCE)
    assert max(found.largest for found in deviations(mesh).values()) < TOLERANCE
    proof = prove(gear_solid(made, TOLERANCE, mesh), made.genus)
    assert (proof.status, proof.watertight) == ("NoError", True)
    assert abs(proof.volume - made.plain_volume()) < TOLERANCE * AREA
    bricks = hex_mesh(tooth, np.array([0]), plain_grid(Cells(flank=5, fillet=4, thickness=2, rim=2, face=7)))
    assert scaled_jacobian(bricks.nodes, bricks.elements).min() > 0.5


def test_the_section_of_a_throated_member_reaches_its_tip() -> None:
    made = member("throat_and_cylinder")
    for z in (-24.0, -8.0, 0.0, 17.0):
        curves = [curve for contour in member_section(made, z, 1e-3).contours for curve in contour.curves]
        points = np.concatenate([curve.at(np.linspace(0.0, 1.0, 5)) for curve in curves])
        assert np.hypot(*points.T).max() == pytest.approx(float(made.tooth.blank.tip.at(z)), abs=1e-9)


def test_a_broken_edge_follows_the_throat() -> None:
    tooth = replace(member("throat").tooth, tip_edge=TipEdge(0.4, rounded=True))
    sections = tooth.sections(np.linspace(0.0, 1.0, 5))
    land = tooth.grid(Region.LAND, [0.0, 1.0], sections).points
    np.testing.assert_allclose(tooth.blank.tip.value(land), 0.0, atol=1e-11)
    edge = tooth.grid(Region.EDGE_RIGHT, np.array([0.0, 1.0]), sections)
    np.testing.assert_allclose(edge.points[1], land[0], atol=1e-11)


@pytest.mark.sweep
@pytest.mark.sweep_cases("conical_tip")
@pytest.mark.parametrize("name", ["throat_and_cylinder", "conical_tip"])
def test_contact_goes_over_to_the_tip_edge_as_the_roll_test_says(name: str) -> None:
    """Behind the end of surface contact the tip edge, or its corner, touches: second route the roll test of two whole teeth."""
    rolled = replace(pair(), pinion=member(name))
    phi1 = np.radians([0.0, 14.0, 16.0])
    path = analyse(rolled, phi1)
    touch = roll_teeth(rolled, phi1, cells=64, guess_phi2=path.phi2)
    assert [bool(edge) for edge in path.edge] == [False, True, True]
    at_tip = rolled.pinion.tooth.blank.tip.value(path.point1)
    assert at_tip[0] < -0.1
    np.testing.assert_allclose(at_tip[1:], 0.0, atol=1e-6)
    for found, phi2, te in zip(touch, path.phi2, path.te, strict=True):
        assert found is not None
        assert abs(found.phi2 - phi2) < 1e-9 + 1e-6 * abs(te)


def test_limits_are_those_of_the_tip_at_each_station() -> None:
    limits = member_limits(member("throat"))
    plain = member_limits(pair().pinion)
    radii = tips()["throat"].at(limits.stations)
    np.testing.assert_allclose(limits.tip_radius, radii, atol=1e-12)
    # a lower tip has a wider land, each its own; where it would be pointed is a matter of the flanks alone
    assert ((limits.top_land > plain.top_land) == (radii < tip_radius())).all()


@pytest.mark.sweep
def test_step_files_of_any_tip_are_valid(tmp_path: Path) -> None:
    pytest.importorskip("OCP")
    from OCP.BRepCheck import BRepCheck_Analyzer
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps
    from OCP.STEPControl import STEPControl_Reader

    for name, cone in (("throat", 0.0), ("conical_tip", ANGLE)):
        made = member(name, cone)
        splines = spline_tooth(made.tooth)
        write_step(solid_part(made, splines), tmp_path / f"{name}.step", name)
        reader = STEPControl_Reader()
        reader.ReadFile(str(tmp_path / f"{name}.step"))
        reader.TransferRoots()
        shape, properties = reader.OneShape(), GProp_GProps()
        assert BRepCheck_Analyzer(shape).IsValid()
        BRepGProp.VolumeProperties_s(shape, properties)
        assert properties.Mass() == pytest.approx(exact_volume(made), abs=max(splines.deviation.values()) * AREA)
