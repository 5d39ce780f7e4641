"""Search for the key that makes a design infeasible, and for the bound at which the gears can just be built.

A tooth that cannot exist is noticed deep in a build, where only defaults and derived values may be known. The user needs to know
which of the keys in the design to change. The search tries builds: each set key is left out, or moved step by step. The key that
must change least, alone, is named with its bound.

- Keys that were changed last are tried first, then the remedies that the refusal names.
- Among keys that cannot be left out, keys whose usual value is 0, as offsets, are tried first.
- A refusal that names a set key with a bound stays if the gears can be built at this bound.
- Only the bound of the named key is refined. The search ends when its effort is spent. If the bound is not known within ROUGH_WIDTH
  then, the message also gives the refused value.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from copy import copy
from typing import Any, TypeVar

from gearmesh.allowed import Bounds
from gearmesh.design.core import Design
from gearmesh.design.dotted import empty_tables
from gearmesh.errors import DesignError, GearmeshError, NoSolutionError, VagueError, shown_value
from gearmesh.kernel.numeric.effort import Effort, limit_effort
from gearmesh.systems.key_bounds import BOUND_DIGITS, Interval, KeyBound
from gearmesh.systems.mending import BOUNDS_EFFORT_SHARE, Mending
from gearmesh.systems.trials import Build, Trials, Values, movable

DesignT = TypeVar("DesignT", bound=Design)

#: effort of the reason and of all trials, about their time in seconds: it limits the accuracy of bounds
MAX_EFFORT = 1.8
#: largest effort of a reason with a bound
MAX_REASON_EFFORT = 1.75
#: the same for a vague refusal, for which other keys are tried all the same
MAX_VAGUE_REASON_EFFORT = 0.3
#: distance from an excluded bound at which a value is tried, over the bound
INSIDE_SHARE = 1e-5
#: distances inside a stated bound at which values are tried, over the bound
INWARD_SHARES = (0.01, 0.02, 0.04, 0.07, 0.12, 0.2, 0.4)
#: units of bounds in mm, by the units of keys
_UNITS_IN_MM = {"length": "mm", "angle": "deg", "curvature": "1/mm"}
#: largest number of named keys if no single key makes the design infeasible
MAX_KEYS_TOGETHER = 3


def diagnose(
    design: Design, failure: GearmeshError, build: Build, built_of: Values = lambda design, made: {}
) -> GearmeshError:
    """Return the refusal of a design that begins with a key set in the design and its bound, or the given refusal.

    - `build`: builds a design, or raises
    - `built_of`: returns the values of left-out keys, from a design and the result of `build`

    If no single key mends the design, a key is named that mends the reported fault although another fault remains. The given
    refusal stays if it names a set key with a true bound, or if nothing mends the design.
    """
    own = dict(design.own())
    effort = Effort(MAX_EFFORT)
    _tell_reason(failure, effort)
    named = failure.key in own
    failure = with_set_value(design, failure)
    trials = Trials(type(design), own, build, effort, empty_tables(design.stated()), failure, built_of)
    mending = Mending(trials, _changed_keys(design, own))
    if named:
        mending.inside[failure.key] = _values_inside(design, failure, trials)
    # the refusal states a bound of a set key: keep the bound if it builds, or correct it
    stated = named and not isinstance(failure, VagueError | NoSolutionError)
    if stated:
        kept = _with_true_bound(design, failure, mending)
        if kept is not None:
            return kept
    # if the allowed values are refused for another fault, the stated bound says more than a key that mends only the other fault
    told = _without_bounds(failure) if stated else failure
    mending_keys, whole = _that_mend(design, told, mending, partly=not stated)
    if mending_keys:
        return _with_bounds(design, told, mending, mending_keys, whole=whole)
    if stated:
        return _with_note(failure)
    if trials.effort.spent:
        # a bound of values that follow from others is not stated of the key itself without a trial
        return _without_bounds(failure) if named and isinstance(failure, VagueError) else failure
    return _together(design, failure, own)


def _tell_reason(failure: GearmeshError, effort: Effort) -> None:
    """Compute the fields of a refusal that are computed when they are read. Bounds that take too long are left out."""
    allowed = MAX_VAGUE_REASON_EFFORT if isinstance(failure, VagueError) else MAX_REASON_EFFORT
    own = Effort(allowed)
    with limit_effort(own):
        _ = failure.key
    effort.left = max(effort.left - (allowed - own.left), 0.0)


# ---------------------------------------------------------------- bounds that refusals state


def _with_true_bound(design: Design, failure: GearmeshError, mending: Mending[Design]) -> GearmeshError | None:
    """Return the refusal of a set key if its bound builds, or with a bound that builds; None if none is found."""
    trials = mending.trials
    if not movable(failure.key, trials.own[failure.key]) or _holds(design, failure, trials):
        return failure
    trials.ask(None)
    first = next(iter(mending.refine(mending.keys([failure.key], [failure.key], {}))), None)
    if first is None or first.value is None:
        return None
    return DiagnosedError(_refusal_of(design, first), (), failure, whole=True)


def _holds(design: Design, failure: GearmeshError, trials: Trials[Design]) -> bool:
    """Return True unless the bounds in a refusal are known to be refused, or do not exclude the key's value.

    True for a refusal with words in the place of bounds.
    """
    bounds = _bounds_in_units(design, failure)
    if bounds is None:
        return failure.bounds is None and not failure.bounds_another
    for value in _ends_of(bounds, trials.own[failure.key]):
        outcome = trials.outcome(failure.key, trials.like(failure.key, value))
        return outcome.built or not outcome.known
    return False


def _ends_of(bounds: Bounds, own: float) -> Iterator[float]:
    """Yield the allowed values of bounds nearest to the refused value `own`, slightly inside excluded bounds."""
    for end, included, inwards in ((bounds.low, bounds.includes_low, 1), (bounds.high, bounds.includes_high, -1)):
        if end is None or (own - end) * inwards > 0.0 or (included and own == end):
            continue
        yield end if included else end + inwards * (1 if isinstance(own, int) else INSIDE_SHARE * (abs(end) or 1.0))


def _values_inside(design: Design, failure: GearmeshError, trials: Trials[Design]) -> tuple[float, ...]:
    """Return values at the bounds that a refusal states for its key, and a little inside them."""
    own, bounds = trials.own[failure.key], _bounds_in_units(design, failure)
    if bounds is None or not isinstance(own, int | float):
        return ()
    values = [
        end + math.copysign(part * end, end - own) for end in _ends_of(bounds, own) for part in (0.0, *INWARD_SHARES)
    ]
    return tuple(trials.like(failure.key, value) for value in values)


def _without_bounds(failure: GearmeshError) -> GearmeshError:
    """Return the refusal without its bounds, if it has a reason, too."""
    made = copy(failure)
    made.allowed = made.allowed if made.bounds is None or not made.reason else ""
    return made


def _with_note(failure: GearmeshError) -> GearmeshError:
    """Return the refusal with the note that another refusal follows within its bounds."""
    made = copy(failure)
    made.allowed += " (another refusal then follows)" if made.bounds is not None else ""
    return made


def with_set_value(design: Design, failure: GearmeshError) -> GearmeshError:
    """Return the refusal with the design's value of its key, if it has no value and the design sets the key to a number."""
    value = dict(design.own()).get(failure.key)
    if failure.value is not None or not isinstance(value, int | float) or isinstance(value, bool):
        return failure
    key = type(design).key_at(failure.key)
    made = copy(failure)
    made.value = value if key is None or not key.power else value * design.mm_per_unit**key.power
    made.unit = failure.unit or (_unit(design, failure.key) if key is None or key.power != 1 else "mm")
    return made


def _bounds_in_units(design: Design, failure: GearmeshError) -> Bounds | None:
    """Return the bounds that a refusal states for its key, in the design's units.

    None without bounds, and for bounds of another quantity.
    """
    key, bounds = type(design).key_at(failure.key), failure.bounds
    if key is None or bounds is None or bounds.unit != _UNITS_IN_MM.get(key.unit, ""):
        return None
    scale = design.mm_per_unit**key.power
    low, high = (None if end is None else end / scale for end in (bounds.low, bounds.high))
    return bounds._replace(low=low, high=high)


def _refusal_of(design: Design, bound: KeyBound) -> GearmeshError:
    """Return the bound of a key as a refusal."""
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
        refused = shown_value(float(f"{bound.refused:.{BOUND_DIGITS}g}"), unit)
        allowed = f"{most} about {shown_value(float(bound.value), unit)}, {refused} is refused as well"
    return DesignError(bound.key, value, unit=unit, allowed=allowed)


# ---------------------------------------------------------------- keys that mend


def _that_mend(
    design: Design, failure: GearmeshError, mending: Mending[Design], *, partly: bool
) -> tuple[list[Interval], bool]:
    """Return the keys that mend a design, each alone, and True if nothing else is wrong then.

    `partly`: accept keys that mend only the reported fault.
    """
    trials, intervals = mending.trials, list[Interval]()
    keys = [key for key, value in trials.own.items() if movable(key, value)]
    named = [key for key in trials.own if key == failure.key]
    groups = _suspects(design, keys, failure)
    for noticed in (None, failure.topic) if partly else (None,):
        trials.ask(noticed)
        for group in groups:
            if intervals:
                intervals += mending.leave_out(group, BOUNDS_EFFORT_SHARE)
            else:
                intervals += mending.keys(group, named, failure.remedies)
            if intervals and not mending.light:
                break
        if intervals:
            return intervals, noticed is None
    return [], False


def _with_bounds(
    design: Design, failure: GearmeshError, mending: Mending[Design], intervals: list[Interval], *, whole: bool
) -> GearmeshError:
    """Return the refusal that begins with the bounds of the keys that mend the design."""
    bounds = mending.refine(intervals)
    if failure.remedies.get(failure.key) == 0:
        bounds = [mending.with_far_end(bound) if bound.key == failure.key else bound for bound in bounds]
    first, *others = [_refusal_of(design, bound) for bound in bounds]
    made = DiagnosedNoSolutionError if isinstance(failure, NoSolutionError) else DiagnosedError
    return made(first, tuple(others), failure, whole=whole)


def _suspects(design: Design, keys: list[str], failure: GearmeshError) -> list[list[str]]:
    """Return groups of keys in the order of the search.

    Changed keys come before keys of the file. Within both, remedies of the refusal come first, then other keys; keys of the refused
    part come before the rest.
    """
    part, new_keys = failure.key, _changed_keys(design, keys)
    remedies = [key for key in failure.remedies if key in keys]
    rest = sorted((key for key in keys if key not in remedies), key=lambda key: not key.startswith(part))
    groups = ([key for key in some if (key in new_keys) is new] for new in (True, False) for some in (remedies, rest))
    return [group for group in groups if group]


def _together(design: Design, failure: GearmeshError, own: dict[str, Any]) -> GearmeshError:
    """Return the refusal of a design that no single key mends, with the set keys of the same member in front, if any."""
    member = failure.key.partition(".")[0]
    named = [key for key in own if key.startswith(f"{member}.") and movable(key, own[key])]
    if not named or failure.key in own:
        return failure
    several = [f"{key} = {shown_value(own[key], _unit(design, key))}" for key in named[:MAX_KEYS_TOGETHER]]
    made = NoSolutionError if isinstance(failure, NoSolutionError) else DesignError
    together = f"together; no other value of one of them alone is enough: {failure}"
    return made(
        named[0],
        own[named[0]],
        unit=_unit(design, named[0]),
        shown=", ".join(several).partition(" = ")[2],
        reason=together,
    )


def without_one(design: DesignT, build: Build) -> tuple[DesignT, str] | None:
    """Return a design that can be built without one of its keys, and this key; None if no single key can be left out."""
    trials = Trials(type(design), dict(design.own()), build, Effort(math.inf), empty_tables(design.stated()))
    for key, value in design.own():
        if movable(key, value) and trials.works(key, None):
            return trials.design_of({**trials.own, key: None}), key
    return None


class _Diagnosis(GearmeshError):
    """A refusal that names a key set in the design.

    Its fields are the key and the bound that was tried; `others` are refusals of keys that would also mend the design; `noticed` is
    the original refusal. If it is not `whole`, another refusal follows within the bound.
    """

    def __init__(
        self, first: GearmeshError, others: tuple[GearmeshError, ...], noticed: GearmeshError, *, whole: bool
    ) -> None:
        super().__init__()
        self.__dict__.update(first.__dict__)
        self.others, self.noticed, self.whole = others, noticed, whole

    @property
    def topic(self) -> str:
        """Topic of the original refusal."""
        return self.noticed.topic

    def __str__(self) -> str:
        bounds = ", or ".join([super().__str__(), *map(str, self.others)])
        rest = "" if self.whole else " (another refusal then follows)"
        # name the key only once, with the bound that was tried in place of the stated bound
        told = copy(self.noticed)
        if self.key == told.key:
            told.allowed = "" if told.reason and told.bounds is not None else told.allowed
            told.key, told.value = "", None
        return ": ".join(part for part in (f"{bounds}, with the other keys unchanged{rest}", str(told)) if part)


class DiagnosedError(_Diagnosis, DesignError):
    """Refusal of a design that cannot be used."""


class DiagnosedNoSolutionError(_Diagnosis, NoSolutionError):
    """Refusal of a design without a solution."""


def _changed_keys(design: Design, keys: Iterable[str]) -> tuple[str, ...]:
    """Return the keys that were changed, alone or with their table."""
    tables = tuple(f"{key}." for key in design.changed_keys)
    return tuple(key for key in keys if f"{key}.".startswith(tables))


def _unit(design: Design, dotted: str) -> str:
    key = type(design).key_at(dotted)
    assert key is not None, "a key that a design sets"
    return key.unit_in(design.units) if key.unit in _UNITS_IN_MM else ""
