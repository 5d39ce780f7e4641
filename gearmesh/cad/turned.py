"""Faces of revolution as OpenCASCADE faces: planes, cylinders and cones between closed loops round the z axis.

A loop is a list of edges in the sense of growing polar angle. On a cylinder or cone the face is cut open along a seam
from the first vertex of one loop to that of the other, which must lie on one generatrix; every edge then gets its curve
in the surface's parameters (u, v): u the polar angle from the seam, v the length along the generatrix.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from gearmesh.cad.nodes import DEGREE
from gearmesh.cad.occ import (
    PRECISION,
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
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.splines import SplineCurve
from gearmesh.kernel.plane.curves import PlaneArc, PlaneCurve
from gearmesh.teeth.blank.features import ClosedLine

#: a trace is refined until it is this close (mm) to its curve, each span of which is cut at most into so many
TRACED, FINEST = 1e-8, 8
#: places on a span of a traced curve at which its distance is measured, and an edge's tolerance over the largest: OpenCASCADE
#: looks at other places
PLACES, MARGIN = 16, 2.0


@dataclass(frozen=True)
class Trace:
    """A curve in cylindrical coordinates: a spline with control points (K, 3) of (polar angle, rho, z), rad and mm.

    Two control points are the ends of an arc, whose parameter is the polar angle. The angle is counted from a direction that
    whoever uses the trace knows. `miss` (mm): the curve itself is nowhere farther from it.
    """

    knots: Array
    control: Array
    miss: float = 0.0

    @staticmethod
    def arc(width: float, rho: float, z: float, start: float) -> Trace:
        """The arc of a width (rad) from a polar angle on."""
        return Trace(np.array([0.0, width]), np.array([(start, rho, z), (start + width, rho, z)]))

    @staticmethod
    def of(knots: Array, control: Array, angle: float) -> Trace:
        """The trace of a spline with control points (K, 3), mm, its polar angles counted from `angle`, -pi to pi.

        Its spans are cut into more and more until it is `TRACED`.
        """
        curve = SplineCurve(knots, control, DEGREE)
        spans = np.unique(knots)
        places = np.unique(spans[:-1, None] + np.diff(spans)[:, None] * np.linspace(0.0, 1.0, PLACES + 1))
        wanted = curve(places)
        miss, trace = np.inf, None
        for pieces in range(1, FINEST + 1):
            inner = (spans[:-1, None] + np.diff(spans)[:, None] * np.arange(pieces) / pieces).ravel()[1:]
            refined = np.concatenate((np.repeat(spans[0], DEGREE + 1), inner, np.repeat(spans[-1], DEGREE + 1)))
            # the spline's own centres of gravity: collocation there is stable for any knots
            at = np.array([refined[k + 1 : k + DEGREE + 1].mean() for k in range(len(refined) - DEGREE - 1)])
            at[0], at[-1] = spans[0], spans[-1]
            drawn = SplineCurve.through(at, _cylindrical(curve(at), angle), DEGREE, refined)
            polar, rho, z = np.moveaxis(drawn(places), -1, 0)
            there = np.stack((rho * np.cos(angle + polar), rho * np.sin(angle + polar), z), axis=-1)
            was, miss = miss, MARGIN * float(np.linalg.norm(there - wanted, axis=-1).max())
            if trace is None or miss < was:
                trace = Trace(refined, drawn.control, miss)
            if miss <= TRACED:
                break
        assert trace is not None
        return trace

    def turn(self, angle: float) -> Trace:
        """The same farther round the axis."""
        return Trace(self.knots, self.control + np.array([angle, 0.0, 0.0]), self.miss)


def _cylindrical(r: Array, angle: float) -> Array:
    x, y, z = np.moveaxis(r, -1, 0)
    polar = (np.arctan2(y, x) - angle + np.pi) % (2.0 * np.pi) - np.pi
    return np.stack((polar, np.hypot(x, y), z), axis=-1)


@dataclass(frozen=True)
class TurnedSurface:
    """The cylinder or cone about z on which two circles lie, as an OpenCASCADE surface with parameters (u, v).

    v is the length along the generatrix from `foot` (rho, z) on, which goes in the direction `generatrix`: away from the
    axis, on a cylinder up. u is the polar angle from `angle` on (rad), clockwise where `axis` is -1.
    """

    surface: Any
    foot: Array
    generatrix: Array
    axis: float
    angle: float

    @staticmethod
    def through(one: Array, other: Array, angle: float) -> TurnedSurface:
        """The one through circles (rho, z), u counted from a polar angle."""
        from OCP.Geom import Geom_ConicalSurface, Geom_CylindricalSurface

        cylinder = abs(one[0] - other[0]) <= PRECISION
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
        """v of a circle."""
        return float((np.array([rho, z]) - self.foot) @ self.generatrix)

    def curve(self, trace: Trace, offset: float = 0.0) -> Any:
        """The curve in (u, v) of a trace whose angles are counted from `angle` + `offset`; u is that of the trace, from 0 on
        or, clockwise, back from a full turn."""
        polar, v = trace.control[:, 0] + offset, (trace.control[:, 1:] - self.foot) @ self.generatrix
        u = polar if self.axis > 0.0 else 2.0 * np.pi - polar
        if len(u) == 2:
            return straight2d((float(u[0]), float(v[0])), (float(np.sign(u[1] - u[0])), 0.0))
        return spline_curve2d(np.stack((u, v), axis=-1), trace.knots)


@dataclass(frozen=True)
class Loop:
    """Edges round the axis, growing polar angle, and their `start` vertex at polar angle `angle` (rad).

    `traces` has one entry per edge, its angles counted from `angle`, or is empty for a circle. `rho`, `z` (mm): of the circle,
    or of the start vertex.
    """

    edges: tuple[Any, ...]
    start: Any
    rho: float
    z: float
    angle: float
    traces: tuple[Trace, ...] = ()


def circle(rho: float, z: float, angle: float) -> Loop:
    """A full circle that starts at a polar angle."""
    from OCP.Geom import Geom_Circle

    start = vertex((rho * np.cos(angle), rho * np.sin(angle), z))
    curve = Geom_Circle(frame((0.0, 0.0, z), 1.0, angle).Ax2(), rho)
    return Loop((edge(curve, start, start, 0.0, 2.0 * np.pi),), start, rho, z, angle)


def plane_face(outer: Loop, inner: Loop | None, up: bool, holes: Sequence[Any] = ()) -> Any:
    """The plane across the axis between two loops, or within one, less `holes` (wires); `up`: the material is below it."""
    from OCP.Geom import Geom_Plane

    wires = [wire(*((edge, True) for edge in outer.edges))]
    if inner is not None:
        wires.append(wire(*((edge, False) for edge in reversed(inner.edges))))
    wires += holes
    return face(Geom_Plane(frame((0.0, 0.0, outer.z), 1.0, 0.0)), wires, up)


def turned_face(near: Loop, far: Loop, outward: bool) -> Any:
    """The cylinder or cone between two loops; `outward`: the material is on the axis' side.

    Raises DesignError where the loops do not begin on one generatrix.
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
    builder, here = BRep_Builder(), TopLoc_Location()
    for loop in (low, high):
        traces = loop.traces or (Trace.arc(2.0 * np.pi, loop.rho, loop.z, 0.0),)
        for drawn, trace in zip(loop.edges, traces, strict=True):
            builder.UpdateEdge(drawn, turned.curve(trace), turned.surface, here, max(PRECISION, trace.miss))
    across, up = turned.generatrix
    direction = np.array([across * np.cos(low.angle), across * np.sin(low.angle), up])
    foot = (low.rho * np.cos(low.angle), low.rho * np.sin(low.angle), low.z)
    seam = edge(Geom_Line(point(foot), gp_Dir(*map(float, direction))), low.start, high.start, 0.0, length)
    sides = [straight2d((u, 0.0), (0.0, 1.0)) for u in (2.0 * np.pi, 0.0)]
    builder.UpdateEdge(seam, *sides, turned.surface, here, PRECISION)
    with_u = turned.axis > 0.0
    round_low = [(edge, with_u) for edge in (low.edges if with_u else low.edges[::-1])]
    round_high = [(edge, not with_u) for edge in (high.edges[::-1] if with_u else high.edges)]
    return face(turned.surface, [wire(*round_low, (seam, True), *round_high, (seam, False))], outward)


@dataclass(frozen=True)
class Prism:
    """The walls of a prism along the axis between two levels: its edges round either, their first vertices, and its faces."""

    edges: tuple[tuple[Any, ...], tuple[Any, ...]]
    starts: tuple[Any, Any]
    faces: tuple[Any, ...]

    @staticmethod
    def of(outline: ClosedLine, levels: tuple[float, float]) -> Prism:
        """Of an outline of lines and arcs, counterclockwise, with material round it, between two z (mm), the lower first."""
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
            # a plane's normal and that of a cylinder go into the material, but where the outline goes round the axis clockwise
            ordered = [(side, not forward) for side, forward in reversed(sides)] if clockwise else sides
            faces.append(face(surface, [wire(*ordered)], clockwise))
        return Prism((edges[0], edges[1]), (posts[0][0], posts[1][0]), tuple(faces))

    def wire_at(self, row: int) -> Any:
        """The hole that it makes in a plane face at the lower (0) or upper (1) level."""
        return wire(*((edge, False) for edge in reversed(self.edges[row])))

    def floor(self, row: int, z: float) -> Any:
        """Its plane end at the lower (0) or upper (1) level z (mm), with the material beyond."""
        from OCP.Geom import Geom_Plane

        return face(
            Geom_Plane(frame((0.0, 0.0, z), 1.0, 0.0)), [wire(*((edge, True) for edge in self.edges[row]))], row == 0
        )


def _wall(curve: PlaneCurve, z: float) -> Any:
    """The surface of a line or arc moved along the axis from z on."""
    from OCP.Geom import Geom_CylindricalSurface, Geom_Plane
    from OCP.gp import gp_Ax3, gp_Dir

    if isinstance(curve, PlaneArc):
        return Geom_CylindricalSurface(
            frame((*curve.centre, z), 1.0, min(curve.first, curve.first + curve.width)), curve.radius
        )
    x, y = curve.end - curve.start
    # the normal of a loop that goes along the edge and then up
    return Geom_Plane(gp_Ax3(point((*curve.start, z)), gp_Dir(y, -x, 0.0), gp_Dir(x, y, 0.0)))


def _unroll(curve: PlaneArc, surface: Any, rise: float, edges: tuple[Any, Any], rises: tuple[Any, Any]) -> None:
    """Give the edges of a cylinder's wall their lines in its parameters: those at both levels, and where the arc
    begins and ends."""
    from OCP.BRep import BRep_Builder
    from OCP.TopLoc import TopLoc_Location

    builder, here, width = BRep_Builder(), TopLoc_Location(), abs(curve.width)
    first, sense = (0.0, 1.0) if curve.width > 0.0 else (width, -1.0)
    for made, v in zip(edges, (0.0, rise), strict=True):
        builder.UpdateEdge(made, straight2d((first, v), (sense, 0.0)), surface, here, PRECISION)
    begin, end = (straight2d((u, 0.0), (0.0, 1.0)) for u in (first, width - first))
    if rises[0] is rises[1]:
        builder.UpdateEdge(rises[0], end, begin, surface, here, PRECISION)
        return
    for made, line in zip(rises, (begin, end), strict=True):
        builder.UpdateEdge(made, line, surface, here, PRECISION)


def _round_edge(curve: PlaneCurve, z: float, start: Any, end: Any) -> Any:
    """The edge of an outline at z, its parameter the length of a line, of an arc the angle from its beginning."""
    from OCP.Geom import Geom_Circle
    from OCP.gp import gp_Ax2, gp_Dir

    if not isinstance(curve, PlaneArc):
        return straight_edge(start, end)
    axis = gp_Dir(0.0, 0.0, 1.0 if curve.width > 0.0 else -1.0)
    along = gp_Dir(float(np.cos(curve.first)), float(np.sin(curve.first)), 0.0)
    circle_there = Geom_Circle(gp_Ax2(point((*curve.centre, z)), axis, along), curve.radius)
    return edge(circle_there, start, end, 0.0, abs(curve.width))
