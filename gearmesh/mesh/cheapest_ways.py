"""The cheapest ways through tables of pairs of nodes of two chains: from corner to corner, one step along either at a time.

The pair (i, j) is reached from (i - 1, j) or (i, j - 1), so that all pairs with the same sum i + j, an antidiagonal of the table,
follow from those of the sum before at once, and those of many tables beside each other:

         j ->                      only pairs in a band may be joined,
     i  0 1 2 .                    from low to high in every row
     |  1 2 3 .
     v  . 3 4 5                    the numbers are i + j
        . . 5 6
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array

Index = NDArray[np.int64]

#: pairs of nodes of a table up to which all of them are tried
PAIRS = 4_000
#: cells beyond the longest diagonal up to which they are tried in tables with more, and how many pairs these may be
CELLS, MOST_PAIRS = 4.0, 40_000
#: places of tables that are gone through at once, unless a single one has more
MOST_PLACES = 2_000_000


@dataclass(frozen=True)
class NodePairs:
    """Which nodes of one chain may be joined with each of the other (A,): from `low` up to `high` (A,), neither of which falls.

    A way begins at one of the two `starts` and stops at one of the two `ends` (2, 2), rows and columns, both of the same sum.
    On the antidiagonals between them, of sums from `begin` on (D,), pairs are in up to `width` rows from row `first` (D,) on.
    """

    low: Index
    high: Index
    starts: Index
    ends: Index
    first: Index
    width: int

    @staticmethod
    def of(
        t: Array, other: Array, apart: float, starts: Sequence[Sequence[int]], ends: Sequence[Sequence[int]]
    ) -> NodePairs | None:
        """Of nodes at t (A,) and (B,) along the strip, those up to `apart` and some cells from each other, of few nodes
        all of them; None where they are too many."""
        low, high = np.zeros(t.size, dtype=np.int64), np.full(t.size, other.size)
        if t.size * other.size > PAIRS:
            widest = max(float(np.diff(of, prepend=0.0, append=1.0).max()) for of in (t, other))
            low = np.searchsorted(other, t - apart - CELLS * widest)
            high = np.searchsorted(other, t + apart + CELLS * widest, side="right")
        if (high - low).sum() > MOST_PAIRS:
            return None
        rows, sums = np.arange(t.size), np.arange(sum(starts[0]), sum(ends[0]) + 1)
        first = np.searchsorted(high + rows, sums, side="right")
        beyond = np.searchsorted(low + rows, sums, side="right")
        return NodePairs(low, high, np.array(starts), np.array(ends), first, int((beyond - first).max()))

    @property
    def begin(self) -> int:
        return int(self.starts[0].sum())

    def places(self) -> tuple[Index, Index]:
        """Row and column (K,) of all pairs, row by row."""
        count = self.high - self.low
        return np.arange(count.size).repeat(count), np.arange(count.sum()) - (count.cumsum() - self.high).repeat(count)

    def pairs(self, a: Index, b: Index) -> Index:
        """The nodes of all pairs (K, 2), of chains a (A,) and b (B,)."""
        row, column = self.places()
        pairs = np.empty((row.size, 2), dtype=np.int64)
        pairs[:, 0], pairs[:, 1] = a[row], b[column]
        return pairs


def together(tables: Sequence[NodePairs]) -> Iterator[list[int]]:
    """The numbers of tables that `cheapest` takes at once, long ones beside long ones."""
    some, width = list[int](), 0
    for n in sorted(range(len(tables)), key=lambda n: -tables[n].first.size):
        wider = max(width, tables[n].width)
        if some and (len(some) + 1) * wider * tables[some[0]].first.size > MOST_PLACES:
            yield some
            some, wider = [], tables[n].width
        some, width = [*some, n], wider
    if some:
        yield some


def cheapest(costs: Array, tables: Sequence[NodePairs]) -> list[tuple[int, NDArray[np.bool_]]]:
    """Of each table of costs, all in one after the other and row by row (K,), the way with the least sum, 2 start + end,
    and its steps, True along the first chain."""
    every, sizes = np.arange(len(tables)), np.array([table.first.size for table in tables])
    last = sizes - 1
    sums = np.arange(sizes.max())
    first = np.stack([table.first[np.minimum(sums, table.first.size - 1)] for table in tables], axis=1)
    width = max(table.width for table in tables)
    # the place of a row on an antidiagonal is its distance from the first; beside all of them is no way
    least = np.full((sums.size, every.size, 2, width + 2), np.inf)
    places = [table.places() for table in tables]
    row, column = (np.concatenate(of) for of in zip(*places, strict=True))
    of = every.repeat([row.size for row, _ in places])
    at = row + column - np.array([table.begin for table in tables])[of]
    within = (at >= 0) & (at < sizes[of])
    row, of, at = row[within], of[within], at[within]
    least[at, of, :, 1 + row - first[at, of]] = costs[within, None]
    starts, ends = (np.stack(of) for of in zip(*((table.starts, table.ends) for table in tables), strict=True))
    begun = np.full(least.shape[1:], np.inf)
    for k in (0, 1):
        place = every, k, 1 + starts[:, k, 0] - first[0]
        begun[place] = least[0][place]
    least[0] = begun
    moved = np.diff(first, axis=0, prepend=0)[:, :, None, None] > 0
    from_row = np.empty((sums.size, every.size, 2, width), dtype=bool)
    for k in range(1, sums.size):
        before = np.where(moved[k], least[k - 1, ..., 1:], least[k - 1, ..., :-1])
        np.less_equal(before[..., :-1], before[..., 1:], out=from_row[k])
        least[k, ..., 1:-1] += np.minimum(before[..., :-1], before[..., 1:])
    # an end in a row beyond is one that no way leads to
    stop = np.clip(1 + ends[:, :, 0] - first[last, every][:, None], 0, width + 1)
    totals = least[last[:, None, None], every[:, None, None], np.arange(2)[:, None], stop[:, None, :]]
    way = totals.reshape(-1, 4).argmin(axis=1)
    row, steps = ends[every, way % 2, 0], np.zeros((sums.size, every.size), dtype=bool)
    for k in range(sums.size - 1, 0, -1):
        steps[k] = from_row[k, every, way // 2, row - first[k]] & (k < sizes)
        row = row - steps[k]
    return [(int(n), taken[1:size]) for n, taken, size in zip(way, steps.T, sizes.tolist(), strict=True)]
