"""Toe or heel of a rack with spline patches: the outline of its end face, and its chamfers.

The chamfers continue along the half roots to the ends of the bar.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from gearmesh.cad.brep import SplineTooth, StripPatch
from gearmesh.cad.faces.drawn_face import DrawnFace, Sides
from gearmesh.cad.faces.strip_faces import strip_row
from gearmesh.cad.occ import edge, spline_curve, straight_edge, translation, vertex
from gearmesh.cad.step import NamedFace
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.teeth.blank.body import end_edges
from gearmesh.teeth.region import Region

#: knots of straight splines
STRAIGHT_KNOTS = np.array([0.0, 0.0, 1.0, 1.0])


@dataclass(frozen=True)
class HalfRoot:
    """Edges of the half root at one end of a bar, on toe or heel."""

    #: edge on the section under the chamfer
    root: Any
    #: edge in the end face
    rim: Any
    #: vertex at the end of the bar in the end face
    corner: Any
    #: point (3,) of this vertex, mm
    point: Array
    #: edge across the chamfer at the end of the bar, None without a chamfer
    side: Any = None


@dataclass(frozen=True)
class BarEnd:
    """Toe or heel of a bar."""

    #: faces of tooth 1
    teeth: SplineTooth
    #: 0 at the toe, 1 at the heel
    end: int
    #: edges of the end face's outline between the half roots
    edges: list[Any]
    #: faces of the chamfers
    faces: list[NamedFace]
    #: patches of the chamfer of tooth 1
    patches: tuple[StripPatch, ...] = ()
    #: vertices at the beginning and the end of the outline
    outer: tuple[Any, ...] = ()
    #: edges from these vertices to the section under the chamfer
    lines: tuple[Any, ...] = ()
    #: control polygons (T, 3) of these edges, mm, from toe to heel
    borders: tuple[Array, ...] = ()

    @staticmethod
    def of(teeth: SplineTooth, end: int, under: tuple[list[Any], list[Any]], ways: list[Array]) -> BarEnd:
        """Return toe (0) or heel (1) of a bar.

        - `under`: vertices and edges of the section under the chamfer, without the first root
        - `ways`: translations (3,) to all teeth, mm
        """
        patches, skipped = teeth.strips[end], int(teeth.links[0].region is Region.ROOT)
        if not patches:
            return BarEnd(teeth, end, under[1], [])
        every = [*ways, ways[-1] + teeth.tooth.joint.to(teeth.tooth.pitch_angle).translation]
        places = [translation(way) for way in every]
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
        """Return the half root at the first or the `last` end of the bar, and add the face of its chamfer.

        - `top`: vertex and point (3,) of the root at the end of the bar
        - `tooth`: vertex and point (3,) of the root at the tooth
        - `y`: distance of the end from the middle of the root before tooth 1, mm
        """
        ends = (tooth, top) if last else (top, tooth)
        if not self.patches:
            root = straight_edge(ends[0][0], ends[1][0])
            return HalfRoot(root, root, *top)
        patch, half = self.patches[0], self.teeth.half
        border = half.points(np.array(patch.net[0][0]))
        # the chamfer's border at the end of the bar: the border of the patch, moved across; control points may be beyond the face
        faces = np.array(self.teeth.tooth.blank.faces)
        first, beyond = self.teeth.tooth.root_middle(faces)
        border[:, 1] = y + first + (border[:, 2] - faces[0]) / (faces[1] - faces[0]) * (beyond - first)
        border = half.points(border)
        point = border[-1 if self.end else 0]
        corner = vertex(point)
        side = edge(
            spline_curve(border, patch.t_knots), *((top[0], corner) if self.end else (corner, top[0])), 0.0, 1.0
        )
        net = np.stack((self.borders[1], border) if last else (border, self.borders[0]))
        bounds = (self.outer[1], corner) if last else (corner, self.outer[0])
        low, high = (
            edge(spline_curve(net[:, k], STRAIGHT_KNOTS), *own, 0.0, 1.0)
            for k, own in zip((0, -1) if self.end else (-1, 0), ((ends[0][0], ends[1][0]), bounds), strict=True)
        )
        region = end_edges(self.teeth.tooth.blank.axial)[self.end]
        drawn = DrawnFace.of_net(region, (0, 1), (net, STRAIGHT_KNOTS, patch.t_knots), outward=self.teeth.outward)
        near, far = (self.lines[1], side) if last else (side, self.lines[0])
        toe, heel = (low, high) if self.end else (high, low)
        name = f"{region}_{self.teeth.tooth.teeth + 1 if last else 1}{half.suffix}"
        self.faces.append(NamedFace(drawn.face(drawn.surface, Sides(toe, [far], heel, [near])), name, region))
        return HalfRoot(low, high, corner, point, side)
