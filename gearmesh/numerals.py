"""Numbers in files and command lines: digits with a sign, a point and an exponent, and nothing else.

Python's float() and int() read more: underscores between digits, the words nan and infinity, digits of other scripts.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable

#: a number
_NUMBER_PATTERN = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")
#: a number with a decimal comma
_DECIMAL_COMMA = re.compile(r"([+-]?[0-9]+),([0-9]+(?:[eE][+-]?[0-9]+)?)")
#: a number followed by letters
_NUMBER_WITH_LETTERS = re.compile(r"[+-]?[0-9][0-9.]*(?:[eE][+-]?[0-9]+)? ?[^\W\d_].*")
#: a whole number of up to 18 digits
_WHOLE_NUMBER_PATTERN = re.compile(r"[+-]?[0-9]{1,18}")
#: characters of numbers and of blanks between them: a text of these that float() reads is a number
_NUMBER_CHARACTERS = re.compile(r"[-+.0-9eE \t\r\n]*")
#: characters that may surround a number
_BLANK_CHARACTERS = " \t\r\n"


def is_number(text: str) -> bool:
    """Return True if a text is a number without blanks around it."""
    return _NUMBER_PATTERN.fullmatch(text) is not None


def parse_number(text: str) -> float | None:
    """Return the finite number in a text, with or without blanks around it; None for any other text."""
    bare = text.strip(_BLANK_CHARACTERS)
    value = float(bare) if is_number(bare) else math.inf
    return value if math.isfinite(value) else None


def parse_whole_number(text: str) -> int | None:
    """Return the whole number of up to 18 digits in a text, with or without blanks around it; None for any other text."""
    bare = text.strip(_BLANK_CHARACTERS)
    return int(bare) if _WHOLE_NUMBER_PATTERN.fullmatch(bare) else None


def parse_numbers(texts: Iterable[str]) -> list[float]:
    """Return the numbers in many texts, in one pass. Raises ValueError if a text is no number."""
    known = list(texts)
    if not _NUMBER_CHARACTERS.fullmatch(" ".join(known)):
        raise ValueError(f"{next(text for text in known if parse_number(text) is None)[:20]!r} is not a number")
    return [float(text) for text in known]


def parse_whole_numbers(texts: Iterable[str]) -> list[int]:
    """Return the whole numbers in many texts. Raises ValueError if a text is no whole number."""
    known = list(texts)
    if not _NUMBER_CHARACTERS.fullmatch(" ".join(known)):
        raise ValueError(
            f"{next(text for text in known if parse_whole_number(text) is None)[:20]!r} is not a whole number"
        )
    return [int(text) for text in known]


def with_letters(text: str) -> bool:
    """Return True if a text is a number followed by letters, as of a unit."""
    return _NUMBER_WITH_LETTERS.fullmatch(text.strip(_BLANK_CHARACTERS)) is not None


def with_point(text: str) -> str:
    """Return the advice for a number with a decimal comma, as "write 2.5"; empty for other texts."""
    parted = _DECIMAL_COMMA.fullmatch(text.strip(_BLANK_CHARACTERS))
    if parted is None:
        return ""
    whole, decimals = parted.groups()
    # three digits after the comma may also be thousands
    return f"write {whole}.{decimals} or {whole}{decimals}" if len(decimals) == 3 else f"write {whole}.{decimals}"
