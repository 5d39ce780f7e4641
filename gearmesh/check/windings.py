"""Threads that go round their axis: a circle about the gear's axis meets every winding, but a tooth only once.

A thread is therefore rolled in overlapping pieces of less than a turn, each piece by itself. Neighbouring windings
require gear rotations one turn of the pinion apart. The winding in mesh is the winding within half of this of the
expected rotation.

      |--- piece 0 ---|--.        z
               |--- piece 1 ---|
      winding       winding
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Generic, Protocol, Self, TypeVar

import numpy as np

from gearmesh.check.touch import FirstTouch
from gearmesh.kernel.motion.rigid import Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.teeth.tooth import Tooth

#: turns from which on a flank is rolled in pieces
MIN_WOUND_TURNS = 0.9
#: turns of a piece
PIECE_TURNS = 0.7
#: turns from one piece to the next
PIECE_STEP_TURNS = 0.35
#: largest difference of the gear's rotations at which two pieces agree; the piece whose middle is nearer to the contact
#: is taken
SAME_ROTATION_RAD = 1e-8


class Wound(Protocol):
    """A flank, or a half of a tooth, that can be divided along its axis."""

    @property
    def points(self) -> Array:
        """Points (K, 3) of the flank, mm, in the member's frame."""

    def between(self, low: float, high: float) -> Self | None:
        """Return the part of the flank between two z (mm), slightly extended; None if there is none."""


Piece = TypeVar("Piece")
WoundFlank = TypeVar("WoundFlank", bound=Wound)


@dataclass(frozen=True)
class WoundTouch(Generic[Piece]):
    """First touch of one piece of a thread."""

    #: the piece
    piece: Piece
    #: its first touch
    touch: FirstTouch
    #: rotation of the gear, rad
    phi2: float
    #: distance of the contact from the middle of the piece along the axis, mm
    aside: float


def turns(tooth: Tooth) -> float:
    """Return the number of turns of a tooth about its axis along the face; 0 for a sliding member."""
    angles = tooth.joint.running(tooth.even.right.tip_angle)
    spin = np.linalg.norm(tooth.joint.spin(Rigid.identity()))
    return float(spin * abs(angles[-1] - angles[0]) / (2.0 * np.pi))


def windings(flank: WoundFlank, count: float) -> tuple[WoundFlank, ...]:
    """Return a flank of `count` turns in pieces of less than a turn; the flank itself if it is short enough."""
    if count < MIN_WOUND_TURNS:
        return (flank,)
    z = flank.points[:, 2]
    low, high = float(z.min()), float(z.max())
    lead = (high - low) / count
    starts = low + lead * PIECE_STEP_TURNS * np.arange(
        max(1, int(np.ceil((count - PIECE_TURNS) / PIECE_STEP_TURNS)) + 1)
    )
    pieces = (flank.between(start, start + PIECE_TURNS * lead) for start in starts.tolist())
    return tuple(piece for piece in pieces if piece is not None)


def middle(flank: Wound) -> float:
    """Return the middle of a flank along the axis, mm."""
    z = flank.points[:, 2]
    return 0.5 * float(z.min() + z.max())


def in_mesh(
    touches: Iterable[WoundTouch[Piece]], guess: float, ratio: float, drive: int, *, anywhere: bool = False
) -> WoundTouch[Piece] | None:
    """Return the touch of the winding in mesh: the first touch near phi2 = `guess` (rad).

    Near means within half a turn of the pinion. Without such a touch the result is None, or with `anywhere` the first
    touch near the touch that is nearest to `guess`.
    """
    candidates = list(touches)
    if len(candidates) > 1:
        half = np.pi * abs(ratio)
        nearest = min((touch.phi2 for touch in candidates), key=lambda phi2: abs(phi2 - guess))
        centre = nearest if anywhere and abs(nearest - guess) >= half else guess
        candidates = [touch for touch in candidates if abs(touch.phi2 - centre) < half]
    if not candidates:
        return None
    foremost = max(drive * touch.phi2 for touch in candidates)
    return min(
        (touch for touch in candidates if drive * touch.phi2 >= foremost - SAME_ROTATION_RAD),
        key=lambda touch: touch.aside,
    )
