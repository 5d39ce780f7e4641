"""Triangulation of the strips between the lines of a link from toe to heel; the diagonals of each strip follow a level.

A strip lies between two neighbouring lines of constant s and the section curves at toe and heel. Its nodes are on the lines
and, where needed, on the section curves between the lines; none lies inside. Two chains lead from a corner at the toe to a
corner at the heel:

          heel   end
      +--o--o--+                             a: the left line, then the heel's nodes
    a |  \\     | b                           b: the toe's nodes, then the right line
      |    \\   |
      +--o--o--+                             (or the toe's nodes before the left line, the heel's after the right one)
    start   toe

A merge of both chains is a triangulation: each step along a chain is a triangle, each pair (a, b) between two steps is a
diagonal. In a merge by level, diagonals join nodes of about the same level. Exchanging two steps of different chains turns a
diagonal. All nodes lie on the edges of a rectangle in the (s, t) plane, and the corners of a triangle never on a single
edge, so every merge is valid.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.cheapest_ways import NodePairs, cheapest, together
from gearmesh.records import dataclass

Index = NDArray[np.int64]
#: function that returns the distances (M,), mm, of the middles of edges (M, 2) from the surface
Miss = Callable[[Index], Array]

#: nodes of a strip: left line, right line, and the nodes between them at toe and heel
Strip = tuple[Index, Index, Index, Index]
#: start, end, and the chains a and b between them
Chains = tuple[int, int, tuple[Index, Index]]

#: possible ends of chains: True, True for a start at the left corner of the toe and an end at the right corner of the heel
END_CORNERS = ((True, True), (True, False), (False, True), (False, False))
#: least gain for which a diagonal turns; less is rounding
MIN_GAIN_MM = 1e-12
#: largest difference, in rows of nodes, of rises of levels that counts as rounding
LEVEL_ROUNDING = 1e-9


@dataclass(frozen=True)
class StripTriangulation:
    """Triangulation of all S strips of a link."""

    #: nodes of the chains a, strip by strip, without the corners at which both chains meet
    a: Index
    #: nodes of the chains b
    b: Index
    #: corner (S,) at which the chains of a strip start
    start: Index
    #: corner (S,) at which they end
    end: Index
    #: index (S, 2) in `a` and `b` at which the chains of a strip begin
    first: Index
    #: steps (K,): True along a, False along b
    steps: NDArray[np.bool_]
    #: strip (K,) of each step
    strip: Index
    #: nodes on the borders of the strips
    strips: tuple[Strip, ...]

    @staticmethod
    def of(
        lines: Sequence[Index], toe: Sequence[Index], heel: Sequence[Index], level: Array, miss: Miss
    ) -> StripTriangulation:
        """Return the triangulation by level.

        - lines: nodes of the S + 1 lines, from toe to heel.
        - toe, heel: nodes of the S strips at toe and heel, between the lines.
        - level: level (N,) of all nodes.
        - miss: distances of edges from the surface.
        """
        strips = list(zip(lines[:-1], lines[1:], toe, heel, strict=True))
        chains = [_chains(strip, *ends) for strip, ends in zip(strips, _corners(strips, level, miss), strict=True)]
        levels = [[np.maximum.accumulate(level[chain])[1:] for chain in pair] for *_, pair in chains]
        steps = [np.argsort(np.concatenate(pair), kind="stable") < len(pair[0]) for pair in levels]
        return StripTriangulation._join(strips, chains, steps)

    @staticmethod
    def _join(
        strips: Sequence[Strip], chains: Sequence[Chains], steps: Sequence[NDArray[np.bool_]]
    ) -> StripTriangulation:
        """Return the triangulation of strips by their chains and steps."""
        counts = np.array([[len(chain) for chain in pair] for *_, pair in chains])
        return StripTriangulation(
            np.concatenate([pair[0] for *_, pair in chains]),
            np.concatenate([pair[1] for *_, pair in chains]),
            np.array([start for start, _, _ in chains]),
            np.array([end for _, end, _ in chains]),
            np.cumsum(counts, axis=0) - counts,
            np.concatenate(steps),
            np.repeat(np.arange(len(steps)), [part.size for part in steps]),
            tuple(strips),
        )

    @property
    def _chains(self) -> list[Chains]:
        """Start, end and chains of each strip."""
        a, b = (np.split(chain, first[1:]) for chain, first in zip((self.a, self.b), self.first.T, strict=True))
        return list(zip(self.start.tolist(), self.end.tolist(), zip(a, b, strict=True), strict=True))

    def diagonals(self) -> tuple[Index, Index]:
        """Return the places (S + K, 2) in a and b of all diagonals, strip by strip in order, and the strip of each."""
        strip = np.concatenate((np.arange(len(self.start)), self.strip))
        order = np.argsort(strip, kind="stable")
        moves = np.zeros((len(strip), 2), dtype=np.int64)
        moves[len(self.start) :, 0], moves[len(self.start) :, 1] = self.steps, ~self.steps
        places, strip = np.cumsum(moves[order], axis=0), strip[order]
        begins = np.searchsorted(strip, np.arange(len(self.start)))
        return places - (places[begins] - self.first)[strip], strip

    def triangles(self) -> tuple[Index, Index]:
        """Return the triangles (S + K + S, 3), counterclockwise in the (s, t) plane, strip by strip, and the strip of each."""
        places, strip = self.diagonals()
        a, b = self.a[places[:, 0]], self.b[places[:, 1]]
        inner = strip[1:] == strip[:-1]
        following = np.where(places[1:, 0] > places[:-1, 0], a[1:], b[1:])
        begins = np.concatenate(([True], ~inner))
        ends = np.concatenate((~inner, [True]))
        made = np.concatenate(
            (
                np.stack((self.start, b[begins], a[begins]), axis=1),
                np.stack((a[:-1], b[:-1], following), axis=1)[inner],
                np.stack((a[ends], b[ends], self.end), axis=1),
            )
        )
        every = np.arange(len(self.start))
        owner = np.concatenate((every, strip[1:][inner], every))
        order = np.argsort(owner, kind="stable")
        return made[order], owner[order]

    def flip(self, miss: Miss, held: Array | None = None) -> StripTriangulation:
        """Return the triangulation with diagonals turned that come closer to the surface.

        Of neighbouring diagonals the one with the largest gain turns. Diagonals between nodes with the same `held` (N,) number
        above 0 stay.
        """
        held = np.zeros(max(int(self.a.max()), int(self.b.max())) + 1) if held is None else held
        chosen, steps = self._gaining(miss, held), self.steps.copy()
        if not chosen.size:
            return self
        steps[chosen], steps[chosen + 1] = self.steps[chosen + 1], self.steps[chosen]
        return replace(self, steps=steps)

    def best(self, miss: Miss, t: Array, chosen: NDArray[np.bool_]) -> StripTriangulation:
        """Return the triangulation with the best corners and diagonals in the `chosen` (S,) strips.

        The sum of the fourth powers of the diagonals' distances from the surface becomes least, by dynamic programming over all
        pairs of nodes [Fuchs, Kedem & Uselton, Comm. ACM 20 (1977) 693]. In long strips only pairs of near nodes are tried; a
        strip with too many pairs stays (see `NodePairs`). `t` (N,): stations of the nodes.
        """
        steps, chains = np.split(self.steps, np.searchsorted(self.strip, np.arange(1, len(self.start)))), self._chains
        places, strip = self.diagonals()
        apart = np.zeros(len(self.start))
        np.maximum.at(apart, strip, np.abs(t[self.a[places[:, 0]]] - t[self.b[places[:, 1]]]))
        tables = [(k, *_around(self.strips[k], t, apart[k])) for k in np.flatnonzero(chosen).tolist()]
        tried = [(k, pair, table) for k, pair, table in tables if table is not None]
        for some in together([table for *_, table in tried]):
            begun = [tried[n] for n in some]
            costs = miss(np.concatenate([table.pairs(*pair) for _, pair, table in begun])) ** 4
            ways = cheapest(costs, [table for *_, table in begun])
            for (k, _, _), (way, taken) in zip(begun, ways, strict=True):
                chains[k], steps[k] = _chains(self.strips[k], *END_CORNERS[way]), taken
        return StripTriangulation._join(self.strips, chains, steps)

    def _gaining(self, miss: Miss, held: Array) -> Index:
        """Return the steps to exchange with the next step, no two of them neighbours."""
        at = np.flatnonzero((self.strip[1:] == self.strip[:-1]) & (self.steps[1:] != self.steps[:-1]))
        places, _ = self.diagonals()
        # the diagonal between steps k and k + 1; each strip also has a diagonal before its first step
        here = places[at + self.strip[at] + 1]
        other = here + np.where(self.steps[at], -1, 1)[:, None] * np.array([1, -1])
        gain = np.zeros(len(self.steps) + 1)
        both = [np.stack((self.a[diagonal[:, 0]], self.b[diagonal[:, 1]]), axis=1) for diagonal in (here, other)]
        first, second = held[both[0]].T
        gain[at] = np.where((first == second) & (first > 0.0), 0.0, miss(both[0]) - miss(both[1]))
        best = (gain > MIN_GAIN_MM) & (gain > np.append(gain[1:], 0.0)) & (gain >= np.concatenate(([0.0], gain[:-1])))
        return np.flatnonzero(best)


def _corners(strips: Sequence[Strip], level: Array, miss: Miss) -> list[tuple[bool, bool]]:
    """Return, for each strip, True for a start at the left corner of the toe, and True for an end at the right corner of the heel.

    Both are True if levels rise across the strip, both False if they fall. If they hardly change, the diagonals closer to the
    surface decide.
    """
    diagonals = [
        (
            (left[1], toe[0] if toe.size else right[0]),
            (toe[-1] if toe.size else left[0], right[1]),
            (heel[-1] if heel.size else left[-1], right[-2]),
            (left[-2], heel[0] if heel.size else right[-1]),
        )
        for left, right, toe, heel in strips
    ]
    from_left, from_right, to_right, to_left = miss(np.array(diagonals).reshape(-1, 2)).reshape(-1, 4).T
    starts, ends = from_left <= from_right + MIN_GAIN_MM, to_right <= to_left + MIN_GAIN_MM
    corners = []
    for k, (left, right, *_) in enumerate(strips):
        rise = 0.5 * float(level[right[0]] + level[right[-1]] - level[left[0]] - level[left[-1]])
        row = float(level[left[-1]] - level[left[0]]) / (len(left) - 1)
        if abs(rise) >= (0.5 - LEVEL_ROUNDING) * row:
            corners.append((rise > 0.0, rise > 0.0))
        else:
            # a chain cannot start and end on a line of two nodes
            held = len(left if starts[k] else right) == 2
            corners.append((bool(starts[k]), bool(starts[k] if held else ends[k])))
    return corners


def _around(strip: Strip, t: Array, apart: float) -> tuple[tuple[Index, Index], NodePairs | None]:
    """Return the nodes of both sides of a strip, and the table of their pairs for chains of all END_CORNERS.

    The first side has the nodes at the toe, on the left line and at the heel. The second side has the nodes at the toe,
    on the right line and at the heel. `apart`: distance along t up to which nodes may be joined.
    """
    left, right, toe, heel = strip
    a, b = np.concatenate((toe[::-1], left, heel)), np.concatenate((toe, right, heel[::-1]))
    starts = [[toe.size + 1, 0], [0, toe.size + 1]]
    ends = [[a.size - 1, toe.size + right.size - 2], [toe.size + left.size - 2, b.size - 1]]
    return (a, b), NodePairs.of(t[a], t[b], apart, starts, ends)


def _chains(strip: Strip, from_left: bool, to_right: bool) -> Chains:
    """Return start, end and chains of a strip with given corners."""
    left, right, toe, heel = strip
    if from_left:
        start, a, b = left[0], left[1:], np.concatenate((toe, right))
    else:
        start, a, b = right[0], np.concatenate((toe[::-1], left)), right[1:]
    if to_right:
        end, a, b = right[-1], np.concatenate((a, heel)), b[:-1]
    else:
        end, a, b = left[-1], a[:-1], np.concatenate((b, heel[::-1]))
    return int(start), int(end), (a, b)
