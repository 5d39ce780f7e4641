"""Binary STL: float32 corners in mm, no regions; read by everything that prints or mills.

Readers find the surface by joining equal corners; trimesh, with a tolerance of its own, those within 1e-8.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from gearmesh import __version__
from gearmesh.io.atomic import whole_file
from gearmesh.io.rebuild import built_mesh, facet_normals, merge
from gearmesh.io.registry import Scene, register
from gearmesh.io.single import in_single, steps
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.triangles import Facets, TriangleMesh

_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
# Coordinates below 0.1 mm are multiples of this (mm), a tenth of an atom: apart for readers that join within 1e-8.
_FINEST = 2.0**-26


def write(scene: Scene, path: Path) -> None:
    """Write the one mesh of the scene; facet normals are those of the corners."""
    ((name, mesh),) = scene.items()
    with whole_file(path) as temporary, open(temporary, "wb") as file:
        file.write(_header(name, mesh.frame) + np.uint32(mesh.triangle_count).astype("<u4").tobytes())
        for corners in mesh.corner_pieces():
            facets = np.zeros(len(corners), _FACET)
            facets["corners"] = corners
            facets["normal"] = facet_normals(corners)
            file.write(facets.view(np.uint8).data)


def _header(name: str, frame: str) -> bytes:
    """The first 80 bytes: who wrote the file, its unit, and the frame that it is in."""
    place = f"own frame of {name}" if frame == "own" else f"{name} in the {frame} frame"
    text = f"gearmesh {__version__} mm, {place}"
    # An ASCII file begins with "solid", and some readers look for that word anywhere here.
    return re.sub("(?i)solid", "body", text).encode("ascii", "replace")[:80].ljust(80)


def mesh_in_file(mesh: Facets) -> Facets:
    """The mesh that a file holds: closed where `mesh` is."""
    return in_single(mesh, finest=_FINEST)


def _steps(points: Array) -> Array:
    return steps(points, finest=_FINEST)


def read(path: Path) -> dict[str, TriangleMesh]:
    """The mesh under the file's name; corners with equal coordinates are one vertex."""
    data = path.read_bytes()
    count = int.from_bytes(data[80:84], "little")
    if len(data) != 84 + count * _FACET.itemsize:
        raise ValueError("its length is not that of a binary STL")
    vertices, corner = merge(np.frombuffer(data, _FACET, offset=84)["corners"].reshape(-1, 3))
    return {path.stem: built_mesh(path.stem, vertices, corner)}


register(".stl", write, read, mesh_in_file, _steps)
