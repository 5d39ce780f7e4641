"""Cheapest ways through tables of node pairs of two chains, from corner to corner, one step along either chain at a time.

The pair (i, j) is reached from (i - 1, j) or (i, j - 1). All pairs with the same sum i + j, an antidiagonal of the table,
follow at once from the pairs with the sum before. The antidiagonals of many tables are computed together:

         j ->                      only pairs in a band may be joined,
     i  0 1 2 .                    from low to high in every row
     |  1 2 3 .
     v  . 3 4 5                    the numbers are i + j
        . . 5 6
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass

Index = NDArray[np.int64]

#: largest table in which all pairs may be joined
MAX_PAIRS_WITHOUT_BAND = 4_000
#: half width of the band in larger tables, in cells beyond the longest diagonal
BAND_CELLS = 4.0
#: largest number of pairs in a band
MAX_BAND_PAIRS = 40_000
#: largest number of places of tables that are computed together; a single table may have more
MAX_PLACES_AT_ONCE = 2_000_000


@dataclass(frozen=True)
class NodePairs:
    """Pairs of nodes of two chains that may be joined."""

    #: first node (A,) of the second chain for each node of the first; it never falls
    low: Index
    #: node (A,) after the last one; it never falls
    high: Index
    #: row and column (2, 2) of the two possible starts, with equal sums
    starts: Index
    #: row and column (2, 2) of the two possible ends, with equal sums
    ends: Index
    #: first row (D,) of the band on each antidiagonal from the starts to the ends
    first: Index
    #: largest number of rows of the band on an antidiagonal
    width: int

    @staticmethod
    def of(
        t: Array, other: Array, apart: float, starts: Sequence[Sequence[int]], ends: Sequence[Sequence[int]]
    ) -> NodePairs | None:
        """Return the pairs of nodes at t (A,) and `other` (B,) along a strip; None if they are too many.

        In a large table, nodes may be `apart` plus some cells from each other; in a small one all pairs are allowed.
        """
        low, high = np.zeros(t.size, dtype=np.int64), np.full(t.size, other.size)
        if t.size * other.size > MAX_PAIRS_WITHOUT_BAND:
            widest = max(float(np.diff(nodes, prepend=0.0, append=1.0).max()) for nodes in (t, other))
            low = np.searchsorted(other, t - apart - BAND_CELLS * widest)
            high = np.searchsorted(other, t + apart + BAND_CELLS * widest, side="right")
        if (high - low).sum() > MAX_BAND_PAIRS:
            return None
        rows, sums = np.arange(t.size), np.arange(sum(starts[0]), sum(ends[0]) + 1)
        first = np.searchsorted(high + rows, sums, side="right")
        beyond = np.searchsorted(low + rows, sums, side="right")
        return NodePairs(low, high, np.array(starts), np.array(ends), first, int((beyond - first).max()))

    @property
    def begin(self) -> int:
        """Sum of row and column at the starts."""
        return int(self.starts[0].sum())

    def places(self) -> tuple[Index, Index]:
        """Return row and column (K,) of all pairs, row by row."""
        count = self.high - self.low
        return np.arange(count.size).repeat(count), np.arange(count.sum()) - (count.cumsum() - self.high).repeat(count)

    def pairs(self, a: Index, b: Index) -> Index:
        """Return the nodes (K, 2) of all pairs, for chains with nodes a (A,) and b (B,)."""
        row, column = self.places()
        pairs = np.empty((row.size, 2), dtype=np.int64)
        pairs[:, 0], pairs[:, 1] = a[row], b[column]
        return pairs


def together(tables: Sequence[NodePairs]) -> Iterator[list[int]]:
    """Yield the numbers of tables that `cheapest` computes together, long tables with long ones."""
    some, width = list[int](), 0
    for n in sorted(range(len(tables)), key=lambda n: -tables[n].first.size):
        wider = max(width, tables[n].width)
        if some and (len(some) + 1) * wider * tables[some[0]].first.size > MAX_PLACES_AT_ONCE:
            yield some
            some, wider = [], tables[n].width
        some, width = [*some, n], wider
    if some:
        yield some


def cheapest(costs: Array, tables: Sequence[NodePairs]) -> list[tuple[int, NDArray[np.bool_]]]:
    """Return the cheapest way through each table: the number 2 start + end, and the steps, True along the first chain.

    `costs` (K,): costs of the pairs of all tables, table by table, row by row.
    """
    every, sizes = np.arange(len(tables)), np.array([table.first.size for table in tables])
    last = sizes - 1
    sums = np.arange(sizes.max())
    first = np.stack([table.first[np.minimum(sums, table.first.size - 1)] for table in tables], axis=1)
    width = max(table.width for table in tables)
    # least sums by antidiagonal, table, start and place; the place of a row is its distance from the first row of the band;
    # the outer two places are never reached
    least = np.full((sums.size, every.size, 2, width + 2), np.inf)
    places = [table.places() for table in tables]
    row, column = (np.concatenate(parts) for parts in zip(*places, strict=True))
    owner = every.repeat([row.size for row, _ in places])
    at = row + column - np.array([table.begin for table in tables])[owner]
    within = (at >= 0) & (at < sizes[owner])
    row, owner, at = row[within], owner[within], at[within]
    least[at, owner, :, 1 + row - first[at, owner]] = costs[within, None]
    starts, ends = (np.stack(pairs) for pairs in zip(*((table.starts, table.ends) for table in tables), strict=True))
    begun = np.full(least.shape[1:], np.inf)
    for k in (0, 1):
        place = every, k, 1 + starts[:, k, 0] - first[0]
        begun[place] = least[0][place]
    least[0] = begun
    moved = np.diff(first, axis=0, prepend=0)[:, :, None, None] > 0
    from_row = np.empty((sums.size, every.size, 2, width), dtype=bool)
    # forward: the least sum of each pair, and the neighbour that it comes from
    for k in range(1, sums.size):
        before = np.where(moved[k], least[k - 1, ..., 1:], least[k - 1, ..., :-1])
        np.less_equal(before[..., :-1], before[..., 1:], out=from_row[k])
        least[k, ..., 1:-1] += np.minimum(before[..., :-1], before[..., 1:])
    # no way leads to an end in a row beyond the band
    stop = np.clip(1 + ends[:, :, 0] - first[last, every][:, None], 0, width + 1)
    totals = least[last[:, None, None], every[:, None, None], np.arange(2)[:, None], stop[:, None, :]]
    way = totals.reshape(-1, 4).argmin(axis=1)
    row, steps = ends[every, way % 2, 0], np.zeros((sums.size, every.size), dtype=bool)
    # backward: the steps of the cheapest way
    for k in range(sums.size - 1, 0, -1):
        steps[k] = from_row[k, every, way // 2, row - first[k]] & (k < sizes)
        row = row - steps[k]
    return [(int(n), taken[1:size]) for n, taken, size in zip(way, steps.T, sizes.tolist(), strict=True)]
