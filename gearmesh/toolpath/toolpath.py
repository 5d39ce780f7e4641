"""A whole tool path: passes planned, axes chosen, result proved, all repeated if too much is left or gouged."""

from __future__ import annotations

import numpy as np

from gearmesh.errors import ArgumentError, NoSolutionError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.progress import tell
from gearmesh.records import dataclass
from gearmesh.teeth.gear_train import Member
from gearmesh.toolpath.axes import Axes, choose_axes
from gearmesh.toolpath.ball import BallCutter, LargestBall, largest_ball, refuse_too_large
from gearmesh.toolpath.corners import inner_corners
from gearmesh.toolpath.motion import ToolMotion, join, motion_of
from gearmesh.toolpath.order import Budget, PathOrder
from gearmesh.toolpath.passes import Passes, plan_passes
from gearmesh.toolpath.proof import DRAFT_CHORDS, PROOF_CHORDS, Left, clear_of_teeth, measure_left, shank_clearance
from gearmesh.toolpath.space import CutSpace, choose_walls

#: depth of the deepest gouge that a path may have
MAX_GOUGE_MM = 1e-4
#: limit of the plans
MAX_PLANS = 5
#: factor by which passes are brought closer than the measured heights require
PASS_DENSITY_MARGIN = 1.02
#: factor of the chord tolerance after a gouge
CHORD_REDUCTION = 0.4


@dataclass(frozen=True)
class ToolPath:
    """A tool path with its plan and its proof."""

    #: space that is cut
    space: CutSpace
    #: cutter
    ball: BallCutter
    #: largest ball that fits
    largest: LargestBall
    #: passes in one space
    passes: Passes
    #: tool axes of the passes
    axes: Axes
    #: motion in one space
    motion: ToolMotion
    #: motion through all spaces of the order
    whole: ToolMotion
    #: measured heights and gouges
    left: Left
    #: clearance of the shank, mm; inf if nothing is near it
    clearance: float
    #: tolerance of the chords, mm
    chord: float


def tool_path(member: Member, ball: BallCutter, order: PathOrder) -> ToolPath:
    """Return the proved path of a ball-end cutter through spaces of a member.

    Raises DesignError for a ball that does not fit. Raises NoSolutionError if the shank is not clear of the teeth, or
    if the heights left or the gouges stay above what the order allows.
    """
    space = CutSpace(member)
    _refuse_number(space, order.spaces)
    space.refuse_threads()
    walls = choose_walls(space, order.flank, order.surfaces)
    denser, budget, corners = np.ones(len(space.walls)), order.budget, inner_corners(space, walls)
    largest = largest_ball(space, walls, order, corners, budget.scallop)
    refuse_too_large(ball, largest, order)
    tell(0.15)
    # plan and measure, first coarsely, until heights and gouges are within the order
    for _ in range(MAX_PLANS):
        passes = plan_passes(space, walls, ball, order, budget, denser, corners)
        axes = choose_axes(space, passes, ball, order)
        motion = motion_of(space, passes, axes, ball, order)
        tell(0.4)
        # a coarse measurement first: it already finds most passes that are too far apart
        for chords in (DRAFT_CHORDS, PROOF_CHORDS):
            left = measure_left(space, walls, passes, motion, order, chords)
            if left.scallop > order.scallop or left.gouge > MAX_GOUGE_MM:
                break
        else:
            break
        # closer passes where too much is left, finer chords after a gouge
        denser = denser * _factors(space, left, order.scallop)
        if left.gouge > MAX_GOUGE_MM:
            budget = Budget(budget.scallop, CHORD_REDUCTION * budget.chord)
    else:
        raise _refusal(ball, left, order.scallop)
    tell(0.9)
    # the shank is measured at the points of all passes, not only where its axes were chosen
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


def _factors(space: CutSpace, left: Left, scallop: float) -> Array:
    """Return factors (W,) by which the passes of each wall of the space must come closer."""
    measured = np.array([left.largest.get(wall.region, 0.0) for wall in space.walls])
    with np.errstate(invalid="ignore"):
        share = np.minimum(np.nan_to_num(measured / scallop, posinf=4.0), 4.0)
    return np.where(share > 1.0, PASS_DENSITY_MARGIN * np.sqrt(share), 1.0)


def _refusal(ball: BallCutter, left: Left, scallop: float) -> NoSolutionError:
    if left.gouge > MAX_GOUGE_MM:
        reason = f"the ball gouges the teeth by {1e3 * left.gouge:.3g} um, beside its passes or beyond the face"
    else:
        reason = f"{1e3 * left.scallop:.3g} um are left instead of {1e3 * scallop:.3g}"
    return NoSolutionError("tool", f"ball:{ball.diameter:g}", reason=reason, remedy="choose a smaller ball")


def _refuse_number(space: CutSpace, which: int | None) -> None:
    """Raise DesignError for a number without a space."""
    numbers = space.numbers
    if which is not None and which not in numbers:
        raise ArgumentError("spaces", which, must_be=f"all, or from {numbers[0]} to {numbers[-1]}")


def _through_spaces(space: CutSpace, motion: ToolMotion, which: int | None) -> ToolMotion:
    """Return the motion through the spaces of the order.

    Raises NoSolutionError if the path above the tips from one space to the next is not clear of the teeth.
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
