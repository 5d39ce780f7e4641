"""Nodes on the lines of a link: the number of cells of a line follows from its density; some stations must be nodes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, distinct
from gearmesh.kernel.numeric.grid import on_grid

Index = NDArray[np.int64]

#: grid of the nodes' coordinates: the last digits of curvatures, which differ between processors, do not move nodes
STEPS_PER_LINK = 2.0**30
#: part of a cell that counts as rounding when cells are counted
CELL_ROUNDING_SHARE = 0.02
#: least factor of the density where cells may become wider
MIN_DENSITY_FACTOR = 0.8


def stations(along: Array, fixed: Array, staggered: NDArray[np.bool_]) -> tuple[Array, Index]:
    """Return the stations t (N,) of the nodes of n lines, line by line, and the index (n + 1,) at which each line begins.

    - along: cells per unit of t (n, T), at T uniform stations.
    - fixed: stations inside (0, 1) that are nodes of every line.
    - staggered: True (n,) for lines with nodes in the middles of the cells (and at fixed stations).
    """
    ends = np.concatenate(([0.0], fixed, [1.0]))
    knots = np.linspace(0.0, 1.0, along.shape[1])
    knots = distinct(np.concatenate((knots, fixed))) if fixed.size else knots
    # cells of each part between fixed stations: the integral of the density, rounded up
    density = _columns(along, knots)
    total = np.zeros_like(density)
    np.cumsum(0.5 * (density[:, 1:] + density[:, :-1]) * np.diff(knots), axis=1, out=total[:, 1:])
    begins = total[:, np.searchsorted(knots, ends)]
    span = np.diff(begins, axis=1)
    cells = np.maximum(1, np.ceil(span - CELL_ROUNDING_SHARE)).astype(int)
    # nodes of each part of a line: its first node and its inner nodes; the end of the line is a part of one node
    shift = staggered[:, None] & (cells > 0)
    count = np.concatenate((cells + shift, np.ones((len(along), 1), dtype=int)), axis=1)
    sizes = count.ravel()
    owner = np.arange(sizes.size).repeat(sizes)
    place = np.arange(owner.size) - (sizes.cumsum() - sizes).repeat(sizes)
    line, part = np.divmod(owner, ends.size)
    inside = np.minimum(part, ends.size - 2)
    share = (place - 0.5 * (staggered[line] & (place > 0))) / cells[line, inside]
    value = begins[line, part] + span[line, inside] * share
    # all lines in one interpolation: the integrals of the lines are shifted so that they do not overlap
    apart = total[:, -1].max() + 1.0
    whole = (total + apart * np.arange(len(total))[:, None]).ravel()
    t = np.interp(value + apart * line, whole, np.tile(knots, len(total)))
    t = on_grid(t, STEPS_PER_LINK)
    t[place == 0] = ends[part[place == 0]]
    return t, np.concatenate(([0], np.cumsum(count.sum(axis=1))))


def between(table: Array, x: Array, y: Array) -> Array:
    """Return the values (N, ...) of a table (X, Y, ...) of uniform samples at x, y (N,), by bilinear interpolation."""
    count, rows = table.shape[:2]
    x, y = x * (count - 1), y * (rows - 1)
    i, j = np.minimum(x.astype(int), count - 2), np.minimum(y.astype(int), rows - 2)
    x, y = ((value - cell).reshape(-1, *(1,) * (table.ndim - 2)) for value, cell in ((x, i), (y, j)))
    # a single index takes half the time of two
    flat_table, at = table.reshape(count * rows, *table.shape[2:]), i * rows + j
    corners = [flat_table.take(at + step, axis=0) for step in (0, rows, 1, rows + 1)]
    low, high = (first * (1.0 - x) + last * x for first, last in (corners[:2], corners[2:]))
    values: Array = low * (1.0 - y) + high * y
    return values


def rows(table: Array, x: Array) -> Array:
    """Return the rows (N, Y) of a table (X, Y) of uniform samples at x (N,), by linear interpolation."""
    at = x * (len(table) - 1)
    low = np.minimum(at.astype(int), len(table) - 2)
    share = (at - low)[:, None]
    between_rows: Array = table[low] * (1.0 - share) + table[low + 1] * share
    return between_rows


def _columns(table: Array, y: Array) -> Array:
    """Return the columns (X, N) of a table (X, Y) of uniform samples at y (N,), by linear interpolation."""
    return rows(table.T, y).T


def nodes(s: Array, per_unit: Array, seams: Array) -> Array:
    """Return nodes from 0 to 1 with a given density; the seams (K,) are nodes.

    `per_unit` (S,): cells per unit of s, linear between s (S,).
    """
    total = integral(s, per_unit)
    ends = np.concatenate(([0.0], np.interp(seams, s, total), total[-1:]))
    parts = []
    for low, high, end in zip(ends[:-1], ends[1:], [*seams, 1.0], strict=True):
        count = max(1, int(np.ceil(high - low - CELL_ROUNDING_SHARE)))
        parts.append(on_grid(np.interp(np.linspace(low, high, count + 1), total, s)[1:], STEPS_PER_LINK))
        parts[-1][-1] = end
    return np.concatenate(([0.0], *parts))


def denser(s: Array, cells: Array, tolerance: float, *, even: bool = False) -> tuple[Array, Array]:
    """Return the cells per unit of s that split the cells beyond the tolerance; with the s at which they are stated.

    - s: ends (C + 1,) of the cells.
    - cells: deviations (C,), mm.
    - tolerance: mm.
    - even: True to widen other cells instead, if that is enough.
    """
    width, missed = np.diff(s), cells > tolerance
    factor = np.where(missed, np.clip(1.03 * np.sqrt(cells / tolerance), 1.03, 2.0), 1.0)
    shifted = np.clip(1.02 * np.sqrt(cells / tolerance), MIN_DENSITY_FACTOR, 2.0)
    if even and shifted.sum() <= factor.size:
        factor = shifted
    # the number of cells is rounded up: the surplus goes to the cells beyond the tolerance
    total = factor.sum()
    factor[missed] = np.minimum(factor[missed] + (np.ceil(total) - total) / missed.sum(), 2.0)
    # a step function: two samples for each cell, a hair inside its ends
    inside = np.stack((s[:-1] + 1e-9 * width, s[1:] - 1e-9 * width), axis=-1).ravel()
    per_unit = np.repeat(factor / width, 2)
    inside[0], inside[-1] = 0.0, 1.0
    return inside, per_unit


def integral(s: Array, per_unit: Array) -> Array:
    """Return the number of cells (S,) from the first s to each s (S,), by the trapezoidal rule on `per_unit` (S,)."""
    cells: Array = np.concatenate(([0.0], np.cumsum(0.5 * (per_unit[1:] + per_unit[:-1]) * np.diff(s))))
    return cells
