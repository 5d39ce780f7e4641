"""Numbers as files and command lines write them: digits with a sign, a point and an exponent, and nothing else.

Python's own float() and int() read more: underscores between digits, the words nan and infinity, digits of other scripts.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable

_NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")
_COMMA = re.compile(r"([+-]?[0-9]+),([0-9]+(?:[eE][+-]?[0-9]+)?)")
_WITH_LETTERS = re.compile(r"[+-]?[0-9][0-9.]*(?:[eE][+-]?[0-9]+)? ?[^\W\d_].*")
_WHOLE_NUMBER = re.compile(r"[+-]?[0-9]{1,18}")
#: characters that numbers and the blanks between them are made of: what float() reads of these is a number
_CHARACTERS = re.compile(r"[-+.0-9eE \t\r\n]*")
_BLANKS = " \t\r\n"


def is_number(text: str) -> bool:
    """True where a text is a number, without blanks around it."""
    return _NUMBER.fullmatch(text) is not None


def parse_number(text: str) -> float | None:
    """The finite number in a text, with blanks around it or not; None where there is none."""
    bare = text.strip(_BLANKS)
    value = float(bare) if is_number(bare) else math.inf
    return value if math.isfinite(value) else None


def parse_whole_number(text: str) -> int | None:
    """The whole number of up to 18 digits in a text, with blanks around it or not; None where there is none."""
    bare = text.strip(_BLANKS)
    return int(bare) if _WHOLE_NUMBER.fullmatch(bare) else None


def parse_numbers(texts: Iterable[str]) -> list[float]:
    """The numbers in many texts, in one pass. Raises ValueError where one of them is none."""
    known = list(texts)
    if not _CHARACTERS.fullmatch(" ".join(known)):
        raise ValueError(f"{next(text for text in known if parse_number(text) is None)[:20]!r} is not a number")
    return [float(text) for text in known]


def parse_whole_numbers(texts: Iterable[str]) -> list[int]:
    """The whole numbers in many texts. Raises ValueError where one of them is none."""
    known = list(texts)
    if not _CHARACTERS.fullmatch(" ".join(known)):
        raise ValueError(
            f"{next(text for text in known if parse_whole_number(text) is None)[:20]!r} is not a whole number"
        )
    return [int(text) for text in known]


def with_letters(text: str) -> bool:
    """True where a text is a number with the letters of a unit behind it."""
    return _WITH_LETTERS.fullmatch(text.strip(_BLANKS)) is not None


def with_point(text: str) -> str:
    """What to write instead of a number with a decimal comma, as "write 2.5"; empty for other texts."""
    parted = _COMMA.fullmatch(text.strip(_BLANKS))
    if parted is None:
        return ""
    whole, decimals = parted.groups()
    # three digits behind the comma may be thousands
    return f"write {whole}.{decimals} or {whole}{decimals}" if len(decimals) == 3 else f"write {whole}.{decimals}"
