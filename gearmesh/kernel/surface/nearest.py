"""Closest points on a surface, batched; what distances between meshes and exact surfaces rest on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import Solution, Status
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.surface import Jet, Surface

#: Gauss-Newton steps at most; the start is next to the solution and 3 or 4 do
STEPS = 12
#: step and tangential distance (mm) that count as none
TOLERANCE = 1e-10
#: square of the sine of the angle between r_u and r_v from which on they are parallel
SINGULAR = 1e-20


@dataclass(frozen=True)
class Nearest(Solution):
    """Closest points: parameters (..., 2) as `values`, the tangential distance left (mm) as residual; the surface's `jet`.

    SINGULAR where r_u || r_v: there is no tangent plane to move in.
    """

    jet: Jet


def nearest(surface: Surface, q: Array, u: Array, v: Array) -> Nearest:
    """Surface points closest to q (..., 3), from starts u, v (...,) near them.

    Gauss-Newton on |R - q|: the step is the tangential part of q - R in the basis r_u, r_v. It contracts by the
    curvature times the distance, which is tiny wherever q is close to the surface.
    """
    jet = surface.jet(u, v)
    du, dv = tangential(jet, q - jet.r)
    iterations = 0
    while iterations < STEPS:
        iterations += 1
        u, v = u + du, v + dv
        along_u, along_v = jet.r_u * du[..., None], jet.r_v * dv[..., None]
        jet = surface.jet(u, v)
        du, dv = tangential(jet, q - jet.r)
        if not (np.maximum(np.abs(along_u), np.abs(along_v)) > TOLERANCE).any():
            break
    left = jet.r_u * du[..., None] + jet.r_v * dv[..., None]
    residual = np.sqrt(dot(left, left))
    outcomes = [
        (~np.isfinite(residual), Status.NOT_FINITE),
        (~_regular(jet), Status.SINGULAR),
        (residual <= TOLERANCE, Status.CONVERGED),
    ]
    status = np.select([where for where, _ in outcomes], [int(s) for _, s in outcomes], int(Status.MAX_ITERATIONS))
    return Nearest(np.stack((u, v), axis=-1), status, residual, iterations, jet)


def _regular(jet: Jet) -> NDArray[np.bool_]:
    """Where (...,) r_u and r_v are not parallel."""
    uu, uv, vv = dot(jet.r_u, jet.r_u), dot(jet.r_u, jet.r_v), dot(jet.r_v, jet.r_v)
    return np.asarray(uu * vv - uv**2 > SINGULAR * uu * vv)


def tangential(jet: Jet, w: Array) -> tuple[Array, Array]:
    """Parameter differentials (...,) whose tangent vector is the tangential part of w (..., 3); 0 where r_u || r_v."""
    uu, uv, vv = dot(jet.r_u, jet.r_u), dot(jet.r_u, jet.r_v), dot(jet.r_v, jet.r_v)
    wu, wv = dot(w, jet.r_u), dot(w, jet.r_v)
    area = uu * vv - uv**2
    with np.errstate(invalid="ignore", divide="ignore"):
        regular = area > SINGULAR * uu * vv
        return np.where(regular, (vv * wu - uv * wv) / area, 0.0), np.where(regular, (uu * wv - uv * wu) / area, 0.0)
