"""Least movement of the gear that frees a pair from interference.

The slack is the distance left before anything interferes: negative where teeth overlap, positive where teeth are free. Its sign
changes between a shift that does not free the pair and a shift that does. The search closes this bracket to a hundredth. Where
a tip leaves a fillet, the slack jumps from 0 to the backlash, so the bracket follows the sign of the overlap. The search ends when
its effort is spent, and then returns the least shift that was found to free the pair, if there is one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from gearmesh.contact.engagement.engagement import LOOKS_PER_PITCH
from gearmesh.contact.first_touch.field import outlook
from gearmesh.contact.fit.fit import (
    ROUNDING_MM,
    Fit,
    clearances_of,
    gear_rotations,
    least,
    play,
    reversed_pair,
    slack_of,
)
from gearmesh.contact.flanks import solver_pair
from gearmesh.kernel.motion.rigid import MAX_SINE_OF_PARALLEL, Rigid
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.kernel.numeric.effort import Effort, EffortSpentError, limit_effort
from gearmesh.teeth.gear_train import GearPair

#: axes closer than this (mm) intersect
MIN_AXIS_DISTANCE_MM = 1e-6
#: width of the closed bracket by the shift
BRACKET_WIDTH = 0.008
#: least width of the closed bracket, mm
MIN_BRACKET_WIDTH_MM = 2e-5
#: shifts tried at most with the slack of touching teeth
MAX_TRIES = 24
#: shifts tried at most with the slack that the field samples
MAX_SAMPLED_TRIES = 8
#: sampled slack by the first slack that is near enough to zero
SAMPLED_NEAR_ZERO = 0.03
#: effort of the whole search, about its seconds
MAX_EFFORT = 2.0
#: effort of one slack of touching teeth, beside the effort that its solvers count
EFFORT_OF_SLACK = 0.4
#: effort of one sampled slack, beside the effort that its solvers count
EFFORT_OF_SAMPLED_SLACK = 0.04
#: shift by the estimated shift at which a tip leaves a fillet: a little more
BEYOND_FILLET = 1.15


def shift_gear(pair: GearPair, shift: float) -> GearPair:
    """Return the pair with its gear moved by `shift` (mm) along `direction`."""
    mount = pair.gear.mount
    away = Rigid(np.eye(3), shift * direction(pair))
    return replace(pair, gear=replace(pair.gear, mount=replace(mount, base=away @ mount.base)))


def direction(pair: GearPair) -> Array:
    """Return the unit vector (3,), fixed frame, along which the gear moves: from axis to axis, or along its axis if they meet."""
    first, second = pair.mounts
    common, between = np.cross(first.axis, second.axis), second.origin - first.origin
    length = float(np.linalg.norm(common))
    along = (between @ first.axis) * first.axis
    across = between - along if length < MAX_SINE_OF_PARALLEL else (between @ common) * common / length**2
    apart = float(np.linalg.norm(across))
    return across / apart if apart > MIN_AXIS_DISTANCE_MM else second.axis


class FreeingShift(NamedTuple):
    """Movement of the gear along `direction` by `length` (mm) that frees a pair; `least`: no shorter movement does."""

    length: float
    least: bool


def freeing_shift(pair: GearPair, fit: Fit, most_effort: float = MAX_EFFORT) -> FreeingShift | None:
    """Find the least movement of the gear for which the pair fits; None where moving does not help.

    The search returns its best movement when `most_effort` is spent. The play that the field samples estimates the first shift
    and the slope of the slack.
    """
    if not np.isfinite(fit.slack):
        return None
    effort = Effort(most_effort)

    def limit_slack(slack: Callable[[GearPair], float | None], at_least: float, standing: GearPair) -> float | None:
        """Return a slack whose effort is `at_least` so much; raises EffortSpentError when no effort is left."""
        effort.left -= at_least
        if effort.spent:
            raise EffortSpentError
        with limit_effort(effort):
            return slack(standing)

    for sense in (1.0, -1.0):

        def standing(at: float, sense: float = sense) -> GearPair:
            return shift_gear(pair, sense * at)

        try:
            begin = _begin(
                lambda at: limit_slack(lambda moved: _sampled_slack(moved, fit), EFFORT_OF_SAMPLED_SLACK, standing(at)),
                max(0.5 * abs(fit.slack), 1e-3),
            )
        except EffortSpentError:
            return None
        shift = (
            None
            if begin is None
            else _least_shift(lambda at: limit_slack(slack_of, EFFORT_OF_SLACK, standing(at)), fit.slack, *begin)
        )
        if shift is not None:
            return shift._replace(length=sense * shift.length)
    return None


def _begin(slack: Callable[[float], float | None], first: float) -> tuple[float, float] | None:
    """Estimate the shift (mm) at which a sampled `slack` (mm) is 0, by secants from `first` on, and the slope of the slack.

    Returns `first` where there is slack already, None where moving does not help.
    """
    low, at_low = 0.0, slack(0.0)
    if at_low is None:
        return None
    enough, high = SAMPLED_NEAR_ZERO * at_low, first
    for _ in range(MAX_SAMPLED_TRIES):
        there = slack(high)
        if there is None or not there > at_low:
            return None if enough < 0.0 else (first, np.nan)
        slope = (there - at_low) / (high - low)
        if at_low >= 0.0:
            return first, slope
        if there >= enough:
            return high - there / slope, slope
        low, at_low, high = high, there, high - there / slope
    return None


def _least_shift(slack: Callable[[float], float | None], start: float, at: float, slope: float) -> FreeingShift | None:
    """Find the least shift at which `slack` (mm) is not negative; None where slack does not grow.

    The slack is `start` at shift 0. The first shift tried is `at`; `slope` is the slope of the play, NaN if unknown.
    """
    short, high, at_high, width = [(0.0, start)], np.inf, np.inf, np.inf
    for _ in range(MAX_TRIES):
        try:
            there = slack(at)
        except EffortSpentError:
            break
        if there is None:
            break
        if there >= -ROUNDING_MM:
            high, at_high = at, there
        elif np.isinf(high) and not there > short[-1][1]:
            return None
        else:
            short.append((at, there))
        low, tight = short[-1][0], max(BRACKET_WIDTH * min(at, high), MIN_BRACKET_WIDTH_MM)
        # where only the play is missing, its slope tells how far the shift is from the root
        if high - low <= tight or at_high <= 0.4 * tight * slope:
            return FreeingShift(high, least=True)
        root = _root(short, (high, at_high), slope)
        if np.isinf(high):
            at = max(root + 0.3 * tight, low + 2.0 ** (len(short) - 2) * tight, _left_fillet(short))
        elif not low < root < high or high - low > 0.5 * width:
            at = 0.5 * (low + high)
        else:
            at = root + 0.3 * tight if root + 0.6 * tight < high else high - 0.9 * tight
        width = high - low
    return None if np.isinf(high) else FreeingShift(high, least=False)


def _root(short: list[tuple[float, float]], free: tuple[float, float], slope: float) -> float:
    """Estimate the shift (mm) at which the slack is 0.

    `short`: shifts (mm) that do not free the pair, with their slacks (mm); `free`: a shift that does, with its slack; `slope`: of
    the play.
    """
    (low, at_low), (high, at_high) = short[-1], free
    if len(short) > 2:
        before, at_before = short[-2]
        slope = (at_low - at_before) / (low - before)
        if at_high > 2.0 * slope * (high - low) > 0.0:
            # the depth of a tip in a fillet falls with the square of the shift that is left
            slope = 0.5 * slope
    elif at_high < -at_low:
        return high - at_high / slope
    return low - at_low / slope if slope > 0.0 else low


def _left_fillet(short: list[tuple[float, float]]) -> float:
    """Estimate the shift (mm) at which a tip has left a fillet, from the last two shifts that do not free the pair.

    The depth of the tip falls with the square of the shift that is left. Returns 0 before there are two such shifts.
    """
    if len(short) < 3:
        return 0.0
    (before, at_before), (low, at_low) = short[-2:]
    first, last = np.sqrt(-at_before), np.sqrt(-at_low)
    return float(low + BEYOND_FILLET * (low - before) * last / (first - last)) if first > last else 0.0


def _sampled_slack(pair: GearPair, fit: Fit) -> float | None:
    """Compute the least of play and clearances (mm) to some micrometres; None where nothing touches.

    The field samples the rotations of `fit`. The depth of tips in fillets is not known here.
    """
    reach = int(np.ceil(max(map(abs, fit.span)) / pair.pitch)) * LOOKS_PER_PITCH
    phi1: Array = np.arange(-reach, reach).astype(float) * (pair.pitch / LOOKS_PER_PITCH)
    advances, both = [], [solver_pair(own) for own in (pair, reversed_pair(pair))]
    for flanks in both:
        with np.errstate(all="ignore"):
            own = np.max([outlook(part, phi1).best for part in flanks.parts.values()], axis=0)
        every = own.reshape(-1, LOOKS_PER_PITCH).max(axis=0)
        advances.append(np.where(np.isfinite(every), every, np.nan))
    if not np.isfinite(advances).all(axis=0).any():
        return None
    values = (fit.lever * play(pair, advances[0] + advances[1], wound=both[0].wound)).tolist()
    advances[0] = np.append(advances[0], advances[0][0])
    return least(
        values
        + clearances_of(pair, gear_rotations(pair, np.linspace(0.0, pair.pitch, LOOKS_PER_PITCH + 1), advances[0]))
    )
