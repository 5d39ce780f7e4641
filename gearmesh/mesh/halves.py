"""Rows of teeth of a member as one: each tooth with its images in the other rows, which may share an end section."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from gearmesh.mesh.tessellate import Welded
from gearmesh.records import dataclass
from gearmesh.teeth.blank.halves import HalfEnd, HalfGear

Index = NDArray[np.int64]


@dataclass(frozen=True)
class WeldedHalves:
    """A tooth and its images in all rows (halves)."""

    #: vertices (V, 3), mm, of the tooth, then of its images
    vertices: NDArray[np.float64]
    #: triangles (M, 3) in the same order
    triangles: Index
    #: numbers, for each half, of the tooth's vertices among all vertices; shared vertices occur in several halves
    numbers: tuple[Index, ...]
    #: vertices of the tooth at toe and heel
    tooth_ends: tuple[Index, Index]
    #: vertices of all halves on the line where the tooth meets the tooth before
    first_line: Index

    @staticmethod
    def of(tooth: Welded, halves: tuple[HalfGear, ...]) -> WeldedHalves:
        """Return a tooth with its images in all halves."""
        size, ends = len(tooth.vertices), (tooth.toe, tooth.heel)
        numbers, vertices, count = list[Index](), list[NDArray[np.float64]](), 0
        for half in halves:
            # vertices on a shared end are those of the first half
            unshared = np.ones(size, dtype=bool)
            for end in half.shared:
                unshared[ends[end]] = False
            numbers.append(np.where(unshared, count + np.cumsum(unshared) - 1, np.arange(size)))
            vertices.append(half.points(tooth.vertices[unshared]))
            count += len(vertices[-1])
        here, beyond = tooth.triangles % size, tooth.triangles // size
        triangles = [
            (number[here] + count * beyond)[:, :: half.hand_sign] for number, half in zip(numbers, halves, strict=True)
        ]
        first_line = np.concatenate([number[tooth.firsts[0]] for number in numbers])
        return WeldedHalves(np.concatenate(vertices), np.concatenate(triangles), tuple(numbers), ends, first_line)

    def end(self, end: HalfEnd) -> Index:
        """Return the vertices at an end of a half, in order."""
        half, which = end
        return self.numbers[half][self.tooth_ends[which]]
