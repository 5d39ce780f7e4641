"""Several solids as one body: the union of their triangle meshes, each triangle with its region and normal."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gearmesh.errors import DesignError
from gearmesh.mesh.solid import facets_of, manifold_of
from gearmesh.mesh.triangles import TriangleMesh


def joined_mesh(parts: Sequence[TriangleMesh], name: str) -> tuple[TriangleMesh, int]:
    """Return the union of closed meshes in one frame, and its genus.

    Raises DesignError for parts that do not make one body: they must overlap, or touch in a plane.
    """
    import manifold3d

    first = manifold3d.Manifold.reserve_ids(len(parts))
    bodies = [
        manifold_of(part.vertices, {first + k: part.triangles}, np.arange(len(part.triangles)))
        for k, part in enumerate(parts)
    ]
    union = manifold3d.Manifold.batch_boolean(bodies, manifold3d.OpType.Add)
    pieces = len(union.decompose())
    if union.status().name != "NoError" or pieces != 1:
        raise DesignError(
            name,
            reason=f"{', '.join(part.name for part in parts)} make {pieces} bodies, not one",
            allowed="members that touch or overlap: longer hubs or shafts, or nearer positions",
        )
    vertices, triangles, origin, face = facets_of(union)
    names = tuple(dict.fromkeys(region for part in parts for region in part.region_names))
    regions, normals = np.empty(len(triangles), dtype=np.int32), np.empty((len(triangles), 3))
    for k, part in enumerate(parts):
        own = origin == first + k
        numbers = np.array([names.index(region) for region in part.region_names], dtype=np.int32)
        regions[own] = numbers[part.regions[face[own]]]
        normals[own] = part.normals[face[own]]
    return TriangleMesh(vertices, triangles, regions, names, normals, name), int(union.genus())
