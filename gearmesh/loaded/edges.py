"""How much of a load lies next to the edges of the flanks, and which edges these are."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.contact.flanks import solver_pair
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.loaded.sharing import PairLoad, inside
from gearmesh.teeth.gear_train import GearPair

#: cells away from an edge up to which the end of a grid is at it
NEXT = 2.0


@dataclass(frozen=True)
class EdgeLoad:
    """Load on the outermost cells at one edge: `edge` as "gear_toe", "" where there is none and contact goes on beyond its grid;
    `moment` (P,), part of the torque on the pinion, N mm, at every position; `width`, mm, of these cells across the edge, the mean
    of that load."""

    edge: str
    moment: Array
    width: float


def edge_loads(gears: GearPair, load: PairLoad, positions: int) -> list[EdgeLoad]:
    """The loaded edges under a load at so many positions, the one with the greatest part of the torque first.

    A cell lies at the edge that bounds its line of cells where this is one at an end of the contact, else at the nearest to the
    contact's middle there. Edges over which the tooth goes on smoothly are none.
    """
    grid = load.separation
    outermost = np.where(grid.on & ~inside(grid.on, 1), load.pressure, 0.0)
    moment = outermost.sum(axis=2) * (grid.dx * grid.dy)[:, None] * grid.levers[0]
    # the ends themselves, half a cell beyond the first and the last middle
    places = grid.places.copy()
    for end, next_to in ((0, 1), (-1, -2)):
        places[:, :, end] += 0.5 * (grid.places[:, :, end] - grid.places[:, :, next_to])
    size = np.repeat(grid.dy[:, None], moment.shape[1], axis=1)
    size[:, [0, -1]] = grid.dx[:, None]
    # cells beside others that are on no flank are at an edge, however far from it the middle is; those at ends may be at none
    least = np.full_like(size, -np.inf)
    least[:, [0, -1]] = -NEXT * size[:, [0, -1]]
    names, outside = [""], [least]
    for member, flank, own in zip(gears.both, solver_pair(gears).flanks, places, strict=True):
        for name, level in flank.edges.items():
            if name not in flank.smooth:
                names.append(f"{member.name}_{flank.edge_name(name)}")
                outside.append(level.value(own))
    nearest = np.argmax(outside, axis=0)
    loads = []
    for k, name in enumerate(names):
        own = np.where(nearest == k, moment, 0.0)
        if own.any():
            at = np.bincount(load.position, own.sum(axis=1), positions).astype(float)
            loads.append(EdgeLoad(name, at, float((own * size).sum() / own.sum())))
    return sorted(loads, key=lambda edge_load: (-edge_load.moment.max(), edge_load.edge))
