"""What a surface is: a map (u, v) -> point, unit normal and their first partials (the jet).

Everything else (curvature, contact, tessellation) needs nothing more. Shapes are (..., 3) for vectors and (...,) for
parameters; lengths in mm. The normal points out of the material of the body that the surface bounds.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.motion.motion import MachineAxis
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, cross


@dataclass(frozen=True)
class Jet:
    """Point r, unit normal n and their first partials, each (..., 3), at parameters (u, v) (...,)."""

    r: Array
    n: Array
    r_u: Array
    r_v: Array
    n_u: Array
    n_v: Array

    def __getitem__(self, which: NDArray[np.intp]) -> Jet:
        """Some of the points, by the first axis."""
        return Jet(*(getattr(self, field.name)[which] for field in fields(Jet)))

    def where(self, condition: NDArray[np.bool_], other: Jet) -> Jet:
        """These points where a condition (N,) holds, those of another jet elsewhere."""
        mine = condition[:, None]
        return Jet(*(np.where(mine, getattr(self, field.name), getattr(other, field.name)) for field in fields(Jet)))

    def move(self, transform: Rigid) -> Jet:
        """The jet of the same surface in another frame."""
        r, *turned = transform.vectors(self.r, self.n, self.r_u, self.r_v, self.n_u, self.n_v)
        return Jet(r + transform.translation, *turned)

    def parallel(self, distance: float) -> Jet:
        """The jet of the surface every point of which is so far (mm) along its normal; parameters stay."""
        r, r_u, r_v = (a + distance * b for a, b in ((self.r, self.n), (self.r_u, self.n_u), (self.r_v, self.n_v)))
        return Jet(r, self.n, r_u, r_v, self.n_u, self.n_v)

    def along(self, du: Array, dv: Array) -> tuple[Array, Array]:
        """Differentials (dr, dn), (..., 3), of point and normal for parameter differentials (...,)."""
        du, dv = du[..., None], dv[..., None]
        return self.r_u * du + self.r_v * dv, self.n_u * du + self.n_v * dv


class Surface(Protocol):
    """A surface with an exact jet."""

    def jet(self, u: Array, v: Array) -> Jet:
        """Jet at parameters u, v (...,)."""


class GeneratedSurface(Surface, Protocol):
    """A surface that a `tool` generates in a motion of as many parameters as it has `freedoms`: none where it is fixed, roll
    (rad), or roll and feed (mm)."""

    @property
    def tool(self) -> Surface:
        """The tool's surface, in the tool's frame."""

    @property
    def freedoms(self) -> int:
        """Number of the motion's parameters."""

    def on_tool(self, u: Array, v: Array) -> tuple[Array, Array]:
        """Parameters (...,) of the tool's surface that generates the points u, v (...,)."""

    def generating(self, u: Array, v: Array) -> tuple[Array, ...]:
        """The motion's parameters, (...,) each, while the tool generates the points u, v (...,)."""

    def tool_to_blank(self, *motion: Array) -> Rigid:
        """The tool's frame over the blank's at parameters of the motion."""

    def axes(self, *motion: Array) -> tuple[MachineAxis, ...]:
        """Axes of the machine, in the blank's frame, at one place of the motion."""

    def progress(self, u: Array, v: Array) -> tuple[Array, Array, Array]:
        """What tells the lines along which the tool touches, (...,), rad or mm, and its partials: the roll, or else the feed."""


@dataclass(frozen=True)
class PlacedSurface:
    """A surface in another frame, to which `place` takes it: what a fixed tool leaves, too."""

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
    """r_u x r_v, (..., 3): its length is the area element, zero where the parametrisation degenerates."""
    return cross(jet.r_u, jet.r_v)
