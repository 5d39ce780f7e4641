"""Sections of a tooth: a chain of links at every station, and the start and end of each link.

A section at a fixed station runs round the tooth counterclockwise (seen from +z) over the links

    root | fillet_right | flank_right | (edge_right) | land | (edge_left) | flank_left | fillet_left | next root

Parameter s runs from 0 to 1 along each link. Every grid point lies on its exact surface, and neighbouring links share
their end points exactly. A link that is not smooth along the profile has a seam: a constant surface parameter at a
constant s.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.levels import ConeLevel, LandSurface, Level
from gearmesh.kernel.surface.stations import along
from gearmesh.kernel.surface.surface import Jet, Surface
from gearmesh.records import dataclass
from gearmesh.teeth.blank.tip_edge import EdgePoints, TipEdge
from gearmesh.teeth.region import Region, Side


@dataclass(frozen=True)
class Grid:
    """Points of one link on an (s, t) grid."""

    #: points (S, T, 3), own frame, mm
    points: Array
    #: unit outward normals (S, T, 3)
    normals: Array
    #: jet (S, T) of the link's surface; None if the link is drawn
    jet: Jet | None = None
    #: first surface parameter (S, T)
    p: Array | None = None
    #: second surface parameter (S, T)
    v: Array | None = None

    @property
    def parameters(self) -> Array:
        """Surface parameters p and v, (S, T, 2)."""
        assert self.p is not None
        assert self.v is not None
        return np.stack((self.p, self.v), axis=-1)


@dataclass(frozen=True)
class Ends:
    """Ends of one side's links at each of T stations."""

    #: flank parameter p (T,) at the form point
    form_point_flank: Array
    #: fillet parameter q (T,) at the form point
    form_point_fillet: Array
    #: flank parameter p (T,) where the flank ends at the tip, or at its broken edge
    tip: Array
    #: parameter (T,) at which a generated chamfer or rounding begins; NaN if there is none
    tip_corner: Array
    #: polar angle (T,) where the land begins, rad; y in mm for a rack
    tip_angle: Array
    #: polar angle (T,) where the root begins, rad; y in mm for a rack
    root_angle: Array
    #: points (T, 3) of the drawn tip edge; None if there is none
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
    """Trimmed sections of a tooth at T stations."""

    #: stations (T,), 0 at the toe, 1 at the heel
    t: Array
    #: station coordinates (T,), mm
    stations: Array
    #: ends of the links on the right side
    right: Ends
    #: ends of the links on the left side
    left: Ends

    def __getitem__(self, which: slice | NDArray[np.intp]) -> Sections:
        """Return the sections at some of the stations."""
        return Sections(self.t[which], self.stations[which], self.right[which], self.left[which])

    def of(self, side: Side) -> Ends:
        """Return the ends of one side."""
        return self.right if side is Side.RIGHT else self.left


#: (s, parameter) of lines along the face over which a link is not smooth, s ascending inside (0, 1)
Seams = tuple[tuple[float, float], ...]


class Link(Protocol):
    """One link of a section: its region, its exact surface (None if drawn), its start and its end."""

    @property
    def region(self) -> Region: ...

    @property
    def surface(self) -> Surface | None: ...

    @property
    def generated(self) -> bool:
        """True where a tool generates the surface: flanks, fillets, tip chamfers and roundings."""

    @property
    def cone(self) -> ConeLevel | None:
        """The surface if it is a plane, cylinder or cone; None for other surfaces."""

    @property
    def seams(self) -> Seams: ...

    def span(self, sections: Sections) -> tuple[Array, Array]:
        """Return the surface's first parameter at start and end of the link, in the direction of the section.

        `sections`: sections of the tooth at T stations. Result: (T,) each.
        """

    def grid(self, s: ArrayLike, sections: Sections) -> Grid:
        """Return exact points and normals on the link.

        `s`: (S,), or (S, T), from 0 to 1 along the link. `sections`: sections of the tooth at T stations. Result: (S,
        T).
        """


def breaks(link: Link) -> Array:
    """Values of s (K,) at the link's seams."""
    return np.array([s for s, _ in link.seams])


def parameter(s: Array, span: tuple[Array, Array], seams: Seams) -> tuple[Array, Array]:
    """Return the surface's first parameter at s of a link that spans it, and its rate dp/ds; all shapes broadcast.

    The parameter is linear in s from one end to the other, or from seam to seam. At a seam the rate is the one after
    the seam.
    """
    first, last = span
    if not seams:
        return first + s * (last - first), last - first
    places = [0.0, *(place for place, _ in seams), 1.0]
    values = [first, *(np.full_like(first, p) for _, p in seams), last]
    shape = np.broadcast_shapes(np.shape(s), np.shape(first))
    p, rate = np.empty(shape), np.empty(shape)
    for k in range(len(places) - 1):
        after_seam = np.broadcast_to(np.asarray(s) >= places[k], shape) if k else np.ones(shape, dtype=bool)
        slope = (values[k + 1] - values[k]) / (places[k + 1] - places[k])
        p = np.where(after_seam, values[k] + (s - places[k]) * slope, p)
        rate = np.where(after_seam, slope, rate)
    return np.where(np.asarray(s) == 1.0, last, p), rate


def _rows(s: ArrayLike) -> Array:
    """Return s (S,) or (S, T) as an array (S, 1) or (S, T)."""
    s = np.asarray(s, dtype=float)
    return s[:, None] if s.ndim == 1 else s


@dataclass(frozen=True)
class GeneratedLink:
    """Link of a flank, fillet, tip chamfer or rounding."""

    #: region of the link
    region: Region
    #: side of the tooth
    side: Side
    #: exact surface
    surface: Surface
    #: station coordinate of a point
    axial: Level
    #: first surface parameters (T,) at the ends towards root and land; the left side runs from land to root
    ends: Callable[[Ends], tuple[Array, Array]]
    #: a tool generates the surface
    generated: bool = True
    #: the surface is no plane, cylinder or cone
    cone: None = None
    #: lines along the face over which the link is not smooth
    seams: Seams = ()

    def span(self, sections: Sections) -> tuple[Array, Array]:
        return self._span(sections.of(self.side))

    def grid(self, s: ArrayLike, sections: Sections) -> Grid:
        return self.between(_rows(s), sections.of(self.side), sections.stations)

    def between(self, s: Array, ends: Ends, stations: Array) -> Grid:
        """Return `grid` at s (S, 1) or (S, T) from the ends of this side alone."""
        p = parameter(s, self._span(ends), self.seams)[0]
        v, jet = along(self.surface, p, stations, self.axial)
        return Grid(jet.r, jet.n, jet, p, v)

    def _span(self, ends: Ends) -> tuple[Array, Array]:
        first, last = self.ends(ends)
        return (first, last) if self.side is Side.RIGHT else (last, first)


@dataclass(frozen=True)
class TurnedLink:
    """Link of a land or root: a surface of revolution, or a plane, whose first parameter is the polar angle."""

    #: region of the link
    region: Region
    #: surface of the land or root
    surface: LandSurface
    #: station coordinate of a point
    axial: Level
    #: polar angles (T,) at both ends, rad; y in mm for a rack
    ends: Callable[[Sections], tuple[Array, Array]]
    #: the link belongs to neither side
    side: None = None
    #: no tool motion generates the surface
    generated: bool = False
    #: the link is smooth
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
    """Link of a root or land that a tool generates, between the ends of two fillets or flanks."""

    #: region of the link
    region: Region
    #: generated surface
    surface: Surface
    #: station coordinate of a point
    axial: Level
    #: first surface parameter at both ends, the same at all stations
    ends: tuple[float, float]
    #: the link belongs to neither side
    side: None = None
    #: a tool generates the surface
    generated: bool = True
    #: the surface is no plane, cylinder or cone
    cone: None = None
    #: the link is smooth
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
    """Link of a broken tip edge that is drawn on the stations."""

    #: region of the link
    region: Region
    #: side of the tooth
    side: Side
    #: chamfer or rounding
    edge: TipEdge
    #: station coordinate of a point
    axial: Level
    #: the edge has no exact surface
    surface: None = None
    #: no tool generates the edge
    generated: bool = False
    #: the edge is no plane, cylinder or cone
    cone: None = None
    #: the link is smooth
    seams: Seams = ()

    def span(self, sections: Sections) -> tuple[Array, Array]:
        zero = np.zeros_like(sections.t)
        return zero, zero + 1.0

    def grid(self, s: ArrayLike, sections: Sections) -> Grid:
        points = sections.of(self.side).edge
        assert points is not None
        way = _rows(s) if self.side is Side.RIGHT else 1.0 - _rows(s)
        return Grid(*self.edge._section_curve(points, self.axial, way))
