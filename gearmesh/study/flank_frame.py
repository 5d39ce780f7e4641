"""Where on a flank something lies: length along the face and height from root to tip, mm, from the middle of the flank.

The length is the tooth's station coordinate (z of a cylinder, cone distance of a bevel gear, radius of a face gear), greater
towards the heel; the height is at right angles to it in the axial half plane, greater towards the tip.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.kernel.algebra import Array, dot
from gearmesh.kernel.levels import Level
from gearmesh.teeth.region import Side
from gearmesh.teeth.train import Member

#: points of the outline along each edge
EDGE = 41


@dataclass(frozen=True)
class FlankFrame:
    """The two coordinates of a flank, the signs by which they grow towards heel and tip, and the values (2,) at its middle;
    `outline` (K, 2), mm, closed, and `extent` (2, 2): the least and greatest of both on it."""

    levels: tuple[Level, Level]
    signs: Array
    middle: Array
    outline: Array

    @staticmethod
    def of(member: Member, side: Side) -> FlankFrame:
        """The frame of a member's flank."""
        tooth = member.tooth
        blank = tooth.blank
        levels = (blank.axial, blank.across)

        def values(points: Array) -> Array:
            return np.stack([level.value(points) for level in levels], axis=-1)

        steps = np.linspace(0.0, 1.0, EDGE)
        cross = values(tooth.flank_grid(side, [0.0, 0.5, 1.0], [0.0, 0.5, 1.0]).points)
        signs = np.sign([cross[1, 2, 0] - cross[1, 0, 0], cross[2, 1, 1] - cross[0, 1, 1]])
        along = values(tooth.flank_grid(side, [0.0, 1.0], steps).points)
        up = values(tooth.flank_grid(side, steps, [0.0, 1.0]).points)
        outline = np.concatenate((along[0], up[1:, 1], along[1, -2::-1], up[-2::-1, 0]))
        return FlankFrame(levels, signs, cross[1, 1], signs * (outline - cross[1, 1]))

    @property
    def extent(self) -> Array:
        """Least and greatest length and height on the outline, (2, 2)."""
        return np.stack((self.outline.min(axis=0), self.outline.max(axis=0)))

    def places(self, points: Array) -> Array:
        """Length and height (..., 2), mm, of points (..., 3), the member's own frame."""
        values = np.stack([level.value(points) for level in self.levels], axis=-1)
        return np.asarray(self.signs * (values - self.middle))

    def directions(self, points: Array, vectors: Array) -> Array:
        """Vectors (..., 3) at points (..., 3) in length and height, (..., 2)."""
        parts = [dot(level.gradient(points), vectors) for level in self.levels]
        return np.asarray(self.signs * np.stack(parts, axis=-1))
