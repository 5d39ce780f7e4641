"""Broken edges between the teeth and their end faces, as deburring leaves them: how large they are; see `teeth.end_strip`."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class EndChamfer:
    """A chamfer along the whole outline of an end face: `width` on the end face, at right angles to the outline, and `depth` under
    it, mm; or a `rounded` edge between both, an arc where the depth is the width."""

    width: float
    depth: float
    rounded: bool = False

    @property
    def area(self) -> float:
        """What it takes off a section across a straight edge, mm^2: a triangle, or what a quarter of an ellipse leaves of a
        rectangle."""
        return (1.0 - 0.25 * math.pi if self.rounded else 0.5) * self.width * self.depth


#: at toe and heel; None where the edge is sharp
EndChamfers = tuple[EndChamfer | None, EndChamfer | None]
#: sharp edges
SHARP: EndChamfers = (None, None)
