"""REXS models as XML."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterator

from gearmesh.errors import FileError
from gearmesh.exchange.json_form import ARRAY_OF_ARRAYS
from gearmesh.exchange.model import Attribute, Component, ComponentReference, LoadCase, Relation, RexsModel, Text
from gearmesh.files.xml_tree import xml_root


def model_of_xml(content: bytes, path: str) -> RexsModel:
    """Return the model in an XML file, which came from `path`. Raises FileError in one line."""
    try:
        root = xml_root(content)
    except ET.ParseError as failure:
        raise FileError(path, reason=f"not XML: {failure}") from None
    except (ValueError, LookupError) as failure:  # LookupError: an encoding that Python does not know
        raise FileError(path, reason=str(failure)) from None
    if root.tag != "model":
        raise FileError(path, reason=f"not a REXS file: its root is <{root.tag}>, not <model>")
    spectra = root.findall("load_spectrum")
    return RexsModel(
        _required_name(root, "version", path),
        root.get("applicationId", ""),
        root.get("applicationVersion", ""),
        root.get("date", ""),
        [_relation(one, path) for one in root.iterfind("relations/relation")],
        [_component(one, path) for one in root.iterfind("components/component")],
        spectra[0].get("id", "") if spectra else "",
        [case for spectrum in spectra for case in _load_cases(spectrum, path)],
        root.get("applicationLanguage", ""),
    )


def _load_cases(spectrum: ET.Element, path: str) -> Iterator[LoadCase]:
    """Yield the load cases and the accumulation of a spectrum."""
    for tag in ("load_case", "accumulation"):
        for case in spectrum.iterfind(tag):
            id = _required_name(case, "id", path) if tag == "load_case" else ""
            components = [_component(one, path) for one in case.iterfind("component")]
            yield LoadCase(id, components, spectrum.get("id", ""))


def _required_name(element: ET.Element, name: str, path: str) -> str:
    """Return an XML attribute that must be there."""
    value = element.get(name)
    if not value:
        raise FileError(path, reason=f"<{element.tag}> without {name}")
    return value


def _relation(element: ET.Element, path: str) -> Relation:
    """Return the relation of an element."""
    references = [
        ComponentReference(_required_name(one, "role", path), _required_name(one, "id", path), one.get("hint", ""))
        for one in element.iterfind("ref")
    ]
    return Relation(
        _required_name(element, "id", path), _required_name(element, "type", path), references, element.get("order", "")
    )


def _component(element: ET.Element, path: str) -> Component:
    """Return the component of an element."""
    attributes = [_attribute(one, path) for one in element.iterfind("attribute")]
    return Component(
        _required_name(element, "id", path),
        element.get("type", ""),
        element.get("name", ""),
        {one.id: one for one in attributes},
    )


def _attribute(element: ET.Element, path: str) -> Attribute:
    """Return the attribute of an element, with its value written out or encoded."""
    id, unit = _required_name(element, "id", path), element.get("unit", "") or "none"
    array, matrix, arrays = (element.find(tag) for tag in ("array", "matrix", "array_of_arrays"))
    coded = next((one for one in (array, matrix) if one is not None and one.get("code")), None)
    if coded is not None:
        shape = None if coded is array else (coded.get("rows", ""), coded.get("columns", ""))
        return Attribute(id, (coded.text or "").strip(), unit, code=coded.get("code", ""), shape=shape)
    if array is not None:
        return Attribute(id, _row(array), unit)
    if matrix is not None:
        return Attribute(id, [_row(row) for row in matrix.iterfind("r")], unit)
    if arrays is not None:
        return Attribute(id, [_row(row) for row in arrays.iterfind("array")], unit, ARRAY_OF_ARRAYS)
    return Attribute(id, (element.text or "").strip(), unit)


def _row(element: ET.Element) -> list[str]:
    """Return the texts of one row."""
    return [(one.text or "").strip() for one in element.iterfind("c")]


def xml_of(model: RexsModel) -> str:
    """Return the XML file of a model."""
    root = ET.Element(
        "model",
        {
            "version": model.version,
            "applicationId": model.application,
            "applicationVersion": model.application_version,
            "date": model.date,
            **({"applicationLanguage": model.language} if model.language else {}),
        },
    )
    relations = ET.SubElement(root, "relations")
    for relation in model.relations:
        order = {"order": relation.order} if relation.order else {}
        element = ET.SubElement(relations, "relation", {"id": relation.id, "type": relation.type, **order})
        for one in relation.references:
            ET.SubElement(element, "ref", {"id": one.id, "role": one.role, **({"hint": one.hint} if one.hint else {})})
    components = ET.SubElement(root, "components")
    for component in model.components:
        _put(components, component)
    for id in dict.fromkeys(case.spectrum or model.spectrum or "1" for case in model.load_cases):
        spectrum = ET.SubElement(root, "load_spectrum", {"id": id})
        for case in model.load_cases:
            if (case.spectrum or model.spectrum or "1") != id:
                continue
            inside = ET.SubElement(spectrum, *(("load_case", {"id": case.id}) if case.id else ("accumulation",)))
            for component in case.components:
                _put(inside, component)
    ET.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def _put(parent: ET.Element, component: Component) -> None:
    """Write a component into a parent element."""
    named = {key: value for key, value in (("type", component.type), ("name", component.name)) if value}
    element = ET.SubElement(parent, "component", {"id": component.id, **named})
    for one in component.attributes.values():
        _put_value(ET.SubElement(element, "attribute", {"id": one.id, "unit": one.unit}), one)


def _put_value(parent: ET.Element, one: Attribute) -> None:
    """Write the value of an attribute into a parent element."""
    if one.code:
        shape = {} if one.shape is None else dict(zip(("rows", "columns"), one.shape, strict=True))
        ET.SubElement(parent, "array" if one.shape is None else "matrix", {"code": one.code, **shape}).text = str(
            one.text
        )
    elif isinstance(one.text, str):
        parent.text = one.text
    elif not any(isinstance(row, list) for row in one.text):
        _put_row(ET.SubElement(parent, "array"), one.text)
    else:
        outside, inside = ("array_of_arrays", "array") if one.type == ARRAY_OF_ARRAYS else ("matrix", "r")
        whole = ET.SubElement(parent, outside)
        for row in one.text:
            _put_row(ET.SubElement(whole, inside), row)


def _put_row(parent: ET.Element, row: Text) -> None:
    """Write the texts of one row into a parent element."""
    for text in row:
        ET.SubElement(parent, "c").text = str(text)
