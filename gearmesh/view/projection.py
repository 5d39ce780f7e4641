"""The projection of points onto a trimmed flank: what lies on a tooth is put on its exact surface, and ends at its edges."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.flanks import contact_flank
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.nearest import nearest
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Side
from gearmesh.view.scene import Project

#: start points of projections onto a flank
STARTS = (31, 61)
#: mm by which a place may lie beyond an edge
BEYOND = 1e-6
#: points whose distances from all starts are in memory at once
AT_ONCE = 2048


def flank_projection(member: Member, side: Side) -> Project:
    """Points (..., 3) near the flank -> closest points of the trimmed exact flank, NaN beyond its edges; own frame, mm."""
    flank = contact_flank(member, side)
    s, t = (np.linspace(0.0, 1.0, n) for n in STARTS)
    grid = member.tooth.flank_grid(side, s, t)
    starts, (p, v) = grid.points.reshape(-1, 3), grid.parameters.reshape(-1, 2).T

    def project(q: Array) -> Array:
        known = np.isfinite(q).all(axis=-1)
        places = np.full(q.shape, np.nan)
        distance, start = _nearest_start(q[known], starts)
        foot = nearest(flank.surface, q[known], p[start], v[start])
        jet = foot.jet
        outside = flank.margin(foot.values, jet.r) > BEYOND
        # beyond a singular line of the surface the search can end farther away than it started, or nowhere
        outside |= np.linalg.norm(jet.r - q[known], axis=-1) > distance + 1e-9
        outside |= ~(foot.residual <= BEYOND)
        places[known] = np.where(outside[:, None], np.nan, jet.r)
        return places

    return project


def _nearest_start(q: Array, starts: Array) -> tuple[Array, NDArray[np.int64]]:
    """Distance (N,) of points (N, 3) from the nearest of starts (S, 3), and its number; a tree takes longer to load than this."""
    middle = starts.mean(axis=0)
    own, others = q - middle, starts - middle
    square = dot(others, others)
    number = np.empty(len(q), dtype=np.int64)
    for first in range(0, len(q), AT_ONCE):
        part = slice(first, first + AT_ONCE)
        number[part] = (square - 2.0 * own[part] @ others.T).argmin(axis=1)
    return np.linalg.norm(q - starts[number], axis=-1), number
