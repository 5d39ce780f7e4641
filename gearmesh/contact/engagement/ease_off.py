"""Ease-off of a pair: the distance of the pinion's flank from the gear's flank when the gears turn at their nominal ratio.

The gear's flank, turned with exactly N1/N2, sweeps out the conjugate flank of the pinion. A point P of the true flank is nearest to
the conjugate flank at one rotation phi1(P), where the advance of P is greatest. The ease-off of P is the difference between this
advance and the greatest advance of all points, as a distance along the normal. Lines of equal phi1 are the contact lines of the
conjugate flank [Kolivand & Kahraman, Mech. Mach. Theory 44 (2009)].
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.engagement.engagement import Engagement
from gearmesh.contact.first_touch.field import advances
from gearmesh.contact.pair import Pair
from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.records import dataclass

#: positions in a pitch at which the advances of all points are computed
POSITIONS_PER_PITCH = 48
#: positions in a turn of the pinion, at least: a thread passes in part of a turn
MIN_POSITIONS_PER_TURN = 192
#: distance (mm) by which a later passing of a worm's point must be nearer than its first passing to count
SECOND_PASSING_MM = 1e-3
#: same for passings beyond the edges of the mating flank, by the error (mm) of its continued table near the base circle
SECOND_PASSING_PAST_EDGES_MM = 5e-3
#: positions times points whose advances are held at once, in some 30 tables of this size
LARGEST_TABLE = 2**17


@dataclass(frozen=True)
class EaseOff:
    """Ease-off on a grid over the pinion's flank, from form point to tip (I) and from toe to heel (J)."""

    #: points (I, J, 3), own frame, mm
    points: Array
    #: ease-off (I, J) along the normal, mm, 0 at the most advanced point, NaN where the gear's flank ends before the nearest place
    distance: Array
    #: rotation (I, J) of the pinion at which the point is nearest, rad, NaN as in `distance`
    phi1: Array
    #: distance (I, J) of the nearest place past the edge of the gear's flank, mm, below 0 on the flank
    beyond: Array
    #: ease-off (I, J) from the continued table of the gear's flank, mm, NaN where the table ends too
    continued: Array
    #: rotation (I, J) of the pinion that belongs to `continued`, rad
    continued_phi1: Array

    def image(self, exchange: Array, turn: float) -> EaseOff:
        """Return the ease-off of the other flanks, which are the images of these flanks.

        `exchange` (3,): diagonal of the map of the own frames. `turn`: sum (rad) of a rotation of the pinion and the
        rotation of its image.
        """

        def along_face(values: Array) -> Array:
            """Return values (I, J, ...) from the image's toe to its heel: a half turn exchanges the ends of the face."""
            return values if exchange[2] > 0.0 else values[:, ::-1]

        return EaseOff(
            along_face(exchange * self.points),
            along_face(self.distance),
            along_face(turn - self.phi1),
            along_face(self.beyond),
            along_face(self.continued),
            along_face(turn - self.continued_phi1),
        )


def ease_off(engagement: Engagement, pitch: float, grid: Array | None = None) -> EaseOff:
    """Compute the ease-off of a pair from its engagement at pinion pitch `pitch` (rad).

    `grid` (I, J, 2) holds surface parameters of the pinion's flank; the default is the grid of the solver. The error is the error
    of the flank's table (see `heights`), mostly 0.1 um. Where the gear's flank begins near its base circle, a node may be 1.15 um
    too far advanced (`beveloid_parallel`), and all distances count from the most advanced node.
    """
    pair = engagement.pair.parts[0]
    low, high = engagement.phi1[[0, -1]]
    phi1 = np.linspace(
        low,
        high,
        int(np.ceil((high - low) * max(POSITIONS_PER_PITCH / pitch, MIN_POSITIONS_PER_TURN / (2.0 * np.pi)))) + 1,
    )
    grid = pair.pinion.grid if grid is None else grid
    jet = pair.pinion.surface.jet(grid[..., 0].ravel(), grid[..., 1].ravel())
    count = max(1, LARGEST_TABLE // len(phi1))
    blocks = [slice(k, k + count) for k in range(0, len(jet.r), count)]
    with np.errstate(all="ignore"):
        rows = np.concatenate([_nearest_rows(pair, phi1, jet.r[part], jet.n[part]) for part in blocks], axis=1)
        (advance, nearest_phi1, nearest_beyond), (advance_past, phi1_past, beyond_past) = rows.reshape(2, 3, -1)
        # the point with the greatest advance has the ease-off 0
        top = np.fmax.reduce(advance)
        distance = (top - advance) * _levers(pair, jet.r, jet.n, nearest_phi1)
        continued = (top - advance_past) * _levers(pair, jet.r, jet.n, phi1_past)
        # a point with a place on the gear's flank keeps this place in the continued rows too
        known = np.isfinite(distance)
        continued = np.where(known, distance, continued)
        continued_phi1 = np.where(known, nearest_phi1, phi1_past)
        beyond = np.where(known, nearest_beyond, beyond_past)
    shape = grid.shape[:2]
    parts = (values.reshape(shape) for values in (distance, nearest_phi1, beyond, continued, continued_phi1))
    return EaseOff(jet.r.reshape(*shape, 3), *parts)


def _nearest_rows(pair: Pair, phi1: Array, r: Array, n: Array) -> Array:
    """Return advance (rad), rotation (rad) and distance past the gear's edges (mm) of points r (K, 3) with normals n, (6, K).

    The first three rows belong to the gear's flank, the other rows to its continued table.
    """
    field = advances(pair, phi1, r, n, np.arange(len(phi1)))
    past = field.beyond.max(axis=0)
    # a thread passes the gear's flank also from behind, where no advance exists
    advance = np.where(np.isnan(field.advance), -np.inf, field.advance)
    levers = _levers(pair, r, n, phi1[advance.argmax(axis=0)])
    first = np.broadcast_to(np.arange(len(phi1), dtype=float)[:, None], advance.shape)
    places = (
        _Nearest.of(phi1, np.where(past <= 0.0, advance, -np.inf), SECOND_PASSING_MM / levers, first),
        _Nearest.of(phi1, advance, SECOND_PASSING_PAST_EDGES_MM / levers, past),
    )
    return np.stack([row for place in places for row in (place.advance, place.phi1, place.read(past))])


@dataclass(frozen=True)
class _Nearest:
    """Greatest advance of K points over N positions, by a parabola through three positions."""

    #: rotation (K,) of the pinion at the greatest advance, rad, NaN where an edge of the gear cuts the advance off
    phi1: Array
    #: greatest advance (K,), rad, NaN likewise
    advance: Array
    #: number (K,) of the middle position of the parabola
    k: NDArray[np.intp]
    #: place (K,) of the greatest advance after the middle position, in steps
    share: Array

    @staticmethod
    def of(phi1: Array, advance: Array, equal: Array, least: Array) -> _Nearest:
        """Find the greatest advances in a table (N, K), rad, that is -inf without an advance.

        Of maxima that differ by less than `equal` (K,), rad, the place with the least value of `least` (N, K) counts.
        """
        before, at, after = advance[:-2], advance[1:-1], advance[2:]
        bend = before - 2.0 * at + after
        summit = np.isfinite(bend) & (bend < 0.0) & (at >= before) & (at >= after)
        share = np.where(summit, 0.5 * (before - after) / bend, 0.0)
        greatest = np.where(summit, at - 0.25 * (before - after) * share, -np.inf)
        # a greatest advance that an edge cuts off is no maximum
        alike = summit & (greatest >= advance.max(axis=0) - equal)
        one, every = np.where(alike, least[1:-1], np.inf).argmin(axis=0), np.arange(advance.shape[1])
        met = alike[one, every]
        share, height = (np.where(met, values[one, every], np.nan) for values in (share, greatest))
        return _Nearest(phi1[one + 1] + share * (phi1[1] - phi1[0]), height, one + 1, share)

    def read(self, values: Array) -> Array:
        """Interpolate values (N, K) at the places of the greatest advance, linearly between two positions; return (K,)."""
        every = np.arange(len(self.k))
        at, next_one = (values[self.k + step, every] for step in (0, np.where(self.share < 0.0, -1, 1)))
        between: Array = at + np.abs(self.share) * (next_one - at)
        return between


def gaps_at(pair: Pair, phi1: Array, phi2: Array, grid: Array) -> Array:
    """Compute distances (N, I, J), mm, of the pinion's flank from the gear's flank at rotations phi1, phi2 (N,), rad.

    `grid` (I, J, 2) holds surface parameters of the pinion's flank; distances are along its normals. NaN where the gear's flank has
    no point on the circle of a point about the gear's axis. The error is the error of the ease-off, so that distances at contact
    may be below 0.
    """
    jet = pair.pinion.surface.jet(grid[..., 0].ravel(), grid[..., 1].ravel())
    with np.errstate(all="ignore"):
        field = advances(pair, phi1, jet.r, jet.n, np.arange(len(phi1)))
        advance = np.where((field.beyond <= 0.0).all(axis=0), field.advance, np.nan)
        behind = pair.drive * (phi2 - pair.ratio * phi1)[:, None] - advance
        gaps: Array = behind * _all_levers(pair, jet.r, jet.n, phi1)
    return gaps.reshape(-1, *grid.shape[:2])


def _levers(pair: Pair, r: Array, n: Array, phi1: Array) -> Array:
    """Return distances (..., K), mm, from the gear's axis of normals n at points r (K, 3), own frame, at phi1 (..., K or 1)."""
    place, gear = pair.pinion.mount.at(phi1), pair.gear.mount
    levers: Array = np.abs(dot(place.vector(n), gear.velocity(place.point(r))))
    return levers


def _all_levers(pair: Pair, r: Array, n: Array, phi1: Array) -> Array:
    """Return `_levers` (N, K) of all points r (K, 3) at all rotations phi1 (N,).

    The velocity of the gear is linear in the place, so that four places at each rotation give it at all points by one product.
    """
    turned, gear = phi1[:, None], pair.gear.mount
    place = pair.pinion.mount.at(turned)
    moved = gear.velocity(place.point(np.concatenate((np.zeros((1, 3)), np.eye(3)))))
    origin, *axes = np.moveaxis(place.inverse.vector(moved), 1, 0)
    velocity = np.concatenate((origin, *(along - origin for along in axes)), axis=1)
    levers: Array = np.abs(velocity @ np.concatenate((n, *(r[:, [k]] * n for k in range(3))), axis=1).T)
    return levers
