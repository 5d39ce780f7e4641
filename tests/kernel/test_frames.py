"""Rigid transforms, and the twists of motions against differences of the transforms themselves."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from oracles.examples import examples
from oracles.motions import as_chain

from gearmesh import Rigid
from gearmesh.kernel.numeric.algebra import Array, cross, dot, every_nth, rotation_about, turn, unit
from gearmesh.kinds import Chain, CradleRoll, RackRoll, Step

many = examples(50)
#: step of central differences, and how far away chains of four steps may go in between
STEP, REACH = 1e-3, 1000.0
angles = st.floats(-3.0, 3.0)
lengths = st.floats(-50.0, 50.0)
triples = st.tuples(angles, angles, angles)
vectors = st.tuples(lengths, lengths, lengths)


def pose(turns: tuple[float, float, float], shift: tuple[float, float, float]) -> Rigid:
    a, b, c = turns
    return Rigid(rotation_about("z", a) @ rotation_about("x", b) @ rotation_about("y", c), np.array(shift))


poses = st.builds(pose, triples, vectors)
bends = st.lists(st.floats(-0.3, 0.3), max_size=2).map(tuple)
steps = st.builds(
    Step,
    rate=angles,
    angle0=angles,
    offset=vectors,
    velocity=vectors,
    base=st.one_of(st.none(), poses),
    higher=bends,
)
tilts = st.one_of(st.just(()), st.tuples(angles, st.floats(-0.3, 0.3), st.floats(-0.3, 0.3)))
paths = st.lists(vectors, max_size=2).map(tuple)
rolls = st.builds(
    CradleRoll,
    centre=vectors,
    base=poses,
    turn=st.tuples(angles, angles, st.floats(-0.3, 0.3), st.floats(-0.3, 0.3)),
    sense=st.sampled_from([1.0, -1.0]),
    tilt=tilts,
    swivel=tilts,
    slide=paths,
    feed=paths,
)
chains = st.lists(steps, min_size=1, max_size=4).map(lambda s: Chain(tuple(s)))
turning = st.builds(Step, rate=angles, angle0=angles, offset=vectors, base=st.one_of(st.none(), poses))


def derivative(function: Callable[[Array], Array], at: Array, h: float = STEP) -> Array:
    """Fourth-order central difference of values (..., k) at `at` (...,)."""
    outer = function(at - 2.0 * h) - function(at + 2.0 * h)
    inner = function(at + h) - function(at - h)
    return (outer + 8.0 * inner) / (12.0 * h)


def check_derivative(own: Array, function: Callable[[Array], Array], at: Array, size: float) -> None:
    """Against the difference: with twice the step its error, h^4 / 30 of the fifth derivative, is 16 times as large, so that both
    differ by 15 times what is left; what is subtracted, up to `size`, loses some 40 roundings."""
    found = derivative(function, at)
    left = np.abs(derivative(function, at, 2.0 * STEP) - found).max()
    np.testing.assert_allclose(own, found, rtol=0, atol=left + 40.0 * np.finfo(float).eps * size / STEP)


def full(vector: Array, phi: Array) -> Array:
    """A twist's vector for every phi: what is the same for all may come as one."""
    return np.broadcast_to(vector, (*np.shape(phi), 3))


def check_twist(motion: Chain | RackRoll | CradleRoll, phi: Array) -> None:
    state = motion.at(phi)
    size = REACH + max(np.abs(x).max() for x in (state.tau, state.tau_phi, state.tool_to_blank.translation))
    for r in np.array([[0.0, 0.0, 0.0], [30.0, 0.0, 0.0], [0.0, -30.0, 0.0], [0.0, 10.0, 30.0]]):
        # in the tool's frame at phi, where the twist is
        to_tool = np.swapaxes(state.tool_to_blank.rotation, -1, -2)
        check_derivative(
            np.broadcast_to(cross(state.omega, r) + state.tau, (*np.shape(phi), 3)),
            lambda p, r=r, to_tool=to_tool: turn(to_tool, motion.at(p).tool_to_blank.point(r)),  # type: ignore[misc]
            phi,
            size,
        )
    for name in ("omega", "tau"):
        own = full(getattr(state, f"{name}_phi"), phi)
        check_derivative(own, lambda p, name=name: full(getattr(motion.at(p), name), p), phi, size)  # type: ignore[misc]


def test_twist_of_a_turn_that_grows_with_the_cube_of_phi() -> None:
    """Points 30 away move by 202 for each rad of phi. The difference quotient used for comparison is itself off by 1.4e-8."""
    check_twist(Chain((Step(rate=0.0, higher=(0.0, 0.25)),)), np.asarray(3.0))


@pytest.mark.quick
@many
@given(motion=chains, phi=angles)
def test_twist_of_any_chain(motion: Chain, phi: float) -> None:
    check_twist(motion, np.asarray(phi))


@pytest.mark.quick
@many
@given(motion=rolls, phi=st.lists(st.floats(-1.5, 1.5), min_size=1, max_size=5))
def test_cradle_roll_is_its_chain_and_has_its_twist(motion: CradleRoll, phi: list[float]) -> None:
    check_twist(motion, np.array(phi))
    for own, chain in ((motion, as_chain(motion)), (motion.unmodified_motion, as_chain(motion.unmodified_motion))):
        one, two = own.at(np.array(phi)), chain.at(np.array(phi))
        pairs = [(one.tool_to_blank.rotation, two.tool_to_blank.rotation)]
        pairs += [(one.tool_to_blank.translation, two.tool_to_blank.translation)]
        pairs += [(getattr(one, name), getattr(two, name)) for name in ("omega", "tau", "omega_phi", "tau_phi")]
        for a, b in pairs:
            np.testing.assert_allclose(a, b, rtol=1e-11, atol=1e-11)


@pytest.mark.quick
@many
@given(turns=st.tuples(turning, turning), shift=vectors, phi=st.lists(angles, min_size=1, max_size=5))
def test_two_turns_are_the_product_of_their_steps(
    turns: tuple[Step, Step], shift: tuple[float, float, float], phi: list[float]
) -> None:
    motion = Chain((*turns, Step(offset=shift)))
    own, product = motion.at(np.array(phi)), motion.at_several(np.array(phi))
    ((omega, tau),), (((omega_phi, tau_phi),),) = product.twists, product.derivatives
    # some roundings of numbers up to 3 x 87 mm and rates up to 6
    for one, two in (
        (own.tool_to_blank.rotation, product.tool_to_blank.rotation),
        (own.tool_to_blank.translation, product.tool_to_blank.translation),
        *((own.omega, omega), (own.tau, tau), (own.omega_phi, omega_phi), (own.tau_phi, tau_phi)),
    ):
        np.testing.assert_allclose(one, two, rtol=0, atol=1e-11)


@pytest.mark.quick
def test_twist_of_rack_roll() -> None:
    check_twist(RackRoll(41.0), np.linspace(-1.5, 1.5, 12).reshape(3, 4))


@pytest.mark.quick
@many
@given(radius=st.floats(1.0, 200.0), phi=st.lists(angles, min_size=1, max_size=5))
def test_rack_roll_is_its_chain(radius: float, phi: list[float]) -> None:
    own, chain = (motion.at(np.array(phi)) for motion in (RackRoll(radius), as_chain(RackRoll(radius))))
    # a few roundings of numbers up to radius * (1 + |phi|)
    close = 1e-14 * radius
    np.testing.assert_allclose(own.tool_to_blank.rotation, chain.tool_to_blank.rotation, rtol=0, atol=1e-14)
    np.testing.assert_allclose(own.tool_to_blank.translation, chain.tool_to_blank.translation, rtol=0, atol=close)
    for name, atol in (("omega", 1e-14), ("tau", close), ("omega_phi", 1e-14), ("tau_phi", close)):
        np.testing.assert_allclose(full(getattr(own, name), np.array(phi)), getattr(chain, name), rtol=0, atol=atol)


@pytest.mark.quick
@many
@given(motion=chains, phi=st.lists(angles, min_size=6, max_size=6))
def test_a_batch_of_states_is_the_states_one_by_one(motion: Chain, phi: list[float]) -> None:
    together = motion.at(np.array(phi).reshape(2, 3))
    assert together.tau_phi.shape == (2, 3, 3)
    for i, p in enumerate(phi):
        alone, at = motion.at(np.asarray(p)), divmod(i, 3)
        assert alone.tau.shape == (3,)
        for name in ("omega", "tau", "omega_phi", "tau_phi"):
            np.testing.assert_allclose(getattr(together, name)[at], getattr(alone, name), rtol=1e-12, atol=1e-10)
        np.testing.assert_allclose(
            together.tool_to_blank.translation[at], alone.tool_to_blank.translation, rtol=1e-12, atol=1e-10
        )


@pytest.mark.quick
def test_rolling_rack_touches_the_pitch_cylinder_without_sliding() -> None:
    roll, phi = 12.5, np.linspace(-1.0, 1.0, 5)
    state = RackRoll(roll).at(phi)
    pole = np.stack((np.zeros(5), roll * phi, np.zeros(5)), axis=-1)
    np.testing.assert_allclose(cross(state.omega, pole) + state.tau, 0.0, atol=1e-14)
    landed = state.tool_to_blank.point(pole)
    np.testing.assert_allclose(landed, roll * np.stack((np.cos(phi), np.sin(phi), 0 * phi), -1), atol=1e-14)


def close(found: Array, expected: Array) -> None:
    """Equal but for a handful of roundings of lengths up to a few hundred."""
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-12)


@pytest.mark.quick
@many
@given(a=poses, b=poses, c=poses, r=vectors)
def test_rigid_algebra(a: Rigid, b: Rigid, c: Rigid, r: tuple[float, float, float]) -> None:
    point, fixed = np.array(r), np.array([1.0, -2.0, 0.5])
    close((a @ b).point(point), a.point(b.point(point)))
    close((a @ b).vector(point), a.vector(b.vector(point)))
    left, right = (a @ b) @ c, a @ (b @ c)
    close(left.rotation, right.rotation)
    close(left.translation, right.translation)
    close(a.inverse.point(a.point(point)), point)
    close((a.inverse @ a).translation, np.zeros(3))
    np.testing.assert_allclose(np.linalg.det(a.rotation), 1.0, atol=1e-14)
    np.testing.assert_allclose(Rigid.identity().point(point), point, rtol=0)
    turned, other = a.vector(point), a.vector(fixed)
    close(cross(turned, other), a.vector(cross(point, fixed)))
    close(dot(turned, other), dot(point, fixed))


@pytest.mark.quick
@pytest.mark.parametrize(("axis", "start", "end"), [("x", "y", "z"), ("y", "z", "x"), ("z", "x", "y")])
def test_rotations_are_right_handed(axis: str, start: str, end: str) -> None:
    e = dict(zip("xyz", np.eye(3), strict=True))
    quarter = rotation_about(axis, np.pi / 2)
    np.testing.assert_allclose(turn(quarter, e[start]), e[end], atol=1e-16)
    np.testing.assert_allclose(turn(quarter, e[axis]), e[axis], atol=0)


@pytest.mark.quick
def test_transforms_broadcast_over_points_and_over_themselves() -> None:
    many = Rigid(rotation_about("z", np.array([[0.1], [0.2]])), np.arange(6.0).reshape(2, 1, 3))
    points = np.arange(12.0).reshape(4, 3)
    both = many.point(points)
    assert both.shape == (2, 4, 3)
    for i in range(2):
        one = Rigid(many.rotation[i, 0], many.translation[i, 0])
        np.testing.assert_allclose(both[i], one.point(points), atol=1e-14)
        np.testing.assert_allclose((many @ one).point(points)[i], one.point(one.point(points)), atol=1e-13)
        np.testing.assert_allclose((one @ many).inverse.point(one.point(both[i]))[i], points, atol=1e-13)
    np.testing.assert_allclose(unit(points[1:])[0], np.array([3.0, 4.0, 5.0]) / np.sqrt(50.0), rtol=1e-15)


@pytest.mark.quick
def test_every_nth_index_is_as_far_from_the_next_as_the_others() -> None:
    for length in range(60):
        for count in (2, 9, 11, 25):
            chosen = every_nth(np.arange(length), count)
            assert len(set(np.diff(chosen))) <= 1
            assert length == 0 or min(length, 0.5 * count) <= len(chosen) <= 1.5 * count
            if length:
                before, behind = chosen[0], length - 1 - chosen[-1]
                assert before <= behind <= before + 1
