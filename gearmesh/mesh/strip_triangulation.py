"""Strip triangulation between the lines of a link that run from toe to heel: the diagonals of each strip follow a level.

Two neighbouring lines of constant s, and the section curves at toe and heel between them, bound a strip. Its nodes are those of
the lines and, where toe and heel need more of them, nodes on these curves between the lines; none lies inside. Two chains
lead from one corner at the toe to one at the heel:

          heel   end
      +--o--o--+                             a: the left line, then the heel's nodes
    a |  \\     | b                           b: the toe's nodes, then the right line
      |    \\   |
      +--o--o--+                             (or the toe's nodes before the left line, the heel's after the right one)
    start   toe

A merge of both chains is a triangulation: every step along either is a triangle, every pair (a, b) between two steps a diagonal.
Merged by a level, diagonals join nodes of about the same level; swapping two steps of different chains then turns a diagonal. All
nodes lie on the edges of a rectangle of the (s, t) plane and no three of a triangle on one of them, so that every merge is
valid.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.cheapest_ways import NodePairs, cheapest, together

Index = NDArray[np.int64]
#: distance (M,), mm, of the middles of edges (M, 2) from the surface
Miss = Callable[[Index], Array]

#: left and right line, the nodes between them at toe and heel
Strip = tuple[Index, Index, Index, Index]
#: start, end, and the chains a and b between them, of a strip
Chains = tuple[int, int, tuple[Index, Index]]

#: a strip may start at the left corner of the toe or at the right one, and end at the right one of the heel or at the left one
CORNERS = ((True, True), (True, False), (False, True), (False, False))
#: gain (mm) from which on a diagonal is turned: below it is rounding
GAIN = 1e-12
#: rises of levels, in rows of nodes, that differ by less are equal but for rounding
LEVEL_ROUNDING = 1e-9


@dataclass(frozen=True)
class StripTriangulation:
    """All strips of a link, one after the other.

    `a`, `b`: nodes of both chains, without the corners `start` and `end` (S,) at which they meet; `first` (S, 2): where a strip's
    begin in them. `steps` (K,): True where the next node is one of a; `strip` (K,) whose step it is. `strips`: their borders.
    """

    a: Index
    b: Index
    start: Index
    end: Index
    first: Index
    steps: NDArray[np.bool_]
    strip: Index
    strips: tuple[Strip, ...]

    @staticmethod
    def of(
        lines: Sequence[Index], toe: Sequence[Index], heel: Sequence[Index], level: Array, miss: Miss
    ) -> StripTriangulation:
        """Lines of nodes from toe to heel (S + 1), and the nodes between them at toe and heel (S), by their `level` (N,)."""
        strips = list(zip(lines[:-1], lines[1:], toe, heel, strict=True))
        chains = [_chains(strip, *ends) for strip, ends in zip(strips, _corners(strips, level, miss), strict=True)]
        levels = [[np.maximum.accumulate(level[chain])[1:] for chain in pair] for *_, pair in chains]
        steps = [np.argsort(np.concatenate(pair), kind="stable") < len(pair[0]) for pair in levels]
        return StripTriangulation._join(strips, chains, steps)

    @staticmethod
    def _join(
        strips: Sequence[Strip], chains: Sequence[Chains], steps: Sequence[NDArray[np.bool_]]
    ) -> StripTriangulation:
        counts = np.array([[len(chain) for chain in pair] for *_, pair in chains])
        return StripTriangulation(
            np.concatenate([pair[0] for *_, pair in chains]),
            np.concatenate([pair[1] for *_, pair in chains]),
            np.array([start for start, _, _ in chains]),
            np.array([end for _, end, _ in chains]),
            np.cumsum(counts, axis=0) - counts,
            np.concatenate(steps),
            np.repeat(np.arange(len(steps)), [of.size for of in steps]),
            tuple(strips),
        )

    @property
    def _chains(self) -> list[Chains]:
        """Start, end, and the chains between them, of every strip."""
        a, b = (np.split(chain, first[1:]) for chain, first in zip((self.a, self.b), self.first.T, strict=True))
        return list(zip(self.start.tolist(), self.end.tolist(), zip(a, b, strict=True), strict=True))

    def diagonals(self) -> tuple[Index, Index]:
        """Places (S + K, 2) in a and b of all diagonals, those of a strip in order, and the strip of each."""
        strip = np.concatenate((np.arange(len(self.start)), self.strip))
        order = np.argsort(strip, kind="stable")
        moves = np.zeros((len(strip), 2), dtype=np.int64)
        moves[len(self.start) :, 0], moves[len(self.start) :, 1] = self.steps, ~self.steps
        places, strip = np.cumsum(moves[order], axis=0), strip[order]
        begins = np.searchsorted(strip, np.arange(len(self.start)))
        return places - (places[begins] - self.first)[strip], strip

    def triangles(self) -> tuple[Index, Index]:
        """Triangles (S + K + S, 3), counterclockwise in the (s, t) plane, and the strip of each, strips in order."""
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
        """The triangulation with diagonals turned where that brings them nearer to the surface, but for those between nodes that
        are `held` (N,) by the same number, 0 for none.

        Of neighbours the one that gains most. Doing so again until nothing gains saves no triangle on any kind of gear.
        """
        held = np.zeros(max(int(self.a.max()), int(self.b.max())) + 1) if held is None else held
        chosen, steps = self._gaining(miss, held), self.steps.copy()
        if not chosen.size:
            return self
        steps[chosen], steps[chosen + 1] = self.steps[chosen + 1], self.steps[chosen]
        return replace(self, steps=steps)

    def best(self, miss: Miss, t: Array, chosen: NDArray[np.bool_]) -> StripTriangulation:
        """The triangulation with the best corners, and the best diagonals between their chains, in the chosen strips (S,): the sum
        of the diagonals' misses, to the fourth power, is the least that there is; nodes are at `t` (N,).

        By dynamic programming over all pairs of nodes [Fuchs, Kedem & Uselton, Comm. ACM 20 (1977) 693], in long strips over those
        that are near; where they are too many the strip stays (`NodePairs`).
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
                chains[k], steps[k] = _chains(self.strips[k], *CORNERS[way]), taken
        return StripTriangulation._join(self.strips, chains, steps)

    def _gaining(self, miss: Miss, held: Array) -> Index:
        """Steps that better change places with the next one, no two of them neighbours."""
        at = np.flatnonzero((self.strip[1:] == self.strip[:-1]) & (self.steps[1:] != self.steps[:-1]))
        places, _ = self.diagonals()
        # the diagonal after step k is the one that it shares with step k + 1; a strip has one diagonal before its first step
        here = places[at + self.strip[at] + 1]
        other = here + np.where(self.steps[at], -1, 1)[:, None] * np.array([1, -1])
        gain = np.zeros(len(self.steps) + 1)
        both = [np.stack((self.a[diagonal[:, 0]], self.b[diagonal[:, 1]]), axis=1) for diagonal in (here, other)]
        first, second = held[both[0]].T
        gain[at] = np.where((first == second) & (first > 0.0), 0.0, miss(both[0]) - miss(both[1]))
        best = (gain > GAIN) & (gain > np.append(gain[1:], 0.0)) & (gain >= np.concatenate(([0.0], gain[:-1])))
        return np.flatnonzero(best)


def _corners(strips: Sequence[Strip], level: Array, miss: Miss) -> list[tuple[bool, bool]]:
    """For every strip whether it starts at the left corner of the toe, and whether it ends at the right one of the heel.

    Where levels rise across the strip both, where they fall neither; where they do neither as the nearer diagonals do.
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
    starts, ends = from_left <= from_right + GAIN, to_right <= to_left + GAIN
    corners = []
    for k, (left, right, *_) in enumerate(strips):
        rise = 0.5 * float(level[right[0]] + level[right[-1]] - level[left[0]] - level[left[-1]])
        row = float(level[left[-1]] - level[left[0]]) / (len(left) - 1)
        if abs(rise) >= (0.5 - LEVEL_ROUNDING) * row:
            corners.append((rise > 0.0, rise > 0.0))
        else:
            # a line of two nodes has none for a chain that starts and ends on it
            held = len(left if starts[k] else right) == 2
            corners.append((bool(starts[k]), bool(starts[k] if held else ends[k])))
    return corners


def _around(strip: Strip, t: Array, apart: float) -> tuple[tuple[Index, Index], NodePairs | None]:
    """The nodes of a strip at its toe, on its left line and at its heel, those at toe, on the right line and at heel, and the
    table of their pairs, in which chains of all CORNERS begin and end: from left, from right; to right, to left."""
    left, right, toe, heel = strip
    a, b = np.concatenate((toe[::-1], left, heel)), np.concatenate((toe, right, heel[::-1]))
    starts = [[toe.size + 1, 0], [0, toe.size + 1]]
    ends = [[a.size - 1, toe.size + right.size - 2], [toe.size + left.size - 2, b.size - 1]]
    return (a, b), NodePairs.of(t[a], t[b], apart, starts, ends)


def _chains(strip: Strip, from_left: bool, to_right: bool) -> Chains:
    """Start, end, and the chains a and b between them, of one strip."""
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
