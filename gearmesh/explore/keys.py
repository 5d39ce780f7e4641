"""Keys of a kind as a page shows them, from the same declarations as `gearmesh describe`."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import cache
from typing import Any

from gearmesh.design.core import Design
from gearmesh.design.dotted import leaves
from gearmesh.design.keys import MM_PER, Key
from gearmesh.explore.state import is_file
from gearmesh.figures import ZERO_SIZES, at_resolution
from gearmesh.systems.system import System


@cache
def key_rows(design: type[Design], units: str) -> tuple[dict[str, Any], ...]:
    """Return all keys of a class of designs that a page can set, in the order of a file, for a unit of lengths."""
    usual = set(design.usual_keys())
    rows = []
    for line in design.key_lines():
        key = design.key_at(line.key)
        if key is None or key.unit == "file" or line.key in ("kind", "gearmesh"):
            continue
        scale = MM_PER[units] ** key.power
        low, high = (bound / scale if math.isfinite(bound) else None for bound in (key.low, key.high))
        rows.append({
            "key": line.key,
            "unit": key.unit_in(units),
            "about": line.about,
            "source": line.source,
            "default": line.default,
            "allowed": key.allowed_values(units),
            "input": "number" if key.is_numeric else key.unit if key.unit in ("choice", "flag") else "text",
            "list": bool(key.most) or key.unit == "stiffness",
            "whole": key.unit == "count",
            "length": key.power == 1,
            "choices": list(key.choices),
            "low": low,
            "high": high,
            "usual": line.key in usual,
        })  # fmt: skip
    return tuple(rows)


def error_keys(system: System[Any], design: type[Design]) -> list[str]:
    """Return the errors of assembly of a kind that move the members and do not change their teeth."""
    known = () if system.displacements is None else system.displacements.keys
    return [dotted for key in known if design.key_at(dotted := f"assembly.{key}") is not None]


def plain_values(design: Design) -> Iterator[tuple[str, Any]]:
    """Yield all keys of a design that have a value, set or not, without names of files; rounding is shown as 0."""
    for dotted, value in leaves(design.plain()):
        if not is_file(type(design), dotted):
            key = type(design).key_at(dotted)
            yield dotted, at_resolution(value, 0.0 if key is None else _resolution(key, design.mm_per_unit))


def _resolution(key: Key, mm_per_unit: float) -> float:
    """Return the size below which a value of a key is rounding, in the design's units; 0 where this is not known."""
    if key.power == 1:
        return ZERO_SIZES["mm"] / mm_per_unit
    return ZERO_SIZES["deg"] if key.unit == "angle" else 0.0
