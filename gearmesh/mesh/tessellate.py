"""Triangulated teeth to a stated tolerance: the largest distance between facets and exact surface, in mm.

Every link of the section chain (see `tooth`) has lines of constant s from toe to heel, as many as it needs, and strips of
triangles between them (see `strip_triangulation`), whose diagonals run along the sections or across the lines, whichever
takes fewer (see `plan`). At toe and heel the chords are the edges of the end faces: there it is the distance from the
section curve itself that counts, which is larger than that from the surface where end face and surface meet at an acute angle
(on a worm's thread more than twice as large), so section curves have nodes between the lines where they need them. What the
second forms predict is then measured between the vertices and mended where the prediction was too bold.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.ends.end_mesh import EndMesh, end_mesh
from gearmesh.mesh.links.forms import Forms
from gearmesh.mesh.links.images import image
from gearmesh.mesh.links.lines import denser, stations
from gearmesh.mesh.links.link_mesh import LinkLines, LinkMesh, mesh_link, thin_link
from gearmesh.mesh.links.plan import LinkPlan, link_plans
from gearmesh.mesh.links.seams import thin_seams
from gearmesh.mesh.patch import PatchMesh
from gearmesh.teeth.blank.body import end_edges
from gearmesh.teeth.end_strip import EndStrip
from gearmesh.teeth.region import FILLETS, FLANKS, Region
from gearmesh.teeth.section import Sections, breaks
from gearmesh.teeth.tooth import Tooth

Index = NDArray[np.int64]

#: sampled deviations may reach this share of the tolerance: between the samples it is a little larger
SAFETY = 0.97
#: rounds of measuring and mending; each halves a cell at most, the usual number is 1 or 2
ROUNDS = 12
#: part of what lines missed before by which more of them must miss less
WORSE = 0.99
#: rounds in which they need not, where a plan without shear takes so many times the triangles
PATIENCE, DEAR = 3, 1.15
#: where links that have more than the fewest triangles have together more than so many times these, those with more than so many
#: are thinned, until they have no more than so many
LARGE, EXCESS, ENOUGH = 1.48, 1.55, 1.42
#: with this share of what sampled deviations may reach: their triangles are of all shapes, and miss more between the samples
BETWEEN = 0.97
#: where flanks and fillets of a tooth of so many triangles in all at most still have more than so many times the fewest nodes of
#: seams are merged, too
MOST, LARGER = 250, 1.48
#: such a plan is taken at once if it takes no more than this share
CHEAP = 0.9


@dataclass(frozen=True)
class ToothMesh:
    """The links of one tooth, and the tolerance (mm) they were made to."""

    tooth: Tooth
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
        names = end_edges(self.tooth.blank.axial)
        return {names[end]: self._end_mesh(strip, end, rows) for end, strip in enumerate(strips) if strip is not None}

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
        return max((mesh.rows for mesh in self.end_meshes().values()), default=1)

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
            welded = welded.with_end(end_edges(self.tooth.blank.axial).index(region), mesh)
        return welded


@dataclass(frozen=True)
class Welded:
    """One tooth: vertices (V, 3), triangles (M, 3), its vertices at `toe` and `heel` in order, and on each link's
    first line; those of the first two go on over the chamfers of its ends.

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
        outline, lines = numbers[mesh.outline], numbers[mesh.lines[:2]]
        # those of root and first fillet, between which bars end
        broken = tuple(
            np.concatenate((first, line) if end else (line[::-1], first))
            for first, line in zip(self.firsts, lines, strict=False)
        )
        firsts = (*broken, *self.firsts[len(broken) :])
        toe, heel = (self.toe, outline) if end else (outline, self.heel)
        return Welded(np.concatenate((self.vertices, mesh.vertices)), triangles, toe, heel, firsts)


def tessellate(
    tooth: Tooth, tolerance: float, regions: tuple[Region, ...] | None = None, *, lean: bool = True
) -> ToothMesh:
    """Mesh one tooth (or only some links of it) within `tolerance` (mm) of its exact surfaces.

    Without `lean` it is not thinned: where nobody keeps the triangles, that takes longer than what they save.

    Raises TrimError where the tooth cannot be trimmed.
    """
    return tessellate_alike((tooth,), tolerance, regions, lean=lean)[0]


def tessellate_alike(
    teeth: Sequence[Tooth], tolerance: float, regions: tuple[Region, ...] | None = None, *, lean: bool = True
) -> tuple[ToothMesh, ...]:
    """Mesh teeth as `tessellate` does one, with lines at the same stations: each fits beside each of them.

    Raises TrimError where a tooth cannot be trimmed.
    """
    for tooth in teeth:
        # rounding decides which edges go: the next mesh of the tooth, as of a sector, is to be this one
        tooth.find_undercut()
    drafts = [_Draft.of(tooth, regions or tooth.regions, tolerance) for tooth in teeth]
    count = len(drafts[0].regions)
    least, fixed, seams = (
        np.ones(count + 1),
        np.unique(np.concatenate([tooth.breaks for tooth in teeth])),
        list[Array](),
    )
    known = dict[bytes, Array]()
    for _ in range(ROUNDS):
        before, seams = seams, _seams(drafts, least, fixed, known)
        moved = [not before or not np.array_equal(*pair) for pair in zip(seams, before or seams, strict=True)]
        if not any(moved) and not any(draft.stale for draft in drafts):
            break
        for draft in drafts:
            draft.mesh(seams, moved, least, fixed)
    patches = [draft.thin() if lean else draft.patches() for draft in drafts]
    if lean and len(drafts) == 1:
        patches = [drafts[0].thin_seams(patches[0])]
    return tuple(ToothMesh(draft.tooth, made, tolerance) for draft, made in zip(drafts, patches, strict=True))


def _seams(drafts: Sequence[_Draft], least: Array, fixed: Array, known: dict[bytes, Array]) -> list[Array]:
    """Stations of the nodes of every seam (R + 1) between the links of all drafts, as many as the links on both sides
    of it want.

    The last seam of a whole tooth is the first one of the next. `least` (R + 1,): cells that they have at least; `known`: those of
    rounds before, by their density.
    """
    count, seams = len(drafts[0].regions), list[Array]()
    whole = count == len(drafts[0].tooth.regions)
    for seam in range(count + 1):
        before, after = [seam - 1] if seam else [], [seam] if seam < count else []
        cells = least[seam]
        if whole and seam in (0, count):
            before, after, cells = [count - 1], [0], max(least[0], least[-1])
        wanted = [draft.plans[k].along[-1] for draft in drafts for k in before]
        wanted += [draft.plans[k].along[0] for draft in drafts for k in after]
        density = np.max(wanted, axis=0)
        total = float(np.trapezoid(density, dx=1.0 / (density.size - 1)))
        density = density * max(1.0, (cells - 0.5) / total)
        key = density.tobytes()
        if key not in known:
            known[key] = stations(density[None], fixed, np.zeros(1, dtype=bool))[0]
        seams.append(known[key])
    return seams


@dataclass
class _Draft:
    """A tooth that is being meshed: the plan of each link, how much it `missed` the surface by before, mm, in how
    many rounds by no less for having more lines (`worse`), and its last mesh, which may be `stale`; the sections
    last `trimmed`."""

    tooth: Tooth
    regions: tuple[Region, ...]
    tolerance: float
    forms: Forms
    plans: list[LinkPlan]
    missed: list[float]
    worse: list[int]
    meshes: dict[int, LinkMesh]
    stale: set[int]
    trimmed: Sections | None = None

    @staticmethod
    def of(tooth: Tooth, regions: tuple[Region, ...], tolerance: float) -> _Draft:
        forms, allowed = Forms.of(tooth, regions), SAFETY * tolerance
        straight, whole = tooth.face_breaks.size > 0, len(regions) == len(tooth.regions)
        plans = link_plans(forms, SAFETY * allowed, allowed, straight=straight, whole=whole)
        return _Draft(
            tooth,
            regions,
            tolerance,
            forms,
            plans,
            [np.inf] * len(regions),
            [0] * len(regions),
            {},
            set(range(len(regions))),
        )

    def patches(self) -> tuple[PatchMesh, ...]:
        """All links in order, as they were meshed last."""
        return tuple(self.meshes[k].patch for k in range(len(self.regions)))

    def thin(self) -> tuple[PatchMesh, ...]:
        """All links in order, with fewer triangles where that many are far from needed."""
        allowed, meshes = SAFETY * self.tolerance, [self.meshes[k] for k in range(len(self.regions))]
        taken = np.array([len(mesh.patch.triangles) for mesh in meshes])
        seams = [int(mesh.cells[0] + mesh.cells[-1]) for mesh in meshes]
        fewest = np.array([self.forms.fewest(k, allowed, cells) for k, cells in enumerate(seams)])
        more = taken > fewest
        thinned = (taken > EXCESS * fewest) & (taken[more].sum() > LARGE * fewest[more].sum())
        patches = [mesh.patch for mesh in meshes]
        # of teeth that have more than so many times the fewest even then all links that have more than enough are
        for rest in (thinned, (taken > ENOUGH * fewest) & ~thinned):
            for k in np.flatnonzero(rest).tolist():
                enough = int(ENOUGH * fewest[k]) - 6
                # where nodes of seams are merged, too, a link that is merged as far as it can be leaves them less room
                patches[k] = self._image(k, patches) or self._thin(k, enough, again=taken.sum() > MOST)
            left = np.array([len(patch.triangles) for patch in patches])
            if not thinned.any() or left[more].sum() <= LARGE * fewest[more].sum():
                break
        return tuple(patches)

    def thin_seams(self, patches: tuple[PatchMesh, ...]) -> tuple[PatchMesh, ...]:
        """These links with fewer nodes on their seams too, where they have few triangles and yet far more than needed."""
        allowed, taken = BETWEEN * SAFETY * self.tolerance, np.array([len(patch.triangles) for patch in patches])
        curved = np.array([region in (*FLANKS.values(), *FILLETS.values()) for region in self.regions])
        if taken.sum() > MOST or not curved.any():
            return patches
        cells = self.forms.seam_cells(allowed, whole=len(self.regions) == len(self.tooth.regions))
        fewest = np.array([self.forms.fewest(k, allowed, int(cells[k] + cells[k + 1])) for k in range(len(patches))])
        least = fewest[curved].sum()
        if taken[curved].sum() <= LARGER * least:
            return patches
        meshes = [self.meshes[k] for k in range(len(patches))]
        # sharp form points ask for more than their flanks and fillets do
        sharp = np.array([mesh.form_point > 0.0 for mesh in meshes])
        held = np.array([bool(sharp[k] or sharp[k - 1]) for k in range(len(patches))])
        enough = int(ENOUGH * least + taken[~curved].sum())
        return thin_seams(self.tooth, patches, self.forms, held, allowed, enough)

    def _image(self, k: int, patches: list[PatchMesh]) -> PatchMesh | None:
        """What was made of a link before whose image link k is, where it is within the tolerance there, too."""
        assert self.trimmed is not None
        for other in range(k):
            if patches[other] is not self.meshes[other].patch:
                both = self.meshes[k], self.meshes[other]
                patch = image(self.tooth, *both, patches[other], self.trimmed, (self.forms, k, other))
                if patch is not None and patch.deviation <= SAFETY * self.tolerance:
                    return patch
        return None

    def _thin(self, k: int, enough: int, *, again: bool) -> PatchMesh:
        allowed = BETWEEN * SAFETY * self.tolerance
        assert self.trimmed is not None
        return thin_link(self.tooth, self.meshes[k], self.trimmed, self.forms, k, allowed, enough, again=again)

    def mesh(self, seams: list[Array], moved: list[bool], least: Array, fixed: Array) -> None:
        """Mesh what is new, with nodes at the stations `seams` of every seam, some of them `moved`, and refine its
        plans.

        `least` (R + 1,): cells that a seam needs.
        """
        wanted = [k for k in range(len(self.regions)) if k in self.stale or moved[k] or moved[k + 1]]
        for k in wanted:
            self.missed[k] = self.missed[k] if k in self.stale else np.inf
        self.stale = set()
        if not wanted:
            return
        tooth = self.tooth
        lines = {
            k: LinkLines.of(self.plans[k], breaks(tooth.chain[self.regions[k]]), fixed, seams[k], seams[k + 1])
            for k in wanted
        }
        drawn = [lines[k].t for k in wanted if tooth.chain[self.regions[k]].surface is None]
        t = np.unique(np.concatenate([*seams, *drawn, fixed]))
        if self.trimmed is None or not np.array_equal(t, self.trimmed.t):
            self.trimmed = tooth.sections(t)
        for k in wanted:
            mesh = mesh_link(
                tooth,
                self.regions[k],
                lines[k],
                self.trimmed,
                self.plans[k],
                self.forms.second[k],
                SAFETY * self.tolerance,
                self.meshes.get(k),
            )
            self.meshes[k] = mesh
            self._refine(k, mesh, least)

    def _refine(self, k: int, mesh: LinkMesh, least: Array) -> None:
        """Replace the plan of a link where its mesh misses the tolerance, and forget the mesh."""
        allowed, plan = SAFETY * self.tolerance, self.plans[k]
        if mesh.worst <= allowed:
            return
        plain = plan.otherwise
        self.worse[k] += mesh.worst > WORSE * self.missed[k]
        if plain is not None and self.worse[k] > (
            PATIENCE if plain.triangles > DEAR * len(mesh.patch.triangles) else 0
        ):
            # lines that lean with the surface and miss it by more for being more: the plain ones take their place
            self.plans[k] = plain
            self.stale.add(k)
            return
        first, self.missed[k] = self.missed[k] == np.inf, mesh.worst
        # at least about a cell more, which a few percent are not where there are few
        factor = np.maximum(1.02 * np.sqrt(mesh.lines / allowed), 1.0 + 1.2 / mesh.cells)
        factor = np.where(mesh.lines > allowed, np.minimum(factor, 2.0), 1.0)
        for seam, line in ((k, 0), (k + 1, -1)):
            if factor[line] > 1.0:
                least[seam] = max(least[seam], np.ceil(mesh.cells[line] * factor[line]), mesh.cells[line] + 1.0)
        if (factor[1:-1] > 1.0).any():
            plan = plan.with_more_nodes(mesh.s[1:-1], factor[1:-1])
        # strips between lines that are good themselves
        strips = np.where(np.maximum(mesh.lines[1:], mesh.lines[:-1]) <= allowed, mesh.strips, 0.0)
        if (strips > allowed).any():
            wanted = len(mesh.patch.triangles) * (1.0 + 0.5 * np.mean(strips > allowed))
            # without shear where that takes far less
            if plain is not None and plain.triangles < CHEAP * wanted:
                plan = plain
            else:
                plan = replace(plan, across=denser(mesh.s, strips, allowed, even=first))
        if plan is not self.plans[k]:
            self.plans[k] = plan
            self.stale.add(k)
