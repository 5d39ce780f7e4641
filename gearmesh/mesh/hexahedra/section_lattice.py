"""Quadrilaterals in the sections of a tooth and its share of the rim: exact nodes on the outline, interpolated ones inside.

Each half of a tooth has two blocks, with lines s along the outline and lines d into the material:

              land
          +---------+ C            `upper`: flank (and broken edge) x half the tooth's thickness
    flank |  upper  |
          |         |              `lower`: middle of the root land to the form point x depth of the rim; its side at the
        J +---------+ M                     joint goes J - M - K, so that the lines d turn around the fillet
    cut  /          |
    +---   lower    |
    |               |
    +---------------+ K
        rim, inner face

If the outline is smooth where flank and land meet, as on lobes and round tips, a corner of a block there would be flat. The first
lines d then go round the tip (`Lines.round`), and `upper` has its corner C' inside:

          C
         .---- land ----      `cap`: the rest of the land x the lines that go round
        /  \\   cap     |
       |    C'---------+ Q    `upper`: up to its line `round` a ring along the flank, beyond it the block P M Q C'
       |    |          |
     J +----P----------+ M

Inner nodes come from transfinite interpolation in a conformal chart of the section, in which radial cuts and arcs around the
axis are straight lines. Sections of constant station are planes, cones or cylinders.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, distinct, dot, median
from gearmesh.mesh.hexahedra.layers import Chart, Layers
from gearmesh.records import dataclass
from gearmesh.teeth.region import FILLET_REGIONS, FLANK_REGIONS, TIP_EDGES, Region, Side

#: height of M over the root land, as a share of the height of the form point
MEETING_HEIGHT_SHARE = 0.35
#: least width of the root land, as a share of the even share of its cells; on a narrower one the cells reach over to the fillet
MIN_ROOT_SHARE = 0.4
#: smallest distance of a mid-side node from the nearer corner, over the distances to both: 0.25 makes elements singular
MIN_MIDDLE_SHARE = 0.35
#: steps of regula falsi towards a mid-side node with this share: within 2 % of the length of its edge
MIDDLE_STEPS = 3
#: cosine of the angle between the normals of flank and land up to which lines go round the tip: corners of 150 deg and more
MIN_SMOOTH_COSINE = float(np.cos(np.radians(30.0)))
#: least number of lines d for some to go round the tip: at the flank, in the middle, and between
MIN_ROUND_LINES = 3
#: wanted share of half the tooth's thickness of the lines that go round its tip
RING_SHARE = 0.45
#: shares that are tried for C' from C to J and to M, for Q from the land to M, and for M from its place to the inner face
TRIED_SHARES = (
    np.linspace(-0.2, 0.6, 9),
    np.linspace(0.1, 0.7, 7),
    np.linspace(0.15, 0.75, 7),
    np.linspace(0.0, 0.6, 5),
)
#: shares that are tried for M from its place to the inner face where lines do not go round the tip
TRIED_DEPTHS = np.linspace(0.0, 0.7, 8)
#: lines s of the blocks that are tried
TRIED_LINES = 13
#: largest sum of the shares towards J and M
MAX_CORNER_SHARE = 0.85
#: depth of the outermost layers under a smooth tip, over that of even ones; mid-side nodes of second order bear no less
OUTER_DENSITY = 0.4
#: sine of the worst corner that is good enough
ENOUGH_SINE = 0.45
#: weight of the ring's thickness, as the share from C to M, against the sine of the worst corner
RING_WEIGHT = 0.1
#: digits of sines by which a corner is chosen: rounding must not choose
SINE_DIGITS = 6
#: points at which the lengths of the outline's links are measured
LENGTH_SAMPLES = 65


def transfinite(low_s: Array, high_s: Array, low_d: Array, high_d: Array) -> Array:
    """Return the nodes (S, D, ..., 2) of a block by transfinite interpolation between its four sides.

    - low_s, high_s: sides (D, ..., 2) at the first and last line s.
    - low_d, high_d: sides (S, ..., 2) at the first and last line d.

    Each side counts by its arc length. Corners must agree.
    """
    xi_low, xi_high = fractions(low_d)[:, None], fractions(high_d)[:, None]
    eta_low, eta_high = fractions(low_s)[None], fractions(high_s)[None]
    # intersections, in the unit square, of the straight lines between corresponding places on opposite sides
    xi = (xi_low + eta_low * (xi_high - xi_low)) / (1.0 - (eta_high - eta_low) * (xi_high - xi_low))
    eta = eta_low + xi * (eta_high - eta_low)
    xi, eta = xi[..., None], eta[..., None]
    sides = (1.0 - xi) * low_s[None] + xi * high_s[None] + (1.0 - eta) * low_d[:, None] + eta * high_d[:, None]
    corners = (1.0 - xi) * ((1.0 - eta) * low_d[0] + eta * high_d[0]) + xi * (
        (1.0 - eta) * low_d[-1] + eta * high_d[-1]
    )
    nodes: Array = sides - corners
    return nodes


def fractions(line: Array) -> Array:
    """Return the arc lengths (S, ...) from the first point of polylines (S, ..., 2), over the whole lengths."""
    steps = np.sqrt((np.diff(line, axis=0) ** 2).sum(axis=-1))
    length = np.concatenate((np.zeros((1, *steps.shape[1:])), np.cumsum(steps, axis=0)))
    shares: Array = length / length[-1]
    return shares


@dataclass(frozen=True)
class Lines:
    """Lines of the lattice, as places from 0 to 1 along the sides of the blocks."""

    #: number of cells from the middle of the root land to the form point
    root: int
    #: places (F + 1,) or (F + 1, T) from form point to tip
    flank: Array
    #: number of cells on a broken tip edge
    edge: int
    #: places (D + 1,) from flank to middle of the tooth
    thickness: Array
    #: places (R + 1,) from there inwards
    rim: Array
    #: weight of the root land's length against the fillet's in the share of the `root` cells
    land: float = 1.0
    #: number of first lines d that go round the tip, under the land; 0: the land is the last line s of the upper block
    round: int = 0
    #: True if every other line has mid-side nodes, which keep away from the corners of their edge on flanks
    halved: bool = False


@dataclass(frozen=True)
class HalfLattice:
    """Nodes of one half of a tooth, lines s by lines d; line L of `lower` is, up to line D, the first line of `upper`."""

    #: (L + 1, N + 1, T, 3), mm
    lower: Array
    #: (U + 1, D + 1, T, 3), mm
    upper: Array
    #: True (L,) for cells of `lower` with their outer face on the root land, False on the fillet
    root_cells: NDArray[np.bool_]
    #: (D - round + 1, round + 1, T, 3), mm, along the land and inwards; None without lines that go round the tip
    cap: Array | None = None


def lines_round(layers: Layers, lines: Lines) -> int:
    """Return the number of lines d that are to go round the tip: 0 if the outline has a corner at the land, or for few lines."""
    middle = len(layers.base.root) // 2
    for side in Side:
        before = FLANK_REGIONS[side] if layers.tooth.tip_edge is None else TIP_EDGES[side]
        ends = (before, 1.0), (Region.LAND, 0.0)
        flank, land = (
            layers.grid(link, np.array([end if side is Side.RIGHT else 1.0 - end])).normals[0, middle]
            for link, end in ends
        )
        if float(dot(flank, land)) < MIN_SMOOTH_COSINE or len(lines.thickness) < MIN_ROUND_LINES:
            return 0
    return int(np.abs(lines.thickness[1:-1] - RING_SHARE).argmin()) + 1


def tooth_lattice(layers: Layers, lines: Lines, chart: Chart, inner: Array) -> tuple[HalfLattice, HalfLattice]:
    """Return the nodes of the right and the left half of a tooth; `inner` (T,): height u, mm, of the rim's inner face."""
    outlines = [_outline(layers, side, lines) for side in Side]
    low, flank, land = ([chart.to_chart(getattr(o, name)) for o in outlines] for name in ("low", "flank", "land"))
    outer = _Outer(low, flank, land, chart.depth(inner), lines)
    halves = []
    for outline, blocks in zip(outlines, outer.blocks(_best_place(outer)), strict=True):
        lower, upper, *rest = (chart.from_chart(nodes) for nodes in blocks)
        halves.append(HalfLattice(lower, upper, outline.root_cells, *rest))
    return halves[0], halves[1]


@dataclass(frozen=True)
class _Outer:
    """Outlines (S, T, 2) of both halves of a tooth, in the chart."""

    #: from the cut to J
    low: list[Array]
    #: from J to C
    flank: list[Array]
    #: from C to the middle of the land
    land: list[Array]
    #: X (T,) of the rim's inner face
    bottom: Array
    #: lines of the lattice
    lines: Lines

    def coarse(self, sections: NDArray[np.int64]) -> _Outer:
        """Return some sections (N,) with few lines s."""
        low, flank = (
            [
                line[distinct(np.linspace(0, len(line) - 1, TRIED_LINES).round().astype(int))][:, sections]
                for line in lines
            ]
            for lines in (self.low, self.flank)
        )
        return _Outer(low, flank, [line[:, sections] for line in self.land], self.bottom[sections], self.lines)

    def blocks(self, place: Array) -> list[tuple[Array, ...]]:
        """Return the nodes (S, D, T, 2) of the blocks of both halves: `lower`, `upper`, and `cap` if lines go round the tip.

        A place (P,) or (T, P) has the share of M on its way to the rim's inner face. Where lines go round the tip, it is the last
        of four: before it are those of C' from C towards J and towards M, and of Q from the land towards M.
        """
        low, lines = self.low, self.lines
        root, centre = 0.5 * (low[0][0, :, 0] + low[1][0, :, 0]), 0.5 * (low[0][0, :, 1] + low[1][0, :, 1])
        meeting = 0.5 * (low[0][-1] + low[1][-1])
        meeting[:, 0] = root + MEETING_HEIGHT_SHARE * (meeting[:, 0] - root)
        meeting[:, 0] += place[..., -1] * (self.bottom - meeting[:, 0])
        down = _straight(meeting, np.stack((self.bottom, centre), -1), lines.rim)
        across = [_straight(side[-1], meeting, lines.thickness) for side in low]
        inwards = [np.concatenate((line, down[1:])) for line in across]
        # shared lines of both halves are spaced by the mean of both
        rises = 0.5 * (fractions(self.flank[0]) + fractions(self.flank[1]))
        places = 0.5 * (fractions(inwards[0]) + fractions(inwards[1]))
        halves = list[tuple[Array, ...]]()
        for k, (side, flank, land) in enumerate(zip(low, self.flank, self.land, strict=True)):
            cut = _straight(side[0], np.stack((self.bottom, side[0, :, 1]), -1), places)
            arc = _straight(cut[-1], inwards[k][-1], np.linspace(0.0, 1.0, len(side)))
            lower = transfinite(cut, inwards[k], side, arc)
            if lines.round:
                halves.append((lower, *_round_tip(flank, land, across[k], rises, lines, place)))
            else:
                upper = transfinite(across[k], land, flank, _straight(meeting, land[-1], rises))
                halves.append((lower, upper))
        return halves


def _round_tip(
    flank: Array, land: Array, across: Array, rises: Array, lines: Lines, place: Array
) -> tuple[Array, Array]:
    """Return the nodes of `upper` (U + 1, D + 1, T, 2) and of `cap` (D - round + 1, round + 1, T, 2) of half a tooth.

    - flank, land, across: lines (S, T, 2) from J to C, from C to the middle of the land, and from J to M.
    - rises: places (U + 1, T) from M to Q.
    - place: shares (4,) or (T, 4), see `_Outer.blocks`.
    """
    count, thickness, tip, meeting = lines.round, lines.thickness, flank[-1], across[-1]
    to_form, to_meeting, down = np.moveaxis(place[..., :3], -1, 0)[..., None]
    corner = tip + to_form * (flank[0] - tip) + to_meeting * (meeting - tip)
    under = land[-1] + down * (meeting - land[-1])
    ring_places, places = thickness[: count + 1] / thickness[count], thickness[count:] - thickness[count]
    # lines are dense at the tip, where the ring is deeper than the layers of a tooth with a corner
    ring_places = ring_places * (OUTER_DENSITY + (1.0 - OUTER_DENSITY) * ring_places)
    inwards = _straight(tip, corner, ring_places)
    ring_inner = _straight(across[count], corner, fractions(flank))
    ring = transfinite(across[: count + 1], inwards, flank, ring_inner)
    top = _straight(corner, under, places / places[-1])
    inner = transfinite(across[count:], top, ring_inner, _straight(meeting, under, rises))
    cap = transfinite(inwards, _straight(land[-1], under, ring_places), land, top)
    return np.concatenate((ring, inner[:, 1:]), axis=1), cap


def _best_place(outer: _Outer) -> Array:
    """Return the place (P,) of M, or of C', Q and M, see `_Outer.blocks`, with a good worst corner of the elements and a thin ring.

    It is chosen in the middle section, for both halves of a tooth.
    """
    if outer.lines.round:
        places = np.stack(np.meshgrid(*TRIED_SHARES, indexing="ij"), axis=-1).reshape(-1, len(TRIED_SHARES))
        # above the line from J to M
        places = places[places[:, 0] + places[:, 1] < MAX_CORNER_SHARE]
    else:
        places = TRIED_DEPTHS[:, None]
    middle = np.full(len(places), len(outer.bottom) // 2)
    halves = outer.coarse(middle).blocks(places)
    worst = np.min([_least_sines(block) for blocks in halves for block in blocks], axis=0)
    # good is enough: then the thinner the ring, the finer its layers
    merit = np.minimum(worst, ENOUGH_SINE) - (RING_WEIGHT * places[:, 1] if outer.lines.round else 0.0)
    return np.asarray(places[int(merit.round(SINE_DIGITS).argmax())])


def _least_sines(nodes: Array) -> Array:
    """Return the smallest sines (N,) of the angles at the corners of the quadrilaterals of N blocks (S, D, N, 2)."""
    along, inwards = (
        way / np.hypot(way[..., 0], way[..., 1])[..., None] for way in (np.diff(nodes, axis=0), np.diff(nodes, axis=1))
    )
    sines = [
        first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]
        for first in (along[:, :-1], along[:, 1:])
        for second in (inwards[:-1], inwards[1:])
    ]
    sense = float(np.sign(median(sines[0])))
    return np.asarray((sense * np.array(sines)).min(axis=(0, 1, 2)))


@dataclass(frozen=True)
class _Outline:
    """Half of a tooth's outline, exact points (..., T, 3), mm."""

    #: from the cut to the form point
    low: Array
    #: from the form point to the tip
    flank: Array
    #: from the tip to the middle of the land
    land: Array
    #: True for cells on the root land
    root_cells: NDArray[np.bool_]


def _outline(layers: Layers, side: Side, lines: Lines) -> _Outline:
    """Return the outline of one half of a tooth."""
    links = _Links(layers, side)
    low, root_cells = links.from_cut_to_form_point(lines.root, lines.land, 2 if lines.halved else 1)
    places = links.with_middles(FLANK_REGIONS[side], lines.flank) if lines.halved else lines.flank
    flank = links.points(FLANK_REGIONS[side], places)
    if layers.tooth.tip_edge is not None:
        flank = np.concatenate((flank, links.points(TIP_EDGES[side], np.linspace(0.0, 1.0, lines.edge + 1))[1:]))
    top = lines.thickness[lines.round :] - lines.thickness[lines.round]
    return _Outline(low, flank, links.points(Region.LAND, top / top[-1]), root_cells)


def _distance(first: Array, second: Array) -> Array:
    """Return the distances (...,) between points (..., 3)."""
    away = second - first
    return np.sqrt(dot(away, away))


class _Links:
    """Links of one side of a tooth's outline; each link runs from the cut towards the land."""

    def __init__(self, layers: Layers, side: Side) -> None:
        self._layers, self._side = layers, side

    def points(self, region: Region, s: Array) -> Array:
        """Return exact points (S, T, 3), mm, at s (S,) or (S, T); root and land count from end to middle."""
        right = self._side is Side.RIGHT
        if region in (Region.ROOT, Region.LAND):
            place = 0.5 * s + 0.5 if region is Region.ROOT else 0.5 * s
            points = self._layers.grid(region, place if right else 1.0 - place).points
            return self._layers.step.point(points) if region is Region.ROOT and not right else points
        return self._layers.grid(region, s if right else 1.0 - s).points

    def with_middles(self, region: Region, s: Array) -> Array:
        """Return places (2 F + 1, T) with every other one near halfway between its neighbours by distance.

        The middle in s stays where its share of the distances to both corners is inside MIN_MIDDLE_SHARE: elements next to
        the small elements of a fillet are graded by it. Near a singular end of a flank the length grows with the square of
        s, and a mid-side node at a quarter of its edge makes the element singular. s: (2 F + 1,) or (2 F + 1, T).
        """
        first, last = self.points(region, s[:-2:2]), self.points(region, s[2::2])
        shape = first.shape[:-1]
        low, middle, high = (
            np.broadcast_to(part if s.ndim > 1 else part[:, None], shape) for part in (s[:-2:2], s[1::2], s[2::2])
        )
        there = self.points(region, middle)
        before, behind = _distance(first, there), _distance(there, last)
        share = np.clip(before / (before + behind), MIN_MIDDLE_SHARE, 1.0 - MIN_MIDDLE_SHARE)
        length = _distance(first, last)
        # regula falsi for the place that has this share: at the corners the difference is minus and plus a part of the length
        nearer, farther = -share * length, (1.0 - share) * length
        for _ in range(MIDDLE_STEPS):
            difference = (1.0 - share) * before - share * behind
            is_low = difference < 0.0
            low, nearer = np.where(is_low, middle, low), np.where(is_low, difference, nearer)
            high, farther = np.where(is_low, high, middle), np.where(is_low, farther, difference)
            middle = low + (high - low) * nearer / (nearer - farther)
            there = self.points(region, middle)
            before, behind = _distance(first, there), _distance(there, last)
        places = np.empty((len(s), *shape[1:]))
        places[::2], places[1::2] = s[::2] if s.ndim > 1 else s[::2, None], middle
        return places

    def from_cut_to_form_point(self, cells: int, land: float, step: int) -> tuple[Array, NDArray[np.bool_]]:
        """Return the nodes (cells + 1, T, 3), mm, over root land and fillet, and True (cells,) for cells on the root land.

        The cells, `step` to an element, are shared by the mean lengths of root land (times `land`) and fillet, evenly spaced on
        each. Where the root land is narrower than MIN_ROOT_SHARE of the even share, its cells reach over to the fillet.
        """
        s = np.linspace(0.0, 1.0, LENGTH_SAMPLES)
        fillet = FILLET_REGIONS[self._side]
        samples = np.concatenate((self.points(Region.ROOT, s), self.points(fillet, s)[1:]))
        steps = np.sqrt((np.diff(samples, axis=0) ** 2).sum(axis=-1))
        length = np.concatenate((np.zeros((1, steps.shape[1])), np.cumsum(steps, axis=0)))
        root, whole = length[LENGTH_SAMPLES - 1], length[-1]
        part = land * root / (land * root + whole - root)
        # a line of corners, not of mid-side nodes, lies between root land and fillet
        elements = cells // step
        on_root = step * int(np.clip(np.round(elements * part.mean()), 1, elements - 1))
        change = np.maximum(root, MIN_ROOT_SHARE * whole * on_root / cells)
        wanted = np.concatenate(
            (
                change * np.linspace(0.0, 1.0, on_root + 1)[:-1, None],
                change + (whole - change) * np.linspace(0.0, 1.0, cells - on_root + 1)[:, None],
            )
        )
        # places: 0 .. 1 over the root land, 1 .. 2 over the fillet
        places = np.linspace(0.0, 2.0, 2 * LENGTH_SAMPLES - 1)
        nodes = np.stack([np.interp(w, at, places) for w, at in zip(wanted.T, length.T, strict=True)], axis=-1)
        points = np.where(
            (nodes <= 1.0)[..., None],
            self.points(Region.ROOT, np.clip(nodes, 0.0, 1.0)),
            self.points(fillet, np.clip(nodes - 1.0, 0.0, 1.0)),
        )
        return points, np.arange(cells) < on_root


def _straight(first: Array, last: Array, places: Array) -> Array:
    """Return points (S, T, 2) on straight lines from `first` to `last` (T, 2) at places (S,) or (S, T)."""
    places = places[:, None] if places.ndim == 1 else places
    return first + places[..., None] * (last - first)
