"""The JSON Schema of report.json: reports are as it says, and it knows nearly all that stands in them."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
from oracles.command_line import run
from oracles.places import SAMPLES

import gearmesh as gm

TYPES = {"object": dict, "array": list, "string": str, "number": (int, float), "integer": int, "null": type(None)}


def schema() -> dict[str, Any]:
    status, text, _ = run("describe", "report", "--schema")
    assert status == 0
    printed: dict[str, Any] = json.loads(text)
    return printed


def faults(value: Any, rule: dict[str, Any], unknown: set[str], place: str = "") -> list[str]:
    """Return the places where a value breaks a rule; keys that a rule leaves open go to `unknown`."""
    types = rule.get("type", [])
    types = [types] if isinstance(types, str) else types
    if types and not any(isinstance(value, TYPES[one]) and not isinstance(value, bool) for one in types):
        return [place]
    if "enum" in rule and value not in rule["enum"]:
        return [place]
    if isinstance(value, list):
        return [at for item in value for at in faults(item, rule.get("items", {}), unknown, place)]
    wrong = []
    if isinstance(value, dict) and ("properties" in rule or "additionalProperties" in rule):
        wrong += [f"{place}.{key}" for key in rule.get("required", ()) if key not in value]
        for key, item in value.items():
            patterns = [one for pattern, one in rule.get("patternProperties", {}).items() if re.search(pattern, key)]
            own = rule.get("properties", {}).get(key, patterns[0] if patterns else rule.get("additionalProperties"))
            if own is False:
                wrong.append(f"{place}.{key}")
            elif own is None:
                unknown.add(f"{place}.{key}")
            else:
                wrong += faults(item, own, unknown, f"{place}.{key}")
    return wrong


@pytest.mark.sweep
@pytest.mark.parametrize("sample", ["spur", "rack", "planetary", "spiral_bevel_basic"])
def test_reports_are_as_the_schema_says(sample: str, tmp_path: Path) -> None:
    gears = gm.build(gm.load(SAMPLES / f"{sample}.toml"))
    gears.run(tmp_path, "50um", page=False)
    report = json.loads((tmp_path / "report.json").read_text())
    unknown: set[str] = set()
    assert faults(report, schema(), unknown) == []
    # keys of the design have schemas of their own, and gear systems figures
    own = {f".contact.{figure.key}" for pair in gears.pairs for figure in figures_of(pair.figures)}
    assert {key for key in unknown if not key.startswith(".design.")} <= own


def figures_of(figures: Any) -> list[Any]:
    return [] if figures is None else [entry.figure for entry in figures.entries]


def test_what_is_wrong_is_no_report() -> None:
    rule = schema()
    good = {
        "gearmesh": gm.__version__,
        "design": {"kind": "cylindrical"},
        "mesh": {"pinion": {"triangles": 1280, "volume_mm3": 21664.3}},
        "roll": [{"phi1_deg": 1.0}],
        "verdicts": [],
        "warnings": [],
        "files": [],
        "frames": {},
    }
    assert rule["$id"] == f"urn:gearmesh:{gm.__version__}:report"
    assert faults(good, rule, set()) == []
    for change in (
        {"mesh": {"pinion": {"triangles": "1280"}}},
        {"roll": [{"phi1_deg": "1"}]},
        {"design": {"kind": "spurs"}},
        {"warnings": [1]},
        {"rolls": []},
    ):
        assert faults(good | change, rule, set())
    assert faults({key: value for key, value in good.items() if key != "files"}, rule, set()) == [".files"]
