"""Which key of a design makes its geometry impossible, and how far it would have to be changed.

A tooth that cannot exist is noticed deep in a build, where only defaults and derived values may be at hand. What the owner of
the design wants to know is the key that he set himself. It is found by trying: each of his keys is left out, or moved step by
step, and the one that has to change least, alone, is named with the bound at which the gears can just be built. What was put in
anew is tried first, then the keys that the refusal itself names as remedies; and of what cannot be left out that which counts from
0 to either side, as an offset. A refusal that already names a key that is set, and bounds it, stays if the gears can be built with
that bound. The bound of the key that is named alone is refined. The search ends when it has taken so much
effort: where its bound is not known to ROUGH then, the value that is refused is given as well.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from copy import copy
from dataclasses import dataclass, field, replace
from typing import Any, Generic, NamedTuple, TypeVar

from gearmesh.design.core import Design
from gearmesh.design.dotted import with_keys
from gearmesh.errors import Bounds, DesignError, GearmeshError, NoSolutionError, VagueError, shown_value
from gearmesh.kernel.numeric.effort import Effort, EffortSpentError, limit_effort

D = TypeVar("D", bound=Design)

#: Makes what can be refused of a design.
Build = Callable[[Any], object]
#: Values by dotted keys, in the design's units, of which something was built from a design.
Values = Callable[[Any, object], Mapping[str, Any]]

#: tables whose keys have no part in the geometry
ASIDE = ("fe.", "mesh.", "material.", "contact.phi1.", "measured.")
#: steps away from a value, as parts of it
STEPS = (0.05, 0.25, 0.8)
#: where an interval between a value that is allowed and one that is refused is parted first, from the latter, and then
FIRST, THEN = 0.125, 0.5
#: divisions of it at most, and significant digits of the bound
DIVISIONS, DIGITS = 14, 4
#: of one that no shorter number may take the place of, as many as messages show
SHOWN_DIGITS = 7
#: width of the interval, over the value, which is fine, which is where more than half of the effort is gone, and from which on the
#: bound is only said to be about there
FINE, FAIR, ROUGH = 1e-4, 1.5e-3, 5e-3
#: how far, by a factor either way, and in how many steps a value is looked for in the place of one that is derived
FARTHEST, ASKED = 64.0, 24
#: builds that are tried at most for what mends a design, and for what mends what was noticed of it; keys that are named at most
MOST_TRIALS, MOST_FOR_NOTICED, MOST_NAMED = 80, 30, 2
#: effort of all trials, about the seconds that they take: bounds are as fine as it allows; and the part of one of them, at most
MOST_EFFORT, OF_ONE = 1.9, 0.6
#: effort of a build beside what it counts itself, and of a design that is refused before it is built
OF_BUILD, OF_DESIGN = 0.015, 0.005
#: part of the effort that a build takes, at most, if other keys are looked for that mend as well
LIGHT = 0.022
#: part of it that has to be left for the bound of a second key to be refined
FOR_SECOND = 0.3
#: part of a bound that is not allowed itself by which a value is tried beside it
INSIDE = 1e-5
#: parts of a stated bound that is refused by which values are tried inside it
PARTS_INSIDE = (0.01, 0.02, 0.04, 0.07, 0.12, 0.2, 0.4)
#: first step, as a part of a bound, and how many steps of which each is doubled, towards the other end of what is allowed
FAR_STEP, FAR_STEPS = 0.01, 7
#: units of keys in mm as bounds name them
_UNITS_IN_MM = {"length": "mm", "angle": "deg", "curvature": "1/mm"}
#: keys that are named at most where none alone makes the design infeasible
MOST_TOGETHER = 3


def diagnose(
    design: Design, failure: GearmeshError, build: Build, built_of: Values = lambda design, made: {}
) -> GearmeshError:
    """The refusal of a design with the key in front that its owner set, and a bound of it that was tried; or as it was.

    `built_of` gives the values that keys have which are left out, of what `build` made.

    Where no single key mends the design one is named that mends what was noticed, of which something else is left. The refusal
    stays as it is where it names a key that the design sets, is not vague and has a true bound, and where nothing mends it.
    """
    own = dict(design.own())
    named, stated = [key for key in own if key == failure.key], None
    keys = [key for key, value in own.items() if _movable(key, value)]
    trials = _Trials(type(design), own, build, Effort(MOST_EFFORT), _changed_keys(design, own), built_of=built_of)
    groups = _suspects(design, keys, failure)
    if named:
        failure = _with_value(design, failure, own[failure.key])
        trials.look_inside(failure, _bounds_in_units(design, failure))
        if not isinstance(failure, VagueError | NoSolutionError):
            if failure.key not in keys or trials.hold(failure, _bounds_in_units(design, failure)):
                return failure
            bounded = _with_own_bound(design, failure, trials)
            if bounded is not None:
                return bounded
            # what the refusal allows is refused for something else
            stated, failure = failure, copy(failure)
            failure.allowed = failure.allowed if failure.bounds is None or not failure.reason else ""
    # a bound that is stated of what was noticed says more than another key that mends that alone
    for noticed in (None, failure.topic) if stated is None else (None,):
        trials.ask(noticed)
        intervals: list[_Interval] = []
        for group in groups:
            intervals += trials.leave_out(group) if intervals else trials.mending(group, named, failure.remedies)
            if intervals and not trials.light:
                break
        if intervals:
            break
    else:
        if stated is not None:
            stated = copy(stated)
            stated.allowed += " (another refusal then follows)" if stated.bounds is not None else ""
        return stated or (failure if trials.effort.spent else _together(design, failure, own))
    bounds = trials.refine(intervals)
    if named and failure.remedies.get(failure.key) == 0:
        bounds = [trials.with_far_end(bound) if bound.key == failure.key else bound for bound in bounds]
    first, *others = [_refusal_of(design, bound) for bound in bounds]
    made = DiagnosedNoSolutionError if isinstance(failure, NoSolutionError) else DiagnosedError
    return made(first, tuple(others), failure, whole=noticed is None)


def _with_own_bound(design: Design, failure: GearmeshError, trials: _Trials[Design]) -> GearmeshError | None:
    """The refusal of a key that is set with the bound that builds instead of the one that it states; None if none is found."""
    trials.ask(None)
    intervals = trials.mending([failure.key], [failure.key], {})
    first = next(iter(trials.refine(intervals)), None)
    if first is None or first.value is None:
        return None
    return DiagnosedError(_refusal_of(design, first), (), failure, whole=True)


def _with_value(design: Design, failure: GearmeshError, value: Any) -> GearmeshError:
    """The refusal of a key with the value that the design sets, if it has none."""
    if failure.value is not None or not isinstance(value, int | float) or isinstance(value, bool):
        return failure
    key = type(design).key_at(failure.key)
    made = copy(failure)
    made.value = value if key is None or not key.power else value * design.mm_per_unit**key.power
    made.unit = failure.unit or (_unit(design, failure.key) if key is None or key.power != 1 else "mm")
    return made


def _bounds_in_units(design: Design, failure: GearmeshError) -> Bounds | None:
    """Bounds that a refusal states of its key, in the design's units; None if it states none, or those of another quantity."""
    key, bounds = type(design).key_at(failure.key), failure.bounds
    if key is None or bounds is None or bounds.unit != _UNITS_IN_MM.get(key.unit, ""):
        return None
    scale = design.mm_per_unit**key.power
    low, high = (None if end is None else end / scale for end in (bounds.low, bounds.high))
    return bounds._replace(low=low, high=high)


def _refusal_of(design: Design, bound: KeyBound) -> GearmeshError:
    """The bound of a key as a refusal of its own."""
    value, unit = dict(design.own())[bound.key], _unit(design, bound.key)
    if bound.value is None:
        return DesignError(
            bound.key,
            value,
            unit=unit,
            reason="if it is left out, its derived value gives gears that can be built",
        )
    most = "at least" if bound.larger else "at most"
    allowed = f"{most} {shown_value(float(bound.value), unit)}"
    if bound.far is not None:
        low, high = sorted((float(bound.value), float(bound.far)))
        allowed = f"from {shown_value(low)} to {shown_value(high, unit)}"
    elif bound.rough:
        refused = shown_value(float(f"{bound.refused:.{DIGITS}g}"), unit)
        allowed = f"{most} about {shown_value(float(bound.value), unit)}, {refused} is refused as well"
    return DesignError(bound.key, value, unit=unit, allowed=allowed)


def _suspects(design: Design, keys: list[str], failure: GearmeshError) -> list[list[str]]:
    """Keys in the order in which they are looked at: what was changed before what was in the file; of both first what the refusal
    itself says would mend it; then what belongs to the part that it is about, before the rest."""
    part, new_keys = failure.key, _changed_keys(design, keys)
    remedies = [key for key in failure.remedies if key in keys]
    rest = sorted((key for key in keys if key not in remedies), key=lambda key: not key.startswith(part))
    groups = ([key for key in some if (key in new_keys) is new] for new in (True, False) for some in (remedies, rest))
    return [group for group in groups if group]


def _together(design: Design, failure: GearmeshError, own: dict[str, Any]) -> GearmeshError:
    """The refusal of a design that no single key mends: with the keys of the same member in front that its owner set, if any."""
    member = failure.key.partition(".")[0]
    named = [key for key in own if key.startswith(f"{member}.") and _movable(key, own[key])]
    if not named or failure.key in own:
        return failure
    several = [f"{key} = {shown_value(own[key], _unit(design, key))}" for key in named[:MOST_TOGETHER]]
    made = NoSolutionError if isinstance(failure, NoSolutionError) else DesignError
    together = f"together; no other value of one of them alone is enough: {failure}"
    return made(
        named[0],
        own[named[0]],
        unit=_unit(design, named[0]),
        shown=", ".join(several).partition(" = ")[2],
        reason=together,
    )


def without_one(design: D, build: Build) -> tuple[D, str] | None:
    """A design that can be built and lacks but one of the keys that are set, and that key; None where there is none."""
    trials = _Trials(type(design), dict(design.own()), build, Effort(math.inf))
    for key, value in design.own():
        if _movable(key, value) and trials.works(key, None):
            return trials.design_of({**trials.own, key: None}), key
    return None


class _Diagnosis(GearmeshError):
    """A refusal that names the key which the design sets: as its own fields with a bound of it that was tried, `others` of which
    each mends it as well, and what was `noticed`; unless it is `whole` another refusal then follows."""

    def __init__(
        self, first: GearmeshError, others: tuple[GearmeshError, ...], noticed: GearmeshError, *, whole: bool
    ) -> None:
        super().__init__()
        self.__dict__.update(first.__dict__)
        self.others, self.noticed, self.whole = others, noticed, whole

    @property
    def topic(self) -> str:
        """That of what was noticed."""
        return self.noticed.topic

    def __str__(self) -> str:
        bounds = ", or ".join([super().__str__(), *map(str, self.others)])
        rest = "" if self.whole else " (another refusal then follows)"
        # a key that was named already is named once, and the bound that was tried is the one that holds
        told = copy(self.noticed)
        if self.key == told.key:
            told.allowed = "" if told.reason and told.bounds is not None else told.allowed
            told.key, told.value = "", None
        return ": ".join(part for part in (f"{bounds}, with the other keys unchanged{rest}", str(told)) if part)


class DiagnosedError(_Diagnosis, DesignError):
    """Of a design that cannot be used."""


class DiagnosedNoSolutionError(_Diagnosis, NoSolutionError):
    """Of a design without a solution."""


@dataclass(frozen=True)
class KeyBound:
    """A value of a key that its owner set with which the gears can be built; None: only if the key is left out.

    `refused`: the nearest value that is known to be refused; `larger` is true where the key has to be larger; `far`: the other end
    of the range of values that are allowed, if it was asked for.
    """

    key: str
    value: float | None
    refused: float
    larger: bool
    far: float | None = None

    @property
    def rough(self) -> bool:
        """Whether the true bound may be farther from the value than ROUGH."""
        return self.value is not None and _width(self.value, self.refused) > ROUGH


@dataclass
class _Interval:
    """Between values of a key that are allowed and refused, for one that is set; `good` is None if only leaving it out mends.

    `kept`: it was not put in anew.
    """

    key: str
    own: float
    good: float | None
    bad: float
    kept: bool
    divisions: int = 0

    @property
    def least(self) -> tuple[bool, float]:
        """By how much of itself the key has to change, at least: what was put in anew before what was kept."""
        return self._change(self.bad)

    @property
    def most(self) -> tuple[bool, float]:
        """The same, at most."""
        return self._change(self.good)

    def _change(self, end: float | None) -> tuple[bool, float]:
        if end is None or self.good is None:
            return self.kept, math.inf
        return self.kept, abs(end - self.own) / (max(abs(self.own), abs(end)) or 1.0)

    @property
    def width(self) -> float:
        """Over the larger of both ends."""
        return 0.0 if self.good is None else _width(self.good, self.bad)


class _Outcome(NamedTuple):
    """Whether gears were built, or what their refusal was about; `known`: it was not given up; `made`: what was built."""

    built: bool
    topic: str | None = None
    known: bool = True
    made: object = None


@dataclass
class _Trials(Generic[D]):
    """Builds of a design class with other values of the keys that are set, each tried once; ends when the `effort` is spent.

    If something was `noticed`, the topic of a refusal, a build works that is not refused for that.
    """

    design: type[D]
    own: dict[str, Any]
    build: Build
    effort: Effort
    changed: tuple[str, ...] = ()
    noticed: str | None = None
    count: int = 0
    tried: dict[tuple[str, float | None], _Outcome] = field(default_factory=dict)
    built_of: Values = lambda design, made: {}

    def __post_init__(self) -> None:
        self.allowed = self.effort.left
        #: values within the bound that the refusal of a key states, where that bound is refused
        self._beyond: dict[str, tuple[float, ...]] = {}

    def ask(self, noticed: str | None) -> None:
        """From now on builds work that are not refused for what was `noticed`; None: that are not refused."""
        self.noticed, self.count = noticed, 0

    def hold(self, failure: GearmeshError, bounds: Bounds | None) -> bool:
        """True unless the bounds, in the design's units, are known to be refused, or do not exclude the value of the key.

        A refusal that states no bounds, but words, needs none.
        """
        if bounds is None:
            return failure.bounds is None and not failure.bounds_another
        own: float = self.own[failure.key]
        for end, included, inwards in ((bounds.low, bounds.includes_low, 1), (bounds.high, bounds.includes_high, -1)):
            if end is None or (own - end) * inwards > 0.0 or (included and own == end):
                continue
            apart = 0.0 if included else inwards * (1 if isinstance(own, int) else INSIDE * (abs(end) or 1.0))
            # figures that messages show are rounded inwards
            outcome = self._outcome(failure.key, self._like(failure.key, end + apart), self.effort.left)
            return outcome.built or not outcome.known
        return False

    def look_inside(self, failure: GearmeshError, bounds: Bounds | None) -> None:
        """Note values a little inside the bound that a refusal states of its key, where that key is moved."""
        own = self.own.get(failure.key or "")
        if bounds is None or not isinstance(own, int | float):
            return
        for end, inwards in ((bounds.low, 1), (bounds.high, -1)):
            if end is not None and (own - end) * inwards <= 0.0:
                self._beyond[failure.key] = tuple(
                    self._like(failure.key, end + inwards * part * abs(end)) for part in PARTS_INSIDE
                )

    def mending(self, keys: list[str], named: list[str], remedies: Mapping[str, int]) -> list[_Interval]:
        """Those of the keys that mend the design, alone: `remedies`, of which the direction is known, moved that way."""
        known = {key: remedies[key] for key in keys if remedies.get(key)}
        return list(self.move(list(known), known)) or list(self.leave_out(keys)) or self.otherwise(keys, named)

    def otherwise(self, keys: list[str], named: list[str]) -> list[_Interval]:
        """Those of the keys that mend the design when they are moved, what was `named` first, and where nothing was, what is
        unusual: towards 0 first."""
        unusual = [] if set(keys) & set(named) else [key for key in keys if self._unusual(key)]
        rest = sorted((key for key in keys if key not in unusual), key=lambda key: key not in named)
        to_zero = {key: -1 if self.own[key] > 0.0 else 1 for key in unusual}
        return list(self.move(unusual, to_zero)) or list(self.move(unusual)) or list(self.move(rest))

    def _unusual(self, key: str) -> bool:
        """Whether a number counts from the usual one, 0, to either side, as an offset does; sizes and tooth numbers do not."""
        about = self.design.key_at(key)
        return about is not None and about.low < 0.0 < about.high

    def works(self, key: str, value: float | None) -> bool:
        """Whether the gears can be built with another value of a key, None: with its default."""
        if self.count >= (MOST_TRIALS if self.noticed is None else MOST_FOR_NOTICED) and (key, value) not in self.tried:
            return False
        return self._works(self._outcome(key, value, OF_ONE * self.allowed))

    def _works(self, outcome: _Outcome) -> bool:
        return outcome.built or (outcome.topic is not None and self.noticed not in (None, outcome.topic))

    def _outcome(self, key: str, value: float | None, most: float) -> _Outcome:
        """With at most so much effort."""
        if (key, value) not in self.tried:
            if self.effort.spent:
                return _Outcome(built=False, known=False)
            self.count += 1
            self.tried[key, value] = self._trial(key, value, min(most, self.effort.left))
        return self.tried[key, value]

    def _trial(self, key: str, value: float | None, most: float) -> _Outcome:
        self.effort.left -= OF_DESIGN
        try:
            design = self.design_of({**self.own, key: value})
        except GearmeshError:
            return _Outcome(built=False)
        own = Effort(most - OF_BUILD)
        if own.spent:
            return _Outcome(built=False, known=False)
        try:
            with limit_effort(own):
                made = self.build(design)
        except EffortSpentError:
            return _Outcome(built=False, known=False)
        except GearmeshError as error:
            return _Outcome(built=False, topic=error.topic)
        finally:
            self.effort.left -= most - own.left
        return _Outcome(built=True, made=made if value is None else None)

    def design_of(self, keys: dict[str, Any]) -> D:
        """The design of the keys that are not None."""
        return self.design(**with_keys({}, ((key, value) for key, value in keys.items() if value is not None)))

    def leave_out(self, keys: list[str]) -> Iterator[_Interval]:
        """Of the keys that mend the design when they are left out."""
        for key in keys:
            if not self.works(key, None):
                continue
            default = self._default(key)
            good = default if default is not None and self.works(key, default) else self._beside(key)
            yield self._interval(key, good)

    def move(self, keys: list[str], ways: Mapping[str, int] | None = None) -> Iterator[_Interval]:
        """Of the keys that mend the design when they are larger or smaller, or moved the one way (1 or -1) that is known."""
        for step in STEPS:
            mended = False
            for key in keys:
                for way in (1, -1) if ways is None else (ways[key],):
                    # where builds take long the rest of the effort is for the bound
                    if mended and not self.light:
                        break
                    value = self._step(key, way * step)
                    if value != self.own[key] and self.works(key, value):
                        mended = True
                        yield self._interval(key, value)
            # what has to change less is found first
            if mended:
                return

    def _step(self, key: str, step: float) -> float:
        """A value that is so much of itself larger; of a whole number at least the next."""
        own: float = self.own[key]
        value = own + step * abs(own)
        if not isinstance(own, int):
            return value
        return round(value) if round(value) != own else own + (1 if step > 0.0 else -1)

    def _beside(self, key: str) -> float | None:
        """A value of a key that works, near the bound that its refusal states or within a factor of FARTHEST; None where none is
        found."""
        for value in self._beyond.get(key, ()):
            if self.works(key, value):
                return value
        for step in range(1, ASKED + 1):
            for factor in (FARTHEST ** (step / ASKED), FARTHEST ** (-step / ASKED)):
                value = self._like(key, self.own[key] * factor)
                if self.works(key, value):
                    return value
        return None

    @property
    def light(self) -> bool:
        """Whether builds have taken so little of the effort that others may be looked for that mend as well."""
        return self._half_left and self.allowed - self.effort.left <= LIGHT * self.allowed * len(self.tried)

    @property
    def _half_left(self) -> bool:
        return self.effort.left > 0.5 * self.allowed

    def _default(self, key: str) -> float | None:
        """The number that a key becomes when it is left out, None where there is none."""
        table: Any = self.design_of({**self.own, key: None})
        for name in key.split("."):
            # a table that is left out with its only key has none
            table = getattr(table, name, None)
        if isinstance(table, int | float) and math.isfinite(table):
            return table
        derived = self.built_of(self.design_of({**self.own, key: None}), self.tried[key, None].made).get(key)
        return self._like(key, derived) if isinstance(derived, int | float) and math.isfinite(derived) else None

    def _interval(self, key: str, good: float | None) -> _Interval:
        """Between a value that works and the one that is set, or what is known to be refused beyond it."""
        own, kept = self.own[key], key not in self.changed
        if good is None:
            return _Interval(key, own, None, own, kept)
        low, high = sorted((own, good))
        refused = [
            value
            for (other, value), outcome in self.tried.items()
            if other == key and value is not None and low < value < high and outcome.known and not self._works(outcome)
        ]
        return _Interval(key, own, good, min(refused, key=lambda value: abs(value - good), default=own), kept)

    def refine(self, intervals: list[_Interval]) -> list[KeyBound]:
        """Bounds of the keys that have to change least, as fine as the effort allows; what may have to change least comes first."""
        fine: list[_Interval] = []
        left = list(intervals)
        while left and len(fine) < MOST_NAMED:
            nearest = min(left, key=lambda interval: (interval.least, interval.most))
            if not self._bisect(nearest):
                left = [interval for interval in left if interval.key != nearest.key]
                fine.append(nearest)
            if self.effort.spent or (fine and self.effort.left < FOR_SECOND * self.allowed):
                break
        exact = [interval for interval in fine if interval.width <= ROUGH]
        nearest_of = exact or sorted(fine + left, key=lambda interval: interval.most)[:1]
        return [self._bound(interval) for interval in sorted(nearest_of, key=lambda interval: interval.most)]

    def _bisect(self, of: _Interval) -> bool:
        """Whether an interval that is not fine yet has become narrower."""
        wanted = FINE if self._half_left else FAIR
        if of.good is None or of.width <= wanted or of.divisions >= DIVISIONS or self.effort.spent:
            return False
        share = THEN if of.divisions or of.bad != of.own else FIRST
        of.divisions += 1
        middle = self._like(of.key, of.bad + share * (of.good - of.bad))
        if middle in (of.bad, of.good):
            middle = self._like(of.key, 0.5 * (of.good + of.bad))
        if middle in (of.bad, of.good):
            return False
        outcome = self._outcome(of.key, middle, self.effort.left)
        if self._works(outcome):
            of.good = middle
        elif outcome.known:
            of.bad = middle
        return outcome.known

    def _bound(self, of: _Interval) -> KeyBound:
        """With few digits that work as well."""
        if of.good is None:
            return KeyBound(of.key, None, of.bad, larger=False)
        larger = of.good > of.own
        short = _round(of.good, larger)
        # where no more can be tried it is rounded towards what is allowed all the same
        fits = short != of.good and (self.effort.spent or self._works(self._outcome(of.key, short, self.effort.left)))
        # what is shown of it is not to be beyond it
        return KeyBound(of.key, short if fits else _round(of.good, larger, SHOWN_DIGITS), of.bad, larger)

    def with_far_end(self, bound: KeyBound) -> KeyBound:
        """The bound with the other end of the range of values that work, if one is found within FAR_STEPS doubled steps."""
        if bound.value is None or bound.rough:
            return bound
        good, way = bound.value, 1.0 if bound.larger else -1.0
        for step in range(FAR_STEPS):
            tried = self._like(bound.key, bound.value + way * FAR_STEP * 2.0**step * (abs(bound.value) or 1.0))
            if not self.works(bound.key, tried):
                break
            good = tried
        else:
            return bound
        # whether a bound is larger is whether its key has to be
        own, bad = self.own[bound.key], tried
        interval = _Interval(bound.key, own, good, bad, kept=True, divisions=1)
        while self._bisect(interval):
            pass
        assert interval.good is not None, "it only moves towards what is refused"
        far = _round(interval.good, not bound.larger)
        return replace(bound, far=far) if interval.width <= ROUGH and self.works(bound.key, far) else bound

    def _like(self, key: str, value: float) -> float:
        """A whole number where the key is one."""
        return round(value) if isinstance(self.own[key], int) else value


def _width(good: float, bad: float) -> float:
    """Of an interval, over the larger of its ends; 0 between neighbouring whole numbers."""
    apart = abs(good - bad)
    return 0.0 if isinstance(good, int) and apart <= 1 else apart / (max(abs(good), abs(bad)) or 1.0)


def _changed_keys(design: Design, keys: Iterable[str]) -> tuple[str, ...]:
    """Those of the keys that were put in anew, alone or with their table."""
    tables = tuple(f"{key}." for key in design.changed_keys)
    return tuple(key for key in keys if f"{key}.".startswith(tables))


def _movable(key: str, value: Any) -> bool:
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return number and not key.startswith(ASIDE)


def _round(value: float, up: bool, digits: int = DIGITS) -> float:
    """A number with so many significant digits, rounded up or down."""
    if isinstance(value, int) or value == 0.0 or float(f"{value:.{digits}g}") == value:
        return value
    unit = 10.0 ** (math.floor(math.log10(abs(value))) + 1 - digits)
    return float(f"{(math.ceil if up else math.floor)(value / unit) * unit:.{digits}g}")


def _unit(design: Design, dotted: str) -> str:
    key = type(design).key_at(dotted)
    assert key is not None, "a key that a design sets"
    return {"length": design.units, "angle": "deg"}.get(key.unit, "")
