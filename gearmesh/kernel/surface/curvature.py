"""Curvature of surfaces from their jets, and the contact ellipse of two surfaces.

Signs and basis throughout:

    shape operator   n_i = -K r_i: K takes a tangent vector t to minus the change of the normal along t
    basis            unit vectors e1, e2 = n x e1 of the tangent plane; K is a symmetric matrix in that basis
    angles           from e1 towards e2, so right-handed about n

With n out of the material a convex body has negative curvatures (a ball of radius R: -1/R), a hollow body positive
ones. Curvatures are in 1/mm; everything is batched over leading axes. Values are NaN or infinite, without a warning,
where a parametrisation degenerates (r_u x r_v = 0) and where a generated surface is undercut.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearmesh.kernel.numeric.algebra import Array, cross, dot, unit
from gearmesh.kernel.surface.surface import Jet
from gearmesh.records import dataclass

#: a direction across e1 has the angle pi/2, not -pi/2, even if rounding moves it this far beyond pi/2
ANGLE_SEAM_RAD = 1e-9


@dataclass(frozen=True)
class Principal:
    """Principal curvatures k1 >= k2 (...,), 1/mm, and the `angle` (...,) from e1 to the direction of k1, rad.

    The angle lies in (-pi/2, pi/2], shifted by ANGLE_SEAM_RAD, and is 0 at an umbilic. The direction of k2 is a right
    angle further.
    """

    k1: Array
    k2: Array
    angle: Array


@dataclass(frozen=True)
class ContactEllipse:
    """Region of the common tangent plane in which two surfaces in contact are closer than delta, to second order."""

    #: larger semi-axis (...,), mm; infinite for line contact
    semi_major: Array
    #: smaller semi-axis (...,), mm
    semi_minor: Array
    #: angle (...,) from e1 to the major axis, rad, in (-pi/2, pi/2] shifted by ANGLE_SEAM_RAD
    angle: Array
    #: unit vector (..., 3) along the major axis
    major: Array
    #: unit vector (..., 3) along the minor axis; (major, minor, n) is right-handed
    minor: Array
    #: True (...,) where the surfaces do not separate along `major`
    line: NDArray[np.bool_]
    #: True (...,) where the bodies penetrate each other near the point in some direction (interference); the axes then
    #: belong to |separation| = delta and bound no contact area
    crossing: NDArray[np.bool_]


def tangent_basis(jet: Jet) -> tuple[Array, Array]:
    """Return orthonormal tangent vectors (e1, e2), each (..., 3): e1 along r_u, e2 = n x e1."""
    with np.errstate(invalid="ignore", divide="ignore"):
        e1 = unit(jet.r_u)
    return e1, cross(jet.n, e1)


def in_plane(angle: Array, e1: Array, e2: Array) -> tuple[Array, Array]:
    """Return unit vectors (..., 3) at `angle` (...,), rad, from e1 towards e2, and a right angle further."""
    c, s = np.cos(angle)[..., None], np.sin(angle)[..., None]
    return c * e1 + s * e2, c * e2 - s * e1


def shape_operator(jet: Jet, e1: Array, e2: Array) -> Array:
    """Return the shape operator K (..., 2, 2), 1/mm, with n_i = -K r_i, in the tangent basis e1, e2 (..., 3).

    The basis is given in the frame of the jet. The lengths of r_u and r_v cancel. A small angle between r_u and r_v
    costs a factor 1/sin in accuracy. The returned matrix is the symmetric part; K of an exact jet is symmetric.
    """
    a, b, c, d = dot(jet.r_u, e1), dot(jet.r_v, e1), dot(jet.r_u, e2), dot(jet.r_v, e2)
    inverse_times_area = _matrix(d, -b, -c, a)
    turned = _matrix(dot(jet.n_u, e1), dot(jet.n_v, e1), dot(jet.n_u, e2), dot(jet.n_v, e2))
    with np.errstate(invalid="ignore", divide="ignore"):
        k = -(turned @ inverse_times_area) / (a * d - b * c)[..., None, None]
    return 0.5 * (k + np.swapaxes(k, -1, -2))


def _matrix(k11: Array, k12: Array, k21: Array, k22: Array) -> Array:
    """Return matrices (..., 2, 2) from their elements (...,)."""
    return np.stack((np.stack((k11, k12), axis=-1), np.stack((k21, k22), axis=-1)), axis=-2)


def principal(k: Array) -> Principal:
    """Return principal curvatures and directions of symmetric operators (..., 2, 2).

    The half difference of k1 and k2 is computed as a hypotenuse, not as the root of mean^2 - Gaussian. Near an umbilic
    this keeps all digits of the matrix; at an umbilic the direction is e1.
    """
    mean = 0.5 * (k[..., 0, 0] + k[..., 1, 1])
    half = 0.5 * (k[..., 0, 0] - k[..., 1, 1])
    mixed = 0.5 * (k[..., 0, 1] + k[..., 1, 0])
    spread = np.hypot(half, mixed)
    angle = 0.5 * np.arctan2(mixed, half)
    return Principal(mean + spread, mean - spread, np.where(angle < ANGLE_SEAM_RAD - 0.5 * np.pi, angle + np.pi, angle))


def gaussian_curvature(k: Array) -> Array:
    """Return the Gaussian curvature k1 k2 (...,), 1/mm^2, of operators (..., 2, 2)."""
    return k[..., 0, 0] * k[..., 1, 1] - k[..., 0, 1] * k[..., 1, 0]


# ---- two surfaces in contact


def relative_curvature(jet1: Jet, jet2: Jet, e1: Array, e2: Array) -> Array:
    """Return K1 - K2 (..., 2, 2), 1/mm, both with respect to n1, for touching jets in one frame: r1 = r2, n1 = -n2.

    Each jet carries the normal out of its own body. Seen along n1, surface 2 therefore has the operator -K2, and the
    difference is the *sum* of the two jets' operators. At a tangent displacement x the surfaces are separated by -x .
    (K1 - K2) x / 2, so the matrix is negative definite for point contact without interference. e1, e2 (..., 3) is a
    tangent basis of surface 1.
    """
    return shape_operator(jet1, e1, e2) + shape_operator(jet2, e1, e2)


def contact_ellipse(relative: Array, e1: Array, e2: Array, delta: ArrayLike, flat: float = 1e-9) -> ContactEllipse:
    """Return the contact ellipse for a `relative_curvature` (..., 2, 2) in the basis e1, e2.

    The semi-axes are sqrt(2 delta / |eigenvalue|) for surfaces that approach by `delta` (mm, scalar or (...,)) [CR3553
    1.7.30-33; LT02 34-43]. An eigenvalue of at most `flat` times the other eigenvalue counts as zero: line contact with
    an infinite semi-axis. The default corresponds to a ratio of axes above 30,000: on a tooth this is a line. It is far
    above the rounding of curvatures.
    """
    curvatures = principal(relative)
    # the smaller curvature separates the surfaces most slowly: its direction is the major axis
    first_is_major = np.abs(curvatures.k1) <= np.abs(curvatures.k2)
    small = np.where(first_is_major, curvatures.k1, curvatures.k2)
    large = np.where(first_is_major, curvatures.k2, curvatures.k1)
    across = np.where(curvatures.angle > ANGLE_SEAM_RAD, curvatures.angle - 0.5 * np.pi, curvatures.angle + 0.5 * np.pi)
    angle = np.where(first_is_major, curvatures.angle, across)
    noise = flat * np.abs(large)
    line = np.abs(small) <= noise
    with np.errstate(divide="ignore", over="ignore"):
        semi_major = np.sqrt(2.0 * np.asarray(delta) / np.where(line, 0.0, np.abs(small)))
        semi_minor = np.sqrt(2.0 * np.asarray(delta) / np.abs(large))
    return ContactEllipse(semi_major, semi_minor, angle, *in_plane(angle, e1, e2), line, curvatures.k1 > noise)
