"""Texts of mesh files: attributes of XML, and tables of numbers, exact and fast."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

_ESCAPED_CHARACTERS = str.maketrans(
    {"&": "&amp;", "<": "&lt;", ">": "&gt;", "\n": "&#10;", "\r": "&#13;", "\t": "&#9;"}
)

#: rows of a table that become one text: more numbers at once are no longer in the processor's memory when they are written
CHUNK_ROWS = 4_000


def quote(text: str) -> str:
    """Return the text quoted and escaped, the same as xml.sax.saxutils.quoteattr, which imports modules that read the web."""
    text = text.translate(_ESCAPED_CHARACTERS)
    if '"' not in text:
        return f'"{text}"'
    return f"'{text}'" if "'" not in text else '"{}"'.format(text.replace('"', "&quot;"))


def lines(template: str, table: NDArray[np.generic], chunk: int = CHUNK_ROWS) -> Iterator[str]:
    """Yield the rows of `table` (N, K) as text, `chunk` rows at a time; `template` is the %-template of one line, K fields.

    With %r a float has the fewest digits that read back exactly.
    """
    for start in range(0, len(table), chunk):
        rows = table[start : start + chunk]
        yield template * len(rows) % tuple(rows.ravel().tolist())
