"""Sizes of the broken edges between teeth and end faces, as deburring leaves them; their surface is
`teeth.end_strip`.
"""

from __future__ import annotations

import math

from gearmesh.records import dataclass


@dataclass(frozen=True)
class EndChamfer:
    """Chamfer, or rounding, along the whole outline of an end face.

    `width`: size on the end face, at right angles to the outline, mm. `depth`: size under the end face, mm. `rounded`:
    True for a rounding, an arc if depth and width are equal.
    """

    width: float
    depth: float
    rounded: bool = False

    @property
    def area(self) -> float:
        """Area, mm^2, removed from a section across a straight edge: a triangle, or a rectangle less a quarter of an
        ellipse.
        """
        return (1.0 - 0.25 * math.pi if self.rounded else 0.5) * self.width * self.depth


#: at toe and heel; None where the edge is sharp
EndChamfers = tuple[EndChamfer | None, EndChamfer | None]
#: sharp edges at both ends
SHARP_ENDS: EndChamfers = (None, None)
