"""Nominal points and unit normals of flanks and fillets, for measuring machines.

Rows run from root to tip, columns from toe to heel. The frame is the member's own: axis z, the middle of a tooth on +x
at mid face.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from gearmesh.errors import ArgumentError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.surface import Surface
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.micro_geometry.deviations import EDGE_MARGIN
from gearmesh.teeth.micro_geometry.modified import MAX_FORM_ERROR
from gearmesh.teeth.micro_geometry.screw_involute import ScrewInvolute
from gearmesh.teeth.region import FILLET_REGIONS, Side
from gearmesh.teeth.section import Grid

#: rows and columns of a grid, as is usual for bevel gears
DEFAULT_SHAPE = (5, 9)
#: largest number of rows or columns
MAX_LINES = 2001
#: largest share of the profile or the face beside the edges that is not measured
MAX_MARGIN = 0.45


@dataclass(frozen=True)
class MeasuringGrid:
    """Grid of points on a flank of one tooth, or on the fillet under it."""

    #: side of the tooth
    side: Side
    #: True for the fillet
    fillet: bool
    #: shares (I,) from root to tip
    s: Array
    #: shares (J,) from toe to heel
    t: Array
    #: points (I, J, 3), mm
    points: Array
    #: unit outward normals (I, J, 3)
    normals: Array
    #: angles (I, J) about the axis, rad; for racks, y over the travel per rad
    angles: Array
    #: diameters (I, J), mm; None for racks
    diameters: Array | None
    #: roll lengths (I, J), mm; None for flanks that are no involutes
    roll_lengths: Array | None

    @staticmethod
    def of(
        member: Member,
        side: Side,
        shape: tuple[int, int] = DEFAULT_SHAPE,
        margins: tuple[float, float] = (EDGE_MARGIN, EDGE_MARGIN),
        *,
        fillet: bool = False,
    ) -> MeasuringGrid:
        """Return points of a flank, or of the fillet under it, evenly spaced along profile and face.

        `member`: member whose teeth are all equal. `side`: side of the tooth. `shape`: rows from root to tip and
        columns from toe to heel; a single row or column lies in the middle. `margins`: shares of profile and face
        beside the edges that are not measured. Raises DesignError for a shape or margins out of range, and if the
        member's teeth differ. Raises NoSolutionError for a tooth that cannot be trimmed.
        """
        refuse_shape(shape, margins)
        tooth = member.one_tooth
        s, t = (_shares(count, margin) for count, margin in zip(shape, margins, strict=True))
        if fillet:
            upward = s if side is Side.RIGHT else 1.0 - s
            grid = tooth.grid(FILLET_REGIONS[side], upward, tooth.sections(t))
        else:
            grid = tooth.flank_grid(side, s, t)
        joint = tooth.joint
        diameters = joint.diameter(np.asarray(joint.radius(grid.points)))
        flank = tooth.side(side).flank
        return MeasuringGrid(
            side=side,
            fillet=fillet,
            s=s,
            t=t,
            points=grid.points,
            normals=grid.normals,
            angles=np.asarray(joint.running(joint.angle(grid.points))),
            diameters=diameters,
            roll_lengths=None if fillet or diameters is None else _roll_lengths(flank, grid),
        )

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of rows and columns."""
        return len(self.s), len(self.t)

    def probe_centres(self, radius: float) -> Array:
        """Return the centres of a probe's ball in contact with the flank.

        `radius`: radius of the ball, mm. Result: centres in the member's frame, mm.
        """
        return np.asarray(self.points + radius * self.normals)

    @property
    def centre_angle(self) -> float:
        """Angle (rad) of the middle point; the mean of the middle points if the number of rows or columns is even."""
        rows, columns = ([(n - 1) // 2, n // 2] for n in self.shape)
        return float(self.angles[np.ix_(rows, columns)].mean())


def thickness_angle(grids: Sequence[MeasuringGrid]) -> float | None:
    """Return the angle (rad) between the middle points of both flanks of a tooth; None if a flank is missing."""
    angles = {grid.side: grid.centre_angle for grid in grids if not grid.fillet}
    return angles[Side.LEFT] - angles[Side.RIGHT] if len(angles) == len(Side) else None


def _roll_lengths(flank: Surface, grid: Grid) -> Array | None:
    """Return roll lengths (I, J), mm, of points on an involute, whose normals all touch one base cylinder; otherwise
    None."""
    if isinstance(flank, ScrewInvolute):
        return grid.p
    (x, y), (n_x, n_y) = (np.moveaxis(vectors[..., :2], -1, 0) for vectors in (grid.points, grid.normals))
    base = (x * n_y - y * n_x) / np.hypot(n_x, n_y)
    if np.ptp(base) > MAX_FORM_ERROR * abs(base.flat[0]):
        return None
    return np.asarray(np.abs(x * n_x + y * n_y) / np.hypot(n_x, n_y))


def _shares(count: int, margin: float) -> Array:
    return np.array([0.5]) if count == 1 else np.linspace(margin, 1.0 - margin, count)


def refuse_shape(shape: tuple[int, int], margins: tuple[float, float]) -> None:
    if not all(1 <= count <= MAX_LINES for count in shape):
        raise ArgumentError(
            "grid", "x".join(map(str, shape)), allowed=f"rows and columns from 1 to {MAX_LINES}, as 5x9"
        )
    if not all(0.0 <= margin <= MAX_MARGIN for margin in margins):
        raise ArgumentError(
            "margins",
            ",".join(f"{margin:g}" for margin in margins),
            allowed=f"shares of profile and face from 0 to {MAX_MARGIN:g}, as 0.1,0.1",
        )
