"""All teeth around the axis and the numbers of their vertices; teeth may differ from each other.

The vertices of all teeth of one kind form a block. A tooth ends at the first line of the next tooth, of any kind: the first
lines of all kinds have nodes at the same stations.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.mesh.halves import WeldedHalves
from gearmesh.mesh.tessellate import ToothMesh
from gearmesh.records import dataclass
from gearmesh.teeth.blank.halves import HalfGear

Index = NDArray[np.int64]


@dataclass(frozen=True)
class TeethRing:
    """All teeth around the axis."""

    #: the different teeth, in all their halves
    kinds: tuple[WeldedHalves, ...]
    #: kind (teeth,) of every tooth around the axis
    order: Index

    @staticmethod
    def of(meshes: Sequence[ToothMesh], order: Index, halves: tuple[HalfGear, ...]) -> TeethRing:
        """Return the ring of teeth by the meshes of the kinds, whose lines have common stations."""
        rows = max(mesh.end_rows for mesh in meshes)
        return TeethRing(tuple(WeldedHalves.of(mesh.weld(rows), halves) for mesh in meshes), order)

    @property
    def teeth(self) -> int:
        """Number of teeth."""
        return len(self.order)

    @property
    def pitch(self) -> float:
        """Angle (rad) from one tooth to the next."""
        return 2.0 * np.pi / self.teeth

    @property
    def vertices(self) -> Array:
        """Vertices (V, 3) of all teeth, mm, kind by kind."""
        return np.concatenate([self.turn(kind, own.vertices) for kind, own in enumerate(self.kinds)])

    @property
    def triangles(self) -> Index:
        """Triangles (M, 3) of all teeth in the same order."""
        blocks = [self.numbers(kind, own.triangles.ravel()).reshape(-1, 3) for kind, own in enumerate(self.kinds)]
        return np.concatenate(blocks)

    @property
    def size(self) -> int:
        """Number of vertices of all teeth."""
        return int(sum(len(self.kinds[kind].vertices) for kind in self.order))

    def places(self, kind: int) -> Index:
        """Return the teeth (K,) of a kind."""
        return np.flatnonzero(self.order == kind)

    def turn(self, kind: int, vectors: Array, places: Index | None = None) -> Array:
        """Return points or vectors (N, 3) of a tooth at all teeth of its kind, or at some `places`: (K N, 3)."""
        rotation = Rigid.about_z((self.places(kind) if places is None else places) * self.pitch).rotation
        turned: Array = np.einsum("kij,nj->kni", rotation, vectors).reshape(-1, 3)
        return turned

    def numbers(self, kind: int, own: Index, places: Index | None = None) -> Index:
        """Return the numbers (K, N) among all vertices of vertices `own` (N,) of a tooth, at all teeth of a kind or some places."""
        count, places = len(self.kinds[kind].vertices), self.places(kind) if places is None else places
        following, beyond = (places + 1) % self.teeth, own >= count
        numbers = self._firsts[places][:, None] + own % count
        lines = self._lines[self.order[following]][:, self.on_next_line(kind, own[beyond]) - count]
        numbers[:, beyond] = self._firsts[following][:, None] + lines
        return numbers

    def on_next_line(self, kind: int, own: Index) -> Index:
        """Return numbers (...,) for vertices on the next tooth: they count along its first line, after the tooth's vertices."""
        count = len(self.kinds[kind].vertices)
        on_line = np.zeros(count, dtype=np.int64)
        on_line[self._lines[kind]] = np.arange(self._lines.shape[1])
        return count + on_line[own % count]

    def next_lines(self, places: Index) -> Array:
        """Return the vertices (K, N, 3), mm, on the first line of the next tooth, for the teeth at some places."""
        following = (places + 1) % self.teeth
        points = np.empty((len(places), self._lines.shape[1], 3))
        for kind, own in enumerate(self.kinds):
            here = self.order[following] == kind
            points[here] = self.turn(kind, own.vertices[own.first_line], following[here]).reshape(-1, *points.shape[1:])
        return points

    @cached_property
    def _lines(self) -> Index:
        """Vertices (kinds, N) on the first line of each kind."""
        return np.array([kind.first_line for kind in self.kinds])

    @cached_property
    def _firsts(self) -> Index:
        """Number (teeth,) of the first vertex of each tooth."""
        sizes = np.array([len(kind.vertices) for kind in self.kinds])[self.order]
        by_kind = np.argsort(self.order, kind="stable")
        firsts = np.empty(self.teeth, dtype=np.int64)
        firsts[by_kind] = np.cumsum(sizes[by_kind]) - sizes[by_kind]
        return firsts
