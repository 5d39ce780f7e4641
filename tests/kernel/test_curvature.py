"""Curvature: surfaces whose curvature is known, two routes to generated surfaces, and the contact ellipse."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.typing import ArrayLike
from oracles.curvature import ellipse_from_principal, from_principal, generated_operator, mean_curvature, meshing_terms
from oracles.examples import examples

from gearmesh import Rigid
from gearmesh.kernel.numeric.algebra import Array, cross, dot, rotation_about
from gearmesh.kernel.surface import curvature
from gearmesh.kinds import Chain, Envelope, Jet, MotionState, RackRoll, Step

pytestmark = pytest.mark.quick

many = examples(100)

angles = st.floats(-3.0, 3.0)
lengths = st.floats(-50.0, 50.0)
sizes = st.floats(0.5, 80.0)
triples = st.tuples(angles, angles, angles)
shifts = st.tuples(lengths, lengths, lengths)


@dataclass(frozen=True)
class Torus:
    """Tube of radius `tube` round a circle of radius `ring` about z; ring 0 is a sphere. Outward normal."""

    ring: float
    tube: float

    def jet(self, u: ArrayLike, v: ArrayLike) -> Jet:
        u, v = np.broadcast_arrays(np.asarray(u, dtype=float), np.asarray(v, dtype=float))
        cu, su, cv, sv, zero = np.cos(u), np.sin(u), np.cos(v), np.sin(v), np.zeros_like(u)
        around, up = np.stack((-su, cu, zero), -1), np.stack((-sv * cu, -sv * su, cv), -1)
        n = np.stack((cv * cu, cv * su, sv), -1)
        rho = (self.ring + self.tube * cv)[..., None]
        centre = self.ring * np.stack((cu, su, zero), -1)
        return Jet(centre + self.tube * n, n, rho * around, self.tube * up, cv[..., None] * around, up)


@dataclass(frozen=True)
class Cylinder:
    """Cylinder about z, u the angle and v = z. Outward normal."""

    radius: float

    def jet(self, u: ArrayLike, v: ArrayLike) -> Jet:
        u, v = np.broadcast_arrays(np.asarray(u, dtype=float), np.asarray(v, dtype=float))
        c, s, zero, one = np.cos(u), np.sin(u), np.zeros_like(u), np.ones_like(u)
        n, t = np.stack((c, s, zero), -1), np.stack((-s, c, zero), -1)
        axis = np.stack((zero, zero, one), -1)
        return Jet(self.radius * n + v[..., None] * axis, n, self.radius * t, axis, t, np.zeros_like(n))


@dataclass(frozen=True)
class Rack:
    """Rack flank with a straight (radius None) or circular-arc profile, inclined by the helix angle."""

    pressure: float
    helix: float
    radius: float | None = None

    def jet(self, u: ArrayLike, v: ArrayLike) -> Jet:
        u, v = np.broadcast_arrays(np.asarray(u, dtype=float), np.asarray(v, dtype=float))
        zero = np.zeros_like(u)
        tilt = self.pressure + (zero if self.radius is None else u / self.radius)
        c, s = np.cos(tilt), np.sin(tilt)
        tangent, normal = np.stack((c, s, zero), -1), np.stack((s, -c, zero), -1)
        if self.radius is None:
            point, turned = u[..., None] * tangent, np.zeros_like(tangent)
        else:
            base = np.array([np.sin(self.pressure), -np.cos(self.pressure), 0.0])
            point, turned = self.radius * (normal - base), tangent / self.radius
        trace = np.broadcast_to(np.array([0.0, 0.0, 1.0]), point.shape)
        lean = Rigid(rotation_about("x", -self.helix), np.zeros(3))
        return Jet(point + v[..., None] * trace, normal, tangent, trace, turned, np.zeros_like(point)).move(lean)


def reparametrised(jet: Jet, heading: float, skew: float, scale_u: float, scale_v: float) -> Jet:
    """The same surface in parameters with r_p, r_q of any length, at `heading` to r_u and at `skew` to each other.

    The jet's own r_u and r_v must be orthogonal; negative skew makes r_p x r_q point against n.
    """
    long_u, long_v = (np.sqrt(dot(a, a)) for a in (jet.r_u, jet.r_v))
    r_p, n_p = jet.along(scale_u * np.cos(heading) / long_u, scale_u * np.sin(heading) / long_v)
    r_q, n_q = jet.along(scale_v * np.cos(heading + skew) / long_u, scale_v * np.sin(heading + skew) / long_v)
    return Jet(jet.r, jet.n, r_p, r_q, n_p, n_q)


def anywhere(turns: tuple[float, float, float], shift: tuple[float, float, float]) -> Rigid:
    a, b, c = turns
    return Rigid(rotation_about("z", a) @ rotation_about("x", b) @ rotation_about("y", c), np.array(shift))


scales = st.floats(-3.0, 3.0).map(lambda e: 10.0**e)
skews = st.tuples(st.floats(0.05, np.pi - 0.05), st.sampled_from((1.0, -1.0))).map(lambda t: t[0] * t[1])


# ---- shape operator and principal curvatures


@many
@given(
    ring=st.one_of(st.just(0.0), sizes), tube=sizes, u=angles, v=st.floats(-1.2, 1.2), heading=angles, skew=skews,
    scale_u=scales, scale_v=scales, turns=triples, shift=shifts,
)  # fmt: skip
def test_torus_and_sphere_in_any_parametrisation_and_position(
    ring: float, tube: float, u: float, v: float, heading: float, skew: float, scale_u: float, scale_v: float,
    turns: tuple[float, float, float], shift: tuple[float, float, float],
) -> None:  # fmt: skip
    own = Torus(ring, tube).jet(u, v)
    place = anywhere(turns, shift)
    jet = reparametrised(own, heading, skew, scale_u, scale_v).move(place)
    basis = curvature.tangent_basis(jet)
    k = curvature.shape_operator(jet, *basis)
    along, around = -1.0 / tube, -np.cos(v) / (ring + tube * np.cos(v))
    found = curvature.principal(k)
    assert k[0, 1] == k[1, 0]
    # rounding eps / sin(0.05) of the parametrisation leaves two decades to 1e-12
    assert found.k1 == pytest.approx(around, rel=1e-12)
    assert found.k2 == pytest.approx(along, rel=1e-12)
    assert curvature.gaussian_curvature(k) == pytest.approx(along * around, rel=1e-12)
    assert mean_curvature(k) == pytest.approx(0.5 * (along + around), rel=1e-12)
    if ring > 1e-2 * tube:
        circle = place.vector(own.r_u) / np.sqrt(dot(own.r_u, own.r_u))
        # a direction is as sharp as the curvatures are apart
        blur = 1e-13 * abs(along) / (around - along)
        assert abs(dot(curvature.in_plane(found.angle, *basis)[0], circle)) == pytest.approx(1.0, abs=blur**2 + 1e-14)


@many
@given(radius=sizes, u=angles, heading=angles, skew=skews, scale_u=scales, scale_v=scales, turns=triples, shift=shifts)
def test_cylinder_in_any_parametrisation_and_position(
    radius: float, u: float, heading: float, skew: float, scale_u: float, scale_v: float,
    turns: tuple[float, float, float], shift: tuple[float, float, float],
) -> None:  # fmt: skip
    place = anywhere(turns, shift)
    jet = reparametrised(Cylinder(radius).jet(u, 7.0), heading, skew, scale_u, scale_v).move(place)
    basis = curvature.tangent_basis(jet)
    found = curvature.principal(curvature.shape_operator(jet, *basis))
    assert found.k1 == pytest.approx(0.0, abs=1e-12 / radius)
    assert found.k2 == pytest.approx(-1.0 / radius, rel=1e-12)
    generator = curvature.in_plane(found.angle, *basis)[0]
    assert abs(dot(generator, place.rotation[:, 2])) == pytest.approx(1.0, abs=1e-13)


def test_accuracy_falls_no_faster_than_the_parameter_lines_close_up() -> None:
    own = Torus(20.0, 4.0).jet(0.3, 0.5)
    exact = -np.cos(0.5) / (20.0 + 4.0 * np.cos(0.5)), -0.25
    for skew in 10.0 ** -np.arange(0.0, 9.0):
        jet = reparametrised(own, 0.7, skew, 1e3, 1e-3)
        found = curvature.principal(curvature.shape_operator(jet, *curvature.tangent_basis(jet)))
        np.testing.assert_allclose((found.k1, found.k2), exact, rtol=0, atol=2e-16 / skew + 1e-15)


def test_principal_is_stable_at_and_near_umbilics() -> None:
    at = curvature.principal(-0.125 * np.eye(2))
    assert (at.k1, at.k2, at.angle) == (-0.125, -0.125, 0.0)
    for gap in 2.0 ** -np.arange(10.0, 50.0, 5.0):
        # 1 + gap and the off-diagonal gap are exact in binary, so the eigenvalues apart by 2 sqrt(2) gap are too
        k = np.array([[1.0 + gap, gap], [gap, 1.0 - gap]])
        near = curvature.principal(k)
        assert near.k1 - near.k2 == pytest.approx(2.0 * np.sqrt(2.0) * gap, abs=5e-16)
        assert near.angle == pytest.approx(np.pi / 8, rel=1e-15)
    # a direction has one angle, whatever the sign of a zero off the diagonal
    for zero in (0.0, -0.0):
        assert curvature.principal(np.array([[-0.2, zero], [zero, 0.1]])).angle == np.pi / 2
    k1, k2, angle = np.full(3, 0.3), np.full(3, -0.2), np.array([-1.2, 0.1, 1.5])
    again = curvature.principal(from_principal(k1, k2, angle))
    np.testing.assert_allclose(again.angle, angle, rtol=1e-14)
    np.testing.assert_allclose(np.stack((again.k1, again.k2)), [k1, k2], rtol=1e-14)


def test_degenerate_parametrisation_is_not_finite_and_spoils_no_neighbour() -> None:
    jet = Cylinder(5.0).jet(np.array([0.1, 0.2]), np.array([0.0, 1.0]))
    edge = Jet(jet.r, jet.n, jet.r_u, jet.r_v * np.array([[0.0], [1.0]]), jet.n_u, jet.n_v)
    k = curvature.shape_operator(edge, *curvature.tangent_basis(edge))
    assert not np.isfinite(k[0]).all()
    np.testing.assert_allclose(k[1], [[-0.2, 0.0], [0.0, 0.0]], atol=1e-16)


# ---- surfaces generated by a tool


def envelope_jet_in_tool_frame(tool: Jet, state: MotionState) -> Jet:
    """Jet of the generated surface [theory of envelopes: phi_u = -f_u / f_phi], brought back to the tool frame."""
    w = cross(state.omega, tool.r) + state.tau
    f_phi = dot(tool.n, cross(state.omega_phi, tool.r) + state.tau_phi)
    spin = cross(state.omega, tool.n)
    phi_u = -(dot(tool.n_u, w) + dot(tool.n, cross(state.omega, tool.r_u))) / f_phi
    phi_v = -(dot(tool.n_v, w) + dot(tool.n, cross(state.omega, tool.r_v))) / f_phi
    phi_u, phi_v = phi_u[..., None], phi_v[..., None]
    return Jet(
        tool.r, tool.n, tool.r_u + w * phi_u, tool.r_v + w * phi_v, tool.n_u + spin * phi_u, tool.n_v + spin * phi_v
    )


@many
@given(
    place=triples, at=shifts, rates=st.tuples(angles, angles, angles), turns=triples, shift=shifts, slide=shifts,
    ring=sizes, tube=sizes, u=angles, v=angles, phi=st.floats(-1.0, 1.0),
)  # fmt: skip
def test_generated_curvature_by_both_routes_in_any_motion(
    place: tuple[float, float, float], at: tuple[float, float, float], rates: tuple[float, float, float],
    turns: tuple[float, float, float], shift: tuple[float, float, float], slide: tuple[float, float, float],
    ring: float, tube: float, u: float, v: float, phi: float,
) -> None:  # fmt: skip
    """CR3553 1.6.40-42 against the jet of the envelope, for a torus in a motion with every kind of term."""
    tool = Torus(ring, tube).jet(u, v)
    steps = (
        Step(rate=rates[0], velocity=slide, offset=shift, base=anywhere(place, at)),
        Step(rate=rates[1], angle0=0.4, velocity=(0.3, -0.2, 0.5), base=anywhere(turns, shift)),
    )

    def motion(speed: float) -> MotionState:
        # the last step slides along the tool's normal, so that one speed puts this point on the contact line
        along = tool.n * speed
        return Chain((*steps, Step(offset=tuple(-along * phi), velocity=tuple(along)))).at(np.asarray(phi))

    still = motion(0.0)
    state = motion(-float(dot(tool.n, cross(still.omega, tool.r) + still.tau)))
    v12, omega12, b3 = meshing_terms(tool, state)
    assert dot(tool.n, v12) == pytest.approx(0.0, abs=1e-10)
    basis = curvature.tangent_basis(tool)
    # near undercut or a standing contact line both routes lose digits in proportion; keep those out
    k_tool = curvature.shape_operator(tool, *basis)
    turn = np.sqrt(dot(omega12, omega12)) + np.abs(k_tool).max() * np.sqrt(dot(v12, v12))
    regular = 1e-3 * turn * max(np.sqrt(dot(v12, v12)), 1e-3)
    a = cross(tool.n, omega12) + np.sum(-(k_tool @ [dot(v12, basis[0]), dot(v12, basis[1])])[:, None] * basis, axis=0)
    assume(abs(b3) > regular)
    assume(abs(b3 + dot(v12, a)) > regular)
    first = curvature.shape_operator(envelope_jet_in_tool_frame(tool, state), *basis)
    second = generated_operator(tool, state, *basis)
    size = max(np.abs(first).max(), np.abs(k_tool).max())
    np.testing.assert_allclose(second, first, rtol=0, atol=1e-10 * size)
    # the same statement once more: K_generated = K_tool + a (x) a / (b3 + v . a)
    components = np.array([dot(a, basis[0]), dot(a, basis[1])])
    third = k_tool + np.outer(components, components) / (b3 + dot(v12, a))
    np.testing.assert_allclose(third, first, rtol=0, atol=1e-10 * size)


@many
@given(
    pressure=st.floats(0.1, 0.6), helix=st.floats(-0.7, 0.7), radius=st.one_of(st.none(), st.floats(15.0, 80.0)),
    roll=st.floats(20.0, 100.0), u=st.floats(-3.0, 3.0), v=st.floats(-20.0, 20.0),
)  # fmt: skip
def test_rack_generated_curvature_by_both_routes(
    pressure: float, helix: float, radius: float | None, roll: float, u: float, v: float
) -> None:
    tool, motion = Rack(pressure, helix, radius), RackRoll(roll)
    surface = Envelope(tool, motion)
    own = tool.jet(u, v)
    state = motion.at(surface.parameter(np.asarray(u), np.asarray(v)))
    basis = curvature.tangent_basis(own)
    second = generated_operator(own, state, *basis)
    first = curvature.shape_operator(
        surface.jet(np.asarray(u), np.asarray(v)).move(state.tool_to_blank.inverse), *basis
    )
    np.testing.assert_allclose(second, first, rtol=0, atol=1e-10 * np.abs(first).max())
    if radius is None:
        # a plane generates a developable surface, the involute helicoid
        found = curvature.principal(second)
        flat, bent = sorted((abs(found.k1), abs(found.k2)))
        assert flat <= 1e-12 * bent


def test_radius_of_curvature_of_a_spur_involute_is_its_generating_line() -> None:
    pressure, roll = np.radians(20.0), 40.0
    surface = Envelope(Rack(pressure, 0.0), RackRoll(roll))
    u, v = np.linspace(-3.0, 3.0, 7), np.linspace(-5.0, 5.0, 7)
    jet = surface.jet(u, v)
    base = roll * np.cos(pressure)
    length = np.sqrt(jet.r[:, 0] ** 2 + jet.r[:, 1] ** 2 - base**2)
    found = curvature.principal(curvature.shape_operator(jet, *curvature.tangent_basis(jet)))
    np.testing.assert_allclose(found.k2, -1.0 / length, rtol=1e-12)
    np.testing.assert_allclose(found.k1, 0.0, atol=1e-15)


def test_meshing_terms_of_two_rotations_are_the_sources() -> None:
    """Two bodies that turn at constant rates about fixed axes, everything literally as in [CR3553 1.6]."""
    rate1, rate2, phi = 1.0, 0.37, 0.6
    fixed_to_blank = anywhere((0.3, 1.1, -0.4), (12.0, -7.0, 30.0))
    # the blank's own rotation is undone, then the tool's applied: tool -> fixed -> blank
    motion = Chain((Step(rate=-rate2), Step(rate=rate1, base=fixed_to_blank)))
    tool = reparametrised(Torus(30.0, 6.0).jet(0.4, 0.9), 0.5, 1.2, 3.0, 0.2)
    state = motion.at(np.asarray(phi))
    v12, omega12, b3 = meshing_terms(tool, state)

    tool_to_fixed = Rigid.about_z(rate1 * phi)
    fixed = tool.move(tool_to_fixed)
    blank_to_fixed = fixed_to_blank.inverse
    omega1, omega2 = np.array([0.0, 0.0, rate1]), rate2 * blank_to_fixed.rotation[:, 2]
    v1, v2 = cross(omega1, fixed.r), cross(omega2, fixed.r - blank_to_fixed.translation)
    np.testing.assert_allclose(tool_to_fixed.vector(v12), v1 - v2, rtol=1e-13)
    np.testing.assert_allclose(tool_to_fixed.vector(omega12), omega1 - omega2, atol=1e-15)
    assert b3 == pytest.approx(dot(fixed.n, cross(omega2, v1)) - dot(fixed.n, cross(omega1, v2)), rel=1e-13)


# ---- contact


def test_contact_ellipse_of_sample_problem_1_7_1() -> None:
    """[CR3553 p. 60, sample problem 1.7.1], in mm; the printed curvatures are in 1/in with kI1 misprinted tenfold."""
    a, b, alpha = ellipse_from_principal(0.01047, -0.00744, -0.03845, -0.00711, np.radians(12.47), delta=0.02)
    # recomputed from the source's equations: agreement to half a unit of the last digit given
    assert np.degrees(alpha) == pytest.approx(-7.96, abs=0.005)
    assert b == pytest.approx(0.909, abs=0.0005)
    assert a == pytest.approx(13.9, abs=0.05)
    # printed, converted to mm: rounding of the curvatures (5e-6) moves alpha by 0.01 deg and b by 0.0005; A is a
    # difference of 1e-4 between curvatures of 1e-2, so a moves by 2 %
    assert np.degrees(alpha) == pytest.approx(-7.95, abs=0.015)
    assert b == pytest.approx(0.035826771 * 25.4, abs=0.001)
    assert a == pytest.approx(0.539370078 * 25.4, rel=0.02)


curvatures = st.floats(-0.2, 0.2)


@many
@given(k_i1=curvatures, k_ii1=curvatures, k_i2=curvatures, k_ii2=curvatures, sigma=angles, heading=angles)
def test_both_routes_to_the_ellipse_agree_and_its_axes_end_at_delta(
    k_i1: float, k_ii1: float, k_i2: float, k_ii2: float, sigma: float, heading: float
) -> None:
    delta = 0.00635
    first = from_principal(*map(np.asarray, (k_i1, k_ii1, heading)))
    relative = first - from_principal(*map(np.asarray, (k_i2, k_ii2, heading + sigma)))
    e1, e2 = np.eye(3)[:2]
    found = curvature.contact_ellipse(relative, e1, e2, delta)
    a, b, alpha = ellipse_from_principal(k_i1, k_ii1, k_i2, k_ii2, sigma, delta)
    size = max(map(abs, (k_i1, k_ii1, k_i2, k_ii2)))
    # axes long against the radii are differences of nearly equal curvatures, and lose digits by any route
    assume(2.0 * delta / a**2 > 1e-4 * size > 0.0)
    assert found.semi_major == pytest.approx(a, rel=1e-10)
    assert found.semi_minor == pytest.approx(b, rel=1e-10)
    assert found.semi_major >= found.semi_minor
    assert not found.line
    for half, direction in ((found.semi_major, found.major), (found.semi_minor, found.minor)):
        x = half * direction[:2]
        assert abs(x @ relative @ x) / 2.0 == pytest.approx(delta, rel=1e-10)
    np.testing.assert_allclose(found.major[:2], (np.cos(found.angle), np.sin(found.angle)), atol=1e-15)
    np.testing.assert_allclose(cross(found.major, found.minor), [0.0, 0.0, 1.0], atol=1e-15)
    assert found.crossing == (np.linalg.eigvalsh(relative).max() > 0.0)
    if abs(1.0 / b**2 - 1.0 / a**2) > 1e-3 / b**2:
        minor = heading - alpha  # alpha counts from the minor axis to the direction of k_i1
        assert abs(dot(found.minor, np.array([np.cos(minor), np.sin(minor), 0.0]))) == pytest.approx(1.0, abs=1e-12)


def touching(first: Jet, second: Jet, turn: float = 0.0) -> Jet:
    """`second` moved so that it touches `first` from outside, its r_u turned by `turn` from the first's."""
    e1, e2 = curvature.tangent_basis(first)
    f1, f2 = curvature.tangent_basis(second)
    own = np.stack((f1, f2, second.n), axis=-1)
    d1, d2 = curvature.in_plane(np.asarray(turn), e1, e2)
    rotation = np.stack((d1, -d2, -first.n), axis=-1) @ own.T
    return second.move(Rigid(rotation, first.r - rotation @ second.r))


def flipped(jet: Jet) -> Jet:
    """The same surface with the material on the other side."""
    return Jet(jet.r, -jet.n, jet.r_u, jet.r_v, -jet.n_u, -jet.n_v)


def test_balls_and_cups_and_cylinders() -> None:
    ball, delta = Torus(0.0, 10.0).jet(0.3, 0.2), 0.01
    basis = curvature.tangent_basis(ball)

    def ellipse(other: Jet, turn: float = 0.0, first: Jet = ball) -> curvature.ContactEllipse:
        e1, e2 = curvature.tangent_basis(first)
        return curvature.contact_ellipse(
            curvature.relative_curvature(first, touching(first, other, turn), e1, e2), e1, e2, delta
        )

    # two balls: 1/10 + 1/40 = 1/8; a ball in a larger cup: 1/10 - 1/40; in a smaller one: 1/10 - 1/5 < 0
    outside = ellipse(Torus(0.0, 40.0).jet(0.0, 0.4))
    assert outside.semi_major == pytest.approx(np.sqrt(2.0 * delta * 8.0), rel=1e-12)
    assert outside.semi_minor == pytest.approx(np.sqrt(2.0 * delta * 8.0), rel=1e-12)
    inside = ellipse(flipped(Torus(0.0, 40.0).jet(0.0, 0.4)))
    assert inside.semi_minor == pytest.approx(np.sqrt(2.0 * delta / (0.1 - 0.025)), rel=1e-12)
    jammed = ellipse(flipped(Torus(0.0, 5.0).jet(0.0, 0.4)))
    assert [bool(e.crossing) for e in (outside, inside, jammed)] == [False, False, True]
    # a ball pressed through the inside of a ring: it fits along the ring's circle but not across
    hole = ellipse(flipped(Torus(30.0, 4.0).jet(0.0, 0.0)))
    assert hole.crossing
    assert not hole.line

    rod = Cylinder(10.0).jet(0.5, 3.0)
    for heading in np.linspace(0.0, 3.0, 13):
        # parameter lines across the generators at any angle, so that the zero eigenvalue is a rounded one
        turned = reparametrised(rod, heading, 1.1, 2.0, 0.3)
        parallel = ellipse(Cylinder(25.0).jet(0.1, 0.0), turn=-heading, first=turned)
        assert parallel.line
        assert np.isinf(parallel.semi_major)
        assert not parallel.crossing
        assert abs(parallel.major[2]) == pytest.approx(1.0, abs=1e-14)
        assert parallel.semi_minor == pytest.approx(np.sqrt(2.0 * delta / (0.1 + 0.04)), rel=1e-12)
    # equal rods crossed by an angle t: a/b = 1 / tan(t/2), the major axis halving the acute angle of the axes
    for t in (0.2, 0.7, 1.4):
        crossed = ellipse(Cylinder(10.0).jet(0.1, 0.0), turn=t, first=rod)
        assert crossed.semi_major / crossed.semi_minor == pytest.approx(1.0 / np.tan(t / 2.0), rel=1e-11)
        assert abs(crossed.major[2]) == pytest.approx(np.cos(t / 2.0), rel=1e-12)
    same = ellipse(flipped(Torus(0.0, 10.0).jet(0.0, 0.4)))
    assert np.isfinite(same.angle)
    assert abs(dot(same.major, basis[0])) <= 1.0 + 1e-15


def test_true_separation_at_the_ends_of_the_axes_tends_to_delta() -> None:
    """A ball on the outside of a ring, measured: the separation at the ellipse's ends is delta (1 + O(delta))."""
    ring, tube, radius = 20.0, 4.0, 15.0
    jet = Torus(ring, tube).jet(0.0, 0.0)
    other = touching(jet, Torus(0.0, radius).jet(0.7, 0.3), 0.4)
    basis = curvature.tangent_basis(jet)
    deltas = np.array([0.04, 0.02, 0.01])
    relative = curvature.relative_curvature(jet, other, *basis)
    found = curvature.contact_ellipse(np.broadcast_to(relative, (3, 2, 2)), *basis, deltas)
    # at the outer equator r_u runs round the ring, which is flatter than the tube: the major axis lies along it
    np.testing.assert_allclose(found.angle, 0.0, atol=1e-12)

    def sagitta(r: float, x: Array) -> Array:
        return r - np.sqrt(r**2 - x**2)

    for outline, half in ((ring + tube, found.semi_major), (tube, found.semi_minor)):
        error = np.abs(sagitta(outline, half) + sagitta(radius, half) - deltas) / deltas
        order = np.log2(error[:-1] / error[1:])
        np.testing.assert_allclose(order, 1.0, atol=0.05)
