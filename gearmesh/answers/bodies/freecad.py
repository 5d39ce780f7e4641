"""Macros for FreeCAD: a design whose members are features, made anew when a parameter changes."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping
from importlib.resources import files
from pathlib import Path
from pprint import pformat
from typing import Any

from gearmesh.design.core import Design
from gearmesh.design.keys import Key

#: what stands in the macro for the design
PLACE = "SETUP = None\n"
#: keys of a design that are no parameters of its gears
NO_PARAMETERS = ("kind", "units", "name", "gearmesh")


def macro(design: Design, data: Mapping[str, Any], text: str, folder: Path, tolerance: str) -> str:
    """The text of a macro that makes the gears of a design in FreeCAD.

    Parameters
    ----------
    design : Design
        As it was loaded from `data`.
    data : mapping
        The table of the design file: its numbers, words and flags become properties of a feature.
    text : str
        The design file.
    folder : Path
        Where names of files in the design are counted from.
    tolerance : str
        Largest distance from the exact tooth surfaces, with its unit.
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
    return template.replace(PLACE, f"SETUP = {pformat(setup, width=120, sort_dicts=False)}\n", 1)


def _properties(
    design: Design, data: Mapping[str, Any], path: tuple[str, ...] = ()
) -> Iterator[tuple[str, dict[str, Any]]]:
    """The property of every key that holds one value: by its name, with type, value and what it is."""
    for name, value in data.items():
        own = (*path, name)
        if isinstance(value, Mapping):
            yield from _properties(design, value, own)
            continue
        key = design.key_at(".".join(own))
        if key is not None and own[0] not in NO_PARAMETERS and isinstance(value, (bool, int, float, str)):
            about = f"{key.about}: {key.allowed_values(design.units)}"
            yield (
                "_".join(own),
                {
                    "key": ".".join(own),
                    "group": path[0] if path else "design",
                    "about": about,
                    **_value_type(key, value),
                },
            )


def _value_type(key: Key, value: bool | int | float | str) -> dict[str, Any]:
    """Type, value and choices of the property of a key."""
    if isinstance(value, bool):
        return {"type": "Bool", "value": value}
    if isinstance(value, str):
        return (
            {"type": "Enumeration", "choices": [str(choice) for choice in key.choices], "value": str(value)}
            if key.choices
            else {"type": "String", "value": value}
        )
    return {"type": "Integer", "value": int(value)} if key.unit == "count" else {"type": "Float", "value": float(value)}
