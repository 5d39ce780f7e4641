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
        """Return points of this jet where a condition holds, and points of another jet elsewhere.

        Parameters
        ----------
        condition : ndarray of bool
            (N,).
        other : Jet
            Jet at N points.

        Returns
        -------
        Jet

        Examples
        --------
        >>> tooth = gears.members["pinion"].tooth
        >>> jet = tooth.chain[gm.Region.FLANK_RIGHT].grid([0.5], tooth.sections([0.0, 1.0])).jet
        >>> row = jet.where(np.array([True]), jet)
        >>> bool((row.r == jet.r).all())
        True
        """
        chosen = condition[:, None]
        return Jet(*(np.where(chosen, getattr(self, field.name), getattr(other, field.name)) for field in fields(Jet)))

    def move(self, transform: Rigid) -> Jet:
        """Return the jet of the same surface in another frame.

        Parameters
        ----------
        transform : Rigid
            From this frame to the other one.

        Returns
        -------
        Jet

        Examples
        --------
        >>> tooth = gears.members["pinion"].tooth
        >>> jet = tooth.chain[gm.Region.FLANK_RIGHT].grid([0.5], tooth.sections([0.0, 1.0])).jet
        >>> moved = jet.move(gm.Rigid(np.eye(3), np.array([0.0, 0.0, 3.0])))
        >>> (moved.r - jet.r)[0, 0].round(12).tolist()
        [0.0, 0.0, 3.0]
        """
        r, *turned = transform.vectors(self.r, self.n, self.r_u, self.r_v, self.n_u, self.n_v)
        return Jet(r + transform.translation, *turned)

    def parallel(self, distance: float) -> Jet:
        """Return the jet of the parallel surface, with unchanged parameters.

        Parameters
        ----------
        distance : float
            Along the normal, mm.

        Returns
        -------
        Jet

        Examples
        --------
        >>> tooth = gears.members["pinion"].tooth
        >>> jet = tooth.chain[gm.Region.FLANK_RIGHT].grid([0.5], tooth.sections([0.0, 1.0])).jet
        >>> (np.linalg.norm(jet.parallel(0.1).r - jet.r, axis=-1)).round(12).tolist()
        [[0.1, 0.1]]
        """
        r, r_u, r_v = (a + distance * b for a, b in ((self.r, self.n), (self.r_u, self.n_u), (self.r_v, self.n_v)))
        return Jet(r, self.n, r_u, r_v, self.n_u, self.n_v)

    def along(self, du: Array, dv: Array) -> tuple[Array, Array]:
        """Return differentials of point and normal for differentials of the parameters.

        Parameters
        ----------
        du : ndarray
            (...,).
        dv : ndarray
            (...,).

        Returns
        -------
        tuple of ndarray
            dr, mm, and dn, (..., 3) each.

        Examples
        --------
        >>> tooth = gears.members["pinion"].tooth
        >>> jet = tooth.chain[gm.Region.FLANK_RIGHT].grid([0.5], tooth.sections([0.0, 1.0])).jet
        >>> dr, dn = jet.along(np.ones((1, 2)), np.zeros((1, 2)))
        >>> bool((dr == jet.r_u).all())
        True
        """
        du, dv = du[..., None], dv[..., None]
        return self.r_u * du + self.r_v * dv, self.n_u * du + self.n_v * dv


class Surface(Protocol):
    """A surface with an exact jet."""

    def jet(self, u: Array, v: Array) -> Jet:
        """Return point, unit normal and their first partial derivatives.

        Parameters
        ----------
        u : ndarray
            First parameter, (...,).
        v : ndarray
            Second parameter, (...,).

        Returns
        -------
        Jet

        Examples
        --------
        >>> jet = gears.members["pinion"].tooth.right.flank.jet(np.array([0.1, 0.2]), np.array([0.0, 0.0]))
        >>> jet.r.shape
        (2, 3)
        """


class GeneratedSurface(Surface, Protocol):
    """A surface that a `tool` generates in a motion with 0 to 2 parameters (`freedoms`).

    The parameters are: none for a fixed tool; the roll (rad); or the roll and the feed (mm).
    """

    @property
    def tool(self) -> Surface:
        """The tool's surface, in the tool's frame."""

    @property
    def freedoms(self) -> int:
        """Number of the motion's parameters."""

    def on_tool(self, u: Array, v: Array) -> tuple[Array, Array]:
        """Return the tool's parameters at the points that generate the surface.

        Parameters
        ----------
        u : ndarray
            First parameter, (...,).
        v : ndarray
            Second parameter, (...,).

        Returns
        -------
        tuple of ndarray
            Both parameters of the tool's surface, (...,) each.

        Examples
        --------
        >>> flank, fillet = gears.members["pinion"].tooth.right.generation
        >>> p, s = flank.on_tool(np.array([0.1]), np.array([0.0]))
        >>> p.shape
        (1,)
        """

    def generating(self, u: Array, v: Array) -> tuple[Array, ...]:
        """Return the motion's parameters at which the points are generated.

        Parameters
        ----------
        u : ndarray
            First parameter, (...,).
        v : ndarray
            Second parameter, (...,).

        Returns
        -------
        tuple of ndarray
            The motion's parameters, (...,) each: none, roll (rad), or roll and feed (mm).

        Examples
        --------
        >>> flank, fillet = gears.members["pinion"].tooth.right.generation
        >>> (roll,) = flank.generating(np.array([0.1]), np.array([0.0]))
        >>> roll.shape
        (1,)
        """

    def tool_to_blank(self, *motion: Array) -> Rigid:
        """Return the transform from the tool's frame to the blank's frame.

        Parameters
        ----------
        motion : ndarray
            Parameters of the motion, (...,) each, as returned by `generating`.

        Returns
        -------
        Rigid
            Transform from tool to blank.

        Examples
        --------
        >>> flank, fillet = gears.members["pinion"].tooth.right.generation
        >>> u, v = np.array([0.1]), np.array([0.0])
        >>> tool = flank.tool.jet(*flank.on_tool(u, v)).r
        >>> made = flank.tool_to_blank(*flank.generating(u, v)).point(tool)
        >>> bool(np.abs(made - flank.jet(u, v).r).max() < 1e-9)
        True
        """

    def axes(self, *motion: Array) -> tuple[MachineAxis, ...]:
        """Return the axes of the machine, in the blank's frame.

        Parameters
        ----------
        motion : ndarray
            Parameters of the motion at one instant.

        Returns
        -------
        tuple of MachineAxis
            Without the axes of blank and tool.

        Examples
        --------
        >>> flank, fillet = gears.members["pinion"].tooth.right.generation
        >>> [axis.name for axis in flank.axes(np.array(0.0))]
        []
        """

    def progress(self, u: Array, v: Array) -> tuple[Array, Array, Array]:
        """Return the parameter that is constant along a line of contact with the tool: the roll, or else the feed.

        Parameters
        ----------
        u : ndarray
            First parameter, (...,).
        v : ndarray
            Second parameter, (...,).

        Returns
        -------
        tuple of ndarray
            Value, rad or mm, and partial derivatives, (...,) each.

        Examples
        --------
        >>> flank, fillet = gears.members["pinion"].tooth.right.generation
        >>> roll, by_u, by_v = flank.progress(np.array([0.1]), np.array([0.0]))
        >>> roll.shape
        (1,)
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
