"""Tables that scripts measured: kept as CSV in scripts/measured, shown in pages by a line that is a link to the file.

    [Contact, one batch against scipy](measured/contact.csv)

The site shows such a line as the table. Sentences with figures stand in a page between two comments, which Markdown does not show:

    <!-- bench:figures -->
    Contact at 201 positions takes 0.03 s.
    <!-- /bench -->
"""

from __future__ import annotations

import csv
import os
import re
from collections.abc import Mapping, Sequence
from io import StringIO
from pathlib import Path

Row = Mapping[str, object]
#: the folder of all kept tables
MEASURED = Path(__file__).resolve().parent / "measured"
#: a line of a page that is nothing but a link to a kept table
SHOWN = re.compile(r"^\[([^][]*)\]\((?:[\w./]*/)?measured/(\w+)\.csv\)$", re.MULTILINE)


def table(rows: Sequence[Row], columns: Mapping[str, str]) -> str:
    """A Markdown table: `columns` says which keys of the rows are shown, in which order, under which title.

    Numbers are at the right, floats to three digits, whole ones with commas between thousands; what a row lacks is left empty.
    """
    if not rows or not columns:
        raise ValueError("a table needs rows and columns")
    numeric = [all(isinstance(row.get(key, 0), int | float) for row in rows) for key in columns]
    lines = [list(columns.values()), ["---:" if right else "---" for right in numeric]]
    lines += [[cell(row[key]) if key in row else "" for key in columns] for row in rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def cell(value: object) -> str:
    """A value as a table shows it."""
    if isinstance(value, float):
        short = f"{value:.3g}"
        return f"{float(short):,.0f}" if 1000.0 <= abs(value) < 1e15 else short
    return f"{value:,}" if isinstance(value, int) else str(value).replace("|", "\\|")


def keep(name: str, rows: Sequence[Row], columns: Mapping[str, str]) -> None:
    """Write a table to its file: titles first, floats to three digits, empty cells where a row lacks a key."""
    if not rows or not columns:
        raise ValueError("a table needs rows and columns")
    text = StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns.values())
    writer.writerows([_plain(row.get(key, "")) for key in columns] for row in rows)
    MEASURED.mkdir(exist_ok=True)
    _whole(MEASURED / f"{name}.csv", text.getvalue())


def kept(name: str) -> list[dict[str, str]]:
    """Rows of a kept table by the titles of their columns; a title that occurs again has its number behind it.

    Raises ValueError if there is no such table.
    """
    titles, *lines = _lines(name)
    numbered = [
        title if title not in titles[:k] else f"{title} {titles[: k + 1].count(title)}"
        for k, title in enumerate(titles)
    ]
    return [dict(zip(numbered, line, strict=True)) for line in lines]


def shown(text: str) -> str:
    """The text of a page with kept tables in the place of the lines that link to them."""
    return SHOWN.sub(lambda link: _markdown(link[2]), text)


def _markdown(name: str) -> str:
    titles, *lines = _lines(name)
    columns = {str(k): title for k, title in enumerate(titles)}
    rows = [{str(k): _value(cell) for k, cell in enumerate(line) if cell} for line in lines]
    return table(rows, columns)


def _lines(name: str) -> list[list[str]]:
    path = MEASURED / f"{name}.csv"
    if not path.is_file():
        raise ValueError(f"{MEASURED.name} has no table {name}")
    return list(csv.reader(StringIO(path.read_text(encoding="utf-8"))))


def _plain(value: object) -> str:
    return f"{value:.3g}" if isinstance(value, float) else str(value)


def _value(text: str) -> int | float | str:
    """The number that a cell holds; a text with a sign before it, as +3.1, stays as it is."""
    if text[:1] == "+":
        return text
    for number in (int, float):
        try:
            return number(text)
        except ValueError:
            pass
    return text


def replaced(text: str, name: str, content: str) -> str:
    """`text` with `content` in its block of that name. Raises ValueError unless there is exactly one such block."""
    pattern = re.compile(rf"(^<!-- bench:{re.escape(name)} -->\n)(.*?)(^<!-- /bench -->$)", re.DOTALL | re.MULTILINE)
    found = pattern.findall(text)
    if len(found) != 1 or "<!-- bench:" in found[0][1]:
        raise ValueError(f"there must be one block <!-- bench:{name} --> ... <!-- /bench -->, not {len(found)}")
    return pattern.sub(lambda block: f"{block[1]}{content.rstrip()}\n{block[3]}", text)


def rewrite(path: Path, blocks: Mapping[str, str]) -> None:
    """Replace several blocks of a file; if one of them is not in the file, none is replaced."""
    text = path.read_text(encoding="utf-8")
    for name, content in blocks.items():
        text = replaced(text, name, content)
    _whole(path, text)


def _whole(path: Path, text: str) -> None:
    """Write a file as a whole: if writing fails, the old file stays."""
    temporary = path.with_name(path.name + ".new")
    temporary.write_text(text, encoding="utf-8")
    os.replace(temporary, path)
