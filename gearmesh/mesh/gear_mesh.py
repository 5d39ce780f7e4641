"""Mesh of a whole gear stored as its different teeth, their places and the body; all other arrays are made piece by piece.

Twelve million triangles with vertices, regions and normals take 800 MB; one tooth of 160 takes 5 MB. Writers, bounds and
proofs need each piece once. `whole` makes the arrays of the whole gear.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.levels import Level
from gearmesh.mesh.body import BodyMesh
from gearmesh.mesh.labelled import labelled_mesh
from gearmesh.mesh.ring import TeethRing
from gearmesh.mesh.triangles import ROWS_PER_PIECE, TriangleMesh, enclosed_volume, pieces
from gearmesh.records import dataclass
from gearmesh.teeth.region import Region

Index = NDArray[np.int64]


@dataclass(frozen=True)
class GearMesh:
    """Closed surface of a gear that repeats its teeth, with the methods of `TriangleMesh` and `whole`."""

    #: all teeth
    ring: TeethRing
    #: mesh that closes the teeth
    body: BodyMesh
    #: axial station of points of the teeth
    level: Level
    #: names of the regions of teeth, then of bodies
    region_names: tuple[Region, ...]
    #: regions (M,) of the triangles of each kind of tooth, as indices in `region_names`
    regions: tuple[NDArray[np.int32], ...]
    #: exact normals (M, 3) of the triangles of each kind of tooth
    normals: tuple[Array, ...]
    #: regions (N,) of the triangles of the body
    body_regions: NDArray[np.int32]
    #: name of the mesh
    name: str
    #: transforms from the gear's own frame to the frame of the mesh, in the order of application
    moves: tuple[Rigid, ...] = ()
    #: function that rounds coordinates to those of a file
    rounding: Callable[[Array], Array] | None = None

    @property
    def frame(self) -> str:
        """Frame of the mesh: "own" or "common"."""
        return "common" if self.moves else "own"

    @property
    def vertex_data(self) -> Mapping[str, Array]:
        """Data of vertices: none."""
        return {}

    @property
    def vertex_count(self) -> int:
        """Number of vertices."""
        return self.ring.size + len(self.body.vertices)

    @property
    def triangle_count(self) -> int:
        """Number of triangles."""
        kinds = enumerate(self.ring.kinds)
        return sum(self.ring.places(k).size * len(tooth.triangles) for k, tooth in kinds) + len(self.body.triangles)

    def move(self, transform: Rigid) -> GearMesh:
        """Return the mesh in another frame, which is called common."""
        return replace(self, moves=(*self.moves, transform))

    def round(self, rounding: Callable[[Array], Array]) -> GearMesh:
        """Return the mesh with rounded coordinates."""
        return replace(self, rounding=rounding)

    def vertex_pieces(self) -> Iterator[Array]:
        """Yield all vertices in order, in pieces (K, 3), mm."""
        for kind, tooth in enumerate(self.ring.kinds):
            for places in self._some_teeth(kind, len(tooth.vertices)):
                yield self._place(self.ring.turn(kind, tooth.vertices, places))
        yield self._place(self.body.vertices)

    def triangle_pieces(self, regions: Sequence[int] | None = None) -> Iterator[Index]:
        """Yield the triangles of all or some regions in order, in pieces (K, 3) of vertex numbers."""
        for kind, triangles in enumerate(self._teeth_of(regions)):
            for places in self._some_teeth(kind, len(triangles)):
                yield self.ring.numbers(kind, triangles.ravel(), places).reshape(-1, 3)
        yield from pieces(self.body.triangles[self._of_body(regions)])

    def region_pieces(self) -> Iterator[NDArray[np.int32]]:
        """Yield the regions (K,) of the triangles, in the pieces of `triangle_pieces`."""
        for kind, regions in enumerate(self.regions):
            for places in self._some_teeth(kind, len(regions)):
                yield np.tile(regions, len(places))
        yield from pieces(self.body_regions)

    def corner_pieces(self, regions: Sequence[int] | None = None) -> Iterator[Array]:
        """Yield the corners (K, 3, 3), mm, of the triangles of all or some regions, in the pieces of `triangle_pieces`."""
        ring = self.ring
        for kind, (own_tooth, triangles) in enumerate(zip(ring.kinds, self._teeth_of(regions), strict=True)):
            # vertices of a tooth, then those of the first line of the next tooth
            local = np.where(triangles < len(own_tooth.vertices), triangles, ring.on_next_line(kind, triangles))
            for places in self._some_teeth(kind, len(triangles)):
                tooth = ring.turn(kind, own_tooth.vertices, places).reshape(len(places), -1, 3)
                points = self._place(np.concatenate((tooth, ring.next_lines(places)), axis=1).reshape(-1, 3))
                first = np.arange(len(places))[:, None, None] * (len(points) // len(places))
                yield points[(local + first).reshape(-1, 3)]
        points, triangles = self._closed_body
        placed = self._place(points)
        for piece in pieces(triangles[self._of_body(regions)]):
            yield placed[piece]

    def volume(self) -> float:
        """Return the enclosed volume, mm3."""
        return enclosed_volume(self.corner_pieces())

    def whole(self) -> TriangleMesh:
        """Return the mesh with the arrays of all vertices, triangles and normals."""
        bare, ring = replace(self, moves=(), rounding=None), self.ring
        mesh = labelled_mesh(
            np.concatenate(list(bare.vertex_pieces())),
            np.concatenate(list(self.triangle_pieces())),
            np.concatenate(list(self.region_pieces())),
            self.region_names,
            np.concatenate([ring.turn(kind, normals) for kind, normals in enumerate(self.normals)]),
            self.name,
        )
        for transform in self.moves:
            mesh = mesh.move(transform)
        return mesh if self.rounding is None else replace(mesh, vertices=self.rounding(mesh.vertices))

    def _place(self, points: Array) -> Array:
        """Return points (N, 3) of the gear's own frame in the frame of the mesh, rounded."""
        for transform in self.moves:
            points = transform.point(points)
        return points if self.rounding is None else self.rounding(points)

    def _some_teeth(self, kind: int, size: int) -> Iterator[Index]:
        """Yield the places of a kind in order, in pieces for teeth of `size` rows each; nothing if `size` is 0."""
        if size:
            yield from pieces(self.ring.places(kind), max(1, ROWS_PER_PIECE // size))

    def _teeth_of(self, regions: Sequence[int] | None) -> list[Index]:
        """Return the triangles (M, 3) of each kind of tooth in all or some regions."""
        triangles = [kind.triangles for kind in self.ring.kinds]
        if regions is None:
            return triangles
        return [some[np.isin(labels, regions)] for some, labels in zip(triangles, self.regions, strict=True)]

    def _of_body(self, regions: Sequence[int] | None) -> NDArray[np.bool_]:
        """Return True (N,) for triangles of the body in all or some regions."""
        return np.ones(len(self.body_regions), dtype=bool) if regions is None else np.isin(self.body_regions, regions)

    @cached_property
    def _closed_body(self) -> tuple[Array, Index]:
        """Vertices (N, 3) of the body and of the teeth beside it, in the gear's own frame, and the body's triangles."""
        used, triangles = np.unique(self.body.triangles, return_inverse=True)
        on_teeth = int(np.searchsorted(used, self.ring.size))
        points = np.empty((len(used), 3))
        points[on_teeth:] = self.body.vertices[used[on_teeth:] - self.ring.size]
        begin = 0
        for kind, tooth in enumerate(self.ring.kinds):
            size, places = len(tooth.vertices), self.ring.places(kind)
            end = begin + size * places.size
            low, high = np.searchsorted(used, (begin, end))
            place, vertex = np.divmod(used[low:high] - begin, size)
            needed, which = np.unique(vertex, return_inverse=True)
            turned = self.ring.turn(kind, tooth.vertices[needed]).reshape(places.size, -1, 3)
            points[low:high] = turned[place, which]
            begin = end
        return points, triangles.reshape(-1, 3)
