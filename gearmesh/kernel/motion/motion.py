"""Rigid motions of a tool relative to a blank, by one parameter or several, with exact twists.

A motion M(phi) takes coordinates of the tool to coordinates of the blank. Its twist is given in the *tool* frame: a
tool point r moves over the blank with M^-1 M' r = Omega x r + tau. This is the relative velocity in the equation of
meshing [CR3553 1.5.2].
"""

from __future__ import annotations

from typing import Protocol

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, cross
from gearmesh.records import dataclass


@dataclass(frozen=True)
class MotionState:
    """A motion at parameters phi (...,): transform, twist in the tool frame, and derivative of the twist.

    The velocity of a tool point r is omega x r + tau per unit of phi. Vectors are (..., 3), or (3,) if they are
    constant.
    """

    #: transform from the tool to the blank frame
    tool_to_blank: Rigid
    #: angular velocity, rad per unit of phi, in the tool frame
    omega: Array
    #: velocity at the tool's origin, mm per unit of phi, in the tool frame
    tau: Array
    #: derivative of omega with respect to phi
    omega_phi: Array
    #: derivative of tau with respect to phi
    tau_phi: Array

    def velocity(self, r: Array) -> Array:
        """Return the velocity (..., 3) of tool points r (..., 3), in the tool frame."""
        return cross(self.omega, r) + self.tau

    def velocity_change(self, r: Array) -> Array:
        """Return the derivative (..., 3) by phi of the velocity of tool points r (..., 3)."""
        return cross(self.omega_phi, r) + self.tau_phi


@dataclass(frozen=True)
class MachineAxis:
    """An axis of a tool or its machine, in the blank's frame: a point (3,), mm, and a unit direction (3,)."""

    name: str
    point: Array
    direction: Array


class Motion(Protocol):
    """One-parameter rigid motion of a tool relative to a blank."""

    @property
    def linear(self) -> bool:
        """True if omega is constant and tau is linear in phi: then the equation of meshing is linear in phi."""

    @property
    def unmodified_motion(self) -> Motion | None:
        """This motion or a close one, whose twist is a + b cos(phi) + c sin(phi) in the tool frame, or None.

        The twist has this form if the tool turns with a cradle while the blank turns in a constant ratio. The equation
        of meshing is then A cos(phi) + B sin(phi) + C = 0.
        """

    def at(self, phi: Array) -> MotionState:
        """Return the state at phi (...,), rad."""

    def axes(self, phi: Array) -> tuple[MachineAxis, ...]:
        """Return the machine's axes at one phi (rad), without the axes of blank and tool."""


#: omega and tau, (..., 3) each
Twist = tuple[Array, Array]


@dataclass(frozen=True)
class SeveralStates:
    """A motion of K parameters at given parameter values, with one twist (omega, tau), (..., 3) each, per parameter.

    `twists[a]` is the velocity of tool points per unit of parameter a, in the tool frame. `derivatives[a][b]` is the
    derivative of `twists[a]` with respect to parameter b.
    """

    tool_to_blank: Rigid
    twists: tuple[Twist, ...]
    derivatives: tuple[tuple[Twist, ...], ...]
