"""Texts of values and keys of design files, for messages and notebooks."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from typing import Any

from gearmesh.errors import shown_value

#: characters of the longest number that a person types
MAX_TYPED_DIGITS = 14


def value_text(value: Any, limit: int = 60) -> str:
    """Return a value as a file has it, in one printable line of at most `limit` characters; computed numbers are rounded."""
    if isinstance(value, float) and len(repr(value)) > MAX_TYPED_DIGITS:
        return shown_value(value)
    try:
        text = json.dumps(value, default=str)
    except (TypeError, ValueError, RecursionError):  # an integer of thousands of digits, a table in a table in a ...
        text = f"<{type(value).__name__}>"
    return text if len(text) <= limit else text[: limit - 3] + "..."


def shown_key(parts: Iterable[Any]) -> str:
    """Return the names of a path as a dotted key, printable in any case."""
    words = [str(part) for part in parts]
    return ".".join(word if word.isprintable() and len(word) <= 60 else value_text(word) for word in words)


def html_table(title: str, columns: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return a table of texts as HTML, for notebooks."""
    import html

    caption = f"<caption>{html.escape(title)}</caption>" if title else ""
    head = "".join(f"<th>{html.escape(column)}</th>" for column in columns)
    head = f"<thead><tr>{head}</tr></thead>" if any(columns) else ""
    body = "".join("<tr>" + "".join(f"<td>{html.escape(text)}</td>" for text in row) + "</tr>" for row in rows)
    return f"<table>{caption}{head}<tbody>{body}</tbody></table>"
