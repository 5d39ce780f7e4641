"""Hints for frequent mistakes in TOML files: a correct line to write instead."""

from __future__ import annotations

import re

from gearmesh.numerals import is_number, parse_whole_number, with_point

#: characters of a line that messages show
MAX_LINE_CHARACTERS = 40
#: beginnings of parser messages about a line that is no key with a value
LINE_ERRORS = ("Expected newline", "Invalid value", "Expected '=' after a key")
#: line and column at the end of a parser message
_ERROR_PLACE = r" \(at line (\d+), column (\d+)\)$"
#: key = value, with a comment
_KEY_AND_VALUE = r"""\s*([\w.\-"']+?)\s*=\s*([^#"']*?)\s*(#.*)?"""
#: number with a unit of length
_NUMBER_WITH_UNIT = r"[-+]?[0-9.]+ ?(um|µm|μm|mm|in|inch)"
#: text without quotes
_BARE_WORD = r"[A-Za-z_][\w. -]*"
#: two keys in one line
_TWO_ASSIGNMENTS = r"""\s*[\w.-]+\s*=\s*(?:[\w.+-]+|"[^"]*")\s*[,;]?\s*[\w.-]+\s*="""
#: words for no value, which TOML does not have, and for special numbers
NO_VALUE_WORDS = ("none", "null", "nil", "nan", "inf")


def toml_refusal(text: str, failure: Exception) -> tuple[str, str]:
    """Return reason and remedy for a text that the TOML parser refused: line and correction, if known."""
    told = " ".join(str(failure).split())
    place = re.search(_ERROR_PLACE, told)
    if place is None:
        return told, ""
    number, column = int(place[1]), int(place[2])
    line = text.split("\n")[number - 1].rstrip("\r")
    rest = line[column - 1 :].strip()[:MAX_LINE_CHARACTERS]
    for opening, closing in (("array", "]"), ("inline table", "}")):
        if told.startswith(f"Unclosed {opening}") and rest and not rest.startswith("#"):
            return f"line {number}, column {column}: a comma or {closing} is missing before {rest}", ""
    remedy = _remedy(line) if told.startswith(LINE_ERRORS) else ""
    return (f"line {number}: {line.strip()[:MAX_LINE_CHARACTERS]}", remedy) if remedy else (told, "")


def _remedy(line: str) -> str:
    """Return the correction of a line with a key and a value; empty if unknown."""
    assignment = re.fullmatch(_KEY_AND_VALUE, line)
    if assignment is None:
        if re.match(_TWO_ASSIGNMENTS, line):
            return "write each key in a line of its own"
        colon = re.fullmatch(r"\s*([\w.-]+)\s*:\s*([^#]*?)\s*(#.*)?", line)
        return f"write {colon[1]} = {colon[2]}"[:MAX_LINE_CHARACTERS] if colon else ""
    key, value = assignment[1], assignment[2].rstrip(";,").rstrip()
    if pointed := with_point(value):
        return pointed.replace("write ", f"write {key} = ", 1)
    if value.lower() in ("true", "false"):
        return f"write {key} = {value.lower()}"
    if re.fullmatch(_NUMBER_WITH_UNIT, value) or (
        re.fullmatch(_BARE_WORD, value) and value.lower() not in NO_VALUE_WORDS
    ):
        return f'write {key} = "{value}"'
    if is_number(value) and value == assignment[2]:
        whole = parse_whole_number(value)
        return f"write {key} = {float(value) if whole is None else whole}"
    return f"write {key} = {value}" if value and value != assignment[2] else ""
