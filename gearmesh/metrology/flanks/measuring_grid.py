"""Nominal points and unit normals of flanks and fillets, at which measuring machines probe.

Rows run from root to tip, columns from toe to heel, in the member's own frame: axis z, the middle of a tooth on +x at mid face.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gearmesh.errors import ArgumentError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.surface.surface import Surface
from gearmesh.teeth.gear_train import Member
from gearmesh.teeth.micro_geometry.deviations import EDGE_MARGIN
from gearmesh.teeth.micro_geometry.modified import MAX_FORM_ERROR
from gearmesh.teeth.micro_geometry.screw_involute import ScrewInvolute
from gearmesh.teeth.region import FILLET_REGIONS, Side
from gearmesh.teeth.section import Grid

#: rows and columns of a grid, as is custom for bevel gears
SHAPE = (5, 9)
#: rows or columns at most
MOST_LINES = 2001
#: shares of the profile and of the face that are left out beside the edges, at most
MOST_MARGIN = 0.45


@dataclass(frozen=True)
class MeasuringGrid:
    """Points and unit outward normals (I, J, 3), mm, of a flank, or of the `fillet` under it, of one tooth.

    `s` (I,), `t` (J,): shares of the way from root to tip and from toe to heel; `angles` (I, J), rad: about the axis, of racks
    over their travel; `diameters` (I, J), None of racks; `roll_lengths` (I, J), None of flanks that are no involutes.
    """

    side: Side
    fillet: bool
    s: Array
    t: Array
    points: Array
    normals: Array
    angles: Array
    diameters: Array | None
    roll_lengths: Array | None

    @staticmethod
    def of(
        member: Member,
        side: Side,
        shape: tuple[int, int] = SHAPE,
        margins: tuple[float, float] = (EDGE_MARGIN, EDGE_MARGIN),
        *,
        fillet: bool = False,
    ) -> MeasuringGrid:
        """Points of a flank, or of the fillet under it, evenly spaced along profile and face.

        Parameters
        ----------
        member : Member
            Whose teeth are all alike.
        side : Side
            The flank.
        shape : tuple of two int
            Rows from root to tip and columns from toe to heel; one alone lies in the middle.
        margins : tuple of two float
            Shares of profile and face that are left out beside the edges.
        fillet : bool
            Whether the fillet is meant.

        Returns
        -------
        MeasuringGrid
            In the member's frame.

        Raises
        ------
        DesignError
            For a shape or margins out of range, and where teeth of the member differ.
        NoSolutionError
            For a tooth that cannot be trimmed.

        Examples
        --------
        >>> gm.MeasuringGrid.of(gears.members["pinion"], gm.Side.RIGHT, (5, 9)).points.shape
        (5, 9, 3)
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
        """Rows and columns."""
        return len(self.s), len(self.t)

    def probe_centres(self, radius: float) -> Array:
        """Where the centre of a probe's ball is when it touches.

        Parameters
        ----------
        radius : float
            Of the ball, mm.

        Returns
        -------
        numpy.ndarray of float (I, J, 3)
            Centres in the member's frame, mm.

        Examples
        --------
        >>> grid = gm.MeasuringGrid.of(gears.members["pinion"], gm.Side.RIGHT, (5, 9))
        >>> bool(np.allclose(grid.probe_centres(1.0) - grid.points, grid.normals))
        True
        """
        return np.asarray(self.points + radius * self.normals)

    @property
    def centre_angle(self) -> float:
        """Angle (rad) of the point in the middle, the mean of the four next to it where lines are even in number."""
        rows, columns = ([(n - 1) // 2, n // 2] for n in self.shape)
        return float(self.angles[np.ix_(rows, columns)].mean())


def thickness_angle(grids: Sequence[MeasuringGrid]) -> float | None:
    """Angle (rad) between the centre points of both flanks of a tooth; None where one of them is missing."""
    angles = {grid.side: grid.centre_angle for grid in grids if not grid.fillet}
    return angles[Side.LEFT] - angles[Side.RIGHT] if len(angles) == len(Side) else None


def _roll_lengths(flank: Surface, grid: Grid) -> Array | None:
    """Roll lengths (I, J), mm, of points on an involute: those whose normals all touch one base cylinder."""
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
    if not all(1 <= count <= MOST_LINES for count in shape):
        raise ArgumentError(
            "grid", "x".join(map(str, shape)), allowed=f"rows and columns from 1 to {MOST_LINES}, as 5x9"
        )
    if not all(0.0 <= margin <= MOST_MARGIN for margin in margins):
        raise ArgumentError(
            "margins",
            ",".join(f"{margin:g}" for margin in margins),
            allowed=f"shares of profile and face from 0 to {MOST_MARGIN:g}, as 0.1,0.1",
        )
