"""Triangles with their regions and normals: those of the exact surfaces where they are known, of the facets elsewhere."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.triangles import TriangleMesh, facet_normals
from gearmesh.teeth.region import FILLETS, FLANKS, Region

#: regions whose triangles have the normals of the exact surfaces
_EXACT = (*FLANKS.values(), *FILLETS.values())


def labelled_mesh(
    vertices: Array,
    triangles: NDArray[np.int64],
    regions: NDArray[np.int32],
    names: tuple[Region, ...],
    tooth_normals: Array,
    name: str,
) -> TriangleMesh:
    """Mesh with facet normals everywhere but on flanks and fillets, where the given normals of the teeth stay."""
    exact, normals = np.zeros(len(triangles), dtype=bool), np.empty((len(triangles), 3))
    exact[: len(tooth_normals)] = np.array([name in _EXACT for name in names])[regions[: len(tooth_normals)]]
    normals[exact] = tooth_normals[exact[: len(tooth_normals)]]
    normals[~exact] = facet_normals(vertices, triangles[~exact])
    return TriangleMesh(vertices, triangles.astype(np.int64), regions.astype(np.int32), names, normals, name)
