"""Envelopes: exact jets, two ways to solve the equation of meshing, nesting, undercut, curvature by two routes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
from oracles.built import pair_of
from oracles.curvature import generated_operator, undercut_indicator
from oracles.motions import as_chain
from oracles.places import SAMPLES

from gearmesh import GearPair, NoSolutionError, Rigid, load
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.curvature import in_plane, principal, shape_operator, tangent_basis
from gearmesh.kinds import Arc, Chain, CradleRoll, Envelope, Jet, RackLine, RackRoll, RackSurface, Region, Side, Step

RADIUS = 60.0
ALPHA = np.radians(20.0)
U, V = np.meshgrid(np.linspace(3.0, 9.0, 5), np.linspace(-8.0, 8.0, 5))


def rack(helix: float = 0.26, cone: float = 0.35, side: int = 1) -> RackSurface:
    return RackSurface(RackLine(ALPHA, 5.0, 1.25 * np.pi), helix, cone, side)


#: nothing of the contact is left to be searched for
MODIFIED = [
    f"pinion.{side}.{key}={value}"
    for side in ("concave", "convex")
    for key, value in {
        "modified_roll_c2": 0.05,
        "modified_roll_c3": -0.1,
        "mean_offset": 0,
        "mean_shift": 0,
        "path_angle": 90,
    }.items()
]
#: the papers' gears, and what is set in them
GEARS: dict[str, list[str]] = {
    "beveloid_crossed": [],
    "circular_arc": [],
    "spiral_bevel_abdullah_curved": [],
    "spiral_bevel_basic": MODIFIED,
}
SURFACES = [
    pytest.param(
        f"{sample} {member} {region}", marks=pytest.mark.quick if sample in ("beveloid_crossed", "circular_arc") else ()
    )
    for sample in GEARS
    for member in ("pinion", "gear")
    for region in (Region.FLANK_RIGHT, Region.FILLET_LEFT)
]


@cache
def papers(sample: str) -> GearPair:
    return pair_of(load(SAMPLES / f"{sample}.toml", GEARS[sample]))


def generated(name: str) -> tuple[Envelope, Array, Array]:
    """A flank or fillet of the papers' gears with parameters spread over it."""
    sample, member, region = name.split()
    tooth = papers(sample).members[member].tooth
    grid = tooth.grid(Region(region), np.linspace(0.1, 0.9, 5), tooth.sections(np.linspace(0.7, 1.0, 4)))
    assert grid.p is not None
    assert grid.v is not None
    return tooth.chain[Region(region)].surface, grid.p, grid.v  # type: ignore[return-value]


def vectors(jet: Jet) -> Array:
    return np.stack((jet.r, jet.n, jet.r_u, jet.r_v, jet.n_u, jet.n_v))


@pytest.mark.parametrize("name", SURFACES)
@pytest.mark.sweep_cases("spiral_bevel_basic pinion flank_right", "spiral_bevel_basic pinion fillet_left")
def test_partials_are_the_derivatives(name: str) -> None:
    surface, u, v = generated(name)
    jet = surface.jet(u, v)
    errors = []
    for h in (1e-2, 5e-3):
        # parameters are mm along lines and rad on arcs, where a hundredth of the step does
        steps = np.array([h * (0.01 if np.ptp(u) < 2.0 else 1.0), h])
        for step, (du, dv), r_, n_ in ((steps[0], (1, 0), jet.r_u, jet.n_u), (steps[1], (0, 1), jet.r_v, jet.n_v)):
            ahead, behind = surface.jet(u + step * du, v + step * dv), surface.jet(u - step * du, v - step * dv)
            miss = (
                np.abs((ahead.r - behind.r) / (2 * step) - r_).max()
                + np.abs((ahead.n - behind.n) / (2 * step) - n_).max()
            )
            errors.append(miss / (1.0 + np.abs(r_).max()))
    first, second = max(errors[:2]), max(errors[2:])
    # central differences converge with order 2 to exact partials, down to rounding
    assert second < 1e-4
    assert second < 0.3 * first or second < 1e-9
    assert np.abs(dot(jet.n, jet.r_u)).max() < 1e-10 * np.abs(jet.r_u).max()
    assert np.abs(dot(jet.n, jet.n_u)).max() < 1e-10 * (1.0 + np.abs(jet.n_u).max())


@pytest.mark.parametrize("name", SURFACES)
def test_curvature_by_two_routes(name: str) -> None:
    """Shape operator of the jet against [CR3553 1.6.40-42] from the tool's curvatures: 1e-10 relative."""
    surface, u, v = generated(name)
    state = surface.generation(u, v)
    e1, e2 = tangent_basis(state.tool)
    from_tool = principal(generated_operator(state.tool, state.state, e1, e2))
    to_blank = state.state.tool_to_blank
    own = principal(shape_operator(surface.jet(u, v), to_blank.vector(e1), to_blank.vector(e2)))
    scale = np.maximum(np.abs(own.k1), np.abs(own.k2))
    assert (np.abs(own.k1 - from_tool.k1) <= 1e-10 * scale).all()
    assert (np.abs(own.k2 - from_tool.k2) <= 1e-10 * scale).all()
    direction = [in_plane(k.angle, e1, e2)[0] for k in (own, from_tool)]
    np.testing.assert_allclose(np.abs(dot(*direction)), 1.0, rtol=0, atol=1e-9)


@pytest.mark.quick
def test_closed_form_and_newton_agree() -> None:
    motion = RackRoll(RADIUS)
    closed = Envelope(rack(), motion)
    by_newton = Envelope(rack(), as_chain(motion))
    np.testing.assert_allclose(by_newton.parameter(U, V), closed.parameter(U, V), rtol=0, atol=1e-12)
    np.testing.assert_allclose(vectors(by_newton.jet(U, V)), vectors(closed.jet(U, V)), rtol=0, atol=1e-10)


def bevel_flank(*overrides: str) -> tuple[Envelope, Array, Array]:
    tooth = pair_of(load(SAMPLES / "spiral_bevel_basic.toml", overrides)).pinion.tooth
    grid = tooth.flank_grid(Side.LEFT, np.linspace(0.0, 1.0, 5), np.linspace(0.0, 1.0, 6))
    assert isinstance(tooth.left.flank, Envelope)
    assert grid.p is not None
    assert grid.v is not None
    return tooth.left.flank, grid.p, grid.v


@pytest.mark.sweep
@pytest.mark.parametrize("roll", [(), ("pinion.convex.modified_roll_c2=0.05", "pinion.convex.modified_roll_c3=-0.1")])
def test_cradle_generation_in_closed_form_and_by_newton_agree(roll: tuple[str, ...]) -> None:
    flank, p, v = bevel_flank(*roll)
    motion = flank.motion
    assert isinstance(motion, CradleRoll)
    phi = flank.parameter(p, v)
    assert (np.sign(flank.generation(p, v).f_phi) == flank.branch).all()
    general = replace(as_chain(motion), harmonic=False)
    by_newton = Envelope(flank.tool, general, phi_range=(float(phi.min()) - 0.1, float(phi.max()) + 0.1))
    np.testing.assert_allclose(by_newton.parameter(p, v), phi, rtol=0, atol=1e-12)
    np.testing.assert_allclose(vectors(by_newton.jet(p, v)), vectors(flank.jet(p, v)), rtol=0, atol=1e-9)
    # the other root of the harmonic equation is another point of the motion
    other = replace(flank, branch=-flank.branch).parameter(p, v)
    assert (np.abs(other - phi) > 0.1).all()


@pytest.mark.sweep
def test_modified_roll_changes_the_flank_by_what_the_blank_turns_more() -> None:
    # nothing of the contact is chosen anew for the pair with modified roll
    fixed = [
        f"pinion.convex.{key}={value}" for key, value in (("path_angle", 90), ("mean_offset", 0), ("mean_shift", 0))
    ]
    fixed += ["pinion.convex.ratio_derivative=0.008", "pinion.convex.semi_major_axis=6"]
    plain, p, v = bevel_flank(*fixed)
    c2 = 1e-6
    changed = bevel_flank(*fixed, f"pinion.convex.modified_roll_c2={c2}")[0]
    before, g = plain.jet(p, v), plain.generation(p, v)
    # to first order the flank moves along its normal as the blank turns more: -c2 phi^2 / ratio about its axis
    assert isinstance(plain.motion, CradleRoll)
    more = -c2 * g.phi**2 * plain.motion.turn[1]
    moved = dot(before.n, np.cross([0.0, 0.0, 1.0], before.r)) * more
    after = changed.jet(p, v)
    np.testing.assert_allclose(dot(before.n, after.r - before.r), moved, rtol=0, atol=1e-3 * np.abs(moved).max())


@pytest.mark.quick
def test_points_that_the_cradle_never_brings_into_mesh_are_not_numbers() -> None:
    flank, _, _ = bevel_flank()
    assert isinstance(flank.motion, CradleRoll)
    # a blank that hardly turns is cut by few points of the cutter, here all round it and far up and down the blade's cone
    flank = replace(flank, motion=replace(flank.motion, turn=(0.0, -0.9)))
    p, v = (a.ravel() for a in np.meshgrid(np.linspace(-300.0, 300.0, 21), np.linspace(-3.0, 3.0, 31)))
    phi = flank.parameter(p, v)
    tool = flank.tool.jet(p, v)
    # n . w over a whole turn of the cradle: does it change its sign?
    state = flank.motion.at(np.linspace(-np.pi, np.pi, 721)[:, None])
    f = dot(tool.n, np.cross(state.omega, tool.r) + state.tau)
    meets = (f.min(axis=0) < 0.0) & (f.max(axis=0) > 0.0)
    assert 100 < meets.sum() < 551
    np.testing.assert_array_equal(np.isfinite(phi), meets)


@pytest.mark.quick
def test_no_root_is_said() -> None:
    unreachable = Envelope(rack(), as_chain(RackRoll(RADIUS)), phi_range=(1.2, 1.4))
    with pytest.raises(NoSolutionError, match="no root"):
        unreachable.jet(U, V)


@dataclass(frozen=True)
class Reversed:
    """A body's surface seen as a tool: the same points, the normal out of what it cuts."""

    surface: Envelope

    def jet(self, u: Array, v: Array) -> Jet:
        jet = self.surface.jet(u, v)
        return Jet(jet.r, -jet.n, jet.r_u, jet.r_v, -jet.n_u, -jet.n_v)


@pytest.mark.quick
def test_envelopes_nest() -> None:
    """A rack generates an involute pinion; the pinion, as a tool, generates the gear that the rack generates as well."""
    r1, r2 = 60.0, 90.0
    straight = rack(helix=0.0, cone=0.0)
    pinion = Envelope(straight, RackRoll(r1))
    # pinion turned by -phi in the fixed frame, seen from a gear at distance r1 + r2 turned by +phi r1 / r2
    centre = Rigid(np.eye(3), np.array([-(r1 + r2), 0.0, 0.0]))
    mesh = Chain((Step(rate=-r1 / r2), Step(rate=-1.0, base=centre)))
    # the normal of an involute crosses the pitch circle twice, 2 alpha = 0.7 rad apart: look on this side only
    gear = Envelope(Reversed(pinion), mesh, phi_range=(-0.3, 0.3))
    u, v = np.linspace(4.0, 7.0, 7), np.zeros(7)
    jet = gear.jet(u, v)
    # the gear's flank is an involute of base circle r2 cos(alpha): its normals touch that circle
    normal_distance = np.abs(jet.r[:, 0] * jet.n[:, 1] - jet.r[:, 1] * jet.n[:, 0])
    np.testing.assert_allclose(normal_distance, r2 * np.cos(ALPHA), rtol=0, atol=1e-9)
    # and the same points, turned, as the rack generates: pinion and gear touch where both touch the rack
    phi = pinion.parameter(u, v)
    np.testing.assert_allclose(gear.parameter(u, v), phi, rtol=0, atol=1e-9)
    direct = Envelope(RackSurface(RackLine(ALPHA, 5.0, 1.25 * np.pi), 0.0, 0.0), RackRoll(r2)).jet(
        10.0 / np.cos(ALPHA) - u, v
    )
    np.testing.assert_allclose(
        np.hypot(jet.r[:, 0], jet.r[:, 1]), np.hypot(direct.r[:, 0], direct.r[:, 1]), rtol=0, atol=1e-9
    )
    operators = [shape_operator(j, *tangent_basis(j)) for j in (jet, direct)]
    np.testing.assert_allclose(principal(operators[0]).k2, principal(operators[1]).k2, rtol=1e-9)


@pytest.mark.quick
def test_undercut_begins_on_the_base_circle() -> None:
    flank = Envelope(rack(helix=0.0, cone=0.0), RackRoll(RADIUS))
    # the generated involute is singular where the line of action touches the base circle: r sin^2(alpha) below the pitch line
    singular = (5.0 - RADIUS * np.sin(ALPHA) ** 2) / np.cos(ALPHA)
    indicator = undercut_indicator(flank, singular + np.array([-0.1, 0.0, 0.1]), np.zeros(3))
    assert indicator[0] < 0.0 < indicator[2]
    assert abs(indicator[1]) < 1e-12
    assert np.hypot(*flank.jet(np.array(singular), np.array(0.0)).r[:2]) == pytest.approx(
        RADIUS * np.cos(ALPHA), abs=1e-9
    )


@pytest.mark.quick
def test_a_sharp_edge_is_the_limit_of_a_rounding() -> None:
    angles, v = np.linspace(0.5, 1.4, 6), np.zeros(6)
    sharp = Envelope(RackSurface(Arc((-6.0, -7.0), 0.0), 0.2, 0.1), RackRoll(RADIUS)).jet(angles, v)
    misses = []
    for radius in (1e-2, 1e-3):
        rounded = Envelope(RackSurface(Arc((-6.0, -7.0), -radius), 0.2, 0.1), RackRoll(RADIUS)).jet(angles, v)
        misses.append(np.abs(rounded.r - sharp.r).max() / radius)
        assert misses[-1] < 1.5
    assert misses[0] == pytest.approx(misses[1], rel=0.05)
