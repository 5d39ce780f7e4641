"""Fields over flank coordinates: derivatives in space by differences, on every kind of station, beyond the grid and in the fade."""

from __future__ import annotations

import numpy as np
import pytest

from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.numeric.grid_spline import GridSpline
from gearmesh.kinds import ConeLevel, Level, PlaneLevel
from gearmesh.teeth.micro_geometry.flank_field import Band, BandSpline, Fade, LevelField

pytestmark = pytest.mark.quick

#: a band between two curves, with a row between them that is nearer to the first
COLUMNS = np.linspace(-10.0, 11.0, 9)
LOW, HIGH = 20.0 + 0.1 * COLUMNS + 0.01 * COLUMNS**2, 26.0 + 0.05 * COLUMNS - 0.004 * COLUMNS**2
POINTS = np.stack([np.stack((COLUMNS, y), axis=-1) for y in (LOW, LOW + (0.45 + 0.004 * COLUMNS) * (HIGH - LOW), HIGH)])
#: stations across the axis, on cones, and on cylinders
STATIONS = {"planes": PlaneLevel(0.0), "cones": ConeLevel(0.45, 60.0), "cylinders": ConeLevel(0.5 * np.pi, 30.0)}
X = np.linspace(-12.0, 12.0, 17)


def spline() -> BandSpline:
    a, b = np.linspace(0.0, 1.0, 9), np.linspace(0.0, 1.0, 5)
    values = 0.05 * np.sin(4.0 * a[:, None] + 3.0 * b) + 0.01 * np.random.default_rng(3).normal(size=(9, 5))
    return BandSpline(Band.of(POINTS), GridSpline.through(a, b, values))


def fade() -> Fade:
    return Fade.between(X, 21.0 + 0.1 * X + 0.003 * X**2, 18.0 + 0.05 * X)


def space(axial: ConeLevel | PlaneLevel, x: Array, y: Array) -> Array:
    """Points with the flank coordinates x, y (N,), anywhere round the axis."""
    rows = np.array([level.gradient(np.array([1.0, 0.0, 0.0]))[[0, 2]] for level in (axial, across(axial))])
    rho, z = np.linalg.solve(rows, np.stack((x - axial.value(np.zeros(3)), y)))
    around = np.linspace(-1.0, 4.0, x.size)
    return np.stack((rho * np.cos(around), rho * np.sin(around), z), axis=-1)


def across(axial: ConeLevel | PlaneLevel) -> Level:
    return ConeLevel(0.5 * np.pi).across(axial)


@pytest.mark.parametrize("name", STATIONS)
def test_gradient_and_hessian(name: str) -> None:
    """Inside the grid, beyond it on every side, and in the fade."""
    axial = STATIONS[name]
    field = LevelField((axial, across(axial)), (spline(), fade()))
    x, y = (each.ravel() for each in np.meshgrid(np.linspace(-11.3, 12.7, 9), np.linspace(18.9, 28.3, 11)))
    r = space(axial, x, y)
    np.testing.assert_allclose([axial.value(r), across(axial).value(r)], [x, y], atol=1e-12)
    exact, w, h = field.jet(r), np.array([0.3, -0.5, 0.8]), 1e-4
    ahead, behind = field.jet(r + h * w), field.jet(r - h * w)
    rate = (ahead.value - behind.value) / (2.0 * h)
    np.testing.assert_allclose(dot(exact.gradient, np.broadcast_to(w, r.shape)), rate, atol=1e-8)
    turned = (ahead.gradient - behind.gradient) / (2.0 * h)
    np.testing.assert_allclose(exact.hessian(np.broadcast_to(w, r.shape)), turned, atol=1e-7)
    assert np.ptp(exact.value) > 0.01


def test_rows_and_columns_of_a_band_have_constant_coordinates() -> None:
    """Up and down, and with columns in either order; between its rows the second coordinate grows."""
    for sense in (1.0, -1.0):
        for points in (POINTS, POINTS[:, ::-1]):
            turned = points * np.array([1.0, sense])
            a, b = (jet.f for jet in Band.of(turned).jets(turned[..., 0], turned[..., 1]))
            np.testing.assert_allclose(a, np.broadcast_to(np.linspace(0.0, 1.0, 9), a.shape), atol=1e-12)
            np.testing.assert_allclose(b[[0, 2]], [[0.0] * 9, [1.0] * 9], atol=1e-12)
            np.testing.assert_allclose(b[1], b[1].mean(), atol=1e-12)
            assert 0.4 < b[1].mean() < 0.5


def test_the_fade_is_whole_at_one_curve_and_nothing_at_the_other() -> None:
    for begins, ends in ((21.0 + 0.1 * X, 18.0 + 0.05 * X), (-21.0 + 0.1 * X, -18.0 + 0.05 * np.abs(X))):
        made = Fade.between(X, begins, ends)
        whole, nothing = made.jet(X, begins), made.jet(X, ends)
        np.testing.assert_allclose(whole.f, 1.0, atol=1e-14)
        assert not any(np.any(each) for each in nothing)
        beyond = made.jet(X, begins + 0.3 * (begins - ends))
        assert (beyond.f == 1.0).all()
        assert not any(np.any(each) for each in beyond[1:])
        rising = made.jet(X[:, None], begins[:, None] + np.linspace(0.0, 1.0, 40) * (ends - begins)[:, None]).f
        assert (np.diff(rising, axis=1) <= 0.0).all()


def test_a_spline_near_a_grid_goes_through_its_places() -> None:
    """Places that are off the lines, and some far enough to be no grid."""
    x, y = np.linspace(0.0, 1.0, 9), np.linspace(0.0, 1.0, 5)
    rng = np.random.default_rng(5)
    at = np.stack(np.meshgrid(x, y, indexing="ij"), axis=-1) + 0.02 * rng.uniform(-1.0, 1.0, (9, 5, 2))
    values = rng.normal(size=(9, 5))
    found = GridSpline.near(x, y, at, values).jet(at[..., 0], at[..., 1])
    np.testing.assert_allclose(found.f, values, atol=1e-12)
    # cubics are met, whatever the places
    cubic = GridSpline.near(x, y, at, at[..., 0] ** 3 * at[..., 1] - at[..., 1] ** 2).jet(
        np.array(0.37), np.array(0.81)
    )
    assert cubic.f == pytest.approx(0.37**3 * 0.81 - 0.81**2, abs=1e-12)
    assert cubic.xy == pytest.approx(3 * 0.37**2, abs=1e-10)
    at[3] = at[4]
    with pytest.raises(ValueError, match="grid"):
        GridSpline.near(x, y, at, values)
