"""Toe or heel of a rack with spline patches: the outline of its end face, and the chamfers there, which go on along the half roots
to the ends of the bar."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from gearmesh.cad.brep import SplineTooth, StripPatch
from gearmesh.cad.faces.drawn_face import DrawnFace, Sides
from gearmesh.cad.faces.strip_faces import strip_row
from gearmesh.cad.occ import edge, spline_curve, straight_edge, translation, vertex
from gearmesh.cad.step import NamedFace
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.teeth.blank.body import end_edges
from gearmesh.teeth.region import Region

#: knots of straight splines
STRAIGHT = np.array([0.0, 0.0, 1.0, 1.0])


@dataclass(frozen=True)
class HalfRoot:
    """What is at one end of a bar: the edge of the half root there on the section under the chamfer, its edge in the end face, the
    vertex (and the point, mm) in which it ends there, and the edge from toe to heel between both ends, None without a chamfer."""

    root: Any
    rim: Any
    corner: Any
    point: Array
    side: Any = None


@dataclass(frozen=True)
class BarEnd:
    """Toe (`end` 0) or heel (1) of a bar: `edges` of the end face's outline between the half roots, and the `faces` of chamfers.

    Of chamfers `patches` of tooth 1, the vertices `outer` where the outline begins and ends, the edges `lines` from there to the
    section under it, and their control polygons (T, 3), mm, from toe to heel.
    """

    teeth: SplineTooth
    end: int
    edges: list[Any]
    faces: list[NamedFace]
    patches: tuple[StripPatch, ...] = ()
    outer: tuple[Any, ...] = ()
    lines: tuple[Any, ...] = ()
    borders: tuple[Array, ...] = ()

    @staticmethod
    def of(teeth: SplineTooth, end: int, under: tuple[list[Any], list[Any]], ways: list[Array]) -> BarEnd:
        """`under`: vertices and edges of the section there, from tooth 1's first link but a root on; `ways` (3,): to all teeth."""
        patches, skipped = teeth.strips[end], int(teeth.links[0].region is Region.ROOT)
        if not patches:
            return BarEnd(teeth, end, under[1], [])
        every = [*ways, ways[-1] + teeth.tooth.joint.to(teeth.tooth.pitch_angle).translation]
        places = [(translation(way), Rigid(np.eye(3), way)) for way in every]
        region = end_edges(teeth.tooth.blank.axial)[end]
        drawn = [DrawnFace.of_net(region, (0, 1), patch.net, outward=teeth.outward) for patch in patches]
        span = range(skipped, len(ways) * len(patches))
        whole = ([*[None] * skipped, *under[0]], [*[None] * skipped, *under[1]])
        row = strip_row(teeth, end, whole, places, drawn, span)
        ends = (span.start, span.stop)
        borders = [patches[n % len(patches)].net[0][0] + every[n // len(patches)] for n in ends]
        outer, lines = (tuple(of[n] for n in ends) for of in (row.outer, row.lines))
        return BarEnd(teeth, end, row.edges, row.faces, patches, outer, lines, tuple(borders))

    def half_root(self, last: int, top: tuple[Any, Array], tooth: tuple[Any, Array], y: float) -> HalfRoot:
        """At the first or `last` end of the bar, which is `y` (mm) from the middle of the root before tooth 1: `top`, vertex and
        point (3,) of the root there, and those of the `tooth`."""
        ends = (tooth, top) if last else (top, tooth)
        if not self.patches:
            root = straight_edge(ends[0][0], ends[1][0])
            return HalfRoot(root, root, *top)
        patch = self.patches[0]
        border = np.array(patch.net[0][0])
        # control points may be beyond the end face
        faces = np.array(self.teeth.tooth.blank.faces)
        first, beyond = self.teeth.tooth.root_middle(faces)
        border[:, 1] = y + first + (border[:, 2] - faces[0]) / (faces[1] - faces[0]) * (beyond - first)
        point = border[-1 if self.end else 0]
        corner = vertex(point)
        side = edge(
            spline_curve(border, patch.t_knots), *((top[0], corner) if self.end else (corner, top[0])), 0.0, 1.0
        )
        net = np.stack((self.borders[1], border) if last else (border, self.borders[0]))
        bounds = (self.outer[1], corner) if last else (corner, self.outer[0])
        low, high = (
            edge(spline_curve(net[:, k], STRAIGHT), *own, 0.0, 1.0)
            for k, own in zip((0, -1) if self.end else (-1, 0), ((ends[0][0], ends[1][0]), bounds), strict=True)
        )
        region = end_edges(self.teeth.tooth.blank.axial)[self.end]
        drawn = DrawnFace.of_net(region, (0, 1), (net, STRAIGHT, patch.t_knots), outward=self.teeth.outward)
        near, far = (self.lines[1], side) if last else (side, self.lines[0])
        toe, heel = (low, high) if self.end else (high, low)
        name = f"{region}_{self.teeth.tooth.teeth + 1 if last else 1}"
        self.faces.append(NamedFace(drawn.face(drawn.surface, Sides(toe, [far], heel, [near])), name, region))
        return HalfRoot(low, high, corner, point, side)
