"""Design files of a kind as a JSON Schema, by which editors complete and check them."""

from __future__ import annotations

import math
from typing import Any, TypeAlias

from gearmesh import __version__
from gearmesh.design.core import Design
from gearmesh.design.keys import Key, Table, key_lines

#: a JSON Schema, or a part of one
JsonSchema: TypeAlias = dict[str, Any]
DIALECT = "https://json-schema.org/draft/2020-12/schema"
#: characters of a text at most, and numbers of a stiffness: its diagonal, or its rows
TEXT, STIFFNESS = 80, 6


def design_schema(design: type[Design], kind: str) -> JsonSchema:
    """The schema of the files of a kind, draft 2020-12; `$id` has the version of gearmesh.

    It knows names, types, choices and the limits that no unit changes. What keys say of each other, and limits of lengths, which
    are in the file's units, are checked when the file is loaded.
    """
    tables: JsonSchema = {}
    schema = _table(design, tables)
    schema["properties"]["kind"] = {"const": kind, "description": "gear system"}
    return {
        "$schema": DIALECT,
        "$id": f"urn:gearmesh:{__version__}:{kind}",
        "title": f"gearmesh design, {kind}",
        "description": design.about,
        **schema,
        "$defs": tables,
    }


def _table(table: type[Table], tables: JsonSchema) -> JsonSchema:
    """A table; those within it go to `tables` once each, by the names of their classes."""
    properties, required = {}, []
    said = {line.key: line for line in key_lines(table)}
    for name in table.names():
        field, below, key = table.model_fields[name], table.table_of(name), table.key_of(name)
        if below is not None:
            if below.__name__ not in tables:
                tables[below.__name__] = {}
                tables[below.__name__] |= _table(below, tables)
            properties[name] = {"$ref": f"#/$defs/{below.__name__}"}
        elif key is not None:
            line = said[name]
            parts = [f"{line.about} [{line.unit}{f', {line.range}' if line.range else ''}]"]
            parts += [] if line.default == "required" else [f"default: {line.default}"]
            value = _value(key)
            if name in table.signed:
                value = {"anyOf": [value, {"type": value["type"], "maximum": -value["minimum"]}]}
            properties[name] = {**value, "description": "; ".join(parts)}
        if field.is_required():
            required.append(name)
    return {"type": "object", "properties": properties, "required": required, "additionalProperties": False}


def _value(key: Key) -> JsonSchema:
    """What a key accepts; also a list of it."""
    if key.unit == "stiffness":
        return {"type": "array", "minItems": STIFFNESS, "maxItems": STIFFNESS}
    one = _one_value(key)
    return {"type": "array", "items": one, "maxItems": key.most} if key.most else one


def _one_value(key: Key) -> JsonSchema:
    match key.unit:
        case "choice":
            return {"enum": list(key.choices)}
        case "text":
            return {"type": "string", "maxLength": TEXT}
        case "file":
            return {"type": "string", "minLength": 1}
        case "flag":
            return {"type": "boolean"}
    number: JsonSchema = {"type": "integer" if key.unit == "count" else "number"}
    # 0 is a limit in every unit of length, others are in mm
    if key.power and key.low >= 0.0:
        number["exclusiveMinimum" if key.above or key.low > 0.0 else "minimum"] = 0.0
    elif math.isfinite(key.low) and not key.power:
        number["exclusiveMinimum" if key.above else "minimum"] = key.low
    if math.isfinite(key.high) and (key.power == 0 or key.high == 0.0):
        number["maximum"] = key.high
    return {"anyOf": [number, {"type": "string"}]} if key.power == 1 else number
