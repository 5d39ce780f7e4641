"""Blanks as CAD solids with named faces, and their outlines as sections: the half section of a turned blank, or the bar."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from gearmesh.cad.contours.curves import Contour
from gearmesh.cad.occ import edge as edge_between
from gearmesh.cad.occ import face as face_on
from gearmesh.cad.occ import mapped_shapes, point, spline_curve, straight_edge, vertex, wire
from gearmesh.cad.section import MemberSection, section_spline
from gearmesh.cad.solid_part import whole_part
from gearmesh.cad.step import NamedFace, Part, require_occ
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.plane.curves import PlaneArc, PlaneCurve, PlaneLine, lines_through
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Region
from gearmesh.teeth.turned_blank import BLANK_REGIONS, BarBlank, TipCurve, TurnedBlank, blank_of

#: name of the contour of a blank
BLANK_CONTOUR = "blank"
#: length of the axis beyond the outline, as a share of the length of the outline
AXIS_OVERRUN_SHARE = 0.05


def blank_section(member: Member, tolerance: float) -> MemberSection:
    """Return the outline of a member's blank within a tolerance, mm: over (z, rho) with the axis; of a bar over (x, y).

    Raises NoSolutionError if the tolerance is not met.
    """
    blank = blank_of(member)
    if isinstance(blank, BarBlank):
        corners = blank.outline
        lines = lines_through([*corners, corners[0]])
        return MemberSection(member.name, float(blank.stations[:2].mean()), (Contour(BLANK_CONTOUR, lines, True),), 0.0)
    curves, deviation = _outline(blank, tolerance)
    z = np.array([(curve.start[0], curve.end[0]) for curve in curves])
    beyond = AXIS_OVERRUN_SHARE * float(np.ptp(z))
    axis = PlaneLine(np.array([z.min() - beyond, 0.0]), np.array([z.max() + beyond, 0.0]))
    return MemberSection(member.name, None, (Contour(BLANK_CONTOUR, tuple(curves), True),), deviation, axis)


def _outline(blank: TurnedBlank, tolerance: float) -> tuple[list[PlaneCurve], float]:
    """Return the curves of a half section, and the deviation (mm) of its splines."""
    curves, deviation = list[PlaneCurve](), 0.0
    for band in blank.bands:
        curve: PlaneCurve | TipCurve = band.curve
        if isinstance(curve, TipCurve):
            curve, missed = section_spline(curve.at, band.region, tolerance)
            deviation = max(deviation, missed)
        curves.append(curve)
    return curves, deviation


def blank_part(member: Member, tolerance: float) -> tuple[Part, float]:
    """Return the blank of a member as a CAD solid within a tolerance, mm, and its deviation.

    Raises DesignError for an invalid solid, NoSolutionError if the tolerance is not met, OutputError without OpenCASCADE.
    """
    require_occ()
    blank, name = blank_of(member), f"{member.name}_blank"
    if isinstance(blank, BarBlank):
        return whole_part(name, _plane_faces(blank.faces), (*member.body_regions, Region.LAND)), 0.0
    return turned_part(replace(blank, name=name), tolerance)


def turned_part(blank: TurnedBlank, tolerance: float) -> tuple[Part, float]:
    """Return a turned body as a CAD solid with its name within a tolerance, mm, and its deviation; raises as `blank_part`."""
    from OCP.BRepPrimAPI import BRepPrimAPI_MakeRevol
    from OCP.Geom import Geom_Plane
    from OCP.gp import gp_Ax1, gp_Ax3, gp_Dir

    # a face for each edge, in order; none for an edge on the axis
    regions_of_faces = tuple(band.region for band in blank.bands if band.curve.at(np.array([0.5]))[0, 1] > 0.0)
    curves, deviation = _outline(blank, tolerance)
    corners = [vertex((curve.start[1], 0.0, curve.start[0])) for curve in curves]
    pairs = zip(curves, corners, (*corners[1:], corners[0]), strict=True)
    edges = [_edge(curve, *between) for curve, *between in pairs]
    # the plane y = 0, in which (z, rho) is counterclockwise about y
    plane = Geom_Plane(gp_Ax3(point(np.zeros(3)), gp_Dir(0.0, 1.0, 0.0), gp_Dir(0.0, 0.0, 1.0)))
    swept = BRepPrimAPI_MakeRevol(_filled(plane, edges), gp_Ax1(point(np.zeros(3)), gp_Dir(0.0, 0.0, 1.0)))
    faces = _named(swept.Shape(), regions_of_faces)
    return whole_part(blank.name, faces, tuple(BLANK_REGIONS)), deviation


def _plane_faces(faces: list[tuple[Region, Array]]) -> tuple[NamedFace, ...]:
    """Return plane faces from polygons (N, 3), mm, by region, named by region and number; they share their edges."""
    from OCP.Geom import Geom_Plane
    from OCP.gp import gp_Dir

    vertices, edges = dict[tuple[float, ...], Any](), dict[tuple[Any, ...], Any]()

    def side(a: tuple[float, ...], b: tuple[float, ...]) -> tuple[Any, bool]:
        """Return the edge between two corners, and True if it begins at the first."""
        for corner in (a, b):
            vertices.setdefault(corner, vertex(corner))
        if (b, a) in edges:
            return edges[b, a], False
        if (a, b) not in edges:
            edges[a, b] = straight_edge(vertices[a], vertices[b])
        return edges[a, b], True

    counts, made = dict[Region, int](), list[NamedFace]()
    for region, ring in faces:
        corners = [tuple(corner) for corner in ring.tolist()]
        normal = np.cross(ring[1] - ring[0], ring[-1] - ring[0])
        plane = Geom_Plane(point(ring[0]), gp_Dir(*normal.tolist()))
        counts[region] = counts.get(region, 0) + 1
        sides = [side(a, b) for a, b in zip(corners, (*corners[1:], corners[0]), strict=True)]
        made.append(NamedFace(face_on(plane, [wire(*sides)], True), f"{region}_{counts[region]}", region))
    return tuple(made)


def _filled(plane: Any, edges: list[Any]) -> Any:
    """Return the face of a plane within edges that go round it counterclockwise."""
    return face_on(plane, [wire(*((edge, True) for edge in edges))], True)


def _edge(curve: PlaneCurve, start: Any, end: Any) -> Any:
    """Return the edge of a curve over (z, rho) in the plane y = 0."""
    from OCP.Geom import Geom_Circle
    from OCP.gp import gp_Ax2, gp_Dir

    if isinstance(curve, PlaneLine):
        return straight_edge(start, end)
    if isinstance(curve, PlaneArc):
        (z, rho), sense = curve.centre, float(np.sign(curve.width))
        along = gp_Dir(float(np.sin(curve.first)), 0.0, float(np.cos(curve.first)))
        circle = Geom_Circle(gp_Ax2(point((rho, 0.0, z)), gp_Dir(0.0, sense, 0.0), along), curve.radius)
        return edge_between(circle, start, end, 0.0, abs(curve.width))
    control: Array = np.column_stack((curve.control[:, 1], np.zeros(len(curve.control)), curve.control[:, 0]))  # type: ignore[attr-defined]
    return edge_between(spline_curve(control, curve.knots), start, end, 0.0, 1.0)  # type: ignore[attr-defined]


def _named(solid: Any, regions: tuple[Region, ...]) -> tuple[NamedFace, ...]:
    """Return the faces of a solid, whose regions are given in their order, named by region and number."""
    from OCP.TopoDS import TopoDS

    found, counts, faces = mapped_shapes(solid, "FACE"), dict[Region, int](), list[NamedFace]()
    for k, region in zip(range(1, found.Extent() + 1), regions, strict=True):
        counts[region] = counts.get(region, 0) + 1
        faces.append(NamedFace(TopoDS.Face(found.FindKey(k)), f"{region}_{counts[region]}", region))
    return tuple(faces)
