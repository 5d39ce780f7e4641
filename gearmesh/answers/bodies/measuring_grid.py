"""Nominal data for measuring machines: points and normals of the flanks of a member, as a file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from gearmesh import __version__
from gearmesh.answers.gearset import GearSet
from gearmesh.answers.result import Result, header
from gearmesh.answers.tables import Listing
from gearmesh.design.core import Design
from gearmesh.errors import ArgumentError
from gearmesh.figures import Content, Figures, Summary, figure
from gearmesh.formats import JSON_SUFFIX, POINT_SUFFIXES
from gearmesh.metrology.flanks.measuring_grid import MeasuringGrid, refuse_shape, thickness_angle
from gearmesh.metrology.flanks.point_file import point_text
from gearmesh.progress import tell
from gearmesh.records import dataclass
from gearmesh.teeth.blank.body import end_names
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.region import Side

#: value of `flank` for both flanks
BOTH_FLANKS = "both"
#: surfaces that can be measured
MEASURED_SURFACES = ("flank", "fillet", "all")

#: largest diameter of a probe's ball
MAX_BALL_DIAMETER_MM = 1000.0


def measuring_grid_of(
    gears: GearSet,
    name: str,
    flank: str,
    shape: tuple[int, int],
    margins: tuple[float, float],
    surface: str,
    ball: float | None,
) -> MeasuringGrids:
    """Return the grids of the "right" or "left" flank of a member, or of "both"; `ball` is the diameter (mm) of a
    probe's ball.

    Raises ArgumentError for an unknown flank or surface and an invalid ball, and the errors of `MeasuringGrid.of`.
    """
    if flank not in (*Side, BOTH_FLANKS):
        raise ArgumentError("flank", flank, must_be=f"one of {', '.join((*Side, BOTH_FLANKS))}")
    if surface not in MEASURED_SURFACES:
        raise ArgumentError("surface", surface, must_be=f"one of {', '.join(MEASURED_SURFACES)}")
    if ball is not None and not 0.0 < ball <= MAX_BALL_DIAMETER_MM:
        raise ArgumentError(
            "ball", ball, unit="mm", allowed=f"a diameter above 0 and up to {MAX_BALL_DIAMETER_MM:g} mm"
        )
    sides = tuple(Side) if flank == BOTH_FLANKS else (Side(flank),)
    fillets = {"flank": (False,), "fillet": (True,), "all": (False, True)}[surface]
    refuse_shape(shape, margins)
    member = gears.member(name)
    tell(0.0)
    grids = tuple(MeasuringGrid.of(member, side, shape, margins, fillet=fillet) for side in sides for fillet in fillets)
    return MeasuringGrids(gears.design, member, grids, None if ball is None else 0.5 * ball)


Number = TypeVar("Number", int, float)


def numbers_of(
    name: str, given: tuple[Number, Number] | str, between: str, number: Callable[[str], Number | None]
) -> tuple[Number, Number]:
    """Return two numbers, given as numbers or as a text with a mark `between` them.

    Raises ArgumentError for another text.
    """
    if not isinstance(given, str):
        return given
    numbers = [known for text in given.lower().split(between) if (known := number(text)) is not None]
    if len(numbers) != 2 or given.count(between) != 1:
        example = {"x": "5x9", ",": "0.1,0.1"}[between]
        raise ArgumentError(name, given, must_be=f"two numbers, as {example}")
    return numbers[0], numbers[1]


@dataclass(frozen=True)
class PointColumns(Figures):
    """Points of the grids, flank by flank, row by row."""

    flank: list[str] = figure("flank")
    surface: list[str] = figure("flank or fillet")
    grid_row: list[int] = figure("row, from root to tip", key="row", whole=True)
    grid_column: list[int] = figure("column, from toe to heel", key="column", whole=True)
    x: list[float] = figure("points, in the member's own frame", "mm", "x")
    y: list[float] = figure("points, in the member's own frame", "mm", "y")
    z: list[float] = figure("points, in the member's own frame", "mm", "z")
    nx: list[float] = figure("unit normals, out of the material", "", "n_x")
    ny: list[float] = figure("unit normals, out of the material", "", "n_y")
    nz: list[float] = figure("unit normals, out of the material", "", "n_z")


@dataclass(frozen=True)
class MeasuringGridFigures(Figures):
    """Nominal data of the flanks of a member."""

    member: str = figure("name of the member")
    rows: int = figure("rows, from root to tip", whole=True)
    columns: int = figure("columns, from toe to heel", whole=True)
    thickness_angle: float | None = figure(
        "theoretical tooth thickness angle: between the centre points of both flanks", "deg", optional=True
    )
    toe_end: float = figure("least z of the body: an end face that can be the datum", "mm")
    heel_end: float = figure("greatest z of the body", "mm")
    probe_radius: float | None = figure("radius of the probe's ball", "mm", optional=True)
    points: PointColumns = figure("points and normals")


@dataclass(frozen=True, repr=False)
class MeasuringGrids(Result):
    """Points and unit normals of the flanks of one tooth of a member, in its own frame (mm)."""

    #: the design
    design: Design
    #: the member
    member: Member
    #: grids of flanks and fillets
    grids: tuple[MeasuringGrid, ...]
    #: radius of the probe's ball, mm; None without a ball
    probe_radius: float | None = None

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (*POINT_SUFFIXES, JSON_SUFFIX)

    @property
    def headline(self) -> str:
        rows, columns = self.grids[0].shape
        flanks = ", ".join(f"{grid.side} {'fillet' if grid.fillet else 'flank'}" for grid in self.grids)
        return f"{self.member.name}: {rows} x {columns} points of each: {flanks}"

    @property
    def listings(self) -> list[Listing]:
        """Tables of the common figures, and of the points in the middle and at the corners of every flank."""
        common = Summary(self.measured)
        shown = [entry for entry in common.entries if entry.figure.key != "points"]
        rows = []
        for grid in self.grids:
            last_row, last_column = (count - 1 for count in grid.shape)
            for i, j in dict.fromkeys(
                [(last_row // 2, last_column // 2), (0, 0), (0, last_column), (last_row, 0), (last_row, last_column)]
            ):
                point, normal = (values[i, j].round(5).tolist() for values in (grid.points, grid.normals))
                surface = "fillet" if grid.fillet else "flank"
                rows.append([f"{grid.side} {surface} {i + 1},{j + 1}", *point, *normal])
        heads = ("row, column", "x mm", "y mm", "z mm", "n_x", "n_y", "n_z")
        return [
            Listing(f"Measuring grid of the {self.member.name}", ("", ""), [(e.figure.key, e.known) for e in shown]),
            Listing("Points in the middle and at the corners", heads, rows),
        ]

    def to_dict(self) -> dict[str, list[Any]]:
        return self.measured.points.row

    @property
    def measured(self) -> MeasuringGridFigures:
        """All points with the data that they refer to."""
        angle, z = thickness_angle(self.grids), [z for _, z in self.member.body.profile]
        rows, columns = self.grids[0].shape
        indices = [np.indices(grid.shape).reshape(2, -1) + 1 for grid in self.grids]
        points, normals = (
            np.concatenate([getattr(grid, name).reshape(-1, 3) for grid in self.grids])
            for name in ("points", "normals")
        )
        count = rows * columns
        return MeasuringGridFigures(
            self.member.name,
            rows,
            columns,
            None if angle is None else float(np.degrees(angle)),
            float(min(z)),
            float(max(z)),
            self.probe_radius,
            PointColumns(
                [str(grid.side) for grid in self.grids for _ in range(count)],
                ["fillet" if grid.fillet else "flank" for grid in self.grids for _ in range(count)],
                *(np.concatenate([index[k] for index in indices]).tolist() for k in (0, 1)),
                *(column.tolist() for column in (*points.T, *normals.T)),
            ),
        )

    @property
    def comments(self) -> list[str]:
        """Lines in the head of a file."""
        common = self.measured
        first, last = end_names(self.member.tooth.blank.axial)
        lines = [
            f"measuring grid of gearmesh {__version__}: {self.design.title}, {self.member.name}",
            "frame: z is the gear's axis, x through the middle of a tooth at mid face; origin as in the design's drawings",
            f"datum: axis z; end faces of the body from z = {common.toe_end:.9g} mm (toe) to {common.heel_end:.9g} mm (heel)",
            f"rows from root to tip, columns from {first} to {last}; right flank: y < 0; normals point out of the material",
            "units: mm; deviations to add in a column deviation_um, along the normal, positive = more material",
        ]
        if common.thickness_angle is not None:
            lines.append(f"theoretical tooth thickness angle at the centre points: {common.thickness_angle:.9g} deg")
        if self.probe_radius is not None:
            lines.append(f"ball: centres of a probe of radius {self.probe_radius:.9g} mm")
        return lines

    @property
    def sections(self) -> Mapping[str, Content]:
        return {**header(self.design), **Summary(self.measured)}

    def _write(self, target: Path) -> None:
        """Write the file; with a column of deviations added, the table `measured` of a design reads it."""
        from gearmesh.io.atomic import whole_text

        whole_text(target, point_text(self.grids, self.comments, self.probe_radius, target.suffix.lower()))
