"""Peak pressure of a contact: the largest pressure that is no edge contact's, and an estimate of its error.

At a tip, a form point or the end face of one body alone pressure is singular: it grows with every refinement of the cells. Along a
line of contact that ends there the pressure rises all the way to that end, over about half the height of a tooth:

    pressure                                      Rows within `edge_zone` of a sharp end count only where the pressure
     |  \\                       ___               has risen again on the way inward, behind a minimum: contact that fades
     |   \\__         _________/   \\              out towards an edge, and humps beside one, have no singularity.
     |      \\_______/              |
     +---|-----------------------------> x       Across a row the same holds for cells beside an edge. A row without a
     sharp  edge_zone               blunt         maximum of its own is in edge contact.

No part of the rule knows the size of cells, and the pressure at the border of the zone is interpolated: peaks are continuous in the
position of the gears. The error is estimated by cells twice as long and wide.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array

#: share by which pressure must exceed a minimum, on the way from an edge, for what is behind to count
RISE = 0.02
#: length of the zone beside a sharp end: this part of the flank's height, this part of the face at most
ZONE_HEIGHTS, ZONE_FACES = 0.5, 0.25


@dataclass(frozen=True)
class RowGrid:
    """Cells (M, X, Y) in rows across a contact: `pressure`, MPa, whether cells are `on` both flanks, rows that are `edged` (M, X)
    run along an edge; length `dx` (M,), mm, of cells; `ends` (2, M), mm: where the ridge of the contact ends, inward from the first
    and the last row's outer side; `blunt` (M, 2): ends at which both bodies end."""

    pressure: Array
    on: NDArray[np.bool_]
    edged: NDArray[np.bool_]
    dx: Array
    ends: Array
    blunt: NDArray[np.bool_]


@dataclass(frozen=True)
class Peaks:
    """`pressure` (M,), MPa, NaN where nothing but edge contact is pressed, and the `row` (M,) in which it is."""

    pressure: Array
    row: NDArray[np.intp]


def edge_zone(points: Array) -> float:
    """Length, mm, over which the pressure of a line of contact rises towards a sharp end, of a flank with nodes (I, J, 3)."""
    height = float(np.linalg.norm(points[-1] - points[0], axis=-1).mean())
    face = float(np.linalg.norm(np.diff(points, axis=1), axis=-1).sum(axis=1).mean())
    return min(ZONE_HEIGHTS * height, ZONE_FACES * face)


def peaks(grid: RowGrid, zone: float) -> Peaks:
    """The largest pressure of each grid (M,) outside zones, mm, beside its sharp ends, or behind a minimum within one."""
    rows, cut = row_peaks(grid), _cut(grid)
    count = rows.shape[1]
    middle = grid.dx[:, None] * (np.arange(count) + 0.5)
    length = grid.dx[:, None] * count
    counted, candidates, places = np.isfinite(rows), [], []
    for end, (way, blunt) in enumerate(zip((1, -1), grid.blunt.T, strict=True)):
        # distances from the end of the ridge, rising along `inward`
        away = (middle if end == 0 else length - middle) - grid.ends[end][:, None]
        known = np.isfinite(rows) & (away > 0.0)
        inward = np.where(known & ~cut, rows, np.inf)[:, ::way]
        least = np.minimum.accumulate(inward, axis=1)[:, ::way]
        free = known & ((away >= zone) | (~cut & (rows > (1.0 + RISE) * least)))
        counted &= free | blunt[:, None]
        # between the last row inside the zone and the first beyond it
        beyond = (away >= zone).argmax(axis=1) if way > 0 else count - 1 - (away >= zone)[:, ::-1].argmax(axis=1)
        before = np.clip(beyond - way, 0, count - 1)
        every = np.arange(len(rows))
        share = np.clip((zone - away[every, before]) / grid.dx, 0.0, 1.0)
        between = (1.0 - share) * rows[every, before] + share * rows[every, beyond]
        inside = (away[every, beyond] >= zone) & (away[every, before] < zone) & known[every, before] & ~blunt
        candidates.append(np.where(inside, between, np.nan))
        places.append(beyond)
    # the border of one zone may lie in the other one
    every = np.arange(len(rows))
    borders = [
        np.where(counted[every, place], border, np.nan) for border, place in zip(candidates, places, strict=True)
    ]
    best = np.where(counted, rows, -np.inf)
    values = np.column_stack((best.max(axis=1), *(np.nan_to_num(border, nan=-np.inf) for border in borders)))
    place = np.column_stack((best.argmax(axis=1), *places))
    chosen = values.argmax(axis=1)
    largest = values[every, chosen]
    return Peaks(np.where(largest > 0.0, largest, np.nan), place[every, chosen])


def row_peaks(grid: RowGrid) -> Array:
    """Largest pressure (M, X) across each row without the rise towards an edge; NaN where there is no other."""
    pressure = np.where(grid.on, grid.pressure, np.inf)
    counted = grid.on.copy()
    for way in (1, -1):
        least = np.minimum.accumulate(pressure[..., ::way], axis=2)[..., ::way]
        counted &= (grid.pressure > (1.0 + RISE) * least) | (least == 0.0)
    free = counted.any(axis=2) & ~grid.edged
    return np.where(free, np.where(counted, grid.pressure, -np.inf).max(axis=2), np.nan)


def _cut(grid: RowGrid) -> NDArray[np.bool_]:
    """Rows (M, X) pressed up to an edge that bounds them."""
    off = np.pad(~grid.on, ((0, 0), (0, 0), (1, 1)), mode="edge")
    at_edge = grid.on & (off[..., :-2] | off[..., 2:]) & (grid.pressure > 0.0)
    return np.asarray(at_edge.any(axis=2))


def coarser(grid: RowGrid, pressure: Array) -> RowGrid:
    """The grid with cells twice as long and wide, and their `pressure` (M, X/2, Y/2)."""
    on = grid.on[:, ::2] & grid.on[:, 1::2]
    return RowGrid(
        pressure,
        on[..., ::2] & on[..., 1::2],
        grid.edged[:, ::2] | grid.edged[:, 1::2],
        2.0 * grid.dx,
        grid.ends,
        grid.blunt,
    )
