"""Surfaces of revolution with a curved profile: the roots that a plunging tool leaves.

The profile rho(z) is a series of Chebyshev polynomials; the level g = rho - rho(z) is positive outside, its zero a surface
with the parameters u = polar angle (rad) and v = z (mm), like the cylinder that it is without a plunge.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.polynomial import Chebyshev

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.levels import Level
from gearmesh.kernel.surface.surface import Jet

#: degrees of a fitted profile that are tried, and the largest distance (mm) that it may be off
DEGREES, EXACT = (10, 20, 40), 1e-10


@dataclass(frozen=True)
class Barrel:
    """The surface of revolution rho = sum of coefficients[k] T_k, mm, z from -1 to 1 over `extent`; a level and a surface."""

    coefficients: tuple[float, ...]
    extent: tuple[float, float]

    @staticmethod
    def through(profile: Callable[[Array], Array], extent: tuple[float, float]) -> Barrel:
        """The one whose profile is rho(z), a smooth function given on `extent`, mm.

        Raises ValueError where no series of the `DEGREES` is within `EXACT` of it.
        """
        for degree in DEGREES:
            fit = Chebyshev.interpolate(profile, degree, domain=extent)
            between = np.linspace(*extent, 3 * degree)
            if np.abs(fit(between) - profile(between)).max() <= EXACT:
                return Barrel(tuple(float(c) for c in fit.coef), extent)
        raise ValueError("the profile is not smooth enough for a barrel")

    @cached_property
    def _profile(self) -> tuple[Chebyshev, Chebyshev, Chebyshev]:
        profile = Chebyshev(self.coefficients, domain=self.extent)
        return profile, profile.deriv(1), profile.deriv(2)

    @property
    def surface(self) -> Barrel:
        """Itself."""
        return self

    def at(self, z: float | Array) -> Array:
        """rho, mm, at z."""
        return np.asarray(self._profile[0](z))

    def value(self, r: Array) -> Array:
        value: Array = np.hypot(r[..., 0], r[..., 1]) - self._profile[0](r[..., 2])
        return value

    def gradient(self, r: Array) -> Array:
        rho = np.hypot(r[..., 0], r[..., 1])
        return np.stack((r[..., 0] / rho, r[..., 1] / rho, -self._profile[1](r[..., 2])), axis=-1)

    def hessian(self, r: Array, w: Array) -> Array:
        rho = np.hypot(r[..., 0], r[..., 1])
        x, y = r[..., 0] / rho, r[..., 1] / rho
        across = (x * w[..., 1] - y * w[..., 0]) / rho
        return np.stack((-y * across, x * across, -self._profile[2](r[..., 2]) * w[..., 2]), axis=-1)

    def jet(self, u: Array, v: Array) -> Jet:
        u, v = np.broadcast_arrays(np.asarray(u, dtype=float), np.asarray(v, dtype=float))
        rho, slope, bend = (p(v) for p in self._profile)
        c, s, zero, one = np.cos(u), np.sin(u), np.zeros_like(u), np.ones_like(u)
        k = 1.0 / np.hypot(1.0, slope)
        radial = np.stack((c, s, zero), axis=-1)
        around = np.stack((-s, c, zero), axis=-1)
        along = np.stack((slope * c, slope * s, one), axis=-1)
        n = (radial - slope[..., None] * np.array([0.0, 0.0, 1.0])) * k[..., None]
        return Jet(
            r=rho[..., None] * radial + v[..., None] * np.array([0.0, 0.0, 1.0]),
            n=n,
            r_u=rho[..., None] * around,
            r_v=along,
            n_u=k[..., None] * around,
            # the meridian's normal turns against its tangent by the curvature
            n_v=-(bend * k**3)[..., None] * along,
        )

    def meeting(self, axial: Level, stations: Array) -> Array:
        """v (...,) near the station coordinates `stations` (...,), mm: a start value, exact for planes across the axis."""
        slope = axial.gradient(np.array([1.0, 0.0, 0.0]))[2]
        return np.asarray((stations - axial.value(np.zeros(3))) / slope)
