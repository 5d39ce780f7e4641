"""Two turns in a constant ratio, such as cradle or shaper and blank, from two products with precomputed matrices."""

from __future__ import annotations

from functools import cached_property

import numpy as np

from gearmesh.kernel.motion.motion import MotionState
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Z_AXIS, Array, cross
from gearmesh.records import dataclass

#: parts of a rotation about z: the constant part, the factor of the cosine, the factor of the sine
ROTATION_PARTS = np.array(
    [np.diag([0.0, 0.0, 1.0]), np.diag([1.0, 1.0, 0.0]), [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]]
)
#: rows: derivatives of 1, cosine and sine in terms of 1, cosine and sine
PART_DERIVATIVES = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])


@dataclass(frozen=True)
class TwoTurns:
    """M(phi) = first Rz(outer) between Rz(inner) last, with both angles linear in phi.

    The entries of M are sums of products of (1, cosine, sine) of both angles. The twist in the tool's frame is a
    constant plus multiples of cosine and sine of the inner angle. This is faster than the product of steps.
    """

    #: angle at phi = 0 (rad) and its rate
    outer: tuple[float, float]
    #: fixed transform between the two turns
    between: Rigid
    #: angle at phi = 0 (rad) and its rate
    inner: tuple[float, float]
    #: fixed transform from the tool's frame
    last: Rigid
    #: fixed transform to the blank's frame; None for the identity
    first: Rigid | None = None

    def at(self, phi: Array) -> MotionState:
        """Return the state at phi (...,)."""
        outer, inner = (_parts(angle + rate * phi) for angle, rate in (self.outer, self.inner))
        place = (outer[..., :, None] * inner[..., None, :]).reshape(*phi.shape, 9) @ self._place
        rotation, translation = place[..., :9].reshape(*phi.shape, 3, 3), place[..., 9:]
        rates = inner @ self._twist
        return MotionState(Rigid(rotation, translation), *(rates[..., k : k + 3] for k in (0, 3, 6, 9)))

    @cached_property
    def _place(self) -> Array:
        """Matrix (9, 12) from products of the parts of both angles to the rotation (9) and translation (3)."""
        rotations = np.einsum("aij,jk,bkl->abil", ROTATION_PARTS, self.between.rotation, ROTATION_PARTS)
        translations = rotations @ self.last.translation
        translations[:, 0] += ROTATION_PARTS @ self.between.translation
        rotations = rotations @ self.last.rotation
        if self.first is not None:
            rotations = self.first.rotation @ rotations
            translations = translations @ self.first.rotation.T
            translations[0, 0] += self.first.translation
        return np.concatenate((rotations.reshape(9, 9), translations.reshape(9, 3)), axis=1)

    @cached_property
    def _twist(self) -> Array:
        """Matrix (3, 12) from the parts of the inner angle to omega, tau, omega_phi and tau_phi."""
        # the outer turn in the frame between the turns, then rotated back by the inner angle
        back = ROTATION_PARTS * np.array([1.0, 1.0, -1.0])[:, None, None]
        seen = self.outer[1] * self.between.rotation.T
        omega, tau = back @ (seen @ Z_AXIS), back @ (seen @ cross(Z_AXIS, self.between.translation))
        omega[0] += self.inner[1] * Z_AXIS
        tau = tau + cross(omega, self.last.translation)
        twist = np.concatenate((omega @ self.last.rotation, tau @ self.last.rotation), axis=1)
        return np.concatenate((twist, self.inner[1] * PART_DERIVATIVES.T @ twist), axis=1)


def _parts(angle: Array) -> Array:
    """Return 1, cosine and sine (..., 3) of angles (...,), rad."""
    parts = np.ones((*angle.shape, 3))
    np.cos(angle, out=parts[..., 1])
    np.sin(angle, out=parts[..., 2])
    return parts
