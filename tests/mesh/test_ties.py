"""Choices between equally good triangles, which the last digits of coordinates must not decide: they differ by processor."""

from __future__ import annotations

import numpy as np
import pytest

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.body import triangulate
from gearmesh.mesh.strip_triangulation import StripTriangulation

#: coordinates (mm) differ by about so much between processors
ROUNDING = 1e-13


@pytest.mark.quick
def test_a_symmetric_outline_is_triangulated_alike_whatever_its_last_digits_are() -> None:
    """The outline of a tooth about its middle, whose opposite nodes lie on circles: any two diagonals are equally good."""
    along = np.linspace(-1.0, 1.0, 9)
    upper = np.column_stack((20.0 + 4.0 * (1.0 - along**2), 3.0 * along))
    polygon = np.concatenate((upper, np.array([[15.0, 4.0], [15.0, 1.5], [15.0, -1.5], [15.0, -4.0]])))
    expected, rng = triangulate(polygon), np.random.default_rng(3)
    assert len(expected) == len(polygon) - 2
    for _ in range(30):
        moved = polygon + ROUNDING * rng.standard_normal(polygon.shape)
        np.testing.assert_array_equal(triangulate(moved), expected)


@pytest.mark.quick
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_strip_begins_alike_where_its_first_diagonals_are_equally_near(sign: float) -> None:
    none = np.zeros(0, dtype=np.int64)
    left, right = np.array([0, 1, 2]), np.array([3, 4, 5])
    level = np.array([0.0, 1.0, 2.0, 0.0, 1.0, 2.0])

    def triangles(rounding: float) -> Array:
        def miss(edges: np.ndarray) -> Array:
            return 1e-3 + rounding * np.where(edges[:, 0] % 2 == 1, 1.0, -1.0)

        return StripTriangulation.of([left, right], [none], [none], level, miss).triangles()[0]

    np.testing.assert_array_equal(triangles(sign * 1e-15), triangles(0.0))
