"""Where a line of contact shrinks to a point as the gears turn: there the least margin of its points to the edges is 0.

Along the line, of arc length s, the margins m of the edges are smooth functions of s and phi1. A line that an edge leaves behind
ends where it is tangent to that edge, m = 0 and dm/ds = 0. The slopes of these two conditions are differences over a step along the
line and one in phi1, both solved exactly: Newton's method in (s, phi1), of all places in one batch. A line between two edges, or at
a corner of a tip line, ends where both margins are 0: a point of the one edge that reaches the other (`events.reaches`), as the
margin of a tip has another slope on either side of its corner.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.bent_lines import EVALUATIONS, LineSections, directions, line_over_face
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
from gearmesh.kernel.numeric.algebra import Array, cross, dot, plane_cross, turn, unit
from gearmesh.kernel.surface.surface import Jet

#: stations of the gear's face at which a line is looked at
STATIONS = 33
#: how often it is looked closer where it is nearest to both flanks; at which stations, as parts of the way to the neighbours; at
#: how many places parabolas are
FINER, LOOKS = 6, 129
CLOSE = np.concatenate((-(0.25 ** np.arange(8.0)), [0.0], 0.25 ** np.arange(7.0, -1.0, -1.0)))
#: margin (mm) of a point that is on both flanks, be it solved for anew
REACHED = 0.5 * EDGE_SLACK
#: rad by which the chords of a line that counts as straight differ at most
STRAIGHT = 1e-3
#: steps over which slopes are taken: parts of a flank's length, and rad
ALONG, TURNED = 1e-4, 1e-5
#: steps of Newton's method at most, and the part of a flank's length, and rad, that count as none
ROUNDS, STILL, STOPPED = 12, 1e-8, 1e-13


@dataclass(frozen=True)
class LineEnds:
    """Places (M,) where lines shrink to a point: `line`, which of the lines that were asked for; rotations `phi1` (M,), rad;
    unknowns `x` (M, 5)."""

    line: NDArray[np.intp]
    phi1: Array
    x: Array


def line_ends(pair: Pair, phi1: Array, x: Array, within: float) -> LineEnds:
    """Where those of the lines through x (K, 5) at phi1 (K,), rad, that bend shrink to points that both flanks have, `within` (rad)
    of there; several of a line, if it has pieces."""
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
    """What both flanks of a `pair` that touches along lines have, at positions (M,), of the lines near x (M, 5), taken as their
    contact: of a line a place may be known where they have nothing of it."""
    x, margin = deepest_points(pair, phi1[position], x)
    own = np.flatnonzero(margin <= EDGE_SLACK)
    trial = Trial.of(position[own], x[own], np.full((own.size, 2), -1))
    trial.line[:] = True
    solve(pair, phi1, trial)
    good = np.flatnonzero(trial.good & trial.line)
    position = trial.position[good]
    trial.give(contacts, position, good, 0, advances_of(pair, phi1, trial.x[good], position))


def deepest_points(pair: Pair, phi1: Array, x: Array) -> tuple[Array, Array]:
    """Of the lines through x (K, 5) at phi1 (K,), rad, the points (K, 5) that are deepest inside both flanks, as far as that must
    be known to tell that a line has points on them, and their margins (K,), mm, < 0 inside."""
    station = np.tile(_stations(pair), (len(x), 1))
    points, margin, left = x.copy(), np.full(len(x), np.inf), np.arange(len(x))
    for _ in range(FINER):
        states, there, outside, _ = _margins_over_face(pair, phi1[left], points[left], station)
        least = np.where(there, outside.max(axis=2), np.inf)
        every, k = np.arange(left.size), least.argmin(axis=1)
        deeper = least[every, k] < margin[left]
        points[left[deeper]], margin[left[deeper]] = states[every, k][deeper], least[every, k][deeper]
        # beside the best station, where it is not on both flanks itself and what is between it and the next may be: no more below
        # it than they are above
        wide = np.pad(least, ((0, 0), (1, 1)), mode="edge")
        beside = np.nan_to_num(wide[every, k] + wide[every, k + 2] - 2.0 * least[every, k], nan=np.inf)
        going = (margin[left] > REACHED) & deeper & (margin[left] <= beside + EDGE_SLACK)
        known = np.where(there[going][..., None] & np.isfinite(outside[going]), outside[going], np.nan)
        station = _about_least(station[going], known, k[going])
        left = left[going]
        if not left.size:
            break
    return points, margin


def _stations(pair: Pair) -> Array:
    """Stations (S,) of the gear's face at which lines are looked at, ascending or falling as the face goes: even, and those of the
    corners of its tip line, where margins have corners."""
    toe, heel = pair.gear.extent
    origin = np.zeros(3)
    corners = [float(pair.gear.axial.value(origin) - level.value(origin)) for level in pair.gear.tip_corners.values()]
    stations = np.unique([*np.linspace(toe, heel, STATIONS), *corners])
    return stations if toe < heel else stations[::-1]


def _about_least(station: Array, outside: Array, k: NDArray[np.intp]) -> Array:
    """Stations (K, S') from one neighbour of the stations `k` (K,) of (K, S) to the other, close about where the margins
    (K, S, B), NaN where there are none, are least: the largest of the edges' parabolas."""
    every, middle = np.arange(len(k)), np.clip(k, 1, station.shape[1] - 2)
    at, m = (np.stack([values[every, middle + i] for i in (-1, 0, 1)], axis=1) for values in (station, outside))
    reach = np.abs(at[:, 1:] - at[:, :-1]).max(axis=1)
    low, high = station[every, k] - reach, station[every, k] + reach
    share = np.linspace(0.0, 1.0, LOOKS)[:, None]
    tried = low + share * (high - low)
    first, second = ((m[:, i + 1] - m[:, i]) / (at[:, i + 1] - at[:, i])[:, None] for i in (0, 1))
    bend = (second - first) / (at[:, 2] - at[:, 0])[:, None]
    away = [(tried - at[:, i])[..., None] for i in (0, 1)]
    margin = np.fmax.reduce(m[:, 0] + away[0] * (first + away[1] * bend), axis=2)
    vertex = np.where(np.isfinite(margin).all(axis=0), tried[margin.argmin(axis=0), every], station[every, k])
    ways = np.where(CLOSE < 0.0, (vertex - low)[:, None], (high - vertex)[:, None])
    stations: Array = vertex[:, None] + CLOSE * ways
    return stations


def _margins_over_face(
    pair: Pair, phi1: Array, x: Array, stations: Array
) -> tuple[Array, NDArray[np.bool_], Array, tuple[Jet, Jet]]:
    """Points (K, S, 5) of lines at stations of the gear, which of them (K, S) are found, how far (K, S, B), mm, they lie beyond
    each edge, and the flanks there (K S)."""
    plain = Conditions(pair.flanks, phi1, pair.length)
    states, there, touch = line_over_face(pair, plain, x, stations)
    outside, past = margins(pair, touch, states.reshape(-1, 5))
    there &= (past <= EDGE_SLACK).reshape(there.shape)
    return states, there, outside.reshape(*there.shape, -1), touch.own


def _least_margins(pair: Pair, phi1: Array, x: Array) -> tuple[NDArray[np.intp], Array, NDArray[np.intp]]:
    """Where the margins of lines are least: their lines (M,), unknowns (M, 5), and by which edges (M, 2) they may shrink there, by
    their numbers in `Pair.bounds`; -1: along the first."""
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
    """Which lines (K,) through points r (K, S, 3), as far as they are `there` (K, S), are not straight."""
    chords = unit(np.diff(r, axis=1))
    both = there[:, 1:] & there[:, :-1]
    first = chords[np.arange(len(r)), both.argmax(axis=1)]
    apart = np.linalg.norm(cross(chords, first[:, None]), axis=-1)
    bent: NDArray[np.bool_] = np.where(both, apart, 0.0).max(axis=1) > STRAIGHT
    return bent


def _tangent(
    pair: Pair, phi1: Array, x: Array, edge: NDArray[np.intp], within: float
) -> tuple[Array, NDArray[np.bool_]]:
    """Unknowns and phi1 (M, 6) where lines near x (M, 5) at phi1 (M,) are tangent to an edge (M,), and which (M,) are so, `within`
    (rad) of there."""
    count, reach = len(x), 0.5 * np.array([pair.length, pair.max_step[4]])
    y, reached = np.column_stack((x, phi1)), np.zeros(count, dtype=bool)
    steps = np.array([ALONG * pair.length, TURNED])
    active = np.arange(count)
    for _ in range(ROUNDS):
        if not active.size:
            break
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
            max_iterations=EVALUATIONS,
            halvings=3,
        )
        f = _tangency(pair, plain.touch(solution.values, np.arange(three.size)), edge[active][three], along).reshape(
            3, -1, 2
        )
        y3 = np.column_stack((solution.values, shifted[:, 5])).reshape(3, -1, 6)
        by_step, by_turn = ((f[k] - f[0]) / step for k, step in zip((1, 2), steps, strict=True))
        area = plane_cross(by_step, by_turn)
        step = np.stack((plane_cross(by_turn, f[0]), -plane_cross(by_step, f[0])), axis=-1) / area[:, None]
        step /= np.maximum(np.abs(step / reach).max(axis=1), 1.0)[:, None]
        y[active] = y3[0] + sum((step[:, k] / steps[k])[:, None] * (y3[k + 1] - y3[0]) for k in (0, 1))
        solved = solution.converged.reshape(3, -1).all(axis=0) & np.isfinite(y[active]).all(axis=1)
        still = (np.abs(step) <= (STILL * pair.length, STOPPED)).all(axis=1)
        solved &= np.abs(y[active, 5] - phi1[active]) <= within
        reached[active] = solved & still
        active = active[solved & ~still]
    return y, reached


def _tangency(pair: Pair, touch: Touch, edge: NDArray[np.intp], along: Array) -> Array:
    """How far (M, 2), mm, points of lines lie beyond edges (M,), and the slopes of that along the lines (mm/mm), which go the way
    of `along` (M, 3)."""
    tangent = directions(pair, touch)[0]
    tangent *= np.sign(dot(tangent, along))[:, None]
    values = np.empty((len(edge), 2))
    for number in np.unique(edge):
        bound, own = pair.bounds[number], np.flatnonzero(edge == number)
        assert bound is not None
        r = touch.own[bound.member].r[own]
        values[own, 0] = bound.level.value(r)
        values[own, 1] = dot(turn(touch.turns[bound.member][own], bound.level.gradient(r)), tangent[own])
    return values


def _crossing(pair: Pair, phi1: Array, x: Array, edges: NDArray[np.intp]) -> tuple[Array, NDArray[np.bool_]]:
    """Unknowns and phi1 (M, 6) where lines near x (M, 5) at phi1 (M,) meet two `edges` (M, 2), and which (M,) do."""
    plain = Conditions(pair.flanks, phi1, pair.length)
    across = directions(pair, plain.touch(x, np.arange(len(x))))[1]
    choice = pair.numbers[np.stack((edges[:, 1], np.full(len(x), -1)), axis=-1)]
    event = reaches(pair, replace(plain, bounds=pair.all_bounds, across=across, choice=choice), edges[:, 0], x)
    return np.column_stack((event.x, event.phi1)), event.reached
