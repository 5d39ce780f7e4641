"""Validation errors of pydantic as one refusal with key, value and allowed values."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterator
from typing import TYPE_CHECKING, Any

from gearmesh.allowed import with_unit
from gearmesh.design.keys import Key, Table
from gearmesh.design.shown import shown_key, value_text
from gearmesh.errors import MIN_LIKENESS, DesignError, nearest, shown_value
from gearmesh.numerals import with_point

if TYPE_CHECKING:
    from pydantic import ValidationError
    from pydantic_core import ErrorDetails

#: rank of error types: the error that a person should fix first has the lowest
_ERROR_RANKS = {"extra_forbidden": 0, "missing": 1}
#: least likeness of a misspelt key and a key of another table for that to be suggested
MIN_LIKENESS_ELSEWHERE = 0.8
#: least number of letters for which a key that begins with them is suggested
MIN_BEGINNING_LETTERS = 4
#: keys of angles that people also write in radians
MAIN_ANGLES = ("helix_angle", "spiral_angle", "pressure_angle", "transverse_pressure_angle")
#: largest value of such a key that looks like radians
LARGEST_ANGLE_RAD = 1.0


def explain(
    error: ValidationError, design: type[Table], units: str, given: Collection[str] = frozenset()
) -> DesignError:
    """Return the refusal of the error to fix first, with the number of further errors.

    - error: of the validation.
    - design: class of the design.
    - units: unit of lengths in the file, "mm" or "inch".
    - given: keys and tables at the top of the file.
    """
    details = sorted(
        error.errors(include_url=False), key=lambda e: (e["loc"] != ("units",), _ERROR_RANKS.get(e["type"], 2))
    )
    return _refusal(details[0], design, units, len(details) - 1, given)


def _refusal(detail: ErrorDetails, design: type[Table], units: str, more: int, given: Collection[str]) -> DesignError:
    """Return the refusal of one error; `more` is the number of further errors."""
    *tables, last = detail["loc"] or ("design",)
    if detail["type"] == "conflict":
        fields = dict(detail["ctx"])
        other = fields.pop("other")
        refusal = _conflict(detail, design, units, more, fields)
        if other is not None:
            names = ("key", "value", "must_be")
            refusal.other_side = _conflict(detail, design, units, more, dict(zip(names, other, strict=True)))
        return refusal
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


def _conflict(detail: ErrorDetails, design: type[Table], units: str, more: int, fields: dict[str, Any]) -> DesignError:
    """Return the refusal of a key that does not go with other keys; `fields` are those of the conflict."""
    key, value = fields.pop("key"), fields.pop("value")
    # a conflict without a key concerns the whole table
    dotted = ".".join([*map(str, detail["loc"]), *([key] if key else [])])
    declared = design.key_at(dotted) if isinstance(value, float | int) and not isinstance(value, bool) else None
    unit = "" if declared is None else declared.unit_in(units).removeprefix("-")
    shown = shown_value(value, unit) if unit else value_text(value)
    fields |= {name: with_unit(fields[name], unit) for name in ("allowed", "must_be") if name in fields}
    return DesignError(design.name_in_texts(dotted), value, shown=shown, more=more, **fields)


def _table(design: type[Table], path: list[Any]) -> type[Table]:
    """Return the class of the table at a path of names."""
    for name in path:
        below = design.table_of(name)
        assert below is not None, "the location of an error follows the tables"
        design = below
    return design


def _allowed_values(table: type[Table], name: str, units: str) -> str:
    """Return the allowed values of a key, or the keys of a table, in words."""
    below = table.table_of(name)
    if below is not None:
        required = [name for name in below.names() if below.model_fields[name].is_required()]
        # a table with optional keys: only its required keys are missing
        some = "at least " + ", ".join(required) if 0 < len(required) < len(below.names()) else ""
        return f"a table with {some or 'the keys ' + ', '.join(below.names())}"
    key = table.key_of(name)
    assert key is not None, "every field that is not a table has a Key"
    return key.allowed_values(units)


def _with_unit(table: type[Table], name: str, value: Any) -> str:
    """Return an example of a length with its unit, if the value is a text; else an empty text."""
    key = table.key_of(name)
    return key.with_unit if isinstance(value, str) and key is not None else ""


def _suggestion(name: str, path: list[Any], table: type[Table], design: type[Table], given: Collection[str]) -> str:
    """Return the known key that an unknown key most likely means, or the keys of the table, in words."""
    keys = list(_dotted_keys(design))
    # the last of equal names wins below: keys of tables in the file come last, then required keys
    keys.sort(key=lambda dotted: (dotted.partition(".")[0] in given, _is_required(design, dotted)))
    everywhere = {dotted.rsplit(".", 1)[-1]: dotted for dotted in keys}
    # the same name in another table of the first level
    if everywhere.get(name, "..").count(".") <= 1:
        return f"did you mean {everywhere[name]}?"
    begins = (key for key in table.model_fields if len(name) >= MIN_BEGINNING_LETTERS and key.startswith(name))
    here = nearest(name, table.model_fields) or next(begins, None)
    if here is not None:
        return f"did you mean {'.'.join([*path, here])}?"
    # keys near the top of the file first; a key in a table needs a greater likeness to a key of another table, and tables of a
    # member have little to do with each other
    likeness = MIN_LIKENESS_ELSEWHERE if path else MIN_LIKENESS
    depths = [1] if len(path) > 1 else [1, max(dotted.count(".") for dotted in everywhere.values())]
    for deepest in depths:
        some = [leaf for leaf, dotted in everywhere.items() if dotted.count(".") <= deepest]
        elsewhere = nearest(name, some, likeness)
        if elsewhere is not None:
            return f"did you mean {everywhere[elsewhere]}?"
    return "known here: " + ", ".join(table.names())


def _is_required(design: type[Table], dotted: str) -> bool:
    """True if a dotted key must be given."""
    *tables, name = dotted.split(".")
    table: type[Table] | None = design
    for below in tables:
        table = None if table is None else table.table_of(below)
    return table is not None and table.model_fields[name].is_required()


def _dotted_keys(table: type[Table], prefix: str = "") -> Iterator[str]:
    """Yield all dotted keys of a table and of the tables in it.

    In a dict by leaf name the last key wins: the order is backwards, so that the pinion wins over the gear.
    """
    for name in reversed(table.model_fields):
        below = table.table_of(name)
        yield prefix + name
        if below is not None:
            yield from _dotted_keys(below, f"{prefix}{name}.")


def _likely_meaning(key: Key, name: str, value: Any, *, hand: bool) -> str:
    """Return a hint for a refused angle: radians, or the sign of the other hand; empty if neither is likely."""
    if key.unit != "angle" or name not in MAIN_ANGLES or isinstance(value, bool) or not isinstance(value, int | float):
        return ""
    if value < 0.0 and key.low == 0.0 and hand and -value <= key.high:
        return '; the key hand, "right" or "left", says the hand of the pinion'
    degrees = math.degrees(abs(value))
    if 0.0 < abs(value) <= LARGEST_ANGLE_RAD and key.low <= degrees <= key.high:
        return f"; {value:g} rad is {math.degrees(value):.4g} deg"
    return ""
