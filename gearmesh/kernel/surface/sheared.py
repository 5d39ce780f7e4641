"""Surfaces whose sections z = const are displaced: along y, or away from the z axis.

A rack's flank is displaced along y by a modification along the face. Threads are displaced away from the axis where the
tool is withdrawn.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields

import numpy as np

from gearmesh.kernel.numeric.algebra import Z_AXIS, Array, dot
from gearmesh.kernel.surface.surface import Jet, Surface
from gearmesh.records import dataclass

#: displacement (...,), mm, at z (...,), mm, and its first two derivatives with respect to z
Slide = Callable[[Array], tuple[Array, Array, Array]]


@dataclass(frozen=True)
class Sheared:
    """A surface whose sections z = const are moved along y by the displacement y(z) of `slide`.

    Its parameters are unchanged. R = r + y e_y,  N = (n - y' n_y e_z) / |n - y' n_y e_z|.
    """

    surface: Surface
    slide: Slide

    def jet(self, u: Array, v: Array) -> Jet:
        base = self.surface.jet(u, v)
        way, rate, bend = self.slide(base.r[..., 2])
        lean = rate * base.n[..., 1]
        normal = _less_z(base.n, lean)
        size = 1.0 / np.sqrt(dot(normal, normal))[..., None]
        n = size * normal

        def change(r_q: Array, n_q: Array) -> tuple[Array, Array]:
            z_q = r_q[..., 2]
            changed = size * _less_z(n_q, rate * n_q[..., 1] + bend * z_q * base.n[..., 1])
            return _more_y(r_q, rate * z_q), changed - n * dot(n, changed)[..., None]

        r_u, n_u = change(base.r_u, base.n_u)
        r_v, n_v = change(base.r_v, base.n_v)
        return Jet(_more_y(base.r, way), n, r_u, r_v, n_u, n_v)


@dataclass(frozen=True)
class Withdrawn:
    """A surface whose sections z = const are moved away from the z axis by the displacement h(z) of `slide`.

    Its parameters are unchanged. With e = e_rho, k = rho / (rho + h) and n = (n_rho, n_phi, n_z):

        R = r + h e,   N = (n_rho, k n_phi, n_z - h' n_rho) / |...|
    """

    surface: Surface
    slide: Slide

    def jet(self, u: Array, v: Array) -> Jet:
        base = self.surface.jet(u, v)
        slide = self.slide(base.r[..., 2])
        moved = np.logical_or.reduce([column != 0.0 for column in slide])
        if moved.all():
            return self._moved(base, *slide)
        # points that stay, as all of a thread but its run-out, keep their jet
        columns = [np.array(np.broadcast_to(getattr(base, field.name), base.r.shape)) for field in fields(Jet)]
        if moved.any():
            there = self._moved(Jet(*(column[moved] for column in columns)), *(column[moved] for column in slide))
            for column, field in zip(columns, fields(Jet), strict=True):
                column[moved] = getattr(there, field.name)
        return Jet(*columns)

    def _moved(self, base: Jet, *slide: Array) -> Jet:
        """Return the jet of points with a jet of the surface that is displaced, by their displacements and derivatives."""
        h, rate, bend = (column[..., None] for column in slide)
        plane = np.array([1.0, 1.0, 0.0])
        rho = np.hypot(base.r[..., :1], base.r[..., 1:2])
        e, flat = plane * base.r / rho, plane * base.n
        out = dot(base.n, e)[..., None]
        k = rho / (rho + h)
        # the normal of the moved surface in the frame (e_rho, e_phi, e_z), then normalised
        normal = k * flat + (1.0 - k) * out * e + (base.n[..., 2:] - rate * out) * Z_AXIS
        size = 1.0 / np.sqrt(dot(normal, normal))[..., None]
        n = size * normal

        def change(r_q: Array, n_q: Array) -> tuple[Array, Array]:
            z_q, rho_q = r_q[..., 2:], dot(e, r_q)[..., None]
            # derivatives of e_rho, of the normal's radial part and of k along a parameter
            e_q = (plane * r_q - rho_q * e) / rho
            out_q = (dot(n_q, e) + dot(base.n, e_q))[..., None]
            k_q = (h * rho_q - rho * rate * z_q) / (rho + h) ** 2
            changed = k_q * (flat - out * e) + k * plane * n_q + (1.0 - k) * (out_q * e + out * e_q)
            changed = size * (changed + (n_q[..., 2:] - bend * z_q * out - rate * out_q) * Z_AXIS)
            return r_q + rate * z_q * e + h * e_q, changed - n * dot(n, changed)[..., None]

        r_u, n_u = change(base.r_u, base.n_u)
        r_v, n_v = change(base.r_v, base.n_v)
        return Jet(base.r + h * e, n, r_u, r_v, n_u, n_v)


def _more_y(vector: Array, more: Array) -> Array:
    made = np.array(vector)
    made[..., 1] += more
    return made


def _less_z(vector: Array, less: Array) -> Array:
    made = np.array(vector)
    made[..., 2] -= less
    return made
