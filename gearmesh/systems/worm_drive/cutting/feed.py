"""Feed of the hob to its final position, which leaves no trace on the wheel, and the length that it needs.

Tangential feed: the hob moves along its axis, and the wheel turns with it. A hob that has turned by theta and moved by
s has the same position as a hob that has only moved by s + P theta. The wheel has turned by the same angle in both
cases. A fly cutter, or a tooth of a tapered hob, is therefore always inside the rolling rack, or on it. The travel of
the feed replaces the missing teeth.

Radial feed: n is the generating normal, out of the wheel, and x points away from the wheel's axis. The roll of the rack
has d(n . w)/d(phi) = K cos(theta) n_x. It reaches n_x = 0 only after an endless roll, so that n_x > 0 on all of a
generated flank. A hob that is farther away by s clears every point of the flank by the integral of n_x ds. Its approach
therefore removes nothing.
"""

from __future__ import annotations

import numpy as np

from gearmesh.systems.worm_drive.wheel import WormHob
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth

#: number of points from form point to tip at which flanks are evaluated
FLANK_HEIGHTS = 9
#: number of points along the face at which flanks are evaluated
FACE_STATIONS = 33


def generating_length(tooth: Tooth, hob: WormHob) -> float:
    """Return the length (mm) along the hob's axis over which it generates both flanks.

    It is the least thread length of a hob with radial feed, and the least travel of a hob with tangential feed.
    """
    t = np.linspace(0.0, 1.0, FACE_STATIONS)
    axis, travel = hob.place(1).rotation[:, 2], hob.way
    ends = []
    for side in Side:
        grid, generation = tooth.flank_grid(side, np.linspace(0.0, 1.0, FLANK_HEIGHTS), t), tooth.side(side).generation
        assert generation is not None
        flank, (p, v) = generation[0], np.moveaxis(grid.parameters, -1, 0)
        along = flank.tool.jet(*flank.on_tool(p, v)).r @ axis - travel * flank.generating(p, v)[0]
        ends += [along.min(), along.max()]
    return float(max(ends) - min(ends))
