"""The ease-off of a pair: how far the pinion's flank stays from the gear's when the gears turn at their nominal ratio.

The gear's flank, turned with exactly N1/N2, sweeps out the pinion's flank that is conjugate to it. A point P of the true one is
nearest to it at one rotation phi1(P), where its advance is greatest; how much less that is than that of the point that is most
advanced, along the normal, is its ease-off. Lines of equal phi1 are the contact lines of the conjugate [Kolivand & Kahraman,
Mech. Mach.
Theory 44 (2009)].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.engagement.engagement import Engagement
from gearmesh.contact.first_touch.field import advances
from gearmesh.contact.pair import Pair
from gearmesh.kernel.numeric.algebra import Array, dot

#: positions at which the advances of all points are taken: in a pitch, and in a turn at least, as a thread passes in part of one
PER_PITCH, PER_TURN = 48, 192
#: mm by which a point of a worm, which conjugate flanks may pass twice, is as near to them at its first passing as at the other
AS_NEAR = 1e-3
#: mm within which tables of flanks are right as far past their edges as the mating flank is drawn: near the base circle a point
#: seems to touch there twice
PAST_EDGES = 5e-3
#: positions times points whose advances are held at once, in some 30 tables of so many numbers
LARGEST_TABLE = 2**17


@dataclass(frozen=True)
class EaseOff:
    """On a grid over the pinion's flank, from form point to tip (I) and from toe to heel (J).

    `points` (I, J, 3), own frame, mm; `distance` (I, J), mm, along the normal, 0 where it is least, and `phi1` (I, J), rad: NaN
    where the gear's flank ends before the point is nearest to it. `beyond` (I, J), mm: how far it ends before that, < 0 where it
    does not; `continued` (I, J), mm, and `continued_phi1` (I, J), rad: the same of the flank as its table goes on, NaN where
    that ends too.
    """

    points: Array
    distance: Array
    phi1: Array
    beyond: Array
    continued: Array
    continued_phi1: Array


def ease_off(engagement: Engagement, pitch: float, grid: Array | None = None) -> EaseOff:
    """The ease-off of a pair that has been followed through its engagement, at pinion pitch `pitch` (rad).

    To the accuracy of the flank's table (see `heights`), mostly some 0.1 um; where the gear's flank begins near its base circle
    a node may be 1.15 um too far advanced (`beveloid_parallel`), and all distances count from the most advanced one. At surface
    parameters `grid` (I, J, 2) of the pinion's flank, by default those that the solver samples.
    """
    pair = engagement.pair.parts[0]
    low, high = engagement.phi1[[0, -1]]
    phi1 = np.linspace(low, high, int(np.ceil((high - low) * max(PER_PITCH / pitch, PER_TURN / (2.0 * np.pi)))) + 1)
    grid = pair.pinion.grid if grid is None else grid
    jet = pair.pinion.surface.jet(grid[..., 0].ravel(), grid[..., 1].ravel())
    count = max(1, LARGEST_TABLE // len(phi1))
    blocks = [slice(k, k + count) for k in range(0, len(jet.r), count)]
    with np.errstate(all="ignore"):
        rows = np.concatenate([_nearest_rows(pair, phi1, jet.r[part], jet.n[part]) for part in blocks], axis=1)
        (advance, nearest_phi1, nearest_beyond), (advance_past, phi1_past, beyond_past) = rows.reshape(2, 3, -1)
        # NaN where no point is most advanced in the middle of the positions
        top = np.fmax.reduce(advance)
        distance = (top - advance) * _levers(pair, jet.r, jet.n, nearest_phi1)
        continued = (top - advance_past) * _levers(pair, jet.r, jet.n, phi1_past)
        # a point that worms pass twice goes on where it touches
        known = np.isfinite(distance)
        continued = np.where(known, distance, continued)
        continued_phi1 = np.where(known, nearest_phi1, phi1_past)
        beyond = np.where(known, nearest_beyond, beyond_past)
    shape = grid.shape[:2]
    parts = (values.reshape(shape) for values in (distance, nearest_phi1, beyond, continued, continued_phi1))
    return EaseOff(jet.r.reshape(*shape, 3), *parts)


def _nearest_rows(pair: Pair, phi1: Array, r: Array, n: Array) -> Array:
    """Advance (rad), rotation (rad) and distance past the gear's edges (mm) of points r (K, 3) with normals n, (6, K).

    The first three rows hold where points are nearest to the gear's flank, the others to the flank as its table goes on.
    """
    field = advances(pair, phi1, r, n, np.arange(len(phi1)))
    past = field.beyond.max(axis=0)
    # of threads the gear's flank also passes where it comes from behind: no advance there
    advance = np.where(np.isnan(field.advance), -np.inf, field.advance)
    levers = _levers(pair, r, n, phi1[advance.argmax(axis=0)])
    first = np.broadcast_to(np.arange(len(phi1), dtype=float)[:, None], advance.shape)
    places = (
        _Nearest.of(phi1, np.where(past <= 0.0, advance, -np.inf), AS_NEAR / levers, first),
        _Nearest.of(phi1, advance, PAST_EDGES / levers, past),
    )
    return np.stack([row for place in places for row in (place.advance, place.phi1, place.read(past))])


@dataclass(frozen=True)
class _Nearest:
    """Where points (K,) are most advanced over positions phi1 (N,), rad: on a parabola through three of them, the middle one number
    `k` and the place a `share` of a step after it; NaN where an edge of the gear cuts it off."""

    phi1: Array
    advance: Array
    k: NDArray[np.intp]
    share: Array

    @staticmethod
    def of(phi1: Array, advance: Array, equal: Array, least: Array) -> _Nearest:
        """Of advances (N, K), rad, -inf where there are none; of summits that differ by less than `equal` (K,) where `least`
        (N, K) is least."""
        before, at, after = advance[:-2], advance[1:-1], advance[2:]
        bend = before - 2.0 * at + after
        summit = np.isfinite(bend) & (bend < 0.0) & (at >= before) & (at >= after)
        share = np.where(summit, 0.5 * (before - after) / bend, 0.0)
        greatest = np.where(summit, at - 0.25 * (before - after) * share, -np.inf)
        # what is greatest where an edge cuts it off is no summit
        alike = summit & (greatest >= advance.max(axis=0) - equal)
        one, every = np.where(alike, least[1:-1], np.inf).argmin(axis=0), np.arange(advance.shape[1])
        met = alike[one, every]
        share, height = (np.where(met, values[one, every], np.nan) for values in (share, greatest))
        return _Nearest(phi1[one + 1] + share * (phi1[1] - phi1[0]), height, one + 1, share)

    def read(self, values: Array) -> Array:
        """Values (N, K) there, between two positions straight."""
        every = np.arange(len(self.k))
        at, next_one = (values[self.k + step, every] for step in (0, np.where(self.share < 0.0, -1, 1)))
        between: Array = at + np.abs(self.share) * (next_one - at)
        return between


def gaps_at(pair: Pair, phi1: Array, phi2: Array, grid: Array) -> Array:
    """How far (N, I, J), mm, the pinion's flank is from the gear's along its normal at rotations phi1, phi2 (N,), rad.

    At surface parameters `grid` (I, J, 2) of the pinion's flank; NaN where the gear's flank has no point on the circle of a point
    about the gear's axis. Accurate as the ease-off is, so that at contact some of them are below 0.
    """
    jet = pair.pinion.surface.jet(grid[..., 0].ravel(), grid[..., 1].ravel())
    with np.errstate(all="ignore"):
        field = advances(pair, phi1, jet.r, jet.n, np.arange(len(phi1)))
        advance = np.where((field.beyond <= 0.0).all(axis=0), field.advance, np.nan)
        behind = pair.drive * (phi2 - pair.ratio * phi1)[:, None] - advance
        gaps: Array = behind * _levers(pair, jet.r, jet.n, phi1[:, None])
    return gaps.reshape(-1, *grid.shape[:2])


def _levers(pair: Pair, r: Array, n: Array, phi1: Array) -> Array:
    """Distances (..., K), mm, of the normals n at points r (K, 3), own frame, from the gear's axis, at phi1 (..., K or 1)."""
    place, gear = pair.pinion.mount.at(phi1), pair.gear.mount
    levers: Array = np.abs(dot(place.vector(n), gear.velocity(place.point(r))))
    return levers
