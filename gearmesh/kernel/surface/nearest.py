"""Closest points on a surface, batched: the basis of distances between meshes and exact surfaces."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import Solution, Status
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.surface import Jet, Surface
from gearmesh.records import dataclass

#: limit of the steps; 3 or 4 suffice from a start next to the solution
MAX_GAUSS_NEWTON_STEPS = 12
#: step and tangential distance that count as 0
TOLERANCE_MM = 1e-10
#: squared sine of the angle between r_u and r_v below which they count as parallel
MIN_SQUARED_SINE = 1e-20


@dataclass(frozen=True)
class Nearest(Solution):
    """Closest points: parameters (..., 2) as `values`, tangential distance (mm) as residual, and the surface's `jet`.

    The status is SINGULAR where r_u || r_v, as there is no tangent plane to move in.
    """

    jet: Jet


def nearest(surface: Surface, q: Array, u: Array, v: Array) -> Nearest:
    """Return the surface points closest to q (..., 3), from starts u, v (...,) near them.

    Gauss-Newton steps minimise |R - q|: a step is the tangential part of q - R in the basis r_u, r_v. The error
    contracts by the curvature times the distance per step, which is tiny for q close to the surface.
    """
    jet = surface.jet(u, v)
    du, dv = tangential(jet, q - jet.r)
    iterations = 0
    while iterations < MAX_GAUSS_NEWTON_STEPS:
        iterations += 1
        u, v = u + du, v + dv
        along_u, along_v = jet.r_u * du[..., None], jet.r_v * dv[..., None]
        jet = surface.jet(u, v)
        du, dv = tangential(jet, q - jet.r)
        if not (np.maximum(np.abs(along_u), np.abs(along_v)) > TOLERANCE_MM).any():
            break
    # the step that would follow is the distance left in the tangent plane
    remaining = jet.r_u * du[..., None] + jet.r_v * dv[..., None]
    residual = np.sqrt(dot(remaining, remaining))
    outcomes = [
        (~np.isfinite(residual), Status.NOT_FINITE),
        (~_regular(jet), Status.SINGULAR),
        (residual <= TOLERANCE_MM, Status.CONVERGED),
    ]
    status = np.select(
        [condition for condition, _ in outcomes], [int(s) for _, s in outcomes], int(Status.MAX_ITERATIONS)
    )
    return Nearest(np.stack((u, v), axis=-1), status, residual, iterations, jet)


def _regular(jet: Jet) -> NDArray[np.bool_]:
    """Return True (...,) where r_u and r_v are not parallel."""
    uu, uv, vv = dot(jet.r_u, jet.r_u), dot(jet.r_u, jet.r_v), dot(jet.r_v, jet.r_v)
    return np.asarray(uu * vv - uv**2 > MIN_SQUARED_SINE * uu * vv)


def tangential(jet: Jet, w: Array) -> tuple[Array, Array]:
    """Return the parameter differentials (...,) of the tangential part of w (..., 3); 0 where r_u || r_v."""
    uu, uv, vv = dot(jet.r_u, jet.r_u), dot(jet.r_u, jet.r_v), dot(jet.r_v, jet.r_v)
    wu, wv = dot(w, jet.r_u), dot(w, jet.r_v)
    area = uu * vv - uv**2
    with np.errstate(invalid="ignore", divide="ignore"):
        regular = area > MIN_SQUARED_SINE * uu * vv
        return np.where(regular, (vv * wu - uv * wv) / area, 0.0), np.where(regular, (uu * wv - uv * wu) / area, 0.0)
