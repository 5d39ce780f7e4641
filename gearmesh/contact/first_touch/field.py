"""Where two flanks may touch first: the advance of every point of the pinion's flank, and the places worth solving for.

Every point of the pinion's flank meets the gear's at one rotation phi2 of the gear, which the circle about the gear's axis
decides. Its advance, drive (phi2 - phi1 N1/N2), is greatest where the flanks touch first [theory of the ease-off: Kolivand &
Kahraman, Mech. Mach. Theory 44 (2009)]. On a grid over the pinion's flank, and where that grid crosses the edges of the gear's
flank, all maxima are found at once: inside both flanks, along each edge of either. Every sampled place is a point where the flanks
do meet, so the greatest advance sampled is a lower bound of the true one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.first_touch.heights import Circles, FlankHeights, bilinear
from gearmesh.contact.pair import (
    EDGES,
    FORM_POINT,
    NUMBERED,
    OF_CORNERS,
    ROOT,
    WITHIN,
    along_face,
    edge_number,
)
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.surface import Jet

if TYPE_CHECKING:
    from gearmesh.contact.pair import Pair

#: every which column of the flank's grid is sampled
COLUMNS = 2
#: points times positions that are worked on at once: arrays that stay in a processor's cache, in half the time of larger ones
CHUNK = 40_000
#: maxima inside the flanks that are kept at a position
INSIDE = 3
#: rounds in which the circle through an eccentric gear's teeth is found
ROUNDS = 5
#: parts into which a cell that may hold a small overlap is divided, each way, and how often
PARTS, CLOSER = 6, 2
#: finer and finer lattices about a sharp peak, and parts of a row and a column of the first one
FINER, ALONG_FACE = 3, (2, 4)
#: nodes about a place that estimate what may lie between them, at most
AROUND = 2
#: a sampled place this far (mm) outside a flank is still on it
SLACK = 1e-9
#: by how much (rad) a summit along an edge is above its neighbours: the noise of tables
DIP = 1e-9
#: kinds of places: inside both flanks, and on the edges of either
INTERIOR = -1
#: limits of a flank in the order in which `heights` has them, the first that of a fillet if it is one; the flank's corners
LIMITS = (FORM_POINT, *EDGES)
CORNERS = (("tip", "toe"), ("tip", "heel"))


@dataclass(frozen=True)
class Candidates:
    """Places to solve from: `position` (C,); unknowns `x` (C, 5); the edges they lie on (C, 2): INTERIOR or by their
    numbers; `most` (C,), rad: the advance that may be there at most. `best` (N,), rad: the greatest
    advance sampled at a position, -inf where nothing meets; `gain` (N,), rad: what may lie between the samples; `top` (N,):
    number of the candidate with the greatest advance, -1 where there is none."""

    position: NDArray[np.intp]
    x: Array
    edges: NDArray[np.intp]
    most: Array
    best: Array
    gain: Array
    top: NDArray[np.intp]

    @staticmethod
    def nothing() -> Candidates:
        """None, of no positions."""
        none = np.zeros(0)
        whole = np.zeros(0, dtype=np.intp)
        return Candidates(whole, np.zeros((0, 5)), np.zeros((0, 2), dtype=np.intp), none, none, none, whole)


@dataclass(frozen=True)
class Outlook:
    """Of positions (N,): the greatest advance sampled, -inf where nothing meets, what may lie between the samples, rad, and whether
    it is greatest inside both flanks."""

    best: Array
    gain: Array
    inside: NDArray[np.bool_]


def outlook(pair: Pair, phi1: Array) -> Outlook:
    """What advances may be expected of the flanks of a pair at phi1 (N,), rad."""
    best, gain, inside = _nothing_seen(len(phi1))
    for rows, nodes in _batches(pair, phi1):
        field = _Field.of(pair, nodes, advances(pair, phi1, nodes.r, nodes.n, nodes.index), trimmed=True)
        best[rows], gain[rows], inside[rows] = field.best, field.gain, field.inside
    return Outlook(best, gain, inside)


def candidates(
    pair: Pair,
    phi1: Array,
    *,
    trimmed: bool = True,
    only: NDArray[np.intp] | None = None,
    finer: bool = False,
    floor: Array | None = None,
) -> Candidates:
    """Where the flanks of a pair may touch first at phi1 (N,), rad, or at some positions `only` (M,); mounts one or N.

    Unless `trimmed` the gear's flank is taken as far as its table goes. The `finer` grid has all nodes of the other. Positions
    where nothing can be ahead of advances `floor` (N,), rad, have no candidates.
    """
    count = len(phi1) if only is None else len(only)
    best, gain, _ = _nothing_seen(count)
    top, parts = np.full(count, -1), [Candidates.nothing()]
    for rows, nodes in _batches(pair, phi1, only, finer=finer):
        if floor is not None:
            near = np.flatnonzero(_near(_beyond(pair, phi1, nodes), nodes.shape).any(axis=(1, 2)))
            rows, nodes = rows[near], nodes.some(near)
        if not rows.size:
            continue
        seen = advances(pair, phi1, nodes.r, nodes.n, nodes.index)
        if floor is not None:
            rows, nodes, seen = _worth(pair, rows, nodes, seen, floor)
        if not rows.size:
            continue
        part = _candidates(pair, nodes, seen, phi1, trimmed)
        before = sum(len(earlier.position) for earlier in parts)
        best[rows], gain[rows], top[rows] = part.best, part.gain, np.where(part.top < 0, -1, part.top + before)
        parts.append(part)
    position, x, edges, most = (
        np.concatenate([getattr(part, name) for part in parts]) for name in ("position", "x", "edges", "most")
    )
    return Candidates(position, x, edges, most, best, gain, top)


def _worth(
    pair: Pair, rows: NDArray[np.intp], nodes: _Nodes, seen: Advances, floor: Array
) -> tuple[NDArray[np.intp], _Nodes, Advances]:
    """The positions of nodes, their `rows` (N,) and what is `seen` at them, where advances may be above the `floor`, rad."""
    if pair.tip_corners:
        return rows, nodes, seen
    near = _near(seen.beyond, nodes.shape) & np.isfinite(seen.advance).reshape(-1, *nodes.shape)
    field = _Field.of(pair, nodes, seen, True)
    most = field.best + np.where(_wider(near, AROUND + 1), field.bends, 0.0).max(axis=(1, 2))
    for cells in field.corners.values():
        position, i, j, _, value = cells.places
        place = np.stack((i, j), axis=-1)
        most[position] = np.maximum(most[position], value + _local_gain(field.bends, position, place, AROUND))
    most[field.unsampled_cells.position] = np.inf
    kept = np.flatnonzero(most > floor[nodes.index])
    return rows[kept], nodes.some(kept), seen[kept]


def _nothing_seen(count: int) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Best, gain and inside (N,), as of an `Outlook`, of positions where nothing meets."""
    return np.full(count, -np.inf), np.zeros(count), np.zeros(count, dtype=bool)


def _batches(
    pair: Pair, phi1: Array, only: NDArray[np.intp] | None = None, *, finer: bool = False
) -> Iterator[tuple[NDArray[np.intp], _Nodes]]:
    """The points that are sampled, at positions that are worked on at once, and which of those asked for these are: of teeth that
    wind round their axis only those at which they come near each other."""
    grid, every = pair.pinion.grid, np.arange(len(phi1)) if only is None else only
    sampled, wound = grid[:, ::COLUMNS], pair.wound
    if finer or wound:
        sampled = _halve(grid)
    if wound and not finer:
        sampled = sampled[::2]
    jet = pair.pinion.surface.jet(sampled[..., 0].ravel(), sampled[..., 1].ravel())
    whole = _Nodes(every, sampled, np.zeros(len(every), dtype=np.intp), sampled.shape[:2], jet.r, jet.n)
    step = max(1, CHUNK // (sampled[:, ::COLUMNS].size // 2 if wound else len(jet.r)))
    for k in range(0, len(every), step):
        rows = np.arange(k, min(k + step, len(every)))
        nodes = whole.at(every[rows])
        if wound:
            near, nodes = nodes.facing(pair, phi1)
            rows = rows[near]
        if rows.size:
            yield rows, nodes


def _halve(grid: Array) -> Array:
    """A grid (I, J, 2) with half its steps."""
    rows, columns = (np.arange(0.0, count - 0.75, 0.5) for count in grid.shape[:2])
    place = np.stack(np.meshgrid(rows, columns, indexing="ij"), axis=-1)
    return bilinear(grid, place.reshape(-1, 2)).reshape(*place.shape[:2], 2)


@dataclass(frozen=True)
class _Nodes:
    """Points of the pinion's grid of parameters (I, J, 2) that are sampled at positions `index` (N,): a `shape` of I rows and W
    columns of it, of each position from a column `first` (N,) on; own points and normals (I W, 3), of all positions, or
    (N, I W, 3)."""

    index: NDArray[np.intp]
    grid: Array
    first: NDArray[np.intp]
    shape: tuple[int, ...]
    r: Array
    n: Array

    def at(self, index: NDArray[np.intp]) -> _Nodes:
        """The same whole grid at other positions."""
        return replace(self, index=index, first=np.zeros(len(index), dtype=np.intp))

    def some(self, which: NDArray[np.intp]) -> _Nodes:
        """The nodes of some of the positions, by their places in `index`."""
        index, first = self.index[which], self.first[which]
        if self.r.ndim == 2:
            return replace(self, index=index, first=first)
        return replace(self, index=index, first=first, r=self.r[which], n=self.n[which])

    @property
    def ends(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """At which positions (N,) the first column is the grid's, and the last one is."""
        return self.first == 0, self.first + self.shape[1] == self.grid.shape[1]

    def parameters(self, position: NDArray[np.intp], place: Array) -> Array:
        """Parameters (C, 2) of the flank at places (C, 2), by row and column, of positions (C,)."""
        return bilinear(self.grid, place + np.stack((np.zeros(len(position)), self.first[position]), axis=-1))

    def facing(self, pair: Pair, phi1: Array) -> tuple[NDArray[np.bool_], _Nodes]:
        """Positions (N,) at which any circles may meet the gear, and of these as many columns as it takes at any of them to have
        all whose circles do, of each its own."""
        rows, columns = self.shape
        few = np.array([0, rows // 2, rows - 1])
        r = self.r.reshape(rows, columns, 3)[few, ::COLUMNS]
        seen = r.shape[1]
        _, target = _seen_from_gear(pair, phi1, r.reshape(-1, 3), self.index)
        joint, table = pair.gear.mount.joint, pair.gear.heights
        beyond = table.beyond(joint.radius(target), target[..., 2]).reshape(len(LIMITS), -1, len(few), seen)
        # of a column and its neighbours, none is inside a limit: nothing between them is
        nearest = _least_beside(beyond.min(axis=2))
        away = pair.next_winding(phi1[self.index][:, None], r[1])
        near = (nearest <= SLACK).all(axis=0) & ~(away & np.roll(away, 1, axis=1) & np.roll(away, -1, axis=1))
        there = np.asarray(near.any(axis=1))
        near, here = near[there], self.at(self.index[there])
        first, last = COLUMNS * near.argmax(axis=1) - 1, COLUMNS * (seen - 1 - near[:, ::-1].argmax(axis=1)) + 1
        width = int(np.clip((last - first).max(initial=2) + 1, 3, columns))
        first = np.clip(first, 0, columns - width)
        if width == columns or not len(first):
            return there, here
        own = first[:, None, None] + np.arange(width) + (np.arange(rows) * columns)[:, None]
        own = own.reshape(len(first), -1)
        return there, replace(here, first=first, shape=(rows, width), r=self.r[own], n=self.n[own])


def _least_beside(values: Array) -> Array:
    """The least of values (..., J) of every column and its neighbours, of those that are numbers."""
    least = values.copy()
    np.fmin(least[..., 1:], values[..., :-1], out=least[..., 1:])
    np.fmin(least[..., :-1], values[..., 1:], out=least[..., :-1])
    return least


@dataclass(frozen=True)
class Advances:
    """The advance (...,), rad, of points of the pinion, NaN where no circle meets the gear's table; `beyond` (4, ...): how far (mm)
    they lie outside the gear's flank, by `heights.LIMITS`; `rho`, `z` (...,) of their circles in the gear's own frame."""

    advance: Array
    beyond: Array
    rho: Array
    z: Array

    def __getitem__(self, which: NDArray[np.intp]) -> Advances:
        """The points of some positions."""
        return Advances(self.advance[which], self.beyond[:, which], self.rho[which], self.z[which])


def _beyond(pair: Pair, phi1: Array, nodes: _Nodes) -> Array:
    """How far (4, N, K), mm, nodes lie outside the gear's flank, as of `Advances`, if it goes round its own axis; else inside."""
    if pair.gear.mount.eccentricity != (0.0, 0.0):
        return np.zeros((len(LIMITS), len(nodes.index), nodes.shape[0] * nodes.shape[1]))
    _, target = _seen_from_gear(pair, phi1, nodes.r, nodes.index)
    return pair.gear.heights.beyond(pair.gear.mount.joint.radius(target), target[..., 2])


def _near(beyond: Array, shape: tuple[int, ...]) -> NDArray[np.bool_]:
    """Nodes (N, I, J) that do not, with all their neighbours, lie `beyond` (4, N, I J) a limit of the gear: contact is at or beside
    them."""
    near = np.ones((beyond.shape[1], *shape), dtype=bool)
    for limit in beyond:
        near &= _wider((limit <= SLACK).reshape(-1, *shape))
    return near


def _wider(nodes: NDArray[np.bool_], steps: int = 1) -> NDArray[np.bool_]:
    """Nodes (N, I, J) and all that are so many steps beside them."""
    wide = nodes
    for axis in (1, 2) * steps:
        narrow, wide = np.moveaxis(wide, axis, 1), wide.copy()
        along = np.moveaxis(wide, axis, 1)
        along[:, 1:] |= narrow[:, :-1]
        along[:, :-1] |= narrow[:, 1:]
    return wide


def advances(pair: Pair, phi1: Array, r: Array, n: Array, index: NDArray[np.intp]) -> Advances:
    """Advances (N, K) of points r (K, 3) or (N, K, 3) with normals n of the pinion, own frame, at positions `index` (N,)."""
    second = pair.gear.mount.rows(index)
    rotation, target = _seen_from_gear(pair, phi1, r, index)
    normal = _by_component(rotation, n)
    z, joint = target[..., 2], second.joint
    theta = joint.angle(target)
    turn, circles, rho = _turn(pair.gear.heights, second.eccentricity, theta, joint.radius(target), z)
    lag = pair.ratio * phi1[index][:, None]
    phi2 = second.zero + second.sign * turn
    # one turn of the gear is one contact: count phi2 - phi1 N1/N2 from -90 to 270 deg, as the sources do
    ahead = joint.wrap(phi2 - lag)
    pushes = pair.drive * second.sign * joint.along(target, normal) > 0.0
    pushes &= ~pair.next_winding(phi1[index][:, None], r)
    return Advances(np.where(pushes, pair.drive * ahead, np.nan), circles.beyond, rho, z)


def _seen_from_gear(pair: Pair, phi1: Array, r: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
    """Points r (K, 3) or (N, K, 3) of the pinion, own frame, as the gear at rest has them at positions `index` (N,): rotations
    (N, 3, 3) or (3, 3) and points (N, K, 3)."""
    first, second = pair.pinion.mount.rows(index), pair.gear.mount.rows(index)
    own_to_base = second.base.inverse @ first.at(phi1[index])
    target = _by_component(own_to_base.rotation, r)
    target += own_to_base.translation[..., None, :]
    return own_to_base.rotation, target


def _by_component(rotation: Array, vectors: Array) -> Array:
    """Vectors (K, 3) or (N, K, 3), turned (N, K, 3), whose components are next to each other in memory: all that follows is done
    component by component."""
    if vectors.ndim == 2:
        turned = (rotation.reshape(-1, 3) @ vectors.T).reshape(*rotation.shape[:-1], len(vectors))
    else:
        turned = rotation @ np.swapaxes(vectors, -1, -2)
    return np.swapaxes(turned, -1, -2)


def _turn(
    heights: FlankHeights, eccentricity: tuple[float, float], theta: Array, rho: Array, z: Array
) -> tuple[Array, Circles, Array]:
    """How far the gear turns (right-handed) to bring its flank to points (rho, theta, z); what their circles meet; own radii."""
    circles = heights.at(rho, z)
    turn = theta - circles.theta
    if eccentricity == (0.0, 0.0):
        return turn, circles, rho
    # the teeth's axis goes round the one that they turn about
    own_rho = rho
    for _ in range(ROUNDS):
        x, y = rho * np.cos(theta - turn) - eccentricity[0], rho * np.sin(theta - turn) - eccentricity[1]
        own_rho = np.hypot(x, y)
        circles = heights.at(own_rho, z)
        turn = turn + (np.arctan2(y, x) - circles.theta + np.pi) % (2.0 * np.pi) - np.pi
    return turn, circles, own_rho


@dataclass(frozen=True)
class _Field:
    """Advances (N, I, J) at nodes, how far those are `beyond` (4, N, I, J) the gear's limits, the advances of those `on` both
    flanks, -inf elsewhere; best, gain and inside (N,) as of an `Outlook`; `crossings` of the grid with edges of the gear:
    positions, grid places, advances; `stations` (N, I, J), mm, counted from corners of the tips' lines, by their numbers."""

    advance: Array
    beyond: Array
    on: Array
    bends: Array
    best: Array
    gain: Array
    inside: NDArray[np.bool_]
    crossings: dict[int, tuple[NDArray[np.intp], Array, Array, Array]]
    stations: dict[int, Array]

    @staticmethod
    def of(pair: Pair, nodes: _Nodes, seen: Advances, trimmed: bool) -> _Field:
        """The field of what is `seen` at the nodes."""
        shape = (len(nodes.index), *nodes.shape)
        advance = seen.advance.reshape(shape)
        beyond = seen.beyond.reshape(4, *shape)
        on = np.where(np.isfinite(advance) & ((beyond <= SLACK).all(axis=0) | (not trimmed)), advance, -np.inf)
        best = on.max(axis=(1, 2))
        inside = (on[:, 1:-1, 1:-1].max(axis=(1, 2)) >= best) & np.isfinite(best)
        crossings = {}
        low = ROOT if ROOT in pair.gear.edges else FORM_POINT
        for limit, name in enumerate((low, *EDGES)):
            if name in pair.gear.edges:
                others = [beyond[k] for k in range(4) if k != limit]
                there, _, _, value = crossings[edge_number(1, name)] = _best_crossing(advance, beyond[limit], others)
                inside[there] &= best[there] >= value
                best[there] = np.maximum(best[there], value)
        place = np.stack((seen.rho, np.zeros_like(seen.rho), seen.z), axis=-1)
        stations = {}
        for number in np.flatnonzero(WITHIN | OF_CORNERS):
            bound = pair.bounds[number]
            if bound is not None:
                beside = bound.level.value(place if bound.member else nodes.r)
                beside = np.broadcast_to(beside.reshape(-1, *shape[1:]), shape)
                if WITHIN[number]:
                    crossings[int(number)] = _best_crossing(advance, beside, list(beyond))
                else:
                    stations[int(number)] = beside
        bends, gain = _bends_and_gain(advance)
        return _Field(advance, beyond, on, bends, best, gain, inside, crossings, stations)

    @cached_property
    def corners(self) -> dict[tuple[int, int], _LatticeCells]:
        """Cells in which the flanks may overlap at corners of the gear's flank, by the numbers of the edges that end there."""
        numbers = {names: (edge_number(1, names[0]), edge_number(1, names[1])) for names in CORNERS}
        return {
            both: _overlapping(self.advance, self.beyond, names).nearest()
            for names, both in numbers.items()
            if all(number in self.crossings for number in both)
        }

    @cached_property
    def unsampled_cells(self) -> _LatticeCells:
        """Cells of positions where nothing is sampled in which the flanks may overlap all the same."""
        unseen = np.flatnonzero(self.best == -np.inf)
        cells = _overlapping(self.advance[unseen], self.beyond[:, unseen], ())
        return replace(cells, position=unseen[cells.position], advance=self.advance)


def _candidates(pair: Pair, nodes: _Nodes, seen: Advances, phi1: Array, trimmed: bool) -> Candidates:
    field, index = _Field.of(pair, nodes, seen, trimmed), nodes.index
    on, best, gain = field.on, field.best, field.gain
    shape = on.shape
    places: list[tuple[NDArray[np.intp], Array, NDArray[np.intp], Array, Array]] = []

    def add(
        position: NDArray[np.intp],
        i: Array,
        j: Array,
        value: Array,
        most: Array,
        edges: tuple[int, int],
        around: int = AROUND,
    ) -> None:
        every = np.tile(edges, (len(position), 1))
        place = np.stack((i, j), axis=-1)
        places.append((position, place, every, value, most + _local_gain(field.bends, position, place, around)))

    def add_samples(position: NDArray[np.intp], i: Array, j: Array, edge: int, value: Array) -> None:
        add(position, i, j, value, value, (edge, INTERIOR))

    peaks = np.where(_is_peak(on), on - _off_middle(shape[1:]), -np.inf).reshape(len(index), -1)
    rows = np.arange(len(index))
    high = on + _largest_beside(field.bends)
    hidden = np.where(_is_peak(high), high, -np.inf).reshape(len(index), -1)
    hidden[peaks > -np.inf] = -np.inf

    def inside(heights: Array, around: int) -> None:
        for _ in range(INSIDE):
            k = heights.argmax(axis=1)
            there = np.flatnonzero(heights[rows, k] > -np.inf)
            if not there.size:
                break
            i, j = np.divmod(k[there], shape[2])
            value = on[there, i, j]
            add(there, i.astype(float), j.astype(float), value, value, (INTERIOR, INTERIOR), around)
            heights[there, k[there]] = -np.inf

    inside(peaks, AROUND)
    # nodes that are less advanced than their neighbours, but may not be between them
    inside(hidden, 1)
    for number, (member, name) in enumerate(NUMBERED):
        if number in field.crossings:
            there, i, j, value = field.crossings[number]
            add_samples(there, i, j, number, value)
        elif member == 0 and name in pair.pinion.edges:
            toe, heel = nodes.ends
            rim = {
                "tip": on[:, -1, :],
                "toe": np.where(toe[:, None], on[:, :, 0], -np.inf),
                "heel": np.where(heel[:, None], on[:, :, -1], -np.inf),
                FORM_POINT: on[:, 0, :],
                ROOT: on[:, 0, :],
            }[name]
            for there, k in _summits(rim):
                fixed = np.full(there.size, {"tip": shape[1] - 1.0, "heel": shape[2] - 1.0}.get(name, 0.0))
                i, j = (fixed, k.astype(float)) if along_face(number) else (k.astype(float), fixed)
                add_samples(there, i, j, number, rim[there, k])
    sampled_count = sum(len(nodes_of[0]) for nodes_of in places)
    # all of a small overlap of two flanks may lie within one cell: then nothing but the signs at its nodes shows it
    for both, cells in field.corners.items():
        add(*cells.places, both)
    for tip, number in pair.tip_corners:
        if tip in field.crossings:
            cells = _overlapping(field.advance, field.beyond, ("tip",), field.stations[number])
            add(*cells.nearest().places, (tip, number))
        else:
            add(*_on_last_row(field, field.stations[number]), (tip, number))
    # where nothing is sampled, less may overlap than a cell holds
    small = _small_overlaps(pair, nodes, phi1, field).places
    for number in pair.ends:
        add(*small, (number, INTERIOR))
    position, place, edges, value, most = (np.concatenate(column) for column in zip(*places, strict=True))
    # what is interpolated may seem to be ahead too much
    sure = on.max(axis=(1, 2))
    worth = np.flatnonzero(most >= sure[position])
    position, place, edges, value = position[worth], place[worth], edges[worth], value[worth]
    x = _starts(pair, nodes.parameters(position, place), phi1, index[position], value)
    order = np.argsort(value, kind="stable")
    order = order[worth[order] < sampled_count]
    top = np.full(len(index), -1)
    top[position[order]] = order
    return Candidates(index[position], x, edges, most[worth], best, gain, top)


def sharpen(pair: Pair, phi1: Array, position: NDArray[np.intp], x: Array) -> Array:
    """Unknowns (M, 5) where the flanks are most advanced near nodes x (M, 5) at positions (M,): over all of a node's columns on
    either side first, on which an advance may be too sharp to be seen between them, then on finer and finer lattices."""
    grid = pair.pinion.grid
    rows, columns = (1 + parts * (count - 1) for parts, count in zip(ALONG_FACE, grid.shape[:2], strict=True))
    lattice = np.stack(
        np.meshgrid(
            *(np.linspace(0.0, n - 1.0, k) for n, k in zip(grid.shape[:2], (rows, columns), strict=True)), indexing="ij"
        ),
        axis=-1,
    )
    parameters = bilinear(grid, lattice.reshape(-1, 2))
    jet = pair.pinion.surface.jet(parameters[:, 0], parameters[:, 1])
    sharp = np.empty_like(x)
    step = max(1, CHUNK // (rows * (2 * COLUMNS * ALONG_FACE[1] + 1)))
    for k in range(0, len(position), step):
        part = slice(k, k + step)
        sharp[part] = _sharpen(pair, phi1, position[part], x[part], lattice, jet)
    return sharp


def _sharpen(pair: Pair, phi1: Array, position: NDArray[np.intp], x: Array, lattice: Array, jet: Jet) -> Array:
    """As `sharpen`, of few places, by the jet of the pinion's flank on a `lattice` (I, J, 2) of grid places."""
    grid = pair.pinion.grid
    last = np.array(grid.shape[:2]) - 1.0
    flat = grid.reshape(-1, 2)
    node = np.abs((flat - x[:, None, :2]) / np.ptp(flat, axis=0)).sum(axis=2).argmin(axis=1)
    place = np.stack(np.divmod(node, grid.shape[1]), axis=-1).astype(float)
    best = pair.drive * (x[:, 4] - pair.ratio * phi1[position])
    every, (rows, columns) = np.arange(len(position)), lattice.shape[:2]

    def climb(tried: Array, there: Advances) -> None:
        """Go on to the most advanced of places tried (M, K, 2)."""
        nonlocal place, best
        advance = np.where((there.beyond <= SLACK).all(axis=0) & np.isfinite(there.advance), there.advance, -np.inf)
        k = advance.argmax(axis=1)
        higher = advance[every, k] > best
        place = np.where(higher[:, None], tried[every, k], place)
        best = np.where(higher, advance[every, k], best)

    # all rows of the columns beside the node: points of the lattice, which all places share
    reach = COLUMNS * ALONG_FACE[1]
    beside = np.clip(ALONG_FACE[1] * (node % grid.shape[1])[:, None] + np.arange(-reach, reach + 1), 0, columns - 1)
    own = (np.arange(rows)[:, None] * columns + beside[:, None, :]).reshape(len(position), -1)
    climb(lattice.reshape(-1, 2)[own], advances(pair, phi1, jet.r[own], jet.n[own], position))
    reaches = 1.0 / np.array(ALONG_FACE)
    for _ in range(FINER - 1):
        ways = np.stack(np.meshgrid(*(np.linspace(-reach, reach, 9) for reach in reaches), indexing="ij"), axis=-1)
        tried = np.clip(place[:, None] + ways.reshape(-1, 2), 0.0, last)
        parameters = bilinear(grid, tried.reshape(-1, 2)).reshape(tried.shape)
        climb(tried, _advances_at(pair, phi1, position, parameters))
        reaches = reaches / 4.0
    return _starts(pair, bilinear(grid, place), phi1, position, best)


def seen_closely(pair: Pair, phi1: Array, position: NDArray[np.intp], x: Array) -> Array:
    """The advance (M,), rad, that there may be at most about nodes x (M, 5) at positions (M,), by a lattice of steps half as long:
    of teeth that wind round their axis; of others no more is known (inf)."""
    if not pair.wound or not len(position):
        return np.full(len(position), np.inf)
    flat = pair.pinion.grid.reshape(-1, 2)
    low, high = flat.min(axis=0), flat.max(axis=0)
    rows, columns = pair.pinion.grid.shape[:2]
    steps = 0.5 * (high - low) / (rows - 1.0, 2.0 * (columns - 1.0))
    shifts = np.arange(-2.0, 3.0)
    ways = steps * np.stack(np.meshgrid(shifts, shifts, indexing="ij"), axis=-1).reshape(-1, 2)
    there = _advances_at(pair, phi1, position, np.clip(x[:, None, :2] + ways, low, high))
    shape = (len(position), len(shifts), len(shifts))
    advance, beyond = there.advance.reshape(shape), there.beyond.max(axis=0).reshape(shape)
    # beside an edge it may be as far ahead as beyond it
    near = ~np.isnan(advance) & (-_largest_beside(-beyond) <= SLACK)
    most: Array = np.where(near, advance + _bends(advance), -np.inf).max(axis=(1, 2))
    return most


def _advances_at(pair: Pair, phi1: Array, position: NDArray[np.intp], parameters: Array) -> Advances:
    """Advances of the pinion's points at `parameters` (M, K, 2) at positions (M,)."""
    jet = pair.pinion.surface.jet(parameters[..., 0].ravel(), parameters[..., 1].ravel())
    r, n = (vectors.reshape(*parameters.shape[:2], 3) for vectors in (jet.r, jet.n))
    return advances(pair, phi1, r, n, position)


def _is_peak(on: Array) -> NDArray[np.bool_]:
    """Nodes (N, I, J) that no neighbour surpasses."""
    peaks = np.isfinite(on)
    for beside in _neighbours(on):
        peaks &= on >= beside
    return peaks


def _summits(rim: Array) -> Iterator[tuple[NDArray[np.intp], NDArray[np.intp]]]:
    """Positions (M,) and places (M,) of the greatest of values along an edge (N, K), and of another summit where they have one: a
    line along which flanks nearly touch may leave them over one edge twice."""
    rows, first = np.arange(len(rim)), rim.argmax(axis=1)
    there = np.flatnonzero(rim[rows, first] > -np.inf)
    yield there, first[there]
    wide = np.pad(rim, ((0, 0), (1, 1)), constant_values=-np.inf)
    others = np.where((rim > wide[:, :-2] + DIP) & (rim > wide[:, 2:] + DIP), rim, -np.inf)
    others[rows, first] = -np.inf
    second = others.argmax(axis=1)
    there = np.flatnonzero(others[rows, second] > -np.inf)
    if there.size:
        yield there, second[there]


def _largest_beside(values: Array) -> Array:
    """The largest of values (N, I, J) at every node and its neighbours."""
    largest = values.copy()
    for beside in _neighbours(values):
        np.maximum(largest, beside, out=largest)
    return largest


def _neighbours(values: Array) -> Iterator[Array]:
    """Values (N, I, J) at the eight neighbours of every node, -inf beyond the rim."""
    rim = np.pad(values, ((0, 0), (1, 1), (1, 1)), constant_values=-np.inf)
    for i, j in product(range(3), repeat=2):
        if (i, j) != (1, 1):
            yield rim[:, i : i + values.shape[1], j : j + values.shape[2]]


def _bends(advance: Array) -> Array:
    """By how much (N, I, J), rad, the advance may rise about every node: twice what a parabola through it and its neighbours
    does, 0 where that is not known."""
    return _bends_and_gain(advance)[0]


def _bends_and_gain(advance: Array) -> tuple[Array, Array]:
    """By how much, rad, the advance may rise about every node (N, I, J), as of `_bends`, and between neighbouring nodes (N,), half
    its largest second differences."""
    bends, gain = np.zeros(advance.shape), np.zeros(len(advance))
    for axis in (1, 2):
        bend = 0.25 * np.abs(np.diff(advance, 2, axis=axis))
        bend[np.isnan(bend)] = 0.0
        inner = np.s_[:, 1:-1] if axis == 1 else np.s_[:, :, 1:-1]
        bends[inner] += bend
        gain += 2.0 * bend.max(axis=(1, 2), initial=0.0)
    return bends, gain


def _local_gain(bends: Array, position: NDArray[np.intp], place: Array, around: int) -> Array:
    """By how much (C,), rad, the advance may rise within so many nodes around grid places (C, 2)."""
    last = np.array(bends.shape[1:]) - 1
    node, near = np.rint(place).astype(np.intp), np.arange(-around, around + 1)
    i, j = (np.clip(node[:, axis, None] + near, 0, last[axis]) for axis in (0, 1))
    gain: Array = bends[position[:, None, None], i[:, :, None], j[:, None, :]].max(axis=(1, 2))
    return gain


@dataclass(frozen=True)
class _LatticeCells:
    """Cells (C,) of lattices of positions: `position`, row `i` and column `j` of their first node, the mean distance `apart` (mm)
    of the flanks from there; the `advance` (N, I, J), rad, of the lattices."""

    position: NDArray[np.intp]
    i: NDArray[np.intp]
    j: NDArray[np.intp]
    apart: Array
    advance: Array

    def __getitem__(self, which: NDArray[np.intp]) -> _LatticeCells:
        return _LatticeCells(self.position[which], self.i[which], self.j[which], self.apart[which], self.advance)

    def nearest(self) -> _LatticeCells:
        """Of the cells of every position the one least apart, of equals the first."""
        order = np.lexsort((self.apart, self.position))
        return self[order[np.diff(self.position[order], prepend=-1) > 0]]

    @property
    def places(self) -> tuple[NDArray[np.intp], Array, Array, Array, Array]:
        """Positions (C,), the middles of the cells, grid places i, j (C,), and mean and greatest advance (C,) of their nodes."""
        nodes = np.stack([self.advance[self.position, self.i + k, self.j + m] for k in (0, 1) for m in (0, 1)])
        i, j = self.i.astype(float) + 0.5, self.j.astype(float) + 0.5
        return self.position, i, j, np.nanmean(nodes, axis=0), np.nanmax(nodes, axis=0)


def _small_overlaps(pair: Pair, nodes: _Nodes, phi1: Array, field: _Field) -> _LatticeCells:
    """Cells of positions where nothing is sampled in which the flanks may overlap all the same, by a finer lattice in them."""
    cells = field.unsampled_cells
    place, own, steps = (
        np.stack((cells.i, cells.j), axis=-1).astype(float),
        np.arange(len(cells.position)),
        np.linspace(0.0, 1.0, PARTS + 1),
    )
    for _ in range(CLOSER):
        if not own.size:
            break
        ways = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1)
        lattice = place[:, None, None] + ways
        position = cells.position[own]
        parameters = nodes.parameters(np.repeat(position, ways[..., 0].size), lattice.reshape(-1, 2))
        seen = _advances_at(pair, phi1, nodes.index[position], parameters.reshape(len(own), -1, 2))
        shape = lattice.shape[:3]
        closer = _overlapping(seen.advance.reshape(shape), seen.beyond.reshape(4, *shape), ())
        place, own, steps = lattice[closer.position, closer.i, closer.j], own[closer.position], steps / PARTS
    return cells[np.unique(own)].nearest()


def _overlapping(advance: Array, beyond: Array, crossed: Sequence[str], station: Array | None = None) -> _LatticeCells:
    """Cells of lattices (N, I, J) in which, by the signs at their nodes, flanks may overlap while edges `crossed`, and a `station`,
    go through them; `beyond` (4, N, I, J)."""

    def any_of(nodes: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Cells with any of so many nodes."""
        pairs = nodes[:, :-1] | nodes[:, 1:]
        return pairs[:, :, :-1] | pairs[:, :, 1:]

    there = any_of(np.isfinite(advance))
    over = [(limit, name in crossed) for limit, name in zip(beyond, LIMITS, strict=True)]
    for limit, edge in [*over, *([] if station is None else [(station, True)])]:
        there &= any_of(limit <= 0.0)
        if edge:
            there &= any_of(limit > 0.0)
    position, i, j = np.nonzero(there)
    apart = np.zeros(len(position))
    for limit, edge in [*over, *([] if station is None else [(station, True)])]:
        own = np.mean([limit[position, i + k, j + m] for k in (0, 1) for m in (0, 1)], axis=0)
        apart += np.abs(own) if edge else np.maximum(own, 0.0)
    return _LatticeCells(position, i, j, apart, advance)


def _on_last_row(field: _Field, station: Array) -> tuple[NDArray[np.intp], Array, Array, Array, Array]:
    """Where the last row of the grid crosses a station of the pinion from which nodes (N, I, J) are so far: positions (M,), grid
    places i, j (M,), and mean and greatest advance (M,) of the nodes on either side."""
    ends = field.on[:, -1, :-1], field.on[:, -1, 1:]
    beside = station[:, -1, :-1], station[:, -1, 1:]
    highest = np.maximum(*ends)
    position, k = np.nonzero(((beside[0] <= 0.0) != (beside[1] <= 0.0)) & (highest > -np.inf))
    before, after = (values[position, k] for values in beside)
    most = highest[position, k]
    lower = np.minimum(*ends)[position, k]
    value = np.where(np.isfinite(lower), 0.5 * (most + lower), most)
    return position, np.full(len(k), field.on.shape[1] - 1.0), k + before / (before - after), value, most


def _best_crossing(
    advance: Array, beside: Array, others: Sequence[Array]
) -> tuple[NDArray[np.intp], Array, Array, Array]:
    """Where lines of the grid cross an edge, on whose sides nodes lie `beside` (N, I, J) it, and are within `others`, the greatest
    advance of each position: positions (M,), grid places i, j (M,) and advances (M,), interpolated between the nodes on either
    side."""
    _, rows, columns = advance.shape
    inside, flat, from_edge = beside <= 0.0, advance.reshape(-1), beside.reshape(-1)
    crossings = []
    for axis, stride in ((1, columns), (2, 1)):
        # lines cross the edge at few places: all else is done for those alone
        changes = np.zeros(advance.shape, dtype=bool)
        if axis == 1:
            np.not_equal(inside[:, :-1], inside[:, 1:], out=changes[:, :-1])
        else:
            np.not_equal(inside[:, :, :-1], inside[:, :, 1:], out=changes[:, :, :-1])
        low = np.flatnonzero(changes)
        high = low + stride
        with np.errstate(all="ignore"):
            before = from_edge[low]
            share = before / (before - from_edge[high])
            before = flat[low]
            value = before + share * (flat[high] - before)
            valid = np.isfinite(value)
            for other in others:
                beyond = other.reshape(-1)
                before = beyond[low]
                valid &= before + share * (beyond[high] - before) <= SLACK
        low, share, value = low[valid], share[valid], value[valid]
        position, node = np.divmod(low, rows * columns)
        i, j = np.divmod(node, columns)
        crossings.append((position, i + share * (axis == 1), j + share * (axis == 2), value))
    position, i, j, value = (np.concatenate(column) for column in zip(*crossings, strict=True))
    # the greatest of each position, of equals the first
    order = np.lexsort((-value, position))
    own = order[np.diff(position[order], prepend=-1) > 0]
    return position[own], i[own], j[own], value[own]


def _starts(pair: Pair, parameters: Array, phi1: Array, position: NDArray[np.intp], value: Array) -> Array:
    """Unknowns (C, 5) where the pinion's points at `parameters` (C, 2) meet the gear at positions (C,), with advances (C,) where
    they do not."""
    x = np.empty((len(position), 5))
    x[:, :2] = parameters
    jet = pair.pinion.surface.jet(x[:, 0], x[:, 1])
    there = advances(pair, phi1, jet.r[:, None], jet.n[:, None], position)
    x[:, 2:4] = pair.gear.heights.parameters_at(there.rho[:, 0], there.z[:, 0])
    x[:, 4] = (
        pair.drive * np.where(np.isfinite(there.advance[:, 0]), there.advance[:, 0], value)
        + pair.ratio * phi1[position]
    )
    return x


def _off_middle(shape: tuple[int, ...]) -> Array:
    """A bias (I, J), rad, far below what matters: of places that touch alike, as along a line, the middle one."""
    i, j = (np.linspace(-1.0, 1.0, n) ** 2 for n in shape)
    return 1e-7 * (i[:, None] + j)
