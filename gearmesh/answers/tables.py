"""Answers as tables: aligned text of at most 80 columns, HTML, and JSON in which what is not a number is null."""

from __future__ import annotations

import json
import math
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from gearmesh.design.shown import html_table
from gearmesh.figures import Figures, Summary, shown_values
from gearmesh.files import csv_table

#: characters in a line
WIDTH = 80
#: blanks between columns, and the least width to which a column of words is folded
GAP, NARROWEST = 2, 12


@dataclass(frozen=True)
class Listing:
    """A table to print: title, column headings (with units) and rows of values; `timed`: columns, or rows by what stands first in
    them, that hold run times."""

    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[Any]]
    timed: frozenset[str] = frozenset()

    @property
    def timeless(self) -> Listing:
        """The same without run times, alike from run to run."""
        kept = [k for k, column in enumerate(self.columns) if column not in self.timed]
        rows = [[row[k] for k in kept] for row in self.rows if row[0] not in self.timed] if self.timed else self.rows
        return replace(self, columns=[self.columns[k] for k in kept], rows=rows)

    @property
    def numeric(self) -> list[bool]:
        """Which columns hold numbers only, unknown ones too."""
        columns = [[row[k] for row in self.rows if row[k] is not None] for k in range(len(self.columns))]
        return [all(isinstance(value, int | float) for value in column) for column in columns]

    @property
    def cells(self) -> list[list[str]]:
        """All values as text."""
        return [[cell(value) for value in row] for row in self.rows]


def figures(title: str, values: Figures | Summary) -> Listing:
    """Figures, one per row, under their JSON keys, those within figures laid flat; what is below their resolution is 0, which JSON
    does not round."""
    rows = []
    for key, value in shown_values(values.entries).items():
        value = plain(value)
        rows.append((key, ", ".join(map(cell, value)) if isinstance(value, list) else value))
    return Listing(title, ("", ""), rows, run_time_keys(values))


def run_time_keys(values: Figures | Summary) -> frozenset[str]:
    """Keys of those that are run times."""
    return frozenset(entry.key for entry in values.entries if entry.figure.timing)


def align(listing: Listing, width: int = WIDTH) -> str:
    """A table as plain text: title, headings, then rows, columns at least two blanks apart.

    Where it is wider than `width`, columns of words are wrapped, and columns of numbers continue in further blocks below, each
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
    return "".join(text)


def _fold(widths: list[int], longest: list[int], numeric: list[bool], width: int) -> list[int]:
    """Widths of columns with those of words made narrower until all fit, or none can be: down to their `longest` words, and further
    only where a column does not even fit beside the first, which keeps its words whole."""
    widths = list(widths)
    narrowest = [max(NARROWEST, word) for word in longest]
    while sum(widths) + GAP * (len(widths) - 1) > width:
        wide = [k for k, number in enumerate(numeric) if not number and widths[k] > narrowest[k]]
        if not wide:
            break
        widths[max(wide, key=lambda k: widths[k])] -= 1
    for k in range(1, len(widths)):
        if not numeric[k]:
            widths[k] = min(widths[k], max(NARROWEST, width - GAP - widths[0]))
    return widths


def _blocks(widths: list[int], width: int) -> list[list[int]]:
    """Columns shared out into blocks that fit, the first column at the beginning of each."""
    blocks: list[list[int]] = [[0]] if widths else []
    for k in range(1, len(widths)):
        if sum(widths[i] + GAP for i in blocks[-1]) + widths[k] > width and len(blocks[-1]) > 1:
            blocks.append([0])
        blocks[-1].append(k)
    return blocks


def _lines(row: Sequence[str], widths: Sequence[int], numeric: Sequence[bool]) -> Iterator[str]:
    """A row as lines, its cells wrapped to the widths."""
    folded = [
        textwrap.wrap(text, size, break_on_hyphens=False) or [""] if len(text) > size else [text]
        for text, size in zip(row, widths, strict=True)
    ]
    for i in range(max(map(len, folded))):
        parts = [column[i] if i < len(column) else "" for column in folded]
        yield (
            (" " * GAP)
            .join(
                part.rjust(size) if number else part.ljust(size)
                for part, size, number in zip(parts, widths, numeric, strict=True)
            )
            .rstrip()
        )


def as_html(listings: Sequence[Listing]) -> str:
    """Tables as HTML, for notebooks."""
    return "".join(html_table(listing.title, listing.columns, listing.cells) for listing in listings)


def cell(value: Any) -> str:
    """A value as a table shows it."""
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "-"
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:.7g}" if isinstance(value, float) else str(value)


def plain(value: Any) -> Any:
    """Nested data with numpy numbers and arrays made Python ones, and NaN and infinities made None."""
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def json_text(document: Mapping[str, Any]) -> str:
    """A document as JSON text."""
    return json.dumps(plain(document), indent=1, allow_nan=False) + "\n"


def csv_text(rows: Sequence[Mapping[str, Any]]) -> str:
    """Rows (one at least) with the same keys as CSV, what is not a number left empty."""
    head = list(rows[0])
    return csv_table.csv_text(head, ([plain(row[name]) for name in head] for row in rows))


def round_to(value: float, digits: int) -> float:
    """A number for people, without -0."""
    return round(value, digits) + 0.0
