"""Variables of an optimisation: keys of a design with the range or the list of their values."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from gearmesh.errors import ArgumentError
from gearmesh.kernel.numeric.algebra import Array
from gearmesh.records import dataclass
from gearmesh.study.plan import KeyReader, Value

#: decimal places of the values of a range, counted from the first digit of its width
RANGE_PLACES = 5


@dataclass(frozen=True)
class Variable:
    """Key of a design that is varied, and its values, in the design's units."""

    #: dotted key
    key: str
    #: least value of the range; 0 of a list
    low: float
    #: largest value of the range; 0 of a list
    high: float
    #: values of a list, or of a range of whole numbers; () for a range of real numbers
    values: tuple[Value, ...] = ()

    @property
    def discrete(self) -> bool:
        """True for whole numbers and lists."""
        return bool(self.values)

    def at(self, share: float) -> Value:
        """Return the value at a share, 0 to 1, of the range or of the list."""
        if self.values:
            return self.values[min(int(share * len(self.values)), len(self.values) - 1)]
        places = RANGE_PLACES - math.floor(math.log10(self.high - self.low))
        return min(max(round(self.low + share * (self.high - self.low), places), self.low), self.high) + 0.0

    def share(self, value: object) -> float | None:
        """Return the share at which `at` has a value; None if it is not one of the values."""
        if self.values:
            return (self.values.index(value) + 0.5) / len(self.values) if value in self.values else None
        if not isinstance(value, int | float) or isinstance(value, bool) or not self.low <= value <= self.high:
            return None
        return (value - self.low) / (self.high - self.low)

    def beside(self, value: Value, share: float) -> tuple[Value, Value] | None:
        """Return the values below and above a value: those of a list of numbers that are next to it, or those a share
        of the range away; at an end the value itself. None if the value has no such neighbours.
        """
        own = self.share(value)
        if own is None or any(isinstance(each, str | bool) for each in self.values):
            return None
        if self.values:
            order = sorted(self.values)
            place = order.index(value)
            return order[max(place - 1, 0)], order[min(place + 1, len(order) - 1)]
        return self.at(max(own - share, 0.0)), self.at(min(own + share, 1.0))

    @property
    def text(self) -> str:
        """Range or list as it is written for `vary`."""
        if isinstance(self.values[0] if self.values else 0, str | bool) or not self.low < self.high:
            return ",".join(map(str, self.values))
        return f"{self.low:g}:{self.high:g}"


def variables_of(read: KeyReader, vary: Mapping[str, str | Sequence[Value]]) -> tuple[Variable, ...]:
    """Return the variables of keys with texts "LOW:HIGH" or "A,B,C", or with lists.

    Raises ArgumentError or DesignError naming key, value and what is allowed.
    """
    if not vary:
        raise ArgumentError("vary", reason="missing; give keys to vary, as pinion.modifications.helix_crowning=0:20um")
    return tuple(_variable(read, key, values) for key, values in vary.items())


def _variable(read: KeyReader, key: str, values: str | Sequence[Value]) -> Variable:
    if isinstance(values, str) and ":" in values:
        return _range(read, key, values)
    listed = read.values(key, values) if isinstance(values, str) else [read.value(key, each) for each in values]
    different = tuple(dict.fromkeys(listed))
    if len(different) < 2:
        raise ArgumentError("vary", entry=key, must_be="LOW:HIGH, or a list A,B,C of 2 different values at least")
    return Variable(key, 0.0, 0.0, different)


def _range(read: KeyReader, key: str, text: str) -> Variable:
    low_text, _, high_text = text.partition(":")
    low, high = read.ends(key, low_text, high_text)
    if not low < high:
        raise ArgumentError("vary", text, entry=key, must_be="LOW:HIGH, with HIGH above LOW")
    first, last = read.value(key, low), read.value(key, high)
    if isinstance(first, int) and isinstance(last, int):
        return Variable(key, low, high, tuple(range(first, last + 1)))
    return Variable(key, low, high)


def values_at(variables: Sequence[Variable], shares: Array) -> tuple[Value, ...]:
    """Return the values of all variables at shares (n,), 0 to 1."""
    return tuple(each.at(share) for each, share in zip(variables, np.asarray(shares).tolist(), strict=True))
