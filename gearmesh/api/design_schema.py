"""JSON Schema of the design files of a kind, with which editors complete and check them."""

from __future__ import annotations

import math
from typing import Any, TypeAlias

from gearmesh import __version__
from gearmesh.design.core import Design
from gearmesh.design.keys import Key, Table, key_lines

#: a JSON Schema, or a part of one
JsonSchema: TypeAlias = dict[str, Any]
#: version of JSON Schema
SCHEMA_DIALECT = "https://json-schema.org/draft/2020-12/schema"
#: largest number of characters of a text
MAX_TEXT_LENGTH = 80
#: number of values of a stiffness: of its diagonal, or of its rows
STIFFNESS_SIZE = 6


def design_schema(design: type[Design], kind: str) -> JsonSchema:
    """Return the schema of the files of a kind, draft 2020-12; `$id` has the version of gearmesh.

    The schema has names, types, choices, and limits that do not depend on units. Relations between keys, and limits of lengths,
    which are in the file's units, are checked when the file is loaded.
    """
    tables: JsonSchema = {}
    schema = _table(design, tables)
    schema["properties"]["kind"] = {"const": kind, "description": "gear system"}
    return {
        "$schema": SCHEMA_DIALECT,
        "$id": f"urn:gearmesh:{__version__}:{kind}",
        "title": f"gearmesh design, {kind}",
        "description": design.about,
        **schema,
        "$defs": tables,
    }


def _table(table: type[Table], tables: JsonSchema) -> JsonSchema:
    """Return the schema of a table; nested tables are added to `tables` once each, by the names of their classes."""
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
    """Return the schema of the values of a key, or of a list of values."""
    if key.unit == "stiffness":
        return {"type": "array", "minItems": STIFFNESS_SIZE, "maxItems": STIFFNESS_SIZE}
    one = _one_value(key)
    return {"type": "array", "items": one, "maxItems": key.most} if key.most else one


def _one_value(key: Key) -> JsonSchema:
    match key.unit:
        case "choice":
            return {"enum": list(key.choices)}
        case "text":
            return {"type": "string", "maxLength": MAX_TEXT_LENGTH}
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
