"""Teeth of cylindrical gears that run out into a thicker shaft: the tool at its stop makes them, and no tool is in them."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

import gearmesh as gm
from gearmesh import DesignError, Member
from gearmesh.cad.brep import exact_volume, spline_tooth
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.nearest import nearest
from gearmesh.kinds import Region, Side
from gearmesh.loaded.compliance.sector_grid import sector_grid
from gearmesh.mesh.hexahedra.hexahedra import Cells, on_breaks
from gearmesh.mesh.solid import gear_solid, prove

MODULE, TEETH, FACE, RADIUS = 2.0, 17, 25.0, 30.0
ALPHA = math.radians(20.0)
DEDENDUM, ROUNDING = 1.25 * MODULE, 0.38 * MODULE


def gear(helix: float, shaft: float = 42.0, **keys: object) -> Member:
    table = {
        "teeth": TEETH,
        "face_width": FACE,
        "bore": 8.0,
        "heel_shaft": {"diameters": [shaft], "lengths": [30.0]},
        "run_out_radius": RADIUS,
        **keys,
    }
    table = {key: value for key, value in table.items() if value is not None}
    design = gm.parse({"kind": "cylindrical", "module": MODULE, "helix_angle": helix, "gear": table})
    return gm.build(design).members["gear"]


def into_tool(points: Array, helix: float, stop: float) -> Array:
    """Largest depth (N,), mm, of points (N, 3) in a cutter with ribs, over its rolling and its feed up to z = stop.

    Each rib is a body of revolution about the cutter's axis with the tooth of the basic rack. While the cutter is fed it is
    straight along the trace. Written without the surfaces that are tested; depths are measured along the rack's pitch.
    """
    c, s = math.cos(helix), math.sin(helix)
    pitch_radius = 0.5 * MODULE * TEETH / c
    across, trace = np.array([0.0, c, -s]), np.array([0.0, s, c])
    axis = RADIUS - DEDENDUM
    centre = -DEDENDUM + ROUNDING
    aside = 0.25 * math.pi * MODULE - centre * math.tan(ALPHA) + ROUNDING / math.cos(ALPHA)
    depth = np.full(len(points), -np.inf)
    for roll in np.linspace(-1.3, 1.3, 2601):
        turned = np.array(
            [(math.cos(roll), math.sin(roll), 0.0), (-math.sin(roll), math.cos(roll), 0.0), (0.0, 0.0, 1.0)]
        )
        at = points @ turned.T - np.array([pitch_radius, 0.0, 0.0])
        beyond = np.maximum(at @ trace - stop * c, 0.0)
        height = axis - np.hypot(axis - at[:, 0], beyond)
        along = (at @ across + pitch_radius * roll * c + 0.5 * math.pi * MODULE) % (math.pi * MODULE)
        along = np.abs(along - 0.5 * math.pi * MODULE)
        flank = 0.25 * math.pi * MODULE - height * math.tan(ALPHA)
        edge = aside - np.sqrt(np.maximum(ROUNDING**2 - (height - centre) ** 2, 0.0))
        half = np.where(height < centre - ROUNDING * math.sin(ALPHA), edge, flank)
        over_tip = height + DEDENDUM
        inside = np.where(
            along > aside, np.minimum(over_tip, along - half), np.where(over_tip > 0.0, along - half, over_tip)
        )
        depth = np.maximum(depth, inside)
    return depth


@pytest.mark.sweep
@pytest.mark.parametrize("helix", [20.0, pytest.param(0.0, marks=pytest.mark.sweep)])
def test_the_tool_touches_run_outs_and_is_nowhere_in_them(helix: float) -> None:
    tooth = gear(helix).tooth
    low, high = tooth.blank.extent
    stop = tooth.right.face_breaks[len(tooth.right.face_breaks) // 2]
    t = (np.linspace(stop - 4.0, high - 0.01, 9) - low) / (high - low)
    for region in (Region.FLANK_RIGHT, Region.FLANK_LEFT, Region.FILLET_RIGHT, Region.FILLET_LEFT, Region.ROOT):
        points = tooth.grid(region, np.linspace(0.02, 0.98, 5), tooth.sections(t)).points
        depth = into_tool(points.reshape(-1, 3), math.radians(helix), stop)
        assert depth.max() < 1e-8
        # rolling in steps misses the touch by less than this
        assert depth.min() > -1e-4


@pytest.mark.parametrize(
    ("helix", "keys"),
    [(0.0, {"profile_shift": 0.5}), (25.0, {"profile_shift": 0.3, "heel_shaft": None, "toe_shaft": {}})],
)
def test_run_outs_end_before_flanks_of_shifted_profiles_do(helix: float, keys: dict[str, object]) -> None:
    """Form points of shifted teeth rise faster than the root: the height that is left is 0.05 modules."""
    shaft = {"diameters": [46.0], "lengths": [20.0]}
    tooth = gear(helix, shaft=46.0, **{k: shaft if v == {} else v for k, v in keys.items()}).tooth
    t = np.array([0.0 if "toe_shaft" in keys else 1.0])
    left = []
    for region in (Region.FLANK_RIGHT, Region.FLANK_LEFT):
        points = tooth.grid(region, np.array([0.0, 1.0]), tooth.sections(t)).points
        left.append(float(np.ptp(np.hypot(points[..., 0], points[..., 1]))))
    assert min(left) == pytest.approx(0.05 * MODULE, rel=0.05)


@pytest.mark.sweep
def test_solids_are_closed_and_full_depth_is_the_face_width() -> None:
    member = gear(20.0)
    low, high = member.tooth.blank.extent
    assert low == -0.5 * FACE
    assert member.body.ends[1] == pytest.approx(high + 30.0)
    solid = gear_solid(member, 0.05)
    proof = prove(solid, member.genus)
    assert proof.ok
    assert proof.volume == pytest.approx(exact_volume(member), rel=2e-3)
    # over the face width the teeth are those of the gear without a shaft
    plain = gear(20.0, heel_shaft=None, run_out_radius=None).tooth
    for region in (Region.FLANK_RIGHT, Region.FILLET_LEFT, Region.ROOT):
        s = np.linspace(0.0, 1.0, 4)
        points, same = (
            tooth.grid(
                region, s, tooth.sections((np.array([-12.0, 0.0, 12.49]) - low) / np.ptp(tooth.blank.extent))
            ).points
            for tooth in (member.tooth, plain)
        )
        assert points == pytest.approx(same, abs=1e-9)


@pytest.mark.sweep
@pytest.mark.parametrize("shafts", [("heel_shaft",), ("toe_shaft", "heel_shaft")])
def test_splines_of_helical_run_outs_split_at_the_crease(shafts: tuple[str, ...]) -> None:
    """0.1 um with few nodes: where a crease crossed the faces 202 x 129 nodes missed by 0.26 um."""
    shaft = {"diameters": [42.0], "lengths": [30.0]}
    member = gear(25.0, **{"heel_shaft": None, **dict.fromkeys(shafts, shaft)})
    teeth = spline_tooth(member.tooth, 1e-4)
    assert teeth.largest_deviation <= 1e-4
    assert len(teeth.bounds) == 2 + len(shafts)
    assert max(max(patch.control.shape[:2]) for row in teeth.patches.values() for patch in row) < 70
    # between the nodes, against the nearest points of the exact surfaces
    places = np.linspace(0.013, 0.987, 23)
    for link, row in teeth.patches.items():
        surface = member.tooth.chain[link.region].surface
        assert surface is not None
        whole = member.tooth.grid(
            link.region, np.linspace(0.0, 1.0, 41), member.tooth.sections(np.linspace(0.0, 1.0, 81))
        )
        assert whole.p is not None
        assert whole.v is not None
        for patch in row:
            points = patch.at(places, places).reshape(-1, 3)
            start = np.linalg.norm(points[:, None] - whole.points.reshape(-1, 3), axis=-1).argmin(axis=1)
            foot = nearest(surface, points, whole.p.ravel()[start], whole.v.ravel()[start]).jet.r
            assert np.linalg.norm(points - foot, axis=-1).max() < 1e-4
    # faces that meet share the points of their borders
    for before, after in pairwise(teeth.links):
        if before in teeth.patches and after in teeth.patches:
            for first, second in zip(teeth.patches[before], teeth.patches[after], strict=True):
                assert np.abs(first.control[-1] - second.control[0]).max() < 1e-9
    for row in teeth.patches.values():
        for first, second in pairwise(row):
            assert np.abs(first.control[:, -1] - second.control[:, 0]).max() < 1e-9


@pytest.mark.sweep
def test_step_solids_have_the_wall_before_the_teeth() -> None:
    pytest.importorskip("OCP")
    from gearmesh.cad.solid_part import solid_part
    from gearmesh.cad.volume import volume

    member = gear(20.0)
    part = solid_part(member, spline_tooth(member.tooth, 2e-2))
    assert volume(part) == pytest.approx(exact_volume(member), rel=1e-5)


@pytest.mark.parametrize(
    ("shaft", "keys", "key", "word"),
    [
        (39.0, {}, "gear.heel_shaft.diameters", "more than the tip diameter, 40.1821"),
        (30.0, {}, "gear.run_out_radius", "no shaft begins"),
        (42.0, {"run_out_radius": 4.0}, "gear.run_out_radius", "smaller than the teeth"),
        (42.0, {"end_chamfer": 0.5}, "gear.heel_shaft.diameters", "cannot run out"),
        (42.0, {"face_width": 12.0}, "gear.face_width", "longer than the face width"),
    ],
)
@pytest.mark.sweep_cases(
    "42.0-keys2-gear.run_out_radius-smaller than the teeth", "42.0-keys4-gear.face_width-longer than the face width"
)
def test_what_cannot_run_out_is_refused(shaft: float, keys: dict[str, object], key: str, word: str) -> None:
    with pytest.raises(DesignError) as refusal:
        gear(20.0, shaft, **keys)
    assert refusal.value.key == key
    assert word in str(refusal.value)


def test_stations_on_breaks_stay_there() -> None:
    """With more breaks than stations between them a second call moved other stations on to the breaks."""
    tooth = gear(20.0).tooth
    grid = on_breaks(tooth, sector_grid(tooth, Side.RIGHT, Cells(flank=6, fillet=3, thickness=2, rim=2, face=8)))
    assert np.array_equal(on_breaks(tooth, grid).t, grid.t)
