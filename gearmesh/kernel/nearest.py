"""Closest points on a surface, batched; what distances between meshes and exact surfaces rest on."""

from __future__ import annotations

import numpy as np

from gearmesh.kernel.algebra import Array, dot
from gearmesh.kernel.surface import Jet, Surface

#: Gauss-Newton steps at most; the start is next to the solution and 3 or 4 do
STEPS = 12


def nearest(surface: Surface, q: Array, u: Array, v: Array) -> tuple[Array, Array, Jet]:
    """Parameters (...,) and jet of the surface points closest to q (..., 3), from starts u, v (...,) near them.

    Gauss-Newton on |R - q|: the step is the tangential part of q - R in the basis r_u, r_v. It contracts by the
    curvature times the distance, which is tiny wherever q is close to the surface.
    """
    jet = surface.jet(u, v)
    for _ in range(STEPS):
        du, dv = tangential(jet, q - jet.r)
        u, v = u + du, v + dv
        jet = surface.jet(u, v)
        moved = np.abs(jet.r_u * du[..., None] + jet.r_v * dv[..., None])
        if not (moved > 1e-10).any():
            break
    return u, v, jet


def tangential(jet: Jet, w: Array) -> tuple[Array, Array]:
    """Parameter differentials (...,) whose tangent vector is the tangential part of w (..., 3); 0 where r_u || r_v."""
    uu, uv, vv = dot(jet.r_u, jet.r_u), dot(jet.r_u, jet.r_v), dot(jet.r_v, jet.r_v)
    wu, wv = dot(w, jet.r_u), dot(w, jet.r_v)
    area = uu * vv - uv**2
    with np.errstate(invalid="ignore", divide="ignore"):
        regular = area > 1e-20 * uu * vv
        return np.where(regular, (vv * wu - uv * wv) / area, 0.0), np.where(regular, (uu * wv - uv * wu) / area, 0.0)
