"""A face of a tooth: its surface with its orientation, and the curves of its edges in the parameters of the surface."""

from __future__ import annotations

from typing import Any

import numpy as np

from gearmesh.cad.occ import PRECISION_MM, face, point, spline_surface, straight2d, wire
from gearmesh.kernel.numeric.algebra import Array, cross
from gearmesh.records import dataclass

#: distance within which control points lie on a plane
PLANE_TOLERANCE_MM = 1e-9


@dataclass(frozen=True)
class Sides:
    """Edges round a face."""

    #: edge at the toe, or nearest to it
    toe: Any
    #: edges where the link ends along the chain, from toe to heel
    far: list[Any]
    #: edge at the heel, or nearest to it
    heel: Any
    #: edges where the link begins along the chain, from toe to heel
    near: list[Any]

    @property
    def wire(self) -> list[tuple[Any, bool]]:
        """Edges in order with their senses, True for forward: first along the chain at the toe, then from toe to heel."""
        return [
            (self.toe, True),
            *((edge, True) for edge in self.far),
            (self.heel, False),
            *((edge, False) for edge in reversed(self.near)),
        ]


@dataclass(frozen=True)
class DrawnFace:
    """A face of tooth 1 between two bounds."""

    #: region of the face
    region: str
    #: numbers of the bounds
    rows: tuple[int, int]
    #: OpenCASCADE surface
    surface: Any
    #: curves of the edges in the surface's parameters with their tolerances, in the order of `Sides.wire`; none for a plane
    curves: tuple[tuple[Any, float], ...]
    #: True if the surface's normal is the direction along the chain times the direction from toe to heel
    with_chain: bool
    #: True if this product points out of the material
    outward: bool

    @staticmethod
    def of_spline(region: str, rows: tuple[int, int], net: tuple[Array, Array, Array], *, outward: bool) -> DrawnFace:
        """Return the face of a spline with a control net (S, T, 3), mm, and knots along the chain and from toe to heel."""
        _, s_knots, t_knots = net
        (s, last), (t, heel) = ((float(knots[0]), float(knots[-1])) for knots in (s_knots, t_knots))
        starts = (((s, t), (1.0, 0.0)), ((last, t), (0.0, 1.0)), ((s, heel), (1.0, 0.0)), ((s, t), (0.0, 1.0)))
        lines = tuple((straight2d(start, direction), PRECISION_MM) for start, direction in starts)
        return DrawnFace(region, rows, spline_surface(*net), lines, True, outward)

    @staticmethod
    def of_net(region: str, rows: tuple[int, int], net: tuple[Array, Array, Array], *, outward: bool) -> DrawnFace:
        """Return the face of a spline, as a plane if its control net is plane."""
        from OCP.Geom import Geom_Plane
        from OCP.gp import gp_Dir

        control = net[0]
        across = cross(control[-1, -1] - control[0, 0], control[0, -1] - control[-1, 0])
        normal = across / np.linalg.norm(across)
        if np.abs((control - control[0, 0]) @ normal).max() > PLANE_TOLERANCE_MM:
            return DrawnFace.of_spline(region, rows, net, outward=outward)
        plane = Geom_Plane(point(control[0, 0]), gp_Dir(*normal.tolist()))
        return DrawnFace(region, rows, plane, (), True, outward)

    def face(self, surface: Any, sides: Sides) -> Any:
        """Return the face of another tooth, by the surface placed there and the tooth's edges."""
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
