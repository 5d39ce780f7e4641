"""Helicoids: what a curve sweeps in a screw motion about the z axis, with its exact jet.

With the screw parameter P (mm/rad) and a curve c(p) with unit normals n(p) of the surface along it

    r(p, v) = Rz(v) c + P v e_z,   r_p = Rz c',   r_v = Rz (e_z x c + P e_z)
    n(p, v) = Rz(v) n,             n_p = Rz n',   n_v = Rz (e_z x n)
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from gearmesh.kernel.numeric.algebra import AXIS, Array, about_axis, about_z, broadcast_pair, cross, dot
from gearmesh.kernel.surface.surface import Jet

Signs = tuple[float, float, float]


@dataclass(frozen=True)
class Generatrix:
    """Points of a curve, unit normals of the surface that it sweeps, and the derivatives of both by p, each (..., 3)."""

    c: Array
    n: Array
    c_p: Array
    n_p: Array


class GeneratingCurve(Protocol):
    """A curve p -> c(p) on a surface that is swept in a screw motion."""

    def at(self, p: Array) -> Generatrix:
        """Points and normals at p (...,)."""


def swept(c: Array, along: tuple[Array, Array], c_p: Array, screw: float) -> Generatrix:
    """The generatrix of a curve with points c and derivatives c_p (..., 3); `along`: its unit tangents and their derivatives.

    The normal is tangent x (e_z x c + P e_z), with P = `screw` in mm/rad.
    """
    (t, t_p), path = along, about_axis(c) + screw * AXIS
    normal = cross(t, path)
    size = 1.0 / np.sqrt(dot(normal, normal))[..., None]
    n = normal * size
    change = (cross(t_p, path) + cross(t, about_axis(c_p))) * size
    return Generatrix(c, n, c_p, change - n * dot(n, change)[..., None])


@dataclass(frozen=True)
class Helicoid:
    """The surface that a curve sweeps, parameters (p, v): that of the curve and the angle of the screw motion (rad).

    `screw`: axial advance (mm/rad), negative of left-hand threads. The curve is moved along the axis by `lift` (mm), and
    reflected with its normals by `signs`, before it is swept; `outward` -1 turns the normals.
    """

    curve: GeneratingCurve
    screw: float
    signs: Signs = (1.0, 1.0, 1.0)
    outward: float = 1.0
    lift: float = 0.0

    def jet(self, u: Array, v: Array) -> Jet:
        u, v = broadcast_pair(u, v)
        return self.sweep(self.curve.at(u), v)

    def sweep(self, at: Generatrix, v: Array) -> Jet:
        """Jet where points of the curve are swept to, at angles v (...,)."""
        own = np.empty((4, *at.c.shape))
        own[0], own[1], own[2], own[3] = at.c + self.lift * AXIS, at.c_p, self.outward * at.n, self.outward * at.n_p
        r, r_u, n, n_u = about_z(np.cos(v), np.sin(v), np.array(self.signs) * own)
        rise = self.screw * AXIS
        return Jet(r + v[..., None] * rise, n, r_u, about_axis(r) + rise, n_u, about_axis(n))

    def axial_section(self, p: Array) -> tuple[Array, Array]:
        """Points (..., 2) and unit normals (..., 2) of the section by the half plane y = 0, x > 0, as x and z, at p (...,)."""
        at = self.jet(p, np.zeros_like(p))
        return half_plane(at.r, at.n, self.screw)


def half_plane(r: Array, n: Array, screw: float) -> tuple[Array, Array]:
    """Points r (..., 3) with normals n of a screw surface, moved in it to the half plane y = 0, x > 0: x and z of point and of the
    section's unit normal, (..., 2) each."""
    rho, angle = np.hypot(r[..., 0], r[..., 1]), np.arctan2(r[..., 1], r[..., 0])
    across = (r[..., 0] * n[..., 0] + r[..., 1] * n[..., 1]) / rho
    points, normals = np.stack((rho, r[..., 2] - screw * angle), axis=-1), np.stack((across, n[..., 2]), axis=-1)
    return points, normals / np.linalg.norm(normals, axis=-1)[..., None]
