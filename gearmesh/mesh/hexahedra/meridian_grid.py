r"""Quadrilaterals in the axial half plane between the inner face of a rim and the profile of the body under it.

The outline is mapped to lines of two directions, H along the rim and V square to it; each side has one nominal value:

        P0 ------ rim ------ Pn           the rim's inner face has nodes at its stations; each line of the grid that
         |                    |           crosses the rim goes through one of these nodes
         |   +---- H ----+    |
         +-V-+           +-V--+           (rho, z) = nominal place + displacement; the displacement is given on the outline
         web's recess                     and harmonic inside, so an outline of right angles has straight lines

Sides that are only nearly along or square to the axis (cones of shafts, rims of bevel gears, back cones) bend the lines.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, distinct
from gearmesh.kernel.numeric.polylines import contains
from gearmesh.records import dataclass

#: longest edge that counts as 0, as a share of the outline's size
NO_LENGTH_SHARE = 1e-7
#: name of the edge that is the rim's inner face
RIM_FACE = "rim_face"

Index = NDArray[np.int64]


class OutlineError(Exception):
    """The outline cannot be mapped to lines of two directions."""


@dataclass(frozen=True)
class MeridianOutline:
    """Outline of a body in the axial half plane; the rim's inner face joins the last point to the first."""

    #: points (N, 2), (rho, z), mm
    points: Array
    #: names of the N - 1 edges between the points
    names: tuple[str, ...]


@dataclass(frozen=True)
class BoundaryEdges:
    """Edges of the grid on its outline."""

    #: direction (E,): 0 on a line of constant first index, 1 of constant second index
    axis: Index
    #: indices (E, 2) of the first node of each edge
    first: Index
    #: True (E,) if the body is at larger indices
    above: NDArray[np.bool_]
    #: name of each edge
    names: tuple[str, ...]

    def only(self, which: NDArray[np.bool_]) -> BoundaryEdges:
        """Return the edges where `which` (E,) is True."""
        names = tuple(name for name, kept in zip(self.names, which, strict=True) if kept)
        return BoundaryEdges(self.axis[which], self.first[which], self.above[which], names)


@dataclass(frozen=True)
class MeridianGrid:
    """Grid of quadrilaterals in the axial half plane."""

    #: nodes (A, B, 2), (rho, z), mm, by lines of growing rho and growing z
    points: Array
    #: True (A - 1, B - 1) for cells in the body
    cells: NDArray[np.bool_]
    #: edges on the outline
    edges: BoundaryEdges
    #: index (0 or 1) that counts along the rim
    axis: int
    #: station (A,) or (B,) whose polar angles the nodes of each line along `axis` have; beyond the rim the nearest
    station: Index
    #: indices (S, 2) of the rim's nodes, by station
    on_rim: Index


@dataclass(frozen=True)
class _OutlineSide:
    """Neighbouring edges of one direction."""

    #: coordinate that is nominally constant: 0 rho, 1 z
    axis: int
    #: number of the first point and edge
    first: int
    #: number of the last point
    last: int


def rim_corners(outline: MeridianOutline, stations: Array, axis: int) -> Array:
    """Return the shares (K,) of the rim's length, 0 .. 1, at which the lines of the outline's corners cross the rim.

    `stations` (S, 2): points of the rim. Raises OutlineError.
    """
    laid = _OutlineLayout(outline, stations, axis)
    inside = (laid.shares_of(laid.breaks[1 - laid.rim_axis])).tolist()
    return np.array([share for share in inside if NO_LENGTH_SHARE < share < 1.0 - NO_LENGTH_SHARE])


def meridian_grid(outline: MeridianOutline, stations: Array, axis: int, size: float, step: int = 1) -> MeridianGrid:
    """Return the grid of an outline.

    - stations: the rim's nodes (S, 2), from the first point to the last; each `step`-th is a corner of cells.
    - axis: 0 if the rim runs along the axis, 1 if square to it.
    - size: approximate size of cells, mm.
    - step: number of spaces between lines in a cell.

    Raises OutlineError.
    """
    return _OutlineLayout(outline, stations, axis).grid(size, step)


class _OutlineLayout:
    """Mapping of an outline to lines of two directions."""

    def __init__(self, outline: MeridianOutline, stations: Array, rim_axis: int) -> None:
        points, names = [outline.points[0]], []
        least = NO_LENGTH_SHARE * float(np.ptp(outline.points, axis=0).max())
        for point, name in zip(outline.points[1:], outline.names, strict=True):
            if np.linalg.norm(point - points[-1]) > least:
                points.append(point)
                names.append(name)
        # the closing edge, the rim, comes last
        self._points, self._names = np.array(points), (*names, RIM_FACE)
        self._stations, self.rim_axis = stations, rim_axis
        self._directions = [self._direction(k) for k in range(len(points))]
        self._sides = self._merge()
        self._values = [self._value(side) for side in self._sides]
        self._nominal = self._corners()
        self.breaks = self._lines()

    def _edge(self, k: int) -> tuple[Array, Array]:
        """Return the ends (2,) of an edge."""
        return self._points[k], self._points[(k + 1) % len(self._points)]

    def _direction(self, k: int) -> int:
        """Return 0 for an edge of nearly constant rho, 1 for an edge of nearly constant z."""
        name = self._names[k]
        if name == RIM_FACE:
            return self.rim_axis
        start, end = self._edge(k)
        rho, z = np.abs(end - start)
        # the rest of the toothed end faces is square to the rim
        return 1 - self.rim_axis if k in (0, len(self._names) - 2) and min(rho, z) > 0.0 else int(rho > z)

    def _merge(self) -> list[_OutlineSide]:
        """Return the sides: runs of edges of one direction."""
        count = len(self._directions)
        starts = [k for k in range(count) if self._directions[k] != self._directions[k - 1]]
        if len(starts) < 4 or len(starts) % 2:
            raise OutlineError
        return [
            _OutlineSide(self._directions[first], first, last if last > first else last + count)
            for first, last in zip(starts, (*starts[1:], starts[0]), strict=True)
        ]

    def _value(self, side: _OutlineSide) -> float:
        """Return the nominal value of a side."""
        coordinates = self._points[np.arange(side.first, side.last + 1) % len(self._points), side.axis]
        if len(self._names) - 1 in range(side.first, side.last):
            # the rim is the outermost side
            outwards = coordinates.mean() > self._points[:, side.axis].mean()
            return float(coordinates.max() if outwards else coordinates.min())
        return float(0.5 * (coordinates.min() + coordinates.max()))

    def _corners(self) -> Array:
        """Return the nominal places (N, 2) of the outline's points."""
        count, nominal = len(self._points), np.full((len(self._points), 2), np.nan)
        for side, value in zip(self._sides, self._values, strict=True):
            nominal[np.arange(side.first, side.last + 1) % count, side.axis] = value
        for side in self._sides:
            inner = np.arange(side.first, side.last + 1)
            along = 1 - side.axis
            ends = nominal[[side.first % count, side.last % count], along]
            places = self._points[inner % count, along].copy()
            places[[0, -1]] = ends
            steps = np.diff(places) * np.sign(ends[1] - ends[0])
            # a side that goes back is spaced by its length instead
            if (steps <= 0.0).any():
                way = np.linalg.norm(np.diff(self._points[inner % count], axis=0), axis=-1)
                places = ends[0] + (ends[1] - ends[0]) * np.concatenate(([0.0], np.cumsum(way))) / way.sum()
            nominal[inner % count, along] = places
        return nominal

    def _lines(self) -> tuple[Array, Array]:
        """Return the nominal values of the lines of both directions."""
        least = NO_LENGTH_SHARE * float(np.ptp(self._points, axis=0).max())
        first, second = (distinct(self._nominal[:, axis]) for axis in (0, 1))
        return tuple(v[np.concatenate(([True], np.diff(v) > least))] for v in (first, second))  # type: ignore[return-value]

    @property
    def _rim_ends(self) -> tuple[float, float]:
        """Nominal places along the rim of its first and last station."""
        first, last = self._nominal[[0, -1], 1 - self.rim_axis].tolist()
        return first, last

    def shares_of(self, values: Array) -> Array:
        """Return the places at which lines cross the rim, as shares of its length from the first station."""
        first, last = self._rim_ends
        return np.asarray((values - first) / (last - first))

    def _station_values(self) -> Array:
        """Return the nominal places (S,) of the stations along the rim."""
        way = np.linalg.norm(np.diff(self._stations, axis=0), axis=-1)
        first, last = self._rim_ends
        return np.asarray(first + (last - first) * np.concatenate(([0.0], np.cumsum(way))) / way.sum())

    def _subdivide(self, breaks: Array, size: float, step: int) -> Array:
        """Return lines between breaks, with cells of about a size, each of `step` spaces."""
        parts = [
            np.linspace(low, high, step * max(1, round((high - low) / size)) + 1)[:-1] for low, high in pairwise(breaks)
        ]
        return np.concatenate((*parts, breaks[-1:]))

    def grid(self, size: float, step: int) -> MeridianGrid:
        """Return the grid, see `meridian_grid`."""
        along, values = 1 - self.rim_axis, self._station_values()
        low, high = np.sort(self._rim_ends)
        breaks = self.breaks[along]
        pieces = [
            self._subdivide(distinct(np.append(breaks[side], end)), size, step)
            for side, end in ((breaks <= low, low), (breaks >= high, high))
        ]
        rim = values if values[0] < values[-1] else values[::-1]
        lines = [np.empty(0), np.empty(0)]
        lines[along] = np.concatenate((pieces[0][:-1], rim, pieces[1][1:]))
        lines[self.rim_axis] = self._subdivide(self.breaks[self.rim_axis], size, step)
        number = np.clip(np.arange(len(lines[along])) - (len(pieces[0]) - 1), 0, len(rim) - 1)
        station = number if values[0] < values[-1] else len(rim) - 1 - number
        return self._fill((lines[0], lines[1]), station, step)

    def _fill(self, lines: tuple[Array, Array], station: Index, step: int) -> MeridianGrid:
        """Return the grid on given lines."""
        nominal = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1)
        centres = 0.25 * (nominal[1:, 1:] + nominal[1:, :-1] + nominal[:-1, 1:] + nominal[:-1, :-1])
        cells = contains(self._nominal, centres)
        moved, edges, on_rim = self._boundary(lines, cells, step)
        return MeridianGrid(_harmonic(nominal, moved, cells, lines), cells, edges, 1 - self.rim_axis, station, on_rim)

    def _boundary(
        self, lines: tuple[Array, Array], cells: NDArray[np.bool_], step: int
    ) -> tuple[Array, BoundaryEdges, Index]:
        """Return places (A, B, 2) of nodes on the outline, NaN elsewhere; the edges; and the rim's nodes by station."""
        places = np.full((len(lines[0]), len(lines[1]), 2), np.nan)
        padded = np.pad(cells, 1)
        axes, firsts, names = list[Index](), list[Index](), list[str]()
        for k, name in enumerate(self._names[:-1]):
            nodes, shares = self._on_edge(lines, k)
            start, end = self._edge(k)
            places[nodes[:, 0], nodes[:, 1]] = start + shares[:, None] * (end - start)
            firsts.append(nodes[:-1:step])
            axes.append(np.full(len(firsts[-1]), self._directions[k]))
            names += [name] * len(firsts[-1])
        on_rim, shares = self._on_edge(lines, len(self._names) - 1)
        # the closing edge runs from the last station to the first
        on_rim = on_rim[::-1] if shares[-1] > shares[0] else on_rim
        places[on_rim[:, 0], on_rim[:, 1]] = self._stations
        first = np.concatenate(firsts)
        above = padded[first[:, 0] + 1, first[:, 1] + 1]
        return places, BoundaryEdges(np.concatenate(axes), first, above, tuple(names)), on_rim

    def _on_edge(self, lines: tuple[Array, Array], k: int) -> tuple[Index, Array]:
        """Return the nodes (K, 2) on an edge, in the order of lines, and their shares (K,) of its length."""
        axis, start, end = self._directions[k], self._nominal[k], self._nominal[(k + 1) % len(self._points)]
        along = 1 - axis
        low, high = sorted(int(np.abs(lines[along] - v[along]).argmin()) for v in (start, end))
        nodes = np.empty((high - low + 1, 2), dtype=np.int64)
        nodes[:, axis] = np.abs(lines[axis] - start[axis]).argmin()
        nodes[:, along] = np.arange(low, high + 1)
        return nodes, (lines[along][low : high + 1] - start[along]) / (end[along] - start[along])


def _harmonic(nominal: Array, places: Array, cells: NDArray[np.bool_], lines: Sequence[Array]) -> Array:
    """Return all nodes (A, B, 2): on the outline at `places` (NaN elsewhere), inside at the nominal place plus displacement.

    The displacement is harmonic over the nominal cells.
    """
    from scipy.sparse import coo_array, diags_array
    from scipy.sparse.linalg import spsolve

    padded = np.pad(cells, 1).astype(float)
    used = (padded[1:, 1:] + padded[1:, :-1] + padded[:-1, 1:] + padded[:-1, :-1]) > 0.0
    inner = used & np.isnan(places[..., 0])
    moved = np.where(np.isnan(places), 0.0, places - nominal)
    if not inner.any():
        return np.asarray(nominal + moved)
    number, padded_widths = np.arange(used.size).reshape(used.shape), [np.pad(np.diff(line), 1) for line in lines]
    # Laplace's equation by finite volumes: the conductance of an edge is half the widths of the cells beside it, over its length
    across = padded * padded_widths[1]
    first = 0.5 * (across[1:-1, 1:] + across[1:-1, :-1]) / np.diff(lines[0])[:, None]
    across = padded * padded_widths[0][:, None]
    second = 0.5 * (across[1:, 1:-1] + across[:-1, 1:-1]) / np.diff(lines[1])
    start = np.concatenate((number[:-1].ravel(), number[:, :-1].ravel()))
    end = np.concatenate((number[1:].ravel(), number[:, 1:].ravel()))
    weights = np.concatenate((first.ravel(), second.ravel()))
    joined = coo_array((weights, (start, end)), shape=(used.size,) * 2)
    joined = (joined + joined.T).tocsr()
    laplace = (diags_array(np.asarray(joined.sum(axis=1))) - joined).tocsc()
    free, flat = np.flatnonzero(inner), moved.reshape(-1, 2)
    known = np.flatnonzero(~inner.ravel())
    rows = laplace[free]
    flat[free] = spsolve(rows[:, free], -(rows[:, known] @ flat[known])).reshape(-1, 2)
    return np.asarray(nominal + flat.reshape(nominal.shape))
