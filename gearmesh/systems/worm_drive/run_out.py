"""Run-outs of threads: beyond the thread's length the tool is withdrawn, and root, roundings and flanks move away from the axis.

tip  ______________________
                       .  |     height: until next to no flank is left
root ________________.----+
            half     | run-out
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.meridian import Values


@dataclass(frozen=True)
class RunOut:
    """The meridian of the root of a thread of the root radius `root`, full over +-`half`; over the `length` of either run-out it
    rises by `height`, with the third power of the way: its curvature does not jump where it begins. mm.

    One piece, with corners nowhere: meshes of threads with an arc, whose curvature jumps, have twice as many triangles and take
    ten times as long.
    """

    root: float
    half: float
    length: float
    height: float
    corners: tuple[float, ...] = ()

    def at(self, a: Array) -> Values:
        rise, slope, bend = self.rise(a)
        return self.root + rise, slope, bend

    def rise(self, z: Array) -> Values:
        """By how much (mm) all has moved away from the axis at z (...,), mm, and the first two derivatives."""
        share = np.maximum(np.abs(z) - self.half, 0.0) / self.length
        steep = 3.0 * self.height / self.length
        return self.height * share**3, np.sign(z) * steep * share**2, 2.0 * steep / self.length * share
