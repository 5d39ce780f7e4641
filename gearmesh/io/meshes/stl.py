"""Binary STL: float32 corners in mm, no regions; read by everything that prints or mills.

Readers find the surface by joining equal corners; trimesh joins corners within 1e-8.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from gearmesh import __version__
from gearmesh.formats import STL_SUFFIX
from gearmesh.io.atomic import whole_file
from gearmesh.io.rebuild import built_mesh, facet_normals, merge
from gearmesh.io.registry import Scene, register
from gearmesh.io.single import in_single, steps
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.triangles import Facets, TriangleMesh

#: record of a facet, 50 bytes
_FACET_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])
#: coordinates below 0.1 mm are multiples of this, so that readers that join corners within 1e-8 keep them apart
_MIN_STEP_MM = 2.0**-26


def write(scene: Scene, path: Path) -> None:
    """Write the only mesh of the scene; facet normals are computed from the corners."""
    ((name, mesh),) = scene.items()
    with whole_file(path) as temporary, open(temporary, "wb") as file:
        file.write(_header(name, mesh.frame) + np.uint32(mesh.triangle_count).astype("<u4").tobytes())
        for corners in mesh.corner_pieces():
            facets = np.zeros(len(corners), _FACET_RECORD)
            facets["corners"] = corners
            facets["normal"] = facet_normals(corners)
            file.write(facets.view(np.uint8).data)


def _header(name: str, frame: str) -> bytes:
    """Return the first 80 bytes: the program, the unit and the frame of the coordinates."""
    place = f"own frame of {name}" if frame == "own" else f"{name} in the {frame} frame"
    text = f"gearmesh {__version__} mm, {place}"
    # An ASCII file begins with "solid", and some readers look for that word anywhere here.
    return re.sub("(?i)solid", "body", text).encode("ascii", "replace")[:80].ljust(80)


def mesh_in_file(mesh: Facets) -> Facets:
    """Return the mesh with the precision of the file; a closed mesh stays closed."""
    return in_single(mesh, finest=_MIN_STEP_MM)


def _steps(points: Array) -> Array:
    return steps(points, finest=_MIN_STEP_MM)


def read(path: Path) -> dict[str, TriangleMesh]:
    """Return the mesh under the file's name; corners with equal coordinates become one vertex."""
    data = path.read_bytes()
    count = int.from_bytes(data[80:84], "little")
    if len(data) != 84 + count * _FACET_RECORD.itemsize:
        raise ValueError("its length is not that of a binary STL")
    vertices, corner = merge(np.frombuffer(data, _FACET_RECORD, offset=84)["corners"].reshape(-1, 3))
    return {path.stem: built_mesh(path.stem, vertices, corner)}


register(STL_SUFFIX, write, read, mesh_in_file, _steps)
