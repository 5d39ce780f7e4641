"""Bounds of a key between a refused and an allowed value, and the division of this interval."""

from __future__ import annotations

import math
from collections.abc import Sequence

from gearmesh.kernel.numeric.excess import Division, Refused
from gearmesh.records import dataclass

#: width of an interval, over the value, above which its bound is stated as approximate
ROUGH_WIDTH = 5e-3
#: place of the first division, as a share of the interval from the refused value
FIRST_SHARE = 0.125
#: place of later divisions
LATER_SHARE = 0.5
#: significant digits of a bound
BOUND_DIGITS = 4
#: significant digits of a bound that cannot be shortened, as many as messages show
SHOWN_DIGITS = 7


@dataclass(frozen=True)
class KeyBound:
    """A bound of a set key at which the gears can be built."""

    #: dotted key
    key: str
    #: value at which the gears can be built, None if the key must be left out
    value: float | None
    #: nearest value that is known to be refused
    refused: float
    #: True if the key must be larger than the refused value
    larger: bool
    #: other end of the allowed range, None if unknown
    far: float | None = None

    @property
    def rough(self) -> bool:
        """True if the true bound may be farther from the value than ROUGH_WIDTH."""
        return self.value is not None and relative_width(self.value, self.refused) > ROUGH_WIDTH


@dataclass
class Interval:
    """Interval between an allowed and a refused value of a set key."""

    #: dotted key
    key: str
    #: value that the design sets
    own: float
    #: allowed value, None if only leaving out the key mends the design
    good: float | None
    #: refused value
    bad: float
    #: True if the key was not changed
    kept: bool
    #: number of divisions
    divisions: int = 0
    #: True if the allowed value itself was built, not only the default of the key
    proved: bool = True
    #: value next to the allowed value with an abandoned trial; no value beyond it is tried any more
    given_up: float | None = None

    def __post_init__(self) -> None:
        self._division = Division()

    @property
    def least(self) -> tuple[bool, float]:
        """Order by the least relative change of the key: False for changed keys, and the change."""
        return self._change(self.bad)

    @property
    def most(self) -> tuple[bool, float]:
        """Order by the largest relative change of the key: False for changed keys, and the change."""
        return self._change(self.good)

    def _change(self, end: float | None) -> tuple[bool, float]:
        if end is None or self.good is None:
            return self.kept, math.inf
        return self.kept, abs(end - self.own) / (max(abs(self.own), abs(end)) or 1.0)

    @property
    def width(self) -> float:
        """Width over the larger end."""
        return 0.0 if self.good is None else relative_width(self.good, self.bad)

    @property
    def end(self) -> float:
        """End opposite to the allowed value: the refused value, or a nearer value with an abandoned trial."""
        return self.bad if self.given_up is None else self.given_up

    def divide(self, refused: Sequence[Refused], wanted: float) -> float:
        """Return the value between both ends for the next build.

        - `refused`: values refused for the same reason as the refused end, from this end on by their distance
        - `wanted`: final width, over the larger end
        """
        assert self.good is not None, "an interval between two values"
        size = max(abs(self.good), abs(self.bad)) or 1.0
        aim = None
        if self.given_up is None:
            aim = self._division.beside_root(self.good, self.bad, refused, wanted * size)
        if aim is None:
            share = LATER_SHARE if self.divisions or self.bad != self.own else FIRST_SHARE
            aim = self.end + share * (self.good - self.end)
        self.divisions += 1
        return aim

    def narrow(self, value: float, *, allowed: bool) -> None:
        """Move the refused or the allowed end to a tried value."""
        self._division.last_refused = not allowed
        if allowed:
            self.good, self.proved = value, True
        else:
            self.bad, self.given_up = value, None


def relative_width(good: float, bad: float) -> float:
    """Return the width of an interval over its larger end, 0 between neighbouring whole numbers."""
    apart = abs(good - bad)
    return 0.0 if isinstance(good, int) and apart <= 1 else apart / (max(abs(good), abs(bad)) or 1.0)


def round_digits(value: float, up: bool, digits: int = BOUND_DIGITS) -> float:
    """Round a number up or down to a number of significant digits."""
    if isinstance(value, int) or value == 0.0 or float(f"{value:.{digits}g}") == value:
        return value
    unit = 10.0 ** (math.floor(math.log10(abs(value))) + 1 - digits)
    return float(f"{(math.ceil if up else math.floor)(value / unit) * unit:.{digits}g}")
