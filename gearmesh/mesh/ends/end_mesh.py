r"""Triangles of the chamfer at one end of a tooth, between its nodes on the section there and new ones on the end face.

    o---o---o--o--o--o--o   last row: outline of the end face
    |  /|  /| /| /| /| /|
    o---o---o--o--o--o--o   further rows, as many as keep the facets within the tolerance, with nodes between where chords miss it
    |  /|  /|\ | / \ | /|
    o---o---o-----o-----o   first row: nodes of the tooth

The last node of every row is the first one of the next tooth.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, cross, dot
from gearmesh.teeth.end_strip import EndStrip, StripPiece
from gearmesh.teeth.region import Region

Index = NDArray[np.int64]

#: rows from which on there are no more, of a rounding, and most parts of a chord
MOST, MOST_OF_ROUNDING = 16, 256
#: chords of a quarter of a circle that is 1 in radius, for 1 between them
QUARTER = np.pi / np.sqrt(32.0)
#: by how many more rows than measured a rounding is meshed anew
MORE = 1.05
#: share of the tolerance that chords between the tooth's nodes may miss the chamfer by
CHORDS = 0.5
#: parts of a facet's edges between the places where it is measured, and these, barycentric: all of the lattice but the corners
PARTS = 4
PLACES = np.array(
    [(i, j, PARTS - i - j) for i in range(PARTS) for j in range(PARTS - i + 1) if j < PARTS and i + j > 0], dtype=float
)
PLACES /= PARTS


@dataclass(frozen=True)
class EndMesh:
    """New vertices (N, 3), mm, and triangles (M, 3), which count the `nodes` of the tooth's section first, then these, and then
    both once more: those of the next tooth.

    `outline`: vertices of the end face's outline in order; `lines` (P, R): new ones where each piece of the strip begins, those
    nearest to the section first; `pieces` (P,): how many triangles each has, one after the other. `deviation`: largest distance
    (mm) of the facets from the chamfer.
    """

    nodes: int
    vertices: Array
    triangles: Index
    outline: Index
    lines: Index
    pieces: Index
    deviation: float

    @property
    def rows(self) -> int:
        """Rows of triangles between section and outline."""
        return int(self.lines.shape[1])


@dataclass(frozen=True)
class _EndRow:
    """Places (piece, sigma) of the vertices of a row, both (K,), and their numbers."""

    tau: float
    piece: Index
    sigma: Array
    number: Index


def end_mesh(strip: EndStrip, s: Sequence[tuple[Region, Array]], end: int, tolerance: float, rows: int = 1) -> EndMesh:
    """The chamfer of one tooth at its toe (`end` 0) or heel, whose section has nodes at s (K,) of every link, from 0 to 1.

    In as many rows as the tolerance (mm) needs, at least `rows`.
    """
    most = MOST
    if strip.chamfer.rounded:
        # chords of a quarter of a circle, all but halved where they are to be
        most = MOST_OF_ROUNDING
        rows = max(rows, min(most, int(np.ceil(QUARTER * np.sqrt(strip.chamfer.width / tolerance)))))
    best = _in_rows(strip, s, end, tolerance, rows)
    while best.deviation > tolerance and rows < most:
        # of a rounding what is missed falls with the square of their number
        rows = (
            min(2 * rows, int(rows * MORE * np.sqrt(best.deviation / tolerance)) + 1)
            if strip.chamfer.rounded
            else 2 * rows
        )
        best = min(best, _in_rows(strip, s, end, tolerance, rows), key=lambda mesh: mesh.deviation)
    return best


def _in_rows(strip: EndStrip, s: Sequence[tuple[Region, Array]], end: int, tolerance: float, rows: int) -> EndMesh:
    """The mesh in so many rows."""
    coarse = [_nodes_of(strip, piece, s) for piece in strip.pieces]
    fine = [
        _nodes_between(strip, piece, sigma, CHORDS * tolerance)
        for piece, sigma in zip(strip.pieces, coarse, strict=True)
    ]
    count = sum(len(of) - 1 for _, of in s)
    ordered, own_places, made = list[_EndRow](), list[tuple[Index, Array, Array]](), count
    for k, tau in enumerate(np.linspace(1.0, 0.0, rows + 1)):
        row = _row(strip, fine if k else coarse, float(tau), made, first=k == 0)
        if k:
            own = np.unique(row.number[row.number >= 0], return_index=True)[1]
            own_places.append((row.piece[own], row.sigma[own], np.full(own.size, tau)))
            made += own.size
        ordered.append(row)
    # the last vertex of a row is the next tooth's first
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
        own = numbers[corners]
        real = (own != np.roll(own, 1, axis=1)).all(axis=1)
        deviation = max(deviation, _miss(strip, piece, ordered, corners[real]))
        triangles.append(own[real])
    joined = np.concatenate(triangles)
    begins = [np.searchsorted(row.piece, np.arange(len(strip.pieces))) for row in ordered[1:]]
    lines = np.stack([numbers[start + begin] for start, begin in zip(starts[1:], begins, strict=False)], axis=1)
    last = np.unique(ordered[-1].number[ordered[-1].number >= 0])
    return EndMesh(
        count,
        _places(strip, *map(np.concatenate, zip(*own_places, strict=True))),
        joined[:, ::-1] if end else joined,
        last,
        lines,
        np.array([len(own) for own in triangles]),
        deviation,
    )


def _nodes_of(strip: EndStrip, piece: StripPiece, s: Sequence[tuple[Region, Array]]) -> Array:
    """sigma (K,) of the tooth's nodes on a piece; of a piece that begins in one of them its ends."""
    first, last = piece.inner
    if first == last:
        return np.array([0.0, 1.0])
    own = next(of for region, of in s if region is piece.region)
    return (own[(own >= first) & (own <= last)] - first) / (last - first)


def _nodes_between(strip: EndStrip, piece: StripPiece, sigma: Array, tolerance: float) -> Array:
    """sigma with nodes between, where chords of the section or the end face's outline miss them by more than the tolerance (mm)."""
    parts, tau = np.ones(sigma.size - 1, dtype=int), np.array([[0.0], [1.0]])
    for _ in range(MOST):
        nodes = np.concatenate(
            [np.linspace(a, b, n + 1)[:-1] for (a, b), n in zip(pairwise(sigma), parts, strict=True)]
        )
        nodes = np.append(nodes, sigma[-1])
        ends, middles = (strip.at(piece, at, tau) for at in (nodes, 0.5 * (nodes[1:] + nodes[:-1])))
        chord, away = ends[:, 1:] - ends[:, :-1], middles - ends[:, :-1]
        # across the chord: along it the middle may be anywhere
        square = np.maximum(dot(chord, chord), 1e-300)
        miss = np.linalg.norm(away - (dot(away, chord) / square)[..., None] * chord, axis=-1).max(axis=0)
        worst = np.maximum.reduceat(miss, np.cumsum(parts) - parts)
        wanted = np.minimum(np.ceil(parts * np.sqrt(np.maximum(worst / tolerance, 1.0))).astype(int), MOST)
        if (wanted <= parts).all():
            break
        parts = np.maximum(parts, wanted)
    return nodes


def _row(strip: EndStrip, sigma: list[Array], tau: float, made: int, *, first: bool) -> _EndRow:
    """One row, its new vertices numbered from `made` on, or (the `first` one) as the tooth's; -1 where the next tooth begins.

    Neighbouring pieces have a vertex in common, and pieces that are a point in this row but one.
    """
    piece = np.concatenate([np.full(of.size, k) for k, of in enumerate(sigma)])
    own = [np.ones(of.size, dtype=bool) for of in sigma]
    for k, one in enumerate(strip.pieces):
        own[k][0] = k == 0
        if (first and one.inner[0] == one.inner[1]) or (tau == 0.0 and one.point is not None):
            own[k][1:] = False
    chosen = np.concatenate(own)
    number = np.cumsum(chosen) - 1 + (0 if first else made)
    return _EndRow(tau, piece, np.concatenate(sigma), np.where(number == number[-1], -1, number))


def _places(strip: EndStrip, piece: Index, sigma: Array, tau: Array) -> Array:
    """Points (N, 3) of places on the strip."""
    points = np.empty((piece.size, 3))
    for k in np.unique(piece).tolist():
        points[piece == k] = strip.at(strip.pieces[k], sigma[piece == k], tau[piece == k])
    return points


def _between(low: _EndRow, high: _EndRow, piece: int) -> Index:
    """Triangles (M, 3) of a piece between two rows, the second with nodes between those of the first; numbers count both rows."""
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
    """Largest distance (mm), across the facets (M, 3), which count the vertices of all rows, of points on them from those of the
    chamfer at the same sigma and tau."""
    if not len(corners):
        return 0.0
    sigma = np.concatenate([row.sigma for row in rows])[corners]
    tau = np.concatenate([np.full(row.sigma.size, row.tau) for row in rows])[corners]
    one = strip.pieces[piece]
    r = strip.at(one, sigma, tau)
    exact = strip.at(one, sigma @ PLACES.T, tau @ PLACES.T)
    normal = cross(r[:, 1] - r[:, 0], r[:, 2] - r[:, 0])
    size = np.maximum(np.sqrt(dot(normal, normal)), 1e-300)
    away = dot(exact - np.einsum("kj,njx->nkx", PLACES, r), normal[:, None]) / size[:, None]
    return float(np.abs(away).max())
