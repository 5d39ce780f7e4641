"""Condensation of a stiff body: a Cholesky factor front by front, in an order that halves the body again and again.

Unknowns are eliminated in columns of nodes, which run from toe to heel. A part of the body is divided by a separator of
as few columns as possible; the part's own halves are divided in the same way [G73]. A separator is eliminated after both
halves. Each set of columns that is eliminated at once is a front [DR83]. It has the stiffness of its own unknowns (o)
and of those that they are coupled to later (b), and the loads F on both:

    L L^T = K_oo    W = K_bo L^-T    Y = L^-1 F_o    K_bb <- K_bb - W W^T    F_b <- F_b - W Y

What is left of b is added to the front that eliminates it. Sums of Y^T Y over the fronts are the responses F^T K^-1 F.
Retained unknowns are never eliminated: their stiffness and loads are those of the condensed body.

Sources: [G73] A. George, SIAM J. Numer. Anal. 10 (1973) 345. [DR83] I. S. Duff, J. K. Reid, ACM Trans. Math. Softw. 9
(1983) 302.
"""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import NoSolutionError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.progress import go_on
from gearmesh.records import dataclass

if TYPE_CHECKING:
    from scipy.sparse import csr_array

Index = NDArray[np.int64]

#: largest number of columns of a part that is not divided: smaller fronts take longer to call than to solve
UNDIVIDED_COLUMNS = 8
#: share of a part's columns that a half has at least
LEAST_HALF_SHARE = 0.35


def condensed(
    stiffness: csr_array, column: Index, retained: Index, loads: csr_array, pressed: int
) -> tuple[Array, Array, Array]:
    """Condense a body to its R retained unknowns.

    - `stiffness` (N, N): K of all unknowns.
    - `column` (N,): number of the column to which an unknown belongs; -1 for unknowns that are held or retained.
    - `retained` (R,): numbers of the retained unknowns.
    - `loads` (N, M): F on all unknowns.
    - `pressed`: number P of the loads, the first ones, to which responses are wanted.

    Returns stiffness (R, R) and loads (R, M) on the retained unknowns, and responses F^T K^-1 F (M, P) with these held.
    Raises NoSolutionError if elements are turned inside out.
    """
    from scipy.linalg.blas import dgemm, dsyrk, dtrsm
    from scipy.linalg.lapack import dpotrf

    free = np.flatnonzero(column >= 0)
    group = np.unique(column[free], return_inverse=True)[1]
    fronts = _fronts(_coupled(stiffness, free, group))
    # unknowns in the order of elimination, then the retained ones; loads in the order of the fronts where they begin
    front_of = np.empty(group.max(initial=-1) + 1, dtype=np.int64)
    for number, front in enumerate(fronts):
        front_of[front.columns] = number
    of_front = np.lexsort((column[free], front_of[group]))
    order = np.concatenate((free[of_front], retained))
    ends = np.searchsorted(front_of[group][of_front], np.arange(len(fronts)), side="right").tolist()
    matrix, forces = stiffness.tocsr()[order][:, order], loads.tocsr()[order]
    begin = np.full(loads.shape[1], len(order))
    by_row = forces.tocoo()
    np.minimum.at(begin, by_row.col, by_row.row)
    load_order = np.argsort(begin, kind="stable")
    forces = forces[:, load_order].tocsr()
    responses, start = np.zeros((loads.shape[1], pressed)), 0
    left_over: dict[int, _LeftOver] = {}
    for number, (front, end) in enumerate(zip(fronts, ends, strict=True)):
        go_on()
        part = _Front.gathered(matrix, forces, start, end, [left_over.pop(half) for half in front.halves])
        factor, failed = dpotrf(part.own, lower=1, overwrite_a=1, clean=0)
        if failed:
            reason = "the finite elements of a tooth are turned inside out: no compliance follows from them"
            raise NoSolutionError(reason=reason, remedy="fe shows them in a picture")
        solved = dtrsm(1.0, factor, part.own_loads, lower=1, overwrite_b=1)
        later, later_loads = part.later, part.later_loads
        if later.size:
            coupling = dtrsm(1.0, factor, part.coupling, side=1, lower=1, trans_a=1, overwrite_b=1)
            later = dsyrk(-1.0, coupling, beta=1.0, c=later, lower=1, overwrite_c=1)
            if later_loads.size:
                later_loads = dgemm(-1.0, coupling, solved, beta=1.0, c=later_loads, overwrite_c=1)
        left_over[number] = _LeftOver(part.others, later, part.loaded, later_loads)
        loaded = load_order[part.loaded]
        pressing = np.flatnonzero(loaded < pressed)
        if pressing.size:
            responses[np.ix_(loaded, loaded[pressing])] += solved.T @ solved[:, pressing]
        start = end
    # what is left of the retained unknowns
    last = _Front.gathered(matrix, forces, start, len(order), list(left_over.values()))
    kept, on_kept = last.own, np.zeros((len(retained), loads.shape[1]))
    kept = np.tril(kept) + np.tril(kept, -1).T
    on_kept[:, load_order[last.loaded]] = last.own_loads
    return kept, on_kept, responses


@dataclass(frozen=True)
class _Columns:
    """Columns that are eliminated at once, and the numbers of the fronts that are eliminated before and lead to it."""

    columns: Index
    halves: list[int]


@dataclass(frozen=True)
class _LeftOver:
    """Remainder of a front, for those after it; unknowns and loads are counted in their new orders."""

    #: unknowns (b,) that remain
    unknowns: Index
    #: their stiffness (b, b), the lower half
    stiffness: Array
    #: loads (m,) that have begun
    loaded: Index
    #: forces (b, m) of these
    forces: Array


@dataclass(frozen=True)
class _Front:
    """Stiffness and loads of unknowns `start` .. `end` that are eliminated at once, and of the others that they are
    coupled to; matrices are in Fortran's order, and of symmetric ones the lower half is set."""

    #: unknowns (b,) that remain
    others: Index
    #: loads (m,) that have begun
    loaded: Index
    #: stiffness (o, o) of the own unknowns
    own: Array
    #: stiffness (b, o) of the others to the own ones
    coupling: Array
    #: stiffness (b, b) of the others
    later: Array
    #: forces (o, m) on the own unknowns
    own_loads: Array
    #: forces (b, m) on the others
    later_loads: Array

    @staticmethod
    def gathered(matrix: csr_array, forces: csr_array, start: int, end: int, halves: list[_LeftOver]) -> _Front:
        """Return the front of unknowns `start` .. `end` with what is left over of those before it."""
        rows, own_forces = matrix[start:end], forces[start:end]
        met = np.unique(np.concatenate([rows.indices, *(half.unknowns for half in halves)]))
        others = met[met >= end]
        loaded = np.unique(np.concatenate([own_forces.indices, *(half.loaded for half in halves)])).astype(np.int64)
        size, rest = end - start, len(others)
        front = _Front(
            others,
            loaded,
            np.zeros((size, size), order="F"),
            np.zeros((rest, size), order="F"),
            np.zeros((rest, rest), order="F"),
            np.zeros((size, len(loaded)), order="F"),
            np.zeros((rest, len(loaded)), order="F"),
        )
        row = np.repeat(np.arange(size), np.diff(rows.indptr))
        own, other = (rows.indices >= start) & (rows.indices < end), rows.indices >= end
        front.own[row[own], rows.indices[own] - start] = rows.data[own]
        front.coupling[np.searchsorted(others, rows.indices[other]), row[other]] = rows.data[other]
        row = np.repeat(np.arange(size), np.diff(own_forces.indptr))
        front.own_loads[row, np.searchsorted(loaded, own_forces.indices)] = own_forces.data
        for half in halves:
            front._add(half, start, end)
        return front

    def _add(self, half: _LeftOver, start: int, end: int) -> None:
        """Add what a half has left over."""
        count = int(np.searchsorted(half.unknowns, end))
        mine, theirs = (
            _runs(half.unknowns[:count] - start, 0),
            _runs(np.searchsorted(self.others, half.unknowns[count:]), count),
        )
        loads = _runs(np.searchsorted(self.loaded, half.loaded), 0)
        for whole, parts, forces in ((self.own, mine, self.own_loads), (self.later, theirs, self.later_loads)):
            for k, (to, source) in enumerate(parts):
                for across, source_across in parts[: k + 1]:
                    whole[to, across] += half.stiffness[source, source_across]
                for across, source_across in loads:
                    forces[to, across] += half.forces[source, source_across]
        for to, source in theirs:
            for across, source_across in mine:
                self.coupling[to, across] += half.stiffness[source, source_across]


def _runs(places: Index, first: int) -> list[tuple[slice, slice]]:
    """Return runs of consecutive places (n,), and the runs of their numbers, counted from `first` on."""
    breaks = [0, *(np.flatnonzero(np.diff(places) != 1) + 1).tolist(), len(places)]
    return [
        (slice(int(places[i]), int(places[i]) + j - i), slice(first + i, first + j))
        for i, j in pairwise(breaks)
        if j > i
    ]


def _coupled(stiffness: csr_array, free: Index, group: Index) -> NDArray[np.bool_]:
    """Return which of G columns are coupled, (G, G), from the columns `group` (n,) of the free unknowns (n,)."""
    number = np.full(stiffness.shape[0], -1)
    number[free] = group
    row, column = np.repeat(number, np.diff(stiffness.indptr)), number[stiffness.indices]
    both = (row >= 0) & (column >= 0)
    count = group.max(initial=-1) + 1
    coupled = np.zeros((count, count), dtype=np.bool_)
    coupled[row[both], column[both]] = True
    return coupled


def _fronts(coupled: NDArray[np.bool_]) -> list[_Columns]:
    """Return the fronts of G columns, coupled as `coupled` (G, G) says, in the order of their elimination."""
    fronts: list[_Columns] = []

    def divide(columns: Index) -> list[int]:
        """Append the fronts of some columns; return the numbers of those that are eliminated last."""
        separator, halves = columns, []
        if len(columns) > UNDIVIDED_COLUMNS:
            separator, first, second = _divided(coupled, columns)
            halves = [number for half in (first, second) if half.size for number in divide(half)]
            if not separator.size:
                return halves
        fronts.append(_Columns(separator, halves))
        return [len(fronts) - 1]

    if len(coupled):
        divide(np.arange(len(coupled)))
    return fronts


def _divided(coupled: NDArray[np.bool_], columns: Index) -> tuple[Index, Index, Index]:
    """Divide columns (n,) by a small separator: return the separator and both halves.

    Columns are sorted by the slowest vibration of a net of equal springs between coupled columns, which has one sense in
    each half. Of all places to divide the sorted columns, the one with the fewest columns next to the other half is
    taken.
    """
    from scipy.linalg import eigh

    springs = coupled[np.ix_(columns, columns)].astype(float)
    np.fill_diagonal(springs, 0.0)
    net = np.diag(springs.sum(axis=1)) - springs
    mode = eigh(net, subset_by_index=(1, 1))[1][:, 0]
    ordered = columns[np.argsort(mode, kind="stable")]
    count, best = len(columns), (np.inf, np.inf)
    least = int(np.ceil(LEAST_HALF_SHARE * count))
    separator = first = second = columns
    for place in range(least, count - least + 1):
        low, high = ordered[:place], ordered[place:]
        across = coupled[np.ix_(low, high)]
        beside = low[across.any(axis=1)], high[across.any(axis=0)]
        in_low = len(beside[0]) <= len(beside[1])
        score = (len(beside[0] if in_low else beside[1]), abs(2 * place - count))
        if score < best:
            best, separator = score, beside[0] if in_low else beside[1]
            first, second = (np.setdiff1d(half, separator) for half in (low, high))
    return separator, first, second
