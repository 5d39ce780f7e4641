"""Nodes for splines through exact curves: spread so that every interval has the same error.

The parameter may be bent first: x = y + bend y (1 - y) runs slower at one end. Where undercut is near, curves go like
sqrt(x + e), and polynomials in a y that is quadratic in x follow them. Bends and first nodes are planned on curves that
are sampled once; whoever has the exact curves spreads the nodes again, by what is measured between them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.grid import on_grid, significant
from gearmesh.kernel.numeric.splines import SplineCurve, rising_through

#: degree of every spline of a STEP file; a spline takes at least one node more than its degree
DEGREE = 5
#: places between neighbouring nodes at which deviations are measured
BETWEEN = np.array([0.25, 0.5, 0.75])
STEP = len(BETWEEN) + 1
#: bends that are tried. On the samples 0.5 to 0.75 saves a quarter of a fillet's nodes, 0.75 to 0.9 a third where undercut is near
BENDS = (0.0, -0.5, 0.5, -0.8, 0.8)
#: share of the allowed error that an interval is given when nodes are spread, less in every round
TARGET, TIGHTER = 0.7, 0.75
#: an interval is never widened more than this at once: one without error says nothing about its surroundings
WIDEST = 4.0
#: rounds of spreading in a plan, and samples of a curve that is planned on: it is known to far below a micrometre then
ROUNDS, SAMPLES = 6, 65
#: bits of errors that spacing follows, and least error: points are exact to 1e-6 of what is allowed, which must not move nodes
EXCESS_BITS, LEAST_EXCESS = 5, 1e-3
#: steps of the grid on which nodes are placed: last digits of errors, which differ between processors, do not move them
STEPS_PER_CURVE = 2.0**20
#: most nodes
MOST = 200


@dataclass(frozen=True)
class Nodes:
    """Nodes `y` (N,) from 0 to 1 of a spline of a degree, at most `most` of them and one or two, and the bend that takes them to
    the curve's own parameter."""

    y: Array
    bend: float = 0.0
    degree: int = DEGREE
    most: int = MOST

    @property
    def fine(self) -> Array:
        """The nodes and the places between them, in order."""
        return with_between(self.y)

    def own(self, y: Array) -> Array:
        """The curve's own parameter at y (...,), both from 0 to 1."""
        return warp(y, self.bend)

    def spread(self, excess: Array, strictness: int = 0) -> Nodes:
        """New nodes by the errors (N - 1,) between the present ones, as multiples of what is allowed."""
        return replace(self, y=_spread(self.y, excess, TARGET * TIGHTER**strictness, self.degree, self.most))


def warp(y: Array, bend: float) -> Array:
    return y + bend * y * (1.0 - y)


def with_between(nodes: Array) -> Array:
    """The nodes and the places between them, in order."""
    inner = nodes[:-1, None] + np.diff(nodes)[:, None] * np.array([0.0, *BETWEEN])
    return np.append(inner.ravel(), nodes[-1])


def by_interval(values: Array) -> Array:
    """The largest of values (4 n + 1, ...) at `with_between` places in each of the n intervals, (n,)."""
    values = values.reshape(len(values), -1).max(axis=1)
    return np.maximum.reduceat(values, np.arange(0, len(values) - 1, STEP))


def samples() -> Array:
    """Where a curve that is planned on is sampled: closer at the ends, (SAMPLES,)."""
    return 0.5 - 0.5 * np.cos(np.pi * np.linspace(0.0, 1.0, SAMPLES))


def plan(points: Array, excess: Callable[[Array, Array], Array], degree: int = DEGREE) -> Nodes:
    """Bend and nodes for splines through curves with points (SAMPLES, K, 3) at `samples`, the bend that takes the fewest nodes.

    `excess` gives, of drawn and exact points (F, K, 3), the errors as multiples of what is allowed, (F,).
    """
    curve = SplineCurve.through(samples(), points, DEGREE)
    best: Nodes | None = None
    for bend in BENDS:
        nodes = Nodes(np.linspace(0.0, 1.0, degree + 1), bend, degree)
        for strictness in range(ROUNDS):
            fine = nodes.fine
            exact = curve(nodes.own(fine))
            drawn = SplineCurve.through(nodes.y, exact[::STEP], degree)(fine)
            errors = by_interval(excess(drawn, exact))
            if errors.max() <= 1.0 or (best is not None and nodes.y.size > 2 * best.y.size):
                break
            nodes = nodes.spread(errors, strictness)
        if best is None or nodes.y.size < best.y.size:
            best = nodes
    assert best is not None
    return best


def _spread(nodes: Array, excess: Array, target: float, degree: int, most: int) -> Array:
    """Nodes that give every interval the error `target`: errors go with the spacing to the power of the degree and one."""
    excess = significant(np.maximum(excess, LEAST_EXCESS), EXCESS_BITS, 0.0)
    # one interval's error is also its neighbours' doing
    around = np.pad(np.log(excess), 1, mode="edge")
    error = np.exp(0.25 * (around[:-2] + 2.0 * around[1:-1] + around[2:]))
    wanted = np.maximum((error / target) ** (1.0 / (degree + 1)), 1.0 / WIDEST)
    place = np.concatenate(([0.0], np.cumsum(wanted)))
    count = min(max(int(np.ceil(place[-1])), degree), most + 1)
    spread = on_grid(rising_through(place, nodes)(np.linspace(0.0, place[-1], count + 1)), STEPS_PER_CURVE)
    spread[0], spread[-1] = nodes[0], nodes[-1]
    return spread
