"""First touch of two flanks that turn about one axis: the circle on which the pinion is farthest ahead of the gear.

Every circle about the gear's axis that meets both flanks has an advance: the height of the pinion over the gear, which is by
how much the gear must turn there. Circles are places (rho, z), and those that meet both flanks fill the overlap of two
regions with rims. The greatest advance is in one of three kinds of places, and each is looked for by itself, so that an
overlap that is a thin strip or a mere corner is missed by none:

1. Corners of the overlap: where a rim of one flank crosses a rim of the other (Newton on both rims, exact).
2. Its sides: rims of one flank over the other, divided between the corners (`_rim`).
3. Its inside: cells of the (rho, z) plane, divided as long as they may hold the greatest (`_inside`). Cells with a place
   of a rim in them are divided too, whether their centres are on both flanks or not.

A flank of several patches has the rims of all: a corner of the profile is a rim, and needs no other care.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.check.heightfield import Field, Hits, Ways
from gearmesh.kernel.numeric.algebra import Array, plane_cross

#: the gear's turn is found to this, mm at the contact: 3e-8 mm at a radius of 90 mm are 7e-5 arc seconds
TOUCH_TOLERANCE = 3e-8
FIRST_CELLS = 64
DIVISION = 4
#: cells or pieces of a rim that are divided at once, how often, and how often those on rims are, whatever their centres say
MOST_CELLS = 100
MOST_STAGES, RIM_STAGES = 24, 5
#: a cell with a level place in it or beside it rises by at most this many times what its rise changes to the next cell
LEVEL = 4.0
#: stages at which cells without neighbours may hold a level place
LONELY_STAGES = 8
#: mm: smaller cells hold nothing that counts
SMALLEST_CELL = 1e-7
#: places on a segment of a rim that are tried first, as shares
SHARES = np.array([0.0, 0.5, 1.0])
#: two rims cross where their places agree to this, mm; shares may run over the ends of a segment by this
CROSSED, OVER = 1e-10, 1e-7
CROSSING_STEPS = 12


@dataclass(frozen=True)
class FirstTouch:
    """Where the gear is touched: in the frame of its bearing, the gear not turned.

    `turn` (rad) of the gear along the push; point (3,) on the pinion and both normals (3,); `parts` of pinion and gear that
    touch; `on_rims` whether either member touches with its rim; `cell` (mm) the size of the cells that the search began
    with; `count` places evaluated.
    """

    turn: float
    point: Array
    pinion_normal: Array
    gear_normal: Array
    parts: tuple[int, int]
    on_rims: tuple[bool, bool]
    cell: float
    count: int


@dataclass(frozen=True)
class _Advances:
    """Advances (N,) of the pinion over the gear at places (N, 2), and the hits on either flank; NaN where one is missed."""

    flat: Array
    advance: Array
    pinion: Hits
    gear: Hits
    on_rims: tuple[bool, bool]

    def best(self, cell: float) -> FirstTouch | None:
        if not np.isfinite(self.advance).any():
            return None
        k = int(np.nanargmax(self.advance))
        one, other = self.pinion, self.gear
        parts = int(one.part[k]), int(other.part[k])
        return FirstTouch(
            float(self.advance[k]),
            one.point[k],
            one.normal[k],
            other.normal[k],
            parts,
            self.on_rims,
            cell,
            len(self.advance),
        )


def first_touch(pinion: Field, gear: Field, arcs: Ways) -> FirstTouch | None:
    """The greatest advance of the pinion over the gear, to `TOUCH_TOLERANCE`; None if no circle meets both."""
    low = np.maximum(pinion.box[0], gear.box[0])
    high = np.minimum(pinion.box[1], gear.box[1])
    if (high < low - CROSSED).any():
        return None
    size = np.maximum(high - low, SMALLEST_CELL) / FIRST_CELLS
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
    """Advances at the centres of ever smaller cells; `cells` are the corner and the size of the first.

    Cells are kept that may hold more than the best: the advance at the centre plus twice what it gains over half a cell reaches
    the best one known. On facets, where a cell may have its own facet falling and the next one rising, the gain of the
    steepest candidate counts for all. The neighbours of a kept cell are kept too, so that rims are followed. Where all is
    smooth a greatest advance inside is level: cells as steep as all round them are dropped, their rims have been looked at.
    """
    low, size = cells
    grid = _square(np.arange(FIRST_CELLS))
    known = np.concatenate([seed.advance for seed in seeds]) if seeds else np.zeros(0)
    places = np.concatenate([seed.flat for seed in seeds]) if seeds else np.zeros((0, 2))
    places, known = places[np.isfinite(known)], known[np.isfinite(known)]
    smooth = pinion.smooth and gear.smooth
    for stage in range(MOST_STAGES):
        flat = low + (grid + 0.5) * size
        advances = _both(pinion, gear, flat)
        flat, one, other = advances.flat, advances.pinion, advances.gear
        yield advances
        best = _better(best, advances.best(0.0))
        if best is None:
            return
        advance = advances.advance
        grid = np.floor((flat - low) / size).astype(np.int64)
        with np.errstate(all="ignore"):
            slope = arcs.slope(one.point, one.normal) - arcs.slope(other.point, other.normal)
            gain = np.abs(slope * size).sum(axis=-1) / 2.0
            candidates = advance + 2.0 * gain >= best.turn
            # where nothing is known yet, rims may hide anything beside them
            beside_rims = 2.0 * float(gain[candidates].max(initial=0.0)) if candidates.any() else np.inf
            if smooth:
                candidates &= gain <= LEVEL * _bend(grid, advances, slope * size, stage)
        steepest = float(gain[candidates].max(initial=0.0))
        kept = np.flatnonzero(candidates if smooth else advance + 2.0 * steepest >= best.turn)
        # flat bottoms (line contact) have no end of candidates; the best of them are as good as all
        grid = grid[kept[np.argsort(-advance[kept])[:MOST_CELLS]]]
        if stage < RIM_STAGES:
            some = np.argsort(-known)[:MOST_CELLS]
            some = some[known[some] + beside_rims >= best.turn]
            grid = np.concatenate((grid, np.floor((places[some] - low) / size).astype(np.int64)))
        done = 2.0 * steepest * float(arcs.arm(best.point)) <= TOUCH_TOLERANCE
        if not len(grid) or (done and stage >= RIM_STAGES) or size.max() < SMALLEST_CELL:
            return
        grid, size = _divide(grid), size / DIVISION


def _bend(grid: NDArray[np.int64], advances: _Advances, rise: Array, stage: int) -> Array:
    """How much the rise (N, 2) over cells `grid` (N, 2) differs from that over neighbours on the same parts, (N,), rad.

    Without neighbours unknown (inf), or nothing at the stages at which a strip that still has none is a rim.
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
    """Advances at those of the places (N, 2) that are on both flanks."""
    one = pinion.at(flat)
    on = np.isfinite(one.height)
    flat, one = flat[on], one[on]
    other = gear.at(flat)
    on = np.isfinite(other.height)
    one, other = one[on], other[on]
    return _Advances(flat[on], one.height - other.height, one, other, (False, False))


def _divide(cells: NDArray[np.int64]) -> NDArray[np.int64]:
    """Cells (N, 2) with their eight neighbours, without doubles, each divided into DIVISION x DIVISION."""
    spread = np.unique((cells[:, None] + _square(np.arange(-1, 2))).reshape(-1, 2), axis=0)
    return (spread[:, None] * DIVISION + _square(np.arange(DIVISION))).reshape(-1, 2)


def _square(steps: NDArray[np.int64]) -> NDArray[np.int64]:
    """All pairs (K^2, 2) of steps (K,)."""
    return np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1).reshape(-1, 2)


# --- rims -------------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Places:
    """Places on a rim: segments (N,), shares (N,) and the advances known there (N,)."""

    segment: NDArray[np.int64]
    share: Array
    advance: Array


def _on_rims(pinion: Field, gear: Field, arcs: Ways, box: tuple[Array, Array]) -> Iterator[_Advances]:
    """Advances where rims cross, then on the pinion's rim over the gear and on the gear's over the pinion."""
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
    """Advances on the rim of one flank over its mating gear: between the places where rims cross, in ever shorter pieces."""
    near = np.repeat(_near(own, box), len(SHARES))
    share = np.tile(SHARES, len(near) // len(SHARES))
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
    for _ in range(MOST_STAGES):
        if best is None or not len(segment):
            return
        change = np.nan_to_num(np.abs(ends[:, 1] - ends[:, 0]))
        top = np.fmax(ends[:, 0], ends[:, 1])
        with np.errstate(invalid="ignore"):
            steepest = change[top + 2.0 * change >= best.turn].max(initial=0.0)
            kept = np.flatnonzero(top + 2.0 * steepest >= best.turn)
        if 2.0 * steepest * float(arcs.arm(best.point)) <= TOUCH_TOLERANCE:
            return
        kept = kept[np.argsort(-top[kept])[:MOST_CELLS]]
        steps = np.arange(DIVISION + 1) / DIVISION
        fine = shares[kept, :1] + steps * np.diff(shares[kept], axis=1)
        advances = _over(own, mating, is_pinion, np.repeat(segment[kept], DIVISION - 1), fine[:, 1:-1].ravel())
        yield advances
        best = _better(best, advances.best(0.0))
        values = np.concatenate((ends[kept, :1], advances.advance.reshape(-1, DIVISION - 1), ends[kept, 1:]), axis=1)
        segment = np.repeat(segment[kept], DIVISION)
        shares = np.stack((fine[:, :-1].ravel(), fine[:, 1:].ravel()), axis=-1)
        ends = np.stack((values[:, :-1].ravel(), values[:, 1:].ravel()), axis=-1)


def _over(own: Field, mating: Field, is_pinion: bool, segment: NDArray[np.int64], share: Array) -> _Advances:
    """Advances at places of a rim over the mating gear."""
    place = own.rim(segment, share)
    met = mating.at(place.flat)
    one, other = (place.hits, met) if is_pinion else (met, place.hits)
    return _Advances(place.flat, one.height - other.height, one, other, (is_pinion, not is_pinion))


def _near(field: Field, box: tuple[Array, Array]) -> NDArray[np.int64]:
    """Segments of the rim that may come into a box."""
    low, high = _bounds(field, np.arange(field.rim_segments))
    return np.flatnonzero((high >= box[0]).all(axis=-1) & (low <= box[1]).all(axis=-1))


def _bounds(field: Field, segment: NDArray[np.int64]) -> tuple[Array, Array]:
    """Least and greatest flat coordinates (N, 2) of segments, with as much again as they bulge."""
    start, middle, end = (field.rim(segment, np.full(len(segment), share)).flat for share in SHARES)
    bulge = 2.0 * np.abs(middle - 0.5 * (start + end)) + 1e3 * CROSSED
    low, high = np.minimum(np.minimum(start, end), middle), np.maximum(np.maximum(start, end), middle)
    return low - bulge, high + bulge


def _crossings(pinion: Field, gear: Field, box: tuple[Array, Array]) -> tuple[tuple[_Places, _Places], _Advances]:
    """Where the rims cross: places on either, and the advances there."""
    first, second = _near(pinion, box), _near(gear, box)
    (low, high), (other_low, other_high) = _bounds(pinion, first), _bounds(gear, second)
    meet = np.ones((len(first), len(second)), dtype=bool)
    for k in range(2):
        meet &= (low[:, k, None] <= other_high[None, :, k]) & (other_low[None, :, k] <= high[:, k, None])
    i, j = np.nonzero(meet)
    first, second = first[i], second[j]
    share = np.full((len(first), 2), 0.5)
    for _ in range(CROSSING_STEPS):
        one, other = pinion.rim(first, share[:, 0]), gear.rim(second, share[:, 1])
        apart = other.flat - one.flat
        with np.errstate(all="ignore"):
            turning = plane_cross(one.rate, other.rate)
            step = np.stack((plane_cross(apart, other.rate), plane_cross(apart, one.rate)), axis=-1) / turning[:, None]
        share = np.clip(share + np.nan_to_num(step, posinf=0.0, neginf=0.0), -0.3, 1.3)
    one, other = pinion.rim(first, share[:, 0]), gear.rim(second, share[:, 1])
    met = np.abs(other.flat - one.flat).max(axis=-1) <= CROSSED
    met &= (share >= -OVER).all(axis=-1) & (share <= 1.0 + OVER).all(axis=-1)
    advance = np.where(met, one.hits.height - other.hits.height, np.nan)
    advances = _Advances(one.flat, advance, one.hits, other.hits, (True, True))
    places = [_Places(rim_places[met], share[met, k], advance[met]) for k, rim_places in enumerate((first, second))]
    return (places[0], places[1]), advances
