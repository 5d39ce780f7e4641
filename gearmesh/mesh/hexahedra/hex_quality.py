"""Quality of hexahedra: scaled Jacobian and volume."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, dot

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
    """Least scaled Jacobian (E,) of hexahedra with 8 or 20 nodes: 1 for a cube, <= 0 if inverted.

    The scaled Jacobian is the determinant of the Jacobian matrix over the product of the lengths of its columns. With 8 nodes it is
    taken at the corners, as VTK does, and with 20 at all nodes, as the minSIGE of gmsh, and at the 27 integration points of C3D20.
    """
    count = elements.shape[1]
    if count == len(CORNER_PLACES):
        places = CORNER_PLACES
    else:
        inside = np.stack(np.meshgrid(*3 * [np.polynomial.legendre.leggauss(3)[0]]), axis=-1).reshape(-1, 3)
        places = np.concatenate((CORNER_PLACES, MIDDLE_PLACES, inside))
    worst = np.ones(len(elements))
    for determinant, tangents in _jacobians(nodes, elements, places):
        lengths = np.sqrt(np.prod([dot(tangent, tangent) for tangent in tangents], axis=0))
        worst = np.minimum(worst, determinant / lengths)
    return worst


def volumes(nodes: Array, elements: NDArray[np.int64]) -> Array:
    """Volumes (E,), mm^3, of hexahedra with 8 nodes, or with 20 as C3D20 interpolates, by Gauss points that are exact for them."""
    order = 2 if elements.shape[1] == len(CORNER_PLACES) else 3
    along, weights = np.polynomial.legendre.leggauss(order)
    places = np.stack(np.meshgrid(along, along, along), axis=-1).reshape(-1, 3)
    shares = np.prod(np.meshgrid(weights, weights, weights), axis=0).ravel()
    total = np.zeros(len(elements))
    for share, (determinant, _) in zip(shares, _jacobians(nodes, elements, places), strict=True):
        total += share * determinant
    return total


def _jacobians(nodes: Array, elements: NDArray[np.int64], places: Array) -> Iterator[tuple[Array, Array]]:
    """Determinant (E,) and columns (3, E, 3) of the Jacobian matrices of elements, at each of the places (P, 3) in the cube."""
    points = np.ascontiguousarray(nodes[elements].swapaxes(0, 1)).reshape(elements.shape[1], -1)
    for place in places:
        tangents = (_shape_derivatives(place, elements.shape[1]) @ points).reshape(3, -1, 3)
        yield dot(np.cross(tangents[0], tangents[1]), tangents[2]), tangents


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
