"""Nodes on the lines of a link: every line has as many cells as its density asks for, and stations that must be nodes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.grid import on_grid

Index = NDArray[np.int64]

#: steps of a link's grid on which nodes are placed: last digits of curvatures, which differ between processors, do not move them
STEPS_PER_LINK = 2.0**30
#: parts of a cell that are rounding
ROUNDING = 0.02
#: cells that need not be as narrow are made wider by no more than that
WIDER = 0.8


def stations(along: Array, fixed: Array, staggered: NDArray[np.bool_]) -> tuple[Array, Index]:
    """Stations t (N,) of the nodes of all lines, one line after the other, and where (n + 1,) each begins in them.

    `along` (n, T): cells per unit of t at uniform t. `fixed`: stations inside (0, 1) that are nodes of every line;
    `staggered` (n,): lines with their nodes in the middles of the cells, and at the fixed stations.
    """
    ends = np.concatenate(([0.0], fixed, [1.0]))
    knots = np.linspace(0.0, 1.0, along.shape[1])
    knots = np.unique(np.concatenate((knots, fixed))) if fixed.size else knots
    density = _columns(along, knots)
    total = np.zeros_like(density)
    np.cumsum(0.5 * (density[:, 1:] + density[:, :-1]) * np.diff(knots), axis=1, out=total[:, 1:])
    begins = total[:, np.searchsorted(knots, ends)]
    span = np.diff(begins, axis=1)
    cells = np.maximum(1, np.ceil(span - ROUNDING)).astype(int)
    # of every part of a line the first node and those inside, and the end of the line as a part of one node
    shift = staggered[:, None] & (cells > 0)
    count = np.concatenate((cells + shift, np.ones((len(along), 1), dtype=int)), axis=1)
    sizes = count.ravel()
    owner = np.arange(sizes.size).repeat(sizes)
    place = np.arange(owner.size) - (sizes.cumsum() - sizes).repeat(sizes)
    line, part = np.divmod(owner, ends.size)
    inside = np.minimum(part, ends.size - 2)
    share = (place - 0.5 * (staggered[line] & (place > 0))) / cells[line, inside]
    value = begins[line, part] + span[line, inside] * share
    # one line after the other, so that all are one interpolation
    apart = total[:, -1].max() + 1.0
    whole = (total + apart * np.arange(len(total))[:, None]).ravel()
    t = np.interp(value + apart * line, whole, np.tile(knots, len(total)))
    t = on_grid(t, STEPS_PER_LINK)
    t[place == 0] = ends[part[place == 0]]
    return t, np.concatenate(([0], np.cumsum(count.sum(axis=1))))


def between(table: Array, x: Array, y: Array) -> Array:
    """Values (N, ...) of a table (X, Y, ...) of uniform samples at x, y (N,), linear between them."""
    count, rows = table.shape[:2]
    x, y = x * (count - 1), y * (rows - 1)
    i, j = np.minimum(x.astype(int), count - 2), np.minimum(y.astype(int), rows - 2)
    x, y = ((of - at).reshape(-1, *(1,) * (table.ndim - 2)) for of, at in ((x, i), (y, j)))
    # by one index, in half the time that two of them take
    of_all, at = table.reshape(count * rows, *table.shape[2:]), i * rows + j
    corners = [of_all.take(at + step, axis=0) for step in (0, rows, 1, rows + 1)]
    low, high = (first * (1.0 - x) + last * x for first, last in (corners[:2], corners[2:]))
    values: Array = low * (1.0 - y) + high * y
    return values


def rows(table: Array, x: Array) -> Array:
    """Rows (N, Y) of a table (X, Y) of uniform samples at x (N,), linear between them."""
    at = x * (len(table) - 1)
    low = np.minimum(at.astype(int), len(table) - 2)
    share = (at - low)[:, None]
    between_rows: Array = table[low] * (1.0 - share) + table[low + 1] * share
    return between_rows


def _columns(table: Array, y: Array) -> Array:
    return rows(table.T, y).T


def nodes(s: Array, per_unit: Array, seams: Array) -> Array:
    """Nodes from 0 to 1 with the given number of cells per unit of s (piecewise linear over s), some of them on the
    seams (K,).
    """
    total = integral(s, per_unit)
    ends = np.concatenate(([0.0], np.interp(seams, s, total), total[-1:]))
    parts = []
    for low, high, end in zip(ends[:-1], ends[1:], [*seams, 1.0], strict=True):
        count = max(1, int(np.ceil(high - low - ROUNDING)))
        parts.append(on_grid(np.interp(np.linspace(low, high, count + 1), total, s)[1:], STEPS_PER_LINK))
        parts[-1][-1] = end
    return np.concatenate(([0.0], *parts))


def denser(s: Array, cells: Array, tolerance: float, *, even: bool = False) -> tuple[Array, Array]:
    """Density over s that splits the cells which miss the tolerance and leaves the others as they are.

    `even`: or only makes the others wider, where that is enough.
    """
    width, missed = np.diff(s), cells > tolerance
    factor = np.where(missed, np.clip(1.03 * np.sqrt(cells / tolerance), 1.03, 2.0), 1.0)
    shifted = np.clip(1.02 * np.sqrt(cells / tolerance), WIDER, 2.0)
    if even and shifted.sum() <= factor.size:
        factor = shifted
    # they get all that makes the cells a whole number
    total = factor.sum()
    factor[missed] = np.minimum(factor[missed] + (np.ceil(total) - total) / missed.sum(), 2.0)
    # a step function: two samples for each cell, a hair inside its ends
    inside = np.stack((s[:-1] + 1e-9 * width, s[1:] - 1e-9 * width), axis=-1).ravel()
    per_unit = np.repeat(factor / width, 2)
    inside[0], inside[-1] = 0.0, 1.0
    return inside, per_unit


def integral(s: Array, per_unit: Array) -> Array:
    """Cells (S,) from the first of s (S,) on, of so many per unit of s (S,)."""
    cells: Array = np.concatenate(([0.0], np.cumsum(0.5 * (per_unit[1:] + per_unit[:-1]) * np.diff(s))))
    return cells
