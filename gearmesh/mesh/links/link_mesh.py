"""Mesh of one link by its plan: nodes, strips of triangles between its lines, and their distances from the surface."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.numeric.grid import on_grid
from gearmesh.mesh.links.collapse import edges_of
from gearmesh.mesh.links.forms import Forms
from gearmesh.mesh.links.lines import STEPS_PER_LINK, between, integral, nodes, rows, stations
from gearmesh.mesh.links.measure import CHORD_SHARES, deviations_of, off_chords
from gearmesh.mesh.links.plan import LinkPlan
from gearmesh.mesh.links.thinning import thin
from gearmesh.mesh.patch import LinkNodes, PatchMesh
from gearmesh.mesh.strip_triangulation import StripTriangulation
from gearmesh.records import dataclass
from gearmesh.teeth.region import Region, Side
from gearmesh.teeth.section import Ends, GeneratedLink, Sections, breaks
from gearmesh.teeth.tooth import Tooth

Index = NDArray[np.int64]

#: function that returns points (N, 3) of a link at s, t (N,), with t = 0 or 1
SectionCurve = Callable[[Array, Array], Array]

#: largest deviation that counts as rounding
ROUNDING_MM = 1e-9
#: grid of the levels in a row of nodes: levels on the same grid point differ by rounding alone
STEPS_PER_ROW = 2.0**30
#: rounds of turning diagonals at first, and after the best diagonals were taken in strips that miss the tolerance
TURNING_ROUNDS = (1, 6)
#: least density of nodes on a section curve, as a share of its largest density
MIN_DENSITY_SHARE = 0.1
#: rounds in which chords of the section curves are cut
MAX_HALVING_ROUNDS = 12


@dataclass(frozen=True)
class LinkLines:
    """Lines of a link and the stations of their nodes."""

    #: s (S + 1,) of the lines
    s: Array
    #: t (N,) of the nodes, line by line
    t: Array
    #: index (S + 2,) in `t` at which each line begins
    begins: Index

    @staticmethod
    def of(plan: LinkPlan, seams: Array, fixed: Array, first: Array, last: Array) -> LinkLines:
        """Return the lines of a plan.

        - seams: s (K,) that must be lines.
        - fixed: stations that are nodes of all inner lines.
        - first, last: stations of the nodes on the first and last line.
        """
        s = nodes(*plan.across, seams)
        if plan.staggered and s.size % 2 == 0:
            # an odd number of lines: both outer lines are not staggered, so the lines alternate
            s = nodes(plan.across[0], plan.across[1] * (s.size - 0.5) / integral(*plan.across)[-1], seams)
        if s.size == 2:
            return LinkLines(s, np.concatenate((first, last)), np.cumsum([0, first.size, last.size]))
        along = rows(plan.along, np.zeros(s.size - 2) if plan.alike else s[1:-1])
        staggered = plan.staggered & (np.arange(1, s.size - 1) % 2 == 1)
        t, begins = stations(along, fixed, staggered)
        return LinkLines(
            s,
            np.concatenate((first, t, last)),
            np.concatenate(([0], first.size + begins, [first.size + t.size + last.size])),
        )

    @property
    def line(self) -> Index:
        """Line (N,) of each node."""
        return np.repeat(np.arange(self.s.size), np.diff(self.begins))


@dataclass(frozen=True)
class LinkMesh:
    """Mesh of a link with the distances of its lines and strips from the surface."""

    #: the mesh
    patch: PatchMesh
    #: s (S + 1,) of the lines
    s: Array
    #: number of cells (S + 1,) on each line
    cells: Array
    #: largest distances (S + 1,), mm, of edges on each line
    lines: Array
    #: largest distances (S,), mm, of triangles in each strip
    strips: Array
    #: largest distance, mm, of edges on the seam of a flank with its fillet from a sharp form point
    form_point: float = 0.0

    @property
    def worst(self) -> float:
        """Largest distance, mm."""
        return max(float(self.lines.max()), float(self.strips.max()))

    def stations(self, s: float) -> Array:
        """Return the stations t of the nodes on the first (s = 0) or last (s = 1) line."""
        nodes = self.patch.nodes
        return nodes.t[nodes.line(s)]


def mesh_link(
    tooth: Tooth,
    region: Region,
    lines: LinkLines,
    trimmed: Sections,
    plan: LinkPlan,
    second: Array,
    tolerance: float,
    before: LinkMesh | None = None,
) -> LinkMesh:
    """Return the mesh of a link on given lines.

    - trimmed: sections, at least at the stations of the first and last line.
    - plan: plan of the link.
    - second: second parameters (S, T) of the surface, as in `Forms`.
    - tolerance: mm; section curves at toe and heel keep it.
    - before: an earlier mesh of the same link, whose results are reused.
    """
    link, count = tooth.chain[region], lines.s.size

    def section_curve(s: Array, t: Array) -> Array:
        """Return points (N, 3) of the section curves at toe and heel."""
        return LinkNodes.of(tooth, region, s, t, trimmed[np.array([0, -1])], between(second, s, t)).points

    # nodes of the lines, then nodes of the section curves between the lines
    ends, missed = _between(section_curve, lines.s, plan.outline, tolerance)
    pieces = [piece for inner in ends for piece in inner]
    at_end = [np.full(sum(piece.size for piece in inner), t) for inner, t in zip(ends, (0.0, 1.0), strict=True)]
    line = np.concatenate((lines.line, np.full(sum(piece.size for piece in pieces), -1)))
    s, t = np.concatenate((lines.s[lines.line], *pieces)), np.concatenate((lines.t, *at_end))
    points = LinkNodes.of(tooth, region, s, t, trimmed, between(second, s, t))
    numbers = [np.arange(low, high) for low, high in pairwise(lines.begins)]
    sizes = np.cumsum([lines.t.size, *(piece.size for piece in pieces)])
    inner = [np.arange(low, high) for low, high in pairwise(sizes)]
    level = on_grid(between(plan.level, s, t), STEPS_PER_ROW)

    def arch(edges: Index) -> Array:
        """Return the heights of arcs over edges (E, 2), mm, without their last digits."""
        return on_grid(points.arch(edges), 1.0 / ROUNDING_MM)

    # strips: the nodes of two neighbouring lines are merged in the order of their levels
    triangulation = StripTriangulation.of(numbers, inner[: count - 1], inner[count - 1 :], level, arch)
    on_break = np.isin(t, tooth.face_breaks)
    held, crease = np.where(on_break, t, 0.0), on_break | np.isin(s, breaks(link)) | (link.surface is None)
    # diagonals turn where that brings triangles closer; strips that still miss the tolerance get the best diagonals
    for turns in TURNING_ROUNDS:
        for _ in range(turns):
            turned = triangulation.flip(arch, held)
            if turned is triangulation:
                break
            triangulation = turned
        triangles, strip = triangulation.triangles()
        edges, side = edges_of(triangles, s.size)
        edge, peaks, normals = deviations_of(points, triangles, edges, side, crease)
        edge, peaks = on_grid(edge, 1.0 / ROUNDING_MM), on_grid(peaks, 1.0 / ROUNDING_MM)
        if peaks.max() <= tolerance or turns == TURNING_ROUNDS[-1]:
            break
        # strips with bad triangles are triangulated anew, except strips with nodes on breaks, whose edges must stay
        bad, fixed = (
            np.bincount(strip[chosen], minlength=count - 1) > 0
            for chosen in (peaks > tolerance, np.any(held[triangles] > 0.0, axis=1))
        )
        triangulation = triangulation.best(arch, t, bad & ~fixed)
    # largest distances of each strip and of each line
    strips, off = np.full(count - 1, ROUNDING_MM), np.full(count, ROUNDING_MM)
    np.maximum.at(strips, strip, peaks)
    on_line = (line[edges[:, 0]] == line[edges[:, 1]]) & (line[edges[:, 0]] >= 0)
    np.maximum.at(off, line[edges[on_line, 0]], edge[on_line])
    # at a sharp form point the seam must be near the exact edge
    form_point = 0.0
    if region.is_flank and isinstance(link, GeneratedLink):
        seam = 0 if link.side is Side.RIGHT else count - 1
        at = lines.t[lines.begins[seam] : lines.begins[seam + 1]]
        if before is not None and np.array_equal(before.stations(float(seam > 0)), at):
            form_point = before.form_point
        else:
            form_point = _form_point_miss(tooth, link, trimmed[np.searchsorted(trimmed.t, at)])
        off[seam] = max(off[seam], form_point)
    deviation = max(float(off.max()), float(strips.max()), missed)
    patch = PatchMesh(points, triangles, normals, deviation)
    return LinkMesh(patch, lines.s, np.diff(lines.begins) - 1.0, off, strips, form_point)


def thin_link(
    tooth: Tooth,
    mesh: LinkMesh,
    trimmed: Sections,
    forms: Forms,
    number: int,
    tolerance: float,
    enough: int,
    *,
    again: bool,
) -> PatchMesh:
    """Return the patch of a link's mesh with fewer triangles within `tolerance`, mm.

    - trimmed: sections, as `mesh_link` takes them.
    - forms: second forms of all links.
    - number: number of the link in the forms.
    - enough: number of triangles at which thinning stops.
    - again: as in `thin`.
    """
    patch, second = mesh.patch, forms.second[number]
    nodes, link = patch.nodes, tooth.chain[patch.region]
    if link.surface is None:
        return patch
    crease = np.isin(nodes.t, tooth.face_breaks) | np.isin(nodes.s, breaks(link))

    def place(s: Array, t: Array) -> LinkNodes:
        """Return nodes at s, t (N,) on the surface."""
        return LinkNodes.of(tooth, patch.region, s, t, trimmed, between(second, s, t))

    link_forms = np.stack([form[number] for form in (forms.length, forms.twist, forms.face)], axis=-1)
    return thin(patch, place, link_forms, forms.outline[number], crease, tolerance, enough, again=again)


def _between(
    curve: SectionCurve, s: Array, outline: Sequence[tuple[Array, Array]], tolerance: float
) -> tuple[list[list[Array]], float]:
    """Return the nodes of the section curves at toe and heel between lines, and the largest distance, mm, of their chords.

    - curve: points of the section curves.
    - s: s (S + 1,) of the lines.
    - outline: cells per unit of s at toe and heel, as pairs (s, density).
    - tolerance: mm; the chords keep it.

    The nodes are two lists, for toe and heel, of S arrays of s.
    """
    # number of cells between two lines: one, or as many as the density of the outline asks for
    totals = [np.interp(s, density[0], integral(*density)) for density in outline]
    cells = np.maximum(1, np.ceil(np.diff(totals) - 1e-9).astype(int))
    # nodes between lines are denser where the curve is bent more
    evens = [
        integral(x, np.maximum(density, MIN_DENSITY_SHARE * density.max() + ROUNDING_MM)) for x, density in outline
    ]
    for _ in range(MAX_HALVING_ROUNDS):
        nodes = [
            _outline_nodes(s, count, even, density) for density, even, count in zip(outline, evens, cells, strict=True)
        ]
        off = _off_curves(curve, nodes)
        worst = np.array(
            [np.maximum.reduceat(away, np.cumsum(count) - count) for away, count in zip(off, cells, strict=True)]
        )
        if not (worst > tolerance).any():
            break
        # the sag of a chord falls with the square of its length; at most twice as many cells per round
        more = np.ceil(cells * np.clip(np.sqrt(worst / tolerance), 1.0, 2.0)).astype(int)
        cells = np.where(worst > tolerance, np.maximum(more, cells + 1), cells)
    inner = [
        [curve_nodes[end - n + 1 : end] for end, n in zip(np.cumsum(count).tolist(), count.tolist(), strict=True)]
        for curve_nodes, count in zip(nodes, cells, strict=True)
    ]
    return inner, float(worst.max())


def _outline_nodes(s: Array, count: Index, even: Array, density: tuple[Array, Array]) -> Array:
    """Return nodes s (N + 1,): each cell between lines s (S + 1,) is cut into `count` (S,) parts with equal cell counts.

    `even`: integral of the cells over the s of the `density`.
    """
    ends = np.interp(s, density[0], even)
    cell = np.repeat(np.arange(count.size), count)
    place = np.arange(cell.size) - (np.cumsum(count) - count)[cell]
    nodes = on_grid(np.interp(place * (np.diff(ends) / count)[cell] + ends[cell], even, density[0]), STEPS_PER_LINK)
    nodes[place == 0] = s[:-1]
    return np.append(nodes, s[-1])


def _off_curves(curve: SectionCurve, nodes: Sequence[Array]) -> list[Array]:
    """Return the largest distances (N,), mm, of the chords between nodes s (N + 1,) from the section curves at toe and heel."""
    step = 1 + CHORD_SHARES.size
    fine = [
        np.append((s[:-1, None] + np.diff(s)[:, None] * np.append(0.0, CHORD_SHARES)).ravel(), s[-1]) for s in nodes
    ]
    t = np.repeat([0.0, 1.0], [s.size for s in fine])
    curves = np.split(curve(np.concatenate(fine), t), [fine[0].size])
    chords = [np.stack((points[:-1:step], points[step::step]), axis=1) for points in curves]
    inner = [points[:-1].reshape(-1, step, 3)[:, 1:] for points in curves]
    return [off_chords(ends, points) for ends, points in zip(chords, inner, strict=True)]


def _form_point_miss(tooth: Tooth, flank: GeneratedLink, stations: Sections) -> float:
    """Return the largest distance, mm, of the chords between stations from a form point that is a sharp edge.

    If flank and fillet join smoothly, the chord may lie beside the form point: both surfaces are near it.
    """
    tooth_side = tooth.side(flank.side)

    def on_edge(ends: Ends) -> NDArray[np.bool_]:
        """True (N,) where the form point is a sharp edge."""
        is_edge: NDArray[np.bool_] = (ends.form_point_flank != tooth_side.form_point[0]) | tooth_side.sharp
        return is_edge

    if not on_edge(stations.of(flank.side)).any():
        return 0.0
    # three points inside each chord: their distances from the chord, where the form point is sharp
    places, t = (0.0, 1.0 / 3.0, 0.5, 2.0 / 3.0), stations.t
    fine = np.append((t[:-1, None] + np.diff(t)[:, None] * places).ravel(), 1.0)
    ends, s = tooth.ends(flank.side, fine), 0.0 if flank.side is Side.RIGHT else 1.0
    curve = flank.between(np.array([[s]]), ends, tooth.stations(fine)).points[0]
    nodes = curve[:: len(places)]
    chord, away = np.diff(nodes, axis=0)[:, None], curve[:-1].reshape(-1, len(places), 3) - nodes[:-1, None]
    off = away - (dot(away, chord) / dot(chord, chord))[..., None] * chord
    sharp = on_edge(ends)[:-1].reshape(-1, len(places))
    return float(np.sqrt(dot(off, off)[:, 1:][sharp[:, 1:]].max(initial=0.0)))
