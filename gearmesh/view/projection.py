"""Projection of points onto a trimmed flank: ellipses and curves lie on the exact surface and end at its edges."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.flanks import contact_flank
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.nearest import nearest
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Side
from gearmesh.view.scene import Project

#: start points of projections across and along a flank
START_GRID = (31, 61)
#: distance beyond an edge at which a point is still on the flank
EDGE_TOLERANCE_MM = 1e-6
#: points whose distances from all start points are in memory together
MAX_POINTS_AT_ONCE = 2048


def flank_projection(member: Member, side: Side) -> Project:
    """Return the function that maps points (..., 3) near a flank to the closest points of the trimmed exact flank.

    It returns NaN beyond the edges. Own frame, mm.
    """
    flank = contact_flank(member, side)
    s, t = (np.linspace(0.0, 1.0, n) for n in START_GRID)
    grid = member.tooth.flank_grid(side, s, t)
    starts, (p, v) = grid.points.reshape(-1, 3), grid.parameters.reshape(-1, 2).T

    def project(q: Array) -> Array:
        known = np.isfinite(q).all(axis=-1)
        places = np.full(q.shape, np.nan)
        distance, start = _nearest_start(q[known], starts)
        foot = nearest(flank.surface, q[known], p[start], v[start])
        jet = foot.jet
        outside = flank.margin(foot.values, jet.r) > EDGE_TOLERANCE_MM
        # beyond a singular line of the surface the search can end farther away than it started, or not converge
        outside |= np.linalg.norm(jet.r - q[known], axis=-1) > distance + 1e-9
        outside |= ~(foot.residual <= EDGE_TOLERANCE_MM)
        places[known] = np.where(outside[:, None], np.nan, jet.r)
        return places

    return project


def _nearest_start(q: Array, starts: Array) -> tuple[Array, NDArray[np.int64]]:
    """Distance (N,) of points (N, 3) from the nearest start point (S, 3), and its index; a tree would take longer to
    load.
    """
    middle = starts.mean(axis=0)
    centred, centred_starts = q - middle, starts - middle
    square = dot(centred_starts, centred_starts)
    number = np.empty(len(q), dtype=np.int64)
    for first in range(0, len(q), MAX_POINTS_AT_ONCE):
        part = slice(first, first + MAX_POINTS_AT_ONCE)
        number[part] = (square - 2.0 * centred[part] @ centred_starts.T).argmin(axis=1)
    return np.linalg.norm(q - starts[number], axis=-1), number
