"""Faces of revolution as OpenCASCADE faces: planes, cylinders and cones between closed loops round the z axis.

A loop is a list of edges in the sense of growing polar angle. On a cylinder or cone the face is cut open along a seam
from the first vertex of one loop to that of the other, which must lie on one generatrix; every edge then gets its curve
in the surface's parameters (u, v): u the polar angle from the seam, v the length along the generatrix.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from gearmesh.cad.occ import PRECISION, edge, face, frame, point, spline_curve2d, straight_edge, vertex, wire
from gearmesh.errors import DesignError
from gearmesh.kernel.algebra import Array
from gearmesh.teeth.train import Slot


@dataclass(frozen=True)
class Trace:
    """An edge in cylindrical coordinates: a spline with control points (K, 3) of (polar angle, rho, z), rad and mm.

    The angle counts from the loop's first vertex. `miss` (mm): the edge itself is nowhere farther from it.
    """

    knots: Array
    control: Array
    miss: float


@dataclass(frozen=True)
class Loop:
    """Edges round the axis, growing polar angle, and their `start` vertex at polar angle `angle` (rad).

    `traces` has one entry an edge, or is empty for a circle. `rho`, `z` (mm): of the circle, or of the start vertex.
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


def plane_face(outer: Loop, inner: Loop | None, up: bool) -> Any:
    """The plane across the axis between two loops, or within one; `up`: the material is below it."""
    from OCP.Geom import Geom_Plane

    wires = [wire(*((each, True) for each in outer.edges))]
    if inner is not None:
        wires.append(wire(*((each, False) for each in reversed(inner.edges))))
    return face(Geom_Plane(frame((0.0, 0.0, outer.z), 1.0, 0.0)), wires, up)


def turned_face(near: Loop, far: Loop, outward: bool) -> Any:
    """The cylinder or cone between two loops; `outward`: the material is on the axis' side.

    Raises DesignError where the loops do not begin on one generatrix.
    """
    from OCP.BRep import BRep_Builder
    from OCP.Geom import Geom_ConicalSurface, Geom_CylindricalSurface, Geom_Line
    from OCP.Geom2d import Geom2d_Line
    from OCP.gp import gp_Dir, gp_Dir2d, gp_Pnt2d
    from OCP.TopLoc import TopLoc_Location

    # v grows with rho, on a cylinder with z
    cylinder = abs(far.rho - near.rho) <= PRECISION
    low, high = (near, far) if (near.z < far.z if cylinder else near.rho < far.rho) else (far, near)
    rise, widening = high.z - low.z, 0.0 if cylinder else high.rho - low.rho
    length = float(np.hypot(rise, widening))
    if abs(np.angle(np.exp(1j * (high.angle - low.angle)))) > 1e-9:
        raise DesignError("body: its profile must have a plane face between the end faces of toe and heel")
    axis = 1.0 if rise > 0.0 else -1.0
    place = frame((0.0, 0.0, low.z), axis, low.angle)
    if cylinder:
        surface = Geom_CylindricalSurface(place, low.rho)
    else:
        surface = Geom_ConicalSurface(place, float(np.arctan2(widening, abs(rise))), low.rho)
    generatrix = np.array([widening, rise]) / length
    builder, here = BRep_Builder(), TopLoc_Location()
    for loop in (low, high):
        if not loop.traces:
            start = gp_Pnt2d(0.0 if axis > 0.0 else 2.0 * np.pi, 0.0 if loop is low else length)
            builder.UpdateEdge(loop.edges[0], Geom2d_Line(start, gp_Dir2d(axis, 0.0)), surface, here, PRECISION)
        for each, trace in zip(loop.edges, loop.traces, strict=False):
            angle, v = trace.control[:, 0], (trace.control[:, 1:] - (low.rho, low.z)) @ generatrix
            u = angle if axis > 0.0 else 2.0 * np.pi - angle
            curve = spline_curve2d(np.stack((u, v), axis=-1), trace.knots)
            builder.UpdateEdge(each, curve, surface, here, max(PRECISION, trace.miss))
    direction = np.array([generatrix[0] * np.cos(low.angle), generatrix[0] * np.sin(low.angle), generatrix[1]])
    foot = (low.rho * np.cos(low.angle), low.rho * np.sin(low.angle), low.z)
    seam = edge(Geom_Line(point(foot), gp_Dir(*map(float, direction))), low.start, high.start, 0.0, length)
    sides = [Geom2d_Line(gp_Pnt2d(u, 0.0), gp_Dir2d(0.0, 1.0)) for u in (2.0 * np.pi, 0.0)]
    builder.UpdateEdge(seam, *sides, surface, here, PRECISION)
    with_u = axis > 0.0
    round_low = [(each, with_u) for each in (low.edges if with_u else low.edges[::-1])]
    round_high = [(each, not with_u) for each in (high.edges[::-1] if with_u else high.edges)]
    return face(surface, [wire(*round_low, (seam, True), *round_high, (seam, False))], outward)


def keyed_bore(rho: float, levels: tuple[float, float], keyway: Slot) -> tuple[tuple[Loop, Loop], tuple[Any, ...]]:
    """A bore with a keyway on +x between two levels z (mm): its loops, and its faces, the bore's own first."""
    from OCP.BRep import BRep_Builder
    from OCP.Geom import Geom_Circle, Geom_CylindricalSurface, Geom_Plane
    from OCP.Geom2d import Geom2d_Line
    from OCP.gp import gp_Ax3, gp_Dir, gp_Dir2d, gp_Pnt2d
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
        builder.UpdateEdge(
            arc, Geom2d_Line(gp_Pnt2d(0.0, z - levels[0]), gp_Dir2d(1.0, 0.0)), cylinder, here, PRECISION
        )
        loops.append(Loop((arc, *(straight_edge(at[i], at[(i + 1) % 4]) for i in (1, 2, 3))), at[0], rho, z, first))
        posts.append(at)
    rises = [straight_edge(low, high) for low, high in zip(*posts, strict=True)]
    for rise, u in zip(rises[:2], ends, strict=True):
        builder.UpdateEdge(rise, Geom2d_Line(gp_Pnt2d(u, 0.0), gp_Dir2d(0.0, 1.0)), cylinder, here, PRECISION)
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
