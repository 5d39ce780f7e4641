"""Vector algebra in batches: products, unit vectors, rotations and polar angles over the last axis.

Lengths are in mm, angles in rad.
"""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]
#: type of the numbers of an array
Number = TypeVar("Number", bound=np.generic)


#: one arc second in rad
ARCSEC = np.pi / 648000.0
#: unit vector of the z axis
Z_AXIS = np.array([0.0, 0.0, 1.0])


def dot(a: Array, b: Array) -> Array:
    """Return the scalar product over the last axis: (..., 3) and (..., 3) -> (...,)."""
    total = a[..., 0] * b[..., 0]
    # added in place, which is faster than a new array per sum
    total += a[..., 1] * b[..., 1]
    total += a[..., 2] * b[..., 2]
    return total


def cross(a: Array, b: Array) -> Array:
    """Return the vector product over the last axis: (..., 3) and (..., 3) -> (..., 3)."""
    ax, ay, az = a[..., 0], a[..., 1], a[..., 2]
    bx, by, bz = b[..., 0], b[..., 1], b[..., 2]
    x = ay * bz - az * by
    # filled by component, which is faster than np.stack for the usual few hundred vectors
    product = np.empty((*x.shape, 3))
    product[..., 0], product[..., 1], product[..., 2] = x, az * bx - ax * bz, ax * by - ay * bx
    return product


def about_axis(a: Array) -> Array:
    """Return e_z x a over the last axis, (..., 3) -> (..., 3); faster than the general product."""
    product = np.zeros(a.shape)
    product[..., 0], product[..., 1] = -a[..., 1], a[..., 0]
    return product


def components(*values: ArrayLike) -> Array:
    """Return vectors (..., K) from K components, the first of full shape (...,); faster than np.stack."""
    vectors = np.empty((*np.shape(values[0]), len(values)))
    for k, value in enumerate(values):
        vectors[..., k] = value
    return vectors


def plane_cross(a: Array, b: Array) -> Array:
    """Return the signed area (...,) of the parallelogram of a and b (..., 2 or more) in the plane of x and y."""
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def unit(a: Array) -> Array:
    """Return vectors (..., 3) scaled to length 1."""
    return a / np.sqrt(dot(a, a))[..., None]


def turn(rotation: Array, vectors: Array) -> Array:
    """Apply rotation matrices (..., 3, 3) to vectors (..., 3)."""
    if rotation.ndim == 2:
        return vectors @ rotation.T
    turned: Array = np.matmul(rotation, vectors[..., None])[..., 0]
    return turned


def rotation_about(axis: str, angle: ArrayLike) -> Array:
    """Return right-handed rotation matrices (..., 3, 3) by `angle` (...,), rad, about the axis "x", "y" or "z"."""
    angle = np.asarray(angle, dtype=float)
    i = "xyz".index(axis)
    j, k = (i + 1) % 3, (i + 2) % 3
    matrix = np.zeros((*angle.shape, 3, 3))
    c, s = np.cos(angle), np.sin(angle)
    matrix[..., i, i] = 1.0
    matrix[..., j, j] = matrix[..., k, k] = c
    matrix[..., j, k] = -s
    matrix[..., k, j] = s
    return matrix


def axis_distance(r: Array) -> Array:
    """Return the distances (...,) of points (..., 3) from the z axis."""
    rho: Array = np.hypot(r[..., 0], r[..., 1])
    return rho


def polar_angle(r: Array) -> Array:
    """Return the polar angle (...,) of points (..., 2 or more) about z, in rad from -pi to pi."""
    return np.arctan2(r[..., 1], r[..., 0])


def about_z(c: Array, s: Array, vector: Array) -> Array:
    """Turn vectors (3,) or (..., 3) about z by angles with cosines c and sines s (...,). Returns (..., 3)."""
    x, y, z = vector[..., 0], vector[..., 1], vector[..., 2]
    turned = np.empty((*np.broadcast_shapes(c.shape, x.shape), 3))
    turned[..., 0], turned[..., 1], turned[..., 2] = c * x - s * y, s * x + c * y, z
    return turned


def broadcast_pair(u: ArrayLike, v: ArrayLike) -> tuple[Array, Array]:
    """Return parameters u, v (...,) as float arrays of one shape; equal shapes skip the slow np.broadcast_arrays."""
    u, v = np.asarray(u, dtype=float), np.asarray(v, dtype=float)
    if u.shape == v.shape:
        return u, v
    u, v = np.broadcast_arrays(u, v)
    return u, v


def spread(indices: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """Return at most `count` of the indices, evenly spread, with the first and the last index among them."""
    if len(indices) <= count:
        return indices
    chosen: NDArray[np.int64] = indices[np.linspace(0, len(indices) - 1, count).round().astype(int)]
    return chosen


def every_nth(indices: NDArray[np.int64], count: int) -> NDArray[np.int64]:
    """Return about `count` of the indices (1/2 to 3/2 of it), each as far from the next as the others.

    Where the last index cannot be one of them, as many are left out before the first as behind the last, or one less.
    """
    stride = max(1, round((len(indices) - 1) / max(count - 1, 1)))
    return indices[(len(indices) - 1) % stride // 2 :: stride]


def distinct(numbers: NDArray[Number]) -> NDArray[Number]:
    """Return each of the numbers (...,) once, ascending, (K,). np.unique is slower: it hashes, and loads masked arrays."""
    ascending = np.sort(numbers, axis=None)
    distinct_numbers: NDArray[Number] = ascending[np.append(True, ascending[1:] != ascending[:-1])[: ascending.size]]
    return distinct_numbers


def median(values: Array) -> float:
    """Return the median of finite values (...,). np.median loads masked arrays."""
    ascending = np.sort(values, axis=None)
    return 0.5 * float(ascending[(ascending.size - 1) // 2] + ascending[ascending.size // 2])


def largest_known(values: Array) -> float:
    """Return the largest value that is known; NaN if there is none."""
    return float(np.nanmax(values)) if np.isfinite(values).any() else np.nan
