"""Writers and readers of file formats. A suffix leads to the module of its format, which registers its functions when loaded.

To add a format, write a module with a writer and a reader, `register` them there, and name the module in `known`.
"""

from __future__ import annotations

import os
import struct
import zipfile
from collections.abc import Callable, Mapping
from importlib import import_module
from pathlib import Path

import numpy as np

from gearmesh.errors import OutputError
from gearmesh.files.reading import is_file
from gearmesh.io.atomic import PathLike
from gearmesh.io.known import KNOWN_FORMATS, formats
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.triangles import Facets, TriangleMesh
from gearmesh.records import dataclass

Scene = Mapping[str, Facets]
Writer = Callable[[Scene, Path], None]
Reader = Callable[[Path], dict[str, TriangleMesh]]


@dataclass(frozen=True)
class MeshFormat:
    """Functions of a file format."""

    #: write(scene, path) writes all meshes, whole or not at all; the meshes already have the precision of the format
    write: Writer
    #: read(path) returns the meshes; raises ValueError, KeyError or the like for a file that it does not understand
    read: Reader
    #: mesh_in_file(mesh) returns the mesh with the precision of the format
    mesh_in_file: Callable[[Facets], Facets]
    #: steps(points) returns the steps (N, 3), mm, between the numbers of the format at coordinates (N, 3), mm
    steps: Callable[[Array], Array]


def _exactly(mesh: Facets) -> Facets:
    return mesh


#: formats by suffix, of the modules that are loaded
_REGISTERED_FORMATS: dict[str, MeshFormat] = {}

#: errors that numpy, struct, zipfile, json and the XML parser (SyntaxError) raise for a damaged or foreign file
_READER_ERRORS = (ValueError, KeyError, IndexError, TypeError, struct.error, zipfile.BadZipFile, SyntaxError)


def register(
    suffix: str,
    write: Writer,
    read: Reader,
    mesh_in_file: Callable[[Facets], Facets] = _exactly,
    steps: Callable[[Array], Array] = np.zeros_like,
) -> None:
    """Register the functions of a format; `mesh_in_file` and `steps` only if the format rounds coordinates."""
    _REGISTERED_FORMATS[suffix] = MeshFormat(write, read, mesh_in_file, steps)


def write(mesh: Facets, path: PathLike, *, as_in_file: bool = False) -> None:
    """Write one mesh (mm) in the format of the suffix of `path`, whole or not at all.

    With `as_in_file` the mesh already comes from `mesh_in_file`.
    Raises OutputError for an unknown suffix and for a file that cannot be written.
    """
    write_scene({mesh.name: mesh}, path, as_in_file=as_in_file)


def write_scene(scene: Scene, path: PathLike, *, as_in_file: bool = False) -> None:
    """Write meshes (mm, in one common frame) to one file; their keys are their names.

    With `as_in_file` the meshes already come from `mesh_in_file`.
    Raises OutputError as `write` does, for a mesh without triangles, and for several meshes in a format that holds one.
    """
    entry = _format_of(path, "write")
    if not scene:
        raise OutputError("cannot write", path, reason="there is no mesh to write")
    for name, mesh in scene.items():
        if not mesh.triangle_count:
            raise OutputError("cannot write", path, reason=f"the mesh {name} has no triangles")
    if len(scene) > 1 and not KNOWN_FORMATS[_suffix(path)].several:
        able = ", ".join(formats(several=True))
        raise OutputError(
            "cannot write", path, reason=f"{_suffix(path)} holds one mesh, not {len(scene)}; several go into {able}"
        )
    entry.write(scene if as_in_file else {name: entry.mesh_in_file(mesh) for name, mesh in scene.items()}, Path(path))


def mesh_in_file(mesh: Facets, path: PathLike) -> Facets:
    """Return a mesh with the precision of the format of `path`: formats of float32 and of decimals round coordinates.

    Vertices that the format cannot distinguish are merged or parted, so a closed surface stays closed. Proofs about a file
    are made on this mesh. Raises OutputError for an unknown suffix.
    """
    return _format_of(path, "write").mesh_in_file(mesh)


def most_rounding(points: Array, path: PathLike) -> float:
    """Largest distance (mm) by which a file moves vertices like these points (N, 3), mm: half a step of each coordinate."""
    return 0.5 * float(np.linalg.norm(_format_of(path, "write").steps(points), axis=1).max())


def read(path: PathLike) -> TriangleMesh:
    """Return the mesh of a file, in mm.

    A format without regions gives one region "surface", a format without normals the normals of the facets. STL corners
    with equal coordinates become one vertex. Raises OutputError for a file that cannot be read or holds several meshes.
    """
    scene = read_scene(path)
    if len(scene) != 1:
        names = ", ".join(scene) or "nothing"
        raise OutputError("cannot read", path, reason=f"it holds {names}")
    return next(iter(scene.values()))


def read_scene(path: PathLike) -> dict[str, TriangleMesh]:
    """Return all meshes of a file by name, in mm. Raises OutputError for a file that cannot be read."""
    entry = _format_of(path, "read")
    if os.path.exists(path) and not is_file(path):
        raise OutputError("cannot read", path, reason="it is not a regular file")
    try:
        return entry.read(Path(path))
    except OSError as error:
        raise OutputError("cannot read", path, reason=error.strerror or str(error)) from error
    except _READER_ERRORS as error:
        detail = " ".join(str(error).split())
        raise OutputError("cannot read", path, reason=f"not a usable {_suffix(path)} file ({detail})") from error


def _suffix(path: PathLike) -> str:
    return Path(path).suffix.lower()


def _format_of(path: PathLike, doing: str) -> MeshFormat:
    suffix = _suffix(path)
    if suffix not in KNOWN_FORMATS:
        fault = f"unknown suffix {suffix}" if suffix else "no suffix"
        raise OutputError(f"cannot {doing}", path, reason=fault, allowed=f"one of {', '.join(KNOWN_FORMATS)}")
    import_module(f"gearmesh.io.meshes.{KNOWN_FORMATS[suffix].module}")
    return _REGISTERED_FORMATS[suffix]
