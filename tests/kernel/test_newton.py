"""Batched Newton: its order, systems with a null space, and a status for every member."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from gearmesh.errors import Status
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.newton import solve

pytestmark = pytest.mark.quick

Index = NDArray[np.intp]


def circle_and_hyperbola(x: Array, index: Index) -> tuple[Array, Array]:
    """x^2 + y^2 = 5, x y = 2: roots (2, 1), (1, 2) and their opposites."""
    a, b = x[:, 0], x[:, 1]
    f = np.stack((a * a + b * b - 5.0, a * b - 2.0), axis=-1)
    return f, np.stack((np.stack((2.0 * a, 2.0 * b), axis=-1), np.stack((b, a), axis=-1)), axis=-2)


def test_convergence_is_quadratic() -> None:
    visited: list[Array] = []

    def recorded(x: Array, index: Index) -> tuple[Array, Array]:
        visited.append(np.abs(x - [2.0, 1.0]).max(axis=-1))
        return circle_and_hyperbola(x, index)

    start = np.array([[2.3, 1.3], [2.2, 0.9], [1.9, 1.15]])
    solution = solve(recorded, start, tolerance=1e-13)
    assert solution.converged.all()
    np.testing.assert_allclose(solution.values, [[2.0, 1.0]] * 3, rtol=0, atol=2e-15)
    for errors in np.array([e for e in visited if e.size == 3]).T:
        # the digits double while errors are above rounding and below the first step's
        steps = [(a, b) for a, b in pairwise(errors) if 1e-7 < a < 0.3]
        orders = [np.log(c / b) / np.log(b / a) for (a, b), (_, c) in pairwise(steps)]
        assert len(orders) >= 1
        assert orders[-1] == pytest.approx(2.0, abs=0.25)
    assert solution.iterations <= 7


def test_one_more_iteration_than_the_tolerance_needs() -> None:
    start = np.array([[2.3, 1.3]])
    loose = solve(circle_and_hyperbola, start, tolerance=1e-4)
    assert loose.residual.max() <= 1e-8


def test_damping_and_step_limit_reach_roots_that_full_steps_miss() -> None:
    def flat(x: Array, index: Index) -> tuple[Array, Array]:
        return np.arctan(x), (1.0 / (1.0 + x * x))[..., None]

    start = np.array([[20.0], [-8.0], [1.0]])  # full Newton steps on atan diverge beyond 1.39
    damped = solve(flat, start, tolerance=1e-14)
    assert damped.converged.all()
    np.testing.assert_allclose(damped.values, 0.0, atol=1e-14)

    visited: list[Array] = []

    def recorded(x: Array, index: Index) -> tuple[Array, Array]:
        visited.append(x[0].copy())
        return circle_and_hyperbola(x, index)

    limited = solve(recorded, np.array([[9.0, 1.0]]), tolerance=1e-13, max_step=np.array([0.5, 0.25]))
    assert limited.converged.all()
    steps = np.abs(np.diff(visited, axis=0))
    # no step is rejected on this way down, so the points visited are the iterates
    assert (steps <= np.array([0.5, 0.25]) * (1.0 + 1e-12)).all()
    assert (steps[:10] / [0.5, 0.25]).max(axis=-1) == pytest.approx(1.0)


def test_consistent_singular_systems_go_to_the_solution_nearest_the_start() -> None:
    def unit_circle(x: Array, index: Index) -> tuple[Array, Array]:
        g, gradient = (x * x).sum(axis=-1) - 1.0, 2.0 * x
        return np.stack((g, -3.0 * g), axis=-1), np.stack((gradient, -3.0 * gradient), axis=-2)

    angle = np.linspace(0.0, 6.0, 7)
    directions = np.stack((np.cos(angle), np.sin(angle)), axis=-1)
    solution = solve(unit_circle, np.linspace(0.5, 3.0, 7)[:, None] * directions, tolerance=1e-13, rcond=1e-8)
    assert solution.converged.all()
    np.testing.assert_allclose(solution.values, directions, rtol=0, atol=1e-14)

    def nearly_singular(x: Array, index: Index) -> tuple[Array, Array]:
        # a line of solutions x + y = 2, of which a tilt at rounding level claims to know the one point
        f = np.stack((x[:, 0] + x[:, 1] - 2.0, x[:, 0] + (1.0 + 1e-12) * x[:, 1] - 2.0 - 1e-9), axis=-1)
        return f, np.tile(np.array([[1.0, 1.0], [1.0, 1.0 + 1e-12]]), (len(x), 1, 1))

    kept = solve(nearly_singular, np.array([[0.0, 0.0], [3.0, 0.0]]), tolerance=1e-8, rcond=1e-8)
    assert kept.converged.all()
    np.testing.assert_allclose(kept.values, [[1.0, 1.0], [2.5, -0.5]], rtol=0, atol=1e-8)


@pytest.mark.parametrize("rcond", [None, 1e-8])
def test_bad_members_have_their_status_and_spoil_no_other(rcond: float | None) -> None:
    """Members: good, undefined from the start, undefined near the root, no root, broken derivative, good, singular."""
    good = np.array([0, 5])

    def mixed(x: Array, index: Index) -> tuple[Array, Array]:
        f, jacobian = circle_and_hyperbola(x, index)
        f[index == 1] = np.nan
        beyond = (index == 2) & (x[:, 0] < 2.1)
        f[beyond], jacobian[beyond] = np.nan, np.nan
        f[index == 3] += [[20.0, 0.0]]
        jacobian[index == 4] = np.nan
        jacobian[index == 6] = 0.0
        return f, jacobian

    start = np.array([[2.3, 1.3], [2.0, 1.1], [2.4, 1.2], [1.0, 0.4], [2.2, 1.2], [0.8, 2.3], [2.2, 1.1]])
    solution = solve(mixed, start, tolerance=1e-13, rcond=rcond)
    assert {i: Status(solution.status[i]) for i in range(6)} == {
        0: Status.CONVERGED,
        1: Status.NOT_FINITE,
        2: Status.STALLED,
        3: Status.STALLED,
        4: Status.SINGULAR,
        5: Status.CONVERGED,
    }
    np.testing.assert_array_equal(solution.converged, np.isin(np.arange(7), good))
    alone = solve(circle_and_hyperbola, start[good], tolerance=1e-13, rcond=rcond)
    np.testing.assert_allclose(solution.values[good], alone.values, rtol=0, atol=1e-15)
    np.testing.assert_allclose(solution.values[good], [[2.0, 1.0], [1.0, 2.0]], rtol=0, atol=1e-15)
    # what is not solved is left at the last point where the function was defined
    assert np.isfinite(solution.values).all()
    assert solution.values[2, 0] >= 2.1


def test_start_at_the_solution_and_empty_batch() -> None:
    at = solve(circle_and_hyperbola, np.array([[2.0, 1.0]]), tolerance=1e-13)
    assert at.converged.all()
    assert at.iterations == 1
    np.testing.assert_array_equal(at.values, [[2.0, 1.0]])
    none = solve(circle_and_hyperbola, np.zeros((0, 2)), tolerance=1e-13)
    assert none.values.shape == (0, 2)
    assert none.status.shape == (0,)


def test_start_is_not_written_to() -> None:
    start = np.array([[2.3, 1.3]])
    solve(circle_and_hyperbola, start, tolerance=1e-13)
    np.testing.assert_array_equal(start, [[2.3, 1.3]])


def test_too_few_iterations_are_reported() -> None:
    solution = solve(circle_and_hyperbola, np.array([[2.3, 1.3], [2.0, 1.0]]), tolerance=1e-13, max_iterations=2)
    assert [Status(s) for s in solution.status] == [Status.MAX_ITERATIONS, Status.CONVERGED]
    assert solution.residual[0] > 1e-13


def test_a_singular_member_leaves_the_others_their_exact_step() -> None:
    """A member with exactly zero pivots must not turn its neighbour's solve into a truncated one."""

    def pair(x: Array, index: Index) -> tuple[Array, Array]:
        scales = np.array([[1.0, 1e-14], [0.0, 0.0]])[index]
        f = np.where(index[:, None] == 0, scales * (x - [3.0, 4.0]), 1.0)
        return f, scales[:, :, None] * np.eye(2)

    solution = solve(pair, np.zeros((2, 2)), tolerance=1e-20)
    assert solution.status[0] == Status.CONVERGED
    assert solution.status[1] != Status.CONVERGED
    np.testing.assert_allclose(solution.values, [[3.0, 4.0], [0.0, 0.0]], rtol=1e-15)


def test_a_constant_jacobian_may_be_a_read_only_broadcast() -> None:
    matrix = np.array([[2.0, 1.0], [1.0, 3.0]])

    def linear(x: Array, index: Index) -> tuple[Array, Array]:
        return x @ matrix.T - 1.0, np.broadcast_to(matrix, (len(x), 2, 2))

    solution = solve(linear, np.zeros((3, 2)), tolerance=1e-14)
    assert solution.converged.all()
    np.testing.assert_allclose(solution.values, [[0.4, 0.2]] * 3, rtol=1e-14)


@pytest.mark.parametrize("most", [None, 7])
def test_shorter_steps_together_are_those_one_by_one(most: int | None) -> None:
    """Members that need none, several or too many halvings: the same to the bit, in fewer evaluations."""
    rng = np.random.default_rng(5)
    matrix, other, constant = rng.normal(size=(40, 2, 2)), rng.normal(size=(40, 2, 2)), rng.normal(size=(40, 2))
    evaluations = {1: 0, 64: 0}

    def solved(at_once: int) -> list[NDArray[np.generic]]:
        def wavy(x: Array, index: Index) -> tuple[Array, Array]:
            evaluations[at_once] += 1
            line = (matrix[index] * x[:, None]).sum(axis=-1)
            f = line**3 + (other[index] * np.sin(3.0 * x)[:, None]).sum(axis=-1) - constant[index]
            return f, 3.0 * line[..., None] ** 2 * matrix[index] + other[index] * (3.0 * np.cos(3.0 * x))[:, None]

        start = 3.0 * np.random.default_rng(6).normal(size=(40, 2))
        solution = solve(wavy, start, tolerance=1e-10, max_evaluations=most, at_once=at_once)
        return [solution.values, solution.status, solution.residual]

    one_by_one, together = solved(1), solved(64)
    for a, b in zip(one_by_one, together, strict=True):
        np.testing.assert_array_equal(a, b)
    assert {int(Status.CONVERGED), int(Status.STALLED)} <= set(one_by_one[1].tolist()) or most is not None
    assert evaluations[64] < 0.8 * evaluations[1] or most is not None
