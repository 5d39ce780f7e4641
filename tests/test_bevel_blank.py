"""Blanks of bevel gears: the table of [AB], and what must hold for any basic data."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from gearmesh.bevel_blank import BasicData, BevelBlank, MemberBlank, Proportions, tapered_blank, uniform_blank
from gearmesh.errors import DesignError

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


def line(angle: float, at: float, z: float) -> float:
    """rho of a cone at z."""
    return at + z * float(np.tan(angle))


def apart(member: MemberBlank, mate: MemberBlank, shaft_angle: float, z: float) -> float:
    """Distance from the tip point of a member at its z to the mate's root line, in the axial plane that both share."""
    rho = line(member.face_angle, member.tip_radius, z)
    # the mate's axis lies at the shaft angle from the member's, beyond the pitch line
    angle = np.arctan2(rho, z)
    size = np.hypot(rho, z)
    return float(size * np.sin((shaft_angle - angle) - mate.root_angle))


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
    minute = np.pi / 180.0 / 60.0
    roots = (float(np.radians(12.0) + minute), float(np.radians(72.0) + 25.0 * minute))
    blank = tapered_blank(basic, Proportions(clearance=0.838, root_angles=roots))
    assert blank.outer_cone_distance == pytest.approx(96.418, abs=1e-9)
    # depths at the heel: the root angles are printed to the minute, 0.028 mm there for each of them
    working = blank.gear.outer_addendum + blank.pinion.outer_addendum
    assert working == pytest.approx(7.671, abs=0.06)
    assert blank.gear.outer_addendum + blank.gear.outer_dedendum == pytest.approx(8.509, abs=0.06)
    assert np.degrees(blank.gear.pitch_angle) == pytest.approx(76.2936, abs=1e-3)
    # the printed module of 5.559 per inch
    assert 25.4 / basic.module == pytest.approx(5.559, abs=1e-3)


@settings(deadline=None, max_examples=100)
@given(basic=data)
def test_tapered_blanks(basic: BasicData) -> None:
    blank = tapered_blank(basic)
    pinion, gear = blank.pinion, blank.gear
    assert pinion.pitch_angle + gear.pitch_angle == pytest.approx(basic.shaft_angle, abs=1e-12)
    # pitch circles are in the ratio of the teeth
    assert np.sin(gear.pitch_angle) / np.sin(pinion.pitch_angle) == pytest.approx(gear.teeth / pinion.teeth, rel=1e-12)
    # one clearance from toe to heel, on both
    for member, mate in ((pinion, gear), (gear, pinion)):
        for share in (0.0, 0.4, 1.0):
            distance = blank.inner_cone_distance + share * blank.face_width
            z = distance * np.cos(member.pitch_angle)
            assert apart(member, mate, basic.shaft_angle, z) == pytest.approx(blank.clearance, rel=1e-9)
    # teeth and spaces share the pitch, and standard proportions hold
    normal = blank.mean_normal_module
    assert pinion.thickness + gear.thickness == pytest.approx(np.pi * normal, rel=1e-12)
    assert blank.mean_working_depth <= 2.0 * normal * (1.0 + 1e-12)
    assert blank.clearance == pytest.approx(0.125 * blank.mean_working_depth, rel=1e-9)
    across_pitch_line = pinion.mean_dedendum - gear.mean_addendum
    assert across_pitch_line == pytest.approx(blank.clearance, rel=2e-3, abs=1e-9) or across_pitch_line > 0.0
    assert gear.mean_addendum <= pinion.mean_addendum * (1.0 + 1e-9)
    assert blank.spiral_angle_at(blank.mean_cone_distance) == pytest.approx(basic.spiral_angle, abs=1e-9)


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
    assert tiny.cutter_radius == pytest.approx(0.95 * tiny.mean_cone_distance)


def test_what_cannot_exist_is_refused() -> None:
    with pytest.raises(DesignError, match=r"shaft_angle = 150 deg: .*allowed is less than 90 deg"):
        BasicData((10, 30), 4.0, 0.6, float(np.radians(150.0)), 0.35)
    with pytest.raises(DesignError, match="face angle of the gear would be"):
        tapered_blank(BasicData((8, 24), 4.0, 0.0, 1.875, 0.35))


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
        rho = blank.mean_cone_distance * np.sin(member.pitch_angle) + member.mean_addendum * np.cos(member.pitch_angle)
        z = blank.mean_cone_distance * np.cos(member.pitch_angle) - member.mean_addendum * np.sin(member.pitch_angle)
        assert line(member.face_angle, member.tip_radius, z) == pytest.approx(rho, rel=1e-12)
