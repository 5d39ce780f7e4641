"""Advance of every point of the pinion's flank, and the places from which first touch of two flanks is solved.

Every point of the pinion's flank lies on a circle about the gear's axis. The circle meets the gear's flank in one point, and the
gear meets the pinion's point at one rotation phi2. The advance of the point is drive (phi2 - phi1 N1/N2): the flanks touch first
where the advance is greatest [ease-off theory: Kolivand & Kahraman, Mech. Mach. Theory 44 (2009)].

The advance is sampled on a grid over the pinion's flank, and where lines of this grid cross the edges of the gear's flank. The
samples show all maxima at once: inside both flanks, and along each edge of either flank. The flanks do meet at every sampled
place. The greatest sampled advance is therefore a lower bound of the greatest advance.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.first_touch.heights import Circles, FlankHeights, bilinear
from gearmesh.contact.first_touch.poses import FIELD_ERROR_RAD, PosedField, Poses
from gearmesh.contact.first_touch.windows import (
    FIRST_COLUMN,
    FIRST_ROW,
    INSIDE_LINE,
    LAST_COLUMN,
    LAST_ROW,
    NO_LINE,
    Windows,
)
from gearmesh.contact.pair import (
    FLANK_EDGES,
    FORM_POINT,
    IS_INSIDE_FLANK,
    IS_TIP_CORNER,
    NUMBERED_EDGES,
    ROOT_EDGE,
    along_face,
    edge_number,
)
from gearmesh.kernel.numeric.algebra import Array, distinct
from gearmesh.kernel.surface.surface import Jet
from gearmesh.records import dataclass

if TYPE_CHECKING:
    from gearmesh.contact.pair import Pair

#: step between the sampled columns of the flank's grid
COLUMN_STRIDE = 2
#: points times positions that are computed at once: such arrays stay in a processor's cache, which halves the time
POINTS_PER_CHUNK = 40_000
#: most positions at one rotation whose advances are never polynomials
LEAST_POSED = 30
#: largest number of maxima inside the flanks that are kept at a position
MAX_INNER_MAXIMA = 3
#: rounds of the fixed-point iteration for the circle through an eccentric gear's teeth
ECCENTRIC_ROUNDS = 5
#: parts of a cell that may hold a small overlap, along its row and along its column
CELL_PARTS = 6
#: number of times such a cell is divided
CELL_DIVISIONS = 2
#: number of finer and finer lattices around a sharp peak
FINER_LATTICES = 3
#: parts of a step between rows and of a step between columns in the first of these lattices
LATTICE_PARTS = (2, 4)
#: distance in nodes from a place within which second differences bound the advance between nodes
NEIGHBOUR_NODES = 2
#: distance outside a flank at which a sampled place still counts as on the flank
SLACK_MM = 1e-9
#: least height of a second summit along an edge over its neighbours: the noise of tables
SUMMIT_RISE_RAD = 1e-9
#: largest distance in nodes from a sampled maximum to the vertex of the parabola through it
VERTEX_STEPS = 1
#: number in place of an edge for places inside both flanks
NO_EDGE = -1
#: limits of a flank in the order of `FlankHeights.beyond`; a fillet has its root in the place of the form point
FLANK_LIMITS = (FORM_POINT, *FLANK_EDGES)
#: lines of places on the limits of the gear's flank, and on the edges of the pinion's grid, in the words of `windows`
LIMIT_LINES = {name: FLANK_LIMITS.index(name) for name in FLANK_LIMITS} | {ROOT_EDGE: 0}
RIM_LINES = {"tip": LAST_ROW, "toe": FIRST_COLUMN, "heel": LAST_COLUMN, FORM_POINT: FIRST_ROW, ROOT_EDGE: FIRST_ROW}
#: nodes of the pinion's grid along its edges
RIM_NODES: dict[str, tuple[int | slice, int | slice]] = {
    "tip": np.s_[-1, :],
    "toe": np.s_[:, 0],
    "heel": np.s_[:, -1],
    FORM_POINT: np.s_[0, :],
    ROOT_EDGE: np.s_[0, :],
}
#: corners of a flank, as the limits that meet there
FLANK_CORNERS = (("tip", "toe"), ("tip", "heel"))


@dataclass(frozen=True)
class Candidates:
    """Places (C,) from which first touch is solved at N positions."""

    #: positions (C,) of the places
    position: NDArray[np.intp]
    #: unknowns (C, 5) of the starts: parameters of both surfaces and rotation of the gear, rad
    x: Array
    #: parameters (C, 2) of the pinion at the samples
    sampled: Array
    #: sampled advances (C,), rad
    value: Array
    #: advances (C,) at the starts, rad, -inf for starts inside the pinion's flank but beside the gear's
    ahead: Array
    #: numbers (C, 2) of the edges on which the places lie, NO_EDGE for none
    edges: NDArray[np.intp]
    #: upper bounds (C,) of the advance at the places, rad
    most: Array
    #: greatest sampled advance (N,) of each position, rad, -inf where no circle meets the gear
    best: Array
    #: estimated rise (N,) of the advance between samples, rad
    gain: Array
    #: candidate (N,) with the greatest advance of each position, -1 without candidates
    top: NDArray[np.intp]
    #: changes (C, 2, 2) of the pinion's parameters by one step of rows and one step of columns of the sampled grid
    steps: Array
    #: nodes about the places
    windows: Windows

    def leading(self, worth: NDArray[np.bool_]) -> NDArray[np.bool_]:
        """Return True (C,) for the place that is farthest ahead of each position, of those that are `worth` it (C,)."""
        last = np.full(len(self.best), -1)
        order = np.argsort(self.ahead, kind="stable")
        order = order[worth[order]]
        last[self.position[order]] = order
        leading = np.zeros(len(self.position), dtype=bool)
        leading[last[last >= 0]] = True
        return leading

    @staticmethod
    def nothing() -> Candidates:
        """Return candidates without places and positions."""
        none = np.zeros(0)
        whole = np.zeros(0, dtype=np.intp)
        edges, steps = np.zeros((0, 2), dtype=np.intp), np.zeros((0, 2, 2))
        windows = Windows(np.zeros((0, 25)), np.zeros((0, 4, 25)), np.zeros((0, 2)), whole, whole, none)
        return Candidates(
            whole, np.zeros((0, 5)), np.zeros((0, 2)), none, none, edges, none, none, none, whole, steps, windows
        )

    def samples(self, pair: Pair, phi1: Array, which: NDArray[np.intp]) -> Array:
        """Return the unknowns (M, 5) at the samples of candidates `which` (M,), not at their starts."""
        return _starts(pair, self.sampled[which], phi1, self.position[which], self.value[which])[0]


@dataclass(frozen=True)
class Outlook:
    """Sampled advances of positions (N,)."""

    #: greatest sampled advance (N,), rad, -inf where no circle meets the gear
    best: Array
    #: estimated rise (N,) of the advance between samples, rad
    gain: Array
    #: True (N,) where the greatest advance is inside both flanks
    inside: NDArray[np.bool_]


def outlook(pair: Pair, phi1: Array) -> Outlook:
    """Sample the advances of the flanks of a pair at rotations phi1 (N,), rad."""
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
    """Return the places where the flanks of a pair may touch first at rotations phi1 (N,), rad; mounts one or N.

    - `trimmed`: if False, the gear's flank extends as far as its table
    - `only`: numbers (M,) of the positions that are sampled, all for None
    - `finer`: sample a grid of half the steps, which has all nodes of the coarse grid
    - `floor`: advances (N,), rad; positions where no advance can exceed them have no candidates
    """
    every = np.arange(len(phi1)) if only is None else only
    best, gain, _ = _nothing_seen(len(every))
    top, parts = np.full(len(every), -1), [Candidates.nothing()]
    worth = np.arange(len(every))
    if floor is not None:
        above = [rows[_ahead(pair, phi1, nodes, floor)] for rows, nodes in _batches(pair, phi1, every, finer=finer)]
        worth = np.concatenate([worth[:0], *above])
    for kept, nodes in _batches(pair, phi1, every[worth], finer=finer, posed=True):
        part = _candidates(pair, nodes, phi1, trimmed)
        rows, before = worth[kept], sum(len(earlier.position) for earlier in parts)
        best[rows], gain[rows], top[rows] = part.best, part.gain, np.where(part.top < 0, -1, part.top + before)
        parts.append(part)
    position, x, sampled, value, ahead, edges, most, steps = (
        np.concatenate([getattr(part, name) for part in parts])
        for name in ("position", "x", "sampled", "value", "ahead", "edges", "most", "steps")
    )
    windows = Windows.join([part.windows for part in parts])
    return Candidates(position, x, sampled, value, ahead, edges, most, best, gain, top, steps, windows)


def _ahead(pair: Pair, phi1: Array, nodes: _Nodes, floor: Array) -> NDArray[np.intp]:
    """Return the positions of nodes, by their places (K,) in `index`, where advances may be above the `floor` (N,), rad."""
    if (facing := _facing_window(pair, phi1, nodes)) is None:
        return np.zeros(0, dtype=np.intp)
    nodes = nodes.window(*facing)
    near = _near(_beyond(pair, phi1, nodes), nodes.shape)
    there = np.flatnonzero(near.any(axis=(1, 2)))
    if pair.tip_corners or not there.size:
        return there
    # nothing farther from contact is read: bends are those of a node and its neighbours
    window = _window(near, NEIGHBOUR_NODES + 2)
    nodes, near = nodes.some(there).window(*window), near[there][:, *window]
    seen = advances(pair, phi1, nodes.r, nodes.n, nodes.index)
    if pair.gear.mount.eccentricity != (0.0, 0.0):
        near = _near(seen.beyond, nodes.shape)
    near &= np.isfinite(seen.advance).reshape(near.shape)
    # upper bound of the advance: the greatest sample, the rise between samples, corners of the gear's flank between nodes
    field = _Field.of(pair, nodes, seen, True)
    most = field.best + np.where(_wider(near, NEIGHBOUR_NODES + 1), field.bends, 0.0).max(axis=(1, 2))
    for cells in field.corners.values():
        position, i, j, _, value = cells.places
        place = np.stack((i, j), axis=-1)
        most[position] = np.maximum(most[position], value + _local_gain(field.bends, position, place, NEIGHBOUR_NODES))
    most[field.unsampled_cells.position] = np.inf
    kept: NDArray[np.intp] = there[most > floor[nodes.index]]
    return kept


def _window(near: NDArray[np.bool_], margin: int) -> tuple[slice, slice]:
    """Return rows and columns of lattices (N, I, J) within so many steps of the nodes that are `near` at any position."""
    rows, columns = (np.flatnonzero(near.any(axis=axes)) for axes in ((0, 2), (0, 1)))
    first, second = (slice(max(0, own[0] - margin), own[-1] + margin + 1) for own in (rows, columns))
    return first, second


def _nothing_seen(count: int) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Return best, gain and inside (N,), as in an `Outlook`, of positions where no circle meets the gear."""
    return np.full(count, -np.inf), np.zeros(count), np.zeros(count, dtype=bool)


def _batches(
    pair: Pair, phi1: Array, only: NDArray[np.intp] | None = None, *, finer: bool = False, posed: bool = False
) -> Iterator[tuple[NDArray[np.intp], _Nodes]]:
    """Yield batches of positions: their rows among the wanted positions, and the nodes that are sampled.

    Positions of many assemblies at one rotation share a batch: their nodes near the gear are nearly the same. If `posed`, their
    fields may be polynomials in the poses of the members. Teeth that wind round their axis have batches only of positions where
    they come near the gear.
    """
    grid, every = pair.pinion.grid, np.arange(len(phi1)) if only is None else only
    sampled, wound = grid[:, ::COLUMN_STRIDE], pair.wound
    if finer or wound:
        sampled = _halve(grid)
    if wound and not finer:
        sampled = sampled[::2]
    jet = pair.pinion.surface.jet(sampled[..., 0].ravel(), sampled[..., 1].ravel())
    whole = _Nodes(every, sampled, np.zeros(len(every), dtype=np.intp), sampled.shape[:2], jet.r, jet.n)
    step = max(1, POINTS_PER_CHUNK // (sampled[:, ::COLUMN_STRIDE].size // 2 if wound else len(jet.r)))
    lines = np.flatnonzero(IS_INSIDE_FLANK | IS_TIP_CORNER)
    posed &= pair.unbroken and not wound and all(pair.bounds[k] is None for k in lines)
    posed &= pair.gear.mount.eccentricity == (0.0, 0.0)
    poses: Poses | None = None
    for group in _by_rotation(phi1[every], step):
        field = None
        if posed and len(group) > LEAST_POSED and (phi1[every[group]] == phi1[every[group[0]]]).all():
            poses, field = _posed(pair, phi1, whole.at(every[group]), poses)
        for part in np.array_split(np.arange(len(group)), max(1, round(len(group) / step))):
            rows = group[part]
            nodes = replace(whole.at(every[rows]), posed=None if field is None else (field, part))
            if wound:
                near, nodes = nodes.facing(pair, phi1)
                rows = rows[near]
            if rows.size:
                yield rows, nodes


def _posed(pair: Pair, phi1: Array, nodes: _Nodes, known: Poses | None) -> tuple[Poses | None, PosedField | None]:
    """Return polynomials in the poses of the members at nodes of many assemblies at one rotation; None if there are too few.

    The `known` poses of another rotation serve again if they are the same.
    """
    first, second = pair.pinion.mount.rows(nodes.index).base, pair.gear.mount.rows(nodes.index).base
    own_to_gear = second.inverse @ first
    if own_to_gear.rotation.ndim == 2:
        return None, None
    if known is None or not known.same(own_to_gear):
        known = Poses.of(own_to_gear, *nodes.middle)
    if known is None:
        return None, None
    few = nodes.some(np.concatenate((known.sampled, known.checked)))
    seen = advances(pair, phi1, few.r, few.n, few.index)
    return known, known.fit(seen.advance, seen.beyond)


def _by_rotation(phi1: Array, most: int) -> list[NDArray[np.intp]]:
    """Return the positions of each rotation in phi1 (N,) where most rotations have half of `most` positions or more, else all."""
    order = np.argsort(phi1, kind="stable")
    repeated = np.diff(phi1[order]) == 0.0
    if not repeated.any():
        return [np.arange(len(phi1))]
    ends = np.flatnonzero(~repeated) + 1
    return np.split(order, ends) if 2 * len(phi1) >= most * (len(ends) + 1) else [order]


def _halve(grid: Array) -> Array:
    """Return a grid (2 I - 1, 2 J - 1, 2) of half the steps of a grid (I, J, 2)."""
    rows, columns = (np.arange(0.0, count - 0.75, 0.5) for count in grid.shape[:2])
    place = np.stack(np.meshgrid(rows, columns, indexing="ij"), axis=-1)
    return bilinear(grid, place.reshape(-1, 2)).reshape(*place.shape[:2], 2)


@dataclass(frozen=True)
class _Nodes:
    """Points of the pinion's grid that are sampled at N positions: all rows, and W columns from a first column on."""

    #: positions (N,)
    index: NDArray[np.intp]
    #: parameters (I, J, 2) of the whole grid
    grid: Array
    #: first sampled column (N,) of each position
    first: NDArray[np.intp]
    #: number I of rows and W of sampled columns
    shape: tuple[int, ...]
    #: points (I W, 3), the same for all positions, or (N, I W, 3), pinion's frame, mm
    r: Array
    #: normals of these points
    n: Array
    #: field of many assemblies, and the N of them, None if advances are sampled
    posed: tuple[PosedField, NDArray[np.intp]] | None = None

    @property
    def middle(self) -> tuple[Array, float]:
        """Middle (3,) of points that are the same for all positions, and their largest distance from it, mm."""
        middle = self.r.mean(axis=0)
        return middle, float(np.sqrt(np.square(self.r - middle).sum(axis=1).max()))

    def seen(self, pair: Pair, phi1: Array) -> Advances:
        """Return the advances (N, I W) of the nodes; radii and heights of circles are zero if the field is known."""
        if self.posed is None:
            return advances(pair, phi1, self.r, self.n, self.index)
        (field, which), none = self.posed, np.zeros(())
        advance, beyond = field.at(which)
        if field.exact.size:
            own = advances(pair, phi1, self.r[field.exact], self.n[field.exact], self.index)
            advance[:, field.exact], beyond[..., field.exact] = own.advance, own.beyond
        return Advances(advance, beyond, none, none)

    @property
    def error(self) -> float:
        """Largest error of the advances, rad, beside that of the gear's table."""
        return 0.0 if self.posed is None else FIELD_ERROR_RAD

    def at(self, index: NDArray[np.intp]) -> _Nodes:
        """Return the whole grid at other positions."""
        return replace(self, index=index, first=np.zeros(len(index), dtype=np.intp))

    def window(self, rows: slice, columns: slice) -> _Nodes:
        """Return the nodes of some rows and columns."""
        r, n = (
            vectors.reshape(*vectors.shape[:-2], *self.shape, 3)[..., rows, columns, :] for vectors in (self.r, self.n)
        )
        shape = r.shape[-3:-1]
        r, n = (vectors.reshape(*vectors.shape[:-3], -1, 3) for vectors in (r, n))
        return replace(self, grid=self.grid[rows], first=self.first + columns.start, shape=shape, r=r, n=n)

    def some(self, which: NDArray[np.intp]) -> _Nodes:
        """Return the nodes of some positions, by their places in `index`."""
        index, first = self.index[which], self.first[which]
        if self.r.ndim == 2:
            return replace(self, index=index, first=first)
        return replace(self, index=index, first=first, r=self.r[which], n=self.n[which])

    @property
    def ends(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Return True (N,) where the first sampled column is the grid's first, and True where the last is the grid's last."""
        return self.first == 0, self.first + self.shape[1] == self.grid.shape[1]

    def parameters(self, position: NDArray[np.intp], place: Array) -> Array:
        """Return the flank's parameters (C, 2) at places (C, 2), row and column, of positions (C,)."""
        return bilinear(self.grid, place + np.stack((np.zeros(len(position)), self.first[position]), axis=-1))

    def steps(self, position: NDArray[np.intp], place: Array) -> Array:
        """Return changes (C, 2, 2) of the parameters by one step of rows and one of columns, at places (C, 2)."""
        last = np.array(self.grid.shape[:2]) - 2
        cell = place.astype(np.intp)
        cell[:, 1] += self.first[position]
        i, j = np.clip(cell, 0, last).T
        corner = self.grid[i, j]
        return np.stack((self.grid[i + 1, j] - corner, self.grid[i, j + 1] - corner), axis=-1)

    def facing(self, pair: Pair, phi1: Array) -> tuple[NDArray[np.bool_], _Nodes]:
        """Return True (N,) for positions at which circles may meet the gear, and the nodes of these positions.

        The nodes of a position are the block of columns that contains every such circle, of the same width at all positions.
        """
        # circles through three rows of every second column, as the gear at rest has them
        rows, columns = self.shape
        few = np.array([0, rows // 2, rows - 1])
        r = self.r.reshape(rows, columns, 3)[few, ::COLUMN_STRIDE]
        seen = r.shape[1]
        _, target = _seen_from_gear(pair, phi1, r.reshape(-1, 3), self.index)
        joint, table = pair.gear.mount.joint, pair.gear.heights
        beyond = table.beyond(joint.radius(target), target[..., 2]).reshape(len(FLANK_LIMITS), -1, len(few), seen)
        # if a column and its neighbours are outside a limit, so is everything between them
        nearest = _least_beside(beyond.min(axis=2))
        away = pair.next_winding(phi1[self.index][:, None], r[1])
        near = (nearest <= SLACK_MM).all(axis=0) & ~(away & np.roll(away, 1, axis=1) & np.roll(away, -1, axis=1))
        may_meet = np.asarray(near.any(axis=1))
        # from the column before the first near column to the column after the last one
        near, at_positions = near[may_meet], self.at(self.index[may_meet])
        first, last = (
            COLUMN_STRIDE * near.argmax(axis=1) - 1,
            COLUMN_STRIDE * (seen - 1 - near[:, ::-1].argmax(axis=1)) + 1,
        )
        width = int(np.clip((last - first).max(initial=2) + 1, 3, columns))
        first = np.clip(first, 0, columns - width)
        if width == columns or not len(first):
            return may_meet, at_positions
        block = first[:, None, None] + np.arange(width) + (np.arange(rows) * columns)[:, None]
        block = block.reshape(len(first), -1)
        return may_meet, replace(at_positions, first=first, shape=(rows, width), r=self.r[block], n=self.n[block])


def _least_beside(values: Array) -> Array:
    """Return the least value (..., J) of every column and its neighbours, NaN apart."""
    least = values.copy()
    np.fmin(least[..., 1:], values[..., :-1], out=least[..., 1:])
    np.fmin(least[..., :-1], values[..., 1:], out=least[..., :-1])
    return least


@dataclass(frozen=True)
class Advances:
    """Advances of points (...,) of the pinion."""

    #: advance (...,), rad, NaN where the circle does not meet the gear's table or the pinion does not drive
    advance: Array
    #: distances (4, ...), mm, outside the limits FLANK_LIMITS of the gear's flank, negative inside
    beyond: Array
    #: radii (...,) of the circles in the gear's frame, mm
    rho: Array
    #: heights (...,) of the circles in the gear's frame, mm
    z: Array


def _beyond(pair: Pair, phi1: Array, nodes: _Nodes) -> Array:
    """Return distances (4, N, K), mm, of nodes outside the limits of the gear's flank, 0 for an eccentric gear.

    The circles through an eccentric gear's teeth are known only after `advances`: 0 keeps all its nodes.
    """
    if pair.gear.mount.eccentricity != (0.0, 0.0):
        return np.zeros((len(FLANK_LIMITS), len(nodes.index), nodes.shape[0] * nodes.shape[1]))
    _, target = _seen_from_gear(pair, phi1, nodes.r, nodes.index)
    return pair.gear.heights.beyond(pair.gear.mount.joint.radius(target), target[..., 2])


def _facing_window(pair: Pair, phi1: Array, nodes: _Nodes) -> tuple[slice, slice] | None:
    """Return rows and columns of the nodes from which all advances near contact are read, None if no node comes near the gear.

    The limits at one position hold for the others but for the distance by which nodes move between these positions.
    """
    if nodes.r.ndim == 3 or pair.gear.mount.eccentricity != (0.0, 0.0):
        return slice(0, nodes.shape[0]), slice(0, nodes.shape[1])
    one = replace(nodes, index=nodes.index[:1], first=nodes.first[:1])
    middle, reach = nodes.middle
    rotation, target = _seen_from_gear(pair, phi1, middle[None], nodes.index)
    moved = np.sqrt(np.square(target[:, 0] - target[0, 0]).sum(axis=-1))
    moved += reach * np.sqrt(np.square(rotation - rotation[:1]).sum(axis=(1, 2))) if rotation.ndim == 3 else 0.0
    far = pair.gear.heights.steepness * moved.max()
    near = _near(_beyond(pair, phi1, one) - far[:, None, None], nodes.shape)
    return _window(near, NEIGHBOUR_NODES + 2) if near.any() else None


def _near(beyond: Array, shape: tuple[int, ...]) -> NDArray[np.bool_]:
    """Return True (N, I, J) for nodes that are inside each limit of the gear, or have a neighbour that is.

    Contact is possible only at or beside such nodes. `beyond` (4, N, I J): distances outside the limits, mm.
    """
    inside = _wider((beyond <= SLACK_MM).reshape(-1, *shape))
    near: NDArray[np.bool_] = np.logical_and.reduce(inside.reshape(len(beyond), -1, *shape))
    return near


def _wider(nodes: NDArray[np.bool_], steps: int = 1) -> NDArray[np.bool_]:
    """Return True (N, I, J) for marked nodes and for nodes within a number of steps from them."""
    wide = nodes
    for _ in range(steps):
        narrow, wide = wide, wide.copy()
        wide[:, 1:] |= narrow[:, :-1]
        wide[:, :-1] |= narrow[:, 1:]
        narrow, wide = wide, wide.copy()
        wide[:, :, 1:] |= narrow[:, :, :-1]
        wide[:, :, :-1] |= narrow[:, :, 1:]
    return wide


def advances(pair: Pair, phi1: Array, r: Array, n: Array, index: NDArray[np.intp]) -> Advances:
    """Return advances (N, K) of the pinion's points r (K, 3) or (N, K, 3) with normals n, at positions `index` (N,)."""
    # angle between the pinion's point and the gear's flank on the same circle, which the gear turns through
    second = pair.gear.mount.rows(index)
    rotation, target = _seen_from_gear(pair, phi1, r, index)
    normal = _by_component(rotation, n)
    z, joint = target[..., 2], second.joint
    theta = joint.angle(target)
    turn, circles, rho = _turn(pair.gear.heights, second.eccentricity, theta, joint.radius(target), z)
    lag = pair.ratio * phi1[index][:, None]
    phi2 = second.zero + second.sign * turn
    # the angle is known but for full turns: count phi2 - phi1 N1/N2 from -90 to 270 deg, as the sources do
    ahead = joint.wrap(phi2 - lag)
    # the pinion drives only where its normal points along the gear's motion
    pushes = pair.drive * second.sign * joint.along(target, normal) > 0.0
    pushes &= ~pair.next_winding(phi1[index][:, None], r)
    return Advances(np.where(pushes, pair.drive * ahead, np.nan), circles.beyond, rho, z)


def _seen_from_gear(pair: Pair, phi1: Array, r: Array, index: NDArray[np.intp]) -> tuple[Array, Array]:
    """Return the pinion's points r (K, 3) or (N, K, 3) in the frame of the gear at rest, at positions `index` (N,).

    The result is the rotations (N, 3, 3) or (3, 3) and the points (N, K, 3), mm.
    """
    first, second = pair.pinion.mount.rows(index), pair.gear.mount.rows(index)
    own_to_base = second.base.inverse @ first.at(phi1[index])
    target = _by_component(own_to_base.rotation, r)
    target += own_to_base.translation[..., None, :]
    return own_to_base.rotation, target


def _by_component(rotation: Array, vectors: Array) -> Array:
    """Return rotated vectors (N, K, 3) of vectors (K, 3) or (N, K, 3).

    Each component is contiguous in memory: later steps work component by component.
    """
    if vectors.ndim == 2:
        turned = (rotation.reshape(-1, 3) @ vectors.T).reshape(*rotation.shape[:-1], len(vectors))
    else:
        turned = rotation @ np.swapaxes(vectors, -1, -2)
    return np.swapaxes(turned, -1, -2)


def _turn(
    heights: FlankHeights, eccentricity: tuple[float, float], theta: Array, rho: Array, z: Array
) -> tuple[Array, Circles, Array]:
    """Return the right-handed angle that brings the gear's flank to points (rho, theta, z), rad.

    The result also holds the meeting of the circles with the flank, and the radii of the circles in the gear's frame.
    """
    circles = heights.at(rho, z)
    turn = theta - circles.theta
    if eccentricity == (0.0, 0.0):
        return turn, circles, rho
    # the axis of an eccentric gear's teeth moves round the bearing axis: the radius in the gear's frame depends on the angle
    own_rho = rho
    for _ in range(ECCENTRIC_ROUNDS):
        x, y = rho * np.cos(theta - turn) - eccentricity[0], rho * np.sin(theta - turn) - eccentricity[1]
        own_rho = np.hypot(x, y)
        circles = heights.at(own_rho, z)
        turn = turn + (np.arctan2(y, x) - circles.theta + np.pi) % (2.0 * np.pi) - np.pi
    return turn, circles, own_rho


@dataclass(frozen=True)
class _Field:
    """Advances at the nodes (I, J) of N positions, and at crossings of the grid with the gear's edges."""

    #: advances (N, I, J), rad, NaN as in `Advances`
    advance: Array
    #: distances (4, N, I, J), mm, outside the limits of the gear's flank
    beyond: Array
    #: advances (N, I, J) of nodes on both flanks, rad, -inf elsewhere
    on: Array
    #: estimated rise (N, I, J) of the advance around each node, rad
    bends: Array
    #: greatest advance (N,), rad, of nodes and crossings
    best: Array
    #: estimated rise (N,) of the advance between samples, rad
    gain: Array
    #: True (N,) where the greatest advance is inside both flanks
    inside: NDArray[np.bool_]
    #: for each edge of the gear and each crease: positions (M,), rows (M,), columns (M,) and advances (M,) of the best crossings
    crossings: dict[int, tuple[NDArray[np.intp], Array, Array, Array]]
    #: for each corner of a tip line: distances (N, I, J), mm, from the corner's station
    stations: dict[int, Array]
    #: True (I, J) for nodes about which the greatest advance of any position may be
    level: NDArray[np.bool_]

    @staticmethod
    def of(pair: Pair, nodes: _Nodes, seen: Advances, trimmed: bool) -> _Field:
        """Return the field of sampled advances, with or without the gear's limits."""
        shape = (len(nodes.index), *nodes.shape)
        advance = seen.advance.reshape(shape)
        beyond = seen.beyond.reshape(4, *shape)
        on = np.where(np.isfinite(advance) & ((beyond <= SLACK_MM).all(axis=0) | (not trimmed)), advance, -np.inf)
        best = on.max(axis=(1, 2))
        bends, gain = _bends_and_gain(advance)
        level = _level(advance, best, bends, beyond if trimmed else None)
        inside = (on[:, 1:-1, 1:-1].max(axis=(1, 2)) >= best) & np.isfinite(best)
        # the gear's edges lie between nodes: interpolate where lines of the grid cross them
        crossings = {}
        low = ROOT_EDGE if ROOT_EDGE in pair.gear.edges else FORM_POINT
        for limit, name in enumerate((low, *FLANK_EDGES)):
            if name in pair.gear.edges:
                others = [beyond[k] for k in range(4) if k != limit]
                crossed, _, _, value = crossings[edge_number(1, name)] = _best_crossing(
                    advance, beyond[limit], others, level
                )
                inside[crossed] &= best[crossed] >= value
                best[crossed] = np.maximum(best[crossed], value)
        # creases inside flanks are crossed the same way; corners of tip lines keep the distances from their stations
        stations = {}
        for number in np.flatnonzero(IS_INSIDE_FLANK | IS_TIP_CORNER):
            bound = pair.bounds[number]
            if bound is not None:
                circle_points = np.stack((seen.rho, np.zeros_like(seen.rho), seen.z), axis=-1)
                beside = bound.level.value(circle_points if bound.member else nodes.r)
                beside = np.broadcast_to(beside.reshape(-1, *shape[1:]), shape)
                if IS_INSIDE_FLANK[number]:
                    crossings[int(number)] = _best_crossing(advance, beside, list(beyond), level)
                else:
                    stations[int(number)] = beside
        return _Field(advance, beyond, on, bends, best, gain, inside, crossings, stations, level)

    @cached_property
    def corners(self) -> dict[tuple[int, int], _LatticeCells]:
        """Cells in which the flanks may overlap at a corner of the gear's flank, by the numbers of the two edges."""
        numbers = {names: (edge_number(1, names[0]), edge_number(1, names[1])) for names in FLANK_CORNERS}
        sought = {names: edges for names, edges in numbers.items() if all(number in self.crossings for number in edges)}
        # both limits change their sign over a cell next to which the advance may be greatest
        around = _wider(self.level[None])[0]
        crossed = {
            name: ((limit <= 0.0).any(axis=0) & around).any() and ((limit > 0.0).any(axis=0) & around).any()
            for name, limit in zip(FLANK_LIMITS, self.beyond, strict=True)
        }
        sought = {names: edges for names, edges in sought.items() if all(crossed[name] for name in names)}
        signs = _cell_signs(self.advance, self.beyond) if sought else None
        return {
            edges: _overlapping(self.advance, self.beyond, names, signs=signs).nearest()
            for names, edges in sought.items()
        }

    @cached_property
    def unsampled_cells(self) -> _LatticeCells:
        """Cells in which the flanks may overlap, of positions without a sample on both flanks."""
        unseen = np.flatnonzero(self.best == -np.inf)
        cells = _overlapping(self.advance[unseen], self.beyond[:, unseen], ())
        return replace(cells, position=unseen[cells.position], advance=self.advance)


def _candidates(pair: Pair, nodes: _Nodes, phi1: Array, trimmed: bool) -> Candidates:
    """Return the maxima of sampled advances: inside both flanks, along edges, and in cells with an overlap between nodes."""
    index = nodes.index
    field = _Field.of(pair, nodes, nodes.seen(pair, phi1), trimmed)
    on, best, gain = field.on, field.best, field.gain
    shape = on.shape
    places: list[
        tuple[NDArray[np.intp], Array, NDArray[np.intp], Array, Array, NDArray[np.intp], NDArray[np.intp]]
    ] = []

    def add(
        position: NDArray[np.intp],
        i: Array,
        j: Array,
        value: Array,
        most: Array,
        edges: tuple[int, int],
        around: int = NEIGHBOUR_NODES,
        rise: Array | None = None,
        line: int = NO_LINE,
    ) -> None:
        edge_pairs = np.tile(edges, (len(position), 1))
        place = np.stack((i, j), axis=-1)
        if rise is None:
            rise = _local_gain(field.bends, position, place, around)
        bounded = np.full(len(position), around), np.full(len(position), line)
        places.append((position, place, edge_pairs, value, most + rise + 2.0 * nodes.error, *bounded))

    # maxima inside both flanks; of nodes that touch alike, as along a line of contact, the middle one
    inner, rows = np.flatnonzero(field.level), np.arange(len(index))
    own = on.reshape(len(index), -1)[:, inner]
    peaks = np.where(_is_peak(on, inner), own - _off_middle(shape[1:]).ravel()[inner], -np.inf)
    # nodes that are less advanced than a neighbour, but beside which the advance may rise higher than beside the neighbour
    high = on + _largest_beside(field.bends)
    hidden = np.where(_is_peak(high, inner), high.reshape(len(index), -1)[:, inner], -np.inf)
    hidden[peaks > -np.inf] = -np.inf

    def inside(heights: Array, around: int) -> None:
        for _ in range(MAX_INNER_MAXIMA if inner.size else 0):
            k = heights.argmax(axis=1)
            found = np.flatnonzero(heights[rows, k] > -np.inf)
            if not found.size:
                break
            heights[found, k[found]] = -np.inf
            i, j = np.divmod(inner[k[found]], shape[2])
            if around == 1 and not pair.wound:
                rising = _may_rise(field.advance, found, i, j)
                found, i, j = found[rising], i[rising], j[rising]
            value = on[found, i, j]
            add(found, i.astype(float), j.astype(float), value, value, (NO_EDGE, NO_EDGE), around, line=INSIDE_LINE)

    inside(peaks, NEIGHBOUR_NODES)
    inside(hidden, 1)
    summits = [place if pair.wound else _vertices(field.advance, position, place) for position, place, *_ in places]
    # maxima along edges: edges of the gear between nodes, edges of the pinion along the rim of the grid
    for number, (member, name) in enumerate(NUMBERED_EDGES):
        if number in field.crossings:
            found, i, j, value = field.crossings[number]
            add(found, i, j, value, value, (number, NO_EDGE), line=LIMIT_LINES.get(name, NO_LINE))
        elif member == 0 and name in pair.pinion.edges and field.level[RIM_NODES[name]].any():
            toe, heel = nodes.ends
            rim = {
                "tip": on[:, -1, :],
                "toe": np.where(toe[:, None], on[:, :, 0], -np.inf),
                "heel": np.where(heel[:, None], on[:, :, -1], -np.inf),
                FORM_POINT: on[:, 0, :],
                ROOT_EDGE: on[:, 0, :],
            }[name]
            # the advance between the nodes of a rim depends on its bends along the rim alone
            side = -1 if name in ("tip", "heel") else 0
            bends = _bends_along(field.advance[:, side] if along_face(number) else field.advance[..., side])
            for found, k in _summits(rim):
                fixed = np.full(found.size, {"tip": shape[1] - 1.0, "heel": shape[2] - 1.0}.get(name, 0.0))
                i, j = (fixed, k.astype(float)) if along_face(number) else (k.astype(float), fixed)
                near = np.clip(k[:, None] + np.arange(-NEIGHBOUR_NODES, NEIGHBOUR_NODES + 1), 0, rim.shape[1] - 1)
                rise = bends[found[:, None], near].max(axis=1)
                add(found, i, j, rim[found, k], rim[found, k], (number, NO_EDGE), rise=rise, line=RIM_LINES[name])
    sampled_count = sum(len(nodes_of[0]) for nodes_of in places)
    # a small overlap of two flanks may lie within one cell: only the signs at the nodes of the cell show it
    for edge_pair, cells in field.corners.items():
        add(*cells.places, edge_pair)
    for tip, number in pair.tip_corners:
        if tip in field.crossings:
            cells = _overlapping(field.advance, field.beyond, ("tip",), field.stations[number])
            add(*cells.nearest().places, (tip, number))
        else:
            add(*_on_last_row(field, field.stations[number]), (tip, number))
    # positions without a sample: the overlap may be smaller than a cell
    small = _small_overlaps(pair, nodes, phi1, field).places
    for number in pair.ends:
        add(*small, (number, NO_EDGE))
    starts = [*summits, *(nodes_of[1] for nodes_of in places[len(summits) :])]
    position, place, edges, value, most, around_each, lines = (
        np.concatenate(column) for column in zip(*places, strict=True)
    )
    start = np.concatenate(starts)
    # drop places that cannot be ahead of the greatest sample; interpolated advances are too uncertain to drop others
    sure = on.max(axis=(1, 2))
    worth = np.flatnonzero(most >= sure[position])
    position, place, start, edges, value = position[worth], place[worth], start[worth], edges[worth], value[worth]
    lines = lines[worth] if pair.unbroken and not pair.wound else np.full(len(worth), NO_LINE)
    windows = Windows.of(field.advance, field.beyond, position, place, around_each[worth], lines, nodes.error)
    x, on_gear = _starts(pair, nodes.parameters(position, start), phi1, index[position], value)
    ahead = pair.drive * (x[:, 4] - pair.ratio * phi1[index[position]])
    ahead[(edges[:, 0] == NO_EDGE) & ~on_gear] = -np.inf
    # the last candidate written of a position is the most advanced one; guesses inside cells do not count
    order = np.argsort(value, kind="stable")
    order = order[worth[order] < sampled_count]
    top = np.full(len(index), -1)
    top[position[order]] = order
    sampled, steps = nodes.parameters(position, place), nodes.steps(position, place)
    return Candidates(index[position], x, sampled, value, ahead, edges, most[worth], best, gain, top, steps, windows)


def sharpen(pair: Pair, phi1: Array, position: NDArray[np.intp], x: Array) -> Array:
    """Return unknowns (M, 5) of the greatest advance near nodes x (M, 5) at positions (M,).

    A peak may be too sharp to show between two columns. The search takes all rows of the columns on either side of the node
    first, then finer and finer lattices around the best place.
    """
    # all positions share the points of the first lattice
    grid = pair.pinion.grid
    rows, columns = (1 + parts * (count - 1) for parts, count in zip(LATTICE_PARTS, grid.shape[:2], strict=True))
    lattice = np.stack(
        np.meshgrid(
            *(np.linspace(0.0, n - 1.0, k) for n, k in zip(grid.shape[:2], (rows, columns), strict=True)), indexing="ij"
        ),
        axis=-1,
    )
    parameters = bilinear(grid, lattice.reshape(-1, 2))
    jet = pair.pinion.surface.jet(parameters[:, 0], parameters[:, 1])
    sharp = np.empty_like(x)
    step = max(1, POINTS_PER_CHUNK // (rows * (2 * COLUMN_STRIDE * LATTICE_PARTS[1] + 1)))
    for k in range(0, len(position), step):
        part = slice(k, k + step)
        sharp[part] = _sharpen(pair, phi1, position[part], x[part], lattice, jet)
    return sharp


def _sharpen(pair: Pair, phi1: Array, position: NDArray[np.intp], x: Array, lattice: Array, jet: Jet) -> Array:
    """Return the unknowns of `sharpen` for one batch, by the jet of the pinion's flank on a `lattice` (I, J, 2) of grid places."""
    # the node of the grid nearest to each start
    grid = pair.pinion.grid
    last = np.array(grid.shape[:2]) - 1.0
    flat = grid.reshape(-1, 2)
    node = np.abs((flat - x[:, None, :2]) / np.ptp(flat, axis=0)).sum(axis=2).argmin(axis=1)
    place = np.stack(np.divmod(node, grid.shape[1]), axis=-1).astype(float)
    best = pair.drive * (x[:, 4] - pair.ratio * phi1[position])
    rows_of_positions, (rows, columns) = np.arange(len(position)), lattice.shape[:2]

    def climb(tried: Array, seen: Advances) -> None:
        """Move each place to the most advanced of the tried places (M, K, 2) if this is ahead."""
        nonlocal place, best
        advance = np.where((seen.beyond <= SLACK_MM).all(axis=0) & np.isfinite(seen.advance), seen.advance, -np.inf)
        k = advance.argmax(axis=1)
        higher = advance[rows_of_positions, k] > best
        place = np.where(higher[:, None], tried[rows_of_positions, k], place)
        best = np.where(higher, advance[rows_of_positions, k], best)

    # all rows of the columns beside the node, at points of the shared lattice
    reach = COLUMN_STRIDE * LATTICE_PARTS[1]
    beside = np.clip(LATTICE_PARTS[1] * (node % grid.shape[1])[:, None] + np.arange(-reach, reach + 1), 0, columns - 1)
    lattice_nodes = (np.arange(rows)[:, None] * columns + beside[:, None, :]).reshape(len(position), -1)
    climb(
        lattice.reshape(-1, 2)[lattice_nodes],
        advances(pair, phi1, jet.r[lattice_nodes], jet.n[lattice_nodes], position),
    )
    # lattices of 9 x 9 points around the place, each with a quarter of the steps before
    reaches = 1.0 / np.array(LATTICE_PARTS)
    for _ in range(FINER_LATTICES - 1):
        offsets = np.stack(np.meshgrid(*(np.linspace(-reach, reach, 9) for reach in reaches), indexing="ij"), axis=-1)
        tried = np.clip(place[:, None] + offsets.reshape(-1, 2), 0.0, last)
        parameters = bilinear(grid, tried.reshape(-1, 2)).reshape(tried.shape)
        climb(tried, _advances_at(pair, phi1, position, parameters))
        reaches = reaches / 4.0
    return _starts(pair, bilinear(grid, place), phi1, position, best)[0]


def seen_closely(pair: Pair, phi1: Array, position: NDArray[np.intp], x: Array) -> Array:
    """Return upper bounds (M,), rad, of the advance around nodes x (M, 5) at positions (M,), by a lattice of half the steps.

    Only teeth that wind round their axis are sampled; the bound of other teeth is infinite.
    """
    if not pair.wound or not len(position):
        return np.full(len(position), np.inf)
    flat = pair.pinion.grid.reshape(-1, 2)
    low, high = flat.min(axis=0), flat.max(axis=0)
    rows, columns = pair.pinion.grid.shape[:2]
    steps = 0.5 * (high - low) / (rows - 1.0, 2.0 * (columns - 1.0))
    shifts = np.arange(-2.0, 3.0)
    offsets = steps * np.stack(np.meshgrid(shifts, shifts, indexing="ij"), axis=-1).reshape(-1, 2)
    seen = _advances_at(pair, phi1, position, np.clip(x[:, None, :2] + offsets, low, high))
    shape = (len(position), len(shifts), len(shifts))
    advance, beyond = seen.advance.reshape(shape), seen.beyond.max(axis=0).reshape(shape)
    # a node beyond an edge counts if it has a neighbour on the flank: the flank's greatest advance may be between them
    near = ~np.isnan(advance) & (-_largest_beside(-beyond) <= SLACK_MM)
    most: Array = np.where(near, advance + _bends(advance), -np.inf).max(axis=(1, 2))
    return most


def _advances_at(pair: Pair, phi1: Array, position: NDArray[np.intp], parameters: Array) -> Advances:
    """Return advances (M, K) of the pinion's points at `parameters` (M, K, 2) at positions (M,)."""
    jet = pair.pinion.surface.jet(parameters[..., 0].ravel(), parameters[..., 1].ravel())
    r, n = (vectors.reshape(*parameters.shape[:2], 3) for vectors in (jet.r, jet.n))
    return advances(pair, phi1, r, n, position)


def _level(advance: Array, best: Array, bends: Array, beyond: Array | None) -> NDArray[np.bool_]:
    """Return True (I, J) for nodes about which an advance (N, I, J) may exceed the `best` (N,) of its position.

    - `bends`: estimated rises (N, I, J) of the advance around the nodes, rad
    - `beyond`: distances (4, N, I, J), mm, outside the limits, None for flanks without limits
    """
    rise = bends.max(axis=0)[None]
    for _ in range(NEIGHBOUR_NODES + 1):
        rise = _largest_beside(rise)
    with np.errstate(invalid="ignore"):
        level: NDArray[np.bool_] = np.fmax.reduce(advance - best[:, None, None], axis=0) + rise[0] >= 0.0
    for limit in () if beyond is None else beyond:
        level &= _wider((limit <= SLACK_MM).any(axis=0)[None])[0]
    return level


def _is_peak(values: Array, nodes: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Return True (N, M) for finite values (N, I, J) at some nodes (M,) that no neighbour exceeds."""
    columns = values.shape[2] + 2
    rim = np.pad(values, ((0, 0), (1, 1), (1, 1)), constant_values=-np.inf).reshape(len(values), -1)
    i, j = np.divmod(nodes, values.shape[2])
    middle = (i + 1) * columns + j + 1
    own = rim[:, middle]
    peaks = np.isfinite(own)
    for down, across in product((-1, 0, 1), repeat=2):
        if (down, across) != (0, 0):
            peaks &= own >= rim[:, middle + down * columns + across]
    return peaks


def _summits(rim: Array) -> Iterator[tuple[NDArray[np.intp], NDArray[np.intp]]]:
    """Yield positions (M,) and places (M,) of the greatest value along an edge (N, K), then of a second summit if there is one.

    A line along which the flanks nearly touch may leave the flanks twice over the same edge.
    """
    rows, first = np.arange(len(rim)), rim.argmax(axis=1)
    positions = np.flatnonzero(rim[rows, first] > -np.inf)
    yield positions, first[positions]
    wide = np.pad(rim, ((0, 0), (1, 1)), constant_values=-np.inf)
    others = np.where((rim > wide[:, :-2] + SUMMIT_RISE_RAD) & (rim > wide[:, 2:] + SUMMIT_RISE_RAD), rim, -np.inf)
    others[rows, first] = -np.inf
    second = others.argmax(axis=1)
    positions = np.flatnonzero(others[rows, second] > -np.inf)
    if positions.size:
        yield positions, second[positions]


def _vertices(advance: Array, position: NDArray[np.intp], place: Array) -> Array:
    """Return places (C, 2) of the vertices of parabolas through 3 x 3 nodes about nodes (C, 2), at most a step from them.

    `advance` (N, I, J) is read at positions (C,). The node itself is returned where the parabola has no vertex.
    """
    last = np.array(advance.shape[1:]) - 1
    if (last < 2).any():
        return place
    node = place.astype(np.intp)
    middle = np.clip(node, 1, last - 1)
    f = {(a, b): advance[position, middle[:, 0] + a, middle[:, 1] + b] for a, b in product((-1, 0, 1), repeat=2)}
    slope_i, slope_j = 0.5 * (f[1, 0] - f[-1, 0]), 0.5 * (f[0, 1] - f[0, -1])
    bend_i, bend_j = f[1, 0] - 2.0 * f[0, 0] + f[-1, 0], f[0, 1] - 2.0 * f[0, 0] + f[0, -1]
    twist = 0.25 * (f[1, 1] - f[1, -1] - f[-1, 1] + f[-1, -1])
    area = bend_i * bend_j - twist**2
    shift = np.stack((twist * slope_j - bend_j * slope_i, twist * slope_i - bend_i * slope_j), axis=-1) / area[:, None]
    vertex = np.clip(np.clip(middle + shift, place - VERTEX_STEPS, place + VERTEX_STEPS), 0.0, last)
    summit = (area > 0.0) & (bend_i < 0.0) & np.isfinite(shift).all(axis=1)
    return np.where(summit[:, None], vertex, place)


def _may_rise(
    advance: Array, position: NDArray[np.intp], i: NDArray[np.intp], j: NDArray[np.intp]
) -> NDArray[np.bool_]:
    """Return True (C,) for nodes beside which the advance may be greatest, by `advance` (N, I, J).

    Along a line of nodes slopes change by no more than twice the second differences at the node and beside it. A node is left out
    if the advance rises for certain along a row, a column or a diagonal, from one neighbour over the node to the next.
    """
    may, last = np.ones(len(position), dtype=bool), np.array(advance.shape[1:])[:, None, None] - 1
    for along in ((1, 0), (0, 1), (1, 1), (1, -1)):
        nodes = np.stack((i, j))[:, None] + np.array(along)[:, None, None] * np.arange(-2, 3)[:, None]
        there = np.asarray(((nodes >= 0) & (nodes <= last)).all(axis=0))
        rise = np.diff(np.where(there, advance[position, *np.clip(nodes, 0, last)], np.nan), axis=0)
        bend = np.abs(np.diff(rise, axis=0))
        slopes = rise[1:3] / np.fmax(bend[:2], bend[1:])
        # beyond the ends of a row or column nothing is known, and nothing is needed
        beyond = np.logical_not(there[1:4:2]) & (0 in along)
        may &= ~(((slopes >= 1.0) | beyond).all(axis=0) | ((slopes <= -1.0) | beyond).all(axis=0))
    return may


def _largest_beside(values: Array) -> Array:
    """Return the largest value (N, I, J) of every node and its neighbours."""
    largest = values.copy()
    for beside in _neighbours(values):
        np.maximum(largest, beside, out=largest)
    return largest


def _neighbours(values: Array) -> Iterator[Array]:
    """Yield the values (N, I, J) of each of the eight neighbours of every node, -inf beyond the rim."""
    rim = np.pad(values, ((0, 0), (1, 1), (1, 1)), constant_values=-np.inf)
    for i, j in product(range(3), repeat=2):
        if (i, j) != (1, 1):
            yield rim[:, i : i + values.shape[1], j : j + values.shape[2]]


def _bends(advance: Array) -> Array:
    """Return the estimated rise (N, I, J), rad, of the advance around every node, 0 where it is unknown.

    The estimate is twice the rise of a parabola through the node and its neighbours.
    """
    return _bends_and_gain(advance)[0]


def _bends_and_gain(advance: Array) -> tuple[Array, Array]:
    """Return the estimated rises (N, I, J) of `_bends`, rad, and a bound (N,) of the rise between neighbouring nodes, rad.

    The bound is half the largest second differences.
    """
    bends, gain = np.zeros(advance.shape), np.zeros(len(advance))
    for axis in (1, 2):
        bend = 0.25 * np.abs(np.diff(advance, 2, axis=axis))
        bend[np.isnan(bend)] = 0.0
        inner = np.s_[:, 1:-1] if axis == 1 else np.s_[:, :, 1:-1]
        bends[inner] += bend
        gain += 2.0 * bend.max(axis=(1, 2), initial=0.0)
    return bends, gain


def _bends_along(line: Array) -> Array:
    """Return the estimated rise (N, K), rad, of the advance (N, K) around every node of a line, as in `_bends`."""
    bends = np.zeros(line.shape)
    bends[:, 1:-1] = np.nan_to_num(0.25 * np.abs(np.diff(line, 2, axis=1)))
    return bends


def _local_gain(bends: Array, position: NDArray[np.intp], place: Array, around: int) -> Array:
    """Return the largest estimated rise (C,), rad, within a number of nodes around grid places (C, 2)."""
    last = np.array(bends.shape[1:]) - 1
    node, near = np.rint(place).astype(np.intp), np.arange(-around, around + 1)
    i, j = (np.clip(node[:, axis, None] + near, 0, last[axis]) for axis in (0, 1))
    gain: Array = bends[position[:, None, None], i[:, :, None], j[:, None, :]].max(axis=(1, 2))
    return gain


@dataclass(frozen=True)
class _LatticeCells:
    """Cells (C,) of lattices that may hold an overlap of the flanks."""

    #: positions (C,)
    position: NDArray[np.intp]
    #: rows (C,) of the first nodes
    i: NDArray[np.intp]
    #: columns (C,) of the first nodes
    j: NDArray[np.intp]
    #: mean distances (C,) of the nodes from the overlap, summed over the limits, mm
    apart: Array
    #: advances (N, I, J) of the lattices, rad
    advance: Array

    def __getitem__(self, which: NDArray[np.intp]) -> _LatticeCells:
        return _LatticeCells(self.position[which], self.i[which], self.j[which], self.apart[which], self.advance)

    def nearest(self) -> _LatticeCells:
        """Return the nearest cell of every position, the first of equally near cells."""
        order = np.lexsort((self.apart, self.position))
        return self[order[np.diff(self.position[order], prepend=-1) > 0]]

    @property
    def places(self) -> tuple[NDArray[np.intp], Array, Array, Array, Array]:
        """Return positions (C,), rows and columns (C,) of the cells' middles, and mean and greatest advance (C,) of their nodes."""
        nodes = np.stack([self.advance[self.position, self.i + k, self.j + m] for k in (0, 1) for m in (0, 1)])
        i, j = self.i.astype(float) + 0.5, self.j.astype(float) + 0.5
        return self.position, i, j, np.nanmean(nodes, axis=0), np.nanmax(nodes, axis=0)


def _small_overlaps(pair: Pair, nodes: _Nodes, phi1: Array, field: _Field) -> _LatticeCells:
    """Return the nearest cells with a small overlap of the flanks, of positions without a sample on both flanks.

    Each cell that may hold an overlap is divided CELL_DIVISIONS times; cells whose parts cannot overlap are dropped.
    """
    cells = field.unsampled_cells
    corners, numbers, steps = (
        np.stack((cells.i, cells.j), axis=-1).astype(float),
        np.arange(len(cells.position)),
        np.linspace(0.0, 1.0, CELL_PARTS + 1),
    )
    for _ in range(CELL_DIVISIONS):
        if not numbers.size:
            break
        # divide each cell into CELL_PARTS by CELL_PARTS parts and solve for the advance at their nodes
        offsets = np.stack(np.meshgrid(steps, steps, indexing="ij"), axis=-1)
        lattice = corners[:, None, None] + offsets
        position = cells.position[numbers]
        parameters = nodes.parameters(np.repeat(position, offsets[..., 0].size), lattice.reshape(-1, 2))
        seen = _advances_at(pair, phi1, nodes.index[position], parameters.reshape(len(numbers), -1, 2))
        shape = lattice.shape[:3]
        # keep the parts with a node inside of every limit: only these may hold an overlap
        closer = _overlapping(seen.advance.reshape(shape), seen.beyond.reshape(4, *shape), ())
        corners, numbers, steps = (
            lattice[closer.position, closer.i, closer.j],
            numbers[closer.position],
            steps / CELL_PARTS,
        )
    return cells[distinct(numbers)].nearest()


def _overlapping(
    advance: Array,
    beyond: Array,
    crossed: Sequence[str],
    station: Array | None = None,
    signs: NDArray[np.uint16] | None = None,
) -> _LatticeCells:
    """Return the cells of lattices (N, I, J) in which the flanks may overlap, by the signs at the nodes.

    - `beyond`: distances (4, N, I, J), mm, outside the limits
    - `crossed`: names of the edges that must run through the cell
    - `station`: distances (N, I, J) from a station that must run through the cell, mm
    - `signs`: `_cell_signs` of advances and distances, where they are known
    """
    # a cell needs a node inside every limit, and also a node outside for each edge that runs through it
    over = [(limit, name in crossed) for limit, name in zip(beyond, FLANK_LIMITS, strict=True)]
    found = _cell_signs(advance, beyond) if signs is None else signs
    needed = 1 | sum(2 + 4 * edge << 2 * k for k, (_, edge) in enumerate(over))
    possible = found & needed == needed
    if station is not None:
        over.append((station, True))
        possible &= _cell_signs(None, station[None]) == 6
    position, i, j = np.nonzero(possible)
    apart = np.zeros(len(position))
    for limit, edge in over:
        distance = 0.25 * sum(limit[position, i + k, j + m] for k in (0, 1) for m in (0, 1))
        apart += np.abs(distance) if edge else np.maximum(distance, 0.0)
    return _LatticeCells(position, i, j, apart, advance)


def _cell_signs(advance: Array | None, beyond: Array) -> NDArray[np.uint16]:
    """Return bits of the cells of lattices (N, I, J): 1 for a finite `advance`, then 2 << 2 k for nodes inside limit k and
    4 << 2 k for nodes outside it, by the distances `beyond` (L, N, I, J).
    """
    nodes = np.zeros(beyond.shape[1:], dtype=np.uint16)
    if advance is not None:
        nodes |= np.isfinite(advance)
    for k, limit in enumerate(beyond):
        for bit, side in ((2, limit <= 0.0), (4, limit > 0.0)):
            nodes |= side.astype(np.uint16) << np.uint16(2 * k) << np.uint16(bit // 2)
    pairs = nodes[:, :-1] | nodes[:, 1:]
    return pairs[:, :, :-1] | pairs[:, :, 1:]


def _on_last_row(field: _Field, station: Array) -> tuple[NDArray[np.intp], Array, Array, Array, Array]:
    """Return the crossings of the last row of the grid with a station of the pinion, by the nodes' distances (N, I, J), mm.

    The result is positions (M,), rows and columns (M,), and mean and greatest advance (M,) of the nodes on either side.
    """
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
    advance: Array, beside: Array, others: Sequence[Array], level: NDArray[np.bool_]
) -> tuple[NDArray[np.intp], Array, Array, Array]:
    """Return the crossing of grid lines with an edge that has the greatest advance, for each position.

    - `beside`: distances (N, I, J), mm, of nodes outside the edge
    - `others`: distances (N, I, J), mm, outside other limits, which crossings must keep
    - `level`: True (I, J) for nodes at either end of the parts of lines that count

    The result is positions (M,), rows and columns (M,) and advances (M,), interpolated between the nodes on either side.
    """
    count, rows, columns = advance.shape
    flat, from_edge = advance.reshape(-1), beside.reshape(-1)
    by_position, nodes = beside.reshape(count, -1), np.arange(rows * columns).reshape(rows, columns)
    crossings = []
    for axis, stride in ((1, columns), (2, 1)):
        # lines cross the edge at few places: compute these places only
        first, second = (np.s_[:-1], np.s_[1:]) if axis == 1 else (np.s_[:, :-1], np.s_[:, 1:])
        parts = nodes[first][level[first] | level[second]]
        position, part = np.nonzero((by_position[:, parts] <= 0.0) != (by_position[:, parts + stride] <= 0.0))
        low = position * (rows * columns) + parts[part]
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
                valid &= before + share * (beyond[high] - before) <= SLACK_MM
        low, share, value = low[valid], share[valid], value[valid]
        position, node = np.divmod(low, rows * columns)
        i, j = np.divmod(node, columns)
        crossings.append((position, i + share * (axis == 1), j + share * (axis == 2), value))
    position, i, j, value = (np.concatenate(column) for column in zip(*crossings, strict=True))
    # the greatest advance of each position, the first of equal ones
    order = np.lexsort((-value, position))
    best = order[np.diff(position[order], prepend=-1) > 0]
    return position[best], i[best], j[best], value[best]


def _starts(
    pair: Pair, parameters: Array, phi1: Array, position: NDArray[np.intp], value: Array
) -> tuple[Array, NDArray[np.bool_]]:
    """Return unknowns (C, 5) where the pinion's points at `parameters` (C, 2) meet the gear at positions (C,).

    Points whose circles do not meet the gear take the advances `value` (C,). True (C,) marks points on the gear's flank.
    """
    x = np.empty((len(position), 5))
    x[:, :2] = parameters
    jet = pair.pinion.surface.jet(x[:, 0], x[:, 1])
    seen = advances(pair, phi1, jet.r[:, None], jet.n[:, None], position)
    x[:, 2:4] = pair.gear.heights.parameters_at(seen.rho[:, 0], seen.z[:, 0])
    x[:, 4] = (
        pair.drive * np.where(np.isfinite(seen.advance[:, 0]), seen.advance[:, 0], value) + pair.ratio * phi1[position]
    )
    return x, np.asarray((seen.beyond[..., 0] <= SLACK_MM).all(axis=0))


def _off_middle(shape: tuple[int, ...]) -> Array:
    """Return a bias (I, J), rad, far below all tolerances, that makes the middle of equally advanced nodes the peak."""
    i, j = (np.linspace(-1.0, 1.0, n) ** 2 for n in shape)
    return 1e-7 * (i[:, None] + j)
