"""Displacements of an elastic half-space under a normal load on its surface: a point load, and pressure on a rectangle.

The half-space is z > 0, and the load acts along +z. Displacements are those of points of the body; along +z they go
into the body.

Units: mm, N, MPa. Source: [J85] K. L. Johnson, Contact Mechanics, 1985, 3.2 (point load, Boussinesq) and 3.3
(rectangle, Love).
"""

from __future__ import annotations

import numpy as np

from gearmesh.contact.hertz import Material
from gearmesh.kernel.numeric.algebra import Array


def point_displacements(place: Array, material: Material) -> Array:
    """Return displacements (..., 3), mm/N, at places (..., 3), mm, z >= 0, under a unit force at the origin [J85
    3.18]."""
    nu = material.poisson_ratio
    shear = 0.5 * material.youngs_modulus / (1.0 + nu)
    z = place[..., 2:]
    r = np.linalg.norm(place, axis=-1, keepdims=True)
    scaled = place * z / r**3
    scaled[..., :2] -= (1.0 - 2.0 * nu) * place[..., :2] / (r * (r + z))
    scaled[..., 2:] += 2.0 * (1.0 - nu) / r
    result: Array = scaled / (4.0 * np.pi * shear)
    return result


def rectangle_influence(x: Array, y: Array, width: Array, height: Array) -> Array:
    """Return surface displacements (...,) under unit pressure on a rectangle, times E / (1 - nu^2), mm.

    The points of the surface are (x, y) (...,), mm. The rectangle is `width` (along x) by `height` and centred on the
    origin [J85 3.25].
    """
    total = np.zeros(np.broadcast_shapes(x.shape, y.shape, np.shape(width), np.shape(height)))
    for x_sign in (1.0, -1.0):
        a = x + x_sign * 0.5 * width
        for y_sign in (1.0, -1.0):
            b = y + y_sign * 0.5 * height
            # equals a log(b + r) + b log(a + r), but keeps its digits where b + r or a + r is nearly 0
            total += x_sign * y_sign * (a * np.arcsinh(b / np.abs(a)) + b * np.arcsinh(a / np.abs(b)))
    influence: Array = total / np.pi
    return influence
