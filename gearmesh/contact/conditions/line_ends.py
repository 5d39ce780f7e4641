"""Ends of bent contact lines: the rotations at which a line shrinks to a point, where the least margin to the edges is 0.

The margins m of the edges along the line are smooth functions of its arc length s and of phi1. A line that passes over an edge ends
where it is tangent to the edge: m = 0 and dm/ds = 0. Newton's method solves for (s, phi1) at all places in one batch. The
slopes of the two conditions are differences over a step along the line and a step in phi1, with exact points of the line. A line
between two edges, or at a corner of a tip line, ends where both margins are 0: a point of one edge reaches the other edge
(`events.reaches`). The margin of a tip has different slopes on both sides of a corner.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.bent_lines import MAX_EVALUATIONS, LineSections, directions, line_over_face
from gearmesh.contact.conditions.events import reaches
from gearmesh.contact.conditions.meshing import Conditions, Touch
from gearmesh.contact.conditions.refinement import (
    EDGE_SLACK,
    Contacts,
    Trial,
    advances_of,
    margins,
    solve,
)
from gearmesh.contact.pair import Pair, edge_number
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, cross, distinct, dot, plane_cross, turn, unit
from gearmesh.kernel.surface.surface import Jet
from gearmesh.records import dataclass

#: stations of the gear's face at which a line is sampled
FACE_STATIONS = 33
#: rounds that search closer where a line is nearest to both flanks
REFINING_ROUNDS = 6
#: places at which the parabolas of the margins are evaluated
PARABOLA_PLACES = 129
#: stations of a round, by the way from the least margin to the neighbours
CLOSE_STATIONS = np.concatenate((-(0.25 ** np.arange(8.0)), [0.0], 0.25 ** np.arange(7.0, -1.0, -1.0)))
#: margin (mm) up to which a point is on both flanks and remains so when it is solved for again
ON_FLANKS_MM = 0.5 * EDGE_SLACK
#: angle (rad) between chords of a line up to which the line is straight
STRAIGHT_RAD = 1e-3
#: step along a line for its slopes, by a flank's length
SLOPE_STEP = 1e-4
#: step in phi1 for slopes, rad
SLOPE_STEP_RAD = 1e-5
#: steps of Newton's method at most
MAX_NEWTON_STEPS = 12
#: last step along a line, by a flank's length
LAST_STEP = 1e-8
#: last step in phi1, rad
LAST_STEP_RAD = 1e-13


@dataclass(frozen=True)
class LineEnds:
    """Points to which lines shrink: number `line` (M,) of the line, rotation `phi1` (M,), rad, and unknowns `x` (M, 5)."""

    line: NDArray[np.intp]
    phi1: Array
    x: Array


def line_ends(pair: Pair, phi1: Array, x: Array, within: float) -> LineEnds:
    """Solve for the points on both flanks to which bent lines through x (K, 5) at phi1 (K,), rad, shrink.

    The points lie `within` so much (rad) of phi1. A line with several pieces has several points.
    """
    line, start, edges = _least_margins(pair, phi1, x)
    ends, reached = np.empty((len(line), 6)), np.zeros(len(line), dtype=bool)
    tangent, crossing = np.flatnonzero(edges[:, 1] < 0), np.flatnonzero(edges[:, 1] >= 0)
    ends[tangent], reached[tangent] = _tangent(pair, phi1[line[tangent]], start[tangent], edges[tangent, 0], within)
    if crossing.size:
        ends[crossing], reached[crossing] = _crossing(pair, phi1[line[crossing]], start[crossing], edges[crossing])
    plain, every = Conditions(pair.flanks, ends[:, 5], pair.length), np.arange(len(ends))
    touch = plain.touch(ends[:, :5], every)
    outside, past = margins(pair, touch, ends[:, :5])
    on_flanks = (outside <= EDGE_SLACK).all(axis=1) & (past <= EDGE_SLACK)
    good = np.flatnonzero(reached & on_flanks & (dot(touch.fixed[0].n, touch.fixed[1].n) < 0.0))
    return LineEnds(line[good], ends[good, 5], ends[good, :5])


def touch_along_lines(pair: Pair, phi1: Array, position: NDArray[np.intp], x: Array, contacts: Contacts) -> None:
    """Put contacts at positions (M,) on the lines near x (M, 5), as far as the lines lie on both flanks of the `pair`.

    The place x of a line may lie beyond the flanks.
    """
    x, margin = deepest_points(pair, phi1[position], x)
    own = np.flatnonzero(margin <= EDGE_SLACK)
    trial = Trial.of(position[own], x[own], np.full((own.size, 2), -1))
    trial.line[:] = True
    solve(pair, phi1, trial)
    good = np.flatnonzero(trial.good & trial.line)
    position = trial.position[good]
    trial.give(contacts, position, good, 0, advances_of(pair, phi1, trial.x[good], position))


def deepest_points(pair: Pair, phi1: Array, x: Array) -> tuple[Array, Array]:
    """Find the points (K, 5) of lines through x (K, 5) at phi1 (K,), rad, that are deepest inside both flanks.

    Also returns their margins (K,), mm, below 0 inside. The search ends as soon as a point is on both flanks.
    """
    station = np.tile(_stations(pair), (len(x), 1))
    points, margin, left = x.copy(), np.full(len(x), np.inf), np.arange(len(x))
    for _ in range(REFINING_ROUNDS):
        states, there, outside, _ = _margins_over_face(pair, phi1[left], points[left], station)
        least = np.where(there, outside.max(axis=2), np.inf)
        every, k = np.arange(left.size), least.argmin(axis=1)
        deeper = least[every, k] < margin[left]
        points[left[deeper]], margin[left[deeper]] = states[every, k][deeper], least[every, k][deeper]
        # go on near the best station if it is not on both flanks but a point next to it may be: the least margin is below the best
        # station by no more than the neighbours are above it
        wide = np.pad(least, ((0, 0), (1, 1)), mode="edge")
        beside = np.nan_to_num(wide[every, k] + wide[every, k + 2] - 2.0 * least[every, k], nan=np.inf)
        going = (margin[left] > ON_FLANKS_MM) & deeper & (margin[left] <= beside + EDGE_SLACK)
        known = np.where(there[going][..., None] & np.isfinite(outside[going]), outside[going], np.nan)
        station = _about_least(station[going], known, k[going])
        left = left[going]
        if not left.size:
            break
    return points, margin


def _stations(pair: Pair) -> Array:
    """Return stations (S,) of the gear's face, from toe to heel: equally spaced, and at the corners of the tip line.

    Margins have corners at the corners of the tip line.
    """
    toe, heel = pair.gear.extent
    origin = np.zeros(3)
    corners = [float(pair.gear.axial.value(origin) - level.value(origin)) for level in pair.gear.tip_corners.values()]
    stations = distinct(np.array([*np.linspace(toe, heel, FACE_STATIONS), *corners]))
    return stations if toe < heel else stations[::-1]


def _about_least(station: Array, outside: Array, k: NDArray[np.intp]) -> Array:
    """Return stations (K, S') between the neighbours of the stations `k` (K,) of (K, S), dense at the least margin.

    The margin is the greatest of the parabolas through the margins (K, S, B) of the edges, NaN without a margin.
    """
    every, middle = np.arange(len(k)), np.clip(k, 1, station.shape[1] - 2)
    at, m = (np.stack([values[every, middle + i] for i in (-1, 0, 1)], axis=1) for values in (station, outside))
    reach = np.abs(at[:, 1:] - at[:, :-1]).max(axis=1)
    low, high = station[every, k] - reach, station[every, k] + reach
    share = np.linspace(0.0, 1.0, PARABOLA_PLACES)[:, None]
    tried = low + share * (high - low)
    first, second = ((m[:, i + 1] - m[:, i]) / (at[:, i + 1] - at[:, i])[:, None] for i in (0, 1))
    bend = (second - first) / (at[:, 2] - at[:, 0])[:, None]
    away = [(tried - at[:, i])[..., None] for i in (0, 1)]
    margin = np.fmax.reduce(m[:, 0] + away[0] * (first + away[1] * bend), axis=2)
    vertex = np.where(np.isfinite(margin).all(axis=0), tried[margin.argmin(axis=0), every], station[every, k])
    ways = np.where(CLOSE_STATIONS < 0.0, (vertex - low)[:, None], (high - vertex)[:, None])
    stations: Array = vertex[:, None] + CLOSE_STATIONS * ways
    return stations


def _margins_over_face(
    pair: Pair, phi1: Array, x: Array, stations: Array
) -> tuple[Array, NDArray[np.bool_], Array, tuple[Jet, Jet]]:
    """Solve for points (K, S, 5) of lines at stations of the gear.

    Also returns True (K, S) for points that are found, distances (K, S, B), mm, beyond each edge, and the flanks (K S).
    """
    plain = Conditions(pair.flanks, phi1, pair.length)
    states, there, touch = line_over_face(pair, plain, x, stations)
    outside, past = margins(pair, touch, states.reshape(-1, 5))
    there &= (past <= EDGE_SLACK).reshape(there.shape)
    return states, there, outside.reshape(*there.shape, -1), touch.own


def _least_margins(pair: Pair, phi1: Array, x: Array) -> tuple[NDArray[np.intp], Array, NDArray[np.intp]]:
    """Find the places where the margins of lines are least: numbers (M,) of the lines, unknowns (M, 5), and edges (M, 2).

    Edges are numbers in `Pair.bounds`. A line may shrink to the crossing of both edges, or tangent to the first edge if the second
    number is -1.
    """
    stations = _stations(pair)
    shape = len(x), len(stations)
    states, there, outside, own = _margins_over_face(pair, phi1, x, stations)
    nearest, bent = outside.argmax(axis=2), _are_bent(own[1].r.reshape(*shape, 3), there)
    least = np.where(there, outside.max(axis=2), np.inf)
    wide = np.pad(least, ((0, 0), (1, 1)), constant_values=np.inf)
    lowest = bent[:, None] & np.isfinite(least) & (least <= wide[:, :-2]) & (least <= wide[:, 2:])
    corners = {
        number: bound.level.value(own[bound.member].r).reshape(shape)
        for _, number in pair.tip_corners
        if (bound := pair.bounds[number]) is not None
    }
    places = []
    face_ends = [edge_number(1, name) for name in ("toe", "heel")]
    for k, s in zip(*np.nonzero(lowest), strict=True):
        first = int(nearest[k, s])
        beside = [t for t in (s - 1, s + 1) if 0 <= t < shape[1] and np.isfinite(least[k, t])]
        others = {-1, *(int(nearest[k, t]) for t in beside), *(face_ends if s in (0, shape[1] - 1) else ())}
        for tip, number in pair.tip_corners:
            if tip == first and any(corners[number][k, s] * corners[number][k, t] <= 0.0 for t in beside):
                others.add(number)
        places += [(k, states[k, s], (first, other)) for other in sorted(others - {first})]
    if not places:
        return np.zeros(0, dtype=np.intp), np.zeros((0, 5)), np.zeros((0, 2), dtype=np.intp)
    lines, starts, edges = (np.array(column) for column in zip(*places, strict=True))
    return lines, starts, edges


def _are_bent(r: Array, there: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """Return True (K,) for lines through points r (K, S, 3), known where `there` (K, S), that are not straight."""
    chords = unit(np.diff(r, axis=1))
    both = there[:, 1:] & there[:, :-1]
    first = chords[np.arange(len(r)), both.argmax(axis=1)]
    apart = np.linalg.norm(cross(chords, first[:, None]), axis=-1)
    bent: NDArray[np.bool_] = np.where(both, apart, 0.0).max(axis=1) > STRAIGHT_RAD
    return bent


def _tangent(
    pair: Pair, phi1: Array, x: Array, edge: NDArray[np.intp], within: float
) -> tuple[Array, NDArray[np.bool_]]:
    """Solve for unknowns and phi1 (M, 6) at which lines near x (M, 5) at phi1 (M,) are tangent to an edge (M,).

    Also returns True (M,) for roots that are found `within` so much (rad) of phi1.
    """
    count, reach = len(x), 0.5 * np.array([pair.length, pair.max_step[4]])
    y, reached = np.column_stack((x, phi1)), np.zeros(count, dtype=bool)
    steps = np.array([SLOPE_STEP * pair.length, SLOPE_STEP_RAD])
    active = np.arange(count)
    for _ in range(MAX_NEWTON_STEPS):
        if not active.size:
            break
        # the point itself, a point a step along the line, and the line a step in phi1 later
        three = np.tile(np.arange(active.size), 3)
        here = Conditions(pair.flanks, y[active, 5], pair.length).touch(y[active, :5], np.arange(active.size))
        along, across = (vectors[three] for vectors in directions(pair, here))
        planes, shifted = here.fixed[0].r[three], np.repeat(y[active][None], 3, axis=0)
        planes[active.size : 2 * active.size] += steps[0] * along[: active.size]
        shifted[2] += steps[1] * np.array([0.0, 0.0, 0.0, 0.0, pair.ratio, 1.0])
        shifted = shifted.reshape(-1, 6)
        plain = Conditions(pair.flanks, shifted[:, 5], pair.length)
        solution = newton.solve(
            LineSections(plain, planes, along, across),
            shifted[:, :5],
            tolerance=pair.tolerance,
            max_iterations=MAX_EVALUATIONS,
            halvings=3,
        )
        f = _tangency(pair, plain.touch(solution.values, np.arange(three.size)), edge[active][three], along).reshape(
            3, -1, 2
        )
        y3 = np.column_stack((solution.values, shifted[:, 5])).reshape(3, -1, 6)
        # Newton's step in (s, phi1), limited to half a flank and the largest step of the solver
        by_step, by_turn = ((f[k] - f[0]) / step for k, step in zip((1, 2), steps, strict=True))
        area = plane_cross(by_step, by_turn)
        step = np.stack((plane_cross(by_turn, f[0]), -plane_cross(by_step, f[0])), axis=-1) / area[:, None]
        step /= np.maximum(np.abs(step / reach).max(axis=1), 1.0)[:, None]
        y[active] = y3[0] + sum((step[:, k] / steps[k])[:, None] * (y3[k + 1] - y3[0]) for k in (0, 1))
        solved = solution.converged.reshape(3, -1).all(axis=0) & np.isfinite(y[active]).all(axis=1)
        still = (np.abs(step) <= (LAST_STEP * pair.length, LAST_STEP_RAD)).all(axis=1)
        solved &= np.abs(y[active, 5] - phi1[active]) <= within
        reached[active] = solved & still
        active = active[solved & ~still]
    return y, reached


def _tangency(pair: Pair, touch: Touch, edge: NDArray[np.intp], along: Array) -> Array:
    """Return distances (mm) of points of lines beyond edges (M,) and their slopes along the lines (mm/mm), (M, 2).

    The lines run in the sense of `along` (M, 3).
    """
    tangent = directions(pair, touch)[0]
    tangent *= np.sign(dot(tangent, along))[:, None]
    values = np.empty((len(edge), 2))
    for number in distinct(edge):
        bound, own = pair.bounds[number], np.flatnonzero(edge == number)
        assert bound is not None
        r = touch.own[bound.member].r[own]
        values[own, 0] = bound.level.value(r)
        values[own, 1] = dot(turn(touch.turns[bound.member][own], bound.level.gradient(r)), tangent[own])
    return values


def _crossing(pair: Pair, phi1: Array, x: Array, edges: NDArray[np.intp]) -> tuple[Array, NDArray[np.bool_]]:
    """Solve for unknowns and phi1 (M, 6) at which lines near x (M, 5) at phi1 (M,) meet two `edges` (M, 2).

    Also returns True (M,) for roots that are found.
    """
    plain = Conditions(pair.flanks, phi1, pair.length)
    across = directions(pair, plain.touch(x, np.arange(len(x))))[1]
    choice = pair.numbers[np.stack((edges[:, 1], np.full(len(x), -1)), axis=-1)]
    event = reaches(pair, replace(plain, bounds=pair.all_bounds, across=across, choice=choice), edges[:, 0], x)
    return np.column_stack((event.x, event.phi1)), event.reached
