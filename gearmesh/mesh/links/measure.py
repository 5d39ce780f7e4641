"""How far edges and triangles of a link are from its exact surface."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.mesh.patch import LinkNodes

Index = NDArray[np.int64]

#: places along a chord at which its distance from its section curve is measured: where the curve is bent unevenly, as beside a
#: form point, the middle is not the farthest
PLACES = np.array([0.25, 0.5, 0.75])


def deviations_of(
    nodes: LinkNodes, triangles: Index, edges: Index, sides: Index, crease: NDArray[np.bool_]
) -> tuple[Array, Array, Array]:
    """Largest distances, mm, of edges (E, 2) and of triangles (M, 3), and the normals (M, 3) near the centres of these.

    `sides` (M, 3): which edges those opposite to a triangle's corners are; `crease` (N,): nodes with one of two normals.
    """
    # of both in one evaluation, which takes hardly more than one of them
    count, (both, normals) = len(edges), nodes.height(edges, triangles)
    heights, centres = both[:count], both[count:]
    # normals on creases are those of one of both sides, and those of drawn links not square to them
    arches = np.where(crease[edges].any(axis=1), 0.0, nodes.arch(edges, heights))
    edge = np.maximum(np.abs(heights), arches)
    inside = peaks(heights[sides], centres)
    return edge, np.maximum(inside, edge[sides].max(axis=1)), normals[count:]


def peaks(sides: Array, centres: Array) -> Array:
    """Largest distances (M,), mm, of triangles from the surface by those, signed, of the middles of edges (M, 3) and
    of centres.

    With a, b, c at the edges' middles, opposite to the corners, the distance is 4 (a y z + b z x + c x y) at
    barycentric x, y, z. It peaks at x : y : z = a (b + c - a) : b (c + a - b) : c (a + b - c) or, where that is
    outside, at the middle of an edge. What the centre has beyond it is of third order and vanishes on the edges like x
    y z.
    """
    # column by column: numpy is slow along axes of three
    a, b, c = sides.T
    total = a + b + c
    x, y, z = a * (total - 2.0 * a), b * (total - 2.0 * b), c * (total - 2.0 * c)
    largest: Array = np.maximum(np.maximum(np.maximum(np.abs(a), np.abs(b)), np.abs(c)), np.abs(centres))
    inside = np.flatnonzero((x > 0.0) & (y > 0.0) & (z > 0.0))
    if inside.size:
        a, b, c, x, y, z = (of[inside] for of in (a, b, c, x, y, z))
        total = x + y + z
        x, y, z = x / total, y / total, z / total
        more = centres[inside] - 4.0 / 9.0 * (a + b + c)
        peak = np.abs(4.0 * (a * y * z + b * z * x + c * x * y) + 27.0 * more * x * y * z)
        largest[inside] = np.maximum(largest[inside], peak)
    return largest


def off_chords(ends: Array, points: Array) -> Array:
    """Largest distances (N,), mm, of points (N, K, 3) from the lines through ends (N, 2, 3)."""
    chord, away = ends[:, 1] - ends[:, 0], points - ends[:, :1]
    length = dot(chord, chord)[:, None]
    along = dot(away, chord[:, None])
    share = np.divide(along, length, out=np.zeros_like(along), where=length > 0.0)
    off = away - share[..., None] * chord[:, None]
    size: Array = np.sqrt(dot(off, off).max(axis=1, initial=0.0))
    return size
