"""Bracketed roots and last places where a condition holds: values, a status for every member, none depending on others."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.optimize.elementwise import find_root

from gearmesh.errors import Status
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.roots import bracketed_root, last_true

pytestmark = pytest.mark.quick

Index = NDArray[np.intp]


def test_roots_and_their_statuses() -> None:
    """Members: ordinary, falling, root at either end, flat far out rising and falling, no change of sign."""
    low = np.array([0.0, 0.0, 0.0, -1.0, -30.0, -30.0, 0.0])
    high = np.array([2.0, 2.0, 1.0, 0.0, 31.0, 31.0, 2.0])

    def function(x: Array, index: Index) -> Array:
        f = x**3 - 2.0, 1.0 - x, x * (3.0 - x), x * (3.0 - x), np.arctan(x - 7.0), np.arctan(7.0 - x), x + 1.0
        return np.choose(index, f)

    found = bracketed_root(function, low, high, tolerance=1e-14)
    assert [Status(s) for s in found.status] == [Status.CONVERGED] * 6 + [Status.NO_CONTACT]
    np.testing.assert_allclose(found.values[:6], [2.0 ** (1.0 / 3.0), 1.0, 0.0, 0.0, 7.0, 7.0], rtol=0, atol=2e-14)
    np.testing.assert_array_equal(found.residual[:6], np.abs(function(found.values, np.arange(7)))[:6])

    # the same the other way round
    back = bracketed_root(function, high, low, tolerance=1e-14)
    np.testing.assert_array_equal(back.status, found.status)
    np.testing.assert_allclose(back.values[:6], found.values[:6], rtol=0, atol=2e-14)

    hurried = bracketed_root(function, low, high, tolerance=1e-14, max_iterations=2)
    assert hurried.status[0] == Status.MAX_ITERATIONS
    assert hurried.status[6] == Status.NO_CONTACT


def test_before_is_the_end_towards_low() -> None:
    low, high = np.array([0.0, 2.0, 0.0, 2.0]), np.array([2.0, 0.0, 2.0, 0.0])
    sign = np.array([1.0, 1.0, -1.0, -1.0])

    def function(x: Array, index: Index) -> Array:
        return sign[index] * (np.exp(x) - 3.0)

    found = bracketed_root(function, low, high)
    values, at_low = function(found.before, np.arange(4)), function(low, np.arange(4))
    assert ((values == 0.0) | (np.sign(values) == np.sign(at_low))).all()
    np.testing.assert_allclose(found.before, np.log(3.0), rtol=1e-15)


def test_what_is_no_root() -> None:
    """Members: a pole, jumps alone and on a slope, undefined in the middle, at an end, infinite at an end, a root."""

    def function(x: Array, index: Index) -> Array:
        with np.errstate(divide="ignore"):
            f = (
                1.0 / (x - 0.3),
                np.where(x > 0.3, 1.0, -1.0),
                x - 0.3 + 0.1 * np.where(x > 0.3, 1.0, -1.0),
                np.where(np.abs(x) > 0.4, x, np.nan),
                np.where(x > -0.9, x, np.nan),
                np.where(x > -1.0, x, -np.inf),
                x,
            )
        return np.choose(index, f)

    found = bracketed_root(function, np.full(7, -1.0), np.full(7, 2.0))
    assert [Status(s) for s in found.status] == [Status.NOT_FINITE] * 6 + [Status.CONVERGED]
    assert found.values[6] == pytest.approx(0.0, abs=1e-13)


@pytest.mark.parametrize("power", [0.25, 1.0 / 3.0, 3.0, 9.0])
def test_steep_and_flat_roots_are_roots(power: float) -> None:
    low, high = np.array([-1.0, -0.1, -3.0]), np.array([2.0, 5.0, 0.31])
    found = bracketed_root(lambda x, k: np.sign(x - 0.3) * np.abs(x - 0.3) ** power, low, high)
    assert found.converged.all()
    assert (found.residual <= 1e-15**power * 10.0).all()


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-12])
def test_poles_and_jumps_are_told_from_steep_roots_by_wide_brackets_too(tolerance: float) -> None:
    """Members: a pole, a jump, a root as steep as a cube root, a straight one."""

    def function(x: Array, index: Index) -> Array:
        d = x - 0.3
        return np.choose(index, (1.0 / d, np.where(d > 0.0, 1.0, -1.0) + d, np.cbrt(d), d))

    found = bracketed_root(function, np.full(4, -1.0), np.full(4, 2.1), tolerance=tolerance)
    np.testing.assert_array_equal(found.converged, [False, False, True, True])


def test_iterates_are_those_of_scipy() -> None:
    """The same method, to the last digit, with a status for what scipy does not tell from a root."""
    rng = np.random.default_rng(8)
    k, low, high = rng.uniform(0.2, 9.0, 500), rng.uniform(-1.4, 0.0, 500), rng.uniform(0.1, 1.5, 500)

    def function(x: Array, index: Index) -> Array:
        return np.tan(x) - x - 0.1 * k[index]

    found = bracketed_root(function, low, high)
    tolerances = {"xatol": 0.0, "xrtol": 4.0 * np.finfo(float).eps}
    known = find_root(
        lambda x, at: function(x, at.astype(int)), (low, high), args=(np.arange(500.0),), tolerances=tolerances
    )
    np.testing.assert_array_equal(found.values, known.x)
    np.testing.assert_array_equal(found.converged, known.success)
    assert 100 < found.converged.sum() < 500
    assert found.iterations == known.nit.max()


def test_an_empty_batch() -> None:
    assert bracketed_root(lambda x, k: x, np.zeros(0), np.zeros(0)).converged.shape == (0,)


@pytest.mark.parametrize("split", [2, 3, 12])
def test_the_last_place_where_a_condition_holds(split: int) -> None:
    edge = np.array([0.3, -0.2, 1e-9, 0.9999])
    low, high = np.array([0.0, 0.0, 0.0, 0.0]), np.array([1.0, -1.0, 1.0, 1.0])

    def holds(x: Array, index: Index) -> NDArray[np.bool_]:
        return np.abs(x) <= np.abs(edge[index])

    last, first = last_true(holds, low, high)
    np.testing.assert_allclose(last, edge, rtol=0, atol=2.0**-60)
    assert holds(last, np.arange(4)).all()
    assert not holds(first, np.arange(4)).any()
    # after few rounds the ends are as far apart as they must be
    last, first = last_true(holds, low, high, rounds=4, split=split)
    np.testing.assert_allclose(np.abs(first - last), float(split) ** -4, rtol=1e-9)
    assert (np.abs(last) <= np.abs(edge)).all()
    assert (np.abs(first) > np.abs(edge)).all()


@pytest.mark.parametrize("split", [2, 5])
def test_whole_numbers_end_as_neighbours_and_are_asked_once(split: int) -> None:
    asked: list[int] = []

    def holds(n: NDArray[np.int64], index: Index) -> NDArray[np.bool_]:
        asked.extend(int(k) for k in n)
        return n <= np.array([17, 9_999, 2])[index]

    last, first = last_true(holds, np.array([2, 2, 2]), np.array([10_000, 10_000, 3]), split=split)
    np.testing.assert_array_equal(last, [17, 9_999, 2])
    np.testing.assert_array_equal(first, [18, 10_000, 3])
    assert len(asked) <= 2 * 14 * split
