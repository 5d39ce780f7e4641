"""Which key of a design makes its geometry impossible, and how far it would have to give way.

A tooth that cannot exist is noticed deep in a build, where only defaults and derived values may be at hand. What the owner of
the design wants to know is the key that he set himself. It is found by trying: each of his keys is left out, or moved step by
step, and the one that has to give way least, alone, is named with the bound at which the gears can just be built. What was put in
anew is tried first, and of what cannot be left out that which counts from 0 to either side, as an offset. The search ends when it
has taken so much effort: a bound is then one that is allowed, if not the last.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from gearmesh.design.core import Design
from gearmesh.design.dotted import with_keys
from gearmesh.errors import DesignError, GearmeshError, NoSolutionError, VagueError
from gearmesh.kernel.effort import Effort, EffortSpentError, limited

D = TypeVar("D", bound=Design)

#: Makes what can be refused of a design.
Build = Callable[[Any], object]

#: tables whose keys have no part in the geometry
ASIDE = ("fe.", "mesh.", "material.", "contact.phi1.")
#: steps away from a value, as parts of it
STEPS = (0.05, 0.25, 0.8)
#: halvings between a value that is refused and one that is not, and significant digits of the bound
HALVINGS, DIGITS = 13, 4
#: how far, by a factor either way, and in how many steps a value is looked for in the place of one that is derived
FARTHEST, ASKED = 64.0, 12
#: builds that are tried at most for what mends a design, and for what mends what was noticed of it; keys that are named at most
MOST_TRIALS, MOST_FOR_NOTICED, MOST_NAMED = 80, 30, 2
#: effort of all trials, about the seconds that they take: bounds are as fine as it allows
MOST_EFFORT = 2.5
#: keys that are named at most where none alone is to blame
MOST_TOGETHER = 3


def blamed(design: Design, failure: GearmeshError, build: Build) -> GearmeshError:
    """The refusal of a design with the key in front that its owner set, and a bound of it that was tried; or as it was.

    Where no single key mends the design one is named that mends what was noticed, of which something else is left. The refusal
    stays as it is where it names a key that the design sets and is not vague, and where nothing mends it.
    """
    own = dict(design.own())
    named = [key for key in own if f"{key} = " in str(failure) or f"{key}:" in str(failure)]
    if named and not isinstance(failure, VagueError | NoSolutionError):
        return failure
    keys = [key for key, value in own.items() if _movable(key, value)]
    effort = Effort(MOST_EFFORT)
    for noticed in (None, failure.topic):
        trials = _Trials(type(design), own, build, effort, noticed)
        found: list[KeyBound] = []
        for group in _suspects(design, keys, failure):
            found += list(trials.left_out(group)) or trials.otherwise(group, named, found)
        if found:
            break
    else:
        return failure if effort.spent else _together(design, failure, own)
    nearest = sorted(found, key=lambda bound: bound.change)[:MOST_NAMED]
    lines = [
        f"{bound.key} = {_shown(design, bound.key, own[bound.key])}: {_allowed(design, bound)}" for bound in nearest
    ]
    made = NoSolutionError if isinstance(failure, NoSolutionError) else DesignError
    # a key that was named already is named once
    why = str(failure).removeprefix(f"{nearest[0].key} = {own[nearest[0].key]:g}: ")
    rest = "" if noticed is None else " (then something else is in the way)"
    return made(f"{', or '.join(lines)}, the other keys as they are{rest}: {why}")


def _suspects(design: Design, keys: list[str], failure: GearmeshError) -> list[list[str]]:
    """Keys in the order in which they are looked at: what was changed before what was in the file, and there what belongs to the
    part that the refusal is about before the rest."""
    changed = [key for key in keys if key in design.changed]
    part = str(failure).partition(": ")[0]
    rest = sorted((key for key in keys if key not in changed), key=lambda key: not key.startswith(part))
    return [group for group in (changed, rest) if group]


def _together(design: Design, failure: GearmeshError, own: dict[str, Any]) -> GearmeshError:
    """The refusal of a design that no single key mends: with the keys of the same member in front that its owner set, if any."""
    member = str(failure).partition(".")[0].partition(":")[0]
    named = [key for key in own if key.startswith(f"{member}.") and _movable(key, own[key])]
    if not named or any(f"{key} = " in str(failure) for key in own):
        return failure
    lines = ", ".join(f"{key} = {_shown(design, key, own[key])}" for key in named[:MOST_TOGETHER])
    made = NoSolutionError if isinstance(failure, NoSolutionError) else DesignError
    return made(f"{lines}: together; no other value of one of them alone is allowed: {failure}")


def without_one(design: D, build: Build) -> tuple[D, str] | None:
    """A design that can be built and lacks but one of the keys that are set, and that key; None where there is none."""
    trials = _Trials(type(design), dict(design.own()), build, Effort(math.inf))
    for key, value in design.own():
        if _movable(key, value) and trials.works(key, None):
            return trials.made({**trials.own, key: None}), key
    return None


@dataclass(frozen=True)
class KeyBound:
    """A value of a key that its owner set with which the gears can be built; None: only if the key is left out.

    `change`: by how much of itself the key has to give way; `larger` is true where it has to be larger.
    """

    key: str
    value: float | None
    change: float
    larger: bool


@dataclass
class _Trials(Generic[D]):
    """Builds of a design class with other values of the keys that are set; counts them, and ends when the `effort` is spent.

    If something was `noticed`, the topic of a refusal, a build works that is not refused for that.
    """

    design: type[D]
    own: dict[str, Any]
    build: Build
    effort: Effort
    noticed: str | None = None
    count: int = 0

    def otherwise(self, keys: list[str], named: list[str], found: list[KeyBound]) -> list[KeyBound]:
        """Bounds of those of the keys that mend the design when they are moved, what was `named` first, and where nothing was,
        what is unusual; none if any are `found`."""
        if found:
            return []
        unusual = [] if set(keys) & set(named) else [key for key in keys if self._unusual(key)]
        rest = sorted((key for key in keys if key not in unusual), key=lambda key: key not in named)
        return list(self.moved(unusual)) or list(self.moved(rest))

    def _unusual(self, key: str) -> bool:
        """Whether a number counts from the usual one, 0, to either side, as an offset does; sizes and tooth numbers do not."""
        about = self.design.key_at(key)
        return about is not None and about.low < 0.0 < about.high

    def works(self, key: str, value: float | None) -> bool:
        """Whether the gears can be built with another value of a key, None: with its default."""
        self.count += 1
        if self.effort.spent:
            return False
        try:
            design = self.made({**self.own, key: value})
        except GearmeshError:
            return False
        try:
            with limited(self.effort):
                self.build(design)
        except EffortSpentError:
            return False
        except GearmeshError as error:
            return self.noticed is not None and error.topic != self.noticed
        return True

    def made(self, keys: dict[str, Any]) -> D:
        """The design of the keys that are not None."""
        return self.design(**with_keys({}, ((key, value) for key, value in keys.items() if value is not None)))

    def left_out(self, keys: list[str]) -> Iterator[KeyBound]:
        """Bounds of the keys that mend the design when they are left out."""
        for key in keys:
            if self._spent or not self.works(key, None):
                continue
            default = self._default(key)
            good = default if default is not None and self.works(key, default) else self._beside(key)
            yield KeyBound(key, None, math.inf, False) if good is None else self._between(key, good)

    def moved(self, keys: list[str]) -> Iterator[KeyBound]:
        """Bounds of the keys that mend the design when they are larger or smaller."""
        for step in STEPS:
            mended = False
            for key in keys:
                for factor in (1.0 + step, 1.0 - step):
                    value = self._like(key, self.own[key] * factor)
                    if not self._spent and value != self.own[key] and self.works(key, value):
                        mended = True
                        yield self._between(key, value)
            # what has to give way less is found first
            if mended or self._spent:
                return

    def _beside(self, key: str) -> float | None:
        """A value of a key that works, within a factor of FARTHEST; None where none is found."""
        for step in range(1, ASKED + 1):
            for factor in (FARTHEST ** (step / ASKED), FARTHEST ** (-step / ASKED)):
                value = self._like(key, self.own[key] * factor)
                if self.works(key, value):
                    return value
        return None

    @property
    def _spent(self) -> bool:
        return self.effort.spent or self.count >= (MOST_TRIALS if self.noticed is None else MOST_FOR_NOTICED)

    def _default(self, key: str) -> float | None:
        """The number that a key becomes when it is left out, None where there is none."""
        table: Any = self.made({**self.own, key: None})
        for name in key.split("."):
            # a table that is left out with its only key has none
            table = getattr(table, name, None)
        if not isinstance(table, int | float) or not math.isfinite(table):
            return None
        return table

    def _between(self, key: str, good: float) -> KeyBound:
        """The bound between a value that works and the one that is set, with few digits that work as well."""
        bad = self.own[key]
        larger = good > bad
        for _ in range(HALVINGS):
            middle = self._like(key, 0.5 * (good + bad))
            if middle in (good, bad) or self.effort.spent:
                break
            good, bad = (middle, bad) if self.works(key, middle) else (good, middle)
        short = _rounded(good, larger)
        # where no more can be tried it is rounded towards what is allowed all the same
        value = short if short != good and (self.works(key, short) or self.effort.spent) else good
        size = max(abs(self.own[key]), abs(value)) or 1.0
        return KeyBound(key, value, abs(value - self.own[key]) / size, larger)

    def _like(self, key: str, value: float) -> float:
        """A whole number where the key is one."""
        return round(value) if isinstance(self.own[key], int) else value


def _movable(key: str, value: Any) -> bool:
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return number and not key.startswith(ASIDE)


def _rounded(value: float, up: bool) -> float:
    """A number with DIGITS significant digits, rounded up or down."""
    if isinstance(value, int) or value == 0.0:
        return value
    unit = 10.0 ** (math.floor(math.log10(abs(value))) + 1 - DIGITS)
    return float(f"{(math.ceil if up else math.floor)(value / unit) * unit:.{DIGITS}g}")


def _allowed(design: Design, bound: KeyBound) -> str:
    if bound.value is None:
        return "left out it is derived, and the gears can be built"
    most = "at least" if bound.larger else "at most"
    return f"allowed is {most} {_shown(design, bound.key, bound.value)}"


def _shown(design: Design, dotted: str, value: float) -> str:
    """A value with its unit."""
    key = type(design).key_at(dotted)
    assert key is not None, "a key that a design sets"
    unit = {"length": f" {design.units}", "angle": " deg"}.get(key.unit, "")
    return f"{value:.7g}{unit}"
