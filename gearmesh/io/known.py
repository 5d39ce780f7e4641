"""Table of the file formats of meshes. It imports no writer or reader: most commands need one of them, or none."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class KnownFormat:
    """A file format of meshes."""

    #: module of `gearmesh.io.meshes` with its writer and reader
    module: str
    #: one line for the user
    description: str
    #: True if one file can hold several meshes
    several: bool = False


#: formats by suffix
KNOWN_FORMATS = {
    ".glb": KnownFormat("glb", "binary glTF, metres, float32, a coloured primitive for each region", True),
    ".obj": KnownFormat("obj", "Wavefront OBJ, mm, text with seven decimals, a group for each region", True),
    ".ply": KnownFormat("ply", "binary PLY, mm, float64, faces by region"),
    ".stl": KnownFormat("stl", "binary STL, mm, float32, no regions"),
    ".3mf": KnownFormat("threemf", "3MF, millimetre, seven decimals, a base material for each region", True),
    ".vtp": KnownFormat("vtk", "VTK surface, mm, float64, regions and exact normals of the cells"),
    ".vtu": KnownFormat("vtk", "VTK unstructured grid, mm, float64, regions and exact normals of the cells"),
    ".vtm": KnownFormat(
        "vtm", "VTK multi-block, mm, float64, a block for each region (pieces in a folder beside)", True
    ),
}


def formats(*, several: bool = False) -> dict[str, str]:
    """Return suffix (".stl", ...) -> one line, for all formats or for those that hold `several` meshes in a file."""
    return {suffix: entry.description for suffix, entry in KNOWN_FORMATS.items() if entry.several or not several}
