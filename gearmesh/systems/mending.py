"""Search for keys that, each alone, mend a design that cannot be built, and for their bounds.

Each set key is left out, or moved step by step. The bound of the key that must change least is refined as far as the effort allows.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any, Generic

from gearmesh.systems.key_bounds import ROUGH_WIDTH, SHOWN_DIGITS, Interval, KeyBound, relative_width, round_digits
from gearmesh.systems.trials import DesignT, Trials

#: steps away from a value, over the value
STEP_SHARES = (0.05, 0.25, 0.8)
#: further steps of changed keys, over the value, while the excess of the refused figure falls
FAR_STEP_SHARES = (1.6, 3.2, 6.4)
#: largest number of divisions of an interval
MAX_DIVISIONS = 14
#: wanted width of an interval, over the value
FINE_WIDTH = 1e-4
#: wanted width of an interval, over the value, after half of the effort
FAIR_WIDTH = 1.5e-3
#: largest effort of one division, over the effort that is left
DIVISION_EFFORT_SHARE = 0.4
#: effort of the dearest trial so far times this factor is allowed for one division in any case
DEAREST_TRIAL_FACTOR = 2.0
#: largest factor, up or down, of a value that replaces a derived value
FARTHEST_FACTOR = 64.0
#: number of steps in the search for such a value
ASKED_STEPS = 24
#: largest number of named keys
MAX_NAMED_KEYS = 2
#: largest effort of a build, over the whole effort, for which more keys are searched after one is found
LIGHT_EFFORT_SHARE = 0.09
#: effort, over the whole effort, that the search for more keys leaves for bounds
BOUNDS_EFFORT_SHARE = 0.7
#: effort that must be left, over the whole effort, for refining the bound of a second key
SECOND_KEY_SHARE = 0.3
#: first step from a bound towards the other end of the allowed range, over the bound
FAR_STEP_SHARE = 0.01
#: number of these steps, each twice the step before
FAR_STEPS = 7


class Mending(Generic[DesignT]):
    """Search by trials for keys that mend a design; `changed` are the keys that were changed."""

    def __init__(self, trials: Trials[DesignT], changed: tuple[str, ...] = ()) -> None:
        self.trials, self.changed = trials, changed
        #: values of a key within the bound in its refusal, which may work
        self.inside: dict[str, tuple[float, ...]] = {}

    def keys(self, keys: list[str], named: list[str], remedies: Mapping[str, int]) -> list[Interval]:
        """Return the keys that mend the design alone.

        - `named`: keys that the refusal names
        - `remedies`: known directions, 1 or -1, in which keys mend the design
        """
        known = {key: remedies[key] for key in keys if remedies.get(key)}
        stated = [key for key in keys if key in named and key in self.inside]
        return (
            list(self._to_bound(stated))
            or list(self._move(list(known), known))
            or list(self.leave_out(keys))
            or self._otherwise(keys, named)
        )

    def _to_bound(self, keys: list[str]) -> Iterator[Interval]:
        """Yield the keys that mend the design at the bound in its refusal."""
        for key in keys:
            for value in self.inside[key][:1]:
                if self.trials.is_allowed(self.trials.outcome(key, value)):
                    yield self._interval(key, value)

    def _otherwise(self, keys: list[str], named: list[str]) -> list[Interval]:
        """Return the keys that mend the design when they are moved.

        Named keys come first. Without a named key, keys whose usual value is 0 come first, moved towards 0.
        """
        unusual = [] if set(keys) & set(named) else [key for key in keys if self._unusual(key)]
        rest = sorted((key for key in keys if key not in unusual), key=lambda key: key not in named)
        to_zero = {key: -1 if self.trials.own[key] > 0.0 else 1 for key in unusual}
        return list(self._move(unusual, to_zero)) or list(self._move(unusual)) or list(self._move(rest))

    def _unusual(self, key: str) -> bool:
        """Return True for a key that may be positive or negative, as an offset; sizes and tooth numbers are positive."""
        about = self.trials.design.key_at(key)
        return about is not None and about.low < 0.0 < about.high

    def leave_out(self, keys: list[str], kept_share: float = 0.0) -> Iterator[Interval]:
        """Yield the keys that mend the design when they are left out, until only a share of the effort is left."""
        for key in keys:
            if kept_share and self.trials.effort.left < kept_share * self.trials.allowed:
                return
            if not self.trials.works(key, None):
                continue
            default = self.trials.default(key)
            # the build without the key has proved the default; a value in place of a derived value is proved by its own build
            yield self._interval(key, self._beside(key) if default is None else default, proved=default is None)

    def _move(self, keys: list[str], ways: Mapping[str, int] | None = None) -> Iterator[Interval]:
        """Yield the keys that mend the design when they are larger or smaller, or moved in a known direction, 1 or -1."""
        open_ways: dict[str, tuple[int, ...]] = {key: (1, -1) if ways is None else (ways[key],) for key in keys}
        for step in (*STEP_SHARES, *FAR_STEP_SHARES):
            mended = False
            for key in keys:
                for way in open_ways[key]:
                    # if builds take long, keep the remaining effort for the bound
                    if mended and not self.light:
                        break
                    value = self._step(key, way * step)
                    if value != self.trials.own[key] and self.trials.works(key, value):
                        mended = True
                        yield self._interval(key, value)
            # keys that mend with a smaller step are preferred
            if mended:
                return
            open_ways = {key: self._farther_ways(key, step, tried) for key, tried in open_ways.items()}

    def _farther_ways(self, key: str, step: float, tried: tuple[int, ...]) -> tuple[int, ...]:
        """Return the directions in which a key is moved farther than a step that was tried.

        There are none if the refused figure does not depend on the key. Only changed keys are moved farther than STEP_SHARES,
        in directions in which the excess falls.
        """
        failure = self.trials.failure
        excess = None if failure is None else failure.excess
        outcomes = [self.trials.tried.get((key, self._step(key, way * step))) for way in tried]
        of_steps = [
            outcome.excess if outcome is not None and failure is not None and outcome.topic == failure.topic else None
            for outcome in outcomes
        ]
        if step < STEP_SHARES[-1]:
            return () if excess is not None and all(of_step == excess for of_step in of_steps) else tried
        if excess is None or key not in self.changed:
            return ()
        return tuple(
            way for way, of_step in zip(tried, of_steps, strict=True) if of_step is not None and of_step < excess
        )

    def _step(self, key: str, step: float) -> float:
        """Return a value larger by a share of itself; for a whole number at least the next one."""
        own: float = self.trials.own[key]
        value = own + step * abs(own)
        if not isinstance(own, int):
            return value
        return round(value) if round(value) != own else own + (1 if step > 0.0 else -1)

    def _beside(self, key: str) -> float | None:
        """Return a value of a key that works, inside the bound in its refusal or within FARTHEST_FACTOR; None if none is found."""
        for value in self.inside.get(key, ()):
            if self.trials.works(key, value):
                return value
        ways = [1.0, -1.0]
        for step in range(1, ASKED_STEPS + 1):
            tried = [
                self.trials.like(key, self.trials.own[key] * FARTHEST_FACTOR ** (way * step / ASKED_STEPS))
                for way in ways
            ]
            for value in tried:
                if self.trials.works(key, value):
                    return value
            if len(ways) > 1:
                ways = self._falling_ways(key, tried, ways)
        return None

    def _falling_ways(self, key: str, tried: list[float], ways: list[float]) -> list[float]:
        """Return the directions in which the excess of the refused figure falls, both if the excess is unknown."""
        failure = self.trials.failure
        outcomes = [self.trials.outcome(key, value) for value in tried]
        if failure is None or failure.excess is None or {outcome.topic for outcome in outcomes} != {failure.topic}:
            return ways
        rises = [outcome.excess is not None and outcome.excess >= failure.excess for outcome in outcomes]
        return (
            [way for way, rising in zip(ways, rises, strict=True) if not rising] if any(rises) != all(rises) else ways
        )

    @property
    def light(self) -> bool:
        """True if builds take so little effort that more keys can be searched."""
        allowed, left = self.trials.allowed, self.trials.effort.left
        return self._half_left and allowed - left <= LIGHT_EFFORT_SHARE * allowed * len(self.trials.tried)

    @property
    def _half_left(self) -> bool:
        return self.trials.effort.left > 0.5 * self.trials.allowed

    def _interval(self, key: str, good: float | None, *, proved: bool = True) -> Interval:
        """Return the interval between a value that works and the nearest value known to be refused, or the set value."""
        own, kept = self.trials.own[key], key not in self.changed
        if good is None:
            return Interval(key, own, None, own, kept)
        low, high = sorted((own, good))
        refused = [value for value in self.trials.refused_values(key) if low < value < high]
        bad = min(refused, key=lambda value: abs(value - good), default=own)
        return Interval(key, own, good, bad, kept, proved=proved)

    # ---------------------------------------------------------------- bounds

    def refine(self, intervals: list[Interval]) -> list[KeyBound]:
        """Return the bounds of the keys that must change least, refined as far as the effort allows, the least change first."""
        fine: list[Interval] = []
        left, effort = list(intervals), self.trials.effort
        while left and len(fine) < MAX_NAMED_KEYS:
            nearest = min(left, key=lambda interval: (interval.least, interval.most))
            if not self._divide(nearest):
                left = [interval for interval in left if interval.key != nearest.key]
                fine.append(nearest)
            if effort.spent or (fine and effort.left < SECOND_KEY_SHARE * self.trials.allowed):
                break
        # the interval whose division the effort ended may be narrow enough as well
        exact = [interval for interval in fine + left if interval.width <= ROUGH_WIDTH][:MAX_NAMED_KEYS]
        nearest_of = exact or sorted(fine + left, key=lambda interval: interval.most)[:1]
        # the key that the refusal names says most, then the key that changes least
        refused = None if self.trials.failure is None else self.trials.failure.key
        order = sorted(nearest_of, key=lambda interval: (interval.key != refused, interval.most))
        return [self._bound(interval) for interval in order]

    def _divide(self, of: Interval) -> bool:
        """Divide an interval; return False if it is fine enough or cannot be divided."""
        wanted = FINE_WIDTH if self._half_left else FAIR_WIDTH
        if of.good is None or of.divisions >= MAX_DIVISIONS or self.trials.effort.spent:
            return False
        if relative_width(of.good, of.end) <= wanted:
            return False
        value = self._short(of, of.divide(self.trials.excesses(of.key, of.bad, of.good), wanted))
        if value is None:
            return False
        # a trial that takes much longer than those before it is not worth its effort
        most = max(DIVISION_EFFORT_SHARE * self.trials.effort.left, DEAREST_TRIAL_FACTOR * self.trials.dearest)
        outcome = self.trials.outcome(of.key, value, most)
        if outcome.known:
            of.narrow(value, allowed=self.trials.is_allowed(outcome))
        else:
            of.given_up = value
        return True

    def _short(self, of: Interval, value: float) -> float | None:
        """Return a number next to a value and between the ends of an interval, with few digits; None if there is none."""
        assert of.good is not None, "an interval between two values"
        low, high = sorted((of.end, of.good))
        for aim in (value, 0.5 * (low + high)):
            for up in (aim < 0.0, aim >= 0.0):
                short = round_digits(self.trials.like(of.key, aim), up)
                if low < short < high:
                    return short
        return None

    def _bound(self, of: Interval) -> KeyBound:
        """Return the bound of an interval, with few digits if the shorter value works, too."""
        if of.good is not None and not of.proved:
            outcome = self.trials.outcome(of.key, of.good)
            # it works as a default alone
            if outcome.known and not self.trials.is_allowed(outcome):
                of.good = None
        if of.good is None:
            return KeyBound(of.key, None, of.bad, larger=False)
        larger = of.good > of.own
        short = round_digits(of.good, larger)
        # without effort for a trial, still round towards the allowed values
        spent = self.trials.effort.spent
        fits = short != of.good and (spent or self.trials.is_allowed(self.trials.outcome(of.key, short)))
        # the digits that messages show must not exceed the bound
        return KeyBound(of.key, short if fits else round_digits(of.good, larger, SHOWN_DIGITS), of.bad, larger)

    def with_far_end(self, bound: KeyBound) -> KeyBound:
        """Return the bound with the other end of the allowed range, if it is found within FAR_STEPS doubled steps."""
        if bound.value is None or bound.rough:
            return bound
        good, way = bound.value, 1.0 if bound.larger else -1.0
        for step in range(FAR_STEPS):
            tried = self.trials.like(
                bound.key, bound.value + way * FAR_STEP_SHARE * 2.0**step * (abs(bound.value) or 1.0)
            )
            if not self.trials.works(bound.key, tried):
                break
            good = tried
        else:
            return bound
        # refine the far end; the sense of rounding is opposite to the sense of the bound
        own: Any = self.trials.own[bound.key]
        interval = Interval(bound.key, own, good, tried, kept=True, divisions=1)
        while self._divide(interval):
            pass
        assert interval.good is not None, "it only moves towards what is refused"
        far = round_digits(interval.good, not bound.larger)
        return replace(bound, far=far) if interval.width <= ROUGH_WIDTH and self.trials.works(bound.key, far) else bound
