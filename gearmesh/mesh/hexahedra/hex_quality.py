"""Quality of hexahedra: scaled Jacobian and volume."""

from __future__ import annotations

from collections.abc import Callable, Iterator

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

#: elements that are measured at once: their numbers stay in the processor's memory
CHUNK_ELEMENTS = 8_000


def scaled_jacobian(nodes: Array, elements: NDArray[np.int64]) -> Array:
    """Return the least scaled Jacobian (E,) of hexahedra with 8 or 20 nodes: 1 for a cube, <= 0 if inverted.

    The scaled Jacobian is the determinant of the Jacobian matrix over the product of the lengths of its columns. Elements of
    8 nodes are evaluated at the corners, as VTK does. Elements of 20 nodes are evaluated at all nodes, as gmsh does for
    minSIGE, and at the 27 integration points of C3D20.
    """
    return _in_chunks(_scaled_jacobian, nodes, elements)


def volumes(nodes: Array, elements: NDArray[np.int64]) -> Array:
    """Return the volumes (E,), mm^3, of hexahedra with 8 or 20 nodes (C3D20).

    The determinant of 8 nodes is integrated in closed form, that of 20 nodes by Gauss points that are exact for it.
    """
    first_order = elements.shape[1] == len(CORNER_PLACES)
    return _in_chunks(_volumes_of_corners if first_order else _volumes_by_gauss, nodes, elements)


def _in_chunks(
    measure: Callable[[Array, NDArray[np.int64]], Array], nodes: Array, elements: NDArray[np.int64]
) -> Array:
    """Return what is measured of each element (E,), a chunk of elements at once."""
    parts = [measure(nodes, elements[k : k + CHUNK_ELEMENTS]) for k in range(0, len(elements), CHUNK_ELEMENTS)]
    return np.concatenate(parts) if parts else np.zeros(0)


def _scaled_jacobian(nodes: Array, elements: NDArray[np.int64]) -> Array:
    """Return the least scaled Jacobian (E,) of a chunk of elements."""
    places = CORNER_PLACES
    if elements.shape[1] != len(CORNER_PLACES):
        inside = np.stack(np.meshgrid(*3 * [np.polynomial.legendre.leggauss(3)[0]]), axis=-1).reshape(-1, 3)
        places = np.concatenate((CORNER_PLACES, MIDDLE_PLACES, inside))
    worst = np.ones(len(elements))
    for determinant, tangents in _jacobians(nodes, elements, places):
        lengths = np.sqrt(np.prod([dot(tangent, tangent) for tangent in tangents], axis=0))
        worst = np.minimum(worst, determinant / lengths)
    return worst


def _volumes_by_gauss(nodes: Array, elements: NDArray[np.int64]) -> Array:
    """Return the volumes (E,), mm^3, of hexahedra with 20 nodes."""
    along, weights = np.polynomial.legendre.leggauss(3)
    places = np.stack(np.meshgrid(along, along, along), axis=-1).reshape(-1, 3)
    shares = np.prod(np.meshgrid(weights, weights, weights), axis=0).ravel()
    total = np.zeros(len(elements))
    for share, (determinant, _) in zip(shares, _jacobians(nodes, elements, places), strict=True):
        total += share * determinant
    return total


def _volumes_of_corners(nodes: Array, elements: NDArray[np.int64]) -> Array:
    """Return the volumes (E,), mm^3, of hexahedra with 8 nodes.

    With x = x0 + a u + b v + c w + d u v + e v w + f w u + g u v w, the volume is the integral of x_u . (x_v x x_w) over the
    cube from -1 to 1; of all products only those with even powers of u, v and w count.
    """
    u, v, w = CORNER_PLACES.T
    # coordinates apart from each other: arrays along all elements are fast
    points = np.stack([nodes[:, k][elements.T] for k in range(3)], axis=1)
    terms = (np.stack((u, v, w, u * v, v * w, w * u)) / 8.0 @ points.reshape(8, -1)).reshape(6, 3, -1)
    a, b, c, d, e, f = terms
    twisted = _triple_products(a, d, f) + _triple_products(d, b, e) + _triple_products(f, e, c)
    return np.asarray(8.0 * (_triple_products(a, b, c) + twisted / 3.0))


def _triple_products(a: Array, b: Array, c: Array) -> Array:
    """Return a . (b x c) (E,) of vectors (3, E)."""
    return np.asarray(
        a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0])
    )


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
