"""Bounds of a key between a value that is refused and one that is allowed, and where the interval is divided next."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from gearmesh.kernel.numeric.excess import Division, Refused

#: width of an interval, over the value, from which on its bound is only said to be about there
ROUGH = 5e-3
#: where an interval is parted first, from the refused value, and then
FIRST, THEN = 0.125, 0.5
#: significant digits of a bound, and of one that no shorter number may take the place of, as many as messages show
DIGITS, SHOWN_DIGITS = 4, 7


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
        return self.value is not None and relative_width(self.value, self.refused) > ROUGH


@dataclass
class Interval:
    """Between values of a key that are allowed and refused, for one that is set; `good` is None if only leaving it out mends.

    `kept`: it was not put in anew. `proved`: the allowed value was built itself, not as the default of the key.
    """

    key: str
    own: float
    good: float | None
    bad: float
    kept: bool
    divisions: int = 0
    proved: bool = True

    def __post_init__(self) -> None:
        self._division = Division()

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
        return 0.0 if self.good is None else relative_width(self.good, self.bad)

    def divide(self, refused: Sequence[Refused], wanted: float) -> float:
        """Value between both ends at which the next build tells most; `wanted`: the width that is.

        `refused`: values that are refused for what is in the way at the refused end, that end first, then by their distance.
        """
        assert self.good is not None, "an interval between two values"
        size = max(abs(self.good), abs(self.bad)) or 1.0
        aim = self._division.beside_root(self.good, self.bad, refused, wanted * size)
        if aim is None:
            share = THEN if self.divisions or self.bad != self.own else FIRST
            aim = self.bad + share * (self.good - self.bad)
        self.divisions += 1
        return aim

    def narrow(self, value: float, *, allowed: bool) -> None:
        """Move one end to a value that was tried."""
        self._division.last_refused = not allowed
        if allowed:
            self.good, self.proved = value, True
        else:
            self.bad = value


def relative_width(good: float, bad: float) -> float:
    """Width of an interval over the larger of its ends; 0 between neighbouring whole numbers."""
    apart = abs(good - bad)
    return 0.0 if isinstance(good, int) and apart <= 1 else apart / (max(abs(good), abs(bad)) or 1.0)


def round_digits(value: float, up: bool, digits: int = DIGITS) -> float:
    """A number with so many significant digits, rounded up or down."""
    if isinstance(value, int) or value == 0.0 or float(f"{value:.{digits}g}") == value:
        return value
    unit = 10.0 ** (math.floor(math.log10(abs(value))) + 1 - digits)
    return float(f"{(math.ceil if up else math.floor)(value / unit) * unit:.{digits}g}")
