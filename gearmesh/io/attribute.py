"""Text as an attribute of XML."""

from __future__ import annotations

_ESCAPED_CHARACTERS = str.maketrans(
    {"&": "&amp;", "<": "&lt;", ">": "&gt;", "\n": "&#10;", "\r": "&#13;", "\t": "&#9;"}
)


def quote(text: str) -> str:
    """Return the text quoted and escaped, the same as xml.sax.saxutils.quoteattr, which imports modules that read the web."""
    text = text.translate(_ESCAPED_CHARACTERS)
    if '"' not in text:
        return f'"{text}"'
    return f"'{text}'" if "'" not in text else '"{}"'.format(text.replace('"', "&quot;"))
