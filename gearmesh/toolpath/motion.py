"""The motion of a cutter: its passes one after the other, with what is between them, as the machine goes through them.

A pass begins and ends beyond the ends of the face by an overrun, curved as it is there. zigzag: passes go to and fro, and the
ball goes from one to the next beyond the face, raised half way along its axis; one-way: all go from toe to heel, and between them
the ball is withdrawn along the tool axis and goes back above the teeth. Between two points the tip goes along a straight line
while the axis turns evenly.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array, unit
from gearmesh.toolpath.axes import Axes
from gearmesh.toolpath.ball import BallCutter
from gearmesh.toolpath.passes import Passes

#: feed orders
ZIGZAG, ONE_WAY = "zigzag", "one-way"
#: decimals of coordinates (mm) and of unit vectors in files: 0.01 um, and as little at the end of a shank of 100 mm
DECIMALS, AXIS_DECIMALS = 5, 7
#: how far over the tips the tip of the tool goes between passes, as a share of the depth and of the ball's diameter
OVER_DEPTH, OVER_BALL = 1.25, 0.5
#: points along a way back, and of an overrun; points of a pass from which the overrun goes on as they do
BACK, BEYOND, END_POINTS = 9, 4, 5


@dataclass(frozen=True)
class ToolMotion:
    """K positions: tips and unit axes (K, 3) as files hold them, whether the way there is `rapid` (K,), the number of the space
    and of the pass in it (K,), from 0; contact points (K, 3), NaN where the ball does not touch; `radius` of the ball, mm."""

    tips: Array
    axes: Array
    rapid: NDArray[np.bool_]
    space: NDArray[np.int64]
    number: NDArray[np.int64]
    contacts: Array
    radius: float

    @property
    def centres(self) -> Array:
        """Centres (K, 3) of the ball."""
        return self.tips + self.radius * unit(self.axes)

    @property
    def cuts(self) -> tuple[Array, Array]:
        """Starts and ends (M, 3) of straight ways of the ball's centre at feed, two for each that the tip goes: as the axis
        turns on the way, the centre is beside the chord."""
        cut = np.flatnonzero(~self.rapid[1:])
        centres, axes = self.centres, unit(self.axes)
        middle = 0.5 * (self.tips[cut] + self.tips[cut + 1]) + self.radius * unit(axes[cut] + axes[cut + 1])
        start, end = centres[cut], centres[cut + 1]
        return np.concatenate((start, middle)), np.concatenate((middle, end))

    @property
    def rapids(self) -> tuple[Array, Array]:
        """Starts and ends (M, 3) of straight ways of the ball's centre that are rapid."""
        rapid = np.flatnonzero(self.rapid[1:])
        centres = self.centres
        return centres[rapid], centres[rapid + 1]

    @property
    def length(self) -> float:
        """Way (mm) of the tip at feed."""
        way = np.linalg.norm(np.diff(self.tips, axis=0), axis=-1)
        return float(way[~self.rapid[1:]].sum())

    def move(self, place: Rigid, space: int) -> ToolMotion:
        """The same in another space of the member.

        Parameters
        ----------
        place : Rigid
            From this space to the other one.
        space : int
            Number of the other one.

        Returns
        -------
        ToolMotion

        Examples
        --------
        >>> motion = gears.toolpath("pinion", "ball:1mm", "20um", spaces=0).motion
        >>> tooth = gears.members["pinion"].tooth
        >>> turn = tooth.joint.to(tooth.pitch_angle)
        >>> set(motion.move(turn, 1).space.tolist())
        {1}
        """
        return replace(
            self,
            tips=place.point(self.tips).round(DECIMALS),
            axes=place.vector(self.axes).round(AXIS_DECIMALS),
            contacts=place.point(self.contacts),
            space=np.full_like(self.space, space),
        )


def join(motions: list[ToolMotion]) -> ToolMotion:
    """Motions one after the other."""
    names = ("tips", "axes", "rapid", "space", "number", "contacts")
    arrays = {name: np.concatenate([getattr(motion, name) for motion in motions]) for name in names}
    return ToolMotion(**arrays, radius=motions[0].radius)


def motion_of(passes: Passes, axes: Axes, ball: BallCutter, depth: float, order: str, overrun: float) -> ToolMotion:
    """The motion through all passes in order, which begins and ends above the teeth; `depth` (mm) of the space."""
    centres, contacts, vectors = _beyond_ends(passes, axes.vectors, overrun)
    if order == ZIGZAG:
        centres[1::2], contacts[1::2], vectors[1::2] = (a[1::2, ::-1] for a in (centres, contacts, vectors))
    above = centres + (OVER_DEPTH * depth + OVER_BALL * ball.diameter) * vectors
    pieces = [_Piece(above[0, :1], vectors[0, :1], True, 0)]
    for k in range(len(centres)):
        if k:
            link = _across if order == ZIGZAG else _back
            pieces.append(link(centres[k - 1 : k + 1], above[k - 1 : k + 1], vectors[k - 1 : k + 1], k))
        pieces.append(_Piece(centres[k], vectors[k], False, k, contacts[k]))
    pieces.append(_Piece(above[-1, -1:], vectors[-1, -1:], True, len(centres) - 1))
    written = np.concatenate([piece.axes for piece in pieces]).round(AXIS_DECIMALS)
    tips = np.concatenate([piece.centres for piece in pieces]) - ball.radius * unit(written)
    sizes = [len(piece.centres) for piece in pieces]
    number = np.repeat([piece.number for piece in pieces], sizes)
    rapid = np.repeat([piece.rapid for piece in pieces], sizes)
    touched = np.concatenate([piece.contact_points for piece in pieces])
    return ToolMotion(tips.round(DECIMALS), written, rapid, np.zeros_like(number), number, touched, ball.radius)


@dataclass(frozen=True)
class _Piece:
    """Centres and axes (N, 3) of a part of a motion, whether it is rapid, the number of its pass, and points of contact (N, 3)."""

    centres: Array
    axes: Array
    rapid: bool
    number: int
    contacts: Array | None = None

    @property
    def contact_points(self) -> Array:
        """Points of contact, NaN where there are none."""
        return np.full_like(self.centres, np.nan) if self.contacts is None else self.contacts


def _across(centres: Array, above: Array, vectors: Array, number: int) -> _Piece:
    """From one of two passes (2, N, 3) to the next beyond the face: raised half way along the axis by as much as they are apart."""
    ends, axes = (np.stack((of[0, -1], of[1, 0])) for of in (centres, vectors))
    axis = unit(axes.sum(axis=0))
    middle = ends.mean(axis=0) + float(np.linalg.norm(ends[1] - ends[0])) * axis
    return _Piece(middle[None], axis[None], False, number)


def _back(centres: Array, above: Array, vectors: Array, number: int) -> _Piece:
    """From the end of one of two passes (2, N, 3) above the teeth to the start of the next."""
    back = np.linspace(centres.shape[1] - 1, 0, BACK).round().astype(int)
    points, axes = (np.concatenate((of[0, -1:], of[1, back])) for of in (above, vectors))
    return _Piece(points, axes, True, number)


def _beyond_ends(passes: Passes, vectors: Array, overrun: float) -> tuple[Array, Array, Array]:
    """Centres, contacts and axes (P, N + 2 BEYOND, 3) of passes that go on beyond both ends by an overrun (mm), curved as there."""
    paths = passes.contacts + passes.reach * passes.normals
    before = passes.centres[:, :1] + _going_on(paths[:, END_POINTS - 1 :: -1], overrun)[:, ::-1]
    after = passes.centres[:, -1:] + _going_on(paths[:, -END_POINTS:], overrun)
    nothing = np.full_like(before, np.nan)
    return (
        np.concatenate((before, passes.centres, after), axis=1),
        np.concatenate((nothing, passes.contacts, nothing), axis=1),
        np.concatenate((vectors[:, [0] * BEYOND], vectors, vectors[:, [-1] * BEYOND]), axis=1),
    )


def _going_on(points: Array, overrun: float) -> Array:
    """Ways (P, BEYOND, 3) from the last of points (P, E, 3) onwards, along the parabola by them over their distance from it."""
    from_end = points - points[:, -1:]
    distance = -np.sqrt((from_end**2).sum(axis=-1))
    # least squares of r = a x + b x^2, x = 0 at the end
    columns = np.stack((distance, distance**2), axis=-1)
    coefficients = np.linalg.pinv(columns) @ from_end
    x = overrun * np.arange(1, BEYOND + 1) / BEYOND
    return np.asarray(np.stack((x, x**2), axis=-1) @ coefficients)
