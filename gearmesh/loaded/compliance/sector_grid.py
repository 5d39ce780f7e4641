"""Where the lines of a sector's hexahedra run: crowded where bending is highest, most of all under sharp fillets.

Stress falls steeply under a fillet, over a depth that goes with the fillet's own size, not with the tooth's. Three things were seen
in plane strain against quadrilaterals of second order:

- with even lines from the flank to the middle of the tooth, and under the tooth, involute teeth are 6 to 9 % below their limit;
- where the fillet is small beside the tooth (gears of `circular_arc`, `novikov`, bevel gears) its own depth takes more lines;
- next to a load the stress of long, thin elements goes up and down from node to node of the flank. Where the flank's lowest element
  is as long as the fillet that reaches through all of it: loads at 0.2 and 0.3 of the flank gave 13 % too much and 13 % too little
  in the gear of `modified_involute`, 29 % too much in that of `circular_arc`, and more the thinner the elements.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from gearmesh.mesh.hexahedra.hexahedra import Cells, HexGrid, plain_grid
from gearmesh.mesh.hexahedra.layers import layers
from gearmesh.teeth.region import FILLETS, Side
from gearmesh.teeth.tooth import Tooth

#: lines from the flank to the middle of the tooth crowd under the flank by this power, those of the rim under the tooth by that;
#: bodies with a web have more lines, which crowd less. Involute teeth are 1 to 2 % below their limit in plane strain so
CROWDED, CROWDED_RIM, CROWDED_WEB = 1.8, 2.5, 1.55
#: what a root land counts beside fillets where their elements are shared out: bending is highest in the fillet
LAND = 0.4
#: half the tooth's thickness over the length of its fillet up to which the layers that are asked for do, and how many times as many
#: there are at most
SLENDER, MOST_LAYERS = 2.0, 1.75
#: an eighth of the flank at its lower end over the length of the fillet from which on lines crowd down the flank, and at which they
#: do by the power of 2: its lowest element is an eighth of that eighth then
LONG, LONGEST = 0.3, 0.5
#: how many times as many elements follow each other along the arc of a thread as along a face
LONGER = 2
#: elements of the flank that is meant
EIGHTHS = 8
#: stations, and places on a fillet, at which it is measured
STATIONS, PLACES = 5, 33


@dataclass(frozen=True)
class FilletSize:
    """How large the fillets of one side are, by means over the face, mm: their `length`, half the tooth's thickness at the
    `form_point`, and the height of the flank's lowest `eighth`."""

    length: float
    form_point: float
    eighth: float

    @staticmethod
    def of(tooth: Tooth, side: Side) -> FilletSize:
        t, s = np.linspace(0.0, 1.0, STATIONS), np.linspace(0.0, 1.0, PLACES)
        sections = layers(tooth, t)
        points = sections.grid(FILLETS[side], s).points
        length = np.linalg.norm(np.diff(points, axis=0), axis=-1).sum(axis=0).mean()
        low = sections.flank(side, np.array([0.0, 1.0 / EIGHTHS])).points
        other = sections.flank(side.other, np.array([0.0])).points[0]
        half, eighth = 0.5 * np.linalg.norm(low[0] - other, axis=-1), np.linalg.norm(low[1] - low[0], axis=-1)
        return FilletSize(float(length), float(half.mean()), float(eighth.mean()))

    @property
    def layers(self) -> float:
        """How many times as many layers from flank to middle it takes until the first is as thin beside the fillet as on involute
        teeth: with K of them that is K to the power of -`CROWDED`."""
        return float(np.clip((self.form_point / self.length / SLENDER) ** (1.0 / CROWDED), 1.0, MOST_LAYERS))

    @property
    def power(self) -> float:
        """By which lines crowd down the flank, 1 (evenly) to 2."""
        return 1.0 + float(np.clip((self.eighth / self.length - LONG) / (LONGEST - LONG), 0.0, 1.0))


def sector_grid(tooth: Tooth, side: Side, cells: Cells, rim: float = CROWDED_RIM) -> HexGrid:
    """Lines for the stress in the fillet of a loaded side: `cells` as they are asked for where it is as large as on involute teeth,
    more layers and lines down the flank where it is sharp; in the rim they crowd under the tooth by the power `rim`."""
    size = FilletSize.of(tooth, side)
    face = cells.face if tooth.screw is None else LONGER * cells.face
    grid = crowd(plain_grid(replace(cells, thickness=round(cells.thickness * size.layers), face=face)), rim)
    if size.power == 1.0:
        return grid
    flank = grid.lines.flank**size.power
    return replace(grid, lines=replace(grid.lines, flank=flank), others=flank)


def crowd(grid: HexGrid, rim: float = CROWDED_RIM) -> HexGrid:
    """The grid with lines that crowd under the flanks and, by the power `rim`, under the tooth."""
    lines = grid.lines
    return replace(grid, lines=replace(lines, thickness=lines.thickness**CROWDED, rim=lines.rim**rim, land=LAND))
