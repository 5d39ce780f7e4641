"""JSON Schemas of design files: every sample is one, wrong names, types and limits are none."""

from __future__ import annotations

import json
import tomllib
from typing import Any

import pytest
from oracles.command_line import refused, run
from oracles.places import SAMPLES

import gearmesh as gm

TYPES = {"object": dict, "array": list, "string": str, "boolean": bool, "number": (int, float), "integer": (int, float)}


def faults(value: Any, schema: dict[str, Any], defs: dict[str, Any], place: str = "") -> list[str]:
    """Return the places where a value breaks a schema, of the words that design files need."""
    if "$ref" in schema:
        schema = defs[schema["$ref"].removeprefix("#/$defs/")]
    if "anyOf" in schema:
        return [] if any(not faults(value, one, defs, place) for one in schema["anyOf"]) else [place]
    if ("const" in schema and value != schema["const"]) or ("enum" in schema and value not in schema["enum"]):
        return [place]
    kind = schema.get("type")
    if kind is not None and (not isinstance(value, TYPES[kind]) or (isinstance(value, bool) and kind != "boolean")):
        return [place]
    if kind == "integer" and value != int(value):
        return [place]
    if kind in ("number", "integer") and not (
        schema.get("minimum", -1e300) <= value <= schema.get("maximum", 1e300)
        and value > schema.get("exclusiveMinimum", -1e300)
    ):
        return [place]
    if kind == "array":
        size = schema.get("minItems", 0) <= len(value) <= schema.get("maxItems", len(value))
        within = [at for item in value for at in faults(item, schema.get("items", {}), defs, place)]
        return within if size else [place]
    if kind == "object":
        own = schema["properties"]
        wrong = [f"{place}.{key}" for key in {*value} - {*own}] + [
            f"{place}.{k}" for k in schema["required"] if k not in value
        ]
        return wrong + [
            at for key in value if key in own for at in faults(value[key], own[key], defs, f"{place}.{key}")
        ]
    return []


def schema_of(kind: str) -> dict[str, Any]:
    status, text, _ = run("describe", kind, "--schema")
    assert status == 0
    schema: dict[str, Any] = json.loads(text)
    assert schema["$id"] == f"urn:gearmesh:{gm.__version__}:{kind}"
    return schema


def samples_of(kind: str) -> list[dict[str, Any]]:
    """Tables of the samples of a kind."""
    designs = [tomllib.loads(path.read_text()) for path in sorted(SAMPLES.glob("*.toml"))]
    return [design for design in designs if design["kind"] == kind]


def complete(design: dict[str, Any]) -> dict[str, Any]:
    """A design with all that its gears are built with; what is left out is no value of a file."""
    return without_none(gm.parse(design).resolve())


def whole_files(kind: str) -> list[dict[str, Any]]:
    """Samples of a kind that need no other file."""
    return [design for design in samples_of(kind) if "topography" not in json.dumps(design)]


@pytest.mark.parametrize("kind", gm.kinds())
def test_samples_and_complete_designs_are_as_their_schema_says(kind: str) -> None:
    schema = schema_of(kind)
    for design in (*samples_of(kind), *map(complete, whole_files(kind)[:1])):
        assert faults(design, schema, schema["$defs"]) == []
    assert faults({}, schema, schema["$defs"])


@pytest.mark.sweep
@pytest.mark.parametrize("kind", gm.kinds())
def test_all_complete_designs_are_as_their_schema_says(kind: str) -> None:
    schema = schema_of(kind)
    for design in map(complete, whole_files(kind)[1:]):
        assert faults(design, schema, schema["$defs"]) == []


def without_none(table: Any) -> Any:
    if isinstance(table, dict):
        return {key: without_none(value) for key, value in table.items() if value is not None}
    return list(table) if isinstance(table, tuple) else table


def test_what_is_wrong_is_no_design() -> None:
    schema = schema_of("cylindrical")
    spur = tomllib.loads((SAMPLES / "spur.toml").read_text())
    for path, value in (
        ("pinion.teeth", 17.5),
        ("pinion.teeth", 0),
        ("pinion.teeht", 17),
        ("pinion.teeth", "17"),
        ("module", -1.0),
        ("module", True),
        ("units", "cm"),
        ("kind", "hypoid"),
        ("pressure_angle", 80),
    ):
        wrong = json.loads(json.dumps(spur))
        *tables, key = path.split(".")
        table = wrong
        for name in tables:
            table = table[name]
        table[key] = value
        assert faults(wrong, schema, schema["$defs"]) == [f".{path}"]
    assert "needs a kind" in refused("describe", "spur", "--schema")
