"""Deviations along the normals of flanks of any kind: what they are followed by, closed teeth, and contact by other routes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

import gearmesh as gm
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.curvature import shape_operator, tangent_basis
from gearmesh.kernel.surface.levels import Level
from gearmesh.kernel.surface.surface import Surface
from gearmesh.teeth.region import Side
from gearmesh.teeth.section import Grid
from gearmesh.teeth.tooth import Tooth

SAMPLES = Path(gm.__file__).parents[1] / "samples"
#: rows and columns of 45 deviations, as bevel gears are measured
S, T = np.linspace(0.1, 0.9, 5), np.linspace(0.1, 0.9, 9)
#: points between them
FINE = np.linspace(0.1, 0.9, 41)


def smooth(tooth: Tooth, which: Side, s: Array, t: Array) -> Array:
    """Of up to 50 um (S, T), mm: a function of the place on the flank, from -1 to 1 along and across the middle half of it."""
    middle, heel, tip = (
        np.array([level.value(tooth.flank_grid(which, [at[0]], [at[1]]).points[0, 0]) for level in flank_levels(tooth)])
        for at in ((0.5, 0.5), (0.5, 1.0), (1.0, 0.5))
    )
    points = tooth.flank_grid(which, s, t).points
    x, y = (level.value(points) - zero for level, zero in zip(flank_levels(tooth), middle, strict=True))
    x, y = x / (heel - middle)[0], y / (tip - middle)[1]
    return np.asarray(0.02 * np.sin(1.5 * x + y) + 0.015 * x**2 - 0.01 * x * y + 0.005 * y**2)


def flank_levels(tooth: Tooth) -> tuple[Level, Level]:
    return tooth.blank.axial, tooth.blank.across


def noisy(tooth: Tooth, which: Side, most: float = 0.002) -> Array:
    """At the points of the grid, by up to `most` (mm) off the smooth ones."""
    return smooth(tooth, which, S, T) + most * np.random.default_rng(1).uniform(-1.0, 1.0, (S.size, T.size))


def sample(name: str, *overrides: str) -> gm.Gears:
    return gm.build(gm.load(SAMPLES / f"{name}.toml", overrides))


def away(surface: Surface, grid: Grid) -> Array:
    """How far (mm) a surface is from points of a grid along the normals there, found by Newton's method."""
    assert grid.p is not None
    assert grid.v is not None
    p, v, d = grid.p, grid.v, np.zeros(grid.p.shape)
    for _ in range(10):
        jet = surface.jet(p, v)
        matrix = np.stack((jet.r_u, jet.r_v, -grid.normals), axis=-1)
        step = np.linalg.solve(matrix, (grid.points + d[..., None] * grid.normals - jet.r)[..., None])[..., 0]
        p, v, d = p + step[..., 0], v + step[..., 1], d + step[..., 2]
    assert np.abs(step).max() < 1e-9
    return np.asarray(d)


@dataclass(frozen=True)
class Pair:
    """A spiral bevel pair, with what the pinion's working flank deviates, and the pair that has it."""

    nominal: gm.Gears
    values: Array
    real: gm.Gears


@pytest.fixture(scope="module")
def bevel() -> Pair:
    gears = sample("spiral_bevel_basic")
    values = noisy(gears.member("pinion").tooth, Side.RIGHT)
    return Pair(gears, values, gears.with_deviations("pinion", "right", values))


def test_a_bevel_flank_follows_45_deviations(bevel: Pair) -> None:
    """To rounding at the points; between them a smooth function to 0.1 um, and noise is not made larger."""
    nominal, real = (gears.member("pinion").tooth for gears in (bevel.nominal, bevel.real))
    at_points, between = (nominal.flank_grid("right", *grid) for grid in ((S, T), (FINE, FINE)))
    np.testing.assert_allclose(away(real.right.flank, at_points), bevel.values, atol=1e-11)
    assert np.ptp(bevel.values) > 0.045
    wanted = smooth(nominal, Side.RIGHT, FINE, FINE)
    assert np.abs(away(real.right.flank, between) - wanted).max() < 0.004
    plain = bevel.nominal.with_deviations("pinion", "right", noisy(nominal, Side.RIGHT, 0.0)).member("pinion").tooth
    assert np.abs(away(plain.right.flank, between) - wanted).max() < 1e-4


def test_normals_and_curvatures_of_a_bevel_flank(bevel: Pair) -> None:
    """By differences of points and of normals, which miss by their own error, of the second order in the step."""
    tooth = bevel.real.member("pinion").tooth
    surface, grid = tooth.right.flank, tooth.flank_grid("right", np.linspace(0.15, 0.8, 4), np.linspace(0.15, 0.8, 6))
    assert grid.jet is not None
    basis, missed = tangent_basis(grid.jet), []
    for h in (4e-4, 1e-4):
        rows = []
        for du, dv in ((h, 0.0), (0.0, h)):
            ahead, behind = (surface.jet(grid.p + k * du, grid.v + k * dv) for k in (1, -1))
            rows.append([(ahead.r - behind.r) / (2.0 * h), (ahead.n - behind.n) / (2.0 * h)])
        (r_u, n_u), (r_v, n_v) = rows
        n = np.cross(r_u, r_v)
        n *= (np.sign(dot(n, grid.normals)) / np.linalg.norm(n, axis=-1))[..., None]
        bent = shape_operator(replace(grid.jet, r_u=r_u, r_v=r_v, n_u=n_u, n_v=n_v), *basis)
        missed.append([np.abs(n - grid.normals).max(), np.abs(bent - shape_operator(grid.jet, *basis)).max()])
    assert missed[1][0] < missed[0][0] / 15.0 + 1e-10
    assert missed[1][1] < missed[0][1] / 15.0 + 1e-9
    # far more than that is what the deviations change
    before = bevel.nominal.member("pinion").tooth.right.flank.jet(grid.p, grid.v)
    assert np.abs(shape_operator(before, *tangent_basis(before)) - shape_operator(grid.jet, *basis)).max() > 1e-3
