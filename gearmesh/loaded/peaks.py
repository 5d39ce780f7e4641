r"""Peak pressure of a contact: the largest pressure apart from edge contact, and an estimate of its error.

The pressure is singular at a tip, at a form point and at the end face of one body alone: it grows with every refinement
of the cells. Along a line of contact that ends there, the pressure rises all the way to the end, over about half the
height of a tooth:

    pressure                                      Rows within `edge_zone` of a sharp end count only if the pressure
     |  \                        ___              has risen again on the way inward, behind a minimum. Contact that
     |   \__         _________/     \             fades out towards an edge, and humps beside an edge, are not singular.
     |      \_______/               |
     +---|--------------------------|--> x        Across a row the same rule holds for cells beside an edge. A row
     sharp  edge_zone               blunt         without a maximum of its own is in edge contact.

The rule does not use the size of the cells, and it interpolates the pressure at the border of the zone. Peaks are
therefore continuous in the position of the gears. The error is estimated with cells twice as long and wide.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass

#: share by which the pressure must rise above a minimum, on the way from an edge, to count beyond the minimum
MIN_PRESSURE_RISE = 0.02
#: length of the zone beside a sharp end over the height of the flank
ZONE_HEIGHTS = 0.5
#: largest length of the zone beside a sharp end over the face width
ZONE_FACES = 0.25


@dataclass(frozen=True)
class RowGrid:
    """Grids (M,) of cells in X rows across a contact, Y cells each."""

    #: pressures (M, X, Y), MPa
    pressure: Array
    #: cells (M, X, Y) that lie on both flanks
    on: NDArray[np.bool_]
    #: rows (M, X) that run along an edge
    edged: NDArray[np.bool_]
    #: length (M,) of the cells, mm
    dx: Array
    #: distances (2, M), mm, inward from the outer sides of the first and the last row to the ends of the contact's
    #: ridge
    ends: Array
    #: ends (M, 2) at which both bodies end
    blunt: NDArray[np.bool_]


@dataclass(frozen=True)
class Peaks:
    """Largest `pressure` (M,), MPa, and its `row` (M,); NaN if all of the pressure is edge contact."""

    pressure: Array
    row: NDArray[np.intp]


def edge_zone(points: Array) -> float:
    """Return the length, mm, over which the pressure along a line of contact rises towards a sharp end.

    `points` (I, J, 3) are nodes of the flank.
    """
    height = float(np.linalg.norm(points[-1] - points[0], axis=-1).mean())
    face = float(np.linalg.norm(np.diff(points, axis=1), axis=-1).sum(axis=1).mean())
    return min(ZONE_HEIGHTS * height, ZONE_FACES * face)


def peaks(grid: RowGrid, zone: float) -> Peaks:
    """Return the largest pressure of each grid (M,): beyond the `zone`, mm, beside a sharp end, or behind a minimum in
    it."""
    rows, cut = row_peaks(grid), _cut(grid)
    count = rows.shape[1]
    # distances of the rows' middles along the grid
    middle = grid.dx[:, None] * (np.arange(count) + 0.5)
    length = grid.dx[:, None] * count
    counted, candidates, border_rows = np.isfinite(rows), [], []
    for end, (inward_step, blunt) in enumerate(zip((1, -1), grid.blunt.T, strict=True)):
        # distances from the end of the ridge, rising along `inward`
        distance = (middle if end == 0 else length - middle) - grid.ends[end][:, None]
        # a row in the zone counts if its pressure exceeds the least pressure between the sharp end and the row
        known = np.isfinite(rows) & (distance > 0.0)
        inward = np.where(known & ~cut, rows, np.inf)[:, ::inward_step]
        least = np.minimum.accumulate(inward, axis=1)[:, ::inward_step]
        free = known & ((distance >= zone) | (~cut & (rows > (1.0 + MIN_PRESSURE_RISE) * least)))
        counted &= free | blunt[:, None]
        # pressure at the border of the zone, interpolated between the last row inside and the first row beyond
        beyond = (
            (distance >= zone).argmax(axis=1)
            if inward_step > 0
            else count - 1 - (distance >= zone)[:, ::-1].argmax(axis=1)
        )
        before = np.clip(beyond - inward_step, 0, count - 1)
        every = np.arange(len(rows))
        share = np.clip((zone - distance[every, before]) / grid.dx, 0.0, 1.0)
        between = (1.0 - share) * rows[every, before] + share * rows[every, beyond]
        inside = (distance[every, beyond] >= zone) & (distance[every, before] < zone) & known[every, before] & ~blunt
        candidates.append(np.where(inside, between, np.nan))
        border_rows.append(beyond)
    # a border counts only where the other end's zone lets its row count
    every = np.arange(len(rows))
    borders = [
        np.where(counted[every, border_row], border, np.nan)
        for border, border_row in zip(candidates, border_rows, strict=True)
    ]
    # the largest of the rows that count and of both borders
    best = np.where(counted, rows, -np.inf)
    values = np.column_stack((best.max(axis=1), *(np.nan_to_num(border, nan=-np.inf) for border in borders)))
    row_of_value = np.column_stack((best.argmax(axis=1), *border_rows))
    chosen = values.argmax(axis=1)
    largest = values[every, chosen]
    return Peaks(np.where(largest > 0.0, largest, np.nan), row_of_value[every, chosen])


def row_peaks(grid: RowGrid) -> Array:
    """Return the largest pressure (M, X) across each row apart from the rise towards an edge; NaN if there is only this
    rise."""
    pressure = np.where(grid.on, grid.pressure, np.inf)
    counted = grid.on.copy()
    for step in (1, -1):
        least = np.minimum.accumulate(pressure[..., ::step], axis=2)[..., ::step]
        counted &= (grid.pressure > (1.0 + MIN_PRESSURE_RISE) * least) | (least == 0.0)
    free = counted.any(axis=2) & ~grid.edged
    return np.where(free, np.where(counted, grid.pressure, -np.inf).max(axis=2), np.nan)


def _cut(grid: RowGrid) -> NDArray[np.bool_]:
    """Return the rows (M, X) that are pressed up to an edge across y."""
    off = np.pad(~grid.on, ((0, 0), (0, 0), (1, 1)), mode="edge")
    at_edge = grid.on & (off[..., :-2] | off[..., 2:]) & (grid.pressure > 0.0)
    return np.asarray(at_edge.any(axis=2))


def coarser(grid: RowGrid, pressure: Array) -> RowGrid:
    """Return the grid with cells twice as long and wide under given pressures (M, X/2, Y/2)."""
    on = grid.on[:, ::2] & grid.on[:, 1::2]
    return RowGrid(
        pressure,
        on[..., ::2] & on[..., 1::2],
        grid.edged[:, ::2] | grid.edged[:, 1::2],
        2.0 * grid.dx,
        grid.ends,
        grid.blunt,
    )
