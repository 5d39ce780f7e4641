r"""Mesh of the chamfer at one end of a tooth, between the tooth's nodes on the section there and new nodes on the end face.

    o---o---o--o--o--o--o   last row: outline of the end face
    |  /|  /| /| /| /| /|
    o---o---o--o--o--o--o   further rows, as many as the tolerance needs, with nodes between where chords miss it
    |  /|  /|\ | / \ | /|
    o---o---o-----o-----o   first row: nodes of the tooth

The last node of each row is the first node of the next tooth.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, cross, distinct, dot
from gearmesh.records import dataclass
from gearmesh.teeth.end_strip import EndStrip, StripPiece
from gearmesh.teeth.region import Region

Index = NDArray[np.int64]

#: largest number of rows of a chamfer, and of parts of a chord
MAX_ROWS = 16
#: largest number of rows of a rounding
MAX_ROWS_OF_ROUNDING = 256
#: chords of a quarter of a circle, over the root of radius per deviation
QUARTER_CIRCLE_ROWS = np.pi / np.sqrt(32.0)
#: factor on the number of rows that the measured deviation of a rounding asks for
MORE_ROWS_FACTOR = 1.05
#: largest deviation of chords between the tooth's nodes from the chamfer, as a share of the tolerance
CHORD_TOLERANCE_SHARE = 0.5
#: parts of a facet's edges between the places of measurement
EDGE_PARTS = 4
#: barycentric places of measurement: all of the lattice but the corners
MEASURED_PLACES = np.array(
    [
        (i, j, EDGE_PARTS - i - j)
        for i in range(EDGE_PARTS)
        for j in range(EDGE_PARTS - i + 1)
        if j < EDGE_PARTS and i + j > 0
    ],
    dtype=float,
)
MEASURED_PLACES /= EDGE_PARTS


@dataclass(frozen=True)
class EndMesh:
    """Mesh of the chamfer at one end of a tooth."""

    #: number of nodes on the tooth's section
    nodes: int
    #: new vertices (N, 3), mm
    vertices: Array
    #: (M, 3); indices count the nodes, the new vertices, and then both once more for the next tooth
    triangles: Index
    #: vertices on the outline of the end face, in order
    outline: Index
    #: new vertices (P, R) on the lines where the P pieces of the strip begin, the nearest to the section first
    lines: Index
    #: number of triangles (P,) of each piece; the triangles go piece by piece
    pieces: Index
    #: largest distance, mm, of the facets from the chamfer
    deviation: float

    @property
    def rows(self) -> int:
        """Number of rows of triangles between section and outline."""
        return int(self.lines.shape[1])


@dataclass(frozen=True)
class _EndRow:
    """Vertices of one row."""

    #: place across the strip: 1 on the section, 0 on the end face
    tau: float
    #: piece (K,) of each vertex
    piece: Index
    #: place (K,) along the piece, 0 to 1
    sigma: Array
    #: vertex number (K,); -1 where the next tooth begins
    number: Index


def end_mesh(strip: EndStrip, s: Sequence[tuple[Region, Array]], end: int, tolerance: float, rows: int = 1) -> EndMesh:
    """Return the mesh of the chamfer at the toe (`end` 0) or heel (1) of a tooth.

    - strip: surface of the chamfer.
    - s: nodes (K,) on the section of each link, from 0 to 1.
    - tolerance: mm.
    - rows: least number of rows.
    """
    most = MAX_ROWS
    if strip.chamfer.rounded:
        # rows by the chords of a quarter of a circle
        most = MAX_ROWS_OF_ROUNDING
        rows = max(rows, min(most, int(np.ceil(QUARTER_CIRCLE_ROWS * np.sqrt(strip.chamfer.width / tolerance)))))
    best = _in_rows(strip, s, end, tolerance, rows)
    while best.deviation > tolerance and rows < most:
        # the deviation of a rounding falls with the square of the number of rows
        rows = (
            min(2 * rows, int(rows * MORE_ROWS_FACTOR * np.sqrt(best.deviation / tolerance)) + 1)
            if strip.chamfer.rounded
            else 2 * rows
        )
        best = min(best, _in_rows(strip, s, end, tolerance, rows), key=lambda mesh: mesh.deviation)
    return best


def _in_rows(strip: EndStrip, s: Sequence[tuple[Region, Array]], end: int, tolerance: float, rows: int) -> EndMesh:
    """Return the mesh of a chamfer in a given number of rows."""
    coarse = [_nodes_of(strip, piece, s) for piece in strip.pieces]
    fine = [
        _nodes_between(strip, piece, sigma, CHORD_TOLERANCE_SHARE * tolerance)
        for piece, sigma in zip(strip.pieces, coarse, strict=True)
    ]
    count = sum(len(nodes) - 1 for _, nodes in s)
    ordered, new_places, made = list[_EndRow](), list[tuple[Index, Array, Array]](), count
    for k, tau in enumerate(np.linspace(1.0, 0.0, rows + 1)):
        row = _row(strip, fine if k else coarse, float(tau), made, first=k == 0)
        if k:
            new = np.unique(row.number[row.number >= 0], return_index=True)[1]
            new_places.append((row.piece[new], row.sigma[new], np.full(new.size, tau)))
            made += new.size
        ordered.append(row)
    # the last vertex of a row is the first vertex of the next tooth
    numbers = np.concatenate([np.where(row.number < 0, made + row.number[0], row.number) for row in ordered])
    starts = np.cumsum([0, *(row.piece.size for row in ordered)])
    triangles, deviation = list[Index](), 0.0
    for piece in range(len(strip.pieces)):
        corners = np.concatenate(
            [
                start + _between(*rows_of, piece)
                for start, rows_of in zip(starts.tolist(), pairwise(ordered), strict=False)
            ]
        )
        numbered = numbers[corners]
        real = (numbered != np.roll(numbered, 1, axis=1)).all(axis=1)
        deviation = max(deviation, _miss(strip, piece, ordered, corners[real]))
        triangles.append(numbered[real])
    joined = np.concatenate(triangles)
    begins = [np.searchsorted(row.piece, np.arange(len(strip.pieces))) for row in ordered[1:]]
    lines = np.stack([numbers[start + begin] for start, begin in zip(starts[1:], begins, strict=False)], axis=1)
    last = distinct(ordered[-1].number[ordered[-1].number >= 0])
    return EndMesh(
        count,
        _places(strip, *map(np.concatenate, zip(*new_places, strict=True))),
        joined[:, ::-1] if end else joined,
        last,
        lines,
        np.array([len(part) for part in triangles]),
        deviation,
    )


def _nodes_of(strip: EndStrip, piece: StripPiece, s: Sequence[tuple[Region, Array]]) -> Array:
    """Return sigma (K,) of the tooth's nodes on a piece; 0 and 1 for a piece that begins in a single node."""
    first, last = piece.inner
    if first == last:
        return np.array([0.0, 1.0])
    nodes = next(link_nodes for region, link_nodes in s if region is piece.region)
    return (nodes[(nodes >= first) & (nodes <= last)] - first) / (last - first)


def _nodes_between(strip: EndStrip, piece: StripPiece, sigma: Array, tolerance: float) -> Array:
    """Return sigma with further nodes where chords of the section or of the outline miss the tolerance, mm."""
    parts, tau = np.ones(sigma.size - 1, dtype=int), np.array([[0.0], [1.0]])
    for _ in range(MAX_ROWS):
        nodes = np.concatenate(
            [np.linspace(a, b, n + 1)[:-1] for (a, b), n in zip(pairwise(sigma), parts, strict=True)]
        )
        nodes = np.append(nodes, sigma[-1])
        ends, middles = (strip.at(piece, at, tau) for at in (nodes, 0.5 * (nodes[1:] + nodes[:-1])))
        chord, away = ends[:, 1:] - ends[:, :-1], middles - ends[:, :-1]
        # distance across the chord; along the chord the middle may be anywhere
        square = np.maximum(dot(chord, chord), 1e-300)
        miss = np.linalg.norm(away - (dot(away, chord) / square)[..., None] * chord, axis=-1).max(axis=0)
        worst = np.maximum.reduceat(miss, np.cumsum(parts) - parts)
        wanted = np.minimum(np.ceil(parts * np.sqrt(np.maximum(worst / tolerance, 1.0))).astype(int), MAX_ROWS)
        if (wanted <= parts).all():
            break
        parts = np.maximum(parts, wanted)
    return nodes


def _row(strip: EndStrip, sigma: list[Array], tau: float, made: int, *, first: bool) -> _EndRow:
    """Return a row; the vertices of the `first` row are the tooth's nodes, others are numbered from `made` on.

    Neighbouring pieces share a vertex; a piece that is a point in this row has one vertex. Numbers are -1 where the next
    tooth begins.
    """
    piece = np.concatenate([np.full(part.size, k) for k, part in enumerate(sigma)])
    unshared = [np.ones(part.size, dtype=bool) for part in sigma]
    for k, strip_piece in enumerate(strip.pieces):
        unshared[k][0] = k == 0
        if (first and strip_piece.inner[0] == strip_piece.inner[1]) or (tau == 0.0 and strip_piece.point is not None):
            unshared[k][1:] = False
    chosen = np.concatenate(unshared)
    number = np.cumsum(chosen) - 1 + (0 if first else made)
    return _EndRow(tau, piece, np.concatenate(sigma), np.where(number == number[-1], -1, number))


def _places(strip: EndStrip, piece: Index, sigma: Array, tau: Array) -> Array:
    """Return the points (N, 3), mm, of places on the strip."""
    points = np.empty((piece.size, 3))
    for k in distinct(piece).tolist():
        points[piece == k] = strip.at(strip.pieces[k], sigma[piece == k], tau[piece == k])
    return points


def _between(low: _EndRow, high: _EndRow, piece: int) -> Index:
    """Return the triangles (M, 3) of a piece between two rows; `high` has all nodes of `low`. Indices count both rows."""
    below, above = np.flatnonzero(low.piece == piece), np.flatnonzero(high.piece == piece)
    on = np.searchsorted(high.sigma[above], low.sigma[below] - 1e-12)
    shift, triangles = low.piece.size, list[tuple[int, int, int]]()
    for (a, b), (first, last) in zip(pairwise(below.tolist()), pairwise(on.tolist()), strict=True):
        middle = (first + last + 1) // 2
        fan = [shift + int(above[n]) for n in range(first, last + 1)]
        half = middle - first
        triangles += [(a, x, y) for x, y in pairwise(fan[: half + 1])]
        triangles += [(b, x, y) for x, y in pairwise(fan[half:])]
        triangles.append((a, fan[half], b))
    return np.array(triangles, dtype=np.int64).reshape(-1, 3)


def _miss(strip: EndStrip, piece: int, rows: Sequence[_EndRow], corners: Index) -> float:
    """Return the largest distance, mm, square to the facets (M, 3), of their points from the chamfer at the same sigma and tau.

    The corners of facets count the vertices of all rows.
    """
    if not len(corners):
        return 0.0
    sigma = np.concatenate([row.sigma for row in rows])[corners]
    tau = np.concatenate([np.full(row.sigma.size, row.tau) for row in rows])[corners]
    strip_piece = strip.pieces[piece]
    r = strip.at(strip_piece, sigma, tau)
    exact = strip.at(strip_piece, sigma @ MEASURED_PLACES.T, tau @ MEASURED_PLACES.T)
    normal = cross(r[:, 1] - r[:, 0], r[:, 2] - r[:, 0])
    size = np.maximum(np.sqrt(dot(normal, normal)), 1e-300)
    away = dot(exact - np.einsum("kj,njx->nkx", MEASURED_PLACES, r), normal[:, None]) / size[:, None]
    return float(np.abs(away).max())
