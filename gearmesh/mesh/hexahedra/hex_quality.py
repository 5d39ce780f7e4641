"""Quality of hexahedra: scaled Jacobian and volume."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array, cross, dot

#: corners in the cube from -1 to 1, in the order of C3D8
CORNER_PLACES = np.array(
    [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]], float
)
#: mid-side nodes in the same cube, in the order of C3D20
MIDDLE_PLACES = np.array(
    [
        *([0, -1, -1], [1, 0, -1], [0, 1, -1], [-1, 0, -1], [0, -1, 1], [1, 0, 1], [0, 1, 1], [-1, 0, 1]),
        *([-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]),
    ],
    float,
)


def scaled_jacobian(nodes: Array, elements: NDArray[np.int64]) -> Array:
    """Return the least scaled Jacobian (E,) of hexahedra with 8 or 20 nodes: 1 for a cube, <= 0 if inverted.

    The scaled Jacobian is the determinant of the Jacobian matrix over the product of the lengths of its columns. Elements of
    8 nodes are evaluated at the corners, as VTK does. Elements of 20 nodes are evaluated at all nodes, as gmsh does for
    minSIGE, and at the 27 integration points of C3D20.
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
    """Return the volumes (E,), mm^3, of hexahedra with 8 or 20 nodes (C3D20), by Gauss points that are exact for them."""
    order = 2 if elements.shape[1] == len(CORNER_PLACES) else 3
    along, weights = np.polynomial.legendre.leggauss(order)
    places = np.stack(np.meshgrid(along, along, along), axis=-1).reshape(-1, 3)
    shares = np.prod(np.meshgrid(weights, weights, weights), axis=0).ravel()
    total = np.zeros(len(elements))
    for share, (determinant, _) in zip(shares, _jacobians(nodes, elements, places), strict=True):
        total += share * determinant
    return total


def _jacobians(nodes: Array, elements: NDArray[np.int64], places: Array) -> Iterator[tuple[Array, Array]]:
    """Yield determinants (E,) and columns (3, E, 3) of the Jacobian matrices of elements, for each place of (P, 3) in the cube."""
    points = np.ascontiguousarray(nodes[elements].swapaxes(0, 1)).reshape(elements.shape[1], -1)
    for place in places:
        tangents = (_shape_derivatives(place, elements.shape[1]) @ points).reshape(3, -1, 3)
        yield dot(cross(tangents[0], tangents[1]), tangents[2]), tangents


def _shape_derivatives(place: Array, count: int) -> Array:
    """Return the derivatives (3, count) of the shape functions of 8 or 20 nodes at a place (3,) of the cube from -1 to 1."""
    corners = 1.0 + CORNER_PLACES * place
    linear = np.stack([CORNER_PLACES[:, k] * corners[:, k - 1] * corners[:, k - 2] for k in range(3)]) / 8.0
    if count == len(CORNER_PLACES):
        return linear
    middles = 1.0 + MIDDLE_PLACES * place
    # the shape function of a mid-side node is 1 - u^2 along its edge
    along = MIDDLE_PLACES == 0.0
    factors = np.where(along, 1.0 - place**2, middles)
    slopes = np.where(along, -2.0 * place, MIDDLE_PLACES)
    quadratic = np.stack([slopes[:, k] * factors[:, k - 1] * factors[:, k - 2] for k in range(3)]) / 4.0
    # shape function of a corner: the linear one minus half of those of the three neighbouring mid-side nodes
    beside = np.abs(CORNER_PLACES[:, None] - MIDDLE_PLACES[None]).sum(axis=-1) == 1.0
    return np.concatenate((linear - 0.5 * quadratic @ beside.T, quadratic), axis=1)
