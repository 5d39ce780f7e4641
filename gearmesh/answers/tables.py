"""Tables of answers: aligned text of at most 80 columns, HTML, and JSON in which null stands for NaN."""

from __future__ import annotations

import json
import math
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from gearmesh.design.shown import html_table
from gearmesh.figures import Figures, Summary, at_resolution, shown_values
from gearmesh.files import csv_table
from gearmesh.records import dataclass

#: characters in a line
LINE_WIDTH = 80
#: blanks between columns
COLUMN_GAP = 2
#: smallest width to which a column of words is folded
MIN_COLUMN_WIDTH = 12


@dataclass(frozen=True)
class Listing:
    """Table to print."""

    #: title above the table; may be empty
    title: str
    #: headings of the columns, with units
    columns: Sequence[str]
    #: values, row by row
    rows: Sequence[Sequence[Any]]
    #: columns with run times; also rows with run times, by their first value
    timed: frozenset[str] = frozenset()
    #: lines below the table, as meanings of columns
    notes: Sequence[str] = ()

    @property
    def timeless(self) -> Listing:
        """The table without run times, which is the same from run to run."""
        kept = [k for k, column in enumerate(self.columns) if column not in self.timed]
        rows = [[row[k] for k in kept] for row in self.rows if row[0] not in self.timed] if self.timed else self.rows
        return replace(self, columns=[self.columns[k] for k in kept], rows=rows)

    @property
    def numeric(self) -> list[bool]:
        """True for each column that holds only numbers or unknown values."""
        columns = [[row[k] for row in self.rows if row[k] is not None] for k in range(len(self.columns))]
        return [all(isinstance(value, int | float) for value in column) for column in columns]

    @property
    def cells(self) -> list[list[str]]:
        """All values as text."""
        return [[cell(value) for value in row] for row in self.rows]


def figures(title: str, values: Figures | Summary) -> Listing:
    """Return figures as a table, one per row, under their JSON keys. Nested figures are flattened.

    Values below their resolution are shown as 0; JSON contains them unrounded.
    """
    rows = []
    for key, value in shown_values(values.entries).items():
        value = plain(value)
        rows.append((key, ", ".join(map(cell, value)) if isinstance(value, list) else value))
    return Listing(title, ("", ""), rows, run_time_keys(values))


def described(title: str, values: Figures | Summary) -> Listing:
    """Return figures as a table for people: meaning, value to four digits, unit and key.

    Unknown figures, sizes of rounding and run times are left out.
    """
    rows = []
    for entry in values.entries:
        known, value = entry.figure, plain(at_resolution(entry.value, entry.figure.resolution))
        if known.timing or known.rounding or value is None or value == []:
            continue
        text = ", ".join(map(_four_digits, value)) if isinstance(value, list) else _four_digits(value)
        rows.append((known.meaning, text, known.unit, known.key))
    return Listing(title, ("", "value", "unit", "key"), rows)


def _four_digits(value: Any) -> str:
    if not isinstance(value, float):
        return cell(value)
    return f"{value:.4g}" if abs(value) < 1e4 else f"{value:.0f}"


def run_time_keys(values: Figures | Summary) -> frozenset[str]:
    """Return the keys of figures that are run times."""
    return frozenset(entry.key for entry in values.entries if entry.figure.timing)


def align(listing: Listing, width: int = LINE_WIDTH) -> str:
    """Return a table as plain text: title, headings, then rows, with columns at least two blanks apart.

    If it is wider than `width`, columns of words are wrapped. Columns of numbers continue in further blocks below, each
    with the first column before it.
    """
    table = [list(listing.columns), *listing.cells]
    columns = list(zip(*table, strict=True))
    numeric = listing.numeric
    words = [max((len(word) for text in column for word in text.split()), default=0) for column in columns]
    widths = _fold([max(map(len, column)) for column in columns], words, numeric, width)
    blocks = _blocks(widths, width)
    text = [listing.title + "\n"] if listing.title else []
    for number, block in enumerate(blocks):
        text += ["\n"] if number else []
        rows = [[row[k] for k in block] for row in table[0 if any(listing.columns) else 1 :]]
        for row in rows:
            text += [line + "\n" for line in _lines(row, [widths[k] for k in block], [numeric[k] for k in block])]
    for note in listing.notes:
        text += [line + "\n" for line in textwrap.wrap(note, width, subsequent_indent="  ", break_on_hyphens=False)]
    return "".join(text)


def _fold(widths: list[int], longest: list[int], numeric: list[bool], width: int) -> list[int]:
    """Return widths of columns, with columns of words made narrower until all fit or none can be narrower.

    Columns keep their `longest` words whole. Only a column that does not fit beside the first column is made narrower
    still; the first column always keeps its words whole.
    """
    widths = list(widths)
    narrowest = [max(MIN_COLUMN_WIDTH, word) for word in longest]
    while sum(widths) + COLUMN_GAP * (len(widths) - 1) > width:
        wide = [k for k, number in enumerate(numeric) if not number and widths[k] > narrowest[k]]
        if not wide:
            break
        widths[max(wide, key=lambda k: widths[k])] -= 1
    for k in range(1, len(widths)):
        if not numeric[k]:
            widths[k] = min(widths[k], max(MIN_COLUMN_WIDTH, width - COLUMN_GAP - widths[0]))
    return widths


def _blocks(widths: list[int], width: int) -> list[list[int]]:
    """Return the columns divided into blocks that fit, each beginning with the first column."""
    blocks: list[list[int]] = [[0]] if widths else []
    for k in range(1, len(widths)):
        if sum(widths[i] + COLUMN_GAP for i in blocks[-1]) + widths[k] > width and len(blocks[-1]) > 1:
            blocks.append([0])
        blocks[-1].append(k)
    return blocks


def _lines(row: Sequence[str], widths: Sequence[int], numeric: Sequence[bool]) -> Iterator[str]:
    """Yield the lines of a row, with its cells wrapped to the widths."""
    folded = [
        textwrap.wrap(text, size, break_on_hyphens=False) or [""] if len(text) > size else [text]
        for text, size in zip(row, widths, strict=True)
    ]
    for i in range(max(map(len, folded))):
        parts = [column[i] if i < len(column) else "" for column in folded]
        yield (
            (" " * COLUMN_GAP)
            .join(
                part.rjust(size) if number else part.ljust(size)
                for part, size, number in zip(parts, widths, numeric, strict=True)
            )
            .rstrip()
        )


def as_html(listings: Sequence[Listing]) -> str:
    """Return tables as HTML, for notebooks."""
    import html

    return "".join(
        html_table(listing.title, listing.columns, listing.cells)
        + "".join(f'<p class="note">{html.escape(note)}</p>' for note in listing.notes)
        for listing in listings
    )


def cell(value: Any) -> str:
    """Return the text of a value in a table."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "-"
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:.7g}" if isinstance(value, float) else str(value)


def plain(value: Any) -> Any:
    """Return nested data with Python numbers and lists in place of NumPy's, and None in place of NaN and infinities."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def json_text(document: Mapping[str, Any]) -> str:
    """Return a document as JSON text."""
    return json.dumps(plain(document), indent=1, allow_nan=False) + "\n"


def csv_text(rows: Sequence[Mapping[str, Any]]) -> str:
    """Return rows (at least one) with the same keys as CSV; NaN and infinities are empty."""
    head = list(rows[0])
    return csv_table.csv_text(head, ([plain(row[name]) for name in head] for row in rows))


def round_to(value: float, digits: int) -> float:
    """Return a rounded number for a table, without -0."""
    return round(value, digits) + 0.0
