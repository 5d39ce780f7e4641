"""Structured hexahedra of some or all teeth of a member, with the rim under them and named sets.

The quadrilaterals of the sections (`section_lattice`) are joined from toe to heel. Halves of a tooth share the nodes on
its middle, neighbouring teeth those of the radial cut between them. A second-order mesh is the lattice of half the cell
size with its mid-side nodes kept, so that those of the flanks lie on the exact surface too.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.errors import DesignError
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.hexahedra.grading import Spacing, uniform
from gearmesh.mesh.hexahedra.hexes import HEX_EDGES, HexMesh
from gearmesh.mesh.hexahedra.layers import Base, Chart, Layers, layers
from gearmesh.mesh.hexahedra.section_lattice import HalfLattice, Lines, tooth_lattice
from gearmesh.teeth.blank.body import end_names
from gearmesh.teeth.region import FLANKS, Side
from gearmesh.teeth.section import breaks
from gearmesh.teeth.tooth import Tooth

#: rim under the root over the whole depth of the teeth
RIM_DEPTH = 1.2
#: growth of cell sizes away from the contact, per unit of distance
GROWTH = 0.4
#: least numbers of cells along, across and through where they follow from a contact ellipse
LEAST_CELLS = 6
#: share of the elements wanted over a contact ellipse that does, and below which lines are added: their slant takes some, too
NEARLY, ENOUGH = 0.95, 0.98
#: stations that are given up for lines that follow a contact ellipse leave as many as these
LEAST_STATIONS = 24
#: beyond this many semi-axes the fine lines no longer follow the slant of the ellipse
FOLLOWED = 1.5

Index = NDArray[np.int64]


@dataclass(frozen=True)
class Cells:
    """Numbers of cells: form point to tip, middle of root land to form point, flank to middle of the tooth, from there to the
    rim's inner face, toe to heel, and on a broken tip edge.

    The defaults give a pair with three teeth each 72,660 elements; [LF04] 17.10 has 71,460.
    """

    flank: int = 24
    fillet: int = 11
    thickness: int = 4
    rim: int = 3
    face: int = 35
    edge: int = 1


@dataclass(frozen=True)
class Focus:
    """A contact ellipse on a flank, in the flank's coordinates s (form point to tip) and t (toe to heel), both 0 .. 1.

    `s`, `t`: its centre; `slope`: ds/dt of the line through the middles of its chords of constant t; `half_s`: half its
    chord through the centre along s; `half_t`: half its extent along t; `half_depth`: its smaller semi-axis over half the
    tooth's thickness there; `cells`: elements wanted over each half, 0 for what the numbers of elements allow; `bow`: second
    derivative (mm) in t of the flank's height over the plane that touches it there, along the ellipse.
    """

    s: float
    t: float
    slope: float
    half_s: float
    half_t: float
    half_depth: float
    cells: int = 8
    bow: float = 0.0


@dataclass(frozen=True)
class CoarsestLines:
    """The coarsest lines over a contact ellipse that will do, whatever the numbers of elements.

    `over`: elements over each semi-axis; `inwards`: over the smaller semi-axis, into the tooth; `sag` (mm): of an element's edge
    along the ellipse from the flank.
    """

    over: float
    inwards: float
    sag: float


@dataclass(frozen=True)
class HexGrid:
    """Where the lines of a whole member run: `t` (T + 1,) stations, `lines` of the tooth on +x.

    `others` (F + 1,): places of the other teeth's lines from form point to tip; they share all else. `own` (F + 1,) or (F + 1, T
    + 1):
    those of some other teeth that have lines of their own, by the tooth's place. `centre`: running polar angle (rad) of the middle
    of the arc of threads (`layers`).
    """

    t: Array
    lines: Lines
    others: Array
    own: Mapping[int, Array] = field(default_factory=dict)
    centre: float = 0.0


def plain_grid(cells: Cells) -> HexGrid:
    """Evenly spaced lines."""
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
    """Lines that crowd round a contact ellipse on the tooth on +x, and across the flanks round those on teeth at places `near` it.

    With `focus.cells` elements wanted over each half of it, their numbers along the face, across the flank and through the
    tooth follow from that, and those of `cells` hold elsewhere; with 0 wanted, they are as fine there as all the numbers of
    `cells` allow, or, where that is too coarse for what is `wanted`, as many more as it takes, and fewer along the face.
    `shared` (K,): rising stations that the mating tooth has about the ellipse, and which are this one's there.
    """
    sizes = [
        (focus.half_t, focus.half_t, focus.t, cells.face),
        (focus.half_s, focus.half_s, focus.s, cells.flank),
        (0.5 * focus.half_depth, focus.half_depth, 0.0, cells.thickness),
    ]
    # numbers of cells that hold whatever the spacing takes
    fixed: list[int | None] = [None if focus.cells else count for _, _, _, count in sizes]
    if focus.cells:
        spacings = [Spacing(width, half / focus.cells, GROWTH) for width, half, _, _ in sizes]
    else:
        spacings = [
            Spacing.of(width, count, float(np.clip(place, 0.0, 1.0)), GROWTH) for width, _, place, count in sizes
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
        # all teeth have as many lines
        spacing = Spacing.of(near_focus.half_s, count, float(np.clip(near_focus.s, 0.0, 1.0)), GROWTH)
        own[place] = spacing.nodes(count, _middle(near_focus, t))
    return HexGrid(t, Lines(cells.fillet, flank, cells.edge, thickness, uniform(cells.rim)), uniform(cells.flank), own)


def _middle(focus: Focus, t: Array) -> Array:
    """Middle (T + 1,) of the fine lines, from form point to tip, at stations t (T + 1,)."""
    reach = FOLLOWED * focus.half_t
    # the fine lines stay on the flank: if some left it, all others would shift to fill their places
    margin = min(focus.half_s, 0.5)
    middle: Array = np.clip(focus.s + focus.slope * np.clip(t - focus.t, -reach, reach), margin, 1.0 - margin)
    return middle


def longest_cell(focus: Focus, sag: float) -> float:
    """The longest cell in t whose edge is no further than `sag` (mm) from the flank at the ellipse, infinite for a straight one."""
    return float(np.sqrt(8.0 * sag / focus.bow)) if focus.bow > 0.0 else np.inf


def _refine_spacings(
    wanted: CoarsestLines, focus: Focus, spacings: list[Spacing], fixed: list[int | None]
) -> tuple[list[Spacing], list[int | None]]:
    """Spacings along, across and inwards with those that are too coarse made finer, and the numbers of cells that still hold."""
    finest = (
        min(focus.half_t / wanted.over, longest_cell(focus, wanted.sag)),
        focus.half_s / wanted.over,
        focus.half_depth / wanted.inwards,
    )
    needed = [replace(spacing, finest=size) for spacing, size in zip(spacings, finest, strict=True)]
    needed[2] = replace(needed[2], width=focus.half_depth)
    coarse = [ENOUGH * spacing.finest > size for spacing, size in zip(spacings[:2], finest[:2], strict=True)]
    # layers beyond the ellipse's depth grow, the first of them may end there
    layers = spacings[2].nodes(fixed[2] or LEAST_CELLS)
    coarse.append(bool(np.interp(focus.half_depth, layers, np.arange(len(layers))) < NEARLY * wanted.inwards))
    if not any(coarse):
        return spacings, fixed
    stations = max(needed[0].cells(focus.t), LEAST_STATIONS)
    if not coarse[0]:
        stations = min(stations, fixed[0] or stations)
    fitting = [finer if rough else as_were for finer, rough, as_were in zip(needed, coarse, spacings, strict=True)]
    along = Spacing.of(focus.half_t, stations, float(np.clip(focus.t, 0.0, 1.0)), GROWTH)
    counts = [None if rough else count for rough, count in zip(coarse, fixed, strict=True)]
    return [along, *fitting[1:]], [stations, *counts[1:]]


def on_breaks(tooth: Tooth, grid: HexGrid) -> HexGrid:
    """The grid with a line on every seam of the flanks and on every station where they are not smooth: the nearest goes there."""
    seams = np.unique(
        np.concatenate([breaks(tooth.chain[FLANKS[Side.RIGHT]]), 1.0 - breaks(tooth.chain[FLANKS[Side.LEFT]])]).round(
            12
        )
    )
    if not (seams.size or tooth.face_breaks.size):
        return grid
    lines = replace(grid.lines, flank=_snap(grid.lines.flank, seams))
    others = lines.flank if grid.others is grid.lines.flank else _snap(grid.others, seams)
    own = {place: _snap(nodes, seams) for place, nodes in grid.own.items()}
    t = grid.t if tooth.screw is not None else _snap(grid.t, tooth.face_breaks)
    return HexGrid(t, lines, others, own, grid.centre)


def on_stations(grid: HexGrid, places: Array) -> HexGrid:
    """The grid with a station at each of some places (K,), 0 .. 1, inside: the nearest goes there."""
    return replace(grid, t=_snap(grid.t, places))


def with_stations(grid: HexGrid, places: Array) -> HexGrid:
    """The grid with a station at each of some places (K,), 0 .. 1: the nearest, or where that is taken a new one."""
    moved = on_stations(grid, places)
    missing = [place for place in places if np.abs(moved.t - place).min() > 1e-12]
    t = np.sort(np.concatenate((moved.t, missing)))

    def at(lines: Array) -> Array:
        """Lines (F + 1,) or (F + 1, T) at the new stations."""
        return lines if lines.ndim == 1 else np.array([np.interp(t, moved.t, line) for line in lines])

    lines, others = replace(moved.lines, flank=at(moved.lines.flank)), at(moved.others)
    others = lines.flank if moved.others is moved.lines.flank else others
    return HexGrid(t, lines, others, {place: at(nodes) for place, nodes in moved.own.items()}, grid.centre)


def _snap(places: Array, wanted: Array) -> Array:
    """Places (N,) or (N, T), ascending, the nearest to each of `wanted` put there, none of them twice and neither end."""
    moved = places.copy().reshape(len(places), -1)
    taken = np.zeros(moved.shape, dtype=bool)
    taken[[0, -1]] = True
    columns = np.arange(moved.shape[1])
    for place in wanted:
        k = np.where(taken, np.inf, np.abs(moved - place)).argmin(axis=0)
        # only between its neighbours
        inner = np.clip(k, 1, len(moved) - 2)
        fits = (k == inner) & (moved[inner - 1, columns] < place) & (place < moved[inner + 1, columns])
        moved[inner[fits], columns[fits]] = place
        taken[inner[fits], columns[fits]] = True
    return moved.reshape(places.shape)


def halve(grid: HexGrid) -> HexGrid:
    """The grid with every cell cut in two each way."""
    lines = grid.lines
    fine = Lines(
        2 * lines.root,
        _with_middles(lines.flank),
        2 * lines.edge,
        _with_middles(lines.thickness),
        _with_middles(lines.rim),
        lines.land,
        halved=True,
    )
    if fine.flank.ndim == 2:
        fine = replace(fine, flank=_with_middles(fine.flank.T).T)
    own = {place: _with_middles(nodes) for place, nodes in grid.own.items()}
    own = {place: _with_middles(nodes.T).T if nodes.ndim == 2 else nodes for place, nodes in own.items()}
    return HexGrid(_with_middles(grid.t), fine, _with_middles(grid.others), own, grid.centre)


def _with_middles(places: Array) -> Array:
    result = np.empty((2 * len(places) - 1, *places.shape[1:]))
    result[::2], result[1::2] = places, 0.5 * (places[1:] + places[:-1])
    return result


def hex_mesh(
    tooth: Tooth, teeth: Index, grid: HexGrid, rim: float | None = None, *, second_order: bool = False
) -> HexMesh:
    """Hexahedra of the teeth at the places `teeth` (K,), neighbours in rising order (0 is the tooth on +x), own frame, mm.

    `rim`: thickness, mm, of the rim under the root land, default `RIM_DEPTH` whole depths of the middle section, less
    where the body is thinner. Face sets, and node sets of the same names: flank_right_k, flank_left_k, fillet_right_k,
    fillet_left_k of the k-th of the teeth (from 1), root, land, edge (if broken), rim (inner face), bore (the same where the
    rim reaches it), toe, heel, and of fewer than all teeth cut_right and cut_left. Element sets: tooth_k.

    Raises TrimError for a tooth that cannot be trimmed, DesignError for a rim that does not fit, and a member of one tooth.
    """
    return toothed_rim(tooth, teeth, grid, rim, second_order=second_order).mesh


@dataclass(frozen=True)
class ToothedRim:
    """Hexahedra of teeth and rim, and the nodes on the rim's inner face that a body can join.

    `inner` (S, J): their numbers by station and growing polar angle, -1 where elements of second order have none; `points` (S, J,
    3): where they are, mm; `closed`: they go round the axis, the first comes after the last; `step`: how many are to an element.
    """

    mesh: HexMesh
    inner: Index
    points: Array
    closed: bool
    step: int


def toothed_rim(
    tooth: Tooth, teeth: Index, grid: HexGrid, rim: float | None = None, *, second_order: bool = False
) -> ToothedRim:
    """Hexahedra as those of `hex_mesh`, and the nodes of the rim's inner face."""
    if tooth.teeth < 2 and tooth.screw is None:
        reason = "hexahedra of a tooth end between it and its neighbours"
        raise DesignError("teeth", tooth.teeth, reason=reason, allowed="at least 2")
    grid = on_breaks(tooth, grid)
    fine = halve(grid) if second_order else grid
    sections = layers(tooth, fine.t, fine.centre)
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
        for place in np.intersect1d(teeth, list(fine.own)).tolist()
    }
    closed = tooth.screw is None and len(teeth) == tooth.joint.cycle(tooth.teeth)
    ends = end_names(tooth.blank.axial)
    layout = _Layout([lattices[place] for place in teeth.tolist()], closed, step, edges, ends)
    return layout.mesh(sections.places(teeth), reaches_bore)


def rim_of(sections: Layers, rim: float | None) -> tuple[Chart, Array]:
    """Chart of the sections, and the height u (T,), mm, of the rim's inner face in them.

    Raises DesignError for a rim thicker than the body.
    """
    base = sections.base
    if rim is not None and rim > base.room.max() * (1.0 + 1e-9):
        raise DesignError(
            "rim", rim, unit="mm", must_be=f"at most {base.room.max():.6g} mm, the depth of the body under the teeth"
        )
    wanted = _usual(base) if rim is None else rim
    return base.chart, base.root - np.minimum(wanted, base.room)


def usual_rim(tooth: Tooth, t: Array) -> float:
    """The rim, mm, of `RIM_DEPTH` whole depths of the middle of stations t (T,), less where the body has less."""
    return _usual(layers(tooth, t).base)


def _usual(base: Base) -> float:
    return min(RIM_DEPTH * _depth(base), float(base.room.max()))


def _depth(base: Base) -> float:
    return float((base.tip - base.root)[len(base.root) // 2])


def whole_rim(tooth: Tooth, t: Array) -> float:
    """The thickest rim, mm, that the body has under the root at stations t (T,): down to the bore, if there is one."""
    return float(layers(tooth, t).base.room.max())


def whole_depth(tooth: Tooth, t: Array) -> float:
    """Depth (mm) from root to tip in the middle of stations t (T,)."""
    return _depth(layers(tooth, t).base)


def least_room(tooth: Tooth, t: Array) -> float:
    """The least room (mm) that the body has under the root at stations t (T,)."""
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
        first, self._count = self._count, self._count + int(np.prod(shape))
        return np.arange(first, self._count).reshape(shape)

    def _tooth(self, k: int) -> dict[tuple[Side, str], Index]:
        """Section node numbers of the four blocks of a tooth, "lower" and "upper" of either side, with what they share."""
        rows, columns, across = self._rows, self._columns, self._across
        high = self._teeth[k][0].upper.shape[0]
        right = np.concatenate((self._cuts[None, k], self._fresh(rows - 1, columns)))
        right_upper = np.concatenate((right[-1:, :across], self._fresh(high - 1, across)))
        left = np.concatenate((self._cuts[None, (k + 1) % len(self._cuts)], self._fresh(rows - 2, columns), right[-1:]))
        left[-1, : across - 1] = self._fresh(across - 1)
        left_upper = np.concatenate(
            (left[-1:, :across], np.concatenate((self._fresh(high - 1, across - 1), right_upper[1:, -1:]), 1))
        )
        return {
            (Side.RIGHT, "lower"): right,
            (Side.RIGHT, "upper"): right_upper,
            (Side.LEFT, "lower"): left,
            (Side.LEFT, "upper"): left_upper,
        }

    def mesh(self, places: Rigid, bore: bool) -> ToothedRim:
        """The mesh of the teeth moved to `places` (K,); `bore`: the rim's inner face is the bore."""
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
                half = self._teeth[k][side is Side.LEFT]
                lattice = half.upper if part == "upper" else half.lower
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
        used, renumbered = np.unique(np.concatenate(elements), return_inverse=True)
        mesh = HexMesh(nodes.reshape(-1, 3)[used], renumbered.reshape(count, -1), {}, element_sets, face_sets)
        mesh = replace(mesh, node_sets={name: mesh.face_nodes(name) for name in face_sets})
        numbers = np.full(nodes.shape[:2], -1).ravel()
        numbers[used] = np.arange(len(used))
        inner = self._inner_line()
        return ToothedRim(mesh, numbers.reshape(nodes.shape[:2])[:, inner], nodes[:, inner], self._closed, self._step)

    def _inner_line(self) -> Index:
        """Section node numbers (J,) along the rim's inner face, as the polar angle grows."""
        halves = [
            half
            for blocks in self._blocks
            for half in (blocks[Side.RIGHT, "lower"][:-1, -1], blocks[Side.LEFT, "lower"][:0:-1, -1])
        ]
        return np.concatenate(halves if self._closed else (*halves, self._blocks[-1][Side.LEFT, "lower"][:1, -1]))

    def _elements(self, block: Index, side: Side) -> Index:
        """Elements (E, 8 or 20) of a block, s slowest, then d, then t; node numbers count layer by layer."""
        step = self._step
        corners = step * np.array(_CORNERS[side])
        offsets = corners if step == 1 else np.concatenate((corners, corners[np.array(HEX_EDGES)].sum(axis=1) // 2))
        s, d, t = np.meshgrid(*(np.arange(0, n - 1, step) for n in (*block.shape, self._layers)), indexing="ij")
        node = block[s[..., None] + offsets[:, 0], d[..., None] + offsets[:, 1]]
        elements: Index = ((t[..., None] + offsets[:, 2]) * self._count + node).reshape(-1, len(offsets))
        return elements

    def _faces(self, k: int, side: Side, part: str, numbers: Index) -> dict[str, Index]:
        """Face sets (n, 2) of a block whose elements are `numbers` (S, D, T), in the order of `_elements`."""
        outer, inner, first, last = _FACES[side]

        def faces(which: Index, face: int) -> Index:
            return np.stack((which.ravel(), np.full(which.size, face)), axis=1)

        first_end, last_end = self._ends
        sets = {first_end: faces(numbers[:, :, 0], 0), last_end: faces(numbers[:, :, -1], 1)}
        if part == "upper":
            flank = len(numbers) - self._edges
            sets[f"flank_{side}_{k + 1}"] = faces(numbers[:flank, 0], outer)
            sets["edge"] = faces(numbers[flank:, 0], outer)
            sets["land"] = faces(numbers[-1], last)
        else:
            root = self._teeth[k][side is Side.LEFT].root_cells[:: self._step]
            sets["root"] = faces(numbers[root, 0], outer)
            sets[f"fillet_{side}_{k + 1}"] = faces(numbers[~root, 0], outer)
            sets["rim"] = faces(numbers[:, -1], inner)
            if not self._closed and k == (0 if side is Side.RIGHT else len(self._teeth) - 1):
                sets[f"cut_{side}"] = faces(numbers[0], first)
        return {name: value for name, value in sets.items() if len(value)}


#: corners of an element in steps (s, d, t); the left half mirrors the right one, its elements turn the other way
_CORNERS = {
    Side.RIGHT: [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
    Side.LEFT: [(0, 0, 0), (0, 1, 0), (1, 1, 0), (1, 0, 0), (0, 0, 1), (0, 1, 1), (1, 1, 1), (1, 0, 1)],
}
#: faces (of `mesh.HEX_FACES`) on the outline, on the last line d, on the first and on the last line s
_FACES = {Side.RIGHT: (2, 4, 5, 3), Side.LEFT: (5, 3, 2, 4)}
