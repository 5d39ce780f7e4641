"""Pressures on half-spaces against Hertz, and problems of any kind against the conditions computed anew."""

from __future__ import annotations

import numpy as np
import pytest

from gearmesh.contact.hertz import STEEL, contact_modulus, point_contact
from gearmesh.errors import Status
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.loaded.complementarity import pressures
from gearmesh.loaded.compliance.contact_compliance import ContactCompliance, half_space_pressures
from gearmesh.loaded.compliance.half_space import rectangle_influence

pytestmark = pytest.mark.quick

MODULUS = contact_modulus(STEEL, STEEL)


@pytest.mark.parametrize(("cells", "tolerance"), [((16, 16), 0.02), ((32, 32), 0.005)])
def test_ellipses_of_hertz(cells: tuple[int, int], tolerance: float) -> None:
    """Round to slender in one batch: pressure, approach and area."""
    kappa, other, force = np.array([0.05, 0.005, 0.0005]), np.array([0.05, 0.1, 0.08]), np.array([1e3, 2e3, 3e3])
    hertz = point_contact(kappa, other, force, MODULUS)
    share = [(2.0 * np.arange(n) + 1.0) / n - 1.0 for n in cells]
    x, y = (1.2 * half[:, None] * part for half, part in zip((hertz.semi_major, hertz.semi_minor), share, strict=True))
    gap = 0.5 * (kappa[:, None] * x**2)[:, :, None] + 0.5 * (other[:, None] * y**2)[:, None]
    dx, dy = x[:, 1] - x[:, 0], y[:, 1] - y[:, 0]
    local = ContactCompliance.of(dx[:, None], dy[:, None], cells, (STEEL, STEEL))
    flat = (3, -1)
    ones, lever = np.ones_like(gap).reshape(flat), 10.0
    plain, found = (
        pressures(
            lambda p, which: local.under(p.reshape(-1, 1, *cells), which).reshape(len(p), -1),
            gap.reshape(flat),
            lever * ones,
            ones * (dx * dy)[:, None],
            ones > 0.0,
            lever * force,
            ones,
            precondition=estimate,
        )
        for estimate in (None, half_space_pressures(dx[:, None], dy[:, None], cells))
    )
    # the half-space's own estimate leads to the same pressures in fewer steps
    np.testing.assert_allclose(found.pressure, plain.pressure, atol=1e-5 * plain.pressure.max())
    assert found.steps < 0.8 * plain.steps
    assert (found.status == Status.CONVERGED).all()
    np.testing.assert_allclose((found.pressure.sum(axis=1) * dx * dy), force, rtol=1e-12)
    np.testing.assert_allclose(found.pressure.max(axis=1), hertz.peak_pressure, rtol=tolerance)
    np.testing.assert_allclose(lever * found.rotation, hertz.approach, rtol=tolerance)
    area = (found.pressure > 0.0).sum(axis=1) * dx * dy
    np.testing.assert_allclose(area, np.pi * hertz.semi_major * hertz.semi_minor, rtol=4.0 * tolerance)


def test_dents_are_sums_over_rectangles() -> None:
    """The convolution against every cell on every other."""
    rng = np.random.default_rng(3)
    pressure, dx, dy = rng.random((2, 5, 7)), np.array([0.2, 0.05]), np.array([0.03, 0.4])
    found = ContactCompliance.of(dx[:, None], dy[:, None], (5, 7), (STEEL, STEEL)).under(
        pressure[:, None], np.arange(2)
    )[:, 0]
    i, j = (each.ravel() for each in np.meshgrid(np.arange(5), np.arange(7), indexing="ij"))
    for k in range(2):
        apart = (i[:, None] - i) * dx[k], (j[:, None] - j) * dy[k]
        table = rectangle_influence(*apart, dx[k], dy[k]) / MODULUS
        np.testing.assert_allclose(found[k].ravel(), table @ pressure[k].ravel(), rtol=1e-11)


def test_dents_of_grids_of_which_some_are_not_pressed() -> None:
    """Those of each grid by itself, in whatever order problems are asked for."""
    rng = np.random.default_rng(4)
    pressure, dx, dy = rng.random((2, 3, 5, 7)), rng.uniform(0.02, 0.4, (2, 3)), rng.uniform(0.02, 0.4, (2, 3))
    pressure[0, 1] = pressure[1, 0] = pressure[1, 2] = 0.0
    found = ContactCompliance.of(dx, dy, (5, 7), (STEEL, STEEL)).under(pressure[::-1], np.array([1, 0]))[::-1]
    for k in np.ndindex(2, 3):
        alone = ContactCompliance.of(dx[k][None, None], dy[k][None, None], (5, 7), (STEEL, STEEL))
        wanted = alone.under(pressure[k][None, None], np.arange(1))[0, 0]
        np.testing.assert_allclose(found[k], wanted, rtol=1e-12, atol=0.0)


def test_converged_means_that_the_conditions_hold() -> None:
    """Random problems, some with most cells far apart: pressure where there is no gap, none where there is, the torque held."""
    rng = np.random.default_rng(11)
    count, cells = 200, 25
    root = rng.standard_normal((count, cells, cells))
    compliance = 1e-5 * (root @ root.swapaxes(1, 2) / cells + 0.05 * np.eye(cells))
    gap = rng.random((count, cells)) * 10.0 ** rng.uniform(-4, 0, (count, 1))
    lever, on = rng.uniform(5.0, 9.0, (count, cells)), rng.random((count, cells)) < 0.8
    on[:, 0] = True
    area, torque = np.broadcast_to(rng.uniform(0.1, 0.3, (count, 1)), gap.shape), 10.0 ** rng.uniform(0, 4, count)

    def moved(p: Array, which: Array) -> Array:
        result: Array = np.einsum("bij,bj->bi", compliance[which], p)
        return result

    first = np.zeros_like(gap)
    first[:, 0] = 1.0
    found = pressures(moved, gap, lever, area, on, torque, first)
    good = found.status == Status.CONVERGED
    assert good.mean() > 0.97
    w = gap + (compliance @ found.pressure[..., None])[..., 0] - lever * found.rotation[:, None]
    scale = np.abs(lever * found.rotation[:, None]).max(axis=1, keepdims=True)
    assert (found.pressure >= 0.0).all()
    assert (found.pressure[~on] == 0.0).all()
    assert np.abs(np.where(found.pressure > 0.0, w, 0.0) / scale)[good].max() < 1e-3
    assert (np.where(on, w, 0.0) / scale)[good].min() > -1e-3
    np.testing.assert_allclose((found.pressure * area * lever).sum(axis=1), torque, rtol=1e-12)
