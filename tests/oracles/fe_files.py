"""Strict readers of Nastran and LS-DYNA files in fixed fields, written from the formats' manuals: anything else is an error."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

#: edges of the mid-side nodes 9 .. 20 of a hexahedron, from 0: bottom, uprights, top (Nastran)
NASTRAN_EDGES = (
    *((0, 1), (1, 2), (2, 3), (3, 0)),
    *((0, 4), (1, 5), (2, 6), (3, 7)),
    *((4, 5), (5, 6), (6, 7), (7, 4)),
)
#: the same: bottom, top, uprights (Ansys SOLID186, LS-DYNA H20, Abaqus C3D20)
USUAL_EDGES = (*((0, 1), (1, 2), (2, 3), (3, 0)), *((4, 5), (5, 6), (6, 7), (7, 4)), *((0, 4), (1, 5), (2, 6), (3, 7)))

Card = tuple[str, list[str]]


def nastran_cards(path: Path) -> list[Card]:
    """Cards of the bulk data: name without its *, and fields from the second on, "" where blank."""
    text = path.read_text(encoding="ascii")
    head, bulk = text.split("BEGIN BULK\n")
    assert bulk.endswith("ENDDATA\n")
    assert all(len(line) <= (80 if line.startswith("$") else 72) for line in head.splitlines())
    cards: list[Card] = []
    for line in bulk.splitlines()[:-1]:
        if line.startswith("$"):
            continue
        if "," in line:
            name, *fields = line.split(",")
            cards.append((name, fields))
            continue
        assert line[72:] in ("", "+")
        first, wide = line[:8].strip(), "*" in line[:8]
        width, count = (16, 4) if wide else (8, 8)
        padded = line[8:72].ljust(width * count)
        fields = [padded[width * k : width * (k + 1)].strip() for k in range(count)]
        if first in ("+", "*", ""):
            cards[-1][1].extend(fields)
        else:
            cards.append((first.rstrip("*"), fields))
    return cards


def nastran_number(text: str) -> float:
    """Value of a number whose exponent may stand without E."""
    for k in range(1, len(text)):
        if text[k] in "+-" and text[k - 1] not in "E":
            return float(f"{text[:k]}E{text[k:]}")
    return float(text)


def whole_numbers(fields: list[str]) -> list[int]:
    return [int(each) for each in fields if each]


def nastran_sets(path: Path) -> dict[str, list[int]]:
    """Sets of the case control by the comments before them: "nodes NAME" and "elements NAME"."""
    head = path.read_text(encoding="ascii").split("BEGIN BULK\n")[0].splitlines()
    found: dict[str, list[int]] = {}
    for before, line in pairwise(head):
        if line.startswith("SET "):
            text = ""
            for part in [line.split("=")[1], *head[head.index(line) + 1 :]]:
                text += part
                if not part.endswith(","):
                    break
            found[before.removeprefix("$ ")] = whole_numbers(text.split(","))
    return found


def dyna_keywords(path: Path) -> Iterator[tuple[str, list[str]]]:
    """Keywords with their lines, in order."""
    lines = path.read_text(encoding="ascii").splitlines()
    assert lines[0] == "*KEYWORD"
    assert lines[-1] == "*END"
    keyword, data = "", list[str]()
    for line in lines[1:]:
        assert len(line) <= (160 if keyword.endswith("+") else 80)
        if line.startswith("$"):
            continue
        if line.startswith("*"):
            if keyword:
                yield keyword, data
            keyword, data = line, []
        else:
            data.append(line)


def fixed(line: str, width: int) -> list[str]:
    """Fields of a line, of `width` characters each."""
    return [line[k : k + width].strip() for k in range(0, len(line), width)]
