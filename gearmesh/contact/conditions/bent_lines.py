"""Lines of contact that bend: followed step by step from a point of them, both ways, and cut to what both flanks have of them.

A line of a worm wheel runs along the whole face while its station on the worm hardly changes, and may leave the tooth over the
throat and enter it again: it has pieces. A step goes along the line's tangent, in which the flanks do not part, and back on to the
line.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

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

#: steps each way over a length of a flank, and in all; residual (mm) while it is followed
STEPS, MOST, ROUGH = 24, 48, 1e-5
#: how far (part of a flank's length) beyond the flanks a line is followed, to where it may enter them again
BEYOND = 0.35
#: how often points of lines that were followed are spaced evenly again
ALIKE = 6
#: neighbours on a line at stations of the face are no farther apart than this many stations, and turn the gear alike (rad)
NEAR, SAME = 4.0, 1e-8
#: stations beyond those known that are looked for from these
AHEAD = 6
#: evaluations of a point of a line at a station at most
EVALUATIONS = 15


@dataclass(frozen=True)
class LinePieces:
    """Pieces of lines (Q,): `line`, the number (Q,) of each one's line, in order along it; unknowns `x` (Q, K, 5) of points evenly
    spaced from end to end; `length` (Q,), mm."""

    line: NDArray[np.intp]
    x: Array
    length: Array


def directions(pair: Pair, touch: Touch) -> tuple[Array, Array]:
    """Unit vectors (M, 3), fixed frame, along and across the lines through places (M,) where both flanks touch."""
    one, two = touch.fixed
    e1, e2 = tangent_basis(one)
    ellipse = contact_ellipse(relative_curvature(one, two, e1, e2), e1, e2, pair.delta)
    return ellipse.major, ellipse.minor


def pieces(pair: Pair, plain: Conditions, x: Array, count: int) -> LinePieces:
    """What both flanks have of the lines through x (M, 5), at `count` points each; `plain`: the conditions at these positions.

    It does not matter which places of the lines x are.
    """
    states = np.full((len(x), 2 * MOST + 1, 5), np.nan)
    over_face, good, start = _over_face(pair, plain, x) if pair.wound else (states, np.zeros(len(x), dtype=bool), x)
    if good.any():
        states[good, : over_face.shape[1]] = over_face[good]
    rest = np.flatnonzero(~good)
    if rest.size:
        states[rest] = _over_face_first(pair, plain.repeat(rest), _follow(pair, plain.repeat(rest), start[rest]))
    own = _pieces(pair, plain, np.arange(len(x)), states, count)
    # a gap between two steps shows between the points of its piece; of what was followed the chords become alike, wherever its
    # steps were: each time their differences are some 40 times less
    for _ in range(ALIKE if rest.size else 1):
        own = _pieces(pair, plain, own.line, own.x, count)
    return own


def _over_face_first(pair: Pair, plain: Conditions, states: Array) -> Array:
    """Lines through states (L, S, 5), NaN where there are none, in the order in which the gear's face begins and ends."""
    first, last = (np.isfinite(way[..., 0]).argmax(axis=1) for way in (states, states[:, ::-1]))
    every = np.arange(len(states))
    ends = np.concatenate((states[every, first], states[every, -1 - last]))
    station = pair.gear.axial.value(plain.touch(ends, np.tile(every, 2)).own[1].r)
    falls = (station[len(states) :] - station[: len(states)]) * np.subtract(*pair.gear.extent[::-1]) < 0.0
    return np.where(falls[:, None, None], states[:, ::-1], states)


def _pieces(pair: Pair, plain: Conditions, line: NDArray[np.intp], states: Array, count: int) -> LinePieces:
    """What both flanks have of lines (L,) through states (L, S, 5) in order along them, NaN where there are none."""
    outside = np.full(states.shape[:2], np.inf)
    there = np.nonzero(np.isfinite(states[..., 0]))
    by_edge, past = margins(
        pair, plain.repeat(line[there[0]]).touch(states[there], np.arange(len(there[0]))), states[there]
    )
    outside[there] = np.maximum(by_edge.max(axis=1), past)
    inside = np.pad(outside <= EDGE_SLACK, ((0, 0), (1, 1))).astype(int)
    row, first = np.nonzero(np.diff(inside, axis=1) > 0)
    last = np.nonzero(np.diff(inside, axis=1) < 0)[1] - 1
    # both ends of all pieces at once
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
    """Points (M, S, 5) of the lines through x (M, 5) at stations (S,) or (M, S) of the gear, mm, which of them (M, S) are found,
    and both flanks there (M S)."""
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
        max_evaluations=EVALUATIONS,
    )
    touch = repeated.touch(solution.values, np.arange(len(rows)))
    one, two = touch.fixed
    there: NDArray[np.bool_] = solution.converged & (dot(one.n, two.n) < 0.0)
    return solution.values.reshape(*shape, 5), there.reshape(shape), touch


def _over_face(pair: Pair, plain: Conditions, x: Array) -> tuple[Array, NDArray[np.bool_], Array]:
    """Points (M, S, 5) of lines through x (M, 5) in order over the gear's face, NaN beyond where they end; which lines (M,) run
    from one end of it to the other without gaps, so that these are all of their points; and where to follow the others from
    (M, 5): the deepest of these points inside both flanks, if one is."""
    stations = np.linspace(*pair.gear.extent, 2 * STEPS + 1)
    states, there, touch = line_over_face(pair, plain, x, stations)
    steps = np.linalg.norm(np.diff(touch.fixed[0].r.reshape(*there.shape, 3), axis=1), axis=-1)
    good = there.all(axis=1) & (steps < 2.0 * 4.0 * pair.length / STEPS).all(axis=1)
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
    """Which points (M, S) of lines at stations (S,) hang together with the places x (M, 5) of theirs.

    `states` (M, S, 5), as far as they are `there` (M, S), are what is known; what lies beyond the ends of what hangs together is
    looked for from there, and put in its place.
    """
    every, near = np.arange(len(x)), NEAR * abs(stations[1] - stations[0])
    rows, middle = np.repeat(every, stations.size), plain.touch(x, every).fixed[0].r[:, None]
    repeated, known = plain.repeat(rows), 0
    while True:
        r = repeated.touch(states.reshape(-1, 5), np.arange(rows.size)).fixed[0].r.reshape(*there.shape, 3)
        # beside the line the gear is turned further
        there &= np.abs(states[..., 4] - x[:, None, 4]) < SAME
        away = np.where(there, np.linalg.norm(r - middle, axis=-1), np.inf)
        gaps = ~(there[:, 1:] & there[:, :-1]) | (np.linalg.norm(np.diff(r, axis=1), axis=-1) >= near)
        run, nearest = np.pad(np.cumsum(gaps, axis=1), ((0, 0), (1, 0))), away.argmin(axis=1)
        held: NDArray[np.bool_] = there & (run == run[every, nearest][:, None]) & (away[every, nearest] < near)[:, None]
        line, k = np.nonzero(held.any(axis=1, keepdims=True) & ~held)
        ends = held.argmax(axis=1), stations.size - 1 - held[:, ::-1].argmax(axis=1)
        end = np.where(k < ends[0][line], ends[0][line], ends[1][line])
        close = np.flatnonzero(np.abs(k - end) <= AHEAD)
        if not close.size or held.sum() == known:
            return held
        known, line, k, end = held.sum(), line[close], k[close], end[close]
        values, solved, _ = line_over_face(pair, plain.repeat(line), states[line, end], stations[k][:, None])
        states[line, k], there[line, k] = values[:, 0], solved[:, 0]


def _follow(pair: Pair, plain: Conditions, x: Array) -> Array:
    """Points (M, 2 MOST + 1, 5) of the lines through x (M, 5): NaN beyond where they end."""
    count = len(x)
    full, length = np.full((count, 2 * MOST + 1, 5), np.nan), 4.0 * pair.length
    full[:, MOST] = x
    position = np.tile(np.arange(count), 2)
    way = np.repeat([1, -1], count)
    at, active = x[position].copy(), np.arange(2 * count)
    heading = directions(pair, plain.touch(x, np.arange(count)))[0][position] * way[:, None]
    step = length / STEPS
    for k in range(1, MOST + 1):
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
        solution = _sections(pair, here, guess, ROUGH)
        touch = here.touch(solution.values, np.arange(len(active)))
        outside, past = margins(pair, touch, solution.values)
        moved = np.linalg.norm(touch.fixed[0].r - fixed[0].r, axis=-1)
        good = solution.converged & (moved < 2.0 * step) & (moved > 0.3 * step) & (past < length)
        good &= dot(touch.fixed[0].n, touch.fixed[1].n) < 0.0
        own = active[good]
        at[own], heading[own] = solution.values[good], along[good]
        full[position[own], MOST + k * way[own]] = at[own]
        active = active[good & (outside.max(axis=1) < BEYOND * length)]
        if not active.size:
            break
    return full


@dataclass(frozen=True)
class LineSections:
    """Where lines of contact go through planes across them, through points `at` (M, 3) with normals `along` (M, 3), fixed frame:
    the flanks' normals agree `across` (M, 3), as they then do along the line."""

    plain: Conditions
    at: Array
    along: Array
    across: Array

    def __call__(self, x: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
        """Residuals (M, 5), mm, and Jacobians (M, 5, 5) of the positions `index` (M,)."""
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
    """Points (M, 5) of the lines in the planes across them through what is near them."""
    touch = here.touch(guess, np.arange(len(guess)))
    along, across = directions(pair, touch)
    return newton.solve(
        LineSections(here, touch.fixed[0].r, along, across), guess, tolerance=tolerance, max_iterations=12, halvings=3
    )


def _cut(pair: Pair, plain: Conditions, line: NDArray[np.intp], outer: Array, inner: Array) -> Array:
    """Where lines (K,) leave the flanks between points outside and inside of them, unknowns (K, 5); NaN where it is not known."""
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
    """Pieces of lines (Q,) through unknowns (K, 5) each, at `count` points."""
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
