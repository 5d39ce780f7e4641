"""Where a line of contact shrinks to a point as the gears turn: there the least margin of its points to the edges is 0.

Along the line, of arc length s, the margins m of the edges are smooth functions of s and phi1. A line that an edge leaves behind
ends where it is tangent to that edge, m = 0 and dm/ds = 0; one between two edges, or at a corner of a tip line, where both are 0.
The slopes of these two conditions are differences over a step along the line and one in phi1, both solved exactly: Newton's method
in (s, phi1), of all places in one batch.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.conditions.bent_lines import EVALUATIONS, LineSections, directions, line_over_face
from gearmesh.contact.conditions.meshing import Conditions
from gearmesh.contact.conditions.refinement import EDGE_SLACK, margins
from gearmesh.contact.pair import Pair, edge_number
from gearmesh.kernel.numeric import newton
from gearmesh.kernel.numeric.algebra import Array, cross, dot, plane_cross, turn, unit
from gearmesh.kernel.surface.surface import Jet

#: stations of the gear's face at which a line is looked at
STATIONS = 33
#: how often, and at how many stations, it is looked closer where it is nearest to both flanks
FINER, BESIDE = 6, 17
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


def line_ends(pair: Pair, phi1: Array, x: Array) -> LineEnds:
    """Where those of the lines through x (K, 5) at phi1 (K,), rad, that bend shrink to points that both flanks have; several of a
    line, if it has pieces."""
    line, start, edges = _least_margins(pair, phi1, x)
    ends, reached = _shrunk(pair, phi1[line], start, edges)
    plain, every = Conditions(pair.flanks, ends[:, 5], pair.length), np.arange(len(ends))
    touch = plain.touch(ends[:, :5], every)
    outside, past = margins(pair, touch, ends[:, :5])
    on_flanks = (outside <= EDGE_SLACK).all(axis=1) & (past <= EDGE_SLACK)
    good = np.flatnonzero(reached & on_flanks & (dot(touch.fixed[0].n, touch.fixed[1].n) < 0.0))
    return LineEnds(line[good], ends[good, 5], ends[good, :5])


def deepest_points(pair: Pair, phi1: Array, x: Array) -> tuple[Array, Array]:
    """Of the lines through x (K, 5) at phi1 (K,), rad, the points (K, 5) that are deepest inside both flanks, as far as that must
    be known to tell that a line has points on them, and their margins (K,), mm, < 0 inside."""
    station = np.broadcast_to(np.linspace(*pair.gear.extent, STATIONS), (len(x), STATIONS))
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
        going = (margin[left] > -EDGE_SLACK) & deeper & (margin[left] <= beside + EDGE_SLACK)
        step = np.abs(station[going, 1] - station[going, 0])[:, None]
        station = station[going, k[going]][:, None] + step * np.linspace(-1.0, 1.0, BESIDE)
        left = left[going]
        if not left.size:
            break
    return points, margin


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
    count = len(x)
    states, there, outside, own = _margins_over_face(pair, phi1, x, np.linspace(*pair.gear.extent, STATIONS))
    nearest, bent = outside.argmax(axis=2), _are_bent(own[1].r.reshape(count, STATIONS, 3), there)
    least = np.where(there, outside.max(axis=2), np.inf)
    wide = np.pad(least, ((0, 0), (1, 1)), constant_values=np.inf)
    lowest = bent[:, None] & np.isfinite(least) & (least <= wide[:, :-2]) & (least <= wide[:, 2:])
    corners = {
        number: bound.level.value(own[bound.member].r).reshape(count, STATIONS)
        for _, number in pair.tip_corners
        if (bound := pair.bounds[number]) is not None
    }
    places = []
    face_ends = [edge_number(1, name) for name in ("toe", "heel")]
    for k, s in zip(*np.nonzero(lowest), strict=True):
        first = int(nearest[k, s])
        beside = [t for t in (s - 1, s + 1) if 0 <= t < STATIONS and np.isfinite(least[k, t])]
        others = {-1, *(int(nearest[k, t]) for t in beside), *(face_ends if s in (0, STATIONS - 1) else ())}
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


def _shrunk(pair: Pair, phi1: Array, x: Array, edges: NDArray[np.intp]) -> tuple[Array, NDArray[np.bool_]]:
    """Unknowns and phi1 (M, 6) where lines near x (M, 5) at phi1 (M,) are tangent to an edge, or meet two, and which (M,) do."""
    count, reach = len(x), 0.5 * np.array([pair.length, pair.max_step[4]])
    y, reached = np.column_stack((x, phi1)), np.zeros(count, dtype=bool)
    steps = np.array([ALONG * pair.length, TURNED])
    active = np.arange(count)
    for _ in range(ROUNDS):
        if not active.size:
            break
        three = np.tile(np.arange(active.size), 3)
        here = Conditions(pair.flanks, y[active, 5], pair.length)
        at = here.touch(y[active, :5], np.arange(active.size)).fixed[0].r
        along, across = (vectors[three] for vectors in directions(pair, here, y[active, :5]))
        planes, shifted = at[three], np.repeat(y[active][None], 3, axis=0)
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
        f = _conditions(pair, plain, solution.values, edges[active][three], along).reshape(3, -1, 2)
        y3 = np.column_stack((solution.values, shifted[:, 5])).reshape(3, -1, 6)
        by_step, by_turn = ((f[k] - f[0]) / step for k, step in zip((1, 2), steps, strict=True))
        area = plane_cross(by_step, by_turn)
        step = np.stack((plane_cross(by_turn, f[0]), -plane_cross(by_step, f[0])), axis=-1) / area[:, None]
        step /= np.maximum(np.abs(step / reach).max(axis=1), 1.0)[:, None]
        y[active] = y3[0] + sum((step[:, k] / steps[k])[:, None] * (y3[k + 1] - y3[0]) for k in (0, 1))
        solved = solution.converged.reshape(3, -1).all(axis=0) & np.isfinite(y[active]).all(axis=1)
        still = (np.abs(step) <= (STILL * pair.length, STOPPED)).all(axis=1)
        reached[active] = solved & still
        active = active[solved & ~still]
    return y, reached


def _conditions(pair: Pair, plain: Conditions, x: Array, edges: NDArray[np.intp], along: Array) -> Array:
    """How far (M, 2), mm, points x (M, 5) of lines lie beyond two edges, or beyond one and its slope along the line (mm/mm), which
    goes the way of `along` (M, 3)."""
    touch = plain.touch(x, np.arange(len(x)))
    tangent = directions(pair, plain, x)[0]
    tangent *= np.sign(dot(tangent, along))[:, None]
    values = np.empty((len(x), 2))
    for number in np.unique(edges[edges >= 0]):
        bound = pair.bounds[number]
        assert bound is not None
        own, slot = np.nonzero(edges == number)
        r = touch.own[bound.member].r[own]
        values[own, slot] = bound.level.value(r)
        alone = (slot == 0) & (edges[own, 1] < 0)
        gradient = turn(touch.turns[bound.member][own], bound.level.gradient(r))
        values[own[alone], 1] = dot(gradient, tangent[own])[alone]
    return values
