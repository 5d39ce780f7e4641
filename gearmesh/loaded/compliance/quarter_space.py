"""Effect of a free end face: extra deflection of the surface of a quarter-space compared with a half-space.

    o-------- x    loaded surface z = 0
    |
    |   body
    z
    end face x = 0

Pressures p on z = 0, mirrored at x = 0, cause no shear on the end face x = 0, but normal stresses A p. Loads q = - A p
on the end face, mirrored at z = 0, remove these stresses and cause A q on z = 0, and so on [H60]. For the real
pressures P the sum is

    p = P + A A p

The end face's loads, mirrored, do not move z = 0 along z. The displacements are therefore those of p and its mirror
image on a half-space. For waves exp(i k y) along the edge, A is one matrix for all k, since the problem has no length
of its own. The extra displacement under a unit force at distance d from the edge is therefore that of its mirror image
on a half-space, times a factor. The mirror image gives 1 / (pi R) over E / (1 - nu^2), with R^2 = (x + d)^2 + y^2. The
factor is

    1 + release(m, phi),    m = |x - d| / (x + d),    phi = arctan y / (x + d)

The 1 is the mirror image alone, and `release` is the effect of the removed stresses. [G11] uses one number for
`release`, 0.29 - (0.08 - 0.5 nu) / (1 - nu), which is 0.39 for steel. Exact values for steel are 0.85 for a force on
itself and 0.47 at the edge for a force far away. Far along the edge the value is 1.36, as for a wedge of 90 degrees.

Units: mm, N, MPa. Sources: [H60] M. Hetenyi, J. Appl. Mech. 27 (1960) 289; [J85] K. L. Johnson, Contact Mechanics,
1985, 2.4, 3.2; [G11] R. Guilbault, J. Tribology 133 (2011) 031402.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.grid_spline import GridSpline

#: steps of ln(k x); twice as many change `release` by 3e-3
WAVE_STEPS = 160
#: least ln(k x): the wedge is two-dimensional there
MIN_LOG_DISTANCE = -12.0
#: largest ln(k x): waves have died out there
MAX_LOG_DISTANCE = 3.2
#: Gauss points of the integral for the potential under a wave
GAUSS_POINTS = 16
#: argument beyond which a wave is 0
MAX_WAVE_ARGUMENT = 45.0
#: angles phi in the table
TABLE_ANGLES = 49
#: wave numbers k over which waves are summed
WAVE_NUMBERS = 3000
#: powers of m^2 in which `release` is tabulated, exact at as many places; between them within 2e-3
RELEASE_POWERS = 3
#: limit far along the edge: a wedge of 90 degrees under a force on one face, less two half-spaces, over a half-space
#: [J85 2.4]
WEDGE_RELEASE = 0.5 * np.pi * (1.0 / (0.5 * np.pi + 1.0) + 1.0 / (0.5 * np.pi - 1.0)) - 2.0


def release(phi: Array, poisson_ratio: float) -> Array:
    """Return coefficients (RELEASE_POWERS, ...) of `release`, by powers of m^2 from 0, at angles phi (...,), rad, from
    0 to a right angle."""
    table = _table(poisson_ratio)
    place = phi / (0.5 * np.pi) * (TABLE_ANGLES - 1)
    low = np.minimum(place.astype(np.intp), TABLE_ANGLES - 2)
    coefficients: Array = table[:, low] + (place - low) * (table[:, low + 1] - table[:, low])
    return coefficients


@lru_cache(maxsize=8)
def _table(poisson_ratio: float) -> Array:
    """Return coefficients (RELEASE_POWERS, TABLE_ANGLES) of `release` at equally spaced phi from 0 to a right angle."""
    from scipy.special import k0

    t, waves = _released_waves(poisson_ratio)
    spline = GridSpline.through(t, t, waves)
    m = np.linspace(0.0, 1.0, RELEASE_POWERS)
    # wave numbers k up to exp(MAX_LOG_DISTANCE), dense near 0
    u = (np.arange(WAVE_NUMBERS) + 0.5) / WAVE_NUMBERS
    k = np.exp(MAX_LOG_DISTANCE) * u**2
    # influence is symmetric: the force is taken as the point that is further from the edge; both distances from the
    # edge sum to 1
    near, far = (
        np.log(np.maximum(0.5 * k * (1.0 + way * m[:, None]), np.exp(MIN_LOG_DISTANCE))) for way in (-1.0, 1.0)
    )
    without_wedge = spline.jet(near, np.minimum(far, MAX_LOG_DISTANCE)).f - WEDGE_RELEASE * 2.0 / np.pi * k0(k)
    # sum the waves along the edge, after subtraction of the wedge's limit, whose sum is known
    y = np.tan(0.5 * np.pi * np.arange(TABLE_ANGLES - 1) / (TABLE_ANGLES - 1))
    along_edge = (without_wedge * (2.0 * u * np.exp(MAX_LOG_DISTANCE) / WAVE_NUMBERS)) @ np.cos(np.outer(k, y))
    # polynomial in m^2 through the values at RELEASE_POWERS places m
    values = WEDGE_RELEASE + np.column_stack((along_edge * np.hypot(1.0, y), np.zeros(RELEASE_POWERS)))
    return np.asarray(np.linalg.solve(m[:, None] ** (2 * np.arange(RELEASE_POWERS)), values))


def _released_waves(poisson_ratio: float) -> tuple[Array, Array]:
    """Return steps t (n,) of ln(k x), and the displacements (n, n) that the end face adds to waves.

    They are beyond those of a wave and its image, and multiplied by E / (1 - nu^2). The wave is a force per length
    along the edge at exp(t) (second index); displacements are at exp(t) (first index).
    """
    from scipy.special import k0

    t = np.linspace(MIN_LOG_DISTANCE, MAX_LOG_DISTANCE, WAVE_STEPS)
    step, x = t[1] - t[0], np.exp(t)
    # the strip between the edge and the first step carries the pressure of the first step
    inner_edge = x[0] * np.exp(-0.5 * step)
    stress_matrix = _end_stresses(x, poisson_ratio) * x * step
    stress_matrix[:, 0] += 2.0 / np.pi * (np.arctan(inner_edge / x) - inner_edge * x / (inner_edge**2 + x**2))
    # p = P + A A p: pressures that are added to P
    twice = stress_matrix @ stress_matrix
    removed = np.linalg.solve(np.eye(WAVE_STEPS) - twice, twice)
    apart = np.abs(x - x[:, None])
    # mean of the logarithm over a step, for a place within its own step
    self_influence = np.log(4.0 * np.pi / (x * step)) - np.euler_gamma
    displacement = (
        (np.where(apart > 0.0, k0(np.where(apart > 0.0, apart, 1.0)), self_influence) + k0(x + x[:, None])) * x * step
    )
    displacement[:, 0] += 2.0 * k0(x) * inner_edge
    return t, 2.0 / np.pi * displacement @ removed / (x * step)


def _end_stresses(x: Array, poisson_ratio: float) -> Array:
    """Return normal stress (n, n) on the plane x = 0 of a half-space under waves of force.

    The first index is the depth x of the stress, the second the place x of the force. The waves have k = 1 and are
    added to their mirror images. psi is the potential of 1/r, which is 2 K0 for a wave, and psi_1 its integral along z.
    Then [J85 3.2]: 2 pi sigma_x = psi_z - z psi_xx - (1 - 2 nu) psi_1.
    """
    from scipy.special import k0, k1

    z, s = x[:, None], np.hypot(x, x[:, None])
    down = -2.0 * k1(s) * z / s
    across = 2.0 * (k0(s) * x**2 / s**2 + k1(s) * (2.0 * x**2 / s**3 - 1.0 / s))
    nodes, weights = np.polynomial.legendre.leggauss(GAUSS_POINTS)
    # psi_1 = - integral of psi from z to infinity, with the substitution t = x sinh w
    w_first = np.arcsinh(z / x)
    w_last = np.maximum(np.arccosh(np.maximum(MAX_WAVE_ARGUMENT / x, 1.0)), w_first)
    distances = x[:, None] * np.cosh(w_first[..., None] + 0.5 * (w_last - w_first)[..., None] * (nodes + 1.0))
    potential = -(w_last - w_first) * ((k0(distances) * distances) @ weights)
    pressure: Array = -(down - z * across - (1.0 - 2.0 * poisson_ratio) * potential) / np.pi
    return pressure
