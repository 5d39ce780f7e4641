"""Quality of hexahedra: scaled Jacobian and volume."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, dot

#: for each corner its three neighbours, right-handed
NEIGHBOURS = ((1, 3, 4), (2, 0, 5), (3, 1, 6), (0, 2, 7), (7, 5, 0), (4, 6, 1), (5, 7, 2), (6, 4, 3))

#: corners and mid-side nodes in the cube from -1 to 1, in the order of C3D8 and C3D20
CORNER_PLACES = np.array(
    [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]], float
)
MIDDLE_PLACES = np.array(
    [
        *([0, -1, -1], [1, 0, -1], [0, 1, -1], [-1, 0, -1], [0, -1, 1], [1, 0, 1], [0, 1, 1], [-1, 0, 1]),
        *([-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]),
    ],
    float,
)


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
    """Volumes (E,), mm^3, of hexahedra with 8 nodes, or with 20 as C3D20 interpolates, by Gauss points that are exact for them."""
    order = 2 if elements.shape[1] == len(CORNER_PLACES) else 3
    places, weights = np.polynomial.legendre.leggauss(order)
    total = np.zeros(len(elements))
    points = nodes[elements]
    for index in np.ndindex(order, order, order):
        derivative = _shape_derivatives(places[list(index)], elements.shape[1])
        tangents = np.einsum("kn,enx->kex", derivative, points)
        total += weights[list(index)].prod() * dot(np.cross(tangents[0], tangents[1]), tangents[2])
    return total


def _shape_derivatives(place: Array, count: int) -> Array:
    """Derivatives (3, count) of the shape functions of 8 or 20 nodes at a place (3,) of the cube from -1 to 1."""
    corners = 1.0 + CORNER_PLACES * place
    linear = np.stack([CORNER_PLACES[:, k] * corners[:, k - 1] * corners[:, k - 2] for k in range(3)]) / 8.0
    if count == len(CORNER_PLACES):
        return linear
    middles = 1.0 + MIDDLE_PLACES * place
    # along its edge a mid-side node has 1 - u^2, for which its place is 0
    along = MIDDLE_PLACES == 0.0
    factors = np.where(along, 1.0 - place**2, middles)
    slopes = np.where(along, -2.0 * place, MIDDLE_PLACES)
    quadratic = np.stack([slopes[:, k] * factors[:, k - 1] * factors[:, k - 2] for k in range(3)]) / 4.0
    # corners: the linear function less half of those of the three middles beside it
    beside = np.abs(CORNER_PLACES[:, None] - MIDDLE_PLACES[None]).sum(axis=-1) == 1.0
    return np.concatenate((linear - 0.5 * quadratic @ beside.T, quadratic), axis=1)
