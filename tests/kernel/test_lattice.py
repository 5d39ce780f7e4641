"""Values between lattice points and numbers of points at places, against scipy."""

import numpy as np
from scipy.ndimage import map_coordinates
from scipy.spatial import cKDTree

from gearmesh.kernel.numeric.lattice import SORTING_DIRECTION, bilinear, numbers_at


def test_bilinear_values_are_those_of_scipy() -> None:
    rng = np.random.default_rng(7)
    values, index = rng.normal(size=(6, 9)), rng.uniform(0.0, 1.0, (200, 2)) * (5.0, 8.0)
    expected = map_coordinates(values, index.T, order=1)
    np.testing.assert_allclose(bilinear(values[..., None], index)[:, 0], expected, atol=1e-13)


def test_numbers_at_places_are_those_of_a_tree() -> None:
    """Also with many points of one height along the direction by which they are sorted, and none near some places."""
    rng = np.random.default_rng(8)
    points = rng.normal(size=(2000, 3))
    level = points[:500] - np.outer(points[:500] @ np.array(SORTING_DIRECTION), SORTING_DIRECTION)
    points = np.concatenate((points, level))
    places = np.concatenate((points[rng.permutation(len(points))[:300]], rng.normal(size=(50, 3)) + 20.0))
    places = (places + rng.normal(size=places.shape) * 0.004).reshape(10, 35, 3)
    distance, number = cKDTree(points).query(places)
    near = distance < 0.01
    found = numbers_at(points, places, 0.01)
    assert 200 < near.sum() < near.size - 49
    assert (found[near] == number[near]).all()
    assert (found[~near] == -1).all()
