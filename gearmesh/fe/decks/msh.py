"""Gmsh mesh (MSH 4.1, ASCII): hexahedra, and quadrilaterals on the named faces, with a physical group for each set.

An element of the file belongs to one entity, but sets may overlap. Entities are therefore the combinations of sets that
occur, and each has the groups of its sets. Element sets are groups of volumes, face sets groups of surfaces, node sets
groups of points.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from gearmesh.fe.decks.registry import register
from gearmesh.fe.model import Model
from gearmesh.formats import MSH_SUFFIX
from gearmesh.io.atomic import whole_file
from gearmesh.io.texts import lines
from gearmesh.mesh.hexahedra.hexes import HEX_EDGES, HEX_FACES, HexMesh
from gearmesh.records import dataclass

#: Gmsh's numbers of the element types, by number of nodes
_TYPE_NUMBERS = {1: 15, 4: 3, 8: 5, 20: 17}
#: Gmsh's number of quadrilaterals with eight nodes
_QUAD8_TYPE = 16
#: Gmsh's order of the twelve edges of a hexahedron, as pairs of corners
_GMSH_EDGES = ((0, 1), (0, 3), (0, 4), (1, 2), (1, 5), (2, 3), (2, 6), (3, 7), (4, 5), (4, 7), (5, 6), (6, 7))
#: place in HEX_EDGES of each of these edges
_EDGE_PLACES = [next(i for i, edge in enumerate(HEX_EDGES) if {*edge} == {*wanted}) for wanted in _GMSH_EDGES]


@dataclass(frozen=True)
class _Cells:
    """Elements of one dimension and type."""

    #: dimension of the elements
    dimension: int
    #: Gmsh's number of their type
    type: int
    #: nodes (C, K)
    nodes: NDArray[np.int64]
    #: entity (C,) of each element
    entity: NDArray[np.int64]
    #: groups of each entity 0, 1, ...
    groups: list[list[int]]


def write(model: Model, path: Path) -> None:
    """Write the mesh and its sets."""
    with whole_file(path) as temporary, open(temporary, "w", encoding="utf-8", newline="\n") as file:
        file.writelines(_file(model))


def _file(model: Model) -> Iterator[str]:
    mesh = model.mesh
    cells = _volumes(mesh), _surfaces(mesh), _points(mesh)
    yield "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
    if model.notes:
        yield "$Comments\n" + "".join(f"{line}\n" for line in model.note_lines) + "$EndComments\n"
    names = [(3, mesh.element_sets), (2, mesh.face_sets), (0, mesh.node_sets)]
    yield f"$PhysicalNames\n{sum(len(sets) for _, sets in names)}\n"
    for dimension, sets in names:
        yield from (f'{dimension} {i} "{name}"\n' for i, name in enumerate(sets, 1))
    yield "$EndPhysicalNames\n"
    yield from _entities(mesh, *cells)
    yield from _nodes(mesh)
    yield from _elements(*cells)


def _combinations(marks: NDArray[np.bool_]) -> tuple[NDArray[np.int64], list[list[int]]]:
    """Return the combination (C,) of sets of each member from the membership (sets, C), and the groups of each
    combination."""
    # the combination of a member as one number of as many bytes as the sets fill, in the order of its bits
    packed = np.ascontiguousarray(np.packbits(marks, axis=0).T)
    keys = packed.view(f"V{packed.shape[1]}")[:, 0] if packed.size else np.zeros(len(packed), "V1")
    _, first, combination_of = np.unique(keys, return_index=True, return_inverse=True)
    return combination_of.reshape(-1), [[int(i) + 1 for i in np.flatnonzero(marks[:, member])] for member in first]


def _membership(sets: dict[str, NDArray[np.int64]], count: int) -> NDArray[np.bool_]:
    marks = np.zeros((len(sets), count), bool)
    for row, members in zip(marks, sets.values(), strict=True):
        row[members] = True
    return marks


def _volumes(mesh: HexMesh) -> _Cells:
    entity, groups = _combinations(_membership(mesh.element_sets, len(mesh.elements)))
    nodes = mesh.elements
    if mesh.second_order:
        nodes = np.concatenate([nodes[:, :8], nodes[:, 8:][:, _EDGE_PLACES]], axis=1)
    return _Cells(3, _TYPE_NUMBERS[nodes.shape[1]], nodes, entity, groups)


def _surfaces(mesh: HexMesh) -> _Cells:
    """Return each named face once, by its number among all faces of all elements."""
    numbers = {name: faces @ [len(HEX_FACES), 1] for name, faces in mesh.face_sets.items()}
    face_numbers = np.unique(np.concatenate([np.empty(0, np.int64), *numbers.values()]))
    places = {name: np.searchsorted(face_numbers, number) for name, number in numbers.items()}
    entity, groups = _combinations(_membership(places, len(face_numbers)))
    nodes = np.zeros((len(face_numbers), 8 if mesh.second_order else 4), np.int64)
    for name, place in places.items():
        outline = mesh.face_outlines(name)
        # Gmsh has all corners before all mid-side nodes
        nodes[place] = np.concatenate([outline[:, ::2], outline[:, 1::2]], axis=1) if mesh.second_order else outline
    return _Cells(2, _QUAD8_TYPE if mesh.second_order else _TYPE_NUMBERS[4], nodes, entity, groups)


def _points(mesh: HexMesh) -> _Cells:
    marks = _membership(mesh.node_sets, len(mesh.nodes))
    named = np.flatnonzero(marks.any(axis=0))
    entity, groups = _combinations(marks[:, named])
    return _Cells(0, _TYPE_NUMBERS[1], named[:, None], entity, groups)


def _entities(mesh: HexMesh, volumes: _Cells, surfaces: _Cells, points: _Cells) -> Iterator[str]:
    yield f"$Entities\n{len(points.groups)} 0 {len(surfaces.groups)} {len(volumes.groups)}\n"
    for cells in (points, surfaces, volumes):
        for tag, groups in enumerate(cells.groups, 1):
            corners = mesh.nodes[cells.nodes[cells.entity == tag - 1]].reshape(-1, 3)
            box = [corners.min(axis=0)] if cells.dimension == 0 else [corners.min(axis=0), corners.max(axis=0)]
            numbers = " ".join(f"{x:.16g}" for x in np.concatenate(box))
            boundary = "" if cells.dimension == 0 else " 0"
            yield f"{tag} {numbers} {' '.join(map(str, [len(groups), *groups]))}{boundary}\n"
    yield "$EndEntities\n"


def _nodes(mesh: HexMesh) -> Iterator[str]:
    """Return all nodes as nodes of the first volume; their entity has no meaning here."""
    count = len(mesh.nodes)
    yield f"$Nodes\n1 {count} 1 {count}\n3 1 0 {count}\n"
    yield from lines("%d\n", np.arange(1, count + 1)[:, None])
    yield from lines("%.16g %.16g %.16g\n", mesh.nodes)
    yield "$EndNodes\n"


def _elements(*kinds: _Cells) -> Iterator[str]:
    total = sum(len(cells.nodes) for cells in kinds)
    yield f"$Elements\n{sum(len(cells.groups) for cells in kinds)} {total} 1 {total}\n"
    first = 1
    for cells in kinds:
        for tag in range(1, len(cells.groups) + 1):
            nodes = cells.nodes[cells.entity == tag - 1]
            yield f"{cells.dimension} {tag} {cells.type} {len(nodes)}\n"
            table = np.column_stack([np.arange(first, first + len(nodes)), nodes + 1])
            yield from lines(" ".join(["%d"] * table.shape[1]) + "\n", table)
            first += len(nodes)
    yield "$EndElements\n"


register("gmsh", MSH_SUFFIX, "Gmsh 4.1, sets as physical groups of volumes, surfaces and points", write)
