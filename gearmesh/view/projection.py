"""The projection of points onto a trimmed flank: what lies on a tooth is put on its exact surface, and ends at its edges."""

from __future__ import annotations

import numpy as np

from gearmesh.contact.flanks import contact_flank
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.nearest import nearest
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Side
from gearmesh.view.scene import Project

#: start points of projections onto a flank
STARTS = (31, 61)
#: mm by which a place may lie beyond an edge
BEYOND = 1e-6


def flank_projection(member: Member, side: Side) -> Project:
    """Points (..., 3) near the flank -> closest points of the trimmed exact flank, NaN beyond its edges; own frame, mm."""
    from scipy.spatial import cKDTree

    flank = contact_flank(member, side)
    s, t = (np.linspace(0.0, 1.0, n) for n in STARTS)
    grid = member.tooth.flank_grid(side, s, t)
    tree, (p, v) = cKDTree(grid.points.reshape(-1, 3)), grid.parameters.reshape(-1, 2).T

    def project(q: Array) -> Array:
        known = np.isfinite(q).all(axis=-1)
        places = np.full(q.shape, np.nan)
        distance, start = tree.query(q[known])
        foot = nearest(flank.surface, q[known], p[start], v[start])
        jet = foot.jet
        outside = flank.margin(foot.values, jet.r) > BEYOND
        # beyond a singular line of the surface the search can end farther away than it started, or nowhere
        outside |= np.linalg.norm(jet.r - q[known], axis=-1) > distance + 1e-9
        outside |= ~(foot.residual <= BEYOND)
        places[known] = np.where(outside[:, None], np.nan, jet.r)
        return places

    return project
