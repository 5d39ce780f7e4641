"""Lengths as people write them: a number and its unit, as 15um, 0.01 mm or 0.5in."""

from __future__ import annotations

import re
from decimal import Decimal, InvalidOperation

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
