"""All rows of a member's teeth as one: each tooth with its images in the other rows, which may share an end of the outline."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from gearmesh.mesh.tessellate import Welded
from gearmesh.teeth.blank.halves import HalfEnd, HalfGear

Index = NDArray[np.int64]


@dataclass(frozen=True)
class WeldedHalves:
    """A tooth and its images: vertices (V, 3) and triangles (M, 3), those of the images after those of the tooth in the same order.

    `numbers` (of every half as many as the tooth has vertices): where its vertices are among all; some may be the next tooth's.
    `first_line`: those of all halves where they meet the tooth before.
    """

    vertices: NDArray[np.float64]
    triangles: Index
    numbers: tuple[Index, ...]
    tooth_ends: tuple[Index, Index]
    first_line: Index

    @staticmethod
    def of(one: Welded, halves: tuple[HalfGear, ...]) -> WeldedHalves:
        """Of a tooth in every one of the halves."""
        size, ends = len(one.vertices), (one.toe, one.heel)
        numbers, vertices, count = list[Index](), list[NDArray[np.float64]](), 0
        for half in halves:
            own = np.ones(size, dtype=bool)
            for end in half.shared:
                own[ends[end]] = False
            numbers.append(np.where(own, count + np.cumsum(own) - 1, np.arange(size)))
            vertices.append(half.points(one.vertices[own]))
            count += len(vertices[-1])
        here, beyond = one.triangles % size, one.triangles // size
        triangles = [
            (number[here] + count * beyond)[:, :: half.hand_sign] for number, half in zip(numbers, halves, strict=True)
        ]
        first_line = np.concatenate([number[one.firsts[0]] for number in numbers])
        return WeldedHalves(np.concatenate(vertices), np.concatenate(triangles), tuple(numbers), ends, first_line)

    def end(self, end: HalfEnd) -> Index:
        """Its vertices in order at an end of a half."""
        half, which = end
        return self.numbers[half][self.tooth_ends[which]]
