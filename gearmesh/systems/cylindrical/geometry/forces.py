"""Forces in a mesh of involute teeth without friction, in closed form [ISO 21771; ISO 6336-1].

The forces lie in the plane of action, along the normal of the flanks. Tangential, radial and axial parts are given at
the pitch point.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from gearmesh.records import dataclass

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.geometry.geometry import InvolutePair
    from gearmesh.systems.cylindrical.rack.member import RackMesh


@dataclass(frozen=True)
class MeshForces:
    """Forces (N) on both members of a mesh."""

    #: F_bt, along the line of action of the transverse section, N
    transverse: float
    #: transverse pressure angle alpha_t, rad
    angle: float
    #: working pressure angle alpha_wt, rad
    working_angle: float
    #: base helix angle beta_b of the pinion, rad, positive right-handed
    base_helix: float
    #: +1 if the pinion's right flanks drive, -1 if its left flanks do
    sense: int

    @property
    def tangential(self) -> float:
        """F_wt, N, at the working pitch circles."""
        return self.transverse * math.cos(self.working_angle)

    @property
    def at_reference(self) -> float:
        """F_t, N: the tangential force at the reference circles that has the same torque."""
        return self.transverse * math.cos(self.angle)

    @property
    def radial(self) -> float:
        """F_wr, N, at the working pitch circles."""
        return self.transverse * math.sin(self.working_angle)

    @property
    def axial(self) -> float:
        """F_wa (N) on the pinion, > 0 along its z; the force on the gear is opposite."""
        return -self.sense * self.transverse * math.tan(self.base_helix)

    @property
    def normal(self) -> float:
        """F_bn, N, along the normal of the flanks."""
        return self.transverse / math.cos(self.base_helix)


def mesh_forces(mesh: InvolutePair | RackMesh, torque: float, sense: int) -> MeshForces:
    """Return the forces for a torque (Nm) on the pinion.

    The pinion drives with its right flanks (`sense` +1) or its left flanks (-1).
    """
    pinion = mesh.pinion
    return MeshForces(1e3 * torque / pinion.base_radius, pinion.alpha_t, mesh.working_angle, pinion.beta_b, sense)
