"""Surfaces moved along their own normals, by an amount that is given over space: modifications of any flank.

        n  N            R = r + a n,   a = g(R)
        | /
    ----+----- R        A point moves along the exact normal n of the base surface until its distance from the base is what the
        | a             amount g says *there*. g is a function of space, so base and amount need not share any parameters.
    ----+----- r

With t(R) the distance from the base, positive along n, the moved surface is the zero of t - g. The gradient of t is n all along a
normal, and on the moved surface, whose parameters are the base's, n changes by n_u and n_v. So with G the gradient of g at R, H its
Hessian, and no more of the base than its jet,

    a_i = G . (r_i + a n_i) / (1 - G . n)       R_i = r_i + a n_i + a_i n
    W   = n - G                                 W_i = n_i - H R_i
    N   = W / |W|                               N_i = (W_i - N (N . W_i)) / |W|

exactly: normals need no curvature of the base, curvatures no third derivatives. Had the amount been given at r instead, n_i would
take them, for g would then be constant along normals, which turn. Where g is constant, N_i = n_i: a parallel surface, of principal
curvatures k / (1 - a k), in the sense of `curvature` (n_i = -K r_i). Nothing is divided by the area of the base, so the jet goes
through its cusps; a surface that is moved beyond its own centres of curvature turns inside out.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from gearmesh.kernel.numeric.algebra import Array, dot
from gearmesh.kernel.surface.surface import Jet, Surface

#: steps by which the amount is found at most: each squares the error, so that 3 do for amounts of micro-geometry
STEPS = 12
#: a step (mm) after which nothing is left
TOLERANCE = 1e-13


@dataclass(frozen=True)
class FieldJet:
    """A function of space at points (..., 3): value (...,), gradient (..., 3), Hessian as it applies to vectors (..., 3)."""

    value: Array
    gradient: Array
    hessian: Callable[[Array], Array]


class SpatialField(Protocol):
    """A function of space with its first and second derivatives."""

    def jet(self, r: Array) -> FieldJet:
        """Value and derivatives at points (..., 3), mm."""


@dataclass(frozen=True)
class Offset:
    """A surface with every point moved along its normal by the amount that `field` has where it comes to; parameters are its own.

    Amounts are in mm, positive along the normal: material is added. NaN where the amount is not to be found, as where the field
    rises along the normal as fast as the point moves.
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
        """Amounts (...,) by Newton's method, and the field where they take the points."""
        a = np.zeros(base.r.shape[:-1])
        for _ in range(STEPS):
            at = self.field.jet(base.r + a[..., None] * base.n)
            step = (at.value - a) / (1.0 - dot(at.gradient, base.n))
            a = a + step
            if not (np.abs(step) > TOLERANCE).any():
                return a, at
        return np.where(np.abs(step) > TOLERANCE, np.nan, a), at


@dataclass(frozen=True)
class Parallel:
    """A surface with every point moved along its normal by the same `distance` (mm, positive along it); parameters are its own."""

    surface: Surface
    distance: float

    def jet(self, u: Array, v: Array) -> Jet:
        return self.surface.jet(u, v).parallel(self.distance)


def _carry(along: Array, n: Array, rate: Array, g: Array) -> Array:
    """Partials (..., 3) of moved points, for those that they have with their amounts held."""
    carried: Array = along + (dot(g, along) * rate)[..., None] * n
    return carried


def _across(vectors: Array, n: Array) -> Array:
    """What of vectors (..., 3) is at right angles to unit vectors n (..., 3)."""
    return np.asarray(vectors - n * dot(n, vectors)[..., None])
