"""Spiral bevel gears: published settings [AB], local synthesis and back, invariances, refusals."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from oracles.bevel import standard_factors
from oracles.built import contact_of, pair_of
from oracles.examples import some
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import GearmeshError, Rigid, load, parse
from gearmesh.contact.conditions.meshing import Flank
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.pair import Pair
from gearmesh.contact.path import ContactPath
from gearmesh.contact.tca import contact_path
from gearmesh.kernel.numeric.algebra import ARCSEC, Array, dot, unit
from gearmesh.kernel.surface.curvature import shape_operator, tangent_basis
from gearmesh.kinds import BodyFeatures, ConeLevel, Mount, PlaneLevel, Side, along, gear_base
from gearmesh.mesh.solid import gear_solid, prove
from gearmesh.systems.spiral_bevel.machine.generated import Generated
from gearmesh.systems.spiral_bevel.machine.pair import BLADE_SIDES, HAND_SIGNS, MATING_SIDES
from gearmesh.systems.spiral_bevel.synthesis.local_synthesis import contact_of as mean_contact_of
from gearmesh.systems.spiral_bevel.synthesis.settings import (
    ContactChoice,
    MeanPoint,
    basic_blank,
    contact_asked,
    gear_sides,
    mean_point,
    pinion_side,
)

STRAIGHT = SAMPLES / "spiral_bevel_abdullah_straight.toml"
CURVED = SAMPLES / "spiral_bevel_abdullah_curved.toml"
BASIC = {"kind": "spiral_bevel", "module": 4.0, "pinion": {"teeth": 15}, "gear": {"teeth": 30}}
GIVEN = (
    "blade_angle",
    "tip_radius",
    "radial",
    "cradle_angle",
    "ratio_of_roll",
    "machining_offset",
    "machine_centre_to_back",
)
#: Table 3 of [AB], and what was asked of local synthesis: d(omega2/omega1)/dphi1, path angle (deg), semi-major axis
TABLE_3 = {
    "concave": ((16.5561, 75.303, 76.030, 63.1869, 0.229, 4.421, 0.539), (8.53588e-4, 74.9055, 4.34324)),
    "convex": ((22.9907, 77.987, 68.525, 54.1910, 0.25348, -6.213, 1.324), (-1.268219e-3, 98.5746, 4.59738)),
}
#: difference quotients of sixth order for the first and second derivative, and their step (rad)
FIRST = np.array([-1.0, 9.0, -45.0, 0.0, 45.0, -9.0, 1.0]) / 60.0
SECOND = np.array([2.0, -27.0, 270.0, -490.0, 270.0, -27.0, 2.0]) / 180.0
STEP = 3.5e-3
#: relative error of the second derivative by what the quotients leave out
TRUNCATION = 5e-9
DIGITS = (4, 3, 3, 4, (3, 5), 3, 3)


def sides(design: Any, name: str) -> tuple[MeanPoint, Generated, Generated]:
    """Mean point, pinion's and gear's side of a design, as cut: what it asks of the contact, nothing chosen."""
    blank = basic_blank(design)
    gear = gear_sides(design, blank)[MATING_SIDES[name]]
    choice = ContactChoice(contact_asked(design, blank, name), design.pinion.side(name).mean_offset)
    mean = mean_point(design, blank, gear, gear_base(blank.shaft_angle), choice)
    return mean, pinion_side(design, blank, name, mean), gear


def bare_path(design: Any, name: str, phi1: Array) -> tuple[ContactPath, MeanPoint, Pair]:
    """Contact of one pair of sides as cut, their surfaces untrimmed, about the mean point."""
    mean, pinion, gear = sides(design, name)
    sense = float(HAND_SIGNS[design.hand])
    shaft = np.radians(design.shaft_angle)
    mounts = (Mount(Rigid.identity(), sense), Mount(gear_base(shaft), -sense, zero=sense * mean.gear_turn))
    blank = basic_blank(design)
    flanks = []
    for side, mount, cone in zip((pinion, gear), mounts, (blank.pinion, blank.gear), strict=True):
        axial, surface = ConeLevel(cone.pitch_angle), side.side(0.0).flank
        extent = tuple(cone.mean_cone_distance + share * cone.face_width for share in (-0.4, 0.4))
        p = np.array([side.blade.at_height(share * side.tip_height) for share in np.linspace(0.2, 0.8, 13)])
        p, stations = np.broadcast_arrays(p[:, None], np.linspace(*extent, 25))
        grid = np.stack((p, along(surface, p, stations, axial)[0]), axis=-1)
        flanks.append(Flank(surface, mount, {"box": PlaneLevel(1e6)}, axial, extent, grid))
    ratio = design.pinion.teeth / design.gear.teeth
    pair = Pair(flanks[0], flanks[1], ratio, BLADE_SIDES[name], design.contact.delta)
    return contact_path(pair, phi1, edges=False), mean, pair


def measured(path: ContactPath, mean: MeanPoint, ratio: float) -> tuple[float, float, float]:
    """(d2 phi2/d phi1^2) / ratio, path angle (rad, 0..pi) on the gear, semi-major axis, from seven positions about 0."""
    error = path.phi2 - ratio * path.phi1
    second = SECOND @ error / STEP**2
    # velocity of the contact point over the gear: in space less with the gear
    moved = FIRST @ path.point / STEP
    contact = mean.contact
    over = moved - np.cross(contact.spin2, contact.point - contact.origin2)
    angle = np.arctan2(over @ contact.profilewise, over @ contact.lengthwise) % np.pi
    return second / ratio, angle, path.semi_major[3]


def second_tolerance(path: ContactPath, pair: Pair, derivative: float) -> float:
    """Relative error that the difference quotient for (d2 phi2/d phi1^2) / ratio, `derivative`, may have in this design.

    The contact leaves the gap that it reports, and the points of both flanks have the rounding of machine and cutter, some
    units of the last digit of the distance from the axes; n . dr over the lever of the normal is what phi2 is off by. The
    quotient multiplies that by 6 / STEP^2 = 5e5, and the second derivative itself is but 1e-3: 4e-8 to 2.3e-6 in all,
    median 1.7e-7. Its truncation error, below 3.1e-7 with twice the step, is a 64th of that.
    """
    gear = pair.gear.mount
    lever = np.abs(dot(path.normal, np.cross(gear.axis, path.point - gear.origin)))
    rounding = 4.0 * np.finfo(float).eps * np.linalg.norm(path.point, axis=-1)
    off = (path.residual + rounding) / lever
    return float(TRUNCATION + np.abs(SECOND) @ off / (STEP**2 * pair.ratio * abs(derivative)))


@pytest.mark.parametrize("name", ["concave", "convex"])
def test_local_synthesis_gives_all_seven_settings_of_table_3(name: str) -> None:
    printed, (derivative, path_angle, axis) = TABLE_3[name]
    design = load(STRAIGHT)
    mapping = design.resolve()
    side = mapping["pinion"][name]
    for key in GIVEN:
        del side[key]
    side |= {"ratio_derivative": derivative * 4.1, "path_angle": path_angle, "semi_major_axis": axis}
    _, pinion, _ = sides(parse(mapping), name)
    machine = pinion.settings
    found = (
        np.degrees(pinion.blade.blade_angle),
        pinion.blade.tip_radius,
        machine.radial,
        np.degrees(machine.cradle_angle),
        machine.ratio_of_roll,
        machine.machining_offset,
        machine.machine_centre_to_back,
    )
    for value, wanted, digits in zip(found, printed, DIGITS, strict=True):
        places = digits if isinstance(digits, int) else digits[name == "convex"]
        # half a unit of the last printed digit, and as much again for the rounding of what is asked
        assert abs(value - wanted) < 1.0 * 10.0**-places, (value, wanted)


@pytest.mark.quick
@pytest.mark.parametrize(
    ("sample", "name", "derivative", "axis", "closure"),
    [
        (STRAIGHT, "concave", 0.0035, 4.343, 3.0),
        (STRAIGHT, "convex", -0.0052, 4.596, 3.0),
        (CURVED, "concave", 0.0037, 4.337, 32.0),
        (CURVED, "convex", -0.0055, 4.347, 32.0),
    ],
)
@pytest.mark.sweep_cases("sample0-concave-0.0035-4.343-3.0", "sample2-concave-0.0037-4.337-32.0")
def test_contact_of_the_printed_settings(
    sample: Path, name: str, derivative: float, axis: float, closure: float
) -> None:
    gears = pair_of(load(sample, [f"contact.side=pinion_{name}"]))
    path = contact_path(solver_pair(gears), STEP * np.arange(-3.0, 4.0), edges=False)
    ratio = gears.ratio
    error = path.phi2 - ratio * path.phi1
    assert abs(SECOND @ error / (STEP**2 * ratio * derivative) - 1.0) < 0.01
    assert abs(path.semi_major[3] / axis - 1.0) < 0.002
    assert abs(error[3]) < closure * ARCSEC


#: what leaves nothing of a side's contact to be chosen beside path, ellipse and parabola
NOTHING_CHOSEN = {"mean_offset": 0.0, "mean_shift": 0.0, "modified_roll_c3": 0.0}


def sensible(rng: np.random.Generator) -> tuple[dict[str, Any], str]:
    teeth = int(rng.integers(10, 26))
    name = str(rng.choice(["concave", "convex"]))
    side = {
        "te_at_change": rng.uniform(3.0, 30.0),
        "path_angle": rng.uniform(65.0, 115.0),
        "semi_major_axis": rng.uniform(3.0, 8.0),
        "blade_radius": float(rng.choice([0.0, 800.0])),
    }
    design = {
        "kind": "spiral_bevel",
        "module": 4.0,
        "spiral_angle": rng.uniform(0.0, 45.0),
        "shaft_angle": rng.uniform(75.0, 105.0),
        "pressure_angle": rng.uniform(18.0, 24.0),
        "hand": str(rng.choice(["right", "left"])),
        "pinion": {"teeth": teeth, name: {**side, **NOTHING_CHOSEN}, MATING_SIDES[name]: {**side, **NOTHING_CHOSEN}},
        "gear": {"teeth": int(teeth * rng.uniform(1.5, 4.0))},
    }
    return design, name


@pytest.mark.parametrize("part", some(range(40), 1))
def test_round_trip_of_local_synthesis_through_contact_analysis(part: int) -> None:
    """Second derivative of phi2 to what rounding leaves of it in each design; path angle and axis to fixed tolerances."""
    rng = np.random.default_rng(23509)
    designs = [sensible(rng) for _ in range(200)]
    worst = np.zeros((2, 3))
    for k in range(5 * part, 5 * part + 5):
        mapping, name = designs[k]
        # sliding bases of tilted cutters take their teeth to be found
        tilted = int(k % 4 == 1)
        if tilted:
            mapping["pinion"][name] |= {"tilt": 8.0 * np.sin(k), "swivel": 180.0 * np.sin(7.0 * k)}
        design = parse(mapping)
        path, mean, pair = bare_path(design, name, STEP * np.arange(-3.0, 4.0))
        assert (path.kind == "point").all(), mapping
        asked = contact_asked(design, basic_blank(design), name)
        second, angle, axis = measured(path, mean, pair.ratio)
        off = [
            (second / asked.ratio_derivative - 1.0) / second_tolerance(path, pair, asked.ratio_derivative),
            np.sin(angle - asked.path_angle),
            axis / asked.semi_major_axis - 1.0,
        ]
        worst[tilted] = np.maximum(worst[tilted], np.abs(off))
        assert abs(path.phi2[3]) < 1e-12
        # the exact inverse of the synthesis, without difference quotients
        jet = pair.pinion.surface.jet(*(path.params1[3, k] for k in (0, 1)))
        e1, e2 = tangent_basis(jet)
        basis = np.stack((e1, e2))
        back = mean_contact_of(basis.T @ shape_operator(jet, e1, e2) @ basis, mean.contact, design.contact.delta)
        assert abs(back.ratio_derivative / asked.ratio_derivative - 1.0) < 1e-8
        assert abs(back.path_angle - asked.path_angle) < 1e-8
        assert abs(back.semi_major_axis / asked.semi_major_axis - 1.0) < 1e-8
    # where the cutter leans is found step by step
    assert (worst < ((1.0, 1e-6, 1e-11), (1.0, 1e-6, 1e-9))).all(), worst


def test_bare_contact_beside_a_saddle_of_the_advance() -> None:
    """The grid showed the saddle alone, where the surfaces cross; the second derivative is what the synthesis was asked for."""
    design = load(Path(__file__).parents[1] / "corpus" / "saddle_spiral_bevel_tilted.toml")
    path, mean, pair = bare_path(design, "convex", STEP * np.arange(-3.0, 4.0))
    assert (path.kind == "point").all()
    assert abs(path.phi2[3]) < 1e-12
    asked = contact_asked(design, basic_blank(design), "convex").ratio_derivative
    assert abs(measured(path, mean, pair.ratio)[0] / asked - 1.0) < second_tolerance(path, pair, asked)


@pytest.mark.sweep
def test_hands_are_mirror_images() -> None:
    found = {}
    for hand in HAND_SIGNS:
        gears = pair_of(parse({**BASIC, "hand": hand}))
        path = contact_path(solver_pair(gears), np.radians(np.linspace(-10.0, 10.0, 5)), edges=False)
        found[hand] = path, gears.pinion.tooth.volume()
    (right, right_volume), (left, left_volume) = found["right"], found["left"]
    np.testing.assert_allclose(right.te, left.te, rtol=0, atol=1e-8 * ARCSEC)
    np.testing.assert_allclose(right.point * [1.0, -1.0, 1.0], left.point, rtol=0, atol=1e-9)
    assert abs(right_volume / left_volume - 1.0) < 1e-12


@pytest.mark.sweep
def test_inches_are_millimetres() -> None:
    inches = {**BASIC, "units": "inch", "module": 4.0 / 25.4, "face_width": 1.0, "backlash": 0.004}
    one, two = (pair_of(parse(d)) for d in (inches, {**BASIC, "face_width": 25.4, "backlash": 0.1016}))
    for a, b in ((one.pinion, two.pinion), (one.gear, two.gear)):
        assert abs(a.tooth.volume() / b.tooth.volume() - 1.0) < 1e-9


@pytest.mark.sweep
@pytest.mark.sweep_cases("0.0")
@pytest.mark.parametrize("backlash", [0.0, 0.2])
def test_backlash_is_what_the_gear_turns_between_both_sides(backlash: float) -> None:
    turned, radius, normal = {}, 0.0, 0.0
    for name in BLADE_SIDES:
        gears = pair_of(parse({**BASIC, "backlash": backlash, "contact": {"side": f"pinion_{name}"}}))
        pinion, gear = gears.pinion.mount, gears.gear.mount
        # the pinion's tooth in the middle of the gear's space
        path = contact_path(solver_pair(gears), np.array([pinion.zero]), edges=False)
        turned[name] = gear.sign * (path.phi2[0] - gear.zero)
        around = np.cross(gear.axis, path.point[0])
        radius, normal = (
            float(np.linalg.norm(around)),
            abs(float(around @ path.normal[0])) / float(np.linalg.norm(around)),
        )
    between = np.sin(0.5 * (turned["convex"] - turned["concave"]) * 30) / 15.0
    # normal backlash over the normal's lever about the gear's axis; the parabolas of both sides leave a little
    assert abs(abs(between) - backlash / (radius * normal)) < 0.02 * backlash / radius + 3.0 * ARCSEC


@pytest.mark.sweep
def test_zerol_and_straight_teeth_are_the_same_system_at_spiral_angle_0() -> None:
    # a large cutter leaves straight teeth: the trace on the pitch cone hardly bends
    for radius, straight in ((0.0, False), (1000.0, True)):
        cutter = {"tip_radius": radius} if radius else {}
        gears = pair_of(parse({**BASIC, "spiral_angle": 0.0, "gear": {"teeth": 30, "cutter": cutter}}))
        path = contact_path(solver_pair(gears), np.radians(np.linspace(-8.0, 8.0, 5)), edges=False)
        assert (path.kind == "point").all()
        tooth = gears.gear.tooth
        grid = tooth.flank_grid(Side.LEFT, np.linspace(0.0, 1.0, 41), np.linspace(0.0, 1.0, 5))
        angle = np.arctan2(grid.points[..., 1], grid.points[..., 0])
        # polar angle on the pitch cone at each station
        pitch = np.tan(np.arctan2(30.0, 15.0))
        off = np.hypot(grid.points[..., 0], grid.points[..., 1]) - pitch * grid.points[..., 2]
        trace = [np.interp(0.0, off[:, k], angle[:, k]) for k in range(5)]
        assert (abs(trace[0] - 2.0 * trace[2] + trace[4]) < 1e-3) == straight


@pytest.mark.sweep
def test_teeth_as_straight_as_can_be_have_the_largest_cutter_that_works() -> None:
    """12/30, m 2: a radius of 800 mm has no pinion, and stays refused; the largest that works leaves 0.8 deg at the ends."""
    straight = {"kind": "spiral_bevel", "module": 2, "spiral_angle": 0, "face_width": 10, "pinion": {"teeth": 12}}
    design: Any = parse({**straight, "gear": {"teeth": 30, "cutter": {"straightest": True}}})
    radius = design.gear.cutter.tip_radius
    assert 450.0 < radius < 459.8
    assert not design.sets("gear.cutter.tip_radius")
    gears = gm.build(design)
    cut = gears.sheet().plain_tables["Teeth as cut, measured on their flanks"]
    assert max(abs(angle) for end in "ie" for angle in cut[f"beta_{end}"][1:]) < 0.8
    # others of the same table: the range is looked through anew, and what is given counts
    assert 450.0 < gm.build(design.with_values({"assembly.dA": 0.01})).design.gear.cutter.tip_radius < 459.8
    given: Any = design.with_values({"gear.cutter.tip_radius": 60.0})
    assert gm.build(given).design.gear.cutter.tip_radius == 60.0
    assert gm.build(design, alone=True).members["gear"].tooth.volume() == pytest.approx(
        gears.members["gear"].tooth.volume(), rel=1e-12
    )
    with pytest.raises(gm.GearmeshError, match=r"^gear.cutter.tip_radius = 800 mm: allowed is at most 4\d\d"):
        gm.build(parse({**straight, "gear": {"teeth": 30, "cutter": {"tip_radius": 800}}}))


@pytest.mark.sweep
@pytest.mark.sweep_cases("pinion")
@pytest.mark.parametrize("name", ["pinion", "gear"])
def test_keyway_and_hub(name: str) -> None:
    features = {"bore": 12.0, "keyway": {"width": 4.0, "depth": 2.0}, "hub": {"diameter": 24.0, "length": 9.0}}
    gears = pair_of(parse({**BASIC, name: {**BASIC[name], **features}}))
    member = gears.members[name]
    plain = gear_solid(replace(member, features=BodyFeatures()), 0.02)
    solid = gear_solid(member, 0.02)
    assert prove(solid, 1).ok
    height = float(np.ptp(member.tooth.blank.body.ends))
    ring = np.pi / 4.0 * (24.0**2 - 12.0**2) * 9.0
    slot = 4.0 * 8.0 - (36.0 * np.arcsin(1.0 / 3.0) + 2.0 * np.sqrt(32.0))
    # the keyway reaches depth 2 beyond the bore's radius, 4 wide, less what is bore already
    assert solid.volume() - plain.volume() == pytest.approx(ring - slot * (height + 9.0), rel=0.02)


def path_at_mean(design: Any, name: str, gear_point: Array) -> tuple[float, Array, float]:
    """Second derivative, direction of the path on the gear (own frame) and semi-major axis where a gear point touches."""
    gears = pair_of(design)
    pair = solver_pair(gears)
    near = 0.0
    for _ in range(8):
        path = contact_path(pair, near + STEP * np.arange(-3.0, 4.0), edges=False)
        moved = FIRST @ path.point2 / STEP
        near += float((gear_point - path.point2[3]) @ moved / (moved @ moved))
    error = path.phi2 - gears.ratio * path.phi1
    return float(SECOND @ error / STEP**2), unit(moved), float(path.semi_major[3])


@pytest.mark.sweep_cases("concave")
@pytest.mark.parametrize("name", ["concave", "convex"])
def test_compensation_restores_path_and_transmission_error(name: str) -> None:
    errors = [f"contact.side=pinion_{name}", "assembly.dV=0.05", "assembly.dA=-0.04", "assembly.d_delta=0.03"]
    aligned, misaligned = load(STRAIGHT, errors[:1]), load(STRAIGHT, errors)
    compensated = gm.build(misaligned).compensate().apply()
    point = contact_path(solver_pair(pair_of(aligned)), np.zeros(1), edges=False).point2[0]
    wanted, spoilt, restored = (path_at_mean(d, name, point) for d in (aligned, misaligned, compensated))
    assert abs(spoilt[0] / wanted[0] - 1.0) > 0.004
    assert abs(restored[0] / wanted[0] - 1.0) < 1e-4
    assert abs(dot(restored[1], wanted[1])) > 1.0 - 1e-7
    assert abs(restored[2] / wanted[2] - 1.0) < 1e-5


@pytest.mark.sweep
def test_settings_sheet_loads_back_to_the_same_gears() -> None:
    design = parse({**BASIC, "units": "inch", "module": 0.16})
    sheet = gm.build(design).sheet()
    again = design.with_values(sheet.values)
    assert again.pinion.concave.radial == sheet.values["pinion.concave.radial"]
    for a, b in zip(pair_of(design).members.values(), pair_of(again).members.values(), strict=True):
        assert abs(a.tooth.volume() / b.tooth.volume() - 1.0) < 1e-9
    titles = [table.title for table in sheet.tables]
    assert titles[:3] == ["Blank", "Pair", "Cutters and machine settings"]
    teeth = next(row for row in sheet.tables[0].rows if row[0] == "teeth")
    assert teeth[2:] == (15, 30)


@pytest.mark.sweep
def test_gears_that_run_ahead_are_warned_of() -> None:
    leading = contact_of(parse({**BASIC, "pinion": {"teeth": 15, "concave": {"te_at_change": -10.0}}}))
    assert any("the gear runs ahead by" in warning for warning in leading.warnings)
    assert not contact_of(parse(BASIC)).warnings


@pytest.mark.sweep
def test_free_edge_radii_give_way_and_given_ones_do_not() -> None:
    # proportions as the standard suggests, with which the pinion is undercut
    narrow = {**BASIC, **standard_factors(10, 41), "spiral_angle": 0.0, "pinion": {"teeth": 10}, "gear": {"teeth": 41}}
    machines = gm.build(parse(narrow)).sheet().tables[2]
    edges = next(row for row in machines.rows if row[0] == "edge radius")[2:]
    # the pinion's spaces are too narrow at the toe for the default that the gear keeps
    assert 0.0 < edges[0] == edges[1] < edges[2] == edges[3]
    given = {"teeth": 10, **{side: {"edge_radius": edges[2]} for side in BLADE_SIDES}}
    with pytest.raises(GearmeshError, match=r"pinion: the fillets of neighbouring teeth overlap .*edge radius"):
        pair_of(parse({**narrow, "pinion": given}))


@pytest.mark.sweep
def test_mean_point_not_generated_at_cradle_rotation_0_is_refused() -> None:
    flat = {**BASIC, "spiral_angle": 0.0, "pinion": {"teeth": 20}, "gear": {"teeth": 20}}
    pair_of(parse(flat))
    with pytest.raises(GearmeshError, match="use mean_point"):
        pair_of(parse({**flat, "mean_point": "cradle_zero"}))


@pytest.mark.sweep
def test_a_cutter_that_would_have_to_be_hollow_is_refused() -> None:
    # straight teeth of the gear leave no crowning to an outside blade
    cutter = {"teeth": 30, "cutter": {"tip_radius": 5000.0}}
    with pytest.raises(GearmeshError, match=r"pinion\.concave: no head cutter gives this contact"):
        pair_of(parse({**BASIC, "spiral_angle": 0.0, "gear": cutter}))


REFUSED = [
    ("shaft_angle=165", "shaft_angle = 165 deg: allowed is at most 117.3 deg"),
    ("face_width=90", "face_width = 90 mm: allowed is less than 40.2492 mm"),
    ("mean_cone_distance=20", "mean_cone_distance = 20 mm: allowed is between 46.9575 .toe. and 67.082 mm"),
    ("pinion.root_angle=60", "pinion.root_angle = 60 deg: allowed is between 0 and the pitch angle, 26.565 deg"),
    ("clearance=9", "clearance = 9 mm: .*allowed is less than half the mean working depth, 2.7"),
    ("gear.bore=400", "gear.bore = 400 mm: the root lies below the bore"),
    ("gear.hub={diameter=300,length=5}", "gear.hub.diameter = 300 mm: allowed is between"),
    ("gear.cutter.edge_radius=9", "gear: .*edge radius"),
    ("pinion.concave.blade_radius=10", "pinion.concave.blade_radius = 10 mm: allowed is 0 .straight. or more than"),
    ("hand=middle", "hand"),
    ("contact.side=left", "contact.side"),
]
#: what is looked for longer before it is refused
SEARCHED = [
    ("gear.cutter.radial=9", "gear"),
    ("pinion.concave.path_angle=20", "pinion.concave: no pinion gives this contact"),
]


@pytest.mark.parametrize(
    ("override", "message"), [*REFUSED, *some(SEARCHED, 0)], ids=[row[0] for row in (*REFUSED, *SEARCHED)]
)
@pytest.mark.sweep_cases(
    "clearance=9", "gear.cutter.edge_radius=9", "shaft_angle=165", "face_width=90", "gear.hub={diameter=300,length=5}"
)
def test_refused(override: str, message: str, tmp_path: Path) -> None:
    file = tmp_path / "basic.toml"
    file.write_text(
        'kind = "spiral_bevel"\nmodule = 4\n[pinion]\nteeth = 15\n[pinion.concave]\n[pinion.convex]\n'
        "[gear]\nteeth = 30\n[gear.cutter]\n[contact]\n"
    )
    with pytest.raises(GearmeshError, match=message) as error:
        contact_of(load(file, [override]))
    assert "\n" not in str(error.value)
