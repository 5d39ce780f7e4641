"""Close upper bounds of the advance about sampled places, from polynomials through 5 x 5 nodes of the sampled field.

Second differences bound the advance between nodes, but too high by far where the flanks nearly touch along a line: the advance
bends much across this ridge and rises slowly along it. A polynomial knows both. It knows nothing of a jump of slope or curvature
between nodes: flanks with such breaks have no windows. A place inside the flanks is bounded by the summits of its polynomial, if
there are any, and a place on an edge by the highest points along this edge.
"""

from __future__ import annotations

from dataclasses import fields

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, distinct
from gearmesh.records import dataclass

#: nodes from the middle of a window to its rim
HALF_WINDOW = 2
#: points of a window in each of its rows, two in a step of the grid
WINDOW_POINTS = 9
#: distance in steps along rows and columns within which every place of a window has a point, half more than needed
POINT_REACH = 0.375
#: share of fourth differences that counts as error of a polynomial and of its slopes: those of a cubic in the middle of a window
FOURTH_SHARE = 0.1
#: line of a place inside both flanks; limits of the gear count from 0, ends of the pinion's grid from FIRST_ROW
INSIDE_LINE, FIRST_ROW, LAST_ROW, FIRST_COLUMN, LAST_COLUMN = -1, 4, 5, 6, 7
#: line of a place whose window bounds nothing
NO_LINE = -2
#: places whose windows are evaluated at once
WINDOWS_AT_ONCE = 256


def _powers() -> tuple[Array, Array, Array, Array]:
    """Return places (P,) of points along a window, and weights (P, 5) of its nodes for values, slopes and bends there."""
    nodes = np.arange(-HALF_WINDOW, HALF_WINDOW + 1.0)
    points = np.linspace(nodes[0], nodes[-1], WINDOW_POINTS)
    count = len(nodes)
    order, to_powers = np.arange(count), np.linalg.inv(np.vander(nodes, count, increasing=True))
    value = np.vander(points, count, increasing=True)
    slope, bend = np.zeros_like(value), np.zeros_like(value)
    slope[:, 1:] = order[1:] * value[:, :-1]
    bend[:, 2:] = order[2:] * order[1:-1] * value[:, :-2]
    return points, value @ to_powers, slope @ to_powers, bend @ to_powers


#: places of the points along a window, and weights of its nodes for values, slopes and bends there
POINT_PLACES, VALUE_WEIGHTS, SLOPE_WEIGHTS, BEND_WEIGHTS = _powers()


def _of_nodes(by_row: Array, by_column: Array) -> Array:
    """Return weights (P P, 25) of the nodes of a window for products of weights (P, 5) along rows and columns."""
    weights: Array = np.einsum("ia,jb->ijab", by_row, by_column).reshape(len(by_row) * len(by_column), -1)
    return weights


#: weights of the nodes for values at the points of a window
VALUES_OF_NODES = _of_nodes(VALUE_WEIGHTS, VALUE_WEIGHTS)
#: the same for values, slopes by row and column, and second derivatives by rows, by both, and by columns
FIELD_OF_NODES = np.concatenate(
    [
        _of_nodes(by_row, by_column)
        for by_row, by_column in (
            (VALUE_WEIGHTS, VALUE_WEIGHTS),
            (SLOPE_WEIGHTS, VALUE_WEIGHTS),
            (VALUE_WEIGHTS, SLOPE_WEIGHTS),
            (BEND_WEIGHTS, VALUE_WEIGHTS),
            (SLOPE_WEIGHTS, SLOPE_WEIGHTS),
            (VALUE_WEIGHTS, BEND_WEIGHTS),
        )
    ]
)
#: fourth differences of five nodes
FOURTH_DIFFERENCE = np.array([1.0, -4.0, 6.0, -4.0, 1.0])


@dataclass(frozen=True)
class Windows:
    """Nodes about C places of a sampled field."""

    #: advances (C, 25), rad
    advance: Array
    #: distances (C, 4, 25), mm, outside the limits of the gear's flank
    beyond: Array
    #: rows and columns (C, 2) of the places, from the middle of their windows
    place: Array
    #: steps (C,) around the places that are bounded
    around: NDArray[np.intp]
    #: lines (C,) on which the places lie
    line: NDArray[np.intp]
    #: errors (C,) of the advances, rad
    error: Array

    @staticmethod
    def of(
        advance: Array,
        beyond: Array,
        position: NDArray[np.intp],
        place: Array,
        around: NDArray[np.intp],
        line: NDArray[np.intp],
        error: float = 0.0,
    ) -> Windows:
        """Return the windows of a field (N, I, J) and its distances (4, N, I, J) about places (C, 2) of positions (C,)."""
        rows, columns = advance.shape[1:]
        errors = np.full(len(place), error)
        last = np.array((rows, columns)) - 1 - HALF_WINDOW
        if (last < HALF_WINDOW).any() or (line == NO_LINE).all():
            empty, line = np.full((len(place), 25), np.nan), np.full(len(place), NO_LINE)
            return Windows(empty, np.repeat(empty[:, None], 4, axis=1), place, around, line, errors)
        middle = np.clip(np.rint(place).astype(np.intp), HALF_WINDOW, last)
        first = (position * rows + middle[:, 0]) * columns + middle[:, 1]
        steps = np.arange(-HALF_WINDOW, HALF_WINDOW + 1)
        nodes = first[:, None] + (columns * steps[:, None] + steps).ravel()
        around_nodes = np.moveaxis(beyond.reshape(4, -1)[:, nodes], 0, 1)
        return Windows(advance.reshape(-1)[nodes], around_nodes, place - middle, around, line, errors)

    def __getitem__(self, which: NDArray[np.intp]) -> Windows:
        return Windows(*(getattr(self, field.name)[which] for field in fields(self)))

    @staticmethod
    def join(parts: list[Windows]) -> Windows:
        """Return the windows of several fields, one after the other."""
        return Windows(*(np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(Windows)))

    def most(self, slack: float) -> Array:
        """Return upper bounds (C,), rad, of the advance about the places, inf where nodes are missing.

        The bound of a place inside both flanks is -inf if the advance has no summit about it. Points count that are no more than
        `slack`, mm, outside a limit.
        """
        most = np.full(len(self.line), np.inf)
        known = np.isfinite(self.advance).all(axis=1) & (self.line != NO_LINE)
        for line in distinct(self.line[known]):
            own = np.flatnonzero(known & (self.line == line))
            for k in range(0, own.size, WINDOWS_AT_ONCE):
                part = own[k : k + WINDOWS_AT_ONCE]
                most[part] = self[part]._most(int(line), slack)
        return most

    def _most(self, line: int, slack: float) -> Array:
        """Return the bounds of `most` for places that all lie on one line."""
        nodes = self.advance.reshape(-1, 5, 5)
        fourth = np.abs(nodes.transpose(0, 2, 1) @ FOURTH_DIFFERENCE).max(axis=1)
        fourth += np.abs(nodes @ FOURTH_DIFFERENCE).max(axis=1)
        error = FOURTH_SHARE * fourth + self.error
        field = (self.advance @ FIELD_OF_NODES.T).reshape(-1, 6, WINDOW_POINTS, WINDOW_POINTS)
        about = np.abs(POINT_PLACES - self.place[..., None]) <= self.around[:, None, None] + 1e-9
        counts = about[:, 0, :, None] & about[:, 1, None, :]
        level = self._inside(counts, line, slack)
        if line == INSIDE_LINE:
            heights = _summits(field, error, counts)
        elif line < FIRST_ROW:
            assert level is not None
            heights = _along_limit(field, level, counts)
        else:
            end, row = 0 if line in (FIRST_ROW, FIRST_COLUMN) else -1, line in (FIRST_ROW, LAST_ROW)
            on_rim = field[:, :, end] if row else field[:, :, :, end]
            value, slope_i, slope_j, bend_i, _, bend_j = np.moveaxis(on_rim, 1, 0)
            rise = _rise(slope_j, bend_j) if row else _rise(slope_i, bend_i)
            own = counts[:, end] if row else counts[:, :, end]
            heights = np.where(own, value + rise, -np.inf).max(axis=1)
        bound: Array = heights + error
        return bound

    def _inside(self, counts: NDArray[np.bool_], line: int, slack: float) -> Array | None:
        """Take points (C, P, P) outside the limits from those that count; return distances (C, P, P), mm, outside a limit."""
        level = None
        for k in range(self.beyond.shape[1]):
            nodes = self.beyond[:, k]
            own = np.arange(len(nodes)) if k == line else np.flatnonzero((nodes > slack).any(axis=1))
            if not own.size:
                continue
            distance = (nodes[own] @ VALUES_OF_NODES.T).reshape(-1, WINDOW_POINTS, WINDOW_POINTS)
            if k == line:
                level = distance
                continue
            square = nodes[own].reshape(-1, 5, 5)
            change = (np.ptp(square, axis=1).max(axis=1) + np.ptp(square, axis=2).max(axis=1)) / (2 * HALF_WINDOW)
            counts[own] &= distance <= (slack + POINT_REACH * change)[:, None, None]
        return level


def _rise(slope: Array, bend: Array) -> Array:
    """Return the greatest rise (...,) of parabolas with slopes and bends (...,) within POINT_REACH."""
    with np.errstate(all="ignore"):
        vertex = 0.5 * slope**2 / -bend
    steep = np.abs(slope)
    inside = (bend < 0.0) & (steep <= -bend * POINT_REACH)
    return np.where(inside, vertex, POINT_REACH * (steep + 0.5 * bend * POINT_REACH))


def _summits(field: Array, error: Array, counts: NDArray[np.bool_]) -> Array:
    """Return the heights (C,), rad, of summits of polynomials (C, 6, P, P) near points that count, -inf without one.

    Slopes across and along the ridge vanish near the points of a summit, as far as the bends and the `error` (C,) allow.
    """
    value, slope_i, slope_j, bend_i, twist, bend_j = np.moveaxis(field, 1, 0)
    half, mean = 0.5 * (bend_i - bend_j), 0.5 * (bend_i + bend_j)
    size = np.hypot(half, twist)
    # the first axis has the algebraically greater bend
    angle = 0.5 * np.arctan2(twist, half)
    c, s = np.cos(angle), np.sin(angle)
    reach = POINT_REACH * (np.abs(c) + np.abs(s))
    slack = error[:, None, None]
    near, rise = counts, np.zeros(value.shape)
    for slope, bend in ((c * slope_i + s * slope_j, mean + size), (c * slope_j - s * slope_i, mean - size)):
        near = near & (np.abs(slope) <= np.abs(bend) * reach + slack)
        rise += _rise(slope, bend)
    heights: Array = np.where(near, value + rise, -np.inf).max(axis=(1, 2))
    return heights


def _along_limit(field: Array, level: Array, counts: NDArray[np.bool_]) -> Array:
    """Return the greatest heights (C,), rad, of polynomials (C, 6, P, P) where a `level` (C, P, P) is 0, -inf if nowhere."""
    most = np.full(len(field), -np.inf)
    spacing = POINT_PLACES[1] - POINT_PLACES[0]
    tangent_i, tangent_j = -np.gradient(level, axis=2), np.gradient(level, axis=1)
    length = np.hypot(tangent_i, tangent_j)
    value, slope_i, slope_j, bend_i, twist, bend_j = np.moveaxis(field, 1, 0)
    with np.errstate(all="ignore"):
        tangent_i, tangent_j = tangent_i / length, tangent_j / length
        slope = slope_i * tangent_i + slope_j * tangent_j
        bend = bend_i * tangent_i**2 + 2.0 * twist * tangent_i * tangent_j + bend_j * tangent_j**2
        for axis, along in ((1, bend_i), (2, bend_j)):
            a, b = (np.s_[:, :-1], np.s_[:, 1:]) if axis == 1 else (np.s_[:, :, :-1], np.s_[:, :, 1:])
            crossed = ((level[a] <= 0.0) != (level[b] <= 0.0)) & (counts[a] | counts[b])
            share = level[a] / (level[a] - level[b])
            there = value[a] + share * (value[b] - value[a])
            there -= 0.25 * share * (1.0 - share) * (along[a] + along[b]) * spacing**2
            rise = _rise(slope[a] + share * (slope[b] - slope[a]), bend[a] + share * (bend[b] - bend[a]))
            np.maximum(most, np.where(crossed, there + rise, -np.inf).max(axis=(1, 2)), out=most)
    return most
