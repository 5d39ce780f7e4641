"""Wavefront OBJ: text in mm with seven decimals, an object for each mesh, a group for each region."""

from __future__ import annotations

import re
from itertools import chain
from pathlib import Path

import numpy as np

from gearmesh.formats import OBJ_SUFFIX
from gearmesh.io.atomic import whole_file
from gearmesh.io.rebuild import Indices, built_mesh, by_name, used_part
from gearmesh.io.registry import Scene, register
from gearmesh.io.single import decimal_steps, in_decimals
from gearmesh.io.texts import lines
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.numerals import parse_numbers, parse_whole_numbers


def write(scene: Scene, path: Path) -> None:
    """Write all meshes; triangles are sorted by region, white space in names becomes an underscore."""
    with whole_file(path) as temporary, open(temporary, "w", encoding="utf-8", newline="\n") as file:
        file.write("# gearmesh, unit mm\n")
        first = 1
        for name, mesh in scene.items():
            file.write(f"o {_word(name)}\n")
            for piece in mesh.vertex_pieces():
                file.writelines(lines("v %r %r %r\n", piece))
            for i, region in enumerate(mesh.region_names):
                file.write(f"g {_word(region)}\n")
                for triangles in mesh.triangle_pieces([i]):
                    file.writelines(lines("f %r %r %r\n", triangles + first))
            first += mesh.vertex_count


def read(path: Path) -> dict[str, TriangleMesh]:
    """Return the meshes of an OBJ of triangles, one for each line `o`; the lines `g` are its regions."""
    text = path.read_text(encoding="utf-8")
    coordinates = [line.split()[:3] for line in re.findall(r"^v[ \t]+(.*)$", text, re.MULTILINE)]
    vertices = np.array(parse_numbers(chain.from_iterable(coordinates))).reshape(-1, 3)
    return by_name(_mesh(name, piece, vertices) for name, piece in _sections("o", path.stem, text))


def _mesh(name: str, text: str, vertices: Array) -> TriangleMesh:
    """Return the mesh of the faces in `text`; groups are regions."""
    groups = _sections("g", "surface", text)
    names = tuple(dict.fromkeys(label for label, _ in groups))
    parts = [_triangles(part) for _, part in groups]
    regions = np.repeat([names.index(label) for label, _ in groups], [len(part) for part in parts])
    return built_mesh(name, *used_part(vertices, np.concatenate(parts)), regions, names)


def _sections(keyword: str, unnamed: str, text: str) -> list[tuple[str, str]]:
    """Return name and following text of each line "keyword name"; faces before the first such line get the name `unnamed`."""
    head, *rest = re.split(rf"^{keyword}[ \t]+(.*?)[ \t\r]*$", text, flags=re.MULTILINE)
    named = list(zip(rest[::2], rest[1::2], strict=True))
    return named if named and not re.search(r"^f[ \t]", head, re.MULTILINE) else [(unnamed, head), *named]


def _triangles(text: str) -> Indices:
    """Vertex indices (T, 3), from 0, of the `f` lines; texture and normal indices are left out."""
    faces = [line.split() for line in re.findall(r"^f[ \t]+(.*)$", re.sub(r"/\S*", "", text), re.MULTILINE)]
    if any(len(face) != 3 for face in faces):
        raise ValueError("a face is not a triangle")
    indices = np.array(parse_whole_numbers(chain.from_iterable(faces)), np.int64).reshape(-1, 3)
    if indices.size and indices.min() < 1:
        raise ValueError("a face counts its vertices from the end")
    return indices - 1


def _word(name: str) -> str:
    """A name as one word: OBJ takes words after the first for further groups."""
    return "_".join(name.split()) or "unnamed"


register(OBJ_SUFFIX, write, read, in_decimals, decimal_steps)
