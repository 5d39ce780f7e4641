"""Writes the table of all figures of answers into gearmesh/answers/README.md, between its two marks."""

from __future__ import annotations

from pathlib import Path

from tables import cell

from gearmesh.api.reference import COLUMNS, figure_groups

#: the file, and what stands round the table in it
README = Path(__file__).parents[1] / "gearmesh" / "answers" / "README.md"
BEGIN, END = "<!-- figures -->\n", "<!-- /figures -->\n"


def reference() -> str:
    """The figures of every answer under its name, as Markdown."""
    head = f"| {' | '.join(COLUMNS)} |\n|{' --- |' * len(COLUMNS)}\n"
    return "\n".join(f"### {group.of}\n\n{head}{_rows(group.rows)}" for group in figure_groups())


def _rows(rows: list[tuple[str, str, str, str]]) -> str:
    return "".join(
        f"| `{key}` | {cell(unit)} | {cell(symbol)} | {cell(meaning)} |\n" for key, unit, symbol, meaning in rows
    )


def current(text: str) -> str:
    """The text of the file with the table as it is now."""
    before, _, rest = text.partition(BEGIN)
    return f"{before}{BEGIN}\n{reference()}\n{END}{rest.partition(END)[2]}"


if __name__ == "__main__":
    README.write_text(current(README.read_text(encoding="utf-8")), encoding="utf-8")
