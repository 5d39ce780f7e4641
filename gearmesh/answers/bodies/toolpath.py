"""Tool paths: finishing of spaces between teeth with a ball-end cutter on a five-axis machine, with proved results."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from gearmesh.answers.gearset import GearSet
from gearmesh.answers.result import Result, header
from gearmesh.answers.tables import Listing, figures
from gearmesh.deprecated import Deprecated
from gearmesh.design.core import Design
from gearmesh.errors import ArgumentError
from gearmesh.figures import Content, Figures, Summary, figure
from gearmesh.formats import CLS_SUFFIX, CSV_SUFFIX, JSON_SUFFIX, TOOL_PATH_SUFFIXES, VTP_SUFFIX
from gearmesh.records import dataclass
from gearmesh.toolpath.ball import BallCutter
from gearmesh.toolpath.motion import ToolMotion
from gearmesh.toolpath.order import PathOrder
from gearmesh.toolpath.toolpath import ToolPath, tool_path

#: smallest and largest feed, mm/min
FEED_RANGE = (1e-3, 1e6)
#: default feed, mm/min
DEFAULT_FEED = 500.0
#: columns that repeat x, y and z with their meaning and unit: the lowest point of the ball
TIP_COLUMNS = ("tip_x_mm", "tip_y_mm", "tip_z_mm")
#: columns of a CSV file
CSV_COLUMNS = (
    "space",
    "pass",
    "rapid",
    "x",
    "y",
    "z",
    "i",
    "j",
    "k",
    "contact_x",
    "contact_y",
    "contact_z",
    *TIP_COLUMNS,
)


@dataclass(frozen=True)
class PathAngles(Figures):
    """Angles of the tool axis over all passes."""

    tilt_min: float = figure("least tilt of the tool axis from the middle of the space, away from the own flank", "deg")
    tilt_max: float = figure("largest tilt of the tool axis", "deg")
    lead_min: float = figure("least lead of the tool axis, towards the heel", "deg")
    lead_max: float = figure("largest lead of the tool axis", "deg")


@dataclass(frozen=True)
class SurfaceLeft(Figures):
    """Material that a tool path leaves on one surface of the space."""

    region: str = figure("surface of the space")
    passes: int = figure("passes over it", whole=True)
    left_max: float = figure("largest height of the finished surface over the exact one, less the stock", "um")
    left_min: float = figure("least height; negative is a gouge", "um")


@dataclass(frozen=True)
class ToolPathFigures(Figures):
    """A tool path of a ball-end cutter, as it was planned and proved."""

    member: str = figure("name of the member")
    ball_diameter: float = figure("diameter of the ball", "mm", "D")
    largest_diameter: float = figure("diameter of the largest ball that fits", "mm")
    largest_by: str = figure("what limits it")
    shank_length: float = figure("length of the shank beyond the ball's centre", "mm", "L")
    shank_clearance: float = figure(
        "least distance of shank and holder from the teeth, where it is less than a quarter of their radii", "mm"
    )
    passes: int = figure("passes in one space", whole=True)
    points: int = figure("positions of the tool in all spaces", whole=True)
    spaces: int = figure("spaces that are cut", whole=True)
    length: float = figure("way of the tip at feed, in one space", "mm")
    step_over_min: float = figure("least distance of neighbouring passes", "mm", "s")
    step_over_max: float = figure("largest distance of neighbouring passes", "mm")
    scallop: float = figure("largest height that was allowed, chords included", "um", "h")
    chord: float = figure("what of it chords were allowed", "um")
    stock: float = figure("stock that is left on purpose", "um")
    left_max: float = figure("largest height of the finished surface over the exact one, less the stock", "um")
    left_min: float = figure("least height; negative is a gouge", "um")
    gouge: float = figure("deepest gouge anywhere, also of lands and other teeth", "um")
    measured_points: int = figure("points of exact surfaces at which heights and gouges were measured", whole=True)
    angles: PathAngles = figure("angles of the tool axis", key="", parts=PathAngles)
    surfaces: list[SurfaceLeft] = figure("what is left on each surface", shown=False)
    holder_diameter: float | None = figure("diameter of the holder", "mm", optional=True, default=None)


@dataclass(frozen=True, repr=False)
class ToolPathAnswer(Result):
    """Passes of a ball-end cutter through spaces of a member, in its own frame (mm), and the material that they leave.

    `motion` has the positions as arrays.
    """

    #: the design
    design: Design
    #: name of the member
    member: str
    #: the planned and proved path
    _path: ToolPath
    #: requested path
    order: PathOrder
    #: feed, mm/min
    feed: float = DEFAULT_FEED
    path = Deprecated("_path", "0.19.0", "`motion` has the positions, `measured` what was proved of them")

    @property
    def motion(self) -> ToolMotion:
        """All positions of the tool, through all spaces that are cut."""
        return self._path.whole

    @property
    def suffixes(self) -> tuple[str, ...]:
        """Suffixes of the files that `save` writes."""
        return (*TOOL_PATH_SUFFIXES, JSON_SUFFIX)

    @property
    def measured(self) -> ToolPathFigures:
        """All figures."""
        path, left, budget = self._path, self._path.left, self.order.budget
        step_over, um = path.passes.step_over, 1e3
        tilt, lead = (np.degrees(angle) for angle in (path.axes.tilt, path.axes.lead))
        angles = PathAngles(*(float(f(angle)) + 0.0 for angle in (tilt, lead) for f in (np.min, np.max)))
        return ToolPathFigures(
            member=self.member,
            ball_diameter=path.ball.diameter,
            largest_diameter=2.0 * path.largest.radius,
            largest_by=path.largest.why,
            shank_length=path.ball.length,
            shank_clearance=path.clearance,
            passes=len(path.passes.centres),
            points=len(path.whole.tips),
            spaces=int(np.unique(path.whole.space).size),
            length=path.motion.length,
            step_over_min=step_over[0],
            step_over_max=step_over[1],
            scallop=um * self.order.scallop,
            chord=um * budget.chord,
            stock=um * self.order.stock,
            left_max=um * left.scallop,
            left_min=um * min(left.least.values()),
            gouge=um * left.gouge,
            measured_points=left.points,
            angles=angles,
            surfaces=self._surfaces,
            holder_diameter=path.ball.holder,
        )

    @property
    def _surfaces(self) -> list[SurfaceLeft]:
        left, passes = self._path.left, self._path.passes
        count = {wall.region: int((passes.wall == k).sum()) for k, wall in enumerate(self._path.space.walls)}
        return [
            SurfaceLeft(str(region), count[region], 1e3 * largest, 1e3 * left.least[region])
            for region, largest in left.largest.items()
        ]

    @property
    def headline(self) -> str:
        measured = self.measured
        return (
            f"{self.member}, {measured.passes} passes of a ball of {measured.ball_diameter:.4g} mm, {measured.points} positions: "
            f"{measured.left_max:.3g} um left, gouge {measured.gouge:.2g} um"
        )

    @property
    def listings(self) -> list[Listing]:
        rows = [[row.region, row.passes, row.left_max, row.left_min] for row in self._surfaces]
        heads = ["surface", "passes", "left_max_um", "left_min_um"]
        return [figures("", self.measured), Listing("What is left on each surface", heads, rows)]

    @property
    def sections(self) -> Mapping[str, Content]:
        return {**header(self.design), **Summary(self.measured)}

    def to_dict(self) -> dict[str, list[Any]]:
        """All positions of the path.

        Returns
        -------
        dict of str to list
            Number of space and pass from 1; True if the move there is rapid; the tool's tip x, y, z (mm), which is the lowest
            point of the ball; the unit axis i, j, k; the point of contact (mm), NaN without contact; and the tip again as
            tip_x_mm, tip_y_mm, tip_z_mm.

        Examples
        --------
        >>> path = gears.toolpath("pinion", "ball:1mm", "20um", spaces=1)
        >>> len(path.to_dict()["x"]) > 100
        True
        """
        motion = self.motion
        numbers = [motion.space + 1, motion.number + 1, motion.rapid]
        vectors = np.concatenate((motion.tips, motion.axes, motion.contacts, motion.tips), axis=1).T
        return {name: column.tolist() for name, column in zip(CSV_COLUMNS, (*numbers, *vectors), strict=True)}

    def _write(self, target: Path) -> None:
        {CLS_SUFFIX: self._write_cls, CSV_SUFFIX: self._write_csv, VTP_SUFFIX: self._write_vtp}[target.suffix.lower()](
            target
        )

    def _write_cls(self, target: Path) -> None:
        from gearmesh.io.atomic import whole_text
        from gearmesh.toolpath.cls import cls_text

        title = f"{self.design.title} {self.member}".upper()
        whole_text(target, cls_text(title, self._notes, self.motion, self._path.ball, self.feed))

    @property
    def _notes(self) -> list[str]:
        measured = self.measured
        return [
            f"GEARMESH: BALL {measured.ball_diameter:.6g} MM, {measured.passes} PASSES A SPACE",
            f"SCALLOP {measured.scallop:.6g} UM, STOCK {measured.stock:.6g} UM",
            f"MEASURED: LEFT {measured.left_min:.3f} TO {measured.left_max:.3f} UM, GOUGE {measured.gouge:.3f} UM",
            "GOTO IS THE TIP OF THE TOOL, IN THE FRAME OF THE MEMBER, Z ITS AXIS",
        ]

    def _write_csv(self, target: Path) -> None:
        from gearmesh.files.csv_table import csv_text
        from gearmesh.io.atomic import whole_text

        table = self.to_dict()
        table["rapid"] = [int(rapid) for rapid in table["rapid"]]
        whole_text(target, csv_text(CSV_COLUMNS, zip(*table.values(), strict=True)))

    def _write_vtp(self, target: Path) -> None:
        from gearmesh.io.meshes.vtk import write_polylines

        motion = self.motion
        steps = np.diff(motion.rapid.astype(int)) != 0
        lines = np.split(np.arange(len(motion.tips)), np.flatnonzero(steps | (np.diff(motion.number) != 0)) + 1)
        data = {"tip": motion.tips, "axis": motion.axes, "contact": motion.contacts}
        columns = {"pass": motion.number + 1, "space": motion.space + 1, "rapid": motion.rapid}
        cells = {
            name: np.array([column[line[0]] for line in lines], dtype=np.int32) for name, column in columns.items()
        }
        write_polylines(target, motion.centres, lines, data, cells)


def tool_path_of(
    gears: GearSet, member: str, tool: str, order: PathOrder, feed: float = DEFAULT_FEED
) -> ToolPathAnswer:
    """Return the tool path of an order; `tool` and `feed` (mm/min) as for `Gears.toolpath`."""
    if not (math.isfinite(feed) and FEED_RANGE[0] <= feed <= FEED_RANGE[1]):
        raise ArgumentError("feed", feed, must_be=f"a feed from {FEED_RANGE[0]:g} to {FEED_RANGE[1]:g} mm/min")
    cutter = BallCutter.of(tool)
    path = tool_path(gears.stocked_part(member).member, cutter, order)
    return ToolPathAnswer(gears.design, member, path, order, float(feed))
