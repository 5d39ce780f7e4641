"""Mesh of one link: nodes on its exact surface, triangles between them, and their distances from the surface."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.stations import along
from gearmesh.records import dataclass
from gearmesh.teeth.region import Region
from gearmesh.teeth.section import Grid, Sections, parameter
from gearmesh.teeth.tooth import Tooth

Index = NDArray[np.int64]

#: least number of rows of nodes for which a test for constant ends of the link pays
MIN_ROWS_OF_SPAN_TEST = 200
#: places on an edge at which its distance from the surface is estimated
EDGE_SHARES = np.array([0.15, 0.25, 0.35, 0.5, 0.65, 0.75, 0.85])[:, None]
#: digits of the station t that count: stations that differ by rounding alone are trimmed once
STATION_DIGITS = 12


@dataclass(frozen=True)
class LinkNodes:
    """Nodes of one link."""

    #: tooth of the link
    tooth: Tooth
    #: region of the link
    region: Region
    #: s (N,), across the link
    s: Array
    #: t (N,), from toe (0) to heel (1)
    t: Array
    #: exact points (N, 3), mm
    points: Array
    #: exact unit normals (N, 3)
    normals: Array
    #: parameters (N, 2) of the surface; None for a drawn link
    parameters: Array | None

    @staticmethod
    def of(tooth: Tooth, region: Region, s: Array, t: Array, trimmed: Sections, second: Array) -> LinkNodes:
        """Return the nodes at s, t (N,), exact points of the surface.

        - trimmed: sections (T,) at stations that rise from 0 to 1. Between them the link's ends are linear in t; a drawn link
          has nodes at these stations only.
        - second: approximate second parameters (N,) of the surface.
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
        """Return the nodes at s (N,) on sections (N,)."""
        grid = tooth.grid(region, s[None], sections)
        parameters = None if grid.p is None else grid.parameters[0]
        return LinkNodes(tooth, region, s, sections.t, grid.points[0], grid.normals[0], parameters)

    def middle(self, *corners: Index) -> Grid:
        """Return the surface (M,) near the means of K nodes each; arrays of corners (M, K), as edges and triangles, are joined."""
        surface = self.tooth.chain[self.region].surface
        if surface is None or self.parameters is None:
            at = trim(self.tooth, _means(self.t, corners))
            drawn = LinkNodes.on(self.tooth, self.region, _means(self.s, corners), at)
            return Grid(drawn.points, drawn.normals)
        jet = surface.jet(*_means(self.parameters, corners).T)
        return Grid(jet.r, jet.n, jet)

    def height(self, *corners: Index) -> tuple[Array, Array]:
        """Return the signed distances (M,), mm, of the means of K nodes each from the surface, and the normals (M, 3) there."""
        near = self.middle(*corners)
        return distance(near, _means(self.points, corners)), near.normals

    def arch(self, edges: Index, heights: Array | None = None) -> Array:
        """Return the largest distances (M,), mm, of edges (M, 2) from the surface, by its normals at their ends.

        With slopes a and b at x = 0 and 1 the distance is x (1 - x) (a (1 - x) - b x), to third order. It may vanish in the
        middle, where `height` measures. With the `heights` (M,) of the middles it is right to fourth order: the difference to
        (a - b) / 8 adds 16 x^2 (1 - x)^2 times.
        """
        first, last = edges.T
        along = self.points[last] - self.points[first]
        a, b = dot(self.normals[first], along), dot(self.normals[last], along)
        over = a * (1.0 - EDGE_SHARES) - b * EDGE_SHARES
        if heights is not None:
            over += 16.0 * EDGE_SHARES * (1.0 - EDGE_SHARES) * (heights - 0.125 * (a - b))
        arch: Array = (EDGE_SHARES * (1.0 - EDGE_SHARES) * np.abs(over)).max(axis=0)
        return arch

    def over(self, corners: Index, places: Array) -> Array:
        """Return the exact points (M, K, 3) at barycentric places (K, 3) of triangles (M, 3) in the (s, t) plane.

        The link must have a surface.
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
        """First parameters at the link's ends if they are the same at all rows of nodes and between them, else None.

        Threads that neither undercut nor a tip cylinder cuts off have constant ends.
        """
        rows = self.t[np.unique(np.round(self.t, STATION_DIGITS), return_index=True)[1]]
        if rows.size < MIN_ROWS_OF_SPAN_TEST:
            return None
        sections = self.tooth.sections(np.sort(np.concatenate((rows, 0.5 * (rows[1:] + rows[:-1])))))
        first, last = self.tooth.chain[self.region].span(sections)
        if np.ptp(first) or np.ptp(last):
            return None
        return first[0], last[0]

    def line(self, s: float) -> Index:
        """Return the nodes at s = 0 or 1, from toe to heel."""
        return _in_order(self.s == s, self.t)

    def end(self, t: float) -> Index:
        """Return the nodes at the toe (t = 0) or heel (t = 1), in the order of s."""
        return _in_order(self.t == t, self.s)


@dataclass(frozen=True)
class PatchMesh:
    """Triangle mesh of one link."""

    #: nodes (N,)
    nodes: LinkNodes
    #: (M, 3), counterclockwise seen from outside
    triangles: Index
    #: exact normals (M, 3) at the centres of the triangles
    normals: Array
    #: largest measured distance from the surface, mm
    deviation: float

    @property
    def region(self) -> Region:
        """Region of the link."""
        return self.nodes.region

    @property
    def points(self) -> Array:
        """Nodes (N, 3), mm."""
        return self.nodes.points


def _in_order(chosen: NDArray[np.bool_], by: Array) -> Index:
    """Return the chosen numbers in the order of `by`."""
    which = np.flatnonzero(chosen)
    ordered: Index = which[np.argsort(by[which], kind="stable")]
    return ordered


def trim(tooth: Tooth, t: Array) -> Sections:
    """Return the sections (N,) at t (N,); each different station is trimmed once."""
    _, first, which = np.unique(np.round(t, STATION_DIGITS), return_index=True, return_inverse=True)
    # the stations themselves, not rounded: a rounded one may be beyond the beginning of undercut
    return tooth.sections(t[first])[which]


def _means(values: Array, corners: Sequence[Index]) -> Array:
    """Return the means (M, ...) of values at nodes (N, ...) over corners (M, K); the results of several arrays are joined."""
    # corner by corner, because numpy is slow along axes of two or three
    means = list[Array]()
    for at in corners:
        total = values[at[:, 0]]
        for k in range(1, at.shape[1]):
            total = total + values[at[:, k]]
        means.append(total / at.shape[1])
    return np.concatenate(means) if len(means) > 1 else means[0]


def distance(near: Grid, q: Array) -> Array:
    """Return the signed distances (...,), mm, of points q (..., 3) of facets from the surface near the points of a grid.

    The distance is n . d minus the height of the surface over its tangent plane at the foot of d. This height is of the same
    order if the facet point lies beside the grid point along the surface.
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
    # near a cusp of the surface the correction is meaningless and is left out
    return height - np.where(np.abs(bulge) <= np.abs(height) + dot(away, away), bulge, 0.0)
