"""Faults of a file by the data model of REXS 1.7, as the table in tests/data has it."""

from __future__ import annotations

import json
import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from pathlib import Path
from typing import Any

FACTS: dict[str, Any] = json.loads((Path(__file__).parents[1] / "data" / "rexs_1_7.json").read_text(encoding="utf-8"))
#: attributes that no version knows; other programs skip them
CUSTOM = re.compile(r"custom_[a-z]+_\w+")
WHOLE = re.compile(r"-?\d+")


def faults(file: Path) -> list[str]:
    """All that the data model forbids, one line each."""
    if file.suffix == ".rexsj":
        model = json.loads(file.read_text(encoding="utf-8"))["model"]
        return list(_model_faults(_json_form(model)))
    root = ET.parse(file).getroot()
    return list(_model_faults(_xml_form(root)))


def _xml_form(root: ET.Element) -> dict[str, Any]:
    def components(parent: ET.Element | None, path: str) -> list[dict[str, Any]]:
        return [
            {
                "id": one.get("id"),
                "type": one.get("type"),
                "attributes": [
                    {
                        "id": part.get("id"),
                        "unit": part.get("unit"),
                        "value": [c.text for c in part.iter("c")] if len(part) else (part.text or ""),
                    }
                    for part in one
                ],
            }
            for one in ([] if parent is None else parent.iterfind(path))
        ]

    relations = [
        {
            "id": one.get("id"),
            "type": one.get("type"),
            "order": one.get("order"),
            "refs": [dict(ref.attrib) for ref in one],
        }
        for one in root.iterfind("relations/relation")
    ]
    cases = components(root, "load_spectrum/load_case/component")
    parts = components(root, "components/component")
    return {"head": dict(root.attrib), "relations": relations, "components": parts, "cases": cases}


def _json_form(model: dict[str, Any]) -> dict[str, Any]:
    def components(found: list[dict[str, Any]]) -> list[dict[str, Any]]:
        made = []
        for one in found:
            attributes = []
            for part in one["attributes"]:
                (type,) = part.keys() - {"id", "unit"}
                attributes.append({"id": part["id"], "unit": part["unit"], "type": type, "value": part[type]})
            made.append({"id": one["id"], "type": one.get("type"), "attributes": attributes})
        return made

    cases = [one for case in model.get("load_spectrum", {}).get("load_cases", []) for one in case["components"]]
    head = {key: value for key, value in model.items() if not isinstance(value, list | dict)}
    return {
        "head": head,
        "relations": model["relations"],
        "components": components(model["components"]),
        "cases": components(cases),
    }


def _model_faults(model: dict[str, Any]) -> Iterator[str]:
    for name in ("version", "applicationId", "applicationVersion", "date"):
        if not model["head"].get(name):
            yield f"model without {name}"
    if model["head"].get("version") != "1.7":
        yield f"version {model['head'].get('version')}"
    types = {str(one["id"]): one["type"] for one in model["components"]}
    for kind in ("components", "relations"):
        ids = [str(one["id"]) for one in model[kind]]
        if len(set(ids)) < len(ids) or not all(map(WHOLE.fullmatch, ids)):
            yield f"ids of {kind} are not different whole numbers"
    for one in model["relations"]:
        yield from _relation_faults(one, types)
    for one in [*model["components"], *model["cases"]]:
        yield from _component_faults(one, types)


def _relation_faults(one: dict[str, Any], types: dict[str, str]) -> Iterator[str]:
    known, name = FACTS["relations"].get(one["type"]), f"relation {one['id']} of type {one['type']}"
    if known is None:
        yield f"{name}: no such type"
        return
    if bool(one.get("order")) != known["ordered"]:
        yield f"{name}: order {one.get('order')}"
    parts = {ref["role"]: types.get(str(ref["id"]), "missing") for ref in one["refs"]}
    allowed = [dict(part.split("=") for part in line.split()) for line in known["combinations"]]
    if parts not in allowed:
        yield f"{name}: {parts}"


def _component_faults(one: dict[str, Any], types: dict[str, str]) -> Iterator[str]:
    type = types.get(str(one["id"]))
    if type not in FACTS["components"]:
        yield f"component {one['id']}: no type {type}"
        return
    for part in one["attributes"]:
        id, name = part["id"], f"{type} {one['id']}: {part['id']}"
        if CUSTOM.fullmatch(id):
            continue
        if id not in FACTS["components"][type]:
            yield f"{name}: no attribute of {type}"
            continue
        known = FACTS["attributes"][id]
        if part["unit"] != known["unit"]:
            yield f"{name}: in {part['unit']}, not {known['unit']}"
        if part.get("type", known["type"]) != known["type"]:
            yield f"{name}: of type {part['type']}, not {known['type']}"
        yield from _value_faults(name, part["value"], known, types)


def _value_faults(name: str, value: Any, known: dict[str, Any], types: dict[str, str]) -> Iterator[str]:
    type, text = known["type"], str(value)
    if known.get("values") and text not in known["values"]:
        yield f"{name} = {text}: none of the choices"
    if type in ("integer", "reference_component") and not WHOLE.fullmatch(text):
        yield f"{name} = {text}: not a whole number"
    if type == "reference_component" and text not in types:
        yield f"{name} = {text}: no such component"
    if type not in ("integer", "floating_point", "floating_point_array"):
        return
    for number in map(float, value if isinstance(value, list) else [value]):
        low, high = known.get("min", -math.inf), known.get("max", math.inf)
        inside = (low < number or (number == low and not known["min_open"])) and (
            number < high or (number == high and not known["max_open"])
        )
        if not math.isfinite(number) or not inside:
            yield f"{name} = {number:g}: outside the range from {low:g} to {high:g}"
