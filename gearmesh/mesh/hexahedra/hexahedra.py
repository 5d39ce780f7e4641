"""Structured hexahedra of some or all teeth of a member, with the rim under them and named sets.

The quadrilaterals of the sections (`section_lattice`) are joined from toe to heel. The halves of a tooth share the nodes on
its middle; neighbouring teeth share the nodes of the radial cut between them. A second-order mesh is the lattice of half the
cell size with its mid-side nodes kept: the mid-side nodes of flanks lie on the exact surface, too.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field, replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.allowed import Allowed
from gearmesh.errors import DesignError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, distinct
from gearmesh.mesh.hexahedra.grading import Spacing, uniform
from gearmesh.mesh.hexahedra.hexes import HEX_EDGES, HexMesh
from gearmesh.mesh.hexahedra.layers import Base, Chart, Layers, layers
from gearmesh.mesh.hexahedra.section_lattice import HalfLattice, Lines, lines_round, tooth_lattice
from gearmesh.records import dataclass
from gearmesh.teeth.blank.body import end_names
from gearmesh.teeth.region import FLANK_REGIONS, Side
from gearmesh.teeth.section import breaks
from gearmesh.teeth.tooth import Tooth

#: stations and lines nearer to each other, as shares of face or flank, are the same
SAME_STATION = 1e-12
#: default thickness of the rim under the root, in whole depths
RIM_WHOLE_DEPTHS = 1.2
#: growth of the cell size per unit of distance from the contact
CELL_GROWTH = 0.4
#: least number of cells along, across and through the tooth if they follow from a contact ellipse
LEAST_CELLS = 6
#: share of the wanted elements into the tooth that is enough
ENOUGH_LAYERS_SHARE = 0.95
#: share of the wanted elements over a contact ellipse below which lines are added; their slant takes some
ENOUGH_LINES_SHARE = 0.98
#: least number of stations when stations are given up for lines that follow a contact ellipse
LEAST_STATIONS = 24
#: distance from the ellipse, in semi-axes, up to which the fine lines follow its slant
FOLLOWED_SEMI_AXES = 1.5

Index = NDArray[np.int64]


@dataclass(frozen=True)
class Cells:
    """Numbers of cells.

    The defaults give a pair with three teeth each 72,660 elements; [LF04] 17.10 has 71,460.
    """

    #: form point to tip
    flank: int = 24
    #: middle of the root land to form point
    fillet: int = 11
    #: flank to middle of the tooth
    thickness: int = 4
    #: middle of the tooth's foot to the rim's inner face
    rim: int = 3
    #: toe to heel
    face: int = 35
    #: on a broken tip edge
    edge: int = 1


@dataclass(frozen=True)
class Focus:
    """A contact ellipse on a flank, in the flank's coordinates s (form point to tip) and t (toe to heel), both 0 .. 1."""

    #: s of the centre
    s: float
    #: t of the centre
    t: float
    #: ds/dt of the line through the middles of the chords of constant t
    slope: float
    #: half the chord through the centre along s
    half_s: float
    #: half the extent along t
    half_t: float
    #: smaller semi-axis over half the tooth's thickness
    half_depth: float
    #: wanted elements over each half; 0 for as many as the numbers of cells allow
    cells: int = 8
    #: second derivative, mm, in t of the flank's height over its tangent plane, along the ellipse
    bow: float = 0.0


@dataclass(frozen=True)
class CoarsestLines:
    """Limits of the coarseness of lines over a contact ellipse."""

    #: least number of elements over each semi-axis
    over: float
    #: least number of elements into the tooth over the smaller semi-axis
    inwards: float
    #: largest distance, mm, of an element's edge along the ellipse from the flank
    sag: float


@dataclass(frozen=True)
class HexGrid:
    """Lines of a whole member."""

    #: stations (T + 1,)
    t: Array
    #: lines of the tooth on +x
    lines: Lines
    #: places (F + 1,), from form point to tip, of the other teeth's lines; all else is shared
    others: Array
    #: places (F + 1,) or (F + 1, T + 1) of teeth with lines of their own, by the tooth's place
    own: Mapping[int, Array] = field(default_factory=dict)
    #: running polar angle, rad, of the middle of a thread's arc (see `layers`)
    centre: float = 0.0


def plain_grid(cells: Cells) -> HexGrid:
    """Return evenly spaced lines."""
    flank = uniform(cells.flank)
    lines = Lines(cells.fillet, flank, cells.edge, uniform(cells.thickness), uniform(cells.rim))
    return HexGrid(uniform(cells.face), lines, flank)


def focused_grid(
    cells: Cells,
    focus: Focus,
    near: Mapping[int, Focus] | None = None,
    wanted: CoarsestLines | None = None,
    shared: Array | None = None,
) -> HexGrid:
    """Return lines that are dense around a contact ellipse.

    - cells: numbers of cells.
    - focus: ellipse on the tooth on +x. If it wants elements, the numbers along the face, across the flank and through the
      tooth follow from them, and `cells` holds elsewhere. If not, lines are as dense at the ellipse as `cells` allows.
    - near: ellipses on other teeth by place; lines across their flanks are dense around them.
    - wanted: limits of the coarseness; where `cells` is too coarse, lines are added, and stations along the face given up.
    - shared: rising stations (K,) of the mating tooth around the ellipse, which this tooth takes over.
    """
    sizes = [
        (focus.half_t, focus.half_t, focus.t, cells.face),
        (focus.half_s, focus.half_s, focus.s, cells.flank),
        (0.5 * focus.half_depth, focus.half_depth, 0.0, cells.thickness),
    ]
    # given numbers of cells; None where the spacing decides
    fixed: list[int | None] = [None if focus.cells else count for _, _, _, count in sizes]
    if focus.cells:
        spacings = [Spacing(width, half / focus.cells, CELL_GROWTH) for width, half, _, _ in sizes]
    else:
        spacings = [
            Spacing.of(width, count, float(np.clip(place, 0.0, 1.0)), CELL_GROWTH) for width, _, place, count in sizes
        ]
        if wanted is not None:
            spacings, fixed = _refine_spacings(wanted, focus, spacings, fixed)
    (along, across, inwards), (stations, rows, layers) = spacings, fixed
    t = along.nodes(stations or max(along.cells(focus.t), LEAST_CELLS), focus.t)
    if shared is not None and len(shared) > 1:
        before, after = (0.5 * float(shared[k + 1] - shared[k]) for k in (0, -2))
        t = np.concatenate((t[t < shared[0] - before], shared, t[t > shared[-1] + after]))
    centre = _middle(focus, t)
    flank = across.nodes(rows or max(across.cells(centre), LEAST_CELLS), centre)
    thickness = inwards.nodes(layers or max(inwards.cells(0.0), LEAST_CELLS))
    own, count = {}, len(flank) - 1
    for place, near_focus in (near or {}).items():
        # all teeth have the same number of lines
        spacing = Spacing.of(near_focus.half_s, count, float(np.clip(near_focus.s, 0.0, 1.0)), CELL_GROWTH)
        own[place] = spacing.nodes(count, _middle(near_focus, t))
    return HexGrid(t, Lines(cells.fillet, flank, cells.edge, thickness, uniform(cells.rim)), uniform(cells.flank), own)


def _middle(focus: Focus, t: Array) -> Array:
    """Return the middles (T + 1,) of the dense lines, from form point to tip, at stations t (T + 1,)."""
    reach = FOLLOWED_SEMI_AXES * focus.half_t
    # the dense lines stay on the flank: if some left it, all others would shift
    margin = min(focus.half_s, 0.5)
    middle: Array = np.clip(focus.s + focus.slope * np.clip(t - focus.t, -reach, reach), margin, 1.0 - margin)
    return middle


def longest_cell(focus: Focus, sag: float) -> float:
    """Return the longest cell in t whose edge is within `sag`, mm, of the flank at the ellipse; inf for a straight flank."""
    return float(np.sqrt(8.0 * sag / focus.bow)) if focus.bow > 0.0 else np.inf


def _refine_spacings(
    wanted: CoarsestLines, focus: Focus, spacings: list[Spacing], fixed: list[int | None]
) -> tuple[list[Spacing], list[int | None]]:
    """Return the spacings along, across and inwards, made finer where too coarse, and the numbers of cells that still hold."""
    finest = (
        min(focus.half_t / wanted.over, longest_cell(focus, wanted.sag)),
        focus.half_s / wanted.over,
        focus.half_depth / wanted.inwards,
    )
    needed = [replace(spacing, finest=size) for spacing, size in zip(spacings, finest, strict=True)]
    needed[2] = replace(needed[2], width=focus.half_depth)
    coarse = [
        ENOUGH_LINES_SHARE * spacing.finest > size for spacing, size in zip(spacings[:2], finest[:2], strict=True)
    ]
    # number of layers within the ellipse's depth
    layers = spacings[2].nodes(fixed[2] or LEAST_CELLS)
    coarse.append(
        bool(np.interp(focus.half_depth, layers, np.arange(len(layers))) < ENOUGH_LAYERS_SHARE * wanted.inwards)
    )
    if not any(coarse):
        return spacings, fixed
    stations = max(needed[0].cells(focus.t), LEAST_STATIONS)
    if not coarse[0]:
        stations = min(stations, fixed[0] or stations)
    fitting = [finer if rough else as_were for finer, rough, as_were in zip(needed, coarse, spacings, strict=True)]
    along = Spacing.of(focus.half_t, stations, float(np.clip(focus.t, 0.0, 1.0)), CELL_GROWTH)
    counts = [None if rough else count for rough, count in zip(coarse, fixed, strict=True)]
    return [along, *fitting[1:]], [stations, *counts[1:]]


def on_breaks(tooth: Tooth, grid: HexGrid) -> HexGrid:
    """Return the grid with the nearest line moved to each seam of the flanks and to each station where they are not smooth."""
    seams = distinct(
        np.concatenate(
            [breaks(tooth.chain[FLANK_REGIONS[Side.RIGHT]]), 1.0 - breaks(tooth.chain[FLANK_REGIONS[Side.LEFT]])]
        ).round(12)
    )
    if not (seams.size or tooth.face_breaks.size):
        return grid
    lines = replace(grid.lines, flank=_snap(grid.lines.flank, seams))
    others = lines.flank if grid.others is grid.lines.flank else _snap(grid.others, seams)
    own = {place: _snap(nodes, seams) for place, nodes in grid.own.items()}
    t = grid.t if tooth.screw is not None else _snap(grid.t, tooth.face_breaks)
    return HexGrid(t, lines, others, own, grid.centre)


def on_stations(grid: HexGrid, places: Array) -> HexGrid:
    """Return the grid with the nearest station moved to each of the places (K,) inside 0 .. 1."""
    return replace(grid, t=_snap(grid.t, places))


def with_stations(grid: HexGrid, places: Array) -> HexGrid:
    """Return the grid with a station at each of the places (K,): the nearest one moved, or a new one if that is taken."""
    moved = on_stations(grid, places)
    missing = [place for place in places if np.abs(moved.t - place).min() > SAME_STATION]
    t = np.sort(np.concatenate((moved.t, missing)))

    def at(lines: Array) -> Array:
        """Return lines (F + 1,) or (F + 1, T) at the new stations."""
        return lines if lines.ndim == 1 else np.array([np.interp(t, moved.t, line) for line in lines])

    lines, others = replace(moved.lines, flank=at(moved.lines.flank)), at(moved.others)
    others = lines.flank if moved.others is moved.lines.flank else others
    return HexGrid(t, lines, others, {place: at(nodes) for place, nodes in moved.own.items()}, grid.centre)


def _snap(places: Array, wanted: Array) -> Array:
    """Return places (N,) or (N, T), rising, with the nearest moved to each of `wanted`; none twice, and never an end.

    Places that are wanted stay, so that a second call changes nothing.
    """
    moved = places.copy().reshape(len(places), -1)
    taken = np.zeros(moved.shape, dtype=bool)
    taken[[0, -1]] = True
    columns = np.arange(moved.shape[1])
    there = np.abs(moved - np.reshape(wanted, (-1, 1, 1))) <= SAME_STATION
    taken |= there.any(axis=0)
    present_at = np.asarray(there.any(axis=1))
    for place, present in zip(wanted, present_at, strict=True):
        k = np.where(taken, np.inf, np.abs(moved - place)).argmin(axis=0)
        # a place may only move between its neighbours
        inner = np.clip(k, 1, len(moved) - 2)
        fits = ~present & (k == inner) & (moved[inner - 1, columns] < place) & (place < moved[inner + 1, columns])
        moved[inner[fits], columns[fits]] = place
        taken[inner[fits], columns[fits]] = True
    return moved.reshape(places.shape)


def halve(grid: HexGrid) -> HexGrid:
    """Return the grid with each cell halved in all directions."""
    lines = grid.lines
    fine = Lines(
        2 * lines.root,
        _with_middles(lines.flank),
        2 * lines.edge,
        _with_middles(lines.thickness),
        _with_middles(lines.rim),
        lines.land,
        2 * lines.round,
        halved=True,
    )
    if fine.flank.ndim == 2:
        fine = replace(fine, flank=_with_middles(fine.flank.T).T)
    own = {place: _with_middles(nodes) for place, nodes in grid.own.items()}
    own = {place: _with_middles(nodes.T).T if nodes.ndim == 2 else nodes for place, nodes in own.items()}
    return HexGrid(_with_middles(grid.t), fine, _with_middles(grid.others), own, grid.centre)


def _with_middles(places: Array) -> Array:
    """Return places with the middles between them."""
    result = np.empty((2 * len(places) - 1, *places.shape[1:]))
    result[::2], result[1::2] = places, 0.5 * (places[1:] + places[:-1])
    return result


def hex_mesh(
    tooth: Tooth, teeth: Index, grid: HexGrid, rim: float | None = None, *, second_order: bool = False
) -> HexMesh:
    """Return the hexahedra of some neighbouring teeth, in the member's own frame, mm.

    - teeth: places (K,) of the teeth, rising; 0 is the tooth on +x.
    - grid: lines.
    - rim: thickness, mm, of the rim under the root land; by default RIM_WHOLE_DEPTHS whole depths of the middle section, or
      less if the body is thinner.
    - second_order: True for mid-side nodes.

    There are face sets, and node sets of the same names:

    - flank_right_k, flank_left_k, fillet_right_k, fillet_left_k of tooth k (from 1).
    - root, land, edge (if broken).
    - rim (inner face), bore (if the rim reaches it), toe, heel.
    - cut_right and cut_left, unless all teeth are meshed.

    Element sets are tooth_k.

    Raises TrimError for a tooth that cannot be trimmed, DesignError for a rim that does not fit, and for a member of one tooth.
    """
    return toothed_rim(tooth, teeth, grid, rim, second_order=second_order).mesh


@dataclass(frozen=True)
class ToothedRim:
    """Hexahedra of teeth and rim, and the nodes on the rim's inner face for a body to join."""

    #: the hexahedra
    mesh: HexMesh
    #: node numbers (S, J) on the inner face by station and growing polar angle; -1 where second-order elements have no node
    inner: Index
    #: their places (S, J, 3), mm
    points: Array
    #: True if the nodes go around the axis: the first follows the last
    closed: bool
    #: number of spaces between nodes in an element
    step: int


def toothed_rim(
    tooth: Tooth, teeth: Index, grid: HexGrid, rim: float | None = None, *, second_order: bool = False
) -> ToothedRim:
    """Return the hexahedra of `hex_mesh`, with the nodes of the rim's inner face."""
    if tooth.teeth < 2 and tooth.screw is None:
        reason = "hexahedra of a tooth end between it and its neighbours"
        raise DesignError("teeth", tooth.teeth, reason=reason, allowed="at least 2")
    grid = on_breaks(tooth, grid)
    coarse = layers(tooth, grid.t, grid.centre)
    grid = replace(grid, lines=replace(grid.lines, round=lines_round(coarse, grid.lines)))
    fine = halve(grid) if second_order else grid
    sections = layers(tooth, fine.t, fine.centre) if second_order else coarse
    tooth = sections.tooth
    chart, inner = rim_of(sections, rim)
    leading = tooth_lattice(sections, fine.lines, chart, inner)
    other = leading
    if len(teeth) > 1 and fine.others is not fine.lines.flank:
        other = tooth_lattice(sections, replace(fine.lines, flank=fine.others), chart, inner)
    rho_inner = tooth.joint.radius(leading[0].lower[0, -1])
    reaches_bore = bool(np.allclose(rho_inner, tooth.blank.body.bore_radius, rtol=0.0, atol=1e-9))
    step = 2 if second_order else 1
    edges = 0 if tooth.tip_edge is None else fine.lines.edge // step
    lattices = {place: other if place else leading for place in teeth.tolist()} | {
        place: tooth_lattice(sections, replace(fine.lines, flank=fine.own[place]), chart, inner)
        for place in sorted(fine.own.keys() & {*teeth.tolist()})
    }
    closed = tooth.screw is None and len(teeth) == tooth.joint.cycle(tooth.teeth)
    ends = end_names(tooth.blank.axial)
    layout = _Layout([lattices[place] for place in teeth.tolist()], closed, step, edges, ends)
    return layout.mesh(sections.places(teeth), reaches_bore)


def rim_of(sections: Layers, rim: float | None) -> tuple[Chart, Array]:
    """Return the chart of the sections, and the height u (T,), mm, of the rim's inner face in them.

    Raises DesignError for a rim thicker than the body.
    """
    base = sections.base
    if rim is not None and rim > base.room.max() * (1.0 + 1e-9):
        raise DesignError(
            "rim",
            rim,
            unit="mm",
            must_be=Allowed.at_most(float(base.room.max()), "mm", note=", the depth of the body under the teeth"),
        )
    wanted = _usual(base) if rim is None else rim
    return base.chart, base.root - np.minimum(wanted, base.room)


def usual_rim(tooth: Tooth, t: Array) -> float:
    """Return the default thickness of the rim, mm, for stations t (T,)."""
    return _usual(layers(tooth, t).base)


def _usual(base: Base) -> float:
    """Return the default thickness of the rim, mm."""
    return min(RIM_WHOLE_DEPTHS * _depth(base), float(base.room.max()))


def _depth(base: Base) -> float:
    """Return the whole depth, mm, of the middle section."""
    return float((base.tip - base.root)[len(base.root) // 2])


def whole_rim(tooth: Tooth, t: Array) -> float:
    """Return the thickest possible rim, mm, at stations t (T,): down to the bore, if there is one."""
    return float(layers(tooth, t).base.room.max())


def whole_depth(tooth: Tooth, t: Array) -> float:
    """Return the depth, mm, from root to tip at the middle of stations t (T,)."""
    return _depth(layers(tooth, t).base)


def least_room(tooth: Tooth, t: Array) -> float:
    """Return the least depth, mm, of the body under the root at stations t (T,)."""
    return float(layers(tooth, t).base.room.min())


class _Layout:
    """Numbering of the nodes of several neighbouring teeth, and the elements and faces between them."""

    def __init__(
        self,
        teeth: list[tuple[HalfLattice, HalfLattice]],
        closed: bool,
        step: int,
        edges: int,
        ends: tuple[str, str],
    ) -> None:
        self._teeth, self._closed, self._step, self._edges, self._ends = teeth, closed, step, edges, ends
        lower, upper = teeth[0][0].lower, teeth[0][0].upper
        self._rows, self._columns, self._layers = lower.shape[:3]
        self._across = upper.shape[1]
        cuts = len(teeth) + (0 if closed else 1)
        self._count = cuts * self._columns
        self._cuts = np.arange(self._count).reshape(cuts, self._columns)
        self._blocks = [self._tooth(k) for k in range(len(teeth))]

    def _fresh(self, *shape: int) -> Index:
        """Return new section node numbers of a shape."""
        first, self._count = self._count, self._count + int(np.prod(shape))
        return np.arange(first, self._count).reshape(shape)

    def _tooth(self, k: int) -> dict[tuple[Side, str], Index]:
        """Return the section node numbers of the blocks of a tooth, "lower", "upper" and "cap" of either side; some are shared."""
        rows, columns, across = self._rows, self._columns, self._across
        high = self._teeth[k][0].upper.shape[0]
        right = np.concatenate((self._cuts[None, k], self._fresh(rows - 1, columns)))
        right_upper = np.concatenate((right[-1:, :across], self._fresh(high - 1, across)))
        left = np.concatenate((self._cuts[None, (k + 1) % len(self._cuts)], self._fresh(rows - 2, columns), right[-1:]))
        left[-1, : across - 1] = self._fresh(across - 1)
        left_upper = np.concatenate(
            (left[-1:, :across], np.concatenate((self._fresh(high - 1, across - 1), right_upper[1:, -1:]), 1))
        )
        blocks = {
            (Side.RIGHT, "lower"): right,
            (Side.RIGHT, "upper"): right_upper,
            (Side.LEFT, "lower"): left,
            (Side.LEFT, "upper"): left_upper,
        }
        cap = self._teeth[k][0].cap
        if cap is None:
            return blocks
        along, inwards = cap.shape[0], cap.shape[1] - 1
        right_cap, left_cap = np.empty((2, along, inwards + 1), dtype=np.int64)
        for side, block in ((right_upper, right_cap), (left_upper, left_cap)):
            block[0], block[:, -1] = side[-1, : inwards + 1], side[-1, inwards:]
        right_cap[1:, :-1] = self._fresh(along - 1, inwards)
        left_cap[1:-1, :-1] = self._fresh(along - 2, inwards)
        left_cap[-1, :-1] = right_cap[-1, :-1]
        return {**blocks, (Side.RIGHT, "cap"): right_cap, (Side.LEFT, "cap"): left_cap}

    def mesh(self, places: Rigid, bore: bool) -> ToothedRim:
        """Return the mesh of the teeth moved to `places` (K,); `bore`: True if the rim's inner face is the bore."""
        rotation, way = (
            np.broadcast_to(v, (len(self._teeth), *v.shape[-n:]))
            for v, n in ((places.rotation, 2), (places.translation, 1))
        )
        nodes = np.empty((self._layers, self._count, 3))
        elements, element_sets = [], {}
        parts: dict[str, list[Index]] = {}
        count = 0
        for k, blocks in enumerate(self._blocks):
            first = count
            for (side, part), block in blocks.items():
                lattice = getattr(self._teeth[k][side is Side.LEFT], part)
                there = np.einsum("ij,sdtj->tsdi", rotation[k], lattice).reshape(self._layers, -1, 3)
                nodes[:, block.ravel()] = there + way[k] if way.any() else there
                elements.append(self._elements(block, side))
                shape = tuple((n - 1) // self._step for n in (*block.shape, self._layers))
                numbers = (count + np.arange(len(elements[-1]))).reshape(shape)
                for key, faces in self._faces(k, side, part, numbers).items():
                    parts.setdefault(key, []).append(faces)
                count += len(elements[-1])
            element_sets[f"tooth_{k + 1}"] = np.arange(first, count)
        face_sets = {key: np.concatenate(faces) for key, faces in parts.items()}
        if bore:
            face_sets["bore"] = face_sets["rim"]
        table = np.concatenate(elements)
        numbers = np.full(nodes.shape[:2], -1).ravel()
        numbers[table] = 0
        used = np.flatnonzero(numbers == 0)
        numbers[used] = np.arange(len(used))
        mesh = HexMesh(nodes.reshape(-1, 3)[used], numbers[table], {}, element_sets, face_sets)
        mesh = replace(mesh, node_sets={name: mesh.face_nodes(name) for name in face_sets})
        inner = self._inner_line()
        return ToothedRim(mesh, numbers.reshape(nodes.shape[:2])[:, inner], nodes[:, inner], self._closed, self._step)

    def _inner_line(self) -> Index:
        """Return the section node numbers (J,) along the rim's inner face, with growing polar angle."""
        halves = [
            half
            for blocks in self._blocks
            for half in (blocks[Side.RIGHT, "lower"][:-1, -1], blocks[Side.LEFT, "lower"][:0:-1, -1])
        ]
        return np.concatenate(halves if self._closed else (*halves, self._blocks[-1][Side.LEFT, "lower"][:1, -1]))

    def _elements(self, block: Index, side: Side) -> Index:
        """Return the elements (E, 8 or 20) of a block, s slowest, then d, then t; node numbers count layer by layer."""
        step = self._step
        corners = step * np.array(_ELEMENT_CORNERS[side])
        offsets = corners if step == 1 else np.concatenate((corners, corners[np.array(HEX_EDGES)].sum(axis=1) // 2))
        s, d, t = np.meshgrid(*(np.arange(0, n - 1, step) for n in (*block.shape, self._layers)), indexing="ij")
        node = block[s[..., None] + offsets[:, 0], d[..., None] + offsets[:, 1]]
        elements: Index = ((t[..., None] + offsets[:, 2]) * self._count + node).reshape(-1, len(offsets))
        return elements

    def _faces(self, k: int, side: Side, part: str, numbers: Index) -> dict[str, Index]:
        """Return the face sets (n, 2) of a block with elements `numbers` (S, D, T), in the order of `_elements`."""
        outer, inner, first, last = _BLOCK_FACES[side]

        def faces(which: Index, face: int) -> Index:
            return np.stack((which.ravel(), np.full(which.size, face)), axis=1)

        first_end, last_end = self._ends
        sets = {first_end: faces(numbers[:, :, 0], 0), last_end: faces(numbers[:, :, -1], 1)}
        if part == "upper":
            flank = len(numbers) - self._edges
            sets[f"flank_{side}_{k + 1}"] = faces(numbers[:flank, 0], outer)
            sets["edge"] = faces(numbers[flank:, 0], outer)
            if self._teeth[k][0].cap is None:
                sets["land"] = faces(numbers[-1], last)
        elif part == "cap":
            sets["land"] = faces(numbers[:, 0], outer)
        else:
            root = self._teeth[k][side is Side.LEFT].root_cells[:: self._step]
            sets["root"] = faces(numbers[root, 0], outer)
            sets[f"fillet_{side}_{k + 1}"] = faces(numbers[~root, 0], outer)
            sets["rim"] = faces(numbers[:, -1], inner)
            if not self._closed and k == (0 if side is Side.RIGHT else len(self._teeth) - 1):
                sets[f"cut_{side}"] = faces(numbers[0], first)
        return {name: value for name, value in sets.items() if len(value)}


#: corners of an element in steps (s, d, t); elements of the left half have the other sense, because it mirrors the right half
_ELEMENT_CORNERS = {
    Side.RIGHT: [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
    Side.LEFT: [(0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0), (0, 0, 1), (0, 1, 1), (1, 1, 1), (1, 0, 1)],
}
#: faces, as indices in `HEX_FACES`, on the outline, on the last line d, on the first line s and on the last line s
_BLOCK_FACES = {Side.RIGHT: (2, 4, 5, 3), Side.LEFT: (5, 3, 2, 4)}
