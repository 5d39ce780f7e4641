"""Polylines and polygons in a plane: where two of them cross, what is inside."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, plane_cross


def first_crossing(one: Array, other: Array) -> tuple[float, float] | None:
    """Where two polylines (N, 2) and (M, 2) cross, the crossing nearest to the first's beginning, in numbers of their points."""
    a, b = one[:-1, None], other[None, :-1]
    u, v = np.diff(one, axis=0)[:, None], np.diff(other, axis=0)[None]
    turn, d = plane_cross(u, v), b - a
    with np.errstate(divide="ignore", invalid="ignore"):
        s, t = plane_cross(d, v) / turn, plane_cross(d, u) / turn
    i, j = np.nonzero((s >= 0.0) & (s <= 1.0) & (t >= 0.0) & (t <= 1.0))
    if not i.size:
        return None
    first = int(np.argmin(i + s[i, j]))
    return float(i[first] + s[i, j][first]), float(j[first] + t[i, j][first])


def contains(polygon: Array, points: Array) -> NDArray[np.bool_]:
    """Which of points (..., 2) are inside a polygon (N, 2), closed or not: an odd number of its sides is beyond them."""
    (x, y), (u, v) = polygon.T, np.roll(polygon, -1, axis=0).T
    px, py = points[..., :1], points[..., 1:]
    with np.errstate(divide="ignore", invalid="ignore"):
        crossed = ((y > py) != (v > py)) & (px < (u - x) * (py - y) / (v - y) + x)
    return np.asarray(crossed.sum(axis=-1) % 2 == 1)
