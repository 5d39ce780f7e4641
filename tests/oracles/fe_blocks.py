"""Meshes of deformed blocks for the finite-element tests, and models of two of them pressed together."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from gearmesh.contact.hertz import STEEL
from gearmesh.fe.model import ContactPair, Model, RigidTie, Support
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.hexahedra.hexes import HEX_EDGES, HexMesh, join

CORNERS = np.array([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)])
# faces S1 .. S6 of an element in a lattice
SIDES = ("z0", "z1", "y0", "x1", "y1", "x0")


def straight(points: Array) -> Array:
    return points


def block(
    x: Array, y: Array, z: Array, shape: Callable[[Array], Array] = straight, second_order: bool = False
) -> HexMesh:
    """The lattice of the given coordinates under `shape`; its six sides are node and face sets, "all" the elements."""
    axes = [_with_middles(np.asarray(a, float)) for a in (x, y, z)]
    lattice = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    counts = [len(a) - 1 for a in (x, y, z)]
    cells = np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1).reshape(-1, 3)
    local = 2 * CORNERS
    if second_order:
        local = np.concatenate([local, [CORNERS[a] + CORNERS[b] for a, b in HEX_EDGES]])
    places = np.ravel_multi_index(tuple(np.moveaxis(2 * cells[:, None] + local, -1, 0)), lattice.shape[:3])
    used, elements = np.unique(places, return_inverse=True)
    node_sets, face_sets = {}, {}
    steps = np.stack(np.unravel_index(used, lattice.shape[:3]), axis=-1)
    for face, side in enumerate(SIDES):
        axis, end = "xyz".index(side[0]), int(side[1])
        node_sets[side] = np.flatnonzero(steps[:, axis] == 2 * counts[axis] * end)
        of_face = np.flatnonzero(cells[:, axis] == (counts[axis] - 1) * end)
        face_sets[side] = np.column_stack([of_face, np.full(len(of_face), face)])
    nodes = shape(lattice.reshape(-1, 3)[used])
    return HexMesh(nodes, elements.reshape(places.shape), node_sets, {"all": np.arange(len(cells))}, face_sets)


def _with_middles(values: Array) -> Array:
    out = np.empty(2 * len(values) - 1)
    out[::2], out[1::2] = values, 0.5 * (values[1:] + values[:-1])
    return out


def graded(fine: float, step: float, end: float, ratio: float = 1.4) -> Array:
    """0 .. `end`: about `step` apart up to `fine`, then steps that grow by `ratio`."""
    inner = np.linspace(0.0, fine, round(fine / step) + 1)
    steps = step * ratio ** np.arange(
        1, 1 + int(np.ceil(np.log1p((end - fine) * (ratio - 1) / (step * ratio)) / np.log(ratio)))
    )
    return np.concatenate([inner, fine + np.cumsum(steps) * (end - fine) / steps.sum()])


def rounded(height: float, kappa_x: float, kappa_y: float) -> Callable[[Array], Array]:
    """A block between z = 0 and `height` whose side z = 0 follows the paraboloid of the curvatures."""

    def shape(points: Array) -> Array:
        x, y, z = points.T
        sagitta = 0.5 * (kappa_x * x**2 + kappa_y * y**2)
        return np.stack([x, y, z + sagitta * (1.0 - z / height)], axis=-1)

    return shape


def pressed(upper: HexMesh, lower: HexMesh, tie: RigidTie, planes: str, stiffness: float) -> Model:
    """Two blocks, the lower one held at its bottom, the upper one rigid at its top; `planes` of symmetry at 0."""
    mesh = join({"upper": upper, "lower": lower})
    supports = [Support("lower_z0")]
    for member, fixed in (("upper", "upper_z1"), ("lower", "lower_z0")):
        for plane in planes:
            # a node of a rigid body cannot be held once more
            name = f"{member}_{plane}_plane"
            mesh.node_sets[name] = np.setdiff1d(mesh.node_sets[f"{member}_{plane}0"], mesh.node_sets[fixed])
            supports.append(Support(name, ("xyz".index(plane),)))
    materials = {"upper": STEEL, "lower": STEEL}
    return Model("pressed", mesh, materials, tuple(supports), (tie,), (ContactPair("upper_z0", "lower_z1", stiffness),))
