"""Triangulated teeth within a tolerance: the largest distance, mm, between facets and exact surface.

Each link of the section chain (see `tooth`) has lines of constant s from toe to heel, and strips of triangles between them
(see `strip_triangulation`). Diagonals follow the sections or cross the lines, whichever needs fewer triangles (see `plan`). At
toe and heel the chords are edges of the end faces, and their distance from the section curve counts. It is larger than the
distance from the surface if end face and surface meet at an acute angle, on a worm's thread more than twice as large.
Section curves therefore have nodes between the lines where needed. The second forms predict the distances; these are then
measured between the vertices, and the mesh is refined where the prediction was too small.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, distinct
from gearmesh.mesh.ends.end_mesh import EndMesh, end_mesh
from gearmesh.mesh.links.forms import Forms
from gearmesh.mesh.links.images import image
from gearmesh.mesh.links.lines import denser, stations
from gearmesh.mesh.links.link_mesh import LinkLines, LinkMesh, mesh_link, thin_link
from gearmesh.mesh.links.plan import LinkPlan, link_plans
from gearmesh.mesh.links.seams import thin_seams
from gearmesh.mesh.patch import PatchMesh
from gearmesh.records import dataclass
from gearmesh.teeth.blank.body import end_edges
from gearmesh.teeth.end_strip import EndStrip
from gearmesh.teeth.region import FILLET_REGIONS, FLANK_REGIONS, Region
from gearmesh.teeth.section import Sections, breaks
from gearmesh.teeth.tooth import Tooth

Index = NDArray[np.int64]

#: largest sampled deviation, as a share of the tolerance: between the samples deviations are a little larger
SAMPLED_SHARE = 0.97
#: rounds of measuring and refining; a round halves cells at most, 1 or 2 rounds are usual
MAX_ROUNDS = 12
#: more lines must reduce the deviation of a link below this share
IMPROVEMENT_SHARE = 0.99
#: rounds without such a reduction before a plan without shear is taken, if that plan needs many more triangles
PATIENT_ROUNDS = 3
#: number of triangles of the plan without shear, over that of the present mesh, that counts as many more
DEAR_PLAN_RATIO = 1.15
#: number of triangles of a tooth, over the least possible, beyond which it is thinned
MAX_TOOTH_EXCESS = 1.48
#: number of triangles of a link, over the least possible, beyond which it is thinned first
MAX_LINK_EXCESS = 1.55
#: number of triangles of a link, over the least possible, at which thinning stops
ENOUGH_RATIO = 1.42
#: share of the allowed deviation for thinned links: their triangles have all shapes and deviate more between the samples
THINNED_SHARE = 0.97
#: largest number of triangles of a tooth whose seams are thinned
MAX_SEAM_TRIANGLES = 250
#: number of triangles of flanks and fillets, over the least possible, beyond which seams are thinned
MAX_CURVED_EXCESS = 1.48
#: the plan without shear is taken at once if it needs no more than this share of the triangles
CHEAP_PLAN_RATIO = 0.9


@dataclass(frozen=True)
class ToothMesh:
    """Mesh of one tooth."""

    #: the tooth
    tooth: Tooth
    #: meshes of its links
    patches: tuple[PatchMesh, ...]
    #: mm
    tolerance: float

    @property
    def deviation(self) -> float:
        """Largest measured distance between facets and surface, mm."""
        ends = (mesh.deviation for mesh in self.end_meshes().values())
        return max(max(patch.deviation for patch in self.patches), *ends, 0.0)

    @property
    def triangles(self) -> int:
        """Number of triangles."""
        ends = sum(len(mesh.triangles) for mesh in self.end_meshes().values())
        return ends + sum(len(patch.triangles) for patch in self.patches)

    @property
    def whole(self) -> bool:
        """True if the mesh has all links: the last one ends where the next tooth begins."""
        return len(self.patches) == len(self.tooth.regions)

    def end_meshes(self, rows: int = 1) -> dict[Region, EndMesh]:
        """Return the meshes of the chamfers of the ends, with at least `rows` rows of triangles; none if links are missing."""
        strips = self.tooth.end_strips if self.whole else (None, None)
        names = end_edges(self.tooth.blank.axial)
        return {names[end]: self._end_mesh(strip, end, rows) for end, strip in enumerate(strips) if strip is not None}

    def _end_mesh(self, strip: EndStrip, end: int, rows: int) -> EndMesh:
        """Return the mesh of the chamfer at an end, which is made once."""
        key = end, rows
        if key not in self._end_meshes:
            s = [(patch.region, patch.nodes.s[patch.nodes.end(float(end))]) for patch in self.patches]
            self._end_meshes[key] = end_mesh(strip, s, end, self.tolerance, rows)
        return self._end_meshes[key]

    @cached_property
    def _end_meshes(self) -> dict[tuple[int, int], EndMesh]:
        """Meshes of chamfers by end and rows."""
        return {}

    @property
    def end_rows(self) -> int:
        """Largest number of rows of triangles of a chamfer; 1 without chamfers."""
        return max((mesh.rows for mesh in self.end_meshes().values()), default=1)

    def weld(self, end_rows: int = 1) -> Welded:
        """Return the links as one mesh; neighbours share the nodes of their seam; then the chamfers of the ends."""
        firsts = [patch.nodes.line(0.0) for patch in self.patches]
        points, numbers, count = [], [], 0
        for patch in self.patches:
            # a link has no vertices of its own on its last line, which is the first line of the next link
            unshared = np.ones(len(patch.points), dtype=bool)
            unshared[patch.nodes.line(1.0)] = False
            numbers.append(np.where(unshared, count + np.cumsum(unshared) - 1, -1))
            points.append(patch.points[unshared])
            count += int(unshared.sum())
        for k, patch in enumerate(self.patches[:-1]):
            numbers[k][patch.nodes.line(1.0)] = numbers[k + 1][firsts[k + 1]]
        last = self.patches[-1].nodes.line(1.0)
        # the last line of a whole tooth is the first line of the next tooth
        numbers[-1][last] = count + (numbers[0][firsts[0]] if self.whole else np.arange(last.size))
        points.append(self.patches[-1].points[last][: 0 if self.whole else None])
        ends = [
            np.concatenate(
                [number[patch.nodes.end(end)[:-1]] for number, patch in zip(numbers, self.patches, strict=True)]
            )
            for end in (0.0, 1.0)
        ]
        triangles = [number[patch.triangles] for number, patch in zip(numbers, self.patches, strict=True)]
        lines = tuple(number[first] for number, first in zip(numbers, firsts, strict=True))
        welded = Welded(np.concatenate(points), np.concatenate(triangles), ends[0], ends[1], lines)
        for region, mesh in self.end_meshes(end_rows).items():
            welded = welded.with_end(end_edges(self.tooth.blank.axial).index(region), mesh)
        return welded


@dataclass(frozen=True)
class Welded:
    """Mesh of one tooth with common nodes on its seams."""

    #: vertices (V, 3), mm
    vertices: Array
    #: triangles (M, 3); of a whole tooth, vertex V + k is vertex k of the next tooth
    triangles: Index
    #: vertices at the toe, in order
    toe: Index
    #: vertices at the heel, in order
    heel: Index
    #: vertices on the first line of each link; the first two lines go on over the chamfers of the ends
    firsts: tuple[Index, ...] = ()

    def with_end(self, end: int, mesh: EndMesh) -> Welded:
        """Return the tooth with the chamfer at its toe (0) or heel (1); the outline of the chamfer is then the end."""
        count, fresh = len(self.vertices), len(mesh.vertices)
        of_tooth = np.concatenate(((self.toe, self.heel)[end], count + np.arange(fresh)))
        numbers = np.concatenate((of_tooth, count + fresh + of_tooth))
        triangles = np.concatenate((self.triangles + fresh * (self.triangles >= count), numbers[mesh.triangles]))
        outline, lines = numbers[mesh.outline], numbers[mesh.lines[:2]]
        # the first lines of root and first fillet, at which bars end, go on over the chamfer
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
    """Return the mesh of a tooth, or of some of its links.

    - tolerance: largest distance, mm, from the exact surfaces.
    - regions: links; None for all.
    - lean: False for a mesh without thinning, which is faster if the mesh is not kept.

    Raises TrimError if the tooth cannot be trimmed.
    """
    return tessellate_alike((tooth,), tolerance, regions, lean=lean)[0]


def tessellate_alike(
    teeth: Sequence[Tooth], tolerance: float, regions: tuple[Region, ...] | None = None, *, lean: bool = True
) -> tuple[ToothMesh, ...]:
    """Return the meshes of several teeth with lines at common stations: each tooth fits beside any other.

    The arguments are those of `tessellate`. Raises TrimError if a tooth cannot be trimmed.
    """
    for tooth in teeth:
        # undercut first, so that later meshes of the tooth, as of a sector, are equal to the last digit
        tooth.find_undercut()
    drafts = [_Draft.of(tooth, regions or tooth.regions, tolerance) for tooth in teeth]
    count = len(drafts[0].regions)
    least, fixed, seams = (
        np.ones(count + 1),
        distinct(np.concatenate([tooth.breaks for tooth in teeth])),
        list[Array](),
    )
    known = dict[bytes, Array]()
    for _ in range(MAX_ROUNDS):
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
    """Return the stations of the nodes on the R + 1 seams, dense enough for the links of all drafts on both sides.

    The last seam of a whole tooth is the first seam of the next.

    - least: least number of cells (R + 1,).
    - fixed: stations that are nodes.
    - known: stations of earlier rounds by their density, which are reused.
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
    """A tooth that is being meshed."""

    #: the tooth
    tooth: Tooth
    #: links to mesh
    regions: tuple[Region, ...]
    #: mm
    tolerance: float
    #: second forms of the links
    forms: Forms
    #: plan of each link
    plans: list[LinkPlan]
    #: deviation of each link in the last round, mm
    missed: list[float]
    #: number of rounds of each link in which more lines did not reduce the deviation
    worse: list[int]
    #: last mesh of each link
    meshes: dict[int, LinkMesh]
    #: links whose last mesh does not follow their plan
    stale: set[int]
    #: sections that were trimmed last
    trimmed: Sections | None = None

    @staticmethod
    def of(tooth: Tooth, regions: tuple[Region, ...], tolerance: float) -> _Draft:
        """Return the draft with its plans, before the first mesh."""
        forms, allowed = Forms.of(tooth, regions), SAMPLED_SHARE * tolerance
        straight, whole = tooth.face_breaks.size > 0, len(regions) == len(tooth.regions)
        plans = link_plans(forms, SAMPLED_SHARE * allowed, allowed, straight=straight, whole=whole)
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
        """Return the last meshes of all links, in order."""
        return tuple(self.meshes[k].patch for k in range(len(self.regions)))

    def thin(self) -> tuple[PatchMesh, ...]:
        """Return the meshes of all links, thinned where they have far more triangles than needed."""
        allowed, meshes = SAMPLED_SHARE * self.tolerance, [self.meshes[k] for k in range(len(self.regions))]
        taken = np.array([len(mesh.patch.triangles) for mesh in meshes])
        seams = [int(mesh.cells[0] + mesh.cells[-1]) for mesh in meshes]
        fewest = np.array([self.forms.fewest(k, allowed, cells) for k, cells in enumerate(seams)])
        more = taken > fewest
        thinned = (taken > MAX_LINK_EXCESS * fewest) & (taken[more].sum() > MAX_TOOTH_EXCESS * fewest[more].sum())
        patches = [mesh.patch for mesh in meshes]
        # links with a large excess first; if the tooth still has too many triangles, all links with more than enough
        for rest in (thinned, (taken > ENOUGH_RATIO * fewest) & ~thinned):
            for k in np.flatnonzero(rest).tolist():
                enough = int(ENOUGH_RATIO * fewest[k]) - 6
                # if seams are thinned later, a link that is thinned to its limit would leave them less room
                patches[k] = self._image(k, patches) or self._thin(k, enough, again=taken.sum() > MAX_SEAM_TRIANGLES)
            left = np.array([len(patch.triangles) for patch in patches])
            if not thinned.any() or left[more].sum() <= MAX_TOOTH_EXCESS * fewest[more].sum():
                break
        return tuple(patches)

    def thin_seams(self, patches: tuple[PatchMesh, ...]) -> tuple[PatchMesh, ...]:
        """Return the links with thinned seams, if they have few triangles and yet far more than needed."""
        allowed, taken = (
            THINNED_SHARE * SAMPLED_SHARE * self.tolerance,
            np.array([len(patch.triangles) for patch in patches]),
        )
        curved = np.array([region in (*FLANK_REGIONS.values(), *FILLET_REGIONS.values()) for region in self.regions])
        if taken.sum() > MAX_SEAM_TRIANGLES or not curved.any():
            return patches
        cells = self.forms.seam_cells(allowed, whole=len(self.regions) == len(self.tooth.regions))
        fewest = np.array([self.forms.fewest(k, allowed, int(cells[k] + cells[k + 1])) for k in range(len(patches))])
        least = fewest[curved].sum()
        if taken[curved].sum() <= MAX_CURVED_EXCESS * least:
            return patches
        meshes = [self.meshes[k] for k in range(len(patches))]
        # seams at sharp form points need more nodes than their flanks and fillets: they stay
        sharp = np.array([mesh.form_point > 0.0 for mesh in meshes])
        held = np.array([bool(sharp[k] or sharp[k - 1]) for k in range(len(patches))])
        enough = int(ENOUGH_RATIO * least + taken[~curved].sum())
        return thin_seams(self.tooth, patches, self.forms, held, allowed, enough)

    def _image(self, k: int, patches: list[PatchMesh]) -> PatchMesh | None:
        """Return the thinned mesh of an earlier link on its image, link k, if it keeps the tolerance there; else None."""
        assert self.trimmed is not None
        for other in range(k):
            if patches[other] is not self.meshes[other].patch:
                both = self.meshes[k], self.meshes[other]
                patch = image(self.tooth, *both, patches[other], self.trimmed, (self.forms, k, other))
                if patch is not None and patch.deviation <= SAMPLED_SHARE * self.tolerance:
                    return patch
        return None

    def _thin(self, k: int, enough: int, *, again: bool) -> PatchMesh:
        """Return the thinned mesh of link k."""
        allowed = THINNED_SHARE * SAMPLED_SHARE * self.tolerance
        assert self.trimmed is not None
        return thin_link(self.tooth, self.meshes[k], self.trimmed, self.forms, k, allowed, enough, again=again)

    def mesh(self, seams: list[Array], moved: list[bool], least: Array, fixed: Array) -> None:
        """Mesh the links whose plans or seams have changed, and refine the plans of those that miss the tolerance.

        - seams: stations of the nodes on each seam.
        - moved: True for seams whose stations have changed.
        - least: least number of cells (R + 1,) of the seams, which is raised where needed.
        - fixed: stations that are nodes of all lines.
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
        t = distinct(np.concatenate([*seams, *drawn, fixed]))
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
                SAMPLED_SHARE * self.tolerance,
                self.meshes.get(k),
            )
            self.meshes[k] = mesh
            self._refine(k, mesh, least)

    def _refine(self, k: int, mesh: LinkMesh, least: Array) -> None:
        """Refine the plan of a link if its mesh misses the tolerance; the mesh is then stale."""
        allowed, plan = SAMPLED_SHARE * self.tolerance, self.plans[k]
        if mesh.worst <= allowed:
            return
        plain = plan.otherwise
        self.worse[k] += mesh.worst > IMPROVEMENT_SHARE * self.missed[k]
        if plain is not None and self.worse[k] > (
            PATIENT_ROUNDS if plain.triangles > DEAR_PLAN_RATIO * len(mesh.patch.triangles) else 0
        ):
            # more lines along the shear made the deviation larger: the plan without shear takes over
            self.plans[k] = plain
            self.stale.add(k)
            return
        first, self.missed[k] = self.missed[k] == np.inf, mesh.worst
        # at least about one more cell on a line: a few percent of few cells would be none
        factor = np.maximum(1.02 * np.sqrt(mesh.lines / allowed), 1.0 + 1.2 / mesh.cells)
        factor = np.where(mesh.lines > allowed, np.minimum(factor, 2.0), 1.0)
        for seam, line in ((k, 0), (k + 1, -1)):
            if factor[line] > 1.0:
                least[seam] = max(least[seam], np.ceil(mesh.cells[line] * factor[line]), mesh.cells[line] + 1.0)
        if (factor[1:-1] > 1.0).any():
            plan = plan.with_more_nodes(mesh.s[1:-1], factor[1:-1])
        # strips count only between lines that keep the tolerance
        strips = np.where(np.maximum(mesh.lines[1:], mesh.lines[:-1]) <= allowed, mesh.strips, 0.0)
        if (strips > allowed).any():
            wanted = len(mesh.patch.triangles) * (1.0 + 0.5 * np.mean(strips > allowed))
            # the plan without shear, if it needs far fewer triangles
            if plain is not None and plain.triangles < CHEAP_PLAN_RATIO * wanted:
                plan = plain
            else:
                plan = replace(plan, across=denser(mesh.s, strips, allowed, even=first))
        if plan is not self.plans[k]:
            self.plans[k] = plan
            self.stale.add(k)
