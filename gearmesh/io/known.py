"""Table of the file formats of meshes. It imports no writer or reader: most commands need one of them, or none."""

from __future__ import annotations

from gearmesh.formats import (
    GLB_SUFFIX,
    OBJ_SUFFIX,
    PLY_SUFFIX,
    STL_SUFFIX,
    THREEMF_SUFFIX,
    VTM_SUFFIX,
    VTP_SUFFIX,
    VTU_SUFFIX,
    mesh_contents,
)
from gearmesh.records import dataclass


@dataclass(frozen=True)
class KnownFormat:
    """A file format of meshes."""

    #: module of `gearmesh.io.meshes` with its writer and reader
    module: str
    #: True if one file can hold several meshes
    several: bool = False


#: formats by suffix
KNOWN_FORMATS = {
    GLB_SUFFIX: KnownFormat("glb", several=True),
    OBJ_SUFFIX: KnownFormat("obj", several=True),
    PLY_SUFFIX: KnownFormat("ply"),
    STL_SUFFIX: KnownFormat("stl"),
    THREEMF_SUFFIX: KnownFormat("threemf", several=True),
    VTP_SUFFIX: KnownFormat("vtk"),
    VTU_SUFFIX: KnownFormat("vtk"),
    VTM_SUFFIX: KnownFormat("vtm", several=True),
}


def formats(*, several: bool = False) -> dict[str, str]:
    """Return suffix -> contents in one line, for all formats or for those that hold `several` meshes in a file."""
    return {suffix: mesh_contents(suffix) for suffix, entry in KNOWN_FORMATS.items() if entry.several or not several}
