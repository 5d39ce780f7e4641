"""Knots at which a modification is measured so that the spline through the amounts there, a topography, is the modification again.

A spline is smooth where a relief begins with a corner. So knots are close there: lines that are kinks are knots, and intervals are
halved for as long as the spline misses what lies between them.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from gearmesh.errors import ArgumentError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.splines import CUBIC_DEGREE, spline_through
from gearmesh.teeth.micro_geometry.modification import Modification, Topography

#: intervals between neighbouring kinks to begin with: enough for a cubic
FIRST = 4
#: places in an interval, by its length, at which spline and modification are compared
BETWEEN = (0.25, 0.5, 0.75)
#: share of the tolerance that each direction may take
SHARE = 0.4
#: most knots in a direction
MOST = 300


def topography_of(modification: Modification, tolerance: float) -> tuple[Topography, float]:
    """The topography of a modification, and by how much it misses it at most between its knots, mm, at most `tolerance`.

    Raises DesignError where that takes too many knots.
    """
    e, kinks = modification.extent, modification.kinks
    knots = [_begin(e.root, e.tip, kinks.lengths), _begin(e.toe, e.heel, kinks.positions)]
    while True:
        fine = [_fine(row) for row in knots]
        wanted = modification.jet(*np.meshgrid(*fine, indexing="ij")).a
        every = len(BETWEEN) + 1
        # in the first direction along all lines of the second, and the other way round
        halved = [
            _halve(knots[0], fine[0], wanted, SHARE * tolerance),
            _halve(knots[1], fine[1], wanted.T, SHARE * tolerance),
        ]
        amounts = tuple(map(tuple, wanted[::every, ::every].tolist()))
        made = Topography(tuple(knots[0].tolist()), tuple(knots[1].tolist()), amounts)
        missed = float(np.abs(made.jet(*np.meshgrid(*fine, indexing="ij")).a - wanted).max())
        if missed <= tolerance and all(len(a) == len(b) for a, b in zip(knots, halved, strict=True)):
            return made, missed
        knots = halved
        if max(map(len, knots)) > MOST:
            raise ArgumentError(
                "tolerance",
                1000.0 * tolerance,
                unit="um",
                reason=f"a topography would need more than {MOST} knots",
                allowed="more, or a relief that begins tangent to the flank",
            )


def _begin(first: float, last: float, kinks: tuple[float, ...]) -> Array:
    ends = sorted({first, last, *kinks})
    return np.array([*(x for a, b in pairwise(ends) for x in np.linspace(a, b, FIRST, endpoint=False)), ends[-1]])


def _fine(knots: Array) -> Array:
    """Knots and the places between them, ascending."""
    steps = np.diff(knots)[:, None] * np.array([0.0, *BETWEEN])
    return np.append((knots[:-1, None] + steps).ravel(), knots[-1])


def _halve(knots: Array, fine: Array, wanted: Array, tolerance: float) -> Array:
    """Knots (K,), those intervals halved in which the splines through them miss amounts `wanted` (F, N) at `fine` places (F,)."""
    every = len(BETWEEN) + 1
    spline = spline_through(knots, wanted[::every], CUBIC_DEGREE)
    missed = np.abs(spline(fine) - wanted).max(axis=1)[:-1].reshape(-1, every).max(axis=1)
    middles = 0.5 * (knots[:-1] + knots[1:])
    return np.sort(np.append(knots, middles[missed > tolerance]))
