"""Surfaces whose sections across z slide along y, as what moves with a rack's flank that is modified along the face, or away from
the z axis, as threads where the tool is withdrawn.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from gearmesh.kernel.numeric.algebra import AXIS, Array, dot
from gearmesh.kernel.surface.surface import Jet, Surface

#: Ways (...,), mm, at z (...,), mm, and their first two derivatives by z
Slide = Callable[[Array], tuple[Array, Array, Array]]


@dataclass(frozen=True)
class Sheared:
    """A surface, its sections z = const moved along y by the way y(z) of a slide; parameters are its own.

    R = r + y e_y,  N = (n - y' n_y e_z) / |n - y' n_y e_z|.
    """

    surface: Surface
    slide: Slide

    def jet(self, u: Array, v: Array) -> Jet:
        own = self.surface.jet(u, v)
        way, rate, bend = self.slide(own.r[..., 2])
        lean = rate * own.n[..., 1]
        normal = _less_z(own.n, lean)
        size = 1.0 / np.sqrt(dot(normal, normal))[..., None]
        n = size * normal

        def change(r_q: Array, n_q: Array) -> tuple[Array, Array]:
            z_q = r_q[..., 2]
            changed = size * _less_z(n_q, rate * n_q[..., 1] + bend * z_q * own.n[..., 1])
            return _more_y(r_q, rate * z_q), changed - n * dot(n, changed)[..., None]

        r_u, n_u = change(own.r_u, own.n_u)
        r_v, n_v = change(own.r_v, own.n_v)
        return Jet(_more_y(own.r, way), n, r_u, r_v, n_u, n_v)


@dataclass(frozen=True)
class Withdrawn:
    """A surface, its sections z = const moved away from the z axis by the way h(z) of a slide; parameters are its own.

    With e = e_rho, k = rho / (rho + h) and n = (n_rho, n_phi, n_z):

        R = r + h e,   N = (n_rho, k n_phi, n_z - h' n_rho) / |...|
    """

    surface: Surface
    slide: Slide

    def jet(self, u: Array, v: Array) -> Jet:
        own = self.surface.jet(u, v)
        h, rate, bend = (column[..., None] for column in self.slide(own.r[..., 2]))
        plane = np.array([1.0, 1.0, 0.0])
        rho = np.hypot(own.r[..., :1], own.r[..., 1:2])
        e, flat = plane * own.r / rho, plane * own.n
        out = dot(own.n, e)[..., None]
        k = rho / (rho + h)
        normal = k * flat + (1.0 - k) * out * e + (own.n[..., 2:] - rate * out) * AXIS
        size = 1.0 / np.sqrt(dot(normal, normal))[..., None]
        n = size * normal

        def change(r_q: Array, n_q: Array) -> tuple[Array, Array]:
            z_q, rho_q = r_q[..., 2:], dot(e, r_q)[..., None]
            e_q = (plane * r_q - rho_q * e) / rho
            out_q = (dot(n_q, e) + dot(own.n, e_q))[..., None]
            k_q = (h * rho_q - rho * rate * z_q) / (rho + h) ** 2
            changed = k_q * (flat - out * e) + k * plane * n_q + (1.0 - k) * (out_q * e + out * e_q)
            changed = size * (changed + (n_q[..., 2:] - bend * z_q * out - rate * out_q) * AXIS)
            return r_q + rate * z_q * e + h * e_q, changed - n * dot(n, changed)[..., None]

        r_u, n_u = change(own.r_u, own.n_u)
        r_v, n_v = change(own.r_v, own.n_v)
        return Jet(own.r + h * e, n, r_u, r_v, n_u, n_v)


def _more_y(vector: Array, more: Array) -> Array:
    made = np.array(vector)
    made[..., 1] += more
    return made


def _less_z(vector: Array, less: Array) -> Array:
    made = np.array(vector)
    made[..., 2] -= less
    return made
