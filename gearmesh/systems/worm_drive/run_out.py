"""Run-outs of threads: beyond the thread's length the tool is withdrawn, and root, roundings and flanks move away from the axis.

       tip  ______________________
                              .  |     rise: until next to no flank is left
       root ________________.----+
                   half     | run-out
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.meridian import CircularMeridian, Joined, Meridian, MeridianCurve, Straight

#: share of a run-out that its arc goes on beyond the end, where a straight line follows, for whoever looks there
BEYOND = 0.01


@dataclass(frozen=True)
class RunOut:
    """The root of a thread of the root radius `root`, full over +-`half`, that rises by `height` over the `length` of either run-out
    in an arc tangent to the root cylinder; mm."""

    root: float
    half: float
    length: float
    height: float

    @property
    def radius(self) -> float:
        """Radius of the arc, mm."""
        return 0.5 * (self.length**2 + self.height**2) / self.height

    @cached_property
    def root_level(self) -> Meridian:
        """The root as a surface of revolution."""
        far, radius = (1.0 + BEYOND) * self.length, self.radius
        slope = far / math.sqrt(radius**2 - far**2)
        low = self.root + radius - math.sqrt(radius**2 - far**2)
        curves: list[MeridianCurve] = [Straight(self.root)]
        for end in (-1.0, 1.0):
            arc = CircularMeridian((end * self.half, self.root + radius), radius)
            line = Straight(low - slope * (self.half + far), end * slope)
            curves = [line, arc, *curves] if end < 0.0 else [*curves, arc, line]
        corners = (-self.half - far, -self.half, self.half, self.half + far)
        return Meridian(Joined(tuple(curves), corners))

    def rise(self, z: Array) -> tuple[Array, Array, Array]:
        """By how much (mm) all has moved away from the axis at z (...,), mm, and the first two derivatives."""
        height, slope, bend = self.root_level.curve.at(z)
        return height - self.root, slope, bend
