"""Racks with modified flanks and broken tip edges: amounts, transmission error and volumes in closed form, solids and refusals."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import gearmesh as gm
from gearmesh import DesignError
from gearmesh.kernel.numeric.algebra import dot
from gearmesh.kinds import Region, Side
from gearmesh.teeth.micro_geometry.plane_flank import PlaneFlank
from gearmesh.teeth.region import FILLET_REGIONS

#: tables of modifications of both flanks, of the right and of the left one
TABLES: dict[str, Any] = {
    "modifications": {
        "helix_crowning": 0.008,
        "profile_crowning": 0.004,
        "end_relief_toe": {"amount": 0.01, "length": 3},
    },
    "modifications_right": {"tip_relief": {"amount": 0.012, "start_height": 0.8, "shape": "parabolic"}},
    "modifications_left": {"helix_slope": 0.005},
}


def rack(bar: dict[str, Any], **keys: Any) -> gm.Gears:
    """A pinion of 20 teeth and a rack of 5, 20 mm wide."""
    pinion = {"teeth": 20, "face_width": 20, **keys.pop("pinion", {})}
    table = {"teeth": 5, "face_width": 20, **bar}
    return gm.build(gm.parse({"kind": "rack", "module": 2, "backlash": 0.05, "pinion": pinion, "rack": table, **keys}))


def removed(side: Side, x: np.ndarray, z: np.ndarray, low: float) -> np.ndarray:
    """Return the amounts, mm, that TABLES remove at heights and places across the bar: parabolas and lines of ISO 21771."""
    amount = 0.008 * (z / 10.0) ** 2 + 0.004 * ((x - 0.5 * (low + 2.0)) / (0.5 * (2.0 - low))) ** 2
    amount += 0.01 * np.clip((-7.0 - z) / 3.0, 0.0, None)
    if side is Side.RIGHT:
        return np.asarray(amount + 0.012 * np.clip((x - 0.8) / 1.2, 0.0, None) ** 2)
    return np.asarray(amount + 0.005 * (z + 10.0) / 20.0)


@pytest.mark.quick
@pytest.mark.parametrize("helix", [0, 20])
@pytest.mark.sweep_cases("0")
def test_flanks_lie_behind_their_planes_by_what_is_removed(helix: int) -> None:
    """Distances along the line of action in the transverse plane; the fillets' ends are moved with the flanks."""
    tooth, plain = (rack(bar, helix_angle=helix).members["rack"].tooth for bar in (TABLES, {}))
    alpha = math.atan(math.tan(math.radians(20.0)) / math.cos(math.radians(helix)))
    for side, region in ((Side.RIGHT, Region.FLANK_RIGHT), (Side.LEFT, Region.FLANK_LEFT)):
        sections = tooth.sections(np.linspace(0.0, 1.0, 9))
        points = tooth.grid(region, np.linspace(0.0, 1.0, 11), sections).points
        nominal = plain.grid(region, np.array([0.5]), plain.sections([0.5]))
        (on,), (normal,) = nominal.points[0], nominal.normals[0]
        # from the plane along the bar, times the cosine: along the line of action
        behind = -dot(points - on, normal) / abs(normal[1]) * math.cos(alpha)
        low = float(points[..., 0].min())
        assert np.abs(behind - removed(side, points[..., 0], points[..., 2], low)).max() < 1e-12
        begins, ends = (0.0, 1.0) if side is Side.RIGHT else (1.0, 0.0)
        flank, fillet = (
            tooth.grid(link, np.array([at]), sections).points
            for link, at in ((region, begins), (FILLET_REGIONS[side], ends))
        )
        assert np.abs(flank - fillet).max() < 1e-9


@pytest.mark.quick
def test_the_transmission_error_is_that_of_an_involute_on_the_profile() -> None:
    """A true spur pinion on a crowned rack, in closed form.

    At the height h the profile leans by alpha', tan alpha' = tan alpha + a'(h) / cos alpha. Its normal n = (sin, cos) alpha'
    touches the base circle where an involute meets it, X cos alpha' - Y sin alpha' = r_b with X = D - h, which says where the bar
    is; and the involute's tangents lie r_b (phi + alpha' - alpha) farther out than at the pitch point, which says where the pinion
    is.
    """
    gears = rack({"modifications": {"profile_crowning": 0.006}})
    contact, tooth = gears.contact(cycle=False), gears.members["rack"].tooth
    h = np.array([row["height_mm"] for row in contact.params["rack"]])[1:]
    low = float(tooth.grid(Region.FLANK_RIGHT, np.zeros(1), tooth.sections([0.5])).points[0, 0, 0])
    x = (h - 0.5 * (low + 2.0)) / (0.5 * (2.0 - low))
    amount, rate = 0.006 * x**2, 0.012 * x / (0.5 * (2.0 - low))
    alpha, r = math.radians(20.0), 20.0
    leaning = np.arctan(math.tan(alpha) + rate / math.cos(alpha))
    s, c = np.sin(leaning), np.cos(leaning)
    bar = ((r - h) * c - r * math.cos(alpha)) / s
    phi = ((r - h) * s + bar * c - r * math.sin(alpha)) / (r * math.cos(alpha)) - leaning + alpha
    way = bar - h * math.tan(alpha) - amount / math.cos(alpha)
    expected = way - r * phi
    assert np.ptp(expected) > 5e-3
    travel = np.asarray(contact.path.te)[1:] * r
    assert np.ptp(travel - expected) < 1e-9


@pytest.mark.sweep
@pytest.mark.sweep_cases("tip_chamfer-0", "tip_rounding-0", "tip_rounding-20")
@pytest.mark.parametrize("helix", [0, 20])
@pytest.mark.parametrize("edge", ["tip_chamfer", "tip_rounding"])
def test_solids_have_the_volume_of_the_sections(helix: int, edge: str) -> None:
    """Mesh, section and B-rep; and bars stay as long as their teeth, whatever is removed at one end of the face."""
    gears = rack({**TABLES, edge: 0.25}, helix_angle=helix)
    member, solid = gears.members["rack"], gears.solid("rack", 0.001)
    exact = member.plain_volume()
    assert solid.mesh.volume() == pytest.approx(exact, rel=1e-4)
    pitch = 2.0 * math.pi / math.cos(math.radians(helix))
    ends = solid.mesh.vertices[np.isclose(solid.mesh.vertices[:, 0], -2.5)]
    toe = ends[np.isclose(ends[:, 2], -10.0), 1]
    assert np.ptp(toe) == pytest.approx(5 * pitch, abs=1e-9)
    assert gears.section("rack", 0.0).cut.gap < 1e-9
    pytest.importorskip("OCP")
    figures = gears.cad("rack").figures["rack"]
    assert abs(figures["volume_error"]) < 5e-7
    assert figures["max_deviation_um"] < 0.1


@pytest.mark.quick
@pytest.mark.parametrize("edge", ["tip_chamfer", "tip_rounding"])
def test_broken_edges_take_their_own_section_off(edge: str) -> None:
    """A chamfer of c below the tip and on the land takes c^2 / 2 of every edge, a rounding the corner beyond
    a circle that touches land and flank."""
    c, alpha = 0.3, math.radians(20.0)
    broken, sharp = (rack(bar).members["rack"].tooth.volume() for bar in ({edge: c}, {}))
    # land and flank meet at 90 deg + alpha; tangent lengths c tan(45 deg - alpha / 2), the arc turns 90 deg - alpha
    turn = 0.5 * math.pi - alpha
    corner = 0.5 * c * c if edge == "tip_chamfer" else c * c * (math.tan(0.5 * turn) - 0.5 * turn)
    assert sharp - broken == pytest.approx(2.0 * 5.0 * 20.0 * corner, rel=1e-6)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("bar", "named"),
    [
        (
            {"tip_chamfer": 0.9},
            "rack.tip_chamfer = 0.9 mm: larger than the tooth's tip allows; allowed is at most 0.82",
        ),
        (
            {"tip_rounding": 1.4},
            "rack.tip_rounding = 1.4 mm: larger than the tooth's tip allows; allowed is at most 1.1",
        ),
        (
            {"tip_chamfer": 0.2, "tip_rounding": 0.2},
            "rack.tip_rounding = 0.2 mm: cannot be given together with tip_chamfer",
        ),
        (
            {"modifications": {"tip_relief": {"amount": 0.01, "start_diameter": 40}}},
            "rack.modifications.tip_relief.start_diameter = 40 mm: this flank has none; allowed is "
            "rack.modifications.tip_relief.start_height",
        ),
        (
            {"modifications": {"tip_relief": {"amount": 0.01, "start_height": 2.5}}},
            "allowed is between the flank's own ends, above -1.99",
        ),
        pytest.param(
            {"modifications": {"triangular_end_relief_tip": {"amount": 0.01, "length": 2}}},
            "rack.modifications.triangular_end_relief_tip: contact lines of spur gears have no such corner",
            marks=pytest.mark.sweep,
        ),
    ],
)
@pytest.mark.sweep_cases(
    "bar0-rack.tip_chamfer = 0.9 mm: larger than the tooth's tip allows; allowed is at most 0.82",
    "bar1-rack.tip_rounding = 1.4 mm: larger than the tooth's tip allows; allowed is at most 1.1",
    "bar4-allowed is between the flank's own ends, above -1.99",
)
def test_what_cannot_be_is_refused_in_a_line(bar: dict[str, Any], named: str) -> None:
    with pytest.raises(DesignError) as failure:
        rack(bar)
    assert named in str(failure.value)


@pytest.mark.quick
def test_heights_are_for_racks_alone() -> None:
    relief = {"tip_relief": {"amount": 0.01, "start_height": 0.5}}
    with pytest.raises(
        DesignError, match=r"pinion\.modifications\.tip_relief\.start_height = 0\.5 mm: this flank has none"
    ):
        rack({}, pinion={"modifications": relief})


@pytest.mark.quick
def test_contact_lines_lean_as_the_rolled_pinion_s_do() -> None:
    """A triangular relief begins along a contact line: those on the rack's plane are level lines of h + lean z."""
    gears = rack({"modifications": {"triangular_end_relief_tip": {"amount": 0.009, "length": 4}}}, helix_angle=20)
    flank = gears.members["rack"].tooth.side(Side.RIGHT).flank
    assert isinstance(flank, PlaneFlank)
    alpha, slope = flank.alpha_t, flank.slope
    # the transverse normal of a point (x, y) on the line of action passes the pitch point, for a displaced bar at every z
    z, way = np.linspace(-8.0, 8.0, 5), 0.3
    x = np.array([_met(flank, at, way) for at in z])
    lean = np.diff(x) / np.diff(z)
    assert lean == pytest.approx([-slope * math.sin(alpha) * math.cos(alpha)] * 4, rel=1e-9)
    assert flank.amount is not None
    ends = [flank.amount.jet(np.array([1.9]), np.array([end])).a[0] for end in (-10.0, 10.0)]
    assert sorted(ends)[0] == 0.0
    assert sorted(ends)[1] > 0.003


def _met(flank: PlaneFlank, z: float, way: float) -> float:
    """The height at which the plane, displaced by `way`, is met on the line of action in the section z."""
    heights = np.linspace(-2.0, 2.0, 3)
    y = flank.side * (-flank.half + heights * math.tan(flank.alpha_t)) + flank.slope * z + way
    # on the line of action y = -s x / tan(alpha)
    off = y + flank.side * heights / math.tan(flank.alpha_t)
    (a, b) = np.polyfit(heights, off, 1)
    return float(-b / a)


@pytest.mark.parametrize("helix", [0, 20])
@pytest.mark.sweep_cases("0")
def test_sharp_root_corners_leave_no_triangles_without_area(helix: int) -> None:
    """Fillets of no radius are lines: their nodes are one, and the solid is closed without them."""
    gears = rack({"tool_tip_radius": 0, "end_chamfer": 0.4}, helix_angle=helix)
    solid, teeth = gears.solid("rack"), gears.solid("rack", teeth=2)
    for mesh in (solid.mesh, teeth.mesh):
        corners = mesh.corners()
        areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
        assert areas.min() > 1e-6
        np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1.0)
    assert solid.figures["watertight"]
    # the border of open teeth is one line, and they are one sheet
    edges = teeth.mesh.triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2).astype(int)
    once, counts = np.unique(np.sort(edges, axis=1), axis=0, return_counts=True)
    border = once[counts == 1]
    assert counts.max() == 2
    assert (np.unique(border, return_counts=True)[1] == 2).all()
