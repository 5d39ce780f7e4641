"""Macros for FreeCAD: designs whose members are features, which are rebuilt when a parameter changes."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from importlib.resources import files
from pathlib import Path
from pprint import pformat
from typing import Any

from gearmesh.design.core import Design
from gearmesh.design.keys import Key

#: line of the macro that is replaced by the design
SETUP_LINE = "SETUP = None\n"
#: keys of a design that are not parameters of its gears
NO_PARAMETERS = ("kind", "units", "name", "gearmesh")


def macro(design: Design, data: Mapping[str, Any], text: str, folder: Path, tolerance: str) -> str:
    """The text of a macro that makes the gears of a design in FreeCAD.

    `data`: the table of the design file: its numbers, words and flags become properties of a feature. `folder`: folder
    to which names of files in the design are relative. `tolerance`: largest distance from the exact tooth surfaces,
    with its unit.
    """
    setup = {
        "python": sys.executable,
        "title": design.title,
        "tolerance": tolerance,
        "folder": str(folder),
        "keys": dict(_properties(design, data)),
        "design": text,
    }
    template = files("gearmesh.cad.programs").joinpath("gears.FCMacro").read_text(encoding="utf-8")
    return template.replace(SETUP_LINE, f"SETUP = {pformat(setup, width=120, sort_dicts=False)}\n", 1)


def _properties(
    design: Design, data: Mapping[str, Any], path: tuple[str, ...] = ()
) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the property of every key with one value: its name, and its type, value and description."""
    for name, value in data.items():
        key_path = (*path, name)
        if isinstance(value, Mapping):
            yield from _properties(design, value, key_path)
            continue
        key = design.key_at(".".join(key_path))
        if key is not None and key_path[0] not in NO_PARAMETERS and isinstance(value, (bool, int, float, str)):
            about = f"{key.about}: {key.allowed_values(design.units)}"
            yield (
                "_".join(key_path),
                {
                    "key": ".".join(key_path),
                    "group": path[0] if path else "design",
                    "about": about,
                    **_value_type(key, value),
                },
            )


def _value_type(key: Key, value: bool | int | float | str) -> dict[str, Any]:
    """Return type, value and choices of the property of a key."""
    if isinstance(value, bool):
        return {"type": "Bool", "value": value}
    if isinstance(value, str):
        return (
            {"type": "Enumeration", "choices": [str(choice) for choice in key.choices], "value": str(value)}
            if key.choices
            else {"type": "String", "value": value}
        )
    return {"type": "Integer", "value": int(value)} if key.unit == "count" else {"type": "Float", "value": float(value)}
