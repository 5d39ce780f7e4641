"""New places on edges that follow from solved places: edges beyond which solutions lie, crossings, edges up which they rise."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import fields

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.pair import IS_TIP_CORNER, NUMBERED_EDGES, Pair
from gearmesh.records import dataclass

#: mark of an edge that is solved for from its crossing with edge k: ALONG_EDGE - k
ALONG_EDGE = -2
#: count of edges of both members
EDGE_COUNT = len(NUMBERED_EDGES)
#: largest absolute value of a mark
MAX_MARK = EDGE_COUNT - ALONG_EDGE


class TriedPlaces:
    """Places that were solved for, by position, first edge and mark."""

    def __init__(self) -> None:
        self._keys = np.zeros(0, dtype=np.intp)

    def add(self, position: NDArray[np.intp], edge: NDArray[np.intp], mark: NDArray[np.intp]) -> NDArray[np.intp]:
        """Add places (S,) and return the numbers of those that are new; of equal places the first is new."""
        keys = (position * (EDGE_COUNT + 2) + edge + 1) * (2 * MAX_MARK + 1) + mark + MAX_MARK
        new = np.sort(np.unique(keys, return_index=True)[1])
        new = new[~np.isin(keys[new], self._keys, assume_unique=True)]
        self._keys = np.concatenate((self._keys, keys[new]))
        return new


@dataclass(frozen=True)
class EdgePlaces:
    """New places (S,) on edges."""

    #: numbers (S,) of the solved places from which they follow
    origin: NDArray[np.intp]
    #: numbers (S, 2) of their edges, -1 for none
    edges: NDArray[np.intp]
    #: marks (S,) of places on the same first edge: the second edge, or the crossing they come from
    mark: NDArray[np.intp]
    #: True (S,) for places that begin at the start of the solved place, not at its solution
    from_start: NDArray[np.bool_]
    #: ranks (S,) among the places of one origin
    rank: NDArray[np.intp]

    @staticmethod
    def alone(
        origin: NDArray[np.intp],
        edge: NDArray[np.intp] | int,
        mark: NDArray[np.intp] | int,
        rank: NDArray[np.intp] | int,
    ) -> EdgePlaces:
        """Return places (S,) on one edge."""
        edge, mark, rank = (np.broadcast_to(value, origin.shape) for value in (edge, mark, rank))
        edges = np.stack((edge, np.full(origin.size, -1)), axis=-1)
        return EdgePlaces(origin, edges, mark, np.zeros(origin.size, dtype=bool), rank)

    @staticmethod
    def crossings(
        origin: NDArray[np.intp],
        edge: NDArray[np.intp],
        other: NDArray[np.intp] | int,
        rank: NDArray[np.intp] | int,
        *,
        from_start: bool,
    ) -> EdgePlaces:
        """Return places (S,) at crossings of two edges."""
        edges = np.stack((np.minimum(edge, other), np.maximum(edge, other)), axis=-1)
        rank = np.broadcast_to(rank, origin.shape)
        return EdgePlaces(origin, edges, edges[:, 1], np.full(origin.size, from_start), rank)

    @staticmethod
    def together(parts: Sequence[EdgePlaces]) -> EdgePlaces:
        """Return the places of all parts, one part after the other."""
        return EdgePlaces(
            *(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(parts[0]))
        )

    def by_origin(self) -> EdgePlaces:
        """Return the places in the order of their origins and ranks."""
        return self[np.lexsort((self.rank, self.origin))]

    def __getitem__(self, which: NDArray[np.intp]) -> EdgePlaces:
        """Return some of the places."""
        return EdgePlaces(*(getattr(self, field.name)[which] for field in fields(self)))


def places_upwards(rising: NDArray[np.intp], edges: NDArray[np.intp]) -> EdgePlaces:
    """Return the places to which the advance rises from solved places `rising` (R,) on edges.

    From an edge it goes inwards, and from a crossing along both edges. An edge may be solved for again from another place, because
    the advance may have several maxima along it. `edges` (C, 2) are those of all solved places.
    """
    on_edge, crossed = rising[edges[rising, 1] < 0], rising[edges[rising, 1] >= 0]
    two_ways = crossed[~IS_TIP_CORNER[edges[crossed, 1]]]
    return EdgePlaces.together(
        [
            EdgePlaces.alone(on_edge, -1, edges[on_edge, 0], 0),
            EdgePlaces.alone(crossed, edges[crossed, 0], ALONG_EDGE - edges[crossed, 1], 0),
            EdgePlaces.alone(two_ways, edges[two_ways, 1], ALONG_EDGE - edges[two_ways, 0], 1),
        ]
    ).by_origin()


def places_beyond(
    pair: Pair, failed: NDArray[np.intp], edges: NDArray[np.intp], outside: NDArray[np.bool_]
) -> EdgePlaces:
    """Return the edges, and crossings with their own edge, to which solved places `failed` (F,) lead that are no contacts.

    All solved places have `edges` (C, 2) and are `outside` (C, B) some edges. The tooth continues beyond a smooth end, so that a
    smooth end counts only for a place on another smooth end.
    """
    smooth, numbers = pair.smooth, np.arange(EDGE_COUNT)
    first, second = edges[failed].T
    over = outside[failed]
    row, edge = np.nonzero(over & (second < 0)[:, None] & ~smooth)
    parts = [EdgePlaces.alone(failed[row], edge, -1, edge)]

    own = np.flatnonzero((first >= 0) & (second < 0))
    counting = smooth[first[own], None] | ~smooth
    others = over[own] & counting
    # without a solution, or beyond none that counts, every other edge is tried
    others = np.where(others.any(axis=1, keepdims=True), others, np.isin(numbers, pair.edges) & counting)
    row, edge = np.nonzero(others & (numbers != first[own, None]))
    row = own[row]
    parts.append(EdgePlaces.crossings(failed[row], first[row], edge, EDGE_COUNT + edge, from_start=True))
    for k, (tip, corner) in enumerate(pair.tip_corners):
        row = own[first[own] == tip]
        parts.append(EdgePlaces.crossings(failed[row], first[row], corner, 2 * EDGE_COUNT + k, from_start=True))

    # from a crossing to the crossings of either edge with a third one
    own = np.flatnonzero((first >= 0) & (second >= 0) & ~IS_TIP_CORNER[second])
    row, edge = np.nonzero(over[own] & (numbers != first[own, None]) & (numbers != second[own, None]))
    row = own[row]
    for k, crossed in enumerate((first, second)):
        parts.append(EdgePlaces.crossings(failed[row], crossed[row], edge, 2 * edge + k, from_start=False))
    return EdgePlaces.together(parts).by_origin()
