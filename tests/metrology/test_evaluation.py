"""Deviations that are made come back as the figures that they were made of."""

from __future__ import annotations

import numpy as np
import pytest

from gearmesh import DesignError
from gearmesh.kinds import Side
from gearmesh.metrology.evaluation import evaluate_trace, helix_range, helix_sign, profile_range
from gearmesh.metrology.pitch import BallInSpace, PitchDeviations
from gearmesh.metrology.second_order import flank_coordinates, second_order

UM = 1e-3


@pytest.mark.quick
def test_ranges_of_evaluation() -> None:
    profile = profile_range(10.0, 30.0, 31.0)
    assert (profile.evaluated, profile.applies, profile.slope) == ((10.0, 29.0), (10.0, 30.0), (10.0, 31.0))
    # of an internal gear the tip has the smaller roll length
    assert profile_range(30.0, 10.0).evaluated == (30.0, 11.0)
    # 5 % of 40 mm is 2 mm, the smaller of it and the module; either way round
    assert helix_range(20.0, -20.0, 3.0).evaluated == (-18.0, 18.0)
    assert helix_range(-20.0, 20.0, 1.5).evaluated == (-18.5, 18.5)


@pytest.mark.parametrize("trace_range", [profile_range(8.0, 28.0, 28.5), profile_range(28.0, 8.0, 7.8)])
@pytest.mark.quick
def test_a_slope_with_a_wave_and_a_crown_comes_back(trace_range) -> None:  # type: ignore[no-untyped-def]
    """The wave is orthogonal to lines and parabolas at the points of Gauss's rule: nothing of it is slope or crowning."""
    first, last = trace_range.evaluated
    w, _ = np.polynomial.legendre.leggauss(40)
    x = first + 0.5 * (w + 1.0) * (last - first)
    # weights of the points differ: make the wave orthogonal to the parabola
    wave = np.cos(9.0 * np.arccos(w))
    wave -= np.polynomial.Polynomial.fit(w, wave, 2)(w)
    begin, end = trace_range.slope
    line = 7.0 * UM * (x - begin) / (end - begin) - 3.0 * UM
    trace = evaluate_trace(x, line + 2.0 * UM * wave, trace_range)
    assert trace.slope == pytest.approx(7.0 * UM, rel=1e-12)
    assert trace.form == pytest.approx(2.0 * UM * np.ptp(wave), rel=1e-12)
    assert trace.total == pytest.approx(np.ptp(line + 2.0 * UM * wave), rel=1e-12)
    assert abs(trace.crowning) < 1e-12
    assert trace.line == pytest.approx([7.0 * UM * (at - begin) / (end - begin) - 3.0 * UM for at in (first, last)])
    crowned = evaluate_trace(x, line + 4.0 * UM * (1.0 - w**2), trace_range)
    assert crowned.crowning == pytest.approx(4.0 * UM, rel=1e-12)
    assert evaluate_trace(x, line, trace_range.over).slope == pytest.approx(7.0 * UM * (last - first) / (end - begin))


@pytest.mark.quick
def test_beside_the_range_excess_counts_and_missing_material_does_not() -> None:
    """2 mm at either end of 40 mm: the line through 0 stays; total and form grow by what stands out, not by what is removed."""
    z = np.linspace(-20.0, 20.0, 401)
    ends = helix_range(-20.0, 20.0, 2.0)
    flat = 1.0 * UM * np.cos(np.pi * z)
    plain = evaluate_trace(z, flat, ends)
    relieved, excess = (evaluate_trace(z, flat + a * UM * (np.abs(z) > 18.5), ends) for a in (-30.0, 5.0))
    assert relieved == plain
    assert excess.slope == plain.slope
    assert excess.total == pytest.approx(7.0 * UM, rel=1e-9)
    assert excess.form == pytest.approx(plain.form + 5.0 * UM, rel=1e-6)
    # what is beyond where the design applies counts for nothing; what is not known neither
    gaps = flat + np.where(np.abs(z) > 20.0, 1.0, 0.0)
    gaps[::7] = np.nan
    assert evaluate_trace(z, gaps, ends).total == pytest.approx(2.0 * UM, rel=1e-3)
    with pytest.raises(DesignError, match="too few measured points between -18 and 18 mm"):
        evaluate_trace(z[:12], flat[:12], ends)


@pytest.mark.quick
def test_a_larger_helix_angle_is_a_positive_helix_slope() -> None:
    """A flank y = side (thickness + d) + z tan(beta) of a tooth on +x: its own slope against that of the nominal one."""
    for side in (1, -1):
        for helix in (0.2, -0.2, 0.0):
            rise = 1e-3
            # outward is -y on the right flank
            angle = np.arctan(np.tan(helix) - side * rise)
            larger = abs(angle) - abs(helix) if helix else angle
            assert np.sign(larger) == helix_sign(side, helix) * np.sign(rise)


@pytest.mark.quick
def test_six_terms_over_a_flank_come_back() -> None:
    """On a spiral, tapered grid; angles by the exact slope along the flank."""
    x, y = np.linspace(-12.0, 12.0, 9), np.linspace(-3.0, 3.0, 5)
    length, height = np.broadcast_to(x, (5, 9)), y[:, None] * (1.0 + 0.01 * x)
    points = np.stack((length * np.cos(0.6), length * np.sin(0.6), height), axis=-1)
    along, up = flank_coordinates(points)
    assert np.abs(along - length).max() < 0.02
    assert up == pytest.approx(height, abs=1e-12)
    w, v = length / 12.0, height / np.abs(height).max()
    d = UM * (3.0 + 2.0 * w - 5.0 * v - 6.0 * w**2 + 1.5 * w * v - 4.0 * v**2)
    own = second_order(length, height, d)
    assert own.thickness == pytest.approx(3.0 * UM)
    assert own.lengthwise_angle == pytest.approx(np.arctan(2.0 * UM / 12.0))
    assert own.profile_angle == pytest.approx(np.arctan(5.0 * UM / np.abs(height).max()))
    assert (own.length_crowning, own.profile_crowning) == pytest.approx((6.0 * UM, 4.0 * UM))
    # from -1.5 w to 1.5 w at either end, twice that from root to tip, and the heel less the toe
    assert own.twist == pytest.approx(6.0 * UM)
    assert own.largest < 1e-12
    moved = second_order(length + 100.0, height - 7.0, d)
    assert moved.profile_angle == pytest.approx(own.profile_angle)
    noisy = d + 1.0 * UM * np.where(np.arange(45).reshape(5, 9) == 22, 1.0, 0.0)
    assert second_order(length, height, noisy).largest > 0.5 * UM
    with pytest.raises(DesignError, match="3 x 3 or more"):
        second_order(length[:2], height[:2], d[:2])


@pytest.mark.quick
def test_eccentric_gear_has_matching_pitch_deviations_and_runout() -> None:
    """Index deviations by exact displaced flanks: along arcs of the reference circle amplitude e / cos(alpha) on either side, out
    of phase by 2 alpha; a ball in the spaces moves by e up and down."""
    count, alpha, e = 36, np.radians(20.0), 0.02
    angle = 2.0 * np.pi * np.arange(count) / count
    half = np.pi / count / 2.0
    sides = {}
    for sign in (1, -1):
        at = angle - sign * half
        tangent, radial = np.stack((-np.sin(at), np.cos(at)), -1), np.stack((np.cos(at), np.sin(at)), -1)
        normal = -sign * np.cos(alpha) * tangent + np.sin(alpha) * radial
        moved = normal @ np.array([e, 0.0])
        sides[sign] = PitchDeviations.of_index(moved / (-sign * np.cos(alpha)))
    right, left = sides[1], sides[-1]
    for own in (right, left):
        assert own.cumulative == pytest.approx(2.0 * e / np.cos(alpha), rel=4e-3)
        assert own.single_pitch == pytest.approx(2.0 * e / np.cos(alpha) * np.sin(np.pi / count), rel=4e-3)
        assert own.sector(count // 2) == pytest.approx(own.cumulative, rel=1e-3)
        assert PitchDeviations.of_single(own.single).single == pytest.approx(own.single, abs=1e-15)
        assert PitchDeviations.of_single(own.single).cumulative == pytest.approx(own.cumulative)
    # the ball is half a pitch before the tooth; its spaces are as wide as the teeth
    ball = BallInSpace(alpha, half)
    assert ball.heights(right, left) == pytest.approx(e * np.cos(angle - 2.0 * half), abs=1e-15)
    assert ball.eccentricity(right, left) == pytest.approx(e, rel=1e-12)
    assert ball.runout(right, left) == pytest.approx(2.0 * e, rel=4e-3)


def test_ball_in_an_asymmetric_space_goes_with_an_eccentric_gear() -> None:
    """Both flanks have their own pressure angle and half of the space; the ball moves as the axis does."""
    teeth, e, phase = 23, 0.02, 0.3
    ball = BallInSpace(0.45, 0.05, left=(0.3, 0.07))
    sides = ball.eccentric(e, phase, teeth)
    right, left = sides[Side.RIGHT], sides[Side.LEFT]
    spaces = 2.0 * np.pi * (np.arange(teeth) - 0.5) / teeth
    heights = ball.heights(right, left)
    assert heights == pytest.approx(e * np.cos(phase - spaces), abs=1e-15)
    for known in Side:
        found = ball.other_side(known, sides[known], heights)
        assert found.index == pytest.approx(sides[known.other].index, abs=1e-15)
    both = ball.both_sides(heights)
    assert both[Side.LEFT].index == pytest.approx(left.index, abs=1e-15)
