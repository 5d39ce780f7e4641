"""Projection of points onto a trimmed flank: ellipses and curves lie on the exact surface and end at its edges."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.flanks import solver_flank
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.nearest import nearest
from gearmesh.kernel.surface.surface import Surface
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.kept_by_tooth import KeptByTooth
from gearmesh.teeth.region import Side

#: start points of projections across and along a flank
START_GRID = (31, 61)
#: distance beyond an edge at which a point is still on the flank
EDGE_TOLERANCE_MM = 1e-6
#: points whose distances from all start points are in memory together: these 0.5 MB stay in the processor's cache
MAX_POINTS_AT_ONCE = 32


@dataclass(frozen=True)
class FlankFeet:
    """Projection onto the exact flank of a member, in its own frame, mm."""

    #: surface of the flank
    surface: Surface
    #: distance (N,) of points beyond the edges, from surface parameters (N, 2) and points (N, 3)
    margin: Callable[[Array, Array], Array]
    #: start points (S, 3)
    starts: Array
    #: surface parameters (S, 2) of the start points
    parameters: Array

    def __call__(self, points: Array) -> Array:
        """Return the closest points (..., 3) of the trimmed flank, NaN beyond its edges."""
        places, beyond = self._feet(points)
        return np.where((beyond > 0.0)[..., None], np.nan, places)

    def beyond(self, points: Array) -> Array:
        """Return distances (...,) of the projections of points (..., 3) beyond the edges, mm; not above 0 on the flank."""
        return self._feet(points)[1]

    def _feet(self, q: Array) -> tuple[Array, Array]:
        """Return closest points (..., 3) of the surface, and their distances (...,) beyond the edges less the tolerance.

        The distance is infinite where there is no closest point.
        """
        known = np.isfinite(q).all(axis=-1)
        places, beyond = np.full(q.shape, np.nan), np.full(q.shape[:-1], np.inf)
        distance, start = _nearest_start(q[known], self.starts)
        foot = nearest(self.surface, q[known], *self.parameters[start].T)
        jet = foot.jet
        # beyond a singular line of the surface the search can end farther away than it started, or not converge
        lost = np.linalg.norm(jet.r - q[known], axis=-1) > distance + 1e-9
        lost |= ~(foot.residual <= EDGE_TOLERANCE_MM)
        places[known] = jet.r
        beyond[known] = np.where(lost, np.inf, self.margin(foot.values, jet.r) - EDGE_TOLERANCE_MM)
        return places, beyond


#: projections of the last flanks
_KEPT_FEET = KeptByTooth[FlankFeet]()


def flank_projection(member: Member, side: Side) -> FlankFeet:
    """Return the projection onto the trimmed flank of one side of a member's tooth; those of the last flanks are kept."""
    tooth = member.one_tooth

    def made() -> FlankFeet:
        s, t = (np.linspace(0.0, 1.0, n) for n in START_GRID)
        grid, flank = tooth.flank_grid(side, s, t), solver_flank(member, side)
        return FlankFeet(flank.surface, flank.margin, grid.points.reshape(-1, 3), grid.parameters.reshape(-1, 2))

    return _KEPT_FEET.get(tooth, side, made)


def _nearest_start(q: Array, starts: Array) -> tuple[Array, NDArray[np.int64]]:
    """Distance (N,) of points (N, 3) from the nearest start point (S, 3), and its index; a tree would take longer to
    load.
    """
    middle = starts.mean(axis=0)
    centred = starts - middle
    # the square of the distance, less that of the point from the middle, is one product of four numbers each
    points = np.concatenate((q - middle, np.ones((len(q), 1))), axis=1)
    factors = np.concatenate((-2.0 * centred.T, dot(centred, centred)[None]))
    number = np.empty(len(q), dtype=np.int64)
    squares = np.empty((MAX_POINTS_AT_ONCE, len(starts)))
    for first in range(0, len(q), MAX_POINTS_AT_ONCE):
        part = points[first : first + MAX_POINTS_AT_ONCE]
        np.matmul(part, factors, out=squares[: len(part)])
        squares[: len(part)].argmin(axis=1, out=number[first : first + len(part)])
    return np.linalg.norm(q - starts[number], axis=-1), number
