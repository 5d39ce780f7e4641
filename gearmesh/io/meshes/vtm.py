"""VTK multi-block VTM: an index file and, in the folder `<stem>_pieces` beside it, a VTP for each region.

One mesh gives one block a region; several give one block a mesh, each with one block a region.
"""

from __future__ import annotations

import os
import re
from pathlib import Path

import numpy as np

from gearmesh.files.xml_tree import xml_root
from gearmesh.formats import VTM_SUFFIX, VTP_SUFFIX
from gearmesh.io.atomic import whole_file, whole_folder
from gearmesh.io.meshes.vtk import read_piece, write_surface
from gearmesh.io.rebuild import built_mesh, merge
from gearmesh.io.registry import Scene, register
from gearmesh.io.texts import quote
from gearmesh.mesh.triangles import TriangleMesh


def write(scene: Scene, path: Path) -> None:
    """Write all meshes; the folder of pieces reaches its place before the index file."""
    pieces = Path(os.path.realpath(path)).with_name(f"{path.stem}_pieces")
    with whole_file(path) as index, whole_folder(pieces, VTP_SUFFIX) as folder:
        blocks = [_write_pieces(mesh.whole(), name, folder, pieces.name) for name, mesh in scene.items()]
        if len(scene) > 1:
            numbered = enumerate(zip(scene, blocks, strict=True))
            blocks = [f'<Block index="{i}" name={quote(name)}>\n{block}</Block>\n' for i, (name, block) in numbered]
        kind = "vtkMultiBlockDataSet"
        head = f'<?xml version="1.0"?>\n<VTKFile type="{kind}" version="1.0" byte_order="LittleEndian">\n<{kind}>\n'
        index.write_text(f"{head}{''.join(blocks)}</{kind}>\n</VTKFile>\n", encoding="utf-8")


def _write_pieces(mesh: TriangleMesh, name: str, folder: Path, shown: str) -> str:
    """Write the regions of a mesh into `folder`; return the <DataSet> elements, with `shown` as the folder's name."""
    elements: list[str] = []
    for i in np.unique(mesh.regions):
        region = mesh.region_names[i]
        file = re.sub(r"[^\w.-]+", "_", f"{name}_{i:02d}_{region}") + VTP_SUFFIX
        write_surface(mesh.only(region), folder / file)
        reference = quote(f"{shown}/{file}")
        elements.append(f'<DataSet index="{len(elements)}" name={quote(region)} file={reference}/>\n')
    return "".join(elements)


def read(path: Path) -> dict[str, TriangleMesh]:
    """Return the meshes of a VTM as this module writes it; equal points of its regions become one vertex again."""
    (root,) = xml_root(path.read_bytes())
    groups = [(block.attrib["name"], block) for block in root.findall("Block")] or [(path.stem, root)]
    return {name: _join(name, [path.parent / piece.attrib["file"] for piece in group]) for name, group in groups}


def _join(name: str, files: list[Path]) -> TriangleMesh:
    """Return the mesh whose regions are the given files."""
    parts = [read_piece(file) for file in files]
    names = parts[0].region_names
    if any(part.region_names != names for part in parts):
        raise ValueError("its pieces name different regions")
    starts = np.cumsum([0, *(len(part.vertices) for part in parts)])
    corners = np.concatenate([part.triangles + start for part, start in zip(parts, starts, strict=False)])
    vertices, place = merge(np.concatenate([part.vertices for part in parts]))
    regions, normals = (np.concatenate([getattr(part, field) for part in parts]) for field in ("regions", "normals"))
    return built_mesh(name, vertices, place[corners], regions, names, normals)


register(VTM_SUFFIX, write, read)
