"""Faces of revolution as OpenCASCADE faces: planes, cylinders and cones between closed loops round the z axis.

A loop is a list of edges in the sense of growing polar angle. A face on a cylinder or cone is cut open along a seam between the
first vertices of its two loops, which must lie on one generatrix. Every edge gets a curve in the surface's parameters (u, v): u is
the polar angle from the seam, v the length along the generatrix.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from gearmesh.cad.nodes import SPLINE_DEGREE
from gearmesh.cad.occ import (
    PRECISION_MM,
    edge,
    face,
    frame,
    point,
    spline_curve2d,
    straight2d,
    straight_edge,
    vertex,
    wire,
)
from gearmesh.errors import DesignError
from gearmesh.io.digits import parameters_on_grid, points_on_grid
from gearmesh.kernel.numeric.algebra import Array, distinct
from gearmesh.kernel.numeric.splines import SplineCurve
from gearmesh.kernel.plane.curves import PlaneArc, PlaneCurve
from gearmesh.records import dataclass
from gearmesh.teeth.blank.bores import ClosedLine

#: distance of a trace from its curve down to which it is refined
TRACE_TOLERANCE_MM = 1e-8
#: largest number of parts into which a span of a curve is divided for its trace
MAX_PARTS_PER_SPAN = 8
#: places on a span of a curve at which the distance of the trace is measured
PLACES_PER_SPAN = 16
#: tolerance of an edge over the largest measured distance: OpenCASCADE measures at other places
TOLERANCE_MARGIN = 2.0


@dataclass(frozen=True)
class Trace:
    """A curve in cylindrical coordinates.

    Two control points are the ends of an arc, whose parameter is the polar angle. The user of a trace knows the direction from
    which its angles count.
    """

    #: knots of the spline; of an arc 0 and its width, rad
    knots: Array
    #: control points (K, 3): polar angle, rho, z; rad and mm
    control: Array
    #: bound of the distance of the curve from the trace, mm
    miss: float = 0.0

    @staticmethod
    def arc(width: float, rho: float, z: float, start: float) -> Trace:
        """Return an arc of a width (rad) that starts at a polar angle."""
        return Trace(np.array([0.0, width]), np.array([(start, rho, z), (start + width, rho, z)]))

    @staticmethod
    def of(knots: Array, control: Array, angle: float) -> Trace:
        """Return the trace of a spline with control points (K, 3), mm, with polar angles from -pi to pi relative to `angle`.

        Its spans are divided into more and more parts until it is within TRACE_TOLERANCE_MM.
        """
        # the curve as it is drawn
        curve = SplineCurve(knots, points_on_grid(control), SPLINE_DEGREE)
        spans = distinct(knots)
        places = distinct(spans[:-1, None] + np.diff(spans)[:, None] * np.linspace(0.0, 1.0, PLACES_PER_SPAN + 1))
        wanted = curve(places)
        miss, trace = np.inf, None
        for pieces in range(1, MAX_PARTS_PER_SPAN + 1):
            inner = (spans[:-1, None] + np.diff(spans)[:, None] * np.arange(pieces) / pieces).ravel()[1:]
            refined = np.concatenate(
                (np.repeat(spans[0], SPLINE_DEGREE + 1), inner, np.repeat(spans[-1], SPLINE_DEGREE + 1))
            )
            # interpolate at the means of neighbouring knots (Greville points), which is stable for any knots
            at = np.array(
                [refined[k + 1 : k + SPLINE_DEGREE + 1].mean() for k in range(len(refined) - SPLINE_DEGREE - 1)]
            )
            at[0], at[-1] = spans[0], spans[-1]
            drawn = SplineCurve.through(at, _cylindrical(curve(at), angle), SPLINE_DEGREE, refined)
            polar, rho, z = np.moveaxis(drawn(places), -1, 0)
            drawn_points = np.stack((rho * np.cos(angle + polar), rho * np.sin(angle + polar), z), axis=-1)
            was, miss = miss, TOLERANCE_MARGIN * float(np.linalg.norm(drawn_points - wanted, axis=-1).max())
            if trace is None or miss < was:
                trace = Trace(refined, parameters_on_grid(drawn.control), miss)
            if miss <= TRACE_TOLERANCE_MM:
                break
        assert trace is not None
        return trace

    def turn(self, angle: float) -> Trace:
        """Return the trace turned round the axis by an angle (rad)."""
        return Trace(self.knots, self.control + np.array([angle, 0.0, 0.0]), self.miss)


def _cylindrical(r: Array, angle: float) -> Array:
    x, y, z = np.moveaxis(r, -1, 0)
    polar = (np.arctan2(y, x) - angle + np.pi) % (2.0 * np.pi) - np.pi
    return np.stack((polar, np.hypot(x, y), z), axis=-1)


@dataclass(frozen=True)
class TurnedSurface:
    """The cylinder or cone about z through two circles, as an OpenCASCADE surface with parameters (u, v)."""

    #: OpenCASCADE surface
    surface: Any
    #: point (rho, z) from which v counts the length along the generatrix, mm
    foot: Array
    #: unit vector (2,) of the generatrix in (rho, z): away from the axis, on a cylinder upwards
    generatrix: Array
    #: sense of u: 1 counterclockwise, -1 clockwise
    axis: float
    #: polar angle from which u counts, rad
    angle: float

    @staticmethod
    def through(one: Array, other: Array, angle: float) -> TurnedSurface:
        """Return the surface through two circles (rho, z), mm, with u counted from a polar angle, rad."""
        from OCP.Geom import Geom_ConicalSurface, Geom_CylindricalSurface

        cylinder = abs(one[0] - other[0]) <= PRECISION_MM
        place = 1 if cylinder else 0
        low, high = (one, other) if one[place] < other[place] else (other, one)
        rise, widening = float(high[1] - low[1]), 0.0 if cylinder else float(high[0] - low[0])
        axis = 1.0 if rise > 0.0 else -1.0
        at = frame((0.0, 0.0, float(low[1])), axis, angle)
        if cylinder:
            surface = Geom_CylindricalSurface(at, float(low[0]))
        else:
            surface = Geom_ConicalSurface(at, float(np.arctan2(widening, abs(rise))), float(low[0]))
        return TurnedSurface(surface, np.array(low), np.array([widening, rise]) / np.hypot(widening, rise), axis, angle)

    def length(self, rho: float, z: float) -> float:
        """Return v of a circle."""
        return float((np.array([rho, z]) - self.foot) @ self.generatrix)

    def curve(self, trace: Trace, offset: float = 0.0) -> Any:
        """Return the curve in (u, v) of a trace whose angles are counted from `angle` + `offset`.

        For a clockwise surface u counts back from a full turn.
        """
        # summed one by one: kernels of matrices round differently from processor to processor
        along = (trace.control[:, 1:] - self.foot) * self.generatrix
        polar, v = trace.control[:, 0] + offset, along[:, 0] + along[:, 1]
        u = polar if self.axis > 0.0 else 2.0 * np.pi - polar
        if len(u) == 2:
            return straight2d((float(u[0]), float(v[0])), (float(np.sign(u[1] - u[0])), 0.0))
        return spline_curve2d(np.stack((u, v), axis=-1), trace.knots)


@dataclass(frozen=True)
class Loop:
    """A closed line of edges round the axis, in the sense of growing polar angle."""

    #: edges in order
    edges: tuple[Any, ...]
    #: first vertex
    start: Any
    #: radius of the circle, or of the first vertex, mm
    rho: float
    #: height of the circle, or of the first vertex, mm
    z: float
    #: polar angle of the first vertex, rad
    angle: float
    #: a trace for each edge, with angles relative to `angle`; empty for a circle
    traces: tuple[Trace, ...] = ()


def circle(rho: float, z: float, angle: float) -> Loop:
    """Return a full circle that starts at a polar angle."""
    from OCP.Geom import Geom_Circle

    start = vertex((rho * np.cos(angle), rho * np.sin(angle), z))
    curve = Geom_Circle(frame((0.0, 0.0, z), 1.0, angle).Ax2(), rho)
    return Loop((edge(curve, start, start, 0.0, 2.0 * np.pi),), start, rho, z, angle)


def plane_face(outer: Loop, inner: Loop | None, up: bool, holes: Sequence[Any] = ()) -> Any:
    """Return the plane face across the axis between two loops, or within one loop.

    `up`: True if the material is below the face; `holes`: wires of holes in it.
    """
    from OCP.Geom import Geom_Plane

    wires = [wire(*((edge, True) for edge in outer.edges))]
    if inner is not None:
        wires.append(wire(*((edge, False) for edge in reversed(inner.edges))))
    wires += holes
    return face(Geom_Plane(frame((0.0, 0.0, outer.z), 1.0, 0.0)), wires, up)


def turned_face(near: Loop, far: Loop, outward: bool) -> Any:
    """Return the face on a cylinder or cone between two loops; `outward`: True if the material is on the side of the axis.

    Raises DesignError if the loops do not begin on one generatrix.
    """
    from OCP.BRep import BRep_Builder
    from OCP.Geom import Geom_Line
    from OCP.gp import gp_Dir
    from OCP.TopLoc import TopLoc_Location

    if abs(np.angle(np.exp(1j * (near.angle - far.angle)))) > 1e-9:
        raise DesignError("body", reason="its profile must have a plane face between the end faces of toe and heel")
    turned = TurnedSurface.through(np.array([near.rho, near.z]), np.array([far.rho, far.z]), near.angle)
    low, high = sorted((near, far), key=lambda loop: turned.length(loop.rho, loop.z))
    length = turned.length(high.rho, high.z)
    # parameter curves of both loops, then of the seam, which has two: at u = 2 pi and at u = 0
    builder, here = BRep_Builder(), TopLoc_Location()
    for loop in (low, high):
        traces = loop.traces or (Trace.arc(2.0 * np.pi, loop.rho, loop.z, 0.0),)
        for drawn, trace in zip(loop.edges, traces, strict=True):
            builder.UpdateEdge(drawn, turned.curve(trace), turned.surface, here, max(PRECISION_MM, trace.miss))
    across, up = turned.generatrix
    direction = np.array([across * np.cos(low.angle), across * np.sin(low.angle), up])
    foot = (low.rho * np.cos(low.angle), low.rho * np.sin(low.angle), low.z)
    seam = edge(Geom_Line(point(foot), gp_Dir(*map(float, direction))), low.start, high.start, 0.0, length)
    sides = [straight2d((u, 0.0), (0.0, 1.0)) for u in (2.0 * np.pi, 0.0)]
    builder.UpdateEdge(seam, *sides, turned.surface, here, PRECISION_MM)
    with_u = turned.axis > 0.0
    round_low = [(edge, with_u) for edge in (low.edges if with_u else low.edges[::-1])]
    round_high = [(edge, not with_u) for edge in (high.edges[::-1] if with_u else high.edges)]
    return face(turned.surface, [wire(*round_low, (seam, True), *round_high, (seam, False))], outward)


@dataclass(frozen=True)
class Prism:
    """The walls of an opening along the axis between two levels."""

    #: edges round the lower and the upper level
    edges: tuple[tuple[Any, ...], tuple[Any, ...]]
    #: first vertices at both levels
    starts: tuple[Any, Any]
    #: walls
    faces: tuple[Any, ...]

    @staticmethod
    def of(outline: ClosedLine, levels: tuple[float, float]) -> Prism:
        """Build the walls over a counterclockwise outline of lines and arcs, with material round it.

        `levels` are the lower and the upper z, mm.
        """
        rise = levels[1] - levels[0]
        posts = [[vertex((*curve.start, z)) for curve in outline] for z in levels]
        walls = [_wall(curve, levels[0]) for curve in outline]
        rises = [straight_edge(low, high) for low, high in zip(*posts, strict=True)]
        edges = tuple(
            tuple(_round_edge(curve, z, row[k], row[(k + 1) % len(row)]) for k, curve in enumerate(outline))
            for z, row in zip(levels, posts, strict=True)
        )
        faces = []
        for k, (curve, surface) in enumerate(zip(outline, walls, strict=True)):
            after = (k + 1) % len(outline)
            sides = [(edges[0][k], True), (rises[after], True), (edges[1][k], False), (rises[k], False)]
            clockwise = isinstance(curve, PlaneArc) and curve.width < 0.0
            if isinstance(curve, PlaneArc):
                _unroll(curve, surface, rise, (edges[0][k], edges[1][k]), (rises[k], rises[after]))
            # normals of planes and cylinders point into the material, except for cylinders over clockwise arcs
            ordered = [(side, not forward) for side, forward in reversed(sides)] if clockwise else sides
            faces.append(face(surface, [wire(*ordered)], clockwise))
        return Prism((edges[0], edges[1]), (posts[0][0], posts[1][0]), tuple(faces))

    def wire_at(self, row: int) -> Any:
        """Return the wire of the hole in a plane face at the lower (0) or upper (1) level."""
        return wire(*((edge, False) for edge in reversed(self.edges[row])))

    def floor(self, row: int, z: float) -> Any:
        """Return the plane floor at the lower (0) or upper (1) level z (mm), with the material beyond it."""
        from OCP.Geom import Geom_Plane

        return face(
            Geom_Plane(frame((0.0, 0.0, z), 1.0, 0.0)), [wire(*((edge, True) for edge in self.edges[row]))], row == 0
        )


def _wall(curve: PlaneCurve, z: float) -> Any:
    """Return the surface of a line or arc extruded along the axis from z."""
    from OCP.Geom import Geom_CylindricalSurface, Geom_Plane
    from OCP.gp import gp_Ax3, gp_Dir

    if isinstance(curve, PlaneArc):
        return Geom_CylindricalSurface(
            frame((*curve.centre, z), 1.0, min(curve.first, curve.first + curve.width)), curve.radius
        )
    x, y = curve.end - curve.start
    # normal of a loop that goes along the edge and then upwards
    return Geom_Plane(gp_Ax3(point((*curve.start, z)), gp_Dir(y, -x, 0.0), gp_Dir(x, y, 0.0)))


def _unroll(curve: PlaneArc, surface: Any, rise: float, edges: tuple[Any, Any], rises: tuple[Any, Any]) -> None:
    """Set the parameter lines of the edges of a cylindrical wall: at both levels, and at both ends of the arc."""
    from OCP.BRep import BRep_Builder
    from OCP.TopLoc import TopLoc_Location

    builder, here, width = BRep_Builder(), TopLoc_Location(), abs(curve.width)
    first, sense = (0.0, 1.0) if curve.width > 0.0 else (width, -1.0)
    for made, v in zip(edges, (0.0, rise), strict=True):
        builder.UpdateEdge(made, straight2d((first, v), (sense, 0.0)), surface, here, PRECISION_MM)
    begin, end = (straight2d((u, 0.0), (0.0, 1.0)) for u in (first, width - first))
    if rises[0] is rises[1]:
        builder.UpdateEdge(rises[0], end, begin, surface, here, PRECISION_MM)
        return
    for made, line in zip(rises, (begin, end), strict=True):
        builder.UpdateEdge(made, line, surface, here, PRECISION_MM)


def _round_edge(curve: PlaneCurve, z: float, start: Any, end: Any) -> Any:
    """Return the edge of an outline at z; its parameter is the length of a line, or the angle from the beginning of an arc."""
    from OCP.Geom import Geom_Circle
    from OCP.gp import gp_Ax2, gp_Dir

    if not isinstance(curve, PlaneArc):
        return straight_edge(start, end)
    axis = gp_Dir(0.0, 0.0, 1.0 if curve.width > 0.0 else -1.0)
    along = gp_Dir(float(np.cos(curve.first)), float(np.sin(curve.first)), 0.0)
    circle_there = Geom_Circle(gp_Ax2(point((*curve.centre, z)), axis, along), curve.radius)
    return edge(circle_there, start, end, 0.0, abs(curve.width))
