"""How far facets are from cones, cylinders and planes about z on which their corners are: in closed form.

The distance of a point (rho, z) from the cone through two others is s (rho - rho of the cone at z), up to its sign, s the sine
of the angle between generatrix and radius. Over a facet z is linear and so is rho of the cone, while the facet's rho is a
distance in the plane, with a gradient of length 1 everywhere: unless the linear one has the same, it can have no extreme inside
the facet, which is therefore farthest in one of its edges. On an edge from a to b (in the plane across z), of length L, m from
the axis, with k = (rho_b - rho_a) / L the distance is greatest at rho = m / sqrt(1 - k^2), and there

    s (rho_a - k a . (b - a) / L - m sqrt(1 - k^2)).
"""

from __future__ import annotations

import numpy as np

from gearmesh.kernel.numeric.algebra import Array

#: chords shorter than this (mm) in the plane across the axis come no nearer to it
SHORT = 1e-6
#: corners closer to each other than this (mm) in the axial half plane tell no generatrix
APART = 1e-7


def drop(a: Array, b: Array) -> Array:
    """By how much (...,), mm, chords from a to b (..., 2 or more) are nearer to the axis z than between radii linear along them."""
    along = b[..., :2] - a[..., :2]
    length, near, far = (np.hypot(v[..., 0], v[..., 1]) for v in (along, a, b))
    with np.errstate(invalid="ignore", divide="ignore"):
        rise = (far - near) / length
        off = np.abs(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]) / length
        forward = (a[..., 0] * along[..., 0] + a[..., 1] * along[..., 1]) / length
        least = near - rise * forward - off * np.sqrt(np.maximum(1.0 - rise**2, 0.0))
    return np.where(length > SHORT, np.maximum(least, 0.0), 0.0)


def facet_distances(corners: Array) -> Array:
    """Largest distances (M,), mm, of facets (M, 3, 3) from the plane, cylinder or cone about z that each has its corners on."""
    rho, z = np.hypot(corners[..., 0], corners[..., 1]), corners[..., 2]
    across, up = (np.roll(part, -1, axis=1) - part for part in (rho, z))
    apart = np.hypot(across, up)
    widest = apart.argmax(axis=1)
    rows = np.arange(len(corners))
    with np.errstate(invalid="ignore", divide="ignore"):
        sine = np.where(apart.max(axis=1) > APART, np.abs(up[rows, widest]) / apart[rows, widest], 0.0)
    distances: Array = sine * drop(corners, np.roll(corners, -1, axis=1)).max(axis=1)
    return distances


def polygon_distance(radius: float, sides: float) -> float:
    """How far (mm) a regular polygon with its corners on a circle is from it; sides are counted round the whole circle."""
    return float(radius * (1.0 - np.cos(np.pi / sides)))
