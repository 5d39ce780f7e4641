"""Mounting and motion of a member: the transform from its own frame to the fixed frame."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearmesh.kernel.motion.joint import REVOLUTE_JOINT, Joint
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass


@dataclass(frozen=True)
class Mount:
    """Bearing of a member: transform from its own frame to the fixed frame at a rotation phi.

    The member turns about its own z axis, or slides if it is a rack. A rotation by phi (rad, counted as the source
    counts it) is a right-handed rotation by `sign` * (phi - `zero`).
    """

    #: transform of the unrotated member to the fixed frame
    base: Rigid
    #: +1 if phi is right-handed about the member's z axis, -1 if left-handed
    sign: float = 1.0
    #: phi of the unrotated member, rad; mm of travel for a rack
    zero: float = 0.0
    #: displacement (x, y), mm, of the member's z axis from the axis of rotation; turns with the member
    eccentricity: tuple[float, float] = (0.0, 0.0)
    #: motion of the member: a turn, or the slide of a rack
    joint: Joint = REVOLUTE_JOINT

    def at(self, phi: ArrayLike) -> Rigid:
        """Return the transform from the member's own frame to the fixed frame at rotations phi (...,), rad; mm of a
        rack."""
        turned = self._turn(phi)
        if self.eccentricity == (0.0, 0.0):
            return turned
        return turned @ self.own_to_turning

    def _turn(self, phi: ArrayLike) -> Rigid:
        """Return the transform of a member without eccentricity at a rotation."""
        return self.base @ self.joint.to(self.sign * (np.asarray(phi, dtype=float) - self.zero))

    def rows(self, index: NDArray[np.intp]) -> Mount:
        """Return some of the mounts of many assemblies, by their numbers (K,); the same mount if `base` is one
        transform."""
        if self.base.rotation.ndim == 2:
            return self
        return replace(self, base=Rigid(self.base.rotation[index], self.base.translation[index]))

    @property
    def own_to_turning(self) -> Rigid:
        """Transform from the own frame to the frame that turns about the axis of rotation: the shift by the
        eccentricity.
        """
        return Rigid(np.eye(3), np.array([*self.eccentricity, 0.0]))

    def turn_from(self, other: Mount) -> float:
        """Return the angle (rad, -pi to pi) about the axis by which this unrotated member is turned from another mount
        of it."""
        if self.base is other.base:
            return 0.0
        x, y = (other.base.rotation.T @ self.base.rotation)[:2, 0]
        return math.atan2(y, x)

    @property
    def concentric(self) -> Mount:
        """The mount without eccentricity: its teeth are centred on the axis of rotation."""
        return replace(self, eccentricity=(0.0, 0.0))

    def off(self, phi: ArrayLike) -> Array:
        """Return the displacement (..., 3), mm, fixed frame, of the teeth by the eccentricity at rotations phi (...,),
        rad."""
        return self._turn(phi).vector(np.array([*self.eccentricity, 0.0]))

    def displace(self, phi: float) -> Mount:
        """Return a mount whose teeth keep the displacement of one rotation phi (rad) and turn about their own axis."""
        base = Rigid(self.base.rotation, self.base.translation + self.off(phi))
        return replace(self, base=base, eccentricity=(0.0, 0.0)) if self.eccentricity != (0.0, 0.0) else self

    def shift(self, shift: Array) -> Mount:
        """Return the mounts of N assemblies, displaced by `shift` (N, 3), mm, fixed frame."""
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
        """Return the velocity (..., 3), mm/rad, of points r (..., 3), mm, of the member, with respect to phi; fixed
        frame."""
        return self.sign * self.joint.velocity(self.base, r)
