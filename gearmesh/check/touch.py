"""First touch of two flanks that turn about one axis: the circle on which the pinion is farthest ahead of the gear.

Every circle about the gear's axis that meets both flanks has an advance: the height of the pinion over the gear, by
which the gear must turn on this circle. Circles are places (rho, z). The circles that meet both flanks fill the overlap
of two regions with rims. The largest advance is in one of three kinds of places. Each kind is searched separately, so
that an overlap that is a thin strip or a mere corner is not missed:

1. Corners of the overlap: crossings of a rim of one flank with a rim of the other (Newton's method on both rims,
   exact).
2. Sides of the overlap: rims of one flank over the other flank, divided between the corners (`_rim`).
3. Inside of the overlap: cells of the (rho, z) plane, divided while they may hold the largest advance (`_inside`).
   Cells that contain a place of a rim are divided, too, even if their centres are not on both flanks.

A flank of several patches has the rims of all patches: a corner of the profile is a rim and needs no other treatment.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.check.heightfield import Field, Hits, Ways
from gearmesh.kernel.numeric.algebra import Array, plane_cross
from gearmesh.records import dataclass

#: precision of the gear's turn, at the contact: 3e-8 mm at a radius of 90 mm are 7e-5 arc seconds
TOUCH_TOLERANCE_MM = 3e-8
#: cells of the first grid in either direction
FIRST_CELLS = 64
#: parts of a divided cell in either direction, and of a divided piece of a rim
PARTS_PER_DIVISION = 4
#: limit of the cells or pieces of a rim that are divided at once
MAX_CELLS = 32
#: limit of the divisions
MAX_STAGES = 24
#: stages at which cells on rims are divided whatever their centres say
RIM_STAGES = 5
#: largest rise of a cell near a level place, relative to the change of its rise to the next cell
MAX_RISE_PER_BEND = 4.0
#: stages at which cells without neighbours may hold a level place
LONELY_STAGES = 8
#: size of cells that are not divided any more
MIN_CELL_MM = 1e-7
#: places on a segment of a rim that are tried first, as shares
FIRST_RIM_SHARES = np.array([0.0, 0.5, 1.0])
#: distance between places of two rims at a crossing
CROSSING_TOLERANCE_MM = 1e-10
#: excess of shares over the ends of a segment
SHARE_TOLERANCE = 1e-7
#: Newton steps to a crossing
MAX_CROSSING_STEPS = 12


@dataclass(frozen=True)
class FirstTouch:
    """First touch of the gear, in the frame of its bearing, with the gear not turned."""

    #: turn of the gear in the direction of the push, rad
    turn: float
    #: point (3,) of the pinion, mm
    point: Array
    #: unit normal (3,) of the pinion
    pinion_normal: Array
    #: unit normal (3,) of the gear
    gear_normal: Array
    #: touching parts of pinion and gear
    parts: tuple[int, int]
    #: True for a member that touches with its rim
    on_rims: tuple[bool, bool]
    #: size of the first cells of the search, mm
    cell: float
    #: number of evaluated places
    count: int


@dataclass(frozen=True)
class _Advances:
    """Advances of the pinion over the gear."""

    #: places (N, 2)
    flat: Array
    #: advances (N,), rad; NaN where a flank is missed
    advance: Array
    #: hits on the pinion
    pinion: Hits
    #: hits on the gear
    gear: Hits
    #: True for a member whose places are on its rim
    on_rims: tuple[bool, bool]

    def best(self, cell: float) -> FirstTouch | None:
        if not np.isfinite(self.advance).any():
            return None
        k = int(np.nanargmax(self.advance))
        pinion_hits, gear_hits = self.pinion, self.gear
        parts = int(pinion_hits.part[k]), int(gear_hits.part[k])
        return FirstTouch(
            float(self.advance[k]),
            pinion_hits.point[k],
            pinion_hits.normal[k],
            gear_hits.normal[k],
            parts,
            self.on_rims,
            cell,
            len(self.advance),
        )


def first_touch(pinion: Field, gear: Field, arcs: Ways) -> FirstTouch | None:
    """Return the largest advance of the pinion over the gear, to `TOUCH_TOLERANCE_MM`; None if no circle meets both."""
    low = np.maximum(pinion.box[0], gear.box[0])
    high = np.minimum(pinion.box[1], gear.box[1])
    if (high < low - CROSSING_TOLERANCE_MM).any():
        return None
    size = np.maximum(high - low, MIN_CELL_MM) / FIRST_CELLS
    cell = float(size.max())
    best, count = None, 0
    seeds: list[_Advances] = []
    for advances in _on_rims(pinion, gear, arcs, (low, high)):
        best, count = _better(best, advances.best(cell)), count + len(advances.advance)
        seeds.append(advances)
    for advances in _inside(pinion, gear, arcs, (low, size), best, seeds):
        best, count = _better(best, advances.best(cell)), count + len(advances.advance)
    return None if best is None else replace(best, count=count)


def _better(one: FirstTouch | None, other: FirstTouch | None) -> FirstTouch | None:
    if one is None or other is None:
        return one or other
    return other if other.turn > one.turn else one


# --- inside -----------------------------------------------------------------------------------------------------------


def _inside(
    pinion: Field,
    gear: Field,
    arcs: Ways,
    cells: tuple[Array, Array],
    best: FirstTouch | None,
    seeds: list[_Advances],
) -> Iterator[_Advances]:
    """Yield advances at the centres of ever smaller cells; `cells` are the corner and the size of the first cells.

    A cell is kept if it may exceed the best known advance: its advance at the centre plus twice the gain over half a
    cell reaches the best. On facets, one facet of a cell may fall while the next rises, so the gain of the steepest
    candidate counts for all cells. The neighbours of a kept cell are kept, too, so that rims are followed. On smooth
    flanks a largest advance inside is level: cells as steep as all cells around them are dropped, because their rims
    are searched separately.
    """
    low, size = cells
    grid = _square(np.arange(FIRST_CELLS))
    known = np.concatenate([seed.advance for seed in seeds]) if seeds else np.zeros(0)
    places = np.concatenate([seed.flat for seed in seeds]) if seeds else np.zeros((0, 2))
    places, known = places[np.isfinite(known)], known[np.isfinite(known)]
    smooth = pinion.smooth and gear.smooth
    for stage in range(MAX_STAGES):
        flat = low + (grid + 0.5) * size
        advances = _both(pinion, gear, flat)
        flat, pinion_hits, gear_hits = advances.flat, advances.pinion, advances.gear
        yield advances
        best = _better(best, advances.best(0.0))
        if best is None:
            return
        advance = advances.advance
        grid = np.floor((flat - low) / size).astype(np.int64)
        with np.errstate(all="ignore"):
            slope = arcs.slope(pinion_hits.point, pinion_hits.normal) - arcs.slope(gear_hits.point, gear_hits.normal)
            gain = np.abs(slope * size).sum(axis=-1) / 2.0
            candidates = advance + 2.0 * gain >= best.turn
            # without candidates nothing is known yet, and any advance may hide beside a rim
            beside_rims = 2.0 * float(gain[candidates].max(initial=0.0)) if candidates.any() else np.inf
            if smooth:
                candidates &= gain <= MAX_RISE_PER_BEND * _bend(grid, advances, slope * size, stage)
        steepest = float(gain[candidates].max(initial=0.0))
        kept = np.flatnonzero(candidates if smooth else advance + 2.0 * steepest >= best.turn)
        # line contact has any number of candidates, of which the best suffice
        grid = grid[kept[np.argsort(-advance[kept])[:MAX_CELLS]]]
        # cells on rims with a large advance are divided in the first stages
        if stage < RIM_STAGES:
            rim_places = np.argsort(-known)[:MAX_CELLS]
            rim_places = rim_places[known[rim_places] + beside_rims >= best.turn]
            grid = np.concatenate((grid, np.floor((places[rim_places] - low) / size).astype(np.int64)))
        done = 2.0 * steepest * float(arcs.arm(best.point)) <= TOUCH_TOLERANCE_MM
        if not len(grid) or (done and stage >= RIM_STAGES) or size.max() < MIN_CELL_MM:
            return
        grid, size = _divide(grid), size / PARTS_PER_DIVISION


def _bend(grid: NDArray[np.int64], advances: _Advances, rise: Array, stage: int) -> Array:
    """Return the difference (N,), rad, of the rise (N, 2) over cells `grid` (N, 2) from the rise over their neighbours.

    Only neighbours on the same parts count. Without neighbours the difference is unknown (inf). At later stages it is
    0, because a strip without neighbours is a rim by then.
    """
    if not len(grid):
        return np.zeros(0)
    part = 1000 * advances.pinion.part + advances.gear.part
    span = np.ptp(grid, axis=0) + 3
    place = grid - grid.min(axis=0) + 1
    key = place[:, 0] * span[1] + place[:, 1]
    order = np.argsort(key)
    bend = np.full(len(grid), -np.inf)
    for step in (span[1], -span[1], 1, -1):
        at = np.minimum(np.searchsorted(key[order], key + step), len(key) - 1)
        other = order[at]
        beside = (key[other] == key + step) & (part[other] == part)
        change = np.abs(rise[other] - rise).sum(axis=-1)
        bend = np.where(beside, np.fmax(bend, change), bend)
    return np.where(np.isfinite(bend), bend, np.inf if stage < LONELY_STAGES else 0.0)


def _both(pinion: Field, gear: Field, flat: Array) -> _Advances:
    """Return advances at the places (N, 2) that are on both flanks."""
    pinion_hits = pinion.at(flat)
    on = np.isfinite(pinion_hits.height)
    flat, pinion_hits = flat[on], pinion_hits[on]
    gear_hits = gear.at(flat)
    on = np.isfinite(gear_hits.height)
    pinion_hits, gear_hits = pinion_hits[on], gear_hits[on]
    return _Advances(flat[on], pinion_hits.height - gear_hits.height, pinion_hits, gear_hits, (False, False))


def _divide(cells: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return cells (N, 2) with their eight neighbours, without duplicates, each divided in both directions."""
    spread = np.unique((cells[:, None] + _square(np.arange(-1, 2))).reshape(-1, 2), axis=0)
    return (spread[:, None] * PARTS_PER_DIVISION + _square(np.arange(PARTS_PER_DIVISION))).reshape(-1, 2)


def _square(steps: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return all pairs (K^2, 2) of steps (K,)."""
    return np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)


# --- rims -------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Places:
    """Places on a rim: segments (N,), shares (N,) and the known advances there (N,)."""

    segment: NDArray[np.int64]
    share: Array
    advance: Array


def _on_rims(pinion: Field, gear: Field, arcs: Ways, box: tuple[Array, Array]) -> Iterator[_Advances]:
    """Yield advances at crossings of rims, then on the pinion's rim over the gear and vice versa."""
    crossed, advances = _crossings(pinion, gear, box)
    yield advances
    best = advances.best(0.0)
    for own, mating, places, is_pinion in ((pinion, gear, crossed[0], True), (gear, pinion, crossed[1], False)):
        for advances in _rim(own, mating, is_pinion, places, box, best, arcs):
            yield advances
            best = _better(best, advances.best(0.0))


def _rim(
    own: Field,
    mating: Field,
    is_pinion: bool,
    crossed: _Places,
    box: tuple[Array, Array],
    best: FirstTouch | None,
    arcs: Ways,
) -> Iterator[_Advances]:
    """Yield advances on the rim of one flank over the mating flank, between crossings, in ever shorter pieces."""
    near = np.repeat(_near(own, box), len(FIRST_RIM_SHARES))
    share = np.tile(FIRST_RIM_SHARES, len(near) // len(FIRST_RIM_SHARES))
    advances = _over(own, mating, is_pinion, near, share)
    yield advances
    best = _better(best, advances.best(0.0))
    segment = np.concatenate((near, crossed.segment))
    share, advance = np.concatenate((share, crossed.share)), np.concatenate((advances.advance, crossed.advance))
    order = np.lexsort((share, segment))
    segment, share, advance = segment[order], share[order], advance[order]
    between = np.flatnonzero((segment[1:] == segment[:-1]) & (share[1:] > share[:-1]))
    # pieces (K,) with shares and advances (K, 2) of their ends
    segment = segment[between]
    shares = np.stack((share[between], share[between + 1]), axis=-1)
    ends = np.stack((advance[between], advance[between + 1]), axis=-1)
    for _ in range(MAX_STAGES):
        if best is None or not len(segment):
            return
        # keep pieces that may exceed the best advance, by twice the change of the steepest candidate
        change = np.nan_to_num(np.abs(ends[:, 1] - ends[:, 0]))
        top = np.fmax(ends[:, 0], ends[:, 1])
        with np.errstate(invalid="ignore"):
            steepest = change[top + 2.0 * change >= best.turn].max(initial=0.0)
            kept = np.flatnonzero(top + 2.0 * steepest >= best.turn)
        if 2.0 * steepest * float(arcs.arm(best.point)) <= TOUCH_TOLERANCE_MM:
            return
        kept = kept[np.argsort(-top[kept])[:MAX_CELLS]]
        steps = np.arange(PARTS_PER_DIVISION + 1) / PARTS_PER_DIVISION
        fine = shares[kept, :1] + steps * np.diff(shares[kept], axis=1)
        advances = _over(
            own, mating, is_pinion, np.repeat(segment[kept], PARTS_PER_DIVISION - 1), fine[:, 1:-1].ravel()
        )
        yield advances
        best = _better(best, advances.best(0.0))
        values = np.concatenate(
            (ends[kept, :1], advances.advance.reshape(-1, PARTS_PER_DIVISION - 1), ends[kept, 1:]), axis=1
        )
        segment = np.repeat(segment[kept], PARTS_PER_DIVISION)
        shares = np.stack((fine[:, :-1].ravel(), fine[:, 1:].ravel()), axis=-1)
        ends = np.stack((values[:, :-1].ravel(), values[:, 1:].ravel()), axis=-1)


def _over(own: Field, mating: Field, is_pinion: bool, segment: NDArray[np.int64], share: Array) -> _Advances:
    """Return advances at places of a rim over the mating gear."""
    place = own.rim(segment, share)
    met = mating.at(place.flat)
    pinion_hits, gear_hits = (place.hits, met) if is_pinion else (met, place.hits)
    return _Advances(
        place.flat, pinion_hits.height - gear_hits.height, pinion_hits, gear_hits, (is_pinion, not is_pinion)
    )


def _near(field: Field, box: tuple[Array, Array]) -> NDArray[np.int64]:
    """Return the segments of the rim that may enter a box."""
    low, high = _bounds(field, np.arange(field.rim_segments))
    return np.flatnonzero((high >= box[0]).all(axis=-1) & (low <= box[1]).all(axis=-1))


def _bounds(field: Field, segment: NDArray[np.int64]) -> tuple[Array, Array]:
    """Return smallest and largest flat coordinates (N, 2) of segments, with twice their bulge as a margin."""
    start, middle, end = (field.rim(segment, np.full(len(segment), share)).flat for share in FIRST_RIM_SHARES)
    bulge = 2.0 * np.abs(middle - 0.5 * (start + end)) + 1e3 * CROSSING_TOLERANCE_MM
    low, high = np.minimum(np.minimum(start, end), middle), np.maximum(np.maximum(start, end), middle)
    return low - bulge, high + bulge


def _crossings(pinion: Field, gear: Field, box: tuple[Array, Array]) -> tuple[tuple[_Places, _Places], _Advances]:
    """Return the crossings of the rims: places on either rim, and the advances there."""
    first, second = _near(pinion, box), _near(gear, box)
    (low, high), (other_low, other_high) = _bounds(pinion, first), _bounds(gear, second)
    # pairs of segments whose boxes overlap
    meet = np.ones((len(first), len(second)), dtype=bool)
    for k in range(2):
        meet &= (low[:, k, None] <= other_high[None, :, k]) & (other_low[None, :, k] <= high[:, k, None])
    i, j = np.nonzero(meet)
    first, second = first[i], second[j]
    share = np.full((len(first), 2), 0.5)
    # Newton's method for the shares of both segments
    for _ in range(MAX_CROSSING_STEPS):
        one, other = pinion.rim(first, share[:, 0]), gear.rim(second, share[:, 1])
        apart = other.flat - one.flat
        with np.errstate(all="ignore"):
            turning = plane_cross(one.rate, other.rate)
            step = np.stack((plane_cross(apart, other.rate), plane_cross(apart, one.rate)), axis=-1) / turning[:, None]
        share = np.clip(share + np.nan_to_num(step, posinf=0.0, neginf=0.0), -0.3, 1.3)
    one, other = pinion.rim(first, share[:, 0]), gear.rim(second, share[:, 1])
    met = np.abs(other.flat - one.flat).max(axis=-1) <= CROSSING_TOLERANCE_MM
    met &= (share >= -SHARE_TOLERANCE).all(axis=-1) & (share <= 1.0 + SHARE_TOLERANCE).all(axis=-1)
    advance = np.where(met, one.hits.height - other.hits.height, np.nan)
    advances = _Advances(one.flat, advance, one.hits, other.hits, (True, True))
    places = [_Places(rim_places[met], share[met, k], advance[met]) for k, rim_places in enumerate((first, second))]
    return (places[0], places[1]), advances
