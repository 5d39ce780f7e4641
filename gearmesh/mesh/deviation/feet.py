"""Feet of points near a surface: heights over it, and their first and second derivatives by the point."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, cross, dot
from gearmesh.kernel.surface.nearest import tangential
from gearmesh.kernel.surface.surface import Jet, Surface
from gearmesh.records import dataclass

#: largest number of steps towards a foot
MAX_STEPS = 40
#: share of the largest distance that the next step may still change
SETTLED_SHARE = 1e-3
#: factor on a step that led away from the point
SHORTER_STEP_FACTOR = 0.25
#: least share of a step that is tried
MIN_STEP_SHARE = 1e-3
#: square of the area of r_u and r_v over that of the square on the longer one, both by their largest lengths, at which the
#: surface counts as singular
SINGULAR_AREA_RATIO = 1e-3
#: largest distance that is rounding
ROUNDING_MM = 1e-9
#: elements of a symmetric 3 by 3 matrix, in the order of `Feet.changes`
MATRIX_PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


@dataclass(frozen=True)
class Feet:
    """Feet of N points on a surface.

    If no foot was reached, the height is the distance from a point of the surface, which is at least the distance from
    the surface. If the surface is nearly singular there (r_u and r_v nearly parallel, or one of them nearly 0), the
    height is over the tangent plane. An example is an involute at its base circle. Such points lie beyond the end of
    the surface, where the next link goes on along this plane.
    """

    #: parameters (N, 2) near the feet
    parameters: Array
    #: heights (N,), mm, over the surface
    heights: Array
    #: normals (N, 3) at the feet
    normals: Array
    #: derivatives of the normals by the point (N, 6), 1/mm: xx, yy, zz, xy, xz, yz of symmetric matrices
    changes: Array
    #: True (N,) where a foot was reached
    sure: NDArray[np.bool_]
    #: largest squares (2,) of r_u and r_v on the patch, the scale of singularity
    lengths: Array

    @staticmethod
    def of(
        surface: Surface,
        q: Array,
        parameters: Array,
        near: tuple[Array, Array] | None = None,
        lengths: Array | None = None,
    ) -> Feet:
        """Return the feet of points.

        - surface: the surface.
        - q: points (N, 3), mm.
        - parameters: parameters (N, 2) from which the search starts.
        - near: other parameters (N, 2), and the distances (N,), mm, above which the search starts from them. Where a surface
          turns back, the mean of two parameters may belong to a point far away.
        - lengths: (2,) as in the class; None for the lengths at the parameters.
        """
        jet = surface.jet(*parameters.T)
        if near is not None:
            others, reach = near
            away = q - jet.r
            lost = np.flatnonzero(~(dot(away, away) <= reach**2))
            if lost.size:
                parameters = parameters.copy()
                parameters[lost] = others[lost]
                jet = _put(jet, lost, surface.jet(*others[lost].T))
        if lengths is None:
            lengths = np.array([np.fmax.reduce(dot(tangent, tangent)) for tangent in (jet.r_u, jet.r_v)])
        u, v = parameters.T.copy()
        share = np.ones(len(q))
        for _ in range(MAX_STEPS):
            away = q - jet.r
            du, dv = tangential(jet, away)
            scale = float(np.fmax.reduce(np.abs(dot(jet.n, away)), initial=ROUNDING_MM))
            which = np.flatnonzero((np.abs(_bulge(jet, du, dv)) > SETTLED_SHARE * scale) & (share > MIN_STEP_SHARE))
            if not which.size:
                break
            du, dv = share[which] * du[which], share[which] * dv[which]
            ahead = surface.jet(u[which] + du, v[which] + dv)
            # where the surface is nearly singular a step leads too far: it is shortened
            before, after = away[which], q[which] - ahead.r
            nearer = dot(after, after) < dot(before, before)
            share[which] = np.where(nearer, 1.0, SHORTER_STEP_FACTOR * share[which])
            if nearer.any():
                u[which[nearer]] += du[nearer]
                v[which[nearer]] += dv[nearer]
                jet = _put(jet, which[nearer], ahead[np.flatnonzero(nearer)])
        return Feet._at(jet, q, np.stack((u, v), axis=-1), lengths)

    @staticmethod
    def _at(jet: Jet, q: Array, parameters: Array, lengths: Array) -> Feet:
        """Return the feet from jets close to them; the rest of the step is taken to second order."""
        away = q - jet.r
        du, dv = tangential(jet, away)
        bulge, heights = _bulge(jet, du, dv), dot(jet.n, away)
        along = away - jet.n * heights[:, None] - jet.along(du, dv)[0]
        left = np.sqrt(dot(along, along)) + np.abs(bulge)
        sure = left <= SETTLED_SHARE * float(np.fmax.reduce(np.abs(heights), initial=ROUNDING_MM))
        farthest = np.copysign(np.sqrt(dot(away, away)), heights)
        # beyond a singular end the surface goes on along its tangent plane, as the next link does
        beyond = np.where(_singular(jet, lengths), heights, np.where(np.isnan(farthest), np.inf, farthest))
        heights = np.where(sure, heights - bulge, beyond)
        return Feet(parameters, heights, jet.n, _changes(jet, np.where(sure, heights, 0.0)), sure, lengths)

    @property
    def known(self) -> Array:
        """Heights (N,), mm, where a foot was reached, else 0."""
        return np.where(self.sure, self.heights, 0.0)

    @property
    def largest(self) -> float:
        """Largest distance, mm, of points whose foot was reached."""
        return float(np.abs(self.heights[self.sure]).max(initial=0.0))


def _singular(jet: Jet, lengths: Array) -> NDArray[np.bool_]:
    """Return True (N,) where r_u and r_v are nearly parallel, or one is nearly 0 compared with `lengths` (2,).

    A surface without width is nowhere singular.
    """
    if not lengths.all():
        return np.zeros(len(jet.r_u), dtype=bool)
    normal = cross(jet.r_u, jet.r_v)
    u, v = dot(jet.r_u, jet.r_u) / lengths[0], dot(jet.r_v, jet.r_v) / lengths[1]
    return np.asarray(dot(normal, normal) / lengths.prod() <= SINGULAR_AREA_RATIO * np.maximum(u, v) ** 2)


def _bulge(jet: Jet, du: Array, dv: Array) -> Array:
    """Return the height (N,), mm, of the surface over its tangent plane at a step (du, dv), to second order."""
    dr, dn = jet.along(du, dv)
    return -0.5 * dot(dr, dn)


def _put(jet: Jet, which: NDArray[np.intp], other: Jet) -> Jet:
    """Return the jet with the points `which` replaced by those of another jet."""
    condition = np.zeros(len(jet.r), dtype=bool)
    condition[which] = True
    number = np.zeros(len(jet.r), dtype=np.intp)
    number[which] = np.arange(which.size)
    return other[number].where(condition, jet)


def _changes(jet: Jet, heights: Array) -> Array:
    """Return the derivatives of the normal by the point (N, 6), at heights (N,) over the surface."""
    r, n, h = (jet.r_u, jet.r_v), (jet.n_u, jet.n_v), heights
    uu, uv, vv = (dot(r[i], r[j]) + h * dot(n[i], r[j]) for i, j in ((0, 0), (0, 1), (1, 1)))
    with np.errstate(all="ignore"):
        area = uu * vv - uv**2
        a = n[0] * (vv / area)[:, None] - n[1] * (uv / area)[:, None]
        b = n[1] * (uu / area)[:, None] - n[0] * (uv / area)[:, None]
        made = np.empty((len(h), 6))
        for k, (i, j) in enumerate(MATRIX_PAIRS):
            made[:, k] = 0.5 * (
                a[:, i] * r[0][:, j] + a[:, j] * r[0][:, i] + b[:, i] * r[1][:, j] + b[:, j] * r[1][:, i]
            )
    return made
