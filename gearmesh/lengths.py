"""Lengths as people write them: a number and its unit, as 15um, 0.01 mm or 0.5in."""

from __future__ import annotations

import math
import numbers
import re
from decimal import Decimal, InvalidOperation

from gearmesh.errors import ArgumentError

#: mm, or a text with its unit
Length = float | str

#: mm in a unit of length; decimal, so that 9um is 0.009 mm to the last digit
MM: dict[str, Decimal] = {
    "um": Decimal("0.001"),
    "µm": Decimal("0.001"),
    "μm": Decimal("0.001"),
    "mm": Decimal(1),
    "in": Decimal("25.4"),
    "inch": Decimal("25.4"),
}
#: how a length with its unit looks, for messages
EXAMPLES = "15um, 0.01mm or 0.0004in"

#: mm: tolerances that meshes and curves can have
FINEST, COARSEST = 1e-5, 10.0

_LENGTH = re.compile(r"\s*([-+.0-9eE]+)\s*([a-zµμ]*)\s*")


def length(text: str, unit: str, bare: str | None = None) -> float | None:
    """The length that a text says, in `unit`, a text without a unit being in `bare`; None where it says none."""
    match = _LENGTH.fullmatch(text)
    if match is None:
        return None
    number, own = match[1], match[2] or bare
    if own not in MM:
        return None
    try:
        return float(Decimal(number) * MM[own] / MM[unit])
    except (InvalidOperation, ArithmeticError):
        return None


def in_mm(
    name: str, value: Length, low: float = -math.inf, high: float = math.inf, examples: str = "5, -2.5mm or 0.1in"
) -> float:
    """A length that somebody gives, in mm: a bare number, also as a text, is one of mm.

    Raises DesignError with `name`, value and what is allowed: a finite one from `low` to `high` (mm).
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
    """A tolerance that somebody gives, in mm. Raises DesignError as `in_mm`."""
    return in_mm(name, value, FINEST, COARSEST, "10um, 0.01mm or 0.0004in")


def _words(mm: float) -> str:
    return f"{1e3 * mm:g}um" if abs(mm) < 0.1 else f"{mm:g}mm"
