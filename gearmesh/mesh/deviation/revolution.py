"""Distances of facets from cones, cylinders and planes about z through their corners, in closed form.

The distance of a point (rho, z) from a cone is s (rho - rho of the cone at z), apart from its sign. Here s is the sine
of the angle between generatrix and radius. Over a facet z is linear, and so is rho of the cone. The facet's own rho is
a distance in the plane z = 0, with a gradient of length 1 everywhere. The difference has no extreme inside the facet,
unless the linear part has the same gradient: the facet is farthest on one of its edges. Take an edge from a to b
(projected along z) of length L, at distance m from the axis, with k = (rho_b - rho_a) / L. Its largest distance is at
rho = m / sqrt(1 - k^2), and it is

    s (rho_a - k a . (b - a) / L - m sqrt(1 - k^2)).
"""

from __future__ import annotations

import numpy as np

from gearmesh.kernel.numeric.algebra import Array

#: shortest chord, projected along the axis, that comes closer to the axis than its ends
MIN_CHORD_MM = 1e-6
#: least distance of corners in the axial half plane for which they define a generatrix
MIN_GENERATRIX_MM = 1e-7


def drop(a: Array, b: Array) -> Array:
    """Return the largest differences (...,), mm, of linear radius and true radius along chords from a to b (..., 2 or more)."""
    along = b[..., :2] - a[..., :2]
    length, near, far = (np.hypot(v[..., 0], v[..., 1]) for v in (along, a, b))
    with np.errstate(invalid="ignore", divide="ignore"):
        rise = (far - near) / length
        off = np.abs(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]) / length
        forward = (a[..., 0] * along[..., 0] + a[..., 1] * along[..., 1]) / length
        least = near - rise * forward - off * np.sqrt(np.maximum(1.0 - rise**2, 0.0))
    return np.where(length > MIN_CHORD_MM, np.maximum(least, 0.0), 0.0)


def facet_distances(corners: Array) -> Array:
    """Return the largest distances (M,), mm, of facets (M, 3, 3) from the plane, cylinder or cone about z through their corners."""
    rho, z = np.hypot(corners[..., 0], corners[..., 1]), corners[..., 2]
    across, up = (np.roll(part, -1, axis=1) - part for part in (rho, z))
    apart = np.hypot(across, up)
    widest = apart.argmax(axis=1)
    rows = np.arange(len(corners))
    with np.errstate(invalid="ignore", divide="ignore"):
        sine = np.where(apart.max(axis=1) > MIN_GENERATRIX_MM, np.abs(up[rows, widest]) / apart[rows, widest], 0.0)
    distances: Array = sine * drop(corners, np.roll(corners, -1, axis=1)).max(axis=1)
    return distances


def polygon_distance(radius: float, sides: float) -> float:
    """Return the largest distance, mm, of an inscribed regular polygon from its circle; `sides` of the whole circle."""
    return float(radius * (1.0 - np.cos(np.pi / sides)))
