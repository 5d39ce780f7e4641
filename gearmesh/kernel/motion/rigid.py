"""Rigid transforms in batches.

A transform is named by both of its frames: `tool_to_blank` takes coordinates in the tool frame to coordinates in the
blank frame. Lengths are in mm, angles in rad. Rotations are (..., 3, 3), translations (..., 3); leading axes broadcast.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from gearmesh.kernel.numeric.algebra import Array, rotation_about, turn
from gearmesh.records import dataclass

#: largest sine of the angle between axes that count as parallel
MAX_SINE_OF_PARALLEL = 1e-9
#: largest `rotation_error` of a rigid motion
MAX_ROTATION_ERROR = 1e-9


@dataclass(frozen=True)
class Rigid:
    """Rigid transform r -> rotation r + translation; rotation (..., 3, 3), translation (..., 3) in mm."""

    rotation: Array
    translation: Array

    @staticmethod
    def identity() -> Rigid:
        """Return the identity transform.

        Returns
        -------
        Rigid
            Of one frame onto itself.

        Examples
        --------
        >>> gm.Rigid.identity().point(np.array([1.0, 2.0, 3.0]))
        array([1., 2., 3.])
        """
        return Rigid(np.eye(3), np.zeros(3))

    @staticmethod
    def about_z(angle: ArrayLike) -> Rigid:
        """Return a rotation about the z axis.

        Parameters
        ----------
        angle : array_like, (...,)
            rad.

        Returns
        -------
        Rigid
            One rotation per angle.

        Examples
        --------
        >>> gm.Rigid.about_z(np.pi / 2.0).point(np.array([1.0, 0.0, 0.0])).round(9)
        array([0., 1., 0.])
        """
        return Rigid(rotation_about("z", angle), np.zeros(3))

    def point(self, r: Array) -> Array:
        """Transform points to the target frame.

        Parameters
        ----------
        r : ndarray, (..., 3)
            mm, in the source frame.

        Returns
        -------
        ndarray, (..., 3)
            Rotated and displaced.

        Examples
        --------
        >>> gm.Rigid(np.eye(3), np.ones(3)).point(np.zeros(3))
        array([1., 1., 1.])
        """
        return turn(self.rotation, r) + self.translation

    def vector(self, v: Array) -> Array:
        """Rotate free vectors to the target frame.

        Parameters
        ----------
        v : ndarray, (..., 3)
            Such as normals and velocities.

        Returns
        -------
        ndarray, (..., 3)
            Rotated, not displaced.

        Examples
        --------
        >>> gm.Rigid(np.eye(3), np.ones(3)).vector(np.array([0.0, 0.0, 1.0]))
        array([0., 0., 1.])
        """
        return turn(self.rotation, v)

    def vectors(self, *vectors: Array) -> tuple[Array, ...]:
        """Rotate several free vectors to the target frame in one product.

        Parameters
        ----------
        vectors : ndarray, (..., 3)
            All of one shape.

        Returns
        -------
        tuple of ndarray, (..., 3)
            Each rotated by `vector`.

        Examples
        --------
        >>> x, y, _ = np.eye(3)
        >>> len(gm.Rigid.about_z(0.1).vectors(x, y))
        2
        """
        # vectors as columns: products take half the time of those with transposed rotations
        together = np.empty((*vectors[0].shape, len(vectors)))
        for k, vector in enumerate(vectors):
            together[..., k] = vector
        turned = self.rotation @ together
        return tuple(turned[..., k] for k in range(len(vectors)))

    def __matmul__(self, other: Rigid) -> Rigid:
        """Return the product: `a_to_b @ c_to_a` is c_to_b."""
        return Rigid(self.rotation @ other.rotation, self.point(other.translation))

    @property
    def inverse(self) -> Rigid:
        back = np.swapaxes(self.rotation, -1, -2)
        return Rigid(back, -turn(back, self.translation))


def rotation_error(place: Rigid) -> Array:
    """Return the largest difference (...,) of each rotation's product with its transpose from the identity; inf for reflections."""
    off = np.abs(place.rotation @ np.swapaxes(place.rotation, -1, -2) - np.eye(3)).max(axis=(-2, -1))
    return np.where(np.linalg.det(place.rotation) > 0.0, off, np.inf)
