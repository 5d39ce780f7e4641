"""A whole tool path: its passes planned, their axes chosen, what they leave proved, and planned anew where that is too much."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from gearmesh.errors import ArgumentError, NoSolutionError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.progress import tell
from gearmesh.teeth.gear_train import Member
from gearmesh.toolpath.axes import Axes, choose_axes
from gearmesh.toolpath.ball import BallCutter, LargestBall, largest_ball, refuse_too_large
from gearmesh.toolpath.corners import inner_corners
from gearmesh.toolpath.motion import ToolMotion, join, motion_of
from gearmesh.toolpath.passes import Budget, Passes, plan_passes
from gearmesh.toolpath.proof import CHORDS, DRAFT, Left, clear_of_teeth, measure_left, shank_clearance
from gearmesh.toolpath.space import CutSpace, choose_walls

#: mm: the deepest gouge that a path may have
GOUGE = 1e-4
#: share of the scallop asked for that the chords may take where no tolerance is given, and what is kept for higher orders
CHORD, KEPT = 0.1, 0.05
#: how often passes are planned; by how much more than what was measured they are brought closer, and chords made finer
ATTEMPTS, MORE, FINER = 5, 1.02, 0.4
#: overrun beyond the ends of the face, in radii of the ball
OVERRUN = 1.0


@dataclass(frozen=True)
class PathOrder:
    """What is asked for: lengths in mm, angles in rad.

    `scallop`: the most that may stand over the surface (or over the stock), that of chords within `chord` (None: a tenth) included;
    `flank` "left", "right" or "both"; `surfaces` "all" (with fillets and root) or "flanks"; `spaces`: the number of the one
    that is cut, that of the tooth after it, or None for all of all rows of teeth; `feed` "zigzag" or "one-way"; `lead`,
    `tilt` None where they are chosen.
    """

    scallop: float
    chord: float | None = None
    stock: float = 0.0
    flank: str = "both"
    surfaces: str = "all"
    spaces: int | None = 0
    feed: str = "zigzag"
    lead: float | None = None
    tilt: float | None = None


@dataclass(frozen=True)
class ToolPath:
    """Passes and axes in one space, its motion and what it leaves; `whole`: the motion through all spaces asked for;
    clearance (mm) of the shank, `inf` where nothing is near it."""

    space: CutSpace
    ball: BallCutter
    largest: LargestBall
    passes: Passes
    axes: Axes
    motion: ToolMotion
    whole: ToolMotion
    left: Left
    clearance: float
    chord: float


def tool_path(member: Member, ball: BallCutter, order: PathOrder) -> ToolPath:
    """The path of a ball-end cutter through spaces of a member, proved.

    Raises DesignError for a ball that does not fit, and NoSolutionError where the shank is not clear of the teeth, or where what is
    left or gouged cannot be brought within what is asked for.
    """
    space = CutSpace(member)
    _refuse_number(space, order.spaces)
    space.refuse_threads()
    walls = choose_walls(space, order.flank, order.surfaces)
    denser, budget, corners = np.ones(len(space.walls)), budget_of(order), inner_corners(space, walls)
    largest = largest_ball(space, walls, order.stock, corners, budget.scallop)
    refuse_too_large(ball, largest, order.stock)
    tell(0.15)
    for _ in range(ATTEMPTS):
        passes = plan_passes(space, walls, ball, order.stock, budget, denser, corners)
        axes = choose_axes(space, passes, ball, order.lead, order.tilt)
        motion = motion_of(passes, axes, ball, space.depth, order.feed, OVERRUN * ball.radius)
        tell(0.4)
        for chords in (DRAFT, CHORDS):
            left = measure_left(space, walls, passes, motion, order.stock, order.scallop, chords)
            if left.scallop > order.scallop or left.gouge > GOUGE:
                break
        else:
            break
        denser = denser * _factors(space, left, order.scallop)
        if left.gouge > GOUGE:
            budget = Budget(budget.scallop, FINER * budget.chord)
    else:
        raise _refusal(ball, left, order.scallop)
    tell(0.9)
    clearance = shank_clearance(space, motion, ball)
    if clearance < 0.0:
        raise NoSolutionError(
            "tool",
            ball.text,
            reason=f"the shank is {-clearance:.3g} mm within a tooth"
            if ball.holder is None
            else f"shank or holder is {-clearance:.3g} mm within a tooth",
            remedy=f"give {'a shorter' if ball.holder is None else 'another'} length, or another lead and tilt",
        )
    return ToolPath(
        space,
        ball,
        largest,
        passes,
        axes,
        motion,
        _through_spaces(space, motion, order.spaces),
        left,
        clearance,
        budget.chord,
    )


def budget_of(order: PathOrder) -> Budget:
    """What passes and chords may leave."""
    chord = CHORD * order.scallop if order.chord is None else order.chord
    return Budget((1.0 - KEPT) * order.scallop - chord, chord)


def _factors(space: CutSpace, left: Left, scallop: float) -> Array:
    """By how much closer (W,) the passes of each wall of the space have to be."""
    measured = np.array([left.largest.get(wall.region, 0.0) for wall in space.walls])
    with np.errstate(invalid="ignore"):
        share = np.minimum(np.nan_to_num(measured / scallop, posinf=4.0), 4.0)
    return np.where(share > 1.0, MORE * np.sqrt(share), 1.0)


def _refusal(ball: BallCutter, left: Left, scallop: float) -> NoSolutionError:
    if left.gouge > GOUGE:
        reason = f"the ball gouges the teeth by {1e3 * left.gouge:.3g} um, beside its passes or beyond the face"
    else:
        reason = f"{1e3 * left.scallop:.3g} um are left instead of {1e3 * scallop:.3g}"
    return NoSolutionError("tool", f"ball:{ball.diameter:g}", reason=reason, remedy="choose a smaller ball")


def _refuse_number(space: CutSpace, which: int | None) -> None:
    """Raise DesignError for a space that there is not."""
    numbers = space.numbers
    if which is not None and which not in numbers:
        raise ArgumentError("spaces", which, must_be=f"all, or from {numbers[0]} to {numbers[-1]}")


def _through_spaces(space: CutSpace, motion: ToolMotion, which: int | None) -> ToolMotion:
    """The motion through the spaces that are asked for.

    Raises NoSolutionError where the way from one to the next, above the tips, is not clear of the teeth.
    """
    if which is not None:
        return motion.move(space.place(which), which)
    numbers = space.numbers
    places = [row.motion @ space.place(k) for row in space.member.halves for k in numbers]
    if not clear_of_teeth(space, motion, places):
        raise NoSolutionError(
            "spaces",
            "all",
            reason="the way from one space to the next is not clear of the teeth",
            remedy="cut one space at a time and index the gear",
        )
    return join([motion.move(place, k) for k, place in enumerate(places)])
