"""Knots at which a modification is sampled, so that the spline through the samples, a topography, equals the
modification.

A spline is smooth; a relief may begin with a corner. Knots are therefore dense there: lines that are kinks are knots,
and intervals are halved as long as the spline misses the modification between them.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from gearmesh.errors import ArgumentError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.splines import CUBIC_DEGREE, spline_through
from gearmesh.teeth.micro_geometry.modification import Modification, Topography

#: first intervals between neighbouring kinks: enough for a cubic
FIRST_INTERVALS = 4
#: places in an interval, as shares of it, at which spline and modification are compared
COMPARED_SHARES = (0.25, 0.5, 0.75)
#: share of the tolerance for each direction
DIRECTION_SHARE = 0.4
#: most knots in a direction
MAX_KNOTS = 300


def topography_of(modification: Modification, tolerance: float) -> tuple[Topography, float]:
    """Return the topography of a modification, and its largest error between the knots, mm, at most `tolerance`.

    Raises DesignError if it needs too many knots.
    """
    e, kinks = modification.extent, modification.kinks
    knots = [_begin(e.root, e.tip, kinks.lengths), _begin(e.toe, e.heel, kinks.positions)]
    while True:
        fine = [_fine(row) for row in knots]
        wanted = modification.jet(*np.meshgrid(*fine, indexing="ij")).a
        every = len(COMPARED_SHARES) + 1
        # each direction is tested along all lines of the other
        halved = [
            _halve(knots[0], fine[0], wanted, DIRECTION_SHARE * tolerance),
            _halve(knots[1], fine[1], wanted.T, DIRECTION_SHARE * tolerance),
        ]
        amounts = tuple(map(tuple, wanted[::every, ::every].tolist()))
        made = Topography(tuple(knots[0].tolist()), tuple(knots[1].tolist()), amounts)
        missed = float(np.abs(made.jet(*np.meshgrid(*fine, indexing="ij")).a - wanted).max())
        if missed <= tolerance and all(len(a) == len(b) for a, b in zip(knots, halved, strict=True)):
            return made, missed
        knots = halved
        if max(map(len, knots)) > MAX_KNOTS:
            raise ArgumentError(
                "tolerance",
                1000.0 * tolerance,
                unit="um",
                reason=f"a topography would need more than {MAX_KNOTS} knots",
                allowed="more, or a relief that begins tangent to the flank",
            )


def _begin(first: float, last: float, kinks: tuple[float, ...]) -> Array:
    """Return the first knots between two ends: the kinks, and FIRST_INTERVALS between neighbours."""
    ends = sorted({first, last, *kinks})
    return np.array(
        [*(x for a, b in pairwise(ends) for x in np.linspace(a, b, FIRST_INTERVALS, endpoint=False)), ends[-1]]
    )


def _fine(knots: Array) -> Array:
    """Knots and the compared places between them, ascending."""
    steps = np.diff(knots)[:, None] * np.array([0.0, *COMPARED_SHARES])
    return np.append((knots[:-1, None] + steps).ravel(), knots[-1])


def _halve(knots: Array, fine: Array, wanted: Array, tolerance: float) -> Array:
    """Knots (K,), with every interval halved in which the splines through them miss the amounts.

    `wanted`: amounts (F, N) at `fine` places (F,).
    """
    every = len(COMPARED_SHARES) + 1
    spline = spline_through(knots, wanted[::every], CUBIC_DEGREE)
    missed = np.abs(spline(fine) - wanted).max(axis=1)[:-1].reshape(-1, every).max(axis=1)
    middles = 0.5 * (knots[:-1] + knots[1:])
    return np.sort(np.append(knots, middles[missed > tolerance]))
