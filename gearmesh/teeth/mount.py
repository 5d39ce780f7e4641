"""Mounting and motion of a member: the transform from its own frame to the fixed frame."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearmesh.kernel.motion.joint import REVOLUTE_JOINT, Joint
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array


@dataclass(frozen=True)
class Mount:
    """A member's bearing: `base` takes the unrotated member to the fixed frame, phi moves it in its `joint`.

    That is a turn about its own z axis, or the slide of a rack. A rotation by phi (rad, counted as the source counts it) is a
    right-handed rotation by `sign` * (phi - `zero`). `eccentricity` (x, y), mm, displaces the member's own z axis from the axis of
    rotation and turns with the member.
    """

    base: Rigid
    sign: float = 1.0
    zero: float = 0.0
    eccentricity: tuple[float, float] = (0.0, 0.0)
    joint: Joint = REVOLUTE_JOINT

    def at(self, phi: ArrayLike) -> Rigid:
        """Where the member is at a rotation.

        Parameters
        ----------
        phi : (...,)
            Rotation, rad; mm of travel for a rack.

        Returns
        -------
        Rigid
            Own frame to fixed frame, `rotation` (..., 3, 3) and `translation` (..., 3), mm.

        Examples
        --------
        >>> mount = gears.members["pinion"].mount
        >>> mount.at(np.radians([0.0, 10.0])).rotation.shape
        (2, 3, 3)
        """
        turned = self._turn(phi)
        if self.eccentricity == (0.0, 0.0):
            return turned
        return turned @ self.own_to_turning

    def _turn(self, phi: ArrayLike) -> Rigid:
        return self.base @ self.joint.to(self.sign * (np.asarray(phi, dtype=float) - self.zero))

    def rows(self, index: NDArray[np.intp]) -> Mount:
        """Some of the mounts of many assemblies.

        Parameters
        ----------
        index : (K,) of int
            Numbers of assemblies.

        Returns
        -------
        Mount
            The same where `base` holds one transform for all.

        Examples
        --------
        >>> mount = gears.members["pinion"].mount
        >>> mount.rows(np.array([0, 2])) is mount
        True
        """
        if self.base.rotation.ndim == 2:
            return self
        return replace(self, base=Rigid(self.base.rotation[index], self.base.translation[index]))

    @property
    def own_to_turning(self) -> Rigid:
        """The member's own frame in the one that turns about the axis of rotation: the shift by the eccentricity."""
        return Rigid(np.eye(3), np.array([*self.eccentricity, 0.0]))

    @property
    def concentric(self) -> Mount:
        """The same with the teeth on the axis of rotation."""
        return replace(self, eccentricity=(0.0, 0.0))

    def off(self, phi: ArrayLike) -> Array:
        """How far the teeth are off the place that they have without eccentricity.

        Parameters
        ----------
        phi : (...,)
            Rotation, rad; mm of travel for a rack.

        Returns
        -------
        (..., 3)
            mm, fixed frame.

        Examples
        --------
        >>> mount = gears.members["pinion"].mount
        >>> mount.off([0.0, 0.1]).tolist()
        [[0.0, 0.0, 0.0], [0.0, 0.0, 0.0]]
        """
        return self._turn(phi).vector(np.array([*self.eccentricity, 0.0]))

    def displace(self, phi: float) -> Mount:
        """The mount of teeth that stay as far off as they are at one rotation, and turn about their own axis there.

        Parameters
        ----------
        phi : float
            Rotation, rad; mm of travel for a rack.

        Returns
        -------
        Mount
            Without eccentricity.

        Examples
        --------
        >>> mount = gears.members["pinion"].mount
        >>> mount.displace(0.5) == mount.concentric
        True
        """
        base = Rigid(self.base.rotation, self.base.translation + self.off(phi))
        return replace(self, base=base, eccentricity=(0.0, 0.0)) if self.eccentricity != (0.0, 0.0) else self

    def shift(self, shift: Array) -> Mount:
        """The mounts of displaced assemblies.

        Parameters
        ----------
        shift : (N, 3)
            Displacements, mm, fixed frame.

        Returns
        -------
        Mount
            Of N assemblies.

        Examples
        --------
        >>> mount = gears.members["pinion"].mount
        >>> mount.shift(np.zeros((5, 3))).base.translation.shape
        (5, 3)
        """
        rotation = np.broadcast_to(self.base.rotation, (len(shift), 3, 3))
        return replace(self, base=Rigid(rotation, self.base.translation + shift))

    @property
    def origin(self) -> Array:
        """Point on the axis, (..., 3), fixed frame, mm."""
        return self.base.translation

    @property
    def axis(self) -> Array:
        """Axis of rotation (..., 3), fixed frame; phi grows right-handed about `spin`."""
        return self.base.rotation[..., 2]

    @property
    def spin(self) -> Array:
        """Unit vector (..., 3), fixed frame, about which the member turns right-handed as phi grows; 0 if it slides."""
        return self.sign * self.joint.spin(self.base)

    def velocity(self, r: Array) -> Array:
        """How points of the member move as phi grows.

        Parameters
        ----------
        r : (..., 3)
            Points, mm, fixed frame.

        Returns
        -------
        (..., 3)
            mm/rad.

        Examples
        --------
        >>> mount = gears.members["pinion"].mount
        >>> np.abs(mount.velocity(np.array([10.0, 0.0, 0.0]))).tolist()
        [0.0, 10.0, 0.0]
        """
        return self.sign * self.joint.velocity(self.base, r)
