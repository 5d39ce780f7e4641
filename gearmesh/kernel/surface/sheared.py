"""Surfaces whose sections across z slide along y: what moves with a rack's flank that is modified along the face."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.surface import Jet, Surface

#: Ways (...,), mm, along y at z (...,), mm, and their first two derivatives by z
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


def _more_y(vector: Array, more: Array) -> Array:
    made = np.array(vector)
    made[..., 1] += more
    return made


def _less_z(vector: Array, less: Array) -> Array:
    made = np.array(vector)
    made[..., 2] -= less
    return made
