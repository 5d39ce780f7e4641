"""Two-parameter envelopes, and gears ground by worms against the racks that generate both [LF04 17.7]."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from oracles.motions import as_chain

from gearmesh import DesignError, NoSolutionError, Rigid
from gearmesh.kernel.numeric.algebra import Array, dot, rotation_about
from gearmesh.kernel.surface.nearest import nearest
from gearmesh.kinds import (
    Arc,
    Chain,
    Envelope,
    FeedEnvelope,
    FeedMotion,
    Jet,
    Parabola,
    Profile,
    RackLine,
    RackRoll,
    RackSurface,
    Step,
    Surface,
)
from gearmesh.tools.worm import Worm

pytestmark = pytest.mark.quick

ALPHA, MODULE, TEETH = np.radians(20.0), 4.0, 21
U, S = np.meshgrid(np.linspace(1.5, 7.5, 5), np.linspace(-20.0, 20.0, 7), indexing="ij")


def rack(helix: float, side: int = 1, profile: Profile | None = None) -> RackSurface:
    return RackSurface(profile or RackLine(ALPHA, MODULE, 0.25 * np.pi * MODULE), helix, 0.0, side)


def worm(helix: float, hand: int = 1, threads: int = 1, radius: float = 60.0) -> Worm:
    return Worm(radius, threads, TEETH, MODULE, helix, hand)


def off(surface: Surface, points: Array, u: Array, v: Array) -> tuple[Array, Jet]:
    """Signed distance (...,) of points (..., 3) from a surface sampled at u, v (K,), along its normal there."""
    samples = surface.jet(u, v).r
    flat = points.reshape(-1, 3)
    start = np.linalg.norm(flat[:, None] - samples, axis=-1).argmin(axis=1)
    jet = nearest(surface, flat, u[start], v[start]).jet
    return dot(flat - jet.r, jet.n).reshape(points.shape[:-1]), jet


def generated(surface: RackSurface) -> tuple[Envelope, Array, Array]:
    """The gear that the rack itself generates, and a fine grid of its parameters."""
    radius = 0.5 * TEETH * MODULE / np.cos(surface.helix)
    u, v = np.meshgrid(np.linspace(0.5, 9.0, 40), np.linspace(-60.0, 60.0, 200), indexing="ij")
    return Envelope(surface, RackRoll(radius)), u.ravel(), v.ravel()


# ---- several parameters of a motion


def test_twists_of_several_parameters() -> None:
    """Against difference quotients: transform by every parameter, twist by every parameter again."""
    base = Rigid(rotation_about("x", 0.4) @ rotation_about("y", 0.7), np.array([3.0, -2.0, 1.0]))
    feed = Step(offset=(40, 0, 0), velocity=(0, 0, 1), plunge=((-0.01, 0.003, 0), (0, 0, 2e-4)), parameter=1, base=base)
    chain = Chain(
        (
            Step(rate=0.14),
            Step(rate=0.03, higher=(0.002,), parameter=1),
            feed,
            Step(rate=1.0, base=base),
            Step(parameter=2, rate=0.5),
        )
    )
    at, r, h = np.random.default_rng(1).normal(size=(3, 6)), np.array([5.0, -7.0, 11.0]), 1e-5
    state = chain.at_several(*at)
    for a in range(3):
        step = np.zeros((3, 1))
        step[a] = h
        ahead, behind = chain.at_several(*(at + step)), chain.at_several(*(at - step))
        omega, tau = state.twists[a]
        moved = (ahead.tool_to_blank.point(r) - behind.tool_to_blank.point(r)) / (2.0 * h)
        np.testing.assert_allclose(moved, state.tool_to_blank.vector(np.cross(omega, r) + tau), rtol=0, atol=2e-8)
        for b in range(3):
            for part in range(2):
                change = (ahead.twists[b][part] - behind.twists[b][part]) / (2.0 * h)
                np.testing.assert_allclose(change, state.derivatives[b][a][part] + 0.0 * change, rtol=0, atol=2e-8)


def test_feed_motion_is_its_chain() -> None:
    """Written out and through the general product: transform, twists and their derivatives, with every term there is."""
    base = Rigid(rotation_about("x", 0.4) @ rotation_about("y", 0.7), np.zeros(3))
    path = ((40.0, 2.0, -1.0), (0.1, -0.2, 1.0), (-0.01, 0.003, 0.002), (1e-4, -2e-4, 3e-4))
    motion = FeedMotion(turn=0.7, tool_turn=-13.0, feed_turn=(0.03, 0.002, -1e-3), path=path, base=base, angle0=0.2)
    psi, s = np.random.default_rng(3).normal(size=(2, 6))
    mine, other = motion.at_several(psi, s), as_chain(motion).at_several(psi, s)
    np.testing.assert_allclose(mine.tool_to_blank.rotation, other.tool_to_blank.rotation, rtol=0, atol=1e-14)
    np.testing.assert_allclose(mine.tool_to_blank.translation, other.tool_to_blank.translation, rtol=0, atol=1e-13)
    for a in range(2):
        for part in range(2):
            np.testing.assert_allclose(mine.twists[a][part], other.twists[a][part], rtol=0, atol=1e-11)
            for b in range(2):
                mine_ab, other_ab = mine.derivatives[a][b][part], other.derivatives[a][b][part]
                np.testing.assert_allclose(mine_ab + 0.0 * other_ab, other_ab, rtol=0, atol=1e-9)


# ---- envelopes


@dataclass(frozen=True)
class Ball:
    """Sphere about the origin, parameters longitude and latitude, rad."""

    radius: float

    def jet(self, u: Array, v: Array) -> Jet:
        cu, su, cv, sv = np.cos(u), np.sin(u), np.cos(v), np.sin(v)
        n = np.stack((cu * cv, su * cv, sv), axis=-1)
        n_u, n_v = np.stack((-su * cv, cu * cv, 0.0 * u), axis=-1), np.stack((-cu * sv, -su * sv, cv), axis=-1)
        return Jet(self.radius * n, n, self.radius * n_u, self.radius * n_v, n_u, n_v)


def test_ball_on_a_paraboloid_leaves_its_offset() -> None:
    a, b, radius = 0.02, 0.05, 3.0
    roll = Step(velocity=(1.0, 0.0, 0.0), plunge=((0.0, 0.0, -a),))
    feed = Step(velocity=(0.0, 1.0, 0.0), plunge=((0.0, 0.0, -b),), parameter=1)
    envelope = FeedEnvelope(Ball(radius), Chain((roll, feed)), lambda u, s: (0.0 * u + 1.2, 0.0 * u))
    longitude, s = np.meshgrid(np.linspace(0.7, 2.3, 5), np.linspace(1.0, 3.0, 4), indexing="ij")
    jet, psi = envelope.jet(longitude, s), envelope.generation(longitude, s).psi
    centre = np.stack((psi, s, -a * psi**2 - b * s**2), axis=-1)
    normal = np.stack((2.0 * a * psi, 2.0 * b * s, np.ones_like(s)), axis=-1)
    normal /= np.linalg.norm(normal, axis=-1)[..., None]
    np.testing.assert_allclose(jet.n, normal, rtol=0, atol=1e-12)
    np.testing.assert_allclose(jet.r, centre + radius * normal, rtol=0, atol=1e-11)


@pytest.mark.parametrize("amounts", [(1e-4, 0.0), (0.0, 2e-6), (2e-4, -1e-6)])
@pytest.mark.parametrize("profile", [None, Arc((5.0, 30.0), 25.0)], ids=["straight", "arc"])
def test_partials_of_a_ground_tooth_are_the_derivatives(amounts: tuple[float, float], profile: Profile | None) -> None:
    surface = worm(0.35).tooth(rack(0.35, profile=profile), *amounts)
    u = U if profile is None else 0.2 + 0.05 * U
    # u is a length on a straight profile and an angle on an arc
    jet, steps = surface.jet(u, S), (1e-3 if profile is None else 1e-5, 1e-3)
    for k, (r_x, n_x) in enumerate(((jet.r_u, jet.n_u), (jet.r_v, jet.n_v))):
        h = steps[k]
        du, ds = (h, 0.0) if k == 0 else (0.0, h)
        ahead, behind = surface.jet(u + du, S + ds), surface.jet(u - du, S - ds)
        np.testing.assert_allclose((ahead.r - behind.r) / (2.0 * h), r_x, rtol=0, atol=1e-7 * np.abs(r_x).max())
        np.testing.assert_allclose((ahead.n - behind.n) / (2.0 * h), n_x, rtol=0, atol=1e-7 * np.abs(n_x).max())
        assert np.abs(dot(jet.n, r_x)).max() < 1e-11 * np.abs(r_x).max()


def test_no_solution_is_said() -> None:
    # a ball that goes uphill evenly leaves a cylinder's line, which this meridian does not reach
    uphill = Chain((Step(velocity=(1.0, 0.0, 0.1)), Step(velocity=(0.0, 1.0, 0.0), parameter=1)))
    lost = FeedEnvelope(Ball(1.0), uphill, lambda u, s: (0.5 + 0.0 * u, s))
    with pytest.raises(
        NoSolutionError, match="two equations of meshing have no solution near the start at 2 of 2 points"
    ):
        lost.generation(np.array([0.3, 0.4]), np.zeros(2))
    assert np.isnan(lost.jet(np.array([0.3, 0.4]), np.zeros(2)).r).all()


def test_parabola_against_its_equation() -> None:
    """Height over the tangent, unit normal across the tangent, and dn/dp by difference quotients."""
    line, coefficient, vertex = RackLine(ALPHA, MODULE, 5.0), 0.0167, 4.2
    curve, p = Parabola(line, coefficient, vertex), np.linspace(0.0, 9.0, 7)
    points, tangents, normals, turned = curve.section(p)
    straight, _, outwards, _ = line.section(p)
    np.testing.assert_allclose(
        ((points - straight) * outwards).sum(axis=-1), -coefficient * (p - vertex) ** 2, rtol=0, atol=1e-14
    )
    np.testing.assert_allclose((normals * tangents).sum(axis=-1), 0.0, rtol=0, atol=1e-14)
    np.testing.assert_allclose((normals**2).sum(axis=-1), 1.0, rtol=0, atol=1e-14)
    assert ((normals * outwards).sum(axis=-1) > 0.0).all()
    (ahead, _, n_ahead, _), (behind, _, n_behind, _) = curve.section(p + 1e-4), curve.section(p - 1e-4)
    np.testing.assert_allclose((ahead - behind) / 2e-4, tangents, rtol=0, atol=1e-10)
    np.testing.assert_allclose((n_ahead - n_behind) / 2e-4, turned, rtol=0, atol=1e-10)


# ---- worms


@pytest.mark.parametrize("hand", [1, -1])
@pytest.mark.parametrize("threads", [1, 3])
def test_thread_is_a_helicoid(hand: int, threads: int) -> None:
    """Thread of lead threads pi m_n / cos(lambda), right-hand for hand +1: a screw motion takes it into itself."""
    tool = worm(0.35, hand, threads)
    thread = tool.thread(rack(0.35))
    u, v = np.meshgrid(np.linspace(1.5, 7.5, 30), np.linspace(-20.0, 20.0, 400), indexing="ij")
    lead = hand * threads * np.pi * MODULE / np.cos(tool.lead_angle)
    points = thread.jet(U[:, 2], np.zeros(5)).r
    turned = Rigid(rotation_about("z", 0.3), np.array([0.0, 0.0, 0.3 * lead / (2.0 * np.pi)])).point(points)
    assert np.abs(off(thread, turned, u.ravel(), v.ravel())[0]).max() < 1e-11
    assert tool.roll == pytest.approx(TEETH / threads, rel=1e-12)
    assert np.sin(tool.lead_angle) == pytest.approx(threads * MODULE / 120.0, rel=1e-15)
    # axes of worm and gear cross at 90 deg less the difference or the sum of both helices
    assert tool.crossing_angle == pytest.approx(0.5 * np.pi - abs(0.35 - hand * tool.lead_angle), abs=1e-12)


@pytest.mark.parametrize("hand", [1, -1])
@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("helix", [0.35, -0.35, 0.0])
def test_worm_without_crowning_grinds_what_the_rack_generates(helix: float, side: int, hand: int) -> None:
    """[LF04 17.7]: rack, worm and gear touch in one point; two routes to one surface, and the start is the solution."""
    surface = worm(helix, hand).tooth(rack(helix, side))
    jet = surface.jet(U, S)
    apart, same = off(generated(rack(helix, side))[0], jet.r, *generated(rack(helix, side))[1:])
    assert np.abs(apart).max() < 1e-12
    np.testing.assert_allclose(jet.n.reshape(-1, 3), same.n, rtol=0, atol=1e-12)
    found = surface.generation(U, S)
    v, psi = surface.start(U, S)
    np.testing.assert_allclose(found.v, v, rtol=0, atol=1e-9)
    np.testing.assert_allclose(found.psi, psi, rtol=0, atol=1e-12)


def test_plunge_and_modified_roll_crown_the_tooth() -> None:
    """Crowning is a_pl s^2 n_x, or a_mr s^2 times the arm of the normal about the axis, to first order in the amount."""
    tool, cutter = worm(0.35), rack(0.35)
    gear, u, v = generated(cutter)
    # the rack's normal is the same everywhere; x points from the gear to the worm
    normal = cutter.jet(np.array(0.0), np.array(0.0)).n
    off_first_order = []
    for plunge in (1e-4, 1e-5):
        crowned = off(gear, tool.tooth(cutter, plunge).jet(U, S).r, u, v)[0]
        expected = -plunge * S**2 * abs(normal[0])
        np.testing.assert_allclose(crowned, expected, rtol=0, atol=2e2 * plunge * np.abs(expected).max())
        roll = plunge * abs(normal[0]) / (tool.gear_radius * abs(normal[1]))
        rolled = off(gear, tool.tooth(cutter, 0.0, roll).jet(U, S).r, u, v)[0]
        np.testing.assert_allclose(np.abs(rolled), np.abs(expected), rtol=0, atol=2e2 * plunge * np.abs(expected).max())
        off_first_order.append(np.abs(crowned / np.where(S == 0.0, 1.0, expected) - 1.0)[S != 0.0].max())
    assert off_first_order[0] / off_first_order[1] == pytest.approx(10.0, rel=0.1)


def test_worm_that_has_no_lead_angle_is_refused() -> None:
    with pytest.raises(DesignError, match=r"worm.pitch_radius = 5 mm: must be more than threads m_n / 2, 6 mm"):
        worm(0.35, threads=3, radius=5.0)
