"""Hypoid pairs: their blanks in space, how they grow out of bevel pairs, and their contact against the roll of members."""

from __future__ import annotations

import tomllib
from typing import Any

import numpy as np
import pytest
from numpy.polynomial import Polynomial, chebyshev
from oracles.built import pair_of
from oracles.examples import some
from oracles.places import SAMPLES

import gearmesh as gm
from gearmesh import DesignError, GearPair, Rigid, load
from gearmesh.check.members import roll_flanks
from gearmesh.contact.flanks import analyse, solver_pair
from gearmesh.contact.path import ContactPath
from gearmesh.contact.tca import contact_path
from gearmesh.kernel.numeric.algebra import ARCSEC, Array, cross, unit
from gearmesh.systems.spiral_bevel.build import build
from gearmesh.systems.spiral_bevel.machine.pair import (
    BLADE_SIDES,
    HAND_SIGNS,
    MATING_SIDES,
    nominal_base,
    without_errors,
)
from gearmesh.systems.spiral_bevel.synthesis import teeth_choice
from gearmesh.systems.spiral_bevel.synthesis.contact_choice import contact_said
from gearmesh.systems.spiral_bevel.synthesis.local_synthesis import ContactAsked
from gearmesh.systems.spiral_bevel.synthesis.settings import (
    ContactChoice,
    basic_blank,
    gear_sides,
    mean_point,
    pinion_side,
)

HYPOID: dict[str, Any] = {
    "kind": "hypoid",
    "module": 4.5,
    "offset": 25.0,
    "pinion": {"teeth": 12},
    "gear": {"teeth": 41},
}
#: what the pairs of tests are beside it; the last is offset the other way
PAIRS: dict[str, dict[str, Any]] = {
    "12/41": {"backlash": 0.1},
    "obtuse": {
        "shaft_angle": 100.0,
        "offset": 15.0,
        "spiral_angle": 42.0,
        "taper": "tilted_root_line",
        "hand": "right",
    },
    "above": {"offset": -12.0, "spiral_angle": 25.0, "hand": "right"},
}
#: the pair of samples/hypoid_formate.toml
FORMATE: dict[str, Any] = {
    "process": "formate_fixed",
    "module": 4.9,
    "offset": 35.0,
    "spiral_angle": 50.0,
    "pressure_angle": 21.25,
    "limit_share": 0.5,
    "backlash": 0.1,
    "pinion": {"teeth": 11, "convex": {"path_angle": 105.0}},
    "gear": {"teeth": 43},
}
#: cells of the roll test: errors of a position go with their fourth power
ROLL_CELLS = 96
SIMPLE = ContactChoice(ContactAsked(0.0, 0.5 * np.pi, 6.0, 0.00635))


def design_of(name: str = "12/41", **more: Any) -> Any:
    return gm.parse({**HYPOID, **(FORMATE if name == "formate" else PAIRS[name]), **more}).in_mm()


def cut(design: Any) -> dict[str, Any]:
    """Machine settings and blades of all four flanks, with a plain contact asked for."""
    blank = basic_blank(design)
    gear, base = gear_sides(design, blank), nominal_base(blank, HAND_SIGNS[design.hand])
    found = {f"gear {name}": side for name, side in gear.items()}
    for name in BLADE_SIDES:
        mean = mean_point(design, blank, gear[MATING_SIDES[name]], base, SIMPLE)
        found[f"pinion {name}"] = pinion_side(design, blank, name, mean)
    return found


@pytest.mark.sweep
@pytest.mark.sweep_cases("obtuse")
@pytest.mark.parametrize("name", PAIRS)
def test_axes_and_mean_point(name: str) -> None:
    """Offset and shaft angle of the axes; what stands over both x axes is one point, where the members slide along the teeth."""
    design = design_of(name)
    blank, hand = basic_blank(design), HAND_SIGNS[design.hand]
    base = nominal_base(blank, hand)
    axis, origin = base.rotation[:, 2], base.translation
    across = np.cross([0.0, 0.0, 1.0], axis)
    assert np.degrees(np.arccos(axis[2])) == pytest.approx(design.shaft_angle, abs=1e-9)
    # the origins are the feet of the common perpendicular
    assert abs(origin @ np.array([0.0, 0.0, 1.0])) < 1e-9
    assert abs(origin @ axis) < 1e-9
    assert -hand * (origin @ across) / np.linalg.norm(across) == pytest.approx(design.offset, abs=1e-9)
    points = []
    for member in blank.members:
        along = member.mean_cone_distance * np.cos(member.pitch_angle) - member.pitch_apex
        points.append(np.array([member.mean_radius, 0.0, along]))
        assert member.stations.value(points[-1]) == pytest.approx(member.mean_cone_distance, abs=1e-9)
    np.testing.assert_allclose(base.point(points[1]), points[0], rtol=0.0, atol=1e-9)
    ratio = blank.pinion.teeth / blank.gear.teeth
    slide = hand * (cross(np.array([0.0, 0.0, 1.0]), points[0]) + ratio * cross(axis, points[0] - origin))
    # seen from the pitch plane: along the pinion's generatrix, and across it
    angle, spiral = blank.pinion.pitch_angle, blank.pinion.spiral_angle
    tooth = np.array([np.sin(angle) * np.cos(spiral), hand * np.sin(spiral), np.cos(angle) * np.cos(spiral)])
    size = float(np.linalg.norm(slide))
    assert abs(abs(slide @ tooth) - size) < 1e-9 * size


def least_apart(own: Any, mating: Any, own_to_mating: Rigid, cone: float) -> float:
    """Least distance (mm) from the root cone of the mating gear, over the circle of the tip cone at a cone distance."""
    # where the tip cone has this station
    axial, tip = own.stations.normal, own.tip.normal
    rho, z = np.linalg.solve(np.array([axial, tip]), [cone + own.stations.offset, own.tip.offset])
    middle, width, least = 0.0, np.radians(60.0), np.inf
    for _ in range(12):
        angles = middle + width * np.linspace(-1.0, 1.0, 81)
        at = own_to_mating.point(np.stack((rho * np.cos(angles), rho * np.sin(angles), np.full(81, z)), axis=-1))
        c, s = np.cos(mating.root_angle), np.sin(mating.root_angle)
        apart = c * np.hypot(at[:, 0], at[:, 1]) - s * (at[:, 2] + mating.root_apex)
        middle, least, width = float(angles[apart.argmin()]), float(apart.min()), 0.1 * width
    return least


@pytest.mark.sweep_cases("obtuse", "above")
@pytest.mark.quick
@pytest.mark.parametrize("name", PAIRS)
def test_tips_clear_the_roots_of_the_mating_gear(name: str) -> None:
    """In space, cone over cone: the least distance over the face is the clearance."""
    design = design_of(name)
    blank = basic_blank(design)
    base = nominal_base(blank, HAND_SIGNS[design.hand])
    for own, mating, to_mating in (
        (blank.pinion, blank.gear, base.inverse),
        (blank.gear, blank.pinion, base),
    ):
        apart = [least_apart(own, mating, to_mating, cone) for cone in np.linspace(*own.extent, 9)]
        assert min(apart) == pytest.approx(blank.clearance, abs=2e-3 * blank.clearance)


@pytest.mark.parametrize("name", PAIRS)
@pytest.mark.sweep_cases("obtuse")
def test_cutters_reach_the_root_cones(name: str) -> None:
    design = design_of(name)
    blank = basic_blank(design)
    for key, side in cut(design).items():
        own = blank.pinion if key.startswith("pinion") else blank.gear
        cone = side.settings.tip_cone()
        assert cone.slope == pytest.approx(np.tan(own.root_angle), rel=1e-12)
        assert -cone.radius / cone.slope == pytest.approx(-own.root_apex, abs=1e-9)


def apart(one: dict[str, Any], other: dict[str, Any]) -> float:
    """Largest difference of the settings and blades of all four flanks, mm and rad."""
    names = (
        *(
            "radial",
            "cradle_angle",
            "ratio_of_roll",
            "machine_root_angle",
            "machining_offset",
            "machine_centre_to_back",
        ),
        *("sliding_base", "tip_radius", "blade_angle", "edge_radius"),
    )
    return max(
        abs(getattr(getattr(one[key], part), name) - getattr(getattr(other[key], part), name))
        for key in one
        for name in names
        for part in ("settings", "blade")
        if hasattr(getattr(one[key], part), name)
    )


@pytest.mark.sweep
def test_without_offset_the_pair_is_a_spiral_bevel_one() -> None:
    """Settings and blades of all four flanks; as the offset goes to 0 so do the differences, with it."""
    # ISO 23509 counts the clearance across the pitch cone, blanks without offset across the root line: by 0.1 % of it apart
    # with the contact given there is none to look for
    fixed = {
        "path_angle": 90.0,
        "mean_offset": 0.0,
        "mean_shift": 0.0,
        "semi_major_axis": 6.0,
        "ratio_derivative": 0.008,
    }
    fixed |= {"ratio_derivative": 0.008, "modified_roll_c3": 0.0}
    pinion = {"teeth": 12, "concave": fixed, "convex": {**fixed, "ratio_derivative": -0.008}}
    given = {"spiral_angle": 35.0, "backlash": 0.1, "clearance": 1e-6, "pinion": pinion}
    none = design_of(offset=0.0, **given)
    blank = basic_blank(none)
    bevel = {key: value for key, value in HYPOID.items() if key != "offset"} | {
        **given,
        "kind": "spiral_bevel",
        "face_width": blank.gear.face_width,
        "mean_cone_distance": blank.gear.mean_cone_distance,
        "gear": {"teeth": 41, "cutter": {"tip_radius": blank.cutter_radius}},
    }
    assert apart(cut(none), cut(gm.parse(bevel).in_mm())) < 1e-8
    steps = [apart(cut(none), cut(design_of(offset=offset, **given))) for offset in (1e-2, 1e-3, 1e-4)]
    assert steps[0] < 0.1
    assert steps[0] / steps[1] == pytest.approx(10.0, rel=0.05)
    assert steps[1] / steps[2] == pytest.approx(10.0, rel=0.05)


@pytest.mark.sweep
@pytest.mark.parametrize(
    ("name", "side"),
    some(
        [
            ("12/41", "concave"),
            ("12/41", "convex"),
            ("obtuse", "concave"),
            ("above", "convex"),
            ("formate", "concave"),
            ("formate", "convex"),
        ],
        1,
    ),
)
def test_contact_is_where_the_rolled_flanks_touch(name: str, side: str) -> None:
    """TCA knows tangents and curvatures, the roll only points and heights: positions over most of a pitch."""
    design = design_of(name, contact={"side": f"pinion_{side}"})
    (pair,) = gm.build(design).train.pairs
    path = analyse(pair, 0.4 * pair.pitch * np.linspace(-1.0, 1.0, 5))
    assert set(path.kind) == {"point"}
    rolled = roll_flanks(pair, path.rotation, cells=ROLL_CELLS, guess_phi2=path.phi2)
    apart = [touch.phi2 - phi2 for touch, phi2 in zip(rolled, path.phi2, strict=True) if touch is not None]
    assert len(apart) == 5
    assert np.abs(apart).max() < 0.05 * ARCSEC


@pytest.mark.sweep
@pytest.mark.parametrize("more", [{}, {"hand": "right", "shaft_angle": 96.0}], ids=["left", "obtuse"])
def test_the_cradle_takes_a_formate_gears_place(more: dict[str, Any]) -> None:
    """The cradle's axis is parallel to the gear's, the pinion's cutters all but upright on its root cone at the mean."""
    design = design_of("formate", **more)
    blank = basic_blank(design)
    gear_axis = nominal_base(blank, HAND_SIGNS[design.hand]).rotation[:, 2]
    c, s = np.cos(blank.pinion.root_angle), np.sin(blank.pinion.root_angle)
    for name, side in cut(design).items():
        if not name.startswith("pinion"):
            continue
        to_own = Rigid.about_z(side.turned)
        cradle = to_own.vector(side.settings.own_from_machine(side.hand).rotation[:, 2])
        np.testing.assert_allclose(cradle, -gear_axis, rtol=0.0, atol=1e-12)
        cutter = side.settings.standing(side.hand, side.turned).rotation[:, 2]
        # the swivel counts from where the gear's cutter would stand
        assert np.degrees(np.arccos(cutter @ np.array([-c, 0.0, s]))) < 4.0
        assert np.degrees(side.settings.tilt) == pytest.approx(
            np.degrees(np.arccos(-gear_axis @ [-c, 0.0, s])), abs=1e-9
        )


@pytest.mark.sweep
def test_whole_members_fit() -> None:
    """Solids at 20 um proved, the roll of whole members, fit on both sides, clearances of the whole surfaces; and the cycle."""
    gears = gm.build(design_of())
    check = gears.check(tolerance=0.02)
    assert check.complaints == []
    summary = gears.contact().summary
    assert summary["contact_ratio"] > 1.2
    assert summary["te_breaks_phi1_deg"] == []
    assert summary["mesh_te_peak_to_peak_arcsec"] == pytest.approx(10.0, rel=0.05)
    assert summary["interference_um"] == 0.0
    assert summary["tip_clearance_pinion_mm"] == pytest.approx(basic_blank(gears.design.in_mm()).clearance, rel=2e-3)


@pytest.mark.sweep
@pytest.mark.sweep_cases("obtuse-left", "above-left")
@pytest.mark.parametrize(
    ("name", "hand"),
    some([("12/41", "right"), ("12/41", "left"), ("obtuse", "left"), ("above", "left")], 3),
)
def test_misaligned_axes_stand_as_the_letters_say(name: str, hand: str) -> None:
    """E, P, G and alpha, all at once, of the axes in space: offset, shaft angle, and both crossing points along them."""
    errors = {"dV": 0.3, "dA": 0.2, "dG": -0.15, "d_delta": 0.4}
    design = design_of(name, hand=hand, assembly=errors)
    trains = [build(each) for each in (design, design.with_values(without_errors(design)))]
    for train, share in zip(trains, (1.0, 0.0), strict=True):
        first, second = train.pairs[0].mounts
        across = np.cross(first.axis, second.axis)
        assert np.degrees(np.arccos(first.axis @ second.axis)) == pytest.approx(
            design.shaft_angle + share * errors["d_delta"], abs=1e-9
        )
        aside = -HAND_SIGNS[hand] * ((second.origin - first.origin) @ across) / np.linalg.norm(across)
        assert aside == pytest.approx(design.offset + share * HAND_SIGNS[hand] * errors["dV"], abs=1e-9)
        # where both axes are nearest to each other, from the members' origins
        apart = np.linalg.lstsq(
            np.stack((first.axis, -second.axis), axis=-1), second.origin - first.origin, rcond=None
        )[0]
        np.testing.assert_allclose(apart, [-share * errors["dA"], -share * errors["dG"]], rtol=0.0, atol=1e-9)


ERRORS = {"dA": 0.03, "dG": -0.02, "dV": 0.04, "d_delta": 0.02, "pinion_eccentricity": 0.004, "pinion_phase": 40.0}


def test_small_errors_act_as_their_closed_forms_say() -> None:
    """The rest beyond first order is of second order: halving the errors quarters it."""
    left = []
    for share in (0.5, 0.25):
        errors = {key: value * (1.0 if key.endswith("phase") else share) for key, value in ERRORS.items()}
        answer = gm.build(design_of(assembly=errors, contact={"phi1": {"start": -8, "stop": 8, "count": 5}})).contact(
            cycle=False
        )
        assert answer.first_order is not None
        left.append(float(np.abs(answer.path.te - answer.first_order).max()))
        assert left[-1] < 0.2 * float(np.ptp(answer.path.te))
    assert left[0] / left[1] == pytest.approx(4.0, rel=0.2)


def around(pair: GearPair, place: Array) -> ContactPath:
    """Contact where it passes the place (2,) of the gear's flank nearest, in its parameters, then +-10 and +-5 deg from there.

    The path over +-2 deg is a polynomial of degree 8, whose last term is 1e-11 of it.
    """
    near = np.radians(2.0) * np.cos(np.linspace(np.pi, 0.0, 9))
    u, v = (Polynomial.fit(near, apart, 8) for apart in (analyse(pair, near).params2 - place).T)
    nearest = (u * u.deriv() + v * v.deriv()).roots()
    (phi1,) = nearest[(np.abs(nearest.imag) < 1e-9) & (np.abs(nearest.real) < near[-1])].real
    return analyse(pair, phi1 + np.radians([0.0, -10.0, -5.0, 5.0, 10.0]))


@pytest.mark.sweep
@pytest.mark.parametrize("more", [PAIRS["12/41"], FORMATE], ids=["generated", "formate"])
def test_compensation_gives_the_contact_back(more: dict[str, Any]) -> None:
    """Path, ellipse and teeth as thick as before, of upright cutters and of tilted ones.

    The index that keeps the backlash turns the pinion by up to 0.2 deg, and phi1 = 0 is at another place of the path: what is
    compared is contact at one place of the gear's flank, which does not change.
    """
    errors = {key: value for key, value in ERRORS.items() if not key.startswith("pinion")}
    design = gm.parse({**HYPOID, **more})
    bent = gm.build(design.with_values({f"assembly.{key}": value for key, value in errors.items()}))
    pairs = [gm.build(design), bent, gm.build(bent.compensate().apply())]
    place = analyse(pairs[0].pairs[0], np.zeros(1)).params2[0]
    before, misaligned, mended = (around(gears.pairs[0], place) for gears in pairs)
    # path and ellipse at the mean point are those asked for: what is left is rounding of the solvers
    np.testing.assert_allclose(mended.params2[0], place, rtol=0.0, atol=1e-9)
    assert mended.semi_major[0] == pytest.approx(before.semi_major[0], rel=1e-8)
    # the parabola at the mean point is: 10 deg from there terms of third order are left, 0.5 % of what the errors do
    apart = [float(np.abs((path.te - path.te[0]) - (before.te - before.te[0])).max()) for path in (misaligned, mended)]
    assert apart[1] < 0.01 * apart[0]
    assert mended.semi_major == pytest.approx(before.semi_major, rel=1e-3)
    backlash = [gears.contact().summary["backlash_normal_min_mm"] for gears in pairs]
    assert abs(backlash[2] - backlash[0]) < 0.01 * abs(backlash[1] - backlash[0])


@pytest.mark.sweep
@pytest.mark.parametrize("more", [{}, FORMATE], ids=["generated", "formate"])
def test_settings_given_as_they_were_derived_are_the_same_pair(more: dict[str, Any]) -> None:
    """Sheet and file: every value that was derived, in inches, and no other pair comes of them."""
    inches = {"units": "inch", "module": 0.18, "offset": 1.3 if more else 1.0, "backlash": 0.004}
    design = gm.parse({**HYPOID, **more, **inches, "contact": {"phi1": {"start": -10, "stop": 10, "count": 5}}})
    gears = gm.build(design)
    given = gm.parse(tomllib.loads(gm.toml(gears.sheet().apply().resolve())))
    assert not any(value != value for _, value in given.own())
    paths = [each.contact(cycle=False).path for each in (gears, gm.build(given))]
    np.testing.assert_allclose(paths[1].te, paths[0].te, rtol=0.0, atol=1e-3 * ARCSEC)


@pytest.mark.sweep_cases("offset", "cutter", "clearance", "face")
@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"offset": 95.0}, r"^offset = 95 mm: method 1 has no pitch cones .*; allowed is at most 92\.2\d+ mm"),
        ({"taper": "round"}, r"^taper"),
        (
            {"gear": {"teeth": 41, "cutter": {"tip_radius": 20.0}}},
            r"^(gear.cutter.tip_radius = 20|offset = 25) mm: .*allowed is",
        ),
        (
            {"clearance": 5.0},
            r"^clearance = 5 mm: .* allowed is less than half the mean working depth",
        ),
        ({"face_width": 200.0}, r"^face_width = 200 mm: .*allowed is"),
    ],
    ids=["offset", "taper", "cutter", "clearance", "face"],
)
def test_what_cannot_be_is_refused(keys: dict[str, Any], message: str) -> None:
    with pytest.raises(DesignError, match=message):
        gm.build(gm.parse({**HYPOID, **keys}))


def test_the_contact_of_a_side_is_looked_for_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """One search for each side's contact serves both the sliding bases and the gears. The gear's own base is found with the
    sliding bases."""
    sides = []

    def looked_for(design: Any, blank: Any, name: str) -> Any:
        sides.append(name)
        return contact_said(design, blank, name)

    monkeypatch.setattr(teeth_choice, "contact_choice", looked_for)
    gm.build(gm.parse({"kind": "hypoid", **FORMATE, "backlash": 0.11}))
    assert sorted(sides) == ["concave", "convex"]


def surface_polynomials(x: Array, y: Array, values: Array, order: int) -> Array:
    """Coefficients (order + 1, order + 1) of Chebyshev polynomials through values at points from -1 to 1."""
    basis = chebyshev.chebvander2d(x.ravel(), y.ravel(), [order, order])
    return np.asarray(np.linalg.lstsq(basis, values.ravel(), rcond=None)[0].reshape(order + 1, order + 1))


@pytest.mark.parametrize(
    ("side", "radii"),
    [("concave", {-0.05: 77.25, 0.0: 78.17, 0.05: 79.05}), ("convex", {-0.05: 79.82, 0.0: 77.84, 0.05: 74.97})],
)
@pytest.mark.sweep_cases("concave-radii0")
def test_an_offset_error_moves_drive_and_coast_contact_to_opposite_ends(side: str, radii: dict[float, float]) -> None:
    """At an offset angle of 17.23 deg dV = +0.05 moves contact of the drive side to the heel, of the coast side to the toe.

    Second route: rotation of the gear, about its own axis, that brings its flank to points of the pinion's displaced flank, by
    polynomials through points of both flanks. The pinion is moved towards the gear's axis by what is taken from the offset.
    """
    sample = SAMPLES / "hypoid.toml"
    pair = pair_of(load(sample, [f"contact.side=pinion_{side}"]))
    pinion, gear = pair.pinion.mount, pair.gear.mount
    x = np.cos(np.pi * (np.arange(40) + 0.5) / 40)
    share = 0.5 * (1.0 + x)
    own, mating = (
        member.mount.at(0.0).point(member.tooth.flank_grid(which, share, share).points)
        for member, which in zip((pair.pinion, pair.gear), pair.flanks, strict=True)
    )

    def about_axis(points: Array) -> tuple[Array, Array]:
        """(rho, z) and angle about the gear's axis."""
        r = (points - gear.base.translation) @ gear.base.rotation
        angle = np.arctan2(r[..., 1], r[..., 0]) - middle
        return np.stack((np.hypot(r[..., 0], r[..., 1]), r[..., 2]), axis=-1), (angle + np.pi) % (2.0 * np.pi) - np.pi

    middle = 0.0
    middle = float(np.median(about_axis(mating)[1]))
    meridian, angle = about_axis(mating)
    centre = meridian.reshape(-1, 2).mean(axis=0)
    directions = np.linalg.svd(meridian.reshape(-1, 2) - centre, full_matrices=False)[2]
    size = np.abs((meridian - centre) @ directions.T).max(axis=(0, 1))
    flat = (meridian - centre) @ directions.T / size
    flank = surface_polynomials(flat[..., 0], flat[..., 1], angle, 11)
    perpendicular = unit(np.cross(pinion.axis, gear.axis))
    perpendicular *= np.sign((gear.origin - pinion.origin) @ perpendicular)
    for error, radius in radii.items():
        meridian, angle = about_axis(own + error * perpendicular)
        flat = (meridian - centre) @ directions.T / size
        ahead = angle - chebyshev.chebval2d(flat[..., 0], flat[..., 1], flank)
        near = (np.abs(flat) <= 1.02).all(axis=-1)
        across, along_face = (each[near] for each in np.meshgrid(x, x, indexing="ij"))
        ahead_of = (1.0 if side == "convex" else -1.0) * surface_polynomials(across, along_face, ahead[near], 13)
        radii_of, at = surface_polynomials(across, along_face, meridian[near][:, 0], 9), np.zeros(2)
        for reach in (0.8, 0.1, 0.01, 1e-3):
            grid = [each + np.linspace(-reach, reach, 81) for each in at]
            i, j = np.unravel_index(chebyshev.chebgrid2d(*grid, ahead_of).argmin(), (81, 81))
            at = np.array([grid[0][i], grid[1][j]])
        found = float(chebyshev.chebval2d(*at, radii_of))
        assert found == pytest.approx(radius, abs=0.03)
        misplaced = pair_of(load(sample, [f"contact.side=pinion_{side}", f"assembly.dV={error}"]))
        point = contact_path(solver_pair(misplaced), np.zeros(1), edges=False).point[0]
        assert np.linalg.norm(np.cross(point - gear.origin, gear.axis)) == pytest.approx(found, abs=0.01)


@pytest.mark.sweep
def test_bodies_whose_back_cone_reaches_the_bore_under_the_teeth() -> None:
    """Under four teeth the body ends closer to the axis at the heel than at the toe; its solid was not closed."""
    keys = ["spiral_angle=40.688", "module=3.8569", "pinion.teeth=4"]
    with pytest.raises(DesignError, match=r"pinion\.bore = 2\.5.* the diameter under the teeth at the heel, 0\.6"):
        gm.build(load(SAMPLES / "hypoid_high_ratio.toml", keys))


def test_teeth_whose_fillets_fold_back_are_made_shallower() -> None:
    """At the full depth the pinion's fillet ends before the lowest point of the blade; it is a matter of depth, not of the kind."""
    keys = {"kind": "hypoid", "module": 0.3294, "offset": 1.887, "spiral_angle": 52.248, "pressure_angle": 17.685}
    gears = gm.build(gm.parse({**keys, "taper": "uniform", "pinion": {"teeth": 25}, "gear": {"teeth": 26}}))
    (depth,) = (warning for warning in gears.warnings if "depth_factor" in warning)
    assert "the fillets do not end in a smooth line along the face" in depth
