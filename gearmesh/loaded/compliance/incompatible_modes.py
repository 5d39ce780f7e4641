"""Incompatible-mode hexahedra: stiffness of eight-node elements that bend without shear locking.

An element has nine internal unknowns: parabolas 1 - xi^2, 1 - eta^2, 1 - zeta^2 in each direction, which let it bend
without shear [T76]. Eight-node hexahedra without them are far too stiff, most of all with few elements across a tooth.
The gradients of the parabolas use the Jacobian of the element's middle, so that states of constant strain are exact in
any shape. CalculiX and Abaqus call these elements C3D8I.

Units: mm, N, MPa. Strains and stresses are in the order xx, yy, zz, xy, yz, zx; shear strains are twice the tensor's.
Source: [T76] R. L. Taylor, P. J. Beresford, E. L. Wilson, Int. J. Num. Meth. Eng. 10 (1976) 1211.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.contact.hertz import Material
from gearmesh.kernel.numeric.algebra import Array

#: corners (8, 3) of the unit element in the order of `HexMesh.elements`
UNIT_CORNERS = np.array(
    [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]], dtype=float
)
#: Gauss points (8, 3) of the unit element
GAUSS_POINTS = UNIT_CORNERS / np.sqrt(3.0)
#: elements whose stiffness is computed at once: limits memory
ELEMENTS_PER_CHUNK = 4000


def elasticity(material: Material) -> Array:
    """Return the matrix (6, 6), MPa, from strain to stress of an isotropic material."""
    e, nu = material.youngs_modulus, material.poisson_ratio
    shear = 0.5 * e / (1.0 + nu)
    law = np.diag([2.0 * shear] * 3 + [shear] * 3)
    law[:3, :3] += 2.0 * shear * nu / (1.0 - 2.0 * nu)
    return law


def stiffness(corners: Array, material: Material) -> Array:
    """Return stiffness matrices (E, 24, 24), N/mm, of hexahedra with corners (E, 8, 3), mm; unknowns are x, y, z of
    each corner."""
    parts = [corners[k : k + ELEMENTS_PER_CHUNK] for k in range(0, len(corners), ELEMENTS_PER_CHUNK)]
    return np.concatenate([_condense(part, elasticity(material))[0] for part in parts])


def corner_stresses(corners: Array, material: Material) -> Array:
    """Return matrices (E, 8, 6, 24), MPa/mm, from displacements of the corners to stresses there.

    The hexahedra have corners (E, 8, 3), mm. Stresses at the Gauss points are extrapolated to the corners, linearly in
    each direction.
    """
    law = elasticity(material)
    _, modes = _condense(corners, law)
    at_gauss = np.empty((len(corners), 8, 6, 24))
    for k, (strain, mode_strain, _) in enumerate(_strains(corners)):
        at_gauss[:, k] = law @ (strain + mode_strain @ modes)
    extrapolation = np.prod(1.0 + 3.0 * UNIT_CORNERS[:, None] * GAUSS_POINTS[None], axis=-1) / 8.0
    stresses: Array = np.einsum("cg,egij->ecij", extrapolation, at_gauss)
    return stresses


def _condense(corners: Array, law: Array) -> tuple[Array, Array]:
    """Return stiffnesses (E, 24, 24), and matrices (E, 9, 24) from corner displacements to internal unknowns.

    Internal unknowns are eliminated by equilibrium.
    """
    count = len(corners)
    outer, mixed, inner = np.zeros((count, 24, 24)), np.zeros((count, 9, 24)), np.zeros((count, 9, 9))
    for corner_strain, mode_strain, weight in _strains(corners):
        stress, mode_stress = (weight[:, None, None] * (law @ strain) for strain in (corner_strain, mode_strain))
        outer += np.swapaxes(corner_strain, 1, 2) @ stress
        mixed += np.swapaxes(mode_strain, 1, 2) @ stress
        inner += np.swapaxes(mode_strain, 1, 2) @ mode_stress
    modes = -np.asarray(np.linalg.solve(inner, mixed), np.float64)
    return outer + np.swapaxes(mixed, 1, 2) @ modes, modes


def _strains(corners: Array) -> list[tuple[Array, Array, Array]]:
    """Return for each Gauss point: strains (E, 6, 24) of the corners, strains (E, 6, 9) of the modes, and volumes (E,),
    mm^3."""
    middle = _jacobian(corners, np.zeros(3))
    to_middle, middle_volume = np.linalg.inv(middle), np.linalg.det(middle)
    strains = []
    for place in GAUSS_POINTS:
        jacobian = _jacobian(corners, place)
        volume = np.linalg.det(jacobian)
        gradients = np.linalg.inv(jacobian) @ _slopes(place)
        modes = to_middle * (-2.0 * place) * (middle_volume / volume)[:, None, None]
        strains.append((_symmetric(gradients), _symmetric(modes), volume))
    return strains


def _slopes(place: Array) -> Array:
    """Return derivatives (3, 8) of the corners' shape functions at a place (3,) of the unit element."""
    factors = 1.0 + UNIT_CORNERS * place
    return np.stack([UNIT_CORNERS[:, k] * factors[:, k - 1] * factors[:, k - 2] for k in range(3)]) / 8.0


def _jacobian(corners: Array, place: Array) -> Array:
    """Return d x_j / d xi_i (E, 3, 3) at a place of the unit element."""
    jacobian: Array = _slopes(place) @ corners
    return jacobian


def _symmetric(gradients: Array) -> Array:
    """Return strains (E, 6, 3 K) from gradients (E, 3, K) of K functions, each of which displaces in three
    directions."""
    count, _, functions = gradients.shape
    strains = np.zeros((count, 6, functions, 3))
    for k in range(3):
        strains[:, k, :, k] = gradients[:, k]
    for row, (i, j) in ((3, (0, 1)), (4, (1, 2)), (5, (2, 0))):
        strains[:, row, :, i] = gradients[:, j]
        strains[:, row, :, j] = gradients[:, i]
    return strains.reshape(count, 6, 3 * functions)


def unknowns(nodes: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return numbers (..., 3 K) of the unknowns of nodes (..., K): x, y, z of each node in turn."""
    return (3 * nodes[..., None] + np.arange(3)).reshape(*nodes.shape[:-1], -1)
