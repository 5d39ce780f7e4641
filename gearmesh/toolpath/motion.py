"""Motion of a cutter: its passes in sequence, with the motions between them, in the order of the machine.

A pass begins and ends beyond the ends of the face by an overrun, which continues the curvature of the pass. There are
two orders:

- zigzag: passes alternate in direction. Beyond the face the ball goes to the next pass, raised half way along its axis.
- one-way: all passes go from toe to heel. Between them the ball is withdrawn along the tool axis and returns above the
  teeth.

Between two points the tip moves along a straight line while the axis turns evenly.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, unit
from gearmesh.records import dataclass
from gearmesh.toolpath.axes import Axes
from gearmesh.toolpath.ball import BallCutter
from gearmesh.toolpath.order import ZIGZAG_ORDER, PathOrder
from gearmesh.toolpath.passes import Passes
from gearmesh.toolpath.space import CutSpace

#: decimals of coordinates (mm) in files: 0.01 um
COORDINATE_DECIMALS = 5
#: decimals of unit vectors in files: 0.01 um at the end of a shank of 100 mm
AXIS_DECIMALS = 7
#: part of the withdrawal along the tool axis between passes, in depths of the space
WITHDRAWAL_DEPTHS = 1.25
#: part of the withdrawal along the tool axis between passes, in diameters of the ball
WITHDRAWAL_DIAMETERS = 0.5
#: points along a return above the teeth
POINTS_PER_RETURN = 9
#: overrun beyond the ends of the face, in radii of the ball
OVERRUN_RADII = 1.0
#: points along an overrun
POINTS_PER_OVERRUN = 4
#: points of a pass that determine the curvature of its overrun
POINTS_BEFORE_OVERRUN = 5


@dataclass(frozen=True)
class ToolMotion:
    """K positions of a tool, as files contain them."""

    #: tips (K, 3), mm, rounded as in files
    tips: Array
    #: unit axes (K, 3), rounded as in files
    axes: Array
    #: True (K,) if the motion to the position is rapid
    rapid: NDArray[np.bool_]
    #: number (K,) of the space
    space: NDArray[np.int64]
    #: number (K,) of the pass in the space, from 0
    number: NDArray[np.int64]
    #: contact points (K, 3), mm; NaN where the ball does not touch
    contacts: Array
    #: radius of the ball, mm
    radius: float

    @property
    def centres(self) -> Array:
        """Centres (K, 3) of the ball."""
        return self.tips + self.radius * unit(self.axes)

    @property
    def cuts(self) -> tuple[Array, Array]:
        """Starts and ends (M, 3) of the straight paths of the ball's centre at feed rate.

        Each path of the tip gives two of them: the axis turns on the way, so that the centre leaves the chord.
        """
        cut = np.flatnonzero(~self.rapid[1:])
        centres, axes = self.centres, unit(self.axes)
        middle = 0.5 * (self.tips[cut] + self.tips[cut + 1]) + self.radius * unit(axes[cut] + axes[cut + 1])
        start, end = centres[cut], centres[cut + 1]
        return np.concatenate((start, middle)), np.concatenate((middle, end))

    @property
    def rapids(self) -> tuple[Array, Array]:
        """Starts and ends (M, 3) of the straight rapid paths of the ball's centre."""
        rapid = np.flatnonzero(self.rapid[1:])
        centres = self.centres
        return centres[rapid], centres[rapid + 1]

    @property
    def length(self) -> float:
        """Path length (mm) of the tip at feed rate."""
        way = np.linalg.norm(np.diff(self.tips, axis=0), axis=-1)
        return float(way[~self.rapid[1:]].sum())

    def move(self, place: Rigid, space: int) -> ToolMotion:
        """Return the same motion in another space of the member.

        `place`: from this space to the other space.
        """
        return replace(
            self,
            tips=place.point(self.tips).round(COORDINATE_DECIMALS),
            axes=place.vector(self.axes).round(AXIS_DECIMALS),
            contacts=place.point(self.contacts),
            space=np.full_like(self.space, space),
        )


def join(motions: list[ToolMotion]) -> ToolMotion:
    """Return several motions as one motion, in sequence."""
    names = ("tips", "axes", "rapid", "space", "number", "contacts")
    arrays = {name: np.concatenate([getattr(motion, name) for motion in motions]) for name in names}
    return ToolMotion(**arrays, radius=motions[0].radius)


def motion_of(space: CutSpace, passes: Passes, axes: Axes, ball: BallCutter, order: PathOrder) -> ToolMotion:
    """Return the motion through all passes, which begins and ends above the teeth."""
    centres, contacts, vectors = _beyond_ends(passes, axes.vectors, OVERRUN_RADII * ball.radius)
    if order.feed == ZIGZAG_ORDER:
        centres[1::2], contacts[1::2], vectors[1::2] = (a[1::2, ::-1] for a in (centres, contacts, vectors))
    above = centres + (WITHDRAWAL_DEPTHS * space.depth + WITHDRAWAL_DIAMETERS * ball.diameter) * vectors
    pieces = [_Piece(above[0, :1], vectors[0, :1], True, 0)]
    for k in range(len(centres)):
        if k:
            link = _across if order.feed == ZIGZAG_ORDER else _back
            pieces.append(link(centres[k - 1 : k + 1], above[k - 1 : k + 1], vectors[k - 1 : k + 1], k))
        pieces.append(_Piece(centres[k], vectors[k], False, k, contacts[k]))
    pieces.append(_Piece(above[-1, -1:], vectors[-1, -1:], True, len(centres) - 1))
    written = np.concatenate([piece.axes for piece in pieces]).round(AXIS_DECIMALS)
    tips = np.concatenate([piece.centres for piece in pieces]) - ball.radius * unit(written)
    sizes = [len(piece.centres) for piece in pieces]
    number = np.repeat([piece.number for piece in pieces], sizes)
    rapid = np.repeat([piece.rapid for piece in pieces], sizes)
    touched = np.concatenate([piece.contact_points for piece in pieces])
    return ToolMotion(
        tips.round(COORDINATE_DECIMALS), written, rapid, np.zeros_like(number), number, touched, ball.radius
    )


@dataclass(frozen=True)
class _Piece:
    """Part of a motion."""

    #: centres (N, 3) of the ball, mm
    centres: Array
    #: unit axes (N, 3)
    axes: Array
    #: True if the part is rapid
    rapid: bool
    #: number of the pass
    number: int
    #: points of contact (N, 3), None if there are none
    contacts: Array | None = None

    @property
    def contact_points(self) -> Array:
        """Points of contact (N, 3), NaN if there are none."""
        return np.full_like(self.centres, np.nan) if self.contacts is None else self.contacts


def _across(centres: Array, above: Array, vectors: Array, number: int) -> _Piece:
    """Return the link beyond the face from the first of two passes (2, N, 3) to the second.

    Half way it is raised along the axis by the distance between the passes.
    """
    ends, axes = (np.stack((of[0, -1], of[1, 0])) for of in (centres, vectors))
    axis = unit(axes.sum(axis=0))
    middle = ends.mean(axis=0) + float(np.linalg.norm(ends[1] - ends[0])) * axis
    return _Piece(middle[None], axis[None], False, number)


def _back(centres: Array, above: Array, vectors: Array, number: int) -> _Piece:
    """Return the link above the teeth from the end of the first of two passes (2, N, 3) to the start of the second."""
    back = np.linspace(centres.shape[1] - 1, 0, POINTS_PER_RETURN).round().astype(int)
    points, axes = (np.concatenate((of[0, -1:], of[1, back])) for of in (above, vectors))
    return _Piece(points, axes, True, number)


def _beyond_ends(passes: Passes, vectors: Array, overrun: float) -> tuple[Array, Array, Array]:
    """Return centres, contacts and axes (P, N + 2 POINTS_PER_OVERRUN, 3) of passes with overruns (mm) at both ends."""
    paths = passes.contacts + passes.reach * passes.normals
    before = passes.centres[:, :1] + _continuation(paths[:, POINTS_BEFORE_OVERRUN - 1 :: -1], overrun)[:, ::-1]
    after = passes.centres[:, -1:] + _continuation(paths[:, -POINTS_BEFORE_OVERRUN:], overrun)
    nothing = np.full_like(before, np.nan)
    return (
        np.concatenate((before, passes.centres, after), axis=1),
        np.concatenate((nothing, passes.contacts, nothing), axis=1),
        np.concatenate((vectors[:, [0] * POINTS_PER_OVERRUN], vectors, vectors[:, [-1] * POINTS_PER_OVERRUN]), axis=1),
    )


def _continuation(points: Array, overrun: float) -> Array:
    """Return displacements (P, POINTS_PER_OVERRUN, 3) that continue points (P, E, 3) beyond the last point.

    They follow the parabola fitted to the points over their distance from the last point.
    """
    from_end = points - points[:, -1:]
    distance = -np.sqrt((from_end**2).sum(axis=-1))
    # least squares of r = a x + b x^2, x = 0 at the end
    columns = np.stack((distance, distance**2), axis=-1)
    coefficients = np.linalg.pinv(columns) @ from_end
    x = overrun * np.arange(1, POINTS_PER_OVERRUN + 1) / POINTS_PER_OVERRUN
    return np.asarray(np.stack((x, x**2), axis=-1) @ coefficients)
