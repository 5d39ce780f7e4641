"""Motions composed of turns and shifts, leftmost first: the general product, exact for every motion of the package."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from gearmesh.kernel.motion.motion import MachineAxis, MotionState, SeveralStates, Twist
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.motion.two_turns import TwoTurns
from gearmesh.kernel.numeric.algebra import Z_AXIS, Array, cross, rotation_about, turn
from gearmesh.records import dataclass


@dataclass(frozen=True)
class Step:
    """One factor of a `Chain`: a turn about z by angle0 + rate phi, then a shift by offset + velocity phi, then `base`.

    As a transform: r -> base (Rz(angle0 + rate phi) r + offset + velocity phi). Vectors are (3,), in the frame that
    `base` maps from.
    """

    #: turn (rad) per unit of phi
    rate: float = 0.0
    #: angle at phi = 0, rad
    angle0: float = 0.0
    #: shift at phi = 0, mm
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)
    #: shift (mm) per unit of phi
    velocity: tuple[float, float, float] = (0.0, 0.0, 0.0)
    #: fixed transform applied last; None for the identity
    base: Rigid | None = None
    #: coefficients of phi^2, phi^3, ... added to the angle (modified roll)
    higher: tuple[float, ...] = ()
    #: coefficients (3,) of phi^2, phi^3, ... added to the shift
    plunge: tuple[tuple[float, float, float], ...] = ()
    #: number of the motion parameter that is phi, for motions of several parameters
    parameter: int = 0

    @property
    def moves(self) -> bool:
        """True if the shift changes with phi."""
        return any(self.velocity) or bool(self.plunge)

    @property
    def turns(self) -> bool:
        """True if the step contains an angle."""
        return bool(self.rate or self.angle0 or any(self.higher))

    def shift(self, phi: Array) -> tuple[Array, Array, Array]:
        """Return the shift and its first two derivatives with respect to phi, (..., 3) each; (3,) if constant."""
        if not self.plunge:
            velocity = np.array(self.velocity)
            return np.array(self.offset) + phi[..., None] * velocity, velocity, np.zeros(3)
        path = np.array((self.offset, self.velocity, *self.plunge), dtype=float)
        powers = phi[..., None] ** np.arange(len(path))
        power = np.arange(1, len(path))
        return (
            powers @ path,
            powers[..., :-1] @ (power[:, None] * path[1:]),
            powers[..., :-2] @ ((power[1:] * power[:-1])[:, None] * path[2:]),
        )

    def turning(self, phi: Array) -> tuple[Array, Array, Array]:
        """Return the angle about z and its first two derivatives with respect to phi, each (...,)."""
        if not any(self.higher):
            return self.angle0 + self.rate * phi, np.array(self.rate), np.array(0.0)
        angle = np.polynomial.Polynomial((self.angle0, self.rate, *self.higher))
        return angle(phi), angle.deriv(1)(phi), angle.deriv(2)(phi)


@dataclass(frozen=True)
class Chain:
    """Motion composed of steps, leftmost first: M(phi) = S_1(phi) S_2(phi) ... S_n(phi).

    Twists are accumulated exactly. When a factor J with body twist xi_J is appended to a product with body twist xi,
    the new twist is Ad(J^-1) xi + xi_J. Its derivative is Ad(J^-1) xi' - [xi_J, Ad(J^-1) xi] + xi_J'.
    """

    steps: tuple[Step, ...]
    #: True if omega is constant and tau is linear in phi
    linear: bool = False
    #: True if the twist is harmonic in phi once the higher terms of the angles are left out
    harmonic: bool = False

    @cached_property
    def unmodified_motion(self) -> Chain | None:
        """The chain without the higher terms of its angles, if it is `harmonic`; otherwise None."""
        if not self.harmonic:
            return None
        if not any(any(step.higher) for step in self.steps):
            return self
        return replace(self, steps=tuple(replace(step, higher=()) for step in self.steps))

    @cached_property
    def _two_turns(self) -> TwoTurns | None:
        """The same motion as `TwoTurns`, if exactly two steps turn in a constant ratio and none shifts; else None."""
        fixed, turns = [Rigid.identity()], list[tuple[float, float]]()
        for step in self.steps:
            if step.moves or any(step.higher):
                return None
            place = Rigid(np.eye(3), np.array(step.offset))
            fixed[-1] = fixed[-1] @ (place if step.base is None else step.base @ place)
            if step.turns:
                turns.append((step.angle0, step.rate))
                fixed.append(Rigid.identity())
        if len(turns) != 2:
            return None
        return TwoTurns(turns[0], fixed[1], turns[1], fixed[2], fixed[0])

    def at(self, phi: Array) -> MotionState:
        """Return the state at phi (...,), which is the parameter of every step."""
        if self._two_turns is not None:
            return self._two_turns.at(np.asarray(phi, dtype=float))
        total, ((omega, tau),), (((omega_phi, tau_phi),),) = _accumulate(self.steps, (np.asarray(phi, dtype=float),))
        return MotionState(total, omega, tau, omega_phi, tau_phi)

    def axes(self, *parameters: Array) -> tuple[MachineAxis, ...]:
        return ()

    def at_several(self, *parameters: Array) -> SeveralStates:
        """Return the state at values (...,) of several parameters; each step follows the parameter that it names."""
        values = np.broadcast_arrays(*(np.asarray(value, dtype=float) for value in parameters))
        return SeveralStates(*_accumulate(self.steps, tuple(values)))


def _accumulate(
    steps: tuple[Step, ...], parameters: tuple[Array, ...]
) -> tuple[Rigid, tuple[Twist, ...], tuple[tuple[Twist, ...], ...]]:
    """Return the transform, the twists and the twists' derivatives of a product of steps."""
    parameter_numbers = range(len(parameters))
    zero = np.zeros((*parameters[0].shape, 3))
    total = Rigid.identity()
    twists: list[Twist] = [(zero, zero) for _ in parameter_numbers]
    derivatives: list[list[Twist]] = [[(zero, zero) for _ in parameter_numbers] for _ in parameter_numbers]
    # zero terms are skipped: most steps only turn or only shift, and nothing moves before the first step
    for number, step in enumerate(steps):
        phi, index = parameters[step.parameter], step.parameter
        if step.base is not None:
            total = total @ step.base
            if number:
                twists = [_body(step.base, *twist) for twist in twists]
                derivatives = [[_body(step.base, *twist) for twist in row] for row in derivatives]
        if number and not step.turns and not step.moves:
            # a constant shift changes only the reference point of the twists
            offset = np.array(step.offset)
            total = Rigid(total.rotation, total.point(offset))
            twists = [(omega, tau + cross(omega, offset)) for omega, tau in twists]
            derivatives = [[(omega, tau + cross(omega, offset)) for omega, tau in row] for row in derivatives]
            continue
        angle, rate, rate_phi = step.turning(phi)
        offset, velocity, velocity_phi = step.shift(phi)
        joint = Rigid(rotation_about("z", angle), offset)
        omega, omega_phi, tau, tau_phi = (
            rate[..., None] * Z_AXIS,
            rate_phi[..., None] * Z_AXIS,
            np.zeros(3),
            np.zeros(3),
        )
        if step.moves:
            back = np.swapaxes(joint.rotation, -1, -2)
            tau = turn(back, velocity)
            # d/dphi of Rz(-angle) v = -rate e_z x (Rz(-angle) v) + Rz(-angle) v'
            tau_phi = turn(back, velocity_phi) - cross(omega, tau)
        total = total @ joint
        if number:
            # twists of the product so far, behind this step: Ad(J^-1) xi, and Ad(J^-1) xi' - [xi_J, Ad(J^-1) xi]
            twists = [_body(joint, *twist) for twist in twists]
            derivatives = [[_body(joint, *twist) for twist in row] for row in derivatives]
            for a in parameter_numbers:
                moved, before = twists[a], derivatives[a][index]
                turned = before[1] - cross(omega, moved[1])
                derivatives[a][index] = (
                    before[0] - cross(omega, moved[0]),
                    turned - cross(tau, moved[0]) if step.moves else turned,
                )
        # add the twist of this step and its derivative
        derivatives[index][index] = (
            derivatives[index][index][0] + omega_phi,
            derivatives[index][index][1] + tau_phi,
        )
        twists[index] = (twists[index][0] + omega, twists[index][1] + tau)
    return total, tuple(twists), tuple(tuple(row) for row in derivatives)


def _body(joint: Rigid, omega: Array, tau: Array) -> tuple[Array, Array]:
    """Return Ad(joint^-1) of a twist: the velocity field omega x r + tau in the frame that `joint` maps from."""
    back = np.swapaxes(joint.rotation, -1, -2)
    return turn(back, omega), turn(back, tau + cross(omega, joint.translation))
