"""Commented design file of a kind: required keys with example values, all other keys with their defaults."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Iterator, Mapping
from typing import Any

from gearmesh import __version__
from gearmesh.design.core import Design
from gearmesh.design.keys import Key, KeyLine, Table

#: characters in a line of a comment
COMMENT_WIDTH = 100


def template(kind: type[Design], *, short: bool = False) -> str:
    """Return the text of a file of a kind: required keys as in `kind.example`, all others commented out.

    A short file has the usual keys alone.
    """
    lines = {line.key: line for line in kind.key_lines()}
    text = [f"# {kind.about}"]
    if short:
        usual = {"gearmesh", *kind.usual_keys()}
        text.append("# The keys that most designs set; a key that begins with # is at its default.")
        text.append(f"# {len(lines.keys() - usual)} more keys: gearmesh new {kind.own_kind} --all writes them.")
        lines = {key: line for key, line in lines.items() if key in usual}
    else:
        text.append("# A key that begins with # is at its default; gearmesh describe lists them too.")
    text += ["", *_table(kind, {"kind": kind.own_kind, "gearmesh": __version__, **kind.example}, lines, "")]
    return "\n".join(text) + "\n"


def _table(table: type[Table], example: Mapping[str, Any], lines: Mapping[str, KeyLine], prefix: str) -> Iterator[str]:
    """Yield those keys of a table that have lines, then the tables in it; of tables listed apart only the first has keys."""
    apart: dict[str, str] = {}
    for name in table.names():
        key, below = table.key_of(name), table.table_of(name)
        if key is not None and prefix + name in lines:
            yield from _key(name, key, lines[prefix + name], example)
        elif below is not None:
            given = example.get(name)
            inside = list(_table(below, given or {}, lines, f"{prefix}{name}."))
            if not inside:
                continue
            optional = table.model_fields[name].default is None and given is None
            first = apart.setdefault(below.listed_apart, name) if below.listed_apart else name
            if name != first and not given:
                yield from ("", f"# [{prefix}{name}]", f"# keys as in [{prefix}{first}]")
                continue
            yield from ("", f"{'# ' if optional else ''}[{prefix}{name}]", *inside)


def _key(name: str, key: Key, line: KeyLine, example: Mapping[str, Any]) -> Iterator[str]:
    """Yield the comment and the line of one key."""
    about = f"{line.about} ({', '.join(part for part in (line.unit, line.range, line.source) if part)})"
    yield from (f"# {part}" for part in textwrap.wrap(about, COMMENT_WIDTH))
    if name in example:
        yield f"{name} = {json.dumps(example[name])}"
    else:
        yield f"# {name} = {_default(key, line)}"


def _default(key: Key, line: KeyLine) -> str:
    """Return the default as a file has it, or in words."""
    if key.unit in ("choice", "text") and line.default in key.choices:
        return json.dumps(line.default)
    return line.default
