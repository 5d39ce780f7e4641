"""Text as an attribute of XML."""

from __future__ import annotations

_ESCAPED = str.maketrans({"&": "&amp;", "<": "&lt;", ">": "&gt;", "\n": "&#10;", "\r": "&#13;", "\t": "&#9;"})


def quote(text: str) -> str:
    """As xml.sax.saxutils.quoteattr, which loads all that reads the web, for every file."""
    text = text.translate(_ESCAPED)
    if '"' not in text:
        return f'"{text}"'
    return f"'{text}'" if "'" not in text else '"{}"'.format(text.replace('"', "&quot;"))
