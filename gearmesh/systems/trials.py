"""Builds of a design with other values of its keys, each tried once, within an effort."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import field
from typing import Any, Generic, NamedTuple, TypeVar

from gearmesh.design.core import Design
from gearmesh.design.dotted import with_keys
from gearmesh.errors import GearmeshError
from gearmesh.kernel.numeric.effort import Effort, EffortSpentError, limit_effort
from gearmesh.kernel.numeric.excess import Refused
from gearmesh.records import dataclass

DesignT = TypeVar("DesignT", bound=Design)

#: builds the gears of a design, or raises
Build = Callable[[Any], object]
#: values by dotted keys, in the design's units, with which an object was built from a design
Values = Callable[[Any, object], Mapping[str, Any]]

#: tables whose keys do not change the geometry
NO_GEOMETRY_TABLES = ("fe.", "mesh.", "material.", "contact.phi1.", "measured.")
#: largest number of builds in the search for keys that mend a design
MAX_TRIALS = 80
#: largest number of builds in the search for keys that mend only the reported fault
MAX_TRIALS_FOR_NOTICED = 30
#: largest effort of one build, over the whole effort
EFFORT_SHARE_PER_TRIAL = 0.6
#: effort of a build beside the effort that it counts itself
EFFORT_PER_BUILD = 0.005
#: effort of a design that is refused before it is built
EFFORT_PER_DESIGN = 0.004


class Outcome(NamedTuple):
    """Result of a trial."""

    #: True if gears were built
    built: bool
    #: topic of the refusal, None for gears that were built
    topic: str | None = None
    #: False if the trial was given up
    known: bool = True
    #: object that was built, kept for trials without the key
    made: object = None
    #: excess of the refused figure over its limit, None if unknown
    excess: float | None = None


@dataclass
class Trials(Generic[DesignT]):
    """Builds of a design with other values of its set keys, each tried once, until the effort is spent."""

    #: class of the design
    design: type[DesignT]
    #: values of the set keys, by dotted key
    own: dict[str, Any]
    #: function that builds gears
    build: Build
    #: effort that is left
    effort: Effort
    #: tables of the design without a key, which stay, as an empty table of a tool asks for that tool
    empty: Mapping[str, Any] = field(default_factory=dict)
    #: refusal of the design
    failure: GearmeshError | None = None
    #: function for the values of keys that are left out
    built_of: Values = lambda design, made: {}
    #: topic for which a build must not be refused, None if it must not be refused at all
    noticed: str | None = None
    #: number of builds since `ask`
    count: int = 0
    #: outcomes by key and value, None for the default
    tried: dict[tuple[str, float | None], Outcome] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.allowed = self.effort.left
        #: effort of the dearest trial that was not given up
        self.dearest = 0.0

    def ask(self, noticed: str | None) -> None:
        """Set the topic for which builds must not be refused from now on; None: builds must not be refused at all."""
        self.noticed, self.count = noticed, 0

    def works(self, key: str, value: float | None) -> bool:
        """Return True if the gears can be built with another value of a key, None for its default."""
        if (
            self.count >= (MAX_TRIALS if self.noticed is None else MAX_TRIALS_FOR_NOTICED)
            and (key, value) not in self.tried
        ):
            return False
        return self.is_allowed(self.outcome(key, value, EFFORT_SHARE_PER_TRIAL * self.allowed))

    def is_allowed(self, outcome: Outcome) -> bool:
        """Return True if an outcome counts as a build that works."""
        return outcome.built or (outcome.topic is not None and self.noticed not in (None, outcome.topic))

    def outcome(self, key: str, value: float | None, most: float | None = None) -> Outcome:
        """Return the outcome of another value of a key, with at most `most` effort."""
        if (key, value) not in self.tried:
            if self.effort.spent:
                return Outcome(built=False, known=False)
            self.count += 1
            left = self.effort.left
            self.tried[key, value] = self._trial(key, value, left if most is None else min(most, left))
        return self.tried[key, value]

    def _trial(self, key: str, value: float | None, most: float) -> Outcome:
        self.effort.left -= EFFORT_PER_DESIGN
        try:
            design = self.design_of({**self.own, key: value})
        except GearmeshError:
            return Outcome(built=False)
        own = Effort(most - EFFORT_PER_BUILD)
        if own.spent:
            return Outcome(built=False, known=False)
        try:
            with limit_effort(own):
                made = self.build(design)
        except EffortSpentError:
            return Outcome(built=False, known=False)
        except GearmeshError as error:
            outcome = Outcome(built=False, topic=error.topic, excess=error.excess)
        else:
            outcome = Outcome(built=True, made=made if value is None else None)
        finally:
            self.effort.left -= most - own.left
        self.dearest = max(self.dearest, most - own.left)
        return outcome

    def design_of(self, keys: dict[str, Any]) -> DesignT:
        """Return the design of the keys that are not None."""
        return self.design(**with_keys(self.empty, ((key, value) for key, value in keys.items() if value is not None)))

    def refused_values(self, key: str) -> list[float]:
        """Return the values of a key that are known to be refused."""
        return [
            value
            for (other, value), outcome in self.tried.items()
            if other == key and value is not None and outcome.known and not self.is_allowed(outcome)
        ]

    def excesses(self, key: str, bad: float, good: float) -> list[Refused]:
        """Return refused values of a key with their excess, from `bad` on away from the allowed value `good`.

        Only values that are refused for the same reason as `bad` are returned.
        """
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
        """Return the number that a key has when it is left out, None without a number."""
        design = self.design_of({**self.own, key: None})
        table: Any = design
        for name in key.split("."):
            # a table whose only key is left out does not exist
            table = getattr(table, name, None)
        if isinstance(table, int | float) and math.isfinite(table):
            return table
        derived = self.built_of(design, self.tried[key, None].made).get(key)
        return self.like(key, derived) if isinstance(derived, int | float) and math.isfinite(derived) else None

    def like(self, key: str, value: float) -> float:
        """Return the value, rounded to a whole number for keys with whole numbers."""
        return round(value) if isinstance(self.own[key], int) else value


def movable(key: str, value: Any) -> bool:
    """Return True for a key with a number that changes the geometry."""
    number = isinstance(value, int | float) and not isinstance(value, bool)
    return number and not key.startswith(NO_GEOMETRY_TABLES)
