"""What to write instead of a line that TOML does not allow, for mistakes that people make often."""

from __future__ import annotations

import re

from gearmesh.numerals import is_number, parse_whole_number, with_point

#: characters of a line that messages show
SHOWN = 40
#: beginnings of what the parser says of a line that is no key with a value
MISWRITTEN = ("Expected newline", "Invalid value", "Expected '=' after a key")
_PLACE = re.compile(r" \(at line (\d+), column (\d+)\)$")
_ASSIGNMENT = re.compile(r"""\s*([\w.\-"']+?)\s*=\s*([^#"']*?)\s*(#.*)?""")
_QUANTITY = re.compile(r"[-+]?[0-9.]+ ?(um|µm|μm|mm|in|inch)")
_WORD = re.compile(r"[A-Za-z_][\w. -]*")
_TWO = re.compile(r"""\s*[\w.-]+\s*=\s*(?:[\w.+-]+|"[^"]*")\s*[,;]?\s*[\w.-]+\s*=""")
#: words that stand for no value, which TOML has not, and for numbers
NOTHING = ("none", "null", "nil", "nan", "inf")


def toml_refusal(text: str, failure: Exception) -> tuple[str, str]:
    """Reason and remedy of a text that the TOML parser refused: with the line and what to write, where that is known."""
    told = " ".join(str(failure).split())
    place = _PLACE.search(told)
    if place is None:
        return told, ""
    number, column = int(place[1]), int(place[2])
    line = text.split("\n")[number - 1].rstrip("\r")
    rest = line[column - 1 :].strip()[:SHOWN]
    for opening, closing in (("array", "]"), ("inline table", "}")):
        if told.startswith(f"Unclosed {opening}") and rest and not rest.startswith("#"):
            return f"line {number}, column {column}: a comma or {closing} is missing before {rest}", ""
    remedy = _remedy(line) if told.startswith(MISWRITTEN) else ""
    return (f"line {number}: {line.strip()[:SHOWN]}", remedy) if remedy else (told, "")


def _remedy(line: str) -> str:
    """What to write instead of a line with a key and a value; empty where that is not known."""
    assignment = _ASSIGNMENT.fullmatch(line)
    if assignment is None:
        if _TWO.match(line):
            return "write each key in a line of its own"
        colon = re.fullmatch(r"\s*([\w.-]+)\s*:\s*([^#]*?)\s*(#.*)?", line)
        return f"write {colon[1]} = {colon[2]}"[:SHOWN] if colon else ""
    key, value = assignment[1], assignment[2].rstrip(";,").rstrip()
    if pointed := with_point(value):
        return pointed.replace("write ", f"write {key} = ", 1)
    if value.lower() in ("true", "false"):
        return f"write {key} = {value.lower()}"
    if _QUANTITY.fullmatch(value) or (_WORD.fullmatch(value) and value.lower() not in NOTHING):
        return f'write {key} = "{value}"'
    if is_number(value) and value == assignment[2]:
        whole = parse_whole_number(value)
        return f"write {key} = {float(value) if whole is None else whole}"
    return f"write {key} = {value}" if value and value != assignment[2] else ""
