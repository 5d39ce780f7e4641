"""Surfaces: maps (u, v) -> point and unit normal with their first partial derivatives (the jet).

Curvature, contact and tessellation need nothing more. Vectors are (..., 3), parameters (...,), lengths in mm. The
normal points out of the material of the body that the surface bounds.
"""

from __future__ import annotations

from dataclasses import fields
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.motion.motion import MachineAxis
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, cross
from gearmesh.records import dataclass


@dataclass(frozen=True)
class Jet:
    """Point and unit normal of a surface, and their first partial derivatives, each (..., 3), at (u, v) (...,)."""

    #: point, mm
    r: Array
    #: unit normal out of the material
    n: Array
    #: derivative of r with respect to u
    r_u: Array
    #: derivative of r with respect to v
    r_v: Array
    #: derivative of n with respect to u
    n_u: Array
    #: derivative of n with respect to v
    n_v: Array

    def __getitem__(self, which: NDArray[np.intp]) -> Jet:
        """Return the jet at some of the points, selected along the first axis."""
        return Jet(*(getattr(self, field.name)[which] for field in fields(Jet)))

    def where(self, condition: NDArray[np.bool_], other: Jet) -> Jet:
        """Return points of this jet where a condition (N,) holds, and points of another jet elsewhere."""
        chosen = condition[:, None]
        return Jet(*(np.where(chosen, getattr(self, field.name), getattr(other, field.name)) for field in fields(Jet)))

    def move(self, transform: Rigid) -> Jet:
        """Return the jet of the same surface in the frame to which `transform` takes this frame."""
        r, *turned = transform.vectors(self.r, self.n, self.r_u, self.r_v, self.n_u, self.n_v)
        return Jet(r + transform.translation, *turned)

    def parallel(self, distance: float) -> Jet:
        """Return the jet of the parallel surface at a distance (mm) along the normals, with unchanged parameters."""
        r, r_u, r_v = (a + distance * b for a, b in ((self.r, self.n), (self.r_u, self.n_u), (self.r_v, self.n_v)))
        return Jet(r, self.n, r_u, r_v, self.n_u, self.n_v)

    def along(self, du: Array, dv: Array) -> tuple[Array, Array]:
        """Return differentials dr (mm) and dn (..., 3) of point and normal for differentials of the parameters (...,)."""
        du, dv = du[..., None], dv[..., None]
        return self.r_u * du + self.r_v * dv, self.n_u * du + self.n_v * dv


class Surface(Protocol):
    """A surface with an exact jet."""

    def jet(self, u: Array, v: Array) -> Jet:
        """Return point, unit normal and their first partial derivatives at parameters u and v (...,)."""


class GeneratedSurface(Surface, Protocol):
    """A surface that a `tool` generates in a motion with 0 to 2 parameters (`freedoms`).

    The parameters are: none for a fixed tool; the roll (rad); the roll and the feed (mm); or, of an edge that indexes, the
    roll and the rotation of its cutter (rad).
    """

    @property
    def tool(self) -> Surface:
        """The tool's surface, in the tool's frame."""

    @property
    def freedoms(self) -> int:
        """Number of the motion's parameters."""

    def on_tool(self, u: Array, v: Array) -> tuple[Array, Array]:
        """Return both parameters (...,) of the tool's surface at the points that generate the surface at u and v
        (...,)."""

    def generating(self, u: Array, v: Array) -> tuple[Array, ...]:
        """Return the motion's parameters (...,) at which the points at u and v (...,) are generated.

        There is none, roll (rad), roll and feed (mm), or roll and rotation of the cutter (rad).
        """

    def tool_to_blank(self, *motion: Array) -> Rigid:
        """Return the transform from the tool's frame to the blank's frame at parameters (...,) of the motion, as from
        `generating`."""

    def axes(self, *motion: Array) -> tuple[MachineAxis, ...]:
        """Return the axes of the machine in the blank's frame at one instant of the motion, without those of blank and
        tool."""

    def progress(self, u: Array, v: Array) -> tuple[Array, Array, Array]:
        """Return the parameter that is constant along a line of contact with the tool, and its partial derivatives (...,).

        It is the roll (rad), or else the feed (mm).
        """


@dataclass(frozen=True)
class PlacedSurface:
    """A surface in another frame, to which `place` takes it; also the surface left by a tool that does not move."""

    surface: Surface
    place: Rigid

    def jet(self, u: Array, v: Array) -> Jet:
        return self.surface.jet(u, v).move(self.place)

    @property
    def tool(self) -> Surface:
        return self.surface

    @property
    def freedoms(self) -> int:
        return 0

    def on_tool(self, u: Array, v: Array) -> tuple[Array, Array]:
        return u, v

    def generating(self, u: Array, v: Array) -> tuple[Array, ...]:
        return ()

    def tool_to_blank(self, *motion: Array) -> Rigid:
        return self.place

    def axes(self, *motion: Array) -> tuple[MachineAxis, ...]:
        return ()

    def progress(self, u: Array, v: Array) -> tuple[Array, Array, Array]:
        zero = np.zeros(np.broadcast_shapes(np.shape(u), np.shape(v)))
        return zero, zero, zero


def area_normal(jet: Jet) -> Array:
    """Return r_u x r_v, (..., 3); its length is the area element, 0 where the parametrisation degenerates."""
    return cross(jet.r_u, jet.r_v)
