"""Surfaces moved along their normals by an amount given over space: modifications of any flank.

        n  N            R = r + a n,   a = g(R)
        | /
    ----+----- R        A point moves along the exact normal n of the base surface until its distance from the base
        | a             equals the amount g *at its new place*. g is a function of space, not of u and v.
    ----+----- r

Let t(R) be the distance from the base, positive along n: the moved surface is the zero of t - g. The gradient of t is n
along a whole normal. On the moved surface, which has the parameters of the base, n changes by n_u and n_v. With the
gradient G and the Hessian H of g at R, the jet of the base suffices:

    a_i = G . (r_i + a n_i) / (1 - G . n)       R_i = r_i + a n_i + a_i n
    W   = n - G                                 W_i = n_i - H R_i
    N   = W / |W|                               N_i = (W_i - N (N . W_i)) / |W|

This is exact: normals need no curvature of the base, and curvatures need no third derivatives. An amount given at r
instead would be constant along normals, which turn, and N_i would need third derivatives of the base. If g is constant,
N_i = n_i: a parallel surface with principal curvatures k / (1 - a k), in the sign of `curvature` (n_i = -K r_i). No
division by the base's area element occurs, so the jet passes through cusps of the base. A surface moved beyond its own
centres of curvature turns inside out.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

import numpy as np

from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.surface import Jet, Surface
from gearmesh.records import dataclass

#: limit of the steps to the amount; 3 suffice for amounts of micro-geometry
MAX_NEWTON_STEPS = 12
#: Newton step of the amount that counts as converged
TOLERANCE_MM = 1e-13


@dataclass(frozen=True)
class FieldJet:
    """A function of space at points (..., 3): its value and derivatives."""

    #: value (...,)
    value: Array
    #: gradient (..., 3)
    gradient: Array
    #: product of the Hessian and vectors (..., 3)
    hessian: Callable[[Array], Array]


class SpatialField(Protocol):
    """A function of space with its first and second derivatives."""

    def jet(self, r: Array) -> FieldJet:
        """Return value and derivatives at points (..., 3), mm."""


@dataclass(frozen=True)
class Offset:
    """A surface with every point moved along its normal by the amount that `field` has at the new place of the point.

    The parameters are the surface's. Amounts are in mm, positive along the normal: material is added. NaN where no
    amount is found, for example if the field rises along the normal as fast as the point moves.
    """

    surface: Surface
    field: SpatialField

    def jet(self, u: Array, v: Array) -> Jet:
        base = self.surface.jet(u, v)
        with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
            a, at = self._amount(base)
            g = at.gradient
            rate = 1.0 / (1.0 - dot(g, base.n))
            r_u, r_v = (
                _carry(r_q + a[..., None] * n_q, base.n, rate, g)
                for r_q, n_q in ((base.r_u, base.n_u), (base.r_v, base.n_v))
            )
            w = base.n - g
            size = 1.0 / np.sqrt(dot(w, w))[..., None]
            n = size * w
            n_u, n_v = (_across(size * (n_q - at.hessian(r_q)), n) for n_q, r_q in ((base.n_u, r_u), (base.n_v, r_v)))
        return Jet(base.r + a[..., None] * base.n, n, r_u, r_v, n_u, n_v)

    def _amount(self, base: Jet) -> tuple[Array, FieldJet]:
        """Return the amounts (...,) by Newton's method, and the field at the moved points."""
        a = np.zeros(base.r.shape[:-1])
        for _ in range(MAX_NEWTON_STEPS):
            at = self.field.jet(base.r + a[..., None] * base.n)
            step = (at.value - a) / (1.0 - dot(at.gradient, base.n))
            a = a + step
            if not (np.abs(step) > TOLERANCE_MM).any():
                return a, at
        return np.where(np.abs(step) > TOLERANCE_MM, np.nan, a), at


@dataclass(frozen=True)
class Parallel:
    """A surface with every point moved along its normal by `distance` (mm); its parameters are unchanged."""

    surface: Surface
    distance: float

    def jet(self, u: Array, v: Array) -> Jet:
        return self.surface.jet(u, v).parallel(self.distance)


def _carry(along: Array, n: Array, rate: Array, g: Array) -> Array:
    """Return partials (..., 3) of moved points from their partials at constant amount."""
    carried: Array = along + (dot(g, along) * rate)[..., None] * n
    return carried


def _across(vectors: Array, n: Array) -> Array:
    """Return the part of vectors (..., 3) at right angles to unit vectors n (..., 3)."""
    return np.asarray(vectors - n * dot(n, vectors)[..., None])
