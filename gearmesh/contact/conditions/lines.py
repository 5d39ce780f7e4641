"""Line contact: the line along which two flanks touch, cut to the part that both of them have.

Where the surfaces touch along a line the five conditions of a point leave one unknown free. It is fixed by where on the line the
point shall lie: on an edge of either flank, which gives the ends of the line, or at a station between them. The normals then need
to agree only across the line.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.meshing import Bound, Conditions
from gearmesh.contact.conditions.refinement import EDGE_SLACK, RCOND, at_positions, margins
from gearmesh.contact.pair import Pair
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.curvature import contact_ellipse, relative_curvature, tangent_basis

#: points by which a line is given, its ends among them
LINE_POINTS = 13
#: a line whose ends' stations differ by less than this share of its length is not followed by stations
STEEP = 0.1


@dataclass(frozen=True)
class ContactLines:
    """Of positions with line contact (M,): `points`, for each None or (LINE_POINTS, 3), fixed frame, mm, from end to end; unknowns
    `x` (M, 5) at the middle, where the line has two ends on the flanks, else as given."""

    points: list[Array | None]
    x: Array


def trace(pair: Pair, phi1: Array, x: Array) -> ContactLines:
    """The lines through solutions x (M, 5) at phi1 (M,)."""
    every = np.arange(len(x))
    plain = Conditions(pair.flanks, phi1, pair.length)
    along, across = directions(pair, plain, x)
    ends, places = _ends(pair, plain, x, along, across)
    points: list[Array | None] = [None] * len(x)
    there = np.flatnonzero(np.isfinite(places).all(axis=1) & (places[:, 1] - places[:, 0] > EDGE_SLACK))
    middle = x.copy()
    if there.size:
        share = np.linspace(0.0, 1.0, LINE_POINTS)[:, None]
        start = ends[there, None, 0] + share * (ends[there, None, 1] - ends[there, None, 0])
        unknowns = _between(pair, plain, start, across[there], there)
        r = plain.touch(unknowns.reshape(-1, 5), np.repeat(there, LINE_POINTS)).fixed[0].r
        for k, row in zip(there, r.reshape(-1, LINE_POINTS, 3), strict=True):
            points[k] = row
        middle[there] = unknowns[:, LINE_POINTS // 2]
    solution = newton.solve(partial(at_positions, plain, every), middle, tolerance=pair.tolerance, rcond=RCOND)
    return ContactLines(points, np.where(solution.converged[:, None], solution.values, x))


def directions(pair: Pair, conditions: Conditions, x: Array) -> tuple[Array, Array]:
    """Unit vectors (M, 3), fixed frame, along and across the lines through x (M, 5)."""
    one, two = conditions.touch(x, np.arange(len(x))).fixed
    e1, e2 = tangent_basis(one)
    ellipse = contact_ellipse(relative_curvature(one, two, e1, e2), e1, e2, pair.delta)
    return ellipse.major, ellipse.minor


def on_edges(pair: Pair, conditions: Conditions, across: Array, x: Array) -> dict[int, tuple[Array, NDArray[np.bool_]]]:
    """Where the lines through x (M, 5), with directions `across` (M, 3), meet the edges, by number in `Pair.bounds`: unknowns
    (M, 5), and whether that is so (M,)."""
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
    """Ends (M, 2, 5) of the lines on both flanks, and their places (M, 2), mm, along them; NaN where there are none."""
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


def _between(pair: Pair, plain: Conditions, start: Array, across: Array, which: NDArray[np.intp]) -> Array:
    """Points (M, LINE_POINTS, 5) of lines from their places on the straight way between their ends."""
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
    steep = np.abs(station[:, -1] - station[:, 0]) < STEEP * pair.length
    values = guess.copy()
    gentle = np.flatnonzero(~steep[rows])
    if gentle.size:
        solution = newton.solve(
            partial(at_positions, by_station, gentle), guess[gentle], tolerance=pair.tolerance, max_step=pair.max_step
        )
        values[gentle] = np.where(solution.converged[:, None], solution.values, guess[gentle])
    rest = np.flatnonzero(steep[rows])
    if rest.size:
        solution = newton.solve(
            partial(at_positions, plain, position[rest]), guess[rest], tolerance=pair.tolerance, rcond=RCOND
        )
        values[rest] = solution.values
    return values.reshape(count, LINE_POINTS, 5)
