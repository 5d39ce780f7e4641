"""Tools that roll: a rack on a pitch cylinder, a cutter on a cradle; written out, a third of the time of the general product."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from gearmesh.kernel.algebra import AXIS, Array, about_z, cross, rotation_about
from gearmesh.kernel.motion import MotionState
from gearmesh.kernel.rigid import Rigid


@dataclass(frozen=True)
class RackRoll:
    """A rack's pitch plane x = 0 rolling without sliding on the pitch cylinder of radius `radius` (mm) [LT02 6].

    M(phi) r = Rz(phi) (r + (radius, -radius phi, 0)); the twist in the tool frame is Omega = e_z and
    tau = (radius phi, 0, 0), which makes the equation of meshing linear in phi [LT02 7; LT85 A.4].
    """

    radius: float
    linear: bool = True
    unmodified: None = None

    def at(self, phi: Array) -> MotionState:
        phi = np.asarray(phi, dtype=float)
        rotation, r = rotation_about("z", phi), self.radius
        c, s = rotation[..., 0, 0], rotation[..., 1, 0]
        shift, tau = np.zeros((*phi.shape, 3)), np.zeros((*phi.shape, 3))
        shift[..., 0], shift[..., 1] = r * (c + phi * s), r * (s - phi * c)
        tau[..., 0] = r * phi
        along_x = np.array([r, 0.0, 0.0])
        return MotionState(Rigid(rotation, shift), AXIS, tau, np.zeros(3), along_x)


@dataclass(frozen=True)
class CradleRoll:
    """A tool turning with a cradle about its z axis while the blank turns about its own [CR3553 1.2; AB 9-16].

    M(phi) r = Rz(turn(phi)) (base Rz(sense phi) (r + centre)): `centre` (3,) the tool's origin in the machine frame at phi = 0,
    `base` the machine frame to the blank's at rest, turn(phi) the polynomial `turn` (its coefficients, rad) of the blank.
    """

    centre: tuple[float, float, float]
    base: Rigid
    turn: tuple[float, ...]
    sense: float = 1.0
    linear: bool = False

    @cached_property
    def unmodified(self) -> CradleRoll:
        """The motion with a constant ratio of roll."""
        return replace(self, turn=self.turn[:2]) if any(self.turn[2:]) else self

    @cached_property
    def _blank(self) -> tuple[Array, Array]:
        """Blank axis and a point of it, (3,) each, in the machine frame."""
        back = self.base.inverse
        return back.vector(AXIS), back.translation

    @cached_property
    def _turn(self) -> tuple[Array, Array, Array]:
        """Coefficients of the blank's angle and its first two derivatives, highest first."""
        turn = np.trim_zeros(np.array(self.turn[::-1]), "f")
        return turn, np.polyder(turn), np.polyder(turn, 2)

    def at(self, phi: Array) -> MotionState:
        phi = np.asarray(phi, dtype=float)
        angle, rate, rate_phi = (_polynomial(p, phi) for p in self._turn)
        c, s = np.cos(self.sense * phi), np.sin(self.sense * phi)
        # the blank's axis and origin, as they go round in the tool's frame, and their derivatives
        axis, origin = (about_z(c, -s, vector) for vector in self._blank)
        spin, centre = self.sense * AXIS, np.array(self.centre)
        axis_phi, origin_phi = -cross(spin, axis), -cross(spin, origin)
        lever = cross(axis, centre - origin)
        lever_phi = cross(axis_phi, centre - origin) - cross(axis, origin_phi)
        return MotionState(
            self._transform(c, s, np.cos(angle[..., 0]), np.sin(angle[..., 0])),
            omega=spin + rate * axis,
            tau=cross(spin, centre) + rate * lever,
            omega_phi=rate_phi * axis + rate * axis_phi,
            tau_phi=rate_phi * lever + rate * lever_phi,
        )

    def _transform(self, c: Array, s: Array, c_blank: Array, s_blank: Array) -> Rigid:
        """Rz(blank) base Rz(cradle), written out: a third of the time of general products."""
        columns = np.empty((*c.shape, 3, 3))
        base = self.base.rotation
        columns[..., 0] = c[..., None] * base[:, 0] + s[..., None] * base[:, 1]
        columns[..., 1] = c[..., None] * base[:, 1] - s[..., None] * base[:, 0]
        columns[..., 2] = base[:, 2]
        rotation = np.empty_like(columns)
        c_blank, s_blank = c_blank[..., None], s_blank[..., None]
        rotation[..., 0, :] = c_blank * columns[..., 0, :] - s_blank * columns[..., 1, :]
        rotation[..., 1, :] = s_blank * columns[..., 0, :] + c_blank * columns[..., 1, :]
        rotation[..., 2, :] = columns[..., 2, :]
        shift = about_z(c_blank[..., 0], s_blank[..., 0], self.base.translation)
        return Rigid(rotation, rotation @ np.array(self.centre) + shift)


def _polynomial(coefficients: Array, x: Array) -> Array:
    """Values (..., 1) of a polynomial, highest coefficient first; of a constant only one, (1,)."""
    value: Array = coefficients[:1] if coefficients.size else np.zeros(1)
    for coefficient in coefficients[1:]:
        value = value * x[..., None] + coefficient
    return value
