"""Meshes from the arrays of a file: vertices are joined again, indices checked, missing normals computed."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gearmesh.kernel.numeric.algebra import Array, cross, dot
from gearmesh.mesh.triangles import TriangleMesh

Indices = NDArray[np.int64]


def facet_normals(corners: Array) -> Array:
    """Unit normals (T, 3) of counterclockwise corners (T, 3, 3); zero for a facet without area."""
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    normal = cross(b - a, c - a)
    length = np.sqrt(dot(normal, normal))
    return normal / np.where(length > 0.0, length, 1.0)[:, None]


def built_mesh(
    name: str,
    vertices: ArrayLike,
    triangles: ArrayLike,
    regions: ArrayLike | None = None,
    region_names: tuple[str, ...] = ("surface",),
    normals: ArrayLike | None = None,
) -> TriangleMesh:
    """Return a mesh from the arrays of a file, checked.

    - vertices: (V, 3), mm.
    - triangles: indices (T, 3) of vertices.
    - regions: indices (T,) of region names; None for one region.
    - normals: unit vectors (T, 3); None for the normals of the facets.

    Raises ValueError without triangles and for indices out of range.
    """
    vertices = np.ascontiguousarray(vertices, dtype=float).reshape(-1, 3)
    triangles = np.ascontiguousarray(triangles, dtype=np.int64).reshape(-1, 3)
    labels = np.zeros(len(triangles), np.int32) if regions is None else np.asarray(regions, dtype=np.int32)
    if not triangles.size:
        raise ValueError("it has no triangles")
    if not (triangles.min() >= 0 and triangles.max() < len(vertices)):
        raise ValueError("a triangle names a vertex that is not there")
    if len(labels) != len(triangles) or not (labels.min() >= 0 and labels.max() < len(region_names)):
        raise ValueError("a triangle names a region that is not there")
    normals = facet_normals(vertices[triangles]) if normals is None else np.asarray(normals, dtype=float).reshape(-1, 3)
    return TriangleMesh(vertices, triangles, labels, region_names, normals, name)


def by_name(meshes: Iterable[TriangleMesh]) -> dict[str, TriangleMesh]:
    """Return the meshes of a file by name; raises ValueError if two have the same name."""
    scene: dict[str, TriangleMesh] = {}
    for mesh in meshes:
        if mesh.name in scene:
            raise ValueError(f"two meshes are named {mesh.name}")
        scene[mesh.name] = mesh
    return scene


def merge(points: NDArray[np.floating]) -> tuple[Array, Indices]:
    """Return the distinct points of (N, 3), in order of first appearance, and the index (N,) of each point among them.

    Points are equal if all coordinates are equal bit by bit, apart from the sign of zero.
    """
    key = np.zeros(len(points), dtype=np.int64)
    for column in points.T:
        # Ranks replace coordinates one axis at a time, so the combined key stays below N^2.
        values, rank = np.unique(column, return_inverse=True)
        _, key = np.unique(key * len(values) + rank, return_inverse=True)
    _, first, group = np.unique(key, return_index=True, return_inverse=True)
    order = np.argsort(first)
    place = np.empty_like(order)
    place[order] = np.arange(len(order))
    return points[first[order]].astype(float), place[group]


def used_part(vertices: Array, triangles: Indices) -> tuple[Array, Indices]:
    """Return the vertices of (V, 3) that triangles (T, 3) use, in their order, and the triangles renumbered."""
    used, renumbered = np.unique(triangles, return_inverse=True)
    return vertices[used], renumbered.reshape(-1, 3)
