"""Tables as CSV: all that are written go through here, and what is written is read back as it was.

A spreadsheet takes a cell that begins with = + - or @ for a formula and runs it. A text that does gets an apostrophe before it, by
which spreadsheets know texts; numbers stay numbers. So that reading finds the text again, one that begins so behind apostrophes of
its own gets one more.
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
SHOWN = 40

#: what makes a spreadsheet run a cell: also behind the blanks that it leaves out, and in the wide forms of East Asian keyboards
_RUN = re.compile(r"'*[\s\0]*[=+\-@\uff1d\uff0b\uff0d\uff20]|'*[\t\r\n\0]")


def csv_text(head: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    """Rows of values under a head; empty where there is nothing or what is no number, numbers to the last digit."""
    lines = _Lines()
    # with this terminator cells that hold either of its characters are quoted
    writer = csv.writer(lines, lineterminator="\r\n")
    writer.writerow(map(_write_cell, head))
    writer.writerows([_write_cell(value) for value in row] for row in rows)
    return "".join(lines)


def cell_number(path: object, line: int, column: str, cell: str) -> float:
    """The finite number in a cell. Raises FileError naming file, line, column and cell."""
    value = parse_number(cell)
    if value is None:
        raise refused_cell(path, line, column, cell, "a finite number")
    return value


def refused_cell(path: object, line: int, column: str, cell: str, must_be: str) -> FileError:
    """The refusal of a cell; `must_be`: what may be there."""
    shown = json.dumps(cell if len(cell) <= SHOWN else f"{cell[:SHOWN]}...")
    return FileError(str(path), reason=f"line {line}: {column} = {shown}: must be {must_be}", remedy=with_point(cell))


class _Lines(list[str]):
    """Lines as they are written, ended as text files are."""

    def write(self, line: str) -> None:
        self.append(line.removesuffix("\r\n") + "\n")


def csv_rows(text: str, path: object) -> Iterator[tuple[int, list[str]]]:
    """Lines that are not empty, by the number of their last line, as texts. Raises FileError naming file and line."""
    reader = csv.reader(io.StringIO(text, newline=""))
    while True:
        try:
            row = next(reader)
        except StopIteration:
            return
        except csv.Error as failure:
            raise FileError(str(path), reason=f"line {reader.line_num}: {failure}") from None
        if row:
            yield reader.line_num, [_read(cell) for cell in row]


def _write_cell(value: Any) -> Any:
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return ""
    if isinstance(value, str) and _RUN.match(value) and not is_number(value):
        return f"'{value}"
    return value


def _read(cell: str) -> str:
    return cell[1:] if cell.startswith("'") and _RUN.match(cell) and not is_number(cell[1:]) else cell
