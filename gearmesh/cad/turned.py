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
from scipy.interpolate import BSpline, make_interp_spline

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
from gearmesh.teeth.gear_train import Drilling, Slot

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
        curve = BSpline(knots, control, DEGREE)
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
            drawn = make_interp_spline(at, _cylindrical(curve(at), angle), k=DEGREE, t=refined)
            polar, rho, z = np.moveaxis(drawn(places), -1, 0)
            there = np.stack((rho * np.cos(angle + polar), rho * np.sin(angle + polar), z), axis=-1)
            was, miss = miss, MARGIN * float(np.linalg.norm(there - wanted, axis=-1).max())
            if trace is None or miss < was:
                trace = Trace(refined, drawn.c, miss)
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
    """The plane across the axis between two loops, or within one, less `holes` (circles); `up`: the material is below it."""
    from OCP.Geom import Geom_Plane

    wires = [wire(*((edge, True) for edge in outer.edges))]
    if inner is not None:
        wires.append(wire(*((edge, False) for edge in reversed(inner.edges))))
    wires += [wire((hole, False)) for hole in holes]
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


def keyed_bore(rho: float, levels: tuple[float, float], keyway: Slot) -> tuple[tuple[Loop, Loop], tuple[Any, ...]]:
    """A bore with a keyway on +x between two levels z (mm): its loops, and its faces, the bore's own first."""
    from OCP.BRep import BRep_Builder
    from OCP.Geom import Geom_Circle, Geom_CylindricalSurface, Geom_Plane
    from OCP.gp import gp_Ax3, gp_Dir
    from OCP.TopLoc import TopLoc_Location

    half, builder, here = 0.5 * keyway.width, BRep_Builder(), TopLoc_Location()
    first = float(np.arcsin(half / rho))
    ends = (first, 2.0 * np.pi - first)
    near, bottom = rho * np.cos(first), rho + keyway.depth
    corners = np.array([(near, half), (near, -half), (bottom, -half), (bottom, half)])
    cylinder = Geom_CylindricalSurface(frame((0.0, 0.0, levels[0]), 1.0, 0.0), rho)
    loops, posts = [], []
    for z in levels:
        at = [vertex((*corner, z)) for corner in corners]
        arc = edge(Geom_Circle(frame((0.0, 0.0, z), 1.0, 0.0).Ax2(), rho), at[0], at[1], *ends)
        builder.UpdateEdge(arc, straight2d((0.0, z - levels[0]), (1.0, 0.0)), cylinder, here, PRECISION)
        loops.append(Loop((arc, *(straight_edge(at[i], at[(i + 1) % 4]) for i in (1, 2, 3))), at[0], rho, z, first))
        posts.append(at)
    rises = [straight_edge(low, high) for low, high in zip(*posts, strict=True)]
    for rise, u in zip(rises[:2], ends, strict=True):
        builder.UpdateEdge(rise, straight2d((u, 0.0), (0.0, 1.0)), cylinder, here, PRECISION)
    surfaces = [cylinder]
    for i in (1, 2, 3):
        x, y = corners[(i + 1) % 4] - corners[i]
        # the normal of a loop that goes along the edge and then up
        surfaces.append(Geom_Plane(gp_Ax3(point((*corners[i], levels[0])), gp_Dir(y, -x, 0.0), gp_Dir(x, y, 0.0))))
    low, high = loops
    faces = tuple(
        face(
            surface,
            [wire((low.edges[i], True), (rises[(i + 1) % 4], True), (high.edges[i], False), (rises[i], False))],
            False,
        )
        for i, surface in enumerate(surfaces)
    )
    return (low, high), faces


def drilled_holes(levels: tuple[float, float], holes: Drilling) -> tuple[dict[float, list[Any]], tuple[Any, ...]]:
    """Holes between two levels z (mm): their circles at either level, and their walls."""
    from OCP.BRep import BRep_Builder
    from OCP.Geom import Geom_Circle, Geom_CylindricalSurface
    from OCP.TopLoc import TopLoc_Location

    builder, here, radius = BRep_Builder(), TopLoc_Location(), 0.5 * holes.diameter
    circles: dict[float, list[Any]] = {z: [] for z in levels}
    walls = []
    for x, y in holes.centres.tolist():
        cylinder = Geom_CylindricalSurface(frame((x, y, levels[0]), 1.0, 0.0), radius)
        starts = [vertex((x + radius, y, z)) for z in levels]
        for z, start in zip(levels, starts, strict=True):
            made = edge(Geom_Circle(frame((x, y, z), 1.0, 0.0).Ax2(), radius), start, start, 0.0, 2.0 * np.pi)
            builder.UpdateEdge(made, straight2d((0.0, z - levels[0]), (1.0, 0.0)), cylinder, here, PRECISION)
            circles[z].append(made)
        seam = straight_edge(*starts)
        sides = [straight2d((u, 0.0), (0.0, 1.0)) for u in (2.0 * np.pi, 0.0)]
        builder.UpdateEdge(seam, *sides, cylinder, here, PRECISION)
        low, high = (circles[z][-1] for z in levels)
        walls.append(face(cylinder, [wire((low, True), (seam, True), (high, False), (seam, False))], False))
    return circles, tuple(walls)
