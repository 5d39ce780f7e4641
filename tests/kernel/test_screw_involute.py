"""Screw involutes and twisted surfaces: jets by two routes, the rack's envelope, the base circle, the true curvature."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np
import pytest

from gearmesh.kernel.envelope.limiting_line import area_density
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.curvature import principal, shape_operator, tangent_basis
from gearmesh.kernel.surface.twisted import Twisted
from gearmesh.kinds import Envelope, Jet, RackLine, RackRoll, RackSurface, Surface
from gearmesh.teeth.micro_geometry.screw_involute import AmountJet, ScrewInvolute

pytestmark = pytest.mark.quick

#: roll lengths and face positions, mm, on both branches
L, Z = (each.ravel() for each in np.meshgrid([-4.0, 1.5, 6.0, 14.0], [-9.0, 0.0, 7.0]))
#: cases (side, internal)
SIDES = [(side, internal) for side in (1, -1) for internal in (False, True)]


@dataclass(frozen=True)
class Wave:
    """An amount that has all its second partials, larger than any micro-geometry."""

    def jet(self, length: Array, z: Array) -> AmountJet:
        c, s, e = np.cos(0.3 * length), np.sin(0.3 * length), 0.05 * np.exp(0.1 * z)
        return AmountJet(e * c, -0.3 * e * s, 0.1 * e * c, -0.09 * e * c, -0.03 * e * s, 0.01 * e * c)


def differences(surface: Surface, u: Array, v: Array) -> Jet:
    """Partials of points and normals by differences of sixth order, good to 1e-9."""
    h = 0.02
    weights = ((-3, -1.0), (-2, 9.0), (-1, -45.0), (1, 45.0), (2, -9.0), (3, 1.0))

    def partial(name: str, du: float, dv: float) -> Array:
        terms = [w * getattr(surface.jet(u + k * h * du, v + k * h * dv), name) for k, w in weights]
        return np.asarray(sum(terms) / (60.0 * h))

    here = surface.jet(u, v)
    return Jet(here.r, here.n, partial("r", 1, 0), partial("r", 0, 1), partial("n", 1, 0), partial("n", 0, 1))


def assert_jet(surface: Surface, u: Array, v: Array) -> None:
    jet, other = surface.jet(u, v), differences(surface, u, v)
    for each in fields(Jet):
        np.testing.assert_allclose(getattr(jet, each.name), getattr(other, each.name), atol=2e-9, err_msg=each.name)
    np.testing.assert_allclose(dot(jet.n, jet.n), 1.0, atol=1e-14)
    np.testing.assert_allclose(dot(jet.n, jet.r_u), 0.0, atol=1e-14)
    np.testing.assert_allclose(dot(jet.n, jet.r_v), 0.0, atol=1e-13)


@pytest.mark.parametrize(("side", "internal"), SIDES)
@pytest.mark.parametrize("amount", [None, Wave()])
def test_jet_is_that_of_its_points(side: int, internal: bool, amount: Wave | None) -> None:
    assert_jet(ScrewInvolute(40.0, 0.012, 0.1, side, internal, amount), L, Z)


@pytest.mark.parametrize(("side", "internal"), SIDES)
def test_amount_is_measured_along_the_line_of_action(side: int, internal: bool) -> None:
    """The involute that an amount leads to is so far from the true one, along every base tangent, and inside the material."""
    true = ScrewInvolute(40.0, 0.012, 0.1, side, internal)
    jet, moved = true.jet(L, Z), replace(true, amount=Wave()).jet(L, Z)
    a = Wave().jet(L, Z).a
    # unwound from where the true one of its tangent begins
    shifted = replace(true, start=0.1 + side * a[0] / 40.0).jet(L[:1], Z[:1])
    np.testing.assert_allclose(moved.r[:1], shifted.r, atol=1e-13)
    np.testing.assert_allclose(np.hypot(*moved.r[:, :2].T), np.hypot(*jet.r[:, :2].T), atol=1e-13)
    small = replace(true, amount=_Scaled(1e-6)).jet(L, Z)
    cos_base = 1.0 / np.hypot(1.0, 40.0 * 0.012)
    np.testing.assert_allclose(dot(small.r - jet.r, jet.n), -1e-6 * a * cos_base, atol=1e-12)


@dataclass(frozen=True)
class _Scaled:
    """The wave times a number."""

    factor: float

    def jet(self, length: Array, z: Array) -> AmountJet:
        wave = Wave().jet(length, z)
        return AmountJet(*(self.factor * getattr(wave, each.name) for each in fields(AmountJet)))


@pytest.mark.parametrize("helix", [0.0, 0.3, -0.5])
@pytest.mark.parametrize("side", [1, -1])
def test_is_what_a_rack_generates(helix: float, side: int) -> None:
    """Points, normals and their changes, at the base circle and below it, against the envelope of the rack."""
    alpha, radius, module = np.radians(20.0), 30.0, 3.0
    rolled = Envelope(RackSurface(RackLine(alpha, module, 2.2, 0.4), helix, 0.0, side), RackRoll(radius))
    p, u = (each.ravel() for each in np.meshgrid(np.linspace(-6.0, 9.0, 7), [-8.0, 0.0, 5.0]))
    there = rolled.jet(p, u)
    length = ScrewInvolute.roll_length(there)
    own = ScrewInvolute.through(there[np.array([0])], side)
    assert own.rate == pytest.approx(np.tan(helix) / radius, abs=1e-15)
    assert own.base_radius == pytest.approx(radius * np.cos(np.arctan(np.tan(alpha) / np.cos(helix))), rel=1e-14)
    here = own.jet(length, there.r[:, 2])
    np.testing.assert_allclose(here.r, there.r, atol=1e-12)
    np.testing.assert_allclose(here.n, there.n, atol=1e-13)
    regular = np.abs(length) > 0.1
    curvatures = [principal(shape_operator(jet, *tangent_basis(jet))) for jet in (here[regular], there[regular])]
    np.testing.assert_allclose(curvatures[0].k1, curvatures[1].k1, atol=1e-9)
    np.testing.assert_allclose(curvatures[0].k2, curvatures[1].k2, atol=1e-9)


def test_is_singular_on_the_base_circle_alone() -> None:
    length = np.array([-1e-3, 0.0, 1e-3])
    for side, internal in SIDES:
        density = area_density(ScrewInvolute(40.0, 0.012, 0.1, side, internal).jet(length, 0.0 * length))
        assert density[1] == 0.0
        assert density[0] * density[2] < 0.0


def test_twisted_jet_is_that_of_its_points() -> None:
    own = ScrewInvolute(40.0, 0.012, 0.1)
    assert_jet(
        Twisted(own, 0.003, lambda z: (0.02 * np.sin(0.2 * z), 4e-3 * np.cos(0.2 * z), -8e-4 * np.sin(0.2 * z))), L, Z
    )
