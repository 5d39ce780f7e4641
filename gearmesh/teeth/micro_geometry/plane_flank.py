"""Flanks of racks in closed form, with micro-geometry: planes along the tooth traces [ISO 21771-1, ISO 53].

In a rack's own frame x points out of the bar from the reference plane, y along it, z across. The flank of side s, +1
right (y < 0), is

    y = s (-half + x tan(alpha_t) + a / cos(alpha_t)) + z tan(beta)

The amount a(x, z) is positive where material is removed, along the line of action in the transverse plane. It moves a
point along the bar into the material, at constant height. On an involute a point turns about the axis instead (see
`screw_involute`).

            | x  \\
            |     \\ flank        N = (Y_x, -1, Y_z) of the right side y = Y(x, z), its opposite of the left one
    --------+------\\------ y
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearmesh.kernel.numeric.algebra import Array, broadcast_pair, dot
from gearmesh.kernel.surface.surface import Jet
from gearmesh.records import dataclass
from gearmesh.teeth.micro_geometry.screw_involute import NO_AMOUNT, Amount


@dataclass(frozen=True)
class PlaneFlank:
    """A rack's flank; parameters: height x over the reference plane and z, both mm. The normal leaves the material."""

    #: transverse pressure angle, rad
    alpha_t: float
    #: dy/dz along the tooth trace
    slope: float
    #: transverse half thickness of the tooth on the reference plane at z = 0, mm
    half: float
    #: +1 right, -1 left
    side: int = 1
    #: micro-geometry over height and z; None for the plane
    amount: Amount | None = None

    @staticmethod
    def through(jet: Jet, side: int) -> PlaneFlank:
        """Return the plane through a point and with the normal of a jet (1,)."""
        (r,), (n,) = jet.r, side * jet.n / np.abs(jet.n[..., 1:2])
        # n = (Y_x, -1, Y_z)
        made = PlaneFlank(float(np.arctan(side * n[0])), float(n[2]), 0.0, side)
        return replace(made, half=float(side * (r[0] * n[0] + r[2] * n[2] - r[1])))

    def jet(self, u: Array, v: Array) -> Jet:
        x, z = broadcast_pair(u, v)
        given = NO_AMOUNT if self.amount is None else self.amount.jet(x, z)
        s, tangent, over = self.side, np.tan(self.alpha_t), 1.0 / np.cos(self.alpha_t)
        by_x, by_z = s * (tangent + over * given.a_l), self.slope + s * over * given.a_z
        y = s * (-self.half + x * tangent + over * given.a) + self.slope * z
        normal = _vectors(x, by_x, -1.0, by_z)
        size = s / np.sqrt(dot(normal, normal))[..., None]
        n = size * normal

        def normal_change(to_x: Array, to_z: Array) -> Array:
            changed = size * _vectors(x, s * over * to_x, 0.0, s * over * to_z)
            change: Array = changed - n * dot(n, changed)[..., None]
            return change

        return Jet(
            r=_vectors(x, x, y, z),
            n=n,
            r_u=_vectors(x, 1.0, by_x, 0.0),
            r_v=_vectors(x, 0.0, by_z, 1.0),
            n_u=normal_change(given.a_ll, given.a_lz),
            n_v=normal_change(given.a_lz, given.a_zz),
        )


def _vectors(like: Array, *components: Array | float) -> Array:
    """Vectors (..., 3) of components (...,) or numbers, with the shape of `like`."""
    made = np.empty((*like.shape, 3))
    for k, component in enumerate(components):
        made[..., k] = component
    return made
