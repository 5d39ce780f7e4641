"""Polylines in a plane: where two of them cross."""

from __future__ import annotations

import numpy as np

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
