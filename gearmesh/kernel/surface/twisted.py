"""Surfaces twisted about the z axis: helical teeth from a transverse section, and flanks modified along the face."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from gearmesh.kernel.numeric.algebra import Z_AXIS, Array, about_axis, dot, rotation_about, turn
from gearmesh.kernel.surface.surface import Jet, Surface
from gearmesh.records import dataclass

#: angle (...,), rad, at z (...,), mm, and its first two derivatives with respect to z
Twist = Callable[[Array], tuple[Array, Array, Array]]


@dataclass(frozen=True)
class Twisted:
    """A surface whose sections z = const are turned about z by psi = `rate` z (rad/mm) plus `more`.

    Its parameters are unchanged. R = Rz(psi) r,  N = Rz(psi) (n - h e_z) / |n - h e_z|  with h = psi' n . (e_z x r). A
    constant rate turns a cylinder along z into a screw surface; each section of the screw surface is the cylinder's
    section.
    """

    surface: Surface
    rate: float
    more: Twist | None = None

    def jet(self, u: Array, v: Array) -> Jet:
        flat = self.surface.jet(u, v)
        z, n_z = flat.r[..., 2], flat.n[..., 2]
        psi, k, bend = self.rate * z, np.full_like(z, self.rate), np.zeros_like(z)
        if self.more is not None:
            psi, k, bend = (angle + addition for angle, addition in zip((psi, k, bend), self.more(z), strict=True))
        # h = psi' n . (e_z x r) tilts the normal against the twist
        swept = about_axis(flat.r)
        around = k[..., None] * swept
        lean = dot(flat.n, around)
        shorter = 1.0 / np.sqrt(1.0 + lean * (lean - 2.0 * n_z))
        normal = (flat.n - lean[..., None] * Z_AXIS) * shorter[..., None]

        def carry(r_q: Array, n_q: Array) -> tuple[Array, Array]:
            """Derivatives of point and normal, seen in the turned section, for those of the cylinder."""
            z_q = r_q[..., 2:]
            lean_q = dot(n_q, around) + k * dot(flat.n, about_axis(r_q)) + bend * z_q[..., 0] * dot(flat.n, swept)
            normal_q = (n_q - lean_q[..., None] * Z_AXIS) * shorter[..., None]
            # derivative of the normalisation
            longer = lean * lean_q - lean_q * n_z - lean * n_q[..., 2]
            normal_q = normal_q - (longer * shorter**2)[..., None] * normal
            return r_q + around * z_q, normal_q + k[..., None] * z_q * about_axis(normal)

        r_u, n_u = carry(flat.r_u, flat.n_u)
        r_v, n_v = carry(flat.r_v, flat.n_v)
        rotation = rotation_about("z", psi)
        return Jet(*(turn(rotation, vector) for vector in (flat.r, normal, r_u, r_v, n_u, n_v)))
