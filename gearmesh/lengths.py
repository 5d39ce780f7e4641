"""Lengths as people write them: a number and its unit, as 15um, 0.01 mm or 0.5in."""

from __future__ import annotations

import math
import numbers
import re
from decimal import Decimal, InvalidOperation

from gearmesh.errors import ArgumentError

#: a number of mm, or a text with a unit
Length = float | str

#: decimal, so that 9um is 0.009 mm to the last digit
MM_PER_UNIT: dict[str, Decimal] = {
    "um": Decimal("0.001"),
    "µm": Decimal("0.001"),
    "μm": Decimal("0.001"),
    "mm": Decimal(1),
    "in": Decimal("25.4"),
    "inch": Decimal("25.4"),
}
#: examples of lengths with units, for messages
LENGTH_EXAMPLES = "15um, 0.01mm or 0.0004in"

#: smallest tolerance of meshes and curves
MIN_TOLERANCE_MM = 1e-5
#: largest tolerance of meshes and curves
MAX_TOLERANCE_MM = 10.0

#: a number and a unit
_LENGTH_PATTERN = re.compile(r"\s*([-+.0-9eE]+)\s*([a-zµμ]*)\s*")


def length(text: str, unit: str, bare: str | None = None) -> float | None:
    """Return the length of a text, in `unit`; a text without a unit is in `bare`. None for any other text."""
    match = _LENGTH_PATTERN.fullmatch(text)
    if match is None:
        return None
    number, text_unit = match[1], match[2] or bare
    if text_unit not in MM_PER_UNIT:
        return None
    try:
        return float(Decimal(number) * MM_PER_UNIT[text_unit] / MM_PER_UNIT[unit])
    except (InvalidOperation, ArithmeticError):
        return None


def in_mm(
    name: str, value: Length, low: float = -math.inf, high: float = math.inf, examples: str = "5, -2.5mm or 0.1in"
) -> float:
    """Return a given length in mm; a number without a unit, also as a text, is in mm.

    Raises DesignError with `name`, the value and what is allowed, if it is not a finite length from `low` to `high`, mm.
    """
    if isinstance(value, str):
        mm = length(value, "mm", bare="mm")
    else:
        mm = float(value) if isinstance(value, numbers.Real) and not isinstance(value, bool) else None
    if mm is None or not math.isfinite(mm) or not low <= mm <= high:
        limits = f", from {_words(low)} to {_words(high)}" if math.isfinite(high) else ""
        raise ArgumentError(name, str(value)[:60], must_be=f"a length as {examples}{limits}")
    return mm


def tolerance_in_mm(name: str, value: Length) -> float:
    """Return a given tolerance in mm. Raises DesignError as `in_mm` does."""
    return in_mm(name, value, MIN_TOLERANCE_MM, MAX_TOLERANCE_MM, "10um, 0.01mm or 0.0004in")


def _words(mm: float) -> str:
    """Return a length in the unit that suits it."""
    return f"{1e3 * mm:g}um" if abs(mm) < 0.1 else f"{mm:g}mm"
