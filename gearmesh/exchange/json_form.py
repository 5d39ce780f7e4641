"""REXS models as JSON."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

from gearmesh.errors import FileError
from gearmesh.exchange.attributes import ATTRIBUTE_FORMS
from gearmesh.exchange.model import Attribute, Component, ComponentReference, LoadCase, Relation, RexsModel, Text
from gearmesh.files.reading import json_value
from gearmesh.numerals import is_number, parse_number, parse_whole_number

#: type of arrays of arrays
ARRAY_OF_ARRAYS = "array_of_integer_arrays"


def model_of_json(text: str, path: str) -> RexsModel:
    """Return the model in a JSON file, which came from `path`. Raises FileError in one line."""
    return _Reader(path).model(json_value(text, path))


class _Reader:
    """Reader of one file; its errors name the place of the fault."""

    def __init__(self, path: str) -> None:
        self.path = path

    def model(self, data: Any) -> RexsModel:
        """Return the model of the whole file."""
        root = self.table(self.table(data, "the file").get("model"), "model")
        spectrum = self.table(root.get("load_spectrum") or {}, "load_spectrum")
        accumulation = self.table(root.get("accumulation") or {}, "accumulation")
        name = str(spectrum.get("id", ""))
        cases = [
            LoadCase(self.text(case, "id", "load case"), self.components(case), name)
            for case in self.tables(spectrum, "load_cases")
        ]
        return RexsModel(
            self.text(root, "version", "model"),
            str(root.get("applicationId", "")),
            str(root.get("applicationVersion", "")),
            str(root.get("date", "")),
            [self.relation(one) for one in self.tables(root, "relations")],
            self.components(root),
            name,
            cases + ([LoadCase("", self.components(accumulation), name)] if accumulation else []),
            str(root.get("applicationLanguage") or ""),
        )

    def table(self, value: Any, where: str) -> Mapping[str, Any]:
        """Return a value that must be an object."""
        if not isinstance(value, dict):
            raise FileError(self.path, reason=f"not a REXS file: {where} is not an object")
        return value

    def tables(self, data: Mapping[str, Any], name: str) -> Iterator[Mapping[str, Any]]:
        """Yield the objects of an array."""
        values = data.get(name) or []
        if not isinstance(values, list):
            raise FileError(self.path, reason=f"not a REXS file: {name} is not an array")
        for value in values:
            yield self.table(value, f"one of {name}")

    def text(self, data: Mapping[str, Any], name: str, where: str) -> str:
        """Return a value that must be a text or a whole number."""
        value = data.get(name)
        if not isinstance(value, (str, int)) or isinstance(value, bool) or value == "":
            raise FileError(self.path, reason=f"{where} without {name}")
        return str(value)

    def relation(self, data: Mapping[str, Any]) -> Relation:
        references = [
            ComponentReference(self.text(one, "role", "ref"), self.text(one, "id", "ref"), str(one.get("hint") or ""))
            for one in self.tables(data, "refs")
        ]
        id, type = (self.text(data, name, "relation") for name in ("id", "type"))
        return Relation(id, type, references, str(data.get("order") or ""))

    def components(self, data: Mapping[str, Any]) -> list[Component]:
        return [self.component(one) for one in self.tables(data, "components")]

    def component(self, data: Mapping[str, Any]) -> Component:
        attributes = [self.attribute(one) for one in self.tables(data, "attributes")]
        id, type, name = self.text(data, "id", "component"), str(data.get("type") or ""), str(data.get("name") or "")
        return Component(id, type, name, {one.id: one for one in attributes})

    def attribute(self, data: Mapping[str, Any]) -> Attribute:
        id, unit = self.text(data, "id", "attribute"), str(data.get("unit") or "none")
        types = [name for name in data if name not in ("id", "unit")]
        if not types:
            # as programs write what is not given
            return Attribute(id, "", unit)
        if len(types) > 1:
            raise FileError(self.path, reason=f"attribute {id} with {len(types)} values: {', '.join(types)[:60]}")
        value = data[types[0]]
        if isinstance(value, dict):
            shape = (str(value["rows"]), str(value["columns"])) if "rows" in value and "columns" in value else None
            return Attribute(id, str(value.get("value", "")), unit, types[0], str(value.get("code", "")), shape)
        return Attribute(id, _text(value), unit, types[0])


def _text(value: Any) -> Text:
    """Return a value of JSON as a text of XML."""
    if isinstance(value, list):
        return [_text(one) for one in value]  # type: ignore[return-value]
    if value is None:
        return ""
    return value if isinstance(value, str) else json.dumps(value)


def json_of(model: RexsModel) -> str:
    """Return the JSON file of a model."""
    root: dict[str, Any] = {
        "version": model.version,
        "applicationId": model.application,
        "applicationVersion": model.application_version,
        "date": model.date,
        "relations": [
            {
                "id": _id(one.id),
                "type": one.type,
                **({"order": _id(one.order)} if one.order else {}),
                "refs": [
                    {"id": _id(ref.id), "role": ref.role, **({"hint": ref.hint} if ref.hint else {})}
                    for ref in one.references
                ],
            }
            for one in model.relations
        ],
        "components": [_component(one) for one in model.components],
    }
    cases = [case for case in model.load_cases if case.id]
    if cases or model.spectrum:
        root["load_spectrum"] = {
            "id": _id(model.spectrum or "1"),
            "load_cases": [
                {"id": _id(case.id), "components": [_component(one) for one in case.components]} for case in cases
            ],
        }
    for case in model.load_cases:
        if not case.id:
            root["accumulation"] = {"components": [_component(one) for one in case.components]}
    return json.dumps({"model": root}, indent=2, ensure_ascii=False) + "\n"


def _id(text: str) -> int | str:
    """Return an id as a whole number if it is one."""
    number = parse_whole_number(text)
    return text if number is None else number


def _component(one: Component) -> dict[str, Any]:
    """Return a component as a JSON object."""
    named = {key: value for key, value in (("type", one.type), ("name", one.name)) if value}
    return {"id": _id(one.id), **named, "attributes": [_attribute(part) for part in one.attributes.values()]}


def _attribute(one: Attribute) -> dict[str, Any]:
    """Return an attribute as a JSON object."""
    type = one.type or guessed_type(one)
    value: Any
    if one.code:
        shape = {} if one.shape is None else {"rows": _id(one.shape[0]), "columns": _id(one.shape[1])}
        value = {"code": one.code, "value": one.text, **shape}
    else:
        value = _value(one.text, type)
    return {"id": one.id, "unit": one.unit, type: value}


def _value(text: Text, type: str) -> Any:
    """Return the value of a text as its JSON type."""
    if isinstance(text, list):
        return [_value(one, type) for one in text]
    if text == "" and not type.startswith(("string", "enum", "file_reference")):
        return None
    if type.startswith(("integer", "reference_component", ARRAY_OF_ARRAYS)):
        value = parse_number(text)
        return int(value) if value is not None and value.is_integer() else text
    if type.startswith("floating_point"):
        return float(text) if is_number(text) else text
    return text.lower() == "true" if type.startswith("boolean") else text


def guessed_type(one: Attribute) -> str:
    """Return the type of an attribute from an XML file, which does not state it, from its name, unit and text."""
    if one.id in ATTRIBUTE_FORMS and not one.code:
        return ATTRIBUTE_FORMS[one.id].type
    end = "_coded" if one.code else ""
    texts = list(_leaves(one.text))
    if isinstance(one.text, list) or one.code:
        rows = one.shape is not None or (isinstance(one.text, list) and any(isinstance(row, list) for row in one.text))
        end = ("_matrix" if rows else "_array") + end
    if one.code.startswith("int"):
        return "integer" + end
    if one.code or (one.unit not in ("none", "") and all(is_number(text) or not text for text in texts)):
        return "floating_point" + end
    if texts and all(text in ("true", "false") for text in texts):
        return "boolean" + end
    if not end and (one.id.startswith("reference_component") or one.id.endswith("_component_id")):
        return "reference_component"
    if (
        texts
        and all(parse_whole_number(text) is not None for text in texts)
        and one.id.startswith(("number_", "gear_shift"))
    ):
        return "integer" + end
    if texts and all(map(is_number, texts)):
        return "floating_point" + end
    return "string" + end


def _leaves(text: Text) -> Iterator[str]:
    """Yield the texts of rows, and of rows of rows."""
    if isinstance(text, str):
        yield text
    else:
        for one in text:
            yield from _leaves(one)
