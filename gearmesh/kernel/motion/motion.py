"""What a rigid motion is: a tool over a blank, by one parameter or several, with its exact twists.

A motion M(phi) takes the tool to the blank. Its twist is given in the *tool* frame: a tool point r moves over the
blank with M^-1 M' r = Omega x r + tau, which is the relative velocity in the equation of meshing [CR3553 1.5.2].
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array


@dataclass(frozen=True)
class MotionState:
    """A motion at parameters phi (...,): the transform, its twist in the tool frame, and the twist's derivative.

    `omega`, `tau` give the velocity omega x r + tau of a tool point r per unit of phi, in the tool frame; `omega_phi`,
    `tau_phi` are their derivatives with respect to phi. Each is (..., 3), or (3,) where it is the same for all phi.
    """

    tool_to_blank: Rigid
    omega: Array
    tau: Array
    omega_phi: Array
    tau_phi: Array


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
        """True where omega is constant and tau linear in phi, so that the equation of meshing is linear in phi."""

    @property
    def unmodified_motion(self) -> Motion | None:
        """This motion, or one close to it, whose twist is a + b cos(phi) + c sin(phi) in the tool frame; None if none is.

        So is the twist of a tool turning with a cradle over a blank that turns in a constant ratio: the equation of
        meshing is A cos(phi) + B sin(phi) + C = 0.
        """

    def at(self, phi: Array) -> MotionState:
        """State at phi (...,), in rad."""

    def axes(self, phi: Array) -> tuple[MachineAxis, ...]:
        """Axes of the machine at one phi (rad), beside those of blank and tool."""


Twist = tuple[Array, Array]


@dataclass(frozen=True)
class SeveralStates:
    """A motion of K parameters at values of them: as `MotionState`, with a twist (omega, tau), (..., 3) each, for every one.

    `twists[a]`: velocity of tool points per unit of parameter a, in the tool frame; `derivatives[a][b]`: its derivative
    with respect to parameter b.
    """

    tool_to_blank: Rigid
    twists: tuple[Twist, ...]
    derivatives: tuple[tuple[Twist, ...], ...]
