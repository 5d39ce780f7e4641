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
        """These points where a condition holds, those of another jet elsewhere.

        Parameters
        ----------
        condition : ndarray of bool
            (N,).
        other : Jet
            Of N points.

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
        mine = condition[:, None]
        return Jet(*(np.where(mine, getattr(self, field.name), getattr(other, field.name)) for field in fields(Jet)))

    def move(self, transform: Rigid) -> Jet:
        """The jet of the same surface in another frame.

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
        """The jet of the parallel surface; parameters stay.

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
        """Differentials of point and normal for differentials of the parameters.

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
        """Point, unit normal and their first partials.

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
    """A surface that a `tool` generates in a motion of as many parameters as it has `freedoms`: none where it is fixed, roll
    (rad), or roll and feed (mm)."""

    @property
    def tool(self) -> Surface:
        """The tool's surface, in the tool's frame."""

    @property
    def freedoms(self) -> int:
        """Number of the motion's parameters."""

    def on_tool(self, u: Array, v: Array) -> tuple[Array, Array]:
        """Where on the tool its points are generated.

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
        """Where in the motion its points are generated.

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
        """The tool's frame over the blank's.

        Parameters
        ----------
        motion : ndarray
            Parameters of the motion, (...,) each, as `generating` has them.

        Returns
        -------
        Rigid
            It takes the tool to the blank.

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
        """Axes of the machine, in the blank's frame.

        Parameters
        ----------
        motion : ndarray
            Parameters of one place of the motion.

        Returns
        -------
        tuple of MachineAxis
            Beside those of blank and tool.

        Examples
        --------
        >>> flank, fillet = gears.members["pinion"].tooth.right.generation
        >>> [axis.name for axis in flank.axes(np.array(0.0))]
        []
        """

    def progress(self, u: Array, v: Array) -> tuple[Array, Array, Array]:
        """What tells the lines along which the tool touches: the roll, or else the feed.

        Parameters
        ----------
        u : ndarray
            First parameter, (...,).
        v : ndarray
            Second parameter, (...,).

        Returns
        -------
        tuple of ndarray
            Its value, rad or mm, and its partials, (...,) each.

        Examples
        --------
        >>> flank, fillet = gears.members["pinion"].tooth.right.generation
        >>> roll, by_u, by_v = flank.progress(np.array([0.1]), np.array([0.0]))
        >>> roll.shape
        (1,)
        """


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
