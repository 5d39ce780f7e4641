"""Rows of symbol, words, unit and values as tables of a sheet."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TypeAlias

from gearmesh.systems.system import SheetTable

#: decimals of every value: what is less is rounding
DECIMALS = 9

#: one value per column, None where there is none
Values: TypeAlias = "tuple[float | int | str | None, ...]"
#: symbol, words, unit, values
Row: TypeAlias = "tuple[str, str, str, Values]"


def table(title: str, columns: tuple[str, ...], rows: Iterable[Row]) -> SheetTable:
    """A table of rows of symbol, words, unit and values."""
    rows = tuple(rows)
    return SheetTable(
        title,
        columns,
        tuple((words, unit, *(_clean(value) for value in values)) for _, words, unit, values in rows),
        tuple(symbol for symbol, *_ in rows),
    )


def _clean(value: float | int | str | None) -> float | int | str | None:
    """A value without what is nothing but rounding; None for what is not a number."""
    if not isinstance(value, float):
        return value
    return round(value, DECIMALS) + 0.0 if math.isfinite(value) else None
