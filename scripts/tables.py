"""Tables of figures in Markdown files, written by the scripts that measured them.

A block of a file that a script may rewrite stands between two comments, which Markdown does not show:

    <!-- bench:contact -->
    | contact | time, s |
    | --- | ---: |
    | one batch | 0.017 |
    <!-- /bench -->
"""

from __future__ import annotations

import os
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

Row = Mapping[str, object]


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


def replaced(text: str, name: str, content: str) -> str:
    """`text` with `content` in its block of that name. Raises ValueError unless there is exactly one such block."""
    pattern = re.compile(rf"(^<!-- bench:{re.escape(name)} -->\n)(.*?)(^<!-- /bench -->$)", re.DOTALL | re.MULTILINE)
    found = pattern.findall(text)
    if len(found) != 1 or "<!-- bench:" in found[0][1]:
        raise ValueError(f"there must be one block <!-- bench:{name} --> ... <!-- /bench -->, not {len(found)}")
    return pattern.sub(lambda block: f"{block[1]}{content.rstrip()}\n{block[3]}", text)


def rewrite(path: Path, blocks: Mapping[str, str]) -> None:
    """Put several blocks into a file: all of them, or, if one of them has no place there, none."""
    text = path.read_text(encoding="utf-8")
    for name, content in blocks.items():
        text = replaced(text, name, content)
    temporary = path.with_name(path.name + ".new")
    temporary.write_text(text, encoding="utf-8")
    os.replace(temporary, path)
