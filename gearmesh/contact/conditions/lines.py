"""Line contact: the line along which two flanks touch, cut to the part on both flanks.

The five conditions of a point leave one unknown free where the surfaces touch along a line. A place on the line fixes it: an edge
of a flank gives an end of the line, a station gives a point between the ends. The normals then need to agree only across the line.
Lines that bend too much for this are followed step by step (`bent_lines.py`).
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.bent_lines import directions, pieces
from gearmesh.contact.conditions.meshing import Bound, Conditions
from gearmesh.contact.conditions.refinement import EDGE_SLACK, NULL_SPACE_SHARE, at_positions, margins
from gearmesh.contact.pair import Pair
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, distinct, dot
from gearmesh.records import dataclass

#: points of a line, with its ends
LINE_POINTS = 13
#: difference of stations between the ends of a line, by a flank's length, below which stations do not fix its points
MIN_STATION_SHARE = 0.1
#: distance (mm) beyond the flanks up to which a point of a line counts
FLANK_SLACK_MM = 1e-6


@dataclass(frozen=True)
class ContactLines:
    """Contact lines at M positions.

    `points` holds for each position None or points (K, 3), fixed frame, mm, from end to end: LINE_POINTS for every piece, with NaN
    between pieces. `x` (M, 5) are the unknowns at the middle of the longest piece; they stay as given where no piece is found.
    """

    points: list[Array | None]
    x: Array


def trace(pair: Pair, phi1: Array, x: Array) -> ContactLines:
    """Solve for the contact lines through solutions x (M, 5) at phi1 (M,), rad."""
    every = np.arange(len(x))
    plain = Conditions(pair.flanks, phi1, pair.length)
    along, across = directions(pair, plain.touch(x, every))
    # lines on wound teeth bend: their ends are not solved for directly
    if pair.wound:
        ends, places = np.full((len(x), 2, 5), np.nan), np.full((len(x), 2), np.nan)
    else:
        ends, places = _ends(pair, plain, x, along, across)
    points: list[Array | None] = [None] * len(x)
    there = np.flatnonzero(np.isfinite(places).all(axis=1) & (places[:, 1] - places[:, 0] > EDGE_SLACK))
    middle, bent = x.copy(), np.full(len(x), True)
    if there.size:
        share = np.linspace(0.0, 1.0, LINE_POINTS)[:, None]
        start = ends[there, None, 0] + share * (ends[there, None, 1] - ends[there, None, 0])
        unknowns, on_line = _between(pair, plain, start, across[there], there)
        touch = plain.touch(unknowns.reshape(-1, 5), np.repeat(there, LINE_POINTS))
        outside, past = margins(pair, touch, unknowns.reshape(-1, 5))
        on_flanks = (np.maximum(outside.max(axis=1), past) <= FLANK_SLACK_MM).reshape(-1, LINE_POINTS)
        bent[there] = ~(on_flanks & on_line).all(axis=1)
        for k, row in zip(there, touch.fixed[0].r.reshape(-1, LINE_POINTS, 3), strict=True):
            points[k] = row
        middle[there] = unknowns[:, LINE_POINTS // 2]
    _bend(pair, plain, np.flatnonzero(bent), x, points, middle)
    solution = newton.solve(
        partial(at_positions, plain, every), middle, tolerance=pair.tolerance, rcond=NULL_SPACE_SHARE
    )
    return ContactLines(points, np.where(solution.converged[:, None], solution.values, x))


def _bend(
    pair: Pair, plain: Conditions, which: NDArray[np.intp], x: Array, points: list[Array | None], middle: Array
) -> None:
    """Follow the lines `which` (B,) through x (M, 5) step by step, and put their pieces on both flanks into `points`.

    The middles of the longest pieces go into `middle` (M, 5). Lines without a piece on both flanks stay unchanged.
    """
    if not which.size:
        return
    own = pieces(pair, plain.repeat(which), x[which], LINE_POINTS)
    r = (
        plain.touch(own.x.reshape(-1, 5), np.repeat(which[own.line], LINE_POINTS))
        .fixed[0]
        .r.reshape(-1, LINE_POINTS, 3)
    )
    for k in distinct(own.line):
        parts = np.flatnonzero(own.line == k)
        gap = np.full((1, 3), np.nan)
        points[which[k]] = np.concatenate([row for part in parts for row in (r[part], gap)][:-1])
        middle[which[k]] = own.x[parts[own.length[parts].argmax()], LINE_POINTS // 2]


def on_edges(pair: Pair, conditions: Conditions, across: Array, x: Array) -> dict[int, tuple[Array, NDArray[np.bool_]]]:
    """Solve for the points at which lines through x (M, 5), with directions `across` (M, 3), meet the edges.

    Returns, by number in `Pair.bounds`, unknowns (M, 5) and True (M,) for roots that are found.
    """
    numbers = list(pair.ends)
    count, position = len(x), np.tile(np.arange(len(x)), len(numbers))
    choice = np.full((len(position), 2), -1)
    choice[:, 0] = np.repeat(pair.numbers[numbers], count)
    repeated = conditions.repeat(position)
    cut = replace(repeated, bounds=pair.all_bounds, across=across[position], choice=choice)
    solution = newton.solve(
        cut, x[position], tolerance=pair.tolerance, max_step=4.0 * pair.max_step, max_iterations=15, halvings=3
    )
    values, met = solution.values.reshape(len(numbers), count, 5), solution.converged.reshape(len(numbers), count)
    return {number: (values[k], met[k]) for k, number in enumerate(numbers)}


def _ends(pair: Pair, plain: Conditions, x: Array, along: Array, across: Array) -> tuple[Array, Array]:
    """Solve for the ends (M, 2, 5) of lines on both flanks, and their places (M, 2), mm, along the lines; NaN without an end."""
    every = np.arange(len(x))
    origin = plain.touch(x, every).fixed[0].r
    ends = np.full((len(x), 2, 5), np.nan)
    places = np.full((len(x), 2), np.nan)
    for values, met in on_edges(pair, plain, across, x).values():
        touch = plain.touch(values, every)
        outside, past = margins(pair, touch, values)
        good = met & (outside <= EDGE_SLACK).all(axis=1) & (past <= EDGE_SLACK)
        good &= dot(touch.fixed[0].n, touch.fixed[1].n) < 0.0
        place = np.where(good, dot(touch.fixed[0].r - origin, along), np.nan)
        for side, further in ((0, place < np.fmin(places[:, 0], np.inf)), (1, place > np.fmax(places[:, 1], -np.inf))):
            better = further | (good & np.isnan(places[:, side]))
            ends[better, side], places[better, side] = values[better], place[better]
    return ends, places


def _between(
    pair: Pair, plain: Conditions, start: Array, across: Array, which: NDArray[np.intp]
) -> tuple[Array, NDArray[np.bool_]]:
    """Solve for points (M, LINE_POINTS, 5) of lines from `start`, the straight way between their ends.

    Also returns True (M, LINE_POINTS) for points that are found.
    """
    count = len(start)
    rows = np.repeat(np.arange(count), LINE_POINTS)
    position = which[rows]
    guess = start.reshape(-1, 5)
    axial = pair.pinion.axial
    station = axial.value(plain.touch(guess, position).own[0].r).reshape(count, LINE_POINTS)
    target = np.linspace(station[:, 0], station[:, -1], LINE_POINTS).T
    by_station = replace(
        plain.repeat(position),
        bounds=(Bound(0, axial, target.ravel()),),
        across=np.repeat(across, LINE_POINTS, axis=0),
    )
    steep = np.abs(station[:, -1] - station[:, 0]) < MIN_STATION_SHARE * pair.length
    values, good = guess.copy(), np.full(len(guess), True)
    gentle = np.flatnonzero(~steep[rows])
    if gentle.size:
        solution = newton.solve(
            partial(at_positions, by_station, gentle), guess[gentle], tolerance=pair.tolerance, max_step=pair.max_step
        )
        values[gentle] = np.where(solution.converged[:, None], solution.values, guess[gentle])
        good[gentle] = solution.converged
    rest = np.flatnonzero(steep[rows])
    if rest.size:
        solution = newton.solve(
            partial(at_positions, plain, position[rest]), guess[rest], tolerance=pair.tolerance, rcond=NULL_SPACE_SHARE
        )
        values[rest], good[rest] = solution.values, solution.converged
    return values.reshape(count, LINE_POINTS, 5), good.reshape(count, LINE_POINTS)
