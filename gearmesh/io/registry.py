"""Writers and readers of file formats: a suffix finds the module of a format, which registers them when it is loaded.

To add a format, write a module with a writer and a reader, `register` them there, and name the module in `known`.
"""

from __future__ import annotations

import os
import struct
import zipfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from xml.etree.ElementTree import ParseError

import numpy as np

from gearmesh.errors import OutputError
from gearmesh.files.reading import is_file
from gearmesh.io.atomic import PathLike
from gearmesh.io.known import KNOWN, formats
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.triangles import Facets, TriangleMesh

Scene = Mapping[str, Facets]
Writer = Callable[[Scene, Path], None]
Reader = Callable[[Path], dict[str, TriangleMesh]]


@dataclass(frozen=True)
class MeshFormat:
    """A file format: `write(scene, path)` writes all meshes whole or not at all, `read(path)` gives them back.

    `write` takes meshes as the file holds them, piece by piece where the format lets it.

    Of formats that hold one mesh the scene given to `write` has one.
    `mesh_in_file(mesh)` is the mesh at the precision of the format, what a reader finds of it; `steps(points)` are the steps
    between its numbers at coordinates (N, 3), mm.
    `read` raises ValueError, KeyError or the like for a file that it does not understand.
    """

    write: Writer
    read: Reader
    mesh_in_file: Callable[[Facets], Facets]
    steps: Callable[[Array], Array]


def _exactly(mesh: Facets) -> Facets:
    return mesh


_FORMATS: dict[str, MeshFormat] = {}

# What readers raise for a damaged or foreign file, by way of numpy, struct, zipfile, json and the XML parser.
_UNREADABLE = (ValueError, KeyError, IndexError, TypeError, struct.error, zipfile.BadZipFile, ParseError)


def register(
    suffix: str,
    write: Writer,
    read: Reader,
    mesh_in_file: Callable[[Facets], Facets] = _exactly,
    steps: Callable[[Array], Array] = np.zeros_like,
) -> None:
    """Make the functions of a known format known; `mesh_in_file` and `steps` where it is less than exact."""
    _FORMATS[suffix] = MeshFormat(write, read, mesh_in_file, steps)


def write(mesh: Facets, path: PathLike, *, as_in_file: bool = False) -> None:
    """Write one mesh (mm) in the format that the suffix of `path` names, whole or not at all; `as_in_file`: of `mesh_in_file`.

    Raises OutputError for an unknown suffix and for a file that cannot be written.
    """
    write_scene({mesh.name: mesh}, path, as_in_file=as_in_file)


def write_scene(scene: Scene, path: PathLike, *, as_in_file: bool = False) -> None:
    """Write meshes (mm, already in one common frame) to one file under their keys as names; `as_in_file`: of `mesh_in_file`.

    Raises OutputError as `write` does, for a mesh without triangles, and for several meshes in a format that holds one.
    """
    entry = _format_of(path, "write")
    if not scene:
        raise OutputError("cannot write", path, reason="there is no mesh to write")
    for name, mesh in scene.items():
        if not mesh.triangle_count:
            raise OutputError("cannot write", path, reason=f"the mesh {name} has no triangles")
    if len(scene) > 1 and not KNOWN[_suffix(path)].several:
        able = ", ".join(formats(several=True))
        raise OutputError(
            "cannot write", path, reason=f"{_suffix(path)} holds one mesh, not {len(scene)}; several go into {able}"
        )
    entry.write(scene if as_in_file else {name: entry.mesh_in_file(mesh) for name, mesh in scene.items()}, Path(path))


def mesh_in_file(mesh: Facets, path: PathLike) -> Facets:
    """What a file at `path` holds of a mesh: the mesh itself, or for formats of float32 the one rounded to it.

    Vertices that float32 cannot distinguish are merged or parted there, so that the surface is as closed as it was: what
    is to be proved of a file is proved of this. Raises OutputError for an unknown suffix.
    """
    return _format_of(path, "write").mesh_in_file(mesh)


def most_rounding(points: Array, path: PathLike) -> float:
    """How far (mm) a file moves vertices like these points (N, 3), mm, at most: by half a step of each coordinate."""
    return 0.5 * float(np.linalg.norm(_format_of(path, "write").steps(points), axis=1).max())


def read(path: PathLike) -> TriangleMesh:
    """The mesh in a file, in mm.

    What a format does not keep is completed: one region "surface", normals of the facets. STL corners with equal
    coordinates become one vertex. Raises OutputError for a file that cannot be read or holds several meshes.
    """
    scene = read_scene(path)
    if len(scene) != 1:
        names = ", ".join(scene) or "nothing"
        raise OutputError("cannot read", path, reason=f"it holds {names}")
    return next(iter(scene.values()))


def read_scene(path: PathLike) -> dict[str, TriangleMesh]:
    """All meshes in a file by name, in mm. Raises OutputError for a file that cannot be read."""
    entry = _format_of(path, "read")
    if os.path.exists(path) and not is_file(path):
        raise OutputError("cannot read", path, reason="it is not a regular file")
    try:
        return entry.read(Path(path))
    except OSError as error:
        raise OutputError("cannot read", path, reason=error.strerror or str(error)) from error
    except _UNREADABLE as error:
        detail = " ".join(str(error).split())
        raise OutputError("cannot read", path, reason=f"not a usable {_suffix(path)} file ({detail})") from error


def _suffix(path: PathLike) -> str:
    return Path(path).suffix.lower()


def _format_of(path: PathLike, doing: str) -> MeshFormat:
    suffix = _suffix(path)
    if suffix not in KNOWN:
        fault = f"unknown suffix {suffix}" if suffix else "no suffix"
        raise OutputError(f"cannot {doing}", path, reason=fault, allowed=f"one of {', '.join(KNOWN)}")
    import_module(f"gearmesh.io.meshes.{KNOWN[suffix].module}")
    return _FORMATS[suffix]
