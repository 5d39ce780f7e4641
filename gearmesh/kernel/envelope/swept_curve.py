"""Surfaces swept by a curve in a one-parameter motion, with their exact jets.

A cutting edge is a curve r(u) with unit tangents t(u). In the motion M(v), with the twist omega, tau in the tool frame:

    R(u, v) = M r,   R_u = L r_u,   R_v = L w,   w = omega x r + tau             (L the rotation of M)
    N = +- L unit(t x w)

The tangent is a function of its own, so that the normal exists at a corner of the edge, where r_u is 0.
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from gearmesh.kernel.motion.motion import Motion
from gearmesh.kernel.numeric.algebra import Array, broadcast_pair, cross, dot
from gearmesh.kernel.surface.surface import Jet
from gearmesh.records import dataclass


@dataclass(frozen=True)
class Edge:
    """Points and unit tangents of a curve, and their derivatives, each (..., 3)."""

    #: points, mm
    r: Array
    #: unit tangents
    t: Array
    #: derivative of r with respect to u
    r_u: Array
    #: derivative of t with respect to u
    t_u: Array


class SpaceCurve(Protocol):
    """A curve u -> r(u) in the frame of a tool."""

    def at(self, u: Array) -> Edge:
        """Return points and tangents at u (...,)."""


@dataclass(frozen=True)
class SweptCurve:
    """Surface that a curve sweeps; its parameters are u of the curve and v of the motion (rad)."""

    #: the swept curve, in the tool frame
    curve: SpaceCurve
    #: motion of the tool
    motion: Motion
    #: +1 if t x w points out of the material, else -1
    sense: float = 1.0

    def jet(self, u: Array, v: Array) -> Jet:
        """Return the jet in the frame to which the motion leads."""
        u, v = broadcast_pair(u, v)
        edge, state = self.curve.at(u), self.motion.at(v)
        w, w_v = state.velocity(edge.r), state.velocity_change(edge.r)
        normal = self.sense * cross(edge.t, w)
        size = np.sqrt(dot(normal, normal))[..., None]
        n = normal / size
        # changes of t x w in the tool frame; the tangent turns with the tool
        normal_u = self.sense * (cross(edge.t_u, w) + cross(edge.t, cross(state.omega, edge.r_u)))
        normal_v = cross(state.omega, normal) + self.sense * cross(edge.t, w_v)
        n_u, n_v = ((change - n * dot(n, change)[..., None]) / size for change in (normal_u, normal_v))
        return Jet(edge.r, n, edge.r_u, w, n_u, n_v).move(state.tool_to_blank)
