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
from collections.abc import Iterable, Iterator
from copy import copy
from typing import Any, TypeVar

from gearmesh.design.core import Design
from gearmesh.errors import Bounds, DesignError, GearmeshError, NoSolutionError, VagueError, shown_value
from gearmesh.kernel.numeric.effort import Effort
from gearmesh.systems.key_bounds import DIGITS, Interval, KeyBound
from gearmesh.systems.mending import Mending
from gearmesh.systems.trials import Build, Trials, Values, movable

D = TypeVar("D", bound=Design)

#: effort of all trials, about the seconds that they take: bounds are as fine as it allows
MOST_EFFORT = 1.8
#: part of a bound that is not allowed itself by which a value is tried beside it
INSIDE = 1e-5
#: parts of a stated bound that is refused by which values are tried inside it
PARTS_INSIDE = (0.01, 0.02, 0.04, 0.07, 0.12, 0.2, 0.4)
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
    named = failure.key in own
    failure = _with_value(design, failure, own[failure.key]) if named else failure
    trials = Trials(type(design), own, build, Effort(MOST_EFFORT), failure, built_of)
    mending = Mending(trials, _changed_keys(design, own))
    if named:
        mending.inside[failure.key] = _values_inside(design, failure, trials)
    # a bound that is stated of a key which is set
    stated = named and not isinstance(failure, VagueError | NoSolutionError)
    if stated:
        kept = _with_true_bound(design, failure, mending)
        if kept is not None:
            return kept
    # where what the refusal allows is refused for something else its bound says more than another key that mends that alone
    told = _without_bounds(failure) if stated else failure
    mending_keys, whole = _that_mend(design, told, mending, partly=not stated)
    if mending_keys:
        return _with_bounds(design, told, mending, mending_keys, whole=whole)
    if stated:
        return _with_note(failure)
    return failure if trials.effort.spent else _together(design, failure, own)


# ---------------------------------------------------------------- bounds that refusals state


def _with_true_bound(design: Design, failure: GearmeshError, mending: Mending[Design]) -> GearmeshError | None:
    """The refusal of a key that is set as it is, if its bound builds, or with a bound of that key that builds; None if none is
    found."""
    trials = mending.trials
    if not movable(failure.key, trials.own[failure.key]) or _holds(design, failure, trials):
        return failure
    trials.ask(None)
    first = next(iter(mending.refine(mending.keys([failure.key], [failure.key], {}))), None)
    if first is None or first.value is None:
        return None
    return DiagnosedError(_refusal_of(design, first), (), failure, whole=True)


def _holds(design: Design, failure: GearmeshError, trials: Trials[Design]) -> bool:
    """True unless the bounds that a refusal states are known to be refused, or do not exclude the value of the key.

    A refusal that states no bounds, but words, needs none.
    """
    bounds = _bounds_in_units(design, failure)
    if bounds is None:
        return failure.bounds is None and not failure.bounds_another
    for value in _ends_of(bounds, trials.own[failure.key]):
        outcome = trials.outcome(failure.key, trials.like(failure.key, value))
        return outcome.built or not outcome.known
    return False


def _ends_of(bounds: Bounds, own: float) -> Iterator[float]:
    """The values nearest to a refused one that bounds allow; figures that messages show are rounded inwards."""
    for end, included, inwards in ((bounds.low, bounds.includes_low, 1), (bounds.high, bounds.includes_high, -1)):
        if end is None or (own - end) * inwards > 0.0 or (included and own == end):
            continue
        yield end if included else end + inwards * (1 if isinstance(own, int) else INSIDE * (abs(end) or 1.0))


def _values_inside(design: Design, failure: GearmeshError, trials: Trials[Design]) -> tuple[float, ...]:
    """Values at the bounds that a refusal states of its key, and a little inside them."""
    own, bounds = trials.own[failure.key], _bounds_in_units(design, failure)
    if bounds is None or not isinstance(own, int | float):
        return ()
    values = [
        end + math.copysign(part * end, end - own) for end in _ends_of(bounds, own) for part in (0.0, *PARTS_INSIDE)
    ]
    return tuple(trials.like(failure.key, value) for value in values)


def _without_bounds(failure: GearmeshError) -> GearmeshError:
    """The refusal without the bounds that it states, if it has a reason beside them."""
    made = copy(failure)
    made.allowed = made.allowed if made.bounds is None or not made.reason else ""
    return made


def _with_note(failure: GearmeshError) -> GearmeshError:
    """The refusal, of which another follows within its bounds."""
    made = copy(failure)
    made.allowed += " (another refusal then follows)" if made.bounds is not None else ""
    return made


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


# ---------------------------------------------------------------- keys that mend


def _that_mend(
    design: Design, failure: GearmeshError, mending: Mending[Design], *, partly: bool
) -> tuple[list[Interval], bool]:
    """Keys that mend a design, alone, and whether they do so wholly; `partly`: keys will do that mend what was noticed."""
    trials, intervals = mending.trials, list[Interval]()
    keys = [key for key, value in trials.own.items() if movable(key, value)]
    named = [key for key in trials.own if key == failure.key]
    groups = _suspects(design, keys, failure)
    for noticed in (None, failure.topic) if partly else (None,):
        trials.ask(noticed)
        for group in groups:
            intervals += mending.leave_out(group) if intervals else mending.keys(group, named, failure.remedies)
            if intervals and not mending.light:
                break
        if intervals:
            return intervals, noticed is None
    return [], False


def _with_bounds(
    design: Design, failure: GearmeshError, mending: Mending[Design], intervals: list[Interval], *, whole: bool
) -> GearmeshError:
    """The refusal with the bounds of keys that mend the design in front."""
    bounds = mending.refine(intervals)
    if failure.remedies.get(failure.key) == 0:
        bounds = [mending.with_far_end(bound) if bound.key == failure.key else bound for bound in bounds]
    first, *others = [_refusal_of(design, bound) for bound in bounds]
    made = DiagnosedNoSolutionError if isinstance(failure, NoSolutionError) else DiagnosedError
    return made(first, tuple(others), failure, whole=whole)


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
    named = [key for key in own if key.startswith(f"{member}.") and movable(key, own[key])]
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
    trials = Trials(type(design), dict(design.own()), build, Effort(math.inf))
    for key, value in design.own():
        if movable(key, value) and trials.works(key, None):
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


def _changed_keys(design: Design, keys: Iterable[str]) -> tuple[str, ...]:
    """Those of the keys that were put in anew, alone or with their table."""
    tables = tuple(f"{key}." for key in design.changed_keys)
    return tuple(key for key in keys if f"{key}.".startswith(tables))


def _unit(design: Design, dotted: str) -> str:
    key = type(design).key_at(dotted)
    assert key is not None, "a key that a design sets"
    return key.unit_in(design.units) if key.unit in _UNITS_IN_MM else ""
