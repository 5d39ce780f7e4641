"""VTK unstructured grid of a model's mesh, with sets as arrays of 0 and 1, for viewers.

Node sets are point data, element sets cell data, each under its name. A face set is cell data too: the sum of 2^face
over the faces (0 .. 5 of `HEX_FACES`) of the element in the set. If an element set has the same name, the name of the
face set ends in _faces.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gearmesh.fe.decks.registry import register
from gearmesh.fe.model import Model
from gearmesh.formats import VTU_SUFFIX
from gearmesh.io.atomic import whole_file
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.hexahedra.hexes import HexMesh


def write(model: Model, path: Path) -> None:
    """Write the mesh and its sets, with the model's notes as a comment at the head."""
    write_mesh(model.mesh, path, notes=model.note_lines)


def write_mesh(
    mesh: HexMesh,
    path: Path,
    point_data: Mapping[str, Array] | None = None,
    notes: Sequence[str] = (),
    cell_data: Mapping[str, Array] | None = None,
) -> None:
    """Write a mesh, its sets, and results by name: (N,) or (N, K) at nodes, (E,) or (E, K) in elements.

    `notes` are lines of a comment at the head.
    """
    import meshio

    points: dict[str, NDArray[np.generic]] = {
        name: members(nodes, len(mesh.nodes)) for name, nodes in mesh.node_sets.items()
    }
    cells: dict[str, NDArray[np.generic]] = {
        name: members(elements, len(mesh.elements)) for name, elements in mesh.element_sets.items()
    }
    for name, faces in mesh.face_sets.items():
        marks = np.zeros(len(mesh.elements), np.uint8)
        np.bitwise_or.at(marks, faces[:, 0], (1 << faces[:, 1]).astype(np.uint8))
        cells[f"{name}_faces" if name in cells else name] = marks
    kind = "hexahedron20" if mesh.second_order else "hexahedron"
    grid = meshio.Mesh(
        mesh.nodes,
        [(kind, mesh.elements)],
        point_data=points | dict(point_data or {}),
        cell_data={name: [values] for name, values in (cells | dict(cell_data or {})).items()},
    )
    with whole_file(path) as temporary:
        grid.write(temporary, file_format="vtu")
        if notes:
            _put_at_head(temporary, notes)


def _put_at_head(path: Path, notes: Sequence[str]) -> None:
    """Insert notes as a comment after the first line, the declaration. A comment of XML must not contain two hyphens in
    a row."""
    declaration, rest = path.read_bytes().split(b"\n", 1)
    comment = "\n".join(notes).replace("--", "- -")
    path.write_bytes(b"\n".join((declaration, f"<!--\n{comment}\n-->".encode(), rest)))


def members(indices: NDArray[np.int64], count: int) -> NDArray[np.uint8]:
    """Return an array (`count`,) of 1 for members of a set and 0 for others."""
    marks = np.zeros(count, np.uint8)
    marks[indices] = 1
    return marks


register("vtu", VTU_SUFFIX, "VTK unstructured grid, sets as point and cell arrays", write)
