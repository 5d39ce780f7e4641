"""Keys that mend a design which cannot be built, alone, and how far they have to change.

Each key that the design sets is left out, or moved step by step. Of the keys that mend it the one that has to change least is
refined to a bound, as fine as the effort allows.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any, Generic

from gearmesh.systems.key_bounds import ROUGH, SHOWN_DIGITS, Interval, KeyBound, round_digits
from gearmesh.systems.trials import D, Trials

#: steps away from a value, as parts of it
STEPS = (0.05, 0.25, 0.8)
#: divisions of an interval at most
DIVISIONS = 14
#: width of an interval, over the value, which is fine, and which is where more than half of the effort is gone
FINE, FAIR = 1e-4, 1.5e-3
#: how far, by a factor either way, and in how many steps a value is looked for in the place of one that is derived
FARTHEST, ASKED = 64.0, 24
#: keys that are named at most
MOST_NAMED = 2
#: part of the effort that a build takes, at most, if other keys are looked for that mend as well
LIGHT = 0.03
#: part of it that has to be left for the bound of a second key to be refined
FOR_SECOND = 0.3
#: first step, as a part of a bound, and how many steps of which each is doubled, towards the other end of what is allowed
FAR_STEP, FAR_STEPS = 0.01, 7


class Mending(Generic[D]):
    """Searches for keys that mend a design, by trials; `changed`: keys that were put in anew; `inside`: values of a key that may
    work, within a bound that its refusal states."""

    def __init__(self, trials: Trials[D], changed: tuple[str, ...] = ()) -> None:
        self.trials, self.changed = trials, changed
        self.inside: dict[str, tuple[float, ...]] = {}

    def keys(self, keys: list[str], named: list[str], remedies: Mapping[str, int]) -> list[Interval]:
        """Those of the keys that mend the design, alone: `remedies`, of which the direction is known, moved that way."""
        known = {key: remedies[key] for key in keys if remedies.get(key)}
        stated = [key for key in keys if key in named and key in self.inside]
        return (
            list(self._to_bound(stated))
            or list(self._move(list(known), known))
            or list(self.leave_out(keys))
            or self._otherwise(keys, named)
        )

    def _to_bound(self, keys: list[str]) -> Iterator[Interval]:
        """Those of the keys that mend the design at the bound that its refusal states."""
        for key in keys:
            for value in self.inside[key][:1]:
                if self.trials.is_allowed(self.trials.outcome(key, value)):
                    yield self._interval(key, value)

    def _otherwise(self, keys: list[str], named: list[str]) -> list[Interval]:
        """Those of the keys that mend the design when they are moved, what was `named` first, and where nothing was, what is
        unusual: towards 0 first."""
        unusual = [] if set(keys) & set(named) else [key for key in keys if self._unusual(key)]
        rest = sorted((key for key in keys if key not in unusual), key=lambda key: key not in named)
        to_zero = {key: -1 if self.trials.own[key] > 0.0 else 1 for key in unusual}
        return list(self._move(unusual, to_zero)) or list(self._move(unusual)) or list(self._move(rest))

    def _unusual(self, key: str) -> bool:
        """Whether a number counts from the usual one, 0, to either side, as an offset does; sizes and tooth numbers do not."""
        about = self.trials.design.key_at(key)
        return about is not None and about.low < 0.0 < about.high

    def leave_out(self, keys: list[str]) -> Iterator[Interval]:
        """Those of the keys that mend the design when they are left out."""
        for key in keys:
            if not self.trials.works(key, None):
                continue
            default = self.trials.default(key)
            # gears of the default have just been built
            yield self._interval(key, self._beside(key) if default is None else default, proved=default is None)

    def _move(self, keys: list[str], ways: Mapping[str, int] | None = None) -> Iterator[Interval]:
        """Those of the keys that mend the design when they are larger or smaller, or moved the one way (1 or -1) that is known."""
        for step in STEPS:
            mended = False
            for key in keys:
                for way in (1, -1) if ways is None else (ways[key],):
                    # where builds take long the rest of the effort is for the bound
                    if mended and not self.light:
                        break
                    value = self._step(key, way * step)
                    if value != self.trials.own[key] and self.trials.works(key, value):
                        mended = True
                        yield self._interval(key, value)
            # what has to change less is found first
            if mended:
                return

    def _step(self, key: str, step: float) -> float:
        """A value that is so much of itself larger; of a whole number at least the next."""
        own: float = self.trials.own[key]
        value = own + step * abs(own)
        if not isinstance(own, int):
            return value
        return round(value) if round(value) != own else own + (1 if step > 0.0 else -1)

    def _beside(self, key: str) -> float | None:
        """A value of a key that works, near the bound that its refusal states or within a factor of FARTHEST; None where none is
        found."""
        for value in self.inside.get(key, ()):
            if self.trials.works(key, value):
                return value
        ways = [1.0, -1.0]
        for step in range(1, ASKED + 1):
            tried = [self.trials.like(key, self.trials.own[key] * FARTHEST ** (way * step / ASKED)) for way in ways]
            for value in tried:
                if self.trials.works(key, value):
                    return value
            if len(ways) > 1:
                ways = self._falling_ways(key, tried, ways)
        return None

    def _falling_ways(self, key: str, tried: list[float], ways: list[float]) -> list[float]:
        """The way in which the excess of what is in the way falls; both where no figure says so."""
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
        """Whether builds have taken so little of the effort that others may be looked for that mend as well."""
        allowed, left = self.trials.allowed, self.trials.effort.left
        return self._half_left and allowed - left <= LIGHT * allowed * len(self.trials.tried)

    @property
    def _half_left(self) -> bool:
        return self.trials.effort.left > 0.5 * self.trials.allowed

    def _interval(self, key: str, good: float | None, *, proved: bool = True) -> Interval:
        """Between a value that works and the one that is set, or what is known to be refused beyond it."""
        own, kept = self.trials.own[key], key not in self.changed
        if good is None:
            return Interval(key, own, None, own, kept)
        low, high = sorted((own, good))
        refused = [value for value in self.trials.refused_values(key) if low < value < high]
        bad = min(refused, key=lambda value: abs(value - good), default=own)
        return Interval(key, own, good, bad, kept, proved=proved)

    # ---------------------------------------------------------------- bounds

    def refine(self, intervals: list[Interval]) -> list[KeyBound]:
        """Bounds of the keys that have to change least, as fine as the effort allows; what may have to change least comes first."""
        fine: list[Interval] = []
        left, effort = list(intervals), self.trials.effort
        while left and len(fine) < MOST_NAMED:
            nearest = min(left, key=lambda interval: (interval.least, interval.most))
            if not self._divide(nearest):
                left = [interval for interval in left if interval.key != nearest.key]
                fine.append(nearest)
            if effort.spent or (fine and effort.left < FOR_SECOND * self.trials.allowed):
                break
        exact = [interval for interval in fine if interval.width <= ROUGH]
        nearest_of = exact or sorted(fine + left, key=lambda interval: interval.most)[:1]
        return [self._bound(interval) for interval in sorted(nearest_of, key=lambda interval: interval.most)]

    def _divide(self, of: Interval) -> bool:
        """Whether an interval that is not fine yet has become narrower."""
        wanted = FINE if self._half_left else FAIR
        if of.good is None or of.width <= wanted or of.divisions >= DIVISIONS or self.trials.effort.spent:
            return False
        value = self._short(of, of.divide(self.trials.excesses(of.key, of.bad, of.good), wanted))
        if value is None:
            return False
        outcome = self.trials.outcome(of.key, value)
        if outcome.known:
            of.narrow(value, allowed=self.trials.is_allowed(outcome))
        return outcome.known

    def _short(self, of: Interval, value: float) -> float | None:
        """A number between the ends of an interval next to a value, with as few digits as bounds have; None where there is none."""
        assert of.good is not None, "an interval between two values"
        low, high = sorted((of.bad, of.good))
        for aim in (value, 0.5 * (low + high)):
            for up in (aim < 0.0, aim >= 0.0):
                short = round_digits(self.trials.like(of.key, aim), up)
                if low < short < high:
                    return short
        return None

    def _bound(self, of: Interval) -> KeyBound:
        """With few digits that work as well."""
        if of.good is not None and not of.proved and not self.trials.works(of.key, of.good):
            # it works as a default alone
            of.good = None
        if of.good is None:
            return KeyBound(of.key, None, of.bad, larger=False)
        larger = of.good > of.own
        short = round_digits(of.good, larger)
        # where no more can be tried it is rounded towards what is allowed all the same
        spent = self.trials.effort.spent
        fits = short != of.good and (spent or self.trials.is_allowed(self.trials.outcome(of.key, short)))
        # what is shown of it is not to be beyond it
        return KeyBound(of.key, short if fits else round_digits(of.good, larger, SHOWN_DIGITS), of.bad, larger)

    def with_far_end(self, bound: KeyBound) -> KeyBound:
        """The bound with the other end of the range of values that work, if one is found within FAR_STEPS doubled steps."""
        if bound.value is None or bound.rough:
            return bound
        good, way = bound.value, 1.0 if bound.larger else -1.0
        for step in range(FAR_STEPS):
            tried = self.trials.like(bound.key, bound.value + way * FAR_STEP * 2.0**step * (abs(bound.value) or 1.0))
            if not self.trials.works(bound.key, tried):
                break
            good = tried
        else:
            return bound
        # whether a bound is larger is whether its key has to be
        own: Any = self.trials.own[bound.key]
        interval = Interval(bound.key, own, good, tried, kept=True, divisions=1)
        while self._divide(interval):
            pass
        assert interval.good is not None, "it only moves towards what is refused"
        far = round_digits(interval.good, not bound.larger)
        return replace(bound, far=far) if interval.width <= ROUGH and self.trials.works(bound.key, far) else bound
