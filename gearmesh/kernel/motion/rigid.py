"""Rigid transforms in batches.

A transform is named by both of its frames, `tool_to_blank` takes coordinates in the tool frame to coordinates in
the blank frame. Lengths are in mm, angles in radians. A transform holds a rotation (..., 3, 3) and a translation
(..., 3); leading axes broadcast.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from gearmesh.kernel.numeric.algebra import Array, rotation_about, turn


@dataclass(frozen=True)
class Rigid:
    """Rigid transform r -> rotation r + translation; rotation (..., 3, 3), translation (..., 3) in mm."""

    rotation: Array
    translation: Array

    @staticmethod
    def identity() -> Rigid:
        return Rigid(np.eye(3), np.zeros(3))

    @staticmethod
    def about_z(angle: ArrayLike) -> Rigid:
        """Rotation by `angle` (..., rad) about the z axis."""
        return Rigid(rotation_about("z", angle), np.zeros(3))

    def point(self, r: Array) -> Array:
        """Points (..., 3) in the target frame."""
        return turn(self.rotation, r) + self.translation

    def vector(self, v: Array) -> Array:
        """Free vectors (..., 3) in the target frame."""
        return turn(self.rotation, v)

    def vectors(self, *vectors: Array) -> tuple[Array, ...]:
        """Several free vectors (..., 3) in the target frame, in one product."""
        together = np.empty((*vectors[0].shape[:-1], len(vectors), 3))
        for k, vector in enumerate(vectors):
            together[..., k, :] = vector
        turned = together @ np.swapaxes(self.rotation, -1, -2)
        return tuple(turned[..., k, :] for k in range(len(vectors)))

    def __matmul__(self, other: Rigid) -> Rigid:
        """`a_to_b @ c_to_a` is c_to_b."""
        return Rigid(self.rotation @ other.rotation, self.point(other.translation))

    @property
    def inverse(self) -> Rigid:
        back = np.swapaxes(self.rotation, -1, -2)
        return Rigid(back, -turn(back, self.translation))
