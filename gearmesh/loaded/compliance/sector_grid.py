"""Grid lines of a sector's hexahedra: crowded where bending stress is high, most of all under sharp fillets.

Stress falls steeply under a fillet, over a depth proportional to the fillet's size and not to the tooth's. Three rules
follow, from plane strain compared with quadrilaterals of second order (see notes.md):

- Lines crowd from the middle of the tooth to the flank, and in the rim towards the tooth.
- A fillet that is small beside the tooth, as on bevel gears, takes more layers.
- Lines crowd down a flank whose lowest element would be as long as the fillet. Next to a load, the stress of long, thin
  elements alternates from node to node of the flank.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from gearmesh.mesh.hexahedra.hexahedra import Cells, HexGrid, plain_grid
from gearmesh.mesh.hexahedra.layers import layers
from gearmesh.records import dataclass
from gearmesh.teeth.region import FILLET_REGIONS, Side
from gearmesh.teeth.tooth import Tooth

#: power by which lines from the flank to the middle of the tooth crowd under the flank
LAYER_POWER = 1.8
#: power by which lines of the rim crowd under the tooth
RIM_POWER = 2.5
#: power for bodies with a web, which have more lines
WEB_RIM_POWER = 1.55
#: weight of a root land beside fillets when elements are shared out: bending stress is highest in the fillet
ROOT_LAND_WEIGHT = 0.4
#: half the tooth's thickness over the length of its fillet, up to which the given number of layers suffices
MAX_SLENDERNESS = 2.0
#: largest factor for the number of layers
MAX_LAYER_FACTOR = 1.75
#: lowest eighth of the flank over the length of the fillet, above which lines crowd down the flank
MIN_CROWDED_EIGHTH = 0.3
#: the same ratio above which they crowd by the power of 2: the lowest element is an eighth of that eighth
MAX_CROWDED_EIGHTH = 0.5
#: factor for the number of elements along the arc of a thread, compared with a face
THREAD_FACE_FACTOR = 2
#: parts of the flank's height of which the lowest is measured
FLANK_EIGHTHS = 8
#: stations along the face at which a fillet is measured
FILLET_STATIONS = 5
#: points on a fillet between which its length is measured
FILLET_PLACES = 33


@dataclass(frozen=True)
class FilletSize:
    """Size of the fillets of one side, in mm, as means over the face."""

    #: length of the fillet
    length: float
    #: half the tooth's thickness at the form point
    form_point: float
    #: height of the flank's lowest eighth
    eighth: float

    @staticmethod
    def of(tooth: Tooth, side: Side) -> FilletSize:
        t, s = np.linspace(0.0, 1.0, FILLET_STATIONS), np.linspace(0.0, 1.0, FILLET_PLACES)
        sections = layers(tooth, t)
        points = sections.grid(FILLET_REGIONS[side], s).points
        length = np.linalg.norm(np.diff(points, axis=0), axis=-1).sum(axis=0).mean()
        flank_ends = sections.flank(side, np.array([0.0, 1.0 / FLANK_EIGHTHS])).points
        opposite = sections.flank(side.other, np.array([0.0])).points[0]
        half_thickness, eighth = (
            0.5 * np.linalg.norm(flank_ends[0] - opposite, axis=-1),
            np.linalg.norm(flank_ends[1] - flank_ends[0], axis=-1),
        )
        return FilletSize(float(length), float(half_thickness.mean()), float(eighth.mean()))

    @property
    def layers(self) -> float:
        """Factor for the number of layers from flank to middle that makes the first layer as thin, relative to the
        fillet, as on involute teeth. K layers have a first layer proportional to K to the power -`LAYER_POWER`."""
        return float(
            np.clip((self.form_point / self.length / MAX_SLENDERNESS) ** (1.0 / LAYER_POWER), 1.0, MAX_LAYER_FACTOR)
        )

    @property
    def power(self) -> float:
        """Power by which lines crowd down the flank, from 1 (equal spacing) to 2."""
        return 1.0 + float(
            np.clip(
                (self.eighth / self.length - MIN_CROWDED_EIGHTH) / (MAX_CROWDED_EIGHTH - MIN_CROWDED_EIGHTH), 0.0, 1.0
            )
        )


def sector_grid(tooth: Tooth, side: Side, cells: Cells, rim: float = RIM_POWER) -> HexGrid:
    """Return grid lines for the stress in the fillet of a loaded side.

    `cells` are used as given if the fillet is as large as on involute teeth. A sharp fillet gets more layers, and lines
    that crowd down the flank. In the rim, lines crowd under the tooth by the power `rim`.
    """
    size = FilletSize.of(tooth, side)
    face = cells.face if tooth.screw is None else THREAD_FACE_FACTOR * cells.face
    grid = crowd(plain_grid(replace(cells, thickness=round(cells.thickness * size.layers), face=face)), rim)
    if size.power == 1.0:
        return grid
    flank = grid.lines.flank**size.power
    return replace(grid, lines=replace(grid.lines, flank=flank), others=flank)


def crowd(grid: HexGrid, rim: float = RIM_POWER) -> HexGrid:
    """Return the grid with lines that crowd under the flanks and, by the power `rim`, under the tooth."""
    lines = grid.lines
    return replace(
        grid, lines=replace(lines, thickness=lines.thickness**LAYER_POWER, rim=lines.rim**rim, land=ROOT_LAND_WEIGHT)
    )
