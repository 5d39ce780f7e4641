"""Incompatible-mode hexahedra: the stiffness of eight-node elements that bend without shear.

The displacements of an element have nine more unknowns of its own, parabolas 1 - xi^2, 1 - eta^2, 1 - zeta^2 in each direction,
which let it bend without shear [T76]: eight-node hexahedra without them are far too stiff, most of all where few lie through a
tooth. Their gradients use the Jacobian of the element's middle, so that states of constant strain stay exact in any shape.
CalculiX and Abaqus call them C3D8I.

Units: mm, N, MPa. Strains and stresses are xx, yy, zz, xy, yz, zx, the strains of shear twice the tensor's.
Source: [T76] R. L. Taylor, P. J. Beresford, E. L. Wilson, Int. J. Num. Meth. Eng. 10 (1976) 1211.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.hertz import Material
from gearmesh.kernel.numeric.algebra import Array

#: corners of the unit element in the order of `HexMesh.elements`
CORNERS = np.array(
    [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]], dtype=float
)
#: points of Gauss
GAUSS = CORNERS / np.sqrt(3.0)
#: hexahedra that are worked on at once
CHUNK = 4000


def elasticity(material: Material) -> Array:
    """Stress from strain (6, 6), MPa, of an isotropic material."""
    e, nu = material.youngs_modulus, material.poisson_ratio
    shear = 0.5 * e / (1.0 + nu)
    law = np.diag([2.0 * shear] * 3 + [shear] * 3)
    law[:3, :3] += 2.0 * shear * nu / (1.0 - 2.0 * nu)
    return law


def stiffness(corners: Array, material: Material) -> Array:
    """Stiffness (E, 24, 24), N/mm, of hexahedra with corners (E, 8, 3), mm; three directions for each corner in turn."""
    parts = [corners[k : k + CHUNK] for k in range(0, len(corners), CHUNK)]
    return np.concatenate([_condense(part, elasticity(material))[0] for part in parts])


def corner_stresses(corners: Array, material: Material) -> Array:
    """Stresses at the corners (E, 8, 6, 24), MPa, from the displacements (24,), mm, of hexahedra with corners (E, 8, 3).

    Those at the points of Gauss continued to the corners, linear in each direction.
    """
    law = elasticity(material)
    _, modes = _condense(corners, law)
    at_gauss = np.empty((len(corners), 8, 6, 24))
    for k, (own, inner, _) in enumerate(_strains(corners)):
        at_gauss[:, k] = law @ (own + inner @ modes)
    beyond = np.prod(1.0 + 3.0 * CORNERS[:, None] * GAUSS[None], axis=-1) / 8.0
    stresses: Array = np.einsum("cg,egij->ecij", beyond, at_gauss)
    return stresses


def _condense(corners: Array, law: Array) -> tuple[Array, Array]:
    """Stiffness (E, 24, 24), and the element's own unknowns (E, 9, 24) that balance its corners' displacements."""
    count = len(corners)
    outer, mixed, inner = np.zeros((count, 24, 24)), np.zeros((count, 9, 24)), np.zeros((count, 9, 9))
    for own, more, weight in _strains(corners):
        stress, stress_more = (weight[:, None, None] * (law @ strain) for strain in (own, more))
        outer += np.swapaxes(own, 1, 2) @ stress
        mixed += np.swapaxes(more, 1, 2) @ stress
        inner += np.swapaxes(more, 1, 2) @ stress_more
    modes = -np.asarray(np.linalg.solve(inner, mixed), np.float64)
    return outer + np.swapaxes(mixed, 1, 2) @ modes, modes


def _strains(corners: Array) -> list[tuple[Array, Array, Array]]:
    """At each point of Gauss: strains (E, 6, 24) from the corners, (E, 6, 9) from the modes, and volumes (E,), mm^3."""
    middle = _jacobian(corners, np.zeros(3))
    to_middle, middle_volume = np.linalg.inv(middle), np.linalg.det(middle)
    strains = []
    for place in GAUSS:
        jacobian = _jacobian(corners, place)
        volume = np.linalg.det(jacobian)
        gradients = np.linalg.inv(jacobian) @ _slopes(place)
        modes = to_middle * (-2.0 * place) * (middle_volume / volume)[:, None, None]
        strains.append((_symmetric(gradients), _symmetric(modes), volume))
    return strains


def _slopes(place: Array) -> Array:
    """Derivatives (3, 8) of the corners' shape functions at a place (3,) of the unit element."""
    factors = 1.0 + CORNERS * place
    return np.stack([CORNERS[:, k] * factors[:, k - 1] * factors[:, k - 2] for k in range(3)]) / 8.0


def _jacobian(corners: Array, place: Array) -> Array:
    """d x_j / d xi_i (E, 3, 3) at a place."""
    jacobian: Array = _slopes(place) @ corners
    return jacobian


def _symmetric(gradients: Array) -> Array:
    """Strains (E, 6, 3 K) from the gradients (E, 3, K) of K functions that each direction has."""
    count, _, number = gradients.shape
    strains = np.zeros((count, 6, number, 3))
    for k in range(3):
        strains[:, k, :, k] = gradients[:, k]
    for row, (i, j) in ((3, (0, 1)), (4, (1, 2)), (5, (2, 0))):
        strains[:, row, :, i] = gradients[:, j]
        strains[:, row, :, j] = gradients[:, i]
    return strains.reshape(count, 6, 3 * number)


def unknowns(nodes: NDArray[np.int64]) -> NDArray[np.int64]:
    """Numbers (..., 3 K) of the unknowns of nodes (..., K): three directions for each node in turn."""
    return (3 * nodes[..., None] + np.arange(3)).reshape(*nodes.shape[:-1], -1)
