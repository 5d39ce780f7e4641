"""Triangulated teeth to a stated tolerance: the largest distance between facets and exact surface, in mm.

Every link of the section chain (see `tooth`) has lines of constant s from toe to heel, as many as it needs, and strips of
triangles between them (see `strip_triangulation`), whose diagonals run along the sections or across the lines, whichever
takes fewer (see `forms`). At toe and heel the chords are the edges of the end faces: there it is the distance from the
section curve itself that counts, which is larger than that from the surface where end face and surface meet at an acute angle
(on a worm's thread more than twice as large), so section curves have nodes between the lines where they need them. What the
second forms predict is then measured between the vertices and mended where the prediction was too bold.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.mesh.ends.end_mesh import EndMesh, end_mesh
from gearmesh.mesh.forms import Forms, LinkPlan, cheapest
from gearmesh.mesh.patch import LinkNodes, PatchMesh
from gearmesh.mesh.strip_triangulation import StripTriangulation
from gearmesh.teeth.end_strip import EndStrip
from gearmesh.teeth.region import END_EDGES, Region, Side
from gearmesh.teeth.section import GeneratedLink, Link, Sections, breaks
from gearmesh.teeth.tooth import Tooth

Index = NDArray[np.int64]

#: sampled deviations may reach this share of the tolerance: between the samples it is a little larger
SAFETY = 0.97
#: rounds of measuring and mending; each halves a cell at most, the usual number is 1 or 2
ROUNDS = 12
#: part of what lines missed before by which more of them must miss less
WORSE = 0.99
#: below this (mm) a deviation is rounding
FLOOR = 1e-9


@dataclass(frozen=True)
class ToothMesh:
    """The links of one tooth with lines at common stations t (T+1,), and the tolerance (mm) they were made to."""

    tooth: Tooth
    t: Array
    patches: tuple[PatchMesh, ...]
    tolerance: float

    @property
    def deviation(self) -> float:
        """Largest measured distance between facets and surface, mm."""
        ends = (mesh.deviation for mesh in self.end_meshes().values())
        return max(max(patch.deviation for patch in self.patches), *ends, 0.0)

    @property
    def triangles(self) -> int:
        """Triangles of one tooth."""
        ends = sum(len(mesh.triangles) for mesh in self.end_meshes().values())
        return ends + sum(len(patch.triangles) for patch in self.patches)

    @property
    def whole(self) -> bool:
        """True where it has all links, so that the last one ends where the next tooth begins."""
        return len(self.patches) == len(self.tooth.regions)

    def end_meshes(self, rows: int = 1) -> dict[Region, EndMesh]:
        """The chamfers of its end faces, in so many rows of triangles at least; none of a few links."""
        strips = self.tooth.end_strips if self.whole else (None, None)
        return {
            END_EDGES[end]: self._end_mesh(strip, end, rows) for end, strip in enumerate(strips) if strip is not None
        }

    def _end_mesh(self, strip: EndStrip, end: int, rows: int) -> EndMesh:
        key = end, rows
        if key not in self._end_meshes:
            s = [(patch.region, patch.nodes.s[patch.nodes.end(float(end))]) for patch in self.patches]
            self._end_meshes[key] = end_mesh(strip, s, end, self.tolerance, rows)
        return self._end_meshes[key]

    @cached_property
    def _end_meshes(self) -> dict[tuple[int, int], EndMesh]:
        return {}

    @property
    def end_rows(self) -> int:
        """Most rows of triangles of a chamfer at its ends, 1 without any."""
        return max((mesh.first.size for mesh in self.end_meshes().values()), default=1)

    def weld(self, end_rows: int = 1) -> Welded:
        """The links in one, neighbouring ones with the nodes of their seam in common, and after them the chamfers of its ends."""
        firsts = [patch.nodes.line(0.0) for patch in self.patches]
        points, numbers, count = [], [], 0
        for patch in self.patches:
            own = np.ones(len(patch.points), dtype=bool)
            own[patch.nodes.line(1.0)] = False
            numbers.append(np.where(own, count + np.cumsum(own) - 1, -1))
            points.append(patch.points[own])
            count += int(own.sum())
        for k, patch in enumerate(self.patches[:-1]):
            numbers[k][patch.nodes.line(1.0)] = numbers[k + 1][firsts[k + 1]]
        last = self.patches[-1].nodes.line(1.0)
        # of a tooth the next one's first line, of a few links nodes of its own
        numbers[-1][last] = count + (numbers[0][firsts[0]] if self.whole else np.arange(last.size))
        points.append(self.patches[-1].points[last][: 0 if self.whole else None])
        ends = [
            np.concatenate([of[patch.nodes.end(end)[:-1]] for of, patch in zip(numbers, self.patches, strict=True)])
            for end in (0.0, 1.0)
        ]
        triangles = [of[patch.triangles] for of, patch in zip(numbers, self.patches, strict=True)]
        lines = tuple(of[first] for of, first in zip(numbers, firsts, strict=True))
        welded = Welded(np.concatenate(points), np.concatenate(triangles), ends[0], ends[1], lines)
        for region, mesh in self.end_meshes(end_rows).items():
            welded = welded.with_end(END_EDGES.index(region), mesh)
        return welded


@dataclass(frozen=True)
class Welded:
    """One tooth: vertices (V, 3), triangles (M, 3), its vertices at `toe` and `heel` in order, and on each link's first line.

    Of a whole tooth a vertex V + k is vertex k of the next one.
    """

    vertices: Array
    triangles: Index
    toe: Index
    heel: Index
    firsts: tuple[Index, ...] = ()

    def with_end(self, end: int, mesh: EndMesh) -> Welded:
        """The same with the chamfer at its toe (0) or heel (1), whose outline takes the place of that end's."""
        count, fresh = len(self.vertices), len(mesh.vertices)
        own = np.concatenate(((self.toe, self.heel)[end], count + np.arange(fresh)))
        numbers = np.concatenate((own, count + fresh + own))
        triangles = np.concatenate((self.triangles + fresh * (self.triangles >= count), numbers[mesh.triangles]))
        outline, line = numbers[mesh.outline], numbers[mesh.first]
        firsts = (np.concatenate((self.firsts[0], line) if end else (line[::-1], self.firsts[0])), *self.firsts[1:])
        toe, heel = (self.toe, outline) if end else (outline, self.heel)
        return Welded(np.concatenate((self.vertices, mesh.vertices)), triangles, toe, heel, firsts)


def tessellate(tooth: Tooth, tolerance: float, regions: tuple[Region, ...] | None = None) -> ToothMesh:
    """Mesh one tooth (or only some links of it) within `tolerance` (mm) of its exact surfaces.

    Raises TrimError where the tooth cannot be trimmed.
    """
    return tessellate_alike((tooth,), tolerance, regions)[0]


def tessellate_alike(
    teeth: Sequence[Tooth], tolerance: float, regions: tuple[Region, ...] | None = None
) -> tuple[ToothMesh, ...]:
    """Mesh teeth as `tessellate` does one, with lines at the same stations: each fits beside each of them.

    Raises TrimError where a tooth cannot be trimmed.
    """
    drafts = [_Draft.of(tooth, regions or tooth.regions, tolerance) for tooth in teeth]
    finest, allowed = max(drafts, key=lambda draft: draft.count), SAFETY * tolerance
    count, fixed = finest.count, np.unique(np.concatenate([tooth.breaks for tooth in teeth]))
    for _ in range(ROUNDS):
        t = _station_nodes(count, finest.t_of_tau, fixed)
        tried = [draft.mesh(t) for draft in drafts]
        along_face, refined = max(edge for edge, _ in tried), any(again for _, again in tried)
        if along_face <= allowed and not refined:
            break
        count = int(np.ceil(count * min(2.0, max(1.0, 1.02 * np.sqrt(along_face / allowed)))))
    return tuple(ToothMesh(draft.tooth, t, tuple(draft.patches), tolerance) for draft in drafts)


@dataclass
class _Draft:
    """A tooth that is being meshed: the plan of each link and how much it `missed` the surface by before, mm; its last patches.

    `count` and `t_of_tau` are its own number of cells along the face and their places.
    """

    tooth: Tooth
    regions: tuple[Region, ...]
    tolerance: float
    count: int
    t_of_tau: Array
    plans: list[LinkPlan]
    missed: Array
    patches: list[PatchMesh]

    @staticmethod
    def of(tooth: Tooth, regions: tuple[Region, ...], tolerance: float) -> _Draft:
        forms, allowed = Forms.of(tooth, regions), SAFETY * tolerance
        count, plans = cheapest(forms, SAFETY * allowed, allowed, straight=tooth.face_breaks.size > 0)
        missed = np.full(len(regions), np.inf)
        return _Draft(tooth, regions, tolerance, count, forms.t_of_tau, plans, missed, [])

    def mesh(self, t: Array) -> tuple[float, bool]:
        """Mesh it at stations t (T,): the largest deviation (mm) of edges along the face, and whether plans were refined."""
        sections, allowed, along_face, refined = self.tooth.sections(t), SAFETY * self.tolerance, 0.0, False
        plans, missed, self.patches = self.plans, self.missed, []
        for k, region in enumerate(self.regions):
            seams = breaks(self.tooth.chain[region])
            s = _nodes(*plans[k].lines, seams)
            patch, edge, strips = _mesh(self.tooth, region, s, sections, plans[k], self.tolerance)
            self.patches.append(patch)
            plain = plans[k].otherwise
            if plain is not None and max(edge, strips.max()) > max(allowed, WORSE * missed[k]):
                # lines that lean with the surface and miss it by more for being more: the plain ones take their place
                plans[k], refined = plain, True
                continue
            missed[k] = max(edge, strips.max())
            along_face = max(along_face, edge)
            if edge <= allowed and (strips > allowed).any():
                refined = True
                plans[k] = _mend(plans[k], s, strips, allowed, seams)
        return along_face, refined


def _station_nodes(count: int, t_of_tau: Array, breaks: Array) -> Array:
    """About `count` cells along the face, evenly over tau between the stations that must be nodes."""
    tau = np.linspace(0.0, 1.0, t_of_tau.size)
    fixed = np.concatenate(([0.0], np.interp(breaks, t_of_tau, tau), [1.0]))
    cells = np.maximum(1, np.ceil(count * np.diff(fixed) - 1e-9).astype(int))
    spans = zip(fixed[:-1], fixed[1:], cells, strict=True)
    t = np.interp(np.concatenate([np.linspace(a, b, n + 1)[:-1] for a, b, n in spans] + [[1.0]]), tau, t_of_tau)
    t[np.cumsum(cells)[:-1]] = breaks
    nodes: Array = t
    return nodes


def _nodes(s: Array, per_unit: Array, seams: Array) -> Array:
    """Nodes from 0 to 1 with the given number of cells per unit of s (piecewise linear over s), some of them on the seams (K,)."""
    total = _integral(s, per_unit)
    ends = np.concatenate(([0.0], np.interp(seams, s, total), total[-1:]))
    parts = []
    for low, high, end in zip(ends[:-1], ends[1:], [*seams, 1.0], strict=True):
        count = max(1, int(np.ceil(high - low - 1e-9)))
        parts.append(np.interp(np.linspace(low, high, count + 1), total, s)[1:])
        parts[-1][-1] = end
    return np.concatenate(([0.0], *parts))


def _integral(s: Array, per_unit: Array) -> Array:
    return np.concatenate(([0.0], np.cumsum(0.5 * (per_unit[1:] + per_unit[:-1]) * np.diff(s))))


def _mend(plan: LinkPlan, s: Array, strips: Array, tolerance: float, seams: Array) -> LinkPlan:
    """With more lines where the strips miss the tolerance, or without shear where that takes no more."""
    finer = replace(plan, lines=_denser(s, strips, tolerance))
    plain = plan.otherwise
    return finer if plain is None or _nodes(*finer.lines, seams).size < _nodes(*plain.lines, seams).size else plain


def _denser(s: Array, cells: Array, tolerance: float) -> tuple[Array, Array]:
    """Density over s that splits the cells which miss the tolerance and leaves the others as they are."""
    width = np.diff(s)
    factor = np.where(cells > tolerance, np.clip(1.03 * np.sqrt(cells / tolerance), 1.03, 2.0), 1.0)
    # a step function: two samples for each cell, a hair inside its ends
    inside = np.stack((s[:-1] + 1e-9 * width, s[1:] - 1e-9 * width), axis=-1).ravel()
    per_unit = np.repeat(factor / width, 2)
    inside[0], inside[-1] = 0.0, 1.0
    return inside, per_unit


def _mesh(
    tooth: Tooth, region: Region, s: Array, sections: Sections, plan: LinkPlan, tolerance: float
) -> tuple[PatchMesh, float, Array]:
    """Patch mesh, largest deviation of edges along the face, and largest deviation (S,) of the strips between the lines."""
    link, count, rows = tooth.chain[region], s.size, sections.t.size
    toe, heel = (
        _between(link, s, sections[end], density, SAFETY * tolerance)
        for end, density in zip((np.s_[:1], np.s_[-1:]), plan.outline, strict=True)
    )
    between, outline = (toe[0], heel[0]), max(toe[1], heel[1])
    extra = [np.concatenate(pieces) for pieces in between]
    at = np.concatenate((np.tile(np.arange(rows), count), *(np.full(extra[k].size, k * (rows - 1)) for k in (0, 1))))
    nodes = LinkNodes.of(tooth, region, np.concatenate((np.repeat(s, rows), *extra)), at, sections)
    lines = np.arange(count * rows).reshape(count, rows)
    sizes = np.cumsum([lines.size, *(inner.size for pieces in between for inner in pieces)])
    inner = [np.arange(low, high) for low, high in pairwise(sizes)]
    level = _level(plan.level, nodes.s, nodes.t)
    triangulation = StripTriangulation.of(list(lines), inner[: count - 1], inner[count - 1 :], level, nodes.miss)
    on_break = np.isin(nodes.t, tooth.face_breaks)
    triangulation = triangulation.flip(nodes.miss, np.where(on_break, nodes.t, 0.0))
    triangles, strip = triangulation.triangles()
    low, high = np.moveaxis(np.sort(triangles[:, [[1, 2], [2, 0], [0, 1]]], axis=-1), -1, 0)
    numbers, side = np.unique(low * nodes.s.size + high, return_inverse=True)
    edges = np.stack(np.divmod(numbers, nodes.s.size), axis=-1)
    heights = nodes.height(edges)
    strips = np.full(count - 1, FLOOR)
    np.maximum.at(strips, strip, _peaks(heights[side.reshape(-1, 3)], nodes.height(triangles)))
    along = float(np.abs(heights[nodes.s[edges[:, 0]] == nodes.s[edges[:, 1]]]).max())
    if region.is_flank and isinstance(link, GeneratedLink):
        along = max(along, _form_point_miss(tooth, link, sections))
    deviation = max(along, float(strips.max()), outline)
    return PatchMesh(nodes, triangles, nodes.middle(triangles).normals, deviation), along, strips


def _peaks(sides: Array, centres: Array) -> Array:
    """Largest distances (M,), mm, of triangles from the surface by those, signed, of the middles of edges (M, 3) and of centres.

    With a, b, c at the edges' middles, opposite to the corners, the distance is 4 (a y z + b z x + c x y) at barycentric x, y, z.
    It peaks at x : y : z = a (b + c - a) : b (c + a - b) : c (a + b - c) or, where that is outside, at the middle of an edge. What
    the centre has beyond it is of third order and vanishes on the edges like x y z.
    """
    shares = sides * (sides.sum(axis=1, keepdims=True) - 2.0 * sides)
    inside = (shares > 0.0).all(axis=1)
    x, y, z = (shares[inside] / shares[inside].sum(axis=1, keepdims=True)).T
    a, b, c = sides[inside].T
    more = centres[inside] - 4.0 / 9.0 * (a + b + c)
    peaks: Array = np.maximum(np.abs(sides).max(axis=1), np.abs(centres))
    peaks[inside] = np.maximum(
        peaks[inside], np.abs(4.0 * (a * y * z + b * z * x + c * x * y) + 27.0 * more * x * y * z)
    )
    return peaks


def _level(level: Array, s: Array, t: Array) -> Array:
    """Levels (N,) at s, t (N,), linear between the samples (S, T)."""
    count, rows = level.shape
    x, y = s * (count - 1), t * (rows - 1)
    i, j = np.minimum(x.astype(int), count - 2), np.minimum(y.astype(int), rows - 2)
    x, y = x - i, y - j
    low, high = level[i, j] * (1.0 - x) + level[i + 1, j] * x, level[i, j + 1] * (1.0 - x) + level[i + 1, j + 1] * x
    interpolated: Array = low * (1.0 - y) + high * y
    return interpolated


def _between(
    link: Link, s: Array, end: Sections, density: tuple[Array, Array], tolerance: float
) -> tuple[list[Array], float]:
    """Nodes (S) of a section curve between the lines s (S+1,), as many as keep its chords within the tolerance.

    And the largest distance (mm) of the chords from the curve.
    """
    total = np.interp(s, density[0], _integral(*density))
    cells = np.maximum(1, np.ceil(np.diff(total) - 1e-9).astype(int))
    for _ in range(ROUNDS):
        nodes = [np.linspace(a, b, n + 1)[:-1] for a, b, n in zip(s[:-1], s[1:], cells, strict=True)]
        worst = np.maximum.reduceat(
            _off_curve(link, np.append(np.concatenate(nodes), 1.0), end), np.cumsum(cells) - cells
        )
        if not (worst > tolerance).any():
            break
        more = np.ceil(cells * np.clip(np.sqrt(worst / tolerance), 1.0, 2.0)).astype(int)
        cells = np.where(worst > tolerance, np.maximum(more, cells + 1), cells)
    return [line[1:] for line in nodes], float(worst.max())


def _off_curve(link: Link, s: Array, end: Sections) -> Array:
    """Largest distance (S,), mm, of the chords between nodes s (S+1,) from the section curve, in their middles."""
    fine = np.empty(2 * s.size - 1)
    fine[::2], fine[1::2] = s, 0.5 * (s[:-1] + s[1:])
    curve = link.grid(fine, end).points[:, 0]
    nodes = curve[::2]
    chord, away = np.diff(nodes, axis=0), curve[1::2] - nodes[:-1]
    length = dot(chord, chord)
    share = np.divide(dot(away, chord), length, out=np.zeros_like(length), where=length > 0.0)
    off = away - share[..., None] * chord
    distance: Array = np.sqrt(dot(off, off))
    return distance


def _form_point_miss(tooth: Tooth, flank: GeneratedLink, stations: Sections) -> float:
    """Largest distance (mm) of the chords between stations from the form point with the fillet, where that is a sharp edge.

    Where flank and fillet pass into each other smoothly, the chord may lie beside the form point: both surfaces are near it.
    """
    own = tooth.side(flank.side)

    def on_edge(sections: Sections) -> NDArray[np.bool_]:
        is_edge: NDArray[np.bool_] = (sections.of(flank.side).form_point_flank != own.form_point[0]) | own.sharp
        return is_edge

    if not on_edge(stations).any():
        return 0.0
    places, t = (0.0, 1.0 / 3.0, 0.5, 2.0 / 3.0), stations.t
    sections = tooth.sections(np.append((t[:-1, None] + np.diff(t)[:, None] * places).ravel(), 1.0))
    curve = flank.grid([0.0 if flank.side is Side.RIGHT else 1.0], sections).points[0]
    nodes = curve[:: len(places)]
    chord, away = np.diff(nodes, axis=0)[:, None], curve[:-1].reshape(-1, len(places), 3) - nodes[:-1, None]
    off = away - (dot(away, chord) / dot(chord, chord))[..., None] * chord
    sharp = on_edge(sections)[:-1].reshape(-1, len(places))
    return float(np.sqrt(dot(off, off)[:, 1:][sharp[:, 1:]].max(initial=0.0)))
