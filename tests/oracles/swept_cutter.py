"""A cutter swept by homogeneous matrices, and how far its cone is from points along their normals."""

from __future__ import annotations

from typing import Any

import numpy as np

from gearmesh.kernel.numeric.algebra import Array


def turn(axis: int, angle: Array) -> Array:
    """Homogeneous rotations (..., 4, 4) about x, y or z (0, 1, 2)."""
    c, s = np.cos(angle), np.sin(angle)
    matrix = np.zeros((*np.shape(angle), 4, 4))
    i, j = (axis + 1) % 3, (axis + 2) % 3
    matrix[..., axis, axis] = matrix[..., 3, 3] = 1.0
    matrix[..., i, i], matrix[..., i, j], matrix[..., j, i], matrix[..., j, j] = c, -s, s, c
    return matrix


def shift(x: Array, y: Array, z: Array) -> Array:
    matrix = np.zeros((*np.broadcast_shapes(np.shape(x), np.shape(y), np.shape(z)), 4, 4))
    matrix[..., range(4), range(4)] = 1.0
    matrix[..., 0, 3], matrix[..., 1, 3], matrix[..., 2, 3] = x, y, z
    return matrix


def power_series(constant: float, coefficients: Any, q: Array) -> Array:
    return constant + sum((a * q ** (k + 1) for k, a in enumerate(coefficients)), np.zeros_like(q))


def along_to_cone(cutter_to_blank: Array, cone: tuple[float, float], points: Array, normals: Array) -> Array:
    """Return distances (mm), along the normals (N, 3) from points (N, 3), to a cutter's prolonged cone at (..., 4, 4).

    `cone`: its radius at the tip, mm, and by how much it grows with the height over it.
    """
    back = np.linalg.inv(cutter_to_blank)
    p = np.einsum("...nij,nj->...ni", back[..., :3, :3], points) + back[..., :3, 3]
    d = np.einsum("...nij,nj->...ni", back[..., :3, :3], normals)
    tip, slope = cone
    # x^2 + y^2 = (r - slope z)^2
    radius = tip - slope * p[..., 2]
    a = d[..., 0] ** 2 + d[..., 1] ** 2 - (slope * d[..., 2]) ** 2
    b = p[..., 0] * d[..., 0] + p[..., 1] * d[..., 1] + radius * slope * d[..., 2]
    c = p[..., 0] ** 2 + p[..., 1] ** 2 - radius**2
    return np.asarray(-c / (b + np.sign(b) * np.sqrt(b**2 - a * c)))
