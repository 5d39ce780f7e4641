"""Topography of a modified flank: the material removed from it, as a table and as the file that a design reads."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from gearmesh.answers.gearset import GearSet
from gearmesh.answers.result import Result, header
from gearmesh.answers.tables import Listing
from gearmesh.design.core import Design
from gearmesh.design.topography_file import TopographyGrid, topography_text
from gearmesh.errors import ArgumentError
from gearmesh.figures import Content, Figures, Summary, figure
from gearmesh.formats import CSV_SUFFIX, JSON_SUFFIX
from gearmesh.progress import tell
from gearmesh.records import dataclass
from gearmesh.teeth.micro_geometry.modified import modification_of
from gearmesh.teeth.micro_geometry.plane_flank import PlaneFlank
from gearmesh.teeth.micro_geometry.topography_knots import topography_of
from gearmesh.teeth.region import Side

#: default distance between the grid and the flank
DEFAULT_TOLERANCE_MM = 1e-5
#: columns and rows of the table that is shown
SHOWN_KNOTS = 7


def flank_topography(gears: GearSet, name: str, flank: str, tolerance: float = DEFAULT_TOLERANCE_MM) -> FlankTopography:
    """Return the topography of the "right" or "left" flank of a member, within `tolerance` (mm).

    Raises ArgumentError for another flank, for a flank without modifications, and for a tolerance that takes too many
    knots.
    """
    if flank not in tuple(Side):
        raise ArgumentError("flank", flank, must_be=f"one of {', '.join(Side)}")
    member = gears.member(name)
    surface = member.one_tooth.side(Side(flank)).flank
    if isinstance(surface, PlaneFlank):
        raise ArgumentError(
            "member", member.name, reason="a rack's flank has no roll lengths, and a rack takes no topography"
        )
    amount = modification_of(surface)
    if amount is None:
        raise ArgumentError(
            "flank",
            flank,
            reason="this flank has no modification",
            allowed=f"a flank with {member.name}.modifications or {member.name}.modifications_{flank}",
        )
    tell(0.0)
    grid, missed = topography_of(amount, tolerance)
    return FlankTopography(
        gears.design, name, Side(flank), TopographyGrid(grid.lengths, grid.positions, grid.amounts), missed
    )


@dataclass(frozen=True)
class AmountColumns(Figures):
    """Amounts removed from a flank at the knots of a grid."""

    roll_length: list[float] = figure("lengths of roll of the knots", "mm", "L")
    z: list[float] = figure("places of the knots along the axis", "mm", "z")
    amount: list[float] = figure("amounts that are removed, along the normal", "um")


@dataclass(frozen=True)
class TopographyFigures(Figures):
    """The topography of a modified flank."""

    member: str = figure("name of the member")
    flank: str = figure("flank: right or left")
    within: float = figure("largest distance of the spline through the knots and the flank", "um")
    topography: AmountColumns = figure("amounts at the knots")


@dataclass(frozen=True, repr=False)
class FlankTopography(Result):
    """Material removed from a flank at the knots of a grid."""

    #: the design
    design: Design
    #: name of the member
    member: str
    #: the flank
    flank: Side
    #: amounts at the knots
    grid: TopographyGrid
    #: largest distance, mm, of the spline through the knots from the flank
    missed: float

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (CSV_SUFFIX, JSON_SUFFIX)

    @property
    def headline(self) -> str:
        rows, columns = len(self.grid.across), len(self.grid.z)
        most = 1e3 * np.max(self.grid.amounts)
        return f"{self.member}, {self.flank} flank: {rows} x {columns} amounts, up to {most:.4g} um"

    @property
    def listings(self) -> list[Listing]:
        """Table of a few rows and columns of the grid, with the tip at the top."""
        i, j = (
            np.unique(np.linspace(0, len(x) - 1, SHOWN_KNOTS).round().astype(int))
            for x in (self.grid.across, self.grid.z)
        )
        rows = [
            [float(f"{self.grid.across[k]:.5g}"), *(round(1e3 * self.grid.amounts[k][m], 3) for m in j)]
            for k in i[::-1]
        ]
        heads = ["L mm \\ z mm", *(f"{self.grid.z[m]:.4g}" for m in j)]
        grid = f"{len(self.grid.across)} x {len(self.grid.z)} knots, within {1e3 * self.missed:.2g} um"
        return [Listing(f"Material removed (um) from the {self.member}'s {self.flank} flank: {grid}", heads, rows)]

    def to_dict(self) -> dict[str, list[Any]]:
        return self.measured.topography.row

    @property
    def measured(self) -> TopographyFigures:
        """Grid of amounts, row by row, and its largest error."""
        at = np.meshgrid(self.grid.across, self.grid.z, indexing="ij")
        across, z = (coordinate.ravel().tolist() for coordinate in at)
        amounts = AmountColumns(across, z, (1e3 * np.array(self.grid.amounts)).ravel().tolist())
        return TopographyFigures(self.member, str(self.flank), 1e3 * self.missed, amounts)

    @property
    def sections(self) -> Mapping[str, Content]:
        return {**header(self.design), **Summary(self.measured)}

    def _write(self, target: Path) -> None:
        """Write the file that the key `topography` reads."""
        from gearmesh.io.atomic import whole_text

        whole_text(target, topography_text(self.grid))
