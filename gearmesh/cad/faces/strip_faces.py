"""The faces of the chamfers along an end face, between the edges in which the teeth end and those of the end face's outline."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from gearmesh.cad.brep import SplineTooth, StripPatch
from gearmesh.cad.faces.drawn_face import DrawnFace, Sides
from gearmesh.cad.occ import edge, point_edge, spline_curve, vertex
from gearmesh.cad.step import NamedFace
from gearmesh.cad.turned import Loop, Trace
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.levels import station_normal
from gearmesh.teeth.blank.body import end_edges

#: moves a curve or surface of tooth 1 to another tooth, by how many pitches
Move = Callable[[Any, int], Any]


def strip_faces(
    teeth: SplineTooth, end: int, under: tuple[list[Any], list[Any]], move: Move
) -> tuple[list[NamedFace], Loop]:
    """The faces of the chamfers of all teeth at the toe (0) or heel (1), and the loop of the end face's outline.

    `under`: vertices and edges of the section under them, round all teeth.
    """
    patches, (corners, below) = teeth.strips[end], under
    count, links = len(patches), len(teeth.links)
    total = teeth.count * count
    inner = [corners[(k * links + patch.column) % len(corners)] for k in range(teeth.count) for patch in patches]
    outer = _outline_vertices(teeth, patches)
    region = end_edges(teeth.tooth.blank.axial)[end]
    drawn = [DrawnFace.of_spline(region, (0, 1), patch.net, outward=teeth.outward) for patch in patches]
    lines, above = list[Any](), list[Any]()
    for n in range(total):
        k, j = divmod(n, count)
        patch, along = patches[j], move(spline_curve(patches[j].net[0][0], patches[j].t_knots), k)
        ends = (inner[n], outer[n]) if end else (outer[n], inner[n])
        lines.append(edge(along, *ends, 0.0, 1.0))
        last = float(patch.s_knots[-1])
        if patch.pointed:
            above.append(point_edge(outer[n], last))
        else:
            curve = move(spline_curve(patch.control[:, 0], patch.s_knots), k)
            above.append(edge(curve, outer[n], outer[(n + 1) % total], 0.0, last))
    faces = []
    for n in range(total):
        k, j = divmod(n, count)
        patch, part = patches[j], drawn[j]
        low = point_edge(inner[n], float(patch.s_knots[-1])) if patch.link is None else below[k * links + patch.link]
        toe, heel = (low, above[n]) if end else (above[n], low)
        shape = part.face(move(part.surface, k), Sides(toe, [lines[(n + 1) % total]], heel, [lines[n]]))
        faces.append(NamedFace(shape, f"{region}_{k + 1}{teeth.half.suffix}", region, 0 if k else teeth.count))
    edges = [made for n, made in enumerate(above) if not patches[n % count].pointed]
    return faces, _loop(teeth, patches, edges, outer[0])


def _outline_vertices(teeth: SplineTooth, patches: tuple[StripPatch, ...]) -> list[Any]:
    """Where every patch of every tooth begins in the outline: one that is a point there where the next one does."""
    wide = [patch for patch in patches if not patch.pointed]
    numbers = np.cumsum([0, *(not patch.pointed for patch in patches[:-1])])
    rotations = Rigid.about_z(np.arange(teeth.count) * teeth.step).rotation
    vertices = [vertex(rotation @ patch.control[0, 0]) for rotation in rotations for patch in wide]
    places = np.arange(teeth.count)[:, None] * len(wide) + numbers
    return [vertices[place % len(vertices)] for place in places.ravel().tolist()]


def _loop(teeth: SplineTooth, patches: tuple[StripPatch, ...], edges: list[Any], start: Any) -> Loop:
    """The outline round all teeth."""
    wide = [patch for patch in patches if not patch.pointed]
    first: Array = wide[0].control[0, 0]
    angle, traces = float(np.arctan2(first[1], first[0])), tuple[Trace, ...]()
    if station_normal(teeth.tooth.blank.axial)[0] != 0.0:
        own = [Trace.of(patch.s_knots, patch.control[:, 0], angle) for patch in wide]
        traces = tuple(trace.turn(k * teeth.step) for k in range(teeth.count) for trace in own)
    return Loop(tuple(edges), start, float(np.hypot(first[0], first[1])), float(first[2]), angle, traces)
