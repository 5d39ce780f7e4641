"""Teeth in plane strain by quadrilaterals of eight nodes: root stress that shares no elements with `loaded`."""

from __future__ import annotations

import numpy as np
from numpy.polynomial.legendre import leggauss
from scipy.sparse import coo_array, csc_array
from scipy.sparse.linalg import splu

from gearmesh.contact.hertz import Material
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kinds import Side, Tooth
from gearmesh.loaded.root_tangent import tangent_weights
from gearmesh.mesh.hexahedra.hexahedra import HexGrid, hex_mesh, whole_rim
from gearmesh.mesh.hexahedra.hexes import HexMesh
from gearmesh.teeth.blank.body import end_names

#: nodes of a quadrilateral, corners first
NODES = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1], [0, -1], [1, 0], [0, 1], [-1, 0]], dtype=float)


def slopes(place: Array) -> Array:
    """Derivatives (2, 8) of the shape functions at a place of the unit square."""
    a, b = NODES.T
    x, y = place
    found = np.empty((2, 8))
    found[0, :4] = (0.25 * a * (1 + b * y) * (2 * a * x + b * y))[:4]
    found[1, :4] = (0.25 * b * (1 + a * x) * (a * x + 2 * b * y))[:4]
    found[:, 4::2] = -x * (1 + b[4::2] * y), 0.5 * (1 - x**2) * b[4::2]
    found[:, 5::2] = 0.5 * (1 - y**2) * a[5::2], -y * (1 + a[5::2] * x)
    return found


def strains(corners: Array, place: Array) -> tuple[Array, Array]:
    """Strains xx, yy, xy (E, 3, 16) from displacements, and area (E,) at a place."""
    jacobian = slopes(place) @ corners
    gradients = np.linalg.solve(jacobian, np.broadcast_to(slopes(place), (len(corners), 2, 8)))
    found = np.zeros((len(corners), 3, 16))
    found[:, 0, ::2] = found[:, 2, 1::2] = gradients[:, 0]
    found[:, 1, 1::2] = found[:, 2, ::2] = gradients[:, 1]
    return found, np.linalg.det(jacobian)


def pressed_nodes(
    mesh: HexMesh, flank: str, chosen: Array, tooth: Tooth, side: Side, height: float
) -> tuple[Array, Array]:
    """The two nodes of a flank, of those `chosen` (N,), about the place `height` of it, and forces (2, 2) of 1 N into it there."""
    exact = tooth.flank_grid(side, np.array([height]), np.array([0.0]))
    radius = np.hypot(*exact.points[0, 0, :2])
    own = np.intersect1d(mesh.node_sets[flank], np.flatnonzero(chosen))
    own = own[np.argsort(np.hypot(*mesh.nodes[own, :2].T))]
    reach = np.hypot(*mesh.nodes[own, :2].T)
    k = int(np.searchsorted(reach, radius))
    share = (radius - reach[k - 1]) / (reach[k] - reach[k - 1])
    return own[k - 1 : k + 1], -np.outer([1.0 - share, share], exact.normals[0, 0, :2])


def bending(tooth: Tooth, side: Side, material: Material, grid: HexGrid, height: float, teeth: int = 5) -> float:
    """Stress, MPa, where the tangent is at 30 deg (without such a tangent the largest) of a section at toe, under 1 N/mm at
    a place of the flank, 0 (form point) .. 1 (tip), held at the bore."""
    rim = whole_rim(tooth, np.linspace(0.0, 1.0, 2))
    mesh = hex_mesh(tooth, np.arange(teeth) - teeth // 2, grid, rim, second_order=True)
    used, faces = np.unique(
        mesh.face_outlines(end_names(tooth.blank.axial)[0])[:, [0, 2, 4, 6, 1, 3, 5, 7]], return_inverse=True
    )
    nodes, faces = mesh.nodes[used], faces.reshape(-1, 8)
    plane = nodes[:, :2]
    e, nu = material.youngs_modulus, material.poisson_ratio
    law = e / (1 + nu) / (1 - 2 * nu) * np.array([[1 - nu, nu, 0], [nu, 1 - nu, 0], [0, 0, 0.5 - nu]])
    places, weights = leggauss(3)
    stiffness = np.zeros((len(faces), 16, 16))
    for x, wx in zip(places, weights, strict=True):
        for y, wy in zip(places, weights, strict=True):
            strain, area = strains(plane[faces], np.array([x, y]))
            stiffness += (wx * wy * np.abs(area))[:, None, None] * (strain.swapaxes(1, 2) @ law @ strain)
    own = (2 * faces[..., None] + np.arange(2)).reshape(-1, 16)
    size = 2 * len(nodes)
    rows, columns = np.repeat(own, 16, axis=1).ravel(), np.tile(own, 16).ravel()
    matrix = csc_array(coo_array((stiffness.ravel(), (rows, columns)), shape=(size, size)))
    number = np.full(len(mesh.nodes), -1)
    number[used] = np.arange(len(used))
    held = number[mesh.node_sets["rim"]]
    free = np.setdiff1d(np.arange(size), (2 * held[held >= 0, None] + np.arange(2)).ravel())
    middle = teeth // 2 + 1
    loaded, force = pressed_nodes(mesh, f"flank_{side}_{middle}", number >= 0, tooth, side, height)
    right, moved = np.zeros((len(nodes), 2)), np.zeros(size)
    right[number[loaded]] = force
    moved[free] = splu(matrix[free][:, free]).solve(right.ravel()[free])
    fillet = number[mesh.node_sets[f"fillet_{side}_{middle}"]]
    fillet = fillet[fillet >= 0]
    near = np.flatnonzero(np.isin(faces, fillet).any(axis=1))
    total, count = np.zeros((len(nodes), 3)), np.zeros(len(nodes))
    inner = NODES[:4] / np.sqrt(3.0)
    stress = np.stack(
        [(law @ strains(plane[faces[near]], at)[0] @ moved[own[near], None])[..., 0] for at in inner], axis=1
    )
    out = 0.25 * np.prod(1.0 + 3.0 * NODES[:, None] * inner[None], axis=-1)
    np.add.at(total, faces[near], np.einsum("ng,egs->ens", out, stress))
    np.add.at(count, faces[near], 1.0)
    xx, yy, xy = (total[fillet] / count[fillet, None]).T
    largest = 0.5 * (xx + yy) + np.hypot(0.5 * (xx - yy), xy)
    return nominal(tooth, side, nodes[fillet], largest)


def nominal(tooth: Tooth, side: Side, fillet: Array, largest: Array) -> float:
    """Return the stress at the tangent of 30 deg, of stresses (F,) at nodes (F, 3) of a fillet; otherwise the largest."""
    # a second station, that there is a way along the tooth
    both = np.concatenate((fillet, fillet + np.array([0.0, 0.0, 1.0])))
    weights = tangent_weights(tooth, side, np.array([0.0, 1.0]), both)
    return float(weights[0, : len(fillet)] @ largest if len(weights) else largest.max())
