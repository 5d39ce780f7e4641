"""Quality of hexahedra: scaled Jacobian and volume."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, dot

#: for each corner its three neighbours, right-handed
NEIGHBOURS = ((1, 3, 4), (2, 0, 5), (3, 1, 6), (0, 2, 7), (7, 5, 0), (4, 6, 1), (5, 7, 2), (6, 4, 3))


def scaled_jacobian(nodes: Array, elements: NDArray[np.int64]) -> Array:
    """Smallest over the corners of the triple product of unit edges, (E,): 1 for a cube, <= 0 if inverted."""
    worst = np.ones(len(elements))
    corners = nodes[elements[:, :8]]
    for corner, others in enumerate(NEIGHBOURS):
        a, b, c = (corners[:, other] - corners[:, corner] for other in others)
        lengths = np.sqrt(dot(a, a) * dot(b, b) * dot(c, c))
        worst = np.minimum(worst, dot(np.cross(a, b), c) / lengths)
    return worst


def volumes(nodes: Array, elements: NDArray[np.int64]) -> Array:
    """Volumes (E,), mm^3, of trilinear hexahedra, by 2 x 2 x 2 Gauss points, which is exact for them."""
    at = np.array([-1.0, 1.0]) / np.sqrt(3.0)
    signs = np.array(
        [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]]
    )
    corners = nodes[elements[:, :8]]
    total = np.zeros(len(elements))
    for place in np.array(np.meshgrid(at, at, at)).reshape(3, -1).T:
        factors = 1.0 + signs * place
        derivative = np.stack([signs[:, k] * factors[:, k - 1] * factors[:, k - 2] for k in range(3)]) / 8.0
        tangents = np.einsum("kc,ecx->kex", derivative, corners)
        total += dot(np.cross(tangents[0], tangents[1]), tangents[2])
    return total
