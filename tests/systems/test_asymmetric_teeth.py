"""Asymmetric teeth: two base circles, fillets against a rack in all positions, contact of both sides."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from oracles.built import built

import gearmesh as gm
from gearmesh import DesignError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import Region, Side
from gearmesh.teeth.region import FILLET_REGIONS, FLANK_REGIONS

DRIVE, COAST = 25.0, 17.0
TOLERANCES = "Flank tolerances [ISO 1328-1:2013]"
SPUR: dict[str, Any] = {
    "kind": "beveloid",
    "module": 2,
    "backlash": 0.1,
    "pressure_angle": DRIVE,
    "coast_pressure_angle": COAST,
    "pinion": {"teeth": 20, "face_width": 15, "profile_shift": 0.3},
    "gear": {"teeth": 41, "face_width": 15, "profile_shift": -0.1},
}


def with_helix(beta: float, **more: Any) -> dict[str, Any]:
    keys = {**SPUR, **more}
    inside = keys["gear"]["teeth"] < 0
    return {
        **keys,
        "pinion": {**keys["pinion"], "helix_angle": beta},
        "gear": {**keys["gear"], "helix_angle": beta if inside else -beta},
    }


RING = {"teeth": -50, "face_width": 15, "addendum": 0.7, "profile_shift": 0.1}


def cylindrical(keys: dict[str, Any], **more: Any) -> dict[str, Any]:
    """The same teeth by the keys of kind cylindrical."""
    members = {
        name: {key: value for key, value in keys[name].items() if key != "helix_angle"} | {"tool_tip_radius": 0.38}
        for name in ("pinion", "gear")
    }
    helix = keys["pinion"].get("helix_angle", 0.0)
    return {**keys, "kind": "cylindrical", "helix_angle": helix, **members, **more}


@pytest.mark.sweep
@pytest.mark.parametrize("flank", ["right", "left"])
@pytest.mark.parametrize(
    "keys", [with_helix(0.0), with_helix(15.0), with_helix(10.0, gear=RING)], ids=["spur", "helical", "ring"]
)
@pytest.mark.sweep_cases("helical-left", "helical-right", "ring-left", "ring-right", "spur-left")
def test_both_sides_are_conjugate_without_backlash_at_the_distance_of_both(keys: dict[str, Any], flank: str) -> None:
    summary = built({**keys, "contact": {"flank": flank}}).contact([-6.0, 0.0, 6.0]).summary
    assert summary["te_peak_to_peak_arcsec"] < 1e-9 * 3600.0
    # the backlash is normal to the drive flanks; along the pitch circle it is the same for both sides
    normal = 0.1 if flank == "right" else 0.1 * math.cos(math.radians(COAST)) / math.cos(math.radians(DRIVE))
    assert summary["backlash_normal_min_mm"] == pytest.approx(normal, abs=1e-9)
    tight = built({**keys, "backlash": 0.0, "contact": {"flank": flank}}).contact([-6.0, 0.0, 6.0]).summary
    assert tight["backlash_normal_min_mm"] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("kind", ["beveloid", "cylindrical", "shaped"])
@pytest.mark.parametrize("beta", [0.0, 15.0])
@pytest.mark.parametrize("name", ["pinion", "gear"])
def test_flanks_are_involutes_of_their_base_circles(name: str, beta: float, kind: str) -> None:
    keys = with_helix(beta) if kind == "beveloid" else cylindrical(with_helix(beta))
    if kind == "shaped":
        keys = {
            **keys,
            **{
                member: {**keys[member], "shaper": {"teeth": 24}, "tool_tip_radius": 0.3}
                for member in ("pinion", "gear")
            },
        }
    tooth, spec = built(keys).members[name].tooth, keys[name]
    helix = math.radians(beta if name == "pinion" else -beta)
    radius = spec["teeth"] / math.cos(helix)
    reduction = 0.025 / math.cos(math.radians(DRIVE))
    for side, alpha in ((Side.RIGHT, math.radians(DRIVE)), (Side.LEFT, math.radians(COAST))):
        alpha_t = math.atan(math.tan(alpha) / math.cos(helix))
        base, twist = radius * math.cos(alpha_t), math.tan(helix) / radius
        half = (0.5 * math.pi + 2.0 * spec["profile_shift"] * math.tan(alpha) - reduction) / math.cos(helix) / radius
        r = tooth.flank_grid(side, np.linspace(0.0, 1.0, 7), np.linspace(0.0, 1.0, 5)).points
        theta = np.sqrt((np.hypot(r[..., 0], r[..., 1]) / base) ** 2 - 1.0)
        turned = np.arctan2(r[..., 1], r[..., 0]) - twist * r[..., 2]
        at = half + math.tan(alpha_t) - alpha_t - (theta - np.arctan(theta))
        assert turned == pytest.approx(-side.sign * at, abs=1e-12)


def clearance(points: Array, alpha: float, half: float, tip: float, rounding: float) -> Array:
    """Return distances (N,) of points (N, 2), x up, from a rack's tooth with y < -half + x tan(alpha) and a rounded corner."""
    # the tooth is a wedge, smaller by the rounding, with a disc of that radius all over it
    along, normal = np.array([math.cos(alpha), math.sin(alpha)]), np.array([-math.sin(alpha), math.cos(alpha)])
    corner = np.array([tip + rounding, 0.0])
    corner[1] = -half + corner[0] * math.tan(alpha) - rounding / math.cos(alpha)
    away = points - corner
    by_flank, by_tip = away @ normal, -away[:, 0]
    beside = (away @ along <= 0.0) & (away[:, 1] >= 0.0)
    return np.where(beside, np.linalg.norm(away, axis=1), np.maximum(by_flank, by_tip)) - rounding


@pytest.mark.parametrize("kind", ["beveloid", "cylindrical"])
@pytest.mark.parametrize("side", [Side.RIGHT, Side.LEFT])
def test_flank_and_fillet_are_what_a_rack_leaves_in_all_its_positions(side: Side, kind: str) -> None:
    """Every point touches the rack in one position, and no position cuts deeper; the rack has another rounding on either side."""
    keys = SPUR if kind == "beveloid" else cylindrical(SPUR)
    rounded = {"tool_tip_radius": 0.38, "coast_tool_tip_radius": 0.2}
    tooth = built({**keys, "pinion": {**keys["pinion"], **rounded}}).members["pinion"].tooth
    rounding = rounded["tool_tip_radius" if side is Side.RIGHT else "coast_tool_tip_radius"]
    alpha, m, radius = math.radians(DRIVE if side is Side.RIGHT else COAST), 2.0, 20.0
    half = 0.5 * math.pi - 0.025 / math.cos(math.radians(DRIVE)) + 0.6 * math.tan(alpha)
    regions = FLANK_REGIONS[side], FILLET_REGIONS[side]
    points = np.concatenate(
        [tooth.grid(region, np.linspace(0.0, 1.0, 9), tooth.sections([0.5])).points[:, 0, :2] for region in regions]
    )
    # the left side is the right side of the mirror image
    points = points * np.array([1.0, side.sign])
    least = np.full(len(points), np.inf)
    for phi in np.linspace(-0.6, 0.6, 6001).tolist():
        c, s = math.cos(phi), math.sin(phi)
        in_rack = points @ np.array([[c, -s], [s, c]]) - np.array([radius, -radius * phi])
        least = np.minimum(least, clearance(in_rack, alpha, half, 0.6 - 1.25 * m, rounding * m))
    assert (least > -1e-9).all()
    assert (least < 2e-6).all()


def test_sheet_has_both_base_circles_and_the_dimension_over_balls() -> None:
    gears = built(SPUR)
    sheet = gears.sheet().plain_tables["Sides of asymmetric teeth"]
    bases = [40.0 * math.cos(math.radians(DRIVE)), 40.0 * math.cos(math.radians(COAST))]
    assert sheet["d_b"][1:3] == pytest.approx(bases, abs=1e-8)
    assert sheet["side"][1:] == ["drive", "coast", "drive", "coast"]
    # a ball of 3.5 mm touches both flanks of the space between two teeth of the section
    tooth, centre = gears.members["pinion"].tooth, 0.5 * (sheet["M_dK"][1] - 3.5)
    sections = tooth.sections([0.5])
    first, second = (
        tooth.grid(FLANK_REGIONS[side], np.linspace(0, 1, 4001), sections).points[:, 0, :2] for side in Side
    )
    right, left = (first, second) if first[0, 1] < 0.0 else (second, first)
    # the right flank of the next tooth, one pitch farther
    turn = tooth.pitch_angle
    c, s = math.cos(turn), math.sin(turn)
    far = right @ np.array([[c, s], [-s, c]])
    angles = np.linspace(0.3, 0.7, 4001) * turn
    centres = centre * np.stack((np.cos(angles), np.sin(angles)), axis=-1)
    gaps = [np.linalg.norm(flank[:, None] - centres[None, ::40], axis=-1).min(axis=0) for flank in (left, far)]
    middle = int(np.argmin(np.abs(gaps[0] - gaps[1])))
    assert [gap[middle] for gap in gaps] == pytest.approx([1.75, 1.75], abs=6e-3)
    assert sheet["W_k"][1:] == [None] * 4


def test_equal_sides_are_symmetric_teeth() -> None:
    plain = {key: value for key, value in SPUR.items() if key != "coast_pressure_angle"}
    ours, theirs = built({**plain, "coast_pressure_angle": DRIVE}), built(plain)
    for name in ("pinion", "gear"):
        assert np.array_equal(ours.solid(name, 0.02).mesh.vertices, theirs.solid(name, 0.02).mesh.vertices)
    assert "Sides of asymmetric teeth" not in ours.sheet().plain_tables


@pytest.mark.parametrize("kind", ["beveloid", "cylindrical"])
def test_spaces_of_a_ring_have_room_on_both_sides_together(kind: str) -> None:
    """One half of such a space is pointed before the root, the other half has the land."""
    ring = {"teeth": -50, "face_width": 15, "addendum": 0.5, "dedendum": 1.3, "tool_tip_radius": 0.05}
    pinion = {"teeth": 20, "face_width": 15, "tool_tip_radius": 0.05, "dedendum": 1.1}
    made = {} if kind == "beveloid" else {"manufacture": "formed"}
    keys = {"kind": kind, "module": 2, "pressure_angle": 35, "coast_pressure_angle": 15, "backlash": 0.1}
    tooth = built({**keys, "pinion": pinion, "gear": {**ring, **made}}).members["gear"].tooth
    root = tooth.grid(Region.ROOT, np.linspace(0.0, 1.0, 5), tooth.sections([0.5])).points[:, 0]
    assert np.hypot(root[:, 0], root[:, 1]) == pytest.approx([52.6] * 5, abs=1e-9)
    assert (np.diff(np.arctan2(root[:, 1], root[:, 0])) != 0.0).all()


def test_solid_of_an_asymmetric_tooth_is_closed() -> None:
    gears = built(with_helix(10.0, gear=RING))
    for name in ("pinion", "gear"):
        assert gears.solid(name, 0.02).figures["watertight"]


CYLINDER: dict[str, Any] = {
    "kind": "cylindrical",
    "module": 2,
    "backlash": 0.1,
    "pressure_angle": DRIVE,
    "coast_pressure_angle": COAST,
    "helix_angle": 15,
    "pinion": {"teeth": 20, "face_width": 15, "profile_shift": 0.2},
    "gear": {"teeth": 41, "face_width": 15},
}
CYLINDERS: dict[str, dict[str, Any]] = {
    "external": CYLINDER,
    "shaped": {**CYLINDER, "pinion": {**CYLINDER["pinion"], "shaper": {"teeth": 24}}},
    "hob": {**CYLINDER, "pinion": {**CYLINDER["pinion"], "hob": {"protuberance": 0.05, "stock": 0.05}}},
    "internal": {**CYLINDER, "gear": {"teeth": -62, "face_width": 15}},
    "formed": {**CYLINDER, "helix_angle": 0, "gear": {"teeth": -62, "face_width": 15, "manufacture": "formed"}},
    "rack": {
        **{key: value for key, value in CYLINDER.items() if key != "gear"},
        "kind": "rack",
        "rack": {"teeth": 12, "face_width": 15},
    },
}


@pytest.mark.parametrize(
    ("name", "flank"),
    [("external", "right"), *((name, "left") for name in CYLINDERS)],
    ids=["drive", *CYLINDERS],
)
@pytest.mark.sweep_cases("shaped", "hob", "formed", "drive", "external", "internal")
def test_cylindrical_gears_are_conjugate_with_the_backlash_of_their_sheet(name: str, flank: str) -> None:
    gears = built({**CYLINDERS[name], "contact": {"flank": flank}})
    summary = gears.contact([-2.0, 1.0]).summary
    assert summary["te_peak_to_peak_arcsec"] < 1e-9 * 3600.0
    backlash = gears.sheet().plain_tables["Backlash"]
    wanted = 0.1 if flank == "right" else backlash["j_bn_coast"][2]
    assert summary["backlash_normal_min_mm"] == pytest.approx(wanted, abs=1e-8)


@pytest.mark.sweep
@pytest.mark.parametrize("flank", ["right", "left"])
@pytest.mark.sweep_cases("left")
def test_planets_touch_the_ring_with_their_other_flanks(flank: str) -> None:
    members = {name: {"teeth": z, "face_width": 15} for name, z in (("sun", 18), ("planet", 27), ("ring", 72))}
    shared = {key: CYLINDER[key] for key in ("module", "backlash", "pressure_angle", "coast_pressure_angle")}
    gears = built({"kind": "planetary", **shared, **members, "contact": {"flank": flank}})
    coast = 0.1 / math.cos(math.radians(DRIVE)) * math.cos(math.radians(COAST))
    for pair, normal in ((0, 0.1 if flank == "right" else coast), (3, coast if flank == "right" else 0.1)):
        summary = gears.contact([-2.0, 1.0], pair=pair).summary
        assert summary["te_peak_to_peak_arcsec"] < 1e-9 * 3600.0
        assert summary["backlash_normal_min_mm"] == pytest.approx(normal, abs=1e-8)


def flanks_and_fillets(keys: dict[str, Any], name: str, side: Side, sign: float) -> Array:
    """Points of one side of a member, mirrored where `sign` is -1, from root to tip."""
    tooth = built(keys).members[name].tooth
    sections = tooth.sections([0.2, 0.5])
    regions = FLANK_REGIONS[side], FILLET_REGIONS[side]
    grids = [tooth.grid(region, np.linspace(0.0, 1.0, 7), sections).points[:: side.sign] for region in regions]
    return np.concatenate(grids) * np.array([1.0, sign, 1.0])


@pytest.mark.parametrize("name", ["external", "shaped", "hob", "internal"])
@pytest.mark.sweep_cases("shaped", "hob", "internal")
def test_coast_side_is_the_drive_side_of_the_mirrored_pair(name: str) -> None:
    keys = CYLINDERS[name]
    normal = built(keys).sheet().plain_tables["Backlash"]["j_bn_coast"][2]
    swapped = {"pressure_angle": COAST, "coast_pressure_angle": DRIVE, "hand": "left", "backlash": normal}
    for member in ("pinion", "gear"):
        for side in Side:
            own = flanks_and_fillets(keys, member, side, 1.0)
            mirrored = flanks_and_fillets({**keys, **swapped}, member, side.other, -1.0)
            assert np.abs(own - mirrored).max() < 1e-7


ROUNDED: dict[str, tuple[dict[str, Any], str]] = {
    **{name: (CYLINDERS[name], "gear" if name in ("internal", "formed") else "pinion") for name in CYLINDERS},
    "rack": (CYLINDERS["rack"], "rack"),
    "symmetric": ({key: value for key, value in CYLINDER.items() if key != "coast_pressure_angle"}, "gear"),
    "beveloid ring": (with_helix(10.0, gear=RING), "gear"),
}


@pytest.mark.parametrize("name", ROUNDED)
@pytest.mark.sweep_cases("shaped", "formed", "internal", "rack", "external", "hob", "symmetric")
def test_each_side_has_the_rounding_of_its_own_side_of_the_tool(name: str) -> None:
    """Fillets of a side are those of a tool with the rounding of that side on both; the flanks run as before."""
    keys, member = ROUNDED[name]
    both = {"tool_tip_radius": 0.12, "coast_tool_tip_radius": 0.22}
    inside = keys.get("gear", {}).get("teeth", 0) < 0

    def made(**radii: float) -> dict[str, Any]:
        return {**keys, member: {**keys[member], **radii}}

    for side in Side:
        key = "tool_tip_radius" if (side is Side.RIGHT) != (inside and member == "gear") else "coast_tool_tip_radius"
        one, alike = (
            flanks_and_fillets(made(**radii), member, side, 1.0) for radii in (both, {"tool_tip_radius": both[key]})
        )
        assert np.abs(one - alike).max() < 1e-9
    gears = built(made(**both))
    assert gears.contact([-2.0, 1.0]).summary["te_peak_to_peak_arcsec"] < 1e-9 * 3600.0
    if keys["kind"] != "cylindrical":
        return
    # the sheet has the form diameter of each side as it is built
    rows, tooth = gears.sheet().plain_tables["Sides of asymmetric teeth"], gears.members[member].tooth
    begins = [np.hypot(*tooth.flank_grid(side, np.zeros(1), np.array([0.5])).points[0, 0, :2]) for side in Side]
    columns = rows["d_Ff"][1:][:2] if member == "pinion" else rows["d_Ff"][1:][2:]
    assert sorted(columns) == pytest.approx(sorted(2.0 * radius for radius in begins), abs=1e-9)
    assert columns[0] != pytest.approx(columns[1], abs=1e-3)


@pytest.mark.parametrize(
    ("name", "key", "radii"),
    [
        ("external", "coast_tool_tip_radius", (0.1, 1.2)),
        ("external", "tool_tip_radius", (1.2, 0.3)),
        ("formed", "coast_tool_tip_radius", (0.1, 1.2)),
        ("formed", "tool_tip_radius", (1.2, 0.2)),
    ],
)
@pytest.mark.sweep_cases("formed-coast_tool_tip_radius-radii2")
def test_the_rounding_without_room_is_refused_with_the_largest_beside_the_other(
    name: str, key: str, radii: tuple[float, float]
) -> None:
    member = ROUNDED[name][1]
    keys = {**CYLINDERS[name]}
    given = dict(zip(("tool_tip_radius", "coast_tool_tip_radius"), radii, strict=True))
    with pytest.raises(DesignError) as refusal:
        built({**keys, member: {**keys[member], **given}})
    assert refusal.value.key == f"{member}.{key}"
    most = refusal.value.bounds[1]
    assert max(radii) > most > 0.3
    built({**keys, member: {**keys[member], **given, key: most - 1e-4}})


def test_the_default_rounding_has_room_beside_that_of_the_coast_side() -> None:
    """It takes 80 % of the largest rounding, which is found by what is refused."""
    keys, coast = CYLINDERS["formed"], 0.5
    gear = {**keys["gear"], "coast_tool_tip_radius": coast}
    derived = built({**keys, "gear": gear}).sheet().plain_tables["Derived keys (lengths in mm)"]
    with pytest.raises(DesignError) as refusal:
        built({**keys, "gear": {**gear, "tool_tip_radius": 0.6}})
    assert derived["gear.tool_tip_radius"][1] == pytest.approx(0.8 * refusal.value.bounds[1], rel=1e-4)
    assert derived["gear.tool_tip_radius"][1] < 0.3


@pytest.mark.sweep
def test_equal_angles_are_symmetric_cylindrical_teeth() -> None:
    plain = {key: value for key, value in CYLINDER.items() if key != "coast_pressure_angle"}
    ours, theirs = built({**plain, "coast_pressure_angle": DRIVE}), built(plain)
    for name in ("pinion", "gear"):
        assert np.array_equal(ours.solid(name, 0.05).mesh.vertices, theirs.solid(name, 0.05).mesh.vertices)
    own, other = ours.sheet().plain_tables, theirs.sheet().plain_tables
    assert {**own, "Derived keys (lengths in mm)": 0} == {**other, "Derived keys (lengths in mm)": 0}


@pytest.mark.parametrize("name", ["external", "internal"])
@pytest.mark.sweep_cases("internal")
def test_a_ball_touches_both_flanks_of_a_helical_space(name: str) -> None:
    """The distance of its centre from both exact flanks is its radius."""
    gears = built(CYLINDERS[name])
    sheet, tooth = gears.sheet().plain_tables["Measures of the tooth thickness"], gears.members["gear"].tooth
    centre, diameter = 0.5 * sheet["d_K"][2], sheet["D_M"][2]
    # flanks of the tooth and of the next one, in the transverse plane of the ball and beside it
    shares = np.linspace(0.0, 1.0, 400), np.linspace(0.3, 0.7, 400)
    points = {side: tooth.flank_grid(side, *shares).points.reshape(-1, 3) for side in Side}
    c, s = math.cos(tooth.pitch_angle), math.sin(tooth.pitch_angle)
    points[Side.RIGHT] = points[Side.RIGHT] @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])

    def gaps(angle: float) -> dict[Side, float]:
        at = centre * np.array([math.cos(angle), math.sin(angle), 0.0])
        return {side: float(np.linalg.norm(cloud - at, axis=1).min()) for side, cloud in points.items()}

    low, high = 0.2 * tooth.pitch_angle, 0.8 * tooth.pitch_angle
    for _ in range(24):
        middle = 0.5 * (low + high)
        found = gaps(middle)
        low, high = (middle, high) if found[Side.LEFT] < found[Side.RIGHT] else (low, middle)
    assert [2.0 * gap for gap in found.values()] == pytest.approx([diameter] * 2, abs=1e-3)


@pytest.mark.sweep
def test_sheet_says_both_sides_and_what_asymmetric_teeth_do_not_have() -> None:
    fixed = {"profile_shift": 0.1, "tip_alteration": 0.0, "tool_tip_radius": 0.3}
    members = {name: {**CYLINDER[name], **fixed} for name in ("pinion", "gear")}
    given = {**CYLINDER, **members}
    sheet = built(given).sheet()
    tables = sheet.plain_tables
    assert tables["Sides of asymmetric teeth"]["side"][1:] == ["drive", "coast"] * 2
    assert tables["Pair, both sides"]["alpha_n"][1:] == [DRIVE, COAST]
    # each side has the contact ratio and the sliding of symmetric teeth of its angle at this centre distance
    for number, alpha in enumerate((DRIVE, COAST)):
        plain = {key: value for key, value in given.items() if key != "coast_pressure_angle"}
        distance = {"center_distance": tables["Pair"]["a"][1]}
        alone = built({**plain, "pressure_angle": alpha, "backlash": 0.1, "assembly": distance}).sheet().plain_tables
        assert tables["Pair, both sides"]["alpha_wt"][1 + number] == pytest.approx(
            alone["Pair"]["alpha_wt"][1], abs=1e-8
        )
        assert tables["Contact from A to E"]["zeta_E"][1 + 2 * number] == pytest.approx(
            alone["Contact from A to E"]["zeta_E"][1], abs=1e-8
        )
    assert tables["Measures of the tooth thickness"]["W_k"][1:] == [None, None]
    # the sheet of one member has its two sides
    alone = built(given).sheet(member="gear").plain_tables
    assert alone["Sides of asymmetric teeth"]["d_b"][1:] == tables["Sides of asymmetric teeth"]["d_b"][3:]
    reasons = {missing.symbol: missing.reason for table in sheet.tables for missing in table.missing}
    assert "two base circles" in reasons["W_k"]
    assert "symmetric" in reasons["s_Fn"]


@pytest.mark.parametrize(
    ("keys", "refused"),
    [
        ({"pinion": {**CYLINDER["pinion"], "span": {"teeth": 3}}}, "pinion.span"),
        ({"coast_pressure_angle": 0.5}, "coast_pressure_angle"),
        ({"pinion": {**CYLINDER["pinion"], "tool_tip_radius": 0.8}}, "pinion.tool_tip_radius"),
    ],
)
def test_what_asymmetric_cylindrical_teeth_cannot_have_is_refused(keys: dict[str, Any], refused: str) -> None:
    with pytest.raises(DesignError) as refusal:
        built({**CYLINDER, "backlash": 0.1, **keys})
    assert str(refusal.value.key).startswith(refused)


def test_refusals() -> None:
    for value in (0, 50):
        with pytest.raises(DesignError) as refusal:
            gm.parse({**SPUR, "coast_pressure_angle": value})
        assert refusal.value.key == "coast_pressure_angle"


@pytest.mark.sweep
def test_tangents_of_30_deg_are_those_of_each_side() -> None:
    """Both sides change places with the pressure angles; the side of a symmetric tooth has half of its chord."""
    found = {}
    for drive, coast in ((DRIVE, COAST), (COAST, DRIVE), (DRIVE, DRIVE)):
        keys = {**cylindrical(SPUR), "pressure_angle": drive, "coast_pressure_angle": coast, "backlash": 0.0}
        keys |= {name: {**keys[name], "tool_tip_radius": 0.25} for name in ("pinion", "gear")}
        tables = {table.title: table for table in built(keys).sheet().tables}
        title = "Sides of asymmetric teeth" if drive != coast else "Root: tangent of 30 deg, internal 60 deg"
        rows = dict(zip(tables[title].symbols, (row[2:] for row in tables[title].rows), strict=True))
        found[drive, coast] = rows
    one, other, alike = found.values()
    for symbol in ("s_Fn/2", "rho_F", "d_F"):
        assert one[symbol][0] == pytest.approx(other[symbol][1], rel=1e-9)
        assert one[symbol][1] == pytest.approx(other[symbol][0], rel=1e-9)
    # the fillet of a side is cut by its own side of the rack
    assert one["s_Fn/2"][0] == pytest.approx(0.5 * alike["s_Fn"][0], rel=1e-9)
    assert one["rho_F"][0] == pytest.approx(alike["rho_F"][0], rel=1e-9)


@pytest.mark.sweep
@pytest.mark.parametrize("name", ["external", "internal", "rack", "beveloid ring"])
@pytest.mark.sweep_cases("rack", "beveloid ring")
def test_each_side_has_the_tip_edge_of_its_own_size(name: str) -> None:
    """Chamfers begin as far under the tip as they are wide; contact ends there on that side."""
    keys, member = ROUNDED[name]
    gears = built({**keys, member: {**keys[member], "tip_chamfer": 0.1, "coast_tip_edge": 0.25}})
    tooth, inside = gears.members[member].tooth, member == "gear"
    places = {side: tooth.flank_grid(side, np.ones(1), np.array([0.5])).points[0, 0] for side in Side}
    tip = tooth.grid(Region.LAND, np.array([0.5]), tooth.sections([0.5])).points[0, 0]
    below = {
        side: abs(float(tip[0] - place[0] if name == "rack" else np.hypot(*tip[:2]) - np.hypot(*place[:2])))
        for side, place in places.items()
    }
    drive = Side.LEFT if inside else Side.RIGHT
    assert [below[drive], below[drive.other]] == pytest.approx([0.1, 0.25], abs=1e-6)
    assert gears.contact([-2.0, 1.0]).summary["te_peak_to_peak_arcsec"] < 1e-9 * 3600.0
    if keys["kind"] == "cylindrical":
        sheet = gears.sheet().plain_tables["Sides of asymmetric teeth"]["d_Fa"][1:]
        ends = [2.0 * np.hypot(*places[side][:2]) for side in (drive, drive.other)]
        assert (sheet[2:] if inside else sheet[:2]) == pytest.approx(ends, abs=1e-8)


def test_the_tip_edge_without_room_is_refused_beside_the_other() -> None:
    def made(coast: float) -> gm.Gears:
        return built({**CYLINDER, "pinion": {**CYLINDER["pinion"], "tip_rounding": 0.2, "coast_tip_edge": coast}})

    with pytest.raises(DesignError) as refusal:
        made(2.5)
    assert refusal.value.key == "pinion.coast_tip_edge"
    most = refusal.value.bounds[1]
    assert 0.2 < most < 2.5
    made(0.999 * most)
    with pytest.raises(DesignError, match="needs tip_chamfer or tip_rounding"):
        gm.parse({**CYLINDER, "pinion": {**CYLINDER["pinion"], "coast_tip_edge": 0.2}})


@pytest.mark.sweep
def test_beveloid_members_of_cone_angle_0_have_the_tolerances_of_cylindrical_gears() -> None:
    keys = {**cylindrical(with_helix(10.0)), "accuracy_class": 7}
    of_cylinders = built(keys).sheet().plain_tables[TOLERANCES]
    crossed = {**with_helix(10.0), "accuracy_class": 7}
    assert built(crossed).sheet().plain_tables[TOLERANCES] == of_cylinders
    # a drawing has them, a design without a class has none
    texts = built(crossed).drawing("gear").texts
    assert "flank tolerance class" in texts
    cones = {**SPUR, "accuracy_class": 7, "pinion": {**SPUR["pinion"], "cone_angle": 8}}
    rows = built(cones).sheet().plain_tables[TOLERANCES]
    assert rows["A"][1:] == [None, 7]
    assert rows["f_pT"][1] is None
    assert TOLERANCES not in built(SPUR).sheet().plain_tables
