"""Sections of a tooth: the chain of links at every station, and where each of them starts and ends.

Going round the tooth counterclockwise (seen from +z) at a fixed station the section is the chain

    root | fillet_right | flank_right | (edge_right) | land | (edge_left) | flank_left | fillet_left | next root

s in [0, 1] runs along each link of the chain. Every grid point lies on its exact surface and neighbouring links share
their end points exactly. Where a link is not smooth along the profile it has a seam: a constant parameter at a constant s.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.levels import ConeLevel, LandSurface, Level
from gearmesh.kernel.surface.stations import along
from gearmesh.kernel.surface.surface import Jet, Surface
from gearmesh.teeth.blank.tip_edge import EdgePoints, TipEdge
from gearmesh.teeth.region import Region, Side


@dataclass(frozen=True)
class Grid:
    """Points and unit outward normals (S, T, 3) of one link on an (s, t) grid; `jet` where the link is a `Surface`.

    `p`, `v` (S, T) are that surface's parameters.
    """

    points: Array
    normals: Array
    jet: Jet | None = None
    p: Array | None = None
    v: Array | None = None

    @property
    def parameters(self) -> Array:
        """(S, T, 2): p and v of a grid on a surface."""
        assert self.p is not None
        assert self.v is not None
        return np.stack((self.p, self.v), axis=-1)


@dataclass(frozen=True)
class Ends:
    """Where the links of one side end, at each of T stations: parameters (T,), and points (T, 3) of the broken edge.

    `tip_corner`: the parameter at which a generated chamfer or rounding begins, NaN where it has none.
    """

    form_point_flank: Array
    form_point_fillet: Array
    tip: Array
    tip_corner: Array
    tip_angle: Array
    root_angle: Array
    edge: EdgePoints | None

    def __getitem__(self, which: slice | NDArray[np.intp]) -> Ends:
        edge = None if self.edge is None else (self.edge[0][which], self.edge[1][which], self.edge[2][which])
        return Ends(
            self.form_point_flank[which],
            self.form_point_fillet[which],
            self.tip[which],
            self.tip_corner[which],
            self.tip_angle[which],
            self.root_angle[which],
            edge,
        )


@dataclass(frozen=True)
class Sections:
    """Trimmed chain ends of both sides at stations t (T,) with station coordinates `stations` (T,), mm."""

    t: Array
    stations: Array
    right: Ends
    left: Ends

    def __getitem__(self, which: slice | NDArray[np.intp]) -> Sections:
        """The sections at some of the stations."""
        return Sections(self.t[which], self.stations[which], self.right[which], self.left[which])

    def of(self, side: Side) -> Ends:
        """The ends of one side.

        Parameters
        ----------
        side : Side
            Right or left.

        Returns
        -------
        Ends
            Parameters at each of the T stations.

        Examples
        --------
        >>> sections = gears.members["pinion"].tooth.sections([0.0, 1.0])
        >>> sections.of(gm.Side.LEFT) is sections.left
        True
        """
        return self.right if side is Side.RIGHT else self.left


#: (s, parameter) of lines along the face over which a link is not smooth, s ascending inside (0, 1)
Seams = tuple[tuple[float, float], ...]


class Link(Protocol):
    """One link of the chain: what it is, its exact surface (None: drawn, not generated), where it starts and ends."""

    @property
    def region(self) -> Region: ...

    @property
    def surface(self) -> Surface | None: ...

    @property
    def generated(self) -> bool:
        """True where a tool generates the surface: flanks, fillets, tip chamfers and roundings."""

    @property
    def cone(self) -> ConeLevel | None:
        """The plane, cylinder or cone that the surface is, if it is one."""

    @property
    def seams(self) -> Seams: ...

    def span(self, sections: Sections) -> tuple[Array, Array]:
        """The surface's first parameter at the start and the end of the link, in the chain's direction.

        Parameters
        ----------
        sections : Sections
            The tooth's, at T stations.

        Returns
        -------
        tuple of ndarray
            (T,) each.

        Examples
        --------
        >>> tooth = gears.members["pinion"].tooth
        >>> first, last = tooth.chain[gm.Region.FLANK_RIGHT].span(tooth.sections([0.0, 1.0]))
        >>> first.shape
        (2,)
        """

    def grid(self, s: ArrayLike, sections: Sections) -> Grid:
        """Exact points and normals on the link.

        Parameters
        ----------
        s : array_like
            (S,), or (S, T), from 0 to 1 along the link.
        sections : Sections
            The tooth's, at T stations.

        Returns
        -------
        Grid
            (S, T).

        Examples
        --------
        >>> tooth = gears.members["pinion"].tooth
        >>> tooth.chain[gm.Region.FLANK_RIGHT].grid([0.0, 0.5, 1.0], tooth.sections([0.0, 1.0])).points.shape
        (3, 2, 3)
        """


def breaks(link: Link) -> Array:
    """s (K,) of the link's seams."""
    return np.array([s for s, _ in link.seams])


def parameter(s: Array, span: tuple[Array, Array], seams: Seams) -> tuple[Array, Array]:
    """The surface's first parameter at s of a link that spans it, and its rate dp/ds; all of shapes that broadcast.

    Straight from one end to the other, or from seam to seam; on a seam the rate is that of what follows.
    """
    first, last = span
    if not seams:
        return first + s * (last - first), last - first
    places = [0.0, *(place for place, _ in seams), 1.0]
    values = [first, *(np.full_like(first, p) for _, p in seams), last]
    shape = np.broadcast_shapes(np.shape(s), np.shape(first))
    p, rate = np.empty(shape), np.empty(shape)
    for k in range(len(places) - 1):
        on = np.broadcast_to(np.asarray(s) >= places[k], shape) if k else np.ones(shape, dtype=bool)
        slope = (values[k + 1] - values[k]) / (places[k + 1] - places[k])
        p = np.where(on, values[k] + (s - places[k]) * slope, p)
        rate = np.where(on, slope, rate)
    return np.where(np.asarray(s) == 1.0, last, p), rate


def _rows(s: ArrayLike) -> Array:
    """s (S,) or (S, T) as (S, 1) or (S, T)."""
    s = np.asarray(s, dtype=float)
    return s[:, None] if s.ndim == 1 else s


@dataclass(frozen=True)
class GeneratedLink:
    """A flank, fillet, tip chamfer or rounding; `ends` are its ends on a side's way from the root to the land, which the left
    one goes back."""

    region: Region
    side: Side
    surface: Surface
    axial: Level
    ends: Callable[[Ends], tuple[Array, Array]]
    generated: bool = True
    cone: None = None
    seams: Seams = ()

    def span(self, sections: Sections) -> tuple[Array, Array]:
        return self._span(sections.of(self.side))

    def grid(self, s: ArrayLike, sections: Sections) -> Grid:
        return self.between(_rows(s), sections.of(self.side), sections.stations)

    def between(self, s: Array, ends: Ends, stations: Array) -> Grid:
        """As `grid`, s (S, 1) or (S, T), where only the side's own ends are known."""
        p = parameter(s, self._span(ends), self.seams)[0]
        v, jet = along(self.surface, p, stations, self.axial)
        return Grid(jet.r, jet.n, jet, p, v)

    def _span(self, ends: Ends) -> tuple[Array, Array]:
        first, last = self.ends(ends)
        return (first, last) if self.side is Side.RIGHT else (last, first)


@dataclass(frozen=True)
class TurnedLink:
    """A land or root: a surface of revolution, or a plane, whose first parameter is the angle; `ends` are its angles."""

    region: Region
    surface: LandSurface
    axial: Level
    ends: Callable[[Sections], tuple[Array, Array]]
    side: None = None
    generated: bool = False
    seams: Seams = ()

    @property
    def cone(self) -> ConeLevel | None:
        return self.surface.cone

    def span(self, sections: Sections) -> tuple[Array, Array]:
        return self.ends(sections)

    def grid(self, s: ArrayLike, sections: Sections) -> Grid:
        first, last = self.ends(sections)
        angle = first + _rows(s) * (last - first)
        start = self.surface.meeting(self.axial, sections.stations)
        v, jet = along(self.surface, angle, sections.stations, self.axial, start)
        return Grid(jet.r, jet.n, jet, angle, v)


@dataclass(frozen=True)
class BottomLink:
    """A root that a tool generates between two values of its first parameter, from one fillet's end to the next one's."""

    region: Region
    surface: Surface
    axial: Level
    ends: tuple[float, float]
    side: None = None
    generated: bool = True
    cone: None = None
    seams: Seams = ()

    def span(self, sections: Sections) -> tuple[Array, Array]:
        first, last = self.ends
        return np.full_like(sections.t, first), np.full_like(sections.t, last)

    def grid(self, s: ArrayLike, sections: Sections) -> Grid:
        first, last = self.ends
        p = np.broadcast_to(
            first + _rows(s) * (last - first), np.broadcast_shapes(_rows(s).shape, (1, sections.t.size))
        )
        v, jet = along(self.surface, p, sections.stations, self.axial)
        return Grid(jet.r, jet.n, jet, p, v)


@dataclass(frozen=True)
class DrawnLink:
    """A broken tip edge, drawn on the stations."""

    region: Region
    side: Side
    edge: TipEdge
    axial: Level
    surface: None = None
    generated: bool = False
    cone: None = None
    seams: Seams = ()

    def span(self, sections: Sections) -> tuple[Array, Array]:
        zero = np.zeros_like(sections.t)
        return zero, zero + 1.0

    def grid(self, s: ArrayLike, sections: Sections) -> Grid:
        points = sections.of(self.side).edge
        assert points is not None
        way = _rows(s) if self.side is Side.RIGHT else 1.0 - _rows(s)
        return Grid(*self.edge._section_curve(points, self.axial, way))
