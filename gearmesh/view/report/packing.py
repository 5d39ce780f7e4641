"""Meshes for a browser: vertices are split at the edges of the surface, arrays are base64 text."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from gearmesh.mesh.triangles import TriangleMesh
from gearmesh.view.offscreen.shapes import corner_normals, region_edges

#: first words of region names with shades of their own; all other regions have the next shade
SHADED_REGIONS = ("flank", "fillet")


def pack(values: ArrayLike, kind: str = "<f4") -> str:
    """Return an array as the base64 text of its little-endian numbers."""
    return base64.b64encode(np.ascontiguousarray(values, dtype=np.dtype(kind)).tobytes()).decode("ascii")


def packed_mesh(mesh: TriangleMesh) -> dict[str, Any]:
    """Return a mesh as packed arrays.

    Positions (V, 3), mm; normals (V, 3) in 1/127; shades (V,); corners (T, 3) and edges (E, 2), 2 bytes each, or 4
    bytes if `wide`.
    """
    normals = np.rint(127.0 * corner_normals(mesh)).astype(np.int64).reshape(-1, 3)
    words = [name.split("_")[0] for name in mesh.region_names]
    shades = np.array(
        [SHADED_REGIONS.index(word) if word in SHADED_REGIONS else len(SHADED_REGIONS) for word in words],
        dtype=np.int64,
    )
    corners = np.column_stack((mesh.triangles.ravel(), np.repeat(shades[mesh.regions], 3), normals))
    vertices, index = np.unique(corners, axis=0, return_inverse=True)
    wide = len(vertices) > np.iinfo(np.uint16).max
    kind = "<u4" if wide else "<u2"
    return {
        "positions": pack(mesh.vertices[vertices[:, 0]]),
        "shades": pack(vertices[:, 1], "u1"),
        "normals": pack(vertices[:, 2:], "i1"),
        "corners": pack(index, kind),
        # any of the vertices that one was split into has its place
        "edges": pack(np.searchsorted(vertices[:, 0], region_edges(mesh)), kind),
        "wide": wide,
    }
