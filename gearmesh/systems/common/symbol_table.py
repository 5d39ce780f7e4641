"""Rows of symbol, words, unit and values as tables of a sheet; a missing value is a dash with its reason.

A refused value, row or table does not prevent the sheet: values go through `attempt`, tables through `tables_of`. Rows of
torque, speed and power are the same for all members that turn.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TypeAlias, TypeVar

from gearmesh.errors import GearmeshError
from gearmesh.records import dataclass
from gearmesh.systems.system import MissingValue, SheetTable

ValueT = TypeVar("ValueT")

#: position of the first value in a row of a table, after item and unit
FIRST_VALUE_COLUMN = 2
#: decimals of every value: smaller parts are rounding
VALUE_DECIMALS = 9


@dataclass(frozen=True)
class Missing:
    """A value that a row does not have, and the `reason`."""

    reason: str


#: one value per column; None if the column has no such value
Values: TypeAlias = "tuple[float | int | str | Missing | None, ...]"
#: symbol, words, unit, values
Row: TypeAlias = "tuple[str, str, str, Values]"
#: title of a table, or of several tables, and the call that makes them
Part: TypeAlias = "tuple[str, Callable[[], SheetTable | Iterable[SheetTable]]]"


def attempt(value: Callable[[], ValueT]) -> ValueT | Missing:
    """Return a value, or the reason why it is refused."""
    try:
        return value()
    except GearmeshError as refusal:
        return Missing(refusal.reason or str(refusal))


def values_of(
    given: Iterable[ValueT | Missing | None], value: Callable[[ValueT], float | int | str | Missing | None]
) -> Values:
    """Return a value for every given item; missing items stay missing, and None stays None."""
    return tuple(_of(item, value) for item in given)


def _of(
    item: ValueT | Missing | None, value: Callable[[ValueT], float | int | str | Missing | None]
) -> float | int | str | Missing | None:
    """Return the value of an item, or the item itself if it is missing or None."""
    if item is None or isinstance(item, Missing):
        return item
    return attempt(lambda: value(item))


def table(title: str, columns: tuple[str, ...], rows: Iterable[Row]) -> SheetTable:
    """Return a table from rows of symbol, words, unit and values."""
    rows = tuple(rows)
    return SheetTable(
        title,
        columns,
        tuple((words, unit, *(_clean(value) for value in values)) for _, words, unit, values in rows),
        tuple(symbol for symbol, *_ in rows),
        tuple(
            MissingValue(symbol, column, value.reason)
            for symbol, _, _, values in rows
            for column, value in zip(columns, values, strict=False)
            if isinstance(value, Missing)
        ),
    )


def side_by_side(parts: Sequence[Sequence[Row]]) -> list[Row]:
    """Return rows with the values of all parts, which have the same rows."""
    first, *others = parts
    return [
        (*row[:3], tuple(value for part in (row, *beside) for value in part[3]))
        for row, *beside in zip(first, *others, strict=True)
    ]


def column_of(of: SheetTable, column: int) -> SheetTable:
    """Return a table with only one of its columns, by number; an empty table is unchanged."""
    return columns_of(of, (column,))


def columns_of(of: SheetTable, columns: Iterable[int]) -> SheetTable:
    """Return a table with only some of its columns, by numbers; an empty table is unchanged."""
    if not of.columns:
        return of
    numbers = [*columns]
    names = tuple(of.columns[column] for column in numbers)
    rows = tuple(
        (*row[:FIRST_VALUE_COLUMN], *(row[FIRST_VALUE_COLUMN + column] for column in numbers)) for row in of.rows
    )
    # columns of the same name belong to one member
    return replace(of, columns=names, rows=rows, missing=tuple(_once(m for m in of.missing if m.column in names)))


def _once(missing: Iterable[MissingValue]) -> Iterable[MissingValue]:
    return dict.fromkeys(missing)


def tables_of(*parts: Part) -> tuple[SheetTable, ...]:
    """Return the tables of a sheet, part by part.

    A refused part is replaced by an empty table of its title, with the reason.
    """
    return tuple(table_of_part for part in parts for table_of_part in _part_tables(*part))


def tables_by_title(parts: Mapping[str, tuple[tuple[str, ...], Callable[[], Iterable[Row]]]]) -> tuple[SheetTable, ...]:
    """Return tables by title, columns and the call that makes their rows, each as far as it is not refused."""
    return tables_of(*((title, partial(_table_of, title, *part)) for title, part in parts.items()))


def _table_of(title: str, columns: tuple[str, ...], rows: Callable[[], Iterable[Row]]) -> SheetTable:
    return table(title, columns, rows())


def _part_tables(title: str, make: Callable[[], SheetTable | Iterable[SheetTable]]) -> Iterator[SheetTable]:
    """Yield the tables of a part, or an empty table with the reason of its refusal."""
    made = attempt(lambda: _table_list(make()))
    yield from (
        [SheetTable(title, (), (), (), (MissingValue("", "", made.reason),))] if isinstance(made, Missing) else made
    )


def _table_list(made: SheetTable | Iterable[SheetTable]) -> list[SheetTable]:
    return [made] if isinstance(made, SheetTable) else list(made)


def _clean(value: float | int | str | Missing | None) -> float | int | str | None:
    """Return a value without rounding errors; None if it is missing or not a number."""
    if isinstance(value, Missing):
        return None
    if not isinstance(value, float):
        return value
    return round(value, VALUE_DECIMALS) + 0.0 if math.isfinite(value) else None


def running_rows(torques: Sequence[float], speeds: Sequence[float] | None) -> list[Row]:
    """Return the rows of torques (Nm), speeds (1/min) and powers; only torques if there are no `speeds`."""
    rows: list[Row] = [("T", "torque", "Nm", tuple(torques))]
    if speeds is None:
        return rows
    power = tuple(1e-3 * torque * math.pi * speed / 30.0 for torque, speed in zip(torques, speeds, strict=True))
    return [*rows, ("n", "speed", "1/min", tuple(speeds)), ("P", "power, without losses", "kW", power)]
