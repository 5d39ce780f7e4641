"""Tables as CSV: all tables are written here, and reading restores every cell.

A spreadsheet takes a cell that begins with = + - or @ for a formula and runs it. Such a text gets an apostrophe in
front, the mark that spreadsheets use for texts; numbers stay numbers. A text that begins with apostrophes before such a
sign gets one more, so that reading finds the text again.
"""

from __future__ import annotations

import csv
import io
import json
import math
import re
from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from gearmesh.errors import FileError
from gearmesh.numerals import is_number, parse_number, with_point

#: characters of a refused cell that messages show
MAX_CELL_CHARACTERS = 40

#: separators of columns that are refused by name: those of spreadsheets where numbers have decimal commas, and of copied cells
OTHER_SEPARATORS = {";": "semicolons", "\t": "tabs"}

#: beginning of a cell that a spreadsheet runs: also behind blanks that it ignores, and in wide forms of East Asian
#: keyboards
_FORMULA_START = re.compile(r"'*[\s\0]*[=+\-@\uff1d\uff0b\uff0d\uff20]|'*[\t\r\n\0]")


def csv_text(head: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    """Return rows of values under a head; None and numbers that are not finite are empty cells, numbers have all
    digits.
    """
    lines = _Lines()
    # with this terminator cells that hold either of its characters are quoted
    writer = csv.writer(lines, lineterminator="\r\n")
    writer.writerow(map(_write_cell, head))
    writer.writerows([_write_cell(value) for value in row] for row in rows)
    return "".join(lines)


def cell_number(path: object, line: int, column: str, cell: str) -> float:
    """Return the finite number in a cell. Raises FileError naming file, line, column and cell."""
    value = parse_number(cell)
    if value is None:
        raise refused_cell(path, line, column, cell, "a finite number")
    return value


def refused_cell(path: object, line: int, column: str, cell: str, must_be: str) -> FileError:
    """Return the refusal of a cell; `must_be`: allowed content."""
    shown = json.dumps(cell if len(cell) <= MAX_CELL_CHARACTERS else f"{cell[:MAX_CELL_CHARACTERS]}...")
    return FileError(str(path), reason=f"line {line}: {column} = {shown}: must be {must_be}", remedy=with_point(cell))


class _Lines(list[str]):
    """Written lines, ended as in text files."""

    def write(self, line: str) -> None:
        self.append(line.removesuffix("\r\n") + "\n")


def csv_rows(text: str, path: object) -> Iterator[tuple[int, list[str]]]:
    """Yield the texts of each line that is not empty, with the number of the line's last row. Empty cells beyond the
    named columns, as spreadsheets and measuring machines leave them, are none. Raises FileError naming file and line,
    also for columns that are separated by something else than commas.
    """
    reader, width = csv.reader(io.StringIO(text, newline="")), 0
    while True:
        try:
            row = next(reader)
        except StopIteration:
            return
        except csv.Error as failure:
            raise FileError(str(path), reason=f"line {reader.line_num}: {failure}") from None
        if row:
            filled = max((k for k, cell in enumerate(row, 1) if cell.strip()), default=1)
            if not width and not row[0].lstrip().startswith("#"):
                _refuse_separators(path, reader.line_num, row)
                width = filled
            yield reader.line_num, [_read(cell) for cell in row[: max(width, filled)]]


def _refuse_separators(path: object, line: int, head: Sequence[str]) -> None:
    """Refuse a head whose columns are separated as spreadsheets of many countries do."""
    for mark, name in OTHER_SEPARATORS.items():
        if len(head) == 1 and mark in head[0]:
            raise FileError(
                str(path),
                reason=f"line {line}: columns are separated by {name}: must be by commas, and numbers have a decimal point",
            )


def _write_cell(value: Any) -> Any:
    """Return a value as a cell; texts that a spreadsheet would run get an apostrophe."""
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return ""
    if isinstance(value, str) and _FORMULA_START.match(value) and not is_number(value):
        return f"'{value}"
    return value


def _read(cell: str) -> str:
    """Return the text of a cell, without that apostrophe."""
    return cell[1:] if cell.startswith("'") and _FORMULA_START.match(cell) and not is_number(cell[1:]) else cell
