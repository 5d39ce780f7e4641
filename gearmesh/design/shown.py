"""How values and keys of design files stand in messages, and which known word a misspelt one is nearest to."""

from __future__ import annotations

import difflib
import json
from collections.abc import Iterable
from typing import Any

from gearmesh.errors import shown_value

#: characters of a number beyond which nobody typed it
TYPED = 14


def value_text(value: Any, limit: int = 60) -> str:
    """A value as it would stand in a file: one line, printable, not long; derived numbers with the digits of other figures."""
    if isinstance(value, float) and len(repr(value)) > TYPED:
        return shown_value(value)
    try:
        text = json.dumps(value, default=str)
    except (TypeError, ValueError, RecursionError):  # an integer of thousands of digits, a table in a table in a ...
        text = f"<{type(value).__name__}>"
    return text if len(text) <= limit else text[: limit - 3] + "..."


def shown_key(parts: Iterable[Any]) -> str:
    """A dotted key, printable even if it is not a sensible one."""
    words = [str(part) for part in parts]
    return ".".join(word if word.isprintable() and len(word) <= 60 else value_text(word) for word in words)


def nearest(word: str, known: Iterable[str]) -> str | None:
    """The known word that a misspelt one most likely stands for."""
    return next(iter(difflib.get_close_matches(word, list(known), n=1, cutoff=0.55)), None)
