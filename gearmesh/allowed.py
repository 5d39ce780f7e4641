"""Allowed values of a refused key or argument: as text, and as bounds with their unit.

A kind that knows its bounds makes `Allowed` of them, which words and rounds them:

    Allowed.less_than(31.25, "mm", "the root")      "less than the root, 31.25 mm"
    Allowed.between(2.0, 7.5, "mm")                 "between 2 and 7.5 mm"

Bounds are rounded to 6 digits towards the allowed values. Free text is read for its bounds by `stated_bounds`.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import NamedTuple, Self

#: significant digits of bounds
BOUND_DIGITS = 6
#: significant digits of lengths in units other than mm
LENGTH_DIGITS = 6
#: words before a length that is an upper (0) or a lower bound (1)
_BOUND_WORDS = {"at most ": 0, "less than ": 0, " to ": 0, "at least ": 1, "more than ": 1, "from ": 1, "between ": 1}
_BOUND_WORDS |= {"at most about ": 0, "at least about ": 1}
#: a number with the words before it
_NUMBER_PATTERN = rf"(?P<bound>{'|'.join(_BOUND_WORDS)})?(?<![\w.])(?P<figure>-?\d+(?:\.\d+)?(?:e[-+]?\d+)?)"
#: one or several lengths in mm, with the words before the first length
_LENGTHS_PATTERN = (
    rf"((?:{'|'.join(_BOUND_WORDS)})?(?<![\w.])-?\d[\d.]*(?:e[-+]?\d+)?"
    r"(?:(?: to | and | or |, )-?\d[\d.]*(?:e[-+]?\d+)?)*) mm(?![/\w^])"
)
#: words before an upper bound
_UPPER_WORDS = "at most|less than|smaller than|below"
#: words before a lower bound
_LOWER_WORDS = "at least|more than|larger than|above"
#: a number
_FIGURE_PATTERN = r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?"
#: a number with its unit, after words that name its quantity
_QUANTITY_PATTERN = (
    rf"(?:about )?(?:[^\d;:]*? |[^;:]*?, )?(?P<{{0}}>{_FIGURE_PATTERN})"
    r"(?: (?P<{0}_unit>mm/mm|1/mm|1/inch|mm|inch|deg))?"
)
#: a range
_RANGE_PATTERN = (
    rf"(?P<range>from|between) {_QUANTITY_PATTERN.format('least')},? (?:to|and) {_QUANTITY_PATTERN.format('most')}"
)
#: a lower bound, or a lower and an upper one
_LOW_PATTERN = (
    rf"(?P<lower>{_LOWER_WORDS}) {_QUANTITY_PATTERN.format('low')}"
    rf"(?:,? and (?P<under>{_UPPER_WORDS}) {_QUANTITY_PATTERN.format('top')})?"
)
#: an upper bound
_HIGH_PATTERN = rf"(?P<upper>{_UPPER_WORDS}) {_QUANTITY_PATTERN.format('high')}"
#: bounds of the value itself: a range, or one or two bounds, followed by nothing that names another quantity
_ALLOWED_PATTERN = rf"(?:{_RANGE_PATTERN}|{_LOW_PATTERN}|{_HIGH_PATTERN})(?=$|[,:]| with | or | either way)"
#: groups of the pattern with a lower and with an upper bound
_BOUND_GROUPS = (("least", "low"), ("most", "top", "high"))
#: a bound of any quantity
_ANY_BOUND = rf"(?:{_UPPER_WORDS}|{_LOWER_WORDS}) {_QUANTITY_PATTERN.format('any')}"
#: a remark in parentheses
_IN_PARENTHESES = r" \([^()]*\)"


class Bounds(NamedTuple):
    """Bounds of an allowed value."""

    #: least allowed value in `unit`, None without a lower bound
    low: float | None
    #: greatest allowed value in `unit`, None without an upper bound
    high: float | None
    #: unit of both bounds
    unit: str
    #: True if the lower bound itself is allowed
    includes_low: bool = True
    #: True if the upper bound itself is allowed
    includes_high: bool = True


class Allowed(str):
    """Allowed values as text, with the bounds that the text states."""

    #: bounds as printed; None if the text has none of the value itself
    bounds: Bounds | None = None

    @classmethod
    def less_than(cls, high: float, unit: str = "", limit: str = "", note: str = "") -> Self:
        """Return values below a bound, which is rounded down.

        - limit: name of the bound, as "the root"; "" for none.
        - note: words behind the bound, with their comma or space.
        """
        return cls._one_bound("less than", None, high, unit, limit, note)

    @classmethod
    def at_most(cls, high: float, unit: str = "", limit: str = "", note: str = "") -> Self:
        """Return values up to a bound, which is rounded down; arguments as for `less_than`."""
        return cls._one_bound("at most", None, high, unit, limit, note)

    @classmethod
    def more_than(cls, low: float, unit: str = "", limit: str = "", note: str = "") -> Self:
        """Return values above a bound, which is rounded up; arguments as for `less_than`."""
        return cls._one_bound("more than", low, None, unit, limit, note)

    @classmethod
    def at_least(cls, low: float, unit: str = "", limit: str = "", note: str = "") -> Self:
        """Return values from a bound, which is rounded up; arguments as for `less_than`."""
        return cls._one_bound("at least", low, None, unit, limit, note)

    @classmethod
    def between(cls, low: float, high: float, unit: str = "", note: str = "") -> Self:
        """Return values between two bounds, which are not allowed themselves; `note` as for `less_than`."""
        return cls._range("between", "and", low, high, unit, note)

    @classmethod
    def from_to(cls, low: float, high: float, unit: str = "", note: str = "") -> Self:
        """Return values between two bounds, which are allowed themselves; `note` as for `less_than`."""
        return cls._range("from", "to", low, high, unit, note)

    @classmethod
    def _one_bound(cls, words: str, low: float | None, high: float | None, unit: str, limit: str, note: str) -> Self:
        figure = rounded_up(low) if low is not None else rounded_down(math.inf if high is None else high)
        name = f"{limit}, " if limit else ""
        text = f"{words} {name}{figure} {unit}".rstrip() + note
        ends = (float(figure), None) if high is None else (None, float(figure))
        return cls._with_bounds(text, ends, unit, includes_low=words != "more than", includes_high=words != "less than")

    @classmethod
    def _range(cls, before: str, middle: str, low: float, high: float, unit: str, note: str) -> Self:
        least, most = rounded_up(low), rounded_down(high)
        text = f"{before} {least} {middle} {most} {unit}".rstrip() + note
        ends, included = (float(least), float(most)), before == "from"
        return cls._with_bounds(text, ends, unit, includes_low=included, includes_high=included)

    @classmethod
    def _with_bounds(
        cls, text: str, ends: tuple[float | None, float | None], unit: str, *, includes_low: bool, includes_high: bool
    ) -> Self:
        made = cls(text)
        # a bound that could not be computed is no bound
        if all(end is None or math.isfinite(end) for end in ends):
            made.bounds = Bounds(ends[0], ends[1], unit, includes_low, includes_high)
        return made


def rounded_down(bound: float) -> str:
    """Return an upper bound as text, rounded down."""
    return _round(bound, math.floor)


def rounded_up(bound: float) -> str:
    """Return a lower bound as text, rounded up."""
    return _round(bound, math.ceil)


def _round(bound: float, whole: Callable[[float], int]) -> str:
    """Return a bound as text, rounded by `whole`."""
    if bound == 0.0 or not math.isfinite(bound):
        return f"{bound:g}"
    unit = 10.0 ** (math.floor(math.log10(abs(bound))) + 1 - BOUND_DIGITS)
    # a number that is whole up to rounding is taken as whole
    nearest = round(bound / unit)
    return f"{(nearest if abs(bound / unit - nearest) < 1e-6 else whole(bound / unit)) * unit:.{BOUND_DIGITS}g}"


def stated_bounds(allowed: str) -> Bounds | None:
    """Return the bounds of the value that a text states; None if it states none, or bounds of another quantity."""
    stated = re.match(_ALLOWED_PATTERN, re.sub(_IN_PARENTHESES, "", allowed))
    if stated is None:
        return None
    part = {name: text for name, text in stated.groupdict().items() if text is not None}
    low, high = (next((float(part[name]) for name in names if name in part), None) for names in _BOUND_GROUPS)
    unit = next((part[name] for name in part if name.endswith("_unit")), "")
    return Bounds(
        low,
        high,
        unit,
        includes_low=part.get("range", "from") == "from" and part.get("lower", "at least") == "at least",
        includes_high=part.get("range", "from") == "from"
        and {part.get("upper"), part.get("under")} <= {"at most", None},
    )


def has_bound(allowed: str) -> bool:
    """Return True if a text states a bound of any quantity."""
    return re.search(_ANY_BOUND, allowed) is not None


def with_unit(allowed: str, unit: str) -> str:
    """Return allowed values with a unit behind the last bound, if they state bounds of the value without a unit."""
    stated = re.match(_ALLOWED_PATTERN, allowed)
    if stated is None or not unit or any(text for name, text in stated.groupdict().items() if name.endswith("_unit")):
        return allowed
    end = max(stated.end(name) for names in _BOUND_GROUPS for name in names)
    return f"{allowed[:end]} {unit}{allowed[end:]}"


def in_unit(line: str, unit: str, mm: float) -> str:
    """Return a message with its lengths, which are in mm, in another unit of length `mm`; bounds are rounded inwards."""
    return line if mm == 1.0 else re.sub(_LENGTHS_PATTERN, lambda lengths: _in_unit(lengths, unit, mm), line)


def _in_unit(lengths: re.Match[str], unit: str, mm: float) -> str:
    """Return one or several lengths, as "from 1 to 2.5 mm", in another unit."""

    def convert(number: re.Match[str]) -> str:
        figure = float(number["figure"]) / mm
        step = 10.0 ** (math.floor(math.log10(abs(figure))) - LENGTH_DIGITS + 1) if figure else 1.0
        # a figure that is whole except for rounding errors stays whole
        whole = (math.floor, math.ceil, round)[_BOUND_WORDS.get(number["bound"], 2)]
        nearest = round(figure / step)
        count = nearest if abs(figure / step - nearest) < 1e-4 else whole(figure / step)
        return f"{number['bound'] or ''}{count * step:.{LENGTH_DIGITS}g}"

    return f"{re.sub(_NUMBER_PATTERN, convert, lengths[1])} {unit}"
