"""Helicoids: surfaces swept by a curve in a screw motion about the z axis, with their exact jets.

With the screw parameter P (mm/rad), a curve c(p) and the surface's unit normals n(p) along it:

    r(p, v) = Rz(v) c + P v e_z,   r_p = Rz c',   r_v = Rz (e_z x c + P e_z)
    n(p, v) = Rz(v) n,             n_p = Rz n',   n_v = Rz (e_z x n)
"""

from __future__ import annotations

from typing import Protocol

import numpy as np

from gearmesh.kernel.numeric.algebra import Z_AXIS, Array, about_axis, about_z, broadcast_pair, cross, dot
from gearmesh.kernel.surface.surface import Jet
from gearmesh.records import dataclass

#: factors of x, y and z in a reflection
Signs = tuple[float, float, float]


@dataclass(frozen=True)
class Generatrix:
    """Points of a curve, normals of the surface that it sweeps, and their derivatives, each (..., 3)."""

    #: points of the curve, mm
    c: Array
    #: unit normals of the swept surface
    n: Array
    #: derivative of c with respect to p
    c_p: Array
    #: derivative of n with respect to p
    n_p: Array


class GeneratingCurve(Protocol):
    """A curve p -> c(p) on a surface that is swept in a screw motion."""

    def at(self, p: Array) -> Generatrix:
        """Return points and normals at p (...,)."""


def swept(c: Array, along: tuple[Array, Array], c_p: Array, screw: float) -> Generatrix:
    """Return the moved of a curve with points c and derivatives c_p (..., 3).

    `along` holds its unit tangents and their derivatives. The normal is tangent x (e_z x c + P e_z), with P = `screw`
    in mm/rad.
    """
    (t, t_p), path = along, about_axis(c) + screw * Z_AXIS
    normal = cross(t, path)
    size = 1.0 / np.sqrt(dot(normal, normal))[..., None]
    n = normal * size
    change = (cross(t_p, path) + cross(t, about_axis(c_p))) * size
    return Generatrix(c, n, c_p, change - n * dot(n, change)[..., None])


@dataclass(frozen=True)
class Helicoid:
    """Surface swept by a curve; its parameters are p of the curve and the angle v of the screw motion (rad)."""

    #: the swept curve with its normals
    curve: GeneratingCurve
    #: axial advance (mm/rad), negative for left-hand threads
    screw: float
    #: reflection of the curve and its normals before it is swept
    signs: Signs = (1.0, 1.0, 1.0)
    #: -1 to reverse the normals
    outward: float = 1.0
    #: displacement of the curve along the axis (mm), before the reflection
    lift: float = 0.0

    def jet(self, u: Array, v: Array) -> Jet:
        u, v = broadcast_pair(u, v)
        return self.sweep(self.curve.at(u), v)

    def sweep(self, at: Generatrix, v: Array) -> Jet:
        """Return the jet of points of the curve after the screw motion by angles v (...,)."""
        moved = np.empty((4, *at.c.shape))
        moved[0], moved[1], moved[2], moved[3] = (
            at.c + self.lift * Z_AXIS,
            at.c_p,
            self.outward * at.n,
            self.outward * at.n_p,
        )
        r, r_u, n, n_u = about_z(np.cos(v), np.sin(v), np.array(self.signs) * moved)
        rise = self.screw * Z_AXIS
        return Jet(r + v[..., None] * rise, n, r_u, about_axis(r) + rise, n_u, about_axis(n))

    def axial_section(self, p: Array) -> tuple[Array, Array]:
        """Return points and unit normals (..., 2), as x and z, at p (...,) in the half plane y = 0, x > 0."""
        at = self.jet(p, np.zeros_like(p))
        return half_plane(at.r, at.n, self.screw)


def half_plane(r: Array, n: Array, screw: float) -> tuple[Array, Array]:
    """Move points r (..., 3) of a screw surface with normals n in their screw motion to the half plane y = 0, x > 0.

    Returns x and z of the points and of the section's unit normals, (..., 2) each.
    """
    rho, angle = np.hypot(r[..., 0], r[..., 1]), np.arctan2(r[..., 1], r[..., 0])
    across = (r[..., 0] * n[..., 0] + r[..., 1] * n[..., 1]) / rho
    points, normals = np.stack((rho, r[..., 2] - screw * angle), axis=-1), np.stack((across, n[..., 2]), axis=-1)
    return points, normals / np.linalg.norm(normals, axis=-1)[..., None]
