"""The mesh of one link: nodes on its exact surface, triangles between them, and how far these are from the surface."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.stations import along
from gearmesh.teeth.region import Region
from gearmesh.teeth.section import Grid, Sections, parameter
from gearmesh.teeth.tooth import Tooth

Index = NDArray[np.int64]

#: rows of nodes from which on it pays to look whether a link ends at the same parameters everywhere
MANY_ROWS = 200
#: where on an edge its distance from the surface is looked at
PLACES = np.array([0.15, 0.25, 0.35, 0.5, 0.65, 0.75, 0.85])[:, None]
#: digits of the station parameter t that count: stations that are the same but for rounding are trimmed once
DIGITS = 12


@dataclass(frozen=True)
class LinkNodes:
    """Nodes of one link at s, t (N,): exact points and normals (N, 3) and, of a surface, its parameters (N, 2)."""

    tooth: Tooth
    region: Region
    s: Array
    t: Array
    points: Array
    normals: Array
    parameters: Array | None

    @staticmethod
    def of(tooth: Tooth, region: Region, s: Array, t: Array, trimmed: Sections, second: Array) -> LinkNodes:
        """Nodes at s, t (N,): exact points of the surface, of the trimmed sections (T,) themselves at their stations.

        Between these stations, ascending from 0 to 1, the link's ends are straight over t; a drawn link has no nodes
        there. `second`: values (N,) near the surface's second parameters.
        """
        link = tooth.chain[region]
        if link.surface is None:
            return LinkNodes.on(tooth, region, s, trimmed[np.searchsorted(trimmed.t, t)])
        first, last = (np.interp(t, trimmed.t, end) for end in link.span(trimmed))
        p = parameter(s, (first, last), link.seams)[0]
        v, jet = along(link.surface, p, tooth.stations(t), tooth.blank.axial, second)
        return LinkNodes(tooth, region, s, t, jet.r, jet.n, np.stack((p, v), axis=-1))

    @staticmethod
    def on(tooth: Tooth, region: Region, s: Array, sections: Sections) -> LinkNodes:
        """Nodes at s (N,) by the sections (N,)."""
        grid = tooth.grid(region, s[None], sections)
        parameters = None if grid.p is None else grid.parameters[0]
        return LinkNodes(tooth, region, s, sections.t, grid.points[0], grid.normals[0], parameters)

    def middle(self, *corners: Index) -> Grid:
        """The surface (M,) near the middles of nodes (M, K), of edges and of triangles one after the other."""
        surface = self.tooth.chain[self.region].surface
        if surface is None or self.parameters is None:
            at = trim(self.tooth, _means(self.t, corners))
            drawn = LinkNodes.on(self.tooth, self.region, _means(self.s, corners), at)
            return Grid(drawn.points, drawn.normals)
        jet = surface.jet(*_means(self.parameters, corners).T)
        return Grid(jet.r, jet.n, jet)

    def height(self, *corners: Index) -> tuple[Array, Array]:
        """Signed distance (M,), mm, of the middles of nodes (M, K), of edges and of triangles, from the surface, and its normals
        (M, 3) near them."""
        near = self.middle(*corners)
        return distance(near, _means(self.points, corners)), near.normals

    def arch(self, edges: Index, heights: Array | None = None) -> Array:
        """Largest distance (M,), mm, of edges (M, 2) from the surface by its normals at their ends alone, to third
        order, or with the `heights` (M,) of their middles to fourth.

        With slopes a and b at x = 0 and 1 the distance is x (1 - x) (a (1 - x) - b x); in the middle, where `height`
        looks, it may vanish. What the height there is more than (a - b) / 8 counts 16 x^2 (1 - x)^2 times.
        """
        first, last = edges.T
        along = self.points[last] - self.points[first]
        a, b = dot(self.normals[first], along), dot(self.normals[last], along)
        over = a * (1.0 - PLACES) - b * PLACES
        if heights is not None:
            over += 16.0 * PLACES * (1.0 - PLACES) * (heights - 0.125 * (a - b))
        arch: Array = (PLACES * (1.0 - PLACES) * np.abs(over)).max(axis=0)
        return arch

    def over(self, corners: Index, places: Array) -> Array:
        """Exact points (M, K, 3) at barycentric places (K, 3) of triangles (M, 3) in the (s, t) plane; of a surface
        only.
        """
        assert self.parameters is not None
        s, t, v = ((coordinate[corners] @ places.T).ravel() for coordinate in (self.s, self.t, self.parameters[:, 1]))
        link, span = self.tooth.chain[self.region], self._constant_span
        assert link.surface is not None
        span = link.span(trim(self.tooth, t)) if span is None else span
        p = parameter(s, span, link.seams)[0]
        jet = along(link.surface, p, self.tooth.stations(t), self.tooth.blank.axial, v)[1]
        return jet.r.reshape(len(corners), -1, 3)

    @cached_property
    def _constant_span(self) -> tuple[Array, Array] | None:
        """First parameters at which the link begins and ends, if they are the same at all nodes and between their
        rows, else None.

        So it is of threads: where neither undercut nor a tip cylinder cuts them off there is nothing to trim.
        """
        rows = self.t[np.unique(np.round(self.t, DIGITS), return_index=True)[1]]
        if rows.size < MANY_ROWS:
            return None
        sections = self.tooth.sections(np.sort(np.concatenate((rows, 0.5 * (rows[1:] + rows[:-1])))))
        first, last = self.tooth.chain[self.region].span(sections)
        if np.ptp(first) or np.ptp(last):
            return None
        return first[0], last[0]

    def line(self, s: float) -> Index:
        """The nodes of constant s = 0 or 1, from toe to heel."""
        return _in_order(self.s == s, self.t)

    def end(self, t: float) -> Index:
        """The nodes at the toe (t = 0) or the heel (t = 1), along s."""
        return _in_order(self.t == t, self.s)


@dataclass(frozen=True)
class PatchMesh:
    """One link: its nodes, triangles (M, 3), counterclockwise seen from outside, and the exact normals at their
    centres.

    `deviation` is the largest measured distance, mm.
    """

    nodes: LinkNodes
    triangles: Index
    normals: Array
    deviation: float

    @property
    def region(self) -> Region:
        return self.nodes.region

    @property
    def points(self) -> Array:
        """Nodes (N, 3), mm."""
        return self.nodes.points


def _in_order(chosen: NDArray[np.bool_], by: Array) -> Index:
    which = np.flatnonzero(chosen)
    ordered: Index = which[np.argsort(by[which], kind="stable")]
    return ordered


def trim(tooth: Tooth, t: Array) -> Sections:
    """Sections (N,) at t (N,), of which every station is trimmed once."""
    _, first, which = np.unique(np.round(t, DIGITS), return_index=True, return_inverse=True)
    # a station itself, not what it is rounded to, which may be beyond the beginning of undercut
    return tooth.sections(t[first])[which]


def _means(of: Array, corners: Sequence[Index]) -> Array:
    """Means (M, ...) of what is given at nodes, over their numbers (M, K), one after the other."""
    # corner by corner: numpy is slow along axes of two or three
    means = list[Array]()
    for at in corners:
        total = of[at[:, 0]]
        for k in range(1, at.shape[1]):
            total = total + of[at[:, k]]
        means.append(total / at.shape[1])
    return np.concatenate(means) if len(means) > 1 else means[0]


def distance(near: Grid, q: Array) -> Array:
    """Signed distance (...,) of facet points q (..., 3) from the surface near the grid's points.

    n . d less the height of the surface over its tangent plane at the foot of d, which is of the same order where the
    facet point lies beside the grid point along the surface.
    """
    away = q - near.points
    height = dot(near.normals, away)
    if near.jet is None:
        return height
    r_u, r_v, n_u, n_v = near.jet.r_u, near.jet.r_v, near.jet.n_u, near.jet.n_v
    uu, uv, vv = dot(r_u, r_u), dot(r_u, r_v), dot(r_v, r_v)
    with np.errstate(invalid="ignore", divide="ignore"):
        area = uu * vv - uv**2
        du = (vv * dot(away, r_u) - uv * dot(away, r_v)) / area
        dv = (uu * dot(away, r_v) - uv * dot(away, r_u)) / area
        bulge = -0.5 * dot(n_u * du[..., None] + n_v * dv[..., None], r_u * du[..., None] + r_v * dv[..., None])
    # on a cusp of the surface the correction means nothing
    return height - np.where(np.abs(bulge) <= np.abs(height) + dot(away, away), bulge, 0.0)
