"""How the hob gets to where it finishes the wheel: of which the wheel shows nothing.

Fed along its axis, the wheel turning with it: a hob that has turned by theta and moved by s stands where one stands that has moved
by s + P theta alone, and the wheel has turned by as much for either. So at every moment a fly cutter, or a tooth of a tapered hob,
is inside the one rack that rolls, or on it, and the way of the feed makes up for the teeth that are missing.

Fed towards the wheel: with n the generating normal, out of the wheel, and x away from its axis, the roll of the rack has
d(n . w)/d(phi) = K cos(theta) n_x. It reaches n_x = 0 after an endless roll alone, so that on all of a flank that is generated
n_x > 0: a hob that is farther away by s clears every point of it by the integral of n_x ds, and its way in takes nothing.
"""

from __future__ import annotations

import numpy as np

from gearmesh.systems.worm_drive.wheel import WormHob
from gearmesh.teeth.region import Side
from gearmesh.teeth.tooth import Tooth

#: places from form point to tip and along the face at which flanks are looked at
HEIGHTS, STATIONS = 9, 33


def generating_length(tooth: Tooth, hob: WormHob) -> float:
    """Length (mm) along the hob's axis over which it generates both flanks: the least thread of a hob that is fed radially, and
    the least way of one that is fed tangentially."""
    t = np.linspace(0.0, 1.0, STATIONS)
    axis, way = hob.place(1).rotation[:, 2], hob.way
    ends = []
    for which in Side:
        grid, generation = tooth.flank_grid(which, np.linspace(0.0, 1.0, HEIGHTS), t), tooth.side(which).generation
        assert generation is not None
        flank, (p, v) = generation[0], np.moveaxis(grid.parameters, -1, 0)
        along = flank.tool.jet(*flank.on_tool(p, v)).r @ axis - way * flank.generating(p, v)[0]
        ends += [along.min(), along.max()]
    return float(max(ends) - min(ends))
