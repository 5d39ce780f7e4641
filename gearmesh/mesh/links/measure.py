"""Distances of edges and triangles of a link from its exact surface."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.mesh.patch import LinkNodes

Index = NDArray[np.int64]

#: places along a chord at which its distance from the section curve is measured; the middle is not always the farthest point,
#: as beside a form point, where the curvature changes
CHORD_SHARES = np.array([0.25, 0.5, 0.75])


def deviations_of(
    nodes: LinkNodes, triangles: Index, edges: Index, sides: Index, crease: NDArray[np.bool_]
) -> tuple[Array, Array, Array]:
    """Return the largest distances, mm, of edges (E,) and triangles (M,), and the normals (M, 3) near the triangles' centres.

    - nodes: nodes (N,) of the link.
    - triangles: nodes (M, 3) of the triangles.
    - edges: nodes (E, 2) of the edges.
    - sides: edges (M, 3) opposite to the corners of the triangles.
    - crease: True (N,) at nodes on a crease, which have the normal of one of its two sides.
    """
    # middles of edges and centres of triangles in one evaluation, which costs little more than either
    count, (both, normals) = len(edges), nodes.height(edges, triangles)
    heights, centres = both[:count], both[count:]
    # arches need normals of the surface: at a crease the normal may be that of the other side
    arches = np.where(crease[edges].any(axis=1), 0.0, nodes.arch(edges, heights))
    edge = np.maximum(np.abs(heights), arches)
    inside = peaks(heights[sides].T, centres)
    return edge, np.maximum(inside, edge[sides].max(axis=1)), normals[count:]


def peaks(sides: Sequence[Array] | Array, centres: Array | None = None) -> Array:
    """Return the largest distances (M,), mm, of triangles from the surface.

    - sides: signed distances 3 x (M,), mm, at the middles of the edges, opposite to the corners.
    - centres: signed distances (M,), mm, at the centres; None for distances to second order.

    To second order the distance at barycentric coordinates x, y, z is 4 (a y z + b z x + c x y). Here a, b, c are the
    distances at the middles of the edges. Its extreme is at x : y : z = a (b + c - a) : b (c + a - b) : c (a + b - c).
    If this point is outside the triangle, the extreme is at the middle of an edge. The rest at the centre is of third
    order; it vanishes on the edges as x y z does.
    """
    # column by column, because numpy is slow along axes of three
    a, b, c = sides
    largest: Array = np.maximum(np.maximum(np.abs(a), np.abs(b)), np.abs(c))
    if centres is not None:
        np.maximum(largest, np.abs(centres), out=largest)
    # an extreme inside needs distances of one sign at all middles
    low, high = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
    same = np.flatnonzero((low > 0.0) | (high < 0.0))
    if not same.size:
        return largest
    a, b, c = a[same], b[same], c[same]
    total = a + b + c
    x, y, z = a * (total - 2.0 * a), b * (total - 2.0 * b), c * (total - 2.0 * c)
    inside = np.flatnonzero((x > 0.0) & (y > 0.0) & (z > 0.0))
    if inside.size:
        # extremes inside the triangle, with the third-order rest of the centre
        a, b, c, x, y, z = (values[inside] for values in (a, b, c, x, y, z))
        total, inside = x + y + z, same[inside]
        x, y, z = x / total, y / total, z / total
        peak = 4.0 * (a * y * z + b * z * x + c * x * y)
        if centres is not None:
            peak = peak + 27.0 * (centres[inside] - 4.0 / 9.0 * (a + b + c)) * x * y * z
        largest[inside] = np.maximum(largest[inside], np.abs(peak))
    return largest


def off_chords(ends: Array, points: Array) -> Array:
    """Return the largest distances (N,), mm, of points (N, K, 3) from the lines through `ends` (N, 2, 3)."""
    chord, away = ends[:, 1] - ends[:, 0], points - ends[:, :1]
    length = dot(chord, chord)[:, None]
    along = dot(away, chord[:, None])
    share = np.divide(along, length, out=np.zeros_like(along), where=length > 0.0)
    off = away - share[..., None] * chord[:, None]
    size: Array = np.sqrt(dot(off, off).max(axis=1, initial=0.0))
    return size
