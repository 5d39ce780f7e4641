"""Hertz contact of elastic bodies that touch in a point or along a line: pressure, contact area and approach.

The bodies are smooth and frictionless half-spaces. Their gap before loading at (x, y) in the common tangent plane is

    gap = (kappa_x x^2 + kappa_y y^2) / 2        kappa: relative principal curvatures, both positive

The curvatures are the eigenvalues of -(K1 - K2) in `curvature.relative_curvature`. The pressure is a semi-ellipsoid,
p = p0 sqrt(1 - (x/a)^2 - (y/b)^2), with a >= b along the directions of the smaller and the larger curvature. With
q = (b/a)^2, m = 1 - q, the complete elliptic integrals K, E of parameter m and

    D = (K - E) / m,    B = (E - q K) / m,    K = B + D,    E = B + q D

the displacement that closes the gap gives [J85 3.41, 4.26]

    kappa_x / 2 = (p0/E*) D b / a^2,    kappa_y / 2 = (p0/E*) B / b,    approach = (p0/E*) b K,    F = 2/3 pi p0 a b

Units: mm, N, MPa. Arguments broadcast against each other, and results have the common shape (...,).
Source: [J85] K. L. Johnson, Contact Mechanics, 1985, chapters 3 to 5.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from gearmesh.errors import DesignError
from gearmesh.kernel.numeric.algebra import Array, cross, dot
from gearmesh.records import dataclass

#: steps of the arithmetic-geometric mean, which doubles its digits in each: enough for q of 1e-300
MEAN_STEPS = 14
#: Newton steps on log q; the slope lies between 3/4 (circle) and 1 (line), and 6 steps suffice for ratios from 1 to 1e-280
NEWTON_STEPS = 10
#: parameter m below which (D - B) / m comes from its series
NEARLY_ROUND = 1e-4


@dataclass(frozen=True)
class Material:
    """Isotropic elastic material with Young's modulus (MPa), Poisson's ratio, and density (kg/m^3) if it is known.

    Raises DesignError for values that no material has.
    """

    youngs_modulus: float = 206000.0
    poisson_ratio: float = 0.3
    density: float | None = None

    def __post_init__(self) -> None:
        if not 0.0 < self.youngs_modulus < np.inf:
            raise DesignError("youngs_modulus", self.youngs_modulus, unit="MPa", allowed="a finite number above 0")
        if not -1.0 < self.poisson_ratio <= 0.5:
            raise DesignError("poisson_ratio", self.poisson_ratio, allowed="above -1 and up to 0.5")

    @property
    def plane_modulus(self) -> float:
        """E / (1 - nu^2), MPa."""
        return self.youngs_modulus / (1.0 - self.poisson_ratio**2)


#: material of all gears without another one
STEEL = Material()


def contact_modulus(first: Material, second: Material) -> float:
    """Return E* (MPa) of two bodies: 1/E* = (1 - nu1^2)/E1 + (1 - nu2^2)/E2 [J85 4.21]."""
    return 1.0 / (1.0 / first.plane_modulus + 1.0 / second.plane_modulus)


@dataclass(frozen=True)
class PointContact:
    """Elliptic contact, all values with the shape (...,)."""

    #: normal force, N
    force: Array
    #: greatest pressure p0, MPa
    peak_pressure: Array
    #: semi-major axis a of the contact ellipse, mm
    semi_major: Array
    #: semi-minor axis b of the contact ellipse, mm
    semi_minor: Array
    #: approach of the bodies, mm
    approach: Array


@dataclass(frozen=True)
class LineContact:
    """Contact along a straight line, all values (...,): `load` N/mm, `peak_pressure` p0 MPa, `half_width` b mm.

    There is no approach: the approach of half-spaces grows without limit with the depth of its reference point [J85 5.56].
    """

    load: Array
    peak_pressure: Array
    half_width: Array


# ---- contact in a point


def point_contact(kappa: ArrayLike, kappa_other: ArrayLike, force: ArrayLike, modulus: ArrayLike) -> PointContact:
    """Compute the point contact under a force (N) from relative principal curvatures (1/mm, in any order) and E* (MPa).

    Raises DesignError unless curvatures and modulus are positive and the force is not negative.
    """
    shape, modulus, force = (
        _EllipseShape.of(kappa, kappa_other),
        _above_zero("modulus", modulus),
        _not_below("force", force),
    )
    return shape.contact(np.cbrt(3.0 * force * shape.e / (2.0 * np.pi * shape.q * modulus * shape.total)), modulus)


@dataclass(frozen=True)
class _EllipseShape:
    """Shape of the contact ellipse, which depends only on the curvatures; all values (...,)."""

    #: square of the ratio of the axes, (b/a)^2
    q: Array
    #: complete elliptic integral K of parameter 1 - q
    k: Array
    #: complete elliptic integral E of parameter 1 - q
    e: Array
    #: half the sum of the relative curvatures, 1/mm
    total: Array

    @staticmethod
    def of(kappa: ArrayLike, kappa_other: ArrayLike) -> _EllipseShape:
        first, second = (_above_zero("relative curvature", k) for k in (kappa, kappa_other))
        small, large = np.minimum(first, second), np.maximum(first, second)
        # log(small / large) to full relative accuracy where the two are nearly equal
        wanted = np.log1p(-np.minimum((large - small) / large, 0.5))
        wanted = np.where(small < 0.5 * large, np.log(small) - np.log(large), wanted)
        q = np.exp(_log_q(wanted))
        d, b = _integrals(q)
        return _EllipseShape(q, b + d, b + q * d, 0.5 * (first + second))

    def contact(self, a: Array, modulus: Array) -> PointContact:
        """Return the contact with semi-major axis a (...,), mm."""
        b = a * np.sqrt(self.q)
        pressure = modulus * self.total * b / self.e
        shared = np.broadcast_arrays(
            2.0 / 3.0 * np.pi * pressure * a * b, pressure, a, b, pressure / modulus * b * self.k
        )
        return PointContact(*shared)


def _log_q(wanted: Array) -> Array:
    """Solve log(q D / B) = `wanted` (<= 0) for log q (...,) by Newton steps from log q = `wanted`."""
    log_q = wanted
    for _ in range(NEWTON_STEPS):
        q = np.exp(log_q)
        d, b = _integrals(q)
        m = -np.expm1(log_q)
        c = np.where(m < NEARLY_ROUND, np.pi / 16.0, (d - b) / np.maximum(m, NEARLY_ROUND))
        step = (log_q + np.log(d / b) - wanted) / (0.5 + 0.5 * c / d + 0.5 * q * c / b)
        log_q = np.minimum(log_q - step, 0.0)
    return np.asarray(log_q)


def _integrals(q: Array) -> tuple[Array, Array]:
    """Return D and B (...,) of parameter m = 1 - q by the arithmetic-geometric mean [DLMF 19.8.5-7].

    With c_n the half differences of the mean's sequences, D = K (1/2 + sum of 2^(n-1) c_n^2 / m over n >= 1), and B = K - D.
    The terms lose no digits at q = 1.
    """
    mean, other = np.ones_like(q), np.sqrt(q)
    # c_1^2 / m, from (1 - sqrt(q))^2 = m (1 - sqrt(q)) / (1 + sqrt(q))
    half_difference = 0.5 * (mean - other)
    share = 0.25 * (mean - other) / (mean + other)
    total, weight = np.full_like(mean, 0.5), 1.0
    for _ in range(MEAN_STEPS):
        total = total + weight * share
        mean, other = 0.5 * (mean + other), np.sqrt(mean * other)
        # c_(n+1) = c_n^2 / (4 a_(n+1)), with the next mean
        following = 0.5 * (mean + other)
        share = share * (0.25 * half_difference / following) ** 2
        half_difference = half_difference**2 / (4.0 * following)
        weight *= 2.0
    k = 0.5 * np.pi / mean
    return k * total, k * (1.0 - total)


# ---- contact along a line


def line_contact(kappa: ArrayLike, load: ArrayLike, modulus: ArrayLike) -> LineContact:
    """Compute the line contact under a load (N/mm) from the relative curvature (1/mm) across the line and E* (MPa).

    Source: [J85 4.42-4.45].

    Raises DesignError unless curvature and modulus are positive and the load is not negative.
    """
    kappa, modulus = _above_zero("relative curvature", kappa), _above_zero("modulus", modulus)
    b = 2.0 * np.sqrt(_not_below("load", load) / (np.pi * kappa * modulus))
    pressure = 0.5 * modulus * kappa * b
    return LineContact(*np.broadcast_arrays(0.5 * np.pi * pressure * b, pressure, b))


# ---- the load


def normal_force(
    torque: ArrayLike, point: Array, normal: Array, origin: Array, axis: Array, share: ArrayLike = 1.0
) -> Array:
    """Compute the normal force (...,), N, at a contact point that carries `share` of a torque (Nmm) on a body about its axis.

    `point` (..., 3) is in mm, `normal` (..., 3) is a unit vector out of the body. `origin` (3,) is a point of the axis, `axis` (3,)
    its unit direction, about which the torque is right-handed. Friction is zero. The share 1 is right only for a single tooth pair
    in contact. The force is negative where the torque takes the bodies apart, and infinite where the normal meets the axis or
    is parallel to it.
    """
    arm = dot(cross(point - origin, normal), axis)
    with np.errstate(divide="ignore", invalid="ignore"):
        force: Array = np.asarray(torque, dtype=float) * np.asarray(share, dtype=float) / arm
        return force


def _above_zero(name: str, values: ArrayLike) -> Array:
    checked = _not_below(name, values, "above 0")
    if not (checked > 0.0).all():
        raise DesignError(name, 0, allowed="a finite number above 0")
    return checked


def _not_below(name: str, values: ArrayLike, allowed: str = "from 0") -> Array:
    checked = np.asarray(values, dtype=float)
    wrong = ~(np.isfinite(checked) & (checked >= 0.0))
    if wrong.any():
        raise DesignError(name, checked[wrong][0], allowed=f"a finite number {allowed}")
    return checked
