"""Strips between two curves: their edges are the curves, their jets the derivatives, on stations of every shape."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.strip import Strip
from gearmesh.kinds import ConeLevel, Level, PlaneLevel

pytestmark = pytest.mark.quick

EXTENT = (40.0, 62.0)


def curve(axial: Level, phase: float, height: float) -> Callable[[Array], Array]:
    """A curve on the stations: a spiral near a cone about z."""

    def points(a: Array) -> Array:
        normal = axial.gradient(np.array([1.0, 0.0, 0.0]))
        along = np.array([-normal[2], 0.0, normal[0]])
        length = height + 0.1 * np.sin(a / 9.0) + 0.02 * a
        rho, _, z = a * normal[:, None] + length * along[:, None]
        angle = phase + 0.004 * (a - 50.0) + 2e-5 * (a - 50.0) ** 2
        return np.stack((rho * np.cos(angle), rho * np.sin(angle), z), axis=-1)

    return points


@pytest.mark.parametrize("axial", [ConeLevel(0.3), ConeLevel(1.2), PlaneLevel(0.0)], ids=["pinion", "gear", "plane"])
def test_strip(axial: Level) -> None:
    # a plane's stations are heights, the length along it is minus the radius
    heights = (-30.0, -30.5) if isinstance(axial, PlaneLevel) else (3.0, 3.4)
    first, second = (curve(axial, phase, height) for phase, height in zip((-0.05, 0.07), heights, strict=True))
    strip = Strip.through(axial, EXTENT, first, second)
    a = np.linspace(*EXTENT, 23)
    for h, edge in ((0.0, first), (1.0, second)):
        np.testing.assert_allclose(strip.jet(np.full(23, h), a - strip.middle).r, edge(a), rtol=0, atol=1e-11)
    h, v = np.meshgrid(np.linspace(0.0, 1.0, 5), np.linspace(-9.0, 9.0, 7))
    jet, step = strip.jet(h, v), 1e-4
    np.testing.assert_allclose(axial.value(jet.r), strip.middle + v, rtol=0, atol=1e-12)
    for dh, dv, r_, n_ in ((step, 0.0, jet.r_u, jet.n_u), (0.0, step, jet.r_v, jet.n_v)):
        ahead, behind = strip.jet(h + dh, v + dv), strip.jet(h - dh, v - dv)
        np.testing.assert_allclose((ahead.r - behind.r) / (2.0 * step), r_, rtol=0, atol=1e-7)
        np.testing.assert_allclose((ahead.n - behind.n) / (2.0 * step), n_, rtol=0, atol=1e-7)
    np.testing.assert_allclose(dot(jet.n, jet.n), 1.0, rtol=0, atol=1e-14)
    for tangent in (jet.r_u, jet.r_v):
        np.testing.assert_allclose(dot(jet.n, tangent), 0.0, rtol=0, atol=1e-12)
    assert (jet.n[..., :2] * jet.r[..., :2]).sum(axis=-1).min() > 0.0 or isinstance(axial, PlaneLevel)


def test_a_broken_curve_is_refused() -> None:
    smooth = curve(ConeLevel(0.3), 0.0, 3.0)

    def broken(a: Array) -> Array:
        return smooth(a) + np.abs(a - 50.0)[:, None] * np.array([0.0, 0.01, 0.0])

    with pytest.raises(ValueError, match="smooth"):
        Strip.through(ConeLevel(0.3), EXTENT, smooth, broken)
