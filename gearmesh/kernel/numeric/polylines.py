"""Polylines and polygons in a plane: first crossing, points inside, and depth inside."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, plane_cross


def first_crossing(first_line: Array, second_line: Array) -> tuple[float, float] | None:
    """Return the first crossing of two polylines (N, 2) and (M, 2), counted along the first polyline, or None.

    The crossing is a pair of fractional point numbers: 2.5 is half way from point 2 to point 3.
    """
    a, b = first_line[:-1, None], second_line[None, :-1]
    u, v = np.diff(first_line, axis=0)[:, None], np.diff(second_line, axis=0)[None]
    turn, d = plane_cross(u, v), b - a
    with np.errstate(divide="ignore", invalid="ignore"):
        s, t = plane_cross(d, v) / turn, plane_cross(d, u) / turn
    i, j = np.nonzero((s >= 0.0) & (s <= 1.0) & (t >= 0.0) & (t <= 1.0))
    if not i.size:
        return None
    nearest = int(np.argmin(i + s[i, j]))
    return float(i[nearest] + s[i, j][nearest]), float(j[nearest] + t[i, j][nearest])


def contains(polygon: Array, points: Array) -> NDArray[np.bool_]:
    """Return True for points (..., 2) inside a polygon (N, 2), closed or not.

    A ray from an inside point crosses an odd number of sides.
    """
    (x, y), (u, v) = polygon.T, np.roll(polygon, -1, axis=0).T
    px, py = points[..., :1], points[..., 1:]
    with np.errstate(divide="ignore", invalid="ignore"):
        crossed = ((y > py) != (v > py)) & (px < (u - x) * (py - y) / (v - y) + x)
    return np.asarray(crossed.sum(axis=-1) % 2 == 1)


def depth_inside(polygon: Array, points: Array) -> Array:
    """Return the distance (...,) of points (..., 2) from the boundary of a polygon (N, 2), closed or not.

    Negative outside, NaN for NaN points.
    """
    (x, y), (u, v) = polygon.T, (np.roll(polygon, -1, axis=0) - polygon).T
    dx, dy = points[..., :1] - x, points[..., 1:] - y
    share = np.clip((dx * u + dy * v) / np.maximum(u**2 + v**2, 1e-300), 0.0, 1.0)
    distance = np.sqrt(((dx - share * u) ** 2 + (dy - share * v) ** 2).min(axis=-1))
    return np.asarray(np.where(contains(polygon, points), distance, -distance))


def share_inside(depth: Array) -> Array:
    """Return the fraction (I, J) of the cell around each grid point in which a smooth function (I, J) is positive."""
    width = np.sum([np.abs(slope) for slope in np.gradient(depth)], axis=0)
    return np.asarray(np.clip(0.5 + depth / np.maximum(width, 1e-300), 0.0, 1.0))
