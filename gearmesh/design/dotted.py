"""Keys of nested tables by their dotted names."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
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


def nested(keys: Mapping[str, Any]) -> dict[str, Any]:
    """Return the tables of dotted keys; a table without a key has the value {}."""
    return with_keys({}, sorted(keys.items(), key=lambda each: each[1] != {}))


def tables_of(dotted: str) -> list[str]:
    """Return the dotted names of the tables in which a key stands, the outermost first."""
    names = dotted.split(".")[:-1]
    return [".".join(names[: k + 1]) for k in range(len(names))]


def leaves(tables: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the dotted keys of nested tables with their values; a table without a key has the value {}."""
    for name, value in tables.items():
        if isinstance(value, Mapping) and value:
            yield from leaves(value, f"{prefix}{name}.")
        else:
            yield prefix + name, value


def values_of(tables: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """Yield the dotted keys of nested tables with their values; tables without a key are left out."""
    return ((key, value) for key, value in leaves(tables) if not isinstance(value, Mapping))


def empty_tables(tables: Mapping[str, Any]) -> dict[str, Any]:
    """Return the tables without a key among nested tables, and those that they stand in."""
    return with_keys({}, ((key, {}) for key, value in leaves(tables) if value == {}))
