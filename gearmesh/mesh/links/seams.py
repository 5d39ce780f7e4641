"""Thinning of all links of a tooth together, including the nodes on the seams between them.

A seam has as many nodes as its finer link needs, at stations that suit neither link once the links are thinned. A link of
a few dozen triangles has half of its nodes on seams. Here all links form one net: link k has s from 2 k to 2 k + 1, so each
link keeps its own second form. A node on a seam occurs twice, once on either side; these twins move along t together and
collapse together. The rest is as in `thinning`, with more patience:

- edges are tried whose collapse misses the tolerance by more,
- diagonals turn while nodes move,
- long edges are judged by the second form at their ends, too.

While nodes move, the ends of the links are straight between END_STATIONS stations. At the end all nodes are put on the exact
sections.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import field, replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, distinct, dot
from gearmesh.mesh.deviation.edges import between_wedges
from gearmesh.mesh.links.collapse import Index
from gearmesh.mesh.links.forms import Forms
from gearmesh.mesh.links.lines import between
from gearmesh.mesh.links.prediction import Prediction
from gearmesh.mesh.links.relaxation import Patience
from gearmesh.mesh.links.thinning import FIXED_NODE, HEEL_NODE, INNER_NODE, SEAM_NODE, TOE_NODE, Net
from gearmesh.mesh.patch import LinkNodes, PatchMesh, distance, trim
from gearmesh.records import dataclass
from gearmesh.teeth.section import breaks
from gearmesh.teeth.tooth import Tooth

#: number of stations, besides those of the seams, between which the ends of links are straight
END_STATIONS = 65
#: least cosine of the angle between two surfaces that join smoothly; at sharper edges chords must keep the tolerance
SMOOTH_COSINE = 0.95
#: patience of the first merging of edges and of two more, after all nodes have moved
MERGE_PATIENCES = (Patience(far=4.0, many=400, stages=((2, 3.0), (4, 2.0), (8, 1.2), (8, 1.02)), turning=True),) * 3


def thin_seams(
    tooth: Tooth,
    patches: Sequence[PatchMesh],
    forms: Forms,
    held: NDArray[np.bool_],
    tolerance: float,
    enough: int,
) -> tuple[PatchMesh, ...]:
    """Return all links of a tooth, or some in a row, with fewer triangles within `tolerance`, mm.

    - forms: second forms of the links.
    - held: True (R,) for links whose first seam stays.
    - enough: number of triangles at which thinning stops.

    Drawn links and their seams stay.
    """
    net = _ToothNet.of_patches(tooth, patches, forms, held, tolerance)
    net.turn()
    net.merge(MERGE_PATIENCES, enough)
    thinned = net.patches(patches)
    most = max(tolerance, *(patch.deviation for patch in patches))
    return tuple(patches) if max(patch.deviation for patch in thinned) > most else thinned


@dataclass
class _ToothNet(Net):
    """Net of all links of a tooth; links with surfaces are thinned."""

    #: meshes of the links before thinning
    links: tuple[PatchMesh, ...] = ()
    #: keys of the chords of the seams before thinning, see `_chord_key`
    chords: Array = field(default_factory=lambda: np.zeros(0))

    @staticmethod
    def of_patches(
        tooth: Tooth, patches: Sequence[PatchMesh], forms: Forms, held: NDArray[np.bool_], tolerance: float
    ) -> _ToothNet:
        """Return the net of the links of a tooth; the arguments are those of `thin_seams`."""
        count, whole = len(patches), len(patches) == len(tooth.regions)
        chain = [tooth.chain[patch.region] for patch in patches]
        smooth = [link.surface is not None for link in chain]
        begins = np.cumsum([0, *(len(patch.points) for patch in patches)])
        # twins: nodes on either side of a seam between links with surfaces
        twin = np.full(begins[-1], -1)
        for k in range(count) if whole else range(1, count):
            if smooth[k] and smooth[k - 1] and not held[k]:
                here = begins[k] + patches[k].nodes.line(0.0)
                there = begins[k - 1 if k else count - 1] + patches[k - 1].nodes.line(1.0)
                twin[here], twin[there] = there, here
        # all links in one net: link k has s from 2 k to 2 k + 1
        st = np.concatenate([_place(patch, k) for k, patch in enumerate(patches)])
        s, t = np.concatenate([patch.nodes.s for patch in patches]), st[:, 1]
        crease = np.zeros(len(st), dtype=bool)
        for k, link in enumerate(chain):
            own = slice(begins[k], begins[k + 1])
            crease[own] = np.isin(s[own], breaks(link)) | np.isin(t[own], tooth.creases(patches[k].region))
        # kinds of nodes: on the end faces, on free seams, fixed on creases and on other seams, or inner
        kind = np.where(t == 0.0, TOE_NODE, np.where(t == 1.0, HEEL_NODE, INNER_NODE))
        seam = (s == 0.0) | (s == 1.0)
        kind[seam] = np.where((twin >= 0) & (kind == INNER_NODE), SEAM_NODE, FIXED_NODE)[seam]
        kind[crease] = FIXED_NODE
        kind[(twin >= 0) & crease[twin]] = FIXED_NODE
        points, normals = (
            np.concatenate([getattr(patch.nodes, name) for patch in patches]) for name in ("points", "normals")
        )
        parameters = [
            np.full((len(patch.points), 2), np.nan) if patch.nodes.parameters is None else patch.nodes.parameters
            for patch in patches
        ]
        # sharp edges at seams; not where the next tooth begins, because its normals are turned by the pitch
        edge = (
            (twin >= 0)
            & (dot(normals, normals[twin]) < SMOOTH_COSINE)
            & (st[:, 0] > 0.0)
            & (st[:, 0] < 2.0 * count - 1.0)
        )
        nodes = LinkNodes(tooth, patches[0].region, st[:, 0], t, points, normals, np.concatenate(parameters))
        seams = np.concatenate([patch.nodes.t[patch.nodes.line(0.0)] for patch in patches])
        trimmed = tooth.sections(
            distinct(np.concatenate((np.linspace(0.0, 1.0, END_STATIONS), seams, tooth.face_breaks)))
        )

        def place(s: Array, t: Array) -> LinkNodes:
            """Return nodes on the surfaces at s, t of the net."""
            points, normals, parameters = np.empty((s.size, 3)), np.empty((s.size, 3)), np.empty((s.size, 2))
            for k, own in _by_link(s):
                local, region = s[own] - 2.0 * k, patches[k].region
                near = between(forms.second[k], local, t[own])
                part = LinkNodes.of(tooth, region, local, t[own], trimmed, near)
                points[own], normals[own], parameters[own] = part.points, part.normals, part.parameters
            return LinkNodes(tooth, patches[0].region, s, t, points, normals, parameters)

        triangles = np.concatenate([patch.triangles + begins[k] for k, patch in enumerate(patches) if smooth[k]])
        net = _ToothNet(
            nodes,
            st,
            triangles,
            np.zeros(len(triangles)),
            kind,
            np.ones(len(st), dtype=bool),
            place,
            _prediction(forms, range(count)),
            crease,
            tolerance,
            twin,
            edge,
            links=tuple(patches),
        )
        net.chords = _chord_key(st[:, 0], t, triangles, np.roll(triangles, -1, axis=1)).ravel()
        net.errors = net.miss(nodes, triangles, crease)
        return net

    def miss(self, nodes: LinkNodes, triangles: Index, crease: NDArray[np.bool_]) -> Array:
        errors = np.empty(len(triangles))
        for k, own in _by_link(nodes.s[triangles[:, 0]]):
            errors[own] = super().miss(self._local(nodes, k), triangles[own], crease)
        return errors

    def off_ends(self, nodes: LinkNodes, triangles: Index, edge: NDArray[np.bool_]) -> Array:
        """Return the distances of one link; new sides on sharp seams (`edge` (N,)) also by the heights over both surfaces."""
        off, after = super().off_ends(nodes, triangles, edge), np.roll(triangles, -1, axis=1)
        along = edge[triangles] & edge[after] & (nodes.s[triangles] == nodes.s[after])
        on, side = np.nonzero(along & ~np.isin(_chord_key(nodes.s, nodes.t, triangles, after), self.chords))
        if on.size:
            sides = np.stack((triangles[on, side], after[on, side]), axis=1)
            odd, last = nodes.s[sides] % 2.0 == 1.0, 2.0 * len(self.links) - 1.0
            there = self.place(
                (nodes.s[sides] + np.where(odd, 1.0, -1.0)).ravel() % (last + 1.0), nodes.t[sides].ravel()
            )
            heights, normals = self._heights(nodes, sides)
            twin_heights, twin_normals = self._heights(there, np.arange(2 * on.size).reshape(-1, 2))
            np.maximum.at(off, on, between_wedges(heights, twin_heights, dot(normals, twin_normals)))
        return off

    def _heights(self, nodes: LinkNodes, edges: Index) -> tuple[Array, Array]:
        """Return the heights (E,), mm, of the middles of edges (E, 2) over their surfaces, and the normals (E, 3) there."""
        heights, normals = np.empty(len(edges)), np.empty((len(edges), 3))
        for k, own in _by_link(nodes.s[edges[:, 0]]):
            near = self._local(nodes, k).middle(edges[own])
            heights[own], normals[own] = distance(near, nodes.points[edges[own]].mean(axis=1)), near.normals
        return heights, normals

    def _local(self, nodes: LinkNodes, k: int) -> LinkNodes:
        """Return all nodes with s counted on link k."""
        return replace(nodes, region=self.links[k].region, s=nodes.s - 2.0 * k)

    def patches(self, before: Sequence[PatchMesh]) -> tuple[PatchMesh, ...]:
        """Return the thinned links; drawn links are those `before`."""
        tooth, made = self.nodes.tooth, list(before)
        for k, own in _by_link(self.st[self.triangles[:, 0], 0]):
            used, corners = np.unique(self.triangles[own], return_inverse=True)
            triangles, region = corners.reshape(-1, 3), before[k].region
            s, t = self.st[used].T
            nodes = LinkNodes.on(tooth, region, s - 2.0 * k, trim(tooth, t))
            errors = super().miss(nodes, triangles, self.crease[used])
            off = self.off_ends(replace(nodes, s=s), triangles, self.edge[used])
            deviation = float(np.maximum(errors, off).max())
            made[k] = PatchMesh(nodes, triangles, nodes.middle(triangles).normals, deviation)
        return tuple(made)


def _chord_key(s: Array, t: Array, first: Index, last: Index) -> Array:
    """Return keys (...,) of chords on seams; different chords have different keys. `first`, `last` (...,): nodes at their ends."""
    key: Array = 4.0 * s[first] + (t[first] + t[last])
    return key


def _place(patch: PatchMesh, k: int) -> Array:
    """Return the places (N, 2) in the net of the nodes of link k."""
    return np.stack((patch.nodes.s + 2.0 * k, patch.nodes.t), axis=-1)


def _by_link(s: Array) -> list[tuple[int, Index]]:
    """Return the links that contain some of s (N,), each with the indices (K,) of these."""
    link = np.floor(0.5 * s).astype(int)
    return [(int(k), np.flatnonzero(link == k)) for k in distinct(link)]


def _prediction(forms: Forms, links: Sequence[int]) -> Prediction:
    """Return the prediction for a net of links, with gaps between them."""
    (_, rows, stations), extent = forms.face.shape, 2.0 * len(links) - 1.0
    steps = rows - 1
    table, outline = np.zeros((int(extent) * steps + 1, stations, 3)), np.zeros((2, int(extent) * steps + 1))
    for k in links:
        own = slice(2 * k * steps, (2 * k + 1) * steps + 1)
        table[own] = np.stack([form[k] for form in (forms.length, forms.twist, forms.face)], axis=-1)
        outline[:, own] = forms.outline[k]
    return Prediction(table, outline, extent, arched=True)
