"""Cylinders twisted about their axis: helical teeth of what a tool generates in the transverse section."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.kernel.algebra import AXIS, Array, cross, dot, rotation_about, turn
from gearmesh.kernel.surface import Jet, Surface


@dataclass(frozen=True)
class Twisted:
    """A cylinder along z, its sections turned about z by `rate` z (rad/mm); parameters are those of the cylinder.

    R = Rz(rate z) r,  N = Rz(rate z) (n - h e_z) / |n - h e_z|  with h = rate n . (e_z x r), for n . e_z = 0: a screw surface in
    every section of which the cylinder's own section stands.
    """

    surface: Surface
    rate: float

    def jet(self, u: Array, v: Array) -> Jet:
        flat, k = self.surface.jet(u, v), self.rate
        around = k * cross(AXIS, flat.r)
        lean = dot(flat.n, around)
        shorter = 1.0 / np.sqrt(1.0 + lean**2)
        normal = (flat.n - lean[..., None] * AXIS) * shorter[..., None]

        def carried(r_q: Array, n_q: Array) -> tuple[Array, Array]:
            """Derivatives of point and normal, seen in the turned section, for those of the cylinder."""
            z_q = r_q[..., 2:]
            lean_q = dot(n_q, around) + k * dot(flat.n, cross(AXIS, r_q))
            normal_q = (n_q - lean_q[..., None] * AXIS) * shorter[..., None]
            normal_q = normal_q - (lean * lean_q * shorter**2)[..., None] * normal
            return r_q + around * z_q, normal_q + k * z_q * cross(AXIS, normal)

        r_u, n_u = carried(flat.r_u, flat.n_u)
        r_v, n_v = carried(flat.r_v, flat.n_v)
        rotation = rotation_about("z", k * flat.r[..., 2])
        return Jet(*(turn(rotation, each) for each in (flat.r, normal, r_u, r_v, n_u, n_v)))
