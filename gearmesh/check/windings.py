"""Threads that go round their axis: a circle about the mating gear's axis meets every winding of one, a tooth only once.

So a thread is rolled in pieces of less than a turn, which overlap, each by itself; neighbouring windings are one turn of the pinion
apart in what they ask of the gear, so that the one in mesh is that within half of it of where the gear is expected.

      |--- piece 0 ---|--.        z
               |--- piece 1 ---|
      winding       winding
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Generic, Protocol, Self, TypeVar

import numpy as np

from gearmesh.check.touch import FirstTouch
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.teeth.tooth import Tooth

#: turns from which on a flank is rolled in pieces, and turns of a piece, and from one to the next
WOUND, PIECE, STEP = 0.9, 0.7, 0.35
#: rad of the gear within which two pieces ask the same of it: the one whose middle is nearer to the contact is taken
SAME = 1e-8


class Wound(Protocol):
    """A flank, or a half of a tooth, that can be taken in pieces along its axis."""

    @property
    def points(self) -> Array:
        """Points (K, 3) on it, own frame, mm."""

    def between(self, low: float, high: float) -> Self | None:
        """The part of it between two z (mm), and a little more; None where there is none."""


T = TypeVar("T")
W = TypeVar("W", bound=Wound)


@dataclass(frozen=True)
class WoundTouch(Generic[T]):
    """A touch of one piece: the gear's rotation phi2 (rad), where, and how far (mm) `aside` of the middle of the piece."""

    piece: T
    touch: FirstTouch
    phi2: float
    aside: float


def turns(tooth: Tooth) -> float:
    """How often a tooth goes round its axis along the face; 0 for what slides."""
    angles = tooth.joint.running(tooth.even.right.tip_angle)
    spin = np.linalg.norm(tooth.joint.spin(Rigid.identity()))
    return float(spin * abs(angles[-1] - angles[0]) / (2.0 * np.pi))


def windings(flank: W, count: float) -> tuple[W, ...]:
    """A flank that goes round `count` times in pieces of less than a turn; itself where it is one already."""
    if count < WOUND:
        return (flank,)
    z = flank.points[:, 2]
    low, high = float(z.min()), float(z.max())
    lead = (high - low) / count
    starts = low + lead * STEP * np.arange(max(1, int(np.ceil((count - PIECE) / STEP)) + 1))
    pieces = (flank.between(start, start + PIECE * lead) for start in starts.tolist())
    return tuple(piece for piece in pieces if piece is not None)


def middle(flank: Wound) -> float:
    """Its middle along the axis, mm."""
    z = flank.points[:, 2]
    return 0.5 * float(z.min() + z.max())


def in_mesh(
    touches: Iterable[WoundTouch[T]], guess: float, ratio: float, drive: int, *, anywhere: bool = False
) -> WoundTouch[T] | None:
    """The touch of the winding in mesh: the first that the gear meets within half a turn of the pinion of phi2 = `guess` (rad).

    None without any; with `anywhere` then about the touch that is nearest to it.
    """
    every = list(touches)
    if len(every) > 1:
        half = np.pi * abs(ratio)
        near = min((touch.phi2 for touch in every), key=lambda phi2: abs(phi2 - guess))
        centre = near if anywhere and abs(near - guess) >= half else guess
        every = [touch for touch in every if abs(touch.phi2 - centre) < half]
    if not every:
        return None
    most = max(drive * touch.phi2 for touch in every)
    return min((touch for touch in every if drive * touch.phi2 >= most - SAME), key=lambda touch: touch.aside)
