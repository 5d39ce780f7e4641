"""Forces in a mesh of involute teeth without friction, in closed form [ISO 21771; ISO 6336-1].

They lie in the plane of action, along the normal of the flanks: tangential, radial and axial parts are those at the pitch point.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from gearmesh.systems.cylindrical.geometry.geometry import InvolutePair
    from gearmesh.systems.cylindrical.rack.member import RackMesh


@dataclass(frozen=True)
class MeshForces:
    """Forces, N, on both members of a mesh: `transverse` F_bt, along the line of action of the transverse section; angles alpha_t,
    alpha_wt and, signed, beta_b of the pinion, rad; `sense`, +1 of the pinion's right flanks, -1 of its left ones."""

    transverse: float
    angle: float
    working_angle: float
    base_helix: float
    sense: int

    @property
    def tangential(self) -> float:
        """F_wt, at the working pitch circles."""
        return self.transverse * math.cos(self.working_angle)

    @property
    def at_reference(self) -> float:
        """F_t, the tangential force at the reference circles that has the same torque."""
        return self.transverse * math.cos(self.angle)

    @property
    def radial(self) -> float:
        """F_wr, at the working pitch circles."""
        return self.transverse * math.sin(self.working_angle)

    @property
    def axial(self) -> float:
        """F_wa on the pinion, > 0 along its z; the gear has the opposite."""
        return -self.sense * self.transverse * math.tan(self.base_helix)

    @property
    def normal(self) -> float:
        """F_bn, along the normal of the flanks."""
        return self.transverse / math.cos(self.base_helix)


def mesh_forces(mesh: InvolutePair | RackMesh, torque: float, sense: int) -> MeshForces:
    """Forces for a torque (Nm) on the pinion, which drives with its right flanks (`sense` +1) or left ones (-1)."""
    own = mesh.pinion
    return MeshForces(1e3 * torque / own.base_radius, own.alpha_t, mesh.working_angle, own.beta_b, sense)
