"""Contact lines that bend: followed step by step both ways from one point, and cut to the pieces that lie on both flanks.

A line on a worm wheel runs along the whole face while its station on the worm hardly changes. It may leave the tooth over the
throat and enter it again, so that it has pieces. A step goes along the tangent of the line, in which the flanks do not part, and
back to the line.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.meshing import Bound, Conditions, Touch
from gearmesh.contact.conditions.refinement import EDGE_SLACK, margins
from gearmesh.contact.pair import Pair
from gearmesh.errors import Solution
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.curvature import contact_ellipse, relative_curvature, tangent_basis
from gearmesh.kernel.surface.nearest import tangential
from gearmesh.records import dataclass

#: steps each way over a length of a flank
STEPS_PER_LENGTH = 24
#: steps each way at most
MAX_STEPS = 48
#: residual (mm) while a line is followed
FOLLOWING_TOLERANCE_MM = 1e-5
#: distance beyond the flanks, by a flank's length, to which a line is followed because it may enter them again
MAX_BEYOND_FLANKS = 0.35
#: rounds that space the points of followed lines equally
SPACING_ROUNDS = 6
#: distance between neighbours on a line, in stations of the face, up to which they are connected
MAX_NEIGHBOUR_STATIONS = 4.0
#: difference of phi2 (rad) between points of one line that is rounding
SAME_PHI2_RAD = 1e-8
#: stations beyond the known points that are solved for from them
STATIONS_AHEAD = 6
#: evaluations of a point of a line at a station at most
MAX_EVALUATIONS = 15


@dataclass(frozen=True)
class LinePieces:
    """Pieces of contact lines: number `line` (Q,) of the line of each piece, unknowns `x` (Q, K, 5), and `length` (Q,), mm.

    The pieces of a line are in order along it, and their K points equally spaced from end to end.
    """

    line: NDArray[np.intp]
    x: Array
    length: Array


def directions(pair: Pair, touch: Touch) -> tuple[Array, Array]:
    """Return unit vectors (M, 3), fixed frame, along and across the contact lines through places (M,) of contact."""
    one, two = touch.fixed
    e1, e2 = tangent_basis(one)
    ellipse = contact_ellipse(relative_curvature(one, two, e1, e2), e1, e2, pair.delta)
    return ellipse.major, ellipse.minor


def pieces(pair: Pair, plain: Conditions, x: Array, count: int) -> LinePieces:
    """Solve for the pieces of the lines through x (M, 5) that lie on both flanks, with `count` points in each piece.

    `plain` are the conditions at these positions. Any place of a line may start the search.
    """
    states = np.full((len(x), 2 * MAX_STEPS + 1, 5), np.nan)
    over_face, good, start = _over_face(pair, plain, x) if pair.wound else (states, np.zeros(len(x), dtype=bool), x)
    if good.any():
        states[good, : over_face.shape[1]] = over_face[good]
    rest = np.flatnonzero(~good)
    if rest.size:
        states[rest] = _over_face_first(pair, plain.repeat(rest), _follow(pair, plain.repeat(rest), start[rest]))
    own = _pieces(pair, plain, np.arange(len(x)), states, count)
    # cut the pieces again, because a gap may lie between two steps; on followed lines each round also makes the chords more equal,
    # by a factor of about 40
    for _ in range(SPACING_ROUNDS if rest.size else 1):
        own = _pieces(pair, plain, own.line, own.x, count)
    return own


def _over_face_first(pair: Pair, plain: Conditions, states: Array) -> Array:
    """Order the points of lines (L, S, 5), NaN without a point, from the beginning to the end of the gear's face."""
    first, last = (np.isfinite(way[..., 0]).argmax(axis=1) for way in (states, states[:, ::-1]))
    every = np.arange(len(states))
    ends = np.concatenate((states[every, first], states[every, -1 - last]))
    station = pair.gear.axial.value(plain.touch(ends, np.tile(every, 2)).own[1].r)
    falls = (station[len(states) :] - station[: len(states)]) * np.subtract(*pair.gear.extent[::-1]) < 0.0
    return np.where(falls[:, None, None], states[:, ::-1], states)


def _pieces(pair: Pair, plain: Conditions, line: NDArray[np.intp], states: Array, count: int) -> LinePieces:
    """Cut lines (L,) with points `states` (L, S, 5) in order along them, NaN without a point, to pieces on both flanks."""
    outside = np.full(states.shape[:2], np.inf)
    there = np.nonzero(np.isfinite(states[..., 0]))
    by_edge, past = margins(
        pair, plain.repeat(line[there[0]]).touch(states[there], np.arange(len(there[0]))), states[there]
    )
    outside[there] = np.maximum(by_edge.max(axis=1), past)
    inside = np.pad(outside <= EDGE_SLACK, ((0, 0), (1, 1))).astype(int)
    row, first = np.nonzero(np.diff(inside, axis=1) > 0)
    last = np.nonzero(np.diff(inside, axis=1) < 0)[1] - 1
    # cut both ends of all pieces in one batch
    rows, inner, outer = np.tile(row, 2), np.concatenate((first, last)), np.concatenate((first - 1, last + 1))
    ends, beyond = states[rows, inner], np.clip(outer, 0, states.shape[1] - 1)
    cut = np.flatnonzero((beyond == outer) & np.isfinite(states[rows, beyond, 0]))
    ends[cut] = _cut(pair, plain, line[rows[cut]], states[rows[cut], outer[cut]], ends[cut])
    between = [
        np.concatenate((begin[None], states[i, j : k + 1], end[None]))
        for i, j, k, begin, end in zip(row, first, last, *np.split(ends, 2), strict=True)
    ]
    return _evenly(pair, plain, line[row], between, count)


def line_over_face(pair: Pair, plain: Conditions, x: Array, stations: Array) -> tuple[Array, NDArray[np.bool_], Touch]:
    """Solve for points (M, S, 5) of the lines through x (M, 5) at stations (S,) or (M, S) of the gear, mm.

    Also returns True (M, S) for points that are found, and both flanks at the points (M S).
    """
    shape = len(x), stations.shape[-1]
    rows = np.repeat(np.arange(shape[0]), shape[1])
    repeated = plain.repeat(rows)
    bound = Bound(1, pair.gear.axial, np.broadcast_to(stations, shape).ravel())
    across = directions(pair, plain.touch(x, np.arange(len(x))))[1]
    solution = newton.solve(
        replace(repeated, bounds=(bound,), across=across[rows]),
        x[rows],
        tolerance=pair.tolerance,
        max_step=pair.max_step,
        max_evaluations=MAX_EVALUATIONS,
    )
    touch = repeated.touch(solution.values, np.arange(len(rows)))
    one, two = touch.fixed
    there: NDArray[np.bool_] = solution.converged & (dot(one.n, two.n) < 0.0)
    return solution.values.reshape(*shape, 5), there.reshape(shape), touch


def _over_face(pair: Pair, plain: Conditions, x: Array) -> tuple[Array, NDArray[np.bool_], Array]:
    """Solve for points (M, S, 5) of lines through x (M, 5) at stations over the gear's face.

    Also returns True (M,) for complete lines, which run over the whole face without gaps, and places (M, 5) from which to follow
    the other lines. Such a place is the deepest point of the line inside both flanks, or x.
    """
    stations = np.linspace(*pair.gear.extent, 2 * STEPS_PER_LENGTH + 1)
    states, there, touch = line_over_face(pair, plain, x, stations)
    steps = np.linalg.norm(np.diff(touch.fixed[0].r.reshape(*there.shape, 3), axis=1), axis=-1)
    good = there.all(axis=1) & (steps < 2.0 * 4.0 * pair.length / STEPS_PER_LENGTH).all(axis=1)
    start, left = x.copy(), np.flatnonzero(~good)
    if left.size:
        own, here = states[left], plain.repeat(left)
        held = _from_neighbours(pair, here, x[left], own, there[left], stations)
        states[left], good[left] = own, held.all(axis=1)
        rows = np.repeat(np.arange(left.size), stations.size)
        outside, past = margins(
            pair, here.repeat(rows).touch(own.reshape(-1, 5), np.arange(rows.size)), own.reshape(-1, 5)
        )
        margin = np.where(held, np.maximum(outside.max(axis=1), past).reshape(held.shape), np.inf)
        inside = np.flatnonzero(margin.min(axis=1) <= EDGE_SLACK)
        start[left[inside]] = own[inside, margin[inside].argmin(axis=1)]
    return states, good, start


def _from_neighbours(
    pair: Pair, plain: Conditions, x: Array, states: Array, there: NDArray[np.bool_], stations: Array
) -> NDArray[np.bool_]:
    """Return True (M, S) for points of lines at stations (S,) that are connected with the places x (M, 5).

    `states` (M, S, 5) are known points where `there` (M, S) is True. Points beyond the ends of a connected part are solved for from
    its ends, and put into `states` and `there`.
    """
    every, near = np.arange(len(x)), MAX_NEIGHBOUR_STATIONS * abs(stations[1] - stations[0])
    rows, middle = np.repeat(every, stations.size), plain.touch(x, every).fixed[0].r[:, None]
    repeated, known = plain.repeat(rows), 0
    while True:
        r = repeated.touch(states.reshape(-1, 5), np.arange(rows.size)).fixed[0].r.reshape(*there.shape, 3)
        # a point beside the line has another phi2
        there &= np.abs(states[..., 4] - x[:, None, 4]) < SAME_PHI2_RAD
        away = np.where(there, np.linalg.norm(r - middle, axis=-1), np.inf)
        gaps = ~(there[:, 1:] & there[:, :-1]) | (np.linalg.norm(np.diff(r, axis=1), axis=-1) >= near)
        run, nearest = np.pad(np.cumsum(gaps, axis=1), ((0, 0), (1, 0))), away.argmin(axis=1)
        held: NDArray[np.bool_] = there & (run == run[every, nearest][:, None]) & (away[every, nearest] < near)[:, None]
        line, k = np.nonzero(held.any(axis=1, keepdims=True) & ~held)
        ends = held.argmax(axis=1), stations.size - 1 - held[:, ::-1].argmax(axis=1)
        end = np.where(k < ends[0][line], ends[0][line], ends[1][line])
        close = np.flatnonzero(np.abs(k - end) <= STATIONS_AHEAD)
        if not close.size or held.sum() == known:
            return held
        known, line, k, end = held.sum(), line[close], k[close], end[close]
        values, solved, _ = line_over_face(pair, plain.repeat(line), states[line, end], stations[k][:, None])
        states[line, k], there[line, k] = values[:, 0], solved[:, 0]


def _follow(pair: Pair, plain: Conditions, x: Array) -> Array:
    """Follow the lines through x (M, 5) both ways; return points (M, 2 MAX_STEPS + 1, 5), NaN beyond the ends."""
    count = len(x)
    full, length = np.full((count, 2 * MAX_STEPS + 1, 5), np.nan), 4.0 * pair.length
    full[:, MAX_STEPS] = x
    position = np.tile(np.arange(count), 2)
    way = np.repeat([1, -1], count)
    at, active = x[position].copy(), np.arange(2 * count)
    heading = directions(pair, plain.touch(x, np.arange(count)))[0][position] * way[:, None]
    step = length / STEPS_PER_LENGTH
    for k in range(1, MAX_STEPS + 1):
        which = position[active]
        here = plain.repeat(which)
        there = here.touch(at[active], np.arange(len(active)))
        fixed, along = there.fixed, directions(pair, there)[0]
        along *= np.sign(dot(along, heading[active]))[:, None]
        guess = at[active].copy()
        for member, jet in enumerate(fixed):
            guess[:, 2 * member], guess[:, 2 * member + 1] = (
                guess[:, 2 * member + i] + step * d for i, d in enumerate(tangential(jet, along))
            )
        solution = _sections(pair, here, guess, FOLLOWING_TOLERANCE_MM)
        touch = here.touch(solution.values, np.arange(len(active)))
        outside, past = margins(pair, touch, solution.values)
        moved = np.linalg.norm(touch.fixed[0].r - fixed[0].r, axis=-1)
        good = solution.converged & (moved < 2.0 * step) & (moved > 0.3 * step) & (past < length)
        good &= dot(touch.fixed[0].n, touch.fixed[1].n) < 0.0
        own = active[good]
        at[own], heading[own] = solution.values[good], along[good]
        full[position[own], MAX_STEPS + k * way[own]] = at[own]
        active = active[good & (outside.max(axis=1) < MAX_BEYOND_FLANKS * length)]
        if not active.size:
            break
    return full


@dataclass(frozen=True)
class LineSections:
    """Conditions of the points in which contact lines cross planes; normals of the flanks must agree only across the line."""

    #: conditions of contact
    plain: Conditions
    #: points (M, 3) of the planes, fixed frame, mm
    at: Array
    #: normals (M, 3) of the planes, along the lines
    along: Array
    #: directions (M, 3) across the lines
    across: Array

    def __call__(self, x: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
        """Return residuals (M, 5), mm, and Jacobians (M, 5, 5) of the positions `index` (M,)."""
        touch, f, jacobian, _ = self.plain.with_phi1(x, index)
        one = touch.fixed[0]
        along, (e1, e2) = self.along[index], tangent_basis(one)
        c1, c2 = (dot(self.across[index], e) for e in (e1, e2))
        f[:, 3] = c1 * f[:, 3] + c2 * f[:, 4]
        jacobian[:, 3] = c1[:, None] * jacobian[:, 3] + c2[:, None] * jacobian[:, 4]
        f[:, 4], jacobian[:, 4] = dot(one.r - self.at[index], along), 0.0
        jacobian[:, 4, 0], jacobian[:, 4, 1] = dot(one.r_u, along), dot(one.r_v, along)
        return f, jacobian


def _sections(pair: Pair, here: Conditions, guess: Array, tolerance: float) -> Solution:
    """Solve for points (M, 5) of lines in the planes across the lines through `guess` (M, 5)."""
    touch = here.touch(guess, np.arange(len(guess)))
    along, across = directions(pair, touch)
    return newton.solve(
        LineSections(here, touch.fixed[0].r, along, across), guess, tolerance=tolerance, max_iterations=12, halvings=3
    )


def _cut(pair: Pair, plain: Conditions, line: NDArray[np.intp], outer: Array, inner: Array) -> Array:
    """Solve for the points (K, 5) at which lines (K,) leave the flanks, between points outside and inside; NaN without a root."""
    if not len(line):
        return np.empty((0, 5))
    here = plain.repeat(line)
    every = np.arange(len(line))
    there = here.touch(inner, every)
    across = directions(pair, there)[1]
    beyond, within = margins(pair, here.touch(outer, every), outer)[0], margins(pair, there, inner)[0]
    own, edge = np.nonzero((beyond > EDGE_SLACK) & np.isfinite(within))
    share = np.clip(beyond[own, edge] / (beyond[own, edge] - within[own, edge]), 0.0, 1.0)[:, None]
    start = outer[own] + share * (inner[own] - outer[own])
    choice = np.stack((pair.numbers[edge], np.full_like(edge, -1)), axis=-1)
    repeated = here.repeat(own)
    at_edge = replace(repeated, bounds=pair.all_bounds, across=across[own], choice=choice)
    solution = newton.solve(at_edge, start, tolerance=pair.tolerance, max_step=pair.max_step, max_iterations=15)
    outside, past = margins(pair, repeated.touch(solution.values, np.arange(len(own))), solution.values)
    good = solution.converged & (outside <= EDGE_SLACK).all(axis=1) & (past <= EDGE_SLACK)
    ends = np.full((len(line), 5), np.nan)
    ends[own[good]] = solution.values[good]
    return ends


def _evenly(pair: Pair, plain: Conditions, line: NDArray[np.intp], chains: list[Array], count: int) -> LinePieces:
    """Return pieces with `count` equally spaced points from chains of points (K, 5), one chain for each piece."""
    sizes = [len(chain) for chain in chains]
    if not chains:
        return LinePieces(line, np.empty((0, count, 5)), np.empty(0))
    every = plain.repeat(np.repeat(line, sizes)).touch(np.concatenate(chains), np.arange(sum(sizes))).fixed[0].r
    guesses, length = np.empty((len(line), count, 5)), np.empty(len(line))
    for q, (chain, r) in enumerate(zip(chains, np.split(every, np.cumsum(sizes)[:-1]), strict=True)):
        way = np.r_[0.0, np.linalg.norm(np.diff(r, axis=0), axis=-1).cumsum()]
        length[q] = way[-1]
        places = np.linspace(0.0, way[-1], count)
        guesses[q] = np.stack([np.interp(places, way, column) for column in chain.T], axis=-1)
    solution = _sections(pair, plain.repeat(np.repeat(line, count)), guesses.reshape(-1, 5), pair.tolerance)
    good = solution.converged.reshape(len(line), count).all(axis=1) & (length > EDGE_SLACK)
    return LinePieces(line[good], solution.values.reshape(guesses.shape)[good], length[good])
