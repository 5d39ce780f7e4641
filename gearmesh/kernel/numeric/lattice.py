"""Values between the points of a lattice, and numbers of points at known places; scipy's would take longer to load."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array

#: direction along which points are sorted; few meshes have many points at right angles to it
SORTING_DIRECTION = (0.5389, 0.6113, 0.5796)


def bilinear(values: Array, index: Array) -> Array:
    """Return values (K, C) at fractional indices (K, 2) of a lattice (M, N, C), continued beyond its edges."""
    first = np.clip(np.floor(index).astype(np.int64), 0, np.maximum(np.array(values.shape[:2]) - 2, 0))
    (i, j), (u, v) = first.T, (index - first).T[..., None]
    i_next, j_next = np.minimum(i + 1, values.shape[0] - 1), np.minimum(j + 1, values.shape[1] - 1)
    low = (1.0 - v) * values[i, j] + v * values[i, j_next]
    high = (1.0 - v) * values[i_next, j] + v * values[i_next, j_next]
    mixed: Array = (1.0 - u) * low + u * high
    return mixed


def numbers_at(points: Array, places: Array, tolerance: float) -> NDArray[np.int64]:
    """Return the numbers (...,) of the points (N, 3) nearest to places (..., 3), -1 where none is within `tolerance`."""
    along = points @ np.array(SORTING_DIRECTION)
    order = np.argsort(along, kind="stable")
    wanted = places.reshape(-1, 3)
    height = wanted @ np.array(SORTING_DIRECTION)
    # no point is farther along the direction, which is a unit vector to 1 %, than in space
    first = along[order].searchsorted(height - 1.01 * tolerance, "left")
    last = along[order].searchsorted(height + 1.01 * tolerance, "right")
    nearest, found = np.full(len(wanted), tolerance), np.full(len(wanted), -1)
    for step in range(int((last - first).max(initial=0))):
        here = np.flatnonzero(first + step < last)
        number = order[first[here] + step]
        distance = np.linalg.norm(points[number] - wanted[here], axis=-1)
        closer = distance < nearest[here]
        nearest[here[closer]], found[here[closer]] = distance[closer], number[closer]
    return found.reshape(places.shape[:-1])
