"""Curvature of surfaces from their jets, and the contact ellipse of two.

Sign and basis, used throughout:

    shape operator   n_i = -K r_i: K takes a tangent vector t to minus the change of the normal along t
    basis            unit vectors e1, e2 = n x e1 of the tangent plane; K is a symmetric matrix in that basis
    angles           from e1 towards e2, so right-handed about n

With n out of the material a convex body has negative curvatures (a ball of radius R: -1/R), a hollow one positive.
Curvatures are in 1/mm; everything is batched over leading axes. Values are NaN or infinite, without a warning, where
a parametrisation degenerates (r_u x r_v = 0) and a generated surface is undercut.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearmesh.kernel.numeric.algebra import Array, cross, dot, unit
from gearmesh.kernel.surface.surface import Jet

#: directions across e1 have the angle pi/2 and not -pi/2, also where rounding leaves them this much (rad) beyond it
SEAM = 1e-9


@dataclass(frozen=True)
class Principal:
    """Principal curvatures k1 >= k2 (...,), 1/mm, and the `angle` (...,) from e1 to the direction of k1, rad.

    The angle lies in (-pi/2, pi/2], shifted by SEAM; the direction of k2 is a right angle further. At an umbilic it is 0.
    """

    k1: Array
    k2: Array
    angle: Array


@dataclass(frozen=True)
class ContactEllipse:
    """Where two surfaces in contact are closer than delta, to second order, in their common tangent plane.

    `semi_major` >= `semi_minor` (...,) in mm; `angle` (...,) from e1 to the major axis, rad, in (-pi/2, pi/2], shifted by SEAM;
    `major`, `minor` (..., 3) unit vectors along the axes, (major, minor, n) right-handed.
    `line` (...,): the surfaces do not separate along `major`, semi_major is infinite.
    `crossing` (...,): in some direction the bodies penetrate each other near the point (interference); the axes
    are then those of |separation| = delta and bound no contact area.
    """

    semi_major: Array
    semi_minor: Array
    angle: Array
    major: Array
    minor: Array
    line: NDArray[np.bool_]
    crossing: NDArray[np.bool_]


def tangent_basis(jet: Jet) -> tuple[Array, Array]:
    """Orthonormal tangent vectors (e1, e2), each (..., 3): e1 along r_u, e2 = n x e1."""
    with np.errstate(invalid="ignore", divide="ignore"):
        e1 = unit(jet.r_u)
    return e1, cross(jet.n, e1)


def in_plane(angle: Array, e1: Array, e2: Array) -> tuple[Array, Array]:
    """Unit vectors (..., 3) at `angle` (..., rad) from e1 towards e2, and a right angle further."""
    c, s = np.cos(angle)[..., None], np.sin(angle)[..., None]
    return c * e1 + s * e2, c * e2 - s * e1


def shape_operator(jet: Jet, e1: Array, e2: Array) -> Array:
    """Shape operator K (..., 2, 2), 1/mm, in the tangent basis e1, e2 (..., 3) of the jet's frame: n_i = -K r_i.

    Indifferent to the lengths of r_u and r_v, which cancel; the angle between them costs a factor 1/sin in
    accuracy. The matrix returned is the symmetric part, which an exact jet's K equals.
    """
    a, b, c, d = dot(jet.r_u, e1), dot(jet.r_v, e1), dot(jet.r_u, e2), dot(jet.r_v, e2)
    inverse_times_area = _matrix(d, -b, -c, a)
    turned = _matrix(dot(jet.n_u, e1), dot(jet.n_v, e1), dot(jet.n_u, e2), dot(jet.n_v, e2))
    with np.errstate(invalid="ignore", divide="ignore"):
        k = -(turned @ inverse_times_area) / (a * d - b * c)[..., None, None]
    return 0.5 * (k + np.swapaxes(k, -1, -2))


def _matrix(k11: Array, k12: Array, k21: Array, k22: Array) -> Array:
    """Matrices (..., 2, 2) from their elements (...,)."""
    return np.stack((np.stack((k11, k12), axis=-1), np.stack((k21, k22), axis=-1)), axis=-2)


def principal(k: Array) -> Principal:
    """Principal curvatures and directions of symmetric operators (..., 2, 2).

    The half difference is a hypotenuse, not the root of mean^2 - Gaussian: near an umbilic it keeps every digit that
    the matrix has, and at one the direction is e1.
    """
    mean = 0.5 * (k[..., 0, 0] + k[..., 1, 1])
    half = 0.5 * (k[..., 0, 0] - k[..., 1, 1])
    mixed = 0.5 * (k[..., 0, 1] + k[..., 1, 0])
    spread = np.hypot(half, mixed)
    angle = 0.5 * np.arctan2(mixed, half)
    return Principal(mean + spread, mean - spread, np.where(angle < SEAM - 0.5 * np.pi, angle + np.pi, angle))


def gaussian_curvature(k: Array) -> Array:
    """Gaussian curvature k1 k2 (...,), 1/mm^2, of operators (..., 2, 2)."""
    return k[..., 0, 0] * k[..., 1, 1] - k[..., 0, 1] * k[..., 1, 0]


# ---- two surfaces in contact


def relative_curvature(jet1: Jet, jet2: Jet, e1: Array, e2: Array) -> Array:
    """K1 - K2 (..., 2, 2), 1/mm, both with respect to n1, for jets in one frame that touch: r1 = r2, n1 = -n2.

    Each jet carries the normal out of its own body, so surface 2 seen along n1 has the operator -K2 and the
    difference is the *sum* of the two jets' operators. The separation of the surfaces at a tangent displacement x is
    -x . (K1 - K2) x / 2: the matrix is negative definite where the bodies touch in a point without interference.
    e1, e2 (..., 3) is a tangent basis of surface 1.
    """
    return shape_operator(jet1, e1, e2) + shape_operator(jet2, e1, e2)


def contact_ellipse(relative: Array, e1: Array, e2: Array, delta: ArrayLike, flat: float = 1e-9) -> ContactEllipse:
    """Contact ellipse of a relative curvature (..., 2, 2) as `relative_curvature` gives it, in the basis e1, e2.

    Half axes sqrt(2 delta / |eigenvalue|) for surfaces approaching by `delta` (mm, scalar or (...,)) [CR3553 1.7.30-33;
    LT02 34-43]. An eigenvalue at most `flat` times the other counts as zero: line contact, semi-axis infinite. The
    default means axes in a ratio above 30,000, which no tooth is long enough to distinguish from a line, and is far above the
    rounding of curvatures.
    """
    own = principal(relative)
    first_is_major = np.abs(own.k1) <= np.abs(own.k2)
    small = np.where(first_is_major, own.k1, own.k2)
    large = np.where(first_is_major, own.k2, own.k1)
    across = np.where(own.angle > SEAM, own.angle - 0.5 * np.pi, own.angle + 0.5 * np.pi)
    angle = np.where(first_is_major, own.angle, across)
    noise = flat * np.abs(large)
    line = np.abs(small) <= noise
    with np.errstate(divide="ignore", over="ignore"):
        semi_major = np.sqrt(2.0 * np.asarray(delta) / np.where(line, 0.0, np.abs(small)))
        semi_minor = np.sqrt(2.0 * np.asarray(delta) / np.abs(large))
    return ContactEllipse(semi_major, semi_minor, angle, *in_plane(angle, e1, e2), line, own.k1 > noise)
