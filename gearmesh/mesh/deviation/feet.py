"""Feet of points near a surface: how far these are from it, and to second order how that changes with the point."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, cross, dot
from gearmesh.kernel.surface.nearest import tangential
from gearmesh.kernel.surface.surface import Jet, Surface

#: steps towards the foot at most, and the share of the largest distance that the next one may change
STEPS, SETTLED = 40, 1e-3
#: share of a step that led away that is tried next, and the share at which no more is
SHORTER, SHORTEST = 0.25, 1e-3
#: square of the area of r_u and r_v, each by its largest length, over that of the longer one's square at which they are singular
SINGULAR = 1e-3
#: distances (mm) below this are rounding
FLOOR = 1e-9
#: elements of a symmetric matrix
PAIRS = ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))


@dataclass(frozen=True)
class Feet:
    """Parameters (N, 2) near the feet of points on the surface, heights (N,) over it, normals (N, 3) there, and how these change
    with the point: the symmetric matrices xx, yy, zz, xy, xz, yz (N, 6).

    Where no foot was reached (not `sure`, (N,)) the height is the distance from a point of the surface, which is no smaller than
    that from the surface. But where the surface is all but singular there (r_u and r_v all but parallel, or one of them all but
    nothing, as an involute at its base) it is the height over its tangent plane: of points beyond its end, where the next link goes
    on along that plane. `lengths` (2,): the largest squares of r_u and r_v on the patch, by which that is judged.
    """

    parameters: Array
    heights: Array
    normals: Array
    changes: Array
    sure: NDArray[np.bool_]
    lengths: Array

    @staticmethod
    def of(
        surface: Surface,
        q: Array,
        parameters: Array,
        near: tuple[Array, Array] | None = None,
        lengths: Array | None = None,
    ) -> Feet:
        """Feet of points q (N, 3), from parameters near them; `lengths` (2,) of the patch, without them those at these parameters.

        `near`: other parameters (N, 2) to start from, and the distance (N,), mm, from which on they are taken: next to where a
        surface turns back the mean of two parameters may be that of a point far away.
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
            lengths = np.array([np.fmax.reduce(dot(of, of)) for of in (jet.r_u, jet.r_v)])
        u, v = parameters.T.copy()
        share = np.ones(len(q))
        for _ in range(STEPS):
            away = q - jet.r
            du, dv = tangential(jet, away)
            scale = float(np.fmax.reduce(np.abs(dot(jet.n, away)), initial=FLOOR))
            which = np.flatnonzero((np.abs(_bulge(jet, du, dv)) > SETTLED * scale) & (share > SHORTEST))
            if not which.size:
                break
            du, dv = share[which] * du[which], share[which] * dv[which]
            ahead = surface.jet(u[which] + du, v[which] + dv)
            # where the surface is all but singular a step leads too far
            before, after = away[which], q[which] - ahead.r
            nearer = dot(after, after) < dot(before, before)
            share[which] = np.where(nearer, 1.0, SHORTER * share[which])
            if nearer.any():
                u[which[nearer]] += du[nearer]
                v[which[nearer]] += dv[nearer]
                jet = _put(jet, which[nearer], ahead[np.flatnonzero(nearer)])
        return Feet._at(jet, q, np.stack((u, v), axis=-1), lengths)

    @staticmethod
    def _at(jet: Jet, q: Array, parameters: Array, lengths: Array) -> Feet:
        """From the jets next to the feet, by the last part of the step."""
        away = q - jet.r
        du, dv = tangential(jet, away)
        bulge, heights = _bulge(jet, du, dv), dot(jet.n, away)
        along = away - jet.n * heights[:, None] - jet.along(du, dv)[0]
        left = np.sqrt(dot(along, along)) + np.abs(bulge)
        sure = left <= SETTLED * float(np.fmax.reduce(np.abs(heights), initial=FLOOR))
        farthest = np.copysign(np.sqrt(dot(away, away)), heights)
        # where it ends in a singular line it goes on, as the next link, along its tangent plane
        beyond = np.where(_singular(jet, lengths), heights, np.where(np.isnan(farthest), np.inf, farthest))
        heights = np.where(sure, heights - bulge, beyond)
        return Feet(parameters, heights, jet.n, _changes(jet, np.where(sure, heights, 0.0)), sure, lengths)

    @property
    def known(self) -> Array:
        """The heights (N,) of those that are sure, 0 of the others."""
        return np.where(self.sure, self.heights, 0.0)

    @property
    def largest(self) -> float:
        """The largest distance, mm, of those that are known."""
        return float(np.abs(self.heights[self.sure]).max(initial=0.0))


def _singular(jet: Jet, lengths: Array) -> NDArray[np.bool_]:
    """Where (N,) r_u and r_v are all but parallel, or one is all but nothing beside its largest square of `lengths` (2,); nowhere
    on what has no width at all."""
    if not lengths.all():
        return np.zeros(len(jet.r_u), dtype=bool)
    normal = cross(jet.r_u, jet.r_v)
    u, v = dot(jet.r_u, jet.r_u) / lengths[0], dot(jet.r_v, jet.r_v) / lengths[1]
    return np.asarray(dot(normal, normal) / lengths.prod() <= SINGULAR * np.maximum(u, v) ** 2)


def _bulge(jet: Jet, du: Array, dv: Array) -> Array:
    """Height (N,) of a surface over its tangent plane at a step in its parameters, to second order."""
    dr, dn = jet.along(du, dv)
    return -0.5 * dot(dr, dn)


def _put(jet: Jet, which: NDArray[np.intp], other: Jet) -> Jet:
    """The jet with some of its points replaced."""
    condition = np.zeros(len(jet.r), dtype=bool)
    condition[which] = True
    number = np.zeros(len(jet.r), dtype=np.intp)
    number[which] = np.arange(which.size)
    return other[number].where(condition, jet)


def _changes(jet: Jet, heights: Array) -> Array:
    """dn/dq (N, 6) at heights over the surface."""
    r, n, h = (jet.r_u, jet.r_v), (jet.n_u, jet.n_v), heights
    uu, uv, vv = (dot(r[i], r[j]) + h * dot(n[i], r[j]) for i, j in ((0, 0), (0, 1), (1, 1)))
    with np.errstate(all="ignore"):
        area = uu * vv - uv**2
        a = n[0] * (vv / area)[:, None] - n[1] * (uv / area)[:, None]
        b = n[1] * (uu / area)[:, None] - n[0] * (uv / area)[:, None]
        made = np.empty((len(h), 6))
        for k, (i, j) in enumerate(PAIRS):
            made[:, k] = 0.5 * (
                a[:, i] * r[0][:, j] + a[:, j] * r[0][:, i] + b[:, i] * r[1][:, j] + b[:, j] * r[1][:, i]
            )
    return made
