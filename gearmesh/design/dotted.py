"""Keys of nested tables by their dotted names."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any


def with_keys(tables: Mapping[str, Any], values: Iterable[tuple[str, Any]]) -> dict[str, Any]:
    """Return a copy of nested tables with the values of dotted keys put in."""
    nested: dict[str, Any] = {
        key: with_keys(value, ()) if isinstance(value, Mapping) else value for key, value in tables.items()
    }
    for dotted, value in values:
        *names, last = dotted.split(".")
        table = nested
        for name in names:
            table = table.setdefault(name, {})
        table[last] = value
    return nested
