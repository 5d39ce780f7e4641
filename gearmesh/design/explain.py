"""Validation errors as one refusal: which key, which value, what is allowed."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator
from typing import TYPE_CHECKING, Any

from gearmesh.design.keys import Key, Table
from gearmesh.design.shown import shown_key, value_text
from gearmesh.errors import LIKE, DesignError, nearest, shown_value
from gearmesh.numerals import with_point

if TYPE_CHECKING:
    from pydantic import ValidationError
    from pydantic_core import ErrorDetails

#: The error a person should mend first comes first.
_ORDER = {"extra_forbidden": 0, "missing": 1}
#: likeness of a misspelt key in one table and a key of another that is meant; letters with which a key may begin to stand for it
MUCH_ALIKE, LEAST_BEGINNING = 0.8, 4
#: angles that are degrees in every design, and the largest value (rad) that is taken for radians
MAIN_ANGLES = ("helix_angle", "spiral_angle", "pressure_angle", "transverse_pressure_angle")
LARGEST_RADIANS = 1.0


def explain(
    error: ValidationError, design: type[Table], units: str, given: Collection[str] = frozenset()
) -> DesignError:
    """The refusal of the first thing to mend, and how many more there are; `given`: keys and tables at the top of the file."""
    details = sorted(error.errors(include_url=False), key=lambda e: (e["loc"] != ("units",), _ORDER.get(e["type"], 2)))
    return _refusal(details[0], design, units, len(details) - 1, given)


def _refusal(detail: ErrorDetails, design: type[Table], units: str, more: int, given: Collection[str]) -> DesignError:
    *tables, last = detail["loc"] or ("design",)
    if detail["type"] == "conflict":
        key, value, fields = (ctx := dict(detail["ctx"])).pop("key"), ctx.pop("value"), ctx
        # without a key of its own it is about the table
        dotted = ".".join([*map(str, detail["loc"]), *([key] if key else [])])
        declared = design.key_at(dotted) if isinstance(value, float | int) and not isinstance(value, bool) else None
        unit = "" if declared is None else declared.unit_in(units).removeprefix("-")
        shown = shown_value(value, unit) if unit else value_text(value)
        return DesignError(design.name_in_texts(dotted), value, shown=shown, more=more, **fields)
    table = _table(design, tables)
    key = design.name_in_texts(shown_key(detail["loc"]))
    if detail["type"] == "extra_forbidden":
        hint = _suggestion(str(last), tables, table, design, given)
        return DesignError(key, reason=f"unknown key; {hint}", more=more)
    allowed = _allowed_values(table, str(last), units)
    if detail["type"] == "missing":
        return DesignError(key, reason="missing", must_be=allowed, more=more)
    own, value = table.key_of(str(last)), detail["input"]
    least = own.least(units) if own is not None and detail["type"] == "too_small" else ""
    hand = any("hand" in where.model_fields for where in (table, design))
    meant = "" if own is None else _likely_meaning(own, str(last), value, hand=hand)
    must_be = f"{allowed}{least}{_with_unit(table, str(last), value)}{meant}"
    remedy = with_point(value) if isinstance(value, str) and own is not None and own.is_numeric else ""
    return DesignError(key, value, shown=value_text(value), must_be=must_be, remedy=remedy, more=more)


def _table(design: type[Table], path: list[Any]) -> type[Table]:
    for name in path:
        below = design.table_of(name)
        assert below is not None, "the location of an error follows the tables"
        design = below
    return design


def _allowed_values(table: type[Table], name: str, units: str) -> str:
    below = table.table_of(name)
    if below is not None:
        required = [name for name in below.names() if below.model_fields[name].is_required()]
        # of many keys those that cannot be left out are what is missing
        some = "at least " + ", ".join(required) if 0 < len(required) < len(below.names()) else ""
        return f"a table with {some or 'the keys ' + ', '.join(below.names())}"
    key = table.key_of(name)
    assert key is not None, "every field that is not a table has a Key"
    return key.allowed_values(units)


def _with_unit(table: type[Table], name: str, value: Any) -> str:
    """For whoever wrote a text: how a length with its unit looks."""
    key = table.key_of(name)
    return key.with_unit if isinstance(value, str) and key is not None else ""


def _suggestion(name: str, path: list[Any], table: type[Table], design: type[Table], given: Collection[str]) -> str:
    keys = list(_dotted_keys(design))
    # a table that the file has is meant rather than another, then what must be given rather than what may be
    keys.sort(key=lambda dotted: (dotted.partition(".")[0] in given, _is_required(design, dotted)))
    everywhere = {dotted.rsplit(".", 1)[-1]: dotted for dotted in keys}
    # the name of a key of another table, but of none within one
    if everywhere.get(name, "..").count(".") <= 1:
        return f"did you mean {everywhere[name]}?"
    begins = (key for key in table.model_fields if len(name) >= LEAST_BEGINNING and key.startswith(name))
    here = nearest(name, table.model_fields) or next(begins, None)
    if here is not None:
        return f"did you mean {'.'.join([*path, here])}?"
    # what is near the top of the file first; whoever names a table means one of its keys, unless that of another is much alike
    likeness = MUCH_ALIKE if path else LIKE
    for deepest in (1, max(dotted.count(".") for dotted in everywhere.values())):
        some = [leaf for leaf, dotted in everywhere.items() if dotted.count(".") <= deepest]
        elsewhere = nearest(name, some, likeness)
        if elsewhere is not None:
            return f"did you mean {everywhere[elsewhere]}?"
    return "known here: " + ", ".join(table.names())


def _is_required(design: type[Table], dotted: str) -> bool:
    *tables, name = dotted.split(".")
    table: type[Table] | None = design
    for below in tables:
        table = None if table is None else table.table_of(below)
    return table is not None and table.model_fields[name].is_required()


def _dotted_keys(table: type[Table], prefix: str = "") -> Iterator[str]:
    # the last one wins in a dict by leaf name: yield backwards so that the pinion comes before the gear
    for name in reversed(table.model_fields):
        below = table.table_of(name)
        yield prefix + name
        if below is not None:
            yield from _dotted_keys(below, f"{prefix}{name}.")


def _likely_meaning(key: Key, name: str, value: Any, *, hand: bool) -> str:
    """Hint for an angle that its key refuses, radians or the sign of the other hand; empty where nothing else is
    likely."""
    if key.unit != "angle" or name not in MAIN_ANGLES or isinstance(value, bool) or not isinstance(value, int | float):
        return ""
    if value < 0.0 and key.low == 0.0 and hand and -value <= key.high:
        return '; the key hand, "right" or "left", says the hand of the pinion'
    degrees = math.degrees(abs(value))
    if 0.0 < abs(value) <= LARGEST_RADIANS and key.low <= degrees <= key.high:
        return f"; {value:g} rad is {math.degrees(value):.4g} deg"
    return ""
