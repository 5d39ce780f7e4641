"""Design files with other values: the text of a file with some keys set anew, its comments and its order kept."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping
from typing import Any

from gearmesh.design.dotted import leaves, nested, tables_of
from gearmesh.design.files import toml
from gearmesh.records import dataclass

#: head of a table
_TABLE_PATTERN = re.compile(r"\s*\[\s*([A-Za-z0-9_.\s-]+?)\s*\]\s*(#.*)?$")
#: first line of a key with its value
_KEY_PATTERN = re.compile(r"(\s*)([A-Za-z0-9_.\s-]+?)\s*=\s*(.*)$")


@dataclass
class _Part:
    """Lines of a file that belong together."""

    #: table in which the lines stand, dotted
    table: str
    #: dotted key that the lines set; empty for comments, empty lines and heads of tables
    key: str
    lines: list[str]


def rewritten(text: str, keys: Mapping[str, Any]) -> str:
    """Return the text of a design file with exactly these dotted keys; comments and order of the file stay.

    A file in a form that cannot be kept is written anew, with the comments of its head.
    """
    wanted = nested(keys)
    try:
        made = _edited(text, keys)
        if tomllib.loads(made) == wanted:
            return made
    except (ValueError, RecursionError):
        pass
    head = list(_head(text))
    return "\n".join([*head, toml(wanted)])


def _head(text: str) -> Iterator[str]:
    for line in text.splitlines():
        if line.strip() and not line.lstrip().startswith("#"):
            return
        yield line


def _edited(text: str, keys: Mapping[str, Any]) -> str:
    parts = list(_parts(text))
    before = dict(leaves(tomllib.loads(text)))
    left = dict(keys)
    kept: list[_Part] = []
    for part in parts:
        inside = {key for key in before if _is_within(key, part.key)} if part.key else set()
        if not inside:
            kept.append(part)
            continue
        now = {key: left.pop(key) for key in list(left) if _is_within(key, part.key)}
        if now == {key: before[key] for key in inside}:
            kept.append(part)
        elif now:
            kept.append(_Part(part.table, part.key, _with_value(part, now)))
    heads = {part.table for part in kept if not part.key and _TABLE_PATTERN.match(part.lines[0])}
    for key, value in left.items():
        if value != {} or key not in heads:
            _add(kept, key, value)
    # heads of tables that have no key any more
    names = {name for key in keys for name in (key, *tables_of(key))}
    kept = [part for part in kept if part.key or part.table in names or not _TABLE_PATTERN.match(part.lines[0])]
    return "\n".join(line for part in kept for line in part.lines) + "\n"


def _is_within(key: str, whole: str) -> bool:
    """True for a dotted key that is another one, or stands in the table of its name."""
    return key == whole or key.startswith(f"{whole}.")


def _parts(text: str) -> Iterator[_Part]:
    """Yield the parts of a file; values over several lines are one part."""
    lines, table, k = text.splitlines(), "", 0
    while k < len(lines):
        line = lines[k]
        if head := _TABLE_PATTERN.match(line):
            table = re.sub(r"\s", "", head[1])
            yield _Part(table, "", [line])
        elif (found := _KEY_PATTERN.match(line)) and not line.lstrip().startswith("#"):
            last = k
            while not _is_whole("\n".join(lines[k : last + 1])):
                last += 1
                if last == len(lines):
                    raise ValueError(line)
            name = re.sub(r"\s", "", found[2])
            yield _Part(table, f"{table}.{name}" if table else name, lines[k : last + 1])
            k = last
        else:
            yield _Part(table, "", [line])
        k += 1


def _is_whole(statement: str) -> bool:
    try:
        tomllib.loads(statement)
    except ValueError:
        return False
    return True


def _with_value(part: _Part, values: Mapping[str, Any]) -> list[str]:
    """Return the lines of a part with other values; the comment behind the value stays."""
    found = _KEY_PATTERN.match(part.lines[0])
    assert found is not None
    comment = _comment(part.lines[-1])
    value = values.get(part.key)
    if value is None:
        inner = nested({key.removeprefix(f"{part.key}."): value for key, value in values.items()})
        shown = _inline(inner)
    else:
        shown = _inline(value)
    return [f"{found[1]}{found[2]} = {shown}{f'  {comment}' if comment else ''}"]


def _comment(line: str) -> str:
    """Return the comment at the end of a line, "" without one."""
    quote = ""
    for k, character in enumerate(line):
        if quote:
            quote = "" if character == quote else quote
        elif character in "\"'":
            quote = character
        elif character == "#":
            return line[k:]
    return ""


def _inline(value: Any) -> str:
    """Return a value as TOML in one line."""
    if value == {}:
        return "{}"
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{key} = {_inline(inner)}" for key, inner in value.items()) + " }"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_inline, value)) + "]"
    return toml({"x": value}).partition(" = ")[2].rstrip("\n")


def _add(parts: list[_Part], key: str, value: Any) -> None:
    """Add a key behind the last key of its table, or with a table at the end."""
    table, _, name = key.rpartition(".")
    made = _Part(table, key, [f"{name} = {_inline(value)}"])
    inside = [k for k, part in enumerate(parts) if part.table == table and (part.key or (table and part.lines))]
    if inside:
        # comments and empty lines after the last key belong to the next table
        last = max((k for k in inside if parts[k].key), default=inside[0])
        parts.insert(last + 1, made)
        return
    # a table that is written in one line
    for part in parts:
        if part.key and _is_within(table, part.key):
            inner = dict(leaves(tomllib.loads("\n".join(part.lines))))
            prefix = f"{part.table}." if part.table else ""
            part.lines = _with_value(part, {**{f"{prefix}{name}": each for name, each in inner.items()}, key: value})
            return
    if not table:
        first = next((k for k, part in enumerate(parts) if part.table), len(parts))
        parts.insert(first, made)
        return
    parts += [_Part(table, "", ["", f"[{table}]"]), made]
