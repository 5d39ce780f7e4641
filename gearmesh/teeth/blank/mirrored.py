"""The other half of a double helical member: the teeth of the first mirrored in a plane across the axis, and the gap between."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.teeth.blank.body import Body
from gearmesh.teeth.region import Region


@dataclass(frozen=True)
class Mirrored:
    """The second half beyond an end face of the first; lengths in mm, in the own frame of the first half.

    `plane`: z of the plane of symmetry; `near`: z of the first half's end face that looks at it: its heel, or its toe where
    `beyond_heel` is false; `groove`: radius of the cylinder in the gap, None where the halves meet; `body`: the gear body of both.
    """

    plane: float
    near: float
    beyond_heel: bool
    groove: float | None
    body: Body

    def points(self, points: Array) -> Array:
        """Mirrored points (..., 3)."""
        return np.asarray(points * (1.0, 1.0, -1.0) + np.array([0.0, 0.0, 2.0 * self.plane]))

    def beside(self, z: float) -> float | None:
        """Where (z) the first half has the section that the whole has at z; None in the gap."""
        low, high = sorted((self.near, 2.0 * self.plane - self.near))
        if low < z < high:
            return None
        return min(z, 2.0 * self.plane - z)

    @property
    def gap(self) -> Body | None:
        """The cylinder in the gap as a body, from the toe, of either half, that looks into it to the heel; None without a gap."""
        if self.groove is None:
            return None
        ends = (self.groove, self.near), (self.groove, 2.0 * self.plane - self.near)
        return Body(ends[::-1] if self.beyond_heel else ends, (Region.GAP,))

    def volume(self, half: float, body: Body) -> float:
        """Volume (mm^3) of both halves, of that of the first one and its body."""
        gap = 0.0 if self.gap is None else self.gap.cut_off()
        return 2.0 * (half + body.cut_off()) - gap - self.body.cut_off()
