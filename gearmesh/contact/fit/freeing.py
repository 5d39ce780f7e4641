"""The least movement of the gear that frees a pair from interference.

The slack, the distance left before anything interferes, is signed: negative where teeth overlap, positive where they are free. Its
sign changes between a shift that does not free the pair and one that does, and the bracket of both is closed to a hundredth. Where
a tip leaves a fillet the slack jumps from 0 to the backlash; so the sign changes by what overlaps. The search ends when its effort
is spent: the answer is then the least shift that was found to free the pair, if there is one.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from gearmesh.contact.engagement.engagement import LOOKS
from gearmesh.contact.first_touch.field import outlook
from gearmesh.contact.fit.fit import (
    NOTHING,
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

#: apart by less (mm) are axes that meet
APART = 1e-6
#: part of the shift within which it is the smallest, and mm that count as none
TIGHT, LEAST = 0.008, 2e-5
#: shifts that are tried at most as teeth touch, and by what the field samples; part of the slack that is near enough to none there
TRIES, SAMPLED_TRIES, NEAR = 24, 8, 0.03
#: effort of the whole search, about the seconds that it takes; of one slack as teeth touch, and of one that the field samples,
#: beside what these count themselves
MOST_EFFORT, OF_SLACK, OF_SAMPLED = 2.0, 0.4, 0.04
#: part of the way to where a tip leaves a fillet by which a shift goes there, and a little beyond
BEYOND_FILLET = 1.15


def shift_gear(pair: GearPair, shift: float) -> GearPair:
    """The pair with its gear moved by `shift` (mm) along `direction`."""
    mount = pair.gear.mount
    away = Rigid(np.eye(3), shift * direction(pair))
    return replace(pair, gear=replace(pair.gear, mount=replace(mount, base=away @ mount.base)))


def direction(pair: GearPair) -> Array:
    """Unit vector (3,), fixed frame, along which gears are brought apart: from axis to axis; the gear's own, where these meet."""
    first, second = pair.mounts
    common, between = np.cross(first.axis, second.axis), second.origin - first.origin
    length = float(np.linalg.norm(common))
    along = (between @ first.axis) * first.axis
    across = between - along if length < MAX_SINE_OF_PARALLEL else (between @ common) * common / length**2
    apart = float(np.linalg.norm(across))
    return across / apart if apart > APART else second.axis


class FreeingShift(NamedTuple):
    """Movement of the gear along `direction`, `length` (mm), that frees a pair; `least`: no shorter one does, within TIGHT."""

    length: float
    least: bool


def freeing_shift(pair: GearPair, fit: Fit, most_effort: float = MOST_EFFORT) -> FreeingShift | None:
    """The least movement of the gear for the pair to fit, or what was found with so much effort; None where moving does not help.

    Where to begin, and by how much more a shift leaves, is estimated from the play that the field samples.
    """
    if not np.isfinite(fit.slack):
        return None
    effort = Effort(most_effort)

    def limit_slack(slack: Callable[[GearPair], float | None], at_least: float, standing: GearPair) -> float | None:
        """A slack that takes so much effort `at_least`; raises EffortSpentError where none is left."""
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
                lambda at: limit_slack(lambda moved: _sampled_slack(moved, fit), OF_SAMPLED, standing(at)),
                max(0.5 * abs(fit.slack), 1e-3),
            )
        except EffortSpentError:
            return None
        shift = (
            None
            if begin is None
            else _least_shift(lambda at: limit_slack(slack_of, OF_SLACK, standing(at)), fit.slack, *begin)
        )
        if shift is not None:
            return shift._replace(length=sense * shift.length)
    return None


def _begin(slack: Callable[[float], float | None], first: float) -> tuple[float, float] | None:
    """The shift (mm) at which a sampled `slack` (mm) is about 0, by secants from `first` on, and its slope; None where moving does
    not help. Where there is slack already, `first` itself."""
    low, at_low = 0.0, slack(0.0)
    if at_low is None:
        return None
    enough, high = NEAR * at_low, first
    for _ in range(SAMPLED_TRIES):
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
    """The least shift at which a `slack` (mm) that is `start` at 0 is not negative any more, tried at `at` first; `slope` of
    the play, as far as it is known. None where slack does not grow."""
    short, high, at_high, width = [(0.0, start)], np.inf, np.inf, np.inf
    for _ in range(TRIES):
        try:
            there = slack(at)
        except EffortSpentError:
            break
        if there is None:
            break
        if there >= -NOTHING:
            high, at_high = at, there
        elif np.isinf(high) and not there > short[-1][1]:
            return None
        else:
            short.append((at, there))
        low, tight = short[-1][0], max(TIGHT * min(at, high), LEAST)
        # where play alone is in the way, its slope tells how far it is from 0
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
    """About where the slack is 0, from shifts (mm) that fall short, with their slacks (mm), and one that frees; `slope` of the
    play."""
    (low, at_low), (high, at_high) = short[-1], free
    if len(short) > 2:
        before, at_before = short[-2]
        slope = (at_low - at_before) / (low - before)
        if at_high > 2.0 * slope * (high - low) > 0.0:
            # a tip leaves a fillet ever more slowly: about with the square of what is left
            slope = 0.5 * slope
    elif at_high < -at_low:
        return high - at_high / slope
    return low - at_low / slope if slope > 0.0 else low


def _left_fillet(short: list[tuple[float, float]]) -> float:
    """About where a tip has left a fillet, from the last two shifts (mm) that fall short: its depth falls with the square of what
    is left of the shift; 0 before there are two."""
    if len(short) < 3:
        return 0.0
    (before, at_before), (low, at_low) = short[-2:]
    first, last = np.sqrt(-at_before), np.sqrt(-at_low)
    return float(low + BEYOND_FILLET * (low - before) * last / (first - last)) if first > last else 0.0


def _sampled_slack(pair: GearPair, fit: Fit) -> float | None:
    """Play and clearances (mm, the least) to some micrometres, by what the field samples over the same rotations as where a fit was
    `fit`; None where nothing touches. It does not know how deep tips are in fillets."""
    reach = int(np.ceil(max(map(abs, fit.span)) / pair.pitch)) * LOOKS
    phi1: Array = np.arange(-reach, reach).astype(float) * (pair.pitch / LOOKS)
    advances, both = [], [solver_pair(own) for own in (pair, reversed_pair(pair))]
    for flanks in both:
        with np.errstate(all="ignore"):
            own = np.max([outlook(part, phi1).best for part in flanks.parts.values()], axis=0)
        every = own.reshape(-1, LOOKS).max(axis=0)
        advances.append(np.where(np.isfinite(every), every, np.nan))
    if not np.isfinite(advances).all(axis=0).any():
        return None
    values = (fit.lever * play(pair, advances[0] + advances[1], wound=both[0].wound)).tolist()
    advances[0] = np.append(advances[0], advances[0][0])
    return least(
        values + clearances_of(pair, gear_rotations(pair, np.linspace(0.0, pair.pitch, LOOKS + 1), advances[0]))
    )
