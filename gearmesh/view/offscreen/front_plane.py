"""Triangles and lines cut at the front plane of a picture.

The cut is made here, not by OpenGL, whose clipping would look at every pixel, also at pixels of hidden triangles.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array

#: corners of the pieces that remain of a triangle, by its number of corners behind the plane, the odd corner first: k
#: is corner k, k + 3 is the point between the corners 0 and k
PIECE_CORNERS = {1: ((0, 4, 5),), 2: ((4, 1, 2), (4, 2, 5))}


def cut_front(
    points: Array, cells: NDArray[np.int64], depth: Array, colours: NDArray[np.uint8] | None = None
) -> tuple[Array, NDArray[np.int64], NDArray[np.uint8] | None]:
    """Return the points (V, 3), cells (C, 2 or 3) and colours (V, 3) behind a plane, where the `depth` (V,) is at least
    0.

    Cells that the plane cuts come first. Points of no cell are omitted.
    """
    behind = depth >= 0.0
    count = behind[cells].sum(axis=1)
    whole = cells[count == cells.shape[1]]
    if cells.shape[1] == 2:
        ends = cells[count == 1]
        ends = np.where(behind[ends[:, :1]], ends, ends[:, ::-1])
        one, two = np.stack((ends[:, 0], ends[:, 0]), axis=-1), ends
    else:
        kept = [_corners(cells[count == k], behind, k) for k in PIECE_CORNERS]
        one, two = (np.concatenate([part[side] for part in kept]) for side in (0, 1))
    first, second = one.reshape(-1), two.reshape(-1)
    # share of the way between two corners at which the depth is 0; 0 where both are the same corner
    span = depth[first] - depth[second]
    share = (depth[first] / np.where(span == 0.0, 1.0, span))[:, None]
    used, renumbered = np.unique(whole, return_inverse=True)
    pieces = len(used) + np.arange(len(first)).reshape(one.shape)
    mixed = points[first] + share * (points[second] - points[first])
    shades = None
    if colours is not None:
        own, other = colours[first].astype(float), colours[second].astype(float)
        shades = np.concatenate((colours[used], np.rint(own + share * (other - own)).astype(np.uint8)))
    return (
        np.concatenate((points[used], mixed)),
        np.concatenate((pieces, renumbered.reshape(whole.shape))).astype(np.int64),
        shades,
    )


def section_lines(points: Array, cells: NDArray[np.int64], depth: Array) -> Array:
    """Return the lines (L, 2, 3) in which triangles (C, 3) meet a plane, where the `depth` (V,) of points (V, 3) is 0."""
    behind = depth[cells] >= 0.0
    crossed = cells[behind.any(axis=1) & ~behind.all(axis=1)]
    behind = depth[crossed] >= 0.0
    odd = (behind == (behind.sum(axis=1) == 1)[:, None]).argmax(axis=1)
    turned = np.take_along_axis(crossed, (odd[:, None] + np.arange(3)) % 3, axis=1)
    one, others = turned[:, :1], turned[:, 1:]
    share = (depth[one] / (depth[one] - depth[others]))[..., None]
    lines: Array = points[one] + share * (points[others] - points[one])
    return lines


def _corners(
    cells: NDArray[np.int64], behind: NDArray[np.bool_], count: int
) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Points (P, 3) and (P, 3) between which the corners of the pieces of triangles (C, 3) lie.

    Both are the same for corners that stay. `count` corners of each triangle are behind the plane.
    """
    # the odd corner is the one of its side: behind for one of three, before for two of three
    odd = (behind[cells] == (count == 1)).argmax(axis=1)
    turned = np.take_along_axis(cells, (odd[:, None] + np.arange(3)) % 3, axis=1)
    pieces = np.array(PIECE_CORNERS[count]).reshape(-1)
    first = np.where(pieces < 3, pieces, 0)
    second = np.where(pieces < 3, pieces, pieces - 3)
    return turned[:, first].reshape(-1, 3), turned[:, second].reshape(-1, 3)
