"""Builds of a design with other values of its keys, each tried once, within an effort."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Generic, NamedTuple, TypeVar

from gearmesh.design.core import Design
from gearmesh.design.dotted import with_keys
from gearmesh.errors import GearmeshError
from gearmesh.kernel.numeric.effort import Effort, EffortSpentError, limit_effort
from gearmesh.kernel.numeric.excess import Refused

D = TypeVar("D", bound=Design)

#: Makes what can be refused of a design.
Build = Callable[[Any], object]
#: Values by dotted keys, in the design's units, of which something was built from a design.
Values = Callable[[Any, object], Mapping[str, Any]]

#: tables whose keys have no part in the geometry
ASIDE = ("fe.", "mesh.", "material.", "contact.phi1.", "measured.")
#: builds that are tried at most for what mends a design, and for what mends what was noticed of it
MOST_TRIALS, MOST_FOR_NOTICED = 80, 30
#: part of the effort that one of them takes, at most
OF_ONE = 0.6
#: effort of a build beside what it counts itself, and of a design that is refused before it is built
OF_BUILD, OF_DESIGN = 0.005, 0.004


class Outcome(NamedTuple):
    """Whether gears were built, or what their refusal was about; `known`: it was not given up; `made`: what was built; `excess`:
    how far the checked figure is beyond its limit, where the refusal says so."""

    built: bool
    topic: str | None = None
    known: bool = True
    made: object = None
    excess: float | None = None


@dataclass
class Trials(Generic[D]):
    """Builds of a design class with other values of the keys that are set, each tried once; ends when the `effort` is spent.

    If something was `noticed`, the topic of a refusal, a build works that is not refused for that.
    """

    design: type[D]
    own: dict[str, Any]
    build: Build
    effort: Effort
    failure: GearmeshError | None = None
    built_of: Values = lambda design, made: {}
    noticed: str | None = None
    count: int = 0
    tried: dict[tuple[str, float | None], Outcome] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.allowed = self.effort.left

    def ask(self, noticed: str | None) -> None:
        """From now on builds work that are not refused for what was `noticed`; None: that are not refused."""
        self.noticed, self.count = noticed, 0

    def works(self, key: str, value: float | None) -> bool:
        """Whether the gears can be built with another value of a key, None: with its default."""
        if self.count >= (MOST_TRIALS if self.noticed is None else MOST_FOR_NOTICED) and (key, value) not in self.tried:
            return False
        return self.is_allowed(self.outcome(key, value, OF_ONE * self.allowed))

    def is_allowed(self, outcome: Outcome) -> bool:
        """Whether a build works."""
        return outcome.built or (outcome.topic is not None and self.noticed not in (None, outcome.topic))

    def outcome(self, key: str, value: float | None, most: float | None = None) -> Outcome:
        """What comes of another value of a key, with at most so much effort."""
        if (key, value) not in self.tried:
            if self.effort.spent:
                return Outcome(built=False, known=False)
            self.count += 1
            left = self.effort.left
            self.tried[key, value] = self._trial(key, value, left if most is None else min(most, left))
        return self.tried[key, value]

    def _trial(self, key: str, value: float | None, most: float) -> Outcome:
        self.effort.left -= OF_DESIGN
        try:
            design = self.design_of({**self.own, key: value})
        except GearmeshError:
            return Outcome(built=False)
        own = Effort(most - OF_BUILD)
        if own.spent:
            return Outcome(built=False, known=False)
        try:
            with limit_effort(own):
                made = self.build(design)
        except EffortSpentError:
            return Outcome(built=False, known=False)
        except GearmeshError as error:
            return Outcome(built=False, topic=error.topic, excess=error.excess)
        finally:
            self.effort.left -= most - own.left
        return Outcome(built=True, made=made if value is None else None)

    def design_of(self, keys: dict[str, Any]) -> D:
        """The design of the keys that are not None."""
        return self.design(**with_keys({}, ((key, value) for key, value in keys.items() if value is not None)))

    def refused_values(self, key: str) -> list[float]:
        """Values of a key that are known to be refused."""
        return [
            value
            for (other, value), outcome in self.tried.items()
            if other == key and value is not None and outcome.known and not self.is_allowed(outcome)
        ]

    def excesses(self, key: str, bad: float, good: float) -> list[Refused]:
        """Refused values of a key, and their excess, from one of them on away from an allowed value: those that are refused for
        the same."""
        points = {value: self.tried[key, value] for value in self.refused_values(key)}
        if self.failure is not None:
            points[self.own[key]] = Outcome(built=False, topic=self.failure.topic, excess=self.failure.excess)
        topic = points[bad].topic if bad in points else None
        same = [
            (value, outcome.excess) for value, outcome in points.items() if topic is not None and outcome.topic == topic
        ]
        beyond = [point for point in same if (point[0] - bad) * (bad - good) >= 0.0]
        beyond.sort(key=lambda point: abs(point[0] - bad))
        return beyond

    def default(self, key: str) -> float | None:
        """The number that a key became when it was left out, None where there is none."""
        design = self.design_of({**self.own, key: None})
        table: Any = design
        for name in key.split("."):
            # a table that is left out with its only key has none
            table = getattr(table, name, None)
        if isinstance(table, int | float) and math.isfinite(table):
            return table
        derived = self.built_of(design, self.tried[key, None].made).get(key)
        return self.like(key, derived) if isinstance(derived, int | float) and math.isfinite(derived) else None

    def like(self, key: str, value: float) -> float:
        """A whole number where the key is one."""
        return round(value) if isinstance(self.own[key], int) else value


def movable(key: str, value: Any) -> bool:
    """True for a key with a number that has a part in the geometry."""
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return number and not key.startswith(ASIDE)
