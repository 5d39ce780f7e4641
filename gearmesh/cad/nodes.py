"""Nodes for splines through exact curves, placed so that every interval has the same error.

The parameter may be bent first: x = y + bend y (1 - y) runs slower at one end. Near undercut, curves behave like sqrt(x + e), and
polynomials in a y that is quadratic in x follow them. Bends and first nodes are planned on curves that are sampled once. Callers
with exact curves place the nodes again, by the errors that they measure between them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.grid import on_grid, significant
from gearmesh.kernel.numeric.splines import SplineCurve, rising_through
from gearmesh.records import dataclass

#: degree of the splines in STEP files; a spline takes at least one node more than its degree
SPLINE_DEGREE = 5
#: places between neighbouring nodes at which deviations are measured, as shares of the interval
PLACES_BETWEEN_NODES = np.array([0.25, 0.5, 0.75])
#: measured places of an interval, its first node included
PLACES_PER_INTERVAL = len(PLACES_BETWEEN_NODES) + 1
#: bends that are tried; they save a quarter of the nodes of a fillet, and a third near undercut
TRIED_BENDS = (0.0, -0.5, 0.5, -0.8, 0.8)
#: error of an interval for which nodes are placed in the first round, as a share of the allowed error
TARGET_ERROR_SHARE = 0.7
#: ratio of this error from round to round
TIGHTENING_FACTOR = 0.75
#: largest widening of an interval in a round: an interval without error says nothing about its surroundings
MAX_WIDENING = 4.0
#: rounds of placing nodes in a plan
PLANNING_ROUNDS = 6
#: samples of a planned curve, which then is known to far below a micrometre
SAMPLES_PER_CURVE = 65
#: bits of the errors by which nodes are placed: rounding must not move nodes
EXCESS_BITS = 5
#: least error by which nodes are placed, over the allowed error: points are exact to 1e-6 of the latter
LEAST_EXCESS = 1e-3
#: steps of the grid on which nodes are placed: last digits of errors, which differ between processors, do not move them
STEPS_PER_CURVE = 2.0**20
#: largest number of nodes
MAX_NODES = 200


@dataclass(frozen=True)
class Nodes:
    """Nodes of a spline, before the bend of its parameter."""

    #: nodes (N,) from 0 to 1
    y: Array
    #: bend that converts y to the curve's parameter
    bend: float = 0.0
    #: degree of the spline
    degree: int = SPLINE_DEGREE
    #: largest number of nodes, exceeded by two at most
    most: int = MAX_NODES

    @property
    def fine(self) -> Array:
        """Nodes and places between them, in order."""
        return with_between(self.y)

    def own(self, y: Array) -> Array:
        """Return the curve's parameter at y (...,), both from 0 to 1."""
        return warp(y, self.bend)

    def spread(self, excess: Array, strictness: int = 0) -> Nodes:
        """Return new nodes by the errors (N - 1,) between the present nodes, over the allowed error."""
        return replace(
            self, y=_spread(self.y, excess, TARGET_ERROR_SHARE * TIGHTENING_FACTOR**strictness, self.degree, self.most)
        )


def warp(y: Array, bend: float) -> Array:
    """Return the bent parameter of y (...,), both from 0 to 1."""
    return y + bend * y * (1.0 - y)


def with_between(nodes: Array) -> Array:
    """Return the nodes and the places between them, in order."""
    inner = nodes[:-1, None] + np.diff(nodes)[:, None] * np.array([0.0, *PLACES_BETWEEN_NODES])
    return np.append(inner.ravel(), nodes[-1])


def by_interval(values: Array) -> Array:
    """Return the largest value (n,) of each of n intervals, from values (4 n + 1, ...) at the places of `with_between`."""
    values = values.reshape(len(values), -1).max(axis=1)
    return np.maximum.reduceat(values, np.arange(0, len(values) - 1, PLACES_PER_INTERVAL))


def samples() -> Array:
    """Return the parameters (SAMPLES_PER_CURVE,) at which a planned curve is sampled, closer at the ends."""
    return 0.5 - 0.5 * np.cos(np.pi * np.linspace(0.0, 1.0, SAMPLES_PER_CURVE))


def plan(points: Array, excess: Callable[[Array, Array], Array], degree: int = SPLINE_DEGREE) -> Nodes:
    """Return the bend with the fewest nodes, and its nodes, for splines through points (SAMPLES_PER_CURVE, K, 3) at `samples`.

    `excess` returns the errors (F,) of drawn and exact points (F, K, 3), over the allowed error.
    """
    curve = SplineCurve.through(samples(), points, SPLINE_DEGREE)
    best: Nodes | None = None
    for bend in TRIED_BENDS:
        nodes = Nodes(np.linspace(0.0, 1.0, degree + 1), bend, degree)
        for strictness in range(PLANNING_ROUNDS):
            fine = nodes.fine
            exact = curve(nodes.own(fine))
            drawn = SplineCurve.through(nodes.y, exact[::PLACES_PER_INTERVAL], degree)(fine)
            errors = by_interval(excess(drawn, exact))
            if errors.max() <= 1.0 or (best is not None and nodes.y.size > 2 * best.y.size):
                break
            nodes = nodes.spread(errors, strictness)
        if best is None or nodes.y.size < best.y.size:
            best = nodes
    assert best is not None
    return best


def _spread(nodes: Array, excess: Array, target: float, degree: int, most: int) -> Array:
    """Return nodes that give every interval the error `target`, if errors fall with the power degree + 1 of the spacing."""
    excess = significant(np.maximum(excess, LEAST_EXCESS), EXCESS_BITS, 0.0)
    # smooth the errors: the error of an interval also depends on its neighbours
    around = np.pad(np.log(excess), 1, mode="edge")
    error = np.exp(0.25 * (around[:-2] + 2.0 * around[1:-1] + around[2:]))
    wanted = np.maximum((error / target) ** (1.0 / (degree + 1)), 1.0 / MAX_WIDENING)
    # number of new intervals up to each old node, and its inverse at whole numbers
    place = np.concatenate(([0.0], np.cumsum(wanted)))
    count = min(max(int(np.ceil(place[-1])), degree), most + 1)
    spread = on_grid(rising_through(place, nodes)(np.linspace(0.0, place[-1], count + 1)), STEPS_PER_CURVE)
    spread[0], spread[-1] = nodes[0], nodes[-1]
    return spread
