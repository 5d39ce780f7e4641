"""Binary PLY: float64 vertices in mm, faces by region, with a comment for each region: number, faces, name.

    comment region 0 1200 flank_left

Faces have no property but their corners: meshio reads a file with a second property wrongly and refuses it.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gearmesh.formats import PLY_SUFFIX
from gearmesh.io.atomic import whole_file
from gearmesh.io.rebuild import built_mesh
from gearmesh.io.registry import Scene, register
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.triangles import Facets, TriangleMesh
from gearmesh.numerals import parse_whole_number, parse_whole_numbers

#: record of a triangle
_FACE_RECORD = np.dtype([("count", "u1"), ("corners", "<i4", 3)])
#: numpy types by their names in PLY
_NUMPY_TYPES = {
    **{
        "char": "i1",
        "uchar": "u1",
        "short": "i2",
        "ushort": "u2",
        "int": "i4",
        "uint": "u4",
        "float": "f4",
        "double": "f8",
    },
    **{"int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4", "float32": "f4"},
    **{"float64": "f8"},
}


def write(scene: Scene, path: Path) -> None:
    """Write the only mesh of the scene; triangles are sorted by region."""
    ((name, mesh),) = scene.items()
    counts = np.sum([np.bincount(piece, minlength=len(mesh.region_names)) for piece in mesh.region_pieces()], axis=0)
    regions = (f"region {i} {counts[i]} {region}" for i, region in enumerate(mesh.region_names))
    comments = ["unit mm", f"name {name}", *regions]
    names, columns = _vertex_columns(mesh)
    header = [
        "ply",
        "format binary_little_endian 1.0",
        *("comment " + " ".join(comment.split()) for comment in comments),
        f"element vertex {mesh.vertex_count}",
        *(f"property double {axis}" for axis in "xyz"),
        *(f"property double {name}" for name in names),
        f"element face {mesh.triangle_count}",
        "property list uchar int vertex_indices",
        "end_header\n",
    ]
    with whole_file(path) as temporary, open(temporary, "wb") as file:
        file.write("\n".join(header).encode())
        first = 0
        for vertices in mesh.vertex_pieces():
            beside = (column[first : first + len(vertices)] for column in columns)
            file.write(np.concatenate((vertices, *beside), axis=1, dtype="<f8").data)
            first += len(vertices)
        for region in range(len(mesh.region_names)):
            for triangles in mesh.triangle_pieces([region]):
                faces = np.empty(len(triangles), _FACE_RECORD)
                faces["count"], faces["corners"] = 3, triangles
                file.write(faces.view(np.uint8).data)


def _vertex_columns(mesh: Facets) -> tuple[list[str], list[Array]]:
    """Return the names and the columns (V, K) of all vertex properties except x, y, z."""
    names, columns = list[str](), list[Array]()
    for name, array in mesh.vertex_data.items():
        names += ["nx", "ny", "nz"] if array.ndim == 2 else [name]
        columns.append(array.reshape(len(array), -1))
    return names, columns


def read(path: Path) -> dict[str, TriangleMesh]:
    """Return the mesh of a binary PLY of triangles; any number types are read."""
    data = path.read_bytes()
    end = data.index(b"end_header")
    body = data.index(b"\n", end) + 1
    header = [line.split(maxsplit=3) for line in data[:end].decode().splitlines()]
    comments = [words[1:] for words in header if words[0] == "comment"]
    elements = _elements(header)
    vertex = np.frombuffer(data, elements["vertex"][1], elements["vertex"][0], body)
    face = np.frombuffer(data, elements["face"][1], elements["face"][0], body + vertex.nbytes)
    if not np.all(face["count"] == 3):
        raise ValueError("a face is not a triangle")
    vertices = np.stack([vertex[axis] for axis in "xyz"], axis=-1)
    name = next((" ".join(words[1:]) for words in comments if words[:1] == ["name"]), path.stem)
    return {name: built_mesh(name, vertices, face["corners"], *_regions(comments, len(face)))}


def _regions(comments: list[list[str]], faces: int) -> tuple[NDArray[np.int64], tuple[str, ...]]:
    """Return the region of each face and the names of regions; one region if the comments do not cover all faces."""
    named = [words[2].split(maxsplit=1) for words in comments if words[:1] == ["region"] and len(words) == 3]
    counts = [
        count
        for words in named
        if len(words) == 2 and (count := parse_whole_number(words[0])) is not None and count >= 0
    ]
    if len(counts) != len(named) or sum(counts) != faces:
        return np.zeros(faces, np.int64), ("surface",)
    return np.repeat(np.arange(len(counts)), counts), tuple(words[1] for words in named)


def _elements(header: list[list[str]]) -> dict[str, tuple[int, np.dtype]]:
    """Return count and record type of each element; the list of a face becomes the fields `count` and `corners`."""
    order = {"binary_little_endian": "<", "binary_big_endian": ">"}[header[1][1]]
    elements: dict[str, tuple[int, list[tuple[Any, ...]]]] = {}
    for words in header[2:]:
        if words[0] == "element":
            elements[words[1]] = (parse_whole_numbers(words[2:3])[0], [])
            fields = elements[words[1]][1]
        elif words[:2] == ["property", "list"]:
            count, (item, _) = words[2], words[3].split()
            fields += [("count", order + _NUMPY_TYPES[count]), ("corners", order + _NUMPY_TYPES[item], 3)]
        elif words[0] == "property":
            fields.append((words[2], order + _NUMPY_TYPES[words[1]]))
    if list(elements)[:2] != ["vertex", "face"]:
        raise ValueError("its elements are not vertex and face")
    return {name: (count, np.dtype(fields)) for name, (count, fields) in elements.items()}


register(PLY_SUFFIX, write, read)
