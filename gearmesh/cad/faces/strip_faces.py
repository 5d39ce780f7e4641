"""Faces of the chamfers along an end face, between the ends of the teeth and the outline of the end face."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from gearmesh.cad.brep import SplineTooth, StripPatch
from gearmesh.cad.faces.drawn_face import DrawnFace, Sides
from gearmesh.cad.occ import edge, point_edge, spline_curve, vertex
from gearmesh.cad.step import NamedFace
from gearmesh.cad.turned import Loop, Trace
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.levels import station_normal
from gearmesh.records import dataclass
from gearmesh.teeth.blank.body import end_edges


@dataclass(frozen=True)
class StripRow:
    """Chamfers along an end face."""

    #: faces of the chamfers
    faces: list[NamedFace]
    #: vertices of the end face's outline, by the number of the patch that begins there
    outer: dict[int, Any]
    #: edges between outline and section, by the number of the patch that begins there
    lines: dict[int, Any]
    #: edges of the outline in order
    edges: list[Any]


def strip_faces(
    teeth: SplineTooth, end: int, under: tuple[list[Any], list[Any]], places: Sequence[Any]
) -> tuple[list[NamedFace], Loop]:
    """Return the faces of the chamfers of all teeth at the toe (0) or heel (1), and the outline of the end face.

    `under`: vertices and edges of the section under the chamfers, round all teeth.
    """
    region = end_edges(teeth.tooth.blank.axial)[end]
    drawn = [DrawnFace.of_spline(region, (0, 1), patch.net, outward=teeth.outward) for patch in teeth.strips[end]]
    row = strip_row(teeth, end, under, places, drawn)
    return row.faces, _loop(teeth, teeth.strips[end], row.edges, row.outer[0])


def strip_row(
    teeth: SplineTooth,
    end: int,
    under: tuple[list[Any], list[Any]],
    places: Sequence[Any],
    drawn: Sequence[DrawnFace],
    span: range | None = None,
) -> StripRow:
    """Build the chamfers of all teeth at the toe (0) or heel (1).

    - `under`: vertices and edges of the section under the chamfers
    - `places`: positions of the teeth, a gp_Trsf each
    - `drawn`: faces of the chamfer of tooth 1
    - `span`: numbers of the patches of a bar, which does not close round; None for all patches of a gear
    """
    patches, (corners, below) = teeth.strips[end], under
    count, links = len(patches), len(teeth.links)
    numbers = range(len(places) * count) if span is None else range(span.start, span.stop + 1)
    face_numbers = numbers if span is None else span
    region = end_edges(teeth.tooth.blank.axial)[end]
    vertices = _outline_vertices(patches, places)
    # edges between section and outline where patches begin
    inner, outer, lines = dict[int, Any](), {n: vertices[n] for n in numbers}, dict[int, Any]()
    for n in numbers:
        k, j = divmod(n, count)
        inner[n] = corners[(k * links + patches[j].column) % len(corners)]
        ends = (inner[n], outer[n]) if end else (outer[n], inner[n])
        curve = spline_curve(patches[j].net[0][0], patches[j].t_knots).Transformed(places[k])
        lines[n] = edge(curve, *ends, 0.0, 1.0)
    # faces with their edges along the chain; a side that is a point gets an edge without length
    faces, edges = list[NamedFace](), list[Any]()
    for n in face_numbers:
        k, j = divmod(n, count)
        patch, after, move = patches[j], numbers[(n - numbers.start + 1) % len(numbers)], places[k]
        last = float(patch.s_knots[-1])
        if patch.pointed:
            above = point_edge(outer[n], last)
        else:
            curve = spline_curve(patch.control[:, 0], patch.s_knots).Transformed(move)
            above = edge(curve, outer[n], outer[after], 0.0, last)
            edges.append(above)
        low = point_edge(inner[n], last) if patch.link is None else below[k * links + patch.link]
        toe, heel = (low, above) if end else (above, low)
        shape = drawn[j].face(drawn[j].surface.Transformed(move), Sides(toe, [lines[after]], heel, [lines[n]]))
        name, copies = f"{region}_{k + 1}{teeth.half.suffix}", 1 if span else 0 if k else teeth.count
        faces.append(NamedFace(shape, name, region, copies, k + 1))
    return StripRow(faces, outer, lines, edges)


def _outline_vertices(patches: tuple[StripPatch, ...], places: Sequence[Any]) -> list[Any]:
    """Return the vertices of the outline where the patches of all teeth begin; a pointed patch shares its vertex with the next."""
    wide = [patch for patch in patches if not patch.pointed]
    numbers = np.cumsum([0, *(not patch.pointed for patch in patches[:-1])])
    vertices = [vertex(patch.control[0, 0], place) for place in places for patch in wide]
    of = np.arange(len(places))[:, None] * len(wide) + numbers
    return [vertices[place % len(vertices)] for place in of.ravel().tolist()]


def _loop(teeth: SplineTooth, patches: tuple[StripPatch, ...], edges: list[Any], start: Any) -> Loop:
    """Return the outline round all teeth."""
    wide = [patch for patch in patches if not patch.pointed]
    first: Array = wide[0].control[0, 0]
    angle, traces = float(np.arctan2(first[1], first[0])), tuple[Trace, ...]()
    if station_normal(teeth.tooth.blank.axial)[0] != 0.0:
        own = [Trace.of(patch.s_knots, patch.control[:, 0], angle) for patch in wide]
        traces = tuple(trace.turn(k * teeth.step) for k in range(teeth.count) for trace in own)
    return Loop(tuple(edges), start, float(np.hypot(first[0], first[1])), float(first[2]), angle, traces)
