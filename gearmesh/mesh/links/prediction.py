"""Predicted distances of edges and triangles in the (s, t) plane of a link from its surface, by the second form alone.

The distance of an edge is an eighth of the form at its middle. The distance of a triangle follows from the middles of its
sides (see `measure`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.links.collapse import FLAT_AREA, Index, area
from gearmesh.mesh.links.lines import between
from gearmesh.mesh.links.measure import peaks
from gearmesh.records import dataclass


@dataclass(frozen=True)
class Prediction:
    """Prediction from sampled second forms.

    If `arched`, an edge uses the form at its ends, too. Let q0, q, q1 be the form at start, middle and end. The height
    of the edge at x (0 to 1) is x (1 - x) ((q0 + 2 q) (1 - x) + (2 q + q1) x) / 6.
    """

    #: L, M, N (S, T, 3), mm, at uniform s from 0 to `extent` and uniform t from 0 to 1
    forms: Array
    #: second derivatives (2, S), mm, of the section curves at toe and heel, as in `Forms`
    outline: Array
    #: largest s
    extent: float = 1.0
    #: True for long edges, along which the form changes
    arched: bool = False

    def triangles(self, a: Array, b: Array, c: Array) -> Array:
        """Return the distances (N,), mm, of triangles with corners a, b, c (N, 2); inf for triangles without area."""
        ends = np.stack((b, c, a)), np.stack((c, a, b))
        middle = self._forms(0.5 * (ends[0] + ends[1]))
        first, last = (self._forms(end) if self.arched else None for end in ends)
        return _worst(*_edges(first, middle, last, ends[1] - ends[0]), area(a, b, c))

    def stars(self, near: Array, places: Array, after: Array, before: Array, following: Index) -> Array:
        """Return the distances (J, K), mm, of the triangles around a node that is tried at K places.

        - near: place (J, 2) of the node at which the second form is taken.
        - places: places (J, K, 2) that are tried.
        - after: next corner (J, 2) of each triangle, counterclockwise.
        - before: last corner (J, 2) of each triangle.
        - following: triangle (J,) that begins at the last corner; -1 if there is none.

        Chords of the section curves at toe and heel count, too.
        """
        a, b, c, count = places, after[:, None], before[:, None], len(near)
        # the side to the last corner belongs to the following triangle, too; without one it is evaluated alone
        open_ = np.flatnonzero(following < 0)
        middles = 0.5 * np.concatenate((near + after, after + before, near[open_] + before[open_]))
        to_after, base, to_before = np.split(self._form(middles)[..., None], [count, 2 * count], axis=1)
        at_near = at_after = at_before = None
        if self.arched:
            at_near, at_after, at_before = (self._form(place)[..., None] for place in (near, after, before))
        lone = None if at_near is None else at_near[:, open_], None if at_before is None else at_before[:, open_]
        edges = (
            _edges(at_after, base, at_before, c - b),
            _edges(at_near, to_after, at_after, a - b),
            _edges(lone[0], to_before, lone[1], a[open_] - c[open_]),
        )
        heights = _round([height for height, _ in edges], following, open_)
        beside = [size for _, size in edges if size is not None]
        errors = _worst(heights, _round(beside, following, open_) if beside else None, area(a, b, c))
        # chords on toe and heel are compared with the section curves, too
        for end in (0, 1):
            at_end = np.flatnonzero(near[:, 1] == end)
            for node in (after, before) if at_end.size else ():
                chord = at_end[node[at_end, 1] == end]
                errors[chord] = np.maximum(errors[chord], self._sag(end, a[chord, :, 0], node[chord, 0][:, None]))
        return errors

    def chords(self, places: Array) -> Array:
        """Return the largest distances (N,), mm, of sides of triangles (N, 3, 2) on toe or heel from the section curve; else 0."""
        off = np.zeros(len(places))
        for end in (0, 1):
            for k in range(3):
                a, b = places[:, k], places[:, k - 1]
                on = np.flatnonzero((a[:, 1] == end) & (b[:, 1] == end))
                off[on] = np.maximum(off[on], self._sag(end, a[on, 0], b[on, 0]))
        return off

    def _forms(self, places: Array) -> Array:
        """Return L, M, N (3, K, N) at places (K, N, 2)."""
        return self._form(places.reshape(-1, 2)).reshape(3, *places.shape[:2])

    def _form(self, places: Array) -> Array:
        """Return L, M, N (3, N) at places (N, 2)."""
        return between(self.forms, places[:, 0] / self.extent, places[:, 1]).T

    def _sag(self, end: int, a: Array, b: Array) -> Array:
        """Return the distances (...,), mm, of chords from s = a to s = b from the section curve at toe (end 0) or heel (end 1)."""
        outline = self.outline[end]
        sag: Array = (
            0.125 * np.interp(0.5 * (a + b), np.linspace(0.0, self.extent, outline.size), outline) * (b - a) ** 2
        )
        return sag


def _height(form: Array, away: Array) -> Array:
    """Return the signed distances (...,), mm, of the middles of edges with vectors `away` (..., 2), by L, M, N (3, ...)."""
    ds, dt = away[..., 0], away[..., 1]
    height: Array = 0.125 * ((form[0] * ds + 2.0 * form[1] * dt) * ds + form[2] * dt**2)
    return height


def _edges(first: Array | None, middle: Array, last: Array | None, away: Array) -> tuple[Array, Array | None]:
    """Return the signed distances (...,), mm, of the middles of edges, and the largest distances (...,), mm, on the edges.

    - first, middle, last: L, M, N (3, ...) at the start, middle and end of the edges; the ends may be None, and the middle
      is then the farthest point of the edge.
    - away: vectors (..., 2) of the edges.
    """
    if first is None or last is None:
        return _height(middle, away), None
    # the heights at a quarter and three quarters of the edge are 3/8 of these sums
    start_part, end_part = _height((first + 2.0 * middle) / 6.0, away), _height((2.0 * middle + last) / 6.0, away)
    height = start_part + end_part
    beside = np.maximum(np.abs(3.0 * start_part + end_part), np.abs(start_part + 3.0 * end_part))
    return height, np.maximum(np.abs(height), 0.375 * beside)


def _round(values: Sequence[Array], following: Index, open_: Index) -> Array:
    """Return values (3, J, K) at the three sides of the triangles around a node.

    - values: at the sides opposite to the node (J, K), at the sides to the next corner (J, K), and at the sides to the last
      corner of open triangles (O, K).
    - following: triangle (J,) that shares the side to the last corner.
    - open_: triangles (O,) without a following triangle.
    """
    base, to_after, lone = values
    sides = np.empty((3, *to_after.shape))
    sides[0], sides[1], sides[2] = base, to_after, to_after[following]
    sides[2, open_] = lone
    return sides


def _worst(middles: Array, sizes: Array | None, areas: Array) -> Array:
    """Return the largest distances (...,) of triangles; inf for triangles without area.

    - middles: signed distances (3, ...) at the middles of the sides.
    - sizes: largest distances (3, ...) on the sides, if they are not at the middles.
    - areas: areas (...,) in the (s, t) plane.
    """
    errors = peaks(middles.reshape(3, -1)).reshape(areas.shape)
    if sizes is not None:
        np.maximum(errors, sizes.max(axis=0), out=errors)
    errors[~(areas > FLAT_AREA)] = np.inf
    return errors
