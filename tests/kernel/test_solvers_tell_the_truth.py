"""CONVERGED implies that the equations hold, computed anew by other code: for every solver, on thousands of random members.

Batches mix easy members with hopeless ones: what a member answers may not depend on its neighbours.
"""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from numpy.typing import NDArray
from oracles.built import pair_of
from oracles.motions import as_chain
from oracles.places import SAMPLES

from gearmesh import GearmeshError, Rigid, load, parse
from gearmesh.contact.flanks import solver_pair
from gearmesh.contact.pair import Pair
from gearmesh.contact.tca import contact_path
from gearmesh.errors import Solution, Status
from gearmesh.kernel.envelope.limiting_line import zeros
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, cross, dot, polar_angle, rotation_about
from gearmesh.kernel.numeric.roots import bracketed_root, last_true
from gearmesh.kernel.surface.nearest import nearest
from gearmesh.kernel.surface.stations import follow
from gearmesh.kinds import (
    Arc,
    Chain,
    ConeLevel,
    CradleRoll,
    Envelope,
    FeedEnvelope,
    Jet,
    Parabola,
    RackLine,
    RackRoll,
    RackSurface,
    Surface,
    TipEdge,
    Tooth,
    along,
)
from gearmesh.mesh.hexahedra.grading import Spacing
from gearmesh.systems.common.racks.rack_tooth import Heights, round_tips
from gearmesh.systems.spiral_bevel.synthesis.settings import basic_blank, gear_sides
from gearmesh.teeth.limits import land_of_width
from gearmesh.tools.worm import Worm

Index = NDArray[np.intp]


def told(solution: Solution, least: float) -> NDArray[np.bool_]:
    """Members that are said to hold; at least a share `least` of them, or the test says nothing, and all that hold finite."""
    held = solution.converged
    assert held.mean() >= least, held.mean()
    assert np.isfinite(solution.residual[held]).all()
    assert np.isin(solution.status, [int(s) for s in Status]).all()
    return held


# ---- one unknown


class Mixed:
    """Functions of one unknown: line, arc tangent, triple root, exponential, wave on a line; pole, jump, gap, no root."""

    KINDS = 9

    def __init__(self, rng: np.random.Generator, count: int) -> None:
        self.kind, self.root = rng.integers(0, self.KINDS, count), rng.uniform(-1.0, 1.0, count)
        self.scale, self.sign = 10.0 ** rng.uniform(-1.0, 2.0, count), rng.choice([-1.0, 1.0], count)
        self.low, self.high = self.root - rng.uniform(0.0, 3.0, count), self.root + rng.uniform(0.0, 3.0, count)
        self.low, self.high = np.where(self.sign > 0, (self.low, self.high), (self.high, self.low))

    @property
    def has_root(self) -> NDArray[np.bool_]:
        return self.kind < 5

    def __call__(self, x: Array, index: Index) -> Array:
        d, k, root = x - self.root[index], self.scale[index], self.root[index]
        with np.errstate(all="ignore"):
            f = (
                k * d,
                np.arctan(k * d),
                k * d**3,
                np.expm1(0.2 * k * d),
                k * np.sin(d) + d,
                k / d,
                np.where(d > 0.0, k, -1.0) + d,
                np.where(np.abs(d) < 1e-3, np.nan, d),
                k + d**2 * (2.0 + np.cos(root)),
            )
        return self.sign[index] * np.choose(self.kind[index], f)


@pytest.mark.quick
def test_bracketed_root() -> None:
    rng, tolerance, wrong = np.random.default_rng(1), 1e-14, 0
    for _ in range(40):
        function = Mixed(rng, 600)
        found = bracketed_root(function, function.low, function.high, tolerance=tolerance)
        held = told(found, 0.4)
        np.testing.assert_array_equal(held, function.has_root)
        # the root is known: the value may be what the function has a few roundings beside it
        beside = 4.0 * (tolerance + 4.0 * np.finfo(float).eps * (np.abs(found.values) + 1.0))
        largest = np.abs(function(function.root + beside, np.arange(600)))
        wrong += int((np.abs(function(found.values, np.arange(600))) > largest)[held].sum())
        flat = function.kind == 2
        wrong += int((np.abs(found.values - function.root) > np.where(flat, 1e-5, beside))[held].sum())
    assert wrong == 0


@pytest.mark.quick
def test_bracketed_root_answers_for_each_member_alone() -> None:
    function = Mixed(np.random.default_rng(2), 300)
    all_of_them = bracketed_root(function, function.low, function.high)
    some = np.random.default_rng(3).permutation(300)[:40]
    for chosen in (some, some[:1], some[1:2]):
        alone = bracketed_root(lambda x, k, c=chosen: function(x, c[k]), function.low[chosen], function.high[chosen])
        np.testing.assert_array_equal(alone.values, all_of_them.values[chosen])
        np.testing.assert_array_equal(alone.status, all_of_them.status[chosen])


@pytest.mark.quick
def test_last_true() -> None:
    rng = np.random.default_rng(4)
    edge, low, high = rng.uniform(-5.0, 5.0, 4000), rng.uniform(-9.0, -5.0, 4000), rng.uniform(5.0, 9.0, 4000)
    flip = rng.random(4000) < 0.5
    low, high = np.where(flip, high, low), np.where(flip, low, high)
    last, first = last_true(lambda x, k: (x <= edge[k]) != flip[k], low, high)
    assert ((last <= edge) != flip).all()
    assert ((first > edge) != flip).all()
    np.testing.assert_allclose(last, first, rtol=1e-15, atol=3e-17)


@pytest.mark.quick
def test_zeros_of_a_line() -> None:
    """Lines with known roots, poles and gaps: every root between samples is found, and nothing else."""
    rng, lines = np.random.default_rng(5), 1500
    places = np.sort(rng.uniform(0.0, 1.0, (3, lines)), axis=0)
    places += np.arange(3)[:, None] * 0.2
    low, high = np.full(lines, -0.1), np.full(lines, 1.6)
    pole, gap = rng.random(lines) < 0.3, rng.random(lines) < 0.3

    def function(x: Array, k: Index) -> Array:
        first, second, third = (x - p for p in places[:, k])
        with np.errstate(all="ignore"):
            f = first * np.where(pole[k], 1.0 / second, second) * np.exp(x)
        return np.where(gap[k] & (third > 0.0), np.nan, f)

    row, at = zeros(function, low, high)
    kinds = np.where(pole[row], np.abs(at - places[0, row]), np.abs(at - places[:2, row]).min(axis=0))
    assert kinds.max() < 1e-12
    # at most one in a sample's interval, and no third
    wanted = np.where(pole, 1, 2)
    np.testing.assert_array_equal(np.bincount(row, minlength=lines), wanted)


# ---- several unknowns


@pytest.mark.parametrize("unknowns", [1, 2, 3, 5])
@pytest.mark.parametrize("rcond", [None, 1e-9])
def test_newton(unknowns: int, rcond: float | None) -> None:
    """Random quadratics with waves; some without solution, some singular, some not defined everywhere."""
    rng, held = np.random.default_rng(unknowns), 0
    for _ in range(10):
        count = 200
        linear = rng.normal(size=(count, unknowns, unknowns))
        linear[rng.random(count) < 0.1, 0] = 0.0
        bent = 0.3 * rng.normal(size=(count, unknowns, unknowns, unknowns))
        constant, wall = rng.normal(size=(count, unknowns)), rng.uniform(0.5, 6.0, count)

        def function(
            x: Array, index: Index, a: Array = linear, b: Array = bent, c: Array = constant, wall: Array = wall
        ) -> tuple[Array, Array]:
            a, b, c = a[index], b[index], c[index]
            quadratic = np.einsum("nijk,nj,nk->ni", b, x, x)
            f = np.einsum("nij,nj->ni", a, x) + quadratic + np.sin(x) + c
            jacobian = a + np.einsum("nijk,nk->nij", b + np.swapaxes(b, 2, 3), x)
            jacobian = jacobian + np.cos(x)[:, :, None] * np.eye(x.shape[1])
            f[np.abs(x).max(axis=-1) > wall[index]] = np.nan
            return f, jacobian

        # few iterations leave members on their way
        most = int(rng.integers(3, 30))
        found = newton.solve(function, np.zeros((count, unknowns)), tolerance=1e-11, rcond=rcond, max_iterations=most)
        good = told(found, 0.0)
        for k in np.flatnonzero(good):
            x = found.values[k]
            f = linear[k] @ x + np.array([x @ m @ x for m in bent[k]]) + np.sin(x) + constant[k]
            assert np.abs(f).max() <= 1.01e-11
            assert np.abs(x).max() <= wall[k]
        held += int(good.sum())
        some = rng.permutation(count)[:7]
        alone = newton.solve(
            lambda x, k, f=function, s=some: f(x, s[k]),
            np.zeros((7, unknowns)),
            tolerance=1e-11,
            rcond=rcond,
            max_iterations=most,
        )
        np.testing.assert_array_equal(alone.status, found.status[some])
        np.testing.assert_allclose(alone.values, found.values[some], rtol=1e-9, atol=1e-9)
    assert held > 500


# ---- equations of meshing


def random_rack(rng: np.random.Generator) -> RackSurface:
    alpha, size = rng.uniform(0.2, 0.5), rng.uniform(0.5, 8.0)
    line = RackLine(alpha, 1.25 * size, 0.8 * size)
    profile = [
        line,
        Parabola(line, rng.normal() * 0.01 / size, size),
        Arc((-size, -size), -rng.uniform(0.1, 0.4) * size),
    ]
    shape = profile[rng.integers(3)]
    return RackSurface(shape, rng.uniform(-0.6, 0.6), rng.uniform(-0.3, 0.3), int(rng.choice([-1, 1])))


def random_points(rng: np.random.Generator, tool: RackSurface, count: int) -> tuple[Array, Array]:
    p = rng.uniform(0.3, 1.4, count) if isinstance(tool.profile, Arc) else rng.uniform(0.0, 10.0, count)
    return p, rng.uniform(-10.0, 10.0, count)


def random_cradle(rng: np.random.Generator, modified: float) -> CradleRoll:
    turned = rotation_about("x", rng.uniform(-0.6, 0.6)) @ rotation_about("y", rng.uniform(0.5, 2.0))
    x, y, z = (float(c) for c in rng.uniform(-60.0, 60.0, 3))
    turn = (
        float(rng.normal()),
        float(-1.0 / rng.uniform(0.1, 0.9)),
        *(float(c) for c in modified * rng.normal(size=2)),
    )
    return CradleRoll((x, y, z), Rigid(turned, rng.uniform(-5.0, 5.0, 3)), turn, float(rng.choice([-1.0, 1.0])))


def meshing(tool: Jet, other: CradleRoll | Chain, phi: Array) -> Array:
    """n . w relative to the velocities that it is made of, by another route to the same motion."""
    state = other.at(phi)
    omega, tau = (np.broadcast_to(x, tool.r.shape) for x in (state.omega, state.tau))
    turning = np.cross(omega, tool.r)
    return (tool.n * (turning + tau)).sum(axis=-1) / (
        1.0 + np.linalg.norm(turning, axis=-1) + np.linalg.norm(tau, axis=-1)
    )


@pytest.mark.quick
@pytest.mark.parametrize("route", ["closed form", "harmonic", "polished", "bracketed"])
def test_equation_of_meshing(route: str) -> None:
    rng, held = np.random.default_rng(6), 0
    for _ in range(40):
        tool = random_rack(rng)
        p, v = random_points(rng, tool, 100)
        motion = RackRoll(rng.uniform(5.0, 90.0)) if route == "closed form" else random_cradle(rng, 0.0)
        if route == "polished":
            motion = random_cradle(rng, 0.1)
        branch = int(rng.choice([-1, 1]))
        if route == "bracketed":
            # f changes its sign from one root of the harmonic to the other: between them there is the root of this branch
            assert isinstance(motion, CradleRoll)
            phi = np.stack([Envelope(tool, motion, branch=b).parameter(p, v) for b in (branch, -branch)])
            there = np.isfinite(phi).all(axis=0)
            p, v, phi = p[there], v[there], phi[:, there]
            if not there.any():
                continue
            ends = float(np.max(phi[0]) + 0.05), float(np.min(phi[0]) - 0.05)
            surface = Envelope(tool, replace(as_chain(motion), harmonic=False), ends)
            try:
                generation = surface.generation(p, v)
            except GearmeshError:
                continue
        else:
            generation = Envelope(tool, motion, branch=branch).generation(p, v)
        with np.errstate(invalid="ignore"):
            found = generation.solution
        good = found.converged
        # a modified roll may lead hundreds of turns away, where rounding alone is more than the tolerance
        assert np.isfinite(found.values[good]).all()
        assert route == "polished" or (good == np.isfinite(found.values)).all()
        finite = np.isfinite(found.values)
        if finite.any():
            other = motion if route == "bracketed" else as_chain(motion)
            off = meshing(tool.jet(p[finite], v[finite]), other, found.values[finite])  # type: ignore[arg-type]
            assert np.abs(off).max() < 1e-12
        held += int(good.sum())
    assert held > 1000


@pytest.mark.sweep
def test_two_equations_of_meshing() -> None:
    """Worms that grind with plunge and modified roll, many of them nonsense, from starts moved at random."""
    rng, held, lost = np.random.default_rng(7), 0, 0
    for _ in range(12):
        module, teeth = rng.uniform(1.0, 6.0), int(rng.integers(8, 60))
        alpha = rng.uniform(0.25, 0.45)
        rack = RackSurface(
            RackLine(alpha, module, 0.25 * np.pi * module), rng.uniform(-0.5, 0.5), 0.0, int(rng.choice([-1, 1]))
        )
        worm = Worm(
            rng.uniform(5.0, 30.0) * module,
            int(rng.integers(1, 4)),
            teeth,
            module,
            rack.helix,
            int(rng.choice([-1, 1])),
        )
        ground = worm.tooth(rack, 10.0 ** rng.uniform(-5.0, -1.0), 10.0 ** rng.uniform(-7.0, -2.0))
        away = 10.0 ** rng.uniform(-3.0, 1.0)

        def start(u: Array, s: Array, ground: FeedEnvelope = ground, away: float = away) -> tuple[Array, Array]:
            v, psi = ground.start(u, s)
            return v + away * np.sin(7.0 * u + s), psi + 0.01 * away * np.cos(u)

        surface = replace(ground, start=start)
        u, s = rng.uniform(-0.5, 2.5, 80) * module, rng.uniform(-8.0, 8.0, 80) * module
        with np.errstate(all="ignore"):
            generation = surface._solve(u, s)
            found = generation.solution
            jet = surface.jet(u, s)
        good = found.converged
        np.testing.assert_array_equal(good, np.isfinite(jet.r).all(axis=-1))
        held, lost = held + int(good.sum()), lost + int((~good).sum())
        if not good.any():
            continue
        v, psi = found.values[good].T
        tool, state = surface.tool.jet(u[good], v), as_chain(ground.motion).at_several(psi, s[good])  # type: ignore[arg-type]
        for omega, tau in state.twists:
            off = dot(tool.n, cross(omega, tool.r) + tau)
            # rounding of two routes to lengths of some meters
            assert (np.abs(off) <= 1e-10 * (1.0 + np.sqrt(dot(tau, tau)))).all()
    assert held > 500
    assert lost > 5


# ---- points of surfaces


def random_gear(rng: np.random.Generator) -> tuple[Surface, RackSurface]:
    rack = random_rack(rng)
    return Envelope(rack, RackRoll(rng.uniform(8.0, 80.0))), rack


@pytest.mark.quick
def test_stations() -> None:
    """On planes and cones; cones that the surface does not reach are among them."""
    rng, held, lost = np.random.default_rng(8), 0, 0
    for _ in range(150):
        surface, rack = random_gear(rng)
        p, v = random_points(rng, rack, 30)
        axial = ConeLevel(rng.uniform(0.0, 1.2)) if rng.random() < 0.7 else ConeLevel(0.0)
        stations = axial.value(surface.jet(p, v).r)
        if rng.random() < 0.3:
            stations = stations + 10.0 ** rng.uniform(-2.0, 3.0) * rng.normal(size=30)
        with np.errstate(all="ignore"):
            found = follow(surface, p, stations, axial)
        good = found.converged
        r = surface.jet(p, found.values).r
        rho, size = np.hypot(r[:, 0], r[:, 1]), 1.0 + np.abs(stations).max()
        off = np.sin(axial.angle) * rho + np.cos(axial.angle) * r[:, 2] - stations
        assert (np.abs(off[good]) <= 1.01e-9 * size).all()
        np.testing.assert_array_equal(found.jet.r[good], r[good])
        held, lost = held + int(good.sum()), lost + int((~good).sum())
    assert held > 2500
    assert lost > 20


@pytest.mark.quick
def test_closest_points() -> None:
    """From near and from far, on flanks and on edges of tools, which have no tangent plane."""
    rng, held, lost = np.random.default_rng(9), 0, 0
    for _ in range(60):
        surface, rack = random_gear(rng)
        p, v = random_points(rng, rack, 40)
        if rng.random() < 0.2:
            surface = replace(rack, profile=Arc((-1.0, -1.0), 0.0))
        far = 10.0 ** rng.uniform(-4.0, 1.5)
        q = surface.jet(p, v).r + far * rng.normal(size=(40, 3))
        with np.errstate(all="ignore"):
            found = nearest(surface, q, p, v)
        good, w = found.converged, q - found.jet.r
        off = w - dot(w, found.jet.n)[:, None] * found.jet.n
        # n and the tangents agree to rounding of what is left
        assert (np.linalg.norm(off[good], axis=-1) <= 1e-10 + 1e-12 * np.linalg.norm(w[good], axis=-1)).all()
        np.testing.assert_array_equal(surface.jet(*found.values[good].T).r, found.jet.r[good])
        held, lost = held + int(good.sum()), lost + int((~good).sum())
    assert held > 1200
    assert lost > 50


# ---- teeth


def random_teeth(count: int, seed: int) -> list[tuple[Tooth, float]]:
    """Pinions with few teeth and their module; designs that are refused are passed over."""
    rng, found = np.random.default_rng(seed), []
    for _ in range(10 * count):
        helix, teeth = float(rng.uniform(0.0, 30.0)), int(rng.integers(7, 20))
        module = float(rng.uniform(1.0, 6.0))
        design = {
            "kind": "beveloid",
            "module": module,
            "pressure_angle": float(rng.uniform(15.0, 25.0)),
            "pinion": {
                "teeth": teeth,
                "helix_angle": helix,
                "face_width": 3.0 * module,
                "profile_shift": rng.uniform(0.0, 0.4),
            },
            "gear": {"teeth": 31, "helix_angle": -helix, "face_width": 3.0 * module},
        }
        try:
            found.append((pair_of(parse(design)).pinion.tooth, module))
        except GearmeshError:
            continue
        if len(found) == count:
            return found
    raise AssertionError("almost all designs are refused")


@cache
def some_teeth() -> list[tuple[Tooth, float]]:
    """Made by the first test that looks at them, not by whoever collects tests."""
    return random_teeth(12, 10)


@pytest.mark.quick
def test_flank_and_fillet_meet() -> None:
    undercut = 0
    for tooth, _ in some_teeth():
        sections = tooth.sections(np.linspace(0.0, 1.0, 40))
        for side, ends in ((tooth.right, sections.right), (tooth.left, sections.left)):
            flank, fillet = (
                along(surface, p, sections.stations, tooth.blank.axial)[1].r
                for surface, p in ((side.flank, ends.form_point_flank), (side.fillet, ends.form_point_fillet))
            )
            assert np.abs(flank - fillet).max() < 1e-9
            undercut += int((ends.form_point_flank != side.form_point[0]).sum())
    assert undercut > 100


@pytest.mark.quick
def test_land_of_width() -> None:
    held = 0
    for k, (tooth, module) in enumerate(some_teeth()):
        axial, tip, width = tooth.blank.axial, tooth.blank.tip, 0.05 * k * module
        stations = tooth.stations(np.linspace(0.0, 1.0, 40))
        flanks = (tooth.right.flank, tooth.right.tip), (tooth.left.flank, tooth.left.tip)
        p, q, points = land_of_width(flanks, axial, tip, stations, width)
        good = np.isfinite(p)
        right, left = (
            along(surface, x[good], stations[good], axial)[1].r for (surface, _), x in zip(flanks, (p, q), strict=True)
        )
        rho = np.hypot(right[:, 0], right[:, 1])
        assert np.abs(right - points[good]).max(initial=0.0) < 1e-9
        assert np.abs(rho * (polar_angle(left) - polar_angle(right)) - width).max(initial=0.0) < 1e-9
        held += int(good.sum())
    assert held > 200


@pytest.mark.parametrize("rounded_edge", [False, True])
@pytest.mark.sweep_cases("True")
def test_broken_edges(rounded_edge: bool) -> None:
    """The chamfer begins `size` below the tip; the rounding touches flank and tip circle."""
    for tooth, module in some_teeth():
        edge = TipEdge(0.04 * module, rounded_edge)
        sections = replace(tooth, tip_edge=edge).sections(np.linspace(0.0, 1.0, 30))
        for side, ends in ((tooth.right, sections.right), (tooth.left, sections.left)):
            assert ends.edge is not None
            _, on_land, centre = ends.edge
            jet = along(side.flank, ends.tip, sections.stations, tooth.blank.axial)[1]
            tip = tooth.blank.tip.at(jet.r[:, 2])
            below = tip - (np.hypot(*centre[:, :2].T) if rounded_edge else np.hypot(*jet.r[:, :2].T))
            assert np.abs(below - edge.size).max() < 1e-12 * module * 20
            assert np.abs(np.hypot(*on_land[:, :2].T) - tip).max() < 1e-11


@pytest.mark.sweep
def test_roundings_of_cutters() -> None:
    """Tangent to the flank, and standing on the tip plane."""
    rng, held = np.random.default_rng(11), 0

    class Spec:
        dedendum = 1.25
        tool_tip_radius = 0.0

    for _ in range(100):
        module = rng.uniform(0.5, 8.0)
        line = RackLine(rng.uniform(0.2, 0.5), module, 0.25 * np.pi * module)
        flank = line if rng.random() < 0.5 else Parabola(line, rng.normal() * 0.02 / module, module)
        spec, heights = Spec(), Heights(module, -1.25 * module)
        spec.tool_tip_radius = rng.uniform(0.0, 0.6)
        try:
            sides = round_tips("pinion", spec, module, (flank, flank), heights)
        except GearmeshError:
            continue
        for rack in sides:
            centre, radius = np.array(rack.rounding.centre), spec.tool_tip_radius * module
            on_flank, _, normal, _ = flank.section(np.array(rack.form_point[0]))
            assert centre[0] - radius == pytest.approx(heights.root, abs=1e-13 * module)
            np.testing.assert_allclose(on_flank + radius * normal, centre, rtol=0, atol=1e-13 * module)
        held += 1
    assert held > 40


@pytest.mark.quick
def test_spacing_takes_its_cells_and_no_more() -> None:
    rng = np.random.default_rng(12)
    for _ in range(60):
        width, count, focus = rng.uniform(0.0, 0.6), int(rng.integers(1, 200)), rng.random()
        spacing = Spacing.of(width, count, focus)
        assert spacing.cells(focus) <= count
        if spacing.finest < 1.0 / count:
            assert Spacing(width, 0.999 * spacing.finest).cells(focus) >= count


@pytest.mark.quick
def test_cradle_rotation_zero() -> None:
    rng, held = np.random.default_rng(13), 0
    for _ in range(40):
        teeth = int(rng.integers(10, 26))
        design = parse(
            {
                "kind": "spiral_bevel",
                "module": 4.0,
                "spiral_angle": rng.uniform(0.0, 45.0),
                "pinion": {"teeth": teeth},
                "gear": {"teeth": int(teeth * rng.uniform(1.5, 4.0))},
            }
        )
        blank = basic_blank(design)
        for side in gear_sides(design, blank).values():
            height = float(rng.uniform(0.2, 0.8)) * side.tip_height
            try:
                p, v = side.at_cradle_zero(height)
            except GearmeshError:
                continue
            flank = side.side(0.0).flank
            assert isinstance(flank, Envelope)
            tool = flank.tool.jet(np.array([p]), np.array([v]))
            assert abs(meshing(tool, as_chain(flank.motion), np.zeros(1))[0]) < 1e-12  # type: ignore[arg-type]
            held += 1
    assert held > 40


# ---- contact


def touches(pair: Pair, phi1: Array) -> tuple[int, int]:
    """Positions of a path that touch and that do not; those that touch are proved to."""
    path = contact_path(pair, phi1)
    touching = path.touching
    np.testing.assert_array_equal(path.status == Status.CONVERGED, touching)
    # tips on fillets, and ridges that undercut leaves, are proved by the roll of whole members
    joint = np.char.find(path.edge, "joint") >= 0
    there = np.flatnonzero(touching & (path.part == 0) & ~joint)
    if not there.size:
        return 0, len(phi1)
    jets = []
    for flank, parameters, angle in ((pair.pinion, path.params1, path.rotation), (pair.gear, path.params2, path.phi2)):
        own = flank.surface.jet(*parameters[there].T)
        mount = flank.mount
        turned = rotation_about("z", mount.sign * (angle[there] - mount.zero))
        own_to_fixed = mount.base.rotation @ turned
        shifted = own.r + np.array([*mount.eccentricity, 0.0])
        assert (flank.margin(parameters[there], own.r) <= 2e-7).all()
        jets.append(
            (own, np.einsum("nij,nj->ni", own_to_fixed, shifted) + mount.base.translation,
             np.einsum("nij,nj->ni", own_to_fixed, own.n), own_to_fixed)
        )  # fmt: skip
    (own1, r1, n1, turn1), (own2, r2, n2, turn2) = jets
    assert np.linalg.norm(r1 - r2, axis=-1).max() < 1e-10
    smooth = np.isin(path.kind[there], ("point", "line"))
    assert np.abs(n1 + n2)[smooth].max(initial=0.0) < 1e-9
    for k in np.flatnonzero(path.kind[there] == "edge"):
        names = path.edge[there[k]].split("+")
        for name in names:
            member, _, edge = name.partition("_")
            one = member == "pinion"
            flank, own, turn, other = (pair.pinion, own1, turn1, n2) if one else (pair.gear, own2, turn2, n1)
            level = flank.edges[edge]
            assert abs(level.value(own.r[k])) < 1e-10
            if len(names) == 1:
                tangent = turn[k] @ np.cross(own.n[k], level.gradient(own.r[k]))
                assert abs(tangent @ other[k]) < 1e-9
    return int(there.size), int((~touching).sum())


@pytest.mark.sweep
def test_contact() -> None:
    """Points, lines and edges under random misalignments, far beyond the ends of engagement too."""
    rng, held, lost = np.random.default_rng(14), 0, 0
    cases = (
        ("beveloid_crossed", ("dx", "dy", "dz", "gamma_h", "gamma_v")),
        ("spur", ()),
        ("helical", ("gamma_h", "gamma_v")),
        ("circular_arc", ("dC", "dgamma")),
    )
    for sample, errors in cases:
        for _ in range(2 if errors else 1):
            keys = [f"assembly.{key}={0.02 * rng.normal():.4f}" for key in errors]
            pair = solver_pair(pair_of(load(SAMPLES / f"{sample}.toml", keys)))
            touching, apart = touches(pair, rng.uniform(-0.9, 0.9, 25))
            held, lost = held + touching, lost + apart
    assert held > 60
    assert lost > 10
