"""Effect of a free end face: how much more the surface of a quarter-space deflects beside it than that of a half-space.

    o-------- x    loaded surface z = 0      Pressures p on z = 0, mirrored at x = 0, leave no shear on the end face x = 0, but
    |                                        stresses A p at right angles to it; loads q = - A p on the end face, mirrored
    |   body                                 at z = 0, take them away and leave A q on z = 0, and so on [H60]. Together
    z
    end face x = 0                               p = P + A A p        P the pressures that are really there

The end face's loads, mirrored, do not move z = 0 along z: displacements are those of p and its mirror image on a half-space. With
waves exp(i k y) along the edge A is one matrix for all k, as nothing has a length of its own, and so is the answer for a unit force
at distance d from the edge: that of its mirror image on a half-space, 1 / (pi R) over E / (1 - nu^2), R^2 = (x + d)^2 + y^2, times

    1 + release(m, phi),    m = |x - d| / (x + d),    phi = arctan y / (x + d)

The 1 is the image alone, the rest what the stresses hold back. For it [G11] takes one number, 0.29 - (0.08 - 0.5 nu) / (1 - nu),
0.39 for steel; it is 0.85 for a force on itself, 0.47 for one far from the edge on the edge, and 1.36, of a wedge of 90 degrees,
for places far along the edge.

Units: mm, N, MPa. Sources: [H60] M. Hetenyi, J. Appl. Mech. 27 (1960) 289; [J85] K. L. Johnson, Contact Mechanics, 1985, 2.4, 3.2;
[G11] R. Guilbault, J. Tribology 133 (2011) 031402.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from gearmesh.kernel.numeric.algebra import Array

#: steps of ln(k x), from where the wedge is two-dimensional to where waves have died out; twice as many: 3e-3
STEPS, LOWEST, HIGHEST = 160, -12.0, 3.2
#: points of Gauss for the potential under a wave
POINTS = 16
#: argument from which on a wave is nothing
FAR = 45.0
#: places phi of the table, and wave numbers over which it is summed
PLACES, WAVES = 49, 3000
#: powers of m^2 at which `release` is tabulated, exact at as many places: within 2e-3 between them
POWERS = 3
#: far along the edge: a wedge of 90 degrees under a force on one face, less twice a half-space, over a half-space [J85 2.4]
WEDGE = 0.5 * np.pi * (1.0 / (0.5 * np.pi + 1.0) + 1.0 / (0.5 * np.pi - 1.0)) - 2.0


def release(phi: Array, poisson_ratio: float) -> Array:
    """Coefficients (POWERS, ...) of `release` at angles phi (...,), rad, from 0 to a right angle, by powers of m^2 from 0 on."""
    table = _table(poisson_ratio)
    place = phi / (0.5 * np.pi) * (PLACES - 1)
    low = np.minimum(place.astype(np.intp), PLACES - 2)
    coefficients: Array = table[:, low] + (place - low) * (table[:, low + 1] - table[:, low])
    return coefficients


@lru_cache(maxsize=8)
def _table(poisson_ratio: float) -> Array:
    """`release` (POWERS, PLACES) at phi evenly from 0 to a right angle."""
    from scipy.interpolate import RectBivariateSpline
    from scipy.special import k0

    t, waves = _released_waves(poisson_ratio)
    spline = RectBivariateSpline(t, t, waves)
    m = np.linspace(0.0, 1.0, POWERS)
    u = (np.arange(WAVES) + 0.5) / WAVES
    k = np.exp(HIGHEST) * u**2
    # forces move each other's places alike: the force is the one that is further from the edge
    near, far = (np.log(np.maximum(0.5 * k * (1.0 + way * m[:, None]), np.exp(LOWEST))) for way in (-1.0, 1.0))
    rest = spline.ev(near, np.minimum(far, HIGHEST)) - WEDGE * 2.0 / np.pi * k0(k)
    y = np.tan(0.5 * np.pi * np.arange(PLACES - 1) / (PLACES - 1))
    summed = (rest * (2.0 * u * np.exp(HIGHEST) / WAVES)) @ np.cos(np.outer(k, y))
    values = WEDGE + np.column_stack((summed * np.hypot(1.0, y), np.zeros(POWERS)))
    return np.asarray(np.linalg.solve(m[:, None] ** (2 * np.arange(POWERS)), values))


def _released_waves(poisson_ratio: float) -> tuple[Array, Array]:
    """Steps t (n,) of ln(k x), and of a wave of force per length along the edge the displacement (n, n) times E / (1 - nu^2),
    beyond that of it and its image, at exp(t) (first index) from the force at exp(t) (second)."""
    from scipy.special import k0

    t = np.linspace(LOWEST, HIGHEST, STEPS)
    step, x = t[1] - t[0], np.exp(t)
    # what is nearer to the edge than the first step is pressed as that is
    nearest = x[0] * np.exp(-0.5 * step)
    onto = _end_stresses(x, poisson_ratio) * x * step
    onto[:, 0] += 2.0 / np.pi * (np.arctan(nearest / x) - nearest * x / (nearest**2 + x**2))
    twice = onto @ onto
    more = np.linalg.solve(np.eye(STEPS) - twice, twice)
    apart = np.abs(x - x[:, None])
    # the logarithm's mean over a step stands for its middle
    own = np.log(4.0 * np.pi / (x * step)) - np.euler_gamma
    moved = (np.where(apart > 0.0, k0(np.where(apart > 0.0, apart, 1.0)), own) + k0(x + x[:, None])) * x * step
    moved[:, 0] += 2.0 * k0(x) * nearest
    return t, 2.0 / np.pi * moved @ more / (x * step)


def _end_stresses(x: Array, poisson_ratio: float) -> Array:
    """Pressure (n, n) on the plane x = 0 at depths x (first index) of a half-space under waves, k = 1, of force per length at x
    (second index) and their mirror images.

    With psi, the potential of 1/r, 2 K0 for a wave, and psi_1, of which it is the derivative by z, [J85 3.2]:
    2 pi sigma_x = psi_z - z psi_xx - (1 - 2 nu) psi_1.
    """
    from scipy.special import k0, k1

    z, s = x[:, None], np.hypot(x, x[:, None])
    down = -2.0 * k1(s) * z / s
    across = 2.0 * (k0(s) * x**2 / s**2 + k1(s) * (2.0 * x**2 / s**3 - 1.0 / s))
    nodes, weights = np.polynomial.legendre.leggauss(POINTS)
    # psi_1 = - the integral of psi from z down, over t = x sinh w
    first = np.arcsinh(z / x)
    last = np.maximum(np.arccosh(np.maximum(FAR / x, 1.0)), first)
    deep = x[:, None] * np.cosh(first[..., None] + 0.5 * (last - first)[..., None] * (nodes + 1.0))
    potential = -(last - first) * ((k0(deep) * deep) @ weights)
    pressure: Array = -(down - z * across - (1.0 - 2.0 * poisson_ratio) * potential) / np.pi
    return pressure
