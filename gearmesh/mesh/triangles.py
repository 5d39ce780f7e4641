"""Triangle meshes as plain arrays, for solids, exports, pictures and the roll test."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import field, replace
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, cross, dot, unit
from gearmesh.records import dataclass

Index = NDArray[np.int64]
ItemT = TypeVar("ItemT", bound=np.generic)

#: largest distance of vertices that count as one, as a share of the largest coordinate: files in single precision cannot
#: distinguish them, and nodes of the two cuts of a sector, turned onto each other, are no farther apart
SAME_VERTEX_SHARE = 2.5e-7
#: rows of a table in a piece, where the whole table would take too much memory
ROWS_PER_PIECE = 50_000


def facet_normals(vertices: Array, triangles: NDArray[np.int64]) -> Array:
    """Return the unit normals (T, 3) of triangles (T, 3) of vertices (V, 3); NaN for triangles without area."""
    a, b, c = np.moveaxis(vertices[triangles], 1, 0)
    return unit(cross(b - a, c - a))


def closeness(vertices: Array) -> float:
    """Return the largest distance, mm, of vertices that count as one."""
    return SAME_VERTEX_SHARE * float(np.abs(vertices).max())


def without_doubles(vertices: Array, triangles: Index, some: Index) -> tuple[Index, Index]:
    """Return triangles with all vertices close to `some` (K,) of the vertices (V, 3) joined, and the triangles that are left."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    pairs = cKDTree(vertices[some]).sparse_distance_matrix(
        cKDTree(vertices), closeness(vertices), output_type="ndarray"
    )
    graph = coo_array((np.ones(len(pairs)), (some[pairs["i"]], pairs["j"])), shape=(len(vertices),) * 2)
    group = connected_components(graph, directed=False)[1]
    triangles = np.unique(group, return_index=True)[1][group][triangles]
    kept = np.flatnonzero((triangles != np.roll(triangles, 1, axis=1)).all(axis=1))
    return triangles[kept], kept


def with_area(vertices: Array, triangles: Index) -> tuple[Index, Index]:
    """Return triangles without area removed, by `without_doubles` on all vertices, and the triangles that are left.

    A fillet without radius is a line, and its triangles have no area. If all triangles have area, they are returned unchanged.
    """
    a, b, c = np.moveaxis(vertices[triangles], 1, 0)
    area = cross(b - a, c - a)
    if (dot(area, area) <= closeness(vertices) ** 4).any():
        return without_doubles(vertices, triangles, np.arange(len(vertices)))
    return triangles, np.arange(len(triangles))


def pieces(table: NDArray[ItemT], size: int = ROWS_PER_PIECE) -> Iterator[NDArray[ItemT]]:
    """Yield a table (N, ...) in pieces of `size` rows."""
    for start in range(0, len(table), size):
        yield table[start : start + size]


def enclosed_volume(corners: Iterable[Array]) -> float:
    """Return the volume, mm^3, enclosed by triangles with corners in pieces (K, 3, 3), by the divergence theorem."""
    total = 0.0
    for a, b, c in (np.moveaxis(piece, 1, 0) for piece in corners):
        total += float(np.einsum("ij,ij->", a, np.cross(b, c)))
    return total / 6.0


class Facets(Protocol):
    """Triangles in pieces, as writers, bounds and proofs take them."""

    @property
    def name(self) -> str:
        """Name of the part."""

    @property
    def frame(self) -> str:
        """Frame of the coordinates, as in `TriangleMesh`."""

    @property
    def region_names(self) -> tuple[str, ...]:
        """Names of the regions."""

    @property
    def vertex_data(self) -> Mapping[str, Array]:
        """Arrays of the vertices by name, as in `TriangleMesh`."""

    @property
    def vertex_count(self) -> int:
        """Number of vertices."""

    @property
    def triangle_count(self) -> int:
        """Number of triangles."""

    def vertex_pieces(self) -> Iterator[Array]:
        """Yield all vertices in order, in pieces (K, 3), mm."""

    def triangle_pieces(self, regions: Sequence[int] | None = None) -> Iterator[Index]:
        """Yield the triangles of all or some regions in order, in pieces (K, 3) of vertex numbers."""

    def region_pieces(self) -> Iterator[NDArray[np.int32]]:
        """Yield the regions (K,) of the triangles, in the pieces of `triangle_pieces`."""

    def corner_pieces(self, regions: Sequence[int] | None = None) -> Iterator[Array]:
        """Yield the corners (K, 3, 3), mm, of the triangles of all or some regions, in the pieces of `triangle_pieces`."""

    def volume(self) -> float:
        """Return the enclosed volume, mm^3."""

    def move(self, transform: Rigid) -> Facets:
        """Return the triangles in another frame, which is called common."""

    def round(self, rounding: Callable[[Array], Array]) -> Facets:
        """Return the triangles with rounded coordinates."""

    def whole(self) -> TriangleMesh:
        """Return the triangles as one mesh."""


@dataclass(frozen=True)
class TriangleMesh:
    """Oriented triangles with a region for each."""

    #: (V, 3), mm
    vertices: Array
    #: vertex indices (T, 3), counterclockwise seen from outside
    triangles: NDArray[np.int64]
    #: regions (T,), as indices in `region_names`
    regions: NDArray[np.int32]
    #: names of the regions: flank_left, fillet_left, land, root, ...
    region_names: tuple[str, ...]
    #: unit outward normals (T, 3): of the exact surface at the centre on flanks and fillets, of the facet elsewhere
    normals: Array
    #: name of the part
    name: str = "gear"
    #: frame of the coordinates: "own" of the part, or "common" of several parts
    frame: str = "own"

    def corners(self) -> Array:
        """Return the corners of all triangles.

        Result: triangle, corner, coordinate, mm.
        """
        return self.vertices[self.triangles]

    def volume(self) -> float:
        """Return the enclosed volume, by the divergence theorem.

        Result: mm^3, negative if inside out.
        """
        return enclosed_volume(self.corner_pieces())

    def round(self, rounding: Callable[[Array], Array]) -> TriangleMesh:
        """Return the mesh with rounded coordinates.

        `rounding`: function from coordinates (N, 3), mm, to rounded coordinates.
        """
        return replace(self, vertices=rounding(self.vertices))

    @property
    def vertex_count(self) -> int:
        """Number of vertices."""
        return len(self.vertices)

    @property
    def triangle_count(self) -> int:
        """Number of triangles."""
        return len(self.triangles)

    def vertex_pieces(self) -> Iterator[Array]:
        """Yield all vertices in order, in pieces.

        Result: mm.
        """
        yield from pieces(self.vertices)

    def triangle_pieces(self, regions: Sequence[int] | None = None) -> Iterator[Index]:
        """Yield the triangles of all or some regions in order, in pieces."""
        yield from pieces(self.triangles if regions is None else self.triangles[np.isin(self.regions, regions)])

    def region_pieces(self) -> Iterator[NDArray[np.int32]]:
        """Yield the regions of the triangles, in the pieces of `triangle_pieces`."""
        yield from pieces(self.regions)

    def corner_pieces(self, regions: Sequence[int] | None = None) -> Iterator[Array]:
        """Yield the corners of the triangles of all or some regions, in the pieces of `triangle_pieces`.

        Result: triangle, corner, coordinate, mm.
        """
        for piece in self.triangle_pieces(regions):
            yield self.vertices[piece]

    def whole(self) -> TriangleMesh:
        """Return the mesh itself; meshes in pieces return their arrays here."""
        return self

    @property
    def vertex_data(self) -> Mapping[str, Array]:
        """Arrays (V,) or (V, 3) of the vertices by name, if the mesh has any; "Normals" are the normals."""
        return {}

    def only(self, *names: str) -> TriangleMesh:
        """Return the part of the mesh in named regions.

        `names`: names of regions.
        """
        wanted = [i for i, name in enumerate(self.region_names) if name in names]
        keep = np.isin(self.regions, wanted)
        used, triangles = np.unique(self.triangles[keep], return_inverse=True)
        return replace(
            self,
            vertices=self.vertices[used],
            triangles=triangles.reshape(-1, 3).astype(np.int64),
            regions=self.regions[keep],
            normals=self.normals[keep],
        )

    def move(self, transform: Rigid) -> TriangleMesh:
        """Return the mesh in another frame, which is called common.

        `transform`: from the frame of the mesh to the other frame.
        """
        vertices, normals = transform.point(self.vertices), transform.vector(self.normals)
        return replace(self, vertices=vertices, normals=normals, frame="common")


#: names in files of the parameters of a surface, and of the shares along section and face
PARAMETER_NAMES = ("p", "v", "s", "t")


@dataclass(frozen=True)
class SurfaceMesh(TriangleMesh):
    """Triangles of open exact surfaces, with normals and parameters at the vertices."""

    #: unit normals (V, 3) at the vertices
    vertex_normals: Array = field(kw_only=True)
    #: (V, 4): p and v of the surface as its tool generates it; s from root to tip (on left sides from tip to root) and t from
    #: toe to heel, both from 0 to 1
    parameters: Array = field(kw_only=True)

    @property
    def vertex_data(self) -> Mapping[str, Array]:
        """Normals and parameters by name."""
        return {"Normals": self.vertex_normals, **dict(zip(PARAMETER_NAMES, self.parameters.T, strict=True))}

    def move(self, transform: Rigid) -> SurfaceMesh:
        """Return the surfaces in another frame, which is called common."""
        return replace(
            self,
            vertices=transform.point(self.vertices),
            normals=transform.vector(self.normals),
            vertex_normals=transform.vector(self.vertex_normals),
            frame="common",
        )

    @staticmethod
    def join(meshes: Sequence[SurfaceMesh]) -> SurfaceMesh:
        """Return several surfaces with the same regions as one."""
        whole = join(meshes)
        return SurfaceMesh(
            whole.vertices,
            whole.triangles,
            whole.regions,
            whole.region_names,
            whole.normals,
            whole.name,
            whole.frame,
            vertex_normals=np.concatenate([mesh.vertex_normals for mesh in meshes]),
            parameters=np.concatenate([mesh.parameters for mesh in meshes]),
        )


def join(meshes: Sequence[TriangleMesh]) -> TriangleMesh:
    """Return several meshes with the same regions as one, with frame and name of the first."""
    firsts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes[:-1])])
    return replace(
        meshes[0],
        vertices=np.concatenate([mesh.vertices for mesh in meshes]),
        triangles=np.concatenate([mesh.triangles + first for mesh, first in zip(meshes, firsts, strict=True)]),
        regions=np.concatenate([mesh.regions for mesh in meshes]),
        normals=np.concatenate([mesh.normals for mesh in meshes]),
    )
