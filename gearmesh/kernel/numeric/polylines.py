"""Polylines and polygons in a plane: where two of them cross, what is inside, and how far."""

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


def depth_inside(polygon: Array, points: Array) -> Array:
    """How far (...,) points (..., 2) are inside a polygon (N, 2), closed or not, < 0 outside; NaN of points that are."""
    (x, y), (u, v) = polygon.T, (np.roll(polygon, -1, axis=0) - polygon).T
    dx, dy = points[..., :1] - x, points[..., 1:] - y
    share = np.clip((dx * u + dy * v) / np.maximum(u**2 + v**2, 1e-300), 0.0, 1.0)
    distance = np.sqrt(((dx - share * u) ** 2 + (dy - share * v) ** 2).min(axis=-1))
    return np.asarray(np.where(contains(polygon, points), distance, -distance))


def share_inside(depth: Array) -> Array:
    """The part (I, J) of the cell around each point of a grid in which a smooth function (I, J) is positive."""
    width = np.sum([np.abs(slope) for slope in np.gradient(depth)], axis=0)
    return np.asarray(np.clip(0.5 + depth / np.maximum(width, 1e-300), 0.0, 1.0))
