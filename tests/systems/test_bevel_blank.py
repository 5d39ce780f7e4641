"""Blanks of bevel gears: the tables of [AB] and ISO 23509, and what must hold for any basic data."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles.examples import examples

from gearmesh import DesignError
from gearmesh.systems.common.bevel.blank import (
    BasicData,
    BevelBlank,
    MemberBlank,
    Proportions,
    tapered_blank,
    uniform_blank,
)
from gearmesh.systems.common.bevel.iso23509.blank_cones import blank_cones
from gearmesh.systems.common.bevel.iso23509.dimensions import bevel_dimensions
from gearmesh.systems.common.bevel.iso23509.tooth_factors import (
    DEPTH_FACTORS,
    Backlash,
    ToothFactors,
    suggested_thickness_factor,
)
from gearmesh.systems.common.bevel.iso23509.tooth_line import FaceCutter

pytestmark = pytest.mark.quick

data = st.builds(
    lambda pinion, ratio, module, spiral, shaft, pressure: BasicData(
        (pinion, max(pinion, int(pinion * ratio))), module, spiral, shaft, pressure
    ),
    st.integers(8, 40),
    st.floats(1.0, 5.0),
    st.floats(0.5, 20.0),
    st.floats(0.0, 0.8),
    st.floats(1.2, 1.6),
    st.floats(0.3, 0.44),
)


#: lengths of a blank and of its members, all in proportion to the module
SHARED_LENGTHS = (
    "mean_normal_module",
    "clearance",
    "mean_depth",
    "point_width",
    "edge_radius",
)
LENGTHS = (
    *("tip_radius", "mean_addendum", "mean_dedendum", "outer_addendum", "outer_dedendum", "thickness"),
    *("face_width", "outer_cone_distance", "mean_cone_distance"),
)
ANGLES = ("pitch_angle", "root_angle", "face_angle")
PLAIN = BasicData((13, 44), 4.0, 0.6, 0.5 * np.pi, 0.35)


def line(angle: float, at: float, z: float) -> float:
    """rho of a cone at z."""
    return at + z * float(np.tan(angle))


def apart(member: MemberBlank, mating: MemberBlank, shaft_angle: float, z: float) -> float:
    """Distance from the tip point of a member at its z to the mating gear's root line, in the axial plane that both share."""
    rho = line(member.face_angle, member.tip_radius, z)
    # the mating gear's axis lies at the shaft angle from the member's, beyond the pitch line
    angle = np.arctan2(rho, z)
    size = np.hypot(rho, z)
    return float(size * np.sin((shaft_angle - angle) - mating.root_angle))


def test_table_1_of_abdullah() -> None:
    gear = np.arctan2(41.0, 10.0)
    basic = BasicData(
        (10, 41),
        2.0 * 96.418 * float(np.sin(gear)) / 41.0,
        spiral_angle=float(np.radians(35.0)),
        shaft_angle=0.5 * np.pi,
        pressure_angle=float(np.radians(20.0)),
        given_face_width=28.931,
        given_mean_cone_distance=81.940,
    )
    blanks = []
    # the root angles are printed to the minute
    for more in (0.0, 1.0):
        roots = (float(np.radians(12.0 + (1.0 + more) / 60.0)), float(np.radians(72.0 + (25.0 + more) / 60.0)))
        blanks.append(tapered_blank(basic, Proportions(clearance=0.838, root_angles=roots)))
    working = [blank.gear.outer_addendum + blank.pinion.outer_addendum for blank in blanks]
    assert working[0] > 7.671 > working[1]
    for name in ("pinion", "gear"):
        whole = [getattr(blank, name).outer_addendum + getattr(blank, name).outer_dedendum for blank in blanks]
        assert whole[0] > 8.509 > whole[1]
    blank = blanks[0]
    assert blank.gear.outer_cone_distance == pytest.approx(96.418, abs=1e-9)
    assert np.degrees(blank.gear.pitch_angle) == pytest.approx(76.2936, abs=1e-3)
    # the printed module of 5.559 per inch
    assert 25.4 / basic.module == pytest.approx(5.559, abs=1e-3)


def test_sample_of_iso_23509() -> None:
    """Spiral bevel pair 14/39, outer pitch diameter 176.893; cutter radius 114.3."""
    basic = BasicData(
        (14, 39),
        176.893 / 39.0,
        spiral_angle=float(np.radians(35.0)),
        shaft_angle=0.5 * np.pi,
        pressure_angle=float(np.radians(20.0)),
        given_face_width=25.4,
    )
    assert np.degrees(basic.pitch_angles) == pytest.approx([19.7468, 70.2532], abs=5e-5)
    assert basic.mean_cone_distance == pytest.approx(81.273, abs=5e-4)
    diameters = 2.0 * basic.mean_cone_distance * np.sin(basic.pitch_angles)
    assert diameters == pytest.approx([54.918, 152.987], abs=5e-4)
    blank = tapered_blank(basic, cutter_radius=114.3)
    normal = blank.mean_normal_module
    assert normal == pytest.approx(3.2133, abs=5e-5)
    assert blank.clearance == pytest.approx(0.803, abs=5e-4)
    # profile shift x_hm and thickness modification x_sm of the pinion, from the ratio alone
    shift = 0.5 * (blank.gear.mean_dedendum - blank.pinion.mean_dedendum) / normal
    assert shift == pytest.approx(0.505, abs=5e-4)
    thick = (blank.pinion.thickness / normal - 0.5 * np.pi) / 2.0 - shift * np.tan(basic.pressure_angle)
    assert thick == pytest.approx(0.046, abs=5e-4)
    # the printed depths follow from the rounded profile shift
    blank = tapered_blank(basic, Proportions(addendum_factor=0.5 * (1.0 - 0.505)))
    assert blank.mean_depth - blank.clearance == pytest.approx(7.230, abs=5e-4)
    for member, mating, addendum, dedendum in (
        (blank.pinion, blank.gear, 4.836, 2.394),
        (blank.gear, blank.pinion, 1.591, 5.639),
    ):
        assert member.mean_dedendum == pytest.approx(dedendum, abs=5e-4)
        # the standard counts the clearance across the pitch line, the blank across the mating gear's root line
        tilt = blank.clearance * (1.0 / np.cos(mating.dedendum_angle) - 1.0)
        assert member.mean_addendum + tilt == pytest.approx(addendum, abs=5e-4)


@examples(100)
@given(basic=data)
def test_tapered_blanks(basic: BasicData) -> None:
    blank = tapered_blank(basic)
    pinion, gear = blank.pinion, blank.gear
    assert pinion.pitch_angle + gear.pitch_angle == pytest.approx(basic.shaft_angle, abs=1e-12)
    # pitch circles are in the ratio of the teeth
    assert np.sin(gear.pitch_angle) / np.sin(pinion.pitch_angle) == pytest.approx(gear.teeth / pinion.teeth, rel=1e-12)
    # one clearance from toe to heel, on both
    for member, mating in ((pinion, gear), (gear, pinion)):
        for share in (0.0, 0.4, 1.0):
            distance = member.inner_cone_distance + share * member.face_width
            z = distance * np.cos(member.pitch_angle)
            assert apart(member, mating, basic.shaft_angle, z) == pytest.approx(blank.clearance, rel=1e-9)
        # the root line passes the apex
        assert member.mean_dedendum == pytest.approx(
            member.mean_cone_distance * np.tan(member.dedendum_angle), rel=1e-9
        )
        outer = member.mean_dedendum * member.outer_cone_distance / member.mean_cone_distance
        assert member.outer_dedendum == pytest.approx(outer, rel=1e-12)
        # the point at the outer addendum across the pitch line is on the tip cone
        sine, cosine = np.sin(member.pitch_angle), np.cos(member.pitch_angle)
        rho = member.outer_cone_distance * sine + member.outer_addendum * cosine
        z = member.outer_cone_distance * cosine - member.outer_addendum * sine
        assert line(member.face_angle, member.tip_radius, z) == pytest.approx(rho, rel=1e-12)
        # the dedendum exceeds the mating gear's addendum by the clearance, which is across the root line
        excess = member.mean_dedendum - mating.mean_addendum
        assert excess * np.cos(member.dedendum_angle) == pytest.approx(blank.clearance, rel=1e-9)
    # teeth and spaces share the pitch, and standard proportions hold
    normal = blank.mean_normal_module
    assert pinion.thickness + gear.thickness == pytest.approx(np.pi * normal, rel=1e-12)
    factor = 2.0 if pinion.teeth >= 12 else DEPTH_FACTORS[pinion.teeth]
    assert blank.mean_working_depth == pytest.approx(factor * normal, rel=1e-12)
    assert blank.clearance == pytest.approx(0.125 * blank.mean_working_depth, rel=1e-9)
    assert pinion.mean_dedendum <= gear.mean_dedendum * (1.0 + 1e-12)


@examples(50)
@given(basic=data, scale=st.floats(0.05, 20.0))
def test_lengths_scale_and_angles_stay(basic: BasicData, scale: float) -> None:
    one = tapered_blank(basic, cutter_radius=75.0)
    other = tapered_blank(replace(basic, module=scale * basic.module), cutter_radius=75.0 * scale)
    for name in SHARED_LENGTHS:
        assert getattr(other, name) == pytest.approx(scale * getattr(one, name), rel=1e-11)
    for a, b in ((one.pinion, other.pinion), (one.gear, other.gear)):
        for name in LENGTHS:
            size = scale * one.gear.mean_cone_distance
            assert getattr(b, name) == pytest.approx(scale * getattr(a, name), rel=1e-11, abs=1e-13 * size)
        for name in ANGLES:
            assert getattr(b, name) == pytest.approx(getattr(a, name), rel=1e-12)


@examples(50)
@given(basic=data, share=st.floats(0.7, 1.5))
def test_spiral_angle_is_that_of_the_cutters_circle(basic: BasicData, share: float) -> None:
    mean = basic.mean_cone_distance
    radius = share * mean
    blank = tapered_blank(basic, cutter_radius=radius)
    # the pitch plane: apex at the origin, mean point on +x, the trace there at the spiral angle from +x
    normal = np.array([np.sin(basic.spiral_angle), -np.cos(basic.spiral_angle)])
    centre = np.array([mean, 0.0]) - radius * normal
    start = np.arctan2(normal[1], normal[0])
    for turn in (-0.12, 0.0, 0.12):
        outward = np.array([np.cos(start + turn), np.sin(start + turn)])
        point, along = centre + radius * outward, np.array([-outward[1], outward[0]])
        angle = np.arctan2(along[1] * point[0] - along[0] * point[1], along @ point)
        assert blank.tooth_line.spiral_angle_at(float(np.hypot(*point))) == pytest.approx(angle, abs=1e-9)


@examples(50)
@given(basic=data, backlash=st.floats(0.0, 0.05))
def test_blanks_are_those_of_the_standard(basic: BasicData, backlash: float) -> None:
    """Tip cones and thicknesses by the dimensions of ISO 23509, for the depths that the blank has."""
    blank, module = tapered_blank(basic, backlash=backlash * basic.module), basic.mean_normal_module
    pinion, gear = blank.pinion, blank.gear
    # the standard counts the clearance across the root lines of the wheel's tip and both of the pinion's cones, so that of
    # depths across the pitch cone the wheel's count
    factors = ToothFactors(
        *2 * (basic.pressure_angle,),
        limit_share=0.0,
        profile_shift=0.5 * (gear.mean_dedendum - pinion.mean_dedendum) / module,
        addendum=0.5 * (blank.mean_depth / module) - blank.clearance / module,
        dedendum=0.5 * blank.mean_depth / module,
        thickness=0.5 * suggested_thickness_factor(basic.teeth),
    )
    cutter = FaceCutter(10.0 * basic.outer_cone_distance)
    given, missing = (pinion.dedendum_angle, gear.dedendum_angle), Backlash(backlash * basic.module)
    own = bevel_dimensions(basic.pitch_cones, cutter, factors, given, missing)
    cones = blank_cones(
        basic.pitch_cones,
        (pinion.dedendum_angle, gear.dedendum_angle),
        (gear.mean_addendum, gear.mean_dedendum),
        blank.clearance,
    )
    size = basic.outer_cone_distance
    for k, (member, dimensions) in enumerate(((pinion, own.pinion), (gear, own.wheel))):
        assert cones.face_angles[k] == dimensions.face_angle == pytest.approx(member.face_angle, abs=1e-14)
        assert member.tip_radius == pytest.approx(cones.face_apexes[k] * np.tan(member.face_angle), abs=1e-13 * size)
        assert cones.root_apexes[k] == pytest.approx(0.0, abs=1e-13 * size)
        assert dimensions.mean_depth.dedendum == pytest.approx(member.mean_dedendum, rel=1e-12)
    assert pinion.thickness == pytest.approx(own.pinion.normal_thickness, rel=1e-12)
    assert gear.thickness == pytest.approx(own.wheel.normal_thickness, rel=1e-12)
    for k, depths in enumerate((own.pinion.mean_depth, own.wheel.mean_depth)):
        assert blank.standard_depths[k].addendum == pytest.approx(depths.addendum, rel=1e-12)
        assert blank.standard_depths[k].dedendum == pytest.approx(depths.dedendum, rel=1e-12)


def test_mitre_gears_are_alike() -> None:
    blank = tapered_blank(BasicData((20, 20), 4.0, 0.6, 0.5 * np.pi, 0.35))
    for name in MemberBlank.__dataclass_fields__:
        assert getattr(blank.pinion, name) == pytest.approx(getattr(blank.gear, name), rel=1e-12)


def test_few_teeth_are_less_deep() -> None:
    def working(teeth: int) -> float:
        blank: BevelBlank = tapered_blank(BasicData((teeth, 40), 4.0, 0.6, 0.5 * np.pi, 0.35))
        return blank.mean_working_depth / blank.mean_normal_module

    assert [round(working(teeth), 3) for teeth in (5, 6, 8, 10, 11, 12, 30)] == [
        1.765,
        1.765,
        1.895,
        1.975,
        1.995,
        2.0,
        2.0,
    ]


def test_uniform_depth_has_parallel_cones() -> None:
    blank = uniform_blank(BasicData((20, 40), 4.0, 0.6, 0.5 * np.pi, 0.35), (0.9, 1.1), 75.0)
    for member in (blank.pinion, blank.gear):
        assert member.root_angle == member.face_angle == member.pitch_angle
        assert member.outer_addendum == member.mean_addendum == pytest.approx(0.9 * blank.mean_normal_module)
        # the tip cone lies the addendum outside the pitch cone
        assert member.tip_radius * np.cos(member.pitch_angle) == pytest.approx(member.mean_addendum, rel=1e-12)
    assert blank.cutter_radius == 75.0


def test_cutter_is_a_nominal_one_where_there_is_one() -> None:
    assert tapered_blank(BasicData((13, 44), 4.0, 0.6, 0.5 * np.pi, 0.35)).cutter_radius == pytest.approx(76.2)
    tiny = tapered_blank(BasicData((13, 44), 0.2, 0.6, 0.5 * np.pi, 0.35))
    assert tiny.cutter_radius == pytest.approx(0.95 * tiny.gear.mean_cone_distance)


def test_what_cannot_exist_is_refused() -> None:
    with pytest.raises(DesignError, match=r"shaft_angle = 150 deg: .*allowed is less than 109.471 deg"):
        BasicData((10, 30), 4.0, 0.6, float(np.radians(150.0)), 0.35)
    with pytest.raises(
        DesignError, match=r"gear would be 91\.\d+ deg; allowed is a face angle of less than 89\.5 deg$"
    ):
        tapered_blank(BasicData((8, 24), 4.0, 0.0, 1.875, 0.35))
    with pytest.raises(DesignError, match=r"^face_width = 60 mm: allowed is less than 55\.05"):
        replace(PLAIN, given_face_width=60.0)
    for distance in (60.0, 92.0):
        with pytest.raises(DesignError, match=rf"^mean_cone_distance = {distance:g} mm: allowed is between"):
            replace(PLAIN, given_mean_cone_distance=distance)
    with pytest.raises(DesignError, match=r"^clearance = 4 mm: allowed is less than half the mean working depth"):
        tapered_blank(PLAIN, Proportions(clearance=4.0))
    pinion, gear = PLAIN.pitch_angles
    # the pitch angle itself is that of uniform depth
    for roots, name in (((pinion + 0.02, None), "pinion"), ((None, -0.1), "gear")):
        with pytest.raises(DesignError, match=rf"^{name}\.root_angle = .*allowed is between 0 and the pitch angle"):
            tapered_blank(PLAIN, Proportions(root_angles=roots))
    with pytest.raises(DesignError, match=r"^clearance = 1 mm: leaves no working depth"):
        tapered_blank(PLAIN, Proportions(clearance=1.0, root_angles=(pinion - 0.005, gear - 0.005)))


def test_wide_faces_are_warned_of() -> None:
    outer = PLAIN.outer_cone_distance
    assert tapered_blank(replace(PLAIN, given_face_width=0.349 * outer)).warnings == ()
    (warning,) = tapered_blank(replace(PLAIN, given_face_width=0.351 * outer)).warnings
    assert "more than 0.35 of the outer cone distance" in warning
    # of itself the face is 0.3 of the outer cone distance, at most ten modules
    assert PLAIN.face_width == pytest.approx(0.3 * outer)
    assert replace(PLAIN, teeth=(13, 90)).face_width == pytest.approx(40.0)


def test_both_members_give_way_for_half_of_the_backlash() -> None:
    none, some = tapered_blank(PLAIN), tapered_blank(PLAIN, backlash=0.1)
    tangent = np.tan(PLAIN.pressure_angle)
    # the slot of the gear takes the pinion's tooth at the pitch line and narrows towards the root, whose line leans
    depth = none.gear.mean_dedendum * np.cos(none.gear.dedendum_angle)
    assert none.point_width + 2.0 * depth * tangent == pytest.approx(none.pinion.thickness)
    half = 0.05 / np.cos(PLAIN.pressure_angle)
    assert some.point_width - none.point_width == pytest.approx(half)
    for first, second in ((none.pinion, some.pinion), (none.gear, some.gear)):
        assert first.thickness - second.thickness == pytest.approx(half)


def test_proportions_may_be_given() -> None:
    basic = BasicData((13, 44), 4.0, 0.6, 0.5 * np.pi, 0.35)
    blank = tapered_blank(basic, Proportions(1.8, 0.3, 0.05, face_angles=(0.4, None)))
    assert blank.mean_working_depth == pytest.approx(1.8 * blank.mean_normal_module, rel=1e-2)
    assert blank.gear.mean_addendum == pytest.approx(0.3 * blank.mean_working_depth, rel=1e-2)
    plain = tapered_blank(basic, Proportions(1.8, 0.3, 0.0))
    assert blank.pinion.thickness - plain.pinion.thickness == pytest.approx(0.05 * blank.mean_normal_module)
    # the given tip cone passes the same tip at the mean cone distance
    for member, angle in ((blank.pinion, 0.4), (plain.pinion, plain.pinion.face_angle)):
        assert member.face_angle == angle
        rho = member.mean_cone_distance * np.sin(member.pitch_angle) + member.mean_addendum * np.cos(member.pitch_angle)
        z = member.mean_cone_distance * np.cos(member.pitch_angle) - member.mean_addendum * np.sin(member.pitch_angle)
        assert line(member.face_angle, member.tip_radius, z) == pytest.approx(rho, rel=1e-12)
