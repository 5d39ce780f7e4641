"""Part of a load that lies on the outermost cells, next to the edges of the flanks, and the names of these edges."""

from __future__ import annotations

import numpy as np

from gearmesh.contact.flanks import solver_pair
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.loaded.sharing import PairLoad, inside
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import GearPair
from gearmesh.teeth.region import END_FACES

#: largest distance, in cells, from the end of a grid to an edge that lies at that end
EDGE_DISTANCE_CELLS = 2.0
#: level by which the first and last line of cells lie at toe and heel, rather than at an edge that is as near, as at a corner
END_ADVANTAGE_MM = 1e-6
#: least half length along the axis over which the load of a row is spread
MIN_AXIAL_REACH_MM = 1e-6


@dataclass(frozen=True)
class EdgeLoad:
    """Load on the outermost cells next to one edge."""

    #: name of the edge, as "gear_toe"; "" if contact ends with its grid and there is no edge
    edge: str
    #: part (P,) of the pinion's torque on these cells, N mm, at every position
    moment: Array
    #: width of these cells across the edge, mm, mean over their load
    width: float


def edge_loads(gears: GearPair, load: PairLoad, positions: int) -> list[EdgeLoad]:
    """Return the loaded edges under a load at `positions` positions, with the largest part of the torque first.

    The outermost cell of a line of cells belongs to the edge that bounds this line. At an end of the contact where no
    edge bounds the line, the cell belongs to the edge nearest to the contact's middle. An edge over which the tooth
    continues smoothly does not count.
    """
    grid = load.separation
    # moment on the outermost cells of each line of cells across the contact
    outermost = np.where(grid.on & ~inside(grid.on, 1), load.pressure, 0.0)
    moment = outermost.sum(axis=2) * (grid.dx * grid.dy)[:, None] * grid.levers[0]
    # move the first and the last line of cells from their middles to the ends of the grid
    places = grid.places.copy()
    for end, next_to in ((0, 1), (-1, -2)):
        places[:, :, end] += 0.5 * (grid.places[:, :, end] - grid.places[:, :, next_to])
    cell_width = np.repeat(grid.dy[:, None], moment.shape[1], axis=1)
    cell_width[:, [0, -1]] = grid.dx[:, None]
    # a line of cells in between always has an edge, however far away; a line at an end has none beyond this distance
    no_edge = np.full_like(cell_width, -np.inf)
    no_edge[:, [0, -1]] = -EDGE_DISTANCE_CELLS * cell_width[:, [0, -1]]
    names, outside = [""], [no_edge]
    for member, flank, member_places in zip(gears.both, solver_pair(gears).flanks, places, strict=True):
        for name, level in flank.edges.items():
            if name not in flank.smooth:
                names.append(f"{member.name}_{flank.edge_name(name)}")
                levels = np.array(level.value(member_places))
                if name in END_FACES:
                    levels[:, [0, -1]] += END_ADVANTAGE_MM
                outside.append(levels)
    # a line of cells lies at the edge with the largest level: negative inside the flank, positive outside
    nearest = np.argmax(outside, axis=0)
    loads = []
    for k, name in enumerate(names):
        edge_moment = np.where(nearest == k, moment, 0.0)
        if edge_moment.any():
            by_position = np.bincount(load.position, edge_moment.sum(axis=1), positions).astype(float)
            loads.append(EdgeLoad(name, by_position, float((edge_moment * cell_width).sum() / edge_moment.sum())))
    return sorted(loads, key=lambda edge_load: (-edge_load.moment.max(), edge_load.edge))


def load_along_face(load: PairLoad, axis: Array, ends: Array) -> Array:
    """Return the load (2 or 1, S), N, in slices of the face, summed over tooth pairs and positions, of every half.

    - `axis` (3,): the pinion's axis, fixed frame.
    - `ends` (S + 1,): ends of the slices, mm along the axis; points of another half are those of its image.
    """
    grid = load.separation
    rows = load.pressure.sum(axis=2) * (grid.dx * grid.dy)[:, None]
    # every row spreads its load evenly over the part of the axis that it covers
    middle = grid.middle @ axis
    along = np.cross(np.broadcast_to(grid.across[:, None], grid.normal.shape), grid.normal) @ axis
    half = np.maximum(0.5 * grid.dx[:, None] * np.abs(along), MIN_AXIAL_REACH_MM)
    below = np.clip((ends[:, None, None] - middle + half) / (2.0 * half), 0.0, 1.0)
    cumulative = np.stack(
        [(below[:, load.half == k] * rows[load.half == k]).sum(axis=(1, 2)) for k in np.unique(load.half)]
    )
    return np.diff(cumulative, axis=1)
