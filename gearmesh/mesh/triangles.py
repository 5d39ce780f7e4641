"""The triangle mesh that solids, exports, pictures and the roll test exchange: arrays, and nothing that computes gears."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, cross, dot, unit

Index = NDArray[np.int64]
T = TypeVar("T", bound=np.generic)

#: vertices closer to each other, over the largest coordinate, are one: files with single precision take them for one. No farther
#: apart are nodes of the two cuts of a sector, turned onto each other
SAME = 2.5e-7
#: rows of a table that are worked on at once, where all of them would take too much memory
PIECE = 50_000


def facet_normals(vertices: Array, triangles: NDArray[np.int64]) -> Array:
    """Unit normals (T, 3) of the triangles (T, 3) of vertices (V, 3); NaN for those without area."""
    a, b, c = np.moveaxis(vertices[triangles], 1, 0)
    return unit(cross(b - a, c - a))


def closeness(vertices: Array) -> float:
    """How far apart (mm) vertices are that are one."""
    return SAME * float(np.abs(vertices).max())


def without_doubles(vertices: Array, triangles: Index, some: Index) -> tuple[Index, Index]:
    """Triangles with one vertex for all that are next to each other on `some` (K,) of the vertices (V, 3); and which of the
    triangles are left."""
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
    """As `without_doubles` on all vertices if any triangle has no area, as those of a fillet without a radius, which is a line;
    else all of them as they are."""
    a, b, c = np.moveaxis(vertices[triangles], 1, 0)
    area = cross(b - a, c - a)
    if (dot(area, area) <= closeness(vertices) ** 4).any():
        return without_doubles(vertices, triangles, np.arange(len(vertices)))
    return triangles, np.arange(len(triangles))


def pieces(table: NDArray[T], size: int = PIECE) -> Iterator[NDArray[T]]:
    """A table (N, ...) in pieces of so many rows."""
    for start in range(0, len(table), size):
        yield table[start : start + size]


def enclosed_volume(corners: Iterable[Array]) -> float:
    """Volume, mm3, between triangles whose corners come in pieces (K, 3, 3), by the divergence theorem."""
    total = 0.0
    for a, b, c in (np.moveaxis(piece, 1, 0) for piece in corners):
        total += float(np.einsum("ij,ij->", a, np.cross(b, c)))
    return total / 6.0


class Facets(Protocol):
    """Triangles that come in pieces, as writers, bounds and proof take them."""

    @property
    def name(self) -> str:
        """The part's name."""

    @property
    def frame(self) -> str:
        """As of `TriangleMesh`."""

    @property
    def region_names(self) -> tuple[str, ...]:
        """Names of the regions."""

    @property
    def vertex_data(self) -> Mapping[str, Array]:
        """As of `TriangleMesh`."""

    @property
    def vertex_count(self) -> int:
        """Number of vertices."""

    @property
    def triangle_count(self) -> int:
        """Number of triangles."""

    def vertex_pieces(self) -> Iterator[Array]:
        """All vertices in order, in pieces (K, 3), mm."""

    def triangle_pieces(self, regions: Sequence[int] | None = None) -> Iterator[Index]:
        """The triangles of all or some regions in order, in pieces (K, 3) of numbers of vertices."""

    def region_pieces(self) -> Iterator[NDArray[np.int32]]:
        """The regions (K,) of the pieces that `triangle_pieces` makes of all."""

    def corner_pieces(self, regions: Sequence[int] | None = None) -> Iterator[Array]:
        """The corners (K, 3, 3), mm, of the triangles of all or some regions, in the pieces of `triangle_pieces`."""

    def volume(self) -> float:
        """The volume that they enclose, mm3."""

    def move(self, transform: Rigid) -> Facets:
        """The same in another frame, which is called common."""

    def round(self, rounding: Callable[[Array], Array]) -> Facets:
        """The same with rounded coordinates."""

    def whole(self) -> TriangleMesh:
        """Arrays of all of them."""


@dataclass(frozen=True)
class TriangleMesh:
    """Oriented triangles with a region for each.

    `vertices` (V, 3) in mm; `triangles` (T, 3) vertex indices, counterclockwise seen from outside;
    `regions` (T,) indices into `region_names` (flank_left, fillet_left, land, root, ...);
    `normals` (T, 3) unit outward normals: of the exact surface at the cell's centre on flanks and fillets,
    of the facet elsewhere; `frame` says where the coordinates count from: "own", that of the part called `name`, or
    "common", where parts are beside each other.
    """

    vertices: Array
    triangles: NDArray[np.int64]
    regions: NDArray[np.int32]
    region_names: tuple[str, ...]
    normals: Array
    name: str = "gear"
    frame: str = "own"

    def corners(self) -> Array:
        """The corners of all triangles.

        Returns
        -------
        ndarray, (T, 3, 3)
            Triangle, corner, coordinate, mm.

        Examples
        --------
        >>> gears.solid("pinion", 0.05).mesh.corners().shape[1:]
        (3, 3)
        """
        return self.vertices[self.triangles]

    def volume(self) -> float:
        """The volume that it encloses, by the divergence theorem.

        Returns
        -------
        float
            mm^3, negative if inside out.

        Examples
        --------
        >>> gears.solid("pinion", 0.05).mesh.volume() > 0.0
        True
        """
        return enclosed_volume(self.corner_pieces())

    def round(self, rounding: Callable[[Array], Array]) -> TriangleMesh:
        """The mesh with rounded coordinates.

        Parameters
        ----------
        rounding : callable
            From coordinates (N, 3), mm, to rounded ones.

        Returns
        -------
        TriangleMesh
            Its triangles and their normals stay.

        Examples
        --------
        >>> mesh = gears.solid("pinion", 0.05).mesh
        >>> bool(mesh.round(np.rint).vertices.max() == np.rint(mesh.vertices.max()))
        True
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
        """All vertices in order, in pieces.

        Returns
        -------
        iterator of ndarray, (K, 3)
            mm.

        Examples
        --------
        >>> mesh = gears.solid("pinion", 0.05).mesh
        >>> sum(map(len, mesh.vertex_pieces())) == mesh.vertex_count
        True
        """
        yield from pieces(self.vertices)

    def triangle_pieces(self, regions: Sequence[int] | None = None) -> Iterator[Index]:
        """The triangles of all or some regions in order, in pieces.

        Parameters
        ----------
        regions : sequence of int, optional
            Indices into `region_names`.

        Returns
        -------
        iterator of ndarray, (K, 3)
            Numbers of vertices.

        Examples
        --------
        >>> mesh = gears.solid("pinion", 0.05).mesh
        >>> sum(map(len, mesh.triangle_pieces())) == mesh.triangle_count
        True
        """
        yield from pieces(self.triangles if regions is None else self.triangles[np.isin(self.regions, regions)])

    def region_pieces(self) -> Iterator[NDArray[np.int32]]:
        """The regions of the pieces that `triangle_pieces` makes of all.

        Returns
        -------
        iterator of ndarray, (K,)
            Indices into `region_names`.

        Examples
        --------
        >>> mesh = gears.solid("pinion", 0.05).mesh
        >>> sum(map(len, mesh.region_pieces())) == mesh.triangle_count
        True
        """
        yield from pieces(self.regions)

    def corner_pieces(self, regions: Sequence[int] | None = None) -> Iterator[Array]:
        """The corners of the triangles of all or some regions, in the pieces of `triangle_pieces`.

        Parameters
        ----------
        regions : sequence of int, optional
            Indices into `region_names`.

        Returns
        -------
        iterator of ndarray, (K, 3, 3)
            Triangle, corner, coordinate, mm.

        Examples
        --------
        >>> mesh = gears.solid("pinion", 0.05).mesh
        >>> sum(map(len, mesh.corner_pieces())) == mesh.triangle_count
        True
        """
        for piece in self.triangle_pieces(regions):
            yield self.vertices[piece]

    def whole(self) -> TriangleMesh:
        """The mesh itself, as of meshes that have no arrays of all.

        Returns
        -------
        TriangleMesh
            It.

        Examples
        --------
        >>> mesh = gears.solid("pinion", 0.05).mesh
        >>> mesh.whole() is mesh
        True
        """
        return self

    @property
    def vertex_data(self) -> Mapping[str, Array]:
        """Arrays of the vertices, (V,) or (V, 3), by their names, of a mesh that has any; normals as "Normals"."""
        return {}

    def only(self, *names: str) -> TriangleMesh:
        """The part of the mesh in named regions.

        Parameters
        ----------
        names : str
            Of `region_names`.

        Returns
        -------
        TriangleMesh
            Without the vertices that it does not need.

        Examples
        --------
        >>> mesh = gears.solid("pinion", 0.05).mesh
        >>> len(mesh.only("flank_right").triangles) < len(mesh.triangles)
        True
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
        """The same mesh in another frame, which is called common.

        Parameters
        ----------
        transform : Rigid
            From its own frame to the other one.

        Returns
        -------
        TriangleMesh
            Vertices and normals moved; its `frame` is "common".

        Examples
        --------
        >>> mesh = gears.solid("pinion", 0.05).mesh
        >>> mesh.move(gm.Rigid.about_z(0.5)).frame
        'common'
        """
        vertices, normals = transform.point(self.vertices), transform.vector(self.normals)
        return replace(self, vertices=vertices, normals=normals, frame="common")


#: names of a surface's parameters and of the shares along the section and along the face, in files
PARAMETERS = ("p", "v", "s", "t")


@dataclass(frozen=True)
class SurfaceMesh(TriangleMesh):
    """Triangles of open exact surfaces: at every vertex the unit normal (V, 3), and the `PARAMETERS` (V, 4).

    p and v are those of the surface, as its tool generates it; s goes from root to tip, or back on left sides, t from toe to heel,
    both from 0 to 1.
    """

    vertex_normals: Array = field(kw_only=True)
    parameters: Array = field(kw_only=True)

    @property
    def vertex_data(self) -> Mapping[str, Array]:
        return {"Normals": self.vertex_normals, **dict(zip(PARAMETERS, self.parameters.T, strict=True))}

    def move(self, transform: Rigid) -> SurfaceMesh:
        return replace(
            self,
            vertices=transform.point(self.vertices),
            normals=transform.vector(self.normals),
            vertex_normals=transform.vector(self.vertex_normals),
            frame="common",
        )

    @staticmethod
    def join(meshes: Sequence[SurfaceMesh]) -> SurfaceMesh:
        """Surfaces with the same regions beside each other in one."""
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
    """Meshes with the same regions beside each other in one, in the first one's frame and by its name."""
    firsts = np.cumsum([0, *(len(mesh.vertices) for mesh in meshes[:-1])])
    return replace(
        meshes[0],
        vertices=np.concatenate([mesh.vertices for mesh in meshes]),
        triangles=np.concatenate([mesh.triangles + first for mesh, first in zip(meshes, firsts, strict=True)]),
        regions=np.concatenate([mesh.regions for mesh in meshes]),
        normals=np.concatenate([mesh.normals for mesh in meshes]),
    )
