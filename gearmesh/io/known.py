"""Which file formats there are, without the modules that write and read them: most commands need one, or none."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class KnownFormat:
    """The module of `gearmesh.io.meshes` that has a format, a line about it, and whether one file can hold `several` meshes."""

    module: str
    description: str
    several: bool = False


#: formats by their suffixes
KNOWN = {
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
    """Suffix (".stl", ...) -> one line about the format, for every format that can be written, or that holds `several` meshes."""
    return {suffix: entry.description for suffix, entry in KNOWN.items() if entry.several or not several}
