"""Face gears [LF04 18]: surfaces against a shaper that is really moved, contact against closed forms, limits by three routes."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.curvature import undercut_indicator
from oracles.examples import some
from oracles.places import SAMPLES
from oracles.stretched import stretched
from scipy.optimize import root

from gearmesh import DesignError, GearPair, build, load, parse
from gearmesh.contact.flanks import analyse
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import Tooth, TrimError
from gearmesh.systems.face_gear.build import middle, shaped_gear
from gearmesh.systems.face_gear.limits import ShapedGear
from gearmesh.teeth.limits import pointed_station, undercut_station
from gearmesh.tools.shaper import Shaper

ARCSEC = np.degrees(1.0) * 3600.0
#: positions within the contact of one pair of teeth
PHI1 = np.radians([-8.0, -4.0, 0.0, 4.0, 8.0])


def design(*overrides: str, sample: str = "face_gear") -> Any:
    return load(SAMPLES / f"{sample}.toml", list(overrides)).in_mm()


def pair(*overrides: str, sample: str = "face_gear") -> GearPair:
    return pair_of(design(*overrides, sample=sample))


def turned(r: Array, angle: Array) -> Array:
    """Points turned about z."""
    c, s = np.cos(angle), np.sin(angle)
    return np.stack((c * r[..., 0] - s * r[..., 1], s * r[..., 0] + c * r[..., 1], r[..., 2] + 0.0 * angle), axis=-1)


# ---------------------------------------------------------------- shaper


@pytest.mark.quick
def test_a_drive_without_a_shaper_has_the_usual_one() -> None:
    """Three teeth more than the pinion, as [LF04 18.4] has it, but no more than the gear."""
    drive = {"kind": "face_gear", "module": 2, "pinion": {"teeth": 25}, "gear": {"teeth": 120}}
    usual, given = parse(drive), parse({**drive, "shaper": {"teeth": 28}})
    assert usual.derived_values() == given.derived_values()
    assert parse({**drive, "gear": {"teeth": 26}}).shaper_teeth == 26
    with pytest.raises(DesignError, match=r"gear\.teeth = 24: must be at least those of the pinion, 25"):
        parse({**drive, "gear": {"teeth": 24}})


@pytest.mark.quick
@pytest.mark.parametrize("shift", [0.0, 0.3])
@pytest.mark.parametrize("radius", [0.0, 0.5])
def test_tip_rounding_touches_involute_and_top_cylinder(radius: float, shift: float) -> None:
    shaper = Shaper(28, 6.35, np.radians(25.0), 1.25 * 6.35, radius, shift)
    theta, form_point = (np.array(p) for p in shaper.form_point)
    for one, other in zip(shaper.involute.section(theta)[::2], shaper.rounding.section(form_point)[::2], strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-13)
    top, _, normal, _ = shaper.rounding.section(np.array(shaper.root))
    outward = np.array([shaper.pitch_radius, 0.0]) - top
    assert np.hypot(*outward) == pytest.approx(shaper.top_radius, abs=1e-12)
    np.testing.assert_allclose(normal, outward / shaper.top_radius, rtol=0, atol=1e-13)
    # [LF04 18.5.3]: half of a pitch is space on the pitch circle, but for the shift
    x, y = shaper.involute.section(np.array(np.tan(shaper.pressure_angle)))[0]
    half_space = (0.25 * np.pi - shift * np.tan(shaper.pressure_angle)) * shaper.module / shaper.pitch_radius
    assert np.arctan2(-y, shaper.pitch_radius - x) == pytest.approx(half_space, abs=1e-14)
    assert np.hypot(shaper.pitch_radius - x, y) == pytest.approx(shaper.pitch_radius, abs=1e-12)


def clearance(shaper: Shaper, x: Array, y: Array) -> Array:
    """Distance (mm) from the shaper's tooth beside the space about +x, in its cross section; inf inside the base circle."""
    radius, angle = np.hypot(x, y), np.abs(np.arctan2(y, x))
    with np.errstate(invalid="ignore"):
        theta = np.sqrt((radius / shaper.base_radius) ** 2 - 1.0)
        off_involute = radius * (shaper.theta_0 + theta - np.arctan(theta) - angle)
    offset = np.array([shaper.pitch_radius, 0.0]) - np.array(shaper.rounding.centre)
    off_tip = np.hypot(radius * np.cos(angle) - offset[0], radius * np.sin(angle) - offset[1]) - shaper.tip_radius
    ends = np.hypot(
        *(np.array([shaper.pitch_radius, 0.0]) - shaper.involute.section(np.array(shaper.form_point[0]))[0])
    )
    distance = np.where(radius < ends, off_involute, off_tip)
    return np.where(radius < shaper.base_radius, np.inf, distance)


MEETING = [(angle, tip, 0.0) for angle in (30.0, 90.0, 110.0, 150.0) for tip in (0.0, 0.15)]


@pytest.mark.parametrize(
    ("angle", "tip_radius", "offset"), some([*MEETING, (90.0, 0.15, 150.0), (70.0, 0.15, -60.0)], 4)
)
def test_shaper_touches_flank_and_fillet_and_never_cuts_in(angle: float, tip_radius: float, offset: float) -> None:
    """Points of the gear are carried through the shaper's whole motion, written out: no equation of meshing."""
    given = design(f"shaft_angle={angle}", f"shaper.tip_radius={tip_radius}", f"offset={offset}")
    tooth, shaped = pair_of(given).gear.tooth, shaped_gear(given)
    sections = tooth.sections(np.linspace(0.0, 1.0, 4))
    # the root is what the shaper's top cylinder sweeps: the fillet runs into it without a corner
    land, fillet = tooth.grid("root", [1.0], sections), tooth.grid("fillet_right", [0.0], sections)
    np.testing.assert_allclose(land.points, fillet.points, rtol=0, atol=1e-10)
    np.testing.assert_allclose(land.normals, fillet.normals, rtol=0, atol=1e-12)
    c, s = np.cos(shaped.shaft_angle), np.sin(shaped.shaft_angle)
    # the tooth is centred where the shaper's middle plane meets the middle of the face
    centred = np.arcsin(-offset / shaped.radius_of(middle(given, shaped)))
    for region in ("flank_right", "flank_left", "fillet_right", "fillet_left"):
        grid = tooth.grid(region, np.linspace(0.05, 0.95, 6), sections).points.reshape(-1, 1, 3)

        def distance(psi: Array, grid: Array = grid) -> Array:
            own = turned(grid, centred - psi * given.shaper_teeth / given.gear.teeth)
            x, y = s * own[..., 2] - c * own[..., 0], -own[..., 1] - offset
            fixed = np.stack((x, y, np.zeros_like(x)), axis=-1)
            back = turned(fixed, -psi)
            return clearance(shaped.shaper, back[..., 0], back[..., 1])

        psi = np.broadcast_to(np.linspace(-0.8, 0.8, 161), (len(grid), 161))
        for _ in range(10):
            found = distance(psi)
            best = np.take_along_axis(psi, found.argmin(axis=1)[:, None], axis=1)
            psi = best + (psi[:, 1] - psi[:, 0])[:, None] * np.linspace(-2.0, 2.0, 41)
        np.testing.assert_allclose(found.min(axis=1), 0.0, rtol=0, atol=2e-9)


# ---------------------------------------------------------------- contact


@pytest.mark.parametrize(
    "overrides",
    [
        ("shaft_angle=80", "contact.flank=left"),
        ("backlash=0.2",),
        ("pinion.profile_shift=0.2", "shaper.teeth=27", "backlash=0.1", "contact.flank=left"),
        ("shaft_angle=110",),
    ],
    ids=" ".join,
)
@pytest.mark.sweep_cases("backlash=0.2", "shaft_angle=110", "shaft_angle=80 contact.flank=left")
def test_aligned_pair_turns_uniformly_and_its_normals_pass_through_the_pitch_point(overrides: tuple[str, ...]) -> None:
    given = design(*overrides)
    path = analyse(pair_of(given), PHI1)
    assert (path.kind == "point").all()
    assert np.abs(path.te).max() * ARCSEC < 1e-6
    np.testing.assert_allclose(path.phi2, PHI1 * given.pinion.teeth / given.gear.teeth, rtol=0, atol=1e-12)
    # [LF04 18.4]: surfaces of shaper, pinion and gear are in mesh at once
    radius = 0.5 * given.shaper_teeth * given.module
    cotangent = given.gear.teeth / given.shaper_teeth + np.cos(np.radians(given.shaft_angle))
    pitch_point = np.array([radius, 0.0, radius * cotangent / np.sin(np.radians(given.shaft_angle))])
    away = np.cross(path.point - pitch_point, path.normal)
    np.testing.assert_allclose(np.linalg.norm(away, axis=-1), 0.0, rtol=0, atol=1e-9)
    np.testing.assert_allclose(path.point[2], pitch_point, rtol=0, atol=1e-9)


@pytest.mark.quick
def test_shaper_like_the_pinion_gives_lines_of_contact() -> None:
    given = design(sample="face_gear_conjugate")
    shaped = shaped_gear(given)
    path = analyse(pair_of(given), PHI1)
    assert (path.kind == "line").all()
    assert np.abs(path.te).max() * ARCSEC < 1e-6
    for phi1, line in zip(PHI1, path.lines, strict=True):
        # the shaper stands where the pinion does: its space is half a pitch beside the pinion's tooth, clockwise
        assert line is not None
        # the ends are cut off between two points
        x, y, z = line[1:-1].T
        kappa = np.arccos(shaped.shaper.base_radius / (z * shaped.axis_slope))
        theta = (x / shaped.shaper.base_radius - np.cos(kappa)) / np.sin(kappa)
        along_normal = x * np.cos(kappa) + y * np.sin(kappa)
        np.testing.assert_allclose(along_normal, shaped.shaper.base_radius, rtol=0, atol=1e-8)
        psi = kappa - theta - shaped.shaper.theta_0
        np.testing.assert_allclose(psi, -phi1 - 0.5 * np.pi / shaped.shaper.teeth, rtol=0, atol=1e-10)
        assert np.ptp(z) > 3.0


@pytest.mark.parametrize("key", ["dE", "dq"])
@pytest.mark.parametrize("error", [-0.1, 0.1])
@pytest.mark.sweep_cases("-0.1-dq", "0.1-dE")
def test_parallel_shift_moves_the_path_by_the_mesh_of_shaper_and_pinion(key: str, error: float) -> None:
    """Shaper and pinion stay in mesh at another centre distance: their line of action turns, and with it the path."""
    given = design(f"assembly.{key}={error}")
    shaped, path = shaped_gear(given), analyse(pair_of(given), PHI1[1:4])
    apart = 0.5 * (given.shaper_teeth - given.pinion.teeth) * given.module
    across, towards = (error, apart) if key == "dE" else (0.0, apart - error)
    working = np.arccos(apart * np.cos(shaped.shaper.pressure_angle) / np.hypot(across, towards))
    kappa = working + np.arctan2(across, towards)
    expected = shaped.shaper.base_radius / (shaped.axis_slope * np.cos(kappa))
    np.testing.assert_allclose(path.point[:, 2], expected, rtol=0, atol=1e-8)
    # 508 mm when aligned: towards the heel with dE, towards the toe with dq
    assert (expected - shaped.pitch_distance) * error * (1.0 if key == "dE" else -1.0) > 0.0
    assert np.abs(path.te).max() * ARCSEC < 1e-6


@pytest.mark.quick
@pytest.mark.parametrize("error", [-0.03, 0.05])
@pytest.mark.sweep_cases("0.05")
def test_change_of_the_shaft_angle_against_explicit_surfaces(error: float) -> None:
    """Both flanks written out as points, tangents by differences; the contact by a general solver."""
    given = design(f"assembly.d_gamma={error}")
    shaped, alpha = shaped_gear(given), np.radians(given.pressure_angle)
    teeth, module = given.pinion.teeth, given.module
    base, apart = 0.5 * teeth * module * np.cos(alpha), 0.5 * (given.shaper_teeth - teeth) * module
    gamma = shaped.shaft_angle + np.radians(error)
    inv = np.tan(alpha) - alpha

    def first(theta: float, z: float) -> Array:
        angle = theta - np.arctan(theta) - inv
        radius = base * np.hypot(1.0, theta)
        return np.array([apart + radius * np.cos(angle), radius * np.sin(angle), z])

    def second(theta: float, z: float, phi2: float) -> Array:
        own = turned(shaped.point(np.array(theta), np.array(z)), np.array(phi2 + 0.5 * np.pi / shaped.teeth))
        return np.array(
            [
                np.sin(gamma) * own[2] - np.cos(gamma) * own[0],
                -own[1],
                np.sin(gamma) * own[0] + np.cos(gamma) * own[2],
            ]
        )

    def normal(surface: Any, theta: float, z: float) -> Array:
        by_theta = surface(theta + 1e-5, z) - surface(theta - 1e-5, z)
        by_z = surface(theta, z + 1e-2) - surface(theta, z - 1e-2)
        across = np.cross(by_theta, by_z)
        return across / np.linalg.norm(across)

    def conditions(x: Array) -> Array:
        theta_1, z_1, theta_s, z_s, phi2 = x * [1.0, 100.0, 1.0, 100.0, 1e-2]
        gear = lambda theta, z: second(theta, z, phi2)  # noqa: E731
        twist = 100.0 * np.cross(normal(first, theta_1, z_1), normal(gear, theta_s, z_s))
        return np.concatenate((first(theta_1, z_1) - gear(theta_s, z_s), twist[1:]))

    place = shaped.pitch_distance / 100.0
    found = root(conditions, [np.tan(alpha), place, np.tan(alpha), place, 0.0], tol=1e-13)
    path = analyse(pair_of(given), np.zeros(1))
    assert np.abs(conditions(found.x)).max() < 1e-9
    np.testing.assert_allclose(path.point[0], first(found.x[0], 100.0 * found.x[1]), rtol=0, atol=2e-4)
    np.testing.assert_allclose(path.phi2[0], 1e-2 * found.x[4], rtol=0, atol=1e-9)
    # opening the axes moves the contact to the toe
    assert (path.point[0, 2] - shaped.pitch_distance) * error < -1e-3


# ---------------------------------------------------------------- limits


def shaped_tooth(*overrides: str) -> tuple[ShapedGear, Tooth, tuple[float, float]]:
    """Face gear, tooth, and its limits in closed form."""
    given = design(*overrides)
    shaped = shaped_gear(given)
    limits = shaped.undercut_radius(), shaped.pointing_radius(given.gear.addendum * given.module)
    return shaped, pair_of(given).gear.tooth, limits


@pytest.mark.sweep
@pytest.mark.sweep_cases("90.0-0.15", "80.0-0.0")
@pytest.mark.parametrize(("angle", "tip_radius"), [(80.0, 0.0), (90.0, 0.15), (110.0, 0.0)])
def test_limits_by_closed_form_by_the_trimmed_sections_and_by_the_surface(angle: float, tip_radius: float) -> None:
    _, tooth, (inner, outer) = shaped_tooth(f"shaft_angle={angle}", f"shaper.tip_radius={tip_radius}")
    # default radii are 2 % of the width between the limits inside them
    give = 0.02 * (outer - inner)
    np.testing.assert_allclose(tooth.blank.extent, (inner + give, outer - give), rtol=0, atol=1e-9)

    def at(radius: float) -> Tooth:
        return stretched(tooth, radius, radius + 1.0)

    def fault(radius: float) -> str:
        try:
            ends = at(radius).sections([0.0]).right
        except TrimError as failure:
            return failure.what
        return "undercut" if ends.form_point_flank[0] != tooth.right.form_point[0] else ""

    assert [fault(inner + d) for d in (-0.2, -1e-6, 1e-6, 1.0)] == ["undercut", "undercut", "", ""]
    assert [fault(outer + d) for d in (-1.0, -1e-6, 1e-6, 1.0)] == ["", "", "pointed", "pointed"]
    assert undercut_station(tooth, tooth.right) == pytest.approx(inner, abs=1e-6)
    assert pointed_station(tooth) == pytest.approx(outer, abs=1e-6)


@pytest.mark.quick
def test_singularity_is_that_of_the_envelope() -> None:
    shaped, tooth, _ = shaped_tooth("shaft_angle=80")
    theta, v = np.linspace(0.3, 0.75, 9), np.linspace(-40.0, 40.0, 9)
    flank: Any = tooth.right.flank
    z = v + flank.motion.steps[-1].offset[2]
    np.testing.assert_allclose(shaped.singularity(theta, z), undercut_indicator(flank, theta, v), rtol=0, atol=1e-13)
    np.testing.assert_allclose(shaped.point(theta, z), flank.jet(theta, v).r, rtol=0, atol=1e-11)


@pytest.mark.quick
def test_top_land_at_the_outer_radius_is_the_one_asked_for() -> None:
    given = design("gear.top_land=0.3")
    limit = shaped_gear(given).pointing_radius(given.gear.addendum * given.module, 0.3 * given.module)
    tooth = pair_of(design(f"gear.outer_radius={limit!r}", "gear.top_land=0.299999")).gear.tooth
    ends = tooth.sections([1.0])
    land = limit * (ends.left.tip_angle - ends.right.tip_angle)
    assert land[0] == pytest.approx(0.3 * given.module, abs=1e-6)


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        (["gear.inner_radius=460"], "gear.inner_radius = 460 mm: undercut by the shaper; allowed is at least 465.0"),
        (["gear.outer_radius=575"], "gear.outer_radius = 575 mm: the teeth are pointed; allowed is at most 569.3"),
        (["gear.top_land=0.4", "gear.outer_radius=560"], "the top land is narrower than 2.54 mm; allowed is at most 5"),
        (["gear.inner_radius=510"], "the path of contact, at the radius 508 mm, is not between"),
        (["gear.outer_radius=400"], "must be larger than gear.inner_radius"),
        (["shaper.teeth=24"], "shaper.teeth = 24: must be at least those of the pinion, 25"),
        (["gear.teeth=27"], "gear.teeth = 27: must be at least those of the shaper, 28"),
        (["shaper.tip_radius=0.4"], "0.4: the shaper's tooth is too narrow for the fillet; allowed is at most 0.206"),
        (["shaper.addendum=2"], "shaper.addendum = 2: allowed is at most 1.41"),
        (
            ["gear.inner_radius=470", "gear.addendum=1.6"],
            "gear.addendum = 1.6: higher than the shaper's involute reaches",
        ),
        (
            ["gear.addendum=2.5"],
            "gear.addendum = 2.5: allowed is at most 1.676, with the other keys unchanged: the top land",
        ),
        (
            ["gear.bore=1000"],
            "gear.bore = 1000 mm: the root lies below the bore; allowed is less than the inner diameter",
        ),
        (["gear.web=20"], "gear.web = 20 mm: reaches the root at the inner cylinder; allowed is less than 19.05 mm"),
        (["backlash=10"], "backlash = 10 mm: allowed is at most 2.8"),
    ],
    ids=lambda value: value[-1] if isinstance(value, list) else "",
)
@pytest.mark.sweep_cases(
    "backlash=10-", "gear.addendum=2.5-", "gear.outer_radius=400-", "shaper.addendum=2-", "shaper.tip_radius=0.4-"
)
def test_refusals_name_key_value_and_limit(overrides: list[str], words: str) -> None:
    with pytest.raises(DesignError) as failure:
        pair(*overrides)
    assert words in str(failure.value)
    assert failure.value.exit_status == 2


@pytest.mark.quick
def test_units_do_not_matter() -> None:
    lengths = ("module=0.25", 'units="inch"', "pinion.bore=2.5", "gear.bore=32")
    inch, mm = load(SAMPLES / "face_gear.toml", list(lengths)), load(SAMPLES / "face_gear.toml")
    np.testing.assert_allclose(25.4 * inch.gear.inner_radius, mm.gear.inner_radius, rtol=1e-13)  # type: ignore[attr-defined]
    np.testing.assert_allclose(pair_of(inch).gear.tooth.blank.extent, pair_of(mm).gear.tooth.blank.extent, rtol=1e-13)
    assert parse(mm.resolve()) == mm


@pytest.mark.quick
def test_face_gear_has_end_radii_and_tip_and_root_heights() -> None:
    """Tip and root are planes if the shaft angle is 90 deg. The tip is at the shaper's pitch radius less the addendum, the root
    at the shaper's top radius."""
    own = design()
    tables = build(own).sheet().plain_tables["Members at mid face"]
    gear = {item: row[2] for item, row in tables.items()}
    pinion = {item: row[1] for item, row in tables.items()}
    shaper = shaped_gear(own).shaper
    for item in ("tip diameter", "root diameter", "flank begins at diameter, right", "flank begins at diameter, left"):
        assert gear[item] is None
        assert pinion[item] is not None
    assert gear["inner diameter of the teeth"] == pytest.approx(2.0 * own.gear.inner_radius, abs=1e-9)
    assert gear["outer diameter of the teeth"] == pytest.approx(2.0 * own.gear.outer_radius, abs=1e-9)
    assert gear["z of the tip"] == pytest.approx(shaper.pitch_radius - own.gear.addendum * own.module, abs=1e-9)
    assert gear["z of the root"] == pytest.approx(shaper.top_radius, abs=1e-9)
    for side in ("right", "left"):
        assert gear["z of the tip"] < gear[f"flank begins at z, {side}"] < gear["z of the root"]
