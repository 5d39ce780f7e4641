"""How far edges and triangles in the (s, t) plane of a link are from its surface, by the second form alone: an edge by an eighth
of the form in its middle, a triangle by the middles of its sides (see `measure`)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.links.collapse import FLAT, Index, area
from gearmesh.mesh.links.lines import between
from gearmesh.mesh.links.measure import peaks


@dataclass(frozen=True)
class Prediction:
    """`forms` (S, T, 3): L, M, N on uniform samples of s, from 0 to `extent`, and t; `outline` (2, S) as that of `Forms`.

    `arched`: edges by the form at their ends too, as long ones ask for: with q0, q, q1 there and in the middle the height at x is
    x (1 - x) ((q0 + 2 q) (1 - x) + (2 q + q1) x) / 6.
    """

    forms: Array
    outline: Array
    extent: float = 1.0
    arched: bool = False

    def triangles(self, a: Array, b: Array, c: Array) -> Array:
        """Distances (N,), mm, of triangles with corners (N, 2); inf where they are no triangles."""
        ends = np.stack((b, c, a)), np.stack((c, a, b))
        middle = self._forms(0.5 * (ends[0] + ends[1]))
        first, last = (self._forms(end) if self.arched else None for end in ends)
        return _worst(*_edges(first, middle, last, ends[1] - ends[0]), area(a, b, c))

    def stars(self, near: Array, places: Array, after: Array, before: Array, following: Index) -> Array:
        """Distances (J, K), mm, of triangles between nodes `after` and `before` (J, 2) and one at `places` (J, K, 2), by the
        second form with it `near` (J, 2); chords of the section curves at toe and heel included.

        `following` (J,): the triangle that begins at the node before, -1 if none does.
        """
        a, b, c, count = places, after[:, None], before[:, None], len(near)
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
        heights, sizes = (_round((edges[0][k], edges[1][k], edges[2][k]), following, open_) for k in (0, 1))
        errors = _worst(heights, sizes, area(a, b, c))
        for end in (0, 1):
            at_end = np.flatnonzero(near[:, 1] == end)
            for node in (after, before) if at_end.size else ():
                chord = at_end[node[at_end, 1] == end]
                errors[chord] = np.maximum(errors[chord], self._sag(end, a[chord, :, 0], node[chord, 0][:, None]))
        return errors

    def chords(self, places: Array) -> Array:
        """Largest distances (N,), mm, of those sides of triangles (N, 3, 2) that are chords of a section curve; 0 of others."""
        off = np.zeros(len(places))
        for end in (0, 1):
            for k in range(3):
                a, b = places[:, k], places[:, k - 1]
                on = np.flatnonzero((a[:, 1] == end) & (b[:, 1] == end))
                off[on] = np.maximum(off[on], self._sag(end, a[on, 0], b[on, 0]))
        return off

    def _forms(self, places: Array) -> Array:
        """L, M, N (3, K, N) at places (K, N, 2)."""
        return self._form(places.reshape(-1, 2)).reshape(3, *places.shape[:2])

    def _form(self, places: Array) -> Array:
        """L, M, N (3, N) at places (N, 2)."""
        return between(self.forms, places[:, 0] / self.extent, places[:, 1]).T

    def _sag(self, end: int, a: Array, b: Array) -> Array:
        """Distances (...,), mm, of chords between s a and b from the section curve at toe (0) or heel (1)."""
        outline = self.outline[end]
        sag: Array = (
            0.125 * np.interp(0.5 * (a + b), np.linspace(0.0, self.extent, outline.size), outline) * (b - a) ** 2
        )
        return sag


def _height(form: Array, away: Array) -> Array:
    """Signed distances (...,), mm, of the middles of edges `away` (..., 2) long by the second form L, M, N (3, ...) there."""
    ds, dt = away[..., 0], away[..., 1]
    height: Array = 0.125 * ((form[0] * ds + 2.0 * form[1] * dt) * ds + form[2] * dt**2)
    return height


def _edges(first: Array | None, middle: Array, last: Array | None, away: Array) -> tuple[Array, Array]:
    """Signed distances (...,), mm, of the middles of edges `away` (..., 2) long, and the largest of all, by the second forms
    (3, ...) in the middle and, where they are given, at both ends."""
    if first is None or last is None:
        height = _height(middle, away)
        return height, np.abs(height)
    one, other = _height((first + 2.0 * middle) / 6.0, away), _height((2.0 * middle + last) / 6.0, away)
    height = one + other
    beside = np.maximum(np.abs(3.0 * one + other), np.abs(one + 3.0 * other))
    return height, np.maximum(np.abs(height), 0.375 * beside)


def _round(values: tuple[Array, Array, Array], following: Index, open_: Index) -> Array:
    """Values (3, J, K) at the sides of the triangles of stars: away from the node, to the node after, and to the one before, which
    the `following` (J,) triangle has too, but for the `open_` (O,) ones, `lone` (O, K)."""
    base, to_after, lone = values
    sides = np.empty((3, *to_after.shape))
    sides[0], sides[1], sides[2] = base, to_after, to_after[following]
    sides[2, open_] = lone
    return sides


def _worst(middles: Array, sizes: Array, areas: Array) -> Array:
    """Largest distances (...,) of triangles by those of the middles of their sides (3, ...), and of the whole sides, `sizes`; inf
    without area (...,)."""
    sides = middles.reshape(3, -1)
    errors = peaks(sides.T, 4.0 / 9.0 * sides.sum(axis=0)).reshape(areas.shape)
    return np.where(areas > FLAT, np.maximum(errors, sizes.max(axis=0)), np.inf)
