"""Triangles with regions and normals: exact normals on flanks and fillets, normals of the facets elsewhere."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.triangles import TriangleMesh, facet_normals
from gearmesh.teeth.region import FILLET_REGIONS, FLANK_REGIONS, Region

#: regions whose triangles have the normals of the exact surfaces
_EXACT_REGIONS = (*FLANK_REGIONS.values(), *FILLET_REGIONS.values())


def labelled_mesh(
    vertices: Array,
    triangles: NDArray[np.int64],
    regions: NDArray[np.int32],
    names: tuple[Region, ...],
    tooth_normals: Array,
    name: str,
) -> TriangleMesh:
    """Return the mesh with exact normals on flanks and fillets and facet normals elsewhere.

    - vertices: (V, 3), mm.
    - triangles: (M, 3), those of the teeth first.
    - regions: indices (M,) in `names`.
    - tooth_normals: exact normals (K, 3) of the triangles of the teeth.
    - name: of the mesh.
    """
    exact, normals = np.zeros(len(triangles), dtype=bool), np.empty((len(triangles), 3))
    exact[: len(tooth_normals)] = np.array([name in _EXACT_REGIONS for name in names])[regions[: len(tooth_normals)]]
    normals[exact] = tooth_normals[exact[: len(tooth_normals)]]
    normals[~exact] = facet_normals(vertices, triangles[~exact])
    return TriangleMesh(vertices, triangles.astype(np.int64), regions.astype(np.int32), names, normals, name)
