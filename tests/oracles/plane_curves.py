"""Curves in a plane by points on them: how far points are from polylines, and points on a curve."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.plane.curves import PlaneCurve


def from_polylines(points: Array, lines: list[Array]) -> Array:
    """Distances (K,) of points (K, 2) from polylines (N, 2): from the segments beside their nearest corners."""
    starts = np.concatenate([line[:-1] for line in lines])
    ends = np.concatenate([line[1:] for line in lines])
    _, near = cKDTree(0.5 * (starts + ends)).query(points, k=4)
    a, b = starts[near], ends[near]
    along, to = b - a, points[:, None] - a
    share = np.clip((to * along).sum(-1) / np.maximum((along**2).sum(-1), 1e-300), 0.0, 1.0)
    return np.asarray(np.linalg.norm(to - share[..., None] * along, axis=-1).min(axis=1))


def evenly(curve: PlaneCurve, apart: float = 0.02) -> Array:
    """Points (N, 2) of a curve, so far apart (mm) at most, about."""
    length = np.linalg.norm(np.diff(curve.at(np.linspace(0.0, 1.0, 33)), axis=0), axis=-1).sum()
    return curve.at(np.linspace(0.0, 1.0, int(length / apart) + 9))
