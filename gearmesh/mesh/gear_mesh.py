"""A whole gear as its different teeth, where each of them is, and the body under them: all else is made piece by piece.

Twelve million triangles with vertices, regions and normals take 800 MB, one tooth of 160 takes 5. Writers, bounds and proof
need each piece once. `whole` makes the arrays of all, for those who ask for them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.levels import Level
from gearmesh.mesh.body import BodyMesh
from gearmesh.mesh.labelled import labelled_mesh
from gearmesh.mesh.ring import TeethRing
from gearmesh.mesh.triangles import PIECE, TriangleMesh, enclosed_volume, pieces
from gearmesh.teeth.region import Region

Index = NDArray[np.int64]


@dataclass(frozen=True)
class GearMesh:
    """The closed surface of a gear, which repeats its teeth; what it offers beside `whole` is that of `TriangleMesh`.

    ring, body     the teeth, and what closes them
    level          station coordinate of the teeth
    region_names   of teeth, then of bodies
    regions        per kind of tooth the regions (M,) of its triangles, indices into `region_names`
    normals        per kind of tooth the exact normals (M, 3) of its triangles
    body_regions   the regions (N,) of the body's triangles
    moves          transforms from the own frame of the gear to the frame of the mesh, the first one first
    rounding       coordinates as a file holds them, from exact ones
    """

    ring: TeethRing
    body: BodyMesh
    level: Level
    region_names: tuple[Region, ...]
    regions: tuple[NDArray[np.int32], ...]
    normals: tuple[Array, ...]
    body_regions: NDArray[np.int32]
    name: str
    moves: tuple[Rigid, ...] = ()
    rounding: Callable[[Array], Array] | None = None

    @property
    def frame(self) -> str:
        """As of `TriangleMesh`."""
        return "common" if self.moves else "own"

    @property
    def vertex_data(self) -> Mapping[str, Array]:
        """None."""
        return {}

    @property
    def vertex_count(self) -> int:
        """Number of vertices."""
        return self.ring.size + len(self.body.vertices)

    @property
    def triangle_count(self) -> int:
        """Number of triangles."""
        kinds = enumerate(self.ring.kinds)
        return sum(self.ring.places(k).size * len(own.triangles) for k, own in kinds) + len(self.body.triangles)

    def move(self, transform: Rigid) -> GearMesh:
        """The same in another frame, which is called common."""
        return replace(self, moves=(*self.moves, transform))

    def round(self, rounding: Callable[[Array], Array]) -> GearMesh:
        """The same with rounded coordinates."""
        return replace(self, rounding=rounding)

    def vertex_pieces(self) -> Iterator[Array]:
        """All vertices in order, in pieces (K, 3), mm."""
        for kind, own in enumerate(self.ring.kinds):
            for places in self._some_teeth(kind, len(own.vertices)):
                yield self._place(self.ring.turn(kind, own.vertices, places))
        yield self._place(self.body.vertices)

    def triangle_pieces(self, regions: Sequence[int] | None = None) -> Iterator[Index]:
        """The triangles of all or some regions in order, in pieces (K, 3) of numbers of vertices."""
        for kind, triangles in enumerate(self._teeth_of(regions)):
            for places in self._some_teeth(kind, len(triangles)):
                yield self.ring.numbers(kind, triangles.ravel(), places).reshape(-1, 3)
        yield from pieces(self.body.triangles[self._of_body(regions)])

    def region_pieces(self) -> Iterator[NDArray[np.int32]]:
        """The regions (K,) of the pieces that `triangle_pieces` makes of all."""
        for kind, regions in enumerate(self.regions):
            for places in self._some_teeth(kind, len(regions)):
                yield np.tile(regions, len(places))
        yield from pieces(self.body_regions)

    def corner_pieces(self, regions: Sequence[int] | None = None) -> Iterator[Array]:
        """The corners (K, 3, 3), mm, of the triangles of all or some regions, in the pieces of `triangle_pieces`."""
        ring = self.ring
        for kind, (own, triangles) in enumerate(zip(ring.kinds, self._teeth_of(regions), strict=True)):
            # a tooth and the line at which the next one begins
            local = np.where(triangles < len(own.vertices), triangles, ring.on_next_line(kind, triangles))
            for places in self._some_teeth(kind, len(triangles)):
                tooth = ring.turn(kind, own.vertices, places).reshape(len(places), -1, 3)
                points = self._place(np.concatenate((tooth, ring.next_lines(places)), axis=1).reshape(-1, 3))
                first = np.arange(len(places))[:, None, None] * (len(points) // len(places))
                yield points[(local + first).reshape(-1, 3)]
        points, triangles = self._closed_body
        placed = self._place(points)
        for piece in pieces(triangles[self._of_body(regions)]):
            yield placed[piece]

    def volume(self) -> float:
        """The volume that it encloses, mm3."""
        return enclosed_volume(self.corner_pieces())

    def whole(self) -> TriangleMesh:
        """Arrays of all vertices and triangles, and their normals."""
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
        """Points (N, 3) of the own frame where the mesh has them."""
        for transform in self.moves:
            points = transform.point(points)
        return points if self.rounding is None else self.rounding(points)

    def _some_teeth(self, kind: int, size: int) -> Iterator[Index]:
        """The places of a kind in order, as many at once as make a piece where each has so many rows; none without rows."""
        if size:
            yield from pieces(self.ring.places(kind), max(1, PIECE // size))

    def _teeth_of(self, regions: Sequence[int] | None) -> list[Index]:
        """Per kind of tooth its triangles (M, 3) in all or some regions."""
        own = [kind.triangles for kind in self.ring.kinds]
        if regions is None:
            return own
        return [of[np.isin(labels, regions)] for of, labels in zip(own, self.regions, strict=True)]

    def _of_body(self, regions: Sequence[int] | None) -> NDArray[np.bool_]:
        """True for the triangles of the body in all or some regions."""
        return np.ones(len(self.body_regions), dtype=bool) if regions is None else np.isin(self.body_regions, regions)

    @cached_property
    def _closed_body(self) -> tuple[Array, Index]:
        """Vertices (N, 3) of the body and of the teeth next to it, own frame, and the body's triangles between them."""
        used, triangles = np.unique(self.body.triangles, return_inverse=True)
        on_teeth = int(np.searchsorted(used, self.ring.size))
        points = np.empty((len(used), 3))
        points[on_teeth:] = self.body.vertices[used[on_teeth:] - self.ring.size]
        begin = 0
        for kind, own in enumerate(self.ring.kinds):
            size, places = len(own.vertices), self.ring.places(kind)
            end = begin + size * places.size
            low, high = np.searchsorted(used, (begin, end))
            place, vertex = np.divmod(used[low:high] - begin, size)
            needed, which = np.unique(vertex, return_inverse=True)
            turned = self.ring.turn(kind, own.vertices[needed]).reshape(places.size, -1, 3)
            points[low:high] = turned[place, which]
            begin = end
        return points, triangles.reshape(-1, 3)
