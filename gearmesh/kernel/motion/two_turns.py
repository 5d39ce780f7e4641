"""Two turns in a constant ratio, as of a cradle or shaper and the blank: two products with precomputed matrices."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from gearmesh.kernel.motion.motion import MotionState
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import AXIS, Array, components, cross

#: a rotation about z by its parts that stay, that go with the cosine and that go with the sine
PARTS = np.array(
    [np.diag([0.0, 0.0, 1.0]), np.diag([1.0, 1.0, 0.0]), [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]]]
)
#: rows: the derivatives of 1, cosine and sine by these
CHANGE = np.array([[0.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])


@dataclass(frozen=True)
class TwoTurns:
    """M(phi) = first Rz(outer) between Rz(inner) last, the angles straight over phi: pairs of that at 0 (rad) and the rate.

    Its entries are sums of products of 1, cosine and sine of either angle, and its twist in the tool's frame is the sum of a
    constant and of multiples of cosine and sine of the inner one. A quarter of the time of the products of steps.
    """

    outer: tuple[float, float]
    between: Rigid
    inner: tuple[float, float]
    last: Rigid
    first: Rigid | None = None

    def at(self, phi: Array) -> MotionState:
        """State at phi (...,)."""
        outer, inner = (_parts(angle + rate * phi) for angle, rate in (self.outer, self.inner))
        place = (outer[..., :, None] * inner[..., None, :]).reshape(*phi.shape, 9) @ self._place
        rotation, translation = place[..., :9].reshape(*phi.shape, 3, 3), place[..., 9:]
        rates = inner @ self._twist
        return MotionState(Rigid(rotation, translation), *(rates[..., k : k + 3] for k in (0, 3, 6, 9)))

    @cached_property
    def _place(self) -> Array:
        """Rotation and translation (9, 12) by the products of parts of the outer and of the inner angle."""
        rotations = np.einsum("aij,jk,bkl->abil", PARTS, self.between.rotation, PARTS)
        translations = rotations @ self.last.translation
        translations[:, 0] += PARTS @ self.between.translation
        rotations = rotations @ self.last.rotation
        if self.first is not None:
            rotations = self.first.rotation @ rotations
            translations = translations @ self.first.rotation.T
            translations[0, 0] += self.first.translation
        return np.concatenate((rotations.reshape(9, 9), translations.reshape(9, 3)), axis=1)

    @cached_property
    def _twist(self) -> Array:
        """omega, tau, omega_phi and tau_phi (3, 12) by the parts of the inner angle."""
        # the outer turn seen from between both, then turned back by the inner angle
        back = PARTS * np.array([1.0, 1.0, -1.0])[:, None, None]
        seen = self.outer[1] * self.between.rotation.T
        omega, tau = back @ (seen @ AXIS), back @ (seen @ cross(AXIS, self.between.translation))
        omega[0] += self.inner[1] * AXIS
        tau = tau + cross(omega, self.last.translation)
        twist = np.concatenate((omega @ self.last.rotation, tau @ self.last.rotation), axis=1)
        return np.concatenate((twist, self.inner[1] * CHANGE.T @ twist), axis=1)


def _parts(angle: Array) -> Array:
    """1, cosine and sine (..., 3) of angles (...,), rad."""
    return components(np.ones_like(angle), np.cos(angle), np.sin(angle))
