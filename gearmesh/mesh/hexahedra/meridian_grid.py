r"""Quadrilaterals in the axial half plane between the inner face of a rim and the profile of the body under it.

The outline is laid onto lines of two directions, of V along the axis and of H across it, each side of it at one value:

        P0 ------ rim ------ Pn           the rim's inner face has the nodes of its stations, and every line of the grid
         |                    |           that crosses it goes through one of them
         |   +---- H ----+    |
         +-V-+           +-V--+           (rho, z) = nominal place + displacement: that of the sides is given, that of the inside
         web's recess                     is harmonic, so that an outline of straight angles has straight lines

Sides that only nearly run along or across the axis, as cones of shafts, rims of bevel gears and back cones, bend the lines.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.polylines import contains

#: share of the outline's size below which its edges count as none
NONE = 1e-7
#: name of the edge that is the rim's inner face
RIM_FACE = "rim_face"

Index = NDArray[np.int64]


class OutlineError(Exception):
    """The outline does not go onto lines of two directions."""


@dataclass(frozen=True)
class MeridianOutline:
    """A body in the axial half plane: `points` (N, 2), (rho, z), mm, the last of them joined to the first by the rim's inner face;
    `names` (N - 1,) of the edges between them."""

    points: Array
    names: tuple[str, ...]


@dataclass(frozen=True)
class BoundaryEdges:
    """Edges of the grid on its outline: on lines of which of the two directions (`axis` 0: constant first index), their first nodes
    (E, 2), whether the grid is at larger indices, and their names."""

    axis: Index
    first: Index
    above: NDArray[np.bool_]
    names: tuple[str, ...]


@dataclass(frozen=True)
class MeridianGrid:
    """Nodes `points` (A, B, 2), (rho, z), by lines of growing rho and growing z; `cells` (A - 1, B - 1) that are in the body;
    `edges` of its outline.

    `station` (A,) or (B,): for every line of the rim's axis (1: lines of z) the station whose angles its nodes have, the nearest
    beyond the rim; `on_rim` (S, 2): indices of the rim's nodes, by station.
    """

    points: Array
    cells: NDArray[np.bool_]
    edges: BoundaryEdges
    axis: int
    station: Index
    on_rim: Index


@dataclass(frozen=True)
class _OutlineSide:
    """Neighbouring edges of one direction: `axis` along which it has one `value`, numbers of its first point and edge, of its last
    point."""

    axis: int
    first: int
    last: int


def rim_corners(outline: MeridianOutline, stations: Array, axis: int) -> Array:
    """Shares (K,) of the rim's length, 0 .. 1, at which lines of the outline's corners cross it; `stations` (S, 2) are on it.

    Raises OutlineError.
    """
    laid = _OutlineLayout(outline, stations, axis)
    inside = (laid.shares_of(laid.breaks[1 - laid.rim_axis])).tolist()
    return np.array([share for share in inside if NONE < share < 1.0 - NONE])


def meridian_grid(outline: MeridianOutline, stations: Array, axis: int, size: float, step: int = 1) -> MeridianGrid:
    """The grid of an outline with cells of about a `size` (mm), each of `step` spaces between lines.

    `stations` (S, 2): the rim's nodes from the first to the last point, of which those at steps are corners of cells; `axis`: 0
    where the rim runs along the axis, 1 where across. Raises OutlineError.
    """
    return _OutlineLayout(outline, stations, axis).grid(size, step)


class _OutlineLayout:
    """An outline laid onto lines of two directions."""

    def __init__(self, outline: MeridianOutline, stations: Array, rim_axis: int) -> None:
        points, names = [outline.points[0]], []
        least = NONE * float(np.ptp(outline.points, axis=0).max())
        for point, name in zip(outline.points[1:], outline.names, strict=True):
            if np.linalg.norm(point - points[-1]) > least:
                points.append(point)
                names.append(name)
        # the closing edge comes last
        self._points, self._names = np.array(points), (*names, RIM_FACE)
        self._stations, self.rim_axis = stations, rim_axis
        self._directions = [self._direction(k) for k in range(len(points))]
        self._sides = self._merge()
        self._values = [self._value(side) for side in self._sides]
        self._nominal = self._corners()
        self.breaks = self._lines()

    def _edge(self, k: int) -> tuple[Array, Array]:
        return self._points[k], self._points[(k + 1) % len(self._points)]

    def _direction(self, k: int) -> int:
        """0 for an edge of constant rho, or nearly, 1 for one of constant z."""
        name = self._names[k]
        if name == RIM_FACE:
            return self.rim_axis
        one, other = self._edge(k)
        rho, z = np.abs(other - one)
        # what is left of the toothed end faces is at right angles to the rim
        return 1 - self.rim_axis if k in (0, len(self._names) - 2) and min(rho, z) > 0.0 else int(rho > z)

    def _merge(self) -> list[_OutlineSide]:
        count = len(self._directions)
        starts = [k for k in range(count) if self._directions[k] != self._directions[k - 1]]
        if len(starts) < 4 or len(starts) % 2:
            raise OutlineError
        return [
            _OutlineSide(self._directions[first], first, last if last > first else last + count)
            for first, last in zip(starts, (*starts[1:], starts[0]), strict=True)
        ]

    def _value(self, side: _OutlineSide) -> float:
        own = self._points[np.arange(side.first, side.last + 1) % len(self._points), side.axis]
        if len(self._names) - 1 in range(side.first, side.last):
            # the rim is beyond all else
            outwards = own.mean() > self._points[:, side.axis].mean()
            return float(own.max() if outwards else own.min())
        return float(0.5 * (own.min() + own.max()))

    def _corners(self) -> Array:
        """Nominal places (N, 2) of the outline's points."""
        count, nominal = len(self._points), np.full((len(self._points), 2), np.nan)
        for side, value in zip(self._sides, self._values, strict=True):
            nominal[np.arange(side.first, side.last + 1) % count, side.axis] = value
        for side in self._sides:
            inner = np.arange(side.first, side.last + 1)
            along = 1 - side.axis
            ends = nominal[[side.first % count, side.last % count], along]
            own = self._points[inner % count, along].copy()
            own[[0, -1]] = ends
            steps = np.diff(own) * np.sign(ends[1] - ends[0])
            if (steps <= 0.0).any():
                way = np.linalg.norm(np.diff(self._points[inner % count], axis=0), axis=-1)
                own = ends[0] + (ends[1] - ends[0]) * np.concatenate(([0.0], np.cumsum(way))) / way.sum()
            nominal[inner % count, along] = own
        return nominal

    def _lines(self) -> tuple[Array, Array]:
        """Values of both directions that some line has."""
        least = NONE * float(np.ptp(self._points, axis=0).max())
        first, second = (np.unique(self._nominal[:, axis]) for axis in (0, 1))
        return tuple(v[np.concatenate(([True], np.diff(v) > least))] for v in (first, second))  # type: ignore[return-value]

    @property
    def _rim_ends(self) -> tuple[float, float]:
        """Nominal places of its first and last station along the rim."""
        first, last = self._nominal[[0, -1], 1 - self.rim_axis].tolist()
        return first, last

    def shares_of(self, values: Array) -> Array:
        """Where lines cross the rim, as shares of its length from the first station on."""
        first, last = self._rim_ends
        return np.asarray((values - first) / (last - first))

    def _station_values(self) -> Array:
        way = np.linalg.norm(np.diff(self._stations, axis=0), axis=-1)
        first, last = self._rim_ends
        return np.asarray(first + (last - first) * np.concatenate(([0.0], np.cumsum(way))) / way.sum())

    def _subdivide(self, breaks: Array, size: float, step: int) -> Array:
        """Lines between breaks, with cells of about a size, each of `step` spaces."""
        parts = [
            np.linspace(low, high, step * max(1, round((high - low) / size)) + 1)[:-1] for low, high in pairwise(breaks)
        ]
        return np.concatenate((*parts, breaks[-1:]))

    def grid(self, size: float, step: int) -> MeridianGrid:
        along, own = 1 - self.rim_axis, self._station_values()
        low, high = np.sort(self._rim_ends)
        breaks = self.breaks[along]
        pieces = [
            self._subdivide(np.union1d(breaks[side], end), size, step)
            for side, end in ((breaks <= low, low), (breaks >= high, high))
        ]
        rim = own if own[0] < own[-1] else own[::-1]
        lines = [np.empty(0), np.empty(0)]
        lines[along] = np.concatenate((pieces[0][:-1], rim, pieces[1][1:]))
        lines[self.rim_axis] = self._subdivide(self.breaks[self.rim_axis], size, step)
        number = np.clip(np.arange(len(lines[along])) - (len(pieces[0]) - 1), 0, len(rim) - 1)
        station = number if own[0] < own[-1] else len(rim) - 1 - number
        return self._fill((lines[0], lines[1]), station, step)

    def _fill(self, lines: tuple[Array, Array], station: Index, step: int) -> MeridianGrid:
        nominal = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1)
        centres = 0.25 * (nominal[1:, 1:] + nominal[1:, :-1] + nominal[:-1, 1:] + nominal[:-1, :-1])
        cells = contains(self._nominal, centres)
        moved, edges, on_rim = self._boundary(lines, cells, step)
        return MeridianGrid(_harmonic(nominal, moved, cells, lines), cells, edges, 1 - self.rim_axis, station, on_rim)

    def _boundary(
        self, lines: tuple[Array, Array], cells: NDArray[np.bool_], step: int
    ) -> tuple[Array, BoundaryEdges, Index]:
        """Places (A, B, 2) of the nodes on the outline, NaN elsewhere; its edges; the rim's nodes by station."""
        places = np.full((len(lines[0]), len(lines[1]), 2), np.nan)
        padded = np.pad(cells, 1)
        axes, firsts, names = list[Index](), list[Index](), list[str]()
        for k, name in enumerate(self._names[:-1]):
            nodes, shares = self._on_edge(lines, k)
            one, other = self._edge(k)
            places[nodes[:, 0], nodes[:, 1]] = one + shares[:, None] * (other - one)
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
        """Nodes (K, 2) on an edge, in the order of their lines, and their shares (K,) of it."""
        axis, start, end = self._directions[k], self._nominal[k], self._nominal[(k + 1) % len(self._points)]
        along = 1 - axis
        low, high = sorted(int(np.abs(lines[along] - v[along]).argmin()) for v in (start, end))
        nodes = np.empty((high - low + 1, 2), dtype=np.int64)
        nodes[:, axis] = np.abs(lines[axis] - start[axis]).argmin()
        nodes[:, along] = np.arange(low, high + 1)
        return nodes, (lines[along][low : high + 1] - start[along]) / (end[along] - start[along])


def _harmonic(nominal: Array, places: Array, cells: NDArray[np.bool_], lines: Sequence[Array]) -> Array:
    """All nodes (A, B, 2): on the outline at their `places` (A, B, 2), which are NaN elsewhere; inside nominal + displacement, this
    harmonic over the nominal cells."""
    from scipy.sparse import coo_array, diags_array
    from scipy.sparse.linalg import spsolve

    padded = np.pad(cells, 1).astype(float)
    used = (padded[1:, 1:] + padded[1:, :-1] + padded[:-1, 1:] + padded[:-1, :-1]) > 0.0
    inner = used & np.isnan(places[..., 0])
    moved = np.where(np.isnan(places), 0.0, places - nominal)
    if not inner.any():
        return np.asarray(nominal + moved)
    number, padded_widths = np.arange(used.size).reshape(used.shape), [np.pad(np.diff(line), 1) for line in lines]
    # conductance of an edge: half the widths of the cells beside it, over its length
    across = padded * padded_widths[1]
    first = 0.5 * (across[1:-1, 1:] + across[1:-1, :-1]) / np.diff(lines[0])[:, None]
    across = padded * padded_widths[0][:, None]
    second = 0.5 * (across[1:, 1:-1] + across[:-1, 1:-1]) / np.diff(lines[1])
    one = np.concatenate((number[:-1].ravel(), number[:, :-1].ravel()))
    other = np.concatenate((number[1:].ravel(), number[:, 1:].ravel()))
    weights = np.concatenate((first.ravel(), second.ravel()))
    joined = coo_array((weights, (one, other)), shape=(used.size,) * 2)
    joined = (joined + joined.T).tocsr()
    laplace = (diags_array(np.asarray(joined.sum(axis=1))) - joined).tocsc()
    free, flat = np.flatnonzero(inner), moved.reshape(-1, 2)
    known = np.flatnonzero(~inner.ravel())
    rows = laplace[free]
    flat[free] = spsolve(rows[:, free], -(rows[:, known] @ flat[known])).reshape(-1, 2)
    return np.asarray(nominal + flat.reshape(nominal.shape))
