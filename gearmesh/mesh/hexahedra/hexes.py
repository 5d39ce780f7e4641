"""Meshes of hexahedra for finite-element models: arrays and named sets."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, distinct
from gearmesh.records import dataclass

#: corner nodes of the six faces of a hexahedron, numbered as S1 .. S6 of Abaqus and CalculiX
HEX_FACES = ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0))


#: corner nodes of its twelve edges, in the order of the mid-side nodes 8 .. 19
HEX_EDGES = ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7))


@dataclass(frozen=True)
class HexMesh:
    """Hexahedra with named sets."""

    #: (N, 3), mm
    nodes: Array
    #: node indices (E, 8): bottom counterclockwise seen from the top, then top; or (E, 20) with mid-side nodes in the order of
    #: `HEX_EDGES` (C3D20, VTK's quadratic hexahedron)
    elements: NDArray[np.int64]
    #: node indices (K,) by name
    node_sets: dict[str, NDArray[np.int64]]
    #: element indices (K,) by name
    element_sets: dict[str, NDArray[np.int64]]
    #: (K, 2) by name: element, and face 0 .. 5 of `HEX_FACES`
    face_sets: dict[str, NDArray[np.int64]]

    @property
    def second_order(self) -> bool:
        """True if elements have mid-side nodes."""
        has_middles: bool = self.elements.shape[1] == 20
        return has_middles

    def face_corners(self, name: str) -> NDArray[np.int64]:
        """Return the corner nodes of the faces of a set.

        `name`: name of the face set. Result: nodes (K, 4), counterclockwise seen from outside the element.
        """
        element, face = self.face_sets[name].T
        return np.take_along_axis(self.elements[element], np.array(HEX_FACES)[face][:, ::-1], axis=1)

    def face_outlines(self, name: str) -> NDArray[np.int64]:
        """Return the nodes along the outlines of the faces of a set.

        `name`: name of the face set. Result: nodes (K, 4 or 8), counterclockwise seen from outside: corners, mid-side
        nodes between them.
        """
        corners = np.array(HEX_FACES)[:, ::-1]
        if not self.second_order:
            return self.face_corners(name)
        edges = {frozenset(edge): 8 + k for k, edge in enumerate(HEX_EDGES)}
        outlines = [
            [n for i in range(4) for n in (f[i], edges[frozenset((f[i], f[(i + 1) % 4]))])] for f in corners.tolist()
        ]
        element, face = self.face_sets[name].T
        return np.take_along_axis(self.elements[element], np.array(outlines)[face], axis=1)

    def face_nodes(self, name: str) -> NDArray[np.int64]:
        """Return all nodes of the faces of a set.

        `name`: name of the face set. Result: nodes (K,), rising, each once.
        """
        return distinct(self.face_outlines(name))

    def move(self, transform: Rigid) -> HexMesh:
        """Return the mesh in another frame.

        `transform`: from the frame of the mesh to the other frame.
        """
        return replace(self, nodes=transform.point(self.nodes))


def join(meshes: dict[str, HexMesh]) -> HexMesh:
    """Return several meshes as one, unconnected: sets of the mesh `name` become name_set, its elements the set `name`."""
    nodes, elements, first_node, first_element = [], [], 0, 0
    node_sets, element_sets, face_sets = {}, {}, {}
    for name, mesh in meshes.items():
        nodes.append(mesh.nodes)
        elements.append(mesh.elements + first_node)
        element_sets[name] = first_element + np.arange(len(mesh.elements))
        node_sets.update({f"{name}_{key}": value + first_node for key, value in mesh.node_sets.items()})
        element_sets.update({f"{name}_{key}": value + first_element for key, value in mesh.element_sets.items()})
        face_sets.update(
            {f"{name}_{key}": value + np.array([first_element, 0]) for key, value in mesh.face_sets.items()}
        )
        first_node, first_element = first_node + len(mesh.nodes), first_element + len(mesh.elements)
    return HexMesh(np.concatenate(nodes), np.concatenate(elements), node_sets, element_sets, face_sets)
