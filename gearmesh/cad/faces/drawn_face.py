"""A face of a tooth with its sense and the curves of its edges in the parameters of its surface."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from gearmesh.cad.occ import PRECISION, face, point, spline_surface, straight2d, wire
from gearmesh.kernel.numeric.algebra import Array, cross

#: control points that are no farther (mm) from a plane are on it
PLANE = 1e-9


@dataclass(frozen=True)
class Sides:
    """Edges round a face: at its toe side, farther on along the chain (several from toe to heel), heel side, nearer."""

    toe: Any
    far: list[Any]
    heel: Any
    near: list[Any]

    @property
    def wire(self) -> list[tuple[Any, bool]]:
        """Edges and senses, from the chain's direction to that from toe to heel."""
        return [
            (self.toe, True),
            *((edge, True) for edge in self.far),
            (self.heel, False),
            *((edge, False) for edge in reversed(self.near)),
        ]


@dataclass(frozen=True)
class DrawnFace:
    """A face of tooth 1 between two of the bounds, `rows`, and the sense of its surface.

    `curves` are those of its edges in the surface's parameters, with their tolerances, in the order of `Sides.wire`; none
    for a plane. `with_chain`: the surface's normal is the vector product of the directions along the chain and from toe to heel;
    `outward`: that product leaves the material.
    """

    region: str
    rows: tuple[int, int]
    surface: Any
    curves: tuple[tuple[Any, float], ...]
    with_chain: bool
    outward: bool

    @staticmethod
    def of_spline(region: str, rows: tuple[int, int], net: tuple[Array, Array, Array], *, outward: bool) -> DrawnFace:
        """Of a spline with a control net (S, T, 3), mm, and its knots in both directions, along the chain and from toe to heel."""
        _, s_knots, t_knots = net
        (s, last), (t, heel) = ((float(knots[0]), float(knots[-1])) for knots in (s_knots, t_knots))
        starts = (((s, t), (1.0, 0.0)), ((last, t), (0.0, 1.0)), ((s, heel), (1.0, 0.0)), ((s, t), (0.0, 1.0)))
        lines = tuple((straight2d(start, direction), PRECISION) for start, direction in starts)
        return DrawnFace(region, rows, spline_surface(*net), lines, True, outward)

    @staticmethod
    def of_net(region: str, rows: tuple[int, int], net: tuple[Array, Array, Array], *, outward: bool) -> DrawnFace:
        """The same, a plane where the control net is one."""
        from OCP.Geom import Geom_Plane
        from OCP.gp import gp_Dir

        control = net[0]
        across = cross(control[-1, -1] - control[0, 0], control[0, -1] - control[-1, 0])
        normal = across / np.linalg.norm(across)
        if np.abs((control - control[0, 0]) @ normal).max() > PLANE:
            return DrawnFace.of_spline(region, rows, net, outward=outward)
        plane = Geom_Plane(point(control[0, 0]), gp_Dir(*normal.tolist()))
        return DrawnFace(region, rows, plane, (), True, outward)

    def face(self, surface: Any, sides: Sides) -> Any:
        """The face on this surface turned to its tooth, with that tooth's edges."""
        from OCP.BRep import BRep_Builder
        from OCP.TopLoc import TopLoc_Location

        builder, here = BRep_Builder(), TopLoc_Location()
        parts = sides.wire
        if self.curves:
            for (side, _), (curve, tolerance) in zip(parts, self.curves, strict=True):
                builder.UpdateEdge(side, curve, surface, here, tolerance)
        if not self.with_chain:
            parts = [(part, not sense) for part, sense in reversed(parts)]
        return face(surface, [wire(*parts)], self.outward == self.with_chain)
