"""Own splines against scipy's, which the program does without because loading them takes longer than a contact."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import BSpline, PchipInterpolator, make_interp_spline
from scipy.ndimage import map_coordinates, spline_filter

from gearmesh.contact.first_touch.spline_table import STEPS_BEYOND_RIM, SplineTable
from gearmesh.kernel.numeric.splines import (
    SplineCurve,
    control_net,
    interpolate,
    knots_of,
    rising_through,
    spline_through,
    table_filter,
    tensor_product,
)

#: places and degree: many, few, and one more than the degree
CASES = [(25, 5), (60, 5), (9, 3), (4, 3), (12, 1), (3, 2), (2, 1)]


@pytest.mark.quick
@pytest.mark.parametrize(("count", "degree"), CASES)
def test_splines_are_scipys(count: int, degree: int) -> None:
    """Knots, coefficients, values and derivatives, also beyond both ends and at the knots."""
    random = np.random.default_rng(count)
    x = np.cumsum(random.uniform(0.2, 1.0, count))
    y = random.normal(size=(count, 2))
    theirs, own = make_interp_spline(x, y, k=degree), spline_through(x, y, degree)
    assert np.array_equal(knots_of(x, degree), theirs.t)
    size = np.abs(theirs.c).max()
    assert interpolate(x, y, degree) == pytest.approx(theirs.c, abs=1e-12 * size)
    places = np.concatenate((np.linspace(x[0] - 0.2, x[-1] + 0.2, 101), x))
    for order in range(degree + 1):
        expected = theirs(places, nu=order)
        assert own(places, order) == pytest.approx(expected, abs=1e-11 * np.abs(expected).max())
    assert not own(places, degree + 1).any()


@pytest.mark.quick
def test_surfaces_and_curves_on_given_knots_are_scipys() -> None:
    random = np.random.default_rng(11)
    x, y = np.cumsum(random.uniform(0.2, 1.0, 30)), np.cumsum(random.uniform(0.2, 1.0, 9))
    points, knots = random.normal(size=(30, 9, 3)), (knots_of(x, 5), knots_of(y, 3))
    net = control_net((x, y), points, knots)
    across = make_interp_spline(x, points, k=5).c
    theirs = make_interp_spline(y, across, k=3, axis=1).c.swapaxes(0, 1)
    assert net == pytest.approx(theirs, abs=1e-11 * np.abs(theirs).max())
    places = np.linspace(x[0], x[-1], 41), np.linspace(y[0], y[-1], 17)
    expected = BSpline(knots[1], BSpline(knots[0], theirs, 5)(places[0]), 3, axis=1)(places[1])
    assert tensor_product(knots, net, places) == pytest.approx(expected, abs=1e-11 * np.abs(theirs).max())
    # knots that are not those of the places
    other = np.concatenate((np.repeat(x[0], 6), np.linspace(x[0], x[-1], 26)[1:-1], np.repeat(x[-1], 6)))
    at = np.array([other[k + 1 : k + 6].mean() for k in range(30)])
    curve, same = SplineCurve.through(at, points, 5, other), make_interp_spline(at, points, k=5, t=other)
    assert curve(places[0]) == pytest.approx(same(places[0]), abs=1e-11 * np.abs(same.c).max())


@pytest.mark.quick
def test_rising_splines_are_scipys() -> None:
    random = np.random.default_rng(5)
    for count in (2, 3, 4, 40):
        x, values = (np.cumsum(random.exponential(size=count)) for _ in range(2))
        places = np.linspace(x[0], x[-1], 401)
        found = rising_through(x, values)(places)
        assert found == pytest.approx(PchipInterpolator(x, values)(places), abs=1e-12 * values[-1])
        assert (np.diff(found) >= 0.0).all()


@pytest.mark.quick
def test_tables_are_scipys_and_go_through_their_values() -> None:
    random = np.random.default_rng(7)
    values = random.normal(size=(11, 16))
    rows, columns = random.uniform(0, 10, 500), random.uniform(0, 15, 500)
    table = SplineTable.of(values)
    grid = np.meshgrid(np.arange(11.0), np.arange(16.0), indexing="ij")
    assert table.at(*grid) == pytest.approx(values, abs=1e-13)
    own = table_filter(30) @ (plain := random.normal(size=(30, 41))) @ table_filter(41).T
    assert own == pytest.approx(spline_filter(plain, order=3), abs=1e-13)
    places = np.stack((rows, columns)) + STEPS_BEYOND_RIM
    expected = map_coordinates(table.coefficients, places, order=3, prefilter=False, mode="mirror")
    assert table.at(rows, columns) == pytest.approx(expected, abs=1e-12)


def test_tables_know_parabolas_beyond_their_rim_and_nothing_further_on() -> None:
    """Six steps beyond they are carried on by parabolas, so that no error is left in one but next to the mirrored end."""
    i, j = np.meshgrid(np.arange(9.0), np.arange(8.0), indexing="ij")
    parabola = lambda x, y: 1.0 + x - 0.5 * y + 0.25 * x**2 - 0.125 * x * y + 0.1 * y**2  # noqa: E731
    table = SplineTable.of(parabola(i, j))
    at = np.linspace(-2.0, 9.5, 47)
    x, y = np.meshgrid(at, at[:-3], indexing="ij")
    # the mirrored end of a spline fades by 2 - sqrt 3 a step
    assert table.at(x, y) == pytest.approx(parabola(x, y), abs=0.1)
    inner = np.meshgrid(np.linspace(0.0, 8.0, 33), np.linspace(0.0, 7.0, 29), indexing="ij")
    assert table.at(*inner) == pytest.approx(parabola(*inner), abs=5e-3)
    over = np.array([-STEPS_BEYOND_RIM - 0.01, 8.0 + STEPS_BEYOND_RIM + 0.01, np.nan])
    assert np.isnan(table.at(over, np.zeros(3))).all()
    assert np.isfinite(table.at(np.array([-6.0, 14.0]), np.array([-6.0, 13.0]))).all()
